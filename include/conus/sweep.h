/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file sweep.h
 * At which opening a growing cone admits each object (Eq. 13).
 */
#ifndef CONUS_PUBLIC_SWEEP_H
#define CONUS_PUBLIC_SWEEP_H

#include <conus/selection.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_sweep conus_sweep; /**< The angles at which a growing cone admits objects. */

/** When a growing cone admits an object (Eq. 13). */
typedef struct conus_admission {
    conus_kind kind; /**< Its kind. */
    uint32_t object; /**< Number in the atlas, as it is reported (level). */
    double angle;  /**< Full opening of the narrowest round cone that holds some of it, radians; 0 if the axis hits it.
                      Of voxels their centres count, of a mesh all its surface, and its inside where closed,
                      of streamlines all points of their lines, without a radius. */
    double margin; /**< Further opening until the next object, radians; NaN if there is none. */
    double point[3]; /**< World position of what is admitted first, mm. */
    double distance; /**< mm from the apex to there. */
    bool is_surface; /**< It is a mesh's; else a voxel's centre, or of a bundle a point of a streamline. */
} conus_admission;

/**
 * Finds when a cone that grows admits each object. Occluded objects count; the selector's range and level hold.
 * @param[out] out The sweep; end it with conus_sweep_destroy().
 * @param selector The selector.
 * @param pose Apex and axis.
 * @param widest Full opening to grow to, radians, in (0, pi).
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another opening, and for a selector with a square aperture or a radius.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_sweep_create(conus_sweep **out, const conus_selector *selector, const conus_pose *pose,
                                              double widest);

/**
 * Ends a sweep.
 * @param sweep NULL is allowed.
 * @threads One at a time for each @p sweep.
 * @since 0.1
 */
CONUS_API void conus_sweep_destroy(conus_sweep *sweep);

/**
 * Counts the admissions. They are ordered by angle.
 * @param sweep NULL counts 0.
 * @return How many admissions there are.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_sweep_count(const conus_sweep *sweep);

/**
 * Gives admission @p index.
 * @param sweep The sweep.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the sweep.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_admission *conus_sweep_admission(const conus_sweep *sweep, size_t index);

#ifdef __cplusplus
}
#endif

#endif
