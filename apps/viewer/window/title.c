/* SPDX-License-Identifier: BSD-3-Clause */
/* Puts the title together from what the window shows. */
#include "viewer/window/title.h"

#include "options/messages.h"

#include <GLFW/glfw3.h>
#include <stdio.h>
#include <string.h>

static const char *last_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
}

/* The best hit, or else what is chosen; 0 = neither. */
static uint32_t find_object(const char **how, const struct viewer *viewer)
{
    const conus_selection *selection = viewer_selection(viewer);
    const conus_result *best = conus_selection_count(selection) ? conus_selection_result(selection, 0) : NULL;
    bool is_hit = best && best->object && best->pixels;
    *how = !is_hit ? "chosen" : viewer->tools[FIRST_TOOL].held ? "held" : "hit";
    return is_hit ? best->object : viewer->drawn->shown.chosen;
}

void title_write(char out[TITLE_SIZE], const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const char *how;
    int used = snprintf(out, TITLE_SIZE, "conus");
    if (!viewer || window->start.on || window->dialog.on) {
        return;
    }
    used += snprintf(out + used, (size_t)(TITLE_SIZE - used), " - %.80s", last_name(viewer->atlases->path));
    if (window->history.session_path) {
        used += snprintf(out + used, (size_t)(TITLE_SIZE - used), " [%.80s]", last_name(window->history.session_path));
    }
    uint32_t object = find_object(&how, viewer);
    if (object) {
        char title[VIEW_ATLAS_TITLE];
        snprintf(out + used, (size_t)(TITLE_SIZE - used), " - %.80s (%s)",
                 view_atlas_title(title, viewer->drawn, object), how);
    }
    make_plain_line(out);
}

void title_update(struct window *window)
{
    char title[TITLE_SIZE];
    title_write(title, window);
    if (strcmp(title, window->frame.title) != 0) {
        memcpy(window->frame.title, title, sizeof title);
        glfwSetWindowTitle(window->handle, title);
    }
}
