/* SPDX-License-Identifier: BSD-3-Clause */
/* Cuts triangles along the borders of voxels, and adds up the volume between each piece and the floor of its column. */
#include "atlas/surface/mesh.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

enum { CORNERS = 12 }; /* a triangle between six planes has at most 9 */

struct polygon {
    double p[CORNERS][3];
    size_t count;
};

static void find_corner(double out[3], const struct mesh *mesh, size_t vertex, const double voxel_from_mesh[16])
{
    for (int a = 0; a < 3; a++) {
        out[a] = (double)mesh->positions[3 * vertex + (size_t)a];
    }
    mat4_point(out, voxel_from_mesh, out);
}

/* The part above `at` along an axis, or below it with side = -1. */
static struct polygon cut(const struct polygon *polygon, int axis, double at, double side)
{
    struct polygon out = {.count = 0};
    for (size_t i = 0; i < polygon->count; i++) {
        const double *from = polygon->p[i];
        const double *to = polygon->p[(i + 1) % polygon->count];
        double begins = side * (from[axis] - at);
        double ends = side * (to[axis] - at);
        if (begins >= 0 && out.count < CORNERS) {
            memcpy(out.p[out.count++], from, sizeof out.p[0]);
        }
        if ((begins < 0) != (ends < 0) && out.count < CORNERS) {
            double *x = out.p[out.count++];
            for (int a = 0; a < 3; a++) {
                x[a] = from[a] + (to[a] - from[a]) * (begins / (begins - ends));
            }
            x[axis] = at;
        }
    }
    return out;
}

static void find_bounds(double bounds[2], const struct polygon *polygon, int axis)
{
    bounds[0] = INFINITY;
    bounds[1] = -INFINITY;
    for (size_t i = 0; i < polygon->count; i++) {
        bounds[0] = fmin(bounds[0], polygon->p[i][axis]);
        bounds[1] = fmax(bounds[1], polygon->p[i][axis]);
    }
}

/* The part of a polygon in cell `cell` along an axis. */
static struct polygon in_cell(const struct polygon *polygon, int axis, size_t cell)
{
    struct polygon above = cut(polygon, axis, (double)cell - 0.5, 1);
    return cut(&above, axis, (double)cell + 0.5, -1);
}

/* The cells of the box that a polygon meets along an axis; first above last where it meets none. */
static void find_cells(size_t cells[2], const struct polygon *polygon, const struct voxel_box *box, int axis)
{
    double bounds[2];
    find_bounds(bounds, polygon, axis);
    bool meets = bounds[1] >= (double)box->low[axis] - 0.5 && bounds[0] <= (double)box->high[axis] + 0.5;
    cells[0] = 1, cells[1] = 0;
    if (meets) {
        cells[0] = (size_t)fmax(floor(bounds[0] + 0.5), (double)box->low[axis]);
        cells[1] = (size_t)fmin(floor(bounds[1] + 0.5), (double)box->high[axis]);
    }
}

/* Adds the volume under a piece in column (i, j): in its own voxel down to the floor, and all of each voxel below.
 * These take one number here and one below, since columns are summed from the top down later. */
static void add_piece(struct voxel_box *box, const struct polygon *piece, const size_t cell[3])
{
    double area = 0;   /* signed, of the piece in the plane of x and y, */
    double moment = 0; /* and its integral of z over that */
    size_t layer = box->count[0] * box->count[1];
    size_t k = cell[2] - box->low[2];
    double *at = box->inside + (cell[0] - box->low[0]) + box->count[0] * (cell[1] - box->low[1]) + layer * k;
    for (size_t i = 2; i < piece->count; i++) {
        const double *a = piece->p[0];
        const double *b = piece->p[i - 1];
        const double *c = piece->p[i];
        double part = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
        area += part;
        moment += part * (a[2] + b[2] + c[2]) / 3;
    }
    double under = moment - area * ((double)cell[2] - 0.5);
    *at += under;
    if (k > 0) {
        *(at - layer) += area - under;
    }
}

