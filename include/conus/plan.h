/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file plan.h
 * Which needles reach and avoid what, and poses from entries and targets for a plan to try.
 */
#ifndef CONUS_PUBLIC_PLAN_H
#define CONUS_PUBLIC_PLAN_H

#include <conus/study.h>
#include <conus/table.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** @name Plans
 * @{ */

typedef struct conus_plan conus_plan; /**< Constraints, and the poses that were tried against them. */

/** The kinds of constraints. */
typedef enum conus_constraint_kind {
    CONUS_CONSTRAINT_REACH = 0,   /**< The measure of the structure is at least the limit. */
    CONUS_CONSTRAINT_AVOID,       /**< The clearance of the structure (Eq. 21) is more than the limit, mm; by
                                     #CONUS_MEASURE_SHARE or #CONUS_MEASURE_PIERCED the measure is at most the limit. */
    CONUS_CONSTRAINT_LENGTH,      /**< far - near is between the limit and most, mm. */
    CONUS_CONSTRAINT_LEAN,        /**< The axis and direction enclose at most the limit, degrees. */
    CONUS_CONSTRAINT_APART,       /**< The axis is farther than the limit from those of other needles, mm. */
    CONUS_CONSTRAINT_FIRST,       /**< The first object that the axis passes is of the structure. */
    CONUS_CONSTRAINT_ENTRY_ANGLE, /**< The axis and the inward normal at its entry enclose at most the limit, degrees.
                                   */
    CONUS_CONSTRAINT_ARC,   /**< The arc angle of a rig (Eq. 26) is between the limit and most, degrees, -360 to 360 and
                               up to a turn apart, within 1e-9; one that is a turn away counts. */
    CONUS_CONSTRAINT_SLIDER /**< The slider angle, likewise. */
} conus_constraint_kind;

/** Measures of a structure. Measures from #CONUS_MEASURE_SHARE on are of the cone or cylinder. */
typedef enum conus_measure {
    CONUS_MEASURE_LENGTH = 0,  /**< REACH: mm of the axis in the union of its objects (Eq. 17). AVOID: the clearance. */
    CONUS_MEASURE_TIP,         /**< 1 where the far end is in it, else 0. */
    CONUS_MEASURE_CROSSED,     /**< 1 where the axis passes or crosses it, also a surface with holes, else 0. */
    CONUS_MEASURE_CONTACTS,    /**< Contacts in it. */
    CONUS_MEASURE_PROBABILITY, /**< Probability of its areas or pathways, summed: mean of the contacts, without any
                                  along the axis. */
    CONUS_MEASURE_SHARE,       /**< Share of its objects (Eq. 4), summed. */
    CONUS_MEASURE_PIERCED,     /**< Pixels whose ray passes any of its objects / the cone's pixels, 0 to 1 (Eq. 10). */
    CONUS_MEASURE_VOLUME,      /**< Volume of its objects in the cone, mm^3, summed (Eq. 10). */
    CONUS_MEASURE_FRACTION,    /**< That volume / the whole volume of its objects, 0 to 1. */
    CONUS_MEASURE_STREAMLINES  /**< Streamlines of its bundles in the cone, summed (Eq. 19). */
} conus_measure;

/** One constraint. All must hold. */
typedef struct conus_constraint {
    size_t struct_size;         /**< Its size, as #CONUS_CONSTRAINT_INIT sets it; 0 = that of this version. */
    conus_constraint_kind kind; /**< Its kind. */
    conus_measure measure;      /**< REACH, AVOID: what is measured. */
    const char *names;          /**< REACH, AVOID, FIRST: the structure, a list of names, abbreviations or labels as of
                                   conus_atlas_find(), separated by commas; one with a comma stands in double quotes. It is the
                                   union of these objects and of the areas below them in the area tree, without hidden ones. */
    double limit;   /**< In the measure's unit. 0 of REACH: more than 1e-9 mm, or any at all. AVOID by clearance: the
                       margin, 0 to 100 mm. */
    double most;    /**< LENGTH, ARC, SLIDER: the upper end, mm or degrees. */
    double part[2]; /**< REACH by length: only the axis from part[0] to part[1] mm before the far end counts; both
                       0 = all of it. */
    double direction[3];     /**< LEAN: world, of any length but 0. */
    const double *needles;   /**< APART: [needle_count][6] both ends of their axes, world mm. */
    size_t needle_count;     /**< APART: how many there are. */
    conus_contacts contacts; /**< REACH by #CONUS_MEASURE_CONTACTS or #CONUS_MEASURE_PROBABILITY: on the axis, counted
                                from the far end; those before the near end are in nothing. */
    int32_t shank;           /**< REACH, AVOID, APART, FIRST: the shank that it is about, from 1; #CONUS_SHANK_ANY or
                                #CONUS_SHANK_ALL of them; 0 = any for REACH, all for the others. */
    double pitch;            /**< ARC: so many degrees are added to the angle in the axes of the selector's frame, -180
                                to 180: the rig is turned about the right-left axis. */
} conus_constraint;

/** conus_constraint.shank: it holds if it does for one shank. */
#define CONUS_SHANK_ANY (-1)
/** conus_constraint.shank: it holds if it does for each. */
#define CONUS_SHANK_ALL (-2)

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_CONSTRAINT_INIT CONUS_INIT_(conus_constraint)

/** How poses are tried and which are listed. Keys of a rank are leeway, slack, clearance, depth, entry_angle (degrees),
 * score, p_ok (with jitter), reach (value of the first REACH; reach2 that of the second, and so on) and share, volume
 * (of the first REACH by them). */
typedef struct conus_plan_options {
    size_t struct_size; /**< Its size, as #CONUS_PLAN_OPTIONS_INIT sets it; 0 = that of this version. */
    uint32_t threads;   /**< Up to 1024; 0 = as many as processors that the process may use. */
    uint64_t top;       /**< Poses to list; 0 = 20, UINT64_MAX = all. Memory grows with them alone. */
    bool infeasible;    /**< Poses that break a constraint are listed, too, behind the others, by candidate; within
                           top. */
    const char *rank;   /**< Keys separated by commas, the more important first; larger is better, of -KEY smaller;
                           KEY/STEP compares floor(key / STEP). NULL = "leeway,-depth". */
    const char *score;  /**< Formula of the key score: numbers, keys, + - * / and parentheses, as of Eq. 12. NULL =
                           none. */
    double angle;       /**< Opening of poses that have none of their own, degrees; 0 = 10, or a cylinder's 0.
                           Only measures of the cone need it. */
    double far;         /**< Far end of poses that have none of their own, mm from the apex; 0 = that of the selector's
                           range. */
    conus_progress progress; /**< Receives how many poses were tried, and of how many, 0 = not known; false ends the
                                run. NULL = no callback. */
    void *progress_user;     /**< Passed to @p progress. */
    uint64_t entries;        /**< The best pose of each entry up to this number is kept, for conus_plan_list(): 56
                                bytes and 8 a key each; 0 = of none. */
    const conus_jitter_options *jitter; /**< Errors of the poses, for the probabilities to hold (Eq. 14), of the listed
                                           ones and where p_ok is a key; progress is not used. NULL = none. Copied. */
    uint64_t targets;                   /**< The best pose of each target up to this number is kept, for
                                           conus_plan_list(): 56 bytes and 8 a key each; 0 = of none. */
    const double *shanks; /**< [shank_count][2] Where the parallel needles of a device are beside its axis, along its
                             x and y, mm, up to 1000. Copied. NULL = one, on the axis. */
    size_t shank_count;   /**< With shanks 1 to 1000, else 0. */
} conus_plan_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_PLAN_OPTIONS_INIT CONUS_INIT_(conus_plan_options)

/** The verdict on one constraint for one pose. */
typedef struct conus_verdict {
    bool holds;      /**< Whether it holds. */
    double value;    /**< The measured value: of a clearance the axis's distance (radius not taken off), of LENGTH far
                        - near, of LEAN, ENTRY_ANGLE, ARC and SLIDER the angle, degrees, of APART the distance, of FIRST
                        1 or 0. */
    double slack;    /**< By how much it holds, at least 0, or more than 0 of a clearance or APART; below, it breaks by
                        so much. Of a clearance value - radius - limit. */
    double leeway;   /**< mm by which no point of the axis may move so that it breaks (Eq. 22), 0 where it does; NaN
                        where none is known. */
    double depth;    /**< mm from the apex: of a clearance where the axis is nearest, of a length or FIRST where it
                        enters; else, and where there is none, NaN. */
    uint32_t object; /**< The nearest object of a clearance, the first one of FIRST; else, and without one, 0. */
    uint32_t shank;  /**< Number of the shank that all but the leeway is of, from 1: the one with the largest slack
                        where any shank will do, the least where all have to hold; of equal ones the first. The leeway
                        is the largest or the least of all theirs. */
    double p;        /**< Probability that it holds under jitter (Eq. 14); NaN without it, and of a miss. */
} conus_verdict;

/** A pose of the list. */
typedef struct conus_planned {
    const char *id;                /**< As of conus_pose_row. */
    uint64_t candidate;            /**< Number of its row in the stream, from 1. */
    uint64_t rank;                 /**< From 1; 0 where it is infeasible. */
    bool feasible;                 /**< All constraints hold. */
    size_t broken;                 /**< Index of the first constraint that does not hold; SIZE_MAX = none. */
    conus_pose pose;               /**< Apex and axis. */
    double near;                   /**< Where the needle begins, mm from the apex. */
    double far;                    /**< Where it ends. */
    double angle;                  /**< Opening of its cone, degrees; 0 of a cylinder. */
    double leeway;                 /**< The least of the verdicts' (Eq. 22), mm; NaN where none is known. */
    size_t leeway_of;              /**< Index of that constraint; SIZE_MAX where there is none. */
    double slack;                  /**< The least of the clearances' slacks, mm; NaN without one. */
    double clearance;              /**< The least clearance, radius taken off, mm; NaN without one. */
    size_t clearance_of;           /**< Index of the constraint that has it; SIZE_MAX where there is none. */
    double score;                  /**< By the formula; NaN without one. */
    const conus_verdict *verdicts; /**< [constraints] Of each constraint. */
    uint64_t entry;                /**< As of conus_pose_row, 0 = none. */
    uint64_t target;               /**< As of conus_pose_row, 0 = none. */
    double entry_angle;            /**< Between the axis and the inward normal at the entry, degrees; NaN without it. */
    double normal[3];              /**< Outward at its entry, as conus_pose_row has it. */
    double p_ok;    /**< Probability that all constraints hold under jitter (Eq. 14); NaN without it, and of a miss. */
    bool has_angle; /**< The opening is the row's own. */
} conus_planned;

/** Rows that were no candidates. */
typedef struct conus_plan_faults {
    uint64_t count;  /**< How many: no pose, a point without direction, no far end, or one before the near end. */
    size_t line;     /**< Line of the first in its file; 0 = there is none. */
    const char *why; /**< Why that row is no pose; "" = there is no such row. Borrowed from the plan. */
} conus_plan_faults;

/** Prepares to try poses.
 * @param[out] out The plan; end it with conus_plan_destroy().
 * @param selector Must outlive the plan. Its range holds where a pose has none of its own, its radius is the needle's.
 * A structure has all that is below it, whatever its level; a measure of a cone needs one that reports nothing else
 * with it, and behind #CONUS_MEASURE_SHARE #CONUS_LAYERS_ALL.
 * @param constraints [count] An array of structs of the size that its first one's struct_size says. Copied.
 * @param count At least 1.
 * @param options NULL = defaults. Its strings are copied.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a name that is unknown or means several, with the closest one in the
 * message, a structure without a shape, one both reached and avoided, a constraint given twice, a number out of its
 * range, a measure that the kind or the selector does not have, and an unknown key. */
CONUS_CHECKED conus_status conus_plan_create(conus_plan **out, conus_selector *selector,
                                             const conus_constraint *constraints, size_t count,
                                             const conus_plan_options *options);

/** Ends a plan.
 * @param plan NULL is allowed. */
CONUS_API void conus_plan_destroy(conus_plan *plan);

/** Tries poses. The list is the same for any number of threads, and with or without pruning.
 * @param plan Not run before.
 * @param poses The stream. A row that is no candidate is counted, see conus_plan_rejected().
 * @param limit Rows to read at most.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a plan that was run; #CONUS_ERROR_CANCELLED; the errors of
 * conus_pose_stream_read() and conus_select().
 * @threads One at a time for each @p plan and @p poses, and for the selector. */
CONUS_CHECKED conus_status conus_plan_run(conus_plan *plan, conus_pose_stream *poses, uint64_t limit);

/** Tries one pose, at once and all by itself: before a run, after it, or without one. The list does not change.
 * @param[out] out All that the list would say of it, also where it breaks constraints; candidate and rank are 0.
 * Borrowed from the plan until the next call.
 * @param plan The plan.
 * @param row The pose, with the id, range and opening that a row of a stream would have; NaN and 0 as there.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a row that would be no candidate, and a pose that is not rigid; the
 * errors of conus_select().
 * @threads One at a time for each @p plan, and for the selector; not during conus_plan_run(). */
CONUS_CHECKED conus_status conus_plan_try(const conus_planned **out, conus_plan *plan, const conus_pose_row *row);

/** Counts the poses of the list: feasible ones by rank, then perhaps others.
 * @param plan NULL counts 0.
 * @return How many there are; 0 before conus_plan_run(). */
CONUS_API size_t conus_plan_count(const conus_plan *plan);

/** Gives pose @p index of the list.
 * @param plan The plan.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the plan. */
CONUS_API const conus_planned *conus_plan_pose(const conus_plan *plan, size_t index);

/** Lists what a plan found besides its poses.
 * @param[out] out The columns below; end it with conus_table_destroy().
 * @param plan The plan.
 * @param what "constraints", in their order: kind, name (of its structure), asked ("at least 5 mm of the axis in
 * Hippocampus_L"), left (how many candidates hold it and all before it), miss (id of the candidate that breaks it
 * alone, by the least; of equal ones the first; n/a where there is none, and where some candidate is feasible).
 * "entries", of which there are as many as conus_plan_options.entries: feasible (how many of its poses break no
 * constraint), candidate (number of the best of these by the rank; 0 = there is none, and all that follows is n/a),
 * leeway_mm, slack_mm, depth_mm, entry_angle_deg, reach1 (value of the first REACH; n/a without one), also where that
 * pose is not in the list; the same for any number of threads, and with or without pruning. "targets": of each target
 * these columns.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another word or NULL, and of entries and targets before
 * conus_plan_run(). */
CONUS_CHECKED conus_status conus_plan_list(conus_table **out, const conus_plan *plan, const char *what);

/** Counts the candidates that hold the first constraints: the funnel.
 * @param plan The plan.
 * @param constraints So many constraints, the first ones; 0 counts all candidates, all of them the feasible ones.
 * @return How many candidates hold them. */
CONUS_API uint64_t conus_plan_left(const conus_plan *plan, size_t constraints);

/** Says which rows were no candidates.
 * @param plan The plan.
 * @return Their number, and the first. */
CONUS_API conus_plan_faults conus_plan_rejected(const conus_plan *plan);
/** @} */

/** Pivot and directions of the turns and shifts. */
typedef struct conus_tolerance_options {
    size_t struct_size;  /**< Its size, as #CONUS_TOLERANCE_OPTIONS_INIT sets it; 0 = that of this version. */
    double pivot;        /**< Depth of the point about which the needle turns, mm; 0 = the device's position. */
    bool pivot_at_tip;   /**< It turns about the far end. */
    double shifts[3][3]; /**< World directions of x, y and z, of any length but 0; all 0 = the world's. */
    double up[3];        /**< World direction about and towards which azimuth and elevation turn, of any length but 0;
                            all 0 = the world's z. */
} conus_tolerance_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_TOLERANCE_OPTIONS_INIT CONUS_INIT_(conus_tolerance_options)

typedef struct conus_sites conus_sites; /**< Points where needles may enter, or to which they may point. */

/** @name Sites
 * @{ */

/** Makes sites of points.
 * @param[out] out The sites; end them with conus_sites_destroy().
 * @param points [count][3] World mm. Copied.
 * @param count May be 0.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a point that is not finite. */
CONUS_CHECKED conus_status conus_sites_create(conus_sites **out, const double *points, size_t count);

/** Makes sites of the vertices of a surface, in the order of the file, with normals: the mean of the triangles around a
 * vertex, weighted by their areas, those at its other numbers too. Of a closed surface they point outwards, by its
 * signed volume; else as its triangles are wound, with a note. Vertices without a triangle, and those whose normals
 * cancel out, are left out.
 * @param[out] out The sites; end them with conus_sites_destroy().
 * @param path A surface in any format that conus_atlas_load() reads.
 * @param flip Normals point to the other side.
 * @return #CONUS_OK; the errors of conus_atlas_load() about surfaces. */
CONUS_CHECKED conus_status conus_sites_load(conus_sites **out, const char *path, bool flip);

/** Makes sites of the centres of the voxels of a region that have one of another kind, or the edge of the grid, at one
 * of their six faces; in the order of the file.
 * @param[out] out The sites; end them with conus_sites_destroy().
 * @param roi The region.
 * @return #CONUS_OK; #CONUS_ERROR_MEMORY. */
CONUS_CHECKED conus_status conus_sites_of_roi(conus_sites **out, const conus_roi *roi);

/** Which points of a structure are sites. */
typedef enum conus_sites_kind {
    CONUS_SITES_CENTROID = 0, /**< The mean position of its voxels and the insides of its closed surfaces, weighted by
                                 volume. A note says where it is not in the structure. */
    CONUS_SITES_DEEPEST,      /**< The centre of the voxel that is farthest from all voxels around the structure, by
                                 their centres, also those beyond the grid; of a closed surface the point inside, on a
                                 grid of 1 mm (or less, where none is inside), that is farthest from it. Of points that
                                 are equal to 1e-9 mm the nearest to the centroid, then the first. A structure that
                                 lies on both sides and says none is refused, as by conus_place_find(). */
    CONUS_SITES_VOXELS        /**< The centres of its voxels, in the order of the file. */
} conus_sites_kind;

/** Finds points of a structure.
 * @param[out] out The sites; end them with conus_sites_destroy().
 * @param selector Of the atlas; its options do not matter.
 * @param names The structure, as conus_constraint.names; but for voxels with all that is hidden in it.
 * @param kind Which points.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a name that is unknown or means several, with close ones in the message,
 * and a structure without voxels, or, but for voxels, without these and a closed surface. */
CONUS_CHECKED conus_status conus_sites_find(conus_sites **out, const conus_selector *selector, const char *names,
                                            conus_sites_kind kind);

/** Keeps the sites that are in a structure, or those that are not.
 * @param sites The sites; unchanged on failure.
 * @param selector As for conus_sites_find().
 * @param names The structure: voxels and closed surfaces have an inside.
 * @param inside Whether those in it are kept.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT as of conus_sites_find(). */
CONUS_CHECKED conus_status conus_sites_keep_named(conus_sites *sites, const conus_selector *selector, const char *names,
                                                  bool inside);

/** Keeps the sites that are in the voxels of a region, or those that are not.
 * @param sites The sites.
 * @param roi The region, in their space.
 * @param inside Whether those in it are kept. */
CONUS_API void conus_sites_keep_roi(conus_sites *sites, const conus_roi *roi, bool inside);

/** Keeps the vertices that have a label, or those that have none.
 * @param sites Of conus_sites_load(); unchanged on failure.
 * @param path Labels of its vertices, as conus_load_options.labels of a surface; label 0 is none.
 * @param labelled Whether those with a label are kept.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for sites of no surface; #CONUS_ERROR_DATA for labels of another number of
 * vertices; the errors of conus_atlas_load() about labels. */
CONUS_CHECKED conus_status conus_sites_keep_labelled(conus_sites *sites, const char *path, bool labelled);

/** Thins sites out: in their order, one is kept unless a kept one is nearer than @p spacing.
 * @param sites The sites; unchanged on failure.
 * @param spacing mm, from 0.001 on.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a spacing out of its range. */
CONUS_CHECKED conus_status conus_sites_space(conus_sites *sites, double spacing);

/** Counts sites.
 * @param sites NULL counts 0.
 * @return How many there are. */
CONUS_API size_t conus_sites_count(const conus_sites *sites);

/** Gives the points.
 * @param sites The sites.
 * @return [count][3] World mm. Borrowed from the sites, until they are thinned out. */
CONUS_API const double *conus_sites_points(const conus_sites *sites);

/** Gives the normals.
 * @param sites The sites.
 * @return [count][3] Of length 1; NULL but of a surface. Borrowed from the sites, until they are thinned out. */
CONUS_API const double *conus_sites_normals(const conus_sites *sites);

/** Gives the number that site @p index has where it comes from.
 * @param sites The sites.
 * @param index From 0.
 * @return From 0: of a vertex in its file, of a voxel in its volume, x fastest, of a point in the array; 0 of a
 * centroid; UINT64_MAX past the last. */
CONUS_API uint64_t conus_sites_source(const conus_sites *sites, size_t index);

/** Ends sites.
 * @param sites NULL is allowed. */
CONUS_API void conus_sites_destroy(conus_sites *sites);
/** @} */

/** The most candidates that a stream has, 2^40. */
#define CONUS_CANDIDATE_LIMIT (UINT64_C(1) << 40)

/** Where needles enter, where they point, and how far they are tilted. */
typedef struct conus_candidates {
    size_t struct_size;    /**< Its size, as #CONUS_CANDIDATES_INIT sets it; 0 = that of this version. */
    const double *entries; /**< [entry_count][3] Where the device is, world mm. NULL with angles. */
    const double *normals; /**< [entry_count][3] Outward at each entry, of any length but 0; NaN where there is none.
                              NULL = there are none. */
    size_t entry_count;    /**< At least 1. */
    const double *targets; /**< [target_count][3] To which it points, world mm. NULL = against the entry's normal. */
    size_t target_count;   /**< At least 1 with targets, else 0. */
    double tilt_most;      /**< Up to which angle each direction is tilted, 0 to 90 degrees; 0 = it is not. */
    double tilt_step;      /**< Angle between one ring of tilted directions and the next, and within a ring at most,
                              from 0.01 degrees to tilt_most. */
    bool to_target;        /**< Rows have a far end: the target's distance from the entry plus @p beyond. */
    double beyond;         /**< mm; below 0 it ends before the target. */
    double roll_step;      /**< Each is also turned about its axis: ceil(360 / roll_step) times, equally; from 0.01 to
                              180 degrees; 0 = not turned. */
    const conus_frame *frame;        /**< Needles are turned about their axes as its space has it, as by
                                        conus_frame_turn_pose(); copied. NULL = #CONUS_SPACE_RAS. */
    const char *const *entry_names;  /**< [entry_count] What the entries are called in ids, in place of eI, up to 64
                                        bytes each, all different; NULL = they have no names. Only entries
                                        or only targets have names with a "-", which ids have between them. */
    const char *const *target_names; /**< [target_count] What the targets are called in ids, in place of tJ, as
                                        entry_names; NULL = they have no names. */
    const double *angles; /**< [entry_count][2] In place of entries: arc and slider angle of a rig, degrees, in the axes
                             of @p frame (Eq. 26). The device is @p back from each target on that way out. */
    double back;          /**< mm, above 0 up to 500. */
} conus_candidates;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_CANDIDATES_INIT CONUS_INIT_(conus_candidates)

/** Makes a stream of all candidates, in the order of entries, of one entry in that of targets, of these two in that of
 * tilts: the direction itself, then rings at tilt_step, 2 tilt_step and so on up to tilt_most; a ring at the angle t
 * has ceil(360 sin(t) / tilt_step) directions, from the device's +y on towards its +x (Eq. 2); of one tilt in that of
 * turns, which move the device's +y towards its +x. No memory grows with their number. A row's id is "eI-tJ-kK-rR" with
 * the numbers or names of entry, target, tilt and turn, from 1, without those that can only be 1; its line is its own
 * number. An entry that is the target itself is a row with an error.
 * @param[out] out The stream; end it with conus_pose_stream_destroy(). Its format is "table".
 * @param candidates Its arrays must outlive the stream.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for no entry or target, for one that is not finite, for a normal without
 * length, for none where they are needed, for tilts and turns out of their range, for a far end at targets that there
 * are not, and for more candidates than #CONUS_CANDIDATE_LIMIT. */
CONUS_CHECKED conus_status conus_candidates_open(conus_pose_stream **out, const conus_candidates *candidates);

/** @name Needles planned together
 * One candidate of each needle, so that no two come too near, and a proof that no combination is better (Eq. 25 to 28).
 * @{ */

typedef struct conus_together conus_together; /**< Needles that were planned together. */

/** A part that rides on a needle, outside of the head, too: a bolt, a holder. It is a capsule along the axis, or a ball
 * (Eq. 25). All numbers are mm, up to 1000. */
typedef struct conus_part {
    double radius; /**< 0 or more; with one point more than 0. */
    double low;    /**< From where it is, outwards along the axis, */
    double high;   /**< up to where; not below @p low. */
    double x;      /**< Beside the axis, along the device's x, */
    double y;      /**< and y. */
    bool from_tip; /**< @p low and @p high count from the far end, else from the device's position. */
} conus_part;

/** A question, and the needles that may answer it. */
typedef struct conus_question {
    size_t struct_size;       /**< Its size, as #CONUS_QUESTION_INIT sets it; 0 = that of this version. */
    const char *needles;      /**< A name, or several between commas. Needles are in the order of their first naming. A
                                 needle of several questions answers any of them; needles of the same ones are alike. */
    bool once;                /**< At most one needle answers it. */
    conus_selector *selector; /**< As for conus_plan_create(); its radius is the needle's. Questions may share one. */
    const conus_constraint *constraints; /**< [constraint_count] As for conus_plan_create(). */
    size_t constraint_count;             /**< At least 1. */
    const conus_plan_options
        *options; /**< threads, angle, far and shanks (up to 64); all else is 0. NULL = defaults. */
    conus_status (*open)(conus_pose_stream **out, void *user); /**< Opens the candidates, each time the same ones: they
                                                                  are read several times. NULL where all are given. */
    void (*close)(conus_pose_stream *stream, void *user);      /**< Ends what @p open opened, once it was read. NULL =
                                                                  conus_pose_stream_destroy(). */
    void *user;                                                /**< Passed to both. */
    const conus_part *parts;                                   /**< [part_count] */
    size_t part_count;                                         /**< Up to 64. */
    const char *arc; /**< Needles of questions with the same text share an arc, those of others do not; NULL or "": with
                        any. Has an effect with conus_together_options.arcs alone. */
    conus_contacts contacts; /**< Of each shank, which conus_together_options.covers count; else count is 0. */
} conus_question;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_QUESTION_INIT CONUS_INIT_(conus_question)

/** A structure that contacts of all needles together are to be in (Eq. 27). */
typedef struct conus_cover {
    const char *names; /**< As conus_constraint.names. */
    uint64_t contacts; /**< So many of all shanks of all needles at least; 0 = they are only counted. */
} conus_cover;

/** How far the search for combinations has got. */
typedef struct conus_so_far {
    uint64_t combination; /**< Number of the one that is looked for, from 1; 0 = candidates are judged. */
    double leeway;        /**< Of the best that was found for it; NaN = none was, or it has none. */
    double bound;         /**< None that may stand there has a larger leeway; NaN = that is not known. */
} conus_so_far;

/** What holds for each two needles (Eq. 26), and for all of them. */
typedef struct conus_together_options {
    size_t struct_size;          /**< Its size, as #CONUS_TOGETHER_OPTIONS_INIT sets it; 0 = that of this version. */
    double between;              /**< Shafts stay farther apart than that, mm, 0 to 100; 0 = they do not touch. */
    double parts;                /**< Two bodies of which one or both are parts stay so far apart, mm, 0 to 100. */
    const conus_pose_row *given; /**< [given_count] Poses that are called like needles: each is in its place, and is of
                                    the first question that it answers. */
    size_t given_count;          /**< 0 = all are planned. */
    double entry_distance;       /**< The positions of the devices are so far apart at least, mm, 0 to 100. */
    uint64_t effort;             /**< Nodes of the search; 0 = 100 million, UINT64_MAX = without end. */
    uint64_t top;                /**< So many combinations are listed, 1 to 100; 0 = 1. */
    double diverse;          /**< Each differs from those before it by candidates whose position or far end is so far
                                off at least, mm, 0 to 100; 0 = by other candidates. */
    uint64_t differ;         /**< In so many needles at least, up to all of them; 0 = 1. */
    conus_progress progress; /**< Receives how many candidates were tried; false ends the run. NULL = no callback. */
    void *progress_user;     /**< Passed to @p progress. */
    double arcs;   /**< A rig carries the needles on arcs, whose angles differ by so many degrees at least, up to
                      180 (Eq. 26), in the axes of the selectors' frames, which are the same; 0 = it does not. */
    double slider; /**< Slider angles of needles on one arc differ by so many degrees at least, up to 180; 0 =
                      as @p arcs. */
    double same;   /**< Arc angles of needles on one arc differ by no more, below half of @p arcs; 0 = 0.5 degrees. */
    uint64_t arcs_most;        /**< Up to so many arcs; 0 = any number. */
    uint64_t arcs_each;        /**< Up to so many needles on one arc, likewise. */
    const conus_cover *covers; /**< [cover_count] Each question has contacts then. */
    size_t cover_count;        /**< Up to 16. */
    double pitch;              /**< Of the rig about the right-left axis, degrees: its arc angles are so much larger. */
    conus_so_far *so_far;      /**< Is filled each time before @p progress is called; NULL = it is not. */
} conus_together_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_TOGETHER_OPTIONS_INIT CONUS_INIT_(conus_together_options)

/** Where a needle is in a combination. */
typedef struct conus_chosen {
    const conus_planned *pose; /**< Its place. */
    uint64_t candidate;        /**< Number of that candidate, from 1, of all of the needle's, question by question; 1
                                  of a given needle. */
    size_t question;           /**< Index of the question that it answers. */
    uint64_t contacts;         /**< So many of its contacts are in any of the covers. */
} conus_chosen;

/** A combination (Eq. 27). Lengths are whole nanometres, in mm. */
typedef struct conus_combination {
    const conus_chosen *chosen; /**< [needles] */
    bool feasible;              /**< All needles and pairs hold. Only where all needles are given it may be false. */
    bool proven;                /**< None is better that may stand there, and all before it are proven. */
    bool last;                  /**< It is proven that no other one differs from all that are listed. */
    double leeway;              /**< The least of all needles' and pairs'; NaN where none has one. */
    const char *leeway_of;      /**< The needle that has it, "A", or both of the pair, "A/B"; NULL = none. */
    double bound;               /**< None that may stand there has a larger leeway; NaN where none has one. */
    double sum;                 /**< Of the needles' leeways. */
    double depth;               /**< Sum of the far ends' depths. */
    uint64_t nodes;             /**< Of the search, with those of combinations before it. */
    uint64_t contacts;          /**< So many of all needles are in any of the covers. */
    const uint64_t *covered;    /**< [cover_count] So many are in each of them. */
} conus_combination;

/** A needle of the answer. */
typedef struct conus_placed {
    const char *name;           /**< Its name. */
    const conus_planned *given; /**< Its place, where that was given; NULL = it is planned. */
    const size_t *questions;    /**< [question_count] Indices of those that it may answer. */
    size_t question_count;      /**< At least 1. */
    double largest;             /**< The largest leeway of its candidates, mm; NaN without one. */
    double cut; /**< Candidates with less are in no combination that is as good as the last one that is listed, and in
                   none at all after a conus_combination.last, mm; NaN without one. */
    uint64_t above; /**< So many of its candidates are not below the cut; of lists that are not known whole, of those
                       that are known. */
} conus_placed;

/** Why there is no combination: the smallest set of needles that has none; of these the first (Eq. 28). */
typedef struct conus_conflict {
    const size_t *needles; /**< [count] */
    size_t count;          /**< 0: it is not known which. */
    double between; /**< mm: each margin of shafts below this has a combination of them, all else being as it is; NaN
                       where none has, and where that is not known. */
    double entry_distance; /**< mm: each distance of entries below this has a combination of them; NaN as of between. */
    bool by_limits;        /**< Only the limits of all needles together, arcs and covers, are in the way. Then: */
    uint64_t arcs_most;    /**< so many arcs are needed at least, all else being as it is; 0 where no number does, and
                              where that is not known, */
    uint64_t arcs_each;    /**< and so many needles on one arc, at least; */
    const double *contacts; /**< [cover_count] so many contacts can be had in each cover, likewise; NaN where no
                               number would do, where that is not known, and of a cover that asks for none. */
} conus_conflict;

/** Plans needles together: has the candidates of each listed, finds the best combinations, and proves them.
 * @param[out] out The answer; end it with conus_together_destroy().
 * @param questions [count] An array of structs of the size that its first one's struct_size says. Selectors must
 * outlive the answer.
 * @param count 1 to 64, of 1 to 16 needles.
 * @param options NULL = defaults.
 * @return #CONUS_OK, also where there is no combination; #CONUS_ERROR_ARGUMENT for a number out of its range, a needle
 * that is named twice in a question, and a given one that is none; #CONUS_ERROR_CANCELLED where a run ended before a
 * combination was found; after that the answer is the best one so far, which is not proven; the errors of
 * conus_plan_create(), conus_plan_run() and conus_plan_try(). */
CONUS_CHECKED conus_status conus_plan_together(conus_together **out, const conus_question *questions, size_t count,
                                               const conus_together_options *options);

/** Ends an answer.
 * @param together NULL is allowed. */
CONUS_API void conus_together_destroy(conus_together *together);

/** Gives a combination, the best one first.
 * @param together The answer.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the answer. */
CONUS_API const conus_combination *conus_together_combination(const conus_together *together, size_t index);

/** Gives a needle.
 * @param together The answer.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the answer. */
CONUS_API const conus_placed *conus_together_needle(const conus_together *together, size_t index);

/** Says why there is no combination.
 * @param together The answer.
 * @return NULL where there is one that is feasible, and where it is not known whether there is. Borrowed from the
 * answer. */
CONUS_API const conus_conflict *conus_together_conflict(const conus_together *together);
/** @} */

#ifdef __cplusplus
}
#endif

#endif
