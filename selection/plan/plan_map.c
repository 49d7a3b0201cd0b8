/* SPDX-License-Identifier: BSD-3-Clause */
/* Distances of voxel centres from cells: along one axis after the other, since the cells are boxes. */
#include "selection/plan/plan.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/measure/measure.h"

#include <math.h>
#include <string.h>

enum {
    FARTHEST = UINT8_MAX, /* so many units, or more */
    UNITS = 8,            /* of the shortest edge of a voxel */
    VOXEL_LIMIT = 1 << 24
};
static const double ALONG = 1e-5;    /* mm per mm of an axis's voxels: less of it may be along their faces */
static const double ROUNDING = 1e-4; /* a part of a distance: more than single precision and this code lose */

struct plan_map {
    const struct volume *volume;
    double scale[3]; /* mm of a voxel */
    double unit;     /* mm */
    double step;     /* mm: so finely a needle is looked at, at least */
    bool outside;
    long first[3]; /* voxel of the atlas's grid, or beyond it */
    size_t count[3];
    uint8_t units[]; /* the distance, rounded down */
};

/* Lets each value of a line of `count`, one for each `inner` numbers, be the least of any plus the squared distance. */
static void spread(float *restrict out, const float *restrict in, const size_t count[3], int axis, double scale,
                   long farthest)
{
    size_t inner = axis == 0 ? 1 : axis == 1 ? count[0] : count[0] * count[1];
    size_t line = inner * count[axis];
    size_t total = count[0] * count[1] * count[2];
    memcpy(out, in, total * sizeof *out);
    for (size_t first = 0; first < total; first += line) {
        for (long shift = 1; shift <= farthest && (size_t)shift < count[axis]; shift++) {
            float more = (float)(((double)shift - 0.5) * scale * ((double)shift - 0.5) * scale);
            size_t by = (size_t)shift * inner;
            for (size_t i = first + by; i < first + line; i++) {
                float square = in[i - by] + more;
                out[i] = square < out[i] ? square : out[i];
            }
            for (size_t i = first; i < first + line - by; i++) {
                float square = in[i + by] + more;
                out[i] = square < out[i] ? square : out[i];
            }
        }
    }
}

/* 0 in the cells from which distances are, else as far as nothing is. */
static void mark(float *out, const struct plan_map *map, const uint32_t *has, bool outside)
{
    const size_t *dim = map->volume->info.dim;
    for (size_t k = 0; k < map->count[2]; k++) {
        for (size_t j = 0; j < map->count[1]; j++) {
            for (size_t i = 0; i < map->count[0]; i++) {
                size_t at[3] = {i + (size_t)map->first[0], j + (size_t)map->first[1], k + (size_t)map->first[2]};
                bool is_there = at[0] < dim[0] && at[1] < dim[1] && at[2] < dim[2] && /* below 0 it is beyond all */
                                has[volume_object(map->volume, at[0] + dim[0] * (at[1] + dim[1] * at[2]))];
                *out++ = is_there != outside ? 0 : INFINITY;
            }
        }
    }
}

/* The first and the last voxel of the objects, along each axis. */
static void find_box(long first[3], long last[3], const struct clearance_index *index, const conus_atlas *atlas,
                     const struct volume *volume, const uint32_t *has)
{
    for (int a = 0; a < 3; a++) {
        first[a] = INT32_MAX;
        last[a] = 0;
    }
    for (size_t i = 0; i < index->brick_count; i++) {
        const struct clearance_brick *brick = &index->bricks[i];
        if (has[brick->object] && atlas_object_volume(atlas, brick->object) == volume) {
            for (int a = 0; a < 3; a++) {
                first[a] = first[a] < (long)brick->first[a] ? first[a] : (long)brick->first[a];
                last[a] = last[a] > (long)brick->last[a] ? last[a] : (long)brick->last[a];
            }
        }
    }
}

