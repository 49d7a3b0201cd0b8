/* SPDX-License-Identifier: BSD-3-Clause */
/* has_gl: whether there is OpenGL 4.5. Exit code 77: no, with the reason. Command lines ask it before they skip a test:
 * conus ends with 4 also where a driver refuses a shader. */
#include "render/gl/gl.h"

#include <stdio.h>

int main(void)
{
    struct gl_context *context = NULL;
    if (gl_context_create(&context, NULL, NULL)) {
        puts(conus_message());
        return 77;
    }
    gl_context_destroy(context);
    return 0;
}
