/* SPDX-License-Identifier: BSD-3-Clause */
/* Grey values of the cuts, opacities and the background by keys; each says what it did in numbers. */
#include "viewer/commands/keys_look.h"

#include <math.h>

static const double grey_step = 0.05, opacity_step = 0.1;

static void say_grey(struct viewer *viewer)
{
    const double *grey = view_atlas_grey(viewer->drawn);
    viewer_say(viewer, "cuts: black %.6g, white %.6g", grey[0], grey[1]);
}

static void move_grey(struct window *window, double right, double up)
{
    if (viewer_move_grey(window->viewer, right, up)) {
        say_grey(window->viewer);
    } else {
        viewer_say(window->viewer, "there are no grey values: start with --context");
    }
}

void look_brighter(struct window *window)
{
    move_grey(window, 0, grey_step);
}

void look_darker(struct window *window)
{
    move_grey(window, 0, -grey_step);
}

void look_more_contrast(struct window *window)
{
    move_grey(window, 2 * grey_step, 0);
}

void look_less_contrast(struct window *window)
{
    move_grey(window, -2 * grey_step, 0);
}

void look_reset_grey(struct window *window)
{
    viewer_set_grey(window->viewer, 0, 0);
    say_grey(window->viewer);
}

/* Of the chosen area, or else of what the cone does not hit, which stays to be seen. */
static void change_opacity(struct window *window, double by)
{
    struct viewer *viewer = window->viewer;
    uint32_t chosen = viewer->drawn->shown.chosen;
    const conus_object *object = conus_atlas_object(viewer->drawn->atlas, chosen);
    if (object && object->kind == CONUS_KIND_BUNDLE) {
        viewer_say(viewer, "%s: streamlines are always opaque", object->name);
        return;
    }
    double now = viewer->drawn->look.opacity[chosen];
    double next = fmin(fmax((isnan(now) ? 1 : now) + by, chosen ? 0 : opacity_step), 1);
    viewer_set_opacity(viewer, chosen, next);
    viewer_say(viewer, "%s: %.2f opaque", object ? object->name : "what the cone does not hit", next);
}

void look_more_opaque(struct window *window)
{
    change_opacity(window, opacity_step);
}

void look_less_opaque(struct window *window)
{
    change_opacity(window, -opacity_step);
}

void look_next_streamlines(struct window *window)
{
    struct viewer *viewer = window->viewer;
    const conus_atlas *atlas = viewer->drawn->atlas;
    size_t count = tract_colour_count(atlas);
    if (!count) {
        viewer_say(viewer, "there are no streamlines: start with --streamlines");
        return;
    }
    viewer_colour_streamlines(viewer, (viewer->drawn->look.streamlines + 1) % count);
    viewer_say(viewer, "streamlines by %s", tract_colour_name(atlas, viewer->drawn->look.streamlines));
}

void look_next_backdrop(struct window *window)
{
    struct viewer *viewer = window->viewer;
    viewer->display.backdrop = (enum backdrop)((viewer->display.backdrop + 1) % BACKDROP_COUNT);
    viewer->version++;
    viewer_say(viewer, "background: %s", backdrop_names[viewer->display.backdrop]);
}