static void add_column(struct voxel_box *box, const struct polygon *polygon, size_t cell[3])
{
    size_t cells[2];
    double bounds[2];
    double ceiling = (double)box->high[2] + 0.5;
    find_cells(cells, polygon, box, 2);
    for (cell[2] = cells[0]; cell[2] <= cells[1]; cell[2]++) {
        struct polygon piece = in_cell(polygon, 2, cell[2]);
        add_piece(box, &piece, cell);
    }
    find_bounds(bounds, polygon, 2);
    if (bounds[1] >= ceiling) { /* as if it lay on the ceiling */
        struct polygon piece = cut(polygon, 2, ceiling, 1);
        for (size_t i = 0; i < piece.count; i++) {
            piece.p[i][2] = ceiling;
        }
        cell[2] = box->high[2];
        add_piece(box, &piece, cell);
    }
}

static void add_triangle(struct voxel_box *box, const struct polygon *triangle)
{
    size_t columns[2];
    size_t rows[2];
    size_t cell[3];
    find_cells(columns, triangle, box, 0);
    for (cell[0] = columns[0]; cell[0] <= columns[1]; cell[0]++) {
        struct polygon strip = in_cell(triangle, 0, cell[0]);
        find_cells(rows, &strip, box, 1);
        for (cell[1] = rows[0]; cell[1] <= rows[1]; cell[1]++) {
            struct polygon piece = in_cell(&strip, 1, cell[1]);
            add_column(box, &piece, cell);
        }
    }
}

/* Shrinks the box to the voxels that the mesh's bounds meet. False where there is none. */
static bool shrink(struct voxel_box *box, const struct mesh *mesh, const double voxel_from_mesh[16])
{
    struct box3 bounds = box3_empty();
    bool meets = true;
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        double p[3];
        find_corner(p, mesh, i, voxel_from_mesh);
        box3_add(&bounds, p);
    }
    for (int a = 0; a < 3; a++) {
        double first = fmax(floor(bounds.low[a] + 0.5), (double)box->low[a]);
        double last = fmin(floor(bounds.high[a] + 0.5), (double)box->high[a]);
        meets = meets && first <= last;
        box->low[a] = meets ? (size_t)first : 0;
        box->high[a] = meets ? (size_t)last : 0;
        box->count[a] = box->high[a] - box->low[a] + 1;
    }
    return meets;
}

conus_status mesh_voxels_measure(struct voxel_box *out, const struct mesh *mesh, const double voxel_from_mesh[16])
{
    struct voxel_box box = *out;
    size_t count;
    box.inside = NULL;
    if (shrink(&box, mesh, voxel_from_mesh)) {
        bool fits = memory_multiply(box.count[0], box.count[1], &count) && memory_multiply(count, box.count[2], &count);
        box.inside = fits ? memory_zeroed(count, sizeof *box.inside) : NULL;
        if (!box.inside) {
            return CONUS_ERROR_MEMORY;
        }
        for (size_t i = 0; i < mesh->triangle_count; i++) {
            struct polygon triangle = {.count = 3};
            for (size_t k = 0; k < 3; k++) {
                find_corner(triangle.p[k], mesh, mesh->triangles[3 * i + k], voxel_from_mesh);
            }
            add_triangle(&box, &triangle);
        }
        /* Sums columns from the top down, and makes volumes positive if the mesh faces inwards. */
        size_t layer = box.count[0] * box.count[1];
        double sum = 0;
        for (size_t i = count - layer; i-- > 0;) {
            box.inside[i] += box.inside[i + layer];
        }
        for (size_t i = 0; i < count; i++) {
            sum += box.inside[i];
        }
        for (size_t i = 0; sum < 0 && i < count; i++) {
            box.inside[i] = -box.inside[i];
        }
    }
    *out = box;
    return CONUS_OK;
}
