/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the area that holds a point, else the nearest one (Eq. 20). */
#include "selection/connectivity/connectivity.h"

#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/engine/voxels/distance_map.h"

#include <stdlib.h>

/* A volume's cells, where there are areas. */
struct area_cells {
    struct near_cells cells;
    double step[3]; /* between neighbouring planes of cells, mm */
    double least;   /* of these */
    int64_t first[3], last[3];
    struct distance_map map; /* no codes: look at every voxel */
};

/* The nearest area so far. */
struct nearest {
    uint32_t area;
    double distance; /* the radius where there is none */
};

static void take(struct nearest *nearest, uint32_t area, double distance)
{
    if (distance < nearest->distance || (distance == nearest->distance && (!nearest->area || area < nearest->area))) {
        *nearest = (struct nearest){area, distance};
    }
}

conus_status area_search_init(struct area_search *out, const conus_atlas *atlas, double radius, size_t points)
{
    enum { FEW = 1 << 16 }; /* a map takes about as long as this many points */
    struct area_cells *cells = memory_zeroed(atlas->volume_count, sizeof *cells);
    struct area_search search = {.atlas = atlas, .radius = radius, .cells = cells};
    conus_status status = cells ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < atlas->volume_count && !status; i++) {
        const struct volume *volume = &atlas->volumes[i];
        if (!atlas_volume_has_areas(volume)) {
            continue;
        }
        const double *m = volume->voxel_from_world;
        bool has_box = volume_is_scalar(volume);
        bool is_empty = has_box && volume->box.first[0] > volume->box.last[0];
        near_cells_init(&cells[i].cells, volume);
        cells[i].least = INFINITY;
        for (int a = 0; a < 3; a++) {
            const double row[3] = {m[a], m[4 + a], m[8 + a]};
            cells[i].step[a] = 1 / vec3_length(row);
            cells[i].least = fmin(cells[i].least, cells[i].step[a]);
            cells[i].first[a] = has_box && !is_empty ? (int64_t)volume->box.first[a] : 0;
            cells[i].last[a] = is_empty  ? -1
                               : has_box ? (int64_t)volume->box.last[a]
                                         : (int64_t)volume->info.dim[a] - 1;
        }
        if (radius > 0 && (points >= FEW || volume->distances)) {
            status = distance_map_init(&cells[i].map, volume);
        }
    }
    if (status) {
        area_search_finish(&search);
        return status;
    }
    *out = search;
    return CONUS_OK;
}

void area_search_finish(struct area_search *search)
{
    for (size_t i = 0; search->cells && i < search->atlas->volume_count; i++) {
        distance_map_finish(&search->cells[i].map);
    }
    memory_free(search->cells);
    *search = (struct area_search){0};
}

/* The first grid that has an area there; else the most probable area. */
static uint32_t find_in_volumes(const conus_atlas *atlas, const double point[3])
{
    struct nearest likely = {.distance = 0}; /* by minus its probability */
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        size_t voxel;
        uint32_t area = atlas_volume_has_areas(volume) && volume_find_voxel(&voxel, volume, point)
                            ? volume_object(volume, voxel)
                            : 0;
        if (area && !volume_is_scalar(volume)) {
            return area;
        }
        if (area) {
            take(&likely, area, -(double)volume_value(volume, voxel));
        }
    }
    return likely.area;
}

/* How far the box round a mesh is. */
static double bounds_distance(const struct mesh *mesh, const double point[3])
{
    double gap[3];
    for (int a = 0; a < 3; a++) {
        gap[a] = fmax(0, fmax(mesh->shape.low[a] - point[a], point[a] - mesh->shape.high[a]));
    }
    return vec3_length(gap);
}

static uint32_t find_in_meshes(const conus_atlas *atlas, const double point[3])
{
    for (uint32_t area = 1; atlas->mesh_count && area <= atlas->area_count; area++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, area);
        if (mesh && bounds_distance(mesh, point) == 0 && fabs(mesh_winding(mesh, point)) >= 0.5) {
            return area;
        }
    }
    return 0;
}

/* A point among the cells of a volume. */
struct looking {
    const struct volume *volume;
    struct area_cells *of;
    double at[3];      /* the point, in voxels */
    int64_t middle[3]; /* the voxel whose cell holds it, or would */
    struct nearest *nearest;
};

