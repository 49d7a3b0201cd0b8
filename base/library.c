/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the functions of libraries that are loaded when they are needed. */
#include "base/library.h"

#include <dlfcn.h>
#include <pthread.h>
#include <string.h>

/* Fills the table from its end on: the first function says that all are there. */
static bool find_functions(void *table, const char *names, void *library, size_t number)
{
    if (!*names) {
        return true;
    }
    void *function = dlsym(library, names);
    if (!function || !find_functions(table, names + strlen(names) + 1, library, number + 1)) {
        return false;
    }
    memcpy((char *)table + number * sizeof function, &function, sizeof function);
    return true;
}

conus_status library_load(void *table, const char *names, const char *file, const char *package)
{
    static pthread_mutex_t loading = PTHREAD_MUTEX_INITIALIZER;
    void *first;
    pthread_mutex_lock(&loading);
    memcpy(&first, table, sizeof first);
    if (!first) {
        void *library = dlopen(file, RTLD_LAZY | RTLD_LOCAL);
        if (library && find_functions(table, names, library, 0)) {
            memcpy(&first, table, sizeof first);
        } else if (library) {
            dlclose(library);
        }
    }
    pthread_mutex_unlock(&loading);
    return first ? CONUS_OK : fail(CONUS_ERROR_UNSUPPORTED, "%s cannot be loaded (Debian: %s)", file, package);
}
