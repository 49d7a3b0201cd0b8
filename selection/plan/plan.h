/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A plan from inside: its constraints and their structures, what judges a pose and tries it, and the order of
 * poses (Eq. 22). */
#ifndef CONUS_SELECTION_PLAN_PLAN_H
#define CONUS_SELECTION_PLAN_PLAN_H

#include "base/geometry/math3.h"
#include "conus/plan.h"
#include "conus/pose.h"
#include "selection/evidence/evidence.h"
#include "selection/measure/measure.h"
#include "selection/measure/score.h"
#include "selection/selection.h"
#include "selection/study/study.h"

/* The checked constraints of a plan (Eq. 22). */

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
    bool *named;    /**< [object_count + 1] The objects that were named; NULL without a structure. */
    bool *reported; /**< [object_count + 1] The object as which each is reported; NULL except for measures of a cone. */
    struct plan_part *parts;
    size_t part_count;
    bool has_leeway; /**< Where it holds. LENGTH, LEAN, FIRST, ARC, SLIDER, contacts, probabilities, measures of a cone,
                        and a REACH by surfaces that are not closed have none, and do not count for the leeway of poses.
                      */
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

/** Whether it measures an angle of a rig with arcs, degrees. */
static inline bool plan_is_of_rig(const struct plan_constraint *constraint)
{
    return constraint->asked.kind >= CONUS_CONSTRAINT_ARC;
}

/** Whether the constraint is a distance that must be kept. */
static inline bool plan_is_clearance(const struct plan_constraint *constraint)
{
    return constraint->asked.kind == CONUS_CONSTRAINT_AVOID && constraint->asked.measure == CONUS_MEASURE_LENGTH;
}

/* How far the points of an axis may move until a structure is no longer reached (Eq. 22). */

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

/* A plan from inside: its constraints, what judges a pose, and the order of poses (Eq. 22). */

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

/** Counts the contacts of all shanks that are in a structure; cover->asked.contacts are those of a shank. */
conus_status plan_judge_contacts(uint32_t *out, struct plan_judge *judge, const struct plan_constraint *cover);

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

/** Copies a pose of @p plan, with all that it points to, into @p out. Ends with plan_copy_finish(). */
conus_status plan_copy(conus_planned *out, const conus_plan *plan, const conus_planned *pose);
void plan_copy_finish(conus_planned *copy);

/** Reads poses again, those whose numbers are the `candidate` of each copy, in ascending order. Tries them, as
 * conus_plan_try(), unless they are @p untried: then a copy keeps its leeway. It is as it was where @p poses ends
 * before. */
conus_status plan_find(conus_planned *copies, size_t count, conus_plan *plan, conus_pose_stream *poses, bool untried);

/** Measures everything of every pose, also what decides nothing: slower, the same answer, to compare with. */
void plan_measure_all(conus_plan *plan);

/** The judge of single poses outside of a run. */
struct plan_judge *plan_judge_of(conus_plan *plan);

/* A pose that is tried: what a plan asks of it, and how much of that has to be measured (Eq. 22). */

/** The constraints and options of a plan; a run does not change them. */
struct plan_asked {
    conus_selector *selector;
    conus_plan_options options; /**< Defaults filled in; strings and shanks are not kept. */
    struct plan_constraint *constraints;
    size_t count;
    struct plan_order order;
    struct plan_jitter jitter;
    bool measures_all; /**< Of every pose, also what decides nothing. */
};

const struct plan_asked *plan_asked_of(const conus_plan *plan);

/** The results of earlier poses, so that less has to be measured of later ones. */
struct plan_bar {
    bool has_maps; /**< All constraints have maps. */
    bool has_feasible;
    bool is_full;      /**< Keys are those of the last pose of a full list: whatever follows has to be better. */
    size_t infeasible; /**< So many are kept. */
    double *keys;      /**< [rank_count] */
    double *misses;    /**< [count] By how much the nearest miss breaks each constraint. */
};

conus_status plan_bar_init(struct plan_bar *out, const struct plan_asked *asked);
void plan_bar_finish(struct plan_bar *bar);
void plan_bar_copy(struct plan_bar *to, const struct plan_bar *from, const struct plan_asked *asked);

/** The scratch with which one thread tries poses. */
struct plan_worker {
    struct plan_judge judge;
    struct plan_bar bar; /**< As it was when the pose's turn came. */
};

/** A pose that is tried. */
struct plan_trial {
    conus_planned planned; /**< The id is that at `id` of its block's strings. */
    size_t id;
    conus_verdict *verdicts;
    double *keys; /**< As they are compared. */
    double *bar;  /**< [rank_count] What it has to be better than, where it has a bar: the last of a full list, or
                     the best of its entry or target so far where that is less. */
    bool has_bar;
    bool is_known;    /**< It was judged before, and is feasible. */
    bool is_measured; /**< All of this is whole. */
    double most;      /**< mm: else, where it is feasible, what its leeway does not exceed. */
    bool is_lone;     /**< It breaks planned.broken and nothing else. */
};

