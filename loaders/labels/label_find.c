/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a volume's label table is: inside the file, then beside it (docs/formats.md has the order). */
#include "loaders/labels/label_files.h"

#include "base/buffer.h"
#include "base/folder.h"
#include "base/memory.h"
#include "loaders/file_kind.h"
#include "loaders/labels/label_parse.h"
#include "loaders/labels/label_search.h"

#include <string.h>
#include <strings.h>
#include <sys/stat.h>

enum {
    LABEL_FILE_LIMIT = 16 << 20,
    LABEL_GROWTH = 64, /* bytes that a byte of a table may become */
};
enum { EXTENSION_AFNI = 4, EXTENSION_WORKBENCH = 30 };

static char *join(const char *stem, size_t length, const char *ending)
{
    char *path = memory_raw(length + strlen(ending) + 1, 1);
    if (path) {
        memcpy(path, stem, length);
        memcpy(path + length, ending, strlen(ending) + 1);
    }
    return path;
}

/* Bytes of a file whose table takes no more memory than is allowed. */
static uint64_t file_limit(uint64_t max_memory)
{
    uint64_t allowed = max_memory / LABEL_GROWTH;
    return max_memory && allowed < LABEL_FILE_LIMIT ? allowed : LABEL_FILE_LIMIT;
}

static conus_status read_file(struct bytes *out, const char *path, uint64_t max_memory)
{
    uint64_t limit = file_limit(max_memory);
    return limit < LABEL_FILE_LIMIT ? file_read_allowed(out, path, limit) : file_read(out, path, limit);
}

static bool has_colours(const struct label_table *table)
{
    for (size_t i = 0; i < table->count; i++) {
        if (table->entries[i].has_rgb) {
            return true;
        }
    }
    return false;
}

/* Colours `table` from the .lut at `path`, if there is one, and counts that as read. */
static conus_status colour_from(struct label_table *table, const char *path, bool *found, struct file_sums *read)
{
    struct bytes bytes = {0};
    *found = false;
    if (!file_exists(path)) {
        return CONUS_OK;
    }
    conus_status status = file_read(&bytes, path, LABEL_FILE_LIMIT);
    if (status) {
        return status;
    }
    if (label_is_lut(bytes.data, bytes.size)) {
        label_lut_apply(table, bytes.data);
        *found = true;
        status = read ? file_sums_add(read, path, &bytes) : CONUS_OK;
    }
    bytes_finish(&bytes);
    return status;
}

/* What the file is if it is known to be no table; a message of the tables' parser says more about others. */
static const struct file_kind *foreign_kind(const char *path, const struct bytes *bytes)
{
    bool table = label_is_lut(bytes->data, bytes->size) || label_format_of(label_text_of(bytes->data, bytes->size));
    const struct file_kind *kind = table || !bytes->size ? NULL : file_kind_of_stored(path, bytes);
    return kind && !file_kind_is_vague(kind) ? kind : NULL;
}

static conus_status read_table(struct label_table *out, const char **format, const char *path,
                               const struct label_use *wanted, struct notes *notes)
{
    struct label_use use = wanted ? *wanted : (struct label_use){0};
    struct bytes bytes = {0};
    conus_status status = read_file(&bytes, path, use.max_memory);
    if (status) {
        return status;
    }
    use.path = path;
    const struct file_kind *kind = foreign_kind(path, &bytes);
    status = kind ? file_kind_fail(path, &bytes, "a label table")
                  : label_bytes_parse(out, format, bytes.data, bytes.size, &use, notes);
    status = status || !use.read ? status : file_sums_add(use.read, path, &bytes);
    bytes_finish(&bytes);
    return status ? fail_in(status, path) : CONUS_OK;
}

conus_status label_file_read(struct label_table *out, const char **format, const char *path,
                             const struct label_use *use, struct notes *notes)
{
    struct label_table table = {0};
    conus_status status = read_table(&table, format, path, use, notes);
    if (!status && !has_colours(&table)) {
        const char *dot = strrchr(path_base(path), '.');
        char *lut = join(path, dot ? (size_t)(dot - path) : strlen(path), ".lut");
        bool found;
        status = lut ? colour_from(&table, lut, &found, use ? use->read : NULL) : CONUS_ERROR_MEMORY;
        memory_free(lut);
    }
    if (status) {
        label_table_finish(&table);
        return status;
    }
    *out = table;
    return CONUS_OK;
}

void label_search_finish(struct label_search *search)
{
    label_table_finish(&search->table);
    file_sums_finish(&search->read);
    buffer_finish(&search->source);
    buffer_finish(&search->complaint);
}

/* Failures that speak about one candidate are kept for later: another may do. */
static conus_status complain(struct label_search *search, conus_status status)
{
    if (status == CONUS_ERROR_MEMORY) {
        return status;
    }
    if (!search->complaint.size) {
        buffer_text(&search->complaint, conus_message());
    }
    return buffer_status(&search->complaint);
}

/* What is no table is worth a word only where a table would stand, and none has been found. */
static conus_status note_unknown(struct label_search *search, const char *name, bool inside)
{
    const char *dot = strrchr(name, '.');
    bool expected = !inside && !(dot && strcasecmp(dot, ".json") == 0); /* BIDS has a .json beside every image */
    return expected && !search->found
               ? notes_add(search->notes, "%s is not a label table of a known format: passed over", name)
               : CONUS_OK;
}

