/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file candidates.h
 * Poses from entries and targets, for a plan to try (Eq. 22).
 */
#ifndef CONUS_PUBLIC_CANDIDATES_H
#define CONUS_PUBLIC_CANDIDATES_H

#include <conus/pose_file.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The most candidates that a stream has, 2^40. */
#define CONUS_CANDIDATE_LIMIT (UINT64_C(1) << 40)

/** Where needles enter, where they point, and how far they are tilted. */
typedef struct conus_candidates {
    size_t struct_size;    /**< Its size, as #CONUS_CANDIDATES_INIT sets it; 0 = that of this version. */
    const double *entries; /**< [entry_count][3] Where the device is, world mm. */
    const double *normals; /**< [entry_count][3] Outward at each entry, of any length but 0; NaN where there is none.
                              NULL = there are none. */
    size_t entry_count;    /**< At least 1. */
    const double *targets; /**< [target_count][3] To which it points, world mm. NULL = against the entry's normal. */
    size_t target_count;   /**< At least 1 with targets, else 0. */
    double tilt_most;      /**< Up to which angle each direction is tilted, 0 to pi/2 radians; 0 = it is not. */
    double tilt_step;      /**< Angle between one ring of tilted directions and the next, and within a ring at most,
                              from pi/18000 radians (0.01 degrees) to tilt_most. */
    bool to_target;        /**< Rows have a far end: the target's distance from the entry plus @p beyond. */
    double beyond;         /**< mm; below 0 it ends before the target. */
} conus_candidates;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_CANDIDATES_INIT CONUS_INIT_(conus_candidates)

/**
 * Makes a stream of all candidates, in the order of entries, of one entry in that of targets, of these two in that of
 * tilts: the direction itself, then rings at tilt_step, 2 tilt_step and so on up to tilt_most; a ring at the angle t
 * has ceil(2 pi sin(t) / tilt_step) directions, from the device's +y on towards its +x (Eq. 2). No memory grows with
 * their number. A row's id is "eI-tJ-kK" with the numbers of entry, target and tilt, from 1, without those of which
 * there is one; its line is its own number. An entry that is the target itself is a row with an error.
 * @param[out] out The stream; end it with conus_pose_stream_destroy(). Its format is #CONUS_POSE_FORMAT_TABLE.
 * @param candidates Its arrays must outlive the stream.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for no entry or target, for one that is not finite, for a normal without
 * length, for none where they are needed, for tilts out of their range, for a far end at targets that there are not,
 * and for more candidates than #CONUS_CANDIDATE_LIMIT.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_candidates_open(conus_pose_stream **out, const conus_candidates *candidates);

#ifdef __cplusplus
}
#endif

#endif
