/* SPDX-License-Identifier: BSD-3-Clause */
/* Starts the window: a program of its own, so that other commands need not load its libraries. */
#include "base/path.h"
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
    size_t folder = length > 0 ? path_length_above(path, (size_t)length) : 0;
    if (folder && folder + sizeof program <= PATH_MAX) {
        memcpy(path + folder, program, sizeof program);
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
