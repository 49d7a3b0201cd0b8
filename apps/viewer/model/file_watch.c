/* SPDX-License-Identifier: BSD-3-Clause */
/* Whether the files of an atlas have changed on disk. */
#include "viewer/model/additions.h"

#include "base/system/system.h"
#include "conus/own.h"
#include "options/output.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Enough to see that a file is another one. */
struct state {
    bool is_there;
    struct timespec changed;
    uint64_t size;
};

struct file_watch {
    const conus_atlas *atlas;
    struct state (
        *states)[2]; /* [count] of volumes and then of other files, as they were looked at last, and at first */
    size_t count;
};

static size_t count_files(const conus_atlas *atlas)
{
    return conus_atlas_volume_count(atlas) + conus_atlas_file_count(atlas);
}

static const char *path_of(const conus_atlas *atlas, size_t index)
{
    size_t volumes = conus_atlas_volume_count(atlas);
    return index < volumes ? conus_atlas_volume(atlas, index)->path : conus_atlas_file(atlas, index - volumes);
}

static struct state look_at_file(const char *path)
{
    struct system_stat info;
    return system_stat(&info, path) ? (struct state){true, info.changed, info.size} : (struct state){false};
}

static bool is_same_state(const struct state *a, const struct state *b)
{
    return a->is_there == b->is_there && a->size == b->size && a->changed.tv_sec == b->changed.tv_sec &&
           a->changed.tv_nsec == b->changed.tv_nsec;
}

void file_watch_destroy(struct file_watch *watch)
{
    if (watch) {
        free(watch->states);
        free(watch);
    }
}

struct file_watch *file_watch_create(const conus_atlas *atlas)
{
    struct file_watch *watch = calloc(1, sizeof *watch);
    if (watch) {
        *watch = (struct file_watch){.atlas = atlas, .states = calloc(count_files(atlas) + 1, sizeof *watch->states)};
    }
    if (!watch || !watch->states) {
        file_watch_destroy(watch);
        return NULL;
    }
    watch->count = count_files(atlas);
    for (size_t i = 0; i < watch->count; i++) {
        watch->states[i][0] = watch->states[i][1] = look_at_file(path_of(watch->atlas, i));
    }
    return watch;
}

/* By its name: paths may be absolute now. */
static bool has_file(const conus_atlas *atlas, const char *name)
{
    for (size_t i = 0; i < count_files(atlas); i++) {
        if (strcmp(path_name(path_of(atlas, i)), name) == 0) {
            return true;
        }
    }
    return false;
}

const char *file_watch_find_other(const struct file_watch *watch, const conus_atlas *now)
{
    for (size_t i = 0; i < watch->count; i++) {
        const char *path = path_of(watch->atlas, i);
        struct state is = look_at_file(path);
        if (!is_same_state(&is, &watch->states[i][1]) && has_file(now, path_name(path))) {
            return path_name(path);
        }
    }
    return NULL;
}

bool file_watch_check(struct file_watch *watch, char text[FILE_WATCH_TEXT])
{
    size_t changes = 0;
    for (size_t i = 0; i < watch->count; i++) {
        const char *path = path_of(watch->atlas, i);
        struct state now = look_at_file(path);
        if (is_same_state(&now, &watch->states[i][0])) {
            continue;
        }
        if (changes++ == 0) {
            snprintf(text, FILE_WATCH_TEXT, "%.60s %s disk: what is shown was read before", path_name(path),
                     now.is_there ? "changed on" : "is gone from");
        }
        watch->states[i][0] = now;
    }
    if (changes > 1) {
        size_t used = strlen(text);
        snprintf(text + used, FILE_WATCH_TEXT - used, " (and %zu more files)", changes - 1);
    }
    return changes;
}
