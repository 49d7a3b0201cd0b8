/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Labels that both surfaces of a manifest and its parcellation have. */
#ifndef CONUS_LOADERS_SCENE_PLAN_SETTLE_H
#define CONUS_LOADERS_SCENE_PLAN_SETTLE_H

#include "loaders/manifest/manifest.h"
#include "loaders/scene/area_plan.h"
#include "loaders/scene/parcellations.h"

/** Settles who has a label that both the plan and the united parcellations have, as the manifest prefers; in the voxels
 * that remain, and in the plan, no label is there twice. A name that only the parcellation's table has is the
 * surface's. */
conus_status area_plan_settle(struct area_plan *plan, struct parcellations *all, enum manifest_preference preference);

#endif
