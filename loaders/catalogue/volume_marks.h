/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether a volume holds labels, by its name, its header and what lies beside it. No voxel is read. */
#ifndef CONUS_LOADERS_CATALOGUE_VOLUME_MARKS_H
#define CONUS_LOADERS_CATALOGUE_VOLUME_MARKS_H

#include "base/job/job.h"

/** Whether the ending of @p name is that of a volume (of a pair, of the header). */
bool volume_marks_is_volume(const char *name);

/** Whether @p name fits one of @p patterns, NULL at the end, and @p how as for text_matches(). */
bool volume_marks_fit(const char *name, const char *const *patterns, unsigned how);

/** Decides whether the one volume in the file @p path counts as labels, and sets @p spacing to its voxels' edge lengths
 * in mm. A volume of a @p known name does. Others need a mark: NIfTI's intent "label", a label table inside, one beside
 * it that bears its name, or a name as label volumes have. A file that cannot be read is no atlas. */
bool volume_marks_find(struct job *job, double spacing[3], const char *path, bool known);

#endif
