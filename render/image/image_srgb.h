/* SPDX-License-Identifier: BSD-3-Clause */
/** @file An image's R, G, B, A as sRGB bytes. */
#ifndef CONUS_RENDER_IMAGE_IMAGE_SRGB_H
#define CONUS_RENDER_IMAGE_IMAGE_SRGB_H

#include "render/draw/srgb.h"
#include "render/image/image.h"

/** Converts R, G, B, A to sRGB bytes; A (1 where there is none) is not premultiplied, values are clipped to 0..1.
 * [width * height * 4], the caller's to memory_free(). CONUS_ERROR_ARGUMENT without R, G, B. */
conus_status image_srgb_bytes(uint8_t **out, const conus_image *image);

#endif
