/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * FreeSurfer's MGH volumes (.mgh, packed .mgz): version 1, always big-endian, one fixed header of 284 bytes. */
#ifndef CONUS_LOADERS_VOLUMES_MGH_H
#define CONUS_LOADERS_VOLUMES_MGH_H

#include "base/notes.h"
#include "loaders/volumes/volume_header.h"

enum { MGH_HEADER_SIZE = 284 };

/** True where @p data begins like an MGH header: version 1, then a width below 2^24. */
bool mgh_is(const uint8_t *data, size_t size);

/** True where @p data is the header of values of a surface's vertices: N x 1 x 1. */
bool mgh_is_of_vertices(const uint8_t *data, size_t size);

/** Reads the header. The datatype is translated into NIfTI's code. */
conus_status mgh_header_parse(struct volume_header *out, const uint8_t *data, size_t size, struct notes *notes);

#endif
