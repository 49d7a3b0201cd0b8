/* SPDX-License-Identifier: BSD-3-Clause */
/* Looks for what the start page can offer, and searches the catalogue by what is typed. */
#include "viewer/window/start.h"

#include "base/path.h"
#include "conus/phantom.h"
#include "options/messages.h"
#include "options/output.h"
#include "viewer/window/state_file.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static const char gaps[] = "-_.+ :";

static bool has_word(const char *name, const char *word, size_t length)
{
    for (; *name; name++) {
        if (strncasecmp(name, word, length) == 0) {
            return true;
        }
    }
    return false;
}

bool installed_fits(const conus_installed *atlas, const char *text)
{
    bool fits = true;
    for (const char *word = text; *word && fits;) {
        size_t length = strcspn(word, gaps);
        fits = has_word(atlas->name, word, length) || strncasecmp(atlas->source, word, length) == 0;
        word += length;
        word += strspn(word, gaps);
    }
    return fits;
}

/* Whether the files `a` and `b` are one atlas in two places: of one name and of as many bytes. */
static bool installed_is_same_file(const char *a, const char *b)
{
    struct system_stat infos[2];
    return strcmp(a, b) == 0 || (strcmp(path_name(a), path_name(b)) == 0 && system_stat(&infos[0], a) &&
                                 system_stat(&infos[1], b) && infos[0].size == infos[1].size);
}

const char *installed_about(const char *name)
{
    static const char *const known[][2] = {{"aal", "Automated Anatomical Labeling, human"},
                                           {"aicha", "AICHA, areas by function, human"},
                                           {"brodmann", "Brodmann's areas, human"},
                                           {"ccfv3", "Allen CCFv3, mouse"},
                                           {"d99", "D99, macaque"},
                                           {"harvardoxford-cort", "Harvard-Oxford, cortex, human"},
                                           {"harvardoxford-sub", "Harvard-Oxford, below the cortex, human"},
                                           {"inia19", "INIA19 NeuroMaps, macaque"},
                                           {"jhu-whitematter", "JHU, white matter, human"},
                                           {"jhu189", "JHU, 189 areas, human"},
                                           {"natbrainlab", "NatBrainLab, pathways, human"},
                                           {"nmt", "NMT, macaque"}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (strncasecmp(name, known[i][0], strlen(known[i][0])) == 0) {
            return known[i][1];
        }
    }
    return NULL;
}

bool installed_is_twin(const conus_catalogue *catalogue, size_t index)
{
    const conus_installed *atlas = conus_catalogue_atlas(catalogue, index);
    bool is = false;
    for (size_t i = 0; i < index && !is; i++) {
        const conus_installed *other = conus_catalogue_atlas(catalogue, i);
        is = strcmp(other->name, atlas->name) == 0 && strcmp(other->kind, atlas->kind) == 0 &&
             installed_is_same_file(other->path, atlas->path);
    }
    return is;
}

/* Whether `words` means this one and no other. */
static bool means(const conus_catalogue *catalogue, const char *words, const conus_installed *atlas)
{
    const conus_installed *found = NULL;
    return !conus_atlas_is_path(words) && !conus_catalogue_find(&found, catalogue, words) && found == atlas;
}

/* Index of the atlas that a text means: the one of that name, else the first that fits; else the number of atlases. */
static size_t installed_best(const conus_catalogue *catalogue, const char *text)
{
    size_t count = conus_catalogue_count(catalogue);
    const conus_installed *named = NULL;
    size_t best = count;
    if (text[0] && conus_catalogue_find(&named, catalogue, text)) {
        named = NULL;
    }
    for (size_t i = count; i-- > 0;) {
        const conus_installed *atlas = conus_catalogue_atlas(catalogue, i);
        if (named ? atlas == named : installed_fits(atlas, text)) {
            best = i;
        }
    }
    return best;
}

/* The next one that fits and is no twin, from `index` up (1) or down (-1) the list; else `index`. */
static size_t installed_next(const conus_catalogue *catalogue, const char *text, size_t index, int by)
{
    size_t count = conus_catalogue_count(catalogue);
    const size_t step =
        by > 0 ? 1 : SIZE_MAX; /* adding SIZE_MAX goes one back, and from 0 to SIZE_MAX, which ends the loop */
    for (size_t i = index + step; i < count; i += step) {
        if (installed_fits(conus_catalogue_atlas(catalogue, i), text) && !installed_is_twin(catalogue, i)) {
            return i;
        }
    }
    return index;
}

