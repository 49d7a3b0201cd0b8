/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads, changes and writes the list of atlases that were opened lately. */
#include "viewer/window/start.h"

#include "base/path.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VERSION = 1, FILE_LIMIT = 1 << 18 /* each byte of each path may be written as six */ };

static const char name[] = "recent.json";

bool recent_parse(struct recent *out, const char *text, size_t size)
{
    json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
    json_t *list = NULL;
    int version = 0;
    struct recent recent = {0};
    bool fine = !json_unpack_ex(root, NULL, JSON_STRICT, "{s: i, s: o}", "conus_recent", &version, "atlases", &list) &&
                version == VERSION && json_is_array(list) && json_array_size(list) <= RECENT_LIMIT;
    for (size_t i = 0; fine && i < json_array_size(list); i++) {
        const char *path = json_string_value(json_array_get(list, i));
        fine = path_is_whole(path) && json_string_length(json_array_get(list, i)) < SYSTEM_PATH;
        if (fine) {
            memcpy(recent.paths[recent.count++], path, strlen(path) + 1);
        }
    }
    json_decref(root);
    if (fine) {
        *out = recent;
    }
    return fine;
}

void recent_load(struct recent *out)
{
    size_t size;
    char *text = state_file_read(&size, name, FILE_LIMIT);
    out->count = 0;
    if (text) {
        recent_parse(out, text, size);
    }
    free(text);
}

/* Completes a path by the current folder, and removes slashes at its end. Links stay unresolved. */
static bool make_absolute(char out[SYSTEM_PATH], const char *path)
{
    char here[SYSTEM_PATH] = "";
    int size = 0;
    if (path_is_whole(path) || system_here(here)) {
        path += strncmp(path, "./", 2) == 0 ? 2 : 0;
        size = snprintf(out, SYSTEM_PATH, "%s%s%s", here, here[0] ? "/" : "", path);
    }
    bool fits = size > 0 && size < SYSTEM_PATH;
    if (fits) {
        out[path_plain_length(out, (size_t)size)] = '\0';
    }
    return fits;
}

void recent_add(const char *path)
{
    struct recent recent;
    char absolute[SYSTEM_PATH] = "";
    if (!make_absolute(absolute, path)) {
        return;
    }
    recent_load(&recent);
    size_t at = 0;
    while (at < recent.count && strcmp(recent.paths[at], absolute) != 0) {
        at++;
    }
    recent.count += at == recent.count && at < RECENT_LIMIT;
    /* The others move down to the place where it was, or the last one goes. */
    at = at < RECENT_LIMIT ? at : RECENT_LIMIT - 1;
    memmove(recent.paths[1], recent.paths[0], at * sizeof recent.paths[0]);
    memcpy(recent.paths[0], absolute, SYSTEM_PATH);
    json_t *list = json_array();
    bool fine = list;
    for (size_t i = 0; fine && i < recent.count; i++) {
        fine = !json_array_append_new(list, json_string(recent.paths[i]));
    }
    json_t *root = fine ? json_pack("{s: i, s: O}", "conus_recent", VERSION, "atlases", list) : NULL;
    char *text = root ? json_dumps(root, JSON_INDENT(1)) : NULL;
    if (text) {
        state_file_write(name, text, strlen(text));
    }
    free(text);
    json_decref(root);
    json_decref(list);
}
