/* SPDX-License-Identifier: BSD-3-Clause */
/* Starts the window: a program of its own, so that other commands need not load its libraries. */
#include "cli/commands.h"
#include "options/messages.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char program[] = "conus-view";

/* Turns this program into conus-view, with `words` as its command line; gives an exit code where that fails. */
static int become_view(char **words)
{
    char path[PATH_MAX]; /* beside this program, if its own path is known */
    ssize_t length = readlink("/proc/self/exe", path, PATH_MAX - 1);
    char *slash = length > 0 ? memrchr(path, '/', (size_t)length) : NULL;
    if (slash && (size_t)(slash - path) + 1 + sizeof program <= PATH_MAX) {
        memcpy(slash + 1, program, sizeof program);
        if (access(path, X_OK) == 0) {
            execv(path, words);
        }
    }
    execvp(program, words);
    if (errno == ENOENT) {
        print_error_line("conus view: the program %s is not installed (Debian package %s): it is neither beside this "
                         "program nor in PATH",
                         program, program);
    } else {
        print_error_line("conus view: the program %s cannot be started: %s", program, strerror(errno));
    }
    return EXIT_DATA;
}

const struct command cmd_view = {
    .name = "view",
    .summary = "browse an atlas in a window and point at it (the program conus-view)",
    .hand_over = become_view,
};
