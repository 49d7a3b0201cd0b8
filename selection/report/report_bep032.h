/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The draft BEP032 of BIDS: what its tables of electrodes and probes say of the contacts of probes. */
#ifndef CONUS_SELECTION_REPORT_REPORT_BEP032_H
#define CONUS_SELECTION_REPORT_REPORT_BEP032_H

#include "selection/report/report.h"

/** The version that is written: of the pull request 2307 of the BIDS specification, with 2481 merged into it. */
#define BEP032_DRAFT "draft BEP032 (microelectrode electrophysiology) of 29 July 2026"

/** Finds what is known of the atlas's sides and ids; end it with report_bep032_destroy(). */
conus_status report_bep032_create(struct report_bep032 **out, const conus_atlas *atlas);
void report_bep032_destroy(struct report_bep032 *made);

/** The area that holds the contact of a query, of several the best one; 0 = none does. */
uint32_t report_area(const conus_report *report, size_t query);
/** "L" or "R": what the area's name or the label table says, else by the middle of the atlas; NULL = it is not known.
 */
const char *report_side(const conus_report *report, size_t query);
/** Name and id of an area; NULL for 0, and where none is known. */
const char *report_location(const conus_report *report, uint32_t area);
const char *report_location_id(const conus_report *report, uint32_t area);
/** By what program and atlas areas were found. */
const char *report_localization(const conus_report *report);

/** Appends probes.tsv. */
conus_status report_write_probes(struct buffer *out, const conus_report *report);
/** Appends coordsystem.json. */
conus_status report_write_coordsystem(struct buffer *out, const conus_report *report);

#endif
