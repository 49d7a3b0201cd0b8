/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Triangulated surfaces in world space: parts of one, what is in it, how near it is, and a tree of boxes over
 * it. */
#ifndef CONUS_ATLAS_SURFACE_MESH_H
#define CONUS_ATLAS_SURFACE_MESH_H

#include "base/geometry/math3.h"
#include "base/status.h"
#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A triangulated surface in world space. */

/** The result of mesh_measure(). */
struct mesh_shape {
    double low[3], high[3]; /**< Bounds of the vertices that triangles use.                                  */
    double volume_mm3;      /**< Signed: positive where the triangles face outwards (divergence theorem).    */
    double centroid[3];     /**< That of the enclosed volume where closed, else of the surface.              */
    bool closed;            /**< mesh_is_closed(), triangles without area that were left out included.       */
    bool has_volume;        /**< Closed, and volume_mm3 is that of its inside: mesh_winds_once().            */
};

struct mesh {
    char *path;       /**< The file it came from; owned, NULL if none.                                 */
    float *positions; /**< [3 vertex_count] x, y, z in world mm (RAS); owned.                          */
    size_t vertex_count;
    uint32_t *triangles; /**< [3 triangle_count] vertex indices, counter-clockwise from outside; owned.   */
    size_t triangle_count;
    bool is_borrowed;        /**< The two arrays are not the mesh's own, not to be written, and 16 bytes behind each
                                  may be read.                                                                  */
    struct mesh_shape shape; /**< mesh_check() fills in `closed`, atlas_add_mesh() all of it. */
};

/** The corners of @p triangle. */
static inline void mesh_corners(double out[3][3], const struct mesh *mesh, size_t triangle)
{
    for (size_t k = 0; k < 3; k++) {
        const float *position = mesh->positions + 3 * (size_t)mesh->triangles[3 * triangle + k];
        for (int a = 0; a < 3; a++) {
            out[k][a] = (double)position[a];
        }
    }
}

void mesh_finish(struct mesh *mesh);

/** A mesh of zeroed arrays for so many vertices and triangles. */
conus_status mesh_init(struct mesh *out, size_t vertex_count, size_t triangle_count);

/** A copy of the vertices, triangles and shape. */
conus_status mesh_copy(struct mesh *out, const struct mesh *mesh);

/** Refuses meshes that no engine may get: no triangle, a coordinate that is not within 1e9 mm of 0, an index out of
 * range. Leaves out triangles without area and counts them in @p notes; notes a mesh that is not closed. */
conus_status mesh_check(struct mesh *mesh, struct notes *notes);

/** The part of mesh_check() that makes a mesh safe to use: numbers and indices. */
conus_status mesh_check_numbers(const struct mesh *mesh);

/** Bounds of the vertices that triangles of a checked mesh use. */
struct box3 mesh_box(const struct mesh *mesh);

/** Measures a checked mesh; keeps mesh->shape.closed. CONUS_ERROR_MEMORY without memory for edges or crossings. */
conus_status mesh_measure(struct mesh_shape *out, const struct mesh *mesh);

/** Distance along a ray to the plane of @p triangle, clamped to the triangle's range along the ray: for a ray that hits
 * it, or misses it by less than rounding. In units of @p direction's length. */
double mesh_distance(const struct mesh *mesh, size_t triangle, const double origin[3], const double direction[3]);

/** mesh_distance(), and in @p side where the ray comes from: 1 from the side that the triangle faces, -1 from the
 * other, 0 in the triangle's plane. */
double mesh_crossing(int *side, const struct mesh *mesh, size_t triangle, const double origin[3],
                     const double direction[3]);

/** Whether the line along a ray passes a triangle. Corners count by where they are: along each edge that two triangles
 * share the line passes one of them, and one of those round a corner, never none and never two (but where the surface
 * folds back). */
bool mesh_is_passed(const struct mesh *mesh, size_t triangle, const double origin[3], const double direction[3]);

/** Twice the area of @p triangle times its unit normal. */
void mesh_normal(double out[3], const struct mesh *mesh, size_t triangle);

/** Turns all triangles around. */
void mesh_turn(struct mesh *mesh);

/** Moves every vertex by @p world_from_mesh; turns triangles around where that mirrors. */
void mesh_transform(struct mesh *mesh, const double world_from_mesh[16]);

/* Whether a mesh bounds a solid. */

/** Whether triangles pass every edge as often in one direction as in the other. Vertices at equal positions are one,
 * and triangles without area count: leave none out before. Then the surface winds a whole number of times around every
 * point that is not on it. */