conus_status label_search_bytes(struct label_search *search, const char *path, const struct bytes *file,
                                struct text text)
{
    struct label_offer offer = {.path = path, .file = file};
    struct label_use use = search->use;
    const char *name = path_base(path);
    const struct label_format *format = label_format_of(text);
    if (!format) {
        return note_unknown(search, name, !file);
    }
    use.path = path;
    conus_status status = label_text_parse(&offer.table, format, text, &use, &offer.notes);
    if (status) {
        notes_finish(&offer.notes);
        return complain(search, fail_in(status, name));
    }
    if (!offer.table.count) {
        notes_finish(&offer.notes);
        label_table_finish(&offer.table);
        return search->found ? CONUS_OK
                             : notes_add(search->notes, "%s in %s has no label but 0: passed over", format->name, name);
    }
    buffer_format(&offer.source, "%s %s %s", format->name, file ? "in" : "inside", name);
    return label_search_offer(search, &offer);
}

conus_status label_search_file(struct label_search *search, const char *path)
{
    struct bytes bytes = {0};
    struct stat info;
    uint64_t limit = file_limit(search->use.max_memory);
    if (!file_exists(path)) {
        return CONUS_OK;
    }
    if (!stat(path, &info) && (uint64_t)info.st_size > limit) { /* tables of results may be called so */
        return notes_add(search->notes, "%s: %lld bytes, a label table may have %llu: passed over", path_base(path),
                         (long long)info.st_size, (unsigned long long)limit);
    }
    conus_status status = read_file(&bytes, path, search->use.max_memory);
    if (status) {
        return complain(search, status);
    }
    if (!label_is_lut(bytes.data, bytes.size)) {
        status = label_search_bytes(search, path, &bytes, label_text_of(bytes.data, bytes.size));
    }
    bytes_finish(&bytes);
    return status;
}

/* Workbench and AFNI also keep what is no label table in their extensions. */
static conus_status search_extension(struct label_search *search, int code, const char *mark)
{
    const struct volume_file *volume = search->volume;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < volume->extension_count; i++) {
        const struct volume_extension *extension = &volume->extensions[i];
        struct text text = label_text_of(extension->data, extension->size);
        if (extension->code == code && text_mentions(text, mark)) {
            status = label_search_bytes(search, volume->path, NULL, text);
        }
    }
    return status;
}

static conus_status search_inside(struct label_search *search)
{
    struct text text = search->volume->embedded;
    text = label_text_of((const uint8_t *)text.data, text.size);
    conus_status status = search_extension(search, EXTENSION_WORKBENCH, "<LabelTable");
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
        char *beside = join(path, volume_stem_length(path), endings[i]);
        status = beside ? label_search_file(search, beside) : CONUS_ERROR_MEMORY;
        memory_free(beside);
    }
    return status;
}

static conus_status colour_beside(struct label_search *search)
{
    static const char *const endings[] = {".nii.lut", ".lut"};
    const char *path = search->volume->path;
    bool coloured = has_colours(&search->table);
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && !coloured && i < sizeof endings / sizeof endings[0]; i++) {
        char *lut = join(path, volume_stem_length(path), endings[i]);
        status = lut ? colour_from(&search->table, lut, &coloured, &search->read) : CONUS_ERROR_MEMORY;
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

static conus_status settle(struct label_search *search)
{
    if (search->found) {
        return search->complaint.size ? notes_add(search->notes, "%s: passed over", search->complaint.data) : CONUS_OK;
    }
    if (search->complaint.size) {
        return fail(CONUS_ERROR_DATA, "%s", search->complaint.data);
    }
    const char *name = path_base(search->volume->path);
    buffer_text(&search->source, "none found");
    int stem = (int)volume_stem_length(name);
    conus_status status = notes_add(
        search->notes,
        "no label table found: areas are called by their numbers (looked inside %s; beside it for %.*s.nii.txt, "
        ".txt, .tsv, .json, .label, .ctbl, .niml.lt, .csv, .lut; in its folder for an inherited dseg.tsv, an "
        "FSL atlas XML, structures.json, FreeSurferColorLUT.txt)",
        name, stem, name);
    return status ? status : number_entries(&search->table);
}

conus_status label_table_of_volume(struct label_table *out, char **source, const struct volume_file *volume,
                                   const uint32_t *voxels, struct file_sums *read, struct notes *notes)
{
    struct label_search search = {.volume = volume,
                                  .use = {.info = &volume->info, .voxels = voxels, .max_memory = volume->max_memory},
                                  .notes = notes};
    conus_status status = search_inside(&search);
    status = status ? status : search_beside(&search);
    status = status ? status : label_search_folder(&search);
    status = status ? status : settle(&search);
    status = status ? status : colour_beside(&search);
    status = status || !read ? status : file_sums_move(read, &search.read);
    char *words = status ? NULL : memory_text(search.source.data, search.source.size);
    if (!words) {
        label_search_finish(&search);
        return status ? status : CONUS_ERROR_MEMORY;
    }
    if (!search.found && !has_colours(&search.table)) {
        label_table_finish(&search.table);
    }
    *source = words;
    *out = search.table;
    search.table = (struct label_table){0};
    label_search_finish(&search);
    return CONUS_OK;
}
