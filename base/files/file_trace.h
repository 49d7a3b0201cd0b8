/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A thread's questions to the file system and their answers: which files were read, which were looked for and are
 * missing, what folders list. So it can be found out later whether the answers are still the same. * A file's answer is
 * its identity: device, inode, size, and the times of its last change. Every change alters one of them, with one
 * exception: the clock of a file system goes in steps, and a second change within one step goes unnoticed. So a trace
 * is settled only if all its files were at rest for a while before it began. Of the files it says which are
 * inputs (inputs.h). */
#ifndef CONUS_BASE_FILE_TRACE_H
#define CONUS_BASE_FILE_TRACE_H

#include "base/buffer.h"
#include "base/files/file.h"
#include "base/files/folder.h"

#include <time.h>

enum trace_kind {
    TRACE_NOTHING,     /**< There is no such path.                        */
    TRACE_FILE,        /**< A regular file: `state`.                      */
    TRACE_FOLDER,      /**< A folder: device and inode of `state`.        */
    TRACE_OTHER,       /**< A device, a pipe: never the same.             */
    TRACE_NAMES,       /**< The names in a folder that end in `more`: `sum`. */
    TRACE_REAL_PATH,   /**< The path without links: `more`.               */
    TRACE_ENVIRONMENT, /**< A variable: `more`; NULL = it is not set.     */
    TRACE_KINDS
};

struct traced {
    enum trace_kind kind;
    char *path, *more; /**< Owned. */
    bool is_input;     /**< A file whose bytes are a part of what was made. */
    struct file_state state;
    char sum[65];
};

struct file_trace {
    struct traced *items;
    size_t count, capacity;
    struct timespec begun;
    bool broken; /**< Something is missing, or changed meanwhile. */
};

enum {
    TRACE_REST_SECONDS = 2,             /**< FAT counts in steps of 2 s, the coarsest of all. */
    TRACE_REST_ELSEWHERE_SECONDS = 3600 /**< Where a server's clock counts, which may be wrong. */
};

/** Begins to keep what this thread asks; no other trace of it may be open. */
void file_trace_begin(struct file_trace *out);
/** Ends that. The items are sorted, each is there once; a path with two answers breaks the trace. */
void file_trace_end(struct file_trace *trace);
void file_trace_finish(struct file_trace *trace);

/** Whether nothing is missing, nothing changed meanwhile, and all files were at rest before the trace began. */
bool file_trace_is_settled(const struct file_trace *trace);

/** Whether every question has the same answer now. Files are opened for it: on NFS, only that asks the server. */
bool file_trace_holds(const struct file_trace *trace);

/** The regular file @p path of an ended trace, or one in the folder @p path, such as a store of Zarr; else NULL. */
const struct traced *file_trace_find(const struct file_trace *trace, const char *path);

/** Appends the trace as bytes. */
void file_trace_write(struct buffer *out, const struct file_trace *trace);
/** The trace of all @p size bytes; false, and nothing to finish, where they are none or there is no memory. */
bool file_trace_parse(struct file_trace *out, const uint8_t *data, size_t size);

/** @name Functions for those who ask the file system; they do nothing on a thread without a trace. @{ */
struct system_stat;
/** @p info is what stat() says of @p path; NULL = it found nothing. */
void file_trace_path(const char *path, const struct system_stat *info);
/** The same of a file that is opened to be read: inputs_read(). */
void file_trace_input(const char *path, const struct system_stat *info);
/** The file @p path was read while the thread searches, and belongs to what it makes. Does nothing at other times. */
void file_trace_take(const char *path);
/** A file is there, but could not be read: the next time it may be, and look the same. That breaks the trace. */
void file_trace_failed(void);
/** The inputs of a kept trace, which need not be read again, are inputs of this process. */
void file_trace_tell(const struct file_trace *trace);
/** getenv(). */
const char *file_trace_environment(const char *name);
/** system_real_path() into @p out, [SYSTEM_PATH]. */
bool file_trace_real_path(char *out, const char *path);
/** @} */

#endif
