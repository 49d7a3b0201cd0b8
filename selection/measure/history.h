/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A track's memory of each object: the scores of Eq. 12 that need a history. Steps come in order of time, at any rate;
 * between two of them an object's contribution is taken as linear. */
#ifndef CONUS_SELECTION_MEASURE_HISTORY_H
#define CONUS_SELECTION_MEASURE_HISTORY_H

#include "base/status.h"

#include <stdint.h>

/** Constants of the filters; every one above 0. */
struct history_constants {
    double window;      /**< T, s                                                       */
    double intent_rate; /**< IntenSelect's, 1/s: -f0 ln c_s.                           */
    double intent_gain; /**< c_g / (1 - c_s)                                            */
    double growth;      /**< IntenSelect+'s, 1/s.                                      */
    double decay;       /**< Likewise.                                                  */
};

/** Entries and exits per second at which stability is 0: a tremor of 10 Hz across an object's edge. */
#define HISTORY_RESTLESS 20.0
/** The least of IntenSelect's scores at which an object outside the cone is remembered. */
#define HISTORY_LEAST 1e-3

/** One object at one step. */
struct history_sample {
    uint32_t object;
    double contribution; /**< Eq. 12, 0 to 1. */
};

struct moment {
    bool inside;         /**< It is in the cone,                     */
    double contribution; /**< contributing so much; 0 if it is not.  */
};

/** The memory of one object. */
struct memory {
    uint32_t object;
    struct moment last;     /**< At the last step.                                     */
    struct moment now;      /**< At the step that history_step() is about.             */
    double intent, plus;    /**< States of the two filters.                            */
    double last_choice;     /**< Until when it ranked first; -INFINITY = never.        */
    struct change *changes; /**< Entries and exits within the window.                  */
    size_t change_count, change_capacity;
    bool inside_before; /**< Before its oldest change. */
};

struct history {
    struct history_constants constants;
    uint32_t *slots; /**< [object_count + 1] Index into memories plus 1; 0 = none. */
    struct memory *memories;
    size_t count, capacity;
    size_t steps; /**< Since the start. */
    double time;  /**< Time of the last step. */
};

/** For objects up to @p object_count. */
conus_status history_init(struct history *out, size_t object_count, const struct history_constants *constants);
void history_finish(struct history *history);

/** Reserves capacity for a step with these objects; otherwise the history stays as it was. */
conus_status history_reserve(struct history *history, const struct history_sample *samples, size_t count);

/** A step at @p time, not before the last one, after history_reserve() for the same samples: the objects in the cone,
 * each once. After more than the window without a step everything starts afresh. */
void history_step(struct history *history, double time, const struct history_sample *samples, size_t count);

/** Notes which object ranked first until now; 0 = none. */
void history_choose(struct history *history, uint32_t object);

/** The memory of @p object; NULL = none. */
const struct memory *history_find(const struct history *history, uint32_t object);

/** The parts of the history that a score uses. */
enum { HISTORY_WINDOW = 1, HISTORY_INTENT = 2, HISTORY_PLUS = 4, HISTORY_ALL = 7 };

/** Whether an object that is not in the cone has a score all the same, of those that live on @p parts. */
bool history_has_score(const struct memory *memory, unsigned parts);

/** SenseShapes' time: the part of the window that the object was in the cone, 0 to 1. */
double history_time(const struct history *history, const struct memory *memory);

/** SenseShapes' stability: 1 - entries and exits in the window / (window x HISTORY_RESTLESS), at least 0. */
double history_stability(const struct history *history, const struct memory *memory);

/* The temporal filters of Eq. 12, exact in time: their input is taken as linear between two samples, and the
 * differential equation is solved over the step, so that how often the device is read hardly matters. */
/** The state of s' = @p rate (u - s) after @p dt seconds (0 or more), s being @p state at first and u going linearly
 * from @p from to @p to. */
double filter_linear(double state, double rate, double from, double to, double dt);

/** The same with the rate @p growth where u > s, and @p decay where u < s. */
double filter_asymmetric(double state, double growth, double decay, double from, double to, double dt);

#endif