static void look_at(const struct looking *looking, const int64_t voxel[3])
{
    const size_t *dim = looking->volume->info.dim;
    size_t index = (size_t)voxel[0] + dim[0] * ((size_t)voxel[1] + dim[1] * (size_t)voxel[2]);
    uint32_t area = volume_object(looking->volume, index);
    if (area) {
        const double cell[3] = {(double)voxel[0], (double)voxel[1], (double)voxel[2]};
        double offset[3];
        take(looking->nearest, area,
             near_cell(offset, &looking->of->cells, cell, looking->at, looking->nearest->distance));
    }
}

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static int64_t smaller(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/* The voxels of a row from `low` to `high`, every so many. */
static void look_at_row(const struct looking *looking, int64_t j, int64_t k, int64_t low, int64_t high, int64_t step)
{
    const struct area_cells *of = looking->of;
    low = step == 1 ? larger(low, of->first[0]) : low;
    for (int64_t i = low; i <= smaller(high, of->last[0]); i += step) {
        if (i >= of->first[0]) {
            look_at(looking, (const int64_t[]){i, j, k});
        }
    }
}

/* Whether the cells of a plane across an axis are farther than the nearest area so far. */
static bool is_far(const struct looking *looking, int axis, int64_t plane)
{
    double gap = (fabs((double)plane - looking->at[axis]) - 0.5) * looking->of->step[axis];
    return gap * (1 - 1e-9) > looking->nearest->distance;
}

/* The voxels that are `ring` rows away from the middle along some axis and no more along any, as far as there are
 * areas. */
static void look_at_ring(const struct looking *looking, int64_t ring)
{
    const struct area_cells *of = looking->of;
    const int64_t *middle = looking->middle;
    for (int64_t k = larger(middle[2] - ring, of->first[2]); k <= smaller(middle[2] + ring, of->last[2]); k++) {
        for (int64_t j = larger(middle[1] - ring, of->first[1]);
             j <= smaller(middle[1] + ring, of->last[1]) && !is_far(looking, 2, k); j++) {
            bool whole = llabs(k - middle[2]) == ring || llabs(j - middle[1]) == ring;
            if (!is_far(looking, 1, j)) {
                look_at_row(looking, j, k, middle[0] - ring, middle[0] + ring, whole ? 1 : 2 * ring);
            }
        }
    }
}

/* How many rows the nearest voxel of an area is away from the middle, or fewer; the middle is where areas are. */
static int64_t empty_rings(const struct looking *looking)
{
    const struct distance_map *map = &looking->of->map;
    const int64_t *middle = looking->middle;
    return map->codes ? map->codes[distance_map_at(map, (size_t)middle[0], (size_t)middle[1], (size_t)middle[2])] : 0;
}

/* From the inside out. The cells of a ring are ring - 1 steps away or more. */
static void look_in_volume(struct nearest *nearest, const struct volume *volume, struct area_cells *of,
                           const double point[3])
{
    struct looking looking = {.volume = volume, .of = of, .nearest = nearest};
    int64_t ring = 0;
    mat4_point(looking.at, volume->voxel_from_world, point);
    for (int a = 0; a < 3; a++) {
        looking.middle[a] = (int64_t)floor(looking.at[a] + 0.5);
        int64_t away =
            of->first[a] > looking.middle[a] ? of->first[a] - looking.middle[a] : looking.middle[a] - of->last[a];
        ring = away > ring ? away : ring;
    }
    ring = ring ? ring : empty_rings(&looking);
    for (; (double)(ring - 1) * of->least * (1 - 1e-9) <= nearest->distance; ring++) {
        look_at_ring(&looking, ring);
    }
}

static uint32_t find_near(const struct area_search *search, const double point[3])
{
    const conus_atlas *atlas = search->atlas;
    struct nearest nearest = {.distance = search->radius};
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (atlas_volume_has_areas(&atlas->volumes[i])) {
            look_in_volume(&nearest, &atlas->volumes[i], &search->cells[i], point);
        }
    }
    for (uint32_t area = 1; atlas->mesh_count && area <= atlas->area_count; area++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, area);
        double foot[3];
        if (mesh && bounds_distance(mesh, point) <= nearest.distance) {
            take(&nearest, area, mesh_nearest(foot, mesh, point, nearest.distance));
        }
    }
    return nearest.area;
}

uint32_t area_at(const struct area_search *search, const double point[3])
{
    uint32_t area = find_in_volumes(search->atlas, point);
    area = area ? area : find_in_meshes(search->atlas, point);
    return area || !(search->radius > 0) ? area : find_near(search, point);
}
