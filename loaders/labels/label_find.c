/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a volume's label table is: inside the file, then beside it (docs/formats.md has the order). */
#include "loaders/labels/label_find.h"

#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/labels/fsl_find.h"
#include "loaders/labels/fsl_number.h"
#include "loaders/labels/label_alike.h"
#include "loaders/labels/label_file.h"
#include "loaders/labels/label_freesurfer.h"
#include "loaders/labels/label_offer.h"
#include "loaders/labels/label_search.h"

#include <string.h>

/* Whether every entity ("res-01", "dseg") of the table's name is one of the volume's: then BIDS lets it inherit. */
static bool name_inherits(struct text table, struct text volume, size_t *entities)
{
    struct text entity;
    *entities = 0;
    for (bool more = true; text_field(&table, '_', &more, &entity); ++*entities) {
        struct text rest = volume;
        struct text other;
        bool found = false;
        for (bool left = true; !found && text_field(&rest, '_', &left, &other);) {
            found = other.size == entity.size && memcmp(other.data, entity.data, entity.size) == 0;
        }
        if (!found) {
            return false;
        }
    }
    return true;
}

static conus_status search_inherited(struct label_search *search, const char *folder)
{
    const char *path = path_base(search->volume->info->path);
    struct text volume = {path, volume_stem_length(path)};
    struct names names = {0};
    const char *best = NULL;
    size_t most = 0;
    conus_status status = names_list(&names, folder, "dseg.tsv");
    for (size_t i = 0; i < names.count; i++) {
        size_t entities;
        struct text table = {names.names[i], strlen(names.names[i]) - strlen(".tsv")};
        if (name_inherits(table, volume, &entities) && entities > most) {
            most = entities;
            best = names.names[i];
        }
    }
    char *found = !status && best ? file_beside(folder, best) : NULL;
    status = !status && best ? (found ? label_search_file(search, found) : CONUS_ERROR_MEMORY) : status;
    memory_free(found);
    names_finish(&names);
    return status;
}

static conus_status offer_atlas(void *user, struct fsl_atlas *atlas, const char *path, const struct bytes *file)
{
    struct label_search *search = user;
    struct label_offer offer = {.path = path, .file = file};
    struct label_use use = search->use;
    use.path = path;
    conus_status status = fsl_atlas_number(atlas, &use, &offer.notes);
    if (status || !atlas->labels.count) {
        notes_finish(&offer.notes);
        return status;
    }
    buffer_format(&offer.source, "%s atlas XML in %s", atlas->is_spm ? "SPM" : "FSL", path_base(path));
    offer.proved = atlas->proved;
    offer.table = atlas->labels;
    atlas->labels = (struct label_table){0};
    return label_search_offer(search, &offer);
}

/* Of all volumes in the folder: asked only where nothing else is. */
static conus_status search_fixed(struct label_search *search)
{
    static const char *const names[] = {"structures.json", "FreeSurferColorLUT.txt"};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && !search->found && i < 2; i++) {
        char *path = file_beside(search->volume->info->path, names[i]);
        search->judge = i == 1 ? label_judge_freesurfer : NULL;
        status = path ? label_search_file(search, path) : CONUS_ERROR_MEMORY;
        search->judge = NULL;
        memory_free(path);
    }
    return status;
}

/* Tries what the volume's folder has under names of its own: an inherited BIDS table, an FSL atlas XML, ... */
static conus_status label_search_folder(struct label_search *search)
{
    char *folder = path_folder(search->volume->info->path);
    conus_status status = folder ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status || search->found ? status : search_inherited(search, folder);
    status = status ? status : fsl_atlas_each(search->volume->info->path, FSL_LABELS, offer_atlas, search);
    status = status || search->found || search->first_error.size ? status : label_search_alike(search, folder);
    status = status || search->found ? status : search_fixed(search);
    status = status || search->found ? status : label_search_freesurfer(search, folder);
    memory_free(folder);
    return status;
}

void label_volume_finish(struct label_volume *volume)
{
    label_table_finish(&volume->segments);
    notes_finish(&volume->notes);
    memory_free(volume->texts);
    *volume = (struct label_volume){0};
}

