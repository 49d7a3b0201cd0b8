/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * conus-hdf5: the one program that links libhdf5. It says what lies at some paths of an HDF5 file, as a stream of
 * frames on stdout (base/child/hdf5_protocol.h). It opens no other file. */
#ifndef CONUS_HDF5_CONUS_HDF5_H
#define CONUS_HDF5_CONUS_HDF5_H

#include "base/child/hdf5_protocol.h"
#include "memory_limit.h"

#include <hdf5.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** The fields of a frame that describe an object or an attribute. */
struct description {
    enum hdf5_frame_kind kind;
    enum hdf5_class class;
    uint32_t size, rank;
    uint64_t address;
    uint64_t dims[HDF5_RANK_LIMIT];
    const char *name;
};

/** Begins the stream, which may have @p limit bytes. */
void stream_begin(uint64_t limit);

/** How many bytes it may still have. */
uint64_t stream_left(void);

/** Begins a frame with @p size bytes of data, which stream_data() then writes, and stream_pad() ends. */
void stream_frame(const struct description *what, uint64_t size);
void stream_data(const void *data, size_t size);
void stream_pad(uint64_t size);

/** Ends the stream, and the program. */
_Noreturn void stream_end(void);

/** Ends the stream with a failure in one line, and the program. @p is_limit: of memory. */
_Noreturn void refuse(bool is_limit, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** The same, of the object at @p path: what libhdf5 says of it. */
_Noreturn void refuse_damaged(const char *path, const char *action);

/** Writes a dataset, and nothing of its attributes. */
void write_dataset(const struct description *what, hid_t dataset);

/** Writes the attribute @p name of @p object, whose path is @p path. */
void write_attribute(const char *path, hid_t object, const char *name);

/** Writes the objects that @p pattern names, and their attributes. */
void write_objects(hid_t file, const char *pattern);

#endif
