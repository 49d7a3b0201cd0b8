/* SPDX-License-Identifier: BSD-3-Clause */
/* Linear values to sRGB and back. */
#include "render/draw/draw.h"

#include <math.h>

double srgb_from_linear(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

double linear_from_srgb(double srgb)
{
    return srgb <= 0.04045 ? srgb / 12.92 : pow((srgb + 0.055) / 1.055, 2.4);
}

void srgb_bytes(uint8_t rgb[3], const float linear[3])
{
    for (int c = 0; c < 3; c++) {
        rgb[c] = (uint8_t)lrint(255 * srgb_from_linear(fmin(fmax((double)linear[c], 0), 1)));
    }
}
