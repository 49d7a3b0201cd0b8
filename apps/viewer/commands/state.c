/* SPDX-License-Identifier: BSD-3-Clause */
/* The numbers of what is shown as JSON. */
#include "viewer/commands/commands.h"

#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>

static json_t *pack_numbers(const struct shown_numbers *shown)
{
    return json_pack("{sI sI sI sI}", "answer", (json_int_t)shown->answer, "plan", (json_int_t)shown->plan, "scene",
                     (json_int_t)shown->scene, "second", (json_int_t)shown->second);
}

static json_t *pack_sum(uint64_t sum)
{
    char text[24];
    snprintf(text, sizeof text, "%016" PRIx64, sum);
    return json_string(text);
}

bool state_write(const struct window *window, const char *path)
{
    static const char *const names[SHOWN_PLACES] = {"list", "labels", "status"};
    const struct viewer *viewer = window->viewer;
    const struct tool *tools = viewer->tools;
    const struct pictures *pictures = &window->pictures;
    const bool is_covered = window->start.on || window->dialog.on;
    const struct painting *drawn = &pictures->drawn;
    const struct shown_numbers is = {true, tools[FIRST_TOOL].answer_number, viewer->plan.number, viewer->scene_number,
                                     tools[SECOND_TOOL].version};
    json_t *state =
        json_pack("{so so s[]}", "is", pack_numbers(&is), "colours", pack_sum(tool_answer_sum(viewer)), "cuts");
    for (size_t i = 0; i < SHOWN_PLACES; i++) {
        if (window->frame.shows[i].is_there) {
            json_object_set_new(state, names[i], pack_numbers(&window->frame.shows[i]));
        }
    }
    if (!is_covered && pictures->painted.name && screen_shows_pane(&window->screen, PANE_3D)) {
        json_object_set_new(state, "picture",
                            json_pack("{sI sI sI}", "answer", (json_int_t)drawn->answer_number, "plan",
                                      (json_int_t)drawn->plan_number, "scene", (json_int_t)drawn->scene_number));
    }
    for (int p = 0; p < PLANE_COUNT; p++) {
        if (!is_covered && screen_shows_pane(&window->screen, p)) {
            json_array_append_new(json_object_get(state, "cuts"), pack_sum(pictures->cuts[p].answer_sum));
        }
    }
    const bool fine = state && !json_dump_file(state, path, JSON_INDENT(1));
    json_decref(state);
    return fine;
}