conus_status plan_map_create(struct plan_map **out, const struct clearance_index *index, const conus_atlas *atlas,
                             const struct volume *volume, const uint32_t *has, bool outside)
{
    struct plan_map shape = {.volume = volume, .outside = outside};
    struct near_cells cells;
    long last[3];
    long farthest[3];
    double total = 1;
    near_cells_init(&cells, volume);
    *out = NULL;
    find_box(shape.first, last, index, atlas, volume, has);
    for (int a = 0; a < 3; a++) {
        shape.scale[a] = sqrt(cells.gram[a][a]);
        double skew = cells.gram[a][(a + 1) % 3] / shape.scale[a];
        if (fabs(skew) > 1e-7 * sqrt(cells.gram[(a + 1) % 3][(a + 1) % 3])) {
            return CONUS_OK;
        }
        shape.step = a == 0 ? shape.scale[0] : fmin(shape.step, shape.scale[a]);
    }
    shape.unit = shape.step / UNITS;
    shape.step *= 0.25;
    for (int a = 0; a < 3; a++) {
        farthest[a] = (long)ceil(FARTHEST * shape.unit / shape.scale[a]) + 1;
        long wider = outside ? 1 : farthest[a];
        shape.first[a] -= wider;
        shape.count[a] = (size_t)(last[a] + wider - shape.first[a] + 1);
        total *= (double)shape.count[a];
    }
    if (total > VOXEL_LIMIT) {
        return CONUS_OK;
    }
    size_t count = (size_t)total;
    struct plan_map *map = memory_raw(1, sizeof *map + count);
    float *squares = memory_raw(2 * count, sizeof *squares);
    if (map && squares) {
        *map = shape;
        mark(squares, map, has, outside);
        spread(squares + count, squares, map->count, 0, map->scale[0], farthest[0]);
        spread(squares, squares + count, map->count, 1, map->scale[1], farthest[1]);
        spread(squares + count, squares, map->count, 2, map->scale[2], farthest[2]);
        for (size_t i = 0; i < count; i++) {
            double units = sqrt((double)squares[count + i]) / map->unit * (1 - ROUNDING);
            map->units[i] = units < FARTHEST ? (uint8_t)units : FARTHEST;
        }
    }
    memory_free(squares);
    *out = squares ? map : NULL;
    if (!squares) {
        memory_free(map);
    }
    return *out ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void plan_map_destroy(struct plan_map *map)
{
    memory_free(map);
}

void plan_map_bounds(double bounds[2], const struct plan_map *map, const double at[3])
{
    size_t voxel = 0;
    size_t stride = 1;
    double square = 0;                            /* of the way from the voxel's centre */
    unsigned units = map->outside ? 0 : FARTHEST; /* beyond the map */
    bool is_in = true;
    for (int a = 0; a < 3; a++) {
        double index = floor(at[a] + 0.5);
        double away = (at[a] - index) * map->scale[a];
        index -= (double)map->first[a];
        is_in = is_in && index >= 0 && index < (double)map->count[a];
        voxel += is_in ? stride * (size_t)index : 0;
        stride *= map->count[a];
        square += away * away;
    }
    if (is_in) {
        units = map->units[voxel];
    }
    double away = sqrt(square) + ROUNDING * map->unit;
    bounds[0] = units * map->unit - away;
    bounds[1] = units < FARTHEST ? (units + 1) * map->unit * (1 + 4 * ROUNDING) + away : INFINITY;
}

/* The needle's line in voxels. */
struct line {
    double at[3], step[3];
};

static struct line line_of(const struct plan_map *map, const struct needle *needle)
{
    struct line line;
    mat4_point(line.at, map->volume->voxel_from_world, needle->origin);
    mat4_direction(line.step, map->volume->voxel_from_world, needle->direction);
    return line;
}

static void bounds_at(double bounds[2], const struct plan_map *map, const struct line *line, double depth)
{
    double at[3];
    vec3_add_scaled(at, line->at, depth, line->step);
    plan_map_bounds(bounds, map, at);
}

int plan_map_is_farther(const struct plan_map *map, const struct needle *needle, double distance)
{
    const struct line line = line_of(map, needle);
    bool is_certain = true;
    double t = needle->near;
    for (bool is_last = false; !is_last;) {
        double bounds[2];
        is_last = t >= needle->far;
        bounds_at(bounds, map, &line, is_last ? needle->far : t);
        if (bounds[1] < distance) {
            return -1;
        }
        double free = bounds[0] - distance; /* so far along nothing is nearer than the distance */
        bool is_free = free >= map->unit;
        is_certain = is_certain && is_free;
        t += is_free ? free : map->step;
    }
    return is_certain;
}

/* Finds the part of the needle inside the map; false where there is none. */
static bool clip(double part[2], const struct plan_map *map, const struct line *line)
{
    for (int a = 0; a < 3; a++) {
        double low = ((double)map->first[a] - 0.5 - line->at[a]) / line->step[a];
        double high = low + (double)map->count[a] / line->step[a];
        part[0] = fmax(part[0], fmin(low, high));
        part[1] = fmin(part[1], fmax(low, high));
    }
    return part[0] < part[1];
}

double plan_map_inside(const struct plan_map *map, const struct needle *needle)
{
    const struct line line = line_of(map, needle);
    double part[2] = {needle->near, needle->far};
    long cell[3];
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        if (fabs(line.step[a] * map->scale[a]) < ALONG) {
            return NAN;
        }
    }
    if (!clip(part, map, &line)) {
        return -INFINITY;
    }
    for (int a = 0; a < 3; a++) {
        double index = floor(line.at[a] + part[0] * line.step[a] + 0.5) - (double)map->first[a];
        cell[a] = (long)fmin(fmax(index, 0), (double)map->count[a] - 1);
    }
    for (double t = part[0]; t < part[1];) {
        size_t voxel = (size_t)cell[0] + map->count[0] * ((size_t)cell[1] + map->count[1] * (size_t)cell[2]);
        double next = part[1];
        int axis = -1;
        for (int a = 0; a < 3; a++) {
            double face = (double)(cell[a] + map->first[a]) + (line.step[a] > 0 ? 0.5 : -0.5);
            double crossing = (face - line.at[a]) / line.step[a];
            axis = crossing < next ? a : axis;
            next = crossing < next ? crossing : next;
        }
        sum += map->units[voxel] ? fmax(next - t, 0) : 0;
        t = fmax(next, t);
        if (axis >= 0) {
            cell[axis] += line.step[axis] > 0 ? 1 : -1;
            t = cell[axis] < 0 || cell[axis] >= (long)map->count[axis] ? part[1] : t;
        }
    }
    return sum;
}

double plan_map_most(const struct plan_map *map, const struct needle *needle, double from, double to, double distance)
{
    const struct line line = line_of(map, needle);
    double sum = 0;
    while (from < to) {
        double bounds[2];
        double half = fmin(map->step, to - from) / 2;
        bounds_at(bounds, map, &line, from + half);
        double free = distance - bounds[1]; /* so far along nothing is the distance away */
        sum += free > half ? 0 : 2 * half;
        from += fmax(half + free, 2 * half);
    }
    return sum * (1 + ROUNDING);
}
