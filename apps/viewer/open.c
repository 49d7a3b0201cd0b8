/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads an atlas while the window says how far that is, and puts it in place of the one before. */
#include "viewer/open.h"

#include "common/messages.h"
#include "settings/atlas_name.h"
#include "settings/atlas_notes.h"
#include "viewer/loader.h"
#include "viewer/loop.h"
#include "viewer/session/session.h"
#include "viewer/window/screen.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Between two looks at how far loading is. */
static const double progress_s = 0.1;

/* ---- Loading ----------------------------------------------------------------------------------------------------- */

/* What is read, and a bar of the files that are. */
static void draw_progress(const struct window *window, const struct loader_progress *progress, double seconds)
{
    static const ui_colour light = {235, 235, 240, 255};
    static const ui_colour dim = {255, 255, 255, 25};
    static const ui_colour full = {66, 150, 250, 255};
    float line = ui_line();
    float wide = fminf(420 * window->scale, 0.8F * (float)window->width);
    struct ui_box bar = {((float)window->width - wide) / 2, (float)window->height / 2, wide, 0.4F * line};
    char text[160];
    snprintf(text, sizeof text, "reading %s   %.1f s", progress->file, seconds);
    ui_draw_text((float[]){bar.x + 3, bar.y - 1.5F * line}, light, text);
    ui_draw_box(bar, dim, 0);
    bar.width *= (float)progress->part;
    ui_draw_box(bar, full, 0);
}

static void draw_loading(struct window *window, struct loader *loader, double seconds)
{
    struct loader_progress progress;
    loader_ask(loader, &progress);
    window_lay_out(window);
    window_clear(window);
    ui_begin();
    ui_panel("loading", (struct ui_box){0, 0, (float)window->width, (float)window->height}, UI_PLAIN);
    draw_progress(window, &progress, seconds);
    ui_panel_end();
    ui_end();
    glfwSwapBuffers(window->handle);
}

/* Waits for the atlas with the window open. NULL: nobody wants it any more, or `why` has the reason. */
static conus_atlas *load(struct window *window, const struct loading *what, char why[LOADER_WHY])
{
    struct loader *loader = NULL;
    double begun = glfwGetTime();
    if (!loader_start(&loader, what)) {
        print_error_line("not enough memory");
        snprintf(why, LOADER_WHY, "not enough memory");
        return NULL;
    }
    while (!loader_done(loader) && !glfwWindowShouldClose(window->handle)) {
        if (window->wanted) {
            loader_cancel(loader);
        }
        draw_loading(window, loader, glfwGetTime() - begun);
        glfwWaitEventsTimeout(progress_s);
    }
    if (glfwWindowShouldClose(window->handle)) { /* the file that is being read is read to its end */
        loader_cancel(loader);
        glfwHideWindow(window->handle);
    }
    return loader_finish(loader, why);
}

/* ---- Opening ----------------------------------------------------------------------------------------------------- */

static void set_head(struct head *head, const struct station_settings *settings)
{
    double enlarged = settings->enlarged > 0 ? settings->enlarged : 1;
    head->named = head->on = settings->head;
    head->size[0] = settings->screen_mm[0] / enlarged; /* in the world */
    head->size[1] = settings->screen_mm[1] / enlarged;
}

static void finish(struct viewer *viewer)
{
    if (viewer) {
        viewer_finish(viewer);
        free(viewer);
    }
}

/* Takes the atlas over, also where there is not enough memory. */
static struct viewer *create(conus_atlas *atlas, const char *path, const struct view_settings *settings)
{
    struct viewer *viewer = malloc(sizeof *viewer);
    settings_say_notes(atlas, &settings->common);
    if (settings->safe_colours) {
        conus_atlas_use_safe_colours(atlas);
    }
    if (!viewer ||
        viewer_create(viewer, atlas, path, settings->transfer, settings->common.verbose ? log_line : NULL, loop_wake)) {
        print_error_line("not enough memory");
        conus_atlas_destroy(atlas);
        free(viewer);
        return NULL;
    }
    viewer->display.safe_colours = settings->safe_colours;
    set_head(&viewer->head, &settings->station);
    return viewer;
}

/* Shows it as the options say; false where the session does not fit. */
static bool show(struct window *window, struct viewer *viewer, const struct view_settings *settings, char *why)
{
    window_show(window, viewer);
    viewer->cone.pointer = window->station ? POINT_BY_TRACKER : window->replay.poses ? POINT_BY_REPLAY : POINT_BY_MOUSE;
    if (window->replay.poses) {
        replay_show(&window->replay, viewer, 0);
    }
    if (settings->session && !session_load(window, settings->session, why)) {
        print_error_line("%s", why);
        return false;
    }
    if (settings->full_screen) {
        window_fill_screen(window, true);
    }
    return true;
}

/* Those were for another atlas, which may be of another brain, with other names. */
static void leave_options(struct view_settings *settings)
{
    settings->atlas = (struct atlas_settings){.max_memory = settings->atlas.max_memory};
    settings->context = settings->transfer = settings->session = NULL;
}

static bool open_path(struct window *window, const char *path, struct view_settings settings, char *why)
{
    struct viewer *before = window->viewer;
    if (before) {
        settings.safe_colours = before->display.safe_colours;
        settings.full_screen = false;
    }
    const struct loading what = {path, &settings.atlas, settings.context, glfwPostEmptyEvent};
    conus_atlas *atlas = load(window, &what, why);
    struct viewer *viewer = atlas ? create(atlas, path, &settings) : NULL;
    if (before && viewer) {
        viewer->display.radiological = before->display.radiological;
    }
    if (atlas && !viewer) {
        snprintf(why, LOADER_WHY, "%s", error_line());
    }
    bool fine = viewer && show(window, viewer, &settings, why);
    if (viewer && !fine) { /* of the session: nothing was open before */
        window_show(window, NULL);
    }
    finish(fine ? before : viewer);
    return fine;
}

/* Opens what the user named, a path or an installed atlas, whose path is what is remembered. */
static bool open_named(struct window *window, const char *text, struct view_settings *settings, bool remember,
                       char why[LOADER_WHY])
{
    struct atlas_name name;
    bool fine = atlas_name_find(&name, text) == EXIT_DONE;
    if (fine) {
        settings->atlas.labels = atlas_name_labels(&name, settings->atlas.labels);
        fine = open_path(window, name.path, *settings, why);
    } else {
        snprintf(why, LOADER_WHY, "%s", error_line());
    }
    if (fine && remember) {
        recent_add(name.path);
    }
    atlas_name_finish(&name);
    return fine;
}

bool open_wanted(struct window *window, const struct view_settings *settings, bool with_options, double begun)
{
    struct view_settings used = *settings;
    char why[LOADER_WHY] = "";
    char *path = window->wanted;
    bool (*press)(struct window *, const char *) = window->press;
    window->wanted = NULL;
    window->press = NULL;
    if (!with_options) {
        leave_options(&used);
    }
    bool fine = open_named(window, path, &used, !settings->script, why);
    window->press = press;
    if (fine) {
        times_start(&window->times, begun);
    } else if (why[0]) {
        window_say(window, why);
    }
    free(path);
    return fine;
}

void open_finish(struct window *window)
{
    struct viewer *viewer = window->viewer;
    window->press = NULL;
    window_show(window, NULL);
    finish(viewer);
}
