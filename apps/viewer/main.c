/* SPDX-License-Identifier: BSD-3-Clause */
/* conus-view: the window. Its options are read and explained by the same tables as those of conus. */
#include "common/messages.h"
#include "pages/pages.h"
#include "settings/atlas_notes.h"
#include "settings/settings.h"
#include "settings/station_settings.h"
#include "viewer/keys.h"
#include "viewer/loader.h"
#include "viewer/loop.h"
#include "viewer/session/session.h"
#include "viewer/window/screen.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Between two looks at how far loading is. */
static const double progress_s = 0.1;

enum { DEFAULT_WIDTH = 1500, DEFAULT_HEIGHT = 940 };

struct view_settings {
    struct atlas_settings atlas;
    struct common_settings common;
    struct station_settings station;
    const char *poses;
    const char *context, *transfer, *script, *session;
    uint32_t size[2];
    double scale;
    bool hidden, safe_colours, full_screen;
};

static const struct option own_options[] = {
    {.name = "context",
     .type = OPTION_TEXT,
     .offset = offsetof(struct view_settings, context),
     .value = "FILE",
     .help = "scalar map to draw around the areas, such as a T1; replaces the manifest's"},
    {.name = "transfer",
     .type = OPTION_TEXT,
     .offset = offsetof(struct view_settings, transfer),
     .value = "NAME|FILE",
     .help = "transfer function of the context in 3-D, as for conus render"},
    {.name = "size",
     .type = OPTION_SIZE,
     .offset = offsetof(struct view_settings, size),
     .value = "WxH",
     .help = "size of the window, pixels (default 1500x940)",
     .low = 1,
     .high = 16384},
    {.name = "scale",
     .type = OPTION_NUMBER,
     .offset = offsetof(struct view_settings, scale),
     .value = "FACTOR",
     .help = "scale of texts and panels, 0.5 to 4 (default: the screen's)",
     .low = 0.5,
     .high = 4},
    {.name = "session",
     .type = OPTION_TEXT,
     .offset = offsetof(struct view_settings, session),
     .value = "FILE.json",
     .help = "open as a saved session was left"},
    {.name = "script",
     .type = OPTION_TEXT,
     .offset = offsetof(struct view_settings, script),
     .value = "FILE",
     .help = "do what the file says (docs/viewer.md), then close"},
    {.name = "poses",
     .type = OPTION_TEXT,
     .offset = offsetof(struct view_settings, poses),
     .value = "FILE",
     .help = "poses to replay, on a time line"},
    {.name = "safe-colours",
     .type = OPTION_FLAG,
     .offset = offsetof(struct view_settings, safe_colours),
     .help = "colours for any colour vision, instead of the atlas's own"},
    {.name = "full-screen",
     .type = OPTION_FLAG,
     .offset = offsetof(struct view_settings, full_screen),
     .help = "start with the 3-D pane alone, over the screen that the window was on (F11)"},
    {.name = "hidden",
     .type = OPTION_FLAG,
     .offset = offsetof(struct view_settings, hidden),
     .help = "with --script: do not show the window (it still needs a display)"},
    {0},
};

static const struct option_group groups[] = {
    {"What is shown", own_options, 0},
    {"", atlas_options, offsetof(struct view_settings, atlas)},
    {"", shown_options, offsetof(struct view_settings, atlas)},
    {"A tracker that points", station_options_table, offsetof(struct view_settings, station)},
    {"A tracked head", screen_options_table, offsetof(struct view_settings, station)},
    {"", quiet_options, offsetof(struct view_settings, common)},
    {0},
};

/* ---- The loop ---------------------------------------------------------------------------------------------------- */

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

/* Waits for the atlas with the window open. NULL: it was closed, or it was said why. */
static conus_atlas *wait_for_atlas(struct window *window, const struct loading *what)
{
    struct loader *loader = NULL;
    double begun = glfwGetTime();
    if (!loader_start(&loader, what)) {
        print_error_line("not enough memory");
        return NULL;
    }
    while (!loader_done(loader) && !glfwWindowShouldClose(window->handle)) {
        draw_loading(window, loader, glfwGetTime() - begun);
        glfwWaitEventsTimeout(progress_s);
    }
    if (glfwWindowShouldClose(window->handle)) { /* the file that is being read is read to its end */
        loader_cancel(loader);
        glfwHideWindow(window->handle);
    }
    return loader_finish(loader);
}

static void set_head(struct head *head, const struct station_settings *settings)
{
    double enlarged = settings->enlarged > 0 ? settings->enlarged : 1;
    head->named = head->on = settings->head;
    head->size[0] = settings->screen_mm[0] / enlarged; /* in the world */
    head->size[1] = settings->screen_mm[1] / enlarged;
}

