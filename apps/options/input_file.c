/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads whole files or pipes, up to a limit of bytes. */
#include "options/input_file.h"

#include "options/messages.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static FILE *refuse_kind(const char *path, mode_t mode, const char *needed)
{
    print_error_line("%s: cannot read: is a %s, a %s is needed", path,
                     S_ISDIR(mode)    ? "folder"
                     : S_ISFIFO(mode) ? "pipe"
                                      : "device",
                     needed);
    return NULL;
}

static FILE *fail_to(const char *action, const char *path)
{
    print_error_line("%s: cannot %s: %s", path, action, strerror(errno));
    return NULL;
}

FILE *input_file_open(const char *path)
{
    struct stat info;
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* does not wait for a pipe's other end */
    if (descriptor < 0) {
        return fail_to("open", path);
    }
    FILE *file = NULL;
    if (fstat(descriptor, &info) == 0 && !S_ISREG(info.st_mode)) {
        refuse_kind(path, info.st_mode, "regular file");
    } else if (!(file = fdopen(descriptor, "r"))) {
        fail_to("open", path);
    }
    if (!file) {
        close(descriptor);
    }
    return file;
}

/* A pipe may be waited for; a device may never end. */
static FILE *open_file_or_pipe(const char *path)
{
    struct stat info;
    if (stat(path, &info)) {
        return fail_to("open", path);
    }
    if (!S_ISREG(info.st_mode) && !S_ISFIFO(info.st_mode)) {
        return refuse_kind(path, info.st_mode, "file or pipe");
    }
    FILE *file = fopen(path, "re");
    return file ? file : fail_to("open", path);
}

/* Reads until the end, or one byte more than the limit. */
static bool read_stream(char **text, size_t *size, FILE *file, const char *path, uint64_t limit)
{
    size_t capacity = 0;
    for (size_t got = 1; got && *size <= limit;) {
        if (*size + 1 >= capacity) {
            size_t more = capacity ? 2 * capacity : 1 << 16;
            char *grown = more > capacity ? realloc(*text, more) : NULL;
            if (!grown) {
                return refuse("not enough memory");
            }
            *text = grown;
            capacity = more;
        }
        size_t space = capacity - *size - 1;
        uint64_t left = limit - *size + 1;
        got = fread(*text + *size, 1, space < left ? space : (size_t)left, file);
        *size += got;
    }
    (*text)[*size] = '\0';
    return !ferror(file) || fail_to("read", path);
}

int input_file_read(char **text, size_t *size, const char *path, enum input_kind kind, uint64_t limit)
{
    char *bytes = NULL;
    size_t count = 0;
    FILE *file = kind == INPUT_FILE ? input_file_open(path) : open_file_or_pipe(path);
    bool whole = file && read_stream(&bytes, &count, file, path, limit);
    if (file) {
        fclose(file);
    }
    if (whole && count > limit) {
        print_error_line("%s: more than the %" PRIu64 " bytes that are read", path, limit);
        whole = false;
    }
    if (!whole) {
        free(bytes);
        return EXIT_DATA;
    }
    *text = bytes;
    *size = count;
    return EXIT_DONE;
}
