/* SPDX-License-Identifier: BSD-3-Clause */
#include "viewer/place.h"

#include <conus/conus.h>

#include <jansson.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { SIZE_LIMIT = 16384, SMALLEST = 64 };

/* False where there is no home, or it is too long. */
static bool find_path(char path[PATH_MAX])
{
    const char *state = getenv("XDG_STATE_HOME");
    const char *home = getenv("HOME");
    int size = 0;
    if (state && state[0] == '/') { /* the specification: relative ones are ignored */
        size = snprintf(path, PATH_MAX, "%s/conus/window.json", state);
    } else if (home && home[0] == '/') {
        size = snprintf(path, PATH_MAX, "%s/.local/state/conus/window.json", home);
    }
    return size > 0 && size < PATH_MAX;
}

static void make_folders(char *path)
{
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        mkdir(path, 0700);
        *slash = '/';
    }
}

static bool is_size(int size)
{
    return size >= SMALLEST && size <= SIZE_LIMIT;
}

void place_load(struct place *out)
{
    char path[PATH_MAX];
    json_t *root = find_path(path) ? json_load_file(path, 0, NULL) : NULL;
    struct place place = {.known = true};
    int failed = json_unpack(root, "{s: i, s: i, s: i, s: i}", "width", &place.width, "height", &place.height, "x",
                             &place.x, "y", &place.y);
    if (!failed && is_size(place.width) && is_size(place.height)) {
        *out = place;
    }
    json_decref(root);
}

void place_save(const struct place *place)
{
    char path[PATH_MAX];
    char text[128];
    if (find_path(path) && is_size(place->width) && is_size(place->height)) {
        int size = snprintf(text, sizeof text, "{\"width\": %d, \"height\": %d, \"x\": %d, \"y\": %d}\n", place->width,
                            place->height, place->x, place->y);
        make_folders(path);
        conus_status status = conus_write_file(path, text, (size_t)size);
        (void)status;
    }
}
