/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The files that a TRX has, in a folder or in a zip archive. */
#ifndef CONUS_LOADERS_TRACTS_TRX_FILES_H
#define CONUS_LOADERS_TRACTS_TRX_FILES_H

#include "base/files/file_sums.h"
#include "base/files/folder.h"
#include "base/formats/zip.h"

struct trx_files {
    struct bytes *archive; /**< NULL of a folder. */
    struct zip zip;        /**< The archive's files. */
    const char *folder;
    struct names names;    /**< The folder's files: "header.json", "dps/weight.float32". */
    struct file_sums read; /**< The folder's files that were opened. */
    uint64_t left;         /**< Bytes of memory that may still be taken. */
};

/** Lists @p archive, which outlives this. CONUS_ERROR_MEMORY where it alone has more than @p max_memory bytes. */
conus_status trx_files_of_archive(struct trx_files *out, struct bytes *archive, uint64_t max_memory);
/** Lists @p folder and those in it that a TRX has. CONUS_ERROR_UNSUPPORTED for NAMES_LIMIT files or more in one. */
conus_status trx_files_of_folder(struct trx_files *out, const char *folder, uint64_t max_memory);
/** Ends either; a zeroed one is fine. */
void trx_files_finish(struct trx_files *files);

size_t trx_files_count(const struct trx_files *files);
struct text trx_files_name(const struct trx_files *files, size_t index);

/** Bytes of a file: the archive's own where it is not packed, else `owned`. */
struct trx_view {
    const uint8_t *data;
    size_t size;
    struct bytes owned;
};

/** Opens a file, verified; end it with trx_files_close(). CONUS_ERROR_MEMORY above what is left. */
conus_status trx_files_open(struct trx_view *out, struct trx_files *files, size_t index);
void trx_files_close(struct trx_view *view, struct trx_files *files);

/** Keeps the bytes of the last file that is read, instead of closing it: they begin at *at of @p out, which may be the
 * archive itself; that is empty then, and no other file is left. */
void trx_files_keep(struct bytes *out, size_t *at, struct trx_view *view, struct trx_files *files);

/** Takes @p size bytes from what is left, for @p what. CONUS_ERROR_MEMORY. */
conus_status trx_files_spend(struct trx_files *files, uint64_t size, const char *what);

#endif
