/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file that is an atlas of probabilities by itself: because a table names its volumes, or because its name or
 * an option states that it is one map. */
#ifndef CONUS_LOADERS_MAPS_NAMED_MAPS_H
#define CONUS_LOADERS_MAPS_NAMED_MAPS_H

#include "loaders/labels/labels_on_job.h"
#include "loaders/volumes/volume_file.h"
#include "sources/source.h"

/** What it has is the job's. */
struct named_maps {
    const struct label_table *table; /**< Its numbers are those of the volumes, from 1; without the background's. Never
                                        NULL. */
    const char *source;              /**< For people: where the names come from. */
    struct notes *notes;             /**< About the table, which nobody has heard yet: for notes_move(); NULL = none. */
    bool chosen;                     /**< The path chooses the one volume of the table. */
    bool is_one; /**< There is one volume, which the file or the user states to be of probabilities. */
};

/** Finds out whether all volumes of @p path, which @p source has open, are named: the file has several, ",volume=K"
 * chooses none, and the table of @p options, or one beside the file, says for certain which volume each name belongs
 * to; the job's result is made of that table then. Where a probability of @p options or the name
 * (named_maps_is_probseg()) states that they are probabilities, one volume, or the chosen one, has its file's name.
 * Otherwise, and with labels_anyway, the table is empty. CONUS_ERROR_ARGUMENT where the table of @p options does not
 * name the volumes, or nothing names stated ones. */
struct named_maps named_maps_find(struct job *job, const struct source *source, const char *path,
                                  const conus_load_options *options);

/** Refuses @p file, opened as a series, where its values may be labels, or images of one thing, and neither its name
 * nor @p asked, the probability of the options, says that they are probabilities (docs/formats.md has the
 * rule). */
void named_maps_check(struct job *job, struct volume_file *file, double asked);

/** Whether the name of the file says that its values are probabilities, as BIDS wants it: X_probseg.nii.gz. */
bool named_maps_is_probseg(const char *path);

#endif
