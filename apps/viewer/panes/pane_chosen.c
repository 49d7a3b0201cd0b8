/* SPDX-License-Identifier: BSD-3-Clause */
/* The chosen area over the picture of the 3-D pane, seen through what lies before it, and its name. */
#include "viewer/panes/panes.h"

#include "viewer/pictures/cells.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COARSE = 2 /* pixels of the pane per pixel of the shadow */, OPACITY = 80 /* of 255, within the outline */ };

/* Finds the cells anew where another area is chosen, or the atlas changed. */
static void find_cells(struct shadow *shadow, struct viewer *viewer)
{
    bool same = shadow->of == viewer->drawn && shadow->chosen == viewer->drawn->shown.chosen &&
                shadow->atlas_number == viewer->atlas_number;
    if (same) {
        return;
    }
    bool *wanted = outline_wanted(viewer);
    cells_finish(&shadow->cells);
    shadow->of = viewer->drawn;
    shadow->chosen = viewer->drawn->shown.chosen;
    shadow->atlas_number = viewer->atlas_number;
    shadow->width = 0;
    if (wanted && cells_find(&shadow->cells, viewer->drawn->atlas, wanted)) { /* said once */
        viewer_say(viewer, "%s", conus_message());
    }
    free(wanted);
}

/* Draws the shadow in its colour, with its outline. */
static void cast(struct window *window, uint32_t width, uint32_t height)
{
    struct shadow *shadow = &window->pictures.shadow;
    uint8_t *mask = calloc((size_t)width * height + 1, 1);
    uint8_t *rgba = malloc((size_t)4 * width * height + 1);
    shadow->top.is_there = false;
    shadow->width = width;
    shadow->height = height;
    shadow->eye = window->pictures.eye;
    if (mask && rgba) {
        uint8_t rgb[3];
        viewer_colour(rgb, window->viewer, shadow->chosen);
        cells_cast(mask, width, height, &shadow->cells, &shadow->eye);
        /* Only the outline of a bundle, since its streamlines may have colours of their own. */
        bool is_bundle = conus_atlas_object(shadow->of->atlas, shadow->chosen)->kind == CONUS_KIND_BUNDLE;
        for (size_t pixel = 0; pixel < (size_t)width * height; pixel++) {
            memcpy(rgba + 4 * pixel, rgb, 3);
            rgba[4 * pixel + 3] = mask[pixel] && !is_bundle ? OPACITY : 0;
        }
        outline_draw(rgba, &shadow->top, mask, width, height);
        texture_set(&shadow->texture, rgba, width, height, true);
    }
    free(mask);
    free(rgba);
}

void pane_chosen_name(struct window *window)
{
    const struct shadow *shadow = &window->pictures.shadow;
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    if (shadow->cells.count && shadow->top.is_there) {
        char title[VIEW_ATLAS_TITLE];
        const float at[2] = {box->x + (float)(COARSE * shadow->top.x), box->y + (float)(COARSE * shadow->top.y)};
        pane_name(&window->frame.labels, box, at, true, theme_shaded[THEME_AMBER], shadow->chosen,
                  view_atlas_title(title, window->viewer->drawn, shadow->chosen));
    }
}

void pane_name(struct labels *labels, const struct ui_box *box, const float at[2], bool above, ui_colour colour,
               uint32_t object, const char *name)
{
    char shown[PANE_NAME];
    struct ui_box place;
    /* the brain stays to be seen, but in narrow panes */
    ui_shorten_name(shown, sizeof shown, name, fminf(box->width - 14, fmaxf(0.4F * box->width, 12 * ui_line())));
    const float size[2] = {ui_text_width(shown), ui_line()};
    if (labels_place(&place, labels, box, at, size, above, object)) {
        const float end[2] = {fmaxf(fminf(at[0], place.x + place.width), place.x),
                              fmaxf(fminf(at[1], place.y + place.height), place.y)};
        ui_draw_line(at, end, colour, 1);
        ui_draw_text((float[]){place.x, place.y}, colour, shown);
    }
}

void pane_chosen(struct window *window)
{
    struct shadow *shadow = &window->pictures.shadow;
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    uint32_t width = (uint32_t)fmaxf(box->width / COARSE, 1);
    uint32_t height = (uint32_t)fmaxf(box->height / COARSE, 1);
    find_cells(shadow, window->viewer);
    if (!shadow->cells.count) {
        return;
    }
    if (shadow->width != width || shadow->height != height || !eye_is_same(&shadow->eye, &window->pictures.eye)) {
        cast(window, width, height);
    }
    if (shadow->top.is_there) {
        ui_draw_overlay(shadow->texture.name, *box);
    }
}

void pane_point(float out[2], const struct pane_plane *plane, const double world[3])
{
    const conus_cut_view *view = &plane->view;
    double right = 0;
    double up = 0;
    for (int a = 0; a < 3; a++) {
        right += (world[a] - view->centre[a]) * view->right[a];
        up += (world[a] - view->centre[a]) * view->up[a];
    }
    out[0] = plane->box.x + plane->box.width / 2 + (float)(right / view->mm_per_pixel);
    out[1] = plane->box.y + plane->box.height / 2 - (float)(up / view->mm_per_pixel);
}

void pane_measured(const struct viewer *viewer, struct labels *labels, const struct ui_box *box, float ends[2][2])
{
    const ui_colour colour = theme_shaded[THEME_GREEN];
    const float middle[2] = {(ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2};
    char text[48];
    for (uint32_t i = 0; i < viewer->measure.count; i++) {
        ui_draw_circle(ends[i], 4, colour, 2);
    }
    if (viewer->measure.count == 2) {
        snprintf(text, sizeof text, "%.2f mm", viewer_distance(viewer));
        ui_draw_line(ends[0], ends[1], colour, 2);
        pane_name(labels, box, middle, true, colour, 0, text);
    }
}
