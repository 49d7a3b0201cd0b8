/* SPDX-License-Identifier: BSD-3-Clause */
/* The colours of objects, and outlines in pictures. */
#include "viewer/model/viewer.h"

#include "base/look.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct outline_look outline_looks[OUTLINE_COUNT] = {[OUTLINE_AVOIDED] = {{LOOK_RGB(LOOK_BROKEN)}, 0},
                                                          [OUTLINE_TARGET] = {{LOOK_RGB(LOOK_HOLDS)}, 0.85},
                                                          [OUTLINE_CHOSEN] = {{LOOK_RGB(LOOK_CHOSEN)}, 0}};
static const uint8_t dark[4] = {LOOK_RGB(LOOK_BLACK), 255};

static const conus_constraint_kind kinds[] = {
    [OUTLINE_AVOIDED] = CONUS_CONSTRAINT_AVOID, [OUTLINE_TARGET] = CONUS_CONSTRAINT_REACH};

void viewer_rank_colour(uint8_t rgb[3], const struct viewer *viewer, uint32_t object, size_t rank)
{
    const conus_object *info = conus_atlas_object(viewer->drawn->atlas, object);
    if (plans_is_in(viewer, CONUS_CONSTRAINT_REACH, object)) {
        memcpy(rgb, outline_looks[OUTLINE_TARGET].rgb, 3);
    } else if (info && viewer_colours_by_rank(viewer, object)) {
        look_ranked(rgb, rank, conus_selection_weight(viewer_selection(viewer), object), LOOK_NOT_HIT);
    } else {
        memcpy(rgb, info ? info->rgb : (const uint8_t[]){LOOK_RGB(LOOK_NO_OBJECT)}, 3);
    }
}

void viewer_colour(uint8_t rgb[3], const struct viewer *viewer, uint32_t object)
{
    viewer_rank_colour(rgb, viewer, object, viewer_rank(viewer, object));
}

bool *outline_wanted(struct viewer *viewer, enum outline which)
{
    const struct view_atlas *view = viewer->drawn;
    const uint32_t chosen = view->shown.chosen;
    const bool is_there = which == OUTLINE_CHOSEN ? chosen : view == viewer->atlases && outline_name(viewer, which);
    bool *wanted = is_there ? calloc(view->object_count + 1, sizeof *wanted) : NULL;
    for (uint32_t number = 1; wanted && number <= view->object_count; number++) {
        wanted[number] = which == OUTLINE_CHOSEN ? viewer_is_below(viewer, number, chosen)
                                                 : plans_is_in(viewer, kinds[which], number);
    }
    return wanted;
}

const char *outline_name(struct viewer *viewer, enum outline which)
{
    return which == OUTLINE_CHOSEN ? NULL : plans_name(viewer, kinds[which]);
}

uint32_t outline_reach(double square)
{
    const double least = floor(square); /* pixels, wherever it begins */
    return (uint32_t)fmin(fmax((sqrt(2) * least - 1) / 2, 0), 48);
}

void outline_smooth(uint8_t *mask, uint8_t *level, uint32_t width, uint32_t height, uint32_t reach)
{
    const size_t across = (size_t)width + 1;
    const uint32_t wide = reach ? reach : 1;                              /* of the level: the line needs one */
    uint32_t *sums = calloc(across, ((size_t)height + 1) * sizeof *sums); /* of all pixels above and to the left */
    for (size_t y = 0; sums && y < height; y++) {
        for (size_t x = 0; x < width; x++) {
            uint32_t *sum = sums + y * across + x;
            sum[across + 1] = sum[across] + sum[1] - *sum + mask[y * width + x];
        }
    }
    for (uint32_t y = 0; sums && y < height; y++) {
        const uint32_t *rows[2] = {sums + across * (y < wide ? 0 : y - wide),
                                   sums + across * (y + wide < height ? y + wide + 1 : height)};
        for (uint32_t x = 0; x < width; x++) {
            const uint32_t left = x < wide ? 0 : x - wide;
            const uint32_t right = x + wide < width ? x + wide + 1 : width;
            const size_t all = (size_t)(right - left) * (size_t)(rows[1] - rows[0]) / across;
            const size_t inside = rows[1][right] - rows[1][left] - rows[0][right] + rows[0][left];
            const uint8_t part = (uint8_t)((255 * inside + all / 2) / all);
            uint8_t *is = mask + (size_t)y * width + x;
            *is = reach ? 2 * inside > all : *is;
            level[(size_t)y * width + x] = (part >= 128) == *is ? part : 255 * *is; /* what is thin stays */
        }
    }
    free(sums);
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
    *top = (struct outline_top){.is_there = false};
    for (uint32_t y = 0; y < height && !top->is_there; y++) {
        const uint8_t *row = mask + (size_t)y * width;
        const uint8_t *first = memchr(row, 1, width);
        if (first) {
            uint32_t x = (uint32_t)(first - row);
            uint32_t end = x;
            while (end < width && row[end]) {
                end++;
            }
            *top = (struct outline_top){true, (x + end) / 2, y};
        }
    }
}

static void put(uint8_t *pixel, const struct outline_look *look, double opacity)
{
    memcpy(pixel, look->rgb, sizeof look->rgb);
    pixel[3] = (uint8_t)(255 * opacity + 0.5);
}

void outline_draw(uint8_t *rgba, struct outline_top *top, const uint8_t *mask, uint32_t width, uint32_t height,
                  const struct outline_look *look)
{
    find_top(top, mask, width, height);
    for (uint32_t y = 0; y < height && top->is_there; y++) {
        for (uint32_t x = 0; x < width; x++) {
            size_t pixel = (size_t)y * width + x;
            bool edge = is_edge(mask, width, height, x, y);
            if (mask[pixel] && (edge || look->fill > 0)) {
                put(rgba + 4 * pixel, look, edge ? 1 : look->fill);
            } else if (edge) {
                memcpy(rgba + 4 * pixel, dark, sizeof dark);
            }
        }
    }
}

