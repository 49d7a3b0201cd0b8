/* SPDX-License-Identifier: BSD-3-Clause */
/* The table beside a 4-D file that names its volumes: one line a volume, or numbers and names. Which number the first
 * volume has follows from the numbers alone, or no name is used. */
#include "loaders/labels/label_volumes.h"

#include "base/folder.h"
#include "base/memory.h"
#include "loaders/labels/label_file.h"
#include "loaders/tables/label_bytes.h"
#include "loaders/tables/label_cells.h"
#include "loaders/tables/label_rows.h"

#include <string.h>

enum { VOLUME_LIMIT = 1024 }; /* more are not named: each name is compared with all others */

static bool same_name(const struct label_table *table, const char *name, size_t from)
{
    for (size_t i = from; i < table->count; i++) {
        if (table->entries[i].name && strcmp(table->entries[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

/* Whether the table has every number from 1 to `last` once, each with another name, and no other but 0. */
static bool counts_to(const struct label_table *table, size_t last)
{
    bool good = table->count == last;
    for (size_t i = 0; good && i < last; i++) {
        const struct label *label = &table->entries[i];
        good = label->number == i + 1 && label->name && !same_name(table, label->name, i + 1);
    }
    return good;
}

/* The name of the volume in a table with numbers; NULL if its numbers do not decide. */
static const char *name_by_number(const struct label_table *table, const conus_volume_info *info)
{
    size_t count = info->volume_count;
    const char *zero = table->zero;
    bool background = !zero || label_is_background(text_from(zero));
    if (zero && counts_to(table, count - 1) && !same_name(table, zero, 0)) { /* 0 to count - 1 */
        return info->volume ? table->entries[info->volume - 1].name : zero;
    }
    return background && counts_to(table, count) ? table->entries[info->volume].name : NULL;
}

static bool next_name(struct text *rest, struct text *name)
{
    struct text line;
    while (text_line(rest, &line)) {
        *name = text_trim(line);
        if (name->size && name->data[0] != '#') {
            return true;
        }
    }
    return false;
}

/* Lines without numbers, one a volume, as a table that counts from 1. False if the text is not that. */
static conus_status read_lines(struct label_table *out, bool *lines, struct text text, size_t count)
{
    conus_status status = CONUS_OK;
    uint32_t number = 0;
    *lines = text_is_readable(text) && text.data[0] != '<' && text.data[0] != '{' && text.data[0] != '[';
    for (struct text name; !status && *lines && next_name(&text, &name);) {
        bool digit = name.data[0] >= '0' && name.data[0] <= '9';
        *lines = !digit && number < count && number < LABEL_LIMIT;
        struct label *label = *lines ? label_table_add(out, ++number) : NULL;
        status = !*lines ? CONUS_OK : label ? label_set_text(&label->name, name) : CONUS_ERROR_MEMORY;
    }
    *lines = *lines && number == count;
    return status;
}

static conus_status read_table(struct label_table *out, bool *table, const char *path, const conus_volume_info *info,
                               struct notes *notes)
{
    static const struct label_use use;
    struct bytes bytes = {0};
    struct notes silent = {0}; /* it counts from 0 or not: that is asked here */
    *table = false;
    if (!file_exists(path)) {
        return CONUS_OK;
    }
    conus_status status = label_file_bytes(&bytes, path, 0);
    struct text text = text_from_bytes(bytes.data, bytes.size);
    const struct label_format *format = status || label_is_lut(bytes.data, bytes.size) ? NULL : label_format_of(text);
    if (!status && format && format != &label_format_colours) {
        status = label_text_parse(out, format, text, &use, &silent);
        *table = !status;
        if (silent.count > (out->zero && !label_is_background(text_from(out->zero)))) { /* a number twice */
            label_table_finish(out);
        }
    } else if (!status && !format && text.size) {
        status = read_lines(out, table, text, info->volume_count);
    }
    notes_finish(&silent);
    bytes_finish(&bytes);
    return status && status != CONUS_ERROR_MEMORY
               ? notes_warn(notes, "%s: passed over: %s", path_base(path), conus_message())
               : status;
}

static conus_status take_name(struct buffer *name, struct buffer *from, const char *path, const conus_volume_info *info,
                              struct notes *notes)
{
    struct label_table table = {0};
    bool is_table;
    conus_status status = read_table(&table, &is_table, path, info, notes);
    const char *found = !status && is_table ? name_by_number(&table, info) : NULL;
    if (!status && is_table && !found) {
        status = notes_warn(notes,
                            "%s is not used for the names of the volumes: needed is another name for each number from "
                            "0 to %zu, or from 1 to %zu",
                            path_base(path), info->volume_count - 1, info->volume_count);
    }
    if (found) {
        buffer_text(name, found);
        buffer_text(from, path_base(path));
        status = buffer_status(name);
        status = status ? status : buffer_status(from);
    }
    label_table_finish(&table);
    return status;
}

conus_status label_volume_name(struct buffer *name, struct buffer *from, const conus_volume_info *info,
                               struct notes *notes)
{
    static const char *const endings[] = {".nii.txt", ".txt", ".tsv", ".csv", ".json", ".label"};
    conus_status status = CONUS_OK;
    for (size_t i = 0; info->volume_count > 1 && info->volume_count <= VOLUME_LIMIT && !status && !from->size &&
                       i < sizeof endings / sizeof endings[0];
         i++) {
        char *path = path_with_ending(info->path, volume_stem_length(info->path), endings[i]);
        status = path ? take_name(name, from, path, info, notes) : CONUS_ERROR_MEMORY;
        memory_free(path);
    }
    return status;
}
