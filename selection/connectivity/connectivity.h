/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The ends of streamlines: areas at points, and which areas they connect (Eq. 20). */
#ifndef CONUS_SELECTION_CONNECTIVITY_CONNECTIVITY_H
#define CONUS_SELECTION_CONNECTIVITY_CONNECTIVITY_H

#include "conus/study.h"
#include "selection/measure/measure.h"
#include "selection/table/table.h"

/* The area at a point or, where none is, the nearest one within a radius (Eq. 20): quickly, for millions. */

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

/* Which areas streamlines connect, from inside (Eq. 20). */

/* Columns of its table. */
extern const struct table_fields connection_fields;

/** Lists the areas of the matrix as rows of a table: *out is freed by the caller. CONUS_ERROR_MEMORY. */
conus_status connection_areas_list(struct table_object **out, size_t *count, const conus_selector *selector);

#endif
