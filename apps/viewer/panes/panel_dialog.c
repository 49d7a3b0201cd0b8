/* SPDX-License-Identifier: BSD-3-Clause */
/* The page on which a file is chosen: a line for its path, places, and what is in the folder. */
#include "conus/own.h"
#include "options/output.h"
#include "viewer/panes/panes.h"
#include "viewer/ui/ui.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const float places_width = 280, gap = 20;

static void draw_line(struct window *window)
{
    struct dialog *dialog = &window->dialog;
    bool saves = dialog->purpose == DIALOG_SAVE;
    static const char *const saved[] = {"Save the session as", "Save the session as", "Save the window's picture as",
                                        "Export the hits as", "Save the study as"};
    ui_heading(saves ? saved[window->files.saves]
                     : "Open an atlas or a session, or add streamlines, a context, points or poses");
    ui_width(ui_room());
    ui_take_keys(&dialog->takes_keys);
    bool entered = ui_type_path("##path", dialog->text, sizeof dialog->text, "", dialog->prefilled, dialog->selected,
                                &dialog->is_set);
    int moved = ui_wants_keys() ? ui_arrow() : 0; /* else keys.c takes them */
    if (moved) {
        dialog_move(dialog, moved);
    }
    char hint[64];
    snprintf(hint, sizeof hint, "Type a name for the file; %s is put behind it",
             dialog->ending ? dialog->ending : ".json");
    ui_text_wrapped(dialog->why[0] ? THEME_ORANGE
                    : saves        ? THEME_PLAIN
                                   : THEME_HINT,
                    dialog->why[0] ? dialog->why
                    : saves        ? hint
                                   : "Type a path, or a part of a name to search this folder");
    if (entered) {
        window_use_dialog(window);
    }
}

static void draw_places(struct window *window)
{
    struct dialog *dialog = &window->dialog;
    ui_text_coloured(THEME_HINT, "Places");
    ui_separator();
    for (size_t i = 0; i < dialog->place_count; i++) {
        char plain[SYSTEM_PATH];
        snprintf(plain, sizeof plain, "%s", dialog->places[i]);
        conus_plain_text(plain);
        bool chosen = panel_row(window, i, false, plain, 0);
        panel_path(plain);
        if (chosen) {
            char text[SYSTEM_PATH + 1];
            snprintf(text, sizeof text, "%s%s", dialog->places[i], strcmp(dialog->places[i], "/") == 0 ? "" : "/");
            dialog_set(dialog, text);
        }
    }
}

/* Whether the list may have changed by a click. */
static bool draw_entry(struct window *window, size_t index)
{
    struct dialog *dialog = &window->dialog;
    const struct folder_entry *entry = &dialog->folder.entries[index];
    bool is_folder = entry->is_folder;
    char plain[SYSTEM_NAME + 2];
    snprintf(plain, sizeof plain, "%s%s", entry->name, is_folder ? "/" : "");
    conus_plain_text(plain);
    bool clicked = panel_row(window, index, index == dialog->marked, NULL, 0);
    if (dialog->scrolls && index == dialog->marked) {
        ui_scroll_here();
        dialog->scrolls = false;
    }
    bool doubled = ui_hovered() && ui_mouse_now().doubled;
    ui_tint(is_folder ? THEME_ACCENT : THEME_PLAIN);
    ui_name_cut(plain, ui_room());
    ui_tint_end();
    if (clicked) {
        dialog_take(dialog, index);
    }
    if (doubled && !is_folder) {
        window_use_dialog(window);
    }
    return clicked;
}

static void draw_folder(struct window *window)
{
    struct dialog *dialog = &window->dialog;
    char here[SYSTEM_PATH];
    size_t fitting = 0;
    bool goes_on = true;
    dialog_look(dialog);
    dialog_here(here, dialog);
    conus_plain_text(here);
    ui_text_coloured(THEME_HINT, "%s", here);
    ui_separator();
    ui_scroll("entries", 0);
    if (ui_row("..  (the folder around it)", false, 0)) {
        dialog_leave(dialog);
    }
    for (size_t i = 0; i < dialog->folder.count && goes_on; i++) {
        if (dialog_fits(dialog, i)) {
            goes_on = !draw_entry(window, i);
            fitting++;
        }
    }
    if (!fitting && goes_on) {
        ui_text_coloured(THEME_HINT, "%s",
                         dialog->folder.missing  ? "There is no such folder."
                         : dialog->folder.failed ? "This folder cannot be read."
                         : dialog->all           ? "Nothing here has such a name."
                                                 : "Nothing here that conus can open by its name.");
    }
    ui_scroll_end();
}