/* How the level changes from pixel to pixel, to the right and downwards. */
static void slope_at(double slope[2], const uint8_t *level, uint32_t width, uint32_t height, uint32_t x, uint32_t y)
{
    const uint8_t *pixel = level + (size_t)y * width + x;
    const double right = x + 1 < width ? pixel[1] : *pixel;
    const double left = x > 0 ? pixel[-1] : *pixel;
    const double below = y + 1 < height ? pixel[width] : *pixel;
    const double above = y > 0 ? *(pixel - width) : *pixel;
    slope[0] = (right - left) / 2;
    slope[1] = (below - above) / 2;
}

/* How far within the shape the middle of a pixel lies, pixels, near its edge, where the level is a half. */
static double depth_at(const uint8_t *level, uint32_t width, uint32_t height, uint32_t x, uint32_t y)
{
    double slope[2];
    slope_at(slope, level, width, height, x, y);
    const double steep = hypot(slope[0], slope[1]);
    const double depth = level[(size_t)y * width + x] - 127.5;
    return steep > 0 ? depth / steep : copysign(INFINITY, depth);
}

/* The part of a pixel, its middle at `depth`, that a line between two depths covers. */
static double covered(double depth, double from, double to)
{
    return fmin(fmax(fmin(depth - from, to - depth) + 0.5, 0), 1);
}

/* Whether a pixel of the line that was drawn is there or beside. */
static bool is_beside_line(const uint8_t *rgba, uint32_t width, uint32_t height, uint32_t x, uint32_t y)
{
    bool found = false;
    for (uint32_t j = y ? y - 1 : 0; j <= y + 1 && j < height && !found; j++) {
        for (uint32_t i = x ? x - 1 : 0; i <= x + 1 && i < width && !found; i++) {
            found = rgba[4 * ((size_t)j * width + i) + 3] == 255;
        }
    }
    return found;
}

void outline_soften(uint8_t *rgba, const uint8_t *level, uint32_t width, uint32_t height,
                    const struct outline_look *look)
{
    static const double wide = 1.2; /* pixels, of the bright line and of the dark one */
    const size_t bytes = (size_t)width * height * 4;
    uint8_t *drawn = malloc(bytes + 1);
    if (drawn) {
        memcpy(drawn, rgba, bytes);
    }
    for (size_t pixel = 0; drawn && pixel < bytes / 4; pixel++) {
        const uint32_t x = (uint32_t)(pixel % width), y = (uint32_t)(pixel / width);
        if (level[pixel] == 0 || level[pixel] == 255 || !is_beside_line(drawn, width, height, x, y)) {
            continue;
        }
        const double depth = depth_at(level, width, height, x, y);
        const double bright = covered(depth, 0, wide);
        const double shade = fmin(covered(depth, -wide, 0), 1 - bright);
        const double within = depth > 0 ? look->fill * (1 - bright - shade) : 0;
        const double all = bright + shade + within;
        for (int c = 0; c < 3 && all > 0; c++) {
            rgba[4 * pixel + (size_t)c] = (uint8_t)((bright + within) / all * look->rgb[c] + 0.5);
        }
        rgba[4 * pixel + 3] = (uint8_t)(255 * all + 0.5);
    }
    free(drawn);
}

void outline_dash(uint8_t *rgba, const uint8_t *level, const uint8_t *hidden, uint32_t width, uint32_t height)
{
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            size_t pixel = (size_t)y * width + x;
            double slope[2];
            slope_at(slope, level, width, height, x, y);
            const bool lies = fabs(slope[1]) >= fabs(slope[0]); /* along all of a dash, as stairs do not */
            if (hidden[pixel] == 1 && rgba[4 * pixel + 3] == 255 && (lies ? x : y) / OUTLINE_DASH % 2) {
                memset(rgba + 4 * pixel, 0, 4);
            }
        }
    }
}

void outline_cut(uint8_t *rgba, struct outline_top *top, const uint32_t *objects, uint32_t width, uint32_t height,
                 const bool *wanted, const struct outline_look *look)
{
    size_t pixels = (size_t)width * height;
    uint8_t *mask = calloc(2, pixels); /* and the same, grown */
    const struct outline_look line = {{look->rgb[0], look->rgb[1], look->rgb[2]}, 0};
    struct outline_top grown;
    if (!mask) {
        return;
    }
    for (size_t pixel = 0; pixel < pixels; pixel++) {
        mask[pixel] = wanted[objects[pixel]];
        for (int c = 0; c < 3 && mask[pixel]; c++) {
            uint8_t *level = rgba + 4 * pixel + c;
            *level = (uint8_t)(*level + (look->rgb[c] - *level) * look->fill + 0.5);
        }
    }
    find_top(top, mask, width, height);
    for (uint32_t y = 0; y < height; y++) { /* grown by a pixel to each side, above and below */
        for (uint32_t x = 0; x < width; x++) {
            size_t pixel = (size_t)y * width + x;
            mask[pixels + pixel] = mask[pixel] || is_edge(mask, width, height, x, y);
        }
    }
    outline_draw(rgba, &grown, mask + pixels, width, height, &line);
    for (uint32_t y = 0; y < height; y++) { /* a pixel to each side of the edge */
        for (uint32_t x = 0; x < width; x++) {
            if (is_edge(mask, width, height, x, y)) {
                put(rgba + 4 * ((size_t)y * width + x), look, 1);
            }
        }
    }
    free(mask);
}
