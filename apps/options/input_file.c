/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads whole files or pipes, up to a limit of bytes. */
#include "options/output.h"

#include "base/system/system.h"
#include "base/text.h"
#include "conus/own.h"
#include "options/messages.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static FILE *refuse_kind(const char *path, enum system_kind kind, const char *needed)
{
    print_error_line("%s: cannot read: is a %s, a %s is needed", path,
                     kind == SYSTEM_FOLDER ? "folder"
                     : kind == SYSTEM_PIPE ? "pipe"
                                           : "device",
                     needed);
    return NULL;
}

static FILE *fail_to(const char *action, const char *path)
{
    print_error_line("%s: cannot %s: %s", path, action, text_error(errno));
    return NULL;
}

FILE *input_file_open(const char *path)
{
    struct system_stat info;
    int descriptor = system_open(path, SYSTEM_READ | SYSTEM_AT_ONCE); /* does not wait for a pipe's other end */
    if (descriptor < 0) {
        return fail_to("open", path);
    }
    FILE *file = NULL;
    if (system_stat_open(&info, descriptor) && info.kind != SYSTEM_FILE) {
        refuse_kind(path, info.kind, "regular file");
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
    struct system_stat info;
    if (!system_stat(&info, path)) {
        return fail_to("open", path);
    }
    if (info.kind != SYSTEM_FILE && info.kind != SYSTEM_PIPE) {
        return refuse_kind(path, info.kind, "file or pipe");
    }
    FILE *file = system_stream(path, "r");
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

bool poses_are_stdin(const char *path)
{
    return output_is_stdout(path) || (path[0] == '-' && conus_pose_path_length(path) == 1);
}

bool poses_are_no_file(const char *path)
{
    char plain[SYSTEM_PATH];
    if (poses_are_stdin(path)) {
        return true;
    }
    snprintf(plain, sizeof plain, "%.*s", (int)conus_pose_path_length(path), path);
    return output_is_no_file(plain);
}
