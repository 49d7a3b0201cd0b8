/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of keys, what each does, and the page that lists them. */
#include "viewer/commands/commands.h"

#include "base/text.h"
#include "viewer/model/viewer.h"
#include "viewer/session/session.h"
#include "viewer/tools/tools.h"
#include "viewer/ui/ui.h"
#include "viewer/window/window.h"

#include <GLFW/glfw3.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static void toggle_help(struct window *window)
{
    window->forms.show_help = !window->forms.show_help;
}

/* Hides or shows the chosen area, or hides all others. */
static void hide_chosen(struct window *window, const int by[3])
{
    const struct shown_objects *shown = &window->viewer->drawn->shown;
    if (shown->chosen && by[0]) {
        viewer_isolate(window->viewer, shown->chosen);
    } else if (shown->chosen) {
        viewer_hide(window->viewer, shown->chosen, !shown->hidden[shown->chosen]);
    }
}

static void hold(struct window *window, const int by[3])
{
    if (window->viewer->tools[by[0]].on) {
        tool_hold(window->viewer, (enum tool_number)by[0]);
    }
}

/* Ends what covers the brain first, then clears the cone. */
static void clear(struct window *window)
{
    if (window->forms.show_help) {
        window->forms.show_help = false;
    } else if (window->forms.figure.open) {
        window->forms.figure.open = false;
    } else if (window->forms.added.open) {
        window->forms.added.open = false;
    } else if (window->frame.navigated) {
        window->frame.navigated = 0;
        window->frame.navigates_anew = true;
    } else if (window->viewer->drawn->shown.search[0]) {
        window->viewer->drawn->shown.search[0] = '\0';
        window->viewer->version++;
    } else {
        if (window->viewer->chosen_point) { /* its depths go with it */
            points_choose(window->viewer, 0);
        }
        tool_clear(window->viewer);
        viewer_choose(window->viewer, 0);
        viewer_say(window->viewer, "cleared");
    }
}

/* Moves the keyboard from the areas to the hits, and back to the panes. */
static void go_to_panel(struct window *window)
{
    window->frame.navigated = (window->frame.navigated + 1) % 3;
    if (window->frame.navigated) {
        window->screen.bare = false;
        layout_fold(&window->screen.layout, (size_t)window->frame.navigated - 1, false);
    }
    window->frame.navigates_anew = true;
}

static void use_second(struct window *window)
{
    tool_use_second(window->viewer, !window->viewer->tools[SECOND_TOOL].on);
    viewer_say(window->viewer, "the second tool is %s", window->viewer->tools[SECOND_TOOL].on ? "on" : "off");
}

static void change_hemispheres(struct window *window)
{
    window_request_hemispheres(window, (conus_hemispheres)((window->files.hemispheres + 1) % HEMISPHERES_COUNT));
}

static void look_at_all(struct window *window)
{
    struct viewer *viewer = window->viewer;
    orbit_look_at(&viewer->orbit, viewer->centre, viewer->radius);
    viewer->version++;
}

static void toggle_head(struct window *window)
{
    struct viewer *viewer = window->viewer;
    bool is_there = head_toggle(&viewer->head);
    viewer_say(viewer, !is_there         ? "no head is tracked: start with --head"
                       : viewer->head.on ? "the head moves the view"
                                         : "the mouse moves the view");
}

static void draw_next(struct window *window)
{
    struct viewer *viewer = window->viewer;
    viewer_draw(viewer, (size_t)(viewer->drawn - viewer->atlases + 1) % viewer->atlas_count);
    viewer_say(viewer, "%s%s", viewer->atlas_count > 1 ? "drawn: " : "there is one atlas: start with --atlas for more",
               viewer->drawn->name);
}

static void quit(struct window *window)
{
    glfwSetWindowShouldClose(window->handle, GLFW_TRUE);
}

static void list_added(struct window *window)
{
    window->forms.figure.open = false;
    window->forms.added = (struct added_form){.open = !window->forms.added.open,
                                              .takes_keys = !window->forms.added.open,
                                              .kind = ADD_STREAMLINES,
                                              .is_set = true};
}

