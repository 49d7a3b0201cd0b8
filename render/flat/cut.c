/* SPDX-License-Identifier: BSD-3-Clause */
/* Creates and draws a cut, and keeps results for the next one. */
#include "render/flat/cut.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

enum { HATCH = 6, PALE = 40 };

/* Lines of surfaces around the areas: a grey that is visible on the context's black and white. */
static const uint8_t around_rgb[3] = {172, 165, 155};

/* Opacities by emphasis, between stripes and on them. */
struct opacities {
    double of[3][2];
};

static double size_of(const conus_atlas *atlas, uint32_t number)
{
    return fabs(atlas_object_mesh(atlas, number)->shape.volume_mm3);
}

conus_status cut_init(struct cut *out, const conus_atlas *atlas)
{
    struct cut cut = {.atlas = atlas, .surfaces = memory_zeroed(atlas->object_count + 1, sizeof *cut.surfaces)};
    conus_status status = cut.surfaces ? cut_list_streamlines(&cut) : CONUS_ERROR_MEMORY;
    if (status) {
        cut_finish(&cut);
        return status;
    }
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        if (!atlas_object_mesh(atlas, number)) {
            continue;
        }
        size_t at = cut.surface_count++;
        for (; at > 0 && size_of(atlas, cut.surfaces[at - 1]) < size_of(atlas, number); at--) {
            cut.surfaces[at] = cut.surfaces[at - 1];
        }
        cut.surfaces[at] = number;
    }
    *out = cut;
    return CONUS_OK;
}

static void free_pixels(struct cut *cut)
{
    memory_free(cut->rgba);
    memory_free(cut->objects);
    memory_free(cut->grey);
    memory_free(cut->contours);
    memory_free(cut->turns);
    cut->rgba = cut->grey = NULL;
    cut->turns = NULL;
    cut->objects = cut->contours = NULL;
    cut->pixel_capacity = 0;
}

void cut_finish(struct cut *cut)
{
    free_pixels(cut);
    for (size_t i = 0; cut->streamlines && i < cut->atlas->tractogram_count; i++) {
        memory_free(cut->streamlines[i]);
    }
    memory_free(cut->streamlines);
    memory_free(cut->surfaces);
    *cut = (struct cut){0};
}

static conus_status reserve_pixels(struct cut *cut, size_t pixels)
{
    if (pixels <= cut->pixel_capacity) {
        return CONUS_OK;
    }
    bool contours = cut->surface_count || cut->atlas->context_surface_count;
    free_pixels(cut);
    cut->has_grey = cut->has_objects = false;
    cut->rgba = memory_raw(pixels, 4);
    cut->objects = memory_raw(pixels, sizeof *cut->objects);
    cut->grey = memory_raw(pixels, 1);
    cut->contours = contours ? memory_raw(pixels, sizeof *cut->contours) : NULL;
    cut->turns = contours ? memory_zeroed(pixels, sizeof *cut->turns) : NULL;
    if (!cut->rgba || !cut->objects || !cut->grey || (contours && !(cut->contours && cut->turns))) {
        free_pixels(cut);
        return CONUS_ERROR_MEMORY;
    }
    cut->pixel_capacity = pixels;
    return CONUS_OK;
}

static void find_again(struct cut *cut, const struct cut_view *view)
{
    bool same = cut->of.width == view->place.width && cut->of.height == view->place.height &&
                cut->of.mm_per_pixel == view->place.mm_per_pixel;
    for (int i = 0; i < 3; i++) {
        same = same && cut->of.centre[i] == view->place.centre[i] && cut->of.right[i] == view->place.right[i] &&
               cut->of.up[i] == view->place.up[i];
    }
    bool same_window = cut->window[0] == view->window[0] && cut->window[1] == view->window[1];
    cut->of = view->place;
    memcpy(cut->window, view->window, sizeof cut->window);
    if (!cut->has_grey || !same || !same_window) {
        cut_find_grey(cut, view);
    }
    if (!cut->has_objects || !same) {
        cut_find_objects(cut, view);
    }
    cut->has_grey = cut->has_objects = true;
}

/* 1 on an area's outline: its own pixels that have a different neighbour beside, above or below. */
static double opacity_at(const struct cut *cut, const struct cut_view *view, const struct opacities *opacities,
                         uint32_t column, uint32_t row)
{
    uint32_t width = cut->of.width;
    const uint32_t *at = cut->objects + (size_t)width * row + column;
    if (!view->no_outlines && ((column > 0 && at[-1] != *at) || (column + 1 < width && at[1] != *at) ||
                               (row > 0 && *(at - width) != *at) || (row + 1 < cut->of.height && at[width] != *at))) {
        return 1;
    }
    return opacities->of[view->emphasis ? view->emphasis[*at] : EMPHASIS_FULL][(column + row) % HATCH < HATCH / 3];
}

static void draw_row(const struct cut *cut, const struct cut_view *view, const struct opacities *opacities,
                     uint32_t row)
{
    const conus_object *list = cut->atlas->objects;
    size_t at = (size_t)cut->of.width * row;
    for (uint32_t column = 0; column < cut->of.width; column++, at++) {
        uint8_t *pixel = cut->rgba + 4 * at;
        uint32_t object = cut->objects[at];
        uint32_t contour = cut->contours ? cut->contours[at] : 0;
        memset(pixel, cut->grey[at], 3);
        pixel[3] = 255;
        if (contour == CUT_AROUND) {
            memcpy(pixel, around_rgb, 3);
        } else if (contour) {
            memcpy(pixel, list[contour - 1].rgb, 3);
        } else if (object) {
            cut_blend(pixel, list[object - 1].rgb, opacity_at(cut, view, opacities, column, row));
        }
    }
}

conus_status cut_draw(struct cut *cut, const struct cut_view *view)
{
    double pale = view->fill * PALE / 100;
    struct opacities opacities = {{[EMPHASIS_PALE] = {pale, pale},
                                   [EMPHASIS_FULL] = {view->fill, view->fill},
                                   [EMPHASIS_HATCHED] = {0.35 * view->fill, fmin(1.6 * view->fill, 1)}}};
    conus_status status = reserve_pixels(cut, (size_t)view->place.width * view->place.height);
    if (status) {
        return status;
    }
    find_again(cut, view);
    for (uint32_t row = 0; row < view->place.height; row++) {
        draw_row(cut, view, &opacities, row);
    }
    if (view->cone) {
        cut_draw_cone(cut->rgba, &view->place, view->cone);
    }
    return CONUS_OK;
}
