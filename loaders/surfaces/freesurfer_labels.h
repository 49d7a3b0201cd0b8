/* SPDX-License-Identifier: BSD-3-Clause */
/** @file FreeSurfer's annotations (lh.aparc.annot), big-endian, and labels (lh.V1_exvivo.label), a list of the vertices
 * of one area as text. docs/formats.md lists the fields. */
#ifndef CONUS_LOADERS_SURFACES_FREESURFER_LABELS_H
#define CONUS_LOADERS_SURFACES_FREESURFER_LABELS_H

#include "base/job/reader.h"
#include "loaders/labels/labels_on_job.h"

/** Reads an annotation: one label per vertex, *count of them (0 = none); the empty @p table is sorted. A label is its
 * entry's number in the file's colour table; vertices name it by its packed colour. Entry 0 is no area if it is called
 * so ("unknown"), else the label behind the last, with a note. NULL after a failure. */
uint32_t *freesurfer_annot_read(struct reader *r, struct label_table *table, size_t *count);

/** Reads a label: 1 for each vertex of the list and 0 for the others up to the last of it, *count in all.
 * CONUS_ERROR_DATA where the file is cut off, or lists voxels. NULL after a failure. */
uint32_t *freesurfer_label_read(struct job *job, struct text text, size_t *count);

#endif
