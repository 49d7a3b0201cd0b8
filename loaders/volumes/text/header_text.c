/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines, keys and values of headers of text. */
#include "loaders/volumes/text/header_text.h"

#include "base/memory.h"
#include "loaders/volumes/text/text_volume.h"

#include <stdio.h>
#include <string.h>

bool header_line(struct text *rest, struct text *line, size_t *count, conus_status *status)
{
    if (*status || !rest->size) {
        return false;
    }
    if (++*count > HEADER_LINE_LIMIT) {
        *status = fail(CONUS_ERROR_DATA, "header: found more than %d lines, allowed are %d", HEADER_LINE_LIMIT,
                       HEADER_LINE_LIMIT);
        return false;
    }
    const char *end = memchr(rest->data, '\n', rest->size);
    size_t length = end ? (size_t)(end - rest->data) : rest->size;
    *line = (struct text){rest->data, length && rest->data[length - 1] == '\r' ? length - 1 : length};
    length += end != NULL;
    *rest = (struct text){rest->data + length, rest->size - length};
    return true;
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

conus_status header_once(struct text *slot, struct text value, struct text name)
{
    if (slot->data) {
        return fail(CONUS_ERROR_DATA, "%.*s: found twice, allowed is once", HEADER_SHOW(name));
    }
    *slot = value;
    return CONUS_OK;
}

conus_status header_keep(struct header_values *values, bool *known, const struct header_table *table, struct text name,
                         struct text value)
{
    for (size_t i = 0; i < table->count; i++) {
        *known = text_is_one_of(name, table->rows[i].names, table->exact);
        if (*known) {
            return header_once(&values->of[i], value, name);
        }
    }
    return CONUS_OK;
}

bool header_has(const struct header_values *values, const struct header_table *table, const char *name)
{
    size_t i = 0;
    while (strncmp(table->rows[i].names, name, strlen(name)) != 0) {
        i++;
    }
    return values->of[i].data;
}

conus_status header_need(struct text value, const char *name, const char *allowed)
{
    return value.data ? CONUS_OK : fail(CONUS_ERROR_DATA, "%s: missing, %s", name, allowed);
}

conus_status header_numbers(double *out, size_t count, struct text value, const char *name)
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
    return found == count
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "%s: found \"%.*s\", %zu numbers are needed", name, HEADER_SHOW(value), count);
}

/* Whole numbers from `least` to 2^62, at most `most` of them; *count says how many there are. */
static conus_status read_integers(int64_t *out, size_t most, size_t *count, struct text value, int64_t least,
                                  const char *name)
{
    struct text rest = value;
    struct text word;
    *count = 0;
    while (text_word(&rest, &word)) {
        int64_t number = 0;
        if (!text_to_int(word, &number) || number < least || number > INT64_MAX / 2) {
            return fail(CONUS_ERROR_DATA, "%s: found \"%.*s\", allowed are whole numbers from %lld", name,
                        HEADER_SHOW(word), (long long)least);
        }
        if (*count == most) {
            return fail(CONUS_ERROR_DATA, "%s: found more than %zu numbers", name, most);
        }
        out[(*count)++] = number;
    }
    return CONUS_OK;
}

conus_status header_integer(int64_t *out, struct text value, int64_t least, const char *name)
{
    size_t count;
    conus_status status = read_integers(out, 1, &count, value, least, name);
    return status || count ? status : fail(CONUS_ERROR_DATA, "%s: empty, a whole number is needed", name);
}

static conus_status take_value(void *out, const struct header_row *row, struct text value, const char *name)
{
    struct header_list *list = out;
    switch (row->kind) {
    case HEADER_TEXT:
        *(struct text *)out = value;
        return CONUS_OK;
    case HEADER_WORD:
        *(int *)out = header_word(row->words, value, row->exact);
        return *(int *)out >= 0 ? CONUS_OK
                                : fail(row->refused ? row->refused : CONUS_ERROR_DATA, "%s: found \"%.*s\", %s", name,
                                       HEADER_SHOW(value), row->allowed);
    case HEADER_INTEGER:
        return header_integer(out, value, row->least, name);
    case HEADER_INTEGERS:
        return read_integers(list->values, HEADER_LIST_LIMIT, &list->count, value, row->least, name);
    case HEADER_NUMBER:
        return header_numbers(out, 1, value, name);
    case HEADER_UNUSED:
        break;
    }
    return CONUS_OK;
}

