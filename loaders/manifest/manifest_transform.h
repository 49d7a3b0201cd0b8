/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The key "transform" of a manifest: what brings its areas to where poses are. */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_TRANSFORM_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_TRANSFORM_H

#include "loaders/manifest/manifest.h"
#include "loaders/manifest/schema.h"

/** A schema_read of a struct manifest: a path, an object, or a list of these. */
conus_status manifest_transforms_read(void *field, const json_t *value, const struct schema_place *place);
void manifest_transforms_finish(struct manifest *manifest);

#endif
