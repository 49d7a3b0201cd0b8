/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The voxels of a volume as labels or as numbers. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_VALUES_H
#define CONUS_LOADERS_VOLUMES_VOLUME_VALUES_H

#include "atlas/labels/label_voxels.h"
#include "atlas/value_map.h"
#include "loaders/volumes/volume_file.h"

/** Decodes to labels. Refuses scaled values that are not whole (tolerance_whole()), or outside 0..4294967295, naming
 * the first such voxel. @p out is the caller's to finish, and empty after a failure. Sets info.minimum and maximum. */
void volume_labels(struct job *job, struct label_voxels *out, struct volume_file *file);

/** The same in the memory of the file's voxels, where one of them has at least 2 bytes: a second copy is never there.
 * @p file has no voxels afterwards, also after a failure. */
void volume_take_labels(struct job *job, struct label_voxels *out, struct volume_file *file);

/** Decodes labels that come in pieces. */
struct label_reader {
    const struct volume_file *file; /**< Its info, datatype, byte order and max_memory, but no voxels; borrowed. */
    struct label_coder coder;
    bool is_bad; /**< A voxel is no label: the first such is kept. */
    size_t bad_voxel;
    uint8_t bad_bytes[8];
};

/** The places go to @p memory, taken over also on failure, or where its data is NULL to memory of their own; see
 * label_coder_init(). */
void label_reader_begin(struct job *job, struct label_reader *reader, const struct volume_file *file,
                        const struct bytes *memory);

/** The take of a voxel_sink, whose user is the reader: voxels in any order, where there was no memory. */
void label_reader_take(struct job *job, void *user, size_t first, const uint8_t *voxels, size_t count);

/** Gives the labels of all voxels, and @p file their range. A voxel that is no label is CONUS_ERROR_DATA, as in
 * volume_labels(). */
void label_reader_end(struct job *job, struct label_voxels *out, struct label_reader *reader, struct volume_file *file);
void label_reader_finish(struct label_reader *reader);

/** Decodes to scaled values. Values that are not finite become 0, and a note counts them. They are the caller's to
 * memory_free(); NULL after a failure. Otherwise as volume_labels(). */
float *volume_values(struct job *job, struct volume_file *file);

/** The same, but that these become NaN, which minimum and maximum disregard. CONUS_ERROR_DATA where all are. */
float *volume_values_or_nan(struct job *job, struct volume_file *file);

/** The values as a sparse map, without all values in between. @p out is the caller's to finish, and empty after a
 * failure. */
void volume_map(struct job *job, struct value_map *out, struct volume_file *file);

/** The same of volume_values_or_nan(). */
void volume_map_or_nan(struct job *job, struct value_map *out, struct volume_file *file);

/** The stored number at @p data, of the NIfTI type @p datatype, unscaled; rounded where it has more than 53 bits. */
double volume_value_at(const uint8_t *data, int datatype, bool swapped);

#endif
