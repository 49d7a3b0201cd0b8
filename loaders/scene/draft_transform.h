/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Transforms that lie in the folder of which a first manifest is made. */
#ifndef CONUS_LOADERS_MOVED_DRAFT_TRANSFORM_H
#define CONUS_LOADERS_MOVED_DRAFT_TRANSFORM_H

#include "loaders/manifest/manifest_draft.h"

/** Says of @p name, if it is a transform, that it is left out: nobody can see which way it leads, and of which image.
 * CONUS_ERROR_MEMORY. */
conus_status draft_transform_say(struct manifest_draft *draft, const char *name);

/** Says the same of the volume @p name, if its header says that it is a deformation field or what belongs to one;
 * *is_field then. CONUS_ERROR_MEMORY. */
conus_status draft_field_say(bool *is_field, struct manifest_draft *draft, const char *name);

#endif
