/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The streamline pass (Eq. 18): which runs of segments the ray of each pixel of n x n buffers may hit. Needs a current
 * context throughout.
 *
 * Leaves of the tree are drawn front to back in batches (mesh_cull.h). Each of their runs is a box on the screen round
 * all that it can cover; the driver notes in which pixels the ray may hit it, in single precision with the slack of
 * tract_start.h, and no farther away than the ray gets for sure. So what it proposes holds all that is hit first; the
 * caller settles it in double, before the next batch.
 */
#ifndef CONUS_RENDER_ID_TRACT_PASS_H
#define CONUS_RENDER_ID_TRACT_PASS_H

#include "atlas/tracts/tract_node.h"
#include "render/id/clusters.h"
#include "render/id/mesh_cull.h"

/** Texels of four 32-bit words that a leaf has in tract_id.vert.glsl: low and thickness, step, then two runs each. */
enum { TRACT_LEAF_TEXELS = 2 + TRACT_LEAF / 2 };

/** Streamlines that a pass searches. */
struct tract_source {
    const struct tractogram *tractogram; /**< With its tree. */
    const bool *shown;                   /**< [streamline_count] Which are searched; NULL = all. */
};

/** Clusters of the leaves that hold a streamline that is shown: `first` is the leaf, `count` its runs; their balls hold
 * the capsules round the segments. There are no triangles. End them with clusters_finish(). */
conus_status tract_clusters_init(struct clusters *out, const struct tract_source *source);

/** Bytes of the leaves' texels. */
uint64_t tract_texels_size(const struct tractogram *tractogram);

/** The texels of the leaf @p number; hidden runs have 0 where others have TRACT_SHOWN. */
void tract_texels_fill(uint32_t out[TRACT_LEAF_TEXELS][4], const struct tract_source *source, size_t number);
enum { TRACT_SHOWN = 1 << 24 };

struct tract_pass;

/** One view, and the rays of its pixels; bottom row first, [n n] each. */
struct tract_query {
    struct mesh_view view;
    const double (*origins)[3];    /**< In the world.              */
    const double (*directions)[3]; /**< Unit vectors in the world. */
    const bool *wanted;            /**< Pixels that are searched; NULL = all. */
    const double *distances; /**< How far the rays get, mm, INFINITY = no limit, read when needed. 0 = the pixel is not
                                  searched. NULL = all hits are searched. */
};

/** A run that the ray of a pixel may hit. */
struct tract_proposal {
    size_t query;   /**< The caller's. */
    uint32_t pixel; /**< In its buffer. */
    size_t source;
    size_t run; /**< As in tract_run_at(). */
};

/** Receives proposals, those of near leaves before those of far ones. */
typedef conus_status (*tract_pass_take)(void *user, const struct tract_proposal *proposal);

/** Whether the driver takes all @p sources, within @p memory_left. */
bool tract_pass_fits(const struct tract_source *sources, size_t count, uint64_t memory_left);

/** Uploads the runs of tractograms, which must outlive the pass; @p sources is copied, but `shown` need not live on.
 * Takes their size on the device off @p memory_left; they must fit. */
conus_status tract_pass_create(struct tract_pass **out, const struct tract_source *sources, size_t count,
                               uint64_t *memory_left);
/** NULL is fine. */
void tract_pass_destroy(struct tract_pass *pass);

/** Passes to @p take the runs that the rays of @p count queries, all of one resolution, may hit. Most of those behind a
 * query's `distances`, or that surely are no first hit, are left out. */
conus_status tract_pass_render(struct tract_pass *pass, const struct tract_query *queries, size_t count,
                               tract_pass_take take, void *user);

#endif