conus_status mesh_is_closed(bool *out, const struct mesh *mesh);

/** first[v], of each vertex v of @p mesh: the first vertex at the same position; -0 is 0. Only the vertices of @p mesh
 * are looked at. */
conus_status mesh_find_first(uint32_t *first, const struct mesh *mesh);

/** Whether the closed @p mesh winds once, everywhere in the same way, around what it encloses. It does not where two
 * parts overlap, or where one faces outwards and another inwards (a mirrored half, say): the signed volume then counts
 * some of the inside twice, or takes it away. Parts that face inwards are fine as cavities of others.
 *
 * Looked at along 64 x 64 lines through the bounds of @p shape. They may disagree on a hundredth of the inside, as
 * surfaces with small folds do. Also false for a mesh with more than 2^26 pairs of a line and a triangle near it. */
conus_status mesh_winds_once(bool *out, const struct mesh *mesh, const struct mesh_shape *shape);

/* How far a point is from a surface, and whether the surface is around it. */

/** Distance from @p point to the nearest point of any triangle, which @p out receives; INFINITY (and @p out untouched)
 * where that is more than @p limit. */
double mesh_nearest(double out[3], const struct mesh *mesh, const double point[3], double limit);

/** Distance from @p needle to @p triangle, 0 where it passes it (mesh_is_passed()). @p depth receives the least depth
 * at which it is so near, @p point the triangle's nearest point there. */
double mesh_needle(double *depth, double point[3], const struct mesh *mesh, size_t triangle,
                   const struct needle *needle);

/** How often the surface winds around @p point: 1 inside of a closed surface and 0 outside, between them near a hole in
 * one; negative where its triangles face inwards. The sum of the triangles' solid angles over 4 pi (van Oosterom and
 * Strackee 1983). */
double mesh_winding(const struct mesh *mesh, const double point[3]);

/* Where triangles cross the lines of a lattice that run along z. */

/** A place where a line passes through a triangle. */
struct line_crossing {
    size_t line;     /**< i + count[0] j                                                                        */
    uint32_t object; /**< The argument of mesh_lines_cross().                                                   */
    int32_t side;    /**< 1 where the line goes into what the triangle faces away from, -1 where it comes out. */
    double z;
};

/** Lines (i, j) at start + (i, j) step along x, y. The caller fills in the first three. */
struct mesh_lines {
    double start[2];
    double step[2]; /**< 0 = there is one place only, and no line. */
    size_t count[2];
    struct line_crossing *crossings; /**< Owned. */
    size_t crossing_count, capacity;
    size_t pairs; /**< Pairs of a line and a triangle whose bounds it passes, looked at so far. */
};

void mesh_lines_finish(struct mesh_lines *lines);

/** Appends the crossings of a triangle of @p mesh, whose vertices @p lines_from_mesh (NULL = the identity) moves. A
 * line that passes an edge or a corner counts as a little beside it, towards larger x and then larger y: of two
 * triangles on either side of an edge it passes one. So a closed surface is left as often as it is entered.
 * CONUS_ERROR_MEMORY. */
conus_status mesh_lines_cross(struct mesh_lines *lines, uint32_t object, const struct mesh *mesh, size_t triangle,
                              const double *lines_from_mesh);

/** Sorts the crossings by line, object, z. */
void mesh_lines_sort(struct mesh_lines *lines);

/* The fraction of each voxel that is inside a closed mesh (Eq. 16). */

/** Voxels whose index coordinates are from `low` to `high`, both among them. */
struct voxel_box {
    size_t low[3], high[3];
    size_t count[3];
    double *inside; /**< [count[2]][count[1]][count[0]] Parts of a voxel. Owned by the caller, memory_free(). */
};

/** Measures the inside of @p mesh, which winds once around it (mesh_winds_once()), in the voxels from @p out->low to @p
 * out->high that its bounds meet: sets the box to these, and `inside`, NULL if there are none. Exact but for rounding:
 * by the divergence theorem a sum over the pieces of triangles in each voxel. CONUS_ERROR_MEMORY. */
conus_status mesh_voxels_measure(struct voxel_box *out, const struct mesh *mesh, const double voxel_from_mesh[16]);

/* A scalp, with the positions of the 10-10 system (Eq. 35). */

typedef struct conus_scalp conus_scalp;

struct scalp_position {
    const char *name; /**< Static. */
    double point[3];
    double outward[3]; /**< Of length 1; 0 of landmarks. */
};

