/* SPDX-License-Identifier: BSD-3-Clause */
/* Which pixels of the buffer are in the cone, with the weight and direction of each. */
#include "selection/cone/cone.h"

#include "base/memory.h"

void aperture_finish(struct aperture *aperture)
{
    memory_free(aperture->in_cone);
    memory_free(aperture->square);
    memory_free(aperture->weight);
    memory_free(aperture->per_depth);
    memory_free(aperture->inside);
    memory_free(aperture->rays.pixel);
    memory_free(aperture->rays.right);
    memory_free(aperture->rays.up);
    memory_free(aperture->rays.forward);
    *aperture = (struct aperture){0};
}

/* Lists the pixels of a block that are in the cone. */
static void list_block(struct aperture *aperture, uint32_t column, uint32_t row)
{
    uint32_t n = aperture->resolution;
    for (uint32_t k = 0; k < APERTURE_BLOCK * APERTURE_BLOCK; k++) {
        uint32_t i = column + aperture_column(k);
        uint32_t j = row + aperture_row(k);
        if (i < n && j < n && aperture->in_cone[(size_t)j * n + i]) {
            aperture->rays.pixel[aperture->rays.count++] = j * n + i;
        }
    }
}

/* In such a cone the angle, too, decides which pixels are in it. */
static bool is_wide_square(const struct cone *cone)
{
    return cone->aperture == CONUS_APERTURE_SQUARE && cone_is_wide(cone);
}

/* Sets what depends on the resolution and the shape. */
static conus_status make_pixels(struct aperture *aperture, const struct cone *cone)
{
    uint32_t n = cone->resolution;
    size_t pixels = (size_t)n * n;
    struct aperture made = {.resolution = n, .shape = cone->aperture, .is_wide_square = is_wide_square(cone)};
    made.in_cone = memory_raw(pixels, sizeof *made.in_cone);
    made.square = memory_raw(pixels, sizeof *made.square);
    made.weight = memory_raw(pixels, sizeof *made.weight);
    made.per_depth = memory_raw(pixels, sizeof *made.per_depth);
    made.inside = memory_raw(pixels, sizeof *made.inside);
    made.rays.pixel = memory_raw(pixels, sizeof *made.rays.pixel);
    made.rays.right = memory_raw(pixels, sizeof *made.rays.right);
    made.rays.up = memory_raw(pixels, sizeof *made.rays.up);
    made.rays.forward = memory_raw(pixels, sizeof *made.rays.forward);
    if (!made.in_cone || !made.square || !made.weight || !made.per_depth || !made.inside || !made.rays.pixel ||
        !made.rays.right || !made.rays.up || !made.rays.forward) {
        aperture_finish(&made);
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) {
            made.in_cone[(size_t)j * n + i] = cone_has_pixel(cone, i, j);
            made.square[(size_t)j * n + i] = cone_square(i, j, n);
        }
    }
    size_t count = 0;
    for (uint32_t row = 0; row < n; row += APERTURE_BLOCK) {
        for (uint32_t column = 0; column < n; column += APERTURE_BLOCK) {
            list_block(&made, column, row);
        }
    }
    for (uint32_t pixel = 0; pixel < n * n; pixel++) {
        if (made.in_cone[pixel]) {
            made.inside[count++] = pixel;
        }
    }
    made.angle = -1; /* no cone's: weights and rays are to follow */
    aperture_finish(aperture);
    *aperture = made;
    return CONUS_OK;
}

/* In units of 2^-32: sums of up to 2^20 weights, which are at most 1, are exact then, in any order. */
static double round_weight(double weight)
{
    return floor(weight * 0x1p32 + 0.5) * 0x1p-32;
}

/* Sets what depends on the angle, too. */
static void make_weights(struct aperture *aperture, const struct cone *cone)
{
    uint32_t n = aperture->resolution;
    aperture->angle = cone->angle;
    aperture->total_weight = 0;
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) {
            size_t pixel = (size_t)j * n + i;
            aperture->weight[pixel] =
                n > APERTURE_EXACT_WEIGHTS ? round_weight(cone_weight(cone, i, j)) : cone_weight(cone, i, j);
            aperture->per_depth[pixel] = cone_per_depth(cone, i, j);
            aperture->total_weight += aperture->in_cone[pixel] ? aperture->weight[pixel] : 0;
        }
    }
}

static void aim_rays(struct aperture *aperture, const struct cone *cone)
{
    enum { AT_ONCE = 64 };
    struct device_rays *rays = &aperture->rays;
    for (size_t first = 0; first < rays->count; first += AT_ONCE) {
        double u[AT_ONCE];
        double v[AT_ONCE];
        size_t count = rays->count - first < AT_ONCE ? rays->count - first : AT_ONCE;
        for (size_t k = 0; k < count; k++) {
            u[k] = cone_coordinate(rays->pixel[first + k] % aperture->resolution, aperture->resolution);
            v[k] = cone_coordinate(rays->pixel[first + k] / aperture->resolution, aperture->resolution);
        }
        cone_device_rays(rays->right + first, rays->up + first, rays->forward + first, cone, u, v, count);
    }
}

bool aperture_is_border(const bool *in_cone, uint32_t n, uint32_t pixel)
{
    const uint32_t i = pixel % n;
    const uint32_t j = pixel / n;
    const bool is_within = i > 0 && j > 0 && i + 1 < n && j + 1 < n;
    return in_cone[pixel] &&
           !(is_within && in_cone[pixel - 1] && in_cone[pixel + 1] && in_cone[pixel - n] && in_cone[pixel + n]);
}

/* Whether the cone has these pixels: if so, another angle changes only their rays and weights. */
static bool has_pixels(const struct aperture *aperture, const struct cone *cone)
{
    bool other = aperture->angle != cone->angle && (aperture->is_wide_square || is_wide_square(cone));
    return !other && aperture->resolution == cone->resolution && aperture->shape == cone->aperture;
}

conus_status aperture_prepare(struct aperture *aperture, const struct cone *cone)
{
    if (!has_pixels(aperture, cone)) {
        conus_status status = make_pixels(aperture, cone);
        if (status) {
            return status;
        }
    }
    if (aperture->angle != cone->angle) {
        make_weights(aperture, cone);
        aim_rays(aperture, cone);
    }
    return CONUS_OK;
}
