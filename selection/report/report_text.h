/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Hands out the text of a report, in whichever format. */
#ifndef CONUS_SELECTION_REPORT_REPORT_TEXT_H
#define CONUS_SELECTION_REPORT_REPORT_TEXT_H

#include "selection/report/report.h"

/** Appends the header row, where the format has one. */
void report_write_header(struct buffer *out, const conus_report *report);

/** Appends the text of the queries that are there, without a header row: of every format but JSON. */
conus_status report_write_part(struct buffer *out, const conus_report *report);

#endif
