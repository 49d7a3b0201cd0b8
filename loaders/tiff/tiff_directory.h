/* SPDX-License-Identifier: BSD-3-Clause */
/** @file One directory of a TIFF file: what it says about its page, and where the page's strips or tiles lie. */
#ifndef CONUS_LOADERS_TIFF_TIFF_DIRECTORY_H
#define CONUS_LOADERS_TIFF_TIFF_DIRECTORY_H

#include "base/status.h"
#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

/** What a directory says. Strips are chunks as wide as the page, the last of them cut off at its end; tiles are chunks
 * that are stored whole and may reach beyond it. */
struct tiff_page {
    uint64_t width, length; /**< Pixels, 1 to 2^31 - 1. */
    unsigned bits;          /**< Of a pixel: 8, 16, 32 or 64. */
    enum tiff_format format;
    enum tiff_compression compression;
    bool differences; /**< Predictor 2: of each pixel from the one before it in the row. */
    bool tiled;
    uint64_t chunk_width, chunk_length; /**< Pixels. */
    uint64_t across, down;              /**< Chunks in a row of them, and rows of them. */
    struct tiff_list offsets, counts;   /**< [across * down]: where each lies, and its stored bytes. */
    struct text description;            /**< Inside the file. */
};

/** Whether @p size bytes from @p at on are inside the file. */
bool tiff_has(const struct tiff_file *file, uint64_t at, uint64_t size);

/** The number of @p size bytes (1, 2, 4, 8) at @p at, which is inside the file. */
uint64_t tiff_number(const struct tiff_file *file, uint64_t at, size_t size);

/** Element @p index of a list. */
uint64_t tiff_list_at(const struct tiff_file *file, const struct tiff_list *list, uint64_t index);

/** Reads the directory at @p at; *next is where the next one lies, 0 after the last. Errors name the field. */
conus_status tiff_directory_read(struct tiff_page *out, uint64_t *next, const struct tiff_file *file, uint64_t at);

#endif
