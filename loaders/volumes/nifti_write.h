/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Volumes as NIfTI-1 (nifti1.h, https://nifti.nimh.nih.gov/nifti-1). */
#ifndef CONUS_LOADERS_VOLUMES_NIFTI_WRITE_H
#define CONUS_LOADERS_VOLUMES_NIFTI_WRITE_H

#include "atlas/space.h"
#include "base/job/job.h"
#include "conus/own.h"

/** Writes @p labels (one per voxel of @p info, i fastest) as a little-endian single file in the narrowest of uint8,
 * uint16 and uint32 that holds them all, intent "label". dim and world_from_voxel of @p info are used: the sform
 * always, with code @p code; the qform too where the matrix has no shear. Same input, same bytes: no time stamps.
 * The file is the job's; empty after a failure. CONUS_ERROR_ARGUMENT for a grid that NIfTI-1 cannot hold (1 to 32767
 * voxels an edge) or a matrix that is not finite as float. */
struct bytes nifti_format_labels(struct job *job, const conus_volume_info *info, const uint32_t *labels, int code);

/** The same without intent, for values that are no labels. */
struct bytes nifti_format_values(struct job *job, const conus_volume_info *info, const uint32_t *values, int code);

/** The numbers of @p grid in their own type; otherwise the same, with the grid's code and description. */
struct bytes nifti_format_grid(struct job *job, const conus_grid *grid);

/** Writes maps of sites that are voxels of @p grid as float32: a volume for each along the fourth axis, NaN in all
 * other voxels. A comment behind the header (ecode 6) has their names, one a line. @p voxels, [site_count], has the
 * voxels of the values of @p maps, [count]. Otherwise the same. */
struct bytes nifti_format_maps(struct job *job, const conus_grid_view *grid, const conus_vertex_map *maps, size_t count,
                               const uint64_t *voxels, size_t site_count);

/** Writes a file, packed where its name ends in .gz. */
void nifti_write(struct job *job, const char *path, const struct bytes *file);

/** Whether a name ends in .nii or .nii.gz. */
bool nifti_is_name(const char *path);

/** Packs as one gzip member without name or time, into the job's memory. */
struct bytes gzip_format(struct job *job, const void *data, size_t size);

#endif
