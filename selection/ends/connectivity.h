/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which areas streamlines connect, from inside (Eq. 20). */
#ifndef CONUS_SELECTION_ENDS_CONNECTIVITY_H
#define CONUS_SELECTION_ENDS_CONNECTIVITY_H

#include "conus/connectivity.h"
#include "selection/cone/cone.h"

struct conus_connectivity {
    conus_connection *rows; /**< Connections of bundles; then as many as there are pairs. */
    size_t row_count;
    conus_connection *pairs; /**< Connections of all bundles together, each streamline once. */
    size_t pair_count;
    double radius; /**< mm; 0 = an end in no area has none. */
    bool is_whole; /**< All streamlines; else those in */
    struct cone cone;
    double ball;     /**< radius of a ball around the cone's origin; 0 of a cone. */
    uint32_t *areas; /**< [area_count] Areas of the matrix, and 0 for ends in none. */
    size_t area_count;
    uint64_t *streamlines; /**< The matrix; NULL until it is asked for. */
    double *length;
};

/** Lists the areas of the matrix, before any is asked for. CONUS_ERROR_MEMORY. */
conus_status connection_areas_list(conus_connectivity *connectivity, const conus_selector *selector);

#endif
