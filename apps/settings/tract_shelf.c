/* SPDX-License-Identifier: BSD-3-Clause */
/* Keeps tractograms, by path and axes. */
#include "settings/settings.h"

#include "base/system/system.h"
#include "conus/own.h"

#include <stdlib.h>
#include <string.h>

struct shelved {
    char *path; /* its real one; NULL = it is not found any more */
    conus_file_space space;
    conus_tractogram *tractogram;
    bool wanted; /* by the last load */
};

static struct shelved *find(const struct tract_shelf *shelf, const char *path, conus_file_space space)
{
    char real[SYSTEM_PATH];
    const char *key = system_real_path(real, path) ? real : path;
    for (size_t i = 0; i < shelf->count; i++) {
        struct shelved *item = &shelf->items[i];
        if (item->path && strcmp(item->path, key) == 0 && item->space == space) {
            return item;
        }
    }
    return NULL;
}

bool tract_shelf_has(const struct tract_shelf *shelf, const char *path, conus_file_space space)
{
    return find(shelf, path, space);
}

conus_status tract_shelf_find(const conus_tractogram **out, struct tract_shelf *shelf, const char *path,
                              const conus_streamlines_options *options)
{
    struct shelved *item = find(shelf, path, options->space);
    if (!item) {
        char real[SYSTEM_PATH];
        struct shelved made = {.path = strdup(system_real_path(real, path) ? real : path), .space = options->space};
        struct shelved *items = realloc(shelf->items, (shelf->count + 1) * sizeof *items);
        shelf->items = items ? items : shelf->items;
        conus_status status =
            items && made.path ? conus_tractogram_load(&made.tractogram, path, options) : CONUS_ERROR_MEMORY;
        if (status) {
            free(made.path);
            return status;
        }
        item = &items[shelf->count++];
        *item = made;
    }
    item->wanted = true;
    *out = item->tractogram;
    return CONUS_OK;
}

void tract_shelf_begin(struct tract_shelf *shelf, bool again)
{
    for (size_t i = 0; i < shelf->count; i++) {
        shelf->items[i].wanted = false;
        if (!again) {
            free(shelf->items[i].path);
            shelf->items[i].path = NULL;
        }
    }
}

void tract_shelf_drop(struct tract_shelf *shelf)
{
    size_t kept = 0;
    for (size_t i = 0; i < shelf->count; i++) {
        if (shelf->items[i].wanted) {
            shelf->items[kept++] = shelf->items[i];
        } else {
            conus_tractogram_destroy(shelf->items[i].tractogram);
            free(shelf->items[i].path);
        }
    }
    shelf->count = kept;
}

void tract_shelf_finish(struct tract_shelf *shelf)
{
    tract_shelf_begin(shelf, false);
    tract_shelf_drop(shelf);
    free(shelf->items);
    *shelf = (struct tract_shelf){0};
}
