/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The key "context" of a manifest, and the keys that say which volume of a file is meant. */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_CONTEXT_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_CONTEXT_H

#include "loaders/manifest/manifest.h"
#include "loaders/manifest/schema.h"

/** A schema_read of a struct manifest: a path, an object, or a list of these. */
conus_status manifest_contexts_read(void *field, const json_t *value, const struct schema_place *place);
void manifest_contexts_finish(struct manifest *manifest);

/** Reads of a struct manifest_volume. */
conus_status manifest_volume_number_read(void *field, const json_t *value, const struct schema_place *place);
conus_status manifest_resolution_read(void *field, const json_t *value, const struct schema_place *place);
void manifest_volume_finish(struct manifest_volume *volume);

#endif
