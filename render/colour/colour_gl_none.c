/* SPDX-License-Identifier: BSD-3-Clause */
/* Stands for the device that draws with OpenGL, in a build without it. */
#include "render/colour/colour.h"

conus_status colour_gl_create(struct colour_device **out, conus_log log, void *log_user)
{
    (void)out, (void)log, (void)log_user;
    return fail(CONUS_ERROR_UNSUPPORTED, "engine: gl, which this build leaves out; rays draws the same pictures");
}
