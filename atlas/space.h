/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Where a voxel grid lies in the world. */
#ifndef CONUS_ATLAS_SPACE_H
#define CONUS_ATLAS_SPACE_H

#include "base/geometry/math3.h"
#include "base/status.h"
#include "base/text.h"
#include "conus/atlas.h"
#include "conus/image.h"

/** NIfTI's codes of a scanner's own space, of one that is aligned to something, and of templates. */
enum { SPACE_SCANNER = 1, SPACE_ALIGNED = 2, SPACE_TALAIRACH = 3, SPACE_MNI = 4, SPACE_TEMPLATE = 5 };

/** What the matrix of a grid, and one that moves an atlas, may be. Microscopy has voxels of 1e-7 mm; beyond these ends
 * a double no longer tells neighbouring voxels apart, or rays would never come out of one. */
#define SPACE_LEAST_STEP 1e-9 /**< mm: the length of a column; */
#define SPACE_MOST_STEP 1e6
#define SPACE_FARTHEST 1e10       /**< mm from the origin, of a corner; */
#define SPACE_FARTHEST_STEPS 1e12 /**< and steps. */
#define SPACE_FLATTEST 1e-6       /**< |det| by the product of the columns' lengths. */

/** out = inverse of @p m, which must be affine, finite, not singular, and within the limits above. The error names
 * @p words, the source of m. */
conus_status space_invert(double out[16], const double m[16], const char *words);

/** Checks @p world_from_voxel as space_invert() does, and the corners of info's grid, if its dim is set; derives info's
 * spacing and orientation. The error names @p transform, the source of the matrix. */
conus_status space_describe(conus_volume_info *info, const double world_from_voxel[16], const char *transform);

/** Volume of a voxel in mm^3: of a parallelepiped where the grid is sheared, which is less than its edges' product. */
double space_voxel_mm3(const conus_volume_info *info);

/** Whether both grids have the same voxels at the same places, but for rounding. */
bool space_same_grid(const conus_volume_info *a, const conus_volume_info *b);

/** Whether the grid lies where NIfTI readers place one of which they know only sizes: along the axes, i towards the
 * left, centred on the origin. */
bool space_is_guess(const conus_volume_info *info);

/** Name of a NIfTI xform code, "unknown" outside 0..5. */
const char *space_code_name(int code);

/** The same of a brain that is stated. */
conus_brain_view space_brain_stated(conus_brain brain);

/** The word of `template` that states a brain: mni152, colin27, mni305, or none for one person's own; NULL for others.
 */
const char *space_brain_word(conus_brain stated);

/** The brain that such a word states; unknown for other words. */
conus_brain space_brain_parse(struct text word);

struct conus_grid {
    conus_grid_view view; /**< data and description are owned.                                            */
    void *data;           /**< The numbers: size bytes a voxel, in this machine's byte order; view.data.     */
    size_t size;          /**< Bytes of a number.                                                            */
    bool labels;          /**< The numbers are labels.                                                       */
};

/** Voxels of @p info: their number, places and space, without data. */
conus_grid_view space_grid(const conus_volume_info *info);

/** Zeros on the grid of @p info. @p description is copied. */
conus_status grid_create(conus_grid **out, const conus_volume_info *info, conus_number number, const char *description);

/** The largest distance between the positions of a corner of the grid by @p a and @p b, matrices from voxels. */
double space_corner_distance(const size_t dim[3], const double a[16], const double b[16]);

/** The box around the voxels of a volume, world mm, cells included. */
struct box3 space_grid_box(const conus_volume_info *info);

#endif
