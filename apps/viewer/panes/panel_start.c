/* SPDX-License-Identifier: BSD-3-Clause */
/* The start page: what conus is, what to do first, and the ways to open an atlas. */
#include "conus/file.h"
#include "options/output.h"
#include "viewer/panes/panels.h"
#include "viewer/ui/ui_list.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const float number_width = 26;
static const float least_wide = 700, gap = 24; /* from here on the lists stand side by side, so far apart */

static void draw_field(struct window *window)
{
    static const char open[] = "Open";
    static const char choose[] = "Choose a file";
    static const char formats[] =
        "Volumes (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF), surfaces, CIFTI labels, FSL's XML, "
        "folders of surfaces or of BrainGlobe, manifests. On an atlas that is open: streamlines (.trk, .tck, .trx, "
        "VTK, .tt.gz), an image as context";
    struct start *start = &window->start;
    float around = 14 * window->screen.scale; /* a button's text, and before it */
    float buttons = ui_text_width(open) + ui_text_width(choose) + 2 * around;
    ui_text_wrapped(THEME_PLAIN, "Drop an atlas on this window, a file or a folder, or give its path or name:");
    ui_width(ui_room() - buttons);
    ui_take_keys(&start->takes_keys);
    bool asked = ui_type_path("##path", start->typed, sizeof start->typed,
                              "search installed atlases, or ~/atlases/aal.nii.gz", "", SIZE_MAX, &start->is_set);
    int moved = ui_wants_keys() ? ui_arrow() : 0; /* else keys.c hears them */
    if (moved) {
        start_move(start, moved);
    }
    ui_tip("a path, or the name of an installed atlas; Enter opens it");
    ui_same_line();
    asked = ui_button(open, "opens what is typed on its left") || asked;
    ui_same_line();
    if (ui_button(choose, "by folders (Ctrl+O)")) {
        window_show_dialog(window, DIALOG_OPEN);
    }
    ui_text_wrapped(start->why[0] ? THEME_ORANGE : THEME_HINT, start->why[0] ? start->why : formats);
    if (asked) {
        window_request_typed(window);
    }
}

/* Shows its name; the folder, too, where another one has that name. */
static void show_name(const struct start *start, size_t index)
{
    char words[SYSTEM_PATH];
    const char *name = start_words(words, start, index);
    const char *about = installed_about(name);
    bool is_alone = true;
    for (size_t i = 0; start_path(start, i); i++) {
        is_alone = is_alone &&
                   (i == index || strcmp(path_name(start_path(start, i)), path_name(start_path(start, index))) != 0);
    }
    if (!is_alone) {
        panel_path(words);
        return;
    }
    ui_text("%s", name);
    if (about) {
        ui_same_line();
        ui_text_coloured(THEME_HINT, "%s", about);
    }
}

/* Draws a line with its number, which is a key; its path is in the tip. */
static void draw_entry(struct window *window, size_t index)
{
    char words[SYSTEM_PATH];
    start_words(words, &window->start, index);
    bool chosen = panel_row(window, index, false, words);
    ui_text_coloured(THEME_ACCENT, "%zu", index + 1);
    ui_same_line_at(number_width * window->screen.scale);
    show_name(&window->start, index);
    if (chosen) {
        window_request_file(window, start_path(&window->start, index));
    }
}

static void draw_list_title(const char *title)
{
    ui_text_coloured(THEME_HINT, "%s", title);
    ui_separator();
}

static void draw_list(struct window *window, const char *title, size_t first, size_t end)
{
    if (first == end) {
        return;
    }
    draw_list_title(title);
    for (size_t i = first; i < end; i++) {
        draw_entry(window, i);
    }
    ui_gap(ui_line() / 2);
}

static void draw_phantom(struct window *window)
{
    draw_list_title("To begin with");
    bool chosen = panel_row(window, RECENT_LIMIT + 1, false,
                            "eleven areas, a pathway and a context, made by conus; not a real brain");
    ui_text_coloured(THEME_ACCENT, "S");
    ui_same_line_at(number_width * window->screen.scale);
    ui_text("brain phantom");
    ui_same_line();
    ui_text_coloured(THEME_HINT, "made by conus, to try it");
    if (chosen) {
        window_request_sample(window);
    }
}

static void draw_known(struct window *window)
{
    const struct start *start = &window->start;
    size_t recent = start->recent.count;
    draw_list(window, "Opened before", 0, recent);
    draw_list(window, "To begin with", recent, recent + (start->found[0] != '\0'));
    if (start->has_no_sample) {
        draw_phantom(window);
    }
}

