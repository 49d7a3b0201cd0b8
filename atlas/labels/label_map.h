/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A hash map from labels (any 32-bit number) to small numbers, for atlases whose labels are not contiguous. */
#ifndef CONUS_ATLAS_LABEL_MAP_H
#define CONUS_ATLAS_LABEL_MAP_H

#include "base/status.h"

struct label_map_slot {
    uint32_t label;
    bool used;
    uint64_t value;
};

struct label_map {
    struct label_map_slot *slots; /**< [mask + 1], open addressing.                                              */
    size_t mask;
    size_t count;
};

void label_map_finish(struct label_map *map);

/** The value of @p label, put in as 0 if it is new; NULL without memory. Valid until the next call. */
uint64_t *label_map_at(struct label_map *map, uint32_t label);

#endif
