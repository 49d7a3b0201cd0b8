/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of areas and pathways, with search and check boxes; hemispheres and sides. */
#include "base/look.h"
#include "conus/own.h"
#include "options/messages.h"
#include "viewer/model/viewer.h"
#include "viewer/panes/panes.h"
#include "viewer/ui/ui.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The next widget gets the panel's width, or what is left of the line. */
static void use_width(const struct window *window)
{
    ui_width(fminf(window->screen.left.width - 20, ui_room()));
}

static void choose_hemispheres(struct window *window)
{
    size_t how = (size_t)window->files.hemispheres;
    use_width(window);
    if (ui_choose(
            "##hemispheres", &how, hemispheres_meanings, HEMISPHERES_COUNT,
            "hemispheres: areas as the file has them; those that lie on both sides cut in two at the midline; or left "
            "and\n"
            "right ones of one name reported as one (--hemispheres). The atlas is opened again for it; F8: the next")) {
        window_request_hemispheres(window, (conus_hemispheres)how);
    }
}

static void choose_side(struct window *window)
{
    static const char *const sides[SIDE_COUNT] = {"both sides", "left only", "right only"};
    struct viewer *viewer = window->viewer;
    size_t side = side_shown(viewer);
    if (side_known(viewer) != SIDE_BOTH) {
        ui_text("%s", side_missing[side_known(viewer)]);
        ui_tip("areas are known to be left or right ones by the label table, by their names, or by a split");
        return;
    }
    use_width(window);
    if (ui_choose("##side", &side, sides, SIDE_COUNT,
                  "hides all areas of the other side, so that they are not hit either; those without a side stay.\n"
                  "F9: the next")) {
        side_show(viewer, (enum side)side);
    }
}

enum { TIP_SIZE = 96 };

/* Searches the whole list: atlases have hundreds of areas, and only open nodes are asked. */
static bool has_children(const struct viewer *viewer, uint32_t object)
{
    for (uint32_t number = 1; number <= viewer->drawn->object_count; number++) {
        if (conus_atlas_object(viewer->drawn->atlas, number)->parent == object) {
            return true;
        }
    }
    return false;
}

static void write_tip(char tip[TIP_SIZE], const conus_object *object)
{
    int used = snprintf(tip, TIP_SIZE, "label %u", object->label);
    if (object->volume_mm3 > 0) {
        snprintf(tip + used, TIP_SIZE - (size_t)used, ", %.0f mm\u00b3", object->volume_mm3);
    }
    if (object->kind == CONUS_KIND_BUNDLE) {
        snprintf(tip + used, TIP_SIZE - (size_t)used, ", %llu streamline%s, %.0f mm long together",
                 (unsigned long long)object->streamlines, object->streamlines == 1 ? "" : "s", object->length_mm);
    }
}

static void draw_area(struct window *window, uint32_t number)
{
    struct viewer *viewer = window->viewer;
    const conus_object *object = conus_atlas_object(viewer->drawn->atlas, number);
    enum shown shown = viewer_shown(viewer, number);
    char name[VIEW_ATLAS_TITLE + 16];
    char buffer[VIEW_ATLAS_TITLE];
    char tip[TIP_SIZE];
    ui_colour colour = panel_colour(viewer, number);
    const char *title = view_atlas_title(buffer, viewer->drawn, number);
    write_tip(tip, object);
    ui_id(number);
    ui_dim(shown == SHOWN_NOT ? theme_pale : shown == SHOWN_IN_PART ? (1 + theme_pale) / 2 : 1);
    colour.a = viewer->drawn->shown.hidden[number] ? 60 : 255;
    ui_chip(colour);
    ui_same_line();
    if (viewer->drawn->shown.chosen == number) {
        if (window->frame.listed != number) { /* it was chosen just now */
            window->frame.listed = number;
            ui_scroll_here();
        }
        snprintf(name, sizeof name, "%s%s", title, shown == SHOWN_IN_PART ? " (in part)" : "");
        ui_tint(THEME_ACCENT);
        float buttons = ui_text_width("Show") + ui_text_width("Only") + 32 * window->screen.scale; /* and a gap */
        ui_name_cut(name, ui_room() - buttons);
        ui_tint_end();
        ui_same_line();
        panel_hide(viewer, number, true);
        panel_look_area(viewer, number);
    } else if (ui_row_cut(title, false, tip)) {
        viewer_choose(viewer, number);
    }
    ui_dim_end();
    ui_id_end();
}

