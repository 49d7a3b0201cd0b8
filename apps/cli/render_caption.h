/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The caption of a picture: what is shown, what its colours are, warnings, and the paragraph of conus cite. */
#ifndef CONUS_CLI_RENDER_CAPTION_H
#define CONUS_CLI_RENDER_CAPTION_H

#include "options/options.h"

#include "conus/picture.h"

#include <jansson.h>

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
