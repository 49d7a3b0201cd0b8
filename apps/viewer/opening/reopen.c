/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads the same atlases with other options and shows them in place of the old ones. */
#include "viewer/opening/parts.h"

#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "viewer/model/additions.h"
#include "viewer/model/viewer.h"
#include "viewer/opening/opening.h"
#include "viewer/session/session.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool has_note(const conus_atlas *atlas, const char *note)
{
    bool has = false;
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        has = has || strcmp(conus_atlas_note(atlas, i), note) == 0;
    }
    return has;
}

/* Finds the first note of `after` that begins with `start` and that `before` lacks; NULL = none. */
static const char *find_note(const conus_atlas *before, const conus_atlas *after, const char *start)
{
    for (size_t i = 0; i < conus_atlas_note_count(after); i++) {
        const char *note = conus_atlas_note(after, i);
        if (strncmp(note, start, strlen(start)) == 0 && !has_note(before, note)) {
            return note;
        }
    }
    return NULL;
}

/* Appends the files of `words` that are not among `others`. */
static void put_names(char *out, size_t size, const char *title, const json_t *words, const json_t *others)
{
    const char *joint = title;
    for (size_t i = 0; i < json_array_size(words); i++) {
        const char *value = NULL;
        char path[SYSTEM_PATH];
        enum addition kind = addition_of(&value, json_string_value(json_array_get(words, i)));
        if (kind < ADDITION_COUNT && addition_path(path, kind, value) &&
            !words_place(others, json_array_get(words, i))) {
            size_t used = strlen(out);
            snprintf(out + used, size - used, "%s%s%s%s", used && joint == title ? "; " : "", joint, path_name(path),
                     kind == ADD_CONTEXT ? " as context" : "");
            joint = ", ";
        }
    }
}

/* "added: b.trk; taken out: a.trk; ...": the files of the options `words` that the first atlas of the window was not
 * opened with, and the other way round, how hemispheres are if they are others, and what `now` notes that it did not
 * note. */
static void tell_update(char *out, size_t size, const struct window *window, const conus_atlas *now,
                        const json_t *words)
{
    const json_t *then = json_object_get(window->files.opened, "options");
    const char *note = find_note(window->viewer->atlases->atlas, now, "");
    conus_hemispheres how = hemispheres_of_words(words);
    out[0] = '\0';
    put_names(out, size, "added: ", words, then);
    put_names(out, size, "taken out: ", then, words);
    if (!note && how != window->files.hemispheres) {
        note = hemispheres_meanings[how];
    }
    size_t used = strlen(out);
    snprintf(out + used, size - used, "%s%s", used && note ? "; " : "", note ? note : "");
}

/* Finds a volume that both atlases have, but with other bytes; NULL = none. */
static const char *find_other_volume(const conus_atlas *before, const conus_atlas *now)
{
    for (size_t i = 0; i < conus_atlas_volume_count(before); i++) {
        const conus_volume_info *was = conus_atlas_volume(before, i);
        for (size_t k = 0; k < conus_atlas_volume_count(now); k++) {
            const conus_volume_info *is = conus_atlas_volume(now, k);
            if (strcmp(was->sha256, is->sha256) != 0 && paths_equal(was->path, is->path)) {
                return was->path;
            }
        }
    }
    return NULL;
}

/* Whether the loaded files are those that were open before, by checksums and the times of files. */
static bool is_unchanged(char why[LOADER_WHY], const struct viewer *viewer, const struct atlases *loaded)
{
    const char *other = NULL;
    for (size_t i = 0; i < viewer->atlas_count && !other; i++) {
        const struct view_atlas *view = &viewer->atlases[i];
        other = file_watch_find_other(view->watch, loaded->items[i].atlas);
        other = other ? other : find_other_volume(view->atlas, loaded->items[i].atlas);
    }
    if (other) {
        snprintf(why, LOADER_WHY, "%.200s: not as when it was opened, so all stays as it is; open the atlas anew",
                 other);
    }
    return !other;
}

