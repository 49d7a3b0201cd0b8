/* SPDX-License-Identifier: BSD-3-Clause */
/** @file TrackVis files, field by field. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_TRK_BUILDER_H
#define CONUS_TESTS_SUPPORT_BUILDERS_TRK_BUILDER_H

#include "base/memory.h"

/** Offsets of fields, as the format's description has them. */
enum {
    TRK_DIM = 6,
    TRK_VOXEL_SIZE = 12,
    TRK_N_SCALARS = 36,
    TRK_SCALAR_NAME = 38,
    TRK_N_PROPERTIES = 238,
    TRK_PROPERTY_NAME = 240,
    TRK_VOX_TO_RAS = 440,
    TRK_VOXEL_ORDER = 948,
    TRK_N_COUNT = 988,
    TRK_VERSION = 992,
    TRK_HDR_SIZE = 996
};

struct trk_builder {
    struct buffer bytes;
    bool big; /**< Byte order; set it before trk_begin(). */
};

/** A header of version 2: 10 x 20 x 30 voxels of 1 mm, RAS, the identity, no scalars, no count. */
void trk_begin(struct trk_builder *builder);

void trk_put_i16(struct trk_builder *builder, size_t offset, int value);
void trk_put_i32(struct trk_builder *builder, size_t offset, int64_t value);
/** Puts @p size bytes of @p text. */
void trk_put_text(struct trk_builder *builder, size_t offset, const char *text, size_t size);

/** Appends the number of points of a streamline, or any number. */
void trk_append_i32(struct trk_builder *builder, int64_t value);
/** Appends @p count floats. */
void trk_append_floats(struct trk_builder *builder, const double *values, size_t count);

#endif
