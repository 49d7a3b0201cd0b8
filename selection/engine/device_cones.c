/* SPDX-License-Identifier: BSD-3-Clause */
/* Tells the device of shapes and places, and takes what it has counted. */
#include "selection/engine/device_cones.h"

#include "atlas/atlas.h"
#include "base/memory.h"
#include "base/order.h"
#include "render/id/id_pass.h"

#include <stdlib.h>
#include <string.h>

enum { KEPT_RAYS = 1 << 20 }; /* of shapes; a block that finds more of them begins anew */

/* Shapes of cones with the same pixels: one for each angle. */
struct shapes {
    size_t rays; /* of each */
    size_t count;
    double *angles; /* [count] */
    size_t capacity;
};

struct device_cones {
    const conus_atlas *atlas;
    struct cone_pass *device;
    struct cone_place *places; /* [place_capacity] */
    struct cone_aim *aims;     /* [aim_capacity] of the shape that is added; */
    struct cone_spot *spots;   /* [spot_capacity] and its spots, if it is counted */
    size_t place_capacity, aim_capacity, spot_capacity;
    bool has_groups;
    struct shapes counted; /* of pixels in the cone, */
    uint32_t resolution;   /* of those n x n */
    conus_aperture aperture;
    struct shapes whole;        /* of all pixels */
    uint32_t listed_resolution; /* whose whole cones the device has listed, so many rays */
    size_t listed;
};

void device_cones_destroy(struct device_cones *cones)
{
    if (cones) {
        cone_pass_destroy(cones->device);
        memory_free(cones->places);
        memory_free(cones->aims);
        memory_free(cones->spots);
        memory_free(cones->counted.angles);
        memory_free(cones->whole.angles);
        memory_free(cones);
    }
}

conus_status device_cones_create(struct device_cones **out, const conus_atlas *atlas, struct id_pass *pass)
{
    struct device_cones *cones = memory_zeroed(1, sizeof *cones);
    conus_status status = cones ? cone_pass_create(&cones->device, pass) : CONUS_ERROR_MEMORY;
    if (status || !cones->device) {
        device_cones_destroy(cones);
        cones = NULL;
    } else {
        cones->atlas = atlas;
    }
    *out = status ? *out : cones;
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
    for (size_t k = 0; k < count; k++) {
        spots[k].pixel |= aperture_is_border(aperture->in_cone, n, spots[k].pixel) ? CONE_BORDER : 0;
    }
}

/* Forgets shapes of other pixels, or very many. */
static void keep_shapes(struct shapes *shapes, bool are_alike, size_t rays)
{
    shapes->count = are_alike && shapes->rays == rays && shapes->count * rays <= KEPT_RAYS ? shapes->count : 0;
    shapes->rays = rays;
}

/* The pixels in the cone, as the aperture has them. */
static conus_status fill_counted(struct device_cones *cones, const struct cone *cone, struct aperture *aperture)
{
    conus_status status = aperture_prepare(aperture, cone);
    const size_t rays = cones->counted.rays;
    if (!memory_reserve(&cones->spots, &cones->spot_capacity, rays, sizeof *cones->spots)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t first = 0; first < rays && !status; first += CONE_PART) {
        size_t count = rays - first < CONE_PART ? rays - first : CONE_PART;
        fill_part(cones->aims + first, cones->spots + first, aperture, first, count);
    }
    return status;
}

/* All pixels, row-major. */
static void fill_whole(struct cone_aim *aim, const struct cone *cone)
{
    const uint32_t n = cone->resolution;
    for (uint32_t pixel = 0; pixel < n * n; pixel++, aim++) {
        const double u = cone_coordinate(pixel % n, n);
        const double v = cone_coordinate(pixel / n, n);
        *aim = (struct cone_aim){.u = u, .v = v};
        cone_device_rays(&aim->right, &aim->up, &aim->forward, cone, &u, &v, 1);
    }
}

/* Gives the device the cone's shape. */
static conus_status add_shape(struct device_cones *cones, struct shapes *shapes, const struct cone *cone,
                              struct aperture *aperture)
{
    conus_status status = CONUS_OK;
    if (!memory_reserve(&shapes->angles, &shapes->capacity, shapes->count + 1, sizeof *shapes->angles) ||
        !memory_reserve(&cones->aims, &cones->aim_capacity, shapes->rays, sizeof *cones->aims)) {
        return CONUS_ERROR_MEMORY;
    }
    if (aperture) {
        status = fill_counted(cones, cone, aperture);
    } else {
        fill_whole(cones->aims, cone);
    }
    status = status ? status
                    : cone_pass_add_shape(cones->device, cones->aims, aperture ? cones->spots : NULL, shapes->rays,
                                          shapes->count);
    shapes->angles[shapes->count++] = cone->angle;
    return status;
}

