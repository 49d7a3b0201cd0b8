/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Files: whole ones in and out, their sums, folders, and which were read. */
#ifndef CONUS_BASE_FILES_FILE_H
#define CONUS_BASE_FILES_FILE_H

#include "base/memory.h"
#include "base/path.h"
#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Whole files in, whole files out. */

/** Bytes on the heap. */
struct bytes {
    uint8_t *data;
    size_t size;
};

void bytes_finish(struct bytes *bytes);

/** Identity, size and times of a file: they differ after every change but one within a step of the clock. */
struct file_state {
    uint64_t device, inode, size;
    int64_t times[4]; /**< Last change of its bytes (mtime), and of anything about it (ctime): s, ns. */
};

#define FILE_CHANGED "changed while it was read"

struct system_stat;
struct writer;

void file_state_take(struct file_state *out, const struct system_stat *info);

conus_status file_state_find(struct file_state *out, const char *path);
/** The same of an open file; false (errno) when that fails. */
bool file_state_of(struct file_state *out, int descriptor);
bool file_state_equal(const struct file_state *a, const struct file_state *b);
/** CONUS_ERROR_IO unless @p path is still as it was @p before. */
conus_status file_state_check(const struct file_state *before, const char *path);

/** A regular file that is open for reading, for those who take turns in reading it. */
struct open_file {
    const char *path; /**< The opener's. */
    int descriptor;
    struct file_state before; /**< When it was opened. */
    const uint8_t *memory;    /**< [before.size] Its bytes, where it is none but stands for one; borrowed. */
};

/** Opens the regular file @p path. Errors as of file_read(). */
conus_status file_open(struct open_file *out, const char *path);
void file_close(const struct open_file *file);

void file_unmap(const void *memory, size_t size);

#define FILE_MAX_MEMORY " (--max-memory)" /**< An option for file_read_open(). */

/** Reads the first @p most bytes, or all if there are fewer, of a file that may not be larger than @p limit; the
 * message says by which @p option, or "", the limit is raised. Errors as of file_read(). */
conus_status file_read_open(struct bytes *out, const struct open_file *file, size_t most, uint64_t limit,
                            const char *option);

/** @name The same two for a caller whose messages have the path already: theirs do not name it. @{ */
conus_status file_open_here(struct open_file *out, const char *path);
conus_status file_read_here(struct bytes *out, const struct open_file *file, size_t most, uint64_t limit,
                            const char *option);
/** Reads @p size bytes from byte @p from on, all within the size that the file had when it was opened. */
conus_status file_part_here(uint8_t *out, const struct open_file *file, uint64_t from, size_t size);
/** @} */

/** Reads the regular file @p path, which may not be larger than @p limit bytes. @p out is the caller's to finish.
 * Errors: CONUS_ERROR_IO (message with the path) when it cannot be read or changes meanwhile, CONUS_ERROR_MEMORY above
 * the limit. */
conus_status file_read(struct bytes *out, const char *path, uint64_t limit);

/** file_read() where the limit is the caller's to raise by --max-memory, as the message says. */
conus_status file_read_allowed(struct bytes *out, const char *path, uint64_t max_memory);

/** Begins a file that is written part by part (base/writer.h): not over an input of this process. *out is the caller's
 * to writer_drop() in any case. CONUS_ERROR_IO, CONUS_ERROR_ARGUMENT. */
conus_status file_begin(struct writer *out, const char *path, unsigned how);
conus_status file_append(struct writer *file, const void *data, size_t size);
/** Gives it its name. */
conus_status file_end(struct writer *file);

/** Writes @p size bytes so that @p path appears whole or not at all: a file without a name in its folder,
 * or else with another one, is flushed to the disk, and then gets this name. Anything that is not a regular file (a
 * pipe, a terminal) is written directly, /dev/stdout behind what is there; of a link the file that it leads to is
 * replaced, and a link that leads nowhere is an error. */
conus_status file_write(const char *path, const void *data, size_t size);

/** The same without waiting for the disk, for many files that are cheap to make again: a crash of the whole machine in
 * the next seconds may lose them. */
