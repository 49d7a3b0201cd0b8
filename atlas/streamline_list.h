/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A list of an atlas's streamlines (conus_streamline_list). */
#ifndef CONUS_ATLAS_STREAMLINE_LIST_H
#define CONUS_ATLAS_STREAMLINE_LIST_H

#include "atlas/atlas.h"

struct conus_streamline_list {
    const conus_atlas *atlas;
    uint32_t *tractograms, *numbers; /**< [count], ascending. */
    size_t count, capacities[2];
    uint64_t points;
};

/** An empty list. */
conus_status streamline_list_create(conus_streamline_list **out, const conus_atlas *atlas);

/** Appends streamline @p number of tractogram @p tractogram, which comes after what is there. */
conus_status streamline_list_add(conus_streamline_list *list, uint32_t tractogram, uint32_t number);

#endif
