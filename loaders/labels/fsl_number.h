/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which number a label of an FSL atlas XML has in a volume of labels. */
#ifndef CONUS_LOADERS_LABELS_FSL_NUMBER_H
#define CONUS_LOADERS_LABELS_FSL_NUMBER_H

#include "loaders/labels/fsl_atlas.h"
#include "loaders/labels/label_use.h"

/** Gives the labels the numbers that they have in a volume of labels, and sorts them: index or index + 1, as their
 * points say if @p use has a volume, else as the type says (docs/formats.md). @p use->path is the XML's. */
conus_status fsl_atlas_number(struct fsl_atlas *atlas, const struct label_use *use, struct notes *notes);

#endif
