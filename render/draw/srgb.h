/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The transfer curve of sRGB. */
#ifndef CONUS_RENDER_DRAW_SRGB_H
#define CONUS_RENDER_DRAW_SRGB_H

#include <stdint.h>

/** The transfer curve of sRGB (IEC 61966-2-1), for values 0 to 1. */
double srgb_from_linear(double linear);
double linear_from_srgb(double srgb);

/** sRGB bytes of a linear colour. */
void srgb_bytes(uint8_t rgb[3], const float linear[3]);

#endif
