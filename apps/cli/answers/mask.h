/* SPDX-License-Identifier: BSD-3-Clause */
/** @file --mask: the voxels in the cone as a NIfTI volume, with its sidecar. */
#ifndef CONUS_CLI_ANSWERS_MASK_H
#define CONUS_CLI_ANSWERS_MASK_H

#include "options/options.h"
#include "options/provenance.h"

#include <conus/conus.h>

struct mask_settings {
    const char *path; /**< NULL = none. */
    size_t content;   /**< conus_grid_content, if given. */
    const char *object;
};

extern const struct option mask_options[];

/** A mask on its way from the selection to its file. A zeroed one is none. */
struct mask {
    const struct mask_settings *settings;
    char *sidecar; /**< Path; NULL without a mask. */
    conus_grid_content content;
    conus_grid *grid;
};

/** Names the sidecar. False (error printed) without memory. */
bool mask_init(struct mask *out, const struct mask_settings *settings, const struct arguments *arguments);
void mask_finish(struct mask *mask);

/** Makes the mask of @p selection, if one is wanted. Returns the exit code and prints an error unless it is 0. */
int mask_take(struct mask *mask, const conus_atlas *atlas, const conus_selection *selection);

/** Writes it and its sidecar, which lists the inputs of @p provenance, likewise. */
int mask_write(const struct mask *mask, conus_report *report, const struct provenance *provenance);

#endif
