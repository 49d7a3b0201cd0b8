/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Files that show one selection: --image, --mask with its sidecar, --streamlines-out. */
#ifndef CONUS_CLI_ANSWERS_SELECTION_FILES_H
#define CONUS_CLI_ANSWERS_SELECTION_FILES_H

#include "conus/image.h"
#include "conus/report.h"
#include "conus/streamlines.h"
#include "options/outputs.h"
#include "options/provenance.h"

struct selection_file_settings {
    const char *image;
    const char *mask;
    size_t mask_content; /**< conus_grid_content, if given. */
    const char *mask_object;
    const char *streamlines;
};

extern const struct option selection_file_options[];

/** The selection's data that its files need, until they are written. Zeroed: nothing. */
struct selection_files {
    const struct selection_file_settings *settings;
    conus_image *image;
    conus_grid_content mask_content;
    conus_grid *mask;
    char *mask_sidecar; /**< Path; NULL without a mask. */
    conus_streamline_list *streamlines;
};

/* Those that return an int give the exit code and print an error unless it is 0. */

/** Finds the mask's content and its sidecar, which is added to @p outputs. @p out is the caller's to
 * selection_files_finish() in any case. */
int selection_files_init(struct selection_files *out, struct outputs *outputs,
                         const struct selection_file_settings *settings, const struct arguments *arguments);
void selection_files_finish(struct selection_files *files);

/** Takes what the files need. */
int selection_files_take(struct selection_files *files, const conus_selection *selection, const conus_atlas *atlas);

/** Writes them; the mask's sidecar has the SHA-256 of the mask and the inputs of @p provenance. */
int selection_files_write(const struct selection_files *files, conus_report *report,
                          const struct provenance *provenance);

#endif
