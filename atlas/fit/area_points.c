/* SPDX-License-Identifier: BSD-3-Clause */
/* Samples points of areas: every n-th voxel or vertex. */
#include "atlas/fit/fit.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

/* Points are counted first, and then taken. */
struct taking {
    struct area_points points; /* without an array while it is counted */
    size_t seen, step;
    size_t left; /* to pass over before the next one is taken */
};

/* Whether the next point is taken: of most, nobody asks where they are. */
static bool is_taken(struct taking *taking)
{
    bool is = taking->points.at && taking->left == 0;
    taking->left = is ? taking->step - 1 : taking->left - 1;
    taking->seen++;
    return is;
}

static void take(struct taking *taking, const double point[3])
{
    memcpy(taking->points.at + 3 * taking->points.count++, point, 3 * sizeof *point);
}

static void take_voxel(struct taking *taking, const struct volume *volume, size_t voxel)
{
    double point[3];
    grid_index(point, volume->info.dim, voxel);
    mat4_point(point, volume->info.world_from_voxel, point);
    take(taking, point);
}

static void take_all(struct taking *taking, const conus_atlas *atlas)
{
    taking->seen = 0;
    taking->left = 0;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (atlas_volume_has_areas(&atlas->volumes[i])) {
            const struct volume *volume = &atlas->volumes[i];
            for (size_t v = volume_next(volume, 0); v < volume->voxel_count; v = volume_next(volume, v)) {
                const size_t end = v - v % VALUE_RUN + VALUE_RUN;
                for (; v < end && v < volume->voxel_count; v++) {
                    if (volume_object(volume, v) && is_taken(taking)) {
                        take_voxel(taking, volume, v);
                    }
                }
            }
        }
    }
    bool has_voxels = taking->seen > 0;
    for (uint32_t number = 1; !has_voxels && number <= atlas->area_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        if (mesh) {
            for (size_t i = 0; i < mesh->vertex_count; i++) {
                const float *at = mesh->positions + 3 * i;
                if (is_taken(taking)) {
                    take(taking, (const double[]){(double)at[0], (double)at[1], (double)at[2]});
                }
            }
        }
    }
}

conus_status area_points_make(struct area_points *out, const conus_atlas *atlas)
{
    struct taking taking = {0};
    take_all(&taking, atlas);
    taking.step = 1 + taking.seen / AREA_POINTS;
    taking.points.at = memory_zeroed(taking.seen / taking.step + 1, 3 * sizeof *taking.points.at);
    if (!taking.points.at) {
        return CONUS_ERROR_MEMORY;
    }
    take_all(&taking, atlas);
    *out = taking.points;
    return CONUS_OK;
}

void area_points_finish(struct area_points *points)
{
    memory_free(points->at);
    *points = (struct area_points){0};
}

void area_points_centre(double out[3], const struct area_points *points)
{
    double sum[3] = {0};
    for (size_t i = 0; i < points->count; i++) {
        vec3_add_scaled(sum, sum, 1, points->at + 3 * i);
    }
    vec3_scale(out, sum, 1 / (double)points->count);
}
