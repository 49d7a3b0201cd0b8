/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A simulated hand that points at areas and presses a button: paths that are made, not measured, the same for
 * one seed everywhere, and how often each way of selecting finds the intended area (Eq. 12). */
#ifndef CONUS_TESTS_SUPPORT_HAND_H
#define CONUS_TESTS_SUPPORT_HAND_H

#include "atlas/atlas.h"
#include "base/memory.h"

/* The path of one trial, angles in degrees. Its numbers are not fitted to a person, but within the range reported for
 * hands that hold a controller. */
#define HAND_RATE 90.0        /* poses per second, 2 in 100 of which are lost                                   */
#define HAND_APPROACH 0.5     /* s of a minimum-jerk movement from 6 to 10 degrees away                         */
#define HAND_DWELL_LOW 0.6    /* s from then to the press, at least,                                            */
#define HAND_DWELL_HIGH 1.0   /* and at most                                                                    */
#define HAND_DRIFT 0.3        /* standard deviation of an Ornstein-Uhlenbeck process of yaw and of pitch,       */
#define HAND_DRIFT_TIME 0.4   /* and its correlation time, s                                                    */
#define HAND_TREMOR 0.15      /* root mean square of the tremor of yaw and of pitch, three sines of 8 to 12 Hz  */
#define HAND_JERK_LOW 0.5     /* the press turns the device downwards by at least so much,                      */
#define HAND_JERK_HIGH 1.5    /* and at most; half as much to a side                                            */
#define HAND_JERK_BEFORE 0.08 /* s before the press at which that begins                                        */
#define HAND_JERK_RISE 0.12   /* s that it takes                                                                */
#define HAND_POSITION 0.5     /* mm, root mean square of the tremor of the position along each axis             */

/** A way of selecting. */
struct hand_method {
    const char *name, *score;
    uint32_t resolution; /**< 1 is a ray.                                                                  */
    double delay;        /**< Delay of the tracker; below 0: the object selected at the press itself counts. */
};

enum { HAND_METHODS = 8 };
extern const struct hand_method hand_methods[HAND_METHODS];

struct hand_outcome {
    size_t hits[HAND_METHODS];    /**< Trials in which the press confirmed the area that was meant.             */
    size_t changes[HAND_METHODS]; /**< Changes of the selected object between these times, in all. */
    double seconds;               /**< From the end of the approach to the press, in all.                      */
};

typedef double (*hand_random)(uint64_t *state, double low, double high);

/** Points @p trials times at areas of @p atlas that can be seen from an arm's length away, anywhere around it, with a
 * cone of 10 degrees. Appends the poses to @p record as a table for conus track, unless that is NULL. */
conus_status hand_run(struct hand_outcome *out, const conus_atlas *atlas, size_t trials, hand_random random,
                      struct buffer *record);

#endif
