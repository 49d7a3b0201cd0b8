/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of all keys. */
#include "viewer/commands/keys.h"

#include "viewer/commands/keys_view.h"
#include "viewer/ui/ui_list.h"

#include <math.h>

/* As on the keyboard: Ctrl+O. */
static void write_key(char out[KEY_LIMIT], const char *key)
{
    bool first = true;
    size_t used = 0;
    for (; key[used] && used + 1 < KEY_LIMIT; used++) {
        bool is_small = key[used] >= 'a' && key[used] <= 'z';
        out[used] = (char)(key[used] + (first && is_small ? 'A' - 'a' : 0));
        first = key[used] == '+';
    }
    out[used] = '\0';
}

static void show_key(const char *key, const char *meaning, float at)
{
    char text[KEY_LIMIT];
    write_key(text, key);
    ui_text_coloured(theme_texts[THEME_AMBER], "%s", text);
    ui_same_line_at(at);
    ui_text_wrapped(meaning);
}

/* In two columns where there is room. */
static void show_keys(float at)
{
    const char *meaning;
    const char *name;
    size_t count = 0;
    while (keys_name(&meaning, count)) {
        count++;
    }
    for (size_t i = 0; (name = keys_name(&meaning, i)); i++) {
        if (meaning) {
            show_key(name, meaning, at);
        }
        if (i + 1 == (count + 1) / 2) {
            ui_next_column();
        }
    }
    for (size_t i = 0; (name = keys_view_name(&meaning, i)); i++) {
        show_key(name, meaning, at);
    }
    show_key("W S A D", "the wand: forward, back, left, right", at);
    show_key("E Q", "the wand: up, down", at);
}

void keys_draw_help(struct window *window)
{
    bool is_wide = (float)window->screen.width >= 1240 * window->screen.scale;
    float width = fminf((is_wide ? 1240 : 640) * window->screen.scale, (float)window->screen.width);
    float height = fminf((is_wide ? 680 : 780) * window->screen.scale, (float)window->screen.height);
    ui_panel("Keys and mouse (?, F1 or Escape closes this)",
             (struct ui_box){((float)window->screen.width - width) / 2, ((float)window->screen.height - height) / 2,
                             width, height},
             UI_IN_FRONT);
    ui_columns(is_wide ? 2 : 1);
    show_keys(120 * window->screen.scale);
    ui_columns(1);
    ui_separator();
    ui_text_wrapped(
        "3-D: left button turns, right button moves, wheel comes nearer; the cone follows the mouse, a click holds it "
        "and sets the crosshair, another one lets it go, a double click confirms.\n"
        "Flat panes: left button sets the crosshair, wheel goes through the cuts, Ctrl and wheel magnify; middle "
        "button, or Ctrl and left, drags the context's brightness (up) and contrast (right), a double click resets; "
        "with the wand, right button puts the device there, with Shift it points there.\n"
        "SpaceMouse: the cap moves and turns the tool along its own axes; first button holds, second resets, third "
        "confirms.\n"
        "Gamepad: left stick moves forward, back and aside, right stick turns, shoulder buttons move down and up, "
        "triggers narrow and widen the cone; A holds, B resets, X confirms.");
    ui_panel_end();
}
