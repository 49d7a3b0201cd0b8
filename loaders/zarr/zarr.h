/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * An array of Zarr 3 or 2: a file of metadata, and files of chunks beside it. Everything that the metadata say is
 * checked before memory is taken for a voxel. */
#ifndef CONUS_LOADERS_ZARR_ZARR_H
#define CONUS_LOADERS_ZARR_ZARR_H

#include "base/formats/packed.h"
#include "base/job/job.h"

enum {
    ZARR_AXES = 5,              /**< At most: OME has t, c, z, y, x. */
    ZARR_CODECS = 4,            /**< Packings of a chunk. */
    ZARR_AROUND = 16,           /**< Bytes of the sums that may be around an unpacked chunk. */
    ZARR_JSON_LIMIT = 16 << 20, /**< Bytes of a file of metadata. */
    ZARR_NAME = 24              /**< Bytes of the name of a type or a codec in a message. */
};

enum zarr_packing { ZARR_ZSTD, ZARR_GZIP, ZARR_ZLIB, ZARR_BLOSC, ZARR_CRC32C };

/** How the numbers of a chunk become bytes. */
struct zarr_chain {
    uint8_t order[ZARR_AXES]; /**< Stored axis i is axis order[i] of the array; the last stored one is the fastest. */
    bool swapped;             /**< Numbers have the other byte order than this machine's. */
    enum zarr_packing packings[ZARR_CODECS]; /**< [count] In the order of packing; one of them compresses at most. */
    size_t count;
};

struct zarr_array {
    int format;                                       /**< 2 or 3. */
    size_t rank;                                      /**< Axes, 3 to ZARR_AXES; the last three are space. */
    uint64_t shape[ZARR_AXES], file_chunk[ZARR_AXES]; /**< Voxels, 1 to 2^31 - 1: of all, and in a file. */
    uint64_t chunk[ZARR_AXES];                        /**< Size of the packed unit; a shard's file has several. */
    size_t chunk_bytes;                               /**< Unpacked; one at the edge is stored whole. */
    char kind;                                        /**< 'u' unsigned, 'i' signed, 'f' floating point. */
    size_t size;                                      /**< Bytes of a number: 1, 2, 4 or 8. */
    bool has_fill;
    uint8_t fill[8]; /**< The value of missing chunks, in its stored form. */
    bool prefixed;   /**< Keys begin with "c". */
    char separator;
    struct zarr_chain chain;
    bool sharded, index_first; /**< A file has several chunks, and an index of them. */
    struct zarr_chain index;
};

/** Parses zarr.json of an array, or .zarray. CONUS_ERROR_UNSUPPORTED names a codec or an extension that is not read,
 * CONUS_ERROR_DATA what is wrong. */
void zarr_array_parse(struct job *job, struct zarr_array *out, struct text text);

struct zarr_unpacker;

/** Scratch of the job for unpacking chunks. */
struct zarr_unpacker *zarr_unpacker_new(struct job *job);

/** Unpacks what @p chain packed as @p stored, which must give exactly @p wanted bytes. @p out has room for ZARR_AROUND
 * more. */
void zarr_unpack(struct job *job, uint8_t *out, struct zarr_unpacker *unpacker, const struct zarr_chain *chain,
                 struct bytes stored, size_t wanted);

/** Facts about an array that was read. */
struct zarr_found {
    uint64_t files, wanted; /**< Files of chunks: those there are, and all possible ones. */
    char sha256[65];        /**< Sum of sha256sum's lines about the files of chunks, in the order of space. */
};

/** Takes @p count voxels along the last axis, as they are stored; the first is voxel @p first of the volume, of which
 * the last axis is the fastest. */
typedef void zarr_take(struct job *job, void *user, size_t first, const uint8_t *voxels, size_t count);

/** Reads the volume @p volume, from 0, of the array in @p folder: of the axes ahead of space, the last is the fastest.
 * @p take gets the voxels chunk by chunk, each row of a chunk once; voxels that it does not get are zeros. What is held
 * in memory meanwhile is a chunk, and the index of a shard; more than job->max_memory of it is CONUS_ERROR_MEMORY, an
 * array without any chunk CONUS_ERROR_DATA. */
struct zarr_found zarr_read(struct job *job, const struct zarr_array *array, const char *folder, uint64_t volume,
                            zarr_take *take, void *user);

/* OME's metadata of a Zarr group: the levels of an image and where they lie. */

struct ome_level {
    char *path;      /**< Path of its array, below the group's folder. */
    double scale[3]; /**< mm a voxel along the axes of space, in their order; 0 = not stated, or without a unit. */
    double translation[3]; /**< mm: where the centre of the first voxel lies. */
};

struct ome {
    struct ome_level *levels;
    size_t count;
    size_t rank;         /**< Axes; 0 = not stated. */
    char orientation[4]; /**< Where the axes of space start, "asr"; empty = not stated.  */
};

/** Parses zarr.json of a group (OME 0.5, 0.6), or .zattrs (OME up to 0.4). No image in it is CONUS_ERROR_DATA; @p out
 * has no levels then, else they are the job's. */
void ome_parse(struct job *job, struct ome *out, struct text text);

#endif
