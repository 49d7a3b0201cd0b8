/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads files whole and writes them whole or not at all, through a temporary file beside the target. */
#include "base/files/file.h"

#include "base/memory.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "base/writer.h"
#include "conus/own.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

void bytes_finish(struct bytes *bytes)
{
    memory_free(bytes->data);
    *bytes = (struct bytes){0};
}

static conus_status fail_errno(const char *path, const char *action)
{
    return fail(CONUS_ERROR_IO, "%s: cannot %s: %s", path, action, text_error(errno));
}

conus_status file_state_find(struct file_state *out, const char *path)
{
    struct system_stat info;
    if (!system_stat(&info, path)) {
        return fail_errno(path, "open");
    }
    file_state_take(out, &info);
    return CONUS_OK;
}

conus_status file_state_check(const struct file_state *before, const char *path)
{
    struct file_state now;
    conus_status status = file_state_find(&now, path);
    return status || file_state_equal(&now, before) ? status : fail(CONUS_ERROR_IO, "%s: " FILE_CHANGED, path);
}

static conus_status fail_read(const char *action)
{
    return fail(CONUS_ERROR_IO, "cannot %s: %s", action, text_error(errno));
}

conus_status file_open_here(struct open_file *out, const char *path)
{
    struct system_stat info;
    int descriptor = system_open(path, SYSTEM_READ | SYSTEM_AT_ONCE);
    if (descriptor < 0) {
        return fail_read("open");
    }
    if (!system_stat_open(&info, descriptor)) {
        conus_status status = fail_read("read");
        close(descriptor);
        return status;
    }
    inputs_read(path, &info);
    if (info.kind != SYSTEM_FILE) {
        close(descriptor);
        return fail(CONUS_ERROR_IO, "cannot read: is a %s",
                    info.kind == SYSTEM_FOLDER ? "folder, a regular file is needed: name those in it one by one"
                                               : "device or pipe, a regular file is needed");
    }
    *out = (struct open_file){.path = path, .descriptor = descriptor};
    file_state_take(&out->before, &info);
    return CONUS_OK;
}

conus_status file_open(struct open_file *out, const char *path)
{
    conus_status status = file_open_here(out, path);
    return status ? fail_in(status, path) : CONUS_OK;
}

void file_close(const struct open_file *file)
{
    if (!file->memory) {
        close(file->descriptor);
    }
}

/* Bytes that were read, all of `size` if the file has them; -1 (errno) on failure. */
static ptrdiff_t read_bytes(uint8_t *out, const struct open_file *file, uint64_t from, size_t size)
{
    if (!file->memory) {
        return system_read_at(file->descriptor, out, size, from);
    }
    memcpy(out, file->memory + from, size);
    return (ptrdiff_t)size;
}

static bool is_as_before(const struct open_file *file)
{
    struct file_state now;
    return file->memory || (file_state_of(&now, file->descriptor) && file_state_equal(&now, &file->before));
}

conus_status file_read_here(struct bytes *out, const struct open_file *file, size_t most, uint64_t limit,
                            const char *option)
{
    uint64_t whole = file->before.size;
    if (whole > limit) {
        return fail(CONUS_ERROR_MEMORY, "file of %llu bytes, allowed are %llu%s", (unsigned long long)whole,
                    (unsigned long long)limit, option);
    }
    size_t size = whole < most ? (size_t)whole : most;
    struct bytes bytes = {.data = memory_raw(size, 1)};
    conus_status status = bytes.data ? CONUS_OK : CONUS_ERROR_MEMORY;
    ptrdiff_t got = status ? 0 : read_bytes(bytes.data, file, 0, size);
    status = got < 0 ? fail_read("read") : status;
    bytes.size = got < 0 ? 0 : (size_t)got;
    if (!status && !is_as_before(file)) {
        status = fail(CONUS_ERROR_IO, FILE_CHANGED);
    }
    return GIVE(status, out, bytes, bytes_finish(&bytes));
}

conus_status file_read_open(struct bytes *out, const struct open_file *file, size_t most, uint64_t limit,
                            const char *option)
{
    conus_status status = file_read_here(out, file, most, limit, option);
    return status ? fail_in(status, file->path) : CONUS_OK;
}

