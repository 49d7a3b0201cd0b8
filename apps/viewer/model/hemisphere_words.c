/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds and exchanges the word of --hemispheres. */
#include "viewer/model/hemisphere_words.h"

#include "settings/settings.h"

#include <string.h>

const char *const hemispheres_meanings[HEMISPHERES_COUNT] = {"areas as in the file", "split left and right",
                                                             "left and right as one"};

static const char option[] = "--hemispheres=";

/* What is behind the equals sign; NULL of another word. */
static const char *value_of(const json_t *word)
{
    const char *text = json_string_value(word);
    return text && strncmp(text, option, strlen(option)) == 0 ? text + strlen(option) : NULL;
}

conus_hemispheres hemispheres_of_words(const json_t *words)
{
    conus_hemispheres how = CONUS_HEMISPHERES_AS_IS;
    for (size_t i = 0; i < json_array_size(words); i++) {
        const char *value = value_of(json_array_get(words, i));
        for (size_t k = 0; value && settings_hemispheres[k]; k++) {
            how = strcmp(value, settings_hemispheres[k]) == 0 ? (conus_hemispheres)k : how;
        }
    }
    return how;
}

json_t *hemispheres_put_in_words(const json_t *given, conus_hemispheres how)
{
    json_t *words = json_copy((json_t *)given);
    for (size_t i = json_array_size(words); i-- > 0;) {
        if (value_of(json_array_get(words, i))) {
            json_array_remove(words, i);
        }
    }
    if (how && json_array_append_new(words, json_sprintf("%s%s", option, settings_hemispheres[how]))) {
        json_decref(words);
        words = NULL;
    }
    return words;
}
