/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A picture: named channels of float or uint32, top row first, and text or matrix attributes for its header. */
#ifndef CONUS_RENDER_IMAGE_H
#define CONUS_RENDER_IMAGE_H

#include "base/status.h"

enum image_type { IMAGE_FLOAT = 1, IMAGE_UINT };

struct image_channel {
    char name[32];
    enum image_type type;
    union {
        float *floats; /**< [width * height] */
        uint32_t *uints;
    };
};

struct image_attribute {
    char *name;
    char *text;        /**< UTF-8.                                                       */
    bool is_matrix;    /**< Then text is NULL and matrix counts.                         */
    double matrix[16]; /**< Column-major.                                                */
};

struct conus_image {
    uint32_t width, height;
    struct image_channel *channels;
    size_t channel_count;
    struct image_attribute *attributes;
    size_t attribute_count;
    uint8_t *png_rgba; /**< [width * height * 4] sRGB that a PNG shows instead of R, G, B, A; NULL if none. */
};

/** An image without channels. */
conus_status image_create(conus_image **out, uint32_t width, uint32_t height);

/** Adds a zeroed channel and returns it through @p out (valid until the next call). */
conus_status image_add_channel(conus_image *image, const char *name, enum image_type type, struct image_channel **out);

conus_status image_add_text(conus_image *image, const char *name, const char *text);
conus_status image_add_matrix(conus_image *image, const char *name, const double matrix[16]);

/** The channel called @p name, or NULL. */
struct image_channel *image_find(const conus_image *image, const char *name);

/* By format: image_exr.c, image_png.c. */
conus_status image_write_exr(const conus_image *image, const char *path);
conus_status image_load_exr(conus_image **out, const char *path);
conus_status image_write_png(const conus_image *image, const char *path);
conus_status image_load_png(conus_image **out, const char *path);

#endif