bool installed_words(char out[SYSTEM_PATH], const conus_catalogue *catalogue, const conus_installed *atlas)
{
    int size = snprintf(out, SYSTEM_PATH, "%s", atlas->name);
    if (!means(catalogue, out, atlas)) {
        size = snprintf(out, SYSTEM_PATH, "%s:%s", atlas->source, atlas->name);
    }
    if (size >= SYSTEM_PATH || !means(catalogue, out, atlas)) {
        size = snprintf(out, SYSTEM_PATH, "%s", atlas->path);
    }
    return size < SYSTEM_PATH;
}

static bool is_recent(const struct start *start, const char *path)
{
    for (size_t i = 0; i < start->recent.count; i++) {
        if (installed_is_same_file(start->recent.paths[i], path)) {
            return true;
        }
    }
    return false;
}

void start_look(struct start *start)
{
    start_finish(start);
    recent_load(&start->recent);
    if (conus_catalogue_create(&start->catalogue, NULL)) {
        start->catalogue = NULL;
    }
    start->picked = conus_catalogue_count(start->catalogue);
    start->picked_by[0] = '\0';
    const conus_installed *aal = NULL; /* which everybody can have: Debian's mricron-data */
    bool is_there = start->catalogue && !conus_catalogue_find(&aal, start->catalogue, "mricron:aal") &&
                    strlen(aal->path) < SYSTEM_PATH;
    start->has_no_sample = !is_there;
    start->found[0] = '\0';
    if (is_there && !is_recent(start, aal->path)) {
        memcpy(start->found, aal->path, strlen(aal->path) + 1);
    }
}

void start_finish(struct start *start)
{
    conus_catalogue_destroy(start->catalogue);
    start->catalogue = NULL;
}

const char *start_path(const struct start *start, size_t index)
{
    if (index < start->recent.count) {
        return start->recent.paths[index];
    }
    return index == start->recent.count && start->found[0] ? start->found : NULL;
}

const char *start_words(char words[SYSTEM_PATH], const struct start *start, size_t index)
{
    snprintf(words, SYSTEM_PATH, "%s", start_path(start, index));
    make_plain_line(words);
    return path_name(words);
}

const char *start_words_typed(const struct start *start)
{
    return !path_is_name(start->typed) || start->typed[0] == '~' ? "" : start->typed;
}

size_t start_picked(struct start *start)
{
    size_t count = conus_catalogue_count(start->catalogue);
    if (strcmp(start->picked_by, start->typed) != 0) {
        bool is_words = count && start_words_typed(start)[0] && !conus_atlas_is_path(start->typed);
        start->picked = is_words ? installed_best(start->catalogue, start->typed) : count;
        memcpy(start->picked_by, start->typed, sizeof start->typed);
    }
    return start->picked < count ? start->picked : count;
}

void start_move(struct start *start, int by)
{
    const char *words = start_words_typed(start);
    size_t count = conus_catalogue_count(start->catalogue);
    size_t picked = start_picked(start);
    start->scrolls = true;
    if (picked < count) {
        start->picked = installed_next(start->catalogue, words, picked, by);
    } else if (count) { /* from below the list to its first, or from above to its last */
        start->picked = by > 0 ? installed_next(start->catalogue, words, SIZE_MAX, 1)
                               : installed_next(start->catalogue, words, count, -1);
    }
}

bool start_typed(char path[SYSTEM_PATH], struct start *start)
{
    const conus_installed *picked = conus_catalogue_atlas(start->catalogue, start_picked(start));
    if (picked) {
        return installed_words(path, start->catalogue, picked);
    }
    return typed_path(path, start->typed);
}

bool start_sample(char path[SYSTEM_PATH])
{
    char folder[SYSTEM_PATH];
    static const char file[] = "/brain.atlas.json";
    bool fine = state_file_path(folder, "sample");
    fine = fine && snprintf(path, SYSTEM_PATH, "%s%s", folder, file) < SYSTEM_PATH;
    return fine && (system_allows(path, SYSTEM_READ) || !conus_phantom_write("brain", folder, NULL));
}
