/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A stack of pages in a TIFF or BigTIFF file: strips or tiles, plain, LZW or deflate, one number a pixel. All of a
 * file's directories are checked against its size before anything is allocated for its pixels. */
#ifndef CONUS_LOADERS_TIFF_TIFF_H
#define CONUS_LOADERS_TIFF_TIFF_H

#include "base/job/job.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TIFF_PAGE_LIMIT = 1 << 16 };

/** A whole file in memory. */
struct tiff_file {
    const uint8_t *data; /**< Not owned. */
    size_t size;
    bool swapped; /**< Its numbers have the other byte order than this machine's. */
    bool big;     /**< BigTIFF: offsets of 8 bytes. */
};

enum tiff_compression { TIFF_PLAIN = 1, TIFF_LZW = 5, TIFF_DEFLATE = 8 };
enum tiff_format { TIFF_UNSIGNED = 1, TIFF_SIGNED = 2, TIFF_FLOAT = 3 };

/** Whole numbers of 1, 2, 4 or 8 bytes that lie in the file one after the other, all of them inside it. */
struct tiff_list {
    uint64_t at;
    uint64_t count; /**< 0 = the directory has no such field. */
    size_t size;    /**< Bytes of each. */
};

/** The contents of a directory. Strips are chunks as wide as the page, the last of them cut off at its end; tiles are
 * chunks that are stored whole and may reach beyond it. */
struct tiff_page {
    uint64_t width, length; /**< Pixels, 1 to 2^31 - 1. */
    unsigned bits;          /**< Bits of a pixel: 8, 16, 32 or 64. */
    enum tiff_format format;
    enum tiff_compression compression;
    bool differences; /**< Predictor 2: of each pixel from the one before it in the row. */
    bool tiled;
    uint64_t chunk_width, chunk_length; /**< Pixels. */
    uint64_t across, down;              /**< Chunks in a row of them, and rows of them. */
    struct tiff_list offsets, counts;   /**< [across * down]: where each lies, and its stored bytes. */
    struct text description;            /**< Inside the file. */
};

struct tiff {
    struct tiff_file file;
    LIST(struct tiff_page) pages; /**< All of one size and type; the job's. */
    uint64_t depth; /**< Pages in the stack: pages.count, or what ImageJ says where it has one directory for all. */
    uint64_t page_bytes; /**< Unpacked. */
    bool whole;          /**< The pages lie plain and in order, without a gap, from `start` on. */
    uint64_t start;
};

/** Reads the directories of @p data, a whole file that must outlive @p out. Errors name page and field. A stack that
 * its file could not possibly hold is CONUS_ERROR_DATA. */
void tiff_parse(struct job *job, struct tiff *out, const uint8_t *data, size_t size);

/** Unpacks @p count pages from @p first on, which have directories, into @p out: one behind the other, rows from the
 * top, in the byte order of the file, count * page_bytes bytes. */
void tiff_unpack(struct job *job, uint8_t *out, const struct tiff *tiff, size_t first, size_t count);

/* LZW as TIFF 6.0 has it: codes of 9 to 12 bits, the highest bit first. */

enum { TIFF_LZW_CODES = 4096 };

/** The strings behind the codes; needs no beginning and no end. */
struct tiff_lzw {
    uint16_t before[TIFF_LZW_CODES]; /**< Code of the string without its last byte. */
    uint16_t length[TIFF_LZW_CODES];
    uint8_t first[TIFF_LZW_CODES], last[TIFF_LZW_CODES];
};

/** Unpacks exactly @p size bytes; false where @p packed is damaged, or holds fewer or more. */
bool tiff_lzw_unpack(uint8_t *out, size_t size, const uint8_t *packed, size_t packed_size, struct tiff_lzw *lzw);

#endif
