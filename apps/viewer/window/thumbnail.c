/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and writes small pictures of atlases. */
#include "viewer/window/start.h"

#include "base/path.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double LEAST = 0.25; /* pixels of a picture for one of its own: of fewer none is kept */

enum { HEAD = 42 /* characters */, PIXELS = sizeof((struct thumbnail *)0)->rgba, NAME = 512 };

static void write_head(char head[HEAD + 1], uint64_t bytes, uint32_t areas)
{
    snprintf(head, HEAD + 1, "conus_picture 1 %016" PRIx64 " %08" PRIx32 "\n", bytes, areas);
}

bool thumbnail_parse(struct thumbnail *out, uint64_t bytes, const char *text, size_t size)
{
    static const size_t at = HEAD - 9; /* of the areas */
    char head[HEAD + 1];
    char digits[9] = "";
    if (size != HEAD + PIXELS) {
        return false;
    }
    memcpy(digits, text + at, 8);
    uint32_t areas = (uint32_t)strtoul(digits, NULL, 16);
    write_head(head, bytes, areas); /* only what is written so is read */
    bool fine = memcmp(text, head, HEAD) == 0;
    if (fine) {
        out->areas = areas;
        memcpy(out->rgba, text + HEAD, PIXELS);
    }
    return fine;
}

/* The name of its file, and the size of the atlas; false where there is no such atlas, or its name is too long. */
static bool find_file(char name[NAME], uint64_t *bytes, const char *path)
{
    struct system_stat info;
    bool fine = system_stat(&info, path) && snprintf(name, NAME, "pictures/%s", path_base(path)) < NAME;
    *bytes = fine ? (uint64_t)info.size : 0;
    return fine;
}

bool thumbnail_load(struct thumbnail *out, const char *path)
{
    char name[NAME];
    uint64_t bytes;
    size_t size;
    char *text = find_file(name, &bytes, path) ? state_file_read(&size, name, HEAD + PIXELS) : NULL;
    bool fine = text && thumbnail_parse(out, bytes, text, size);
    free(text);
    return fine;
}

/* The mean of the pixels that lie in one of the thumbnail. */
static void average(uint8_t out[4], const struct painted *picture, const uint32_t from[2], const uint32_t to[2])
{
    uint64_t sums[4] = {0};
    uint64_t count = (uint64_t)(to[0] - from[0]) * (to[1] - from[1]);
    for (uint32_t y = from[1]; y < to[1]; y++) {
        for (uint32_t x = from[0]; x < to[0]; x++) {
            for (size_t c = 0; c < 4; c++) {
                sums[c] += picture->rgba[4 * ((size_t)y * picture->width + x) + c];
            }
        }
    }
    for (size_t c = 0; c < 4; c++) {
        out[c] = (uint8_t)(sums[c] / count);
    }
}

/* Where the pixels of a picture end that begin at `from`: one at least. */
static uint32_t end_of(double to, uint32_t from)
{
    return (uint32_t)fmax(to, from + 1);
}

void thumbnail_keep(const char *path, uint32_t areas, const struct painted *picture)
{
    /* the largest part of its shape in the middle */
    const double edge = fmin((double)picture->width / THUMBNAIL_WIDTH, (double)picture->height / THUMBNAIL_HEIGHT);
    const double left = (picture->width - edge * THUMBNAIL_WIDTH) / 2;
    const double top = (picture->height - edge * THUMBNAIL_HEIGHT) / 2;
    char name[NAME];
    char *text = malloc(HEAD + PIXELS);
    uint64_t bytes;
    if (!text || edge < LEAST || !find_file(name, &bytes, path)) {
        free(text);
        return;
    }
    write_head(text, bytes, areas);
    for (uint32_t y = 0; y < THUMBNAIL_HEIGHT; y++) {
        for (uint32_t x = 0; x < THUMBNAIL_WIDTH; x++) {
            const uint32_t from[2] = {(uint32_t)(left + x * edge), (uint32_t)(top + y * edge)};
            const uint32_t to[2] = {end_of(left + (x + 1) * edge, from[0]), end_of(top + (y + 1) * edge, from[1])};
            average((uint8_t *)text + HEAD + 4 * (size_t)(y * THUMBNAIL_WIDTH + x), picture, from, to);
        }
    }
    state_file_write(name, text, HEAD + PIXELS);
    free(text);
}
