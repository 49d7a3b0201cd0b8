/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Several transforms that points go through in turn, and the formats that have them: composites of ITK (ANTs,
 * fMRIPrep) and X5, both HDF5. */
#ifndef CONUS_LOADERS_TRANSFORM_TRANSFORM_CHAIN_H
#define CONUS_LOADERS_TRANSFORM_TRANSFORM_CHAIN_H

#include "atlas/deformation/deformation.h"
#include "base/buffer.h"
#include "base/child/hdf5.h"
#include "conus/atlas_info.h"

/** The result of all steps: one affine, or fields of which all affines are parts. Points are RAS mm. */
struct transform_chain {
    double matrix[16];          /**< The affine. One before the fields becomes a part of them at the end. */
    struct deformation *fields; /**< [count] Points go through the last one first. Measured when it is whole. */
    size_t count;
};

void transform_chain_finish(struct transform_chain *chain);

/** @name Steps. A chain begins with chain_begin(); each step is one that points go through *before* those that are
 * there; chain_end() makes it whole.
 * @{ */
void chain_begin(struct transform_chain *chain);
/** CONUS_ERROR_DATA for a matrix that cannot be inverted. */
conus_status chain_add_matrix(struct transform_chain *chain, const double m[16]);
/** A field on @p dim nodes at @p world_from_voxel, both checked, whose vectors are still to be set: *out is the
 * chain's. Vectors are added to the place of a node if they are displacements; else they are positions. */
conus_status chain_add_field(struct deformation **out, struct transform_chain *chain, const size_t dim[3],
                             const double world_from_voxel[16], bool displacements, uint64_t max_memory);
/** Sets number @p place of the vectors, as a whole double. False where it is not finite, or there is no memory (then
 * *status says so). */
bool chain_set_number(conus_status *status, struct deformation *field, size_t place, double number);
/** Takes over a field whose places, base and linear are set: the affines that are there become a part of it. */
conus_status chain_push(struct transform_chain *chain, struct deformation *field);
conus_status chain_end(struct transform_chain *chain);
/** @} */

/** @name The formats. @p words gets one line: what the file is, and the steps as points go through them.
 * @{ */
conus_status itk_hdf5_parse(struct transform_chain *chain, const struct hdf5 *hdf5, uint64_t max_memory,
                            struct buffer *words);
bool x5_is(const struct hdf5 *hdf5);
conus_status x5_parse(struct transform_chain *chain, const struct hdf5 *hdf5, uint64_t max_memory,
                      struct buffer *words);
/** The groups of /TransformGroup, which must be called 0, 1, 2, …, in this order; memory_free() the list. */
conus_status chain_groups(const struct hdf5_object ***out, size_t *count, const struct hdf5 *hdf5);
/** @} */

#endif
