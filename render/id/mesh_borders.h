/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Smooth borders between areas of one surface, for pictures only: engines have the triangles as they are. */
#ifndef CONUS_RENDER_ID_MESH_BORDERS_H
#define CONUS_RENDER_ID_MESH_BORDERS_H

#include "render/id/mesh_list.h"

/** Areas that a surface was cut into (mesh_split.h) share corners, but no triangle, so that their border has teeth.
 * Here each corner of a border belongs to the area of most triangles round it, to the lower number of two; a triangle
 * whose corners are of two areas is cut along the middles of its edges, one of three areas at its centre, too. One with
 * no corner of its own area stays its own. So a border moves by at most half a triangle. Corners at one place have one
 * normal. Surfaces that are closed, and all where two triangles pass an edge the same way, stay as they are. Takes the
 * memory of the pieces off @p memory_left. */
conus_status mesh_borders_smooth(struct mesh_list *parts, const conus_atlas *atlas, uint64_t *memory_left);

#endif
