/* SPDX-License-Identifier: BSD-3-Clause */
/* Starts the window: a program of its own, so that other commands need not load its libraries. */
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "cli/commands.h"
#include "options/messages.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static const char program[] = "conus-view";

/* Turns this program into conus-view, with `words` as its command line; gives an exit code where that fails. */
static int become_view(char **words)
{
    char path[SYSTEM_PATH]; /* beside this program, if its own path is known */
    size_t folder = system_program(path) ? path_folder_length(path) : 0;
    if (folder && folder + sizeof program <= sizeof path) {
        memcpy(path + folder, program, sizeof program);
        if (system_allows(path, SYSTEM_RUN)) {
            execv(path, words);
        }
    }
    execvp(program, words);
    if (errno == ENOENT) {
        print_error_line("conus view: the program %s is not installed (Debian package %s): it is neither beside this "
                         "program nor in PATH",
                         program, program);
    } else {
        print_error_line("conus view: the program %s cannot be started: %s", program, text_error(errno));
    }
    return EXIT_DATA;
}

const struct command cmd_view = {
    .name = "view",
    .summary = "browse an atlas in a window and point at it (the program conus-view)",
    .hand_over = become_view,
};
