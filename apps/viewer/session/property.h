/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The table of the window's state: a row for each value that a user sets. Session files, undo, scripts, keys and tips
 * are loops over it or name its rows; a new value is one row. What belongs to the objects of an atlas (hidden areas,
 * thresholds, opacities) is not here but in session.h. */
#ifndef CONUS_VIEWER_SESSION_PROPERTY_H
#define CONUS_VIEWER_SESSION_PROPERTY_H

#include "viewer/window/window.h"

enum property_id {
    PROPERTY_POSE = 0,
    PROPERTY_HAS_POSE,
    PROPERTY_IS_POINT,
    PROPERTY_CHOSEN_POINT,
    PROPERTY_FROZEN,
    PROPERTY_POINTER,
    PROPERTY_ANGLE,
    PROPERTY_RADIUS,
    PROPERTY_RANGE,
    PROPERTY_RESOLUTION,
    PROPERTY_LAYERS,
    PROPERTY_APERTURE,
    PROPERTY_SAMPLING,
    PROPERTY_ENGINE,
    PROPERTY_FADE,
    PROPERTY_FILL,
    PROPERTY_OUTLINES,
    PROPERTY_RADIOLOGICAL,
    PROPERTY_ORBIT,
    PROPERTY_CROSSHAIR,
    PROPERTY_MAGNIFICATION,
    PROPERTY_ENLARGED,
    PROPERTY_BY_HEAD,
    PROPERTY_EYE,
    PROPERTY_SCREEN,
    PROPERTY_SCREEN_MM,
    PROPERTY_SLICE_FRACTION,
    PROPERTY_START,
    PROPERTY_ONE_RAY,
    PROPERTY_FOLLOW,
    PROPERTY_ORDER,
    PROPERTY_SLICES,
    PROPERTY_STUDY,
    PROPERTY_SWEEP,
    PROPERTY_JITTER,
    PROPERTY_SECOND_ON,
    PROPERTY_SECOND_POINTER,
    PROPERTY_SECOND_HAS_POSE,
    PROPERTY_SECOND_HELD,
    PROPERTY_SECOND_ANGLE,
    PROPERTY_SECOND_POSE,
    PROPERTY_SPEED,
    PROPERTY_BACKGROUND,
    PROPERTY_SAFE_COLOURS,
    PROPERTY_OWN_COLOURS,
    PROPERTY_FIGURE_IN_MM,
    PROPERTY_FIGURE_PIXELS,
    PROPERTY_FIGURE_MM,
    PROPERTY_FIGURE_DPI,
    PROPERTY_FIGURE_LEGEND,
    PROPERTY_FIGURE_TEXT,
    PROPERTY_PANELS,
    PROPERTY_DIVISION,
    PROPERTY_FOLD_LEFT,
    PROPERTY_FOLD_RIGHT,
    PROPERTY_BARE,
    PROPERTY_DEVICE_VIEW,
    PROPERTY_MEASURES,
    PROPERTY_MEASURED,
    PROPERTY_PLACES,
    PROPERTY_RESULT_ORDER,
    PROPERTY_RESULT_REVERSED,
    PROPERTY_EXPORT,
    PROPERTY_COUNT
};

/** How a value is kept in the window, and how it is written in a session. */
enum property_type {
    PROPERTY_REAL = 0, /**< double. */
    PROPERTY_WHOLE,    /**< uint32_t, written as a real number; a fraction is dropped. */
    PROPERTY_INTEGER,  /**< uint32_t, written as an integer. */
    PROPERTY_TRUTH,    /**< bool. */
    PROPERTY_NAME,     /**< An enum or size_t, written by name. */
};

/** Whether a session has to say it. */
enum property_presence {
    PROPERTY_NEEDED = 0, /**< Yes; of an @e object: where that is there. */
    PROPERTY_KEPT,       /**< No; then it stays as it is. */
    PROPERTY_ZERO,       /**< No; then it is 0, and 0 is not written. */
    PROPERTY_OF_HEAD,    /**< Only where a head moves the view, which `by_head` says. */
};

/** Whether undo takes it back. */
enum property_undo {
    UNDO_TAKES = 0,
    UNDO_LEAVES,        /**< Never: it is where a pane looks. */
    UNDO_LEAVES_MOVING, /**< Not while a device or a file moves the tool. */
    UNDO_LEAVES_REPLAY, /**< Not while a replay moves the first tool: its rows say it. */
};

/** The part of the window that follows a change. */
enum property_change {
    CHANGES_PICTURE = 0,
    CHANGES_ANSWER,
    CHANGES_COLOURS,
    CHANGES_SECOND, /**< The answer of the second tool. */
    CHANGES_SPEED,  /**< That of all devices. */
};

enum { PROPERTY_NUMBERS = 16, PROPERTY_REASON = 256 };

struct property {
    const char *object; /**< Object of the session that has it; NULL = the session itself. */
    const char *name;
    const char *help; /**< Names the value and its unit. */
    enum property_type type;
    bool is_negated;   /**< A bool whose opposite the window keeps. */
    bool of_window;    /**< The offset is in struct window, not in struct viewer. */
    bool is_set_apart; /**< A session sets it by a function of its own (session.c). */
    size_t offset, size;
    size_t count;                     /**< How many numbers it has: 0 stands for 1. */
    double low, high;                 /**< Range of each number that a session or a script may give. */
    const char *const *names;         /**< [high - low + 1] Of PROPERTY_NAME; NULL = it may not be that. */
    const char *(*name_of)(size_t i); /**< In their place. */
    enum property_presence presence;
    enum property_undo undo;
    enum property_change change;
    const char *const *says;    /**< [high - low + 1] What the status line says once it is that; NULL = nothing. */
    const char *tip;            /**< Tip of its widget, where it says more than @e help. */
    const char *label;          /**< Of its widget; */
    const char *const *choices; /**< [high - low + 1] what that offers; NULL = the names, or a box to check; */
    const char *format;         /**< and of a slider. */
    double slider[2];           /**< Its range; 0, 0 = low to high. */
    bool is_logarithmic;
};

/** [PROPERTY_COUNT] */
extern const struct property properties[PROPERTY_COUNT];

static inline size_t property_count(const struct property *property)
{
    return property->count ? property->count : 1;
}

/** Its numbers: a bool is 0 or 1, an enum its value. */
void property_get(double out[PROPERTY_NUMBERS], const struct property *property, const struct window *window);
/** Only stores them: what a change means is property_set()'s. */
void property_put(struct window *window, const struct property *property, const double numbers[PROPERTY_NUMBERS]);

/** The JSON that a session has. NULL without memory. */
struct json_t *property_json(const struct property *property, const double numbers[PROPERTY_NUMBERS]);
/** False where @p value is not what the row allows: @p why says what is, in one line. */
bool property_read(double out[PROPERTY_NUMBERS], const struct property *property, const struct json_t *value,
                   char why[PROPERTY_REASON]);
/** Says why a session is refused, in one line; false. */
bool session_refuse(char why[PROPERTY_REASON], const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Its first number. */
double property_value(const struct window *window, enum property_id id);
/** Sets that, as a user does: answers and pictures follow, and the status line says so. */
void property_set(struct window *window, enum property_id id, double value);
/** Sets the next value of an enum or bool, after the last the first. */
void property_next(struct window *window, enum property_id id);
/** Sets it to what @p words, [count], of a script say; false where the row does not allow that. */
bool property_set_words(struct window *window, enum property_id id, char *const *words, size_t count);

#endif
