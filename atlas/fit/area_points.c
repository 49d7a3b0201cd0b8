/* SPDX-License-Identifier: BSD-3-Clause */
/* Samples points of areas: every n-th voxel or vertex. */
#include "atlas/fit/area_points.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

/* Points are counted first, and then taken. */
struct taking {
    struct area_points points; /* without an array while it is counted */
    size_t seen, step;
};

static void take(struct taking *taking, const double point[3])
{
    if (taking->points.at && taking->seen % taking->step == 0) {
        memcpy(taking->points.at + 3 * taking->points.count++, point, 3 * sizeof *point);
    }
    taking->seen++;
}

static void take_all(struct taking *taking, const conus_atlas *atlas)
{
    taking->seen = 0;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (atlas_volume_has_areas(&atlas->volumes[i])) {
            const size_t *dim = atlas->volumes[i].info.dim;
            const struct volume *volume = &atlas->volumes[i];
            for (size_t v = volume_next(volume, 0); v < volume->voxel_count; v = volume_next(volume, v + 1)) {
                if (volume_object(volume, v)) {
                    const size_t j = v / dim[0] % dim[1];
                    const size_t k = v / dim[0] / dim[1];
                    double point[3] = {(double)(v % dim[0]), (double)j, (double)k};
                    mat4_point(point, atlas->volumes[i].info.world_from_voxel, point);
                    take(taking, point);
                }
            }
        }
    }
    for (uint32_t number = 1; !taking->seen && number <= atlas->area_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        if (mesh) {
            for (size_t i = 0; i < mesh->vertex_count; i++) {
                const float *at = mesh->positions + 3 * i;
                take(taking, (const double[]){(double)at[0], (double)at[1], (double)at[2]});
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
