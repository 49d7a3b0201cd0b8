/* SPDX-License-Identifier: BSD-3-Clause */
/* An atlas of the window: its making, its question and its end. */
#include "viewer/model/viewer.h"

#include "conus/own.h"
#include "viewer/model/additions.h"
#include "viewer/model/study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Finds the box around all objects, which is that of those that are shown where none is hidden. */
static conus_status find_box(struct view_atlas *view)
{
    bool hides = view_atlas_hidden(view) > 0;
    conus_status status = hides ? conus_atlas_set_hidden(view->atlas, NULL) : CONUS_OK;
    if (!status && conus_atlas_bounds(view->box[0], view->box[1], view->atlas)) {
        view->box[0][0] = INFINITY;
    }
    return hides && !status ? conus_atlas_set_hidden(view->atlas, view->shown.hidden) : status;
}

bool view_atlas_init(struct view_atlas *out, const struct view_source *source)
{
    struct view_atlas view = {.atlas = source->atlas,
                              .path = strdup(source->path ? source->path : ""),
                              .name = strdup(source->name ? source->name : ""),
                              .object_count = conus_atlas_object_count(source->atlas)};
    view.shown.hidden = calloc(view.object_count + 1, sizeof *view.shown.hidden);
    for (size_t number = 1; view.shown.hidden && number <= view.object_count; number++) {
        view.shown.hidden[number] = conus_atlas_is_hidden(view.atlas, number);
    }
    view.watch = file_watch_create(view.atlas);
    view.sides = malloc(view.object_count + 1);
    view.prefixes = calloc(view.object_count + 1, sizeof(const char *));
    bool has_look = appearance_init(&view.appearance, view.object_count);
    if (!view.shown.hidden || !has_look || !view.path || !view.name || !view.watch || !view.prefixes || !view.sides ||
        conus_atlas_sides(view.sides, view.atlas) || conus_atlas_prefixes(view.prefixes, view.atlas) ||
        find_box(&view)) {
        view_atlas_finish(&view);
        return false;
    }
    size_t context = view_atlas_context(&view);
    if (context == conus_atlas_volume_count(view.atlas) || conus_atlas_window(view.found_grey, view.atlas, context)) {
        view.found_grey[0] = view.found_grey[1] = 0;
    }
    *out = view;
    return true;
}

void view_atlas_finish(struct view_atlas *view)
{
    for (enum tool_number tool = FIRST_TOOL; tool < TOOL_COUNT; tool++) {
        view_atlas_forget(view, tool);
    }
    view_atlas_invalidate(view);
    free(view->shown.hidden);
    appearance_finish(&view->appearance);
    file_watch_destroy(view->watch);
    free(view->sides);
    free((void *)view->prefixes);
    free(view->made_level);
    free(view->name);
    free(view->path);
}

conus_status view_atlas_prepare(struct view_atlas *view, const conus_selector_options *options)
{
    if (view->selector && selector_options_are_same(options, &view->made_with)) {
        return CONUS_OK;
    }
    char *level = options->level ? strdup(options->level) : NULL;
    if (options->level && !level) {
        return CONUS_ERROR_MEMORY;
    }
    conus_selector_destroy(view->selector);
    view->selector = NULL;
    free(view->made_level);
    view->made_level = level;
    view->made_with = *options;
    view->made_with.level = level;
    return conus_selector_create(&view->selector, view->atlas, options);
}

/* Puts the answer in the place of the one before. */
static conus_status ask(struct answer **out, struct view_atlas *view, const conus_selector_options *options,
                        const conus_pose *pose, double angle)
{
    conus_selection *selection = NULL;
    conus_status status = view_atlas_prepare(view, options);
    if (!status) {
        status = isnan(angle)
                     ? conus_select_ball(&selection, view->selector, pose->world_from_device + 12, options->radius)
                     : conus_select(&selection, view->selector, pose, angle);
    }
    struct answer *answer = status ? NULL : answer_create(selection);
    if (!status && !answer) {
        conus_selection_destroy(selection);
        status = CONUS_ERROR_MEMORY;
    }
    answer_drop(*out);
    *out = answer;
    return status;
}