static void draw_tree(struct window *window, uint32_t parent)
{
    const struct viewer *viewer = window->viewer;
    for (uint32_t number = 1; number <= viewer->drawn->object_count; number++) {
        const conus_object *object = conus_atlas_object(viewer->drawn->atlas, number);
        if (object->parent != parent) {
            continue;
        }
        if (!has_children(viewer, number)) {
            draw_area(window, number);
            continue;
        }
        ui_id(number);
        bool leads = window->frame.listed != viewer->drawn->shown.chosen && viewer->drawn->shown.chosen != number &&
                     viewer_is_below(viewer, viewer->drawn->shown.chosen, number);
        bool open = ui_tree("##node", leads ? UI_OPEN_NOW : parent == 0 ? UI_OPEN_FIRST : UI_AS_IT_WAS);
        ui_id_end();
        ui_same_line();
        draw_area(window, number);
        if (open) {
            draw_tree(window, number);
            ui_tree_end();
        }
    }
}

/* Lists the areas that fit the search, the best first. */
static void draw_found(struct window *window)
{
    struct shown_objects *shown = &window->viewer->drawn->shown;
    size_t count;
    uint32_t *found = search_all(&count, window->viewer->drawn->atlas, shown->search);
    for (size_t i = 0; found && i < count; i++) {
        draw_area(window, found[i]);
    }
    free(found);
    if (!count) {
        ui_text("nothing fits");
        ui_same_line();
        if (ui_small_button("Clear", "lists all areas again")) {
            shown->search[0] = '\0';
        }
    }
}

/* Chooses which of several atlases is drawn. */
static void choose_atlas(struct window *window)
{
    struct viewer *viewer = window->viewer;
    size_t drawn = (size_t)(viewer->drawn - viewer->atlases);
    if (viewer->atlas_count > 1) {
        ui_width(ui_room());
        if (ui_choose("##atlas", &drawn, viewer->names, viewer->atlas_count,
                      "the atlas that is drawn and listed here; N: the next one")) {
            viewer_draw(viewer, drawn);
        }
    }
    if (window->frame.listed_of != viewer->drawn) {
        window->frame.listed_of = viewer->drawn;
        window->frame.listed = 0;
    }
}

void panel_hidden(struct window *window)
{
    struct viewer *viewer = window->viewer;
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        const struct view_atlas *view = &viewer->atlases[i];
        const size_t count = view_atlas_hidden(view);
        if (!count) {
            continue;
        }
        ui_text_coloured(THEME_ORANGE, "%zu area%s hidden%s%s", count, count == 1 ? "" : "s",
                         view->name[0] ? " in " : "", view->name);
        if (view == viewer->drawn) {
            ui_same_line();
            if (ui_small_button("Show all", "what is hidden is not hit and blocks nothing: the answer is another one "
                                            "with it; V, too")) {
                window_press(window, "v");
            }
        }
    }
}

/* Gives the tip about an atlas none of whose areas has a name; NULL of another one. */
static const char *find_unnamed(const conus_atlas *atlas)
{
    size_t areas = 0;
    for (size_t number = 1; number <= conus_atlas_object_count(atlas); number++) {
        const conus_object *object = conus_atlas_object(atlas, number);
        if (object->kind == CONUS_KIND_AREA && object->named) {
            return NULL;
        }
        areas += object->kind == CONUS_KIND_AREA;
    }
    return areas ? "no label table names them: give one by --labels, or lay it beside the atlas's file" : NULL;
}

