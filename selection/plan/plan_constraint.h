/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The checked constraints of a plan (Eq. 22). */
#ifndef CONUS_SELECTION_PLAN_PLAN_CONSTRAINT_H
#define CONUS_SELECTION_PLAN_PLAN_CONSTRAINT_H

#include "conus/plan.h"
#include "selection/selector.h"

/** A shape that objects of a structure have: a volume, a mesh, or a bundle. */
struct plan_part {
    const struct volume *volume; /**< Any of its objects may be the structure's. */
    const struct mesh *mesh;
    const struct tractogram *tractogram;
    const struct tract_group *group; /**< Group of the tractogram; NULL = all of it. */
    uint32_t object;                 /**< The mesh's or the bundle's. */
    struct plan_map *map;            /**< Map of the volume, see plan_constraint_map(); NULL = none. */
};

/** A constraint, checked. */
struct plan_constraint {
    char *name;             /**< The names that were asked for, as the atlas has them; NULL without a structure. */
    conus_constraint asked; /**< Without names; needles are owned, the direction has length 1. */
    uint32_t *has;  /**< [object_count + 1] Each object of the structure at its number, else 0; NULL without one. */
    bool *reported; /**< [object_count + 1] The object as which each is reported; NULL except for measures of a cone. */
    struct plan_part *parts;
    size_t part_count;
    bool has_leeway;
    size_t shanks[2]; /**< It is about those from the first to before the second, from 0: */
    bool any_shank;   /**< any of these; else each. */
};

/** Fills a zeroed one; it can be finished after a failure, too. */
conus_status plan_constraint_init(struct plan_constraint *out, const conus_selector *selector,
                                  const conus_constraint *asked, size_t shank_count);
void plan_constraint_finish(struct plan_constraint *constraint);

/** Makes the maps of a constraint that keeps a distance, or that has a leeway. */
conus_status plan_constraint_map(struct plan_constraint *constraint, const conus_selector *selector);

/** Fills a zeroed one's name, has and parts; it can be finished after a failure, too. Hidden objects are left out,
 * unless @p with_hidden. */
conus_status plan_structure_find(struct plan_constraint *out, const conus_atlas *atlas, const char *names,
                                 bool with_hidden);

/** The same of one object and of all below it, hidden or not; it may have no part. */
conus_status plan_structure_of(struct plan_constraint *out, const conus_atlas *atlas, uint32_t number);

/** Refuses constraints that repeat or exclude each other. */
conus_status plan_constraints_check(const struct plan_constraint *constraints, size_t count, const conus_atlas *atlas);

/** Whether a measure concerns the pose's cone or cylinder, not its axis. */
static inline bool plan_is_of_cone(conus_measure measure)
{
    return measure >= CONUS_MEASURE_SHARE;
}

/** Whether it measures an angle: degrees in the verdict, radians while it is judged. */
static inline bool plan_is_of_direction(const struct plan_constraint *constraint)
{
    return constraint->asked.kind == CONUS_CONSTRAINT_LEAN || constraint->asked.kind == CONUS_CONSTRAINT_ENTRY_ANGLE;
}

/** Whether the constraint is a distance that must be kept. */
static inline bool plan_is_clearance(const struct plan_constraint *constraint)
{
    return constraint->asked.kind == CONUS_CONSTRAINT_AVOID && constraint->asked.measure == CONUS_MEASURE_LENGTH;
}

#endif
