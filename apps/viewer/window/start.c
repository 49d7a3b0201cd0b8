/* SPDX-License-Identifier: BSD-3-Clause */
/* Looks for what the start page can offer. */
#include "viewer/window/start.h"

#include "common/messages.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_recent(const struct start *start, const char *path)
{
    for (size_t i = 0; i < start->recent.count; i++) {
        if (strcmp(start->recent.paths[i], path) == 0) {
            return true;
        }
    }
    return false;
}

/* The atlas that everybody can have: Debian's mricron-data. */
static void find_atlas(struct start *start)
{
    conus_catalogue *catalogue = NULL;
    const conus_installed *aal = NULL;
    start->found[0] = '\0';
    if (!conus_catalogue_create(&catalogue, NULL) && !conus_catalogue_find(&aal, catalogue, "mricron:aal") &&
        strlen(aal->path) < PATH_MAX && !is_recent(start, aal->path)) {
        memcpy(start->found, aal->path, strlen(aal->path) + 1);
    }
    conus_catalogue_destroy(catalogue);
}

void start_look(struct start *start)
{
    recent_load(&start->recent);
    find_atlas(start);
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

bool start_typed(char path[PATH_MAX], const struct start *start)
{
    const char *home = getenv("HOME");
    bool at_home = home && strncmp(start->typed, "~/", 2) == 0;
    int size = snprintf(path, PATH_MAX, "%s%s", at_home ? home : "", start->typed + at_home);
    return size > 0 && size < PATH_MAX;
}
