/* SPDX-License-Identifier: BSD-3-Clause */
/** @file AFNI's headers (.HEAD), whose voxels lie in a .BRIK (AFNI, "README.attributes"). AFNI's DICOM order is LPS. */
#ifndef CONUS_LOADERS_VOLUMES_TEXT_AFNI_H
#define CONUS_LOADERS_VOLUMES_TEXT_AFNI_H

#include "base/notes.h"
#include "loaders/volumes/text/text_volume.h"

/** Reads the whole header @p data. @p out is the caller's to finish. Errors name the attribute. */
conus_status afni_parse(struct text_volume *out, const uint8_t *data, size_t size, struct notes *notes);

#endif