conus_status view_atlas_select(struct view_atlas *view, enum tool_number tool, const conus_selector_options *options,
                               const conus_pose *pose, double angle)
{
    return ask(&view->answers[tool], view, options, pose, angle);
}

struct answer *view_atlas_nothing(struct view_atlas *view, const conus_selector_options *options,
                                  const conus_pose *pose)
{
    bool fails = !view->nothing && ask(&view->nothing, view, options, pose, options->radius > 0 ? 0 : 0.1);
    return fails ? NULL : view->nothing;
}

void view_atlas_invalidate(struct view_atlas *view)
{
    conus_selector_destroy(view->selector);
    for (int layers = CONUS_LAYERS_VISIBLE; layers <= CONUS_LAYERS_ALL; layers++) {
        conus_selector_destroy(view->pickers[layers]);
        view->pickers[layers] = NULL;
    }
    conus_cutter_destroy(view->probe);
    answer_drop(view->nothing);
    view->nothing = NULL;
    view->selector = NULL;
    view->probe = NULL;
}

void view_atlas_forget(struct view_atlas *view, enum tool_number tool)
{
    answer_drop(view->answers[tool]);
    view->answers[tool] = NULL;
}

const conus_selection *view_atlas_selection(const struct view_atlas *view, enum tool_number tool)
{
    return answer_selection(view->answers[tool]);
}

const char *view_atlas_title(char out[VIEW_ATLAS_TITLE], const struct view_atlas *view, size_t number)
{
    return view_atlas_title_of(out, view, number, conus_atlas_object(view->atlas, number)->name);
}

const char *view_atlas_title_of(char out[VIEW_ATLAS_TITLE], const struct view_atlas *view, size_t number,
                                const char *name)
{
    if (!view->prefixes[number][0]) {
        return name;
    }
    snprintf(out, VIEW_ATLAS_TITLE, "%s %s", view->prefixes[number], name); /* cut texts differ */
    return out;
}

size_t view_atlas_context(const struct view_atlas *view)
{
    size_t i = 0;
    while (i < conus_atlas_volume_count(view->atlas) &&
           conus_atlas_volume(view->atlas, i)->role != CONUS_ROLE_CONTEXT) {
        i++;
    }
    return i;
}

const double *view_atlas_grey(const struct view_atlas *view)
{
    const double *set = view->appearance.grey;
    return set[0] != 0 || set[1] != 0 ? set : view->found_grey;
}

bool view_atlas_shares_context(const struct view_atlas *a, const struct view_atlas *b)
{
    const conus_volume_info *one = conus_atlas_volume(a->atlas, view_atlas_context(a));
    const conus_volume_info *other = conus_atlas_volume(b->atlas, view_atlas_context(b));
    return one && other ? strcmp(one->path, other->path) == 0 && one->volume == other->volume : one == other;
}

size_t view_atlas_hidden(const struct view_atlas *view)
{
    size_t count = 0;
    for (size_t number = 1; number <= view->object_count; number++) {
        count += view->shown.hidden[number];
    }
    return count;
}

bool view_atlas_shows_tracts(const struct view_atlas *view)
{
    size_t number = view->object_count; /* they come last */
    while (number && view->shown.hidden[number] && conus_atlas_object(view->atlas, number)->kind != CONUS_KIND_AREA) {
        number--;
    }
    return number && conus_atlas_object(view->atlas, number)->kind != CONUS_KIND_AREA;
}

char view_atlas_side(const struct view_atlas *view, size_t number)
{
    return (char)(conus_atlas_exchanged(view->atlas) ? ' ' : view->sides[number]);
}

const conus_volume_info *view_atlas_pathway(const struct view_atlas *view, uint32_t object)
{
    const conus_object *pathway = conus_atlas_object(view->atlas, object);
    bool has_threshold = pathway && pathway->kind == CONUS_KIND_PATHWAY && !pathway->is_band;
    return has_threshold ? conus_atlas_volume(view->atlas, pathway->volume) : NULL;
}
