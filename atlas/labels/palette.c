/* SPDX-License-Identifier: BSD-3-Clause */
/* The colour of the n-th area. */
#include "atlas/labels/palette.h"

#include <math.h>

/* HSV to RGB after A. R. Smith, "Color Gamut Transform Pairs", SIGGRAPH 1978, in its closed form. */
static uint8_t channel_of(double hue, double saturation, double value, double offset)
{
    double k = fmod(offset + hue * 6, 6);
    double slope = fmax(0, fmin(1, fmin(k, 4 - k)));
    return (uint8_t)lround(255 * value * (1 - saturation * slope));
}

void palette_colour(uint8_t rgb[3], size_t index)
{
    static const double offsets[3] = {5, 3, 1};
    static const double values[3] = {0.95, 0.75, 0.85};
    const double golden = 0.61803398874989485;
    double hue = fmod(0.08 + golden * (double)index, 1);
    double saturation = 0.45 + 0.25 * (double)(index / 3 % 2);
    for (int i = 0; i < 3; i++) {
        rgb[i] = channel_of(hue, saturation, values[index % 3], offsets[i]);
    }
}

void palette_safe_colour(uint8_t rgb[3], size_t index)
{
    static const uint8_t colours[7][3] = {{230, 159, 0}, {86, 180, 233}, {0, 158, 115},  {240, 228, 66},
                                          {0, 114, 178}, {213, 94, 0},   {204, 121, 167}};
    static const double towards[3] = {0, 0.45, -0.35}; /* white, black */
    double part = towards[index / 7 % 3];
    for (int i = 0; i < 3; i++) {
        double colour = colours[index % 7][i];
        rgb[i] = (uint8_t)lround(part > 0 ? colour + part * (255 - colour) : colour * (1 + part));
    }
}
