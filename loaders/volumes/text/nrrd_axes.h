/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The axes of an NRRD file: which are space, which one is the list of volumes, and where they lie. */
#ifndef CONUS_LOADERS_VOLUMES_TEXT_NRRD_AXES_H
#define CONUS_LOADERS_VOLUMES_TEXT_NRRD_AXES_H

#include "base/notes.h"
#include "base/text.h"
#include "loaders/volumes/text/nrrd_segments.h"
#include "loaders/volumes/text/text_volume.h"

/** The fields of a header; those from NRRD_UNUSED on are not looked at. */
enum nrrd_field {
    NRRD_DIMENSION,
    NRRD_TYPE,
    NRRD_SIZES,
    NRRD_SPACE,
    NRRD_SPACE_DIMENSION,
    NRRD_DIRECTIONS,
    NRRD_ORIGIN,
    NRRD_SPACE_UNITS,
    NRRD_KINDS,
    NRRD_SPACINGS,
    NRRD_ENDIAN,
    NRRD_ENCODING,
    NRRD_LINE_SKIP,
    NRRD_BYTE_SKIP,
    NRRD_DATA_FILE,
    NRRD_UNUSED,
    NRRD_FIELD_COUNT = NRRD_UNUSED + 15
};

struct nrrd_header {
    struct text fields[NRRD_FIELD_COUNT]; /**< Values, inside the header's bytes; data is NULL where there is none. */
    struct nrrd_segments segments;
};

/** Sets dim, count, interleaved, world_from_voxel, transform and space_code of @p out. */
conus_status nrrd_axes_read(struct text_volume *out, const struct nrrd_header *header, struct notes *notes);

#endif
