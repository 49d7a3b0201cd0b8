/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the names of what is under the mouse, in each atlas. */
#include "viewer/window/window.h"

#include "viewer/model/viewer.h"

#include <math.h>
#include <stdio.h>

enum { NAME_TEXT = 256 };

static const double told_mm = 0.5; /* depths that differ by less count as the same */

/* The object of an atlas at the mouse, and how much deeper it is than the drawn atlas's. */
struct found {
    uint32_t object;
    double value;  /* of a pathway; NaN of an area */
    double deeper; /* mm */
};

static void find_along_ray(struct found *out, const struct hover *hover, struct view_atlas *view)
{
    double depth;
    double drawn = 0;
    double place[3];
    if (!hover->object) { /* nothing is there, or the context hides it */
        return;
    }
    out->object = view_atlas_pick(&depth, view, hover->eye, hover->direction);
    for (int a = 0; a < 3 && out->object; a++) {
        place[a] = hover->eye[a] + depth * hover->direction[a];
        drawn += (hover->at[a] - hover->eye[a]) * hover->direction[a];
    }
    if (out->object) {
        out->value = view_atlas_value(view, out->object, place);
        out->deeper = depth - drawn;
    }
}

static void find_at_mouse(struct found *out, const struct window *window, struct view_atlas *view)
{
    const struct hover *hover = &window->frame.hover;
    const double *at = hover->has_place ? hover->at : window->viewer->crosshair;
    *out = (struct found){.value = NAN};
    if (hover->has_place && view == window->viewer->drawn) {
        out->object = hover->object;
        out->value = hover->value;
    } else if (hover->has_place && hover->by_ray) {
        find_along_ray(out, hover, view);
    } else {
        out->object = view_atlas_at(view, at);
        out->value = view_atlas_value(view, out->object, at);
    }
}

static void name(char out[NAME_TEXT], const struct window *window, struct view_atlas *view)
{
    struct found found;
    find_at_mouse(&found, window, view);
    const conus_object *object = conus_atlas_object(view->atlas, found.object);
    char title[VIEW_ATLAS_TITLE];
    int used = snprintf(out, NAME_TEXT, "%.200s", object ? view_atlas_title(title, view, found.object) : "");
    if (object && isfinite(found.value)) {
        used += snprintf(out + used, NAME_TEXT - (size_t)used, "  %.3g", found.value);
    }
    if (fabs(found.deeper) >= told_mm) {
        snprintf(out + used, NAME_TEXT - (size_t)used, " (%.1f mm %s)", fabs(found.deeper),
                 found.deeper > 0 ? "deeper" : "nearer");
    }
}

void hover_text(char out[HOVER_TEXT], const struct window *window, const char *between)
{
    const struct viewer *viewer = window->viewer;
    char text[NAME_TEXT];
    size_t used = 0;
    out[0] = '\0';
    if (viewer->atlas_count == 1) {
        name(out, window, viewer->drawn);
    }
    for (size_t i = 0; i < viewer->atlas_count && viewer->atlas_count > 1 && used < HOVER_TEXT; i++) {
        struct view_atlas *view = &viewer->atlases[i];
        name(text, window, view);
        used += (size_t)snprintf(out + used, HOVER_TEXT - used, "%s%s: %s", i ? between : "", view->name,
                                 text[0] ? text : "-");
    }
}

void hover_tip(const struct window *window)
{
    const struct forms *forms = &window->forms;
    char tip[HOVER_TEXT];
    if (!forms->figure.open && !forms->added.open && !forms->show_help) { /* over which it would lie */
        hover_text(tip, window, "\n");
        ui_tip(tip);
    }
}
