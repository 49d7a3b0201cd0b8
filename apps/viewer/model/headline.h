/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The answer in a sentence of two lines. */
#ifndef CONUS_VIEWER_MODEL_HEADLINE_H
#define CONUS_VIEWER_MODEL_HEADLINE_H

#include "viewer/model/viewer.h"

enum { HEADLINE_TEXT = 512 };

struct headline {
    char what[HEADLINE_TEXT]; /**< "Precentral_L", "Caudate_L and Putamen_L", "Reaches Hippocampus_L". */
    char more[HEADLINE_TEXT]; /**< "60 % of the cone \u00b7 50.0 mm from the start \u00b7 left"; " " where there is
                                   nothing to say. */
    bool is_of_plan;          /**< It says what the needle of a plan does, in place of what is hit first. */
};

/** Words the first tool's answer in the drawn atlas: what the needle of a plan does, wherever that is judged, or else
 * what is hit best: of several whose shares are shown as the same number all, as far as shares decide. */
void headline_find(struct headline *out, struct viewer *viewer);

#endif
