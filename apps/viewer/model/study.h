/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A study of the cone: its shares over its angle, or the chances under errors of its pose, in all atlases. Or
 * of candidates against constraints: a plan.
 * Angles in degrees; mm. */
#ifndef CONUS_VIEWER_MODEL_STUDY_H
#define CONUS_VIEWER_MODEL_STUDY_H

#include "viewer/model/plan_list.h"

enum { LEVEL_LIMIT = 1024, STUDY_ERROR = 256 };
enum study_kind {
    STUDY_NONE = 0,
    STUDY_SWEEP,
    STUDY_JITTER,
    STUDY_COUNT,
    STUDY_PLAN = STUDY_COUNT /**< Not of the cone. */
};

/** Whether both make the same selector. Scores are compared by their address: they are names of conus_score(). */
bool selector_options_are_same(const conus_selector_options *a, const conus_selector_options *b);

/** The user's settings. */
struct study_settings {
    enum study_kind kind;
    double angles[3];          /**< From, to and by, full openings, degrees. */
    double tilt_deg, shift_mm; /**< Standard deviations of jitter, as conus_jitter_options has them. */
    double samples;            /**< For jitter: a power of two from 16 to 2^20. */
};

extern const struct study_settings study_defaults;

/** NULL, or what is wrong with settings, in words. */
const char *study_fault(const struct study_settings *settings);

/** All that an answer depends on. */
struct study_question {
    struct study_settings settings;
    conus_selector_options options; /**< Without a level. */
    char level[LEVEL_LIMIT];        /**< In the first atlas; "" = none. */
    conus_pose pose;
    double angle; /**< For jitter: full opening; 0 = a cylinder. */
    conus_frame frame;
    unsigned atlas_number;        /**< Grows when an atlas changes. */
    const struct plan_task *plan; /**< A plan's task, which must outlive the question; else NULL. */
};

/** Whether both have the same answer. */
bool study_is_same(const struct study_question *a, const struct study_question *b);
/** Whether they have the same selectors. */
bool study_has_same_selectors(const struct study_question *a, const struct study_question *b);

/** An object's shares, by the angle. */
struct study_curve {
    uint32_t object; /**< 0 = nothing hit. */
    double *shares;  /**< [angle_count] 0 to 1. */
    double most;     /**< The largest of them. */
};

/** The numbers of one atlas. */
struct study_table {
    struct study_curve *curves; /**< [curve_count] Of a sweep: the largest first, nothing hit last. */
    size_t curve_count;
    conus_table *chances; /**< Of jitter: by rank, nothing hit last. */
};

struct study_answer {
    struct study_question question;
    double *angles; /**< [angle_count] Of a sweep, degrees. */
    size_t angle_count;
    struct study_table *tables; /**< [atlas_count] */
    size_t atlas_count;
    struct plan_list plan;   /**< A plan's poses, in the first atlas. */
    char *text;              /**< As conus sweep --format tsv prints it; NULL where it failed: */
    char error[STUDY_ERROR]; /**< why. */
};

struct view_atlas;

/** Answers by the selectors of @p question's options; what fails is the answer's error. NULL without memory, or where
 * @p stops, asked between portions, says so. */
struct study_answer *study_answer_create(const struct study_question *question, conus_selector *const *selectors,
                                         const struct view_atlas *atlases, size_t count, bool (*stops)(void *user),
                                         void *user);
/** An answer that only says why there is none. NULL without memory. */
struct study_answer *study_answer_refuse(const struct study_question *question, const char *why);
/** A number of a row of chances. */
double chance_number(const conus_table *chances, size_t row, const char *column);
/** Whether it lies in the cone of some pose, but no pixel of any hits it first: known with all layers. */
bool chance_is_behind(const conus_table *chances, size_t row);
/** Whether it is hit, seen or behind under any pose. */
bool chance_is_listed(const conus_table *chances, size_t row);
/** NULL is allowed. */
void study_answer_destroy(struct study_answer *answer);

#endif
