/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file track.h
 * Follows a device: ranks what its selector finds together with earlier steps (Eq. 12).
 */
#ifndef CONUS_PUBLIC_TRACK_H
#define CONUS_PUBLIC_TRACK_H

#include <conus/selection.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_tracker conus_tracker; /**< A selector that remembers. */

/** Constants of the scores that need a history (Eq. 12). */
typedef struct conus_tracker_options {
    size_t struct_size; /**< Its size, as #CONUS_TRACKER_OPTIONS_INIT sets it; 0 = that of this version. */
    double window;      /**< T of time and stability, s; after longer without a step all starts afresh. 0 = 2. */
    double stickiness;  /**< IntenSelect's c_s, in (0, 1), what is kept of a score in one frame. 0 = 0.5. */
    double snappiness;  /**< IntenSelect's c_g, up to 1, what is added of the new one. 0 = 0.5. */
    double rate;        /**< Hz: a frame of c_s and c_g is 1/rate. 0 = 60. */
    double growth;      /**< IntenSelect+'s, 1/s. 0 = 7.5. */
    double decay;       /**< IntenSelect+'s where an object contributes less than it did, 1/s. 0 = 5. */
    double exponent;    /**< k of both, in (0, 1]. 0 = 4/5. */
    double delay;       /**< s before the trigger of what it confirms, up to the window. 0 = 0.15; below 0 = none. */
} conus_tracker_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_TRACKER_OPTIONS_INIT CONUS_INIT_(conus_tracker_options)

/**
 * Starts a track.
 * @param[out] out The tracker; end it with conus_tracker_destroy().
 * @param selector Must outlive the tracker.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an option out of its range.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_tracker_create(conus_tracker **out, conus_selector *selector,
                                                const conus_tracker_options *options);

/**
 * Ends a tracker.
 * @param tracker NULL is allowed.
 * @threads One at a time for each @p tracker.
 * @since 0.1
 */
CONUS_API void conus_tracker_destroy(conus_tracker *tracker);

/**
 * Answers for the device at a time: conus_select() with a history. An object that left the cone stays in the ranking,
 * with 0 pixels, for as long as it has a score or could be confirmed. Of two steps at one time the later one counts
 * from there on. After a failure the tracker is as it was, so that a lost frame has no effect.
 * @param[out] out The selection; end it with conus_selection_destroy().
 * @param tracker The tracker.
 * @param time_s Seconds of any clock.
 * @param pose Apex and axis.
 * @param angle As for conus_select().
 * @param trigger The trigger is held down. The step at which it goes down confirms what was selected `delay` ago,
 * before the press moved the hand.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a time before the last step; the errors of conus_select().
 * @threads One at a time for each @p tracker.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_tracker_step(conus_selection **out, conus_tracker *tracker, double time_s,
                                              const conus_pose *pose, double angle, bool trigger);

/**
 * Gives what was selected some time before the last step.
 * @param tracker The tracker.
 * @param ago Seconds, 0 to the window.
 * @return Number of the object; 0 if none was.
 * @threads One at a time for each @p tracker.
 * @since 0.1
 */
CONUS_API uint32_t conus_tracker_selected(const conus_tracker *tracker, double ago);

/** Where a selection stands in its track. */
typedef struct conus_step {
    double time_s;      /**< Time of the step, s. */
    uint32_t selected;  /**< The first by rank of what is in the cone or has a score from before; 0 = none. */
    uint32_t confirmed; /**< Object that the trigger confirms at this step; 0 = none, no press. */
} conus_step;

/**
 * Gives the step of a selection.
 * @param selection The selection.
 * @return NULL if the selection is not from a tracker. Borrowed from the selection.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_step *conus_selection_step(const conus_selection *selection);

#ifdef __cplusplus
}
#endif

#endif
