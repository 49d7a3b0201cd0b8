/* SPDX-License-Identifier: BSD-3-Clause */
/* Names on the areas of a picture without a cone, where several of them have one colour, or nearly. */
#include "base/memory.h"
#include "selection/picture/picture.h"
#include "selection/selection.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* In em: letters, and from line to line. */
static const double LETTERS = 0.85;
static const double LINE = 0.95;

/* How much smaller a legend of what has no name may make the areas. */
static const double ROOM = 1.3;

/* A name in up to two lines. */
struct words {
    char text[PICTURE_TEXT];
    const char *lines[2]; /* the second one may be NULL */
};

/* Ends the first line at the space that leaves the lines most alike. */
static void split(struct words *words)
{
    const size_t length = strlen(words->text);
    char *best = NULL;
    double least = INFINITY;
    for (char *at = words->text; (at = strchr(at, ' ')); at++) {
        const double apart = fabs((double)(at - words->text) - (double)length / 2);
        best = apart < least ? at : best;
        least = fmin(least, apart);
    }
    if (best) {
        *best = '\0';
        words->lines[1] = best + 1;
    }
}

static void find_words(struct words *out, const struct picture *picture, uint32_t number,
                       const struct picture_name_place *place)
{
    char text[PICTURE_TEXT];
    snprintf(text, sizeof text, "%zu", place->number);
    snprintf(out->text, sizeof out->text, "%s", place->number ? text : picture_name(text, picture, number));
    out->lines[0] = out->text;
    out->lines[1] = NULL;
    if (place->lines > 1) {
        split(out);
    }
}

/* Width and height of the words in a box, pixels. */
static void measure(double size[2], const struct picture *picture, const struct words *words)
{
    const double letters = LETTERS * picture->em;
    size[0] = font_width(picture->font, letters, words->lines[0]);
    size[1] = LINE * letters * (words->lines[1] ? 2 : 1);
    size[0] = words->lines[1] ? fmax(size[0], font_width(picture->font, letters, words->lines[1])) : size[0];
}

/* The ray in the middle of a box of so many rays that all meet the object, as near as can be to the middle of all that
 * do; SIZE_MAX where there is none. `rows` is scratch for a row of rays. */
static size_t find_room(const conus_selection *sight, uint32_t number, const size_t box[2], size_t *rows)
{
    const uint32_t *object = sight->evidence.object;
    const size_t n = sight->cone.resolution;
    size_t sum[2] = {0}, count = 0;
    double nearest = INFINITY;
    size_t best = SIZE_MAX;
    for (size_t p = 0; p < n * n; p++) {
        const bool is_own = object[p] == number;
        sum[0] += is_own ? p % n : 0;
        sum[1] += is_own ? p / n : 0;
        count += is_own;
    }
    const size_t middle[2] = {box[0] / 2 * count + sum[0], box[1] / 2 * count + sum[1]}; /* times count */
    memset(rows, 0, n * sizeof *rows);
    for (size_t p = 0, run = 0; p < n * n; p++) {
        const size_t x = p % n;
        const size_t y = p / n;
        run = object[p] == number ? (x ? run : 0) + 1 : 0;
        rows[x] = run >= box[0] ? rows[x] + 1 : 0;
        const double across = (double)(x * count) - (double)middle[0];
        const double upward = (double)(y * count) - (double)middle[1];
        const double away = rows[x] < box[1] ? INFINITY : hypot(across, upward);
        best = away < nearest ? p - box[0] / 2 - n * (box[1] / 2) : best;
        nearest = fmin(nearest, away);
    }
    return best;
}

/* Colours that lie nearer to each other, of 255 in each channel, are taken for one. */
static const double ALIKE = 30;