conus_status file_part_here(uint8_t *out, const struct open_file *file, uint64_t from, size_t size)
{
    ptrdiff_t got = read_bytes(out, file, from, size);
    if (got < 0) {
        return fail_read("read");
    }
    return is_as_before(file) && (size_t)got == size ? CONUS_OK : fail(CONUS_ERROR_IO, FILE_CHANGED);
}

static conus_status read_path(struct bytes *out, const char *path, uint64_t limit, const char *option)
{
    struct open_file file;
    conus_status status = file_open(&file, path);
    if (!status) {
        status = file_read_open(out, &file, SIZE_MAX, limit, option);
        file_close(&file);
    }
    return status;
}

conus_status file_read(struct bytes *out, const char *path, uint64_t limit)
{
    return read_path(out, path, limit, "");
}

conus_status file_read_allowed(struct bytes *out, const char *path, uint64_t max_memory)
{
    return read_path(out, path, max_memory, FILE_MAX_MEMORY);
}

conus_status file_begin(struct writer *out, const char *path, unsigned how)
{
    const char *input = how & WRITER_NEW ? NULL : conus_inputs_find(path);
    if (input) {
        *out = (struct writer){.file = -1};
        return fail(CONUS_ERROR_ARGUMENT, "%s would overwrite the input %s", path, input);
    }
    if (writer_begin(out, path, how)) {
        return CONUS_OK;
    }
    return errno == EISDIR ? fail(CONUS_ERROR_IO, "%s: cannot write: is a folder", path)
                           : fail_errno(path, out->is_direct ? "open" : "write");
}

conus_status file_append(struct writer *file, const void *data, size_t size)
{
    return writer_append(file, data, size) ? CONUS_OK : fail_errno(file->path, "write");
}

conus_status file_end(struct writer *file)
{
    if (!writer_end(file)) {
        return errno == EEXIST ? fail(CONUS_ERROR_IO, "%s: there is a file already, which is not replaced", file->path)
                               : fail_errno(file->path, "write");
    }
    if (!file->is_direct) {
        inputs_product(file->path);
    }
    return CONUS_OK;
}

static conus_status write_file(const char *path, const void *data, size_t size, unsigned how)
{
    struct writer file;
    conus_status status = file_begin(&file, path, how);
    if (!status) {
        status = file_append(&file, data, size);
        status = status ? status : file_end(&file);
    }
    bool again = status == CONUS_ERROR_IO && !file.is_direct && !file.is_named && !(how & WRITER_NAMED);
    writer_drop(&file);
    return again ? write_file(path, data, size, how | WRITER_NAMED) : status; /* an error is that of this */
}

conus_status file_write(const char *path, const void *data, size_t size)
{
    return write_file(path, data, size, 0);
}

conus_status file_write_in(const char *folder, const char *name, const struct buffer *content)
{
    struct buffer path = {0};
    buffer_format(&path, "%s/%s", folder, name);
    conus_status status = buffer_status(content);
    status = status ? status : buffer_status(&path);
    status = status ? status : file_write(path.data, content->data, content->size);
    buffer_finish(&path);
    return status;
}

conus_status file_write_soon(const char *path, const void *data, size_t size)
{
    return write_file(path, data, size, WRITER_SOON);
}

conus_status file_write_new(const char *path, const void *data, size_t size)
{
    return write_file(path, data, size, WRITER_NEW);
}

conus_status file_make_folder(const char *path)
{
    if (system_make_folder(path, false) || (errno == EEXIST && file_is_folder(path))) {
        return CONUS_OK;
    }
    return fail(CONUS_ERROR_IO, "%s: cannot make this folder: %s", path, text_error(errno));
}

void file_unmap(const void *memory, size_t size)
{
    system_unmap(memory, size);
}

bool file_exists(const char *path)
{
    struct system_stat info;
    return system_stat(&info, path) && info.kind == SYSTEM_FILE;
}

bool file_is_folder(const char *path)
{
    struct system_stat info;
    return system_stat(&info, path) && info.kind == SYSTEM_FOLDER;
}

char *file_beside(const char *path, const char *name)
{
    size_t folder = path_is_whole(name) ? 0 : path_folder_length(path);
    char *joined = memory_raw(folder + strlen(name) + 1, 1);
    if (joined) {
        memcpy(joined, path, folder);
        memcpy(joined + folder, name, strlen(name) + 1);
    }
    return joined;
}

conus_status conus_write_file(const char *path, const void *data, size_t size)
{
    return file_write(path, data, size);
}