static void draw_buttons(struct window *window)
{
    struct dialog *dialog = &window->dialog;
    bool saves = dialog->purpose == DIALOG_SAVE;
    if (ui_button(saves ? "Save" : "Open", NULL)) {
        window_use_dialog(window);
    }
    ui_same_line();
    if (!saves) {
        if (ui_button("Open this folder", "for an atlas that is a folder: of surfaces, or of BrainGlobe")) {
            window_use_folder(window);
        }
        ui_same_line();
        if (ui_button("Installed atlases", "the start page (Ctrl+N)")) {
            dialog->on = false;
            window_go_to_start(window);
        }
        ui_same_line();
    }
    if (ui_button("Cancel", NULL)) {
        dialog->on = false;
    }
    ui_same_line();
    ui_check("all files", &dialog->all, "lists files whatever their names end in");
}

void panel_dialog(struct window *window)
{
    float width = panel_page(window, "dialog");
    float places = floorf(fminf(places_width * window->screen.scale, width / 3));
    float height = (float)window->screen.height;
    ui_gap(fmaxf(0.04F * height, 0));
    draw_line(window);
    size_t pins = window->viewer && window->dialog.purpose == DIALOG_OPEN ? window->viewer->pin_count : 0;
    if (pins) {
        ui_text_coloured(
            THEME_ORANGE,
            "Another atlas in place of this one ends the list of what was kept (%zu); O in the window saves it.", pins);
    }
    ui_gap(ui_line() / 2);
    float lists = fmaxf(ui_room_below() - 4 * ui_line(), 5 * ui_line());
    ui_column("places", places, lists);
    draw_places(window);
    ui_scroll_end();
    ui_same_line_at(places + gap * window->screen.scale);
    ui_column("folder", width - places - gap * window->screen.scale, lists);
    draw_folder(window);
    ui_scroll_end();
    ui_gap(ui_line() / 4);
    draw_buttons(window);
    panel_key(window, "Up, down", "mark an entry; Enter goes into a folder or takes a file; Escape goes back");
    bool escaped = ui_escaped();
    ui_panel_end();
    window->dialog.on = window->dialog.on && !escaped;
}

static void ask_to_close(struct window *window)
{
    char text[256];
    snprintf(text, sizeof text, "No session has %s: it ends with the window.", window->forms.closing_loses);
    window_panel(window, "Close without saving?", 460, 130);
    ui_text_wrapped(THEME_ORANGE, text);
    ui_gap(ui_line() / 4);
    if (ui_main_button("Save\u2026", "saves the session, as Ctrl+S does: then the window closes unasked")) {
        window_answer_closing(window, false);
        window_press(window, "ctrl+s");
    }
    ui_same_line();
    if (ui_button("Close without saving", "Q, too")) {
        window_answer_closing(window, true);
    }
    ui_same_line();
    if (ui_button("Cancel", "all stays as it is; Enter or Escape")) {
        window_answer_closing(window, false);
    }
    ui_panel_end();
}

void panel_ask(struct window *window)
{
    const struct open_request *asked = &window->files.asked;
    char name[SYSTEM_NAME + 1];
    if (window->forms.closing_loses) {
        ask_to_close(window);
        return;
    }
    bool may_be_added = asked->may_be_added;
    size_t pins = window->viewer ? window->viewer->pin_count : 0;
    snprintf(name, sizeof name, "%s", path_name(asked->asked_of));
    conus_plain_text(name);
    window_panel(window, "Add or replace?", 460, 170);
    ui_text_wrapped(THEME_PLAIN, name);
    ui_text_wrapped(THEME_PLAIN,
                    may_be_added ? "Another atlas is open. Both can be: the same cone is asked in each, and each has a "
                                   "list. Or this one takes its place."
                                 : "This session takes the place of what is open.");
    if (pins) {
        ui_text_wrapped(THEME_ORANGE, "If it takes its place, the list of what was kept ends.");
    }
    ui_gap(ui_line() / 4);
    if (may_be_added) {
        if (ui_button("Add", "opens it beside what is open, as --atlas does; A or Enter")) {
            window_answer(window, OPEN_ADDS);
        }
        ui_same_line();
    }
    if (ui_button("Replace", "closes what is open; R")) {
        window_answer(window, OPEN_REPLACES);
    }
    ui_same_line();
    if (ui_button("Cancel", "all stays as it is; Escape")) {
        window_answer(window, OPEN_ASKS);
    }
    ui_panel_end();
}
