/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file plan_together.h
 * Several needles together: one candidate of each, so that no two come too near, and a proof that no combination is
 * better (Eq. 25 to 28).
 */
#ifndef CONUS_PUBLIC_PLAN_TOGETHER_H
#define CONUS_PUBLIC_PLAN_TOGETHER_H

#include <conus/plan.h>
#include <conus/table.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

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

/** A needle, and the question that its candidates answer. */
typedef struct conus_needle {
    size_t struct_size;       /**< Its size, as #CONUS_NEEDLE_INIT sets it; 0 = that of this version. */
    const char *name;         /**< Of no other needle. Copied. */
    conus_selector *selector; /**< As for conus_plan_create(); its radius is the needle's. Needles may share one. */
    const conus_constraint *constraints; /**< [constraint_count] As for conus_plan_create(). */
    size_t constraint_count;             /**< At least 1. */
    const conus_plan_options
        *options; /**< threads, angle, far and shanks (up to 64); all else is 0. NULL = defaults. */
    conus_status (*open)(conus_pose_stream **out, void *user); /**< Opens the candidates, each time the same ones: they
                                                                  are read several times. Not of a given needle. */
    void *user;                                                /**< Passed to @p open. */
    const conus_part *parts;                                   /**< [part_count] */
    size_t part_count;                                         /**< Up to 64. */
    const conus_pose_row *given; /**< The needle is in its place already: its only candidate. NULL = it is planned. */
} conus_needle;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_NEEDLE_INIT CONUS_INIT_(conus_needle)

/** What holds for each two needles (Eq. 26). */
typedef struct conus_together_options {
    size_t struct_size;      /**< Its size, as #CONUS_TOGETHER_OPTIONS_INIT sets it; 0 = that of this version. */
    double between;          /**< Shafts stay farther apart than that, mm, 0 to 100; 0 = they do not touch. */
    double parts;            /**< Likewise two bodies of which one or both are parts. */
    double entry_distance;   /**< The positions of the devices are so far apart at least, mm, 0 to 100. */
    uint64_t effort;         /**< Nodes of the search; 0 = 100 million, UINT64_MAX = without end. */
    conus_progress progress; /**< Is told how many candidates were tried; false ends the run. NULL = no callback. */
    void *progress_user;     /**< Passed to @p progress. */
} conus_together_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_TOGETHER_OPTIONS_INIT CONUS_INIT_(conus_together_options)

/** A combination (Eq. 27). Lengths are whole nanometres, in mm. */
typedef struct conus_combination {
    bool feasible;       /**< All needles and pairs hold. Only where all needles are given it may be false. */
    bool proven;         /**< No combination is better. */
    double leeway;       /**< The least of all needles' and pairs'; NaN where none has one. */
    size_t leeway_of[2]; /**< The needle that has it, or both of the pair; SIZE_MAX = none. */
    double bound;        /**< No combination has a larger leeway; NaN where none has one. */
    double sum;          /**< Of the needles' leeways. */
    double depth;        /**< Sum of the far ends' depths. */
    uint64_t nodes;      /**< Of the search. */
} conus_combination;

/** A needle of the answer. */
typedef struct conus_placed {
    const char *name;          /**< Its name. */
    bool given;                /**< It was given. */
    const conus_plan *plan;    /**< Its constraints, and its candidates (conus_plan_left()); a given one has none. */
    const conus_planned *pose; /**< Its place in the combination; NULL without one. */
    uint64_t candidate;        /**< Number of that candidate, from 1; 1 of a given one. */
    double radius;             /**< Of its shafts, mm. */
    const double *shanks;      /**< [shank_count][2] As of conus_plan_options, also of one on the axis. */
    size_t shank_count;        /**< At least 1. */
    const conus_part *parts;   /**< [part_count] */
    size_t part_count;         /**< How many there are. */
    double largest;            /**< The largest leeway of its candidates, mm; NaN without one. */
    double cut;                /**< Candidates with less are in no combination that is as good, mm; NaN likewise. */
} conus_placed;

/** Why there is no combination: the smallest set of needles that has none; of these the first (Eq. 28). */
typedef struct conus_conflict {
    const size_t *needles; /**< [count] */
    size_t count;          /**< 0: it is not known which. */
    double between; /**< mm: each margin of shafts below this has a combination of them, all else being as it is; NaN
                       where none has, and where that is not known. */
    double entry_distance; /**< mm: this distance of entries has one, likewise. */
} conus_conflict;

/**
 * Plans needles together: has the candidates of each listed, finds the best combination, and proves it.
 * @param[out] out The answer; end it with conus_together_destroy().
 * @param needles [count] An array of structs of the size that its first one's struct_size says. Selectors must outlive
 * the answer.
 * @param count 1 to 16.
 * @param options NULL = defaults.
 * @return #CONUS_OK, also where there is no combination; #CONUS_ERROR_ARGUMENT for a number out of its range and two
 * needles of one name; #CONUS_ERROR_CANCELLED where a run ended before a combination was found; after that the answer
 * is the best one so far, which is not proven; the errors of conus_plan_create(), conus_plan_run() and
 * conus_plan_try().
 * @threads One at a time for each selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_plan_together(conus_together **out, const conus_needle *needles, size_t count,
                                               const conus_together_options *options);

/**
 * Ends an answer.
 * @param together NULL is allowed.
 * @threads One at a time for each @p together.
 * @since 0.1
 */
CONUS_API void conus_together_destroy(conus_together *together);

/**
 * Gives the best combination.
 * @param together The answer.
 * @return NULL where there is none. Borrowed from the answer.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_combination *conus_together_combination(const conus_together *together);

/**
 * Gives the options of the answer.
 * @param together The answer.
 * @return With the defaults filled in. Borrowed from the answer.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_together_options *conus_together_asked(const conus_together *together);

/**
 * Counts the needles.
 * @param together NULL counts 0.
 * @return How many there are.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_together_count(const conus_together *together);

/**
 * Gives a needle.
 * @param together The answer.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the answer.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_placed *conus_together_needle(const conus_together *together, size_t index);

/**
 * Says why there is no combination.
 * @param together The answer.
 * @return NULL where there is one that is feasible, and where it is not known whether there is. Borrowed from the
 * answer.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_conflict *conus_together_conflict(const conus_together *together);

/**
 * Makes a table of all pairs of the combination: how near the needles come to each other, and where.
 * @param[out] out A row for each two needles: combination, needle, other, slack_mm, leeway_mm, distance_mm, body,
 * other_body, x, y, z, other_x, other_y, other_z, entry_distance_mm; without a combination no row. End it with
 * conus_table_destroy().
 * @param together The answer.
 * @return #CONUS_OK; only #CONUS_ERROR_MEMORY is expected.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_together_pairs(conus_table **out, const conus_together *together);

#ifdef __cplusplus
}
#endif

#endif
