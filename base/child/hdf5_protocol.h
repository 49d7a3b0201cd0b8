/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The stream that conus-hdf5 writes. All numbers are little-endian.
 *
 *     conus-hdf5 BYTES PATTERN...     with the HDF5 file as descriptor 3
 *
 * BYTES is the most that it may write. A PATTERN is an absolute path, in which a whole name may be "*": any; the last
 * may be "**": the object before it, and all that is below, at any depth.
 *
 * Stream: char[8] "CONUSH51", then frames, each a multiple of 8 bytes:
 *
 *     u32 kind (enum hdf5_frame_kind), u32 class (enum hdf5_class), u32 size, u32 rank, u64 address, u64 dims[8],
 *     u32 bytes of the name, u32 0, u64 bytes of the data, then the name, zeros up to a multiple of 8,
 *     the data, zeros up to a multiple of 8
 *
 * An object's name is its path, its address its place in the file: what references to it hold. An attribute is of the
 * object before it. Dims behind the rank are 0; rank 0 is one element. Numbers have `size` bytes, references 8, as
 * unsigned numbers. Strings have size 0; their data are u64[count + 1] begins, the last the end, counted from behind
 * these, and the bytes. Objects of other classes (groups, compounds, and so on) have neither size nor data. A failure's
 * name says what is wrong, in one line, and its rank what kind of failure it is: 1 = a limit of memory, 0 = another.
 * The last frame is HDF5_FRAME_END, its address the number of frames before it. */
#ifndef CONUS_BASE_CHILD_HDF5_PROTOCOL_H
#define CONUS_BASE_CHILD_HDF5_PROTOCOL_H

#define HDF5_STREAM_MAGIC "CONUSH51"

enum { HDF5_MAGIC_SIZE = 8, HDF5_FRAME_HEADER_SIZE = 104, HDF5_RANK_LIMIT = 8, HDF5_NAME_LIMIT = 4096 };
enum { HDF5_FRAME_LIMIT = 1 << 18 }; /**< Frames of one stream. */

enum hdf5_frame_kind { HDF5_FRAME_OBJECT = 1, HDF5_FRAME_ATTRIBUTE = 2, HDF5_FRAME_FAILURE = 3, HDF5_FRAME_END = 4 };

enum hdf5_class {
    HDF5_GROUP = 1,
    HDF5_FLOAT,  /**< 4 or 8 bytes. */
    HDF5_SIGNED, /**< 1, 2, 4 or 8 bytes; also of enumerations. */
    HDF5_UNSIGNED,
    HDF5_STRING,
    HDF5_REFERENCE, /**< To an object. */
    HDF5_OTHER      /**< Nothing that is read. */
};

#endif