static void reset_layout(struct window *window)
{
    window->screen.layout = (struct layout){.panels = {0}};
}

static void fill_screen(struct window *window)
{
    window_fill_screen(window, !window->screen.alone);
}

static void enlarge(struct window *window)
{
    window->screen.enlarged = window->screen.enlarged < PANE_COUNT - 1 ? window->screen.enlarged + 1 : -1;
    window_lay_out(window);
}

static void widen(struct window *window, const int by[3])
{
    if (window->viewer->tools[by[0]].on) {
        tool_widen(window->viewer, (enum tool_number)by[0], by[1] > 0 ? 1.1 : 1 / 1.1);
    }
}

static void scale_speed(struct window *window, const int by[3])
{
    struct devices *devices = &window->inputs.devices;
    devices_set_speed(devices, devices_speed(devices) * (by[0] > 0 ? 1.25 : 0.8));
    window->viewer->version++;
    viewer_say(window->viewer, "a SpaceMouse or gamepad moves by %.0f mm and degrees a second at most",
               devices_speed(devices));
}

/* Moves the nearer or the farther depth limit, mm. */
static void move_range(struct window *window, const int by[3])
{
    query_move_range(window->viewer, by[0], by[1]);
}

static void press_save(struct window *window, const int by[3])
{
    save_file(window, (enum saved_file)by[0]);
}

static void copy_table(struct window *window, const int by[3])
{
    window_copy(window, (enum copied)by[0]);
}

static void show_dialog(struct window *window, const int by[3])
{
    window_show_dialog(window, (enum dialog_purpose)by[0]);
}

static void widen_first(struct window *window, const int by[3])
{
    layout_widen_first(&window->screen.layout, by[0]);
}

static void widen_panels(struct window *window, const int by[3])
{
    layout_widen_panels(&window->screen.layout, by[0], (float)window->screen.width, window->screen.scale);
}

static void say_grey(struct viewer *viewer)
{
    const double *grey = view_atlas_grey(viewer->drawn);
    viewer_say(viewer, "cuts: black %.6g, white %.6g", grey[0], grey[1]);
}

/* Changes grey values as the mouse does: right for more contrast, up for brighter. */
static void move_grey(struct window *window, const int by[3])
{
    static const double step = 0.05;
    if (viewer_move_grey(window->viewer, by[0] * step, by[1] * step)) {
        say_grey(window->viewer);
    } else {
        viewer_say(window->viewer, "there are no grey values: start with --context");
    }
}

static void reset_grey(struct window *window)
{
    viewer_set_grey(window->viewer, 0, 0);
    say_grey(window->viewer);
}

/* Changes the chosen area, or else all that the cone does not hit, which is never invisible. */
static void change_opacity(struct window *window, const int by[3])
{
    static const double step = 0.1;
    struct viewer *viewer = window->viewer;
    uint32_t chosen = viewer->drawn->shown.chosen;
    const conus_object *object = conus_atlas_object(viewer->drawn->atlas, chosen);
    if (object && object->kind == CONUS_KIND_BUNDLE) {
        viewer_say(viewer, "%s: streamlines are always opaque", object->name);
        return;
    }
    double now = viewer->drawn->appearance.opacity[chosen];
    double next = fmin(fmax((isnan(now) ? 1 : now) + by[0] * step, chosen ? 0 : step), 1);
    viewer_set_opacity(viewer, chosen, next);
    viewer_say(viewer, "%s: %.2f opaque", object ? object->name : "what the cone does not hit", next);
}

static void next_streamlines(struct window *window)
{
    struct viewer *viewer = window->viewer;
    const conus_atlas *atlas = viewer->drawn->atlas;
    size_t count = tract_colour_count(atlas);
    if (!count) {
        viewer_say(viewer, "there are no streamlines: start with --streamlines");
        return;
    }
    viewer_colour_streamlines(viewer, (viewer->drawn->appearance.streamlines + 1) % count);
    viewer_say(viewer, "streamlines by %s", tract_colour_name(atlas, viewer->drawn->appearance.streamlines));
}

