/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The options of conus render about flat cuts, and the planes that they stand for. */
#ifndef CONUS_CLI_RENDER_CUTS_H
#define CONUS_CLI_RENDER_CUTS_H

#include "options/options.h"

#include "conus/picture.h"

struct cut_settings {
    const char *cuts; /* NULL = none */
    const char *at;   /* a place */
    double fill;
    bool radiological;
};

extern const struct option cut_options[];

/** Whether the words of --cuts are some, and every option has an effect; prints an error if not. */
bool render_cuts_check(const struct cut_settings *settings, const struct arguments *arguments);

/** Whether there is a view in space among the cuts, or there are no cuts. */
bool render_cuts_need_space(const struct cut_settings *settings);

/** Whether one of their positions is in the space of --space. */
bool render_cuts_have_places(const struct cut_settings *settings, const struct arguments *arguments);

/** Finds the planes in an atlas; the caller frees them in any case. @p selection, of a cone at @p pose or a tube
 * around its axis, may be NULL: the middle of its best hit is where planes without a place are, unless @p at, world mm,
 * is (NULL = none). Returns the exit code and prints an error unless it is 0. */
int render_cuts_find(conus_cut_plane **planes, size_t *count, const struct cut_settings *settings, const double *at,
                     const conus_atlas *atlas, const conus_frame *frame, conus_selector *selector,
                     const conus_selection *selection, const conus_pose *pose, bool is_tube);

/** How all cuts look. */
conus_cut_view render_cuts_look(const struct cut_settings *settings, const struct arguments *arguments);

#endif
