/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The kind of a file, label tables included: for messages about it, and for choosing a reader. */
#ifndef CONUS_LOADERS_FILE_KIND_H
#define CONUS_LOADERS_FILE_KIND_H

#include "loaders/formats/formats.h"

/** format_find(), and label tables of all formats. */
const struct file_kind *file_kind_of(const char *path, const struct bytes *head);

/** Fails with CONUS_ERROR_DATA and one line without the path: what the file is, what is needed, the way on. @p stored
 * has its first bytes, packed or not. */
conus_status file_kind_fail(const char *path, const struct bytes *stored, const char *needed);

#endif
