/* SPDX-License-Identifier: BSD-3-Clause */
/** @file MINC 2: volumes of the Montreal Neurological Institute, which are HDF5 (base/child/hdf5.h). MINC 1 is netCDF.
 */
#ifndef CONUS_LOADERS_VOLUMES_MINC_H
#define CONUS_LOADERS_VOLUMES_MINC_H

#include "base/child/hdf5.h"
#include "loaders/volumes/volume_input.h"

/** Takes the header of the volume in @p hdf5. The voxels that v->read() gives are stored ones,
 * or float64 where each slice has a scale of its own. CONUS_ERROR_UNSUPPORTED for what is no single volume of regular
 * voxels. */
void minc_from_hdf5(struct job *job, struct volume_input *v, const struct hdf5 *hdf5);

#endif
