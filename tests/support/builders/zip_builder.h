/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Zip archives, byte by byte after PKWARE's APPNOTE.TXT, so that each byte can be changed. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_ZIP_BUILDER_H
#define CONUS_TESTS_SUPPORT_BUILDERS_ZIP_BUILDER_H

#include "base/memory.h"

struct zip_builder {
    struct buffer bytes;     /**< The archive; end it with buffer_finish(). */
    struct buffer directory; /**< The central one, until zip_end(). */
    size_t count;
    bool wide;   /**< Sizes, places and counts of ZIP64, of whatever size.           */
    bool behind; /**< Sizes and checksums stand behind the files, as in a stream's.  */
    bool last_is_packed;
    size_t header_at, central_at; /**< The header of the file added last, and in `directory` its entry. */
};

/** Adds a file, packed by deflate or not. */
void zip_add(struct zip_builder *builder, const char *name, const void *data, size_t size, bool packed);

/** Appends the central directory, and the record of it; central_at counts in the archive from here on. */
void zip_end(struct zip_builder *builder);

#endif
