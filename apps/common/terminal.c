/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks the terminal and the environment. */
#include "common/terminal.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { WIDTH_LIMIT = 100000 };

size_t terminal_width(int descriptor)
{
    struct winsize size = {0};
    if (!isatty(descriptor)) {
        return 0;
    }
    if (ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
        return size.ws_col;
    }
    const char *columns = getenv("COLUMNS");
    long width = columns ? strtol(columns, NULL, 10) : 0;
    return width > 0 && width < WIDTH_LIMIT ? (size_t)width : 0;
}

bool terminal_has_colour(int descriptor)
{
    const char *none = getenv("NO_COLOR"); /* no-color.org: any text but the empty one */
    const char *term = getenv("TERM");
    return isatty(descriptor) && !(none && *none) && term && *term && strcmp(term, "dumb") != 0;
}
