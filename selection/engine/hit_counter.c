/* SPDX-License-Identifier: BSD-3-Clause */
/* Tells the device of shapes and places, and takes what it has counted. */
#include "selection/engine/hit_counter.h"

#include "atlas/atlas.h"
#include "base/memory.h"
#include "base/order.h"
#include "render/id/cone_count.h"

#include <stdlib.h>
#include <string.h>

enum { KEPT_RAYS = 1 << 20 }; /* of shapes; a block that finds more of them begins anew */

struct hit_counter {
    struct cone_count *device;
    struct cone_place *places; /* [place_capacity] */
    size_t place_capacity;
    uint32_t resolution; /* of the shapes that the device has */
    conus_aperture aperture;
    size_t rays; /* of each */
    size_t shape_count;
    double *angles;          /* [shape_count] */
    struct cone_aim *aims;   /* [shape_count * rays] */
    struct cone_spot *spots; /* likewise */
    size_t angle_capacity, aim_capacity, spot_capacity;
};

void hit_counter_destroy(struct hit_counter *counter)
{
    if (counter) {
        cone_count_destroy(counter->device);
        memory_free(counter->places);
        memory_free(counter->angles);
        memory_free(counter->aims);
        memory_free(counter->spots);
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

/* Forgets the shapes where they have other pixels than the aperture, or are very many. */
static void keep_shapes(struct hit_counter *counter, const struct aperture *aperture)
{
    bool fits = counter->resolution == aperture->resolution && counter->aperture == aperture->shape &&
                counter->rays == aperture->rays.count && !aperture->is_wide_square;
    counter->shape_count = fits && counter->shape_count * counter->rays <= KEPT_RAYS ? counter->shape_count : 0;
    counter->resolution = aperture->resolution;
    counter->aperture = aperture->shape;
    counter->rays = aperture->rays.count;
}

static conus_status add_shape(struct hit_counter *counter, const struct aperture *aperture)
{
    size_t rays = counter->rays;
    size_t end = (counter->shape_count + 1) * rays;
    if (!memory_reserve(&counter->angles, &counter->angle_capacity, counter->shape_count + 1,
                        sizeof *counter->angles) ||
        !memory_reserve(&counter->aims, &counter->aim_capacity, end, sizeof *counter->aims) ||
        !memory_reserve(&counter->spots, &counter->spot_capacity, end, sizeof *counter->spots)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t first = 0; first < rays; first += CONE_PART) {
        size_t count = rays - first < CONE_PART ? rays - first : CONE_PART;
        fill_part(counter->aims + end - rays + first, counter->spots + end - rays + first, aperture, first, count);
    }
    counter->angles[counter->shape_count++] = aperture->angle;
    return CONUS_OK;
}

/* The number of the shape of that angle; the number of shapes if there is none. `near` may be it. */
static size_t find_shape(const struct hit_counter *counter, double angle, size_t near)
{
    size_t shape = near;
    if (near >= counter->shape_count || counter->angles[near] != angle) {
        for (shape = 0; shape < counter->shape_count && counter->angles[shape] != angle; shape++) {
        }
    }
    return shape;
}

/* Lists the cones with their shapes, and gives the device those that are new. */
static conus_status place_cones(struct hit_counter *counter, const struct cone *const *cones, size_t count,
                                struct aperture *aperture)
{
    conus_status status = CONUS_OK;
    keep_shapes(counter, aperture);
    const size_t known = counter->shape_count;
    for (size_t c = 0, shape = 0; c < count && !status; c++) {
        struct cone_place *place = &counter->places[c];
        const double *m = cones[c]->pose.world_from_device;
        shape = find_shape(counter, cones[c]->angle, shape);
        if (shape == counter->shape_count) {
            status = aperture_prepare(aperture, cones[c]);
            status = status ? status : add_shape(counter, aperture);
        }
        place->radius = cones[c]->radius;
        place->shape = (uint32_t)shape;
        memcpy(place->right, m, sizeof place->right);
        memcpy(place->up, m + 4, sizeof place->up);
        memcpy(place->back, m + 8, sizeof place->back);
        memcpy(place->apex, m + 12, sizeof place->apex);
    }
    status = status ? status
                    : cone_count_set_shapes(counter->device, counter->aims, counter->spots, (uint32_t)counter->rays,
                                            known, counter->shape_count);
    counter->shape_count = status ? 0 : counter->shape_count;
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
                               const struct cone *const *cones, size_t count, struct aperture *aperture)
{
    const struct cone_head *heads = NULL;
    const struct cone_row *rows = NULL;
    size_t parts = (aperture->rays.count + CONE_PART - 1) / CONE_PART;
    if (!memory_reserve(&counter->places, &counter->place_capacity, count, sizeof *counter->places)) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = place_cones(counter, cones, count, aperture);
    status = status ? status : cone_count_run(counter->device, counter->places, (uint32_t)count, &heads, &rows);
    for (size_t i = 0; i < count * parts && !status; i++) {
        status = take_rows(out[i / parts], rows + heads[i].first, heads[i].count);
    }
    return status;
}
