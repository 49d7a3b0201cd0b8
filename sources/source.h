/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file that is opened once and known by its first bytes. */
#ifndef CONUS_SOURCES_SOURCE_H
#define CONUS_SOURCES_SOURCE_H

#include "base/job/reader.h"
#include "base/threads.h"
#include "sources/format.h"
#include "sources/keys.h"

struct source {
    char *path; /**< Owned, of source_open_atlas(); else NULL. */
    struct open_file file;
    bool is_open;
    bool is_packed;        /**< By gzip, as a whole. */
    struct bytes stored;   /**< Its first bytes, HEAD_SIZE or all. */
    struct bytes unpacked; /**< Of one that is packed: what these give; none where they are damaged. */
    struct bytes whole;    /**< source_whole() */
    struct file_head head; /**< Of `unpacked` or else `stored`. */
    char sha256[65];       /**< Of all stored bytes, once they were summed up. */
    struct thread_piece summing;
    _Atomic bool stops; /**< Nobody will ask for the sum. */
};

/** Takes "FILE,key=value" apart: keys.path is FILE, "" without memory. CONUS_ERROR_ARGUMENT where keys are refused. */
void source_keys_read(struct job *job, struct source_keys *out, const char *text, enum key_kind kind);
/** CONUS_ERROR_ARGUMENT where a key is given that is not among @p allowed (KEY_BIT()). */
void source_keys_refuse(struct job *job, const struct source_keys *keys, uint64_t allowed);

/** Opens the regular file @p path, which must live as long as the job, and looks how it begins. The path is a place,
 * which the caller enters before. NULL after a failure. The job closes it. */
struct source *source_open(struct job *job, const char *path);

/** The same of @p bytes, a file in memory called @p path or NULL; both must live as long as the job. */
struct source *source_of_memory(struct job *job, const char *path, struct text bytes);

/** Reads it unpacked, from the beginning; any number of readers may take turns. @p source may be NULL after a failure.
 */
struct reader source_reader(struct job *job, const struct source *source);

/** All its bytes, unpacked, at most the job's max_memory; what gzip packs is verified to its end. They are there until
 * source_close(), which may come before the job's end. None after a failure. */
struct bytes source_whole(struct job *job, struct source *source);

/** All of its bytes, as they are stored, at most @p limit, which --max-memory raises; they are summed up. */
struct bytes source_bytes(struct job *job, struct source *source, uint64_t limit);

/** Begins to read its bytes for its sum, beside whoever reads it meanwhile. @p source may be NULL. */
void source_sum_ahead(struct source *source);

/** The SHA-256 of its bytes as they are stored, in hexadecimal; "" after a failure. */
const char *source_sum(struct job *job, struct source *source);

/** The result is made of the file. */
void source_made_of(struct job *job, struct source *source);

void source_close(struct source *source); /**< NULL is fine. */

/** For callers without a job: looks at the whole file @p stored, or at its first bytes, which is borrowed, as the file
 * @p path. CONUS_ERROR_MEMORY. @p out is the caller's to close, also on failure. */
conus_status source_of(struct source *out, const char *path, const struct bytes *stored);

/** Likewise opens a file that is given as an atlas, which may end in ",map=K" if it is one of CIFTI labels. One that
 * cannot be read is no error: who wants to read it says why. CONUS_ERROR_MEMORY. */
conus_status source_open_atlas(struct source *out, const char *path);

/** FORMAT_MANIFEST, FORMAT_ATLAS_XML or FORMAT_CIFTI, which name other files or have several parts; else FORMAT_OTHER.
 * All that begins with '{' is FORMAT_MANIFEST, whose parser says what is wrong with it. */
enum format_id source_scene(const struct source *source);

/** Its first character that is not white space, unless it is packed; else 0. XML and JSON are read unpacked only. */
char source_first(const struct source *source);

/** The row of the file or folder @p path, as of format_find(); NULL if it has none or cannot be read.
 * CONUS_ERROR_MEMORY. */
conus_status source_find(const struct format **out, const char *path, unsigned roles);
const struct format *source_format(struct job *job, const char *path, unsigned roles); /**< Likewise, on a job. */

#endif
