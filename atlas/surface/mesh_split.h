/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A surface with a label at each vertex, cut into one surface per label. */
#ifndef CONUS_ATLAS_SURFACE_MESH_SPLIT_H
#define CONUS_ATLAS_SURFACE_MESH_SPLIT_H

#include "atlas/surface/mesh.h"

struct mesh_part {
    uint32_t label;
    struct mesh mesh; /**< Only the vertices that its triangles use; path as that of the whole. */
};

/** Sorted by label. */
struct mesh_parts {
    struct mesh_part *parts;
    size_t count;
};

void mesh_parts_finish(struct mesh_parts *parts);

/** The part with that label, or NULL. They ascend by label. */
struct mesh_part *mesh_parts_find(const struct mesh_parts *parts, uint32_t label);

/** Cuts the checked @p mesh by @p labels (one per vertex, 0 = none). A triangle belongs to the label of most of its
 * corners; where all three differ, to that of its first. Triangles of label 0 are left out, with a note. Parts are open
 * at their borders, as areas of a surface are. CONUS_ERROR_DATA where no triangle is labelled. */
conus_status mesh_split(struct mesh_parts *out, const struct mesh *mesh, const uint32_t *labels, struct notes *notes);

#endif
