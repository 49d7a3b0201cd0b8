/* SPDX-License-Identifier: BSD-3-Clause */
/* Stands for the engine that renders, in a build without OpenGL. */
#include "selection/engine/engine.h"

conus_status engine_gl_create(struct engine **out, const conus_atlas *atlas, const struct engine_options *options)
{
    (void)out, (void)atlas, (void)options;
    return fail(CONUS_ERROR_UNSUPPORTED, "engine: gl, which this build leaves out; rays gives the same answers");
}
