/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Small atlases with an area tree, written down in tests. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_AREA_ROWS_H
#define CONUS_TESTS_SUPPORT_BUILDERS_AREA_ROWS_H

#include "atlas/atlas.h"

/** An entry of a label table. */
struct area_row {
    uint32_t label; /**< 0 ends a table. */
    const char *name;
    uint32_t parent; /**< Label, 0 = none. */
    const char *abbreviation;
    char hemisphere;
};

/** A parcellation of @p dim voxels of 1 mm with these @p labels and names; the middle of its grid is at the origin. */
conus_status area_rows_atlas(conus_atlas **out, const size_t dim[3], const uint32_t *labels,
                             const struct area_row *rows);

/** Three pairs, the fewest that the library tells, A_L to C_R, numbered in this order: a voxel each, the left ones at x
 * = -1, the right ones at 1, or, where left and right are @p exchanged, the other way round, with the note of that. */
conus_status area_rows_pairs(conus_atlas **out, bool exchanged);

/** The number of the area called @p name; 0 if there is none. */
uint32_t area_rows_number(const conus_atlas *atlas, const char *name);

/** Adds a pathway of all voxels of the atlas's grid. */
conus_status area_rows_add_pathway(conus_atlas *atlas, const char *name);

#endif