static conus_status search_inside(struct label_search *search)
{
    struct label_volume *volume = search->volume;
    const char *path = volume->info->path;
    conus_status status = CONUS_OK;
    if (volume->segments.count) {
        struct label_offer offer = {.path = path, .table = volume->segments, .notes = volume->notes};
        volume->segments = (struct label_table){0};
        volume->notes = (struct notes){0};
        buffer_format(&offer.source, "Slicer segments inside %s", path_base(path));
        status = label_search_offer(search, &offer);
    }
    for (size_t i = 0; !status && i < volume->count; i++) {
        status = label_search_bytes(search, path, NULL, volume->texts[i]);
    }
    return status;
}

static conus_status search_beside(struct label_search *search)
{
    static const char *const endings[] = {".nii.txt", ".txt",     ".tsv", ".json",    ".label",
                                          ".ctbl",    ".niml.lt", ".csv", ".nii.lut", ".lut"};
    const char *path = search->volume->info->path;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < sizeof endings / sizeof endings[0]; i++) {
        char *beside = path_with_ending(path, volume_stem_length(path), endings[i]);
        status = beside ? label_search_file(search, beside) : CONUS_ERROR_MEMORY;
        memory_free(beside);
    }
    return status;
}

static conus_status colour_beside(struct label_search *search)
{
    static const char *const endings[] = {".nii.lut", ".lut"};
    const char *path = search->volume->info->path;
    bool coloured = label_table_has_colours(&search->table);
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && !coloured && i < sizeof endings / sizeof endings[0]; i++) {
        char *lut = path_with_ending(path, volume_stem_length(path), endings[i]);
        status = lut ? label_file_colours(&search->table, &coloured, lut, &search->read) : CONUS_ERROR_MEMORY;
        if (!status && coloured) {
            buffer_format(&search->source, ", colours in %s", path_base(lut));
            status = buffer_status(&search->source);
        }
        memory_free(lut);
    }
    return status;
}

/* Entries without names, for colours to go to. */
static conus_status number_entries(struct label_table *table)
{
    for (uint32_t number = 1; number < 256; number++) {
        if (!label_table_add(table, number)) {
            return CONUS_ERROR_MEMORY;
        }
    }
    return CONUS_OK;
}

static conus_status settle_search(struct label_search *search)
{
    if (search->found) {
        return search->first_error.size ? notes_warn(search->notes, "%s: passed over", search->first_error.data)
                                        : CONUS_OK;
    }
    if (search->first_error.size) {
        return fail(CONUS_ERROR_DATA, "%s", search->first_error.data);
    }
    const char *name = path_base(search->volume->info->path);
    buffer_text(&search->source, "none found");
    int stem = (int)volume_stem_length(name);
    conus_status status = notes_warn(
        search->notes,
        "no label table found: areas are called by their numbers (looked inside %s; beside it for %.*s.nii.txt, "
        ".txt, .tsv, .json, .label, .ctbl, .niml.lt, .csv, .lut; in its folder for an inherited dseg.tsv, an "
        "atlas XML of FSL or SPM, a table with a similar name, structures.json, FreeSurferColorLUT.txt)",
        name, stem, name);
    return status ? status : number_entries(&search->table);
}

conus_status label_table_of_volume(struct label_table *out, char **source, struct label_volume *volume,
                                   const struct label_voxels *voxels, struct file_sums *read, struct notes *notes)
{
    struct label_search search = {
        .volume = volume,
        .use = {.info = volume->info, .voxels = voxels, .max_memory = volume->max_memory, .header = volume->header},
        .notes = notes};
    conus_status status = search_inside(&search);
    status = status ? status : search_beside(&search);
    status = status ? status : label_search_folder(&search);
    status = status ? status : settle_search(&search);
    status = status ? status : colour_beside(&search);
    status = status || !read ? status : file_sums_move(read, &search.read);
    char *words = status ? NULL : memory_text(search.source.data, search.source.size);
    if (!words) {
        label_search_finish(&search);
        return status ? status : CONUS_ERROR_MEMORY;
    }
    if (!search.found && !label_table_has_colours(&search.table)) {
        label_table_finish(&search.table);
    }
    *source = words;
    *out = search.table;
    search.table = (struct label_table){0};
    label_search_finish(&search);
    return CONUS_OK;
}
