/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and writes the file with the window's place. */
#include "viewer/window/place.h"

#include "viewer/window/state_file.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIZE_LIMIT = 16384, SMALLEST = 64, FILE_LIMIT = 4096 };

static const char name[] = "window.json";

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
    size_t size;
    char *text = state_file_read(&size, name, FILE_LIMIT);
    if (text) {
        place_parse(out, text, size);
    }
    free(text);
}

void place_save(const struct place *place)
{
    char text[128];
    if (is_size(place->width) && is_size(place->height)) {
        int size = snprintf(text, sizeof text, "{\"width\": %d, \"height\": %d, \"x\": %d, \"y\": %d}\n", place->width,
                            place->height, place->x, place->y);
        state_file_write(name, text, (size_t)size);
    }
}
