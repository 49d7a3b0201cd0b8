/* SPDX-License-Identifier: BSD-3-Clause */
/* Crossings of triangles with parallel lines, found triangle by triangle. */
#include "atlas/surface/mesh.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"

#include <stdbool.h>

void mesh_lines_finish(struct mesh_lines *lines)
{
    memory_free(lines->crossings);
    lines->crossings = NULL;
}

/* Lines first to last, exclusive, pass the triangle's bounds along axis a. */
static void find_range(size_t range[2], const struct mesh_lines *lines, double p[3][3], int a)
{
    double low = fmin(fmin(p[0][a], p[1][a]), p[2][a]);
    double high = fmax(fmax(p[0][a], p[1][a]), p[2][a]);
    double first = lines->step[a] > 0 ? ceil((low - lines->start[a]) / lines->step[a]) : 0;
    double last = lines->step[a] > 0 ? floor((high - lines->start[a]) / lines->step[a]) : -1;
    range[0] = (size_t)fmin(fmax(first, 0), (double)lines->count[a]);
    range[1] = (size_t)(fmax(fmin(last, (double)lines->count[a] - 1), -1) + 1);
}

static bool is_before(const double a[3], const double b[3])
{
    return a[0] < b[0] || (a[0] == b[0] && a[1] < b[1]);
}

/* Twice the signed area of the triangle a, b, (x, y) in the plane; of b, a exactly its negative. */
static double area_with(const double a[3], const double b[3], double x, double y)
{
    return is_before(b, a) ? -area_with(b, a, x, y) : (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

/* On which side of the edge from a to b the line is: 1 left, -1 right. A line on it is moved by a little in x and by
 * much less in y; it has no side only where the edge runs along z. */
static int side_of(const double a[3], const double b[3], double area)
{
    double decides = area != 0 ? area : a[1] != b[1] ? a[1] - b[1] : b[0] - a[0];
    return (decides > 0) - (decides < 0);
}

static bool add_crossing(struct mesh_lines *lines, uint32_t object, double p[3][3], size_t i, size_t j)
{
    double x = lines->start[0] + (double)i * lines->step[0];
    double y = lines->start[1] + (double)j * lines->step[1];
    double weights[3];
    int sides[3];
    for (int k = 0; k < 3; k++) {
        const double *from = p[(k + 1) % 3];
        const double *to = p[(k + 2) % 3];
        weights[k] = area_with(from, to, x, y);
        sides[k] = side_of(from, to, weights[k]);
    }
    double sum = weights[0] + weights[1] + weights[2];
    if (sides[0] == 0 || sides[0] != sides[1] || sides[1] != sides[2] || sum == 0) {
        return true;
    }
    bool fits =
        memory_reserve(&lines->crossings, &lines->capacity, lines->crossing_count + 1, sizeof *lines->crossings);
    if (fits) {
        double z = (weights[0] * p[0][2] + weights[1] * p[1][2] + weights[2] * p[2][2]) / sum;
        lines->crossings[lines->crossing_count++] =
            (struct line_crossing){i + lines->count[0] * j, object, sides[0] > 0 ? -1 : 1, z};
    }
    return fits;
}

conus_status mesh_lines_cross(struct mesh_lines *lines, uint32_t object, const struct mesh *mesh, size_t triangle,
                              const double *lines_from_mesh)
{
    double p[3][3];
    size_t range[2][2];
    bool fits = true;
    mesh_corners(p, mesh, triangle);
    for (int k = 0; lines_from_mesh && k < 3; k++) {
        mat4_point(p[k], lines_from_mesh, p[k]);
    }
    find_range(range[0], lines, p, 0);
    find_range(range[1], lines, p, 1);
    for (size_t j = range[1][0]; fits && j < range[1][1]; j++) {
        for (size_t i = range[0][0]; fits && i < range[0][1]; i++) {
            lines->pairs++;
            fits = add_crossing(lines, object, p, i, j);
        }
    }
    return fits ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static int compare_crossings(const void *a, const void *b)
{
    const struct line_crossing *x = a;
    const struct line_crossing *y = b;
    int order = compare_unsigned(x->line, y->line);
    order = order ? order : compare_unsigned(x->object, y->object);
    return order ? order : compare_double(x->z, y->z);
}

void mesh_lines_sort(struct mesh_lines *lines)
{
    order_sort(lines->crossings, lines->crossing_count, sizeof *lines->crossings, compare_crossings);
}