static void confirm(struct window *window)
{
    inputs_confirm(&window->inputs, window->viewer, FIRST_TOOL);
}

static void next_backdrop(struct window *window)
{
    property_next(window, PROPERTY_BACKGROUND);
    viewer_say(window->viewer, "background: %s", backdrop_names[window->viewer->display.backdrop]);
}

static bool is_turned_by_head(struct viewer *viewer)
{
    if (viewer->head.on) {
        viewer_say(viewer, "the head moves the view; T gives it to the mouse");
    }
    return viewer->head.on;
}

/* Degrees to the head's left, and up. */
static void look_from(struct window *window, const int by[3])
{
    if (!is_turned_by_head(window->viewer)) {
        orbit_look_from(&window->viewer->orbit, by[0] * M_PI / 180, by[1] * M_PI / 180);
        window->viewer->version++;
    }
}

static void turn(struct window *window, const int by[3])
{
    static const double step = 0.025; /* of a pane's height: 5 degrees */
    if (!is_turned_by_head(window->viewer)) {
        orbit_turn(&window->viewer->orbit, step * by[0], -step * by[1], 1);
        window->viewer->version++;
    }
}

/* Opens the panel of hits, whose search is in sight, and lets it be typed. */
static void go_to_search(struct window *window)
{
    if (window->forms.show_help) {
        window->forms.searches_help = true;
        return;
    }
    window->screen.bare = false;
    layout_fold(&window->screen.layout, 1, false);
    window->frame.searches = true;
}

static void come_nearer(struct window *window, const int by[3])
{
    orbit_zoom(&window->viewer->orbit, by[0]);
    window->viewer->version++;
}

/* Moves the crosshair by 1 mm; right is right in the cuts. */
static void cross(struct window *window, const int by[3])
{
    struct viewer *viewer = window->viewer;
    double side = viewer->display.radiological ? -1 : 1;
    const double at[3] = {viewer->crosshair[0] + side * by[0], viewer->crosshair[1] + by[1],
                          viewer->crosshair[2] + by[2]};
    viewer_cross(viewer, at);
}

static void magnify(struct window *window, const int by[3])
{
    struct viewer *viewer = window->viewer;
    viewer->magnification = fmin(fmax(viewer->magnification * pow(1.1, by[0]), 0.2), 50);
    viewer->version++;
}

/* Moves the tool that is a wand by 1 mm along an axis of its own, or from 3 on turns it about one by 2 degrees. */
static void steer(struct window *window, const int by[3])
{
    double steps[6] = {0};
    steps[by[0]] = by[1] * (by[0] < 3 ? 1 : 0.035);
    inputs_steer(window->viewer, tool_moved_by(window->viewer, POINT_BY_WAND), steps, steps + 3);
}

/* From the row where the tool is; from elsewhere to the first, or the last. */
static void go_in_plan(struct window *window, const int by[3])
{
    const char *why;
    const struct plan_list *list = plans_list(window->viewer, &why);
    size_t count = list && list->count ? list->count : 1;
    size_t at = plans_at(window->viewer);
    plans_go(window->viewer, at == SIZE_MAX ? (by[0] > 0 ? 0 : count - 1) : (at + count + (size_t)by[0]) % count);
}

