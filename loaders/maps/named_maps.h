/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file that is an atlas of probabilities by itself: because a table names its volumes, or because its name or
 * an option states that it is one map. */
#ifndef CONUS_LOADERS_MAPS_NAMED_MAPS_H
#define CONUS_LOADERS_MAPS_NAMED_MAPS_H

#include "atlas/labels/labels.h"
#include "base/files/file_sums.h"
#include "loaders/probe.h"
#include "loaders/volumes/volume_file.h"

struct named_maps {
    struct label_table table; /**< Its numbers are those of the volumes, from 1; without the background's. */
    char *source;             /**< For people: where the names come from.                               */
    struct file_sums read;    /**< The table.                                                             */
    bool chosen;              /**< The path chooses the one volume of the table. */
    bool is_one;              /**< There is one volume, which the file or the user states to be of probabilities. */
    struct notes notes;
};

/** Finds out whether all volumes of @p path, which @p probe has open, are named: the file has several, ",volume=K"
 * chooses none, and the table of @p options, or one beside the file, says for certain which volume each name belongs
 * to. Where a probability of @p options or the name (named_maps_is_probseg()) states that they are probabilities, one
 * volume, or the chosen one, has its file's name. Otherwise, and with labels_anyway, the table of @p out is empty.
 * CONUS_ERROR_ARGUMENT where the table of @p options does not name the volumes, or nothing names stated ones. */
conus_status named_maps_find(struct named_maps *out, const struct probe *probe, const char *path,
                             const conus_load_options *options);

/** Refuses @p file, opened as a series, where its values may be labels, or images of one thing, and neither its name
 * nor @p asked, the probability of the options, says that they are probabilities (docs/formats.md has the
 * rule). */
conus_status named_maps_check(struct volume_file *file, double asked, struct notes *notes);

/** Whether the name of the file says that its values are probabilities, as BIDS wants it: X_probseg.nii.gz. */
bool named_maps_is_probseg(const char *path);

void named_maps_finish(struct named_maps *maps);

#endif
