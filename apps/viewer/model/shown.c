/* SPDX-License-Identifier: BSD-3-Clause */
/* Hiding, showing and finding areas and pathways. */
#include "viewer/model/viewer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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
    for (size_t i = 0; i < shown->undo_count; i++) {
        free(shown->undo[i]);
    }
    free(shown->hidden);
}

/* What is hidden is not in the atlas: it is not hit, not drawn, and blocks nothing. */
static void hide_in_atlas(struct viewer *viewer)
{
    if (viewer->painter) {
        painter_hold(viewer->painter);
    }
    viewer_rest_selectors(viewer);
    if (conus_atlas_set_hidden(viewer->atlas, viewer->shown.hidden)) {
        viewer_say(viewer, "%s", conus_message());
        for (size_t number = 1; number <= viewer->object_count; number++) {
            viewer->shown.hidden[number] = conus_atlas_is_hidden(viewer->atlas, number);
        }
    }
    if (viewer->painter) {
        painter_resume(viewer->painter);
    }
    viewer->scene_number++;
    viewer_reselect(viewer);
}

static void remember(struct viewer *viewer)
{
    bool *copy = malloc((viewer->object_count + 1) * sizeof *copy);
    if (!copy) {
        return;
    }
    memcpy(copy, viewer->shown.hidden, (viewer->object_count + 1) * sizeof *copy);
    if (viewer->shown.undo_count == UNDO_LIMIT) {
        free(viewer->shown.undo[0]);
        memmove(viewer->shown.undo, viewer->shown.undo + 1, (UNDO_LIMIT - 1) * sizeof *viewer->shown.undo);
        viewer->shown.undo_count--;
    }
    viewer->shown.undo[viewer->shown.undo_count++] = copy;
}

bool viewer_is_below(const struct viewer *viewer, uint32_t object, uint32_t ancestor)
{
    while (object && object != ancestor) {
        object = conus_atlas_object(viewer->atlas, object)->parent;
    }
    return object;
}

enum shown viewer_shown(const struct viewer *viewer, uint32_t object)
{
    bool any = false;
    bool all = true;
    for (uint32_t number = 1; number <= viewer->object_count; number++) {
        if (viewer_is_below(viewer, number, object)) {
            any = any || !viewer->shown.hidden[number];
            all = all && !viewer->shown.hidden[number];
        }
    }
    return all ? SHOWN : any ? SHOWN_IN_PART : SHOWN_NOT;
}

void viewer_hide(struct viewer *viewer, uint32_t object, bool hide)
{
    remember(viewer);
    for (uint32_t number = 1; number <= viewer->object_count; number++) {
        if (viewer_is_below(viewer, number, object)) {
            viewer->shown.hidden[number] = hide;
        }
    }
    hide_in_atlas(viewer);
}

void viewer_isolate(struct viewer *viewer, uint32_t object)
{
    remember(viewer);
    for (uint32_t number = 1; number <= viewer->object_count; number++) {
        viewer->shown.hidden[number] = !viewer_is_below(viewer, number, object);
    }
    hide_in_atlas(viewer);
}

void viewer_show_all(struct viewer *viewer)
{
    remember(viewer);
    memset(viewer->shown.hidden, 0, (viewer->object_count + 1) * sizeof *viewer->shown.hidden);
    hide_in_atlas(viewer);
}

void viewer_set_hidden(struct viewer *viewer, bool *hidden)
{
    remember(viewer);
    free(viewer->shown.hidden);
    viewer->shown.hidden = hidden;
    hide_in_atlas(viewer);
}

void viewer_undo(struct viewer *viewer)
{
    if (!viewer->shown.undo_count) {
        viewer_say(viewer, "nothing to undo");
        return;
    }
    free(viewer->shown.hidden);
    viewer->shown.hidden = viewer->shown.undo[--viewer->shown.undo_count];
    hide_in_atlas(viewer);
}

static bool contains(const char *text, const char *part)
{
    size_t length = strlen(part);
    for (; *text; text++) {
        if (strncasecmp(text, part, length) == 0) {
            return true;
        }
    }
    return length == 0;
}

static bool fits(const conus_object *object, const char *text)
{
    char label[16];
    snprintf(label, sizeof label, "%u", object->label);
    return contains(object->name, text) || contains(object->abbreviation, text) || strcmp(label, text) == 0;
}

bool viewer_fits(const struct viewer *viewer, uint32_t object)
{
    return fits(conus_atlas_object(viewer->atlas, object), viewer->shown.search);
}

uint32_t viewer_find(const struct viewer *viewer, const char *text)
{
    uint32_t found = 0;
    for (uint32_t number = 1; number <= viewer->object_count; number++) {
        const conus_object *object = conus_atlas_object(viewer->atlas, number);
        if (strcmp(object->name, text) == 0) {
            return number;
        }
        found = !found && fits(object, text) ? number : found;
    }
    return found;
}
