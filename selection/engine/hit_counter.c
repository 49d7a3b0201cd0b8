/* SPDX-License-Identifier: BSD-3-Clause */
/* Tells the device of shapes and places, and takes what it has counted. */
#include "selection/engine/hit_counter.h"

#include "atlas/atlas.h"
#include "base/memory.h"
#include "base/order.h"
#include "render/id/cone_count.h"

#include <stdlib.h>
#include <string.h>

struct hit_counter {
    struct cone_count *device;
    struct cone_place *places; /* [place_capacity] */
    size_t place_capacity;
    uint32_t resolution; /* of the shape that the device has; 0 = none yet, */
    conus_aperture shape;
    double angle;
};

void hit_counter_destroy(struct hit_counter *counter)
{
    if (counter) {
        cone_count_destroy(counter->device);
        memory_free(counter->places);
        memory_free(counter);
    }
}

conus_status hit_counter_create(struct hit_counter **out, const conus_atlas *atlas, const struct id_pass *pass,
                                const size_t *volumes, size_t volume_count, const uint32_t *group)
{
    struct hit_counter *counter = memory_zeroed(1, sizeof *counter);
    const double **matrices = memory_raw(volume_count, sizeof(double *));
    uint32_t *groups = memory_raw(atlas->object_count + 1, sizeof *groups);
    conus_status status = counter && matrices && groups ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < volume_count && !status; i++) {
        matrices[i] = atlas->volumes[volumes[i]].voxel_from_world;
    }
    for (uint32_t i = 0; i <= atlas->object_count && !status; i++) {
        groups[i] = group ? group[i] : i;
    }
    status = status
                 ? status
                 : cone_count_create(&counter->device, pass, groups, atlas->object_count + 1, matrices, volume_count);
    memory_free(groups);
    memory_free((void *)matrices);
    if (status || !counter->device) {
        hit_counter_destroy(counter);
        counter = NULL;
    }
    *out = status ? *out : counter;
    return status;
}

static int by_pixel(const void *a, const void *b)
{
    uint32_t one = ((const struct cone_spot *)a)->pixel;
    uint32_t other = ((const struct cone_spot *)b)->pixel;
    return (one > other) - (one < other);
}

/* The rays of a part, which are walked together, and its pixels, which are added up in their order. */
static void fill_part(struct cone_aim *aims, struct cone_spot *spots, const struct aperture *aperture, size_t first,
                      size_t count)
{
    const struct device_rays *rays = &aperture->rays;
    uint32_t n = aperture->resolution;
    for (size_t k = 0; k < count; k++) {
        uint32_t pixel = rays->pixel[first + k];
        spots[k] = (struct cone_spot){aperture->weight[pixel], pixel, aperture->square[pixel]};
    }
    order_sort(spots, count, sizeof *spots, by_pixel);
    for (size_t k = 0; k < count; k++) {
        uint32_t pixel = rays->pixel[first + k];
        const struct cone_spot *spot =
            bsearch(&(struct cone_spot){.pixel = pixel}, spots, count, sizeof *spots, by_pixel);
        aims[k] = (struct cone_aim){.right = rays->right[first + k],
                                    .up = rays->up[first + k],
                                    .forward = rays->forward[first + k],
                                    .u = cone_coordinate(pixel % n, n),
                                    .v = cone_coordinate(pixel / n, n),
                                    .rank = (uint32_t)(spot - spots)};
    }
}

/* Gives the device the shape of the aperture, unless it has it. */
static conus_status set_shape(struct hit_counter *counter, const struct aperture *aperture)
{
    size_t rays = aperture->rays.count;
    if (counter->resolution == aperture->resolution && counter->shape == aperture->shape &&
        counter->angle == aperture->angle) {
        return CONUS_OK;
    }
    struct cone_aim *aims = memory_raw(rays, sizeof *aims);
    struct cone_spot *spots = memory_raw(rays, sizeof *spots);
    conus_status status = aims && spots ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t first = 0; first < rays && !status; first += CONE_PART) {
        size_t count = rays - first < CONE_PART ? rays - first : CONE_PART;
        fill_part(aims + first, spots + first, aperture, first, count);
    }
    status = status ? status : cone_count_set_shape(counter->device, aims, spots, (uint32_t)rays);
    memory_free(aims);
    memory_free(spots);
    counter->resolution = status ? 0 : aperture->resolution; /* 0: none */
    counter->shape = aperture->shape;
    counter->angle = aperture->angle;
    return status;
}

static conus_status take_rows(struct hit_counts *out, const struct cone_row *rows, uint32_t count)
{
    if (!memory_reserve(&out->rows, &out->capacity, out->count + count, sizeof *out->rows)) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < count; i++) {
        out->rows[out->count++] = (struct hit_count){.object = rows[i].object,
                                                     .pixels = rows[i].pixels,
                                                     .weight = rows[i].weight,
                                                     .nearest = rows[i].nearest,
                                                     .pixel = rows[i].pixel,
                                                     .own = rows[i].own,
                                                     .voxel = rows[i].voxel,
                                                     .contact = rows[i].contact};
    }
    return CONUS_OK;
}

conus_status hit_counter_count(struct hit_counter *counter, struct hit_counts *const *out,
                               const struct cone *const *cones, size_t count, const struct aperture *aperture)
{
    const struct cone_head *heads = NULL;
    const struct cone_row *rows = NULL;
    size_t parts = (aperture->rays.count + CONE_PART - 1) / CONE_PART;
    if (!memory_reserve(&counter->places, &counter->place_capacity, count, sizeof *counter->places)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t c = 0; c < count; c++) {
        const double *m = cones[c]->pose.world_from_device;
        counter->places[c].radius = cones[c]->radius;
        memcpy(counter->places[c].right, m, sizeof counter->places[c].right);
        memcpy(counter->places[c].up, m + 4, sizeof counter->places[c].up);
        memcpy(counter->places[c].back, m + 8, sizeof counter->places[c].back);
        memcpy(counter->places[c].apex, m + 12, sizeof counter->places[c].apex);
    }
    conus_status status = set_shape(counter, aperture);
    status = status ? status : cone_count_run(counter->device, counter->places, (uint32_t)count, &heads, &rows);
    for (size_t i = 0; i < count * parts && !status; i++) {
        status = take_rows(out[i / parts], rows + heads[i].first, heads[i].count);
    }
    return status;
}
