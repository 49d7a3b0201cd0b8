/* SPDX-License-Identifier: BSD-3-Clause */
/* The table beside a 4-D file that names its volumes: one line a volume, or numbers and names. Which number the first
 * volume has follows from the numbers alone, or no name is used. */
#include "loaders/labels/label_volumes.h"

#include "base/files/file_trace.h"
#include "base/files/folder.h"
#include "base/formats/encoding.h"
#include "base/memory.h"
#include "loaders/labels/label_cells.h"
#include "loaders/labels/label_file.h"
#include "loaders/labels/label_format.h"

#include <string.h>

enum { VOLUME_LIMIT = 1024 }; /* more are not named: each name is compared with all others */

static bool has_twin(const struct label_table *table, const char *name, size_t from)
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
        good = label->number == i + 1 && label->name && !has_twin(table, label->name, i + 1);
    }
    return good;
}

/* Makes the numbers of the table those of `count` volumes, from 1. Not decided, and no change, if they do not say so.
 */
static conus_status count_from_one(bool *decided, struct label_table *table, size_t count)
{
    const char *zero = table->zero;
    bool background = !zero || label_is_background(text_from(zero));
    if (!zero || !counts_to(table, count - 1) || has_twin(table, zero, 0)) {
        *decided = background && counts_to(table, count);
        return CONUS_OK;
    }
    for (size_t i = 0; i < table->count; i++) { /* 0 to count - 1 */
        table->entries[i].number++;
    }
    struct label *first = label_table_add(table, 1);
    conus_status status = first ? label_set_text(&first->name, text_from(zero)) : CONUS_ERROR_MEMORY;
    struct notes silent = {0};
    status = status ? status : label_table_sort(table, &silent);
    notes_finish(&silent);
    *decided = !status;
    return status;
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

static conus_status parse_names(struct label_table *out, bool *table, const struct bytes *bytes, size_t volumes,
                                const struct label_use *chosen, struct notes *notes)
{
    const struct label_use use = {.columns = {chosen->columns[0], chosen->columns[1]}};
    const bool has_columns = use.columns[0].size || use.columns[1].size;
    struct notes silent = {0}; /* it counts from 0 or not: that is asked here */
    struct text text = text_from_bytes(bytes->data, bytes->size);
    char *owned = NULL;
    conus_status status = text_is_readable(text) ? encoding_decode(&owned, &text, notes) : CONUS_OK;
    const struct label_format *format = label_is_lut(bytes->data, bytes->size) ? NULL
                                        : has_columns                          ? &label_format_chosen
                                                                               : label_format_of(text);
    if (!status && format && format != &label_format_colours) {
        status = label_text_parse(out, format, text, &use, &silent);
        *table = !status;
        if (silent.count > (out->zero && !label_is_background(text_from(out->zero)))) { /* a number twice */
            label_table_finish(out);
        }
    } else if (!status && !format && text.size) {
        status = read_lines(out, table, text, volumes);
    }
    notes_finish(&silent);
    memory_free(owned);
    return status;
}

/* The table of the file, whose numbers are those of the volumes, from 1; empty, with a note, if they do not decide. One
 * that was found is passed over if it is damaged, one that was given is not. */
static conus_status take_names(struct label_table *out, const char *path, bool given, const struct label_use *use,
                               struct notes *notes)
{
    const size_t count = use->info->volume_count;
    struct bytes bytes = {0};
    bool is_table = false;
    bool decided = false;
    bool before = file_trace_search(!given);
    conus_status status = label_file_bytes(&bytes, path, use->max_memory);
    if (!status && (status = parse_names(out, &is_table, &bytes, count, use, notes))) {
        status = given ? fail_in(status, path) : status;
    }
    if (status && !given && status != CONUS_ERROR_MEMORY) {
        status = notes_warn(notes, "%s: passed over: %s", path_base(path), conus_message());
        is_table = false;
    }
    status = status || !is_table ? status : count_from_one(&decided, out, count);
    if (!status && is_table && !decided) {
        status = notes_warn(notes,
                            "%s is not used for the names of the volumes: needed is another name for each number from "
                            "0 to %zu, or from 1 to %zu",
                            path_base(path), count - 1, count);
    }
    status = status || !decided || !use->read ? status : file_sums_add(use->read, path, &bytes);
    if (status || !decided) {
        label_table_finish(out);
    } else {
        file_trace_take(path);
    }
    file_trace_search(before);
    bytes_finish(&bytes);
    return status;
}

conus_status label_volume_table(struct label_table *out, struct buffer *from, const char *path,
                                const struct label_use *use, struct notes *notes)
{
    const conus_volume_info *info = use->info;
    static const char *const endings[] = {".nii.txt", ".txt", ".tsv", ".csv", ".json", ".label"};
    bool several = info->volume_count > 1 && info->volume_count <= VOLUME_LIMIT;
    struct label_use chosen = *use;
    conus_status status = CONUS_OK;
    for (size_t i = 0; several && !status && !out->count && i < (path ? 1 : sizeof endings / sizeof endings[0]); i++) {
        size_t stem = volume_stem_length(info->path);
        char *file = path ? NULL : path_with_ending(info->path, stem, endings[i]);
        status = path ? label_path_split(&file, chosen.columns, path) : file ? CONUS_OK : CONUS_ERROR_MEMORY;
        status = status || (!path && !file_exists(file)) ? status : take_names(out, file, path != NULL, &chosen, notes);
        if (!status && out->count) {
            buffer_text(from, path_base(file));
            status = buffer_status(from);
        }
        memory_free(file);
    }
    return status;
}

conus_status label_volume_name(struct buffer *name, struct buffer *from, const conus_volume_info *info,
                               struct notes *notes)
{
    struct label_table table = {0};
    conus_status status = label_volume_table(&table, from, NULL, &(struct label_use){.info = info}, notes);
    if (!status && table.count) {
        buffer_text(name, table.entries[info->volume].name);
        status = buffer_status(name);
    }
    label_table_finish(&table);
    return status;
}
