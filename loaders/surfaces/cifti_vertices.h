/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Labels of the vertices of one surface in a .dlabel.nii. */
#ifndef CONUS_LOADERS_SURFACES_CIFTI_VERTICES_H
#define CONUS_LOADERS_SURFACES_CIFTI_VERTICES_H

#include "loaders/surfaces/mesh_file.h"

/** Takes from the .dlabel.nii @p bytes the labels of options->surface: those of the structure that it says it is, else
 * of the cortex on the side options->hemisphere, else of the only surface of the file. They must be of as many vertices
 * as a GIFTI surface has. @p map chooses a map. Errors do not name the file. */
conus_status cifti_vertices_read(struct vertex_labels *out, const struct bytes *bytes, struct text map,
                                 const struct mesh_file_options *options, struct notes *notes);

#endif
