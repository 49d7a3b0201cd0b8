/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Builds streams of conus-hdf5, valid or not (base/child/hdf5_protocol.h). */
#ifndef CONUS_TESTS_SUPPORT_HDF5_BUILDER_H
#define CONUS_TESTS_SUPPORT_HDF5_BUILDER_H

#include "base/child/hdf5_protocol.h"
#include "base/memory.h"

struct hdf5_builder {
    struct buffer bytes;
    uint64_t frames;
};

/** A frame with these values, whether or not they fit together. */
struct built_value {
    enum hdf5_frame_kind kind;
    enum hdf5_class class;
    uint32_t size, rank;
    uint64_t dims[HDF5_RANK_LIMIT];
    uint64_t address;
    const char *name;
    const void *data;
    uint64_t data_size;
};

void hdf5_begin(struct hdf5_builder *builder);
void hdf5_frame(struct hdf5_builder *builder, struct built_value value);
/** An object or attribute of @p count doubles, in one dimension. */
void hdf5_doubles(struct hdf5_builder *builder, enum hdf5_frame_kind kind, const char *name, const double *values,
                  size_t count);
/** One of @p count strings. */
void hdf5_strings(struct hdf5_builder *builder, enum hdf5_frame_kind kind, const char *name, const char *const *texts,
                  size_t count);
void hdf5_group(struct hdf5_builder *builder, const char *path);
void hdf5_end(struct hdf5_builder *builder);

#endif
