/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Areas of a manifest that are the parts of one surface. */
#ifndef CONUS_LOADERS_PLAN_PLAN_LABELLED_H
#define CONUS_LOADERS_PLAN_PLAN_LABELLED_H

#include "loaders/manifest/manifest.h"
#include "loaders/scene/area_plan.h"

/** Plans "file" with "vertex_labels". @p path is the manifest's, areas[entry] the entry. */
conus_status plan_labelled(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path,
                           struct notes *notes);

#endif
