/* SPDX-License-Identifier: BSD-3-Clause */
/* Drops files, types paths, adds files and takes them out. */
#include "viewer/commands/script_add.h"

#include <jansson.h>
#include <string.h>

static bool type(struct window *window, const char *text)
{
    struct start *start = &window->start;
    if (window->dialog.on) {
        dialog_set(&window->dialog, text);
        return true;
    }
    size_t size = strlen(text) + 1;
    bool fine = start->on && size <= sizeof start->typed;
    memcpy(start->typed, text, fine ? size : 0);
    return fine;
}

static bool take_out(struct window *window, const char *path)
{
    const json_t *words = window_words(window);
    size_t index = additions_index(words, path);
    bool fine = index < json_array_size(words);
    if (fine) {
        window_take_out(window, index);
    }
    return fine;
}

bool script_add(struct window *window, char *const *words, size_t count)
{
    int kind = 0;
    if (strcmp(words[0], "type") == 0) {
        return type(window, words[1]);
    }
    if (strcmp(words[0], "drop") == 0) {
        window_drop(window, count, (const char *const *)words + 1);
        return true;
    }
    if (strcmp(words[0], "take-out") == 0) {
        return take_out(window, words[1]);
    }
    while (kind < ADD_STREAMLINES && strcmp(addition_names[kind], words[0]) != 0) {
        kind++;
    }
    window_add(window, (enum addition)kind, words[1]);
    return true;
}
