/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file image.h
 * Pictures as named channels of pixels: made, read, written and compared.
 */
#ifndef CONUS_PUBLIC_IMAGE_H
#define CONUS_PUBLIC_IMAGE_H

#include <conus/selection.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_image conus_image; /**< Named float and uint32 channels of one picture. */

/**
 * Makes an image of the device's pixels: channels id (uint32: the atlas's own label), object (uint32), X, Y, Z, t
 * (float, world mm), top row first as in every image, with atlas and pose as attributes. Where a pixel has no hit, id
 * and object are 0, X, Y, Z are NaN and t is infinity. A PNG of it is magnified, in the areas' colours, with a legend.
 * @param[out] out The image; end it with conus_image_destroy().
 * @param selection The selection. Its atlas must still be there.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a ball, which has no pixels.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_image_of_selection(conus_image **out, const conus_selection *selection);

/**
 * Gives the width.
 * @param image The image.
 * @return Pixels.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API uint32_t conus_image_width(const conus_image *image);

/**
 * Gives the height.
 * @param image The image.
 * @return Pixels.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API uint32_t conus_image_height(const conus_image *image);

/**
 * Names channel @p index.
 * @param image The image.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the image.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const char *conus_image_channel(const conus_image *image, size_t index);

/**
 * Says what the colours of a picture mean: its legend in words, with the names that the atlas has, a line each row.
 * @param image The image.
 * @return UTF-8; "" if there is nothing to say. Borrowed from the image.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const char *conus_image_legend(const conus_image *image);

/**
 * Gives the pixels of a float channel.
 * @param image The image.
 * @param channel Its name.
 * @return [height width], top row first; NULL if there is none of that name and type. Borrowed from the image.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const float *conus_image_floats(const conus_image *image, const char *channel);

/**
 * Gives the pixels of a uint32 channel.
 * @param image The image.
 * @param channel Its name.
 * @return As of conus_image_floats().
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const uint32_t *conus_image_uints(const conus_image *image, const char *channel);

/**
 * Makes an image with the channels R, G, B, A from bytes.
 * @param[out] out The image; end it with conus_image_destroy().
 * @param rgba [height width 4] sRGB and opacity, top row first. Copied.
 * @param width Pixels.
 * @param height Pixels.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a size out of its range.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_image_from_bytes(conus_image **out, const uint8_t *rgba, uint32_t width,
                                                  uint32_t height);

/**
 * Reads OpenEXR (flat scan lines, one part) or PNG (as linear, premultiplied R, G, B, A). The content decides.
 * @param[out] out The image; end it with conus_image_destroy().
 * @param path The file.
 * @return #CONUS_OK; #CONUS_ERROR_IO, #CONUS_ERROR_DATA or #CONUS_ERROR_UNSUPPORTED for a file that cannot be read.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_image_load(conus_image **out, const char *path);

/**
 * Writes an image: .exr all channels, .png 8-bit sRGB of R, G, B and A (A not premultiplied); a picture with
 * conus_view.shapes as .svg or .pdf, with the pixels as an image inside, text as text, and a size by the dpi (a 96th
 * inch a pixel without).
 * @param image The image.
 * @param path The ending decides the format.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another ending; #CONUS_ERROR_IO where the system refuses;
 * #CONUS_ERROR_UNSUPPORTED for .pdf where cairo cannot be loaded.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_image_write(const conus_image *image, const char *path);

/**
 * Makes the bytes that conus_image_write() would write.
 * @param[out] data [size] Borrowed until the next call on the image.
 * @param[out] size Bytes.
 * @param image The image.
 * @param format "exr", "png", "svg" or "pdf", as of conus_image_write().
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another format.
 * @threads One at a time for each @p image.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_image_encode(const uint8_t **data, size_t *size, conus_image *image,
                                              const char *format);

/**
 * Ends an image.
 * @param image NULL is allowed.
 * @threads One at a time for each @p image.
 * @since 0.1
 */
CONUS_API void conus_image_destroy(conus_image *image);

/** How two images differ. In a float channel NaN equals NaN and infinity itself; one of them against anything else
 * differs by infinity. */
typedef struct conus_image_difference {
    uint64_t pixels;    /**< Width times height. */
    uint64_t differing; /**< Pixels in which a float channel differs by more than the tolerance, or a uint32 channel at
                           all. */
    double max_difference; /**< Largest difference in any channel. */
    double rms;            /**< Largest root mean square difference of a channel. */
    char channel[32];      /**< The channel of max_difference, "" if there is no difference. */
    uint32_t x;            /**< Column of its first pixel, from the left. */
    uint32_t y;            /**< Row of its first pixel, from the top. */
} conus_image_difference;

/**
 * Compares two images channel by channel; attributes do not count.
 * @param[out] out The difference.
 * @param a One image.
 * @param b The other.
 * @param tolerance 0 or more.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT unless both have the same size and the same channels, in whatever order.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_image_compare(conus_image_difference *out, const conus_image *a, const conus_image *b,
                                               double tolerance);

#ifdef __cplusplus
}
#endif

#endif
