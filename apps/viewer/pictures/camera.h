/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The eye that sees a picture, and where things lie in the picture. The eye is on an orbit around a point, or
 * that of a tracked head. World RAS+, mm. */
#ifndef CONUS_VIEWER_PICTURES_CAMERA_H
#define CONUS_VIEWER_PICTURES_CAMERA_H

#include "link/station.h"

struct orbit {
    double centre[3];
    double distance;           /**< From it to the eye. */
    double azimuth, elevation; /**< Radians: 0, 0 looks from the front (+y); azimuth grows to the head's left. */
    double field_of_view;      /**< Vertical, radians.                                                        */
};

/** Looks from the front left above, so that a ball of @p radius around @p centre fills the pane. */
void orbit_look_at(struct orbit *orbit, const double centre[3], double radius);

/** Fits the field of view to a pane, so that what fills a square one shows whole in any. */
void orbit_fit(struct orbit *orbit, const double size[2]);

/** The camera: looks down its own -z, +y up. */
void orbit_camera(conus_pose *out, const struct orbit *orbit);

/** Looks from there, radians, at the same centre. */
void orbit_look_from(struct orbit *orbit, double azimuth, double elevation);
/** Goes around by so many pixels of a pane @p height pixels high; moves the centre along the picture; comes nearer by
 * that many clicks of a wheel. */
void orbit_turn(struct orbit *orbit, double right, double down, double height);
void orbit_pan(struct orbit *orbit, double right, double down, double height);
void orbit_zoom(struct orbit *orbit, double clicks);

/** The eye of a picture: a camera and what it sees, as conus_view has them. */
struct eye {
    conus_pose camera; /**< Looks down its own -z, +y up.                               */
    double frustum[4]; /**< The picture's left, right, lower and upper edge at depth 1. */
};

/** The eye on an orbit, for a picture of width x height pixels. */
void eye_of_orbit(struct eye *out, const struct orbit *orbit, const double size[2]);
/** Whether both are the same to the last bit. */
bool pose_is_same(const conus_pose *a, const conus_pose *b);
/** Whether both see the same. */
bool eye_is_same(const struct eye *a, const struct eye *b);
/** Widens or narrows the frustum, so that a picture of that size has square pixels. */
void eye_fit(struct eye *eye, const double size[2]);

/** Where world point @p p lies in such a picture: x right, y down from the top left. False behind the eye. */
bool eye_project(double out[2], const struct eye *eye, const double size[2], const double p[3]);
/** The unit direction from the eye through a point of such a picture. */
void eye_ray(double direction[3], const struct eye *eye, const double size[2], const double at[2]);

struct head {
    bool named;               /**< A tool is on it: --head.                                       */
    bool on;                  /**< The 3-D pane shows what it sees.                               */
    bool known;               /**< The eye below is one.                                          */
    bool inside;              /**< The newest eye was in the screen's plane or behind, and is not the one below. */
    enum station_state state; /**< The state of its tool. */
    double eye[3];
    conus_pose screen; /**< Its middle, +x to its right, +y up, +z to the viewer.          */
    double size[2];    /**< Width and height of the screen, mm; 0, 0 = not known. */
    unsigned number;   /**< Grows with every change that shows.                            */
};

/** Takes over where the eye and the screen are now. */
void head_move(struct head *head, const double eye[3], const conus_pose *screen);
/** Takes over the state of the head's tool. */
void head_set_state(struct head *head, enum station_state state);
/** Switches between the head's view and the one that the mouse turns. False: there is no head. */
bool head_toggle(struct head *head);

/** Its view through a part of the screen: left, right, lower and upper edge, each from 0 to 1 of the whole. False
 * where that is not shown, or never was seen. */
bool head_eye(struct eye *out, const struct head *head, const double part[4]);
/** One line about the head; *is_well tells whether it is seen. NULL where it does not matter. */
const char *head_text(const struct head *head, bool *is_well);

#endif
