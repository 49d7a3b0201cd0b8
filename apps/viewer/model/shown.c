/* SPDX-License-Identifier: BSD-3-Clause */
/* Hiding and showing areas and pathways. */
#include "viewer/model/viewer.h"

#include <stdlib.h>
#include <string.h>

bool shown_init(struct shown_objects *out, const conus_atlas *atlas)
{
    size_t count = conus_atlas_object_count(atlas);
    *out = (struct shown_objects){.hidden = calloc(count + 1, sizeof *out->hidden)};
    for (size_t number = 1; out->hidden && number <= count; number++) {
        out->hidden[number] = conus_atlas_is_hidden(atlas, number);
    }
    return out->hidden;
}

void shown_finish(struct shown_objects *shown)
{
    free(shown->hidden);
}

/* What is hidden is not in the atlas: it is not hit, not drawn, and blocks nothing. */
static void hide_in_atlas(struct viewer *viewer, struct view_atlas *on)
{
    if (viewer->painter) {
        painter_hold(viewer->painter);
    }
    studier_hold(viewer->study.studier);
    view_atlas_rest(on);
    viewer->atlas_number++;
    if (conus_atlas_set_hidden(on->atlas, on->shown.hidden)) {
        viewer_say(viewer, "%s", conus_message());
        for (size_t number = 1; number <= on->object_count; number++) {
            on->shown.hidden[number] = conus_atlas_is_hidden(on->atlas, number);
        }
    }
    if (viewer->painter) {
        painter_resume(viewer->painter);
    }
    studier_resume(viewer->study.studier);
    viewer->scene_number++;
    viewer_reselect(viewer);
}

bool viewer_is_below(const struct viewer *viewer, uint32_t object, uint32_t ancestor)
{
    while (object && object != ancestor) {
        object = conus_atlas_object(viewer->drawn->atlas, object)->parent;
    }
    return object;
}

enum shown viewer_shown(const struct viewer *viewer, uint32_t object)
{
    bool any = false;
    bool all = true;
    for (uint32_t number = 1; number <= viewer->drawn->object_count; number++) {
        if (viewer_is_below(viewer, number, object)) {
            any = any || !viewer->drawn->shown.hidden[number];
            all = all && !viewer->drawn->shown.hidden[number];
        }
    }
    return all ? SHOWN : any ? SHOWN_IN_PART : SHOWN_NOT;
}

void viewer_hide(struct viewer *viewer, uint32_t object, bool hide)
{
    for (uint32_t number = 1; number <= viewer->drawn->object_count; number++) {
        if (viewer_is_below(viewer, number, object)) {
            viewer->drawn->shown.hidden[number] = hide;
        }
    }
    hide_in_atlas(viewer, viewer->drawn);
}

void viewer_isolate(struct viewer *viewer, uint32_t object)
{
    for (uint32_t number = 1; number <= viewer->drawn->object_count; number++) {
        viewer->drawn->shown.hidden[number] = !viewer_is_below(viewer, number, object);
    }
    hide_in_atlas(viewer, viewer->drawn);
}

void viewer_show_all(struct viewer *viewer)
{
    memset(viewer->drawn->shown.hidden, 0, (viewer->drawn->object_count + 1) * sizeof *viewer->drawn->shown.hidden);
    hide_in_atlas(viewer, viewer->drawn);
}

void viewer_set_hidden(struct viewer *viewer, struct view_atlas *on, bool *hidden)
{
    free(on->shown.hidden);
    on->shown.hidden = hidden;
    hide_in_atlas(viewer, on);
}
