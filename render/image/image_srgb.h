/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The transfer curve of sRGB, and an image's R, G, B, A as sRGB bytes. */
#ifndef CONUS_RENDER_IMAGE_IMAGE_SRGB_H
#define CONUS_RENDER_IMAGE_IMAGE_SRGB_H

#include "render/image/image.h"

/** The transfer curve of sRGB (IEC 61966-2-1), for values 0 to 1. */
double srgb_from_linear(double linear);
double linear_from_srgb(double srgb);

/** sRGB bytes of a linear colour. */
void srgb_bytes(uint8_t rgb[3], const float linear[3]);

/** Converts R, G, B, A to sRGB bytes; A (1 where there is none) is not premultiplied, values are clipped to 0..1.
 * [width * height * 4], the caller's to memory_free(). CONUS_ERROR_ARGUMENT without R, G, B. */
conus_status image_srgb_bytes(uint8_t **out, const conus_image *image);

#endif
