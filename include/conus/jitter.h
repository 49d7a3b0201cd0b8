/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file jitter.h
 * The certainty of an answer when the pose has errors (Eq. 14).
 */
#ifndef CONUS_PUBLIC_JITTER_H
#define CONUS_PUBLIC_JITTER_H

#include <conus/selection.h>
#include <conus/table.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

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

/**
 * Traces from poses around @p pose as its errors make them. They are always the same ones: low-discrepancy samples
 * without a random seed.
 * @param[out] out The columns of `conus sweep --jitter` (docs/formats.md) but query, the most probable object first,
 * what is unassigned last; end it with conus_table_destroy(). The answer of a pose (p_hit) is the object that the
 * selector ranks best among those that pixels hit first.
 * @param selector The selector.
 * @param pose Apex and axis without errors.
 * @param angle As for conus_select().
 * @param options The errors; must be given.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an option out of its range; #CONUS_ERROR_CANCELLED; the errors of
 * conus_select().
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_jitter(conus_table **out, conus_selector *selector, const conus_pose *pose,
                                        double angle, const conus_jitter_options *options);

#ifdef __cplusplus
}
#endif

#endif
