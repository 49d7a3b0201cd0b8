/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes paths apart. It needs nothing else of conus, so that programs have it, too. */
#include "base/path.h"

#include <string.h>
#include <strings.h>

bool path_is_whole(const char *path)
{
    return path && path[0] == '/';
}

bool path_is_name(const char *path)
{
    return !strchr(path, '/');
}

const char *path_base(const char *path)
{
    return path + path_folder_length(path);
}

size_t path_folder_length(const char *path)
{
    return path_length_above(path, strlen(path));
}

size_t path_length_above(const char *path, size_t length)
{
    while (length && path[length - 1] != '/') {
        length--;
    }
    return length;
}

size_t path_plain_length(const char *path, size_t length)
{
    while (length > 1 && path[length - 1] == '/') {
        length--;
    }
    return length;
}

const char *path_joint(const char *folder, size_t length)
{
    return length && folder[length - 1] != '/' ? "/" : "";
}

char *path_cut(char *path)
{
    char *cut = strrchr(path, '/');
    if (cut) {
        *cut = '\0';
    }
    return cut;
}

void path_join_again(char *cut)
{
    *cut = '/';
}

bool path_part(const char **rest, const char **part, size_t *size)
{
    *part = *rest;
    *size = strcspn(*rest, "/");
    *rest += *size + ((*rest)[*size] == '/');
    return *rest > *part;
}

bool path_each_folder(char *path, size_t from, bool (*take)(void *user, const char *folder), void *user)
{
    bool goes_on = true;
    for (char *at = strchr(path + from, '/'); at && goes_on; at = strchr(at + 1, '/')) {
        *at = '\0';
        goes_on = take(user, path);
        *at = '/';
    }
    return goes_on;
}

bool path_ends_in(const char *path, const char *ending)
{
    size_t length = strlen(path);
    size_t tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

size_t path_ending_length(const char *path, const char *endings)
{
    size_t length = strlen(path);
    for (const char *at = endings; *at;) {
        size_t tail = strcspn(at, "/");
        if (length > tail && strncasecmp(path + length - tail, at, tail) == 0) {
            return tail;
        }
        at += tail + (at[tail] == '/');
    }
    return 0;
}
