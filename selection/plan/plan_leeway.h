/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How far the points of an axis may move until a structure is no longer reached (Eq. 22). */
#ifndef CONUS_SELECTION_PLAN_PLAN_LEEWAY_H
#define CONUS_SELECTION_PLAN_PLAN_LEEWAY_H

#include "base/geometry/needle.h"
#include "selection/evidence/layers.h"
#include "selection/plan/plan_constraint.h"

/** A part of the axis, mm from the apex. */
struct plan_span {
    double entry, exit;
};

struct plan_spans {
    struct plan_span *items;
    size_t count, capacity;
};

/** Scratch, kept between questions. A zeroed one is ready. */
struct plan_leeway {
    struct needle needle;    /**< The part of the axis that counts. */
    const uint32_t *has;     /**< The structure's objects. */
    conus_contacts contacts; /**< Its points, where there are some: `least` of them are to stay in the structure, */
    double least;            /**< else so many mm. */
    bool uses_maps;          /**< The parts' maps, where they have some, may be looked at. */
    struct plan_side *sides;
    size_t side_count, side_capacity;
    struct plan_body *bodies; /**< Everything that is not the structure, side by side. */
    size_t body_count, body_capacity;
    struct plan_spans inside; /**< Where the needle is in the structure, side by side; */
    struct plan_spans taken;  /**< where bodies are nearer than delta, and where they are for a smaller one, */
    struct plan_spans sure;   /**< likewise; */
    struct plan_spans left;   /**< what that leaves. */
};

void plan_leeway_finish(struct plan_leeway *leeway);

/** Asks about a constraint with a leeway, a REACH, and an axis that passes @p layers; leeway->needle, contacts and
 * least are set. */
conus_status plan_leeway_ask(struct plan_leeway *leeway, const struct plan_constraint *constraint,
                             const conus_atlas *atlas, const struct layers *layers);

/** Whether the points of the axis may each move by less than @p delta, mm, in any direction. */
conus_status plan_leeway_is(bool *out, struct plan_leeway *leeway, double delta);

/** A delta for which that is so, at most @p most: no less than half of the largest one, or 0. */
conus_status plan_leeway_guess(double *out, struct plan_leeway *leeway, double most);

/** The largest such delta, from below, to 1e-6 mm. */
conus_status plan_leeway_find(double *out, struct plan_leeway *leeway);

#endif
