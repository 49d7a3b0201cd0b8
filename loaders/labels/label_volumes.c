/* SPDX-License-Identifier: BSD-3-Clause */
/* The table beside a 4-D file that names its volumes: one line a volume, or numbers and names. Which number the first
 * volume has follows from the numbers alone, or no name is used. */
#include "loaders/labels/labels.h"

#include "base/files/file.h"
#include "loaders/labels/label_format.h"
#include "sources/names.h"

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

/* Makes the numbers of the table those of `count` volumes, from 1. False, and no change, if they do not say so. */
static bool count_from_one(struct job *job, struct label_table *table, size_t count)
{
    const char *zero = table->zero;
    if (!zero || !counts_to(table, count - 1) || has_twin(table, zero, 0)) {
        return (!zero || label_is_background(text_from(zero))) && counts_to(table, count);
    }
    for (size_t i = 0; i < table->count; i++) { /* 0 to count - 1 */
        table->entries[i].number++;
    }
    labels_set(job, &labels_add(job, table, 1)->name, text_from(zero));
    labels_sort(job, table);
    return true;
}

/* Reads the text of the file as a table into `out`; false if it is none. */
static bool read_names(struct job *job, struct label_table *out, struct text text, const struct label_use *wanted,
                       bool is_listed)
{
    const struct label_use use = {.columns = {wanted->columns[0], wanted->columns[1]}};
    const struct label_format *format = label_format_for(&text, &(struct bytes){(uint8_t *)text.data, text.size}, &use);
    if (!format) {
        bool lines = label_lines_count(text) == wanted->info->volume_count;
        if (lines) {
            label_parse_lines(job, out, text, &use);
        }
        return lines && job_ok(job);
    }
    if (format->is_colours) {
        return false;
    }
    struct attempt silent = job_try(job); /* it counts from 0 or not: that is asked here */
    size_t warnings = 0;
    label_text_parse(job, out, format, text, &use);
    for (size_t i = silent.notes; i < job->notes.count; i++) {
        warnings += notes_severity(&job->notes, i) == CONUS_SEVERITY_WARNING;
    }
    const size_t expected = out->zero && !label_is_background(text_from(out->zero));
    attempt_end(job, &silent, warnings || !is_listed ? ATTEMPT_SILENT : ATTEMPT_KEEP);
    if (warnings > expected && job_ok(job)) { /* a number that stands twice */
        label_table_finish(out);
    }
    return job_ok(job);
}

/* Ends an attempt at a table: the error of one that was given stays, that of one that was found is a note. */
static bool settle(struct job *job, const struct attempt *attempt, const char *path, bool given)
{
    if (given) {
        attempt_end(job, attempt, ATTEMPT_KEEP);
        return job_ok(job);
    }
    const char *why = attempt_end(job, attempt, ATTEMPT_TRY);
    if (why) {
        job_note(job, "%s: passed over: %s", path_base(path), why);
    }
    return !why;
}

/* The table of the file, whose numbers are those of the volumes, from 1; empty, with a note, if they do not decide. */
static void take_names(struct job *job, struct label_table *out, const char *path, bool given,
                       const struct label_use *use, bool is_listed)
{
    const size_t count = use->info->volume_count;
    struct label_table *table = labels_new(job);
    struct attempt attempt = job_try(job);
    struct bytes bytes = label_file_bytes(job, path);
    size_t place = job_in(job, path, JOB_ALONE);
    job_out(job, given ? place + 1 : place); /* the note about one that was found has its name */
    struct text text = text_from_bytes(bytes.data, bytes.size);
    if (text_is_readable(text)) {
        labels_decode(job, &text);
    }
    bool is_table = settle(job, &attempt, path, given);
    attempt = job_try(job);
    is_table = is_table && read_names(job, table, text, use, is_listed);
    if (given && !is_table) {
        label_columns_refuse(job, text);
    }
    is_table = settle(job, &attempt, path, given) && is_table;
    job_out(job, place);
    if (!is_table) {
        return;
    }
    if (!count_from_one(job, table, count)) {
        job_note(job,
                 "%s is not used for the names of the volumes: needed is another name for each number from 0 to %zu, "
                 "or from 1 to %zu",
                 path_base(path), count - 1, count);
        return;
    }
    if (is_listed) {
        job_made_of(job, path, &bytes);
    }
    inputs_take(path);
    labels_move(job, out, table);
}

static const char *find_table(struct job *job, struct label_table *out, const char *path, const struct label_use *use,
                              bool is_listed)
{
    const conus_volume_info *info = use->info;
    struct label_use chosen = *use;
    const char *file = NULL;
    bool several = info->volume_count > 1 && info->volume_count <= VOLUME_LIMIT;
    struct text rest = text_from(path ? "" : label_endings(job, false));
    struct text ending;
    for (bool more = several; !out->count && text_field(&rest, '/', &more, &ending);) {
        file =
            path ? label_path_split(job, chosen.columns, path)
                 : job_format(job, "%.*s%.*s", (int)volume_stem_length(info->path), info->path, TEXT_SHOW(ending, 80U));
        bool before = inputs_search(!path);
        if (job_ok(job) && (path || job_has_file(job, file))) {
            take_names(job, out, file, path != NULL, &chosen, is_listed);
        }
        inputs_search(before);
    }
    return out->count ? path_base(file) : NULL;
}

const char *label_volume_table(struct job *job, struct label_table *out, const char *path, const struct label_use *use)
{
    return find_table(job, out, path, use, true);
}

const char *label_volume_name(struct job *job, const char **from, const conus_volume_info *info)
{
    struct label_table *table = labels_new(job);
    *from = find_table(job, table, NULL, &(struct label_use){.info = info}, false);
    return *from ? table->entries[info->volume].name : NULL;
}
