/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Several transforms that points go through in turn, and the formats that have them: composites of ITK (ANTs,
 * fMRIPrep) and X5. */
#ifndef CONUS_LOADERS_TRANSFORM_TRANSFORM_CHAIN_H
#define CONUS_LOADERS_TRANSFORM_TRANSFORM_CHAIN_H

#include "atlas/deformation/deformation.h"
#include "base/child/hdf5.h"
#include "conus/atlas.h"

/** The result of all steps: one affine, or fields of which all affines are parts. Points are RAS mm. */
struct transform_chain {
    double matrix[16];          /**< The affine. One before the fields becomes a part of them at the end. */
    struct deformation *fields; /**< [count] Points go through the last one first. Measured when it is whole. */
    size_t count;
};

void transform_chain_finish(struct transform_chain *chain);

/** @name Steps. A chain begins with chain_begin(); each step is one that points go through *before* those that are
 * there; chain_end() makes it whole. Finish it also after a failure.
 * @{ */
void chain_begin(struct transform_chain *chain);
/** CONUS_ERROR_DATA for a matrix that cannot be inverted. */
void chain_add_matrix(struct job *job, struct transform_chain *chain, const double m[16]);
/** A field on @p dim nodes at @p world_from_voxel, whose vectors are still to be set: the chain's; NULL after a
 * failure. Vectors are added to the place of a node if they are displacements; else they are positions. */
struct deformation *chain_add_field(struct job *job, struct transform_chain *chain, const size_t dim[3],
                                    const double world_from_voxel[16], bool displacements);
/** Sets number @p place of the vectors, as a whole double; false where it is not finite. */
bool chain_set_number(struct job *job, struct deformation *field, size_t place, double number);
/** Takes over a field whose places, base and linear are set: the affines that are there become a part of it. */
void chain_push(struct job *job, struct transform_chain *chain, struct deformation *field);
void chain_end(struct job *job, struct transform_chain *chain);
/** @} */

/** @name Formats of several steps. They fill a chain that was begun. @{ */

/** One transform in a file of ITK, as stored: points are LPS. */
struct itk_entry {
    struct text type; /**< "AffineTransform_double_3_3". */
    LIST(double) parameters, fixed;
    bool has_parameters, has_fixed; /**< A composite has neither. */
};

/** Adds an affine or a B-spline as a step before those of @p chain. CONUS_ERROR_DATA for numbers that do not fit the
 * type, CONUS_ERROR_UNSUPPORTED for other types. */
void itk_chain_add(struct job *job, struct transform_chain *chain, const struct itk_entry *entry);

/** ITK (ANTs, 3D Slicer, elastix) as text: the only entry, the entries of a composite, where points go through the last
 * one first, or entry @p chosen - 1; 0 = none is chosen. Errors as itk_chain_add(), CONUS_ERROR_UNSUPPORTED for several
 * entries where none is chosen, and CONUS_ERROR_ARGUMENT. */
void itk_text_parse(struct job *job, struct transform_chain *chain, struct text text, size_t chosen);
/** The same as MATLAB's level 4, which has one entry. */
void itk_matlab_parse(struct job *job, struct transform_chain *chain, const uint8_t *data, size_t size);

/** Whether the type of a transform, "AffineTransform_double_3_3", is @p type, "AffineTransform", in 3-D. */
bool itk_is_type(struct text name, const char *type);
bool itk_is_composite(struct text name);

/** Composites in HDF5. They give one line: what the file is, and the steps as points go through them. */
const char *itk_hdf5_parse(struct job *job, struct transform_chain *chain, const struct hdf5 *hdf5);
bool x5_is(const struct hdf5 *hdf5);
const char *x5_parse(struct job *job, struct transform_chain *chain, const struct hdf5 *hdf5);

/** The groups of /TransformGroup, which must be called 0, 1, 2, …, in this order; 0 of them after a failure. */
const struct hdf5_object **chain_groups(struct job *job, size_t *count, const struct hdf5 *hdf5);
/** @} */

/** FLIRT's coordinates of a voxel: mm along the axes from the first one, x turned around where the axes are
 * right-handed in RAS ("neurological"). */
void flirt_from_voxel(double out[16], const conus_volume_info *info);

#endif
