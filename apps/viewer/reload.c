/* SPDX-License-Identifier: BSD-3-Clause */
/* A second loader beside the window's loop, and what takes the place of what. */
#include "viewer/reload.h"

#include "common/messages.h"
#include "viewer/hemispheres/carry.h"
#include "viewer/hemispheres/words.h"
#include "viewer/loader.h"
#include "viewer/opening/additions.h"
#include "viewer/question/question.h"
#include "viewer/session/undo.h"
#include "viewer/view_words.h"

#include <GLFW/glfw3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct reload {
    struct loader *loader;
    struct worded worded; /* what the atlases were opened with */
    char *path;
    conus_hemispheres how;
    bool is_dropped; /* something else was wanted meanwhile */
};

static void reload_destroy(struct reload *reload)
{
    if (reload) {
        worded_finish(&reload->worded);
        free(reload->path);
        free(reload);
    }
}

/* Nothing comes of it, and one line says why. */
static void give_up(struct window *window, const char *why)
{
    hemispheres_rest(&window->hemispheres);
    viewer_say(window->viewer, "%s", why);
    window->viewer->version++;
}

static void give_up_aloud(struct window *window, const char *why)
{
    print_error_line("%s", why);
    give_up(window, why);
}

/* A file of an atlas that is not as it was when the atlas was opened; NULL = all are. */
static const char *find_other_file(const struct viewer *viewer)
{
    const char *other = NULL;
    for (size_t i = 0; i < viewer->atlas_count && !other; i++) {
        other = viewer->atlases[i].watch ? watch_other(viewer->atlases[i].watch) : NULL;
    }
    return other;
}

/* ---- Beginning --------------------------------------------------------------------------------------------------- */

/* As the atlases were opened; what is hidden comes from the window. */
static bool find_settings(struct reload *reload, const struct window *window)
{
    const struct hemispheres *hemispheres = &window->hemispheres;
    const struct view_settings given = {
        .atlas = {.max_memory = hemispheres->max_memory, .no_cache = hemispheres->no_cache}};
    const json_t *words = json_object_get(window->opened, "options");
    bool fine = words && worded_parse(&reload->worded, words, &given, false) == EXIT_DONE;
    struct atlas_settings *settings = &reload->worded.settings.atlas;
    settings->hemispheres = (size_t)hemispheres->wanted;
    settings->no_cache = settings->no_cache || hemispheres->no_cache;
    reload->how = hemispheres->wanted;
    reload->path = strdup(window->viewer->atlases->path);
    return fine && reload->path;
}

static void begin(struct window *window)
{
    char why[LOADER_WHY];
    const char *other = find_other_file(window->viewer);
    if (other) {
        snprintf(why, sizeof why, "%.200s: not as when it was opened, so areas stay as they are; open it anew", other);
        give_up_aloud(window, why);
        return;
    }
    struct reload *reload = calloc(1, sizeof *reload);
    bool fine = reload && find_settings(reload, window);
    const struct loading what = {fine ? reload->path : NULL, fine ? &reload->worded.settings.atlas : NULL,
                                 fine ? &reload->worded.settings.context : NULL, glfwPostEmptyEvent};
    if (fine && loader_start(&reload->loader, &what)) {
        window->reload = reload;
    } else {
        reload_destroy(reload);
        give_up_aloud(window, window->opened ? "not enough memory" : "what was opened has a name that is not UTF-8");
    }
}

/* ---- Ending ------------------------------------------------------------------------------------------------------ */

/* Paths may be absolute now. */
static bool is_same_atlas(const conus_atlas *a, const conus_atlas *b)
{
    bool same = conus_atlas_volume_count(a) == conus_atlas_volume_count(b) &&
                conus_atlas_file_count(a) == conus_atlas_file_count(b);
    for (size_t i = 0; same && i < conus_atlas_volume_count(a); i++) {
        const conus_volume_info *one = conus_atlas_volume(a, i);
        const conus_volume_info *other = conus_atlas_volume(b, i);
        same = strcmp(one->sha256, other->sha256) == 0 && one->volume == other->volume;
    }
    return same;
}

/* What was opened is what has been loaded now, by its checksums and by the time of its files. */
static bool is_same(char why[LOADER_WHY], const struct viewer *viewer, const struct atlases *loaded)
{
    bool same = true;
    for (size_t i = 0; i < viewer->atlas_count && same; i++) {
        same = is_same_atlas(viewer->atlases[i].atlas, loaded->items[i].atlas);
    }
    const char *other = find_other_file(viewer);
    if (!same || other) {
        snprintf(why, LOADER_WHY, "%.200s: not as when it was opened, so areas stay as they are; open it anew",
                 other ? other : viewer->atlases->path);
    }
    return same && !other;
}