/* In the order of the page that lists them. A key of the wand comes before one of the views. */
static const struct key keys[] = {
    {"?", "this list; F1, too", .act = toggle_help, .is_anywhere = true, .group = "Window"},
    {"f1", NULL, .act = toggle_help, .is_anywhere = true},
    {"enter", "keep the answer", .act = confirm, .group = "Pointing"},
    {"space", "hold the cone, or let it follow the mouse again, as a click does", .move = hold, .by = {FIRST_TOOL}},
    {"escape", "end the search; clear the cone, and choose no area", .act = clear},
    {"1", "one area, by a single ray, or all areas in the cone", .sets = PROPERTY_ONE_RAY},
    {"x", "the mouse's cone begins at the surface, before it, or at your eye", .sets = PROPERTY_START},
    {"g", "the cuts go along with the cone's tip, with the contact of its best hit, or stay", .sets = PROPERTY_FOLLOW},
    {"+", "a wider cone", .move = widen, .by = {FIRST_TOOL, 1}, .sets = PROPERTY_ANGLE},
    {"-", "a narrower cone", .move = widen, .by = {FIRST_TOOL, -1}, .sets = PROPERTY_ANGLE},
    {"l", "first hits, or all hits", .sets = PROPERTY_LAYERS, .group = "What is asked"},
    {"m", "what moves the cone: the next of mouse, wand \u2026", .tool = tool_choose_next},
    {"2", "the second tool, with a cone and a list of its own, or none", .act = use_second,
     .group = "Second tool and devices"},
    {"3", "what moves the second tool: the next", .tool = tool_choose_next, .by = {SECOND_TOOL}},
    {"4", "hold the second tool, or let it go", .move = hold, .by = {SECOND_TOOL}},
    {"6", "a wider second cone", .move = widen, .by = {SECOND_TOOL, 1}, .sets = PROPERTY_SECOND_ANGLE},
    {"5", "a narrower one", .move = widen, .by = {SECOND_TOOL, -1}, .sets = PROPERTY_SECOND_ANGLE},
    {"8", "a SpaceMouse or gamepad moves faster", .move = scale_speed, .by = {1}, .sets = PROPERTY_SPEED},
    {"7", "slower", .move = scale_speed, .by = {-1}, .sets = PROPERTY_SPEED},
    {"f7", "areas as parts of larger ones: the next level of the tree, after the last one each by itself",
     .view = query_next_level, .group = "Areas and lists"},
    {"f8", "areas as in the file, split left and right, or left and right as one", .act = change_hemispheres},
    {"f9", "both sides, the left one only, the right one only: the other side's areas are hidden",
     .view = side_show_next},
    {"y", "the list by rank, or the nearest first", .sets = PROPERTY_ORDER},
    {"f4", "depth limits: the farther one 1 mm nearer; at first 0 to 50 mm", .move = move_range, .by = {0, -1},
     .group = "Depths, studies and plans"},
    {"f5", "the farther one 1 mm deeper", .move = move_range, .by = {0, 1}},
    {"f2", "the nearer one 1 mm nearer", .move = move_range, .by = {-1, 0}},
    {"f3", "the nearer one 1 mm deeper", .move = move_range, .by = {1, 0}},
    {"j", "a study of the cone: sweep over its angle, jitter of its pose, or none", .sets = PROPERTY_STUDY},
    {"ctrl+j", "save the study's table", .move = press_save, .by = {SAVE_STUDY}},
    {";", "the next pose of the plan; : the one before", .move = go_in_plan, .by = {1}},
    {":", NULL, .move = go_in_plan, .by = {-1}},
    {"f", "the brain alone in the whole window, or panels and cuts again", .sets = PROPERTY_BARE, .group = "Views"},
    {"ctrl+1",
     "look at the left side; Ctrl+2 the right, Ctrl+3 the front, Ctrl+4 the back, Ctrl+5 from above, Ctrl+6 "
     "from below",
     .move = look_from, .by = {90, 0}},
    {"ctrl+2", NULL, .move = look_from, .by = {-90, 0}},
    {"ctrl+3", NULL, .move = look_from, .by = {0, 0}},
    {"ctrl+4", NULL, .move = look_from, .by = {180, 0}},
    {"ctrl+5", NULL, .move = look_from, .by = {180, 90}},
    {"ctrl+6", NULL, .move = look_from, .by = {0, -90}},
    {"ctrl+m", "measure: two clicks, in 3-D or in a cut, give a distance; or no more", .sets = PROPERTY_MEASURES},
    {"/", "search an area", .act = go_to_search},
    {"ctrl+r", "neurological or radiological", .sets = PROPERTY_RADIOLOGICAL},
    {"t", "the view of a tracked head, or the one that the mouse turns", .act = toggle_head},
    {"n", "draw the next of several atlases", .act = draw_next, .ends_column = true},
    {"h", "hide or show the chosen area", .move = hide_chosen, .group = "Hide, undo"},
    {"i", "show the chosen area only", .move = hide_chosen, .by = {1}},
    {"ctrl+z", "take back the last change; U, too", .step = undo_step, .by = {-1}},
    {"u", NULL, .step = undo_step, .by = {-1}},
    {"ctrl+y", "do again what was taken back; Ctrl+Shift+Z, too", .step = undo_step, .by = {1}},
    {"ctrl+shift+z", NULL, .step = undo_step, .by = {1}},
    {"v", "show all areas", .view = viewer_show_all},
    {"r", "look at the whole brain", .act = look_at_all},
    {"c", "colours for any colour vision, or the atlas's own", .sets = PROPERTY_SAFE_COLOURS, .group = "How it looks"},
    {"]", "brighter cuts; [ darker, } more contrast, { less: grey values of the context", .move = move_grey,
     .by = {0, 1}},
    {"[", NULL, .move = move_grey, .by = {0, -1}},
    {"}", NULL, .move = move_grey, .by = {2, 0}},
    {"{", NULL, .move = move_grey, .by = {-2, 0}},
    {"b", "their black and white as they were found", .act = reset_grey},
    {".", "the chosen area more opaque in 3-D, or else what the cone does not hit; , less", .move = change_opacity,
     .by = {1}},
    {",", NULL, .move = change_opacity, .by = {-1}},
    {"k", "another background of 3-D: the theme's, light, white, black, transparent in figures", .act = next_backdrop,
     .sets = PROPERTY_BACKGROUND},
    {"9", "streamlines by their bundle, by direction, or by the next number of their file", .act = next_streamlines},
    {"ctrl+s", "save the session where it was opened or saved last", .move = press_save, .by = {SAVE_SAME_SESSION},
     .group = "Files"},
    {"ctrl+shift+s", "save the session under another name", .move = show_dialog, .by = {DIALOG_SAVE}},
    {"o", "save a copy of the session, under a name by the time", .move = press_save, .by = {SAVE_SESSION}},
    {"p", "save what the window shows, as a picture", .move = press_save, .by = {SAVE_PICTURE}},
    {"ctrl+c", "copy the hits of the cone as a table", .move = copy_table, .by = {COPY_RESULTS}},
    {"ctrl+shift+c", "copy what was kept", .move = copy_table, .by = {COPY_PINS}},
    {"ctrl+e", "export the hits of the cone", .move = press_save, .by = {SAVE_RESULTS}},
    {"ctrl+p", "save 3-D or a cut as a figure: its size, dpi, background, legend and name", .act = figure_form_open},
    {"ctrl+shift+p", "copy the path of the figure that was saved last", .act = figure_form_copy},
    {"ctrl+o", "open a file: an atlas or a session; or add one: streamlines or an image as context",
     .move = show_dialog, .by = {DIALOG_OPEN}, .is_anywhere = true},
    {"ctrl+l", "what was added: streamlines, pathways, context; add, change or take out", .act = list_added},
    {"ctrl+n", "the start page, for another atlas; Escape comes back", .act = window_go_to_start},
    {"ctrl+q", "close the window", .act = quit, .is_anywhere = true},
    {"f6", "keys go to the areas, the hits, back: arrows and Tab move, Space presses or enters, Escape leaves",
     .act = go_to_panel, .group = "Keyboard and panes"},
    {"tab", "one pane after the other fills the window", .act = enlarge},
    {"z", "the pane under the mouse alone, or all again; also a double click in a cut", .act = window_maximise},
    {")", "a larger 3-D pane; borders can be dragged, too", .move = widen_first, .by = {1}},
    {"(", "a smaller 3-D pane", .move = widen_first, .by = {-1}},
    {">", "wider panels", .move = widen_panels, .by = {1}},
    {"<", "narrower panels", .move = widen_panels, .by = {-1}},
    {"\\", "panes and panels as at first", .act = reset_layout},
    {"f11", "3-D alone, over the whole screen, and back", .act = fill_screen},
    {"ctrl++", "larger texts and panels", .step = window_zoom, .by = {1}, .is_anywhere = true},
    {"ctrl+-", "smaller ones", .step = window_zoom, .by = {-1}, .is_anywhere = true},
    {"ctrl+0", "as large as the screen asks for", .step = window_zoom, .by = {0}, .is_anywhere = true},
    {"up", NULL, .move = steer, .by = {3, 1}, .is_of_wand = true},
    {"down", NULL, .move = steer, .by = {3, -1}, .is_of_wand = true},
    {"left", NULL, .move = steer, .by = {4, 1}, .is_of_wand = true},
    {"right", NULL, .move = steer, .by = {4, -1}, .is_of_wand = true},
    {"left", "turn the 3-D view by 5\u00b0; the wand, where that points", .move = turn, .by = {-1, 0},
     .shown = "Arrows", .group = "Arrows and the wand"},
    {"right", NULL, .move = turn, .by = {1, 0}},
    {"up", NULL, .move = turn, .by = {0, 1}},
    {"down", NULL, .move = turn, .by = {0, -1}},
    {"pageup", "come nearer in 3-D, or go away", .move = come_nearer, .by = {1}, .shown = "Page Up, Down"},
    {"pagedown", NULL, .move = come_nearer, .by = {-1}},
    {"shift+left", "the crosshair: 1 mm to the side, to the front or back", .move = cross, .by = {-1, 0, 0},
     .shown = "Shift+arrows"},
    {"shift+right", NULL, .move = cross, .by = {1, 0, 0}},
    {"shift+up", NULL, .move = cross, .by = {0, 1, 0}},
    {"shift+down", NULL, .move = cross, .by = {0, -1, 0}},
    {"shift+pageup", "the crosshair: 1 mm up, down", .move = cross, .by = {0, 0, 1}, .shown = "Shift+Page \u2026"},
    {"shift+pagedown", NULL, .move = cross, .by = {0, 0, -1}},
    {"ctrl+pageup", "magnify the cuts, or less", .move = magnify, .by = {1}, .shown = "Ctrl+Page \u2026"},
    {"ctrl+pagedown", NULL, .move = magnify, .by = {-1}},
    {"w", "the wand: forward, back, left, right", .move = steer, .by = {2, -1}, .shown = "W S A D", .is_of_wand = true},
    {"s", NULL, .move = steer, .by = {2, 1}, .is_of_wand = true},
    {"a", NULL, .move = steer, .by = {0, -1}, .is_of_wand = true},
    {"d", NULL, .move = steer, .by = {0, 1}, .is_of_wand = true},
    {"e", "the wand: up, down", .move = steer, .by = {1, 1}, .shown = "E Q", .is_of_wand = true},
    {"q", NULL, .move = steer, .by = {1, -1}, .is_of_wand = true},
};
enum { KEYS = sizeof keys / sizeof keys[0] };

