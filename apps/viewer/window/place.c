/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and writes the file with the window's place. */
#include "viewer/window/place.h"

#include <conus/conus.h>

#include <jansson.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { SIZE_LIMIT = 16384, SMALLEST = 64, FILE_LIMIT = 4096 };

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

bool place_parse(struct place *out, const char *text, size_t size)
{
    json_t *root = json_loadb(text, size, 0, NULL);
    struct place place = {.known = true};
    bool fine = !json_unpack(root, "{s: i, s: i, s: i, s: i}", "width", &place.width, "height", &place.height, "x",
                             &place.x, "y", &place.y) &&
                is_size(place.width) && is_size(place.height);
    json_decref(root);
    *out = fine ? place : *out;
    return fine;
}

void place_load(struct place *out)
{
    char path[PATH_MAX];
    char text[FILE_LIMIT];
    FILE *file = find_path(path) ? fopen(path, "re") : NULL;
    if (file) {
        place_parse(out, text, fread(text, 1, sizeof text, file));
        fclose(file);
    }
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
