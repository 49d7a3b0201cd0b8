/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/output.h"

#include "cli/messages.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

bool output_is_stdout(const char *path)
{
    return !path || strcmp(path, "-") == 0;
}

static int complain_stdout(int error)
{
    complain("standard output: cannot write: %s", strerror(error));
    return EXIT_DATA;
}

int output_write(const char *path, const char *text, size_t size)
{
    if (!output_is_stdout(path)) {
        conus_status status = conus_write_file(path, text, size);
        return status ? complain_status(status) : EXIT_DONE;
    }
    if (fwrite(text, 1, size, stdout) != size || fflush(stdout)) {
        int error = errno;
        clearerr(stdout);
        return complain_stdout(error);
    }
    return EXIT_DONE;
}

int output_finish(int code)
{
    if (code != EXIT_DONE && code != EXIT_DIFFERENT) {
        return code;
    }
    bool failed = ferror(stdout);
    if (fflush(stdout) || failed) {
        return complain_stdout(failed ? EIO : errno);
    }
    return code;
}

bool path_ends(const char *path, const char *ending)
{
    size_t length = strlen(path);
    size_t tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

bool paths_equal(const char *a, const char *b)
{
    struct stat one;
    struct stat other;
    if (stat(a, &one)) {
        return strcmp(a, b) == 0;
    }
    return S_ISREG(one.st_mode) && stat(b, &other) == 0 && one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}
