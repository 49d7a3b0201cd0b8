/* SPDX-License-Identifier: BSD-3-Clause */
/* Deep images in memory. deep_exr.c writes them. */
#include "render/image/deep_image.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>

static conus_status count_samples(size_t *out, uint32_t width, uint32_t height, const uint32_t *counts)
{
    *out = 0;
    for (uint32_t y = 0; y < height; y++) {
        uint64_t row = 0;
        for (uint32_t x = 0; x < width; x++) {
            row += counts[(size_t)y * width + x];
        }
        if (row > INT32_MAX) {
            return fail(CONUS_ERROR_UNSUPPORTED, "row of %llu deep samples, allowed are %d", (unsigned long long)row,
                        INT32_MAX);
        }
        *out += row;
    }
    return CONUS_OK;
}

conus_status deep_image_create(struct deep_image **out, uint32_t width, uint32_t height, const uint32_t *counts)
{
    size_t pixels = (size_t)width * height;
    struct deep_image *image = memory_zeroed(1, sizeof *image);
    if (!image) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = image_create(&image->header, width, height);
    status = status ? status : count_samples(&image->sample_count, width, height, counts);
    image->counts = status ? NULL : memory_raw(pixels, sizeof *counts);
    if (!image->counts) {
        deep_image_destroy(image);
        return status ? status : CONUS_ERROR_MEMORY;
    }
    memcpy(image->counts, counts, pixels * sizeof *counts);
    *out = image;
    return CONUS_OK;
}

void deep_image_destroy(struct deep_image *image)
{
    if (!image) {
        return;
    }
    for (size_t i = 0; i < image->channel_count; i++) {
        memory_free(image->channels[i].floats);
    }
    memory_free(image->channels);
    memory_free(image->counts);
    bytes_finish(&image->manifest);
    conus_image_destroy(image->header);
    memory_free(image);
}

conus_status deep_image_add_channel(struct deep_image *image, const char *name, enum image_type type,
                                    struct image_channel **out)
{
    struct image_channel *channels = memory_resize(image->channels, image->channel_count + 1, sizeof *channels);
    if (!channels) {
        return CONUS_ERROR_MEMORY;
    }
    image->channels = channels;
    struct image_channel channel = {.type = type, .floats = memory_zeroed(image->sample_count, sizeof(float))};
    if (!channel.floats) {
        return CONUS_ERROR_MEMORY;
    }
    snprintf(channel.name, sizeof channel.name, "%s", name);
    channels[image->channel_count] = channel;
    *out = &channels[image->channel_count++];
    return CONUS_OK;
}
