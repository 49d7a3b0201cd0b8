/* SPDX-License-Identifier: BSD-3-Clause */
/* The start page: what conus is, what to do first, and the ways to open an atlas. */
#include "conus/own.h"
#include "options/output.h"
#include "viewer/panes/panes.h"
#include "viewer/ui/ui.h"
#include "viewer/window/start.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ABOUT = 512, PICTURED = 1000 /* beside the numbers of rows */ };

static const float number_width = 26;
static const float least_wide = 700, gap = 24; /* from here on the lists stand side by side, so far apart */
static const char sources[] =
    "conus lists those that mricron (Debian's package mricron-data), FSL, FreeSurfer, BrainGlobe, TemplateFlow, AFNI, "
    "SPM, CAT12, nilearn and MRIcroGL keep on this computer, and your own in the folder $CONUS_ATLAS_PATH. \"conus "
    "atlases --places\" says where it looks. Any other one: drop it here.";

static void draw_field(struct window *window)
{
    static const char open[] = "Open";
    static const char choose[] = "Choose a file";
    struct start *start = &window->start;
    float around = 14 * window->screen.scale; /* a button's text, and before it */
    float buttons = ui_text_width(open) + ui_text_width(choose) + 2 * around;
    ui_text_wrapped(THEME_PLAIN, "Drop an atlas on this window, a file or a folder, or give its path or name:");
    ui_width(ui_room() - buttons);
    ui_take_keys(&start->takes_keys);
    bool asked = ui_type_path("##path", start->typed, sizeof start->typed,
                              "search installed atlases, or ~/atlases/aal.nii.gz", "", SIZE_MAX, &start->is_set);
    int moved = ui_wants_keys() ? ui_arrow() : 0; /* else keys.c takes them */
    if (moved) {
        start_move(start, moved);
    }
    ui_tip(
        "a path, or the name of an installed atlas, which the arrow keys choose; Enter opens it: volumes (NIfTI,\n"
        "MGH, NRRD, MetaImage, AFNI, TIFF), surfaces, CIFTI labels, FSL's XML, folders of surfaces or of BrainGlobe,\n"
        "manifests; on an atlas that is open streamlines (.trk, .tck, .trx, VTK, .tt.gz), an image as context,\n"
        "points or poses, such as contacts, needles or coils");
    ui_same_line();
    asked = ui_button(open, "opens what is typed on its left") || asked;
    ui_same_line();
    if (ui_button(choose, "by folders (Ctrl+O)")) {
        window_show_dialog(window, DIALOG_OPEN);
    }
    ui_text_wrapped(THEME_ORANGE, start->why);
    if (asked) {
        window_request_typed(window);
    }
}

/** A row of a list. */
struct offer {
    size_t id;
    const char *key; /**< That opens it; NULL = none. */
    const char *name, *tip;
    uint32_t picture; /**< 0 = none. */
    bool is_picked;
};

/* Draws it with a picture, and what is said about it below its name; returns whether it was clicked. */
static bool draw_offer(const struct window *window, const struct offer *offer, const char *about)
{
    const float scale = window->screen.scale;
    const float high = ceilf(2 * ui_line());
    bool clicked = panel_row(window, offer->id, offer->is_picked, offer->tip, high);
    if (offer->key) {
        ui_text_coloured(THEME_ACCENT, "%s", offer->key);
        ui_same_line_at(number_width * scale);
    }
    if (offer->picture) {
        ui_picture(offer->picture, high / THUMBNAIL_HEIGHT * THUMBNAIL_WIDTH, high);
        ui_same_line();
    }
    ui_group();
    ui_name_cut(offer->name, ui_room());
    ui_tint(THEME_HINT);
    ui_text_cut(about, ui_room());
    ui_tint_end();
    ui_group_end();
    return clicked;
}

/* Draws the first brain that has a picture, so large as the lists below leave room: a click opens it. */
static void draw_brain(struct window *window, float height)
{
    const float least = 100 * window->screen.scale;
    const size_t index = start_pictured(&window->start, window->wake, window->files.remembers);
    const float high = floorf(
        fminf(fminf(height, THUMBNAIL_HEIGHT * window->screen.scale), ui_room() * THUMBNAIL_HEIGHT / THUMBNAIL_WIDTH));
    char words[SYSTEM_PATH];
    if (index == SIZE_MAX || high < least) {
        return;
    }
    start_words(words, &window->start, index);
    bool clicked = panel_row(window, PICTURED, false, words, high);
    ui_picture(start_known(&window->start, index, false).picture.name, high / THUMBNAIL_HEIGHT * THUMBNAIL_WIDTH, high);
    ui_gap(ui_line() / 4);
    if (clicked) {
        window_request_file(window, start_path(&window->start, index));
    }
}

/* ", 1 mm", ", 1 x 1 x 2 mm"; "" of surfaces. */
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

/* "Automated Anatomical Labeling, human, 116 areas, 1 mm, mricron": as much of it as is known. */
static void write_about(char out[ABOUT], const char *name, const conus_installed *atlas, uint32_t areas)
{
    const char *about = installed_about(name);
    char count[32] = "";
    char spacing[64] = "";
    if (areas) {
        snprintf(count, sizeof count, ", %u area%s", areas, areas == 1 ? "" : "s");
    }
    if (atlas) {
        write_spacing(spacing, atlas->spacing);
    }
    int used = snprintf(out, ABOUT, "%s%s%s%s%s",
                        about   ? about
                        : atlas ? atlas->kind
                                : "",
                        count, spacing, atlas ? ", " : "", atlas ? atlas->source : "");
    if (out[0] == ',') { /* nothing stands before it */
        memmove(out, out + 2, (size_t)used - 1);
    }
}

