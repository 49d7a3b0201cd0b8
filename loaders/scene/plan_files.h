/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Areas of a manifest that are one surface a file. */
#ifndef CONUS_LOADERS_PLAN_PLAN_FILES_H
#define CONUS_LOADERS_PLAN_PLAN_FILES_H

#include "loaders/manifest/manifest.h"
#include "loaders/scene/area_plan.h"

/** Plans "file". @p path is the manifest's, areas[entry] the entry. */
conus_status plan_file(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path);

/** Plans "files", a pattern. */
conus_status plan_pattern(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path,
                          struct notes *notes);

#endif
