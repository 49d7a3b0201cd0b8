/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the tiles with edges and draws them again with four rays per pixel. */
#include "render/colour/smooth.h"

#include "base/memory.h"
#include "render/gl/context.h"

#include <math.h>
#include <string.h>

enum { TILE = COLOUR_TILE, RAYS = 4 };

#define THRESHOLD 0.05F /* of white, linear radiance times opacity */

struct tile {
    uint16_t x, y; /* of its first pixel */
};

struct tiles {
    struct tile *items;
    size_t count;
};

static bool differ(const float *a, const float *b)
{
    float most = 0;
    for (int c = 0; c < 4; c++) {
        most = fmaxf(most, fabsf(a[c] - b[c]));
    }
    return most > THRESHOLD;
}

/* Whether a pixel of the tile differs from its right or upper neighbour, which may lie in the next tile. */
static bool has_edge(const float *rgba, const struct target *target, struct tile tile)
{
    for (size_t y = tile.y; y < (size_t)tile.y + TILE && y < target->height; y++) {
        for (size_t x = tile.x; x < (size_t)tile.x + TILE && x < target->width; x++) {
            const float *pixel = rgba + 4 * (y * target->width + x);
            if ((x + 1 < target->width && differ(pixel, pixel + 4)) ||
                (y + 1 < target->height && differ(pixel, pixel + (size_t)4 * target->width))) {
                return true;
            }
        }
    }
    return false;
}

static conus_status find_tiles(struct tiles *out, const float *rgba, const struct target *target)
{
    size_t across = (target->width + TILE - 1) / TILE;
    size_t upward = (target->height + TILE - 1) / TILE;
    out->items = memory_raw(across * upward, sizeof *out->items);
    if (!out->items) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t n = 0; n < across * upward; n++) {
        struct tile tile = {(uint16_t)(n % across * TILE), (uint16_t)(n / across * TILE)};
        if (has_edge(rgba, target, tile)) {
            out->items[out->count++] = tile;
        }
    }
    return CONUS_OK;
}

/* Adds up the tiles' pictures by rays through four places of each pixel, a rotated square, a quarter each. */
static conus_status draw_tiles(const struct tiles *tiles, const struct target *target, const struct colour_pass *pass,
                               const struct colour_view *view)
{
    static const double places[RAYS][2] = {{-0.125, -0.375}, {0.375, -0.125}, {0.125, 0.375}, {-0.375, 0.125}};
    GLuint buffer = 0;
    glCreateBuffers(1, &buffer);
    glNamedBufferData(buffer, (GLsizeiptr)(tiles->count * sizeof *tiles->items), tiles->items, GL_STREAM_DRAW);
    glBlendColor(0, 0, 0, 1.0F / RAYS);
    glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE);
    conus_status status = CONUS_OK;
    for (int n = 0; n < RAYS && !status; n++) {
        struct colour_view shifted = *view;
        memcpy(shifted.shift, places[n], sizeof shifted.shift);
        status = gl_tell(&view->listener, (size_t)n, RAYS);
        status = status ? status : colour_pass_begin(pass, &shifted);
        if (status) {
            break;
        }
        target_bind(target);
        glEnable(GL_BLEND);
        colour_pass_prepare(pass, &shifted);
        glUseProgram(colour_pass_tile_program(pass, &shifted));
        glUniform2f(0, (float)view->width, (float)view->height);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffer);
        glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)tiles->count);
    }
    glDisable(GL_BLEND);
    glDeleteBuffers(1, &buffer);
    return status;
}

conus_status smooth_edges(float *rgba, const struct target *target, const struct colour_pass *pass,
                          const struct colour_view *view)
{
    struct tiles tiles = {0};
    float *smooth = memory_raw((size_t)target->width * target->height, 4 * sizeof *smooth);
    conus_status status = smooth ? find_tiles(&tiles, rgba, target) : CONUS_ERROR_MEMORY;
    if (!status && tiles.count) {
        target_bind(target);
        target_clear(target);
        status = draw_tiles(&tiles, target, pass, view);
        status = status ? status : target_read(target, "colour", smooth);
        if (!status) {
            for (size_t n = 0; n < tiles.count; n++) {
                size_t x = tiles.items[n].x;
                size_t width = target->width - x < TILE ? target->width - x : TILE;
                for (size_t y = tiles.items[n].y; y < (size_t)tiles.items[n].y + TILE && y < target->height; y++) {
                    size_t first = 4 * (y * target->width + x);
                    memcpy(rgba + first, smooth + first, 4 * width * sizeof *rgba);
                }
            }
        }
    }
    memory_free(smooth);
    memory_free(tiles.items);
    return status;
}
