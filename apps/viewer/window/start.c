/* SPDX-License-Identifier: BSD-3-Clause */
/* Looks for what the start page can offer. */
#include "viewer/window/start.h"

#include "options/messages.h"
#include "viewer/window/state_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool is_recent(const struct start *start, const char *path)
{
    for (size_t i = 0; i < start->recent.count; i++) {
        if (installed_is_same_file(start->recent.paths[i], path)) {
            return true;
        }
    }
    return false;
}

/* The atlas that everybody can have: Debian's mricron-data. */
static void find_atlas(struct start *start)
{
    const conus_installed *aal = NULL;
    bool is_there = start->catalogue && !conus_catalogue_find(&aal, start->catalogue, "mricron:aal") &&
                    strlen(aal->path) < PATH_MAX;
    start->has_no_sample = !is_there;
    start->found[0] = '\0';
    if (is_there && !is_recent(start, aal->path)) {
        memcpy(start->found, aal->path, strlen(aal->path) + 1);
    }
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
    find_atlas(start);
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

const char *start_words(char words[PATH_MAX], const struct start *start, size_t index)
{
    snprintf(words, PATH_MAX, "%s", start_path(start, index));
    make_plain_line(words);
    const char *slash = strrchr(words, '/');
    return slash && slash[1] ? slash + 1 : words;
}

const char *start_words_typed(const struct start *start)
{
    return strchr(start->typed, '/') || start->typed[0] == '~' ? "" : start->typed;
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

bool start_typed(char path[PATH_MAX], struct start *start)
{
    const conus_installed *picked = conus_catalogue_atlas(start->catalogue, start_picked(start));
    if (picked) {
        return installed_words(path, start->catalogue, picked);
    }
    const char *home = getenv("HOME");
    bool at_home = home && strncmp(start->typed, "~/", 2) == 0;
    int size = snprintf(path, PATH_MAX, "%s%s", at_home ? home : "", start->typed + at_home);
    return size > 0 && size < PATH_MAX;
}

bool start_sample(char path[PATH_MAX])
{
    char folder[PATH_MAX];
    static const char file[] = "/brain.atlas.json";
    bool fine = state_file_path(folder, "sample");
    fine = fine && snprintf(path, PATH_MAX, "%s%s", folder, file) < PATH_MAX;
    return fine && (access(path, R_OK) == 0 || !conus_phantom_write("brain", folder, NULL));
}
