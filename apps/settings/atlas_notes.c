/* SPDX-License-Identifier: BSD-3-Clause */
/* The atlas's notes, where those that many pathways share are one. */
#include "settings/atlas_notes.h"

#include "options/messages.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LISTED = 8, LIST_SIZE = 512 };

/* What comes last where it is said of a pathway which threshold it has. */
static const char threshold_mark[] = "; threshold ";

/* What a note says of a pathway, behind "pathway NAME: "; NULL = it is of something else. */
static const char *said_of_pathway(const conus_atlas *atlas, const char *note)
{
    static const char start[] = "pathway ";
    for (size_t k = 1; strncmp(note, start, strlen(start)) == 0 && k <= conus_atlas_object_count(atlas); k++) {
        const conus_object *object = conus_atlas_object(atlas, k);
        const char *behind = note + strlen(start);
        size_t length = strlen(object->name);
        if (object->kind == CONUS_KIND_PATHWAY && strncmp(behind, object->name, length) == 0 &&
            strncmp(behind + length, ": ", 2) == 0) {
            return behind + length + 2;
        }
    }
    return NULL;
}

/* The threshold that it ends with, or its end. */
static const char *threshold_in(const char *words)
{
    const char *mark = strstr(words, threshold_mark);
    return mark ? mark + strlen(threshold_mark) : words + strlen(words);
}

/* Whether both say the same, but for the threshold. */
static bool is_same(const char *a, const char *b)
{
    size_t length = (size_t)(threshold_in(a) - a);
    return length == (size_t)(threshold_in(b) - b) && strncmp(a, b, length) == 0;
}

/* How many of the notes before `end` say the same as words[i], with its threshold if `exactly`. */
static size_t count_same(const char *const *words, size_t end, size_t i, bool exactly)
{
    size_t count = 0;
    for (size_t k = 0; k < end; k++) {
        count += words[k] && (exactly ? strcmp(words[k], words[i]) == 0 : is_same(words[k], words[i]));
    }
    return count;
}

/* One note for all that say the same as the first of them, words[i]. */
static void say_shared(const char *of, const char *const *words, size_t count, size_t i)
{
    char list[LIST_SIZE] = "";
    size_t size = 0;
    size_t values = 0;
    for (size_t k = i; k < count; k++) {
        if (words[k] && is_same(words[k], words[i]) && !count_same(words, k, k, true) && values++ < LISTED) {
            int more = snprintf(list + size, sizeof list - size, "%s%s", size ? ", " : "", threshold_in(words[k]));
            size = more > 0 && size + (size_t)more < sizeof list ? size + (size_t)more : size;
        }
    }
    int common = (int)(threshold_in(words[i]) - words[i]);
    size_t pathways = count_same(words, count, i, false);
    if (values == 1) {
        print_error_line("note: %s%zu pathways: %s", of, pathways, words[i]);
    } else if (values <= LISTED) {
        print_error_line("note: %s%zu pathways: %.*ss %s", of, pathways, common - 1, words[i], list);
    } else {
        print_error_line("note: %s%zu pathways: %.*ss %s and %zu more (conus info says which)", of, pathways,
                         common - 1, words[i], list, values - LISTED);
    }
}

/* `of` begins each note: "NAME: ", or nothing. */
static void say_notes(const conus_atlas *atlas, const char *of)
{
    size_t count = conus_atlas_note_count(atlas);
    const char **words = calloc(count + 1, sizeof *words); /* without memory each is said by itself */
    for (size_t i = 0; words && i < count; i++) {
        words[i] = said_of_pathway(atlas, conus_atlas_note(atlas, i));
    }
    for (size_t i = 0; i < count; i++) {
        if (!words || !words[i] || count_same(words, count, i, false) == 1) {
            print_error_line("note: %s%s", of, conus_atlas_note(atlas, i));
        } else if (!count_same(words, i, i, false)) {
            say_shared(of, words, count, i);
        }
    }
    free((void *)words);
}

void settings_say_notes(const conus_atlas *atlas, const struct common_settings *settings)
{
    if (!settings->quiet) {
        say_notes(atlas, "");
    }
}

void atlases_say_notes(const struct atlases *atlases, const struct common_settings *settings)
{
    for (size_t i = 0; i < atlases->count && !settings->quiet; i++) {
        char of[ATLAS_PREFIX_SIZE];
        say_notes(atlases->items[i].atlas, atlases_prefix(of, &atlases->items[i]));
    }
}

/* A surface that is not closed has no volume, nor has one whose parts overlap or face different ways. */
static void say_open(const conus_atlas *atlas, const char *of)
{
    size_t surfaces = 0;
    size_t open = 0;
    size_t odd = 0;
    for (size_t number = 1; number <= conus_atlas_object_count(atlas); number++) {
        const conus_object *object = conus_atlas_object(atlas, number);
        surfaces += object->triangles > 0;
        open += object->triangles > 0 && !object->closed;
        odd += object->closed && object->volume_mm3 == 0;
    }
    if (odd) {
        print_error_line(
            "note: %s%zu of %zu surfaces overlap themselves, or have parts that face inwards and are no cavities: "
            "there is no fraction",
            of, odd, surfaces);
    }
    if (open) {
        print_error_line(
            "note: %s%zu of %zu surfaces are not closed: paths count only where a ray goes in and comes out, and "
            "there is no fraction",
            of, open, surfaces);
    }
}

void atlases_say_open(const struct atlases *atlases, const struct engine_settings *engine,
                      const struct common_settings *settings)
{
    bool said = engine->layers == CONUS_LAYERS_ALL && !settings->quiet;
    for (size_t i = 0; i < atlases->count && said; i++) {
        char of[ATLAS_PREFIX_SIZE];
        say_open(atlases->items[i].atlas, atlases_prefix(of, &atlases->items[i]));
    }
}
