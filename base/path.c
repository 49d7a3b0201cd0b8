/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes paths apart. It needs nothing else of conus, so that programs have it, too. */
#include "base/path.h"

#include "base/system/system.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static bool is_separator(char c)
{
    return c && strchr(SYSTEM_SEPARATORS, c);
}

/* Length of the drive that a path begins with: "C:", where there are such. */
static size_t drive_length(const char *path)
{
    return SYSTEM_SEPARATORS[1] && isalpha((unsigned char)path[0]) && path[1] == ':' ? 2 : 0;
}

/* The first separator, or NULL. */
static char *find_separator(char *path)
{
    return strpbrk(path, SYSTEM_SEPARATORS);
}

bool path_is_whole(const char *path)
{
    return path && (drive_length(path) || is_separator(path[0]));
}

bool path_is_name(const char *path)
{
    return path_folder_length(path) == 0;
}

const char *path_base(const char *path)
{
    return path + path_folder_length(path);
}

/* Whether a title is a number, perhaps of a side. */
static bool is_number(const char *title)
{
    const size_t digits = strspn(title, "0123456789");
    const char *rest = title + digits;
    return digits && (!*rest || strcmp(rest, " left") == 0 || strcmp(rest, " right") == 0);
}

const char *path_title(char *out, size_t size, const char *title, const char *path)
{
    enum { LONGEST = 40 }; /* bytes: with a number, a share and a distance as wide as a column of print */
    const char *base = path_base(path);
    const size_t length = strcspn(base, ".");
    if (!is_number(title) || !length || length > LONGEST) {
        return title;
    }
    snprintf(out, size, "%.*s %s", (int)length, base, title);
    out[0] = (char)toupper((unsigned char)out[0]);
    return out;
}

size_t path_folder_length(const char *path)
{
    return path_length_above(path, strlen(path));
}

size_t path_length_above(const char *path, size_t length)
{
    const size_t drive = drive_length(path);
    while (length > drive && !is_separator(path[length - 1])) {
        length--;
    }
    return length;
}

size_t path_plain_length(const char *path, size_t length)
{
    const size_t root = drive_length(path) + 1;
    while (length > root && is_separator(path[length - 1])) {
        length--;
    }
    return length;
}

const char *path_joint(const char *folder, size_t length)
{
    return length > drive_length(folder) && !is_separator(folder[length - 1]) ? "/" : "";
}

char *path_cut(char *path)
{
    size_t length = path_folder_length(path);
    char *cut = length > drive_length(path) ? path + length - 1 : NULL;
    if (cut) {
        *cut = '\0';
    }
    return cut;
}

bool path_part(const char **rest, const char **part, size_t *size)
{
    *part = *rest;
    *size = strcspn(*rest, SYSTEM_SEPARATORS);
    *rest += *size + is_separator((*rest)[*size]);
    return *rest > *part;
}

bool path_each_folder(char *path, size_t from, bool (*take)(void *user, const char *folder), void *user)
{
    bool goes_on = true;
    const size_t root = drive_length(path) + 1; /* no folder of its own where there are drives */
    for (char *at = find_separator(path + (from > root || root == 1 ? from : root)); at && goes_on;
         at = find_separator(at + 1)) {
        const char separator = *at;
        *at = '\0';
        goes_on = take(user, path);
        *at = separator;
    }
    return goes_on;
}

bool path_ends_in(const char *path, const char *ending)
{
    size_t length = strlen(path);
    size_t tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

size_t path_ending_within(const char *path, size_t length, const char *endings)
{
    for (const char *at = endings; *at;) {
        size_t tail = strcspn(at, "/");
        if (length > tail && strncasecmp(path + length - tail, at, tail) == 0) {
            return tail;
        }
        at += tail + (at[tail] == '/');
    }
    return 0;
}

size_t path_ending_length(const char *path, const char *endings)
{
    return path_ending_within(path, strlen(path), endings);
}
