/* SPDX-License-Identifier: BSD-3-Clause */
/* Stands for OpenGL's contexts where conus is built without: tests that need one skip. */
#include "render/gl/gl.h"

conus_status gl_context_create(struct gl_context **out, conus_log log, void *log_user)
{
    (void)out, (void)log, (void)log_user;
    return fail(CONUS_ERROR_GL, "this build of conus leaves out OpenGL");
}

void gl_context_destroy(struct gl_context *context)
{
    (void)context;
}
