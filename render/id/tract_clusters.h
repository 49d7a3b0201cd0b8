/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A tractogram as clusters (clusters.h), so that what a view cannot show is left out as of meshes: a cluster is a leaf
 * of the tree, with 32 runs of segments, and what clusters call a mesh is a group of neighbouring leaves. And the runs
 * of all leaves as shaders read them. */
#ifndef CONUS_RENDER_ID_TRACT_CLUSTERS_H
#define CONUS_RENDER_ID_TRACT_CLUSTERS_H

#include "atlas/tracts/tract_node.h"
#include "render/id/clusters.h"

/** Texels of four 32-bit words that a leaf has in tract_id.vert.glsl: low and thickness, step, then two runs each. */
enum { TRACT_LEAF_TEXELS = 2 + TRACT_LEAF / 2 };

/** Streamlines that a pass finds. */
struct tract_source {
    const struct tractogram *tractogram; /**< With its tree. */
    const bool *shown;                   /**< [streamline_count] Those that are looked for; NULL = all. */
};

/** Clusters of the leaves with a streamline that is shown: `first` is the leaf, `count` its runs; their balls have the
 * capsules round the segments in them. Triangles there are none. End them with clusters_finish(). */
conus_status tract_clusters_init(struct clusters *out, const struct tract_source *source);

/** Bytes of the leaves' texels. */
uint64_t tract_texels_size(const struct tractogram *tractogram);

/** The texels of the leaf @p number: what is not shown has a 0 where others have TRACT_SHOWN. */
void tract_texels_fill(uint32_t out[TRACT_LEAF_TEXELS][4], const struct tract_source *source, size_t number);
enum { TRACT_SHOWN = 1 << 24 };

#endif
