/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks for what the second tool's cone hits. */
#include "viewer/tools/second.h"

#include "link/clock.h"

#include <math.h>
#include <stdlib.h>

static const double default_angle = 5; /* degrees, as of the first */

void second_forget(struct second *second)
{
    for (size_t i = 0; i < second->atlas_count; i++) {
        answer_drop(second->answers[i]);
    }
    free((void *)second->answers);
    second->answers = NULL;
    second->atlas_count = 0;
    second->is_asked = false;
    second->answer_number++;
}

void second_touch(struct second *second)
{
    second->is_asked = false;
    second->version++;
}

void second_use(struct second *second, struct viewer *viewer, bool on)
{
    bool is_taken = second->pointer == viewer->cone.pointer && second->pointer != POINT_BY_TRACKER;
    second->on = on;
    if (!on) {
        second_forget(second);
    } else if (is_taken) {
        second->pointer = second->pointer == POINT_BY_WAND ? POINT_BY_MOUSE : POINT_BY_WAND;
    }
    second_touch(second);
}

void second_aim(struct second *second, const conus_pose *pose)
{
    second->pose = *pose;
    second->has_pose = true;
    second_touch(second);
}

double second_angle(const struct second *second)
{
    return second->angle > 0 ? second->angle : default_angle;
}

double second_question(conus_selector_options *options, const struct second *second, const struct viewer *viewer,
                       size_t index)
{
    double first = viewer_question(options, viewer, index);
    return options->radius > 0 || viewer->cone.one_ray ? first
                                                       : second_angle(second) * (M_PI / 180); /* as conus query */
}

/* Both tools share the selector, which is the same for the same options. */
static struct answer *ask(const struct second *second, struct viewer *viewer, size_t index)
{
    struct view_atlas *on = &viewer->atlases[index];
    conus_selector_options options;
    conus_selection *selection = NULL;
    double angle = second_question(&options, second, viewer, index);
    conus_status status = view_atlas_prepare(on, &options);
    status = status ? status : conus_select(&selection, on->selector, &second->pose, angle);
    struct answer *answer = status ? NULL : answer_create(selection);
    if (!answer) {
        conus_selection_destroy(selection);
        viewer_say(viewer, "second tool: %s",
                   status && status != CONUS_ERROR_MEMORY ? conus_message() : "not enough memory");
    }
    return answer;
}

void second_update(struct second *second, struct viewer *viewer)
{
    bool is_asked = second->is_asked && second->asked_after == viewer->cone.answer_number;
    if (!second->on || is_asked) {
        return;
    }
    double begun = clock_ms();
    second_forget(second);
    second->answers = second->has_pose ? calloc(viewer->atlas_count, sizeof(struct answer *)) : NULL;
    second->atlas_count = second->answers ? viewer->atlas_count : 0;
    for (size_t i = 0; i < second->atlas_count; i++) {
        second->answers[i] = ask(second, viewer, i);
    }
    second->is_asked = true;
    second->asked_after = viewer->cone.answer_number;
    second->select_ms = clock_ms() - begun;
    second->version++;
}

const conus_selection *second_selection(const struct second *second, size_t atlas)
{
    return atlas < second->atlas_count ? answer_selection(second->answers[atlas]) : NULL;
}
