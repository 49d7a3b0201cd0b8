/* SPDX-License-Identifier: BSD-3-Clause */
/* The start page: what conus is, and the ways to open an atlas. */
#include "viewer/panels/panels.h"

#include <math.h>

static const float page_width = 640, number_width = 26, key_width = 80;

/* ---- Its parts, from above --------------------------------------------------------------------------------------- */

static void draw_title(void)
{
    ui_heading("conus");
    ui_text_wrapped("Which areas of the brain does this beam, probe or pointing hand reach?");
    ui_gap(ui_line());
}

static void draw_field(struct window *window)
{
    static const char open[] = "Open";
    struct start *start = &window->start;
    float button = ui_text_width(open) + 14 * window->scale; /* with what is around its text and before it */
    ui_text_wrapped("Drop an atlas on this window, a file or a folder, or give its path:");
    ui_width(ui_room() - button);
    if (start->takes_keys) {
        ui_take_keys();
        start->takes_keys = false;
    }
    ui_type("##path", start->typed, sizeof start->typed, "~/atlases/aal.nii.gz");
    bool asked = ui_entered();
    ui_same_line();
    asked = ui_button(open) || asked;
    ui_tint(theme_texts[start->why[0] ? THEME_ORANGE : THEME_HINT]);
    ui_text_wrapped(start->why[0] ? start->why : "NIfTI and MGH volumes, surfaces, folders of surfaces, manifests");
    ui_tint_end();
    if (asked) {
        window_want_typed(window);
    }
}

/* Its number is a key; the folder is cut where the page ends, and in the tip it is whole. */
static void draw_entry(struct window *window, size_t index)
{
    char words[PATH_MAX];
    const char *name = start_words(words, &window->start, index);
    ui_id((uint32_t)index);
    bool chosen = ui_row("##entry", false);
    ui_id_end();
    ui_tip(words);
    ui_same_line_at(4 * window->scale);
    ui_text_coloured(theme_texts[THEME_AMBER], "%zu", index + 1);
    ui_same_line_at(number_width * window->scale);
    ui_text("%s", name);
    if (name > words) {
        ui_same_line();
        ui_text_coloured(theme_texts[THEME_HINT], "%.*s", (int)(name - words), words);
    }
    if (chosen) {
        window_want(window, start_path(&window->start, index));
    }
}

static void draw_list(struct window *window, const char *title, size_t first, size_t end)
{
    if (first == end) {
        return;
    }
    ui_gap(ui_line() / 2);
    ui_text_coloured(theme_texts[THEME_HINT], "%s", title);
    ui_separator();
    for (size_t i = first; i < end; i++) {
        draw_entry(window, i);
    }
}

static void draw_key(const struct window *window, const char *key, const char *meaning)
{
    ui_text_coloured(theme_texts[THEME_AMBER], "%s", key);
    ui_same_line_at(key_width * window->scale);
    ui_text_coloured(theme_texts[THEME_HINT], "%s", meaning);
}

static void draw_keys(const struct window *window)
{
    ui_gap(ui_line());
    if (start_path(&window->start, 0)) {
        draw_key(window, "1, 2 ...", "open one of these");
    }
    draw_key(window, "Tab", "type a path; Enter opens it");
    if (window->viewer) {
        draw_key(window, "Escape", "back to the atlas that is open");
    }
    draw_key(window, "?", "keys and mouse where an atlas is open");
}

void panel_start(struct window *window)
{
    const struct start *start = &window->start;
    float margin = 16 * window->scale;
    float width = fmaxf(fminf(page_width * window->scale, (float)window->width - 2 * margin), 1);
    float height = (float)window->height;
    size_t recent = start->recent.count;
    ui_panel("start", (struct ui_box){floorf(((float)window->width - width) / 2), 0, width, height}, UI_PLAIN);
    ui_scroll("page", 0);
    ui_gap(fmaxf(0.12F * height - margin, 0));
    draw_title();
    draw_field(window);
    draw_list(window, "Opened before", 0, recent);
    draw_list(window, "On this computer", recent, recent + (start->found[0] != '\0'));
    draw_keys(window);
    ui_scroll_end();
    ui_panel_end();
}
