/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Areas of a manifest that are the structures of a BrainGlobe folder. */
#ifndef CONUS_LOADERS_PLAN_PLAN_BRAINGLOBE_H
#define CONUS_LOADERS_PLAN_PLAN_BRAINGLOBE_H

#include "loaders/manifest/manifest.h"
#include "loaders/scene/area_plan.h"

/** Plans "brainglobe". @p path is the manifest's, areas[entry] the entry. */
conus_status plan_brainglobe(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path,
                             struct notes *notes);

#endif