conus_status header_take(void *header, const struct header_table *table, const struct header_values *values)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < table->count; i++) {
        const struct header_row *row = &table->rows[i];
        struct text value = values->of[i];
        char name[HEADER_SHOWN];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(row->names, "/"), row->names);
        if (value.data) {
            status = take_value((char *)header + row->place, row, value, name);
        } else if (row->missing) {
            status = header_need(value, name, row->missing);
        }
        status = status || !row->check ? status : row->check(header, value);
    }
    return status;
}

conus_status header_file(char **out, struct text value, const char *name, const char *allowed, bool exact)
{
    struct text rest = value;
    struct text word;
    bool list = text_word(&rest, &word) && (exact ? text_equal : text_equal_ignoring_case)(word, "LIST");
    bool pattern = value.size && memchr(value.data, '%', value.size) && text_trim(rest).size;
    if (list || pattern) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%s: found \"%.*s\", %s", name, HEADER_SHOW(value), allowed);
    }
    bool inside = value.size && !memchr(value.data, '\0', value.size) && value.data[0] != '/';
    rest = value;
    for (bool more = inside; text_field(&rest, '/', &more, &word);) {
        inside = inside && !text_equal(word, "..");
    }
    if (!inside) {
        return fail(CONUS_ERROR_DATA,
                    "%s: found \"%.*s\", allowed is the name of a file in the header's folder or below it", name,
                    HEADER_SHOW(value));
    }
    *out = memory_text(value.data, value.size);
    return *out ? CONUS_OK : CONUS_ERROR_MEMORY;
}

double header_unit(struct text unit)
{
    static const struct {
        const char *name;
        double mm;
    } units[] = {
        {"mm", 1},           {"millimeter", 1}, {"millimeters", 1}, {"millimetre", 1},    {"millimetres", 1},
        {"um", 1e-3},        {"micron", 1e-3},  {"microns", 1e-3},  {"micrometer", 1e-3}, {"micrometers", 1e-3},
        {"\xc2\xb5m", 1e-3}, {"cm", 10},        {"m", 1e3},         {"nm", 1e-6}};
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        if (text_equal(unit, units[i].name)) {
            return units[i].mm;
        }
    }
    return 0;
}

void header_turn_lps(double m[16])
{
    for (int column = 0; column < 4; column++) {
        m[4 * column] = -m[4 * column];
        m[4 * column + 1] = -m[4 * column + 1];
    }
}

void text_volume_finish(struct text_volume *volume)
{
    if (!volume) {
        return;
    }
    for (size_t i = 0; i < volume->segment_count; i++) {
        label_finish(&volume->segments[i].label);
    }
    for (int64_t i = 0; volume->titles && i < volume->count; i++) {
        memory_free(volume->titles[i]);
    }
    memory_free(volume->segments);
    memory_free(volume->titles);
    memory_free(volume->slopes);
    memory_free(volume->labels);
    memory_free(volume->file);
    *volume = (struct text_volume){0};
}

conus_status text_volume_labels(struct label_table *out, const struct text_volume *volume, size_t index,
                                struct notes *notes)
{
    struct label_table table = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < volume->segment_count; i++) {
        const struct label *label = &volume->segments[i].label;
        if (volume->segments[i].volume == index) {
            struct label *entry = label_table_add(&table, label->number);
            status = entry ? label_copy(entry, label) : CONUS_ERROR_MEMORY;
        }
    }
    status = status ? status : label_table_sort(&table, notes);
    if (status) {
        label_table_finish(&table);
    } else {
        *out = table;
    }
    return status;
}