/* Whether no other path of the lists has its name. */
static bool is_alone(const struct start *start, size_t index)
{
    bool is = true;
    for (size_t i = 0; start_path(start, i); i++) {
        is = is && (i == index || strcmp(path_name(start_path(start, i)), path_name(start_path(start, index))) != 0);
    }
    return is;
}

/* Draws a line with its number, which is a key; its path is in the tip, and below its name where another has that. */
static void draw_entry(struct window *window, size_t index)
{
    struct start *start = &window->start;
    char words[SYSTEM_PATH];
    char about[ABOUT];
    const char key[2] = {(char)('1' + index), '\0'};
    const char *name = start_words(words, start, index);
    const struct known_atlas known = start_known(start, index, false);
    const struct offer offer = {.id = index,
                                .key = key,
                                .name = name,
                                .tip = words,
                                .picture = index < start->recent.count ? known.picture.name : 0};
    if (is_alone(start, index)) {
        write_about(about, name, start_installed(start, start_path(start, index)), known.areas);
    } else {
        snprintf(about, sizeof about, "%.*s", (int)(name - words), words);
    }
    if (draw_offer(window, &offer, about)) {
        window_request_file(window, start_path(start, index));
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
    static const struct offer phantom = {.id = RECENT_LIMIT + 1,
                                         .key = "S",
                                         .name = "brain phantom",
                                         .tip =
                                             "eleven areas, a pathway and a context, made by conus; not a real brain"};
    draw_list_title("To begin with");
    if (draw_offer(window, &phantom, "made by conus, to try it")) {
        window_request_sample(window);
    }
    ui_gap(ui_line() / 2);
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

static void draw_installed(struct window *window, size_t index, bool picked)
{
    struct start *start = &window->start;
    const conus_installed *atlas = conus_catalogue_atlas(start->catalogue, index);
    char words[SYSTEM_PATH];
    char about[ABOUT];
    const struct offer offer = {.id = index, .name = atlas->name, .tip = words, .is_picked = picked};
    snprintf(words, sizeof words, "%s", atlas->path);
    conus_plain_text(words);
    write_about(about, atlas->name, atlas, start_known(start, index, true).areas);
    bool chosen = draw_offer(window, &offer, about);
    if (picked && start->scrolls) {
        ui_scroll_here();
        start->scrolls = false;
    }
    if (chosen && installed_words(words, start->catalogue, atlas)) {
        window_request_file(window, words);
    }
}

/* Draws installed atlases in a list that scrolls by itself, since there may be hundreds. */
static void draw_catalogue(struct window *window, float height)
{
    struct start *start = &window->start;
    size_t picked = start_picked(start);
    size_t fitting = 0;
    draw_list_title("Installed on this computer");
    ui_scroll("installed", fmaxf(height - 1.5F * ui_line(), 0));
    for (size_t i = 0; i < conus_catalogue_count(start->catalogue); i++) {
        if (start_lists(start, i)) {
            draw_installed(window, i, i == picked);
            fitting++;
        }
    }
    if (!fitting) {
        ui_text_wrapped(THEME_HINT, !conus_catalogue_count(start->catalogue) ? "None was found."
                                    : start_words_typed(start)[0]            ? "No installed atlas has such a name."
                                                                             : "All are listed already.");
    }
    if (!conus_catalogue_count(start->catalogue)) {
        ui_text_wrapped(THEME_HINT, sources);
    }
    ui_scroll_end();
}

/* What an atlas is opened for, while nothing that was opened before has the place. */
static void draw_guide(const struct window *window)
{
    static const char *const asks[][2] = {{"Mouse", "What does the cone hit? A click holds it"},
                                          {"L", "What lies behind that? All depths of the cone"},
                                          {"/", "Where is an area? Search by name or label"},
                                          {"Drop", "A T1, streamlines, a second atlas: into the window"}};
    if (window->start.recent.count) {
        return;
    }
    draw_list_title("Once an atlas is open");
    for (size_t i = 0; i < sizeof asks / sizeof asks[0]; i++) {
        panel_key(window, asks[i][0], asks[i][1]);
    }
}

/* Of what stands below the large picture. */
static float known_height(const struct window *window)
{
    const struct start *start = &window->start;
    const size_t offers = start->recent.count + (start->found[0] || start->has_no_sample);
    const float guide = start->recent.count ? 0 : 6;
    return (2.3F * (float)offers + 4 + guide) * ui_line();
}

static void draw_lists(struct window *window, float height)
{
    float width = ui_room();
    float half = floorf((width - gap * window->screen.scale) / 2);
    if (width < least_wide * window->screen.scale) {
        draw_known(window);
        draw_catalogue(window, fmaxf(height / 2, 8 * ui_line()));
        ui_gap(ui_line() / 2);
        draw_guide(window);
        return;
    }
    ui_column("known", half, height);
    draw_brain(window, height - known_height(window));
    draw_known(window);
    draw_guide(window);
    ui_scroll_end();
    ui_same_line_at(half + gap * window->screen.scale);
    ui_column("catalogue", half, height);
    draw_catalogue(window, ui_room_below());
    ui_scroll_end();
}

static void draw_keys(const struct window *window)
{
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
    draw_field(window);
    ui_gap(ui_line() / 2);
    draw_lists(window, fmaxf(ui_room_below() - 3.5F * ui_line(), 10 * ui_line()));
    ui_gap(ui_line() / 2);
    draw_keys(window);
    ui_scroll_end();
    ui_panel_end();
}
