/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A file that is written part by part, and appears whole or not at all: it has no name until its end, where the file
 * system has such files, so that nothing is left of it when the process is killed; else it is called
 * FILE.XXXXXXXX.part. What fails returns false, with errno set. */
#ifndef CONUS_BASE_WRITER_H
#define CONUS_BASE_WRITER_H

#include "base/system/system.h"

enum {
    WRITER_NEW = 1,  /**< It is never put in the place of anything that is there: EEXIST. */
    WRITER_SOON = 2, /**< Its end does not wait for the disk: a crash of the whole machine may lose it. */
    WRITER_NAMED = 4 /**< It has the other name from the beginning. */
};

struct writer {
    char path[SYSTEM_PATH];           /**< Where it goes: of a link the file that it leads to. */
    char temporary[SYSTEM_PATH + 16]; /**< Its other name. */
    unsigned how;
    int file;       /**< Descriptor; -1 = closed. */
    bool is_named;  /**< It has the other name. */
    bool is_direct; /**< What is there is no regular file (a pipe, a terminal), and is written to as it goes. */
};

/** Begins it; @p how is a sum of the above. Afterwards *out is the caller's to writer_drop() in any case. A folder, and
 * a link that leads nowhere, are errors. */
bool writer_begin(struct writer *out, const char *path, unsigned how);

bool writer_append(struct writer *writer, const void *data, size_t size);

/** Gives the file its name, in the place of what is there, and closes it. */
bool writer_end(struct writer *writer);

/** Closes it; what has no name by then is gone. errno stays. */
void writer_drop(struct writer *writer);

#endif
