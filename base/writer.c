/* SPDX-License-Identifier: BSD-3-Clause */
/* Files without a name, and those with another one, until they are whole. */
#include "base/writer.h"

#include "base/path.h"

#include <inttypes.h>
#include <string.h>

enum { ATTEMPTS = 100 };

/* A name beside the file's that nobody else has: neither another thread or process, on this machine or another, nor
 * one that ended before its time. */
static bool find_name(struct writer *writer)
{
    uint32_t number;
    if (!system_random(&number, sizeof number)) {
        return false;
    }
    snprintf(writer->temporary, sizeof writer->temporary, "%s.%08" PRIx32 ".part", writer->path, number);
    return true;
}

static bool open_named(struct writer *writer)
{
    errno = EEXIST;
    for (int i = 0; i < ATTEMPTS && writer->file < 0 && errno == EEXIST && find_name(writer); i++) {
        writer->file = system_open(writer->temporary, SYSTEM_WRITE | SYSTEM_NEW);
    }
    writer->is_named = writer->file >= 0;
    return writer->is_named;
}

static bool open_nameless(struct writer *writer)
{
    size_t length = path_folder_length(writer->path);
    memcpy(writer->temporary, writer->path, length);
    memcpy(writer->temporary + length, ".", sizeof ".");
    writer->file = system_open_nameless(writer->temporary);
    return writer->file >= 0;
}

/* Gives it the other name. */
static bool name_otherwise(struct writer *writer)
{
    for (int i = 0; i < ATTEMPTS && !writer->is_named && errno == EEXIST && find_name(writer); i++) {
        writer->is_named = system_name(writer->file, writer->temporary);
    }
    return writer->is_named;
}

/* Where the bytes go: *out->path, or directly to what is there. */
static bool find_target(struct writer *out, const char *path)
{
    struct system_stat info;
    bool exists = system_stat(&info, path);
    size_t size = strlen(path) + 1;
    if (exists && info.kind == SYSTEM_FOLDER) {
        errno = EISDIR;
        return false;
    }
    if (size > sizeof out->path) {
        errno = ENAMETOOLONG;
        return false;
    }
    memcpy(out->path, path, size);
    out->is_direct = exists && info.kind != SYSTEM_FILE;
    if (out->is_direct || (out->how & WRITER_NEW) || !system_stat_link(&info, path) || info.kind != SYSTEM_LINK) {
        return true;
    }
    out->is_direct = system_is_open_name(path);
    return out->is_direct || system_real_path(out->path, path);
}

bool writer_begin(struct writer *out, const char *path, unsigned how)
{
    out->how = how;
    out->file = -1;
    out->is_named = out->is_direct = false;
    if (!find_target(out, path)) {
        return false;
    }
    if (out->is_direct) {
        out->file = system_open(path, SYSTEM_WRITE | SYSTEM_APPEND);
        return out->file >= 0;
    }
    return (!(how & WRITER_NAMED) && open_nameless(out)) || open_named(out);
}

bool writer_append(struct writer *writer, const void *data, size_t size)
{
    return system_write(writer->file, data, size);
}

static bool close_file(struct writer *writer)
{
    int file = writer->file;
    writer->file = -1;
    return close(file) == 0;
}

bool writer_end(struct writer *writer)
{
    bool replaces = !(writer->how & WRITER_NEW);
    if (writer->is_direct) {
        return close_file(writer);
    }
    if (!(writer->how & WRITER_SOON) && !system_to_disk(writer->file)) {
        return false;
    }
    bool is_done = !writer->is_named && system_name(writer->file, writer->path);
    if (!is_done && !writer->is_named && !(replaces && name_otherwise(writer))) {
        return false;
    }
    if (!close_file(writer)) {
        return false;
    }
    is_done = is_done || system_rename(writer->temporary, writer->path, replaces);
    writer->is_named = writer->is_named && !is_done;
    return is_done;
}

void writer_drop(struct writer *writer)
{
    int error = errno;
    if (writer->file >= 0) {
        close_file(writer);
    }
    if (writer->is_named) {
        system_remove(writer->temporary);
    }
    writer->is_named = false;
    errno = error;
}
