/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file pose.h
 * The position and orientation of a device: a beam, a probe, a pointing hand, a camera.
 */
#ifndef CONUS_PUBLIC_POSE_H
#define CONUS_PUBLIC_POSE_H

#include <conus/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Rigid position and orientation of a device. It points along its own -z; +y is up (Eq. 2). Left-handed only where
 * conus_frame_turn_pose() made it so. */
typedef struct conus_pose {
    double world_from_device[16]; /**< Column-major; maps device mm to world mm. */
} conus_pose;

/**
 * Makes a device at @p origin that points along @p direction.
 * @param[out] out The pose.
 * @param origin World mm.
 * @param direction Any length but 0.
 * @param up Upwards of the device; NULL = the default of Eq. 2.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a number that is not finite, and for a direction of length 0 or along @p
 * up.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_along(conus_pose *out, const double origin[3], const double direction[3],
                                            const double up[3]);

/**
 * Makes a device at @p origin that points at a point.
 * @param[out] out The pose.
 * @param origin World mm.
 * @param target World mm.
 * @param up As for conus_pose_along().
 * @return #CONUS_OK; as conus_pose_along().
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_toward(conus_pose *out, const double origin[3], const double target[3],
                                             const double up[3]);

/**
 * Makes a pose from a rigid, right-handed matrix. Deviations up to 2e-3 (three decimals in files) are made exact:
 * the axis is kept as given.
 * @param[out] out The pose.
 * @param world_from_device Column-major; maps device mm to world mm.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another matrix.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_from_matrix(conus_pose *out, const double world_from_device[16]);

/**
 * Makes a pose from a position and a quaternion.
 * @param[out] out The pose.
 * @param origin World mm.
 * @param wxyz w, x, y, z; any length but 0.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a number that is not finite, and for a quaternion of length 0.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_from_quaternion(conus_pose *out, const double origin[3], const double wxyz[4]);

/**
 * Computes the camera of an eye that sees through a window, such as that of a tracked head before a screen (Eq. 1).
 * @param[out] camera The camera, for conus_view.camera.
 * @param[out] frustum Left, right, lower and upper edge, for conus_view.frustum.
 * @param window The middle of the window, with +x to its right, +y up, +z to the side of the eye.
 * @param size Width and height of the window, mm.
 * @param eye World mm.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where the eye is not before the window: no edge may be more than 1000 times
 * as far off as the eye is near.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_window_camera(conus_pose *camera, double frustum[4], const conus_pose *window,
                                               const double size[2], const double eye[3]);

#ifdef __cplusplus
}
#endif

#endif
