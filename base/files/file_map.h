/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Files that are mapped for reading while others may cut them off or write to them. */
#ifndef CONUS_BASE_FILE_MAP_H
#define CONUS_BASE_FILE_MAP_H

#include "base/files/file.h"

/** Maps the regular file @p path, if that is as it was: @p before. NULL where it is not, or cannot be mapped. The
 * caller unmaps its before->size bytes. */
void *file_map(const char *path, const struct file_state *before);

/** Until file_guard_end(), this thread and those of base/threads.h read zeros where a mapped file has no bytes any
 * more, or its disk gives none, in place of the SIGBUS that ends programs. There is one guard in a process, since
 * signals are the whole process's: a second caller waits for the first one's end. */
void file_guard_begin(void *mapped, size_t size);

/** CONUS_ERROR_IO if zeros were read, or if @p path is not as it was @p before. */
conus_status file_guard_end(const char *path, const struct file_state *before);

#endif
