/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What pictures have without OpenGL: the camera, texels of a volume, and the listener to their pieces. */
#ifndef CONUS_RENDER_GL_CAMERA_H
#define CONUS_RENDER_GL_CAMERA_H

#include "base/status.h"
#include "conus/pose.h"

#include <stdint.h>

/* Where a picture is taken from: a pose that looks down its own -z, and a field of view. */

struct camera {
    double world_from_camera[16]; /**< Rigid; -z is forward, +y up.       */
    double slope[2];              /**< Half the picture's width and height at depth 1.        */
    double middle[2];             /**< Where its middle is there, off the axis: 0, 0 unless it is off-axis (Eq. 1). */
};

/** The part of the picture that the subject shall fill, in pixels. */
struct camera_frame {
    uint32_t width, height;
    uint32_t left, right, top, bottom; /**< Margins kept free; together less than the picture. */
};

/** A camera at @p pose; @p field_of_view is vertical, radians. */
void camera_from_pose(struct camera *out, const conus_pose *pose, double field_of_view, uint32_t width,
                      uint32_t height);

/** A camera at @p pose whose picture at depth 1 reaches over @p frustum: left, right, lower and upper edge. */
void camera_from_frustum(struct camera *out, const conus_pose *pose, const double frustum[4]);

/** A camera that looks along @p forward (any length but 0), superior up (anterior up where it looks along z), from the
 * smallest distance at which all @p points, [count][3] in the world, lie in the frame's free part. */
void camera_frame_points(struct camera *out, const double *points, size_t count, const double forward[3],
                         double field_of_view, const struct camera_frame *frame);

/** Viewing direction for an atlas without a cone: from the front left above. */
void camera_default_forward(double out[3]);

/** Viewing direction that shows a cone along @p axis and its contact: 35 degrees off the axis, to the side from which
 * the head looks more familiar (left, right, front or back), and a little from above. */
void camera_cone_forward(double out[3], const double axis[3]);

/** Where the world point @p p lies in the picture: *x, *y in pixels from the top left, *depth in mm along the view
 * axis. False where it is not in front of the camera. */
bool camera_project(double *x, double *y, double *depth, const struct camera *camera, const struct camera_frame *frame,
                    const double p[3]);

/* What a texel of a volume is, in GL and on the CPU. */

enum volume_texture_kind {
    VOLUME_TEXTURE_UINT8 = 1, /**< R8UI; integers are never filtered. */
    VOLUME_TEXTURE_UINT16,    /**< R16UI */
    VOLUME_TEXTURE_UINT32,    /**< R32UI */
    VOLUME_TEXTURE_FLOAT,     /**< R32F, trilinear between voxel centres, clamped to the edge. */
    VOLUME_TEXTURE_BYTE4,     /**< RGBA8, likewise.                                            */
    VOLUME_TEXTURE_HALF4,     /**< RGBA16F, likewise; its voxels are four floats each.         */
    VOLUME_TEXTURE_FLOAT4     /**< RGBA32F, never filtered: a table. */
};

/* The listener to the pieces of a picture. Needs no GL. */

/** Receives progress and may cancel a picture between its pieces; `progress` may be NULL. */
struct picture_listener {
    conus_progress progress;
    void *user;
};

/** Reports piece @p done of @p total. CONUS_ERROR_CANCELLED if the listener ends it. */
static inline conus_status listener_tell(const struct picture_listener *listener, size_t done, size_t total)
{
    return !listener->progress || listener->progress(listener->user, done, total)
               ? CONUS_OK
               : fail(CONUS_ERROR_CANCELLED, "the picture was cancelled");
}

#endif
