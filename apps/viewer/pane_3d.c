/* SPDX-License-Identifier: BSD-3-Clause */
#include "viewer/window.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const ui_colour light = {235, 235, 240, 255};
static const ui_colour dark = {20, 20, 24, 255};
static const ui_colour orange = {255, 150, 30, 255};

static const double rest_ms = 300; /* a cone that others move rests when it stood still for so long */

enum { NAMES_SHOWN = 3, INSET = 7 /* pixels on the screen per pixel of the device's view */ };

/* ---- The picture ------------------------------------------------------------------------------------------------- */

static bool is_same_pose(const conus_pose *a, const conus_pose *b)
{
    bool same = true;
    for (int i = 0; i < 16; i++) {
        same = same && a->world_from_device[i] == b->world_from_device[i];
    }
    return same;
}

static bool is_same(const struct painting *a, const struct painting *b)
{
    return is_same_pose(&a->camera, &b->camera) && a->width == b->width && a->height == b->height &&
           a->fade == b->fade && a->answer_number == b->answer_number && a->scene_number == b->scene_number &&
           a->moving == b->moving;
}

static void ask_painter(struct window *window, bool moving)
{
    struct viewer *viewer = window->viewer;
    const struct ui_box *box = &window->panes[PANE_3D];
    struct painting what = {.field_of_view = viewer->orbit.field_of_view,
                            .width = (uint32_t)fmaxf(box->width, 1),
                            .height = (uint32_t)fmaxf(box->height, 1),
                            .fade = viewer->fade,
                            .answer = viewer->answer,
                            .answer_number = viewer->answer_number,
                            .scene_number = viewer->scene_number,
                            .moving = moving};
    orbit_camera(&what.camera, &viewer->orbit);
    if (viewer->painter && !is_same(&what, &window->asked)) {
        painter_ask(viewer->painter, &what);
        window->asked = what;
        window->painted_fine = false;
    }
}

static void note_picture(struct window *window, double milliseconds)
{
    struct times *times = &window->times;
    times_add(times, TIMED_PICTURE, milliseconds);
    times->first_picture = times->first_picture > 0 ? times->first_picture : times_now() - times->started;
}

static void take_picture(struct window *window)
{
    struct painted picture;
    if (window->viewer->painter && painter_take(window->viewer->painter, &picture)) {
        note_picture(window, picture.milliseconds);
        texture_set(&window->painted, picture.rgba, picture.width, picture.height);
        window->painted_ms = picture.milliseconds;
        window->painted_fine = picture.fine && is_same(&picture.what, &window->asked);
        free(picture.rgba);
    }
}

/* ---- Over it ----------------------------------------------------------------------------------------------------- */

static bool place_of(float out[2], const struct window *window, const double world[3])
{
    const struct ui_box *box = &window->panes[PANE_3D];
    double at[2];
    bool visible =
        orbit_project(at, &window->viewer->orbit, (double[]){(double)box->width, (double)box->height}, world);
    out[0] = box->x + (float)at[0];
    out[1] = box->y + (float)at[1];
    return visible;
}

/* The names of the best results beside their contacts, one below the other where they would overlap. */
static void draw_names(const struct window *window)
{
    const conus_selection *selection = viewer_selection(window->viewer);
    size_t count = conus_selection_count(selection);
    float line = 1.15F * ui_line();
    float taken[NAMES_SHOWN];
    size_t shown = 0;
    for (size_t i = 0; i < count && shown < NAMES_SHOWN; i++) {
        const conus_result *result = conus_selection_result(selection, i);
        float at[2];
        if (result->object && result->pixels && place_of(at, window, result->contact)) {
            float y = at[1] - line / 2;
            for (size_t k = 0; k < shown; k++) {
                y = fabsf(y - taken[k]) < line ? taken[k] + line : y;
            }
            taken[shown++] = y;
            ui_draw_circle(at, 4, light, 1.5F);
            ui_draw_line(at, (float[]){at[0] + 16, y + line / 2}, light, 1);
            ui_draw_text((float[]){at[0] + 18, y}, light,
                         conus_atlas_object(window->viewer->atlas, result->object)->name);
        }
    }
}

/* What the device sees, enlarged: the pixels of its buffer in the areas' colours. */
static void draw_device_view(struct window *window)
{
    const conus_selection *selection = viewer_selection(window->viewer);
    conus_evidence evidence = conus_selection_evidence(selection);
    uint32_t n = evidence.resolution;
    if (n < 1 || n > 64) {
        return;
    }
    uint8_t rgba[64 * 64 * 4];
    for (uint32_t pixel = 0; pixel < n * n; pixel++) {
        uint8_t *to = rgba + 4 * ((n - 1 - pixel / n) * n + pixel % n);
        viewer_colour(to, window->viewer, evidence.object[pixel]);
        if (!evidence.object[pixel]) {
            memset(to, 52, 3);
        }
        for (int c = 0; c < 3 && !evidence.in_cone[pixel]; c++) {
            to[c] = (uint8_t)(to[c] / 4);
        }
        to[3] = 255;
    }
    texture_set(&window->device_view, rgba, n, n);
    const struct ui_box *box = &window->panes[PANE_3D];
    float edge = fminf(INSET * 16 * window->scale, 0.3F * fminf(box->width, box->height));
    struct ui_box inset = {box->x + box->width - edge - 10, box->y + 10, edge, edge};
    ui_surface("inset", inset);
    ui_draw_image(window->device_view.name, inset);
    ui_draw_box(inset, light, 1);
    static const char caption[] = "what the device sees";
    ui_draw_text((float[]){inset.x + edge - ui_text_width(caption), inset.y + edge + 4}, light, caption);
}

