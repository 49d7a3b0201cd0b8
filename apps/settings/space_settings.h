/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The options that say in which space positions are, and where it lies. */
#ifndef CONUS_SETTINGS_SPACE_SETTINGS_H
#define CONUS_SETTINGS_SPACE_SETTINGS_H

#include "options/options.h"

#include <conus/conus.h>

struct atlases;

struct space_settings {
    size_t name;      /* conus_space */
    double bregma[3]; /* AP, DV, ML in CCF, micrometres; 0, 0, 0 = the default */
};

extern const struct option space_options[]; /**< space_settings */

/** Whether the options go together; prints an error if not. */
bool settings_check_space(const struct arguments *arguments, const struct space_settings *settings);

/** Whether positions are found only once the atlas is loaded. */
bool settings_space_needs_atlas(const struct space_settings *settings);

/** Finds where the space lies in all of the @p atlases, which must be one place. Returns the exit code and prints an
 * error unless it is 0; unless @p quiet, says where the atlas calls the right side left. */
int settings_frame(conus_frame *out, const struct atlases *atlases, const struct space_settings *settings, bool quiet);

/** A position in the space of @p frame, in the world; @p option is its option's name. Likewise. */
int settings_point(double out[3], const double in[3], const conus_frame *frame, const char *option);

#endif
