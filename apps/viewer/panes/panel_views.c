/* SPDX-License-Identifier: BSD-3-Clause */
/* Buttons over the 3-D pane: the brain alone, and where it is looked at from. */
#include "viewer/panes/panels.h"

static const float inset = 8; /* pixels at scale 1, from the pane's corner */

static const struct {
    const char *label, *key, *tip;
} buttons[] = {{"Brain alone", "f", "the brain has the whole window, and gives it back (F)"},
               {"L", "ctrl+1", "looks at the left side (Ctrl+1)"},
               {"R", "ctrl+2", "looks at the right side (Ctrl+2)"},
               {"A", "ctrl+3", "looks at the front (Ctrl+3)"},
               {"P", "ctrl+4", "looks at the back (Ctrl+4)"},
               {"S", "ctrl+5", "looks from above (Ctrl+5)"},
               {"I", "ctrl+6", "looks from below (Ctrl+6)"},
               {"Measure", "ctrl+m", "two clicks give a distance, in 3-D or in a cut (Ctrl+M)"}};

enum { BUTTONS = sizeof buttons / sizeof buttons[0] };

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
    size_t rows = find_rows(begins, &out->width, part * box->width - 2 * margin);
    out->x = box->x + margin;
    out->y = box->y + margin;
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
    ui_panel_end();
}
