/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of keys, what each does, and the help that lists them. */
#include "viewer/commands/keys.h"

#include "viewer/commands/keys_look.h"
#include "viewer/commands/keys_view.h"
#include "viewer/commands/keys_wand.h"
#include "viewer/model/hemisphere_side.h"
#include "viewer/model/question.h"
#include "viewer/model/studies.h"
#include "viewer/session/keep.h"
#include "viewer/session/undo.h"
#include "viewer/tools/inputs.h"
#include "viewer/tools/point.h"
#include "viewer/ui/ui_list.h"
#include "viewer/ui/ui_navigate.h"
#include "viewer/window/figure_form.h"
#include "viewer/window/screen.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdlib.h>
#include <strings.h>

static void toggle_help(struct window *window)
{
    window->forms.show_help = !window->forms.show_help;
}

static void confirm(struct window *window)
{
    tool_confirm(window->viewer, FIRST_TOOL);
}

static void undo(struct window *window)
{
    undo_step(window, -1);
}

static void redo(struct window *window)
{
    undo_step(window, 1);
}

static void show_all(struct window *window)
{
    viewer_show_all(window->viewer);
}

static void hide_chosen(struct window *window)
{
    struct viewer *viewer = window->viewer;
    if (viewer->drawn->shown.chosen) {
        viewer_hide(viewer, viewer->drawn->shown.chosen, !viewer->drawn->shown.hidden[viewer->drawn->shown.chosen]);
    }
}

static void isolate_chosen(struct window *window)
{
    if (window->viewer->drawn->shown.chosen) {
        viewer_isolate(window->viewer, window->viewer->drawn->shown.chosen);
    }
}

static void hold(struct window *window)
{
    tool_hold(window->viewer, FIRST_TOOL);
}

/* First what covers the brain, then the cone. */
static void clear(struct window *window)
{
    if (window->forms.show_help) {
        window->forms.show_help = false;
    } else if (window->forms.figure.open) {
        window->forms.figure.open = false;
    } else if (window->forms.added.open) {
        window->forms.added.open = false;
    } else if (ui_navigates()) {
        window->frame.navigated = 0;
        window->frame.navigates_anew = true;
    } else {
        viewer_clear(window->viewer);
        viewer_choose(window->viewer, 0);
        viewer_say(window->viewer, "cleared");
    }
}

/* From the areas to the hits, and back to the panes. */
static void go_to_panel(struct window *window)
{
    window->frame.navigated = ui_navigates() ? (window->frame.navigated + 1) % 3 : 1;
    window->frame.navigates_anew = true;
}

static void use_eye(struct window *window)
{
    point_use_eye(window->viewer, !window->viewer->cone.apex_at_eye);
}

static void follow_next(struct window *window)
{
    point_follow(window->viewer, (enum follow)((window->viewer->cone.follow + 1) % FOLLOW_COUNT));
}

static void use_ray(struct window *window)
{
    point_use_ray(window->viewer, !window->viewer->cone.one_ray);
}

static void use_second(struct window *window)
{
    tool_use_second(window->viewer, !window->viewer->tools[SECOND_TOOL].on);
    viewer_say(window->viewer, "the second tool is %s", window->viewer->tools[SECOND_TOOL].on ? "on" : "off");
}

static void hold_second(struct window *window)
{
    if (window->viewer->tools[SECOND_TOOL].on) {
        tool_hold(window->viewer, SECOND_TOOL);
    }
}

static void scale_second(struct window *window, double factor)
{
    if (window->viewer->tools[SECOND_TOOL].on) {
        tool_widen(window->viewer, SECOND_TOOL, factor);
    }
}

static void widen_second(struct window *window)
{
    scale_second(window, 1.1);
}

static void narrow_second(struct window *window)
{
    scale_second(window, 1 / 1.1);
}

static void scale_speed(struct window *window, double factor)
{
    devices_set_speed(&window->inputs.devices, devices_speed(&window->inputs.devices) * factor);
    window->viewer->version++;
    viewer_say(window->viewer, "a SpaceMouse or gamepad moves by %.0f mm and degrees a second at most",
               devices_speed(&window->inputs.devices));
}

static void speed_up(struct window *window)
{
    scale_speed(window, 1.25);
}

static void slow_down(struct window *window)
{
    scale_speed(window, 0.8);
}

static void move_by_next(struct window *window)
{
    tool_choose_next(window->viewer, FIRST_TOOL);
}

