/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws the page, and waits for the loader's thread. */
#include "viewer/opening/opening.h"

#include "options/messages.h"
#include "options/output.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double progress_s = 0.05; /* between two looks at how far it is */
/* Files that load within this time need no page in place of the open atlas. */
static const double patience_s = 0.2, first_patience_s = 0.05;

/* Shows the name of the file that is read, and a bar of the files that were; in the rest of it a piece goes to and fro,
 * for one file may take a minute. */
static void draw_page(struct window *window, const struct loader *loader, const struct loader_progress *progress,
                      double seconds)
{
    char text[160];
    char shown[sizeof text + 4]; /* an ellipsis has three bytes */
    window_lay_out(window);
    window_clear(window);
    ui_begin(glfwGetTime());
    float line = ui_line();
    float wide = fminf(420 * window->screen.scale, 0.8F * (float)window->screen.width);
    ui_panel("loading",
             (struct ui_box){((float)window->screen.width - wide) / 2, (float)window->screen.height / 2 - 2 * line,
                             wide, 4 * line},
             UI_PLAIN);
    snprintf(text, sizeof text, "reading %s   %.1f s",
             progress->file[0] ? progress->file : path_name(loader_path(loader)), seconds);
    ui_shorten_name(shown, sizeof shown, text, wide);
    ui_text("%s", shown);
    const struct ui_box bar = ui_area("bar", 0.4F * line);
    float read = (float)progress->part * bar.width;
    float piece = (bar.width - read) / 4;
    float at = fabsf(fmodf((float)seconds, 2) - 1); /* from 1 to 0 and back */
    ui_draw_box(bar, theme_marks[THEME_LINE], 0);
    ui_draw_box((struct ui_box){bar.x, bar.y, read, bar.height}, theme_marks[THEME_MARK], 0);
    ui_draw_box((struct ui_box){bar.x + read + 3 * piece * (1 - at), bar.y, piece, bar.height}, theme_marks[THEME_MARK],
                0);
    ui_text_coloured(THEME_HINT, "%s",
                     window->files.stops ? "Escape: this file is the last one that is read" : "Escape ends that");
    ui_panel_end();
    ui_end();
    glfwSwapBuffers(window->handle);
}

/* Handles keys while files are read: Escape ends it. */
static bool press_while_loading(struct window *window, const char *key)
{
    bool ends = strcmp(key, "escape") == 0;
    window->files.stops = window->files.stops || ends;
    return ends;
}

/* Waits until the loader is done, or the window is closed. */
static void wait_for(struct loader *loader, struct window *window)
{
    double begun = glfwGetTime();
    double patience = window->viewer ? patience_s : first_patience_s;
    struct loader_progress progress;
    while (loader_ask(loader, &progress), !progress.done && !glfwWindowShouldClose(window->handle)) {
        double seconds = glfwGetTime() - begun;
        if (window_has_request(window) || window->files.stops) {
            loader_cancel(loader);
        }
        if (seconds >= patience) {
            draw_page(window, loader, &progress, seconds);
        }
        glfwWaitEventsTimeout(seconds < patience ? fmin(patience - seconds, progress_s) : progress_s);
        for (size_t left = window->events.count; left && events_take(window); left--) { /* there are no widgets here */
        }
    }
    if (glfwWindowShouldClose(window->handle)) { /* the file that is being read is read to its end */
        loader_cancel(loader);
        glfwHideWindow(window->handle);
    }
}

void wait_leave(struct window *window)
{
    struct atlases atlases;
    char why[LOADER_WHY];
    if (window->files.begun) {
        loader_cancel(window->files.begun);
        (void)loader_finish(window->files.begun, &atlases, why);
        atlases_finish(&atlases);
        window->files.begun = NULL;
    }
}

bool wait_load(struct window *window, const struct loading *request, struct atlases *out, char why[LOADER_WHY])
{
    struct loader *loader = window->files.begun;
    if (loader && !request->task && strcmp(loader_path(loader), request->path) == 0) {
        window->files.begun = NULL;
    } else if (!loader_start(&loader, request)) {
        print_error_line("not enough memory");
        snprintf(why, LOADER_WHY, "not enough memory");
        return false;
    }
    bool (*press)(struct window *, const char *) = window->press;
    window->press = press_while_loading;
    window->files.stops = false;
    wait_for(loader, window);
    window->press = press;
    bool fine = loader_finish(loader, out, why);
    if (!fine && !why[0] && window->files.stops) {
        snprintf(why, LOADER_WHY, "not read: Escape ended that");
    }
    return fine;
}

bool wait_look(struct window *window, const char *path, void (*look)(void *user), void *user, char why[LOADER_WHY])
{
    struct atlases none;
    return wait_load(window, &(struct loading){.path = path, .task = look, .user = user}, &none, why);
}
