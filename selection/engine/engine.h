/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The interface of the engines, which fill the evidence and list the intervals of rays, and their constructors.
 */
#ifndef CONUS_SELECTION_ENGINE_ENGINE_H
#define CONUS_SELECTION_ENGINE_ENGINE_H

#include "render/passes/shapes.h" /* SLICES_FRACTION */
#include "selection/cone/cone.h"
#include "selection/evidence/evidence.h"

/** An engine for one atlas. */
struct engine;
struct layers;
struct traverse_kernel;

struct engine_functions {
    /** Fills @p out (already initialised to the cone's resolution) for @p cone. With begins_at_range a hit at or behind
     * the near end of the range is the first there; one before it says nothing. */
    conus_status (*trace)(struct engine *engine, struct evidence *out, const struct cone *cone);
    /** trace() for @p count cones of one resolution at once; NULL where that is no faster. */
    conus_status (*trace_many)(struct engine *engine, struct evidence *const *out, const struct cone *const *cones,
                               size_t count);
    /** Appends every interval of every pixel's ray inside an object to @p out, whatever hides it (Eq. 10), and inside
     * what blocks, as VOLUME_BLOCKER. Exact sampling only. The range of the cone does not matter, except that intervals
     * beyond its far end may be missing, and one that crosses it may end anywhere beyond. */
    conus_status (*pierce)(struct engine *engine, struct layers *out, const struct cone *cone);
    void (*destroy)(struct engine *engine);
};

/** First member of every engine. */
struct engine {
    const struct engine_functions *functions;
    char name[96]; /**< "rays, avx512"; "gl, llvmpipe (...)". */
};

struct engine_options {
    conus_sampling sampling;
    uint32_t slices;       /**< N of Eq. 7 of the colour pass, 0 = default. */
    double slice_fraction; /**< F of Eq. 7, 0 = a fifth. */
    conus_log log;         /**< May be NULL. */
    void *log_user;
};

/* The engines that there are: engine_rays.c and engine_gl.c. */
conus_status engine_rays_create(struct engine **out, const conus_atlas *atlas, const struct engine_options *options);
conus_status engine_gl_create(struct engine **out, const conus_atlas *atlas, const struct engine_options *options);

/** NULL is fine. */
static inline void engine_destroy(struct engine *engine)
{
    if (engine) {
        engine->functions->destroy(engine);
    }
}

/* The rays engine with its kernel chosen by hand, for tests and measurements; and for the meshes or the bundles
 * alone. */

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
