/* SPDX-License-Identifier: BSD-3-Clause */
/* Buttons for who does not know the keys yet. */
#include "viewer/panes/panels.h"

void panel_tip(enum property_id id)
{
    char tip[KEYS_TIP];
    ui_tip(keys_tip(tip, id));
}

/* Each is a key that is pressed. */
static void press(struct window *window, const char *label, const char *key, const char *tip)
{
    if (ui_button(label)) {
        window_press(window, key);
    }
    ui_tip(tip);
}

void panel_tools(struct window *window)
{
    press(window, "open", "ctrl+o", "an atlas or a session (Ctrl+O)");
    ui_same_line();
    press(window, "save", "ctrl+s", "saves the session (Ctrl+S)");
    ui_same_line();
    press(window, "undo", "ctrl+z", "takes back the last change (Ctrl+Z)");
    ui_same_line();
    press(window, "redo", "ctrl+y", "does it again (Ctrl+Y)");
    ui_same_line();
    press(window, " ? ", "?", "all keys, and what the mouse does (? or F1)");
    ui_separator();
}
