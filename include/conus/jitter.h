/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file jitter.h
 * The certainty of an answer when the pose has errors (Eq. 14).
 */
#ifndef CONUS_PUBLIC_JITTER_H
#define CONUS_PUBLIC_JITTER_H

#include <conus/selection.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_jitter conus_jitter; /**< An answer under errors of the pose. */

/** How far off a pose may be: independent normal errors (Eq. 14). */
typedef struct conus_jitter_options {
    size_t struct_size; /**< Its size, as #CONUS_JITTER_OPTIONS_INIT sets it; 0 = that of this version. */
    double
        tilt; /**< Standard deviation of the axis's tilt about the device's x, and about its y; radians, 0 to pi/2. */
    double shift;            /**< Standard deviation of the position along each of its axes, mm, 0 to 1e6. */
    uint32_t samples;        /**< Poses to trace from, a power of two from 16 to 2^20; 0 = 1024. */
    conus_progress progress; /**< Hears of each pose that was traced from; false ends it. NULL = no callback. */
    void *progress_user;     /**< Passed to @p progress. */
    double entry;  /**< In place of tilt and shift, of a needle (conus_plan_options): standard deviation of the device's
                      position along each of its x and y, mm, 0 to 1e6; */
    double target; /**< that of the far end, likewise; */
    double depth;  /**< and that of the needle's depth, mm. */
} conus_jitter_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_JITTER_OPTIONS_INIT CONUS_INIT_(conus_jitter_options)

/** The chances of one object. */
typedef struct conus_chance {
    conus_kind kind; /**< Its kind. */
    uint32_t object; /**< Number in the atlas; 0 for #CONUS_KIND_UNASSIGNED. */
    uint32_t rank;   /**< From 1, by hit; 0 for #CONUS_KIND_UNASSIGNED. */
    double hit; /**< Probability that it is the answer: the object that the selector ranks best among those that pixels
                   hit first; #CONUS_KIND_UNASSIGNED where no pixel hits any. They sum to 1. */
    double hit_error;       /**< Standard error of that number, from 16 independent sets of samples. */
    double seen;            /**< Probability that some pixel hits it first. */
    double in_cone;         /**< Probability that it is in the cone at all, a bundle with one of its streamlines (Eq.
                               19); NaN without #CONUS_LAYERS_ALL. */
    double share;           /**< Mean share (Eq. 4); they sum to 1. */
    double share_deviation; /**< Standard deviation of the share from sample to sample. */
} conus_chance;

/**
 * Traces from poses around @p pose as its errors make them. They are always the same ones: low-discrepancy samples
 * without a random seed.
 * @param[out] out The chances; end them with conus_jitter_destroy().
 * @param selector The selector.
 * @param pose Apex and axis without errors.
 * @param angle As for conus_select().
 * @param options The errors; must be given.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an option out of its range; #CONUS_ERROR_CANCELLED; the errors of
 * conus_select().
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_jitter_create(conus_jitter **out, conus_selector *selector, const conus_pose *pose,
                                               double angle, const conus_jitter_options *options);

/**
 * Ends the chances.
 * @param jitter NULL is allowed.
 * @threads One at a time for each @p jitter.
 * @since 0.1
 */
CONUS_API void conus_jitter_destroy(conus_jitter *jitter);

/**
 * Counts the chances. They are ordered by rank, with that of unassigned last.
 * @param jitter NULL counts 0.
 * @return How many chances there are.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_jitter_count(const conus_jitter *jitter);

/**
 * Gives chance @p index.
 * @param jitter The chances.
 * @param index From 0.
 * @return NULL past the last. Borrowed from @p jitter.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_chance *conus_jitter_chance(const conus_jitter *jitter, size_t index);

#ifdef __cplusplus
}
#endif

#endif
