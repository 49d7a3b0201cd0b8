/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A packed 4-D file that is large enough for an index, and the index in the user's cache folder. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_SERIES_BUILDER_H
#define CONUS_TESTS_SUPPORT_BUILDERS_SERIES_BUILDER_H

#include "base/buffer.h"
#include "loaders/volumes/volume_file.h"

/** 17 volumes of 1 MiB, whose noise packs to about 0.8 of it: SERIES_MEMORY holds a volume, but not the packed file. */
enum {
    SERIES_EDGE = 128,
    SERIES_PLANES = 64,
    SERIES_COUNT = 17,
    SERIES_VOLUME = SERIES_EDGE * SERIES_EDGE * SERIES_PLANES,
    SERIES_HEAD = 352,
    SERIES_MEMORY = 5 << 20,
    SERIES_TRAILER_AT = 24, /**< In the bytes of an index: where the file's checksum is, and */
    SERIES_POINTS_AT = 136  /**< ... the points. */
};

/** Voxel @p i of volume @p volume. */
uint8_t series_voxel(size_t volume, size_t i);

/** Writes the file whose volume k is series_voxel(@p first + k), in members of @p member unpacked bytes. */
const char *series_make(const char *name, size_t first, size_t member);

/** Formats whose header is text, packed as a whole, behind the header, or in a file of their own. */
enum series_form {
    SERIES_BRIK,
    SERIES_NRRD_WHOLE,
    SERIES_NRRD,
    SERIES_NRRD_APART,
    SERIES_METAIMAGE,
    SERIES_METAIMAGE_APART,
    SERIES_FORMS
};

/** Writes the same series as a file of @p form, and if need be another; returns the path to open. */
const char *series_make_as(enum series_form form, size_t first);

/** The path of the voxels of the file @p path that series_make_as() wrote; static. */
const char *series_voxels_of(const char *path, enum series_form form);

/** Opens volume 0 of @p path as if the file had not changed for long, which makes and keeps an index. */
void series_open_rested(const char *path);

/** The path of the series from volume 0 on in one member, which is made once: for tests that only read it. */
const char *series_path(void);

/** Opens a volume; there are no notes. */
conus_status series_open(struct volume_file *out, const char *path, size_t volume, bool cache);
void series_assert(const struct volume_file *file, size_t number);

/** Opens a volume of the series from 0 on without memory for all of the file, asserts its voxels, and returns whether
 * that succeeds. */
bool series_opens_by_index(const char *path, size_t volume);

/** Opens volume @p volume with enough memory, and asserts that it is series_voxel(@p first + @p volume), whatever its
 * index is. */
void series_assert_opens(const char *path, size_t volume, size_t first);

/** Unpacks the file, as if it had not changed for long if @p rested, and keeps its index. */
void series_index(const char *path, bool rested);

/** Whether there is a valid index. */
bool series_is_indexed(const char *path);

/** Makes the index of series_path() unless it is there. */
void series_need_index(void);

/** The path of the only index in the cache; "" if there is none; static. */
const char *series_entry(void);

/** Overwrites the bytes of the file, which stays the same file. */
void overwrite_file(const char *path, const void *data, size_t size);

/** Writes the entry @p bytes with @p packed in the place of its index, with valid checksums. */
void series_forge(const char *entry, const struct bytes *bytes, const uint8_t *packed);

/** Appends a gzip member, packed fast. */
void append_fast_gzip(struct buffer *out, const char *data, size_t size);

#endif
