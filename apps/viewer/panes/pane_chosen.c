/* SPDX-License-Identifier: BSD-3-Clause */
/* The chosen area and those of a plan over the picture of the 3-D pane, seen through what lies before them, and their
 * names. */
#include "viewer/panes/panes.h"

#include "base/geometry/math3.h"
#include "base/look.h"
#include "conus/own.h"
#include "viewer/model/viewer.h"
#include "viewer/pictures/pictures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Finds the cells anew where another area is chosen, the plan is another, or the atlas changed. */
static void find_cells(struct shadow *shadow, struct viewer *viewer, enum outline which)
{
    bool is_chosen = which == OUTLINE_CHOSEN;
    uint32_t chosen = is_chosen ? viewer->drawn->shown.chosen : 0;
    unsigned plan = is_chosen ? 0 : viewer->plan.number;
    bool same = shadow->of == viewer->drawn && shadow->chosen == chosen && shadow->plan_number == plan &&
                shadow->atlas_number == viewer->atlas_number;
    if (same) {
        return;
    }
    bool *wanted = outline_wanted(viewer, which);
    cells_finish(&shadow->cells);
    shadow->of = viewer->drawn;
    shadow->chosen = chosen;
    shadow->plan_number = plan;
    shadow->atlas_number = viewer->atlas_number;
    shadow->width = 0;
    if (wanted && cells_find(&shadow->cells, viewer->drawn->atlas, wanted)) { /* said once */
        viewer_say(viewer, "%s", conus_message());
    }
    free(wanted);
    const conus_atlas *atlas = viewer->drawn->atlas;
    shadow->has_middle = !shadow->cells.count && chosen && !conus_atlas_is_hidden(atlas, chosen) &&
                         !conus_atlas_centre(shadow->middle, atlas, chosen);
}

/* Whether something else than its own objects lies before the nearest cell beside a pixel. */
static bool is_hidden(const struct window *window, const struct shadow *shadow, const bool *own, const float *nearest,
                      uint32_t x, uint32_t y, uint32_t beside)
{
    const double *from = shadow->eye.camera.world_from_device + 12;
    double depth = INFINITY;
    double direction[3];
    double at[3];
    uint32_t object;
    for (uint32_t j = y > beside ? y - beside : 0; j <= y + beside && j < shadow->height; j++) {
        for (uint32_t i = x > beside ? x - beside : 0; i <= x + beside && i < shadow->width; i++) {
            depth = fmin(depth, (double)nearest[(size_t)j * shadow->width + i]);
        }
    }
    eye_ray(direction, &shadow->eye, (double[]){shadow->width, shadow->height}, (double[]){x + 0.5, y + 0.5});
    depth -= 2 * shadow->cells.edge; /* what lies beside it is as far */
    return viewer_pick(&object, at, window->viewer, from, direction, depth) && !(object && own[object]);
}

/* Finds where its outline, the pixels of `rgba` that are opaque, is hidden (1) or not (2): dash by dash. */
static void find_hidden(uint8_t *hidden, const struct window *window, const struct shadow *shadow, const bool *own,
                        const uint8_t *rgba, const float *nearest, uint32_t beside)
{
    for (uint32_t y = 0; y < shadow->height; y++) {
        for (uint32_t x = 0; x < shadow->width; x++) {
            size_t pixel = (size_t)y * shadow->width + x;
            if (rgba[4 * pixel + 3] < 255 || hidden[pixel]) {
                continue;
            }
            uint8_t is = is_hidden(window, shadow, own, nearest, x, y, beside) ? 1 : 2;
            for (uint32_t j = y; j < shadow->height && j / OUTLINE_DASH == y / OUTLINE_DASH; j++) {
                uint32_t left = x / OUTLINE_DASH * OUTLINE_DASH;
                for (uint32_t i = left; i < shadow->width && i < left + OUTLINE_DASH; i++) {
                    hidden[(size_t)j * shadow->width + i] = is;
                }
            }
        }
    }
}

