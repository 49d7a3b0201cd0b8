/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * FreeSurfer's MGH volumes (.mgh, packed .mgz): version 1, always big-endian, one fixed header of 284 bytes. */
#ifndef CONUS_LOADERS_VOLUMES_MGH_H
#define CONUS_LOADERS_VOLUMES_MGH_H

#include "base/notes.h"
#include "loaders/volumes/volume_header.h"
#include "sources/signatures.h"

/** Reads the header. The datatype is translated into NIfTI's code. */
conus_status mgh_header_parse(struct volume_header *out, const uint8_t *data, size_t size, struct notes *notes);

#endif
