/* SPDX-License-Identifier: BSD-3-Clause */
/* The second tool's cone over the four panes: its wall as lines of its own colour, and the names of what it hits. */
#include "viewer/panes/panes.h"

#include "base/look.h"
#include "viewer/tools/shell.h"

#include <math.h>

static const ui_colour second_colour = {LOOK_RGB(LOOK_SECOND), 255};
static const ui_colour old_colour = {LOOK_RGB(LOOK_CONE_OLD), 255}; /* as the first tool's where it is not seen */
static const ui_colour shade = {LOOK_RGB(LOOK_UNDER_SECOND),
                                150}; /* under lines, so that they are seen on white as on black */

static double distance(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* The length from the apex to the far side of all atlases. */
static double whole_length(const struct viewer *viewer)
{
    return distance(viewer->tools[SECOND_TOOL].pose.world_from_device + 12, viewer->centre) + viewer->radius;
}

/* The length to the farthest contact, so that the cone ends on what it hits; the whole length without hits. */
static double seen_length(const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const conus_selection *selection = view_atlas_selection(viewer->drawn, SECOND_TOOL);
    double most = 0;
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object && result->pixels) {
            most = fmax(most, distance(result->contact, viewer->tools[SECOND_TOOL].pose.world_from_device + 12));
        }
    }
    return most > 0 ? most : whole_length(viewer);
}

static void find_shell(struct shell *out, const struct window *window, double length)
{
    conus_selector_options options;
    double angle = viewer_query(&options, window->viewer, SECOND_TOOL, 0);
    if (options.radius > 0) { /* a cylinder ends there, too */
        options.range[1] = options.range[1] > 0 ? options.range[1] : length;
    }
    shell_find(out, &window->viewer->tools[SECOND_TOOL].pose, &options, angle, length);
}

static ui_colour find_colour(const struct window *window)
{
    return inputs_is_old(&window->inputs, window->viewer, SECOND_TOOL) ? old_colour : second_colour;
}

static void draw_line(const float from[2], const float to[2], ui_colour colour)
{
    ui_draw_line(from, to, shade, 4);
    ui_draw_line(from, to, colour, 1.8F);
}

static bool shows(const struct window *window)
{
    return window->viewer->tools[SECOND_TOOL].on && window->viewer->tools[SECOND_TOOL].has_pose;
}

void pane_second_cut(struct window *window, const struct pane_plane *plane)
{
    struct shell shell;
    struct shell_piece pieces[2 * SHELL_POINTS];
    double normal[3];
    if (!shows(window)) {
        return;
    }
    tool_update_second(window->viewer); /* a panel may have changed the atlas in this frame */
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3;
        int c = (a + 2) % 3;
        normal[a] = plane->view.right[b] * plane->view.up[c] - plane->view.right[c] * plane->view.up[b];
    }
    find_shell(&shell, window, whole_length(window->viewer));
    size_t count = shell_cut(pieces, &shell, plane->view.centre, normal);
    ui_colour colour = find_colour(window);
    for (size_t i = 0; i < count; i++) {
        float from[2];
        float to[2];
        pane_point(from, plane, pieces[i].ends[0]);
        pane_point(to, plane, pieces[i].ends[1]);
        draw_line(from, to, colour);
    }
}

static void draw_between(const struct window *window, const double from[3], const double to[3], ui_colour colour)
{
    float ends[2][2];
    if (window_point(ends[0], window, from) && window_point(ends[1], window, to)) {
        draw_line(ends[0], ends[1], colour);
    }
}

static void draw_best(struct window *window, ui_colour colour)
{
    const struct viewer *viewer = window->viewer;
    const conus_selection *selection = view_atlas_selection(viewer->drawn, SECOND_TOOL);
    const conus_result *best = conus_selection_result(selection, 0);
    float at[2];
    if (best && best->object && best->pixels && window_point(at, window, best->contact)) {
        ui_draw_circle(at, 4, colour, 1.5F);
        const struct ui_box *box = &window->screen.panes[PANE_3D];
        char title[VIEW_ATLAS_TITLE];
        pane_name(&window->frame.labels, box, at, false, colour, best->object,
                  view_atlas_title(title, viewer->drawn, best->object));
    }
}

void pane_second_3d(struct window *window)
{
    struct shell shell;
    float apex[2];
    const double *eye = window->pictures.shown.camera.world_from_device + 12;
    if (!shows(window)) {
        return;
    }
    tool_update_second(window->viewer); /* a panel may have changed the atlas in this frame */
    ui_colour colour = find_colour(window);
    find_shell(&shell, window, seen_length(window));
    for (size_t i = 0; i < SHELL_POINTS; i++) {
        size_t next = (i + 1) % SHELL_POINTS;
        draw_between(window, shell.far[i], shell.far[next], colour);
        draw_between(window, shell.near[i], shell.near[next], colour);
        if (shell_turns(&shell, i, eye)) {
            draw_between(window, shell.near[i], shell.far[i], colour);
        }
    }
    if (window_point(apex, window, window->viewer->tools[SECOND_TOOL].pose.world_from_device + 12)) {
        ui_draw_circle(apex, 4, colour, 0);
    }
    draw_best(window, colour);
}
