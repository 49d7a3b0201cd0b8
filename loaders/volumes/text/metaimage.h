/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * MetaImage headers, with the voxels behind them (.mha) or in another file (.mhd): "key = value" lines of ITK's MetaIO.
 * ITK places them in LPS. */
#ifndef CONUS_LOADERS_VOLUMES_TEXT_METAIMAGE_H
#define CONUS_LOADERS_VOLUMES_TEXT_METAIMAGE_H

#include "base/notes.h"
#include "loaders/volumes/text/text_volume.h"

/** Reads the header at the start of @p data. @p out is the caller's to finish. Errors name the field. */
conus_status metaimage_parse(struct text_volume *out, const uint8_t *data, size_t size, struct notes *notes);

#endif
