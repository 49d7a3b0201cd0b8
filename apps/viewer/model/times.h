/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How long frames, pictures and selections take, for docs/benchmarks.md and for whoever wants to know. */
#ifndef CONUS_VIEWER_MODEL_TIMES_H
#define CONUS_VIEWER_MODEL_TIMES_H

#include "options/clock.h"

#include "conus/status.h"

enum timed {
    TIMED_FRAME = 0, /**< Drawing the window, without waiting for the screen.                        */
    TIMED_PERIOD,    /**< From one frame to the next, where they follow at once.                      */
    TIMED_SELECTION, /**< Selecting, once per pose.                                                  */
    TIMED_LATENCY,   /**< From a tracker's message to the selection.                                 */
    TIMED_PICTURE,   /**< The 3-D picture, coarse or fine, on its own thread.                        */
    TIMED_KINDS
};

enum { TIMES_KEPT = 2048 };

struct times {
    double samples[TIMED_KINDS][TIMES_KEPT]; /**< ms; the newest replace the oldest. */
    size_t counts[TIMED_KINDS];              /**< All samples that were added. */
    double started, frame_started;           /**< Clock, ms: of the program, of the newest frame (0 = none yet). */
    double first_frame, first_picture;       /**< ms from the start; 0 = not yet.    */
    double written, used;                    /**< Clock and processor time, ms, when they were written last. */
};

/** Starts, at the clock @p started. */
void times_start(struct times *times, double started);
void times_add(struct times *times, enum timed kind, double milliseconds);
/** A frame begins now. */
void times_begin_frame(struct times *times);
/** The window sleeps: the next frame does not follow from the one before. */
void times_pause(struct times *times);

/** Writes count, median, 90th percentile and maximum of each since the last time, as JSON, and starts anew; with
 * how long that was, and the processor time that the program took meanwhile. */
conus_status times_write(struct times *times, const char *path);

#endif
