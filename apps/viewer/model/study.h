/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Studies of the window: what they ask, the candidates of a plan, and the thread that answers. */
#ifndef CONUS_VIEWER_MODEL_STUDY_H
#define CONUS_VIEWER_MODEL_STUDY_H

#include "settings/settings.h"

/* Candidates of a file, tried against constraints: the best of them. World RAS+, mm. */

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

/** Tries the candidates with the radius and range of @p selector; Rows and text of @p out are the caller's to
 * free in any case. */
conus_status plan_list_fill(struct plan_list *out, const struct plan_task *task, conus_selector *selector,
                            const conus_atlas *atlas, const conus_frame *frame, conus_progress progress, void *user);

/** The name of the object that a clearance is from: the nearest one, or else its constraint's structure. */
const char *plan_nearest(const conus_plan *plan, const conus_atlas *atlas, const conus_planned *planned, size_t index);

/* A study of the cone: its shares over its angle, or the chances under errors of its pose, in all atlases. Or of
 * candidates against constraints: a plan. Angles in degrees; mm. */

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

/* A thread that answers the newest study while the window goes on. It has selectors of its own. */

struct studier;

/** The state of model/viewer.h. */
struct study_state {
    struct study_settings settings;
    struct studier *studier;     /**< Made when needed. */
    struct study_question asked; /**< The newest one, if there is a studier. */
    struct study_answer *answer; /**< The newest one; NULL = none. */
};

/** The atlases [count] and their names must outlive it; @p wake (NULL = nothing) is called on its thread when there is
 * an answer. False without memory or a thread. */
bool studier_create(struct studier **out, const struct view_atlas *atlases, size_t count, void (*wake)(void));
/** Waits for the portion that is being computed. NULL is allowed, here and below. */
void studier_destroy(struct studier *studier);

/** Asks for a study in place of those asked before; the one under way is ended, unless it takes less than 0.3 s. */
void studier_ask(struct studier *studier, const struct study_question *question);
/** The newest answer, now the caller's to destroy; NULL = there is no other than before. */
struct study_answer *studier_take(struct studier *studier);

/** Waits until nothing of the atlases is read, and lets nothing be read, until as many calls of studier_resume(). */
void studier_hold(struct studier *studier);
void studier_resume(struct studier *studier);

/* The window's state of its plan (viewer.h). */

enum { PLAN_TEXT = 256, PLAN_LINE = 320, PLAN_DETAILS = 2048 };

/** The verdict of a plan's constraints on the first tool. */
struct plan_verdict {
    enum { PLAN_UNKNOWN = 0, PLAN_HOLDS, PLAN_BREAKS, PLAN_FAILED } state;
    char text[PLAN_TEXT];         /**< "holds, 1.8 mm to Insula_L"; */
    char leeway[32];              /**< follows it: ", may be off by 0.66 mm". */
    char reaches[PLAN_TEXT];      /**< "Reaches U", "Does not reach U"; "" where nothing is to be reached. */
    char clears[PLAN_TEXT];       /**< "4.0 mm from Ball", "touches Ball"; "" where nothing is to be clear of it. */
    char details[PLAN_DETAILS];   /**< A line for each constraint; "" where it is unknown. */
    const conus_constraint *lost; /**< The first whose area the atlas does not show, for which nothing is judged; NULL =
                                     none. The plan's. */
};

/** The state of model/viewer.h. */
struct plan_state {
    struct plan_task task;            /**< Does not change. */
    unsigned number;                  /**< Grows with every other task. */
    double depth;                     /**< Far end of candidates that have none; 0 = none. */
    struct study_state list;          /**< The candidates' study: STUDY_PLAN, or STUDY_NONE without a file of them. */
    conus_selector *selector;         /**< Selects for the plan that tries the tool; */
    conus_plan *live;                 /**< NULL = to be made. */
    conus_selector_options made_with; /**< That selector. */
    struct plan_verdict verdict;
    bool judged;           /**< There is a verdict, */
    unsigned judged_after; /**< at this answer_number of the tool. */
};

/** Ends the plan that tries the tool: its radius or its atlas is about to change. */
void plan_state_drop_live(struct plan_state *state);
/** Likewise, and lets nothing of the atlas be read until plan_state_resume(). */
void plan_state_pause(struct plan_state *state);
void plan_state_resume(struct plan_state *state);
/** Forgets the list, and the thread that makes it: the atlas is another one. */
void plan_state_forget(struct plan_state *state);
void plan_state_finish(struct plan_state *state);

#endif
