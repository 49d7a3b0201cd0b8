/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the squares that are drawn again, and mixes what was drawn. */
#include "render/colour/colour.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

/* The number of the square that a pixel is in. */
static size_t tile_of(size_t x, size_t y, uint32_t width)
{
    return y / COLOUR_TILE * edges_across(width) + x / COLOUR_TILE;
}

static bool differ(const float *a, const float *b)
{
    float most = 0;
    for (int c = 0; c < 4; c++) {
        most = fmaxf(most, fabsf(a[c] - b[c]));
    }
    return most > COLOUR_EDGE;
}

static bool find_edges(uint32_t *tiles, const float *rgba, uint32_t width, uint32_t height)
{
    bool found = false;
    memset(tiles, 0, edges_across(width) * edges_across(height) * sizeof *tiles);
    for (size_t y = 0; y < height; y++) {
        for (size_t x = 0; x < width; x++) {
            const float *pixel = rgba + 4 * (y * width + x);
            bool right = x + 1 < width && differ(pixel, pixel + 4);
            bool above = y + 1 < height && differ(pixel, pixel + 4 * (size_t)width);
            if (right || above) {
                tiles[tile_of(x, y, width)] = 1;
                found = true;
            }
        }
    }
    return found;
}

/* Half of the pixel at x, y is its own ray's, half those of its four corners, which it shares with its neighbours. Of a
 * square that was not drawn the pixel's own ray stands for them. */
static void mix_corners(float *rgba, const float *drawn, const uint32_t *tiles, const struct colour_view *view,
                        size_t x, size_t y)
{
    float *pixel = rgba + 4 * (y * view->width + x);
    float sum[4];
    for (size_t c = 0; c < 4; c++) {
        sum[c] = 4 * pixel[c];
    }
    for (size_t n = 0; n < 4; n++) {
        const size_t right = x + (n % 2 && x + 1 < view->width);
        const size_t up = y + (n / 2 && y + 1 < view->height);
        const bool is_drawn = tiles[tile_of(right, up, view->width)];
        for (size_t c = 0; c < 4; c++) {
            sum[c] += is_drawn ? drawn[4 * (up * view->width + right) + c] : pixel[c];
        }
    }
    for (size_t c = 0; c < 4; c++) {
        pixel[c] = sum[c] / 8;
    }
}

static void mix(float *rgba, const float *drawn, const uint32_t *tiles, const struct colour_view *view,
                const struct colour_edges *edges)
{
    for (size_t y = 0; y < view->height; y++) {
        for (size_t x = 0; x < view->width; x++) {
            const size_t pixel = 4 * (y * view->width + x);
            if (!tiles[tile_of(x, y, view->width)]) {
                continue;
            }
            if (edges->is_corner) {
                mix_corners(rgba, drawn, tiles, view, x, y);
            } else {
                memcpy(rgba + pixel, drawn + pixel, 4 * sizeof *rgba);
            }
        }
    }
}

conus_status edges_smooth(float *rgba, const struct colour_view *view, const struct colour_edges *edges,
                          edges_draw draw, void *user)
{
    float *drawn = memory_zeroed((size_t)view->width * view->height, 4 * sizeof *drawn);
    uint32_t *tiles = memory_raw(edges_across(view->width) * edges_across(view->height), sizeof *tiles);
    conus_status status = drawn && tiles ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && find_edges(tiles, rgba, view->width, view->height)) {
        status = draw(user, drawn, tiles, view, edges);
        if (!status) {
            mix(rgba, drawn, tiles, view, edges);
        }
    }
    memory_free(drawn);
    memory_free(tiles);
    return status;
}
