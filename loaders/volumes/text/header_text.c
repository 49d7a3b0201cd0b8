/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines, keys and values of headers of text. */
#include "loaders/volumes/text/text_volume.h"

#include "base/order.h"
#include "base/path.h"

#include <stdio.h>
#include <string.h>

bool header_line(struct reader *r, struct text *line, size_t *count)
{
    if (!reader_line(r, line)) {
        return false;
    }
    if (++*count > HEADER_LINE_LIMIT) {
        job_bad(r->job, "header: found more than %d lines, allowed are %d", HEADER_LINE_LIMIT, HEADER_LINE_LIMIT);
    }
    if (reader_at(r) > HEADER_TEXT_LIMIT) {
        job_bad(r->job, "header: found more than %d bytes, allowed are %d", HEADER_TEXT_LIMIT, HEADER_TEXT_LIMIT);
    }
    return job_ok(r->job);
}

int header_word(const struct header_word *words, struct text text, bool exact)
{
    for (; words->names; words++) {
        if (text_is_one_of(text, words->names, exact)) {
            return words->value;
        }
    }
    return -1;
}

void header_once(struct job *job, struct text *slot, struct text value, struct text name)
{
    if (slot->data) {
        job_bad(job, "%.*s: found twice, allowed is once", HEADER_SHOW(name));
        return;
    }
    *slot = (struct text){job_copy(job, value), value.size};
}

bool header_keep(struct job *job, struct header_values *values, const struct header_table *table, struct text name,
                 struct text value)
{
    for (size_t i = 0; i < table->count; i++) {
        if (text_is_one_of(name, table->rows[i].names, table->exact)) {
            header_once(job, &values->of[i], value, name);
            return true;
        }
    }
    return false;
}

bool header_has(const struct header_values *values, const struct header_table *table, const char *name)
{
    size_t i = 0;
    while (strncmp(table->rows[i].names, name, strlen(name)) != 0) {
        i++;
    }
    return values->of[i].data;
}

void header_need(struct job *job, struct text value, const char *name, const char *allowed)
{
    if (!value.data) {
        job_bad(job, "%s: missing, %s", name, allowed);
    }
}

void header_numbers(struct job *job, double *out, size_t count, struct text value, const char *name)
{
    struct text rest = value;
    struct text word;
    size_t found = 0;
    for (; text_word(&rest, &word); found++) {
        if (found == count || !text_to_double(word, &out[found])) {
            found = count + 1;
            break;
        }
    }
    if (found != count) {
        job_bad(job, "%s: found \"%.*s\", %zu numbers are needed", name, HEADER_SHOW(value), count);
    }
}

/* Whole numbers from `least` to 2^62, at most `most` of them. */
static void read_integers(struct job *job, struct header_list *out, size_t most, struct text value, int64_t least,
                          const char *name)
{
    struct text rest = value;
    struct text word;
    out->count = 0;
    while (job_ok(job) && text_word(&rest, &word)) {
        int64_t number = 0;
        if (!text_to_int(word, &number) || number < least || number > INT64_MAX / 2) {
            job_bad(job, "%s: found \"%.*s\", allowed are whole numbers from %lld", name, HEADER_SHOW(word),
                    (long long)least);
        } else if (out->count == most) {
            job_bad(job, "%s: found more than %zu numbers", name, most);
        } else {
            out->values[out->count++] = number;
        }
    }
}

int64_t header_integer(struct job *job, struct text value, int64_t least, const char *name)
{
    struct header_list list = {.values = {0}};
    read_integers(job, &list, 1, value, least, name);
    if (!list.count) {
        job_bad(job, "%s: empty, a whole number is needed", name);
    }
    return list.values[0];
}

static void take_value(struct job *job, void *out, const struct header_row *row, struct text value, const char *name)
{
    switch (row->kind) {
    case HEADER_TEXT:
        *(struct text *)out = value;
        break;
    case HEADER_WORD:
        *(int *)out = header_word(row->words, value, row->exact);
        if (*(int *)out < 0) {
            job_fail(job, row->refused ? row->refused : CONUS_ERROR_DATA, "%s: found \"%.*s\", %s", name,
                     HEADER_SHOW(value), row->allowed);
        }
        break;
    case HEADER_INTEGER:
        *(int64_t *)out = header_integer(job, value, row->least, name);
        break;
    case HEADER_INTEGERS:
        read_integers(job, out, HEADER_LIST_LIMIT, value, row->least, name);
        break;
    case HEADER_NUMBER:
        header_numbers(job, out, 1, value, name);
        break;
    case HEADER_UNUSED:
        break;
    }
}

void header_take(struct job *job, void *header, const struct header_table *table, const struct header_values *values)
{
    for (size_t i = 0; job_ok(job) && i < table->count; i++) {
        const struct header_row *row = &table->rows[i];
        struct text value = values->of[i];
        char name[HEADER_SHOWN];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(row->names, "/"), row->names);
        if (value.data) {
            take_value(job, (char *)header + row->place, row, value, name);
        } else if (row->missing) {
            header_need(job, value, name, row->missing);
        }
        if (job_ok(job) && row->check) {
            row->check(job, header, value);
        }
    }
}

char *header_file(struct job *job, struct text value, const char *name, const char *allowed, bool exact)
{
    struct text rest = value;
    struct text word;
    bool list = text_word(&rest, &word) && (exact ? text_equal : text_equal_ignoring_case)(word, "LIST");
    bool pattern = value.size && memchr(value.data, '%', value.size) && text_trim(rest).size;
    if (list || pattern) {
        job_refuse(job, "%s: found \"%.*s\", %s", name, HEADER_SHOW(value), allowed);
    }
    char *name_of_file = job_copy(job, value);
    bool inside = value.size && !memchr(value.data, '\0', value.size) && !path_is_whole(name_of_file);
    const char *part;
    size_t size;
    for (const char *at = name_of_file; inside && path_part(&at, &part, &size);) {
        inside = size != 2 || strncmp(part, "..", 2) != 0;
    }
    if (!inside) {
        job_bad(job, "%s: found \"%.*s\", allowed is the name of a file in the header's folder or below it", name,
                HEADER_SHOW(value));
    }
    return name_of_file;
}

double header_unit(struct text unit)
{
    static const struct unit {
        const char *names;
        double mm;
    } units[] = {{TEXT_MM, 1},
                 {"um/micron/microns/micrometer/micrometers/\xc2\xb5m", 1e-3},
                 {"cm", 10},
                 {"m", 1e3},
                 {"nm", 1e-6}};
    const struct unit *row = ROW_NAMED(units, unit, true);
    return row ? row->mm : 0;
}

void header_turn_lps(double m[16])
{
    for (int column = 0; column < 4; column++) {
        m[4 * column] = -m[4 * column];
        m[4 * column + 1] = -m[4 * column + 1];
    }
}

void text_volume_labels(struct job *job, struct label_table *table, const struct text_volume *volume, size_t index)
{
    for (size_t i = 0; job_ok(job) && i < volume->segment_count; i++) {
        const struct label *label = &volume->segments[i].label;
        if (volume->segments[i].volume == index) {
            struct label *entry = label_table_add(table, label->number);
            (void)(job_need(job, entry) && JOB_CALL(job, label_copy(entry, label)));
        }
    }
    (void)JOB_CALL(job, label_table_sort(table, &job->notes));
}
