/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Joins the formats whose header is text (loaders/volumes/text) to volume_file.c: NRRD, MetaImage and AFNI. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_TEXT_H
#define CONUS_LOADERS_VOLUMES_VOLUME_TEXT_H

#include "base/notes.h"
#include "loaders/volumes/stored/stored_file.h"
#include "loaders/volumes/text/header_text.h"
#include "loaders/volumes/text/text_volume.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_header.h"
#include "sources/format.h"

enum {
    VOLUME_TEXT_HEAD = HEADER_TEXT_LIMIT
}; /**< Bytes that volume_text_parse() wants to see, if there are as many. */

/** Reads the header of @p format (FORMAT_NRRD, FORMAT_METAIMAGE, FORMAT_AFNI) at the start of @p head. out->text is the
 * caller's to finish. */
conus_status volume_text_parse(struct volume_header *out, enum format_id format, const struct bytes *head,
                               struct notes *notes);

/** The same of a file, packed or not. */
conus_status volume_text_parse_stored(struct volume_header *out, enum format_id format, const struct stored *stored,
                                      struct notes *notes);

/** Finishes and frees *text, which may be NULL. */
void volume_text_finish(struct text_volume **text);

/** The header file of the AFNI data set whose voxels are @p path, by its name; the caller's to memory_free(). NULL for
 * another kind of file. */
conus_status volume_text_head_path(char **out, const char *path);

/** The file of the voxels of the header @p path, the caller's to memory_free(); NULL where they lie behind the header.
 * One that is not there is CONUS_ERROR_IO. */
conus_status volume_text_data_path(char **out, const struct text_volume *text, const char *path);

/** Bytes that decoding takes beyond the voxels that are wanted. */
uint64_t volume_text_scratch(const struct volume_header *header);

/** Whether the voxels are packed, one volume behind the other; @p packed: their file is, as a whole. */
bool volume_text_is_packed(const struct volume_header *header, bool packed);

/** ", gzip", ", text" or "": how the voxels are stored. */
const char *volume_text_encoding(const struct volume_header *header);

/** Reads the chosen volume, or @p all, from their file; @p range has the sink, if any, and gets the bytes behind them.
 */
conus_status volume_text_voxels(struct bytes *out, struct gzip_range *range, const struct volume_header *header,
                                struct stored *stored, bool all);

/** SHA-256 of @p header, unless it is NULL, and @p voxels after it. */
void volume_text_sha256(char out[65], const struct bytes *header, const struct bytes *voxels);

/** Sets title and slope of the chosen volume. */
void volume_text_choose(struct volume_file *file);

#endif
