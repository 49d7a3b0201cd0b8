/* SPDX-License-Identifier: BSD-3-Clause */
/* An atlas of the window: its making, its question and its end. */
#include "viewer/model/view_atlas.h"

#include "viewer/model/study.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Once, and not for every cut. */
static void find_window(struct view_atlas *on)
{
    size_t context = view_atlas_context(on);
    if (context == conus_atlas_volume_count(on->atlas) || conus_atlas_window(on->window, on->atlas, context)) {
        on->window[0] = on->window[1] = 0;
    }
}

/* Likewise: it takes names apart. */
static void find_sides(struct view_atlas *on)
{
    on->sides = malloc(on->object_count + 1);
    if (on->sides && conus_atlas_sides(on->sides, on->atlas)) {
        free(on->sides);
        on->sides = NULL;
    }
}

bool view_atlas_init(struct view_atlas *out, const struct view_source *source)
{
    struct view_atlas on = {.atlas = source->atlas,
                            .path = strdup(source->path ? source->path : ""),
                            .name = strdup(source->name ? source->name : ""),
                            .object_count = conus_atlas_object_count(source->atlas)};
    on.shown.hidden = calloc(on.object_count + 1, sizeof *on.shown.hidden);
    for (size_t number = 1; on.shown.hidden && number <= on.object_count; number++) {
        on.shown.hidden[number] = conus_atlas_is_hidden(on.atlas, number);
    }
    bool has_look = look_init(&on.look, on.object_count);
    if (!on.shown.hidden || !has_look || !on.path || !on.name) {
        view_atlas_finish(&on);
        return false;
    }
    on.watch = watch_create(on.atlas);
    find_sides(&on);
    on.kinds = calloc(on.object_count + 1, sizeof(const char *));
    for (size_t number = 0; on.kinds && number <= on.object_count; number++) {
        on.kinds[number] = conus_atlas_kind_word(on.atlas, number);
    }
    find_window(&on);
    *out = on;
    return true;
}

void view_atlas_finish(struct view_atlas *on)
{
    for (enum tool_number tool = FIRST_TOOL; tool < TOOL_COUNT; tool++) {
        view_atlas_forget(on, tool);
    }
    view_atlas_rest(on);
    free(on->shown.hidden);
    look_finish(&on->look);
    watch_destroy(on->watch);
    free(on->sides);
    free((void *)on->kinds);
    free(on->made_level);
    free(on->name);
    free(on->path);
}

conus_status view_atlas_prepare(struct view_atlas *on, const conus_selector_options *options)
{
    if (on->selector && selector_options_are_same(options, &on->made_with)) {
        return CONUS_OK;
    }
    char *level = options->level ? strdup(options->level) : NULL;
    if (options->level && !level) {
        return CONUS_ERROR_MEMORY;
    }
    conus_selector_destroy(on->selector);
    on->selector = NULL;
    free(on->made_level);
    on->made_level = level;
    on->made_with = *options;
    on->made_with.level = level;
    return conus_selector_create(&on->selector, on->atlas, options);
}

conus_status view_atlas_select(struct view_atlas *on, enum tool_number tool, const conus_selector_options *options,
                               const conus_pose *pose, double angle)
{
    conus_selection *selection = NULL;
    conus_status status = view_atlas_prepare(on, options);
    status = status ? status : conus_select(&selection, on->selector, pose, angle);
    struct answer *answer = status ? NULL : answer_create(selection);
    if (!status && !answer) {
        conus_selection_destroy(selection);
        status = CONUS_ERROR_MEMORY;
    }
    answer_drop(on->answers[tool]);
    on->answers[tool] = answer;
    return status;
}

void view_atlas_rest(struct view_atlas *on)
{
    conus_selector_destroy(on->selector);
    conus_selector_destroy(on->picker);
    conus_cutter_destroy(on->probe);
    on->selector = on->picker = NULL;
    on->probe = NULL;
}

void view_atlas_forget(struct view_atlas *on, enum tool_number tool)
{
    answer_drop(on->answers[tool]);
    on->answers[tool] = NULL;
}

const conus_selection *view_atlas_selection(const struct view_atlas *on, enum tool_number tool)
{
    return answer_selection(on->answers[tool]);
}

const char *view_atlas_title(char out[VIEW_ATLAS_TITLE], const struct view_atlas *on, size_t number)
{
    return view_atlas_title_of(out, on, number, conus_atlas_object(on->atlas, number)->name);
}

const char *view_atlas_title_of(char out[VIEW_ATLAS_TITLE], const struct view_atlas *on, size_t number,
                                const char *name)
{
    if (!on->kinds || !on->kinds[number][0]) {
        return name;
    }
    snprintf(out, VIEW_ATLAS_TITLE, "%s %s", on->kinds[number], name); /* so that where it is cut, they differ */
    return out;
}

size_t view_atlas_context(const struct view_atlas *on)
{
    size_t i = 0;
    while (i < conus_atlas_volume_count(on->atlas) && conus_atlas_volume(on->atlas, i)->role != CONUS_ROLE_CONTEXT) {
        i++;
    }
    return i;
}

const double *view_atlas_grey(const struct view_atlas *on)
{
    const double *set = on->look.grey;
    return set[0] != 0 || set[1] != 0 ? set : on->window;
}

bool view_atlas_shares_context(const struct view_atlas *a, const struct view_atlas *b)
{
    const conus_volume_info *one = conus_atlas_volume(a->atlas, view_atlas_context(a));
    const conus_volume_info *other = conus_atlas_volume(b->atlas, view_atlas_context(b));
    return one && other ? strcmp(one->path, other->path) == 0 && one->volume == other->volume : one == other;
}

const conus_volume_info *view_atlas_pathway(const struct view_atlas *on, uint32_t object)
{
    const conus_object *pathway = conus_atlas_object(on->atlas, object);
    bool has_threshold = pathway && pathway->kind == CONUS_KIND_PATHWAY && !pathway->is_band;
    return has_threshold ? conus_atlas_volume(on->atlas, pathway->volume) : NULL;
}
