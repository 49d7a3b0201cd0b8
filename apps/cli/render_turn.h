/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The options of conus render about frames of a turntable, their cameras and the names of their files. */
#ifndef CONUS_CLI_RENDER_TURN_H
#define CONUS_CLI_RENDER_TURN_H

#include "options/options.h"

#include "conus/picture.h"

/** Stands for a frame's number in the name of its file. */
#define TURN_FRAME "{frame}"

struct turn_settings {
    double degrees;  /* 0 = a full turn */
    uint32_t frames; /* 0 = no turntable */
};

extern const struct option turn_options[];

/** Whether the options and the name of the output go together; prints an error if not. */
bool turn_check(const struct turn_settings *settings, const char *output, const struct arguments *arguments);

/** The camera of frame @p frame, from 0: that of the first, @p start (NULL = from the front and above, with the ball
 * around the atlas in view), turned about the upright axis through the middle of the atlas. */
conus_status turn_camera(conus_pose *out, const struct turn_settings *settings, uint32_t frame, const conus_pose *start,
                         const conus_atlas *atlas, const conus_view *view);

/** The field of view, degrees, in which what @p view shows from such cameras fills the picture from at least one side
 * all around, in a part @p room of its width: a legend may take the rest. */
conus_status turn_fit(double *field_of_view, const conus_atlas *atlas, conus_renderer *renderer, const conus_view *view,
                      double room);

/** @p pattern with the frame's number from 1 in it, with as many digits as the last one has. NULL without memory; the
 * caller frees it. */
char *turn_path(const char *pattern, const struct turn_settings *settings, uint32_t frame);

#endif
