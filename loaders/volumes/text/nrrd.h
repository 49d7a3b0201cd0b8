/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * NRRD headers, attached (.nrrd) and detached (.nhdr), versions 1 to 5 (teem, "Definition of NRRD File Format"), and
 * the segments that 3D Slicer writes into them (.seg.nrrd). */
#ifndef CONUS_LOADERS_VOLUMES_TEXT_NRRD_H
#define CONUS_LOADERS_VOLUMES_TEXT_NRRD_H

#include "base/notes.h"
#include "loaders/volumes/text/text_volume.h"

/** Reads the header at the start of @p data. @p out is the caller's to finish. Errors name the field. */
conus_status nrrd_parse(struct text_volume *out, const uint8_t *data, size_t size, struct notes *notes);

#endif
