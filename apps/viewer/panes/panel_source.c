/* SPDX-License-Identifier: BSD-3-Clause */
/* Where poses come from: the replay's time line, the tracker's state. */
#include "viewer/panes/panels.h"

#include "settings/station_settings.h"

#include <GLFW/glfw3.h>
#include <math.h>

static void show_replay(struct window *window)
{
    struct replay *replay = &window->inputs.replay;
    size_t count = replay->poses ? conus_pose_list_count(replay->poses) : 0;
    if (!count) {
        ui_text("no poses: start with --poses FILE");
        return;
    }
    uint32_t row = (uint32_t)replay->at + 1;
    if (ui_button(replay->playing ? "stop" : "play")) {
        replay_toggle(replay, glfwGetTime());
    }
    ui_tip("the poses one after the other, at their times");
    ui_same_line();
    if (ui_count("row", &row, 1, (uint32_t)count)) {
        replay->playing = false;
        replay_show(replay, window->viewer, row - 1);
    }
    ui_tip("the pose of the file, by its number from 1");
    ui_text("%.2f of %.2f s, %s", replay_time(replay, replay->at), replay_time(replay, count - 1),
            conus_pose_list_row(replay->poses, replay->at)->id);
}

static void show_tracker(struct window *window)
{
    static const enum theme_text colours[] = {THEME_HINT, THEME_HINT, THEME_RED, THEME_RED, THEME_GREEN};
    char text[160];
    if (!window->inputs.station) {
        ui_text("no tracker: start with --listen or --connect");
        return;
    }
    settings_station_text(text, sizeof text, window->inputs.station, &window->inputs.news);
    ui_text_coloured(theme_texts[colours[window->inputs.news.state]], "%s", text);
}

void panel_source(struct window *window)
{
    if (window->viewer->tools[FIRST_TOOL].pointer == POINT_BY_REPLAY) {
        show_replay(window);
    } else if (window->viewer->tools[FIRST_TOOL].pointer == POINT_BY_TRACKER) {
        show_tracker(window);
    }
    panel_speed(window, window->viewer->tools[FIRST_TOOL].pointer);
}

void panel_speed(struct window *window, enum pointer pointer)
{
    double speed = devices_speed(&window->inputs.devices);
    if (pointer < POINT_BY_SPACEMOUSE) {
        return;
    }
    if (ui_slider("speed", &speed, SOURCE_LEAST_SPEED, SOURCE_MOST_SPEED, "%.0f mm/s", true)) {
        devices_set_speed(&window->inputs.devices, speed);
        window->viewer->version++;
    }
    panel_tip(PROPERTY_SPEED);
}
