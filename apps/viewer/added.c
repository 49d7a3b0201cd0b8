/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares the atlas before and after. */
#include "viewer/added.h"

#include "viewer/opening/additions.h"

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

const char *added_note(const conus_atlas *before, const conus_atlas *after, const char *start)
{
    for (size_t i = 0; i < conus_atlas_note_count(after); i++) {
        const char *note = conus_atlas_note(after, i);
        if (strncmp(note, start, strlen(start)) == 0 && !has_note(before, note)) {
            return note;
        }
    }
    return NULL;
}

static bool has_word(const json_t *words, const json_t *word)
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
        if (kind < ADDITION_COUNT && addition_path(path, kind, value) && !has_word(others, json_array_get(words, i))) {
            const char *slash = strrchr(path, '/');
            size_t used = strlen(out);
            snprintf(out + used, size - used, "%s%s%s%s", used && joint == title ? "; " : "", joint,
                     slash ? slash + 1 : path, kind == ADD_CONTEXT ? " as context" : "");
            joint = ", ";
        }
    }
}

void added_news(char *out, size_t size, const json_t *then, const json_t *now)
{
    out[0] = '\0';
    put_names(out, size, "added: ", now, then);
    put_names(out, size, "taken out: ", then, now);
}

/* Of the same kind and name; 0 = there is none. */
static uint32_t find_same(const conus_atlas *atlas, const conus_object *wanted)
{
    for (uint32_t number = 1; wanted && number <= conus_atlas_object_count(atlas); number++) {
        const conus_object *object = conus_atlas_object(atlas, number);
        bool same_label = object->kind != CONUS_KIND_AREA || object->label == wanted->label;
        if (object->kind == wanted->kind && same_label && strcmp(object->name, wanted->name) == 0) {
            return number;
        }
    }
    return 0;
}

void added_choose(struct viewer *viewer, const struct viewer *before)
{
    for (size_t i = 0; i < viewer->atlas_count && i < before->atlas_count; i++) {
        struct shown_objects *shown = &viewer->atlases[i].shown;
        const struct view_atlas *then = &before->atlases[i];
        shown->chosen = find_same(viewer->atlases[i].atlas, conus_atlas_object(then->atlas, then->shown.chosen));
        memcpy(shown->search, then->shown.search, sizeof shown->search);
    }
}
