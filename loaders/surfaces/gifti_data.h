/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The numbers inside a GIFTI <Data> element. Only loaders/gifti*.c include it. */
#ifndef CONUS_LOADERS_SURFACES_GIFTI_DATA_H
#define CONUS_LOADERS_SURFACES_GIFTI_DATA_H

#include "base/status.h"
#include "base/text.h"

enum gifti_encoding { GIFTI_ASCII, GIFTI_BASE64, GIFTI_GZIP_BASE64, GIFTI_EXTERNAL };

/** NIfTI's datatype codes. */
enum gifti_type {
    GIFTI_UINT8 = 2,
    GIFTI_INT16 = 4,
    GIFTI_INT32 = 8,
    GIFTI_FLOAT32 = 16,
    GIFTI_FLOAT64 = 64,
    GIFTI_INT8 = 256,
    GIFTI_UINT16 = 512,
    GIFTI_UINT32 = 768,
    GIFTI_INT64 = 1024,
    GIFTI_UINT64 = 1280
};

/** How an array is stored. */
struct gifti_storage {
    enum gifti_encoding encoding;
    enum gifti_type type;
    bool swapped;      /**< Not this machine's byte order.                    */
    bool column_major; /**< The first index runs fastest.                     */
    size_t rank;
    const size_t *dim; /**< [rank]                                            */
    size_t count;      /**< Their product.                                    */
    const char *path;  /**< GIFTI_EXTERNAL: the file with the numbers, ...    */
    uint64_t offset;   /**< ... and where in it they begin.                   */
};

/** Decodes exactly storage->count numbers into *out, the last index fastest; the caller's to memory_free(). Nothing is
 * allocated for more numbers than @p text can hold. */
conus_status gifti_data_decode(double **out, const struct gifti_storage *storage, struct text text);

#endif
