/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The parts of conus render: flat cuts, frames of a turntable, and the caption. */
#ifndef CONUS_CLI_CMD_RENDER_H
#define CONUS_CLI_CMD_RENDER_H

#include "conus/picture.h"
#include "options/options.h"

#include <jansson.h>

/* The options of conus render about flat cuts, and the planes that they stand for. */

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

/* The options of conus render about frames of a turntable, their cameras and the names of their files. */

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

/* The caption of a picture: what is shown, what its colours are, warnings, and the paragraph of conus cite. */

/** What is known once the picture is drawn. Zeroed, nothing is. */
struct caption {
    char *shown;     /**< What is drawn, a sentence without its full stop. */
    char *legend;    /**< conus_image_legend() */
    json_t *sidecar; /**< Of the selection's answer; NULL = there is none. */
};

/** Keeps what the picture's colours mean, unless that of a frame before is kept. Returns the exit code and prints an
 * error unless it is 0, as do the others. */
int caption_take(struct caption *caption, const conus_image *image);

/** Keeps the answer that the picture shows; @p region as in struct question. */
int caption_ask(struct caption *caption, const conus_selector *selector, const conus_selection *selection,
                const conus_frame *frame, const struct arguments *arguments, const char *region);

/** Writes the caption with the thread's warnings to @p path; @p given is the atlas as it was given. */
int caption_write(const struct caption *caption, const char *path, const char *given, const conus_atlas *atlas);

void caption_finish(struct caption *caption);

#endif