static bool colours_repeat(const struct picture *picture)
{
    const conus_atlas *atlas = picture->atlas;
    bool found = false;
    for (size_t n = 1; n <= atlas->object_count && !found; n++) {
        for (size_t m = 1; m < n && !found && picture->seen[n] >= PICTURE_LEAST_PART; m++) {
            const uint8_t *one = atlas->objects[n - 1].rgb;
            const uint8_t *other = atlas->objects[m - 1].rgb;
            found = picture->seen[m] >= PICTURE_LEAST_PART &&
                    hypot(hypot(one[0] - other[0], one[1] - other[1]), one[2] - other[2]) < ALIKE;
        }
    }
    return found;
}

/* Of what is seen and was not tried yet, what is seen most; 0 = nothing. */
static uint32_t next_seen(const struct picture *picture)
{
    uint32_t best = 0;
    for (uint32_t n = 1; n <= picture->atlas->object_count; n++) {
        const bool is_next = !picture->names[n].lines && picture->seen[n] >= PICTURE_LEAST_PART;
        best = is_next && (!best || picture->seen[n] > picture->seen[best]) ? n : best;
    }
    return best;
}

/* With so many rays for each pixel. */
static bool find_place(struct picture_name_place *out, const struct picture *picture, uint32_t number, double rays,
                       size_t *rows)
{
    const struct cone *cone = &picture->sight->cone;
    struct words words;
    double size[2];
    find_words(&words, picture, number, out);
    measure(size, picture, &words);
    const size_t box[2] = {(size_t)ceil(rays * size[0]), (size_t)ceil(rays * size[1])};
    const size_t ray = find_room(picture->sight, number, box, rows);
    if (ray < SIZE_MAX) {
        cone_point(out->at, cone, (uint32_t)(ray % cone->resolution), (uint32_t)(ray / cone->resolution),
                   picture->sight->evidence.distance[ray]);
    }
    return ray < SIZE_MAX;
}

conus_status picture_names_init(struct picture *picture)
{
    const conus_selection *sight = picture->sight;
    if (!sight || !picture_lists_all(picture) || !colours_repeat(picture)) {
        return CONUS_OK;
    }
    const double *slope = picture->camera.slope;
    const double rays = ROOM * sight->cone.resolution * slope[0] / (fmax(slope[0], slope[1]) * picture->drawing[0]);
    size_t *rows = memory_raw(sight->cone.resolution, sizeof *rows);
    picture->names = memory_zeroed(picture->atlas->object_count + 1, sizeof *picture->names);
    if (!rows || !picture->names) {
        memory_free(rows);
        return CONUS_ERROR_MEMORY;
    }
    size_t unnamed = 0;
    for (uint32_t number; (number = next_seen(picture)) > 0;) {
        struct picture_name_place *place = &picture->names[number];
        for (place->lines = 1; place->lines <= 2 && !find_place(place, picture, number, rays, rows); place->lines++) {
        }
        if (place->lines > 2) { /* its row in the legend, if there is one */
            *place = (struct picture_name_place){.lines = 1, .number = ++unnamed};
            const bool has_row = !picture->options.legend_rows || unnamed <= picture->options.legend_rows;
            place->number = has_row && find_place(place, picture, number, rays, rows) ? unnamed : 0;
            place->lines = place->number ? 1 : -1;
        }
    }
    memory_free(rows);
    return CONUS_OK;
}

void picture_names_draw(struct draw_list *list, const struct picture *picture)
{
    const double letters = LETTERS * picture->em;
    for (uint32_t number = 1; number <= picture->atlas->object_count; number++) {
        const struct picture_name_place *place = &picture->names[number];
        double x, y, depth;
        if (place->lines <= 0 || !camera_project(&x, &y, &depth, &picture->camera, &picture->frame, place->at)) {
            continue;
        }
        struct words words;
        double size[2];
        float ink[4];
        find_words(&words, picture, number, place);
        measure(size, picture, &words);
        picture_ink_on(ink, picture, number);
        for (int n = 0; n < 2 && words.lines[n]; n++) {
            const double at[2] = {x - font_width(picture->font, letters, words.lines[n]) / 2,
                                  y - size[1] / 2 + (LINE * n + 0.8) * letters};
            draw_text(list, picture->font, at, letters, ink, words.lines[n]);
        }
    }
}
