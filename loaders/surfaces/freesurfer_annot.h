/* SPDX-License-Identifier: BSD-3-Clause */
/** @file FreeSurfer's annotations (lh.aparc.annot), big-endian. docs/formats.md lists the fields. */
#ifndef CONUS_LOADERS_SURFACES_FREESURFER_ANNOT_H
#define CONUS_LOADERS_SURFACES_FREESURFER_ANNOT_H

#include "atlas/labels/labels.h"

/** Parses an annotation: *labels has one label per vertex (0 = none), the caller's to memory_free(); @p table is
 * sorted, and the caller's to finish. A label is its entry's number in the file's colour table; vertices name it by its
 * packed colour. Entry 0 is no area if it is called so ("unknown"), else the label behind the last, with a note. */
conus_status freesurfer_annot_parse(uint32_t **labels, size_t *count, struct label_table *table, const uint8_t *data,
                                    size_t size, struct notes *notes);

#endif