const struct key *keys_row(size_t index)
{
    return index < KEYS ? &keys[index] : NULL;
}

const char *keys_shown(char out[KEY_LIMIT], const struct key *key)
{
    if (key->shown) {
        return key->shown;
    }
    bool first = true; /* "ctrl+o" is Ctrl+O */
    size_t used = 0;
    for (; key->key[used] && used + 1 < KEY_LIMIT; used++) {
        bool is_small = key->key[used] >= 'a' && key->key[used] <= 'z';
        out[used] = (char)(key->key[used] + (first && is_small ? 'A' - 'a' : 0));
        first = key->key[used] == '+';
    }
    out[used] = '\0';
    return out;
}

const char *keys_tip(char out[KEYS_TIP], enum property_id id)
{
    const struct property *property = &properties[id];
    char name[KEY_LIMIT];
    size_t count = 0;
    int used = snprintf(out, KEYS_TIP, "%s", property->tip ? property->tip : property->help);
    for (size_t i = 0; i < KEYS && used < KEYS_TIP; i++) {
        if (keys[i].sets && keys[i].sets == id) {
            used += snprintf(out + used, KEYS_TIP - (size_t)used, "%s %s", count++ ? " and" : ";",
                             keys_shown(name, &keys[i]));
        }
    }
    if (count && used < KEYS_TIP) {
        snprintf(out + used, KEYS_TIP - (size_t)used, count > 1 ? " change it" : " changes it");
    }
    return out;
}