/* Draws the outline. What is chosen has no colour within: what lies there in the picture may be another area. */
static void cast(struct window *window, enum outline which, uint32_t width, uint32_t height)
{
    struct shadow *shadow = &window->pictures.shadows[which];
    size_t pixels = (size_t)width * height;
    uint8_t *mask = calloc(pixels + 1, 3); /* and what is hidden of it, and its level */
    uint8_t *rgba = calloc(pixels + 1, 4);
    float *nearest = malloc((pixels + 1) * sizeof *nearest);
    bool *own = outline_wanted(window->viewer, which);
    shadow->top.is_there = false;
    shadow->width = width;
    shadow->height = height;
    shadow->eye = window->pictures.shown;
    if (mask && rgba && nearest && own) {
        for (size_t pixel = 0; pixel < pixels; pixel++) {
            nearest[pixel] = INFINITY;
        }
        const double square = cells_cast(nearest, width, height, &shadow->cells, &shadow->eye);
        const uint32_t reach = outline_reach(square);
        for (size_t pixel = 0; pixel < pixels; pixel++) {
            mask[pixel] = isfinite(nearest[pixel]) != 0;
        }
        outline_smooth(mask, mask + 2 * pixels, width, height, reach);
        outline_draw(rgba, &shadow->top, mask, width, height, &outline_looks[which]);
        find_hidden(mask + pixels, window, shadow, own, rgba, nearest, reach + 1);
        outline_dash(rgba, mask + 2 * pixels, mask + pixels, width, height);
        outline_soften(rgba, mask + 2 * pixels, width, height, &outline_looks[which]);
        texture_set(&shadow->texture, rgba, width, height, true);
    }
    free(mask);
    free(rgba);
    free(nearest);
    free(own);
}

void pane_chosen_names(struct window *window)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    for (enum outline which = OUTLINE_COUNT; which-- > 0;) { /* what is chosen first */
        const struct shadow *shadow = &window->pictures.shadows[which];
        const uint8_t *rgb = outline_looks[which].rgb;
        const ui_colour colour = {rgb[0], rgb[1], rgb[2], 255};
        float at[2] = {box->x + (float)shadow->top.x, box->y + (float)shadow->top.y};
        bool has_outline = shadow->cells.count && shadow->top.is_there;
        if (has_outline || (shadow->has_middle && window_point(at, window, shadow->middle))) {
            char title[VIEW_ATLAS_TITLE];
            const char *name = outline_name(window->viewer, which);
            float scale = window->screen.scale;
            if (!has_outline) {
                stroke_circle(at, 4, (struct pen){colour, 1.5F, scale});
            }
            pane_name(&window->frame.labels, box, at,
                      &(struct pane_name){.name = name ? name
                                                       : view_atlas_title(title, window->viewer->drawn, shadow->chosen),
                                          .object = shadow->chosen,
                                          .colour = colour,
                                          .above = has_outline,
                                          .scale = scale});
        }
    }
}

void pane_name(struct labels *labels, const struct ui_box *box, const float at[2], const struct pane_name *what)
{
    char shown[PANE_NAME];
    struct ui_box place;
    float phase = 0;
    if (labels->high > 0) {
        ui_push_letters(what->name, labels->high);
    }
    const float edge = what->chip.a ? 0.7F * ui_line() : 0;
    const float before = what->chip.a ? edge + 4 : 0;
    ui_colour colour = what->colour;
    colour.a = what->is_hidden ? (uint8_t)(255 * theme_pale) : colour.a;
    const struct pen pen = {colour, 1, what->scale};
    /* the brain stays to be seen, but in narrow panes */
    ui_shorten_name(shown, sizeof shown, what->name, fminf(box->width - 14, fmaxf(0.4F * box->width, 12 * ui_line())));
    const float size[2] = {before + ui_text_width(shown), ui_line()};
    if (labels_place(&place, labels, box, at, size, what->above, what->object)) {
        const float end[2] = {fmaxf(fminf(at[0], place.x + place.width), place.x),
                              fmaxf(fminf(at[1], place.y + place.height), place.y)};
        if (what->is_hidden) {
            stroke_dashes(&phase, at, end, pen);
        } else {
            stroke_line(at, end, pen);
        }
        if (what->chip.a) {
            ui_draw_box((struct ui_box){place.x - 3, place.y - 1, before + 3, ui_line()}, theme_surfaces[THEME_SHADE],
                        0);
            ui_draw_box((struct ui_box){place.x, place.y + (ui_line() - edge) / 2, edge, edge}, what->chip, 0);
        }
        ui_draw_text((float[]){place.x + before, place.y}, colour, shown);
    }
    if (labels->high > 0) {
        ui_pop_letters();
    }
}

void pane_chosen(struct window *window)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    uint32_t width = (uint32_t)fmaxf(box->width, 1);
    uint32_t height = (uint32_t)fmaxf(box->height, 1);
    for (enum outline which = 0; which < OUTLINE_COUNT; which++) {
        struct shadow *shadow = &window->pictures.shadows[which];
        find_cells(shadow, window->viewer, which);
        if (shadow->cells.count && (shadow->width != width || shadow->height != height ||
                                    !eye_is_same(&shadow->eye, &window->pictures.shown))) {
            cast(window, which, width, height);
        }
        if (shadow->cells.count && shadow->top.is_there) {
            ui_draw_overlay(shadow->texture.name, *box);
        }
    }
}

