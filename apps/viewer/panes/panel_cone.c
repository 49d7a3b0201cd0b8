/* SPDX-License-Identifier: BSD-3-Clause */
/* The panel of the cone: what moves it, its pose, shape and score, and which hits count. */
#include "conus/own.h"
#include "settings/settings.h"
#include "viewer/model/viewer.h"
#include "viewer/panes/panes.h"
#include "viewer/tools/tools.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void show_replay(struct window *window)
{
    struct replay *replay = &window->inputs.replay;
    size_t count = replay->poses ? conus_pose_list_count(replay->poses) : 0;
    if (!count) {
        ui_text(window->viewer->points.count ? "a row of the list in Points" : "no list: --pose FILE, or --poses FILE");
        return;
    }
    uint32_t row = (uint32_t)replay->at + 1;
    if (ui_button(replay->playing ? "Stop" : "Play", "the poses one after the other, at their times")) {
        replay_toggle(replay, glfwGetTime());
    }
    ui_same_line();
    if (ui_count("Row", &row, 1, (uint32_t)count, "the pose of the file, by its number from 1")) {
        replay->playing = false;
        replay_show(replay, window->viewer, row - 1);
    }
    ui_text("%.2f of %.2f s, %s", replay_time(replay, replay->at), replay_time(replay, count - 1),
            conus_pose_list_row(replay->poses, replay->at)->id);
}

static void show_tracker(struct window *window)
{
    static const enum theme_text colours[] = {THEME_HINT, THEME_HINT, THEME_RED, THEME_RED, THEME_GREEN};
    struct inputs *inputs = &window->inputs;
    char text[256];
    if (inputs->station) {
        station_settings_text(text, sizeof text, inputs->station, &inputs->update);
        ui_text_wrapped(colours[inputs->update.state], text);
        if (ui_button("Disconnect", "ends the connection; the answer from before stays, and is said to be old")) {
            inputs_disconnect(inputs, window->viewer);
        }
    }
    if (inputs->station && !station_host(inputs->station)) { /* it listens */
        return;
    }
    bool entered =
        ui_type("Tracker", inputs->address, sizeof inputs->address, "host:port",
                "the address of a tracker, or of 3D Slicer, that sends OpenIGTLink, as for --connect; Enter connects");
    bool pressed = ui_button("Connect", "connects to it, and tries again until it answers");
    if (entered || pressed) {
        inputs_disconnect(inputs, window->viewer);
        (void)window_connect(window);
    }
}

enum { LEVELS_SHOWN = 24 };

static const double deepest_mm = 300;
static const double least_mm = 0.1; /* between the limits */

static void choose_range(struct viewer *viewer)
{
    double from = viewer->cone.options.range[0];
    double to = viewer->cone.options.range[1];
    bool limited = to > 0;
    if (viewer->cone.options.sampling == CONUS_SAMPLING_SLICES) {
        ui_text("depth limits need exact sampling");
        return;
    }
    if (ui_check("Only some depths", &limited,
                 "only what lies between two depths along the axis, mm from the start, counts (--range);\n"
                 "F4 and F5 move the farther limit, F2 and F3 the nearer one")) {
        (void)(limited ? query_move_range(viewer, 0, 0) : query_set_range(viewer, 0, 0));
        return;
    }
    if (!limited) {
        return;
    }
    bool changed = ui_slider("From depth", &from, 0, deepest_mm, "%.1f mm", true,
                             "mm along the axis from the start: nothing before it counts");
    changed = ui_slider("To depth", &to, least_mm, deepest_mm, "%.1f mm", true,
                        "mm along the axis from the start: nothing behind it counts") ||
              changed;
    if (changed) {
        from = fmin(from, fmax(to - least_mm, 0));
        query_set_range(viewer, from, to);
    }
}