/* Nothing that was made of the atlases before may outlive them. */
static void forget_pictures(struct window *window)
{
    second_forget(&window->second);
    window->hover.object = 0;
    window->listed = 0;
    for (int p = 0; p < PLANE_COUNT; p++) {
        conus_cutter_destroy(window->cuts[p].cutter);
        window->cuts[p].cutter = NULL;
    }
}

static bool exchange(struct window *window, struct atlases *loaded, conus_hemispheres how)
{
    struct viewer *viewer = window->viewer;
    conus_atlas **atlases = calloc(loaded->count, sizeof(conus_atlas *));
    for (size_t i = 0; atlases && i < loaded->count; i++) {
        atlases[i] = loaded->items[i].atlas;
    }
    forget_pictures(window);
    if (!atlases) {
        viewer_say(viewer, "not enough memory");
    }
    bool fine = atlases && carry_over(viewer, atlases, window->hemispheres.now, how);
    for (size_t i = 0; i < loaded->count && fine; i++) {
        loaded->items[i].atlas = NULL; /* the viewer has them */
    }
    free((void *)atlases);
    return fine;
}

/* The library's own words, which say what was cut where. */
static void say_how(struct viewer *viewer, conus_hemispheres how)
{
    static const char begins[] = "hemispheres: ";
    const conus_atlas *atlas = viewer->atlases->atlas;
    const char *found = NULL;
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        const char *note = conus_atlas_note(atlas, i);
        found = strncmp(note, begins, strlen(begins)) == 0 ? note : found;
    }
    viewer_say(viewer, "%s", how && found ? found : hemispheres_meanings[how]);
}

/* A level that is of areas that are not there any more. */
static void check_level(struct viewer *viewer)
{
    if (viewer->cone.level[0] && !question_set_level(viewer, viewer->cone.level)) {
        char level[64];
        snprintf(level, sizeof level, "%.60s", viewer->cone.level);
        question_set_level(viewer, "");
        viewer_say(viewer, "level %s is not possible with these hemispheres: each area by itself", level);
    }
}

/* With what was added, whose objects have other numbers now. */
static bool describe(struct window *window, conus_hemispheres how)
{
    json_t *words = json_object_get(window->opened, "options");
    json_t *added =
        hemispheres_put_in_words(words, how) ? additions_describe(window->viewer->atlases->atlas, words) : NULL;
    return added && !json_object_set_new(window->opened, "added", added);
}

static void show(struct window *window, struct atlases *loaded, conus_hemispheres how)
{
    if (!exchange(window, loaded, how)) {
        char why[MESSAGE_SIZE_LIMIT];
        memcpy(why, window->viewer->message, sizeof why);
        give_up_aloud(window, why);
        return;
    }
    if (!describe(window, how)) {
        print_error_line("not enough memory");
    }
    window->hemispheres.now = how;
    say_how(window->viewer, how);
    check_level(window->viewer);
    undo_go_on(window);
    hemispheres_rest(&window->hemispheres);
}

static void end(struct window *window)
{
    struct reload *reload = window->reload;
    struct atlases loaded = {0};
    char why[LOADER_WHY];
    bool is_wanted = !reload->is_dropped;
    bool fine = loader_finish(reload->loader, &loaded, why);
    window->reload = NULL;
    if (fine && is_wanted && is_same(why, window->viewer, &loaded)) {
        show(window, &loaded, reload->how);
    } else if (is_wanted) {
        give_up(window, why);
        if (fine) {
            print_error_line("%s", why);
        }
    }
    atlases_finish(&loaded);
    reload_destroy(reload);
}

/* ---- The whole --------------------------------------------------------------------------------------------------- */

static void drop(struct reload *reload)
{
    reload->is_dropped = true;
    loader_cancel(reload->loader);
}

void reload_step(struct window *window)
{
    if (window->reload && window->reload->how != window->hemispheres.wanted) {
        drop(window->reload);
    }
    if (window->reload && loader_done(window->reload->loader)) {
        end(window);
    }
    if (!window->reload && hemispheres_wait(&window->hemispheres)) {
        begin(window);
    }
}

void reload_end(struct window *window)
{
    hemispheres_rest(&window->hemispheres);
    undo_pay(window);
    if (window->reload) {
        drop(window->reload);
        end(window);
    }
}
