/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Candidates of a file, tried against constraints: the best of them. World RAS+, mm. */
#ifndef CONUS_VIEWER_MODEL_PLAN_LIST_H
#define CONUS_VIEWER_MODEL_PLAN_LIST_H

#include "settings/constraints.h"

enum { PLAN_ID = 64, PLAN_NAME = 96, PLAN_SAYS = 256 };

/** The constraints on needles, and the file of those that are tried. */
struct plan_task {
    struct constraints constraints; /**< None = there is no plan. */
    char *poses;                    /**< NULL = no candidates. */
};

/** A listed candidate. The place of one that holds all constraints is its rank. */
struct plan_row {
    char id[PLAN_ID];
    conus_pose pose;
    double range[2];          /**< Near and far end. */
    double angle;             /**< Opening of its cone, degrees; 0 of a cylinder. */
    double leeway, clearance; /**< NaN where there is none. */
    bool breaks;              /**< It breaks a constraint. */
    char nearest[PLAN_NAME];  /**< The avoided object that has the clearance, or "breaks U"; "" = none. */
};

struct plan_list {
    struct plan_row *rows; /**< [count] By rank; where none holds all constraints, the nearest misses. */
    size_t count;
    char says[PLAN_SAYS]; /**< How many were tried, and how many hold all constraints. */
    char *text;           /**< As conus plan --format tsv prints it. */
};

/** Tries the candidates with the radius and range of @p selector; @p out is the caller's to finish in any case. */
conus_status plan_list_fill(struct plan_list *out, const struct plan_task *task, conus_selector *selector,
                            const conus_atlas *atlas, const conus_frame *frame, conus_progress progress, void *user);
void plan_list_finish(struct plan_list *list);

/** The name of the object that a clearance is from: the nearest one, or else its constraint's structure. */
const char *plan_nearest(const conus_plan *plan, const conus_atlas *atlas, const conus_planned *planned, size_t index);

#endif
