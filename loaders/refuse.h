/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a message says of a file that is not what is needed. */
#ifndef CONUS_LOADERS_REFUSE_H
#define CONUS_LOADERS_REFUSE_H

#include "sources/source.h"

/** format_find() of all rows, and label tables of all formats. */
const struct format *format_nearest(const struct file_head *head);

/** Fails with CONUS_ERROR_DATA and one line without the path: what the file is, what is needed, the way on. @p stored
 * has its first bytes, packed or not. */
void file_refuse(struct job *job, const char *path, const struct bytes *stored, const char *needed);

/** The same of a file that is open. Damaged gzip, and what unpacks to nothing, come first. */
void source_refuse(struct job *job, const struct source *source, const char *needed);

#endif
