/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares the atlas before and after. */
#include "viewer/opening/news.h"

#include "viewer/model/hemisphere_words.h"

#include <stdio.h>
#include <string.h>

static bool has_note(const conus_atlas *atlas, const char *note)
{
    bool has = false;
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        has = has || strcmp(conus_atlas_note(atlas, i), note) == 0;
    }
    return has;
}

const char *news_note(const conus_atlas *before, const conus_atlas *after, const char *start)
{
    for (size_t i = 0; i < conus_atlas_note_count(after); i++) {
        const char *note = conus_atlas_note(after, i);
        if (strncmp(note, start, strlen(start)) == 0 && !has_note(before, note)) {
            return note;
        }
    }
    return NULL;
}

bool news_has_word(const json_t *words, const json_t *word)
{
    bool has = false;
    for (size_t i = 0; i < json_array_size(words); i++) {
        has = has || json_equal(json_array_get(words, i), word);
    }
    return has;
}

/* The files of one that the other has not. */
static void put_names(char *out, size_t size, const char *title, const json_t *words, const json_t *others)
{
    const char *joint = title;
    for (size_t i = 0; i < json_array_size(words); i++) {
        const char *value = NULL;
        char path[PATH_MAX];
        enum addition kind = addition_of(&value, json_string_value(json_array_get(words, i)));
        if (kind < ADDITION_COUNT && addition_path(path, kind, value) &&
            !news_has_word(others, json_array_get(words, i))) {
            const char *slash = strrchr(path, '/');
            size_t used = strlen(out);
            snprintf(out + used, size - used, "%s%s%s%s", used && joint == title ? "; " : "", joint,
                     slash ? slash + 1 : path, kind == ADD_CONTEXT ? " as context" : "");
            joint = ", ";
        }
    }
}

void news_tell(char *out, size_t size, const struct window *window, const conus_atlas *now, const json_t *words)
{
    const json_t *then = json_object_get(window->files.opened, "options");
    const char *note = news_note(window->viewer->atlases->atlas, now, "");
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
