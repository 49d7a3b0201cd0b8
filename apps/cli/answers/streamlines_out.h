/* SPDX-License-Identifier: BSD-3-Clause */
/** @file --streamlines-out: the streamlines of a selection as a tractogram. */
#ifndef CONUS_CLI_ANSWERS_STREAMLINES_OUT_H
#define CONUS_CLI_ANSWERS_STREAMLINES_OUT_H

#include "settings/settings.h"

/** The table for streamlines_out_settings. */
extern const struct option streamlines_out_options[];

struct streamlines_out_settings {
    const char *path; /**< NULL = none. */
};

/* Those that return an int give the exit code and print an error unless it is 0. Without a path they do nothing. */

/** Lists the streamlines that come into the cone or ball, of all bundles that are shown. @p out is the caller's. */
int streamlines_out_take(conus_streamline_list **out, const struct streamlines_out_settings *settings,
                         const conus_selection *selection);

/** Writes what was taken. */
int streamlines_out_write(const conus_streamline_list *list, const struct streamlines_out_settings *settings);

#endif
