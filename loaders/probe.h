/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file that is given as an atlas, opened once and known by its first bytes. */
#ifndef CONUS_LOADERS_PROBE_H
#define CONUS_LOADERS_PROBE_H

#include "loaders/file_kind.h"

struct probe {
    struct open_file file; /**< Its path is as given, but for ",map=K" of CIFTI labels. */
    bool is_open;          /**< False where it cannot be read: who wants to read it says why. */
    struct bytes stored;   /**< Its first bytes, FILE_KIND_HEAD or all. */
    bool packed;           /**< By gzip. */
    char first;            /**< Its first character that is not white space, unless it is packed; else 0. */
    enum format_reader reader;
    char *path; /**< Path of `file`; owned. */
};

/** Opens the file @p path, which may end in ",map=K" if it is one of CIFTI labels, and looks what it is. One that
 * cannot be read is no error. Errors: CONUS_ERROR_MEMORY. @p out is the caller's to close, also on failure. */
conus_status probe_open(struct probe *out, const char *path);
void probe_close(struct probe *probe);

/** The open file, or NULL. */
const struct open_file *probe_file(const struct probe *probe);

#endif
