/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Pictures on the screen. */
#ifndef CONUS_VIEWER_WINDOW_TEXTURE_H
#define CONUS_VIEWER_WINDOW_TEXTURE_H

#include <stdbool.h>
#include <stdint.h>

struct texture {
    uint32_t name; /**< GL's name; 0 = none yet. */
    uint32_t width, height;
};

/** Puts bytes of sRGB, top row first, on a texture; @p smooth: where it has another size, pixels run into each other.
 */
void texture_set(struct texture *texture, const uint8_t *rgba, uint32_t width, uint32_t height, bool smooth);
/** Ends the picture on a texture. */
void texture_drop(struct texture *texture);

#endif
