/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The header of a TrackVis file, and the way from its coordinates into the world. */
#ifndef CONUS_LOADERS_TRACTS_TRK_HEADER_H
#define CONUS_LOADERS_TRACTS_TRK_HEADER_H

#include "base/notes.h"

#include <stdint.h>

enum { TRK_HEADER_SIZE = 1000, TRK_NAMES = 10, TRK_NAME_SIZE = 20 };

/** Names of scalars or properties. */
struct trk_names {
    uint32_t count;       /**< Numbers per point or per streamline. */
    const uint8_t *names; /**< [TRK_NAMES][TRK_NAME_SIZE], in the header. */
};

struct trk_header {
    bool swapped;
    int32_t version;             /**< 1 or 2 */
    uint32_t streamline_count;   /**< 0 = not stated. */
    struct trk_names scalars;    /**< Per point. */
    struct trk_names properties; /**< Per streamline. */
    bool has_matrix;             /**< The header says where the world is. */
    double world[16];            /**< World mm from the coordinates of the file. */
};

/** Parses the TRK_HEADER_SIZE bytes at @p data, which @p out points into. CONUS_ERROR_DATA, CONUS_ERROR_UNSUPPORTED. */
conus_status trk_header_parse(struct trk_header *out, const uint8_t *data, struct notes *notes);

#endif