/* "1 mm", "1 x 1 x 2 mm"; "" of surfaces. */
static void write_spacing(char out[64], const double mm[3])
{
    bool is_cube = fabs(mm[1] - mm[0]) < 1e-4 && fabs(mm[2] - mm[0]) < 1e-4;
    out[0] = '\0';
    if (mm[0] > 0 && is_cube) {
        snprintf(out, 64, ", %.4g mm", mm[0]);
    } else if (mm[0] > 0) {
        snprintf(out, 64, ", %.4g x %.4g x %.4g mm", mm[0], mm[1], mm[2]);
    }
}

static void draw_installed(struct window *window, size_t index, bool picked)
{
    const conus_installed *atlas = conus_catalogue_atlas(window->start.catalogue, index);
    char words[SYSTEM_PATH];
    char spacing[64];
    const char *about = installed_about(atlas->name);
    write_spacing(spacing, atlas->spacing);
    snprintf(words, sizeof words, "%s", atlas->path);
    conus_plain_text(words);
    bool chosen = panel_row(window, index, picked, words);
    if (picked && window->start.scrolls) {
        ui_scroll_here();
        window->start.scrolls = false;
    }
    ui_text("%s", atlas->name);
    ui_same_line();
    snprintf(words, sizeof words, "%s%s, %s", about ? about : atlas->kind, spacing, atlas->source);
    ui_tint(THEME_HINT);
    ui_text_cut(words, ui_room());
    ui_tint_end();
    if (chosen && installed_words(words, window->start.catalogue, atlas)) {
        window_request_file(window, words);
    }
}

/* Draws installed atlases in a list that scrolls by itself, since there may be hundreds. */
static void draw_catalogue(struct window *window, float height)
{
    struct start *start = &window->start;
    const char *words = start_words_typed(start);
    size_t picked = start_picked(start);
    size_t fitting = 0;
    draw_list_title("Installed on this computer");
    ui_scroll("installed", fmaxf(height - 1.5F * ui_line(), 0));
    for (size_t i = 0; i < conus_catalogue_count(start->catalogue); i++) {
        bool is_named = i == picked; /* as "mricron:aal" */
        bool fits = installed_fits(conus_catalogue_atlas(start->catalogue, i), words);
        if (fits && (is_named || !installed_is_twin(start->catalogue, i))) {
            draw_installed(window, i, i == picked);
            fitting++;
        }
    }
    if (!fitting) {
        ui_text_wrapped(THEME_HINT, conus_catalogue_count(start->catalogue)
                                        ? "No installed atlas has such a name."
                                        : "None was found. \"conus atlases\" lists where conus looks.");
    }
    ui_scroll_end();
}

static void draw_lists(struct window *window, float height)
{
    float width = ui_room();
    float half = floorf((width - gap * window->screen.scale) / 2);
    if (width < least_wide * window->screen.scale) {
        draw_known(window);
        draw_catalogue(window, fmaxf(height / 2, 8 * ui_line()));
        return;
    }
    ui_column("known", half, height);
    draw_known(window);
    ui_scroll_end();
    ui_same_line_at(half + gap * window->screen.scale);
    ui_column("catalogue", half, height);
    draw_catalogue(window, ui_room_below());
    ui_scroll_end();
}

static void draw_keys(const struct window *window)
{
    if (start_path(&window->start, 0)) {
        panel_key(window, "1, 2 ...", "open what has this number");
    }
    panel_key(window, "A-Z, Tab", "search or type a path; the arrow keys choose, Enter opens");
    panel_key(window, "Ctrl+O", "choose a file");
    if (window->files.session_waits) {
        panel_key(window, "Escape", "open atlases without the session");
    } else if (window->viewer) {
        panel_key(window, "Escape", "back to the atlas that is open");
    }
    panel_key(window, "?", "keys and mouse where an atlas is open");
}

void panel_start(struct window *window)
{
    float margin = 16 * window->screen.scale;
    float height = (float)window->screen.height;
    panel_page(window, "start");
    ui_scroll("page", 0);
    ui_gap(fmaxf(0.08F * height - margin, 0));
    ui_heading("conus");
    ui_text_wrapped(THEME_PLAIN, "Which areas of the brain does this beam, probe or pointing hand reach?");
    ui_gap(ui_line() / 2);
    ui_text_wrapped(THEME_PLAIN,
                    "First open an atlas: click one below. Then move the mouse over the brain: a cone begins under it, "
                    "and the list on the right names the areas that it hits. A click holds the cone.");
    ui_gap(ui_line() / 2);
    draw_field(window);
    ui_gap(ui_line() / 2);
    draw_lists(window, fmaxf(ui_room_below() - 6.5F * ui_line(), 10 * ui_line()));
    ui_gap(ui_line() / 2);
    draw_keys(window);
    ui_scroll_end();
    ui_panel_end();
}
