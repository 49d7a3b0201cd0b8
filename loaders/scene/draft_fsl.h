/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a manifest in the making takes of an FSL atlas XML. */
#ifndef CONUS_LOADERS_SCENE_DRAFT_FSL_H
#define CONUS_LOADERS_SCENE_DRAFT_FSL_H

#include "loaders/labels/fsl_atlas.h"
#include "loaders/manifest/manifest_draft.h"

/** Which file stands for the XML @p xml, of type Label: the XML itself; its volume, where that has other names by
 * itself, so that the manifest says what a query of the volume says; or NULL, where another XML has taken the volume. A
 * line of the log says why it is not the XML. *name is the caller's to memory_free(). */
conus_status draft_fsl_choose(char **name, const struct manifest_draft *draft, const char *xml);

/** Its images are no further volumes of the folder. */
conus_status draft_fsl_mark(struct manifest_draft *draft, const struct fsl_atlas *atlas);

/** Whether the volume @p name is one of those. */
bool draft_fsl_has(const struct manifest_draft *draft, const char *name);

#endif
