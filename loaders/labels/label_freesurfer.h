/* SPDX-License-Identifier: BSD-3-Clause */
/** @file FreeSurfer's volumes away from FreeSurfer's colour table. */
#ifndef CONUS_LOADERS_LABELS_LABEL_FREESURFER_H
#define CONUS_LOADERS_LABELS_LABEL_FREESURFER_H

#include "loaders/labels/label_offer.h"

/** Tries FreeSurferColorLUT.txt of FREESURFER_HOME, or of the FreeSurfer whose subject the volume is, in @p folder, if
 * the volume's name is one of FreeSurfer's and its labels are where FreeSurfer's are. A note says which was taken. */
conus_status label_search_freesurfer(struct label_search *search, const char *folder);

/** A label_judge of a FreeSurferColorLUT.txt in the volume's folder: FreeSurfer's own is taken only for volumes that
 * bear one of FreeSurfer's names or whose labels lie as FreeSurfer's do; any other is taken. */
conus_status label_judge_freesurfer(bool *taken, struct label_search *search, const struct label_table *table,
                                    const char *path);

#endif