/* Refuses streamlines that hardly lie where the areas are, unless the user asks for them a second time. */
static bool is_doubtful(struct window *window, const conus_atlas *now, const json_t *words, char why[LOADER_WHY])
{
    const char *doubt = find_note(window->viewer->atlases->atlas, now, "bundle ");
    char *text = doubt ? json_dumps(words, JSON_COMPACT) : NULL;
    bool trusts = text && window->files.doubted && strcmp(text, window->files.doubted) == 0;
    free(window->files.doubted);
    window->files.doubted = trusts ? NULL : text;
    if (doubt && !trusts) {
        snprintf(why, LOADER_WHY, "not added: %s If all is well, add it once more.", doubt);
        return true;
    }
    free(trusts ? text : NULL);
    return false;
}

/* Flags the objects of files whose option differs from before: for these the new option holds. */
static bool *find_fresh(size_t object_count, const json_t *added, const json_t *before)
{
    bool *fresh = calloc(object_count + 1, sizeof *fresh);
    for (size_t i = 0; fresh && i < json_array_size(added); i++) {
        const json_t *entry = json_array_get(added, i);
        const json_t *objects = json_object_get(entry, "objects");
        bool is_old = words_place(before, json_object_get(entry, "option"));
        for (size_t k = 0; !is_old && k < json_array_size(objects); k++) {
            fresh[json_integer_value(json_array_get(objects, k))] = true;
        }
    }
    return fresh;
}

/* Takes over the atlases on success. */
static bool exchange(struct window *window, struct atlases *loaded, const json_t *added, conus_hemispheres how,
                     char why[LOADER_WHY])
{
    struct replacement now = {.before = window->files.hemispheres, .how = how};
    now.atlases = calloc(loaded->count, sizeof(conus_atlas *));
    now.fresh = find_fresh(conus_atlas_object_count(loaded->items[0].atlas), added,
                           json_object_get(window->files.opened, "options"));
    for (size_t i = 0; now.atlases && i < loaded->count; i++) {
        now.atlases[i] = loaded->items[i].atlas;
    }
    window->frame.hover.object = 0; /* nothing that was made of the atlases before may outlive them */
    window->frame.listed = 0;
    for (int p = 0; p < PLANE_COUNT; p++) {
        conus_cutter_destroy(window->pictures.cuts[p].cutter);
        window->pictures.cuts[p].cutter = NULL;
    }
    snprintf(why, LOADER_WHY, "not enough memory");
    bool fine = now.atlases && now.fresh && viewer_replace(window->viewer, &now, why, LOADER_WHY);
    for (size_t i = 0; i < loaded->count && fine; i++) {
        loaded->items[i].atlas = NULL;
    }
    free((void *)now.atlases);
    free((void *)now.fresh);
    return fine;
}

/* Holds the tool against the constraints of other options. */
static bool change_plan(struct window *window, const struct worded *worded, char why[LOADER_WHY])
{
    bool fine = !plans_change(window->viewer, worded->settings.arguments, worded->settings.poses);
    if (!fine) {
        snprintf(why, LOADER_WHY, "%s", error_line());
    }
    return fine;
}

/* "target: Hippocampus_L, avoids Insula_L" */
static void tell_asked(struct viewer *viewer)
{
    const struct plan_state *plan = &viewer->plan;
    char avoided[256] = "";
    const char *target = NULL;
    size_t used = 0;
    for (size_t i = 0; i < plan->task.constraints.count && plan->live; i++) {
        const conus_constraint_kind kind = plan->task.constraints.items[i].kind;
        const char *name = conus_plan_name(plan->live, i);
        target = kind == CONUS_CONSTRAINT_REACH ? name : target;
        if (kind == CONUS_CONSTRAINT_AVOID && used < sizeof avoided) {
            used += (size_t)snprintf(avoided + used, sizeof avoided - used, ", avoids %s", name);
        }
    }
    viewer_say(viewer, "%s%s%s", target ? "target: " : "there is no target", target ? target : "", avoided);
}

/* Nothing is read anew. */
static bool change_asked(struct window *window, const struct worded *worded, const json_t *words, int step,
                         char why[LOADER_WHY])
{
    if (!change_plan(window, worded, why)) {
        return false;
    }
    json_object_set(window->files.opened, "options", (json_t *)words);
    tell_asked(window->viewer);
    if (step) {
        undo_go_on(window, step);
    }
    return true;
}

