/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws outlines into pictures. */
#include "viewer/model/outline.h"

#include "base/look.h"

#include <stdlib.h>
#include <string.h>

static const uint8_t bright[4] = {LOOK_RGB(LOOK_CHOSEN), 255};
static const uint8_t dark[4] = {LOOK_RGB(LOOK_BLACK), 255};

bool *outline_wanted(const struct viewer *viewer)
{
    uint32_t chosen = viewer->drawn->shown.chosen;
    bool *wanted = chosen ? calloc(viewer->drawn->object_count + 1, sizeof *wanted) : NULL;
    for (uint32_t number = 1; wanted && number <= viewer->drawn->object_count; number++) {
        wanted[number] = viewer_is_below(viewer, number, chosen);
    }
    return wanted;
}

/* Whether a neighbour beside, above or below has the other value. */
static bool is_edge(const uint8_t *mask, uint32_t width, uint32_t height, uint32_t x, uint32_t y)
{
    const uint8_t *pixel = mask + (size_t)y * width + x;
    return (x > 0 && pixel[-1] != *pixel) || (x + 1 < width && pixel[1] != *pixel) ||
           (y > 0 && *(pixel - width) != *pixel) || (y + 1 < height && pixel[width] != *pixel);
}

/* The middle of the first run of the first row that has one. */
static void find_top(struct outline_top *top, const uint8_t *mask, uint32_t width, uint32_t height)
{
    size_t pixels = (size_t)width * height;
    const uint8_t *first = memchr(mask, 1, pixels);
    *top = (struct outline_top){.is_there = first};
    if (first) {
        size_t at = (size_t)(first - mask);
        size_t end = at;
        while (end < pixels && end / width == at / width && mask[end]) {
            end++;
        }
        top->x = (uint32_t)((at + end) / 2 % width);
        top->y = (uint32_t)(at / width);
    }
}

void outline_draw(uint8_t *rgba, struct outline_top *top, const uint8_t *mask, uint32_t width, uint32_t height)
{
    find_top(top, mask, width, height);
    for (uint32_t y = 0; y < height && top->is_there; y++) {
        for (uint32_t x = 0; x < width; x++) {
            if (is_edge(mask, width, height, x, y)) {
                size_t pixel = (size_t)y * width + x;
                memcpy(rgba + 4 * pixel, mask[pixel] ? bright : dark, sizeof bright);
            }
        }
    }
}

void outline_dash(uint8_t *rgba, const uint8_t *mask, const uint8_t *hidden, uint32_t width, uint32_t height)
{
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            size_t pixel = (size_t)y * width + x;
            bool lies = (y > 0 && mask[pixel - width] != mask[pixel]) ||
                        (y + 1 < height && mask[pixel + width] != mask[pixel]); /* and does not stand */
            if (hidden[pixel] == 1 && (lies ? x : y) / OUTLINE_DASH % 2) {
                memset(rgba + 4 * pixel, 0, 4);
            }
        }
    }
}

uint8_t *outline_cut(struct outline_top *top, const uint8_t *rgba, const uint32_t *objects, uint32_t width,
                     uint32_t height, const bool *wanted)
{
    size_t pixels = (size_t)width * height;
    uint8_t *copy = malloc(4 * pixels);
    uint8_t *mask = calloc(2, pixels); /* and the same, grown */
    struct outline_top grown;
    if (!copy || !mask) {
        free(copy);
        free(mask);
        return NULL;
    }
    memcpy(copy, rgba, 4 * pixels);
    for (size_t pixel = 0; pixel < pixels; pixel++) {
        mask[pixel] = wanted[objects[pixel]];
    }
    find_top(top, mask, width, height);
    for (uint32_t y = 0; y < height; y++) { /* grown by a pixel to each side, above and below */
        for (uint32_t x = 0; x < width; x++) {
            size_t pixel = (size_t)y * width + x;
            mask[pixels + pixel] = mask[pixel] || is_edge(mask, width, height, x, y);
        }
    }
    outline_draw(copy, &grown, mask + pixels, width, height);
    for (uint32_t y = 0; y < height; y++) { /* a pixel to each side of the edge */
        for (uint32_t x = 0; x < width; x++) {
            if (is_edge(mask, width, height, x, y)) {
                memcpy(copy + 4 * ((size_t)y * width + x), bright, sizeof bright);
            }
        }
    }
    free(mask);
    return copy;
}
