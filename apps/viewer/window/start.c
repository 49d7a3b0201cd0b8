/* SPDX-License-Identifier: BSD-3-Clause */
/* Looks for what the start page can offer. */
#include "viewer/window/start.h"

#include "common/messages.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Of Debian's mricron-data, below a folder of data. */
static const char templates[] = "mricron/templates/aal.nii.gz";

static bool is_recent(const struct start *start, const char *path)
{
    for (size_t i = 0; i < start->recent.count; i++) {
        if (strcmp(start->recent.paths[i], path) == 0) {
            return true;
        }
    }
    return false;
}

/* In the folders of $XDG_DATA_DIRS, of which the specification ignores relative ones. */
static void find_atlas(struct start *start)
{
    const char *folders = getenv("XDG_DATA_DIRS");
    folders = folders && folders[0] ? folders : "/usr/local/share:/usr/share";
    start->found[0] = '\0';
    while (*folders && !start->found[0]) {
        char path[PATH_MAX] = "";
        int length = (int)strcspn(folders, ":");
        bool slash = length && folders[length - 1] == '/';
        int size = snprintf(path, sizeof path, "%.*s/%s", length - slash, folders, templates);
        if (folders[0] == '/' && size < PATH_MAX && access(path, R_OK) == 0) {
            memcpy(start->found, path, sizeof path);
        }
        folders += length + (folders[length] == ':');
    }
    if (is_recent(start, start->found)) {
        start->found[0] = '\0';
    }
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
