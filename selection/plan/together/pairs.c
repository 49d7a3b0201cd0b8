/* SPDX-License-Identifier: BSD-3-Clause */
/* The columns of pairs. */
#include "selection/plan/together/together.h"

#include <stdio.h>

static void name_body(char out[BODY_WORD], const struct bodies *bodies, size_t body)
{
    size_t shafts = bodies->shaft_count;
    bool is_part = body >= shafts;
    snprintf(out, BODY_WORD, is_part || shafts > 1 ? "%s %zu" : "shaft", is_part ? "part" : "shank",
             (is_part ? body - shafts : body) + 1);
}

void pair_row_name(struct pair_row *row, const struct bodies *bodies, const struct bodies *other)
{
    name_body(row->bodies[0], bodies, row->pair.nearest.body);
    name_body(row->bodies[1], other, row->pair.nearest.other);
    row->words[0] = row->bodies[0];
    row->words[1] = row->bodies[1];
}

static const struct table_field columns[] = {
    {"combination", NULL, "number of the combination, from 1; 0 of one that breaks something",
     TABLE_OF(LARGE_COUNT, struct pair_row, combination)},
    {"needle", NULL, "the one needle", TABLE_OF(TEXT, struct pair_row, names[0])},
    {"other", NULL, "the other one", TABLE_OF(TEXT, struct pair_row, names[1])},
    {"slack_mm", "mm", "by how much they are farther apart than their margin",
     TABLE_OF(NUMBER, struct pair_row, pair.slack)},
    {"leeway_mm", "mm", "by which all their points may be off before they are nearer",
     TABLE_OF(NUMBER, struct pair_row, leeway)},
    {"distance_mm", "mm", "between the surfaces of the two bodies with that slack; below 0 where they overlap",
     TABLE_OF(NUMBER, struct pair_row, pair.nearest.distance)},
    {"body", NULL, "the needle's: shaft, shank N or part N", TABLE_OF(TEXT, struct pair_row, words[0])},
    {"other_body", NULL, "the other needle's", TABLE_OF(TEXT, struct pair_row, words[1])},
    TABLE_XYZ("", "where the axis of the needle's body is nearest", TABLE_OF, struct pair_row, pair.nearest.at),
    TABLE_XYZ("other_", "where that of the other one is", TABLE_OF, struct pair_row, pair.nearest.other_at),
    {"entry_distance_mm", "mm", "between the positions of both devices",
     TABLE_OF(NUMBER, struct pair_row, pair.entries)},
    {"arc_deg", "degree", "between their arc angles (--arcs)", TABLE_OF(NUMBER, struct pair_row, pair.arc)},
    {"slider_deg", "degree", "between their slider angles", TABLE_OF(NUMBER, struct pair_row, pair.slider)},
};

const struct table_fields pair_fields = {columns, sizeof columns / sizeof columns[0]};
