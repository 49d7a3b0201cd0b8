/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The rays engine with its kernel chosen by hand, for tests and measurements; and for the meshes or
 * the bundles alone. */
#ifndef CONUS_SELECTION_ENGINE_ENGINE_RAYS_H
#define CONUS_SELECTION_ENGINE_ENGINE_RAYS_H

#include "selection/engine/engine.h"
#include "selection/engine/voxels/traverse.h"

/** engine_rays_create() with @p kernel, which this machine must support. */
conus_status engine_rays_create_with(struct engine **out, const conus_atlas *atlas,
                                     const struct engine_options *options, const struct traverse_kernel *kernel);

/** A rays engine that knows only the meshes of @p atlas. */
conus_status engine_rays_create_for_meshes(struct engine **out, const conus_atlas *atlas);

/** One that knows only the bundles. */
conus_status engine_rays_create_for_bundles(struct engine **out, const conus_atlas *atlas);

/** trace() of a rays engine that adds to @p out: hits that @p out already has stay where they are nearer. */
conus_status engine_rays_trace_on(struct engine *engine, struct evidence *out, const struct cone *cone);

#endif
