/* SPDX-License-Identifier: BSD-3-Clause */
/* Ranks objects by how well their names fit. */
#include "viewer/model/viewer.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Whether a byte is part of a word; bytes of UTF-8 beyond ASCII are. */
static bool is_of_word(char c)
{
    return isalnum((unsigned char)c) || (unsigned char)c >= 0x80;
}

static enum search_fit fit_name(const char *name, const char *text)
{
    enum search_fit best = SEARCH_NONE;
    size_t length = strlen(text);
    if (strcasecmp(name, text) == 0) {
        return strcmp(name, text) == 0 ? SEARCH_SAME : SEARCH_EXACT;
    }
    for (const char *at = name; *at && best < SEARCH_WORD; at++) {
        if (strncasecmp(at, text, length) == 0) {
            bool begins_word = at > name && is_of_word(*at) && !is_of_word(at[-1]);
            best = at == name ? SEARCH_BEGIN : begins_word ? SEARCH_WORD : SEARCH_PART;
        }
    }
    return best;
}

enum search_fit search_fit(const conus_object *object, const char *text)
{
    char label[16];
    if (!*text) {
        return SEARCH_NONE;
    }
    enum search_fit name = fit_name(object->name, text);
    enum search_fit abbreviation = fit_name(object->abbreviation, text);
    enum search_fit best = name > abbreviation ? name : abbreviation;
    snprintf(label, sizeof label, "%u", object->label);
    return best == SEARCH_NONE && strcmp(label, text) == 0 ? SEARCH_LABEL : best;
}

uint32_t *search_all(size_t *count, const conus_atlas *atlas, const char *text)
{
    size_t objects = conus_atlas_object_count(atlas);
    uint8_t *fits = calloc(objects + 1, 1);
    uint32_t *found = calloc(objects + 1, sizeof *found);
    *count = 0;
    if (!fits || !found) {
        free(fits);
        free(found);
        return NULL;
    }
    for (size_t number = 1; number <= objects; number++) {
        fits[number] = (uint8_t)search_fit(conus_atlas_object(atlas, number), text);
        *count += fits[number] != SEARCH_NONE;
    }
    uint32_t meant = 0; /* as it is on the command line: "left hippocampus" is Hippocampus_L */
    const bool has_letters = text[strspn(text, "0123456789")];
    if (has_letters && !conus_atlas_find(&meant, atlas, text) && fits[meant] == SEARCH_NONE) {
        fits[meant] = SEARCH_EXACT;
        ++*count;
    }
    size_t used = 0;
    for (int fit = SEARCH_FIT_END - 1; fit > SEARCH_NONE; fit--) { /* what fits best first */
        for (size_t number = 1; number <= objects; number++) {
            if (fits[number] == fit) {
                found[used++] = (uint32_t)number;
            }
        }
    }
    free(fits);
    return found;
}

uint32_t search_best(const conus_atlas *atlas, const char *text)
{
    size_t count;
    uint32_t *found = search_all(&count, atlas, text);
    uint32_t best = found && count ? found[0] : 0;
    free(found);
    return best;
}