static void choose_depth(struct viewer *viewer, unsigned deepest)
{
    static const char *const names[LEVELS_SHOWN + 1] = {
        "each area", "1, the roots", "2",  "3",  "4",  "5",  "6",  "7",  "8",  "9",  "10", "11", "12",
        "13",        "14",           "15", "16", "17", "18", "19", "20", "21", "22", "23", "24"};
    bool listed = viewer->cone.level[0] && !query_depth(viewer);
    size_t depth = listed ? SIZE_MAX : query_depth(viewer);
    char level[32] = "";
    if (ui_choose(
            "Level", &depth, names, 1 + (deepest < LEVELS_SHOWN ? deepest : LEVELS_SHOWN),
            "areas are reported as the areas that they are part of, at this depth of the tree (--level); F7: the next\n"
            "one. The roots are 1. It holds for the first atlas.")) {
        if (depth) {
            snprintf(level, sizeof level, "%zu", depth);
        }
        query_set_level(viewer, level);
    }
}

/* Lets a list of areas be typed, which holds from Enter on. */
static void type_level(struct viewer *viewer)
{
    char typed[LEVEL_LIMIT] = ""; /* the widget keeps what is being typed */
    if (!query_depth(viewer)) {
        memcpy(typed, viewer->cone.level, sizeof typed);
    }
    bool entered = ui_type(
        "Level by areas", typed, sizeof typed, "Thalamus,Isocortex",
        "areas are reported as the nearest of these that they are part of; names with commas between, then Enter");
    if (entered) {
        query_set_level(viewer, typed);
    }
}

/* Chooses which hits count, and their order: depths, level, list. */
static void choose_hits(struct window *window)
{
    struct viewer *viewer = window->viewer;
    unsigned deepest = query_deepest(viewer);
    choose_range(viewer);
    if (deepest) {
        choose_depth(viewer, deepest);
        type_level(viewer);
    }
    panel_property(window, PROPERTY_ORDER);
}

enum { SCORE_LIMIT = 64 };

static void choose_score(struct viewer *viewer)
{
    const char *names[SCORE_LIMIT];
    size_t count = 0;
    size_t chosen = 0;
    const conus_score_info *info;
    for (size_t i = 0; count < SCORE_LIMIT && (info = conus_score(i)); i++) {
        if (!info->needs_history && !info->needs_weight) {
            chosen = viewer->cone.options.score && strcmp(viewer->cone.options.score, info->name) == 0 ? count : chosen;
            names[count++] = info->name;
        }
    }
    if (ui_choose("Score", &chosen, names, count,
                  "by what the hits are ranked, the best first: conus query --help says what each means")) {
        viewer->cone.options.score = names[chosen];
        tool_reselect(viewer);
    }
}

static void choose_shape(struct window *window)
{
    bool cylinder = window->viewer->cone.options.radius > 0;
    if (ui_check("A cylinder in place of the cone", &cylinder,
                 "in place of the cone a tube around its axis, such as a needle or a probe")) {
        property_set(window, PROPERTY_RADIUS, cylinder ? 2 : 0);
    }
}

static void show_pose(struct viewer *viewer)
{
    const double *m = viewer->tools[FIRST_TOOL].pose.world_from_device;
    double origin[3] = {m[12], m[13], m[14]};
    double along[3] = {-m[8], -m[9], -m[10]};
    if (!viewer->tools[FIRST_TOOL].has_pose) {
        ui_text("no pose yet");
        return;
    }
    conus_space space = viewer->frame.space;
    char label[32] = "From, mm";
    if (space >= CONUS_SPACE_CCF) {
        snprintf(label, sizeof label, "%s %s %s, %s", conus_space_axis(space, 0), conus_space_axis(space, 1),
                 conus_space_axis(space, 2), conus_space_unit(space));
    }
    conus_frame_from_world(origin, &viewer->frame, origin);
    conus_frame_direction_from_world(along, &viewer->frame, along);
    bool moved = ui_numbers(label, origin, viewer_place_format(viewer),
                            "where the cone starts, in the unit of the label beside it; type numbers and press Enter");
    bool turned = ui_numbers("Direction", along, "%.3f",
                             "the direction of the cone's axis, of any length; type numbers and press Enter");
    if ((moved || turned) && viewer_to_world(origin, viewer, origin)) {
        conus_frame_direction_to_world(along, &viewer->frame, along);
        tool_aim_along(viewer, FIRST_TOOL, origin, along);
    }
}

