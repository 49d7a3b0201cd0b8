/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file pose_check.h
 * Counts poses that look as if they came from another space or unit.
 */
#ifndef CONUS_PUBLIC_POSE_CHECK_H
#define CONUS_PUBLIC_POSE_CHECK_H

#include <conus/selection.h>

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_pose_check conus_pose_check; /**< Where poses are, and whether they point at the atlas. */

/** Poses of one kind. */
typedef struct conus_pose_finding {
    uint64_t count;  /**< How many. */
    uint64_t first;  /**< The lowest number among them; the other members are of that one. */
    uint32_t object; /**< The object that it is inside of, else 0. */
    conus_pose pose; /**< Where it is and points. */
    double angle;    /**< Its full opening, radians. */
} conus_pose_finding;

/** Findings about poses that seem to come from another space or unit. */
typedef struct conus_pose_findings {
    uint64_t poses;            /**< Poses counted. */
    conus_pose_finding inside; /**< A cone's apex is in a voxel of an area or pathway, or, with exact sampling, inside a
                            closed surface; of several such surfaces the object is the smallest. */
    conus_pose_finding away;   /**< The cone or cylinder misses the box around all objects. */
    conus_pose_finding tiny;   /**< Within 1 mm of 0 in every coordinate, and not at 0. */
    uint64_t points;           /**< Points counted. */
    conus_pose_finding far;    /**< A point is farther from that box than a quarter of its longest edge; likewise. */
    conus_pose_finding apart; /**< The ball around a point misses the box around all objects; the pose is not turned. */
} conus_pose_findings;

/** In what other way the first of some odd poses may have been meant. */
typedef struct conus_pose_suggestion {
    uint32_t object; /**< The object hit first in that case, from outside of it; 0 = there is no such way. */
    bool of_tiny; /**< It is about conus_pose_findings.tiny, and the other findings about that pose mean nothing. Else
                     it is about conus_pose_findings.away. */
    const char *words; /**< "with x and y negated (LPS for RAS)", text of the library; NULL if object is 0. */
    conus_pose pose;   /**< The pose, so read. */
} conus_pose_suggestion;

/**
 * Starts to count for the atlas, aperture and radius of a selector.
 * @param[out] out The counts; end them with conus_pose_check_destroy().
 * @param selector Must outlive the counts.
 * @return #CONUS_OK; only #CONUS_ERROR_MEMORY is expected.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_check_create(conus_pose_check **out, const conus_selector *selector);

/**
 * Ends the counts.
 * @param check NULL is allowed.
 * @threads One at a time for each @p check.
 * @since 0.1
 */
CONUS_API void conus_pose_check_destroy(conus_pose_check *check);

/**
 * Counts a pose. One that conus_select() refuses is not counted. It compares the apex with boxes, and sends one ray
 * where the apex lies in the box around a closed surface.
 * @param check The counts.
 * @param number The caller's number of the pose.
 * @param pose Apex and axis.
 * @param angle Full opening, radians.
 * @threads One at a time for each @p check.
 * @since 0.1
 */
CONUS_API void conus_pose_check_add(conus_pose_check *check, uint64_t number, const conus_pose *pose, double angle);

/**
 * Counts a point. One that is not finite is not counted.
 * @param check The counts.
 * @param number The caller's number of the point.
 * @param point World mm.
 * @param radius Of the ball around it, mm; 0 of a point without one.
 * @threads One at a time for each @p check.
 * @since 0.1
 */
CONUS_API void conus_pose_check_add_point(conus_pose_check *check, uint64_t number, const double point[3],
                                          double radius);

/**
 * Gives the counts.
 * @param check The counts.
 * @return Borrowed; it changes with conus_pose_check_add().
 * @threads One at a time for each @p check.
 * @since 0.1
 */
CONUS_API const conus_pose_findings *conus_pose_check_found(const conus_pose_check *check);

/**
 * Finds in what other way odd poses may have been meant. It tries the units metres and micrometres, the space LPS and
 * the other end of the device on the first tiny pose, or else the first that points away, and selects with each.
 * @param[out] out The first way by which that pose hits something; object 0 if there is none.
 * @param found Counts of poses.
 * @param selector That for which they were counted.
 * @return #CONUS_OK, also without such a way; only #CONUS_ERROR_MEMORY and errors of the engine are expected.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_check_suggest(conus_pose_suggestion *out, const conus_pose_findings *found,
                                                    conus_selector *selector);

#ifdef __cplusplus
}
#endif

#endif
