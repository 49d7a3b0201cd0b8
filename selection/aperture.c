/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/aperture.h"

#include "base/memory.h"

void aperture_finish(struct aperture *aperture)
{
    memory_free(aperture->in_cone);
    memory_free(aperture->radius);
    memory_free(aperture->weight);
    *aperture = (struct aperture){0};
}

/* What the resolution and the shape decide. */
static conus_status make_pixels(struct aperture *aperture, const struct cone *cone)
{
    uint32_t n = cone->resolution;
    size_t pixels = (size_t)n * n;
    struct aperture made = {.resolution = n, .shape = cone->aperture};
    made.in_cone = memory_raw(pixels, sizeof *made.in_cone);
    made.radius = memory_raw(pixels, sizeof *made.radius);
    made.weight = memory_raw(pixels, sizeof *made.weight);
    if (!made.in_cone || !made.radius || !made.weight) {
        aperture_finish(&made);
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) {
            made.in_cone[(size_t)j * n + i] = cone_has_pixel(cone, i, j);
            made.radius[(size_t)j * n + i] = cone_radius(cone, i, j);
        }
    }
    made.angle = -1; /* no cone's: the weights are to follow */
    aperture_finish(aperture);
    *aperture = made;
    return CONUS_OK;
}

static void make_weights(struct aperture *aperture, const struct cone *cone)
{
    uint32_t n = aperture->resolution;
    aperture->angle = cone->angle;
    aperture->total_weight = 0;
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) {
            size_t pixel = (size_t)j * n + i;
            aperture->weight[pixel] = cone_weight(cone, i, j);
            aperture->total_weight += aperture->in_cone[pixel] ? aperture->weight[pixel] : 0;
        }
    }
}

conus_status aperture_prepare(struct aperture *aperture, const struct cone *cone)
{
    if (aperture->resolution != cone->resolution || aperture->shape != cone->aperture) {
        conus_status status = make_pixels(aperture, cone);
        if (status) {
            return status;
        }
    }
    if (aperture->angle != cone->angle) {
        make_weights(aperture, cone);
    }
    return CONUS_OK;
}