/* The number of the shape of that angle; the number of shapes if there is none. `near` may be it. */
static size_t find_shape(const struct shapes *shapes, double angle, size_t near)
{
    size_t shape = near;
    if (near >= shapes->count || shapes->angles[near] != angle) {
        for (shape = 0; shape < shapes->count && shapes->angles[shape] != angle; shape++) {
        }
    }
    return shape;
}

/* Lists the cones with their shapes; those of other angles are added, counted ones as @p aperture has them. */
static conus_status place_cones(struct device_cones *cones, struct shapes *shapes, const struct cone *const *in,
                                size_t count, struct aperture *aperture)
{
    conus_status status = CONUS_OK;
    if (!memory_reserve(&cones->places, &cones->place_capacity, count, sizeof *cones->places)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t c = 0, shape = 0; c < count && !status; c++) {
        struct cone_place *place = &cones->places[c];
        const double *m = in[c]->pose.world_from_device;
        shape = find_shape(shapes, in[c]->angle, shape);
        if (shape == shapes->count) {
            status = add_shape(cones, shapes, in[c], aperture);
        }
        place->radius = in[c]->radius;
        place->shape = (uint32_t)shape;
        for (int column = 0; column < 4; column++) {
            memcpy(place->columns[column], m + 4 * column, sizeof place->columns[column]);
        }
    }
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
                                                     .contact = rows[i].contact,
                                                     .is_at_border = rows[i].border != 0};
    }
    return CONUS_OK;
}

static conus_status set_groups(struct device_cones *cones, const uint32_t *group)
{
    size_t count = cones->atlas->object_count + 1;
    uint32_t *groups = cones->has_groups ? NULL : memory_raw(count, sizeof *groups);
    if (cones->has_groups || !groups) {
        return cones->has_groups ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < count; i++) {
        groups[i] = group ? group[i] : i;
    }
    conus_status status = cone_pass_set_groups(cones->device, groups, count);
    cones->has_groups = !status;
    memory_free(groups);
    return status;
}

conus_status device_cones_count(struct device_cones *cones, struct hit_counts *const *out, const struct cone *const *in,
                                size_t count, struct aperture *aperture, const uint32_t *group)
{
    struct shapes *shapes = &cones->counted;
    const struct cone_head *heads = NULL;
    const struct cone_row *rows = NULL;
    size_t parts = (aperture->rays.count + CONE_PART - 1) / CONE_PART;
    keep_shapes(shapes,
                cones->resolution == aperture->resolution && cones->aperture == aperture->shape &&
                    !aperture->is_wide_square,
                aperture->rays.count);
    cones->resolution = aperture->resolution;
    cones->aperture = aperture->shape;
    conus_status status = set_groups(cones, group);
    status = status ? status : place_cones(cones, shapes, in, count, aperture);
    if (!status) {
        status = cone_pass_count(cones->device, cones->places, (uint32_t)count, (uint32_t)shapes->rays, &heads, &rows);
    }
    for (size_t i = 0; i < count * parts && !status; i++) {
        status = take_rows(out[i / parts], rows + heads[i].first, heads[i].count);
    }
    return status;
}

conus_status device_cones_list(struct device_cones *cones, const struct cone *const *in, size_t count,
                               const uint32_t *list, uint32_t ray_count)
{
    struct shapes *shapes = &cones->whole;
    const uint32_t n = in[0]->resolution;
    const bool is_whole = ray_count == count * n * n;
    keep_shapes(shapes, true, (size_t)n * n);
    const size_t listed = is_whole && cones->listed_resolution == n ? cones->listed : 0;
    conus_status status = place_cones(cones, shapes, in, count, NULL);
    if (!status) {
        status = cone_pass_list(cones->device, cones->places, (uint32_t)count, n * n, list, listed, ray_count);
    }
    cones->listed_resolution = n;
    cones->listed = is_whole ? (listed > ray_count ? listed : ray_count) : 0;
    return status;
}

conus_status device_cones_make_rays(struct device_cones *cones, size_t volume)
{
    return cone_pass_make_rays(cones->device, volume);
}