enum { SCALP_POSITIONS = 65 };

struct conus_scalp {
    struct mesh mesh;
    struct scalp_position at[SCALP_POSITIONS];
    size_t count;
};

/** Finds the positions on the checked @p mesh, from nasion, inion, left and right ear. Takes the mesh over, also on
 * failure. CONUS_ERROR_DATA for landmarks that are far from it, and where sections are no loops. */
conus_status scalp_make(conus_scalp *out, struct mesh *mesh, const double landmarks[4][3]);

/** The position of this name, in any case; NULL: there is none on a scalp. */
const struct scalp_position *scalp_find(const conus_scalp *scalp, struct text name);

/** The place @p mm from one position to another, and on, by the shorter way along the section through both that has the
 * mean of their normals in its plane; it has the name of @p from. CONUS_ERROR_ARGUMENT where both are one, where no way
 * is clearly the shorter, and for a way that is not above 0 and below half of the section. */
conus_status scalp_walk(struct scalp_position *out, const conus_scalp *scalp, const struct scalp_position *from,
                        const struct scalp_position *to, double mm);

/* A surface with a label at each vertex, cut into one surface per label. */

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

/* A bounding volume hierarchy: a tree of boxes along the axes, searched along rays and round needles. Every box is
 * taken to be a little larger than it is (BVH_SLACK), far more than rounding in double precision moves a ray. So a
 * triangle that mesh_is_passed() accepts lies in boxes that the ray hits. */

/** Relative to the largest coordinate of the boxes and of the ray's origin. */
#define BVH_SLACK 1e-6

/** Bounds, edges included. */
struct bvh_box {
    float low[3], high[3];
    uint32_t number; /**< The caller's number of the box. */
};

struct bvh_node;

/** A zeroed one is empty: a search finds nothing. */
struct bvh {
    struct bvh_node *nodes; /**< Each before those below it; the first one holds all. Owned. */
    uint32_t *numbers;      /**< [count] of the boxes, leaf by leaf. Owned.                  */
    size_t count;
};

/** Extends @p box to @p point. */
void bvh_box_extend(struct bvh_box *box, const float point[3]);

/** A box that holds nothing yet. */
struct bvh_box bvh_box_empty(uint32_t number);

/** The box round @p count boxes, with number 0. */
struct bvh_box bvh_box_around(const struct bvh_box *boxes, size_t count);

/** The longest axis, 0 to 2; of equally long ones the first. */
int bvh_box_longest_axis(const struct bvh_box *box);

/** Reorders boxes: those with the lower middles along @p axis come before boxes[half]; half is below count. */
void bvh_halve(struct bvh_box *boxes, size_t count, size_t half, int axis);

/** Makes a tree of @p count boxes, at most UINT32_MAX, and reorders them. The same boxes in the same order give the
 * same tree. CONUS_ERROR_MEMORY. */
conus_status bvh_init(struct bvh *out, struct bvh_box *boxes, size_t count);
void bvh_finish(struct bvh *bvh);

/** Nodes on the stack of a search: each step down leaves one behind, and halving UINT32_MAX boxes takes 32 steps. */
enum { BVH_DEPTH = 33 };

/** A search on its way. */
struct bvh_search {
    const struct bvh *bvh;
    const struct needle_frame *needle; /**< Round which it goes; NULL: along a ray. */
    double origin[3];
    double inverse[3]; /**< 1 / direction; infinite where that is 0. */
    double slack;
    size_t next, end; /**< The rest of a leaf, in bvh->numbers. */
    struct bvh_visit {
        double enter; /**< Where the ray enters the node's box, or how far the needle is from it. */
        uint32_t node;
    } visits[BVH_DEPTH]; /**< A stack of nodes to visit. */
    size_t waiting;
};

/** Begins a search along a ray from @p origin; both arrays are copied, @p bvh must outlive the search. */
void bvh_search_init(struct bvh_search *out, const struct bvh *bvh, const double origin[3], const double direction[3]);

/** Begins a search round @p needle, in the frame of the boxes; both must outlive the search. Boxes are as they are. */
void bvh_search_round(struct bvh_search *out, const struct bvh *bvh, const struct needle_frame *needle);

/** The next number, approximately from near to far, whose leaf the ray hits at @p limit (in units of the direction's
 * length) or before, or is no farther from the needle than that, mm; false after the last. The limit may shrink from
 * call to call. The ray may miss the number's own box. */
bool bvh_search_next(uint32_t *number, struct bvh_search *search, double limit);

#endif
