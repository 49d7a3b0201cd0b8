/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds columns by their names, and fields by their columns. */
#include "poses/rows/pose_columns.h"

#include "poses/rows/pose_row.h"

#include <math.h>

static const size_t NO_COLUMN = SIZE_MAX;

static bool is_called(struct text field, const char *names)
{
    struct text rest = text_from(names);
    struct text name;
    bool found = false;
    for (bool more = true; text_field(&rest, '|', &more, &name);) {
        found = found || text_compare(field, name) == 0;
    }
    return found;
}

static bool next_field(struct text *field, enum text_quotes *quotes, const struct pose_columns *columns,
                       struct text *line, bool *more)
{
    char separator = columns->separator ? columns->separator : '\t';
    if (!columns->quotes_are_plain) {
        return text_quoted_field(line, separator, more, field, quotes);
    }
    bool found = text_field(line, separator, more, field);
    *field = text_trim(*field);
    *quotes = TEXT_PLAIN;
    return found;
}

conus_status pose_columns_find(struct pose_columns *columns, struct text header)
{
    struct text field;
    enum text_quotes quotes;
    conus_status status = CONUS_OK;
    columns->field_count = 0;
    for (size_t i = 0; i < columns->count; i++) {
        columns->at[i] = NO_COLUMN;
    }
    for (bool more = true; next_field(&field, &quotes, columns, &header, &more); columns->field_count++) {
        for (size_t i = 0; i < columns->count; i++) {
            if (is_called(field, columns->names[i])) {
                bool twice = columns->at[i] != NO_COLUMN;
                status = twice ? fail(CONUS_ERROR_DATA, "header: a column %s twice", columns->names[i]) : status;
                columns->at[i] = columns->field_count;
            }
        }
    }
    return status;
}

bool pose_columns_has(const struct pose_columns *columns, size_t column)
{
    return columns->at[column] != NO_COLUMN;
}

conus_status pose_columns_split(struct text *fields, const struct pose_columns *columns, struct text line)
{
    struct text field;
    enum text_quotes quotes;
    size_t index = 0;
    size_t least = columns->may_end_early ? 0 : columns->field_count;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < columns->count; i++) {
        fields[i] = (struct text){"", 0};
        least = columns->at[i] != NO_COLUMN && columns->at[i] >= least ? columns->at[i] + 1 : least;
    }
    for (bool more = true; next_field(&field, &quotes, columns, &line, &more); index++) {
        if (!status && (quotes == TEXT_UNCLOSED || quotes == TEXT_FOLLOWED)) {
            status = fail(CONUS_ERROR_DATA, "a quotation mark inside a field, or one that is not closed: %.*s",
                          POSE_QUOTE(field));
        }
        for (size_t i = 0; i < columns->count; i++) {
            fields[i] = columns->at[i] == index ? field : fields[i];
        }
    }
    return status || (index >= least && index <= columns->field_count)
               ? status
               : fail(CONUS_ERROR_DATA, "%zu fields, the header has %zu", index, columns->field_count);
}

bool pose_field_is_absent(struct text field)
{
    return !field.size || text_equal_ignoring_case(field, "n/a") || text_equal(field, "None");
}

conus_status pose_columns_number(double *out, const struct pose_columns *columns, const struct text *fields,
                                 size_t column)
{
    return text_to_double(fields[column], out) && isfinite(*out)
               ? CONUS_OK
               : pose_no_number(columns->names[column], fields[column]);
}

conus_status pose_columns_point(double out[3], const struct pose_columns *columns, const struct text *fields,
                                size_t first, double scale)
{
    for (size_t i = 0; i < 3; i++) {
        conus_status status = pose_columns_number(&out[i], columns, fields, first + i);
        if (status) {
            return status;
        }
        out[i] *= scale;
    }
    return CONUS_OK;
}
