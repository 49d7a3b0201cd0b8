/* SPDX-License-Identifier: BSD-3-Clause */
/** @file From the "areas" and the "tree" of a manifest to the list of surfaces that become areas. */
#ifndef CONUS_LOADERS_SCENE_LOAD_PLAN_H
#define CONUS_LOADERS_SCENE_LOAD_PLAN_H

#include "loaders/manifest/manifest.h"
#include "loaders/scene/area_plan.h"

/** Finds the files of all entries. @p path is the manifest's. Errors name the key, not the manifest. */
conus_status area_plan_make(struct area_plan *out, const struct manifest *manifest, const char *path,
                            struct notes *notes);

#endif
