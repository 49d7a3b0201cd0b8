/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Writes small CIFTI files of labels (.dlabel.nii) for tests, right or wrong ones. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_CIFTI_BUILDER_H
#define CONUS_TESTS_SUPPORT_BUILDERS_CIFTI_BUILDER_H

#include "base/memory.h"

enum { CIFTI_GRAYORDINATES = 9, CIFTI_MAPS = 2 };

/** Differences from the file below; zero is the default of each. */
struct cifti_spec {
    const char *find, *replace; /**< In the XML, once.                                        */
    const char *field;          /**< Field of the header, as nifti_set() calls it, gets this value: */
    size_t index;
    double value;
    int datatype;         /**< float32 */
    bool big;             /**< Byte order.                                                    */
    const double *values; /**< [9][2]                                                         */
};

/** Appends a file of two maps, "one" and "two", with the labels 5 A (red), 7 Thalamus, 8 B and 0.
 * Grayordinates 0 to 2: CortexLeft, vertices 0 1 2 of 4; labels 5 5 5, in map two 8 8 8.
 * 3 to 6: CortexRight, vertices 0 1 2 3 of 4; labels 5 5 8 8, in map two 0.
 * 7, 8: voxels (0 0 0) and (1 2 1) of the left thalamus, in 2 x 3 x 2 voxels of 2 mm; label 7, in map two 0. Voxel i,
 * j, k lies at 90 - 2 i, 2 j - 126, 2 k - 72 mm. */
void cifti_build(struct buffer *out, const struct cifti_spec *spec);

#endif
