/* SPDX-License-Identifier: BSD-3-Clause */
/* The formats and the kinds of rows of reports, by their names. */
#include "selection/report/parts.h"

static const struct {
    conus_format_info info;
    bool in_columns;
} formats[] = {
#define FACTS_OF(number, name, word, facts)                                                                            \
    {{word, ((facts)&FOREIGN) != 0, ((facts)&OF_PROBE) != 0, ((facts)&OF_BATCH) != 0}, ((facts)&IN_COLUMNS) != 0},
    REPORT_FORMATS(FACTS_OF)};

const conus_format_info *conus_format_at(size_t index)
{
    return index < sizeof formats / sizeof formats[0] ? &formats[index].info : NULL;
}

bool report_in_columns(enum report_number format)
{
    return formats[format].in_columns;
}

conus_status report_format_find(enum report_number *out, const char *word)
{
    size_t at = 0;
    while (conus_format_at(at) && strcmp(formats[at].info.name, word ? word : "table") != 0) {
        at++;
    }
    *out = conus_format_at(at) ? (enum report_number)at : *out;
    return conus_format_at(at) ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "format: there is no %s", word);
}

#define WORD_OF(name, word) word
static const char *const words[] = {REPORT_ROWS(WORD_OF)};

const char *conus_rows_name(size_t index)
{
    return index < sizeof words / sizeof words[0] ? words[index] : NULL;
}

conus_status report_rows_find(enum report_rows *out, const char *word)
{
    size_t at = 0;
    while (conus_rows_name(at) && strcmp(words[at], word ? word : "answers") != 0) {
        at++;
    }
    *out = conus_rows_name(at) ? (enum report_rows)at : *out;
    return conus_rows_name(at) ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "rows: there are no %s", word);
}