static void choose_pointer(struct window *window)
{
    struct viewer *viewer = window->viewer;
    size_t pointer = (size_t)viewer->tools[FIRST_TOOL].pointer;
    if (ui_choose("Point with", &pointer, pointer_names, POINTER_COUNT,
                  "what moves the cone: the mouse, keys, a file of poses, or a tracked tool")) {
        tool_choose(viewer, FIRST_TOOL, (enum pointer)pointer);
    }
    if (viewer->tools[FIRST_TOOL].pointer == POINT_BY_REPLAY) {
        show_replay(window);
    } else if (viewer->tools[FIRST_TOOL].pointer == POINT_BY_TRACKER) {
        show_tracker(window);
    }
    panel_speed(window, viewer->tools[FIRST_TOOL].pointer);
}

enum { FOUND_SHOWN = 5 };

/* Lists the areas that fit best where the list of areas, which has them all, is folded. */
static void search_area(struct window *window)
{
    struct viewer *viewer = window->viewer;
    const char *search = viewer->drawn->shown.search;
    ui_take_keys(&window->frame.searches);
    panel_search(viewer, "Search", "area or label",
                 "an area by its name, abbreviation or label; Enter chooses the first; / comes here");
    size_t count = 0;
    uint32_t *found = search[0] && window->screen.folded[0] ? search_all(&count, viewer->drawn->atlas, search) : NULL;
    for (size_t i = 0; i < count && i < FOUND_SHOWN; i++) {
        char title[VIEW_ATLAS_TITLE];
        ui_id(found[i]);
        if (ui_row(view_atlas_title(title, viewer->drawn, found[i]), viewer->drawn->shown.chosen == found[i], 0)) {
            viewer_choose(viewer, found[i]);
        }
        ui_id_end();
    }
    free(found);
}

/* A needle, whose depths count from the surface, has no start before it: what is lit is what is. */
static void choose_start(struct window *window)
{
    const struct property *row = &properties[PROPERTY_START];
    const char *const choices[] = {row->choices[START_SURFACE], row->choices[START_EYE]};
    size_t index = point_start(window->viewer) == START_EYE;
    if (!(window->viewer->cone.options.range[1] > 0)) {
        panel_property(window, PROPERTY_START);
    } else if (ui_choose(row->label, &index, choices, 2, row->tip)) {
        property_set(window, PROPERTY_START, index ? START_EYE : START_SURFACE);
    }
}

void panel_question(struct window *window)
{
    struct viewer *viewer = window->viewer;
    choose_pointer(window);
    panel_property(window, viewer->cone.options.radius > 0 ? PROPERTY_RADIUS : PROPERTY_ANGLE);
    if (viewer->tools[FIRST_TOOL].pointer == POINT_BY_MOUSE) {
        choose_start(window);
    }
    panel_property(window, PROPERTY_LAYERS);
    search_area(window);
}

static void show_times(const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    char device[PAINTER_TEXT];
    char text[PAINTER_TEXT + 128];
    const bool has_device = viewer->painter && painter_text(device, viewer->painter, PAINTER_DEVICE);
    snprintf(text, sizeof text, "frame %.1f ms, picture %.0f ms, selection %.3f ms%s%s", window->frame.ms,
             window->pictures.painted_ms, viewer->tools[FIRST_TOOL].select_ms, has_device ? ", " : "",
             has_device ? device : "");
    ui_text_wrapped(THEME_HINT, text);
}

/* All other settings of the cone and of the hits that count. */
void panel_expert(struct window *window)
{
    struct viewer *viewer = window->viewer;
    show_pose(viewer);
    panel_property(window, PROPERTY_FOLLOW);
    panel_property(window, PROPERTY_ONE_RAY);
    panel_property(window, PROPERTY_DEVICE_VIEW);
    if (!viewer->cone.one_ray) {
        static const enum property_id rows[] = {PROPERTY_RESOLUTION, PROPERTY_APERTURE,       PROPERTY_SAMPLING,
                                                PROPERTY_ENGINE,     PROPERTY_SLICE_FRACTION, PROPERTY_SLICES};
        const size_t count = viewer->cone.options.sampling == CONUS_SAMPLING_SLICES ? 6 : 4;
        choose_shape(window);
        choose_score(viewer);
        for (size_t i = 0; i < count; i++) {
            panel_property(window, rows[i]);
        }
    }
    choose_hits(window);
    show_times(window);
}
