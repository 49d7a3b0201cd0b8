/* SPDX-License-Identifier: BSD-3-Clause */
/* The atlas's notes, where those that many pathways share are one. */
#include "settings/atlas_notes.h"

#include "common/messages.h"

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
static void say_shared(const char *const *words, size_t count, size_t i)
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
        print_error_line("note: %zu pathways: %s", pathways, words[i]);
    } else if (values <= LISTED) {
        print_error_line("note: %zu pathways: %.*ss %s", pathways, common - 1, words[i], list);
    } else {
        print_error_line("note: %zu pathways: %.*ss %s and %zu more (conus info says which)", pathways, common - 1,
                         words[i], list, values - LISTED);
    }
}

void settings_say_notes(const conus_atlas *atlas, const struct common_settings *settings)
{
    size_t count = settings->quiet ? 0 : conus_atlas_note_count(atlas);
    const char **words = calloc(count + 1, sizeof *words); /* without memory each is said by itself */
    for (size_t i = 0; words && i < count; i++) {
        words[i] = said_of_pathway(atlas, conus_atlas_note(atlas, i));
    }
    for (size_t i = 0; i < count; i++) {
        if (!words || !words[i] || count_same(words, count, i, false) == 1) {
            print_error_line("note: %s", conus_atlas_note(atlas, i));
        } else if (!count_same(words, i, i, false)) {
            say_shared(words, count, i);
        }
    }
    free((void *)words);
}
