/* SPDX-License-Identifier: BSD-3-Clause */
/** @file FreeSurfer's labels (lh.V1_exvivo.label): a list of the vertices of one area, as text. */
#ifndef CONUS_LOADERS_SURFACES_FREESURFER_LABEL_H
#define CONUS_LOADERS_SURFACES_FREESURFER_LABEL_H

#include "base/status.h"
#include "base/text.h"

#include <stdint.h>

/** Whether @p text begins as FreeSurfer's labels do. */
bool freesurfer_label_is(struct text text);

/** Parses a label: *labels has 1 for each vertex of the list and 0 for the others up to the last of it, the caller's to
 * memory_free(). CONUS_ERROR_DATA where it is cut off, or is of voxels. */
conus_status freesurfer_label_parse(uint32_t **labels, size_t *count, struct text text);

#endif
