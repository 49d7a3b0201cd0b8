/* SPDX-License-Identifier: BSD-3-Clause */
/* How often a closed mesh winds around what it encloses, along lines in z. */
#include "atlas/surface/mesh_winding.h"

#include "base/memory.h"
#include "base/order.h"

#include <math.h>
#include <stdlib.h>

enum { LINES = 64, PAIR_LIMIT = 1 << 26 };

struct crossing {
    double z;
    uint32_t line; /* i + LINES j */
    int32_t side;  /* 1 where the line goes into what the triangle faces away from, -1 where it comes out */
};

struct lines {
    const struct mesh *mesh;
    double start[2], step[2]; /* line i is at start + i step along x, y */
    struct crossing *crossings;
    size_t count, capacity;
    size_t pairs; /* of a line and a triangle whose bounds it passes */
};

/* Lines lie off the middle of their cells, since vertices of many meshes are at round numbers. */
static void place_lines(struct lines *lines, const struct mesh_shape *shape)
{
    static const double off_middle[2] = {0.4878911, 0.5127683};
    for (int a = 0; a < 2; a++) {
        lines->step[a] = (shape->high[a] - shape->low[a]) / LINES;
        lines->start[a] = shape->low[a] + off_middle[a] * lines->step[a];
    }
}

/* Lines first to last, exclusive, pass the triangle's bounds along axis a. */
static void find_range(int range[2], const struct lines *lines, double p[3][3], int a)
{
    double low = fmin(fmin(p[0][a], p[1][a]), p[2][a]);
    double high = fmax(fmax(p[0][a], p[1][a]), p[2][a]);
    double first = lines->step[a] > 0 ? ceil((low - lines->start[a]) / lines->step[a]) : 0;
    double last = lines->step[a] > 0 ? floor((high - lines->start[a]) / lines->step[a]) : -1;
    range[0] = (int)fmax(first, 0);
    range[1] = (int)fmin(last, LINES - 1) + 1;
}

/* Twice the signed area of the triangle a, b, (x, y) in the plane. */
static double area_with(const double a[3], const double b[3], double x, double y)
{
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

static bool add_crossing(struct lines *lines, double p[3][3], int i, int j)
{
    double x = lines->start[0] + i * lines->step[0];
    double y = lines->start[1] + j * lines->step[1];
    double weights[3] = {area_with(p[1], p[2], x, y), area_with(p[2], p[0], x, y), area_with(p[0], p[1], x, y)};
    bool upwards = weights[0] > 0 && weights[1] > 0 && weights[2] > 0;
    if (!upwards && !(weights[0] < 0 && weights[1] < 0 && weights[2] < 0)) {
        return true;
    }
    bool fits = memory_reserve(&lines->crossings, &lines->capacity, lines->count + 1, sizeof *lines->crossings);
    if (fits) {
        double sum = weights[0] + weights[1] + weights[2];
        double z = (weights[0] * p[0][2] + weights[1] * p[1][2] + weights[2] * p[2][2]) / sum;
        lines->crossings[lines->count++] = (struct crossing){z, (uint32_t)(i + LINES * j), upwards ? -1 : 1};
    }
    return fits;
}

static conus_status cross_triangle(struct lines *lines, size_t triangle)
{
    double p[3][3];
    int range[2][2];
    bool fits = true;
    for (int k = 0; k < 3; k++) {
        const float *position = &lines->mesh->positions[3 * (size_t)lines->mesh->triangles[3 * triangle + (size_t)k]];
        for (int a = 0; a < 3; a++) {
            p[k][a] = (double)position[a];
        }
    }
    find_range(range[0], lines, p, 0);
    find_range(range[1], lines, p, 1);
    for (int j = range[1][0]; fits && j < range[1][1]; j++) {
        for (int i = range[0][0]; fits && i < range[0][1]; i++) {
            lines->pairs++;
            fits = add_crossing(lines, p, i, j);
        }
    }
    return fits ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static int compare_crossings(const void *a, const void *b)
{
    const struct crossing *x = a;
    const struct crossing *y = b;
    int order = compare_unsigned(x->line, y->line);
    return order ? order : compare_double(x->z, y->z);
}

/* The length inside, winding not 0, and that of it around which the mesh does not wind `facing` times. */
static void sum_lengths(double *inside, double *wrong, const struct lines *lines, int facing)
{
    int winding = 0;
    for (size_t i = 0; i + 1 < lines->count; i++) {
        const struct crossing *here = &lines->crossings[i];
        bool ends = here[1].line != here->line;
        winding = ends ? 0 : winding + here->side;
        if (winding != 0) {
            *inside += here[1].z - here->z;
            *wrong += winding != facing ? here[1].z - here->z : 0;
        }
    }
}

conus_status mesh_winds_once(bool *out, const struct mesh *mesh, const struct mesh_shape *shape)
{
    static const double tolerance = 1e-2;
    struct lines lines = {.mesh = mesh};
    double inside = 0;
    double wrong = 0;
    conus_status status = CONUS_OK;
    place_lines(&lines, shape);
    for (size_t i = 0; !status && lines.pairs <= PAIR_LIMIT && i < mesh->triangle_count; i++) {
        status = cross_triangle(&lines, i);
    }
    if (!status) {
        if (lines.count > 1) {
            qsort(lines.crossings, lines.count, sizeof *lines.crossings, compare_crossings);
        }
        sum_lengths(&inside, &wrong, &lines, shape->volume_mm3 < 0 ? -1 : 1);
        *out = lines.pairs <= PAIR_LIMIT && wrong <= tolerance * inside;
    }
    memory_free(lines.crossings);
    return status;
}
