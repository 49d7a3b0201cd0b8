/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares two images channel by channel. */
#include "render/image/image.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A channel that both images have. */
struct pair {
    const struct image_channel *a, *b;
    double sum_of_squares;
};

static conus_status check_sizes(const conus_image *a, const conus_image *b, double tolerance)
{
    if (!(tolerance >= 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "tolerance: %g, allowed is 0 or more", tolerance);
    }
    if (a->width != b->width || a->height != b->height) {
        return fail(CONUS_ERROR_ARGUMENT, "images of %u x %u and %u x %u pixels cannot be compared", a->width,
                    a->height, b->width, b->height);
    }
    return CONUS_OK;
}

static const char *type_name(enum image_type type)
{
    return type == IMAGE_UINT ? "uint32" : "float";
}

/* Whether every channel of `a` is in `b`, too; then `pairs` (unless NULL) holds them. */
static conus_status pair_channels(struct pair *pairs, const conus_image *a, const conus_image *b, const char *lacking)
{
    for (size_t i = 0; i < a->channel_count; i++) {
        const struct image_channel *channel = &a->channels[i];
        const struct image_channel *other = image_find(b, channel->name);
        if (!other) {
            return fail(CONUS_ERROR_ARGUMENT, "channel %s is not in the %s image", channel->name, lacking);
        }
        if (other->type != channel->type) {
            return fail(CONUS_ERROR_ARGUMENT, "channel %s is %s in one image and %s in the other", channel->name,
                        type_name(channel->type), type_name(other->type));
        }
        if (pairs) {
            pairs[i] = (struct pair){.a = channel, .b = other};
        }
    }
    return CONUS_OK;
}

static double difference_at(const struct pair *pair, size_t pixel)
{
    if (pair->a->type == IMAGE_UINT) {
        return fabs((double)pair->a->uints[pixel] - (double)pair->b->uints[pixel]);
    }
    double a = (double)pair->a->floats[pixel];
    double b = (double)pair->b->floats[pixel];
    if (a == b || (isnan(a) && isnan(b))) {
        return 0;
    }
    return isfinite(a) && isfinite(b) ? fabs(a - b) : INFINITY;
}

static void compare_pixel(conus_image_difference *difference, struct pair *pairs, size_t count, size_t pixel,
                          double tolerance)
{
    bool differs = false;
    for (size_t c = 0; c < count; c++) {
        double d = difference_at(&pairs[c], pixel);
        pairs[c].sum_of_squares += d * d;
        differs = differs || d > (pairs[c].a->type == IMAGE_UINT ? 0 : tolerance);
        if (d > difference->max_difference) {
            difference->max_difference = d;
            memcpy(difference->channel, pairs[c].a->name, sizeof difference->channel);
            difference->x = (uint32_t)pixel; /* of the whole image, until the end */
        }
    }
    difference->differing += differs;
}

conus_status conus_image_compare(conus_image_difference *out, const conus_image *a, const conus_image *b,
                                 double tolerance)
{
    conus_status status = check_sizes(a, b, tolerance);
    struct pair *pairs = status ? NULL : memory_zeroed(a->channel_count, sizeof *pairs);
    status = status ? status : pairs ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : pair_channels(pairs, a, b, "second");
    status = status ? status : pair_channels(NULL, b, a, "first");
    if (!status) {
        conus_image_difference difference = {.pixels = (uint64_t)a->width * a->height};
        for (size_t pixel = 0; pixel < difference.pixels; pixel++) {
            compare_pixel(&difference, pairs, a->channel_count, pixel, tolerance);
        }
        for (size_t c = 0; c < a->channel_count; c++) {
            difference.rms = fmax(difference.rms, sqrt(pairs[c].sum_of_squares / (double)difference.pixels));
        }
        difference.y = difference.x / a->width;
        difference.x %= a->width;
        *out = difference;
    }
    memory_free(pairs);
    return status;
}