static void press(struct window *window, const struct key *key)
{
    if (key->act) {
        key->act(window);
    } else if (key->view) {
        key->view(window->viewer);
    } else if (key->tool) {
        key->tool(window->viewer, (enum tool_number)key->by[0]);
    } else if (key->step) {
        key->step(window, key->by[0]);
    } else if (key->move) {
        key->move(window, key->by);
    } else {
        property_next(window, key->sets);
    }
}

/* Presses the first key of that name that is one now: without an atlas of few, of a wand's while a tool is moved as
 * one. False = there is none. */
static bool press_row(struct window *window, const char *key, bool has_atlas)
{
    const bool has_wand = has_atlas && tool_moved_by(window->viewer, POINT_BY_WAND) < TOOL_COUNT;
    for (size_t i = 0; i < KEYS; i++) {
        const bool is_one = has_atlas ? has_wand || !keys[i].is_of_wand : keys[i].is_anywhere;
        if (is_one && strcasecmp(keys[i].key, key) == 0) {
            press(window, &keys[i]);
            return true;
        }
    }
    return false;
}

static bool press_in_dialog(struct window *window, const char *key)
{
    struct dialog *dialog = &window->dialog;
    bool goes_up = strcasecmp(key, "up") == 0;
    if (goes_up || strcasecmp(key, "down") == 0) {
        dialog_move(dialog, goes_up ? -1 : 1);
    } else if (strcasecmp(key, "enter") == 0) {
        window_use_dialog(window);
    } else if (strcasecmp(key, "escape") == 0) {
        dialog->on = false;
    } else if (strcasecmp(key, "tab") == 0) {
        dialog->takes_keys = true;
    } else {
        return strcasecmp(key, "ctrl+q") == 0 && press_row(window, key, false);
    }
    return true;
}

