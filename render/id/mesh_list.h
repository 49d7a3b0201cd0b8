/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The meshes of an atlas and the surfaces around its areas, whose numbers follow those of the objects, as
 * pictures draw them: in one list of corners and one of triangles. Needs no GL. */
#ifndef CONUS_RENDER_ID_MESH_LIST_H
#define CONUS_RENDER_ID_MESH_LIST_H

#include "atlas/atlas.h"
#include "render/gl/camera.h"
#include "render/gl/listener.h"

struct mesh_vertex {
    float position[3], normal[3]; /**< World mm; the sum of its triangles' normals, each as long as twice its area. */
    uint32_t object;
};

/** The triangles of an object or surface. */
struct mesh_entry {
    size_t first, count; /**< Indices; 0 where it is no mesh. */
    bool is_shown;       /**< It is there, and not hidden. */
};

struct mesh_list {
    struct mesh_vertex *vertices; /**< [vertex_count] */
    size_t vertex_count;
    uint32_t *indices; /**< [index_count] Three a triangle. */
    size_t index_count;
    struct mesh_entry *parts; /**< [part_count] Part i is that of number i + 1. */
    size_t part_count;
    float (
        *values)[2]; /**< [vertex_count] Of a map: the part of its range, and 1; 0 and 0 without one. NULL = no map. */
    uint32_t mapped; /**< Number of the surface that has a map; 0 = none. */
};

/** Takes the size of the lists off @p memory_left. CONUS_ERROR_MEMORY above that. */
conus_status mesh_list_init(struct mesh_list *out, const conus_atlas *atlas, uint64_t *memory_left);
/** Frees the lists of vertices and triangles, and leaves the parts. */
void mesh_list_drop(struct mesh_list *parts);
void mesh_list_finish(struct mesh_list *parts);

/** Updates the hidden meshes. */
void mesh_list_show(struct mesh_list *parts, const conus_atlas *atlas);

/** Whether a picture shows the part, with others that are translucent or with those that are not. @p opacity is by
 * number; NULL = all 1. */
bool mesh_list_draws(const struct mesh_list *parts, size_t part, const float *opacity, bool translucent);

enum { MESH_LAYER_PEELS = 8 }; /* Layers of translucent meshes at a pixel, at most. */

/** A picture of meshes and streamlines. */
struct mesh_layer_view {
    const struct camera *camera;
    uint32_t width, height;
    double shift[2];                  /**< From pixel centres to rays, in pixels, right and up. */
    const float *opacity;             /**< By mesh, from 0 on; NULL = all 1. A mesh of opacity 0 is not drawn. */
    double draft;                     /**< mm; fewer streamlines, at least so wide: see tube_layer.h. 0 = all. */
    struct picture_listener listener; /**< Hears of pieces of streamlines. */
};

/** What takes a place relative to the eye to the picture: right and up in halves of it, times the depth; the depth. */
void mesh_camera_rows(double rows[9], const struct camera *camera);

/** The inverse, by columns: from (x, y, 1) in the picture to the place of its ray at depth 1. */
void mesh_camera_columns(double columns[9], const double rows[9]);

#endif
