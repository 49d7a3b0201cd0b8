/* SPDX-License-Identifier: BSD-3-Clause */
/* Keeps what is found, and holds the limits of the search. */
#include "loaders/catalogue/catalogue.h"

#include "base/memory.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "conus/own.h"

#include <errno.h>
#include <string.h>

static void stop_here(conus_catalogue *catalogue, const char *what, size_t limit)
{
    if (!catalogue->source.full) {
        job_note(&catalogue->job, "%s: more than %zu %s: the rest is left out", catalogue->source.name, limit, what);
    }
    catalogue->source.full = true;
}

/* Makes a name fit for a line of a terminal; it is no path. */
static const char *plain_name(struct job *job, const char *bytes)
{
    char *name = job_name(job, text_from(bytes));
    for (char *slash = name; slash && (slash = strchr(slash, '/'));) {
        *slash = ' ';
    }
    return name ? name : "";
}

static enum catalogue_kind identify(struct catalogue_id *id, const char *path)
{
    struct system_stat info;
    if (!system_stat(&info, path)) {
        return CATALOGUE_NOTHING;
    }
    *id = (struct catalogue_id){info.device, info.inode};
    return info.kind == SYSTEM_FOLDER              ? CATALOGUE_FOLDER
           : info.kind == SYSTEM_FILE && info.size ? CATALOGUE_FILE
                                                   : CATALOGUE_NOTHING;
}

enum catalogue_kind catalogue_at(const char *path)
{
    struct catalogue_id id;
    return identify(&id, path);
}

static bool is_same(const struct catalogue_id *a, const struct catalogue_id *b)
{
    return a->device == b->device && a->inode == b->inode;
}

void catalogue_add(struct job *job, conus_catalogue *catalogue, const struct catalogue_item *found)
{
    struct job *own = &catalogue->job;
    struct catalogue_item item = *found;
    catalogue_items *items = item.is_image ? &catalogue->images : &catalogue->items;
    size_t first = item.is_image ? catalogue->source.first_image : catalogue->source.first;
    const char *name = item.atlas.name;
    if (!job_step(job) || identify(&item.id, item.atlas.path) == CATALOGUE_NOTHING) {
        return;
    }
    /* The same file by the same name. Two names of one file are two: datalad keeps files of equal content once. */
    for (size_t i = first; i < items->count; i++) {
        const struct catalogue_item *known = &items->at[i];
        if (is_same(&known->id, &item.id) &&
            (strcmp(known->atlas.name, name) == 0 || (known->alias && strcmp(known->alias, name) == 0))) {
            return;
        }
    }
    if (items->count - first == CATALOGUE_ATLASES) {
        if (!item.is_image) { /* so many images may lie before an atlas */
            stop_here(catalogue, "atlases", CATALOGUE_ATLASES);
        }
        return;
    }
    item.atlas.source = catalogue->source.name;
    item.atlas.name = plain_name(own, name);
    item.atlas.path = job_copy(own, text_from(item.atlas.path));
    item.atlas.labels = item.atlas.labels ? job_copy(own, text_from(item.atlas.labels)) : NULL;
    item.alias = item.alias ? plain_name(own, item.alias) : NULL;
    *LIST_ADD(own, items) = item;
}

const char *catalogue_join(struct job *job, const char *folder, const char *name)
{
    return job_format(job, "%s%s%s", folder, folder[0] ? path_joint(folder, strlen(folder)) : "/", name);
}

/* Takes the hidden ones out, and those behind the limit. */
static void sift_names(struct names *names, conus_catalogue *catalogue)
{
    size_t kept = 0;
    for (size_t i = 0; i < names->count && !catalogue->source.full; i++) {
        bool is_shown = names->names[i][0] != '.';
        if (is_shown && catalogue->source.seen == CATALOGUE_ENTRIES) {
            stop_here(catalogue, "files and folders", CATALOGUE_ENTRIES);
        } else if (is_shown) {
            names->names[kept++] = names->names[i];
            catalogue->source.seen++;
        }
    }
    names->count = kept;
}

struct names catalogue_list(struct job *job, conus_catalogue *catalogue, const char *folder)
{
    struct names names = {0};
    struct catalogue_id id;
    if (catalogue->source.full || identify(&id, folder) != CATALOGUE_FOLDER) {
        return names;
    }
    for (size_t i = 0; i < catalogue->source.folders.count; i++) {
        if (is_same(&catalogue->source.folders.at[i], &id)) {
            return names;
        }
    }
    if (!system_allows(folder, SYSTEM_READ | SYSTEM_RUN)) {
        job_note(&catalogue->job, "%s: %s: cannot read this folder: %s", catalogue->source.name, folder,
                 text_error(errno));
        return names;
    }
    *LIST_ADD(&catalogue->job, &catalogue->source.folders) = id;
    names = job_names(job, folder, "");
    if (names.count == NAMES_LIMIT) {
        job_note(&catalogue->job, "%s: %s: more than %d names: the others are left out", catalogue->source.name, folder,
                 NAMES_LIMIT);
    }
    sift_names(&names, catalogue);
    return names;
}

void conus_catalogue_destroy(conus_catalogue *catalogue)
{
    if (catalogue) {
        job_end(&catalogue->job);
        memory_free(catalogue);
    }
}

size_t conus_catalogue_count(const conus_catalogue *catalogue)
{
    return catalogue ? catalogue->items.count : 0;
}

const conus_installed *conus_catalogue_atlas(const conus_catalogue *catalogue, size_t index)
{
    return index < conus_catalogue_count(catalogue) ? &catalogue->items.at[index].atlas : NULL;
}

size_t conus_catalogue_place_count(const conus_catalogue *catalogue)
{
    return catalogue ? catalogue->places.count : 0;
}

const conus_catalogue_place *conus_catalogue_place_at(const conus_catalogue *catalogue, size_t index)
{
    return index < conus_catalogue_place_count(catalogue) ? &catalogue->places.at[index] : NULL;
}

size_t conus_catalogue_note_count(const conus_catalogue *catalogue)
{
    return catalogue ? catalogue->job.notes.count : 0;
}

const char *conus_catalogue_note(const conus_catalogue *catalogue, size_t index)
{
    return index < conus_catalogue_note_count(catalogue) ? catalogue->job.notes.lines[index] : NULL;
}
