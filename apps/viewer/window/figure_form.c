/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds a name, waits until the window has said what it does, and writes. */
#include "viewer/window/figure_form.h"

#include <GLFW/glfw3.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

const char *const figure_panes[PANE_COUNT] = {"axial", "coronal", "sagittal", "3d"};

/* The frame in which it is asked, and one more that says so and is shown. */
enum { FRAMES_BEFORE = 4, FREE_NAMES = 10000 };

static void find_name(char name[FIGURE_NAME])
{
    for (int i = 1; i < FREE_NAMES; i++) {
        snprintf(name, FIGURE_NAME, "figure-%d.png", i);
        if (access(name, F_OK)) {
            return;
        }
    }
}

void figure_form_open(struct window *window)
{
    struct figure_form *form = &window->forms.figure;
    form->open = form->takes_keys = true;
    form->pane = window->screen.enlarged >= 0 ? (size_t)window->screen.enlarged : PANE_3D;
    form->news[0] = form->replaced[0] = '\0';
    find_name(form->name);
}

static bool has_ending(const char *name)
{
    const char *dot = strrchr(name, '.');
    return dot && (strcasecmp(dot, ".png") == 0 || strcasecmp(dot, ".exr") == 0);
}

static void say(struct window *window, const char *what, const char *name)
{
    struct figure_form *form = &window->forms.figure;
    snprintf(form->news, sizeof form->news, "%s%s", what, name);
    viewer_say(window->viewer, "%s", form->news);
}

void figure_form_save(struct window *window)
{
    struct figure_form *form = &window->forms.figure;
    size_t used = strlen(form->name);
    if (!used || form->frames) {
        return;
    }
    if (!has_ending(form->name)) {
        snprintf(form->name + used, sizeof form->name - used, ".png");
    }
    if (!access(form->name, F_OK) && strcmp(form->replaced, form->name) != 0) {
        snprintf(form->replaced, sizeof form->replaced, "%s", form->name);
        say(window, "it is there already; save again to replace ", form->name);
        return;
    }
    form->frames = FRAMES_BEFORE;
    window->frame.frames_wanted = FRAMES_BEFORE + 2;
    say(window, "saving ", form->name);
}

static void write_now(struct window *window)
{
    struct figure_form *form = &window->forms.figure;
    struct figure_settings settings;
    char why[FIGURE_REASON];
    char whole[PATH_MAX];
    figure_of_window(&settings, window);
    if (!figure_write(window, form->pane, &settings, form->name, why)) {
        say(window, "", why);
        return;
    }
    bool found = realpath(form->name, whole) && strlen(whole) < sizeof form->saved;
    snprintf(form->saved, sizeof form->saved, "%.*s", FIGURE_NAME - 1, found ? whole : form->name);
    form->replaced[0] = '\0';
    say(window, "saved: ", form->saved);
}

void figure_form_step(struct window *window)
{
    struct figure_form *form = &window->forms.figure;
    form->frames -= form->frames > 0;
    if (form->frames == 1 && window->viewer) {
        form->frames = 0;
        write_now(window);
    }
}

void figure_form_copy(struct window *window)
{
    const char *saved = window->forms.figure.saved;
    if (saved[0]) {
        glfwSetClipboardString(window->handle, saved);
        viewer_say(window->viewer, "copied the path: %s", saved);
    } else {
        viewer_say(window->viewer, "no figure was saved yet: Ctrl+P");
    }
}
