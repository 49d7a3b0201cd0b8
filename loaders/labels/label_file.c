/* SPDX-License-Identifier: BSD-3-Clause */
/* A label table from a file, and its colours from a .lut beside it. */
#include "loaders/labels/labels.h"

#include "base/files/file.h"
#include "loaders/labels/label_format.h"
#include "sources/source.h"

#include <string.h>

enum {
    LABEL_FILE_LIMIT = 16 << 20,
    LABEL_GROWTH = 64, /* bytes that a byte of a table may become */
};

uint64_t label_file_limit(const struct job *job)
{
    uint64_t allowed = job->max_memory / LABEL_GROWTH;
    return job->max_memory && allowed < LABEL_FILE_LIMIT ? allowed : LABEL_FILE_LIMIT;
}

struct bytes label_file_bytes(struct job *job, const char *path)
{
    uint64_t limit = label_file_limit(job);
    size_t place = job_in(job, path, JOB_ALONE);
    struct bytes bytes = job_read(job, path, limit, limit < LABEL_FILE_LIMIT ? FILE_MAX_MEMORY : "");
    job_out(job, place);
    return bytes;
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

static void apply_colours(struct job *job, struct label_table *table, const struct label_format *format,
                          struct text text)
{
    struct label_table *colours = labels_new(job);
    struct attempt silent = job_try(job); /* without the note of a number that is there twice */
    label_text_parse(job, colours, format, text, &(struct label_use){0});
    attempt_end(job, &silent, ATTEMPT_SILENT);
    for (size_t i = 0; job_ok(job) && i < table->count; i++) {
        const struct label *colour = label_table_find(colours, table->entries[i].number);
        if (colour && colour->has_rgb) {
            memcpy(table->entries[i].rgb, colour->rgb, sizeof colour->rgb);
            table->entries[i].has_rgb = true;
        }
    }
}

bool label_file_colours(struct job *job, struct label_table *table, const char *path)
{
    struct text text;
    if (!job_has_file(job, path)) {
        return false;
    }
    struct bytes bytes = label_file_bytes(job, path);
    const struct label_format *format = label_format_for(&text, &bytes, &(struct label_use){0});
    const bool has_colours = format && format->is_colours;
    if (has_colours) {
        apply_colours(job, table, format, text);
        job_made_of(job, path, &bytes);
    }
    return has_colours;
}

const char *label_path_split(struct job *job, struct text columns[2], const char *text)
{
    struct source_keys keys;
    source_keys_read(job, &keys, text, KEYS_LABELS);
    columns[0] = keys_value(&keys, KEY_LABEL)->text;
    columns[1] = keys_value(&keys, KEY_NAME)->text;
    return keys.path;
}

/* The format of a file that is certainly no table, else NULL: then the parser of tables says more. */
static const struct format *find_foreign(struct job *job, const char *path, const struct bytes *bytes)
{
    static const struct format packed_table = {.words = "a label table packed with gzip", .way = "unpack it"};
    struct text text;
    struct source source = {0};
    if (!bytes->size || label_format_for(&text, bytes, &(struct label_use){0}) ||
        !JOB_CALL(job, source_of(&source, path, bytes))) {
        return NULL;
    }
    const struct format *format = format_find(&source.head, 0);
    const bool is_table = source.unpacked.size && format && format->certainty != KIND_CERTAIN &&
                          label_format_of(text_from_bytes(source.unpacked.data, source.unpacked.size));
    source_close(&source);
    return is_table ? &packed_table : format && format->certainty != KIND_VAGUE ? format : NULL;
}

void label_file_read(struct job *job, struct label_table *out, const char **format, const char *text,
                     const struct label_use *wanted)
{
    const struct job_mark mark = job_mark(job);
    struct label_use use = wanted ? *wanted : (struct label_use){0};
    struct label_table *table = labels_new(job);
    const char *name = NULL;
    const char *path = label_path_split(job, use.columns, text);
    struct bytes bytes = label_file_bytes(job, path);
    const struct format *foreign = find_foreign(job, path, &bytes);
    use.path = path;
    size_t place = job_in(job, path, JOB_ALONE);
    if (foreign) {
        (void)JOB_CALL(job, format_refuse(foreign, &bytes, "a label table"));
    } else {
        label_bytes_parse(job, table, &name, &bytes, &use);
    }
    job_out(job, place);
    job_made_of(job, path, &bytes);
    if (job_ok(job) && !label_table_has_colours(table)) {
        const char *dot = strrchr(path_base(path), '.');
        int stem = (int)(dot ? (size_t)(dot - path) : strlen(path));
        label_file_colours(job, table, job_format(job, "%.*s.lut", stem, path));
    }
    if (job_ok(job)) {
        *format = name;
    }
    labels_move(job, out, table);
    job_release(job, mark);
}
