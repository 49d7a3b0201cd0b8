/* SPDX-License-Identifier: BSD-3-Clause */
/* The weight of each pixel of a cone or cylinder, made once for all poses of one shape (Eq. 31). */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/weight/weight.h"

#include <math.h>

void soft_finish(struct soft *soft)
{
    memory_free(soft->pixels);
    memory_free(soft->sides);
    *soft = (struct soft){0};
}

/* A power of two that is as large as the largest, or less than twice. */
static double unit_of(double largest)
{
    int exponent;
    const bool is_power = frexp(largest, &exponent) == 0.5;
    return ldexp(1, is_power ? exponent - 1 : exponent);
}

/* Sums of up to 2^20 multiples of 2^-32, each at most 1, are exact in any order; as w is (aperture.c). */
static void round_weights(struct soft *soft, double largest, size_t pixels)
{
    const double unit = unit_of(largest);
    for (size_t p = 0; p < pixels && largest > 0; p++) {
        soft->pixels[p] = floor(soft->pixels[p] / unit * 0x1p32 + 0.5) * 0x1p-32;
    }
}

static uint8_t sides_of(const bool *in_cone, uint32_t n, uint32_t i, uint32_t j)
{
    const bool *at = in_cone + (size_t)j * n + i;
    const bool left = i > 0 && at[-1];
    const bool right = i + 1 < n && at[1];
    const bool below = j > 0 && *(at - n);
    const bool above = j + 1 < n && at[n];
    return (uint8_t)(left | right << 1 | below << 2 | above << 3);
}

/* W of the rays at the distance r from the buffer's centre. */
static double value_at(const conus_weight *weight, const struct cone *cone, double r)
{
    return weight_value(weight, cone->radius > 0 ? r * cone->radius : degrees_from_radians(cone_off_axis(cone, r)), 0);
}

conus_status soft_prepare(struct soft *soft, const conus_weight *weight, const struct aperture *aperture,
                          const struct cone *cone)
{
    const uint32_t n = cone->resolution;
    const size_t pixels = (size_t)n * n;
    if (soft->pixels && soft->resolution == n && soft->shape == cone->aperture && soft->angle == cone->angle) {
        return CONUS_OK;
    }
    soft_finish(soft);
    struct soft made = {.resolution = n, .shape = cone->aperture, .angle = cone->angle};
    made.pixels = memory_zeroed(pixels, sizeof *made.pixels);
    made.sides = memory_zeroed(pixels, sizeof *made.sides);
    if (!made.pixels || !made.sides) {
        soft_finish(&made);
        return CONUS_ERROR_MEMORY;
    }
    double largest = 0;
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) {
            const size_t p = (size_t)j * n + i;
            if (aperture->in_cone[p]) {
                made.sides[p] = sides_of(aperture->in_cone, n, i, j);
                made.pixels[p] = cone_weight(cone, i, j) * value_at(weight, cone, cone_radius(cone, i, j));
                largest = fmax(largest, made.pixels[p]);
            }
        }
    }
    if (n > APERTURE_EXACT_WEIGHTS) {
        round_weights(&made, largest, pixels);
    }
    for (size_t p = 0; p < pixels; p++) {
        made.total += made.pixels[p];
    }
    *soft = made;
    return CONUS_OK;
}
