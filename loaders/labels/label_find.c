/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a volume's label table is: inside the file, then beside it (docs/formats.md has the order). */
#include "loaders/labels/label_find.h"

#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/labels/label_file.h"
#include "loaders/labels/label_folder.h"
#include "loaders/labels/label_search.h"
#include "loaders/volumes/text/text_volume.h"

enum { EXTENSION_AFNI = 4, EXTENSION_WORKBENCH = 30 };

/* Workbench and AFNI also keep what is no label table in their extensions. */
static conus_status search_extension(struct label_search *search, int code, const char *mark)
{
    const struct volume_file *volume = search->volume;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < volume->extension_count; i++) {
        const struct volume_extension *extension = &volume->extensions[i];
        struct text text = text_from_bytes(extension->data, extension->size);
        if (extension->code == code && text_mentions(text, mark)) {
            status = label_search_bytes(search, volume->path, NULL, text);
        }
    }
    return status;
}

/* The labels of 3D Slicer's segments. */
static conus_status search_segments(struct label_search *search)
{
    struct label_offer offer = {.path = search->volume->path};
    const struct volume_file *volume = search->volume;
    conus_status status =
        volume->text ? text_volume_labels(&offer.table, volume->text, volume->info.volume, &offer.notes) : CONUS_OK;
    if (status || !offer.table.count) {
        notes_finish(&offer.notes);
        label_table_finish(&offer.table);
        return status;
    }
    buffer_format(&offer.source, "Slicer segments inside %s", path_base(volume->path));
    return label_search_offer(search, &offer);
}

static conus_status search_inside(struct label_search *search)
{
    struct text text = search->volume->embedded;
    text = text_from_bytes((const uint8_t *)text.data, text.size);
    conus_status status = search_segments(search);
    status = status ? status : search_extension(search, EXTENSION_WORKBENCH, "<LabelTable");
    status = status ? status : search_extension(search, EXTENSION_AFNI, "LABEL_DTABLE");
    status = status ? status : search_extension(search, EXTENSION_AFNI, "ATLAS_LABEL_TABLE");
    if (status || !text.size) {
        return status;
    }
    return label_search_bytes(search, search->volume->path, NULL, text);
}

static conus_status search_beside(struct label_search *search)
{
    static const char *const endings[] = {".nii.txt", ".txt",     ".tsv", ".json",    ".label",
                                          ".ctbl",    ".niml.lt", ".csv", ".nii.lut", ".lut"};
    const char *path = search->volume->path;
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
    const char *path = search->volume->path;
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
    const char *name = path_base(search->volume->path);
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

conus_status label_table_of_volume(struct label_table *out, char **source, const struct volume_file *volume,
                                   const struct label_voxels *voxels, struct file_sums *read, struct notes *notes)
{
    struct label_search search = {.volume = volume,
                                  .use = {.info = &volume->info, .voxels = voxels, .max_memory = volume->max_memory},
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
