/* SPDX-License-Identifier: BSD-3-Clause */
/* Buttons over the 3-D pane: the brain alone, and where it is looked at from. */
#include "viewer/panes/panels.h"

static const float inset = 8; /* pixels at scale 1, from the pane's corner */

void panel_views(struct window *window)
{
    static const struct {
        const char *label, *key, *tip;
    } buttons[] = {{"Brain alone", "f", "the brain has the whole window, and gives it back (F)"},
                   {"Left", "ctrl+1", "looks at the left side (Ctrl+1)"},
                   {"Right", "ctrl+2", "looks at the right side (Ctrl+2)"},
                   {"Front", "ctrl+3", "looks at the front (Ctrl+3)"},
                   {"Back", "ctrl+4", "looks at the back (Ctrl+4)"},
                   {"Top", "ctrl+5", "looks from above (Ctrl+5)"},
                   {"Bottom", "ctrl+6", "looks from below (Ctrl+6)"},
                   {"Measure", "ctrl+m", "two clicks give a distance, in 3-D or in a cut (Ctrl+M)"}};
    enum { BUTTONS = sizeof buttons / sizeof buttons[0] };
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    float margin = inset * window->screen.scale;
    float room = 0.7F * box->width - 2 * margin; /* beside what the device sees */
    float wide = 0;
    size_t count = 0;
    while (count < BUTTONS && wide + ui_button_width(buttons[count].label) <= room) {
        wide += ui_button_width(buttons[count++].label);
    }
    if (!count || !screen_shows_pane(&window->screen, PANE_3D)) {
        return;
    }
    ui_panel("views", (struct ui_box){box->x + margin, box->y + margin, wide, 1.2F * ui_line()}, UI_PLAIN);
    for (size_t i = 0; i < count; i++) {
        if (i) {
            ui_same_line();
        }
        if (ui_small_button(buttons[i].label, buttons[i].tip)) {
            window_press(window, buttons[i].key);
        }
    }
    ui_panel_end();
}
