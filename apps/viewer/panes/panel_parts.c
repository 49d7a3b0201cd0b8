/* SPDX-License-Identifier: BSD-3-Clause */
/* Widgets that several panels have. */
#include "options/output.h"
#include "viewer/panes/panes.h"
#include "viewer/ui/ui.h"

#include <math.h>
#include <stdio.h>

static const float page_width = 980, key_width = 80; /* pixels at scale 1 */

void panel_property(struct window *window, enum property_id id)
{
    const struct property *property = &properties[id];
    const char *const *choices = property->choices ? property->choices : property->names;
    const double *range = property->slider[1] > 0 ? property->slider : (const double[]){property->low, property->high};
    double value = property_value(window, id);
    size_t index = (size_t)(value - property->low);
    bool is_on = value > 0;
    bool changed;
    char tip[KEYS_TIP];
    keys_tip(tip, id);
    if (choices) {
        changed = ui_choose(property->label, &index, choices, (size_t)(property->high - property->low) + 1, tip);
        value = property->low + (double)index;
    } else if (property->type == PROPERTY_TRUTH) {
        changed = ui_check(property->label, &is_on, tip);
        value = is_on;
    } else if (property->type == PROPERTY_WHOLE) {
        uint32_t count = (uint32_t)value;
        changed = ui_count(property->label, &count, (uint32_t)range[0], (uint32_t)range[1], tip);
        value = count;
    } else {
        changed =
            ui_slider(property->label, &value, range[0], range[1], property->format, property->is_logarithmic, tip);
    }
    if (changed) {
        property_set(window, id, value);
    }
}

void panel_speed(struct window *window, enum pointer pointer)
{
    if (pointer >= POINT_BY_SPACEMOUSE) {
        panel_property(window, PROPERTY_SPEED);
    }
}

void panel_key_button(struct window *window, const char *label, const char *key, const char *tip)
{
    if (ui_button(label, tip)) {
        window_press(window, key);
    }
}

void panel_hide(struct viewer *viewer, uint32_t object, bool small)
{
    bool (*button)(const char *label, const char *tip) = small ? ui_small_button : ui_button;
    bool hide = viewer_shown(viewer, object) == SHOWN;
    if (button(hide ? "Hide" : "Show", "hidden areas are not hit, not drawn, and block nothing; H, too")) {
        viewer_hide(viewer, object, hide);
    }
    if (small) {
        ui_same_line();
    } else {
        ui_flow("Only");
    }
    if (button("Only", "hides all others; I, too, and Ctrl+Z takes it back")) {
        viewer_isolate(viewer, object);
    }
}

void panel_search(struct viewer *viewer, const char *label, const char *hint, const char *tip)
{
    char *search = viewer->drawn->shown.search;
    bool entered = ui_type(label, search, sizeof viewer->drawn->shown.search, hint, tip) && search[0];
    uint32_t best = entered ? search_best(viewer->drawn->atlas, search) : 0;
    if (best) {
        viewer_choose(viewer, best);
    } else if (entered) {
        viewer_say(viewer, "nothing is called \"%s\"", search);
    }
}

ui_colour panel_colour(const struct viewer *viewer, uint32_t object)
{
    uint8_t rgb[3];
    viewer_colour(rgb, viewer, object);
    return (ui_colour){rgb[0], rgb[1], rgb[2], 255};
}

void panel_widths(float *out, const struct window *window, const char *const *headings, const char *const *widest,
                  size_t count)
{
    out[0] = PANEL_NAME * window->screen.scale;
    for (size_t i = 1; i < count; i++) {
        out[i] = fmaxf(ui_text_width(widest[i]), ui_text_width(headings[i]));
    }
}

void panel_number(const char *format, double value)
{
    char text[32] = "-";
    if (isfinite(value)) {
        snprintf(text, sizeof text, format, value);
    }
    ui_text_right(text);
}

bool panel_row(const struct window *window, size_t index, bool marked, const char *tip, float height)
{
    ui_id((uint32_t)index);
    bool chosen = ui_row("##row", marked, height);
    ui_id_end();
    if (tip) {
        ui_tip(tip);
    }
    ui_same_line_at(4 * window->screen.scale);
    return chosen;
}

void panel_path(const char *path)
{
    const char *name = path_name(path);
    ui_text("%s", name);
    if (name > path) {
        ui_same_line();
        ui_text_coloured(THEME_HINT, "%.*s", (int)(name - path), path);
    }
}

void panel_key(const struct window *window, const char *key, const char *meaning)
{
    ui_text_coloured(THEME_ACCENT, "%s", key);
    ui_same_line_at(key_width * window->screen.scale);
    ui_text_coloured(THEME_HINT, "%s", meaning);
}

float panel_page(const struct window *window, const char *title)
{
    float margin = 16 * window->screen.scale;
    float width = fmaxf(fminf(page_width * window->screen.scale, (float)window->screen.width - 2 * margin), 1);
    ui_panel(title,
             (struct ui_box){floorf(((float)window->screen.width - width) / 2), 0, width, (float)window->screen.height},
             UI_PLAIN);
    return width;
}
