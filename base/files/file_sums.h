/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which files were read, and what they held. */
#ifndef CONUS_BASE_FILE_SUMS_H
#define CONUS_BASE_FILE_SUMS_H

#include "base/files/file.h"
#include "base/name_set.h"

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

#endif
