/* SPDX-License-Identifier: BSD-3-Clause */
/** @file FreeSurfer's annotations (lh.aparc.annot), big-endian, and labels (lh.V1_exvivo.label), a list of the vertices
 * of one area as text. docs/formats.md lists the fields. */
#ifndef CONUS_LOADERS_SURFACES_FREESURFER_LABELS_H
#define CONUS_LOADERS_SURFACES_FREESURFER_LABELS_H

#include "atlas/labels/labels.h"
#include "base/status.h"
#include "base/text.h"

#include <stdint.h>

/** Parses an annotation: *labels has one label per vertex (0 = none), the caller's to memory_free(); @p table is
 * sorted, and the caller's to finish. A label is its entry's number in the file's colour table; vertices name it by its
 * packed colour. Entry 0 is no area if it is called so ("unknown"), else the label behind the last, with a note. */
conus_status freesurfer_annot_parse(uint32_t **labels, size_t *count, struct label_table *table, const uint8_t *data,
                                    size_t size, struct notes *notes);

/** Parses a label: *labels has 1 for each vertex of the list and 0 for the others up to the last of it; the caller's to
 * memory_free(). CONUS_ERROR_DATA where the file is cut off, or lists voxels. */
conus_status freesurfer_label_parse(uint32_t **labels, size_t *count, struct text text);

#endif
