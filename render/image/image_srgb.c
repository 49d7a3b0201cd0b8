/* SPDX-License-Identifier: BSD-3-Clause */
/* An image's linear values to sRGB bytes and back. */
#include "render/image/image.h"

#include "base/memory.h"
#include "conus/own.h"

#include <math.h>

static uint8_t byte_from_linear(const float steps[255], float linear)
{
    unsigned low = 0;
    for (unsigned half = 128; half; half /= 2) {
        low += low + half <= 255 && linear >= steps[low + half - 1] ? half : 0;
    }
    return (uint8_t)low;
}

conus_status image_srgb_bytes(uint8_t **out, const conus_image *image)
{
    const struct image_rgba rgba = image_rgba(image);
    if (!rgba.plane[0] || !rgba.plane[1] || !rgba.plane[2]) {
        return fail(CONUS_ERROR_ARGUMENT, "a PNG shows the channels R, G and B, this image lacks some of them");
    }
    size_t count = (size_t)image->width * image->height;
    uint8_t *bytes = memory_raw(count, 4);
    if (!bytes) {
        return CONUS_ERROR_MEMORY;
    }
    float steps[255];
    /* An sRGB byte is the number of these that a value reaches: the middles between the bytes, in linear radiance. */
    for (int i = 0; i < 255; i++) {
        steps[i] = (float)linear_from_srgb((i + 0.5) / 255);
    }
    for (size_t i = 0; i < count; i++) {
        float opacity = rgba.plane[3] ? rgba.plane[3][i] : 1;
        for (size_t c = 0; c < 3; c++) {
            bytes[4 * i + c] = opacity > 0 ? byte_from_linear(steps, rgba.plane[c][i] / opacity) : 0;
        }
        bytes[4 * i + 3] = (uint8_t)(opacity > 0 ? lrintf(255 * fminf(opacity, 1)) : 0);
    }
    *out = bytes;
    return CONUS_OK;
}

conus_status conus_image_from_bytes(conus_image **out, const uint8_t *rgba, uint32_t width, uint32_t height)
{
    conus_image *image = NULL;
    conus_status status = image_create_rgba(&image, width, height);
    if (status) {
        return status;
    }
    float linear[256];
    const struct image_rgba to = image_rgba(image);
    for (int i = 0; i < 256; i++) {
        linear[i] = (float)linear_from_srgb(i / 255.0);
    }
    for (size_t p = 0; p < (size_t)width * height; p++) {
        float opacity = (float)rgba[4 * p + 3] / 255;
        for (size_t c = 0; c < 3; c++) {
            to.plane[c][p] = linear[rgba[4 * p + c]] * opacity;
        }
        to.plane[3][p] = opacity;
    }
    *out = image;
    return CONUS_OK;
}
