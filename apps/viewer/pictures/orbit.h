/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The eye of the 3-D pane, which goes around a point. World RAS+, mm. */
#ifndef CONUS_VIEWER_MODEL_ORBIT_H
#define CONUS_VIEWER_MODEL_ORBIT_H

#include <conus/conus.h>

struct orbit {
    double centre[3];
    double distance;           /**< Of the eye from it.                                                       */
    double azimuth, elevation; /**< Radians: 0, 0 looks from the front (+y); azimuth grows to the head's left. */
    double field_of_view;      /**< Vertical, radians.                                                        */
};

/** From the front left above, so that a ball of @p radius around @p centre fills the pane. */
void orbit_look_at(struct orbit *orbit, const double centre[3], double radius);

/** Fits the field of view to a pane, so that what fills a square one shows whole in any. */
void orbit_fit(struct orbit *orbit, const double size[2]);

/** The camera: looks down its own -z, +y up. */
void orbit_camera(conus_pose *out, const struct orbit *orbit);

/** Goes around by so many pixels of a pane @p height pixels high; moves the centre along the picture; comes nearer by
 * that many clicks of a wheel. */
void orbit_turn(struct orbit *orbit, double right, double down, double height);
void orbit_pan(struct orbit *orbit, double right, double down, double height);
void orbit_zoom(struct orbit *orbit, double clicks);

#endif
