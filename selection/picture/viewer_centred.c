/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_window_camera(): the camera of a viewer before a window. */
#include "base/geometry/math3.h"
#include "selection/picture/picture.h"

static conus_status check_window(const double size[2], const double eye[3])
{
    for (int a = 0; a < 2; a++) {
        if (!(size[a] > 0 && isfinite(size[a]))) {
            return fail(CONUS_ERROR_ARGUMENT, "size: %g x %g mm, allowed is more than 0", size[0], size[1]);
        }
    }
    return vec3_is_finite(eye)
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "eye: %g,%g,%g, allowed are finite numbers", eye[0], eye[1], eye[2]);
}

conus_status conus_window_camera(conus_pose *camera, double frustum[4], const conus_pose *window, const double size[2],
                                 const double eye[3])
{
    conus_pose exact;
    double offset[3];
    double edges[4];
    conus_status status = check_window(size, eye);
    status = status ? status : conus_pose_from_matrix(&exact, window->world_from_device);
    if (status) {
        return fail_in(status, "window");
    }
    const double *m = exact.world_from_device;
    vec3_sub(offset, eye, m + 12);
    double before = vec3_dot(m + 8, offset); /* Eq. 1 */
    for (int k = 0; k < 4; k++) {
        edges[k] = ((k % 2 ? 0.5 : -0.5) * size[k / 2] - vec3_dot(m + 4 * (k / 2), offset)) / before;
        if (!(before > 0 && fabs(edges[k]) <= PICTURE_FRUSTUM_LIMIT)) {
            return fail(CONUS_ERROR_ARGUMENT, "eye: %g mm before the window, which is not far enough to see through it",
                        before);
        }
    }
    memcpy(exact.world_from_device + 12, eye, 3 * sizeof *eye);
    memcpy(frustum, edges, sizeof edges);
    *camera = exact;
    return CONUS_OK;
}
