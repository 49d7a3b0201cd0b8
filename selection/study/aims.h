/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Where cones begin and whether they point at the atlas at all: geometry, before any ray is traced. */
#ifndef CONUS_SELECTION_STUDY_AIMS_H
#define CONUS_SELECTION_STUDY_AIMS_H

#include "selection/cone/cone.h"

/** Sets up a zeroed one for the atlas and options of @p selector, which must outlive it. */
void aims_init(struct conus_aims *out, const conus_selector *selector);

/** Adds what @p from has found to @p aims. */
void aims_merge(conus_astray *aims, const conus_astray *from);

/** Whether the cone or cylinder surely hits nothing of the box from @p low to @p high. A pyramid or prism counts as
 * the cone or cylinder around it. */
bool aims_past(const struct cone *cone, const double low[3], const double high[3]);

struct conus_aims {
    const conus_selector *selector;
    double low[3], high[3]; /**< Around all areas and pathways. */
    bool has_box;
    conus_astray found;
};

#endif
