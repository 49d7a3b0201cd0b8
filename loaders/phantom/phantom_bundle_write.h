/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The bundle phantom as files. phantom_write.c writes those that are drawings. */
#ifndef CONUS_LOADERS_PHANTOM_PHANTOM_BUNDLE_WRITE_H
#define CONUS_LOADERS_PHANTOM_PHANTOM_BUNDLE_WRITE_H

#include "base/status.h"

/** Writes the bundle phantom into @p folder, which must be there: bundle.tck, the truth bundle.json and, last, the
 * manifest bundle.atlas.json. docs/formats.md has its shapes. */
conus_status phantom_bundle_write(const char *folder);

#endif