static const struct warning {
    enum theme_text colour;
    const char *text;
    const char *(*find)(const conus_atlas *atlas); /* More about it; NULL where it does not hold. */
} warnings[] = {
    {THEME_ORANGE, "Names or places have left and right exchanged", conus_atlas_exchanged},
    {THEME_HINT, "Areas have numbers in place of names", find_unnamed},
};
enum { WARNINGS = sizeof warnings / sizeof *warnings };

/* Whether a line is about what the table above says in short. */
static bool is_said(const struct viewer *viewer, const char *line)
{
    bool is = false;
    for (size_t i = 0; i < viewer->atlas_count * WARNINGS && !is; i++) {
        const char *more = warnings[i % WARNINGS].find(viewer->atlases[i / WARNINGS].atlas);
        is = more && strstr(line, more);
    }
    return is;
}

bool panel_warning(struct panel_warning *out, size_t *index, const struct viewer *viewer)
{
    const size_t of_atlases = viewer->atlas_count * WARNINGS;
    const char *line;
    for (; *index < of_atlases; ++*index) {
        const struct view_atlas *view = &viewer->atlases[*index / WARNINGS];
        const struct warning *warning = &warnings[*index % WARNINGS];
        *out = (struct panel_warning){.colour = warning->colour, .more = warning->find(view->atlas)};
        if (out->more) {
            snprintf(out->text, sizeof out->text, "%s%s%s", warning->text, view->name[0] ? " in " : "", view->name);
            ++*index;
            return true;
        }
    }
    size_t warnings_said = 0;
    size_t notes_said = 0;
    char drawn[PAINTER_TEXT];
    while (warning_line(warnings_said)) {
        warnings_said++;
    }
    while (note_line(notes_said)) {
        notes_said++;
    }
    for (size_t i;
         (i = *index - of_atlases, line = i < warnings_said ? warning_line(i) : note_line(i - warnings_said));) {
        ++*index;
        if (!is_said(viewer, line)) {
            *out = (struct panel_warning){.colour = i < warnings_said ? THEME_ORANGE : THEME_HINT};
            snprintf(out->text, sizeof out->text, "%s: %s", i < warnings_said ? "Warning" : "Note", line);
            return true;
        }
    }
    bool is_last = *index == of_atlases + warnings_said + notes_said && viewer->painter &&
                   painter_text(drawn, viewer->painter, PAINTER_NOTE);
    if (is_last) {
        ++*index;
        *out = (struct panel_warning){.colour = THEME_HINT};
        snprintf(out->text, sizeof out->text, "Note of the 3-D picture: %s", drawn);
    }
    return is_last;
}

void panel_warnings(const struct viewer *viewer)
{
    struct panel_warning warning;
    for (size_t i = 0; panel_warning(&warning, &i, viewer);) {
        ui_text_wrapped(warning.colour, warning.text);
        if (warning.more) {
            ui_tip(warning.more);
        }
    }
}

/* For users who do not know the keys yet; strokes are those of ui_icon(). */
static const struct icon {
    const char *id, *strokes, *key, *tip;
    int step; /* among the changes, which may be the last one there is */
} icons[] = {
    {"##point", "nimllminfmeldieffeidlemfni iaid iniq aidi niqi hiji", NULL,
     "Point: a click holds the cone, and does not measure any more (Ctrl+M)", 0},
    {"##measure", "bipi efbiel mfpiml", NULL, "Measure: two clicks give a distance, in 3-D or in a cut (Ctrl+M)", 0},
    {"##search", "mhlkklhmeldkchdeedhckdlemh llpp", "/", "Search: an area by its name or label (/)", 0},
    {"##list", "feoe fioi fmom cede cidi cmdm", NULL, "Areas: opens or folds the list: search, hide, hemispheres (F6)",
     0},
    {"##open", "bnbdgdifpfpnbn", "ctrl+o",
     "Open: an atlas or a session; streamlines, a context, points or poses on it (Ctrl+O)", 0},
    {"##save", "icik ehilmh clcooool", "ctrl+s", "Save: the session (Ctrl+S)", 0},
    {"##undo", "gddggj dgkgninlkngn", "ctrl+z", "Undo: takes back the last change (Ctrl+Z)", -1},
    {"##redo", "kdngkj ngggdidlgnkn", "ctrl+y", "Redo: does it again (Ctrl+Y)", 1},
    {"##keys", "ffgdickdlfkhijil inio", "?", "Help: all keys, and what the mouse does (? or F1)", 0}};

