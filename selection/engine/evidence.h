/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The evidence: what each pixel's ray met first, and the interface of the engines that produce it. Everything
 * behind it (statistics, scores, report, pictures) neither knows nor cares which engine did. */
#ifndef CONUS_SELECTION_ENGINE_EVIDENCE_H
#define CONUS_SELECTION_ENGINE_EVIDENCE_H

#include "atlas/atlas.h"
#include "selection/cone/cone.h"

#define EVIDENCE_NO_VOXEL UINT64_MAX

/** n*n pixels, row-major, row 0 at the device's bottom (v = -1). Pixels outside the aperture are filled too. */
struct evidence {
    uint32_t resolution;
    uint32_t *object; /**< Object met first; 0 = none.                                                          */
    double *distance; /**< mm from the apex along the ray to the entry into that object; INFINITY = none.       */
    uint64_t *voxel;  /**< Linear index of the voxel met, in the object's volume, or the triangle of its mesh;
                         EVIDENCE_NO_VOXEL = none. */
};

conus_status evidence_init(struct evidence *out, uint32_t resolution);
void evidence_finish(struct evidence *evidence);

/** Sets every pixel to "nothing". */
void evidence_clear(struct evidence *evidence);

/** Sets pixels that hold VOLUME_BLOCKER to "nothing". */
void evidence_drop_blocked(struct evidence *evidence);

/** An engine for one atlas. */
struct engine;
struct layers;

struct engine_functions {
    /** Fills @p out (already initialised to the cone's resolution) for @p cone. */
    conus_status (*trace)(struct engine *engine, struct evidence *out, const struct cone *cone);
    /** trace() for @p count cones of one resolution at once; NULL where that is no faster. */
    conus_status (*trace_many)(struct engine *engine, struct evidence *const *out, const struct cone *const *cones,
                               size_t count);
    /** Appends every interval of every pixel's ray inside an object to @p out, whatever hides it (Eq. 10), and inside
     * what blocks, as VOLUME_BLOCKER. Neither heeds the cone's range. Exact sampling only. */
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
    uint32_t slices; /**< N of Eq. 7 of the colour pass; the ID pass takes N/5. 0 = default. */
    conus_log log;   /**< May be NULL. */
    void *log_user;
};

conus_status engine_rays_create(struct engine **out, const conus_atlas *atlas, const struct engine_options *options);
conus_status engine_gl_create(struct engine **out, const conus_atlas *atlas, const struct engine_options *options);

/** NULL is fine. */
void engine_destroy(struct engine *engine);

#endif