/** Why a row is no candidate; NULL where it is one, and @p out has its needle. */
const char *plan_trial_begin(conus_planned *out, const conus_pose_row *row, const struct plan_asked *asked);

/** Has a judge that is turned to the pose give all verdicts, with so much care, and sums them up. */
conus_status plan_trial_measure(struct plan_trial *trial, struct plan_judge *judge, const struct plan_asked *asked,
                                enum plan_care care);

/** Tries the pose, which was begun: it is whole where it may be kept. */
conus_status plan_trial_try(struct plan_trial *trial, struct plan_worker *worker, const struct plan_asked *asked);

/** The same of a pose that is known to be feasible; of one that is measured its leeway is known. */
conus_status plan_trial_again(struct plan_trial *trial, struct plan_worker *worker, const struct plan_asked *asked);

/* Bounds of distances to a structure, or to what is outside of it: a byte for each voxel. */

struct plan_map;

/** Measures the voxels round the objects of @p has, of @p volume, which has some: how far their centres are from the
 * nearest cell of these objects; or, with @p outside, of others and of all that is beyond the grid. @p out is NULL
 * where the grid's axes are not perpendicular and where that would be too many voxels. CONUS_ERROR_MEMORY. */
conus_status plan_map_create(struct plan_map **out, const struct clearance_index *index, const conus_atlas *atlas,
                             const struct volume *volume, const uint32_t *has, bool outside);
/** NULL is fine. */
void plan_map_destroy(struct plan_map *map);

/** The limits, mm, between which, exclusively, lies the distance of the point @p at (the volume's voxels); the second
 * may be infinite. */
void plan_map_bounds(double bounds[2], const struct plan_map *map, const double at[3]);

/** 1 if the whole part of @p needle is farther than @p distance, mm; -1 if some of it is nearer; 0 where the map cannot
 * say. */
int plan_map_is_farther(const struct plan_map *map, const struct needle *needle, double distance);

/** mm of the part of @p needle inside the objects of a map with outside, to 1e-6. -INFINITY where it stays a voxel away
 * from them, NaN where the map cannot say. */
double plan_map_inside(const struct plan_map *map, const struct needle *needle);

/** An upper bound of the mm of the needle's line, between the depths @p from and @p to, that are @p distance or more
 * away. */
double plan_map_most(const struct plan_map *map, const struct needle *needle, double from, double to, double distance);

/* The inner point of a structure, how far it is, and how much of it lies on which side, hidden or not. */

/** A point of a structure. */
struct inner_point {
    double at[3];    /**< World mm. */
    double depth;    /**< mm to what is not the structure; 0 = there is no such point. */
    uint64_t source; /**< Linear index of its voxel; UINT64_MAX of a surface. */
};

/** Of the centres of the structure's voxels that which is farthest from the centres of all others, background and what
 * lies beyond the grid included; of the points inside of a closed surface, on a grid of 1 mm (or less, where none is
 * inside), that which is farthest from it. Of points that are equal to 1e-9 mm the nearest to @p centroid, then the
 * first. @p structure is one with hidden objects. CONUS_ERROR_MEMORY. */
conus_status plan_deepest(struct inner_point *out, const struct plan_constraint *structure, const double centroid[3]);

/** Whether a point lies in one of the structure's voxels or closed surfaces. */
bool plan_is_inside(const struct plan_constraint *structure, const double point[3]);

/** The centre of the structure's voxel, or the point of its surface, that is nearest to @p from, of equally near ones
 * the first; false for bundles, which have neither. */
bool plan_nearest_point(double out[3], const struct plan_constraint *structure, const double from[3]);

/** mm from each point to the nearest voxel's centre or point of a surface of its object and of those below it, hidden
 * or not; 0 in such a voxel, infinite where there is neither. @p out is [count]. One pass over the voxels for all
 * points. CONUS_ERROR_MEMORY. */
conus_status plan_distances(double *out, const conus_atlas *atlas, const uint32_t *objects, const double (*points)[3],
                            size_t count);

/** The structure's mean position, weighted by volume, and that volume, mm^3, in out[3]; all 0 without one. */
void plan_centroid(double out[4], const struct plan_constraint *structure);

/** Refuses the inner point of a structure of which 20 % or more lie on each side (frame_midline()), and whose object
 * says no side: nobody has chosen one. One that is nearer to the midline than half its depth is fine, in an atlas some
 * of whose areas have a side. Where the midline is not known, each without a side is refused. CONUS_ERROR_ARGUMENT
 * with both volumes and the way on; CONUS_ERROR_MEMORY. */
conus_status plan_check_sides(const struct plan_constraint *structure, const struct inner_point *inner,
                              const conus_atlas *atlas, uint32_t object);

#endif