static void move_second_by_next(struct window *window)
{
    tool_choose_next(window->viewer, SECOND_TOOL);
}

static void scale_angle(struct window *window, double factor)
{
    struct viewer *viewer = window->viewer;
    viewer->tools[FIRST_TOOL].angle = fmin(fmax(viewer->tools[FIRST_TOOL].angle * factor, 0.1), 179);
    viewer_reselect(viewer);
}

static void widen(struct window *window)
{
    scale_angle(window, 1.1);
}

static void narrow(struct window *window)
{
    scale_angle(window, 1 / 1.1);
}

static void toggle_layers(struct window *window)
{
    conus_selector_options *options = &window->viewer->cone.options;
    options->layers = options->layers ? CONUS_LAYERS_VISIBLE : CONUS_LAYERS_ALL;
    viewer_reselect(window->viewer);
}

static void go_deeper(struct window *window)
{
    question_next_level(window->viewer);
}

static void change_hemispheres(struct window *window)
{
    window_want_hemispheres(window, (conus_hemispheres)((window->files.hemispheres + 1) % HEMISPHERES_COUNT), 0);
}

static void show_next_side(struct window *window)
{
    side_show_next(window->viewer);
}

static void change_order(struct window *window)
{
    question_set_order(window->viewer, window->viewer->cone.order ? CONUS_ORDER_RANK : CONUS_ORDER_DEPTH);
}

static void shorten_range(struct window *window)
{
    question_move_range(window->viewer, 0, -1);
}

static void lengthen_range(struct window *window)
{
    question_move_range(window->viewer, 0, 1);
}

static void start_nearer(struct window *window)
{
    question_move_range(window->viewer, -1, 0);
}

static void start_deeper(struct window *window)
{
    question_move_range(window->viewer, 1, 0);
}

static void study_next(struct window *window)
{
    studies_next(window->viewer);
}

static void keep_study(struct window *window)
{
    keep(window, KEEP_STUDY);
}

static void look_at_all(struct window *window)
{
    struct viewer *viewer = window->viewer;
    orbit_look_at(&viewer->orbit, viewer->centre, viewer->radius);
    viewer->version++;
}

static void flip_sides(struct window *window)
{
    window->viewer->display.radiological = !window->viewer->display.radiological;
    window->viewer->version++;
}

static void toggle_head(struct window *window)
{
    struct viewer *viewer = window->viewer;
    bool is_there = head_toggle(&viewer->head);
    viewer_say(viewer, !is_there         ? "no head is tracked: start with --head"
                       : viewer->head.on ? "the head moves the view"
                                         : "the mouse moves the view");
}

static void change_colours(struct window *window)
{
    viewer_use_safe_colours(window->viewer, !window->viewer->display.safe_colours);
}

static void draw_next(struct window *window)
{
    struct viewer *viewer = window->viewer;
    viewer_draw(viewer, (size_t)(viewer->drawn - viewer->atlases + 1) % viewer->atlas_count);
    viewer_say(viewer, "%s%s", viewer->atlas_count > 1 ? "drawn: " : "there is one atlas: start with --atlas for more",
               viewer->drawn->name);
}

static void keep_session(struct window *window)
{
    keep(window, KEEP_SESSION);
}

static void keep_same_session(struct window *window)
{
    keep(window, KEEP_SAME_SESSION);
}

static void open_file(struct window *window)
{
    window_show_dialog(window, DIALOG_OPEN);
}

static void save_as(struct window *window)
{
    window_show_dialog(window, DIALOG_SAVE);
}

static void quit(struct window *window)
{
    glfwSetWindowShouldClose(window->handle, GLFW_TRUE);
}

static void keep_picture(struct window *window)
{
    window->frame.keeps_picture = true; /* once the frame is drawn */
}

static void copy_list(struct window *window)
{
    window_copy(window, COPY_RESULTS);
}

static void copy_confirmed(struct window *window)
{
    window_copy(window, COPY_PINS);
}

static void export_list(struct window *window)
{
    keep(window, KEEP_RESULTS);
}

static void ask_for_figure(struct window *window)
{
    figure_form_open(window);
}

static void list_added(struct window *window)
{
    window->forms.figure.open = false;
    window->forms.added = (struct added_form){.open = !window->forms.added.open,
                                              .takes_keys = !window->forms.added.open,
                                              .kind = ADD_STREAMLINES,
                                              .is_set = true};
}

static void copy_figure(struct window *window)
{
    figure_form_copy(window);
}

