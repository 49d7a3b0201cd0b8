/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Labels that both surfaces of a manifest and its parcellation have. */
#ifndef CONUS_LOADERS_SCENE_PLAN_SETTLE_H
#define CONUS_LOADERS_SCENE_PLAN_SETTLE_H

#include "loaders/manifest/manifest.h"
#include "loaders/scene/area_plan.h"
#include "loaders/scene/parcellations.h"

/** Gives each label that both the plan and the united parcellations have to the surface or to the voxels, as the
 * manifest prefers; after that no label is there twice. A surface without a name takes that of the parcellation's
 * table. */
conus_status area_plan_settle(struct area_plan *plan, struct parcellations *all, enum manifest_preference preference);

#endif
