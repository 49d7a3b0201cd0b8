/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A plan from inside: its constraints, what judges a pose, and the order of poses (Eq. 22). */
#ifndef CONUS_SELECTION_PLAN_PLAN_H
#define CONUS_SELECTION_PLAN_PLAN_H

#include "conus/plan.h"
#include "selection/measure/formula.h"
#include "selection/plan/plan_leeway.h"
#include "selection/selector.h"
#include "selection/study/study.h"

/* plan.c */

/** The best pose of an entry or of a target. */
struct plan_best {
    uint64_t feasible;  /**< How many of its poses break no constraint. */
    uint64_t candidate; /**< Number of the best of these by the rank; 0 = there is none, and all that follows is NaN. */
    double leeway, slack, far, entry_angle; /**< As of conus_planned. */
    double reach;                           /**< Value of the first REACH; NaN without one. */
};

/** Whether it has its list. */
bool plan_is_done(const conus_plan *plan);

/** [count] Of all entries, or of all targets. */
const struct plan_best *plan_bests(size_t *count, const conus_plan *plan, bool of_targets);

/* plan_order.c */

/** A key by which poses are ordered: what a name of struct plan_order means. */
struct plan_key {
    size_t name;
    bool smaller; /**< Smaller is better. */
    double step;  /**< 0 = none. */
};

struct plan_name {
    char text[16];
    enum plan_quantity {
        PLAN_LEEWAY,
        PLAN_SLACK,
        PLAN_CLEARANCE,
        PLAN_CHANCE, /**< Probability to hold (Eq. 14). */
        PLAN_DEPTH,
        PLAN_ENTRY_ANGLE,
        PLAN_VALUE, /**< Value of a constraint. */
        PLAN_SCORE
    } quantity;
    size_t constraint;
};

struct plan_order {
    struct plan_name *names; /**< [name_count] The last is the score's, if there is one. */
    size_t name_count;
    struct plan_key *rank; /**< [rank_count] */
    size_t rank_count;
    struct formula *score; /**< NULL = none. */
    bool needs_leeway, needs_chance;
    bool in_nanometres; /**< Keys are lengths, compared in whole ones (Eq. 27). */
    size_t sure_count;  /**< So many keys of the rank, the first ones, do without the chance. */
};

/** Fills a zeroed one; it can be finished after a failure, too. */
conus_status plan_order_init(struct plan_order *out, const struct plan_constraint *constraints, size_t count,
                             const conus_plan_options *options);
void plan_order_finish(struct plan_order *order);

/** Sets planned->score, and the keys of @p rank (may be NULL) as they are compared: larger is better. @p pose has its
 * verdicts. */
void plan_order_keys(double *rank, conus_planned *pose, const struct plan_order *order);

/** Above 0 where keys @p a are better than @p b, below 0 where they are worse. */
int plan_keys_compare(const double *a, const double *b, size_t count);

/* plan_verdict.c */

/** How much of a verdict is wanted. */
enum plan_care {
    PLAN_HOLDS,  /**< Whether the constraint holds. */
    PLAN_SLACKS, /**< All but the leeway. */
    PLAN_ALL
};

/** One of the parallel needles of the pose at hand. */
struct plan_shank {
    conus_pose pose;
    struct needle needle;
    bool is_followed;           /**< The layers are its. */
    struct layers layers;       /**< Objects along its axis, from the apex on, sorted. */
    conus_selection *selection; /**< NULL = not needed yet. */
};

/** The scratch with which one thread judges, and the pose at hand. */
struct plan_judge {
    const struct plan_constraint *constraints;
    conus_selector *selector; /**< Shares its engine with the other threads'. */
    const conus_planned *pose;
    const double (*offsets)[2]; /**< [shank_count] Along the device's x and y, mm. */
    struct plan_shank *shanks;  /**< [shank_count] */
    size_t shank_count;
    struct plan_shank *shank;  /**< The one at hand. */
    struct plan_leeway leeway; /**< Its uses_maps is that of all questions. */
};

conus_status plan_judge_init(struct plan_judge *out, conus_selector *selector,
                             const struct plan_constraint *constraints, const double (*offsets)[2], size_t shank_count);
void plan_judge_finish(struct plan_judge *judge);

/** The angle between the axis and the inward normal at the entry, radians. */
double plan_entry_angle(const conus_planned *pose);

/** Turns to another candidate. */
void plan_judge_turn(struct plan_judge *judge, const conus_planned *pose);

/** mm to the farthest point of the pose's needles from a point, or from the line through it along the unit vector
 * @p along unless that is NULL. */
double plan_judge_lever(const struct plan_judge *judge, const double pivot[3], const double along[3]);

/** The verdict on constraint @p index. Less care leaves members as they were. */
conus_status plan_judge(conus_verdict *out, struct plan_judge *judge, size_t index, enum plan_care care);

/** Whether constraint @p index, which holds, lets @p quantity (leeway, slack or clearance) of the pose be @p least or
 * more; quicker than to measure it. */
conus_status plan_judge_least(bool *out, struct plan_judge *judge, size_t index, enum plan_quantity quantity,
                              double least);

/** A leeway of constraint @p index, which has one, that is proven: at most @p most, mm, and 0 where it breaks. Of a
 * direction its slack, radians, by which the axis may turn. */
conus_status plan_judge_leeway(double *out, struct plan_judge *judge, size_t index, double most);

/** mm from the needle's axis to the structure of constraint @p index; of several as conus_plan_distance() says. */
double plan_judge_distance(struct plan_judge *judge, size_t index);

/* plan_jitter.c */

/** Errors of poses. */
struct plan_jitter {
    conus_jitter_options options;        /**< Defaults filled in; samples 0 = no errors. */
    double (*errors)[JITTER_DIMENSIONS]; /**< [samples] Standard normal ones. */
};

/** Fills a zeroed one; NULL = no errors. */
conus_status plan_jitter_init(struct plan_jitter *out, const conus_jitter_options *asked);

/** Sets pose->p_ok: the part of the poses with errors that hold all of @p count constraints. @p verdicts are all of the
 * pose's; with @p is_whole sets the p of each. Gives up once p_ok is sure to be below @p least: then it is an upper
 * bound. @p has_bounds: what the leeways prove is not judged. */
conus_status plan_jitter_ask(conus_planned *pose, conus_verdict *verdicts, struct plan_judge *judge, size_t count,
                             const struct plan_jitter *jitter, bool is_whole, double least, bool has_bounds);

/* plan.c */

/** Has a plan, the default rank's, compare whole nanometres (Eq. 27), and its run only try about one pose of 16: what
 * it lists tells how far down the best are. plan_list_again() then tries the others. */
void plan_sample(conus_plan *plan);

/** Lists anew, once plan_sample() and a run were called: the best @p most of all poses, which @p poses has again, that
 * have a leeway of @p least nm or more. What is learnt of a pose is kept: none is judged or measured twice, except
 * samples that break something. Verdicts of what is listed are of no use. */
conus_status plan_list_again(conus_plan *plan, conus_pose_stream *poses, int64_t least, uint64_t most);

/** Frees what is listed. */
void plan_forget_list(conus_plan *plan);

/** Tries the pose with that number again, as conus_plan_try(): it is NULL where @p poses ends before. */
conus_status plan_find(const conus_planned **out, conus_plan *plan, conus_pose_stream *poses, uint64_t number);

/** Measures everything of every pose, also what decides nothing: slower, the same answer, to compare with. */
void plan_measure_all(conus_plan *plan);

/** The judge of single poses outside of a run. */
struct plan_judge *plan_judge_of(conus_plan *plan);

#endif