static const double faded = 25;   /* mm: a line so far from a cut is not drawn in it */
static const double piece_mm = 1; /* of a line in a cut, which are firm or faint */

void pane_point(float out[2], const struct pane_plane *plane, const double world[3])
{
    const conus_cut_view *view = &plane->view;
    double offset[3];
    vec3_sub(offset, world, view->centre);
    const double right = vec3_dot(offset, view->right);
    const double up = vec3_dot(offset, view->up);
    out[0] = plane->box.x + plane->box.width / 2 + (float)(right / view->mm_per_pixel);
    out[1] = plane->box.y + plane->box.height / 2 - (float)(up / view->mm_per_pixel);
}

void pane_normal(double out[3], const struct pane_plane *plane)
{
    vec3_cross(out, plane->view.right, plane->view.up);
}

/* Half of the longest edge of the first volume's voxels, mm; of an atlas without one, half a mm. */
static double half_slice(const conus_atlas *atlas)
{
    const conus_volume_info *volume = conus_atlas_volume(atlas, 0);
    return volume ? fmax(fmax(volume->spacing[0], volume->spacing[1]), volume->spacing[2]) / 2 : 0.5;
}

/* How far a place of the needle is from a cut, with a sign. */
static double from_cut(const double place[3], const struct pane_plane *plane)
{
    double normal[3];
    double offset[3];
    pane_normal(normal, plane);
    vec3_sub(offset, place, plane->view.centre);
    return vec3_dot(offset, normal);
}

double pane_line_cut(const struct window *window, const struct pane_plane *plane, const double from[3],
                     const double to[3], double radius, struct pen pen)
{
    const double in_cut = fmax(radius, half_slice(window->viewer->drawn->atlas));
    double whole[3];
    vec3_sub(whole, to, from);
    const double length = vec3_length(whole);
    const double piece = fmax(piece_mm, length / 1000); /* sessions may have any places */
    const int count = (int)ceil(length / piece);
    int firm = 0;
    for (int i = 0; i < count; i++) {
        double place[3];
        double away = 0;
        float ends[2][2];
        for (int e = 0; e < 2; e++) {
            vec3_add_scaled(place, from, fmin(piece * (i + e) / length, 1), whole);
            pane_point(ends[e], plane, place);
            away += from_cut(place, plane) / 2;
        }
        away = fabs(away);
        firm += away <= in_cut;
        if (away <= in_cut) {
            stroke_line(ends[0], ends[1], pen);
        } else if (away < faded) {
            ui_colour faint = pen.colour;
            faint.a = (uint8_t)(204 * (1 - away / faded) + 0.5);
            ui_draw_line(ends[0], ends[1], faint, pen.scale);
        }
    }
    return count ? (double)firm / count : 0;
}

bool pane_is_in_cut(const struct window *window, const struct pane_plane *plane, const double place[3], double radius)
{
    return fabs(from_cut(place, plane)) <= fmax(radius, half_slice(window->viewer->drawn->atlas));
}

void pane_measured(const struct window *window, struct labels *labels, const struct ui_box *box,
                   const struct pane_plane *plane, float ends[2][2])
{
    const struct viewer *viewer = window->viewer;
    const double *places = viewer->measure.points;
    const struct pen pen = {{LOOK_RGB(LOOK_OVER), 255}, 2, window->screen.scale};
    const float middle[2] = {(ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2};
    double firm = 1;
    char text[48];
    for (uint32_t i = 0; i < viewer->measure.count; i++) {
        if (!plane || pane_is_in_cut(window, plane, places + (size_t)3 * i, 0)) {
            stroke_circle(ends[i], 4, pen);
        }
    }
    if (viewer->measure.count < 2) {
        return;
    }
    if (plane) {
        firm = pane_line_cut(window, plane, places, places + 3, 0, pen);
    } else {
        stroke_line(ends[0], ends[1], pen);
    }
    if (firm > 0) {
        snprintf(text, sizeof text, "%.2f mm%s", viewer_distance(viewer), firm < 1 ? " in 3-D" : "");
        pane_name(labels, box, middle,
                  &(struct pane_name){.name = text, .colour = pen.colour, .above = true, .scale = pen.scale});
    }
}
