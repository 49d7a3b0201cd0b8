/* SPDX-License-Identifier: BSD-3-Clause */
/* Starts the window: a program of its own, so that other commands need not load its libraries. Where there is none,
 * shows a page in the browser. */
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "cli/commands.h"
#include "options/messages.h"
#include "options/output.h"
#include "sources/names.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char program[] = "conus-view";

/* Turns this program into conus-view, with `words` as its command line; gives an exit code where that fails, -1 where
 * it is not installed. */
static int become_view(char **words)
{
    char path[SYSTEM_PATH]; /* beside this program, if its own path is known */
    size_t folder = system_program(path) ? path_folder_length(path) : 0;
    if (folder && folder + sizeof program <= sizeof path) {
        memcpy(path + folder, program, sizeof program);
        if (system_allows(path, SYSTEM_RUN)) {
            system_become(path, words);
        }
    }
    system_become(program, words);
    if (errno == ENOENT) {
        return -1;
    }
    print_error_line("conus view: the program %s cannot be started: %s", program, text_error(errno));
    return EXIT_DATA;
}

/* The page's path in `folder`, by the name of the atlas, of what all shells, addresses and systems take as it is. NULL
 * without memory. */
static char *name_page(const char *folder, const char *atlas)
{
    enum { LONGEST = 100 };
    const char *name = path_name(atlas);
    size_t length = stem_length(name, strlen(name), ROLES_ATLAS);
    char *path = NULL;
    while (length > LONGEST || (length && ((unsigned char)name[length] & 0xC0) == 0x80)) { /* no half of a character */
        length--;
    }
    if (asprintf(&path, "%s/%.*s.html", folder, (int)length, name) < 0) {
        return NULL;
    }
    for (char *at = path + strlen(folder) + 1; *at; at++) {
        bool is_first = at[-1] == '/';
        bool is_safe = (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z') || (*at >= '0' && *at <= '9') ||
                       (unsigned char)*at >= 0x80 || (!is_first && strchr("._-+", *at));
        *at = is_safe ? *at : '_';
    }
    return path;
}

static int run_view(const void *given, const struct arguments *arguments)
{
    struct page_settings settings = *(const struct page_settings *)given;
    struct stage stage;
    char *path = NULL;
    int code = stage_begin(&stage, "view", 0) ? EXIT_DONE : EXIT_DATA;
    if (!code) {
        settings.output = path = name_page(stage.folder, arguments->operands[0]);
        code = path ? page_write(settings, arguments,
                                 "the window, conus-view, is not installed (Debian package conus-view), and ")
                    : print_no_memory();
    }
    if (!code && !system_show(path)) {
        print_error_line("no browser could be started here: open %s in one, here or on another computer", path);
    } else if (!code && !settings.common.quiet) {
        print_error_line("note: opened in the browser: %s, which stays until the system clears that folder; the "
                         "window, conus-view, has more (on Linux: Debian package conus-view)",
                         path);
    }
    free(path);
    stage_end(&stage, !code);
    return code;
}

const struct command cmd_view = {
    .name = "view",
    .summary = "browse an atlas in a window and point at it (the program conus-view)",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .description =
        "The window, conus-view, is not installed here (on Linux: Debian package conus-view). In its place,\n"
        "the browser shows a page with the atlas and what a cone hits, which conus page would write to a\n"
        "file. It has a folder of its own among temporary files, which nobody else can read.",
    .examples = "  conus view aal\n"
                "  conus view aal --origin -90,20,20 --toward 0,-10,10 --angle 20\n",
    .see_also = "  conus page      writes the page to a file, to keep or to pass on\n",
    .groups = page_view_groups,
    .settings_size = sizeof(struct page_settings),
    .hand_over = become_view,
    .run = run_view,
};
