/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A long file of rows that appears whole or not at all (base/writer.h), and its sum. */
#ifndef CONUS_CLI_BATCH_FILE_H
#define CONUS_CLI_BATCH_FILE_H

#include "base/writer.h"

struct batch_file {
    const char *path; /**< NULL = standard output. */
    struct writer rows;
    uint64_t size; /**< Bytes so far, */
    uint32_t crc;  /**< and their CRC-32 (as in zlib, PNG and zip). */
};

/* Functions that return an int return the exit code, and print an error unless it is 0. */

/** Begins it; NULL is standard output. @p out is the caller's to batch_file_close() in any case. */
int batch_file_begin(struct batch_file *out, const char *path);

int batch_file_append(struct batch_file *file, const char *text, size_t size);

/** Gives the file its name, in the place of what is there. */
int batch_file_finish(struct batch_file *file);

/** Closes it; without a name it is gone. */
void batch_file_close(struct batch_file *file);

/** CRC-32 and number of all bytes of the file at @p path; those from byte @p from on are appended to @p to, unless that
 * is NULL. */
int batch_file_read(uint32_t *crc, uint64_t *size, const char *path, struct batch_file *to, uint64_t from);

#endif
