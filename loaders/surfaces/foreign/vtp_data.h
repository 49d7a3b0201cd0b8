/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The numbers inside a DataArray of a VTP file. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_VTP_DATA_H
#define CONUS_LOADERS_SURFACES_FOREIGN_VTP_DATA_H

#include "base/files/file.h"
#include "base/text.h"

enum vtp_kind { VTP_INTEGER, VTP_UNSIGNED, VTP_REAL };

/** How an array is stored. */
struct vtp_storage {
    enum vtp_kind kind;
    size_t size;         /**< Bytes of a number: 1, 2, 4 or 8.                  */
    bool is_text;        /**< Else binary, ...                                  */
    bool is_raw;         /**< ... as it is, or in base64.                       */
    bool is_packed;      /**< Blocks of zlib.                                   */
    bool swapped;        /**< Not this machine's byte order.                    */
    size_t header;       /**< Bytes of a number of the header: 4 or 8.          */
    uint64_t max_memory; /**< Bytes that the unpacked numbers may take.         */
    bool any;            /**< NaN and infinity are numbers, too, where they are text. */
    struct text content; /**< The numbers; appended ones with whatever follows. */
};

/** The whole numbers of an array into *out[*count], the caller's to memory_free(); those above 2^63 - 1 become -1. */
conus_status vtp_wholes(int64_t **out, size_t *count, const struct vtp_storage *storage);

/** Numbers of any kind as float, rounded once. */
conus_status vtp_floats(float **out, size_t *count, const struct vtp_storage *storage);

/** The bytes of a binary array, in the order in which they are stored. */
conus_status vtp_bytes(struct bytes *out, const struct vtp_storage *storage);

#endif
