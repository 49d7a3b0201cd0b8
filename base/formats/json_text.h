/* SPDX-License-Identifier: BSD-3-Clause */
/** @file JSON from untrusted text, through jansson. */
#ifndef CONUS_BASE_FORMATS_JSON_TEXT_H
#define CONUS_BASE_FORMATS_JSON_TEXT_H

#include "base/job/job.h"

#include <jansson.h>

enum { JSON_TEXT_MEMORY = 1 << 28 }; /**< Bytes that a text may become. */

/** Parses @p text, in which no key may stand twice in an object, and NaN and Infinity, as Python writes them, are no
 * numbers, but no errors either; CONUS_ERROR_DATA with line and column,
 * CONUS_ERROR_MEMORY if it has so many entries that it could take more than JSON_TEXT_MEMORY. *out is the caller's to
 * json_decref(). */
conus_status json_text_load(json_t **out, struct text text);

/** The same on a job, whose value it is; NULL after a failure. */
json_t *json_text_read(struct job *job, struct text text);

/** The text of @p value; "" where it is no text, or NULL. */
struct text json_text_of(const json_t *value);

/** Whether @p list is one of @p count numbers, which @p out then has. */
bool json_numbers(double *out, size_t count, const json_t *list);

#endif
