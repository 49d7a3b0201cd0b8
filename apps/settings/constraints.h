/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Options that constrain a plan, in their order on the command line. */
#ifndef CONUS_SETTINGS_CONSTRAINTS_H
#define CONUS_SETTINGS_CONSTRAINTS_H

#include "conus/plan.h"
#include "settings/pose_settings.h"

struct constraints {
    conus_constraint *items; /**< [count] */
    char **texts;            /**< [count] Their options' values, cut at their commas. */
    double **needles;        /**< [count] Of --apart; else NULL. */
    size_t count;
    double *shanks; /**< [shank_count][2] Of --shanks, along the device's x and y, mm; NULL = not given. */
    size_t shank_count;
};

extern const struct option constraint_options[]; /**< struct constraint_settings */
extern const struct option entry_options[];      /**< Likewise, of candidates that have an entry. */
extern const struct option shank_options[];      /**< Likewise: --shanks. */

/** Only so that the parser keeps what it reads: constraints_parse() takes the uses, in their order. */
struct constraint_settings {
    struct option_list reach, avoid, lean, apart, first;
    double length[2];
    double entry_angle;
    const char *shanks;
};

/** Reads the options about constraints, if there are any. @p out is the caller's to constraints_finish() in any case.
 * Returns the exit code and prints an error unless it is 0. */
int constraints_parse(struct constraints *out, const struct arguments *arguments);
/** Gives the contacts of --contacts, NULL = not given, to the constraints that count them. Likewise. */
int constraints_take_contacts(struct constraints *constraints, const char *text);
/** Whether there are any; @p arguments may be NULL. */
bool constraints_are_given(const struct arguments *arguments);
/** The last measure of any of them, in the order of conus_measure: whether rays are needed, and all layers. */
conus_measure constraints_last_measure(const struct constraints *constraints);
void constraints_finish(struct constraints *constraints);

/** Where positions are, and the atlases in which they are to be. */
struct pose_places {
    const conus_frame *frame;
    const struct pose_file_settings *settings; /**< NULL = the command has none. */
    const struct atlases *atlases;
    const struct common_settings *common;
};

/** Turns directions into the world, and loads the needles of --apart, whose poses are in the space of the frame, too.
 * Poses without a far end of their own have @p far, mm; 0 = none. Likewise. */
int constraints_place(struct constraints *constraints, const struct pose_places *places, double far);

#endif
