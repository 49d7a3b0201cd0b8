/* SPDX-License-Identifier: BSD-3-Clause */
/* An atlas of the window: its making, its question and its end; and whether its files have changed on disk. */
#include "viewer/model/view_atlas.h"

#include "options/output.h"
#include "viewer/model/study.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Enough to see that a file is another one. */
struct state {
    bool is_there;
    struct timespec changed;
    off_t size;
};

struct file_watch {
    const conus_atlas *atlas;
    struct state *states; /* [count] of volumes and then of other files, as they were looked at last */
    struct state *first;  /* [count] and at first */
    size_t count;
};

static size_t count_files(const conus_atlas *atlas)
{
    return conus_atlas_volume_count(atlas) + conus_atlas_file_count(atlas);
}

static const char *path_of(const conus_atlas *atlas, size_t index)
{
    size_t volumes = conus_atlas_volume_count(atlas);
    return index < volumes ? conus_atlas_volume(atlas, index)->path : conus_atlas_file(atlas, index - volumes);
}

static struct state look_at_file(const char *path)
{
    struct stat stat_;
    if (stat(path, &stat_)) {
        return (struct state){.is_there = false};
    }
    return (struct state){.is_there = true, .changed = stat_.st_mtim, .size = stat_.st_size};
}

static bool is_same_state(const struct state *a, const struct state *b)
{
    return a->is_there == b->is_there && a->size == b->size && a->changed.tv_sec == b->changed.tv_sec &&
           a->changed.tv_nsec == b->changed.tv_nsec;
}

static void file_watch_destroy(struct file_watch *watch)
{
    if (watch) {
        free(watch->states);
        free(watch->first);
        free(watch);
    }
}

/* Notes how the files are now; NULL without memory. */
static struct file_watch *file_watch_create(const conus_atlas *atlas)
{
    struct file_watch *watch = calloc(1, sizeof *watch);
    if (!watch) {
        return NULL;
    }
    watch->atlas = atlas;
    watch->count = count_files(atlas);
    watch->states = calloc(watch->count + 1, sizeof *watch->states);
    watch->first = calloc(watch->count + 1, sizeof *watch->first);
    if (!watch->states || !watch->first) {
        file_watch_destroy(watch);
        return NULL;
    }
    for (size_t i = 0; i < watch->count; i++) {
        watch->states[i] = watch->first[i] = look_at_file(path_of(watch->atlas, i));
    }
    return watch;
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
    bool has_look = appearance_init(&view.appearance, view.object_count);
    if (!view.shown.hidden || !has_look || !view.path || !view.name) {
        view_atlas_finish(&view);
        return false;
    }
    view.watch = file_watch_create(view.atlas);
    view.sides = malloc(view.object_count + 1);
    if (view.sides && conus_atlas_sides(view.sides, view.atlas)) {
        free(view.sides);
        view.sides = NULL;
    }
    view.kinds = calloc(view.object_count + 1, sizeof(const char *));
    for (size_t number = 0; view.kinds && number <= view.object_count; number++) {
        view.kinds[number] = conus_atlas_kind_word(view.atlas, number);
    }
    size_t context = view_atlas_context(&view);
    if (context == conus_atlas_volume_count(view.atlas) || conus_atlas_window(view.window, view.atlas, context)) {
        view.window[0] = view.window[1] = 0;
    }
    *out = view;
    return true;
}

void view_atlas_finish(struct view_atlas *view)
{
    for (enum tool_number tool = FIRST_TOOL; tool < TOOL_COUNT; tool++) {
        view_atlas_forget(view, tool);
    }
    view_atlas_rest(view);
    free(view->shown.hidden);
    appearance_finish(&view->appearance);
    file_watch_destroy(view->watch);
    free(view->sides);
    free((void *)view->kinds);
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

conus_status view_atlas_select(struct view_atlas *view, enum tool_number tool, const conus_selector_options *options,
                               const conus_pose *pose, double angle)
{
    conus_selection *selection = NULL;
    conus_status status = view_atlas_prepare(view, options);
    status = status ? status : conus_select(&selection, view->selector, pose, angle);
    struct answer *answer = status ? NULL : answer_create(selection);
    if (!status && !answer) {
        conus_selection_destroy(selection);
        status = CONUS_ERROR_MEMORY;
    }
    answer_drop(view->answers[tool]);
    view->answers[tool] = answer;
    return status;
}

void view_atlas_rest(struct view_atlas *view)
{
    conus_selector_destroy(view->selector);
    conus_selector_destroy(view->picker);
    conus_cutter_destroy(view->probe);
    view->selector = view->picker = NULL;
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
    if (!view->kinds || !view->kinds[number][0]) {
        return name;
    }
    snprintf(out, VIEW_ATLAS_TITLE, "%s %s", view->kinds[number], name); /* so that where it is cut, they differ */
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
    return set[0] != 0 || set[1] != 0 ? set : view->window;
}

bool view_atlas_shares_context(const struct view_atlas *a, const struct view_atlas *b)
{
    const conus_volume_info *one = conus_atlas_volume(a->atlas, view_atlas_context(a));
    const conus_volume_info *other = conus_atlas_volume(b->atlas, view_atlas_context(b));
    return one && other ? strcmp(one->path, other->path) == 0 && one->volume == other->volume : one == other;
}

const conus_volume_info *view_atlas_pathway(const struct view_atlas *view, uint32_t object)
{
    const conus_object *pathway = conus_atlas_object(view->atlas, object);
    bool has_threshold = pathway && pathway->kind == CONUS_KIND_PATHWAY && !pathway->is_band;
    return has_threshold ? conus_atlas_volume(view->atlas, pathway->volume) : NULL;
}

/* By its name: paths may be absolute now. */
static bool has_file(const conus_atlas *atlas, const char *name)
{
    for (size_t i = 0; i < count_files(atlas); i++) {
        if (strcmp(path_name(path_of(atlas, i)), name) == 0) {
            return true;
        }
    }
    return false;
}

const char *file_watch_find_other(const struct file_watch *watch, const conus_atlas *now)
{
    for (size_t i = 0; i < watch->count; i++) {
        const char *path = path_of(watch->atlas, i);
        struct state is = look_at_file(path);
        if (!is_same_state(&is, &watch->first[i]) && has_file(now, path_name(path))) {
            return path_name(path);
        }
    }
    return NULL;
}

bool file_watch_check(struct file_watch *watch, char text[FILE_WATCH_TEXT])
{
    size_t changes = 0;
    for (size_t i = 0; i < watch->count; i++) {
        const char *path = path_of(watch->atlas, i);
        struct state now = look_at_file(path);
        if (is_same_state(&now, &watch->states[i])) {
            continue;
        }
        if (changes++ == 0) {
            snprintf(text, FILE_WATCH_TEXT, "%.60s %s disk: what is shown was read before", path_name(path),
                     now.is_there ? "changed on" : "is gone from");
        }
        watch->states[i] = now;
    }
    if (changes > 1) {
        size_t used = strlen(text);
        snprintf(text + used, FILE_WATCH_TEXT - used, " (and %zu more files)", changes - 1);
    }
    return changes;
}