static bool show_again(struct window *window, struct atlases *loaded, const struct worded *worded, const json_t *words,
                       int step, char why[LOADER_WHY])
{
    struct viewer *viewer = window->viewer;
    const conus_atlas *atlas = loaded->items[0].atlas;
    conus_hemispheres before = window->files.hemispheres;
    conus_hemispheres how = hemispheres_of_words(words);
    char update[LOADER_WHY];
    json_t *added = additions_describe(atlas, words);
    bool has_plan = plans_asked_is_same(words, json_object_get(window->files.opened, "options"));
    struct point_list points = {0};
    const struct view_settings *settings = &worded->settings;
    tell_update(update, sizeof update, window, atlas, words);
    bool fine = !settings->pose || !points_load(&points, settings->pose, loaded, &viewer->frame, settings->radius,
                                                &settings->common, settings->atlas.max_memory);
    if (!fine) {
        snprintf(why, LOADER_WHY, "%s", error_line());
        atlases_finish(loaded); /* it was said */
    }
    fine = fine && exchange(window, loaded, added, how, why);
    if (fine) {
        points_use(viewer, &points);
        window->files.hemispheres = how;
        json_object_set(window->files.opened, "options", (json_t *)words);
        json_object_set(window->files.opened, "added", added);
        window->start.on = window->dialog.on = false;
        memcpy(why, update, sizeof update);
        char level[64];
        snprintf(level, sizeof level, "%.60s", viewer->cone.level);
        if (level[0] && !query_set_level(viewer, viewer->cone.level)) { /* its areas are not there any more */
            query_set_level(viewer, "");
            snprintf(why, LOADER_WHY, "level %s is not possible with these hemispheres: each area by itself", level);
        }
        if (!has_plan && !change_plan(window, worded, why)) {
            print_error_line("%s", why);
        }
        viewer_say(viewer, "%s", why);
        if (step) {
            undo_go_on(window, step);
        } else if (before == how) { /* coming and going of files is no change to be taken back */
            undo_renew(window);
        }
        why[0] = '\0';
    }
    json_decref(added);
    points_finish(&points);
    return fine;
}

/* Keeps the options as words in which files have absolute paths. */
static bool load_and_show(struct window *window, const struct worded *worded, int step, char why[LOADER_WHY])
{
    const struct loading request = {.path = window->viewer->atlases->path,
                                    .settings = &worded->settings.atlas,
                                    .context = &worded->settings.context,
                                    .again = true};
    struct atlases loaded = {0};
    json_t *words = view_words(&worded->arguments, NULL);
    snprintf(why, LOADER_WHY, "%s", words ? "" : "not enough memory");
    bool fine = words && wait_load(window, &request, &loaded, why);
    if (fine) {
        fine = is_unchanged(why, window->viewer, &loaded) && !is_doubtful(window, loaded.items[0].atlas, words, why) &&
               show_again(window, &loaded, worded, words, step, why);
    }
    if (!fine && loaded.count) {
        print_error_line("%s", why);
    }
    json_decref(words);
    atlases_finish(&loaded);
    if (fine && worded->settings.atlas.shelf) {
        tract_shelf_drop(worded->settings.atlas.shelf);
    }
    return fine;
}

bool reopen(struct window *window, const json_t *words, int step, const struct view_settings *settings,
            char why[LOADER_WHY])
{
    struct worded worded;
    json_t *others[2] = {plans_put_asked(words, NULL),
                         plans_put_asked(json_object_get(window->files.opened, "options"), NULL)};
    bool fine = worded_parse(&worded, words, settings, false) == EXIT_DONE;
    if (fine && others[0] && json_equal(others[0], others[1])) {
        fine = change_asked(window, &worded, words, step, why);
    } else if (fine) {
        fine = load_and_show(window, &worded, step, why);
    } else {
        snprintf(why, LOADER_WHY, "%s", error_line());
    }
    worded_finish(&worded);
    json_decref(others[0]);
    json_decref(others[1]);
    return fine;
}