static void enlarge_texts(struct window *window)
{
    window_zoom(window, 1);
}

static void shrink_texts(struct window *window)
{
    window_zoom(window, -1);
}

static void reset_texts(struct window *window)
{
    window_zoom(window, 0);
}

static void widen_first(struct window *window)
{
    layout_widen_first(&window->screen.layout, 1);
}

static void narrow_first(struct window *window)
{
    layout_widen_first(&window->screen.layout, -1);
}

static void widen_panels(struct window *window)
{
    layout_widen_panels(&window->screen.layout, 1, (float)window->screen.width, window->screen.scale);
}

static void narrow_panels(struct window *window)
{
    layout_widen_panels(&window->screen.layout, -1, (float)window->screen.width, window->screen.scale);
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

static const struct {
    const char *key;
    void (*act)(struct window *window);
    const char *meaning; /* NULL = it is not listed */
} keys[] = {
    {"?", toggle_help, "this list; F1, too"},
    {"f1", toggle_help, NULL},
    {"enter", confirm, "confirm: pin the best result"},
    {"space", hold, "hold the cone, or let it follow the mouse again, as a click does"},
    {"escape", clear, "clear the cone, and choose no area"},
    {"1", use_ray, "one area, by a single ray, or all areas in the cone"},
    {"x", use_eye, "the mouse's cone begins at the surface, or at your eye"},
    {"g", follow_next, "the cuts go along with the cone's tip, with the contact of its best hit, or stay"},
    {"+", widen, "a wider cone"},
    {"-", narrow, "a narrower cone"},
    {"l", toggle_layers, "first hits, or all hits"},
    {"m", move_by_next, "what moves the cone: the next of mouse, wand, ..."},
    {"2", use_second, "the second tool, with a cone and a list of its own, or none"},
    {"3", move_second_by_next, "what moves the second tool: the next"},
    {"4", hold_second, "hold the second tool, or let it go"},
    {"6", widen_second, "a wider second cone"},
    {"5", narrow_second, "a narrower one"},
    {"8", speed_up, "a SpaceMouse or gamepad moves faster"},
    {"7", slow_down, "slower"},
    {"f7", go_deeper, "areas as parts of larger ones: the next level of the tree, after the last one each by itself"},
    {"f8", change_hemispheres, "areas as in the file, split left and right, or left and right as one"},
    {"f9", show_next_side, "both sides, the left one only, the right one only: the other side's areas are hidden"},
    {"y", change_order, "the list by rank, or the nearest first"},
    {"f4", shorten_range, "depth limits: the farther one 1 mm nearer; at first 0 to 50 mm"},
    {"f5", lengthen_range, "the farther one 1 mm deeper"},
    {"f2", start_nearer, "the nearer one 1 mm nearer"},
    {"f3", start_deeper, "the nearer one 1 mm deeper"},
    {"j", study_next, "a study of the cone: sweep over its angle, jitter of its pose, or none"},
    {"ctrl+j", keep_study, "save the study's table: conus-DATE-TIME.tsv, in the folder where conus was started"},
    {"h", hide_chosen, "hide or show the chosen area"},
    {"i", isolate_chosen, "show the chosen area only"},
    {"ctrl+z", undo, "take back the last change; U, too"},
    {"u", undo, NULL},
    {"ctrl+y", redo, "do again what was taken back; Ctrl+Shift+Z, too"},
    {"ctrl+shift+z", redo, NULL},
    {"v", show_all, "show all areas"},
    {"r", look_at_all, "look at the whole brain"},
    {"f", flip_sides, "neurological or radiological"},
    {"t", toggle_head, "what a tracked head sees, or what the mouse turns"},
    {"n", draw_next, "draw the next of several atlases"},
    {"c", change_colours, "colours for any colour vision, or the atlas's own"},
    {"]", look_brighter, "brighter cuts; [ darker, } more contrast, { less: grey values of the context"},
    {"[", look_darker, NULL},
    {"}", look_more_contrast, NULL},
    {"{", look_less_contrast, NULL},
    {"b", look_reset_grey, "their black and white as they were found"},
    {".", look_more_opaque, "the chosen area more opaque in 3-D, or else what the cone does not hit; , less"},
    {",", look_less_opaque, NULL},
    {"k", look_next_backdrop, "another background of 3-D: light, white, black, transparent in figures"},
    {"9", look_next_streamlines, "streamlines by their bundle, by direction, or by the next number of their file"},
    {"ctrl+s", keep_same_session, "save the session where it was opened or saved last"},
    {"ctrl+shift+s", save_as, "save the session under another name"},
    {"o", keep_session, "or at once: conus-DATE-TIME.json, in the folder where conus was started"},
    {"p", keep_picture, "save what the window shows: conus-DATE-TIME.png, there, too"},
    {"ctrl+c", copy_list, "copy the hits of the cone as a table"},
    {"ctrl+shift+c", copy_confirmed, "copy what was confirmed"},
    {"ctrl+e", export_list, "export the hits of the cone: conus-DATE-TIME-hits.tsv, .csv or .json, there, too"},
    {"ctrl+p", ask_for_figure, "save 3-D or a cut as a figure: its size, dpi, background, legend and name"},
    {"ctrl+shift+p", copy_figure, "copy the path of the figure that was saved last"},
    {"ctrl+o", open_file, "open a file: an atlas or a session; or add one: streamlines or an image as context"},
    {"ctrl+l", list_added, "what was added: streamlines, pathways, context; add, change or take out"},
    {"ctrl+n", window_go_to_start, "the start page, for another atlas; Escape comes back"},
    {"ctrl+q", quit, "close the window"},
    {"f6", go_to_panel,
     "keys go to the areas, the hits, back: arrows and Tab move, Space presses or enters, Escape leaves"},
    {"tab", enlarge, "one pane after the other fills the window"},
    {"z", window_maximise, "the pane under the mouse alone, or all again; also a double click in a cut"},
    {")", widen_first, "a larger 3-D pane; borders can be dragged, too"},
    {"(", narrow_first, "a smaller 3-D pane"},
    {">", widen_panels, "wider panels"},
    {"<", narrow_panels, "narrower panels"},
    {"\\", reset_layout, "panes and panels as at first"},
    {"f11", fill_screen, "3-D alone, over the whole screen, and back"},
    {"ctrl++", enlarge_texts, "larger texts and panels"},
    {"ctrl+-", shrink_texts, "smaller ones"},
    {"ctrl+0", reset_texts, "as large as the screen asks for"},
};
enum { KEYS = sizeof keys / sizeof keys[0] };

/* Keys that need no atlas. */
static bool press_anywhere(struct window *window, const char *key)
{
    for (size_t i = 0; i < KEYS; i++) {
        bool needs_none = keys[i].act == toggle_help || keys[i].act == open_file || keys[i].act == quit ||
                          keys[i].act == enlarge_texts || keys[i].act == shrink_texts || keys[i].act == reset_texts;
        if (needs_none && strcasecmp(keys[i].key, key) == 0) {
            keys[i].act(window);
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
        return strcasecmp(key, "ctrl+q") == 0 && press_anywhere(window, key);
    }
    return true;
}

/* There the digits are those of its lists. */
static bool press_at_start(struct window *window, const char *key)
{
    struct start *start = &window->start;
    const char *path = key[0] >= '1' && key[0] <= '9' && !key[1] ? start_path(start, (size_t)(key[0] - '1')) : NULL;
    if (path) {
        window_want(window, path);
    } else if (strcasecmp(key, "tab") == 0) {
        start->takes_keys = true;
    } else if (strcasecmp(key, "enter") == 0) {
        window_want_typed(window);
    } else if (strcasecmp(key, "up") == 0 || strcasecmp(key, "down") == 0) {
        start_move(start, strcasecmp(key, "up") == 0 ? -1 : 1);
    } else if (strcasecmp(key, "s") == 0 && start->has_no_sample) {
        window_want_sample(window);
    } else if (strcasecmp(key, "escape") == 0 && window->forms.show_help) {
        window->forms.show_help = false;
    } else if (strcasecmp(key, "escape") == 0 && window->files.session_waits) {
        free(window->files.session_waits);
        window->files.session_waits = NULL;
        start->why[0] = '\0';
    } else if (strcasecmp(key, "escape") == 0 && window->viewer) {
        start->on = false;
    } else {
        return press_anywhere(window, key);
    }
    return true;
}

const char *keys_name(const char **meaning, size_t index)
{
    *meaning = index < KEYS ? keys[index].meaning : NULL;
    return index < KEYS ? keys[index].key : NULL;
}

bool keys_press(struct window *window, const char *key)
{
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
    for (size_t i = 0; i < KEYS; i++) {
        if (strcasecmp(keys[i].key, key) == 0) {
            keys[i].act(window);
            return true;
        }
    }
    return keys_wand_press(window, key) || keys_view_press(window, key);
}
