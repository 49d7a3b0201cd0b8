/* SPDX-License-Identifier: BSD-3-Clause */
/* The direction of an edge is that of the smaller eigenvalue of its structure tensor. */
#include "viewer/pictures/pictures.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { REACH = 3 /* pixels along the edge to either side */ };

static const float weights[REACH + 1] = {1, 0.85F, 0.53F, 0.24F}; /* a Gaussian, sigma REACH / 1.7 */
static const float faint = 900; /* sum of nine squared changes, in 255ths, from pixel to pixel: 10 each */

struct picture {
    uint8_t *rgba; /* as it was */
    float (*tensor)[3];
    long width, height;
};

/* The pixel at a place, or the nearest one. */
static size_t index_of(const struct picture *picture, long x, long y)
{
    x = x < 0 ? 0 : x < picture->width ? x : picture->width - 1;
    y = y < 0 ? 0 : y < picture->height ? y : picture->height - 1;
    return (size_t)(y * picture->width + x);
}

/* xx, yy and xy of the changes of all colours around a pixel. */
static void find_tensor(float out[3], const struct picture *picture, long x, long y)
{
    float changes[2][3] = {{0}};
    for (long j = -1; j <= 1; j++) {
        for (long i = -1; i <= 1; i++) {
            const uint8_t *from = picture->rgba + 4 * index_of(picture, x + i, y + j);
            for (int c = 0; c < 3; c++) {
                changes[0][c] += (float)(i * (j ? 1 : 2) * from[c]) / 8;
                changes[1][c] += (float)(j * (i ? 1 : 2) * from[c]) / 8;
            }
        }
    }
    memset(out, 0, 3 * sizeof *out);
    for (int c = 0; c < 3; c++) {
        out[0] += changes[0][c] * changes[0][c];
        out[1] += changes[1][c] * changes[1][c];
        out[2] += changes[0][c] * changes[1][c];
    }
}

/* The step along the edge at a pixel, shorter where it has no clear direction. False where there is none. */
static bool find_step(float step[2], const struct picture *picture, long x, long y)
{
    float sum[3] = {0};
    for (long n = 0; n < 9; n++) {
        const float *tensor = picture->tensor[index_of(picture, x + n % 3 - 1, y + n / 3 - 1)];
        for (int k = 0; k < 3; k++) {
            sum[k] += tensor[k];
        }
    }
    float across = sum[0] - sum[1];
    float apart = hypotf(across, 2 * sum[2]); /* the difference of the eigenvalues */
    float all = sum[0] + sum[1];
    if (all + apart <= 2 * faint || apart <= 0) {
        return false;
    }
    step[0] = apart / all * sqrtf(fmaxf(0, 1 - across / apart) / 2); /* twice the angle is known */
    step[1] = apart / all * copysignf(sqrtf(fmaxf(0, 1 + across / apart) / 2), -sum[2]);
    return true;
}

/* Adds the colour at a place, between the middles of four pixels. */
static void add_colour(float sum[3], const struct picture *picture, float x, float y, float weight)
{
    long left = (long)floorf(x);
    long top = (long)floorf(y);
    float right = x - (float)left;
    float below = y - (float)top;
    for (long n = 0; n < 4; n++) {
        const uint8_t *from = picture->rgba + 4 * index_of(picture, left + n % 2, top + n / 2);
        float part = weight * (n % 2 ? right : 1 - right) * (n / 2 ? below : 1 - below);
        for (int c = 0; c < 3; c++) {
            sum[c] += part * from[c];
        }
    }
}

void edges_smooth(uint8_t *rgba, uint32_t width, uint32_t height)
{
    size_t count = (size_t)width * height;
    struct picture picture = {malloc(4 * count + 1), malloc((count + 1) * sizeof *picture.tensor), width, height};
    if (picture.rgba && picture.tensor) {
        memcpy(picture.rgba, rgba, 4 * count);
        for (size_t i = 0; i < count; i++) {
            find_tensor(picture.tensor[i], &picture, (long)(i % width), (long)(i / width));
        }
        for (size_t i = 0; i < count; i++) {
            long x = (long)(i % width);
            long y = (long)(i / width);
            float step[2];
            float sum[3] = {0};
            float all = 0;
            if (!find_step(step, &picture, x, y)) {
                continue;
            }
            for (int n = -REACH; n <= REACH; n++) {
                add_colour(sum, &picture, (float)x + (float)n * step[0], (float)y + (float)n * step[1],
                           weights[abs(n)]);
                all += weights[abs(n)];
            }
            for (int c = 0; c < 3; c++) {
                rgba[4 * i + (size_t)c] = (uint8_t)(sum[c] / all + 0.5F);
            }
        }
    }
    free(picture.rgba);
    free(picture.tensor);
}