static int run_window(struct window *window, const struct view_settings *settings, const char *path,
                      struct script *script)
{
    const struct loading what = {path, &settings->atlas, settings->context, glfwPostEmptyEvent};
    struct viewer viewer;
    conus_atlas *atlas = wait_for_atlas(window, &what);
    if (!atlas) {
        return glfwWindowShouldClose(window->handle) ? EXIT_DONE : EXIT_DATA;
    }
    settings_say_notes(atlas, &settings->common);
    if (settings->safe_colours) {
        conus_atlas_use_safe_colours(atlas);
    }
    if (viewer_create(&viewer, atlas, path, settings->transfer, settings->common.verbose ? log_line : NULL,
                      loop_wake)) {
        print_error_line("not enough memory");
        conus_atlas_destroy(atlas);
        return EXIT_DATA;
    }
    viewer.display.safe_colours = settings->safe_colours;
    set_head(&viewer.head, &settings->station);
    window->viewer = &viewer;
    window->press = keys_press;
    window_fill_screen(window, settings->full_screen);
    viewer.cone.pointer = window->station ? POINT_BY_TRACKER : window->replay.poses ? POINT_BY_REPLAY : POINT_BY_MOUSE;
    if (window->replay.poses) {
        replay_show(&window->replay, &viewer, 0);
    }
    char why[SESSION_REASON];
    int code = EXIT_DATA;
    if (settings->session && !session_load(window, settings->session, why)) {
        print_error_line("%s", why);
    } else {
        code = loop_run(window, script);
    }
    window->press = NULL;
    window->viewer = NULL;
    viewer_finish(&viewer);
    return code;
}

static int start_sources(struct window *window, const struct view_settings *settings)
{
    int code = settings_start_station(&window->station, &settings->station);
    if (window->station) {
        station_on_pose(window->station, loop_wake);
    }
    if (!code && settings->poses) {
        const conus_pose_options options = {.max_memory = settings->atlas.max_memory};
        conus_status status = conus_pose_list_load(&window->replay.poses, settings->poses, &options);
        code = status ? print_status(status) : EXIT_DONE;
        if (!code && !conus_pose_list_count(window->replay.poses)) {
            print_error_line("%s: no poses in it to replay", settings->poses);
            code = EXIT_DATA;
        }
    }
    return code;
}

/* Scripts see the same window everywhere. */
static void find_place(struct place *out, const struct view_settings *settings)
{
    *out = (struct place){.width = DEFAULT_WIDTH, .height = DEFAULT_HEIGHT};
    if (!settings->script) {
        place_load(out);
    }
    if (settings->size[0]) {
        out->width = (int)settings->size[0];
        out->height = (int)settings->size[1];
    }
}

static int run_view(const void *given, const struct arguments *arguments)
{
    const struct view_settings *settings = given;
    double started = clock_ms();
    struct script *script = NULL;
    struct window window;
    struct place place;
    if (!option_needs(arguments, "hidden", "script") || !settings_check_station(arguments) ||
        !settings_check_screen(&settings->station, arguments)) {
        return EXIT_USAGE;
    }
    int code = settings->script ? script_load(&script, settings->script) : EXIT_DONE;
    if (code) {
        return code;
    }
    find_place(&place, settings);
    if (!window_open(&window, &place, settings->scale, settings->hidden)) {
        print_error_line("conus view needs a display and OpenGL 4.5; conus render draws pictures without a window");
        script_destroy(script);
        return EXIT_NO_GL;
    }
    times_start(&window.times, started);
    code = start_sources(&window, settings);
    code = code ? code : run_window(&window, settings, arguments->operands[0], script);
    station_stop(window.station);
    conus_pose_list_destroy(window.replay.poses);
    if (!code && !settings->script) {
        window_place(&window, &place);
        place_save(&place);
    }
    window_close(&window);
    script_destroy(script);
    return code;
}

static const struct command cmd_view = {
    .name = "view",
    .summary = "browse an atlas in a window and point at it",
    .operands = {"ATLAS"},
    .description =
        "Four panes: the brain in 3-D and its axial, coronal and sagittal cuts. The cone follows the mouse, or a\n"
        "wand moved by keys; the areas that it hits are named, ranked and highlighted. Press ? in the window for\n"
        "the keys.",
    .examples =
        "  conus view /usr/share/mricron/templates/aal.nii.gz --context /usr/share/mricron/templates/ch2bet.nii.gz\n",
    .groups = groups,
    .settings_size = sizeof(struct view_settings),
    .run = run_view,
};

int main(int count, char **words)
{
    static const struct command *const commands[] = {&cmd_view, NULL};
    static const struct program program = {.name = "conus-view", .commands = commands, .unnamed = true};
    struct arguments arguments;
    struct view_settings settings = {0};
    int code;
    if (pages_answer(&code, &program, count, words)) {
        return code;
    }
    code = options_parse(&arguments, &settings, &cmd_view, count, words, 1);
    if (code < 0) {
        code = run_view(&settings, &arguments);
    }
    options_finish(&settings, &arguments);
    return code;
}
