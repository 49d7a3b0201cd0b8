/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws lines with edges. */
#include "viewer/panes/panes.h"

#include "base/look.h"

#include <math.h>

static const ui_colour edge = {LOOK_RGB(LOOK_UNDER), 205};
static const float casing = 2, dash = 6, gap = 5; /* pixels at scale 1; the casing is both edges */

void stroke_line(const float from[2], const float to[2], struct pen pen)
{
    ui_draw_line(from, to, edge, (pen.width + casing) * pen.scale);
    ui_draw_line(from, to, pen.colour, pen.width * pen.scale);
}

void stroke_dashes(float *phase, const float from[2], const float to[2], struct pen pen)
{
    float length = hypotf(to[0] - from[0], to[1] - from[1]);
    float period = (dash + gap) * pen.scale;
    int dashes = (int)ceilf((*phase + length) / period);
    for (int i = 0; i < dashes; i++) {
        float at = (float)i * period - *phase;
        float begin = fmaxf(at, 0) / length;
        float end = fminf(at + dash * pen.scale, length) / length;
        if (end > begin) {
            stroke_line((float[]){from[0] + begin * (to[0] - from[0]), from[1] + begin * (to[1] - from[1])},
                        (float[]){from[0] + end * (to[0] - from[0]), from[1] + end * (to[1] - from[1])}, pen);
        }
    }
    *phase = fmodf(*phase + length, period);
}

void stroke_circle(const float centre[2], float radius, struct pen pen)
{
    ui_draw_circle(centre, radius * pen.scale, edge, (pen.width + casing) * pen.scale);
    ui_draw_circle(centre, radius * pen.scale, pen.colour, pen.width * pen.scale);
}
