/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and writes the file with the window's place. */
#include "viewer/window/window.h"

#include "viewer/window/start.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIZE_LIMIT = 16384, SMALLEST = 64, FILE_LIMIT = 4096 };

static const char name[] = "window.json";

static bool is_size(int size)
{
    return size >= SMALLEST && size <= SIZE_LIMIT;
}

static bool is_zoom(double zoom)
{
    return 100 * zoom >= PLACE_LEAST_ZOOM && 100 * zoom <= PLACE_MOST_ZOOM;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int most(int a, int b)
{
    return a > b ? a : b;
}

void place_fit(struct place *place, const int area[4])
{
    place->width = least(place->width, area[2]);
    place->height = least(place->height, area[3]);
    place->x = most(least(place->x, area[0] + area[2] - place->width), area[0]);
    place->y = most(least(place->y, area[1] + area[3] - place->height), area[1]);
}

float place_scale(float content, int pixels, int millimetres)
{
    static const double usual = 96, highest = 600; /* pixels per inch: those of texts of size 1, and of no screen */
    double density = millimetres > 0 ? 25.4 * pixels / millimetres : usual;
    if (content != 1 || density > highest) {
        return content;
    }
    return (float)fmin(fmax(floor(4 * density / usual) / 4, 1), 3);
}

bool place_parse(struct place *out, const char *text, size_t size)
{
    json_t *root = json_loadb(text, size, 0, NULL);
    struct place place = {.known = true};
    double *panels = place.layout.panels;
    double *division = place.layout.division;
    int folds[2] = {0};
    bool fine =
        !json_unpack(root, "{s: i, s: i, s: i, s: i, s?: F, s?: [F, F], s?: [F, F], s?: [i, i]}", "width", &place.width,
                     "height", &place.height, "x", &place.x, "y", &place.y, "zoom", &place.zoom, "panels", &panels[0],
                     &panels[1], "division", &division[0], &division[1], "folds", &folds[0], &folds[1]) &&
        folds[0] >= 0 && folds[1] >= 0;
    place.layout.folds[0] = (enum fold)folds[0];
    place.layout.folds[1] = (enum fold)folds[1];
    fine = fine && layout_is_fine(&place.layout) && is_size(place.width) && is_size(place.height) &&
           (place.zoom == 0 || is_zoom(place.zoom));
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
    char text[512];
    const struct layout *layout = &place->layout;
    if (is_size(place->width) && is_size(place->height)) {
        int size = snprintf(text, sizeof text,
                            "{\"width\": %d, \"height\": %d, \"x\": %d, \"y\": %d, \"zoom\": %.4f,"
                            " \"panels\": [%.2f, %.2f], \"division\": [%.4f, %.4f], \"folds\": [%d, %d]}\n",
                            place->width, place->height, place->x, place->y, is_zoom(place->zoom) ? place->zoom : 1,
                            layout->panels[0], layout->panels[1], layout->division[0], layout->division[1],
                            (int)layout->folds[0], (int)layout->folds[1]);
        state_file_write(name, text, (size_t)size);
    }
}
