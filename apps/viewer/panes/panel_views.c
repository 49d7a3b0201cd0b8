/* SPDX-License-Identifier: BSD-3-Clause */
/* Buttons over the 3-D pane: the brain alone, and where it is looked at from. */
#include "viewer/panes/panes.h"
#include "viewer/ui/ui.h"

#include <math.h>

static const float inset = 8; /* pixels at scale 1, from the pane's corner */

static const struct {
    const char *label, *key, *tip;
} buttons[] = {{"Brain alone", "f", "the brain has the whole window, and gives it back (F)"},
               {"L", "ctrl+1", "looks at the left side (Ctrl+1)"},
               {"R", "ctrl+2", "looks at the right side (Ctrl+2)"},
               {"A", "ctrl+3", "looks at the front (Ctrl+3)"},
               {"P", "ctrl+4", "looks at the back (Ctrl+4)"},
               {"S", "ctrl+5", "looks from above (Ctrl+5)"},
               {"I", "ctrl+6", "looks from below (Ctrl+6)"}};

enum { BUTTONS = sizeof buttons / sizeof buttons[0] };

static const double glass = 0.15; /* opacity */
static const char as_glass[] = "Areas as glass", why[] = "Other areas are left out: they would hide fibres";

/* Whether pictures have pathways or streamlines, and so leave out the areas of voxels, which would hide them, or draw
 * them as glass. */
static bool has_areas_to_leave_out(const struct view_atlas *view)
{
    bool found = false;
    for (size_t number = 1; number <= view->object_count && !found; number++) {
        const conus_object *object = conus_atlas_object(view->atlas, number);
        found = object->kind == CONUS_KIND_AREA && object->voxels && !view->shown.hidden[number];
    }
    return found && view_atlas_shows_tracts(view);
}

/* Draws areas that are not hit as glass, and pathways as before. */
static void draw_areas_as_glass(struct viewer *viewer)
{
    for (uint32_t number = 1; number <= viewer->drawn->object_count; number++) {
        bool is_area = conus_atlas_object(viewer->drawn->atlas, number)->kind == CONUS_KIND_AREA;
        if (!is_area && isnan(viewer->drawn->appearance.opacity[number])) {
            viewer_set_opacity(viewer, number, 1);
        }
    }
    viewer_set_opacity(viewer, 0, glass);
}

/* Which buttons begin a row, and the widest row. */
static size_t find_rows(bool begins[BUTTONS], float *widest, float room)
{
    size_t rows = 0;
    float wide = 0;
    *widest = 0;
    for (size_t i = 0; i < BUTTONS; i++) {
        float width = ui_button_width(buttons[i].label);
        begins[i] = !i || wide + width > room;
        wide = begins[i] ? width : wide + width;
        *widest = fmaxf(*widest, wide);
        rows += begins[i];
    }
    return rows;
}

static size_t place_rows(bool begins[BUTTONS], struct ui_box *out, const struct window *window)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    float margin = inset * window->screen.scale;
    float part = window->viewer->display.device_view ? 0.7F : 1;
    float room = part * box->width - 2 * margin;
    size_t rows = find_rows(begins, &out->width, room);
    out->x = box->x + margin;
    out->y = box->y + margin;
    if (has_areas_to_leave_out(window->viewer->drawn)) {
        out->width = fminf(fmaxf(out->width, ui_button_width(as_glass) + ui_text_width(why)), room);
        rows++;
    }
    out->height = (1.2F + 1.5F * (float)(rows - 1)) * ui_line();
    return rows;
}

void panel_views_size(float out[2], const struct window *window)
{
    bool begins[BUTTONS];
    struct ui_box box;
    place_rows(begins, &box, window);
    out[0] = box.width + inset * window->screen.scale;
    out[1] = box.height + 2 * inset * window->screen.scale;
}

void panel_views(struct window *window)
{
    bool begins[BUTTONS];
    struct ui_box box;
    if (!screen_shows_pane(&window->screen, PANE_3D) || place_rows(begins, &box, window) > BUTTONS / 2) {
        return; /* of a pane that is too narrow they would be a list */
    }
    ui_panel("views", box, UI_PLAIN);
    for (size_t i = 0; i < BUTTONS; i++) {
        if (!begins[i]) {
            ui_same_line();
        }
        if (ui_small_button(buttons[i].label, buttons[i].tip)) {
            window_press(window, buttons[i].key);
        }
    }
    if (has_areas_to_leave_out(window->viewer->drawn)) {
        if (window->viewer->drawn->appearance.opacity[0] < 1) {
            if (ui_small_button("Leave areas out", "draws pathways and streamlines, and the areas that are hit")) {
                viewer_set_opacity(window->viewer, 0, 1);
            }
        } else {
            if (ui_small_button(as_glass,
                                "draws areas that are not hit, too: pathways and streamlines are seen through them")) {
                draw_areas_as_glass(window->viewer);
            }
            ui_same_line();
            ui_text_cut(why, ui_room());
        }
    }
    ui_panel_end();
}
