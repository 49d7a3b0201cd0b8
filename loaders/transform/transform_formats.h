/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The formats of transform_file_read(), each from the bytes of a file to a matrix in RAS mm. */
#ifndef CONUS_LOADERS_TRANSFORM_TRANSFORM_FORMATS_H
#define CONUS_LOADERS_TRANSFORM_TRANSFORM_FORMATS_H

#include "base/status.h"
#include "base/text.h"
#include "conus/atlas_info.h"

/* ITK (ANTs, 3D Slicer, elastix): text, and MATLAB's level 4. Points are LPS there. */
bool itk_text_is(struct text text);
conus_status itk_text_parse(double out[16], struct text text);
bool itk_matlab_is(const uint8_t *data, size_t size);
conus_status itk_matlab_parse(double out[16], const uint8_t *data, size_t size);

/** FLIRT's coordinates of a voxel: mm along the axes from the first one, x turned around where the axes are
 * right-handed in RAS ("neurological"). */
void flirt_from_voxel(double out[16], const conus_volume_info *info);

#endif
