/* SPDX-License-Identifier: BSD-3-Clause */
/* What is to be opened next, by a drop, the start page or the dialog; and what the window asks that. */
#include "viewer/window/window.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool window_wants(const struct window *window)
{
    return window->files.wanted.count || window->files.wanted.words;
}

void wanted_finish(struct wanted *wanted)
{
    for (size_t i = 0; i < wanted->count; i++) {
        free(wanted->paths[i]);
    }
    free(wanted->paths);
    json_decref(wanted->words);
    *wanted = (struct wanted){.count = 0};
}

void window_want_all(struct window *window, size_t count, const char *const *paths)
{
    bool fine = true;
    wanted_finish(&window->files.wanted);
    window->files.wanted.paths = calloc(count + 1, sizeof *window->files.wanted.paths);
    for (size_t i = 0; i < count && fine; i++) {
        char *path = window->files.wanted.paths ? strdup(paths[i]) : NULL;
        fine = path;
        if (fine) {
            window->files.wanted.paths[window->files.wanted.count++] = path;
        }
    }
    if (!fine) {
        wanted_finish(&window->files.wanted);
        window_say(window, "not enough memory");
    }
}

void window_want(struct window *window, const char *path)
{
    window_want_all(window, 1, &path);
}

void window_want_typed(struct window *window)
{
    char path[PATH_MAX];
    if (start_typed(path, &window->start)) {
        window_want(window, path);
    }
}

void window_want_sample(struct window *window)
{
    char path[PATH_MAX];
    if (start_sample(path)) {
        window_want(window, path);
    } else {
        window_say(window, conus_message());
    }
}

void window_drop(struct window *window, size_t count, const char *const *paths)
{
    window_want_all(window, count, paths);
    window->files.wanted.asks = !window->start.on && window->viewer->pin_count;
}

void window_ask(struct window *window, const struct wanted *wanted)
{
    window_go_to_start(window);
    if (wanted->count == 1) {
        snprintf(window->start.typed, sizeof window->start.typed, "%s", wanted->paths[0]);
    }
}

const struct json_t *window_words(struct window *window)
{
    const json_t *words = json_object_get(window->files.opened, "options");
    if (!words) {
        window_say(window, "one of the options with which conus was started is not UTF-8: the atlas stays as it is");
    }
    return words;
}

/* Opens the atlas again with these, which are taken over. */
static void want_words(struct window *window, json_t *words)
{
    if (words) {
        wanted_finish(&window->files.wanted);
        window->files.wanted.words = words;
    } else {
        window_say(window, "not enough memory, or a name that is not UTF-8");
    }
}

void window_add(struct window *window, enum addition kind, const char *value)
{
    const json_t *words = window_words(window);
    if (words) {
        want_words(window, additions_with(words, kind, value));
    }
}

void window_take_out(struct window *window, size_t index)
{
    const json_t *words = window_words(window);
    if (words) {
        want_words(window, additions_without(words, index));
    }
}

void window_change(struct window *window, size_t index, enum addition kind, const char *value)
{
    const json_t *words = window_words(window);
    json_t *changed = words ? additions_without(words, index) : NULL;
    if (changed) {
        want_words(window, additions_with(changed, kind, value));
    }
    json_decref(changed);
}

void window_want_hemispheres(struct window *window, conus_hemispheres how, int step)
{
    const json_t *words = window_words(window);
    if (words && how != window->files.hemispheres) {
        want_words(window, hemispheres_put_in_words(words, how));
        window->files.wanted.step = step;
    } else if (words) {
        viewer_say(window->viewer, "%s", hemispheres_meanings[how]);
    }
}

/* Beside the one that was saved last, or else where one can write, by the atlas's name. */
static void find_session_path(char path[PATH_MAX], const struct window *window)
{
    char here[PATH_MAX];
    const char *atlas = window->viewer->atlases->path;
    const char *slash = strrchr(atlas, '/');
    const char *name = slash && slash[1] ? slash + 1 : atlas;
    bool fits = getcwd(here, sizeof here) && access(here, W_OK) == 0;
    const char *home = getenv("HOME");
    int size = window->history.session_path ? snprintf(path, PATH_MAX, "%s", window->history.session_path)
                                            : snprintf(path, PATH_MAX, "%s/%.*s-session.json",
                                                       fits   ? here
                                                       : home ? home
                                                              : "",
                                                       (int)strcspn(name, "."), name);
    path[size < PATH_MAX ? size : 0] = '\0';
}

void window_show_dialog(struct window *window, enum dialog_purpose purpose)
{
    char path[PATH_MAX];
    start_look(&window->start);
    if (purpose == DIALOG_OPEN) {
        dialog_show(&window->dialog, purpose, NULL, &window->start);
    } else if (window->viewer) {
        find_session_path(path, window);
        dialog_show(&window->dialog, purpose, path, &window->start);
    }
}

void window_use_dialog(struct window *window)
{
    char path[PATH_MAX];
    struct dialog *dialog = &window->dialog;
    if (!dialog_enter(path, dialog)) {
        return;
    }
    dialog->on = false;
    if (dialog->purpose == DIALOG_OPEN) {
        window_want(window, path);
    } else {
        free(window->files.saves_as);
        window->files.saves_as = strdup(path);
    }
}

void window_use_folder(struct window *window)
{
    char path[PATH_MAX];
    dialog_here(path, &window->dialog);
    window->dialog.on = false;
    window_want(window, path);
}
