/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How far a plan has come, as text: what is known of rows of its stream. */
#ifndef CONUS_SELECTION_PLAN_PLAN_KNOWN_H
#define CONUS_SELECTION_PLAN_PLAN_KNOWN_H

#include "base/buffer.h"
#include "base/text.h"
#include "conus/status.h"

#include <stdint.h>

enum { PLAN_CONSTRAINTS = 100, PLAN_WHY = 256 }; /**< Constraints of a plan, at most; bytes of a reason. */

/** Its lines, each with numbers. */
enum plan_line {
    PLAN_ROWS,    /**< [2] Rows from this number, from 0, to before that one. */
    PLAN_LEFT,    /**< [constraints + 1] The funnel. */
    PLAN_NONE,    /**< [2] So many rows are no candidates; line of the first. */
    PLAN_KEPT,    /**< Numbers of candidates, from 1, ascending: all that is kept follows from them. */
    PLAN_ENTRIES, /**< Feasible poses of each entry, */
    PLAN_TARGETS, /**< and of each target. */
    PLAN_LINES
};

struct plan_numbers {
    uint64_t *items;
    size_t count;
};

struct plan_known {
    struct plan_numbers lines[PLAN_LINES];
    char why[PLAN_WHY]; /**< why the first row of PLAN_NONE is no pose; "" = there is no such row. */
};

/** A reason as it is kept: its beginning, as one plain line, which is read back the same. */
void plan_known_reason(char out[PLAN_WHY], struct text why);

/** Appends it as text. */
void plan_known_format(struct buffer *out, const struct plan_known *known);

/** Reads it back; CONUS_ERROR_DATA for any other text. @p out is the caller's to plan_known_finish() in any case. */
conus_status plan_known_parse(struct plan_known *out, const char *text, size_t size);
void plan_known_finish(struct plan_known *known);

#endif
