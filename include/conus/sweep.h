/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file sweep.h
 * At which opening a growing cone admits each object (Eq. 13).
 */
#ifndef CONUS_PUBLIC_SWEEP_H
#define CONUS_PUBLIC_SWEEP_H

#include <conus/selection.h>
#include <conus/table.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Finds when a cone that grows admits each object, in the order of the angles. Occluded objects count; the selector's
 * range and level hold. Of voxels their centres count, of a mesh all its surface, and its inside where closed, of
 * streamlines all points of their lines, without a radius.
 * @param[out] out The columns of `conus sweep` (docs/formats.md) but query; end it with conus_table_destroy().
 * @param selector The selector.
 * @param pose Apex and axis.
 * @param widest Full opening to grow to, radians, in (0, pi).
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another opening, and for a selector with a square aperture or a radius.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_sweep(conus_table **out, const conus_selector *selector, const conus_pose *pose,
                                       double widest);

#ifdef __cplusplus
}
#endif

#endif
