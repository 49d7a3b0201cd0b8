/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How the voxels of an open volume are read, and MINC. */
#ifndef CONUS_LOADERS_VOLUMES_PARTS_H
#define CONUS_LOADERS_VOLUMES_PARTS_H

#include "base/child/hdf5.h"
#include "loaders/volumes/volumes.h"

/* The voxels of a volume that is open, and what its format needs to read them. */

/** Whether its file, a large one that is not packed, is read in pieces, however large it is. */
bool volume_is_in_pieces(const struct volume_input *v);

/** Whether voxels can come in pieces, so that labels need not be held twice. */
bool volume_has_slabs(const struct volume_input *v);

/** The voxels of @p count volumes from @p first on, which are the job's. */
struct bytes volume_keep(struct job *job, struct volume_input *v, size_t first, size_t count);

/** Gives the voxels of one volume to @p sink, in pieces. */
void volume_give(struct job *job, struct volume_input *v, size_t volume, const struct voxel_sink *sink);

/** The file @p path that belongs to the volume, whose place it takes. NULL after a failure. */
const struct source *volume_beside(struct job *job, const char *path);

/** All bytes of @p source as they are stored, which are the job's, and become part of the volume's sum. */
struct bytes volume_bytes(struct job *job, struct volume_input *v, const struct source *source);

/** Bytes of v->run, for formats that decode them. */
struct bytes volume_run(struct job *job, struct volume_input *v, size_t first, size_t count);

/** Takes type, dimensions and place of the header as found; @p words say where the place comes from. */
void volume_describe(struct job *job, struct volume_input *v, int datatype, const int64_t dim[7],
                     const double world_from_voxel[16], const char *words);

/* MINC 2: volumes of the Montreal Neurological Institute, which are HDF5 (base/child/hdf5.h). MINC 1 is netCDF. */

/** Takes the header of the volume in @p hdf5. The voxels that v->read() gives are stored ones,
 * or float64 where each slice has a scale of its own. CONUS_ERROR_UNSUPPORTED for what is no single volume of regular
 * voxels. */
void minc_from_hdf5(struct job *job, struct volume_input *v, const struct hdf5 *hdf5);

#endif