enum { ICON_POINT = 0, ICON_MEASURE, ICON_SEARCH, ICON_LIST, ICONS = sizeof icons / sizeof icons[0] };

static bool is_marked(const struct window *window, size_t icon)
{
    bool measures = window->viewer->measure.on;
    return icon == ICON_POINT     ? !measures
           : icon == ICON_MEASURE ? measures
                                  : icon == ICON_LIST && !window->screen.folded[0];
}

/* Draws them below each other: the list that one of them opens stands beside them, and none moves. */
static void draw_icons(struct window *window)
{
    const float wide = fminf(36 * window->screen.scale, ui_room());
    const float high = 30 * window->screen.scale;
    for (size_t i = 0; i < ICONS; i++) {
        const struct icon *icon = &icons[i];
        bool marked = is_marked(window, i);
        if (i == ICON_LIST + 1) {
            ui_separator();
        }
        ui_disable(icon->step && !changes_reach(&window->history.changes, icon->step));
        bool pressed = ui_icon(icon->id, icon->strokes, wide, high, marked, icon->tip);
        ui_disable_end();
        if (pressed && i == ICON_LIST) {
            layout_fold(&window->screen.layout, 0, marked);
        } else if (pressed && icon->key) {
            window_press(window, icon->key);
        } else if (pressed && !marked) { /* one of the two that clicks are for */
            window_press(window, "ctrl+m");
        }
    }
}

void panel_rail(struct window *window, size_t side)
{
    struct ui_box box = side ? window->screen.right : window->screen.left;
    box.width = fminf(box.width, floorf(LAYOUT_RAIL * window->screen.scale));
    ui_panel(side ? "##hits" : "##areas", box, UI_UNTITLED | UI_NARROW);
    if (side == 0) {
        draw_icons(window);
    } else if (ui_button("Hits", "opens the hits of the cone and the settings (F6)")) {
        layout_fold(&window->screen.layout, 1, false);
    }
    ui_panel_end();
}

void panel_areas(struct window *window)
{
    struct viewer *viewer = window->viewer;
    struct ui_box box = window->screen.left;
    panel_rail(window, 0);
    if (window->screen.folded[0]) {
        return;
    }
    box.x += floorf(LAYOUT_RAIL * window->screen.scale);
    box.width -= box.x;
    ui_panel("Areas", box, 0);
    choose_atlas(window);
    ui_id((uint32_t)(viewer->drawn - viewer->atlases)); /* each has a list of its own, scrolled and opened */
    ui_width(ui_room());
    panel_search(
        viewer, "##search", "search name or label",
        "whole names come first, then names and words that begin so, names with it inside, and label numbers;\n"
        "Enter chooses the first");
    panel_key_button(window, "Show all", "v", "no area is hidden any more; V, too");
    ui_same_line();
    ui_text("%zu in all", viewer->drawn->object_count);
    ui_flow("Files");
    panel_key_button(window, "Files", "ctrl+l",
                     "streamlines, pathways and context: add one, change it, take it out; Ctrl+L, too");
    ui_text_coloured(THEME_HINT, "left and right");
    choose_hemispheres(window);
    choose_side(window);
    ui_separator();
    ui_scroll("list", 0);
    if (viewer->drawn->shown.search[0]) {
        draw_found(window);
    } else {
        draw_tree(window, 0);
    }
    ui_scroll_end();
    ui_id_end();
    ui_panel_end();
}
