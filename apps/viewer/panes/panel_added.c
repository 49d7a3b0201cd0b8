/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of additions to the atlas, and a line for one more. */
#include "conus/own.h"
#include "options/output.h"
#include "viewer/panes/panes.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* What the line takes, by kind. */
static const char *const files[ADDITION_COUNT] = {
    "a volume, in place of another one, or a surface", "a map of probabilities or of a statistic, or a mask",
    "a tractogram", "a list of contacts, optodes, coils or other points and poses, in place of another one",
    "an atlas, or the name of an installed one, in the same space: it gets the same questions"};

/* Lines and boxes for what may stand behind the file. */
static const struct {
    enum addition kind;
    const char *key, *label;
    const char *hint; /* NULL: a box */
    const char *tip;
} fields[] = {
    {ADD_PATHWAY, "name", "Name", "Arcuate", "what it is called; else as its file"},
    {ADD_PATHWAY, "threshold", "Threshold", "0.5", "voxels from this value on are of it, in the unit of its file"},
    {ADD_PATHWAY, "unit", "Unit", "z", "of its values"},
    {ADD_PATHWAY, "volume", "Volume", "0", "the one of a file that has several, from 0"},
    {ADD_STREAMLINES, "name", "Name", "Arcuate", "what the bundle is called; else as its file"},
    {ADD_STREAMLINES, "radius", "Radius", "0.5", "mm, of the tubes as which streamlines are hit"},
    {ADD_STREAMLINES, "space", "Space", "ras or lps", "of its coordinates, where the file does not say it"},
    {ADD_STREAMLINES, "moves", "It moves with the atlas", NULL, "by --atlas-transform; else it stays where it is"},
};

/* Draws a file's name and keys; the tip has the whole path. */
static void draw_file(struct window *window, size_t index, enum addition kind, const char *value)
{
    struct added_form *form = &window->forms.added;
    char plain[SYSTEM_PATH];
    char path[SYSTEM_PATH];
    if (!addition_path(path, kind, value)) {
        return;
    }
    snprintf(plain, sizeof plain, "%s", value + (path_name(path) - path));
    conus_plain_text(plain);
    ui_id((uint32_t)index);
    if (ui_small_button("Take out", "the atlas is opened again without it")) {
        window_change(window, index, kind, NULL);
    }
    ui_same_line();
    if (ui_small_button("Change", "its file or what stands behind it, in the line below")) {
        form->kind = kind;
        form->changed = index + 1;
        form->takes_keys = form->is_set = true;
        snprintf(form->text, sizeof form->text, "%s", value);
    }
    ui_id_end();
    ui_same_line();
    ui_text_coloured(THEME_HINT, "%s", addition_names[kind]);
    ui_same_line();
    ui_text("%s", plain);
    conus_plain_text(path);
    ui_tip(path);
}

/* Draws the fields of the kind, with what the line has. */
static void draw_fields(struct added_form *form)
{
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        const char *hint = fields[i].hint;
        char was[sizeof form->text];
        char is[sizeof form->text];
        if (fields[i].kind != form->kind) {
            continue;
        }
        bool is_on = addition_key(was, sizeof was, fields[i].kind, form->text, fields[i].key);
        memcpy(is, was, sizeof is);
        bool changed = hint ? ui_type(fields[i].label, is, sizeof is, hint, fields[i].tip)
                            : ui_check(fields[i].label, &is_on, fields[i].tip);
        if ((changed || strcmp(was, is) != 0) && !strchr(is, ',')) { /* a comma begins the next key */
            addition_put_key(form->text, sizeof form->text, fields[i].kind, fields[i].key,
                             (hint ? *is : is_on) ? is : NULL);
            form->is_set = true;
        }
    }
}

static void draw_files(struct window *window, const json_t *words)
{
    size_t count = 0;
    ui_scroll("files", fmaxf(ui_room_below() - 13 * ui_line(), 3 * ui_line()));
    for (size_t i = 0; i < json_array_size(words) && !window_has_request(window); i++) {
        const char *value;
        enum addition kind = addition_of(&value, json_string_value(json_array_get(words, i)));
        if (kind < ADDITION_COUNT) {
            draw_file(window, i, kind, value);
            count++;
        }
    }
    if (!count) {
        ui_text_coloured(THEME_HINT, "Nothing was added by an option or by hand.");
    }
    ui_scroll_end();
}

static void draw_line(struct window *window, const json_t *words)
{
    struct added_form *form = &window->forms.added;
    ui_choose("Kind", &form->kind, addition_names, ADDITION_COUNT, "what the file is to be");
    ui_take_keys(&form->takes_keys);
    ui_width(ui_room());
    bool entered = ui_type_path("##file", form->text, sizeof form->text, "", "", SIZE_MAX, &form->is_set);
    ui_text_wrapped(THEME_HINT, files[form->kind]);
    draw_fields(form);
    bool used = ui_button(form->changed ? "Use instead" : "Add",
                          "the atlas is opened again, and all that you set stays; Enter, too") ||
                entered;
    if (used && form->text[0]) {
        size_t index = form->changed && form->changed <= json_array_size(words) ? form->changed - 1 : SIZE_MAX;
        window_change(window, index, (enum addition)form->kind, form->text);
    }
    ui_same_line();
    if (form->changed && ui_button("no, add another", NULL)) {
        *form = (struct added_form){.open = true, .kind = form->kind, .is_set = true};
    }
    ui_same_line();
    if (ui_button("Close", NULL)) {
        form->open = false;
    }
    ui_text_wrapped(THEME_PLAIN, window->viewer->message);
}

void panel_added(struct window *window)
{
    const json_t *words = json_object_get(window->files.opened, "options");
    window_panel(window, "Files that were added (Ctrl+L; Escape closes this)", 620, 400);
    draw_files(window, words);
    ui_separator();
    draw_line(window, words);
    ui_panel_end();
}
