/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A cone's look at surfaces, with the number of rays at once chosen by hand. */
#ifndef CONUS_APPS_BENCH_MESH_LOOK_H
#define CONUS_APPS_BENCH_MESH_LOOK_H

#include "selection/evidence.h"
#include "selection/mesh_rays.h"

enum { MESH_LOOK_RESOLUTION = 16 };

/** Fills @p out as the rays engine does, for a cone of MESH_LOOK_RESOLUTION; @p width 0 = as the engine chooses. */
conus_status bench_look_at_meshes(struct evidence *out, struct mesh_rays *rays, const struct cone *cone,
                                  unsigned width);

#endif