/* Puts a letter into the line of the start page, which has the keys from then on, in place of what it had. */
static bool type_at_start(struct start *start, const char *key)
{
    size_t length = start->is_set ? strlen(start->typed) : 0;
    bool is_letter = key[0] && !key[1] && length + 1 < sizeof start->typed;
    if (is_letter) {
        memcpy(start->typed + length, key, 2);
        start->takes_keys = start->is_set = true;
    }
    return is_letter;
}

/* Presses a key on the start page, where digits open the entries of its lists. */
static bool press_at_start(struct window *window, const char *key)
{
    struct start *start = &window->start;
    const char *path = key[0] >= '1' && key[0] <= '9' && !key[1] ? start_path(start, (size_t)(key[0] - '1')) : NULL;
    if (start->is_set && type_at_start(start, key)) {
        return true; /* typed before the line had the keys */
    }
    if (path) {
        window_request_file(window, path);
    } else if (strcasecmp(key, "tab") == 0) {
        start->takes_keys = true;
    } else if (strcasecmp(key, "enter") == 0) {
        window_request_typed(window);
    } else if (strcasecmp(key, "up") == 0 || strcasecmp(key, "down") == 0) {
        start_move(start, strcasecmp(key, "up") == 0 ? -1 : 1);
    } else if (strcasecmp(key, "s") == 0 && start->has_no_sample) {
        window_request_sample(window);
    } else if (strcasecmp(key, "escape") == 0 && window->forms.show_help) {
        window->forms.show_help = false;
    } else if (strcasecmp(key, "escape") == 0 && window->files.session_waits) {
        free(window->files.session_waits);
        window->files.session_waits = NULL;
        start->why[0] = '\0';
    } else if (strcasecmp(key, "escape") == 0 && window->viewer) {
        start->on = false;
    } else {
        return press_row(window, key, false) || (!isdigit((unsigned char)key[0]) && type_at_start(start, key));
    }
    return true;
}

