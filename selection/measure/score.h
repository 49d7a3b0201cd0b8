/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Scores: formulas over named values, a track's memory, and ranks (Eq. 12). */
#ifndef CONUS_SELECTION_MEASURE_SCORE_H
#define CONUS_SELECTION_MEASURE_SCORE_H

#include "base/status.h"
#include "conus/own.h"
#include "selection/measure/measure.h"

#include <stdint.h>

/* Formulas over named values: numbers, names, + - * /, a minus in front, parentheses. Parsed once into a program for
 * a stack; ASCII only, whatever the locale. Knows nothing of what the names mean. */

enum { FORMULA_LENGTH_LIMIT = 256, FORMULA_DEPTH_LIMIT = 16 };

enum formula_kind {
    FORMULA_NUMBER,
    FORMULA_NAME,
    FORMULA_NEGATE,
    FORMULA_ADD,
    FORMULA_SUBTRACT,
    FORMULA_MULTIPLY,
    FORMULA_DIVIDE
};

struct formula_step {
    enum formula_kind kind;
    size_t name;   /**< For FORMULA_NAME: its index.   */
    double number; /**< For FORMULA_NUMBER.            */
};

struct formula {
    struct formula_step steps[FORMULA_LENGTH_LIMIT]; /**< In the order of a stack: operands first. */
    size_t count;
    char text[FORMULA_LENGTH_LIMIT + 1]; /**< As it was given. */
};

/** Name @p index that a formula may use; NULL past the last. */
typedef const char *(*formula_name)(const void *names, size_t index);

/** Parses @p text (at most FORMULA_LENGTH_LIMIT bytes, FORMULA_DEPTH_LIMIT parentheses deep), whose names are those of
 * @p name_at; CONUS_ERROR_ARGUMENT says what is wrong where, and of an unknown name the closest known one. Dividing by
 * a constant that is 0 is an error. */
conus_status formula_parse(struct formula *out, const char *text, formula_name name_at, const void *names);

/** The value of the formula, that of name @p index being values[index]. NaN where it has none: a name in it is NaN, a
 * divisor is 0, the result is no finite number. */
double formula_value(const struct formula *formula, const double *values);

/** Whether the formula uses name @p index. */
bool formula_uses(const struct formula *formula, size_t index);

/* A track's memory of each object: the scores of Eq. 12 that need a history. Steps come in order of time, at any
 * rate; between two of them an object's contribution is taken as linear. */

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

/* Ranks the objects that a cone hit (Eq. 12): a table of scores, and formulas over them. */

/** Input of a score beside the result. */
struct score_view {
    const struct cone *cone;
    uint32_t cone_pixels;          /**< Pixels of the aperture.                                      */
    double near, far;              /**< Distances of the box around the atlas from the apex, mm; needs_box.   */
    const bool *on_border;         /**< By object; only where ranking.needs_border.                  */
    const struct history *history; /**< NULL = none; only where ranking.info.needs_history.          */
};

/** One way of scoring; higher scores come first. */
struct score {
    conus_score_info info;
    double (*value)(const conus_result *result, const struct score_view *view);
    unsigned history; /**< Parts of it that the score lives on; 0 unless info.needs_history. */
    bool needs_border, needs_box, needs_rays, needs_posterior; /**< needs_rays: a weight of them. */
};

/** The ranking of a selector: a formula over the table's names. */
struct ranking {
    struct formula formula;
    conus_score_info info; /**< Its needs; without name and description. */
    uint32_t uses;         /**< Bit n: the table's n-th score.         */
    unsigned history;      /**< The parts of a history that the scores use. */
    bool needs_border, needs_box, needs_rays, needs_posterior;
};

/** Parses a name or formula, NULL = the default. CONUS_ERROR_ARGUMENT says what is wrong with it. */
conus_status ranking_parse(struct ranking *out, const char *text);

/** IntenSelect's contribution of one moment, 0 to 1: 1 - atan(d_perp / d_proj^k) / theta for the object's contact, in
 * metres, theta being half the cone's angle; 0 for an object that no pixel hit first. In a cylinder, where there is no
 * theta, 1 - d_perp / radius. @p exponent is k, in (0, 1]. */
double score_contribution(const conus_result *result, const struct cone *cone, double exponent);

/** Fills score and rank and sorts by rank, the highest score first and what has none last; ties go to the larger
 * share, then the nearer, then the lower object number. CONUS_KIND_UNASSIGNED stays last. */
void score_rank(struct statistics *statistics, const struct ranking *ranking, const struct score_view *view);

#endif
