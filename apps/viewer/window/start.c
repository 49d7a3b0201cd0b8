/* SPDX-License-Identifier: BSD-3-Clause */
/* Looks for what the start page can offer, and searches the catalogue by what is typed. */
#include "viewer/window/start.h"

#include "base/path.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "viewer/model/viewer.h"
#include "viewer/ui/ui.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { PATH_LIMIT = RECENT_LIMIT + 1 /* and the sample */ };

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

/* Whether each word of text is in the atlas's name, or is its source's name or the beginning of that. Upper and
 * lower case are the same, and so are '-', '_', '.', '+' and spaces. An empty text fits all. */
static bool installed_fits(const conus_installed *atlas, const char *text)
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

/* Whether the paths of the lists have it. */
static bool is_offered(const struct start *start, const char *path)
{
    const char *offered;
    for (size_t i = 0; (offered = start_path(start, i)); i++) {
        if (installed_is_same_file(offered, path)) {
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
    if (is_there && !is_offered(start, aal->path)) {
        memcpy(start->found, aal->path, strlen(aal->path) + 1);
    }
    start->paints = PATH_LIMIT;
    start->known = calloc(PATH_LIMIT + conus_catalogue_count(start->catalogue), sizeof *start->known);
}

void start_finish(struct start *start)
{
    start_stop(start);
    for (size_t i = 0; start->known && i < PATH_LIMIT + conus_catalogue_count(start->catalogue); i++) {
        texture_drop(&start->known[i].picture);
    }
    free(start->known);
    start->known = NULL;
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

struct known_atlas start_known(struct start *start, size_t index, bool is_installed)
{
    const char *path = is_installed ? conus_catalogue_atlas(start->catalogue, index)->path : start_path(start, index);
    struct known_atlas *known = start->known ? start->known + (is_installed ? PATH_LIMIT : 0) + index : NULL;
    if (known && !known->is_looked_for) {
        struct thumbnail *thumbnail = malloc(sizeof *thumbnail);
        if (thumbnail && thumbnail_load(thumbnail, path)) {
            known->areas = thumbnail->areas;
            texture_set(&known->picture, thumbnail->rgba[0][0], THUMBNAIL_WIDTH, THUMBNAIL_HEIGHT, true);
        }
        free(thumbnail);
        known->is_looked_for = true;
    }
    return known ? *known : (struct known_atlas){0};
}

static const double CLOSER = 2; /* clicks of the wheel: a brain fills the picture */

/* Opens the atlas of a path, and asks for its picture. */
static void begin_picture(struct start *start, size_t index, void (*wake)(void))
{
    struct view_source source = {.path = start_path(start, index)};
    struct viewer *viewer = calloc(1, sizeof *viewer);
    start->paints = index;
    if (!viewer || conus_atlas_load(&source.atlas, source.path, NULL) ||
        viewer_create(viewer, &source, 1, NULL, NULL, wake)) {
        conus_atlas_destroy(source.atlas);
        free(viewer);
        return;
    }
    struct painting what = {.width = THUMBNAIL_WIDTH,
                            .height = THUMBNAIL_HEIGHT,
                            .answer = viewer_pictured(viewer),
                            .is_dark = theme_used() == THEME_DARK};
    orbit_zoom(&viewer->orbit, CLOSER);
    eye_of_orbit(&what.eye, &viewer->orbit, (double[]){THUMBNAIL_WIDTH, THUMBNAIL_HEIGHT});
    painter_ask(viewer->painter, &what);
    start->painted = viewer;
}

void start_stop(struct start *start)
{
    if (start->painted) {
        viewer_finish(start->painted);
        free(start->painted);
        start->painted = NULL;
    }
}

/* Takes what was drawn so far; keeps the last and finest. */
static void take_picture(struct start *start, bool keeps)
{
    struct painted picture;
    struct known_atlas *known = &start->known[start->paints];
    char why[PAINTER_TEXT];
    bool ends = painter_text(why, start->painted->painter, PAINTER_ERROR);
    if (painter_take(start->painted->painter, &picture)) {
        known->areas = (uint32_t)start->painted->drawn->object_count;
        texture_set(&known->picture, picture.rgba, picture.width, picture.height, true);
        if (picture.fine && keeps) {
            thumbnail_keep(start_path(start, start->paints), known->areas, &picture);
        }
        free(picture.rgba);
        ends = ends || picture.fine;
    }
    if (ends) {
        start_stop(start);
    }
}

size_t start_pictured(struct start *start, void (*wake)(void), bool keeps)
{
    size_t index = 0;
    if (start->painted) {
        take_picture(start, keeps);
    }
    while (start_path(start, index) && !start_known(start, index, false).picture.name) {
        index++;
    }
    if (start_path(start, index)) {
        return index;
    }
    if (start->known && start->found[0] && start->paints == PATH_LIMIT) {
        begin_picture(start, start->recent.count, wake);
    }
    return start->painted ? start->paints : SIZE_MAX;
}

const conus_installed *start_installed(const struct start *start, const char *path)
{
    const conus_installed *atlas;
    for (size_t i = 0; (atlas = conus_catalogue_atlas(start->catalogue, i)); i++) {
        if (installed_is_same_file(atlas->path, path)) {
            return atlas;
        }
    }
    return NULL;
}

bool start_lists(struct start *start, size_t index)
{
    const conus_installed *atlas = conus_catalogue_atlas(start->catalogue, index);
    const char *words = start_words_typed(start);
    bool is_named = index == start_picked(start); /* as "mricron:aal" */
    bool is_twin = installed_is_twin(start->catalogue, index) || (!words[0] && is_offered(start, atlas->path));
    return installed_fits(atlas, words) && (is_named || !is_twin);
}

/* The next one of the list, from `index` up (1) or down (-1); else `index`. */
static size_t find_next(struct start *start, size_t index, int by)
{
    size_t count = conus_catalogue_count(start->catalogue);
    const size_t step =
        by > 0 ? 1 : SIZE_MAX; /* adding SIZE_MAX goes one back, and from 0 to SIZE_MAX, which ends the loop */
    for (size_t i = index + step; i < count; i += step) {
        if (start_lists(start, i)) {
            return i;
        }
    }
    return index;
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
    size_t count = conus_catalogue_count(start->catalogue);
    size_t picked = start_picked(start);
    start->scrolls = true;
    if (picked < count) {
        start->picked = find_next(start, picked, by);
    } else if (count) { /* from below the list to its first, or from above to its last */
        start->picked = find_next(start, by > 0 ? SIZE_MAX : count, by);
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
