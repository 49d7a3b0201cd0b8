/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Files for the volume tests, built in memory so that every field can be changed. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_NIFTI_BUILDER_H
#define CONUS_TESTS_SUPPORT_BUILDERS_NIFTI_BUILDER_H

#include "base/memory.h"
#include "base/status.h"

#include <stdint.h>

struct nifti_builder {
    struct buffer bytes;
    int version;
    bool big; /**< Byte order of the file. */
    int datatype;
};

/** A valid header with its extender: @p dim voxels of 2 x 3 x 4 mm, sform code 4 = diag(2, 3, 4) with origin
 * (-10, -20, -30), no qform, slope 0. End with buffer_finish(&builder->bytes). */
void nifti_begin(struct nifti_builder *builder, int version, bool big, int datatype, const int64_t dim[3]);

/** Sets element @p index of the field that nifti1.h calls @p name ("srow" = the three rows in a row). */
void nifti_set(struct nifti_builder *builder, const char *name, size_t index, double value);

/** Appends an extension with @p esize as its size field and @p size bytes of @p data, and moves vox_offset. */
void nifti_extend(struct nifti_builder *builder, int esize, int ecode, const void *data, size_t size);

/** Appends @p value as a voxel of the datatype. */
void nifti_voxel(struct nifti_builder *builder, double value);
/** The same for 64-bit integers that no double holds. */
void nifti_voxel_bits(struct nifti_builder *builder, uint64_t bits);

/** Appends the @p size low bytes of @p bits in the given byte order. */
void append_ordered(struct buffer *buffer, uint64_t bits, size_t size, bool big);
/** Appends @p value as float32. */
void append_float(struct buffer *buffer, double value, bool big);

/** Appends @p size bytes of @p data as one gzip member. */
void append_gzip(struct buffer *buffer, const void *data, size_t size);

/** Writes a scratch file, as it is or as one gzip member, and returns its path (as test_scratch() does). */
const char *write_bytes(const char *name, const struct buffer *bytes);
const char *write_packed(const char *name, const struct buffer *bytes);

#endif
