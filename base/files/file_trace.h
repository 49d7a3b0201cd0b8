/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What base/files/file.c says of the files that it opens. */
#ifndef CONUS_BASE_FILE_TRACE_H
#define CONUS_BASE_FILE_TRACE_H

#include "base/files/inputs.h"

static inline void file_trace_path(const char *path, const struct system_stat *info)
{
    (void)path;
    (void)info;
}

static inline void file_trace_input(const char *path, const struct system_stat *info)
{
    inputs_read(path, info);
}

static inline void file_trace_failed(void)
{
}

#endif
