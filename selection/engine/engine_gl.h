/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Facts about the gl engine, for tests. */
#ifndef CONUS_SELECTION_ENGINE_ENGINE_GL_H
#define CONUS_SELECTION_ENGINE_ENGINE_GL_H

#include "selection/engine/engine.h"

/** How many runs of streamlines the driver has proposed so far, for pixels one by one; 0 where it draws none. */
uint64_t engine_gl_proposals(const struct engine *engine);

#endif
