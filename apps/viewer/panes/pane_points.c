/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of points over a pane: balls and names as figures have them, a ring around the one that is chosen. */
#include "viewer/panes/panes.h"

#include "base/geometry/math3.h"
#include "base/look.h"
#include "conus/own.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float reach = 9;       /* pixels at scale 1 that the mouse may be beside a ball's middle */
static const double letters = 0.85; /* parts of the panels' lines */

/* What a layer is drawn for, as numbers. */
static void find_key(double key[POINTS_KEY], const struct window *window, const struct ui_box *box,
                     const conus_cut_view *cut)
{
    const struct viewer *viewer = window->viewer;
    const struct eye *eye = &window->pictures.shown;
    const double head[] = {viewer->points.number, viewer->atlas_number,        (double)box->width,
                           (double)box->height,   (double)ui_line(),           viewer->display.backdrop,
                           theme_used(),          viewer->display.own_colours, viewer->chosen_point};
    enum { HEAD = sizeof head / sizeof *head };
    memset(key, 0, POINTS_KEY * sizeof *key);
    memcpy(key, head, sizeof head);
    if (cut) {
        memcpy(key + HEAD, cut->centre, sizeof cut->centre);
        memcpy(key + HEAD + 3, cut->right, sizeof cut->right);
        key[HEAD + 6] = cut->mm_per_pixel;
    } else {
        memcpy(key + HEAD, eye->camera.world_from_device, sizeof eye->camera.world_from_device);
        memcpy(key + HEAD + 16, eye->frustum, sizeof eye->frustum);
    }
}

static void draw_anew(struct point_layer *layer, struct window *window, const struct ui_box *box,
                      const conus_cut_view *cut)
{
    struct viewer *viewer = window->viewer;
    const struct eye *eye = &window->pictures.shown;
    const conus_drawn_point *chosen = points_chosen(viewer);
    conus_image *image = NULL;
    conus_view view = {.width = (uint32_t)fmaxf(box->width, 1),
                       .height = (uint32_t)fmaxf(box->height, 1),
                       .camera = &eye->camera,
                       .selection = answer_selection(viewer_pictured(viewer)),
                       .no_cone = true,
                       .legend = CONUS_LEGEND_NONE,
                       .own_colours = viewer->display.own_colours,
                       .dpi = letters * (double)ui_line() * 72 / LOOK_FIGURE_POINTS,
                       .points = viewer->points.points,
                       .point_count = viewer->points.count};
    if (cut) {
        view.background = CONUS_BACKGROUND_COLOUR; /* black */
    } else {
        memcpy(view.frustum, eye->frustum, sizeof view.frustum);
        backdrop_set(&view, viewer->display.backdrop, theme_used() == THEME_DARK);
    }
    conus_status status = conus_points_image(&image, viewer->drawn->atlas, &view, cut,
                                             chosen ? (size_t)(chosen - viewer->points.points) : SIZE_MAX);
    uint8_t *rgba = status ? NULL : painted_bytes(image);
    if (status) {
        viewer_say(viewer, "%s", conus_message());
    }
    texture_drop(&layer->texture);
    if (rgba) {
        texture_set(&layer->texture, rgba, view.width, view.height, false);
    }
    free(rgba);
    conus_image_destroy(image);
}

/* Where a point is seen, pixels; false where it is not: behind the eye, or too far from the cut. A needle of which the
 * cut has the line alone is where that comes nearest to it, as figures name it there. */
static bool find_place(float out[2], const struct window *window, const conus_drawn_point *point,
                       const struct pane_plane *plane)
{
    if (!plane) {
        return window_point(out, window, point->at);
    }
    const conus_cut_view *view = &plane->view;
    double normal[3];
    double offset[3];
    double way[3];
    double span[2] = {0, 1}; /* the part of the line that is shown */
    double begin = 0;
    double along = 0;
    pane_normal(normal, plane);
    vec3_sub(offset, point->at, view->centre);
    vec3_sub(way, vec3_is_finite(point->end) ? point->end : point->at, point->at);
    const double *axes[] = {view->right, view->up, normal};
    const double limits[] = {view->mm_per_pixel * (double)plane->box.width / 2,
                             view->mm_per_pixel * (double)plane->box.height / 2,
                             fmax(point->radius, CONUS_POINT_NEAR_CUT)};
    for (int a = 0; a < 3; a++) {
        begin = vec3_dot(offset, axes[a]);
        along = vec3_dot(way, axes[a]);
        if (along != 0) {
            span[0] = fmax(span[0], (-copysign(limits[a], along) - begin) / along);
            span[1] = fmin(span[1], (copysign(limits[a], along) - begin) / along);
        } else if (fabs(begin) > limits[a]) {
            return false;
        }
    }
    const double crossing = along != 0 ? -begin / along : 0; /* of the cut */
    vec3_add_scaled(way, point->at, span[0] > 0 ? fmin(fmax(crossing, span[0]), span[1]) : 0, way);
    pane_point(out, plane, way);
    return span[1] > span[0];
}

void pane_points(struct window *window, size_t pane, const struct ui_box *box, const struct pane_plane *plane)
{
    struct point_layer *layer = &window->pictures.points[pane];
    const conus_cut_view *cut = plane ? &plane->view : NULL;
    const conus_drawn_point *chosen = points_chosen(window->viewer);
    double key[POINTS_KEY];
    float at[2];
    if (!window->viewer->points.count) {
        return;
    }
    bool is_same = true;
    find_key(key, window, box, cut);
    for (size_t i = 0; i < POINTS_KEY; i++) {
        is_same = is_same && key[i] == layer->key[i];
    }
    if (!is_same) {
        memcpy(layer->key, key, sizeof key); /* what cannot be drawn is said once */
        draw_anew(layer, window, box, cut);
    }
    if (layer->texture.name) {
        ui_draw_overlay(layer->texture.name, *box);
    }
    if (chosen && find_place(at, window, chosen, plane)) {
        stroke_circle(at, reach, (struct pen){{LOOK_RGB(LOOK_CHOSEN), 255}, 2, window->screen.scale});
    }
}

bool pane_points_choose(struct window *window, const float at[2], const struct pane_plane *plane)
{
    struct viewer *viewer = window->viewer;
    float nearest = reach * window->screen.scale;
    uint32_t row = 0;
    for (size_t i = 0; i < viewer->points.count; i++) {
        float place[2];
        if (find_place(place, window, &viewer->points.points[i], plane) &&
            hypotf(place[0] - at[0], place[1] - at[1]) < nearest) {
            nearest = hypotf(place[0] - at[0], place[1] - at[1]);
            row = viewer->points.rows[i];
        }
    }
    if (row) {
        points_choose(viewer, row);
    }
    return row;
}