static bool press_in_question(struct window *window, const char *key)
{
    bool may_be_added = window->files.asked.may_be_added;
    if (window->forms.closing_loses) {
        bool stays = strcasecmp(key, "enter") == 0 || strcasecmp(key, "escape") == 0;
        if (stays || strcasecmp(key, "q") == 0) {
            window_answer_closing(window, !stays);
            return true;
        }
        return strcasecmp(key, "ctrl+q") == 0; /* which may be held down: no answer */
    }
    if (may_be_added && (strcasecmp(key, "a") == 0 || strcasecmp(key, "enter") == 0)) {
        window_answer(window, OPEN_ADDS);
    } else if (strcasecmp(key, "r") == 0) {
        window_answer(window, OPEN_REPLACES);
    } else if (strcasecmp(key, "escape") == 0) {
        window_answer(window, OPEN_ASKS);
    } else {
        return strcasecmp(key, "ctrl+q") == 0 && press_row(window, key, false);
    }
    return true;
}

bool keys_press(struct window *window, const char *key)
{
    if (window_asks(window)) {
        return press_in_question(window, key);
    }
    if (window->dialog.on) {
        return press_in_dialog(window, key);
    }
    if (window->start.on) {
        return press_at_start(window, key);
    }
    bool asks = window->forms.figure.open || window->forms.added.open;
    if (asks && strcasecmp(key, "escape") != 0 && strncasecmp(key, "ctrl+", 5) != 0) {
        return true; /* the question is before the brain: a second Enter confirms nothing */
    }
    return press_row(window, key, true);
}

/* Whether a row has the text that is searched, in its key or in what it does. */
static bool is_found(const struct key *key, const char *shown, const char *search)
{
    return key->help && (!search[0] || text_contains(text_from(key->help), text_from(search)) ||
                         text_contains(text_from(shown), text_from(search)));
}

void keys_draw_help(struct window *window)
{
    char *search = window->forms.help_search;
    bool is_wide = (float)window->screen.width >= 1240 * window->screen.scale;
    size_t found = 0;
    window_panel(window, "Keys and mouse (?, F1 or Escape closes this)", is_wide ? 1240 : 640, 780);
    ui_take_keys(&window->forms.searches_help);
    ui_type("Search", search, sizeof window->forms.help_search, "a key, or what it does",
            "lists the keys that have this in their name or in what they do; / comes here");
    ui_columns(is_wide ? 2 : 1);
    for (size_t i = 0; i < KEYS; i++) {
        char text[KEY_LIMIT];
        const char *shown = keys_shown(text, &keys[i]);
        if (keys[i].group && !search[0]) {
            ui_text_coloured(THEME_HINT, "%s", keys[i].group);
        }
        if (is_found(&keys[i], shown, search)) {
            found++;
            ui_text_coloured(THEME_ACCENT, "%s", shown);
            ui_same_line_at(120 * window->screen.scale);
            ui_text_wrapped(THEME_PLAIN, keys[i].help);
        }
        if (keys[i].ends_column && !search[0]) {
            ui_next_column();
        }
    }
    if (!found) {
        ui_text("no key does that");
    }
    ui_columns(1);
    ui_separator();
    ui_text_wrapped(
        THEME_PLAIN,
        "3-D: left button turns, right button moves, wheel comes nearer; the cone follows the mouse, a click holds it "
        "and sets the crosshair, another one lets it go, a double click keeps the answer.\n"
        "Flat panes: left button sets the crosshair, wheel goes through the cuts, Ctrl and wheel magnify; middle "
        "button, or Ctrl and left, drags the context's brightness (up) and contrast (right), a double click resets; "
        "with the wand, right button puts the device there, with Shift it points there.\n"
        "SpaceMouse: the cap moves and turns the tool along its own axes; first button holds, second resets, third "
        "keeps the answer.\n"
        "Gamepad: left stick moves forward, back and aside, right stick turns, shoulder buttons move down and up, "
        "triggers narrow and widen the cone; A holds, B resets, X keeps.");
    ui_panel_end();
}
