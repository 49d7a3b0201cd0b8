/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The area at a point or, where none is, the nearest one within a radius (Eq. 20): quickly, for millions. */
#ifndef CONUS_SELECTION_ENDS_AREA_AT_H
#define CONUS_SELECTION_ENDS_AREA_AT_H

#include "selection/measure/near.h"

struct area_search {
    const conus_atlas *atlas;
    double radius;            /**< mm; 0 = a point in no area has none. */
    struct area_cells *cells; /**< [volume_count] */
};

/** Makes ready to search the areas of @p atlas, which must outlive the search, at about @p points points: for many it
 * is worth while to find out first where no area is. CONUS_ERROR_MEMORY. */
conus_status area_search_init(struct area_search *out, const conus_atlas *atlas, double radius, size_t points);
void area_search_finish(struct area_search *search);

/** Number of the area at the world point @p point, hidden ones aside; 0 = none. Any thread. */
uint32_t area_at(const struct area_search *search, const double point[3]);

#endif
