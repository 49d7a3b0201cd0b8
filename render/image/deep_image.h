/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A deep image: each pixel has any number of samples, front to back, each with a value in every channel. */
#ifndef CONUS_RENDER_IMAGE_DEEP_IMAGE_H
#define CONUS_RENDER_IMAGE_DEEP_IMAGE_H

#include "conus/image.h"
#include "render/image/image.h"

struct deep_image {
    conus_image *header;   /**< Size and attributes; has no channels.                                            */
    uint32_t *counts;      /**< [width * height] samples of each pixel, top row first.                           */
    size_t sample_count;   /**< Their sum.                                                                       */
    struct bytes manifest; /**< From id_manifest_format(); its data is NULL if there is none.                    */
    struct image_channel *channels; /**< Arrays of sample_count values, pixel by pixel; sorted by their names. */
    size_t channel_count;
};

/** Copies @p counts ([width * height]). Of one row, their sum is at most INT32_MAX. */
conus_status deep_image_create(struct deep_image **out, uint32_t width, uint32_t height, const uint32_t *counts);
void deep_image_destroy(struct deep_image *image);

/** Adds a zeroed channel and returns it through @p out (valid until the next call). The name has 1 to 31 bytes and is
 * new in the image. */
conus_status deep_image_add_channel(struct deep_image *image, const char *name, enum image_type type,
                                    struct image_channel **out);

/** OpenEXR: one part of deep scan lines, ZIPS, with the header's attributes, `idManifest` and `maxSamplesPerPixel`. @p
 * out is the caller's to finish. */
conus_status deep_image_format(struct bytes *out, const struct deep_image *image);

#endif
