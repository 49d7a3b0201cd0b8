/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A long output that survives being killed. Rows go to FILE.part, whole blocks at a time; a journal, FILE.journal, has
 * a line for each block that is there (docs/batch.md). When all is written the part takes the name FILE, and the
 * journal goes. A run that resumes keeps what the journal vouches for and cuts off the rest. */
#ifndef CONUS_BATCH_BATCH_FILE_H
#define CONUS_BATCH_BATCH_FILE_H

#include "conus/batch.h"

struct batch_file {
    const char *path;     /**< NULL = standard output, which has no journal. */
    char *part, *journal; /**< Paths. */
    int rows, log;        /**< Descriptors of the two; -1 = closed. */
    uint64_t poses, errors;
    uint64_t size;    /**< Bytes, the header row included, */
    uint32_t crc;     /**< and their CRC-32. */
    bool is_finished; /**< It has its name. */
};

enum batch_start { BATCH_ANEW, BATCH_FORCE, BATCH_RESUME };

/** Opens or reopens it. @p fingerprint, a line, names everything that the rows depend on; @p header_row stands above
 * them. What is there is only replaced with BATCH_FORCE, and only continued with BATCH_RESUME if it has this
 * fingerprint; file->poses then says how many are answered. Returns the exit code and prints an error unless it is 0;
 * @p out is the caller's to batch_file_close() in any case. */
int batch_file_open(struct batch_file *out, const char *path, const char *fingerprint, const char *header_row,
                    enum batch_start how);

/** Whether there is an unfinished batch that is to become the file @p path. */
bool batch_file_is_begun(const char *path);

/** A block's line in the journal. */
struct batch_entry {
    uint64_t poses, errors, size;
    uint32_t crc;
};

struct batch_entry batch_entry_of(const conus_batch_block *block);

/** Appends a block; to standard output where the file has no path. Gives the exit code likewise. */
int batch_file_append(struct batch_file *file, const conus_batch_block *block);

/** Notes a block that somebody else has written behind those that are there. Gives the exit code likewise. */
int batch_file_note(struct batch_file *file, const struct batch_entry *entry);

/** Lets the journal vouch for nothing: the rows stay, but no run resumes them. */
void batch_file_disown(struct batch_file *file);

/** Gives the file its name; the journal is gone then. Gives the exit code likewise. */
int batch_file_finish(struct batch_file *file);

/** Closes it. An unfinished file stays, to be resumed, unless it is empty. */
void batch_file_close(struct batch_file *file);

/** CRC-32 (as in zlib, PNG and zip) of all bytes of the file at @p path, and their number; false, after an error
 * message, when it cannot be read. */
bool batch_file_checksum(const char *path, uint32_t *crc, uint64_t *size);

#endif
