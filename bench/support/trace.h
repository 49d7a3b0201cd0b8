/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Ways to answer cones: an engine, many cones, and comparisons with the answers of another way. */
#ifndef CONUS_BENCH_SUPPORT_TRACE_H
#define CONUS_BENCH_SUPPORT_TRACE_H

#include "bench/support/bench.h"
#include "selection/engine/engine.h"
#include "selection/engine/triangles/mesh_rays.h"

enum { CONTEST_LIMIT = 8 };

/** An engine that answers cones; cones of one resolution. */
struct trace {
    char name[112];
    struct engine *engine;    /**< Borrowed, as the cones are. */
    const struct cone *cones; /**< [count]                      */
    size_t count;
    struct evidence *answers; /**< [count] Of trace_init().                                */
    struct evidence scratch;  /**< Answers of timed runs go here, as in a long batch. */
    conus_status status;      /**< The first failure of a cone. */
};

/** Answers all cones once. End it with trace_finish() even if this fails. */
conus_status trace_init(struct trace *out, struct engine *engine, const struct cone *cones, size_t count);
/** The same, but the answers are the first of all hits (Eq. 10). */
conus_status trace_init_firsts(struct trace *out, struct engine *engine, const struct cone *cones, size_t count);
void trace_finish(struct trace *trace);

/** Answers all cones again, into the scratch: the `run` of a variant whose data is a trace. */
void trace_all(void *trace);

/** Whether objects, voxels or triangles, and distances are the same to the bit. */
bool trace_same(const struct trace *a, const struct trace *b);

/** Number of pixels of all cones. */
size_t trace_pixels(const struct trace *trace);

/** Number of pixels in which the two name different objects. */
size_t trace_differences(const struct trace *a, const struct trace *b);

/** Whether they name the same objects except at edges, which a rasteriser moves by up to 1/128 of a pixel, since it
 * snaps corners to a grid; prints the differences. */
bool trace_same_but_edges(const struct trace *trace, const struct trace *rays);

/** Engines that answer the same cones. */
struct contest {
    conus_atlas *atlas; /**< Owned; may be NULL. */
    struct cone *cones; /**< [cone_count] Owned. */
    size_t cone_count;
    struct engine *engines[CONTEST_LIMIT]; /**< [count] Owned. */
    struct trace traces[CONTEST_LIMIT];    /**< [count] */
    size_t count;
};

/** Loads the atlas at @p path, which must have labelled voxels, and aims @p count cones from 200 to 300 mm around its
 * grid at the inner half of it. End it with contest_finish() even if this fails. */
conus_status contest_load(struct contest *out, const char *path, size_t count, double angle_deg, uint64_t seed);

/** Takes @p engine over, and makes it answer all cones once. */
conus_status contest_add(struct contest *contest, struct engine *engine, const char *name);

/** Way number @p index as a variant, whose answers are not yet marked as equal. */
struct bench_variant contest_variant(struct contest *contest, size_t index);

void contest_finish(struct contest *contest);

/** A frame, and one selection while it is drawn. */
struct shot {
    conus_status (*draw)(void *scene, int way); /**< Has a frame drawn in one of its ways, without waiting for it. */
    conus_status (*wait)(void *scene);          /**< Until it is there. */
    void *scene;
    int way;
    struct trace *trace; /**< NULL = no selection. */
    size_t next;         /**< Its next cone.       */
    conus_status status;
};

/** The `run` of a variant whose data is a shot. The frame is finished when both the picture and the selection are
 * there. */
void shoot(void *shot);

/** Engines for the comparisons. The caller destroys them; what they are given must outlive them. */

/** Plain scalar traversal of the volumes, a voxel at a time (tests/support/oracle_traversal.h). */
conus_status plain_engine_create(struct engine **out, const conus_atlas *atlas);

/** Surfaces only, with so many rays at once; @p width 0 = as the rays engine chooses. Cones of at most 16 x 16 rays. */
conus_status mesh_engine_create(struct engine **out, struct mesh_rays *rays, unsigned width);

/** Surfaces only, by Embree alone, in builds with it (bare_embree.c); for cones whose rays are known. */
conus_status bare_embree_create(struct engine **out, const conus_atlas *atlas);

/** Writes cones from 200 to 300 mm around a grid's middle, towards its inner half. */
void cones_round_grid(struct cone *out, size_t count, const conus_volume_info *info, double angle_deg, uint64_t seed);

#endif
