/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A picture: named channels of float or uint32, top row first, and text or matrix attributes for its header.
 * Where it has the channels R, G, B and A, they are linear radiance with the primaries of sRGB, and R, G, B are
 * premultiplied by A (as OpenEXR has it), so that src + (1 - A) dst lays one over the other. */
#ifndef CONUS_RENDER_IMAGE_IMAGE_H
#define CONUS_RENDER_IMAGE_IMAGE_H

#include "base/files/file.h"
#include "base/status.h"
#include "conus/image.h"
#include "render/draw/draw.h"

/** Longest side, and largest sum of all channels in bytes, of an image that is created or read. */
#define IMAGE_MAX_SIDE 65536U
#define IMAGE_MAX_BYTES (UINT64_C(8) << 30)

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
    uint8_t *png_rgba; /**< [png_width * png_height * 4] sRGB, A not premultiplied: the pixels of a PNG in place of R,
                            G, B, A; NULL if none. May be larger than the image, for pictures too small to see. */
    uint32_t png_width, png_height;
    struct draw_list *list; /**< Lines and text that are not in the pixels; NULL = they are. */
    double dpi;             /**< Pixels per inch; 0 = not known. */
    struct bytes encoded;   /**< The result of conus_image_encode(). */
};

/** An image without channels. Sides from 1 to IMAGE_MAX_SIDE. */
conus_status image_create(conus_image **out, uint32_t width, uint32_t height);

/** Adds a zeroed channel and returns it through @p out (valid until the next call), which may be NULL. The name has
 * 1 to 31 bytes and is new in the image. */
conus_status image_add_channel(conus_image *image, const char *name, enum image_type type, struct image_channel **out);

/** An image with the zeroed (transparent black) float channels R, G, B, A. */
conus_status image_create_rgba(conus_image **out, uint32_t width, uint32_t height);

/** Likewise, with an empty list. */
conus_status image_create_listed(conus_image **out, uint32_t width, uint32_t height);

/** Lays the list, which is there, over the pixels, and ends it. */
conus_status image_paint(conus_image *image);

/** The attribute that says what a picture's colours mean. */
#define IMAGE_LEGEND "conus:legend"

/** Attribute names have 1 to 31 bytes; a second attribute of a name replaces the first. */
conus_status image_add_text(conus_image *image, const char *name, const char *text);
conus_status image_add_matrix(conus_image *image, const char *name, const double matrix[16]);

/** The channel called @p name, or NULL. */
struct image_channel *image_find(const conus_image *image, const char *name);
/** The attribute called @p name, or NULL. */
struct image_attribute *image_find_attribute(const conus_image *image, const char *name);

/** Pixels of R, G, B, A in this order, each NULL where the image has no such float channel. */
struct image_rgba {
    float *plane[4];
};
struct image_rgba image_rgba(const conus_image *image);

/** Lays @p over, linear and premultiplied, over a pixel of an image that has all four. */
static inline void image_lay(const struct image_rgba *to, size_t pixel, const float over[4])
{
    for (int c = 0; c < 4; c++) {
        to->plane[c][pixel] = over[c] + (1 - over[3]) * to->plane[c][pixel];
    }
}

/* The codecs between an image and bytes in memory: image_exr.c and image_png.c. image_file.c picks one for a file.
 * Formatting gives bytes that are the caller's to finish. */

/** All channels and attributes, as one scan-line part, ZIP. Matrices are written as m44d, row-major like OpenEXR's. */
conus_status image_format_exr(struct bytes *out, const conus_image *image);
/** One scan-line part of FLOAT, UINT and HALF (made float) channels, string and m44 attributes. DWA, and B44 of other
 * than HALF, are CONUS_ERROR_UNSUPPORTED: OpenEXR's C library 3.1.5 lacks the one and decodes the other wrongly. */
conus_status image_parse_exr(conus_image **out, const uint8_t *data, size_t size);
/** 8-bit sRGB with opacity: png_rgba, or else image_srgb_bytes(). */
conus_status image_format_png(struct bytes *out, const conus_image *image);
/** 1 to 16 bits of any colour type, taken as sRGB whatever gamma or profile it states. */
conus_status image_parse_png(conus_image **out, const uint8_t *data, size_t size);

/* An image's R, G, B, A as sRGB bytes. */

/** Converts R, G, B, A to sRGB bytes; A (1 where there is none) is not premultiplied, values are clipped to 0..1.
 * [width * height * 4], the caller's to memory_free(). CONUS_ERROR_ARGUMENT without R, G, B. */
conus_status image_srgb_bytes(uint8_t **out, const conus_image *image);

#endif
