/* SPDX-License-Identifier: BSD-3-Clause */
/* What is known of the formats of reports. */
#include "selection/report/parts.h"

static const struct {
    conus_format_info info;
    bool in_columns;
} formats[] = {
#define FACTS_OF(name, word, facts)                                                                                    \
    {{word, ((facts)&FOREIGN) != 0, ((facts)&OF_PROBE) != 0, ((facts)&OF_BATCH) != 0}, ((facts)&IN_COLUMNS) != 0},
    REPORT_FORMATS(FACTS_OF)};

const conus_format_info *conus_format_at(size_t format)
{
    return format < sizeof formats / sizeof formats[0] ? &formats[format].info : NULL;
}

bool report_in_columns(conus_format format)
{
    return formats[format].in_columns;
}
