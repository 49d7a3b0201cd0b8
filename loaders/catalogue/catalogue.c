/* SPDX-License-Identifier: BSD-3-Clause */
/* Keeps what is found, and holds the limits of the search. */
#include "loaders/catalogue/catalogue.h"

#include "base/buffer.h"
#include "base/memory.h"
#include "base/text.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static void item_finish(struct catalogue_item *item)
{
    memory_free((char *)item->atlas.name);
    memory_free((char *)item->atlas.path);
    memory_free((char *)item->atlas.labels);
    memory_free(item->alias);
}

static conus_status stop_here(conus_catalogue *catalogue, const char *what, size_t limit)
{
    if (catalogue->full) {
        return CONUS_OK;
    }
    catalogue->full = true;
    return notes_warn(&catalogue->notes, "%s: more than %zu %s: the rest is left out", catalogue->source, limit, what);
}

/* Makes a name fit for a line of a terminal; it is no path. */
static char *plain_name(const char *bytes)
{
    char *name = text_to_utf8(text_trim(text_from(bytes)));
    for (char *slash = name; slash && (slash = strchr(slash, '/'));) {
        *slash = ' ';
    }
    return name;
}

conus_status catalogue_add(conus_catalogue *catalogue, const struct catalogue_found *found)
{
    /* The same file by the same name. Two names of one file are two: datalad keeps files of equal content once. */
    for (size_t i = catalogue->first; i < catalogue->count; i++) {
        const struct catalogue_item *known = &catalogue->items[i];
        if (known->id.device == found->id.device && known->id.inode == found->id.inode &&
            (strcmp(known->atlas.name, found->name) == 0 || (known->alias && strcmp(known->alias, found->name) == 0))) {
            return CONUS_OK;
        }
    }
    if (catalogue->count - catalogue->first == CATALOGUE_ATLASES) {
        return stop_here(catalogue, "atlases", CATALOGUE_ATLASES);
    }
    struct catalogue_item item = {.atlas = {.source = catalogue->source, .kind = found->kind}, .id = found->id};
    bool fine = memory_reserve(&catalogue->items, &catalogue->capacity, catalogue->count + 1, sizeof item);
    memcpy(item.atlas.spacing, found->spacing, sizeof item.atlas.spacing);
    item.atlas.name = fine ? plain_name(found->name) : NULL;
    item.atlas.path = fine ? memory_text(found->path, strlen(found->path)) : NULL;
    item.atlas.labels = fine && found->labels ? memory_text(found->labels, strlen(found->labels)) : NULL;
    item.alias = fine && found->alias ? plain_name(found->alias) : NULL;
    if (!item.atlas.name || !item.atlas.path || (found->labels && !item.atlas.labels) ||
        (found->alias && !item.alias)) {
        item_finish(&item);
        return CONUS_ERROR_MEMORY;
    }
    catalogue->items[catalogue->count++] = item;
    return CONUS_OK;
}

struct catalogue_id catalogue_id_of(const struct stat *info)
{
    return (struct catalogue_id){(uint64_t)info->st_dev, (uint64_t)info->st_ino};
}

char *catalogue_join(const char *folder, const char *name)
{
    struct buffer path = {0};
    size_t length = strlen(folder);
    buffer_format(&path, "%s%s%s", folder, length && folder[length - 1] == '/' ? "" : "/", name);
    if (buffer_status(&path)) {
        buffer_finish(&path);
        return NULL;
    }
    return path.data;
}

/* Takes the hidden ones out, and those behind the limit. */
static conus_status sift_names(struct names *names, conus_catalogue *catalogue)
{
    size_t kept = 0;
    bool over = false;
    for (size_t i = 0; i < names->count; i++) {
        bool shown = names->names[i][0] != '.';
        over = over || (shown && catalogue->seen == CATALOGUE_ENTRIES);
        if (shown && !over) {
            names->names[kept++] = names->names[i];
            catalogue->seen++;
        } else {
            memory_free(names->names[i]);
        }
    }
    names->count = kept;
    return over ? stop_here(catalogue, "files and folders", CATALOGUE_ENTRIES) : CONUS_OK;
}

conus_status catalogue_list(struct names *out, conus_catalogue *catalogue, const char *folder)
{
    struct stat info;
    if (catalogue->full || stat(folder, &info) || !S_ISDIR(info.st_mode)) {
        return CONUS_OK;
    }
    const struct catalogue_id id = catalogue_id_of(&info);
    for (size_t i = 0; i < catalogue->folder_count; i++) {
        if (catalogue->folders[i].device == id.device && catalogue->folders[i].inode == id.inode) {
            return CONUS_OK;
        }
    }
    if (access(folder, R_OK | X_OK)) {
        return notes_warn(&catalogue->notes, "%s: %s: cannot read this folder: %s", catalogue->source, folder,
                          strerror(errno));
    }
    if (!memory_reserve(&catalogue->folders, &catalogue->folder_capacity, catalogue->folder_count + 1,
                        sizeof *catalogue->folders)) {
        return CONUS_ERROR_MEMORY;
    }
    catalogue->folders[catalogue->folder_count++] = id;
    conus_status status = names_list(out, folder, "");
    if (!status && out->count == NAMES_LIMIT) {
        status = notes_warn(&catalogue->notes, "%s: %s: more than %d names: the others are left out", catalogue->source,
                            folder, NAMES_LIMIT);
    }
    return status ? status : sift_names(out, catalogue);
}

void conus_catalogue_destroy(conus_catalogue *catalogue)
{
    if (!catalogue) {
        return;
    }
    for (size_t i = 0; i < catalogue->count; i++) {
        item_finish(&catalogue->items[i]);
    }
    for (size_t i = 0; i < catalogue->place_count; i++) {
        memory_free((char *)catalogue->places[i].path);
    }
    memory_free(catalogue->items);
    memory_free(catalogue->places);
    memory_free(catalogue->folders);
    notes_finish(&catalogue->notes);
    memory_free(catalogue);
}

size_t conus_catalogue_count(const conus_catalogue *catalogue)
{
    return catalogue ? catalogue->count : 0;
}

const conus_installed *conus_catalogue_atlas(const conus_catalogue *catalogue, size_t index)
{
    return index < conus_catalogue_count(catalogue) ? &catalogue->items[index].atlas : NULL;
}

size_t conus_catalogue_place_count(const conus_catalogue *catalogue)
{
    return catalogue ? catalogue->place_count : 0;
}

const conus_catalogue_place *conus_catalogue_place_at(const conus_catalogue *catalogue, size_t index)
{
    return index < conus_catalogue_place_count(catalogue) ? &catalogue->places[index] : NULL;
}

size_t conus_catalogue_note_count(const conus_catalogue *catalogue)
{
    return catalogue ? catalogue->notes.count : 0;
}

const char *conus_catalogue_note(const conus_catalogue *catalogue, size_t index)
{
    return index < conus_catalogue_note_count(catalogue) ? catalogue->notes.lines[index] : NULL;
}
