/* SPDX-License-Identifier: BSD-3-Clause */
/* A label table from a file, and its colours from a .lut beside it. */
#include "loaders/labels/label_file.h"

#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/formats/formats.h"
#include "loaders/labels/label_format.h"

#include <string.h>

enum {
    LABEL_FILE_LIMIT = 16 << 20,
    LABEL_GROWTH = 64, /* bytes that a byte of a table may become */
};

uint64_t label_file_limit(uint64_t max_memory)
{
    uint64_t allowed = max_memory / LABEL_GROWTH;
    return max_memory && allowed < LABEL_FILE_LIMIT ? allowed : LABEL_FILE_LIMIT;
}

conus_status label_file_bytes(struct bytes *out, const char *path, uint64_t max_memory)
{
    uint64_t limit = label_file_limit(max_memory);
    return limit < LABEL_FILE_LIMIT ? file_read_allowed(out, path, limit) : file_read(out, path, limit);
}

bool label_table_has_colours(const struct label_table *table)
{
    for (size_t i = 0; i < table->count; i++) {
        if (table->entries[i].has_rgb) {
            return true;
        }
    }
    return false;
}

static conus_status apply_colours(struct label_table *table, struct text text)
{
    static const struct label_use use;
    struct label_table colours = {0};
    struct notes notes = {0};
    conus_status status = label_text_parse(&colours, &label_format_colours, text, &use, &notes);
    for (size_t i = 0; !status && i < table->count; i++) {
        const struct label *colour = label_table_find(&colours, table->entries[i].number);
        if (colour) {
            memcpy(table->entries[i].rgb, colour->rgb, sizeof colour->rgb);
            table->entries[i].has_rgb = true;
        }
    }
    label_table_finish(&colours);
    notes_finish(&notes);
    return status;
}

conus_status label_file_colours(struct label_table *table, bool *found, const char *path, struct file_sums *read)
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
    struct text text = text_from_bytes(bytes.data, bytes.size);
    if (label_is_lut(bytes.data, bytes.size)) {
        *found = true;
        label_lut_apply(table, bytes.data);
    } else if (label_format_of(text) == &label_format_colours) {
        *found = true;
        status = apply_colours(table, text);
    }
    if (!status && *found && read) {
        status = file_sums_add(read, path, &bytes);
    }
    bytes_finish(&bytes);
    return status;
}

conus_status label_path_split(char **path, struct text columns[2], const char *text)
{
    static const char *const keys[2] = {"label=", "name="};
    const char *at = path_base(text);
    bool found = false;
    columns[0] = columns[1] = (struct text){0};
    for (; !found && !file_exists(text) && (at = strchr(at, ',')); at += !found) {
        found = strncmp(at + 1, keys[0], strlen(keys[0])) == 0 || strncmp(at + 1, keys[1], strlen(keys[1])) == 0;
    }
    struct text rest = text_from(found ? at + 1 : "");
    struct text field;
    for (bool more = found; text_field(&rest, ',', &more, &field);) {
        int key = text_starts(field, keys[0]) ? 0 : 1;
        size_t length = strlen(keys[key]);
        if (!text_starts(field, keys[key]) || field.size == length || columns[key].size) {
            return fail(CONUS_ERROR_ARGUMENT, "%s: found \"%.*s\", needed are label=COLUMN and name=COLUMN, once each",
                        text, (int)field.size, field.data);
        }
        columns[key] = (struct text){field.data + length, field.size - length};
    }
    *path = memory_text(text, found ? (size_t)(at - text) : strlen(text));
    return *path ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* The kind of a file that is certainly no table, else NULL: then the parser of tables says more. */
static const struct file_kind *foreign_kind(const char *path, const struct bytes *bytes)
{
    bool table = label_is_lut(bytes->data, bytes->size) || label_format_of(text_from_bytes(bytes->data, bytes->size));
    static const struct file_kind packed_table = {.words = "a label table packed with gzip", .way = "unpack it"};
    struct bytes head = {bytes->data, bytes->size < FILE_KIND_HEAD ? bytes->size : FILE_KIND_HEAD};
    struct bytes unpacked = {0};
    if (!table && format_unpack_head(&unpacked, bytes)) {
        head = unpacked;
    }
    const struct file_kind *kind = table || !bytes->size ? NULL : format_find(path, &head);
    if (unpacked.size && kind && kind->certainty != KIND_CERTAIN &&
        label_format_of(text_from_bytes(unpacked.data, unpacked.size))) {
        kind = &packed_table;
    }
    bytes_finish(&unpacked);
    return kind && kind->certainty != KIND_VAGUE ? kind : NULL;
}

static conus_status read_table(struct label_table *out, const char **format, const char *path,
                               const struct label_use *wanted, struct notes *notes)
{
    struct label_use use = *wanted;
    struct bytes bytes = {0};
    conus_status status = label_file_bytes(&bytes, path, use.max_memory);
    if (status) {
        return status;
    }
    use.path = path;
    const struct file_kind *kind = foreign_kind(path, &bytes);
    status = kind ? format_fail(kind, &bytes, "a label table")
                  : label_bytes_parse(out, format, bytes.data, bytes.size, &use, notes);
    status = status || !use.read ? status : file_sums_add(use.read, path, &bytes);
    bytes_finish(&bytes);
    return status ? fail_in(status, path) : CONUS_OK;
}

conus_status label_file_read(struct label_table *out, const char **format, const char *text,
                             const struct label_use *wanted, struct notes *notes)
{
    struct label_table table = {0};
    struct label_use chosen = wanted ? *wanted : (struct label_use){0};
    const struct label_use *use = &chosen;
    char *path = NULL;
    conus_status status = label_path_split(&path, chosen.columns, text);
    status = status ? status : read_table(&table, format, path, use, notes);
    if (!status && !label_table_has_colours(&table)) {
        const char *dot = strrchr(path_base(path), '.');
        char *lut = path_with_ending(path, dot ? (size_t)(dot - path) : strlen(path), ".lut");
        bool found;
        status = lut ? label_file_colours(&table, &found, lut, use->read) : CONUS_ERROR_MEMORY;
        memory_free(lut);
    }
    memory_free(path);
    if (status) {
        label_table_finish(&table);
        return status;
    }
    *out = table;
    return CONUS_OK;
}
