/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The table of pairs (Eq. 26). */
#ifndef CONUS_SELECTION_PLAN_TOGETHER_PAIRS_H
#define CONUS_SELECTION_PLAN_TOGETHER_PAIRS_H

#include "selection/plan/together/bodies.h"
#include "selection/table/table.h"

enum { BODY_WORD = 16 };

/** A row: two needles of a combination. */
struct pair_row {
    struct table_object none;
    uint64_t combination;      /**< 0 of one that does not hold. */
    const char *names[2];      /**< Of the needles. */
    const char *words[2];      /**< Of the bodies: bodies[0] and [1]. */
    char bodies[2][BODY_WORD]; /**< "shaft", "shank 2", "part 1" */
    double leeway;
    struct pair pair;
};

extern const struct table_fields pair_fields;

/** Fills what is about the bodies. */
void pair_row_name(struct pair_row *row, const struct bodies *bodies, const struct bodies *other);

#endif