static void draw_waiting(const struct window *window)
{
    const struct ui_box *box = &window->panes[PANE_3D];
    char error[256];
    const float at[2] = {box->x + 20, box->y + box->height / 2};
    if (!window->viewer->painter) {
        ui_draw_text(at, orange, "not enough memory to draw");
    } else if (painter_error(window->viewer->painter, error, sizeof error)) {
        ui_draw_text(at, orange, error);
    } else if (!window->painted.name) {
        ui_draw_text(at, light, "drawing ...");
    }
}

/* ---- The mouse --------------------------------------------------------------------------------------------------- */

/* From the eye through the mouse. */
static void find_ray(double eye[3], double direction[3], const struct window *window)
{
    const struct ui_box *box = &window->panes[PANE_3D];
    const struct orbit *orbit = &window->viewer->orbit;
    const struct ui_mouse mouse = ui_mouse_now();
    const double size[2] = {(double)box->width, (double)box->height};
    const double at[2] = {(double)(mouse.x - box->x), (double)(mouse.y - box->y)};
    conus_pose camera;
    orbit_camera(&camera, orbit);
    memcpy(eye, camera.world_from_device + 12, 3 * sizeof *eye);
    orbit_ray(direction, orbit, size, at);
}

static void point(struct window *window)
{
    double eye[3];
    double direction[3];
    find_ray(eye, direction, window);
    viewer_aim_along(window->viewer, eye, direction);
}

/* Names what is under the mouse; where the cone follows the mouse, it has its name there already. */
static void hover(struct window *window)
{
    struct viewer *viewer = window->viewer;
    double eye[3];
    double direction[3];
    find_ray(eye, direction, window);
    window->hovered = viewer_pick(window->hovered_at, viewer, eye, direction);
    window->hovers = window->hovered;
    if (window->hovers) {
        window->hovered_value = viewer_value(viewer, window->hovered, window->hovered_at);
    }
    if (window->hovers && (viewer->pointer != POINT_BY_MOUSE || viewer->frozen)) {
        char tip[HOVER_TEXT];
        window_hover_text(window, tip);
        ui_tip(tip);
    }
}

/* Returns whether the view moves. */
static bool use_mouse(struct window *window)
{
    struct viewer *viewer = window->viewer;
    struct ui_mouse mouse = ui_mouse_now();
    double height = (double)window->panes[PANE_3D].height;
    bool held = ui_surface_held();
    bool moved = mouse.moved_x != 0 || mouse.moved_y != 0;
    if (held && moved && mouse.down[0]) {
        orbit_turn(&viewer->orbit, (double)mouse.moved_x, (double)mouse.moved_y, height);
    } else if (held && moved && (mouse.down[1] || mouse.down[2])) {
        orbit_pan(&viewer->orbit, (double)mouse.moved_x, (double)mouse.moved_y, height);
    } else if (!held && moved && viewer->pointer == POINT_BY_MOUSE && !viewer->frozen) {
        point(window);
    }
    if (mouse.wheel != 0) {
        orbit_zoom(&viewer->orbit, (double)mouse.wheel);
    }
    if (mouse.doubled) {
        viewer_confirm(viewer);
    }
    return moved || mouse.wheel != 0;
}

/* Whether a tracker or a replay moved the cone just now, and will again. */
static bool is_carried(struct window *window)
{
    const struct viewer *viewer = window->viewer;
    double now = times_now();
    if (window->carried_answer != viewer->answer_number) {
        window->carried_answer = viewer->answer_number;
        window->carried_ms = now;
    }
    bool by_others = viewer->pointer == POINT_BY_TRACKER || viewer->pointer == POINT_BY_REPLAY;
    return by_others && now - window->carried_ms < rest_ms;
}

void pane_3d(struct window *window)
{
    const struct ui_box *box = &window->panes[PANE_3D];
    orbit_fit(&window->viewer->orbit, (double[]){(double)box->width, (double)box->height});
    take_picture(window);
    ui_panel("3d", *box, UI_PLAIN);
    ui_draw_box(*box, dark, 0);
    if (window->painted.name) {
        ui_draw_image(window->painted.name, *box);
    }
    bool touched = ui_surface("surface", *box);
    bool moving = touched && use_mouse(window);
    if (touched) {
        hover(window);
    }
    ask_painter(window, moving || is_carried(window));
    ui_clip(*box);
    draw_names(window);
    draw_waiting(window);
    draw_device_view(window);
    ui_clip_end();
    ui_panel_end();
}
