/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Where a NIfTI header puts its grid: METHODs 1 to 3 of nifti1.h; docs/spaces.md says which one wins. */
#ifndef CONUS_LOADERS_VOLUMES_NIFTI_TRANSFORM_H
#define CONUS_LOADERS_VOLUMES_NIFTI_TRANSFORM_H

#include "base/notes.h"

/** The header's fields about space, as stored. */
struct nifti_placement {
    double pixdim[8]; /**< [0] = qfac, [1..3] = size of a voxel in `units`.                        */
    int units;        /**< xyzt_units; its lowest three bits: 1 = m, 2 = mm, 3 = micrometres.       */
    int qform_code, sform_code;
    double quatern[3], qoffset[3]; /**< b, c, d and the centre of voxel (0, 0, 0).                  */
    double srow[12];               /**< Three rows of world_from_voxel.                            */
};

/** Sets world_from_voxel, spacing, orientation and transform of @p info, whose dim is set. The sform wins over the
 * qform; without either, the voxel sizes alone are used as FSL and nibabel do. Notes say what a careful user should
 * know: no transform, two that differ, units that are not millimetres. */
conus_status nifti_place(conus_volume_info *info, const struct nifti_placement *placement, struct notes *notes);

#endif
