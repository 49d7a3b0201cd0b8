/* SPDX-License-Identifier: BSD-3-Clause */
/* What the window asks the dialog, and does with its answers. */
#include "viewer/window/window.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Beside the one that was saved last, or else where one can write, by the atlas's name. */
static void find_session_path(char path[PATH_MAX], const struct window *window)
{
    char here[PATH_MAX];
    const char *atlas = window->viewer->atlases->path;
    const char *slash = strrchr(atlas, '/');
    const char *name = slash && slash[1] ? slash + 1 : atlas;
    bool fits = getcwd(here, sizeof here) && access(here, W_OK) == 0;
    const char *home = getenv("HOME");
    int size = window->session_path ? snprintf(path, PATH_MAX, "%s", window->session_path)
                                    : snprintf(path, PATH_MAX, "%s/%.*s-session.json",
                                               fits   ? here
                                               : home ? home
                                                      : "",
                                               (int)strcspn(name, "."), name);
    path[size < PATH_MAX ? size : 0] = '\0';
}

void window_show_dialog(struct window *window, enum dialog_purpose purpose)
{
    char path[PATH_MAX];
    start_look(&window->start);
    if (purpose == DIALOG_OPEN) {
        dialog_show(&window->dialog, purpose, NULL, &window->start);
    } else if (window->viewer) {
        find_session_path(path, window);
        dialog_show(&window->dialog, purpose, path, &window->start);
    }
}

void window_use_dialog(struct window *window)
{
    char path[PATH_MAX];
    struct dialog *dialog = &window->dialog;
    if (!dialog_enter(path, dialog)) {
        return;
    }
    dialog->on = false;
    if (dialog->purpose == DIALOG_OPEN) {
        window_want(window, path);
    } else {
        free(window->saves_as);
        window->saves_as = strdup(path);
    }
}

void window_use_folder(struct window *window)
{
    char path[PATH_MAX];
    dialog_here(path, &window->dialog);
    window->dialog.on = false;
    window_want(window, path);
}
