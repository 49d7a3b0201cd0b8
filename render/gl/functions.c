/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes the functions of OpenGL and EGL from libepoxy. */
#include "render/gl/gl.h"

#include <pthread.h>

/* libepoxy's variables. */
static struct {
    GL_FUNCTIONS(LIBRARY_MEMBER)
} theirs;

#define DEFINE(prefix, name) __typeof__(prefix##name) prefix##name;
GL_FUNCTIONS(DEFINE)

#define COPY(prefix, name) prefix##name = *theirs.name;
static void copy_functions(void){GL_FUNCTIONS(COPY)}

conus_status gl_load_functions(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    conus_status status = library_load(&theirs, GL_FUNCTIONS(LIBRARY_NAME), CONUS_EPOXY_FILE, "libepoxy0");
    if (!status) {
        pthread_once(&once, copy_functions);
    }
    return status;
}
