/* SPDX-License-Identifier: BSD-3-Clause */
/* What the clipboard gets. */
#include "viewer/model/studies.h"
#include "viewer/window/window.h"

#include <GLFW/glfw3.h>
#include <stdlib.h>

static void copy_study(struct window *window)
{
    const char *text = studies_text(window->viewer);
    if (text) {
        glfwSetClipboardString(window->handle, text);
        viewer_say(window->viewer, "copied the study");
    }
}

void window_copy(struct window *window, enum copied what)
{
    struct viewer *viewer = window->viewer;
    if (what == COPY_STUDY) {
        copy_study(window);
        return;
    }
    char *text = what == COPY_PINS ? viewer_pins_text(viewer) : viewer_results_text(viewer);
    size_t rows = what == COPY_PINS ? viewer->pin_count : 0;
    for (size_t i = 0; i < viewer->atlas_count && what == COPY_RESULTS; i++) {
        rows += conus_selection_count(view_atlas_selection(&viewer->atlases[i], FIRST_TOOL));
    }
    if (text) {
        glfwSetClipboardString(window->handle, text);
        viewer_say(viewer, "copied %zu rows", rows);
    } else {
        viewer_say(viewer, "not copied: not enough memory");
    }
    free(text);
}
