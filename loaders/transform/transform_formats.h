/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The formats of transform_file_read(), each from the bytes of a file to a transform of RAS mm. */
#ifndef CONUS_LOADERS_TRANSFORM_TRANSFORM_FORMATS_H
#define CONUS_LOADERS_TRANSFORM_TRANSFORM_FORMATS_H

#include "base/status.h"
#include "base/text.h"
#include "conus/atlas_info.h"
#include "loaders/transform/transform_chain.h"

/** One transform in a file of ITK, as stored: points are LPS. */
struct itk_entry {
    struct text type; /**< "AffineTransform_double_3_3"; points into the file. */
    double *parameters, *fixed;
    size_t count, fixed_count;
    bool has_parameters, has_fixed; /**< A composite has neither. */
};

/** Adds an affine or a B-spline as a step before those of @p chain. CONUS_ERROR_DATA for numbers that do not fit the
 * type, CONUS_ERROR_UNSUPPORTED for other types. */
conus_status itk_chain_add(struct transform_chain *chain, const struct itk_entry *entry);

/** @name ITK (ANTs, 3D Slicer, elastix): text, and MATLAB's level 4. Fills @p chain, which was begun: from the only
 * entry, from the entries of a composite, where points go through the last one first, or from entry @p chosen - 1; 0 =
 * none is chosen. Errors as itk_chain_add(), CONUS_ERROR_UNSUPPORTED for several entries where none is chosen, and
 * CONUS_ERROR_ARGUMENT. Finish the chain also after a failure. @{ */
bool itk_text_is(struct text text);
conus_status itk_text_parse(struct transform_chain *chain, struct text text, size_t chosen);
bool itk_matlab_is(const uint8_t *data, size_t size);
conus_status itk_matlab_parse(struct transform_chain *chain, const uint8_t *data, size_t size);
/** @} */

/** Whether the type of a transform, "AffineTransform_double_3_3", is @p type, "AffineTransform", in 3-D. */
bool itk_is_type(struct text name, const char *type);
bool itk_is_composite(struct text name);

/** FLIRT's coordinates of a voxel: mm along the axes from the first one, x turned around where the axes are
 * right-handed in RAS ("neurological"). */
void flirt_from_voxel(double out[16], const conus_volume_info *info);

#endif