conus_status file_write_soon(const char *path, const void *data, size_t size);

/** file_write() of @p content as @p name in @p folder; fails as the content did if that has failed. */
conus_status file_write_in(const char *folder, const char *name, const struct buffer *content);

/** Like file_write(), but never in the place of anything that is there: CONUS_ERROR_IO then. */
conus_status file_write_new(const char *path, const void *data, size_t size);

/** Makes the folder @p path unless it is there. */
conus_status file_make_folder(const char *path);

bool file_exists(const char *path);
bool file_is_folder(const char *path);

/** "folder of @p path" + "/" + @p name, or a copy of @p name where it is absolute or @p path has no folder. NULL
 * without memory; memory_free() it. */
char *file_beside(const char *path, const char *name);

/** Lower-case SHA-256 of @p bytes in hexadecimal, with a final NUL. */
void file_sha256(char out[65], const struct bytes *bytes);

struct sha256_ctx;

/** The same of all bytes given to @p context, which is as new afterwards. */
void file_sha256_end(char out[65], struct sha256_ctx *context);

/* Which files were read, and what they held. */

struct file_sum {
    char *path;
    char sha256[65];
};

/** Every path once, in the order in which they came. */
struct file_sums {
    struct file_sum *items;
    size_t count;
    struct name_set paths; /**< The paths of the first items, to find them. */
};

void file_sums_finish(struct file_sums *sums);

/** Lower-case SHA-256 of an open file in hexadecimal, read a part at a time, until stops(@p user), if not NULL, is
 * true: CONUS_ERROR_CANCELLED. Other errors as of file_part_here(). */
conus_status file_sha256_open(char out[65], const struct open_file *file, bool (*stops)(void *user), void *user);

/** Adds @p path with the sum of @p content, the bytes that were read from it, unless it is there. */
conus_status file_sums_add(struct file_sums *sums, const char *path, const struct bytes *content);

/** The same of an open file, whose bytes are read for it, a part at a time. */
conus_status file_sums_add_open(struct file_sums *sums, const struct open_file *file);

/** Adds @p path with its sum, unless it is there. */
conus_status file_sums_put(struct file_sums *sums, const char *path, const char sha256[65]);

/** Moves the sums of @p from, which is left empty, behind its own, except those it has. */
conus_status file_sums_move(struct file_sums *sums, struct file_sums *from);

/** Forgets all but the first @p count. */
void file_sums_cut(struct file_sums *sums, size_t count);

/* The entries of a folder, and paths made of others. */

/** File names, owned. */
struct names {
    char **names;
    size_t count;
};

enum { NAMES_LIMIT = 4096 }; /**< Names of a folder that names_list() gives. */

/** The first NAMES_LIMIT names in @p folder that end in @p ending, sorted, so that an answer does not depend on the
 * file system; none if there is no such folder. @p ending may be a list, as for path_ending_length(). @p out is the
 * caller's to finish, also on failure. */
conus_status names_list(struct names *out, const char *folder, const char *ending);
void names_finish(struct names *names);

/** Appends a copy of @p name. */
conus_status names_add(struct names *names, const char *name);

/** The folder of @p path with a '/' at its end, "./" if it has none. NULL without memory; memory_free() it. */
char *path_folder(const char *path);

/* The files that this process has read, in that order (conus_inputs_keep()), so that none is replaced by an output. */

/** The file @p path is opened to be read; @p info is what stat() says of it, NULL = nothing. It becomes an input where
 * it is a regular file, unless the thread searches. */
void inputs_read(const char *path, const struct system_stat *info);

/** While a thread searches, it reads files to find out whether they belong to what it makes. Those that do become
 * inputs by inputs_take(). Gives what was, to be set again. */
bool inputs_search(bool searches);

/** The file @p path was read while the thread searches, and belongs to what it makes. Does nothing at other times. */
void inputs_take(const char *path);

/** The file @p path has been made by this process, which may read it and make it again. */
void inputs_product(const char *path);

#endif
