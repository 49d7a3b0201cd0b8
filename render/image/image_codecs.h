/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The codecs between an image and bytes in memory: image_exr.c and image_png.c. image_file.c picks one for a
 * file. Formatting gives bytes that are the caller's to finish. */
#ifndef CONUS_RENDER_IMAGE_IMAGE_CODECS_H
#define CONUS_RENDER_IMAGE_IMAGE_CODECS_H

#include "render/image/image.h"

/** All channels and attributes, as one scan-line part, ZIP. Matrices are written as m44d, row-major like OpenEXR's. */
conus_status image_format_exr(struct bytes *out, const conus_image *image);
/** One scan-line part of FLOAT, UINT and HALF (made float) channels, string and m44 attributes. DWA, and B44 of other
 * than HALF, are CONUS_ERROR_UNSUPPORTED: OpenEXR's C library 3.1.5 lacks the one and decodes the other wrongly. */
conus_status image_parse_exr(conus_image **out, const uint8_t *data, size_t size);
/** 8-bit sRGB with opacity: png_rgba, or else image_srgb_bytes(). */
conus_status image_format_png(struct bytes *out, const conus_image *image);
/** 1 to 16 bits of any colour type, taken as sRGB whatever gamma or profile it states. */
conus_status image_parse_png(conus_image **out, const uint8_t *data, size_t size);

#endif
