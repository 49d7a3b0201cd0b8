/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A small random atlas and answers of each kind from it, for reports; and reports without memory. */
#ifndef CONUS_TESTS_SUPPORT_REPORT_SCENE_H
#define CONUS_TESTS_SUPPORT_REPORT_SCENE_H

#include "conus/report.h"

struct report_scene {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_selection *cone;
    conus_selection *contacts[2]; /**< Balls 1 mm apart. */
    conus_table *sweep, *jitter;
    conus_report_options options; /**< Zero; a test sets what it needs. */
};

struct report_scene report_scene_create(void);
/** The same from another seed: another atlas, and other queries. */
struct report_scene report_scene_create_from(uint64_t seed);
void report_scene_destroy(struct report_scene *scene);

/** One answer and its report. */
struct report_attempt {
    const conus_atlas *atlas;
    conus_selector_options options;
    conus_report_options report;
    conus_pose pose;
    double angle;
    double centre[3], radius; /**< A ball, unless the radius is 0: then the pose counts. */
};

/** Selects and reports with a new selector, with every allocation failing in turn. */
void report_every_allocation(const struct report_attempt *attempt);

#endif
