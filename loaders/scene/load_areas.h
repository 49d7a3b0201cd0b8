/* SPDX-License-Identifier: BSD-3-Clause */
/** @file From planned surfaces to areas of the atlas. */
#ifndef CONUS_LOADERS_SCENE_LOAD_AREAS_H
#define CONUS_LOADERS_SCENE_LOAD_AREAS_H

#include "atlas/atlas.h"
#include "loaders/scene/area_plan.h"
#include "loaders/scene/load_progress.h"

/** Reads the surfaces, whose coordinates are in @p space where nothing else says so, and adds them to @p atlas, then
 * the groups; links parents. */
conus_status area_plan_load(struct area_plan *plan, conus_atlas *atlas, enum mesh_space space,
                            const conus_load_options *options, struct load_progress *progress);

#endif
