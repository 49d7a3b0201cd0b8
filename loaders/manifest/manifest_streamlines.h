/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The key "streamlines" of a manifest: tractograms that become bundles. */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_STREAMLINES_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_STREAMLINES_H

#include "loaders/manifest/manifest.h"
#include "loaders/manifest/schema.h"

/** A schema_read of a struct manifest: a list of paths and objects. */
conus_status manifest_streamlines_read(void *field, const json_t *value, const struct schema_place *place);
void manifest_streamlines_finish(struct manifest *manifest);

#endif
