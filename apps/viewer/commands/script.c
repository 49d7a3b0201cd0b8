/* SPDX-License-Identifier: BSD-3-Clause */
/* The commands of scripts, and their run over frames. */
#include "viewer/commands/commands.h"

#include "base/system/system.h"
#include "conus/own.h"
#include "options/messages.h"
#include "settings/settings.h"
#include "viewer/model/columns.h"
#include "viewer/model/viewer.h"
#include "viewer/session/session.h"
#include "viewer/tools/tools.h"
#include "viewer/window/window.h"

#include <GLFW/glfw3.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SETTLE_FRAMES = 3, PICTURE_LIMIT = 16384, LINE_LIMIT = 65536 };

static const double settle_limit_ms = 6e5; /* a window that is never settled is an error */

struct script {
    char *path;
    FILE *file;
    char line[LINE_LIMIT + 2]; /* with its end, and a NUL */
    unsigned number;
    unsigned waiting; /* frames to let pass before the next command */
    unsigned settled; /* frames that the pictures shall still be fine for */
    double until;     /* by clock_ms(): settled, or it fails; or the end of a pause */
    bool settling, pausing;
    bool is_held;      /* the line was read, and is done once the pictures are fine */
    char *awaited;     /* a file that must be there before the next command; NULL = none */
    char *state;       /* a file that gets what the window shows once it rests; NULL = none */
    bool is_unwritten; /* that file could not be */
};

/* A command that is being run. */
struct call {
    struct script *script; /* NULL = not from a script */
    struct window *window;
    struct viewer *viewer; /* of the window */
    char *const *words;    /* the command's name, then its arguments */
    char *const *arguments;
    size_t count;      /* of arguments */
    double numbers[8]; /* those that its row asks for */
};

/* [count] numbers from the argument @p first on; false where there are not so many. */
static bool numbers(double *out, const struct call *call, size_t first, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (first + i >= call->count || !script_number(&out[i], call->arguments[first + i])) {
            return false;
        }
    }
    return true;
}

/* Whether argument @p index is @p word. */
static bool is_word(const struct call *call, size_t index, const char *word)
{
    return index < call->count && strcmp(call->arguments[index], word) == 0;
}

/* The index of a word among @p count names; @p count = it is none of them. */
static size_t find_name(const char *word, const char *const *names, size_t count)
{
    size_t found = 0;
    while (found < count && strcmp(names[found], word) != 0) {
        found++;
    }
    return found;
}

static bool is_done(conus_status status)
{
    if (status) {
        print_status(status);
    }
    return !status;
}

static bool is_fine(bool fine, const char *why)
{
    if (!fine) {
        print_error_line("%s", why);
    }
    return fine;
}

/* Two points of the world, the second one less the first as a direction: from the argument @p first on six numbers of
 * the viewer's space, or two places of the first atlas in words. False, and the message says why, where they are none;
 * *is_wrong where there are not so many. */
static bool read_line(bool *is_wrong, double from[3], double direction[3], const struct call *call, size_t first)
{
    double given[6];
    conus_place_options options = {.frame = &call->viewer->frame, .has_axis = true};
    bool fine = true;
    *is_wrong = call->count != first + 2 && (call->count != first + 6 || !numbers(given, call, first, 6));
    if (call->count == first + 6 && !*is_wrong) {
        fine = viewer_to_world(from, call->viewer, given) && viewer_to_world(direction, call->viewer, given + 3);
    }
    for (size_t i = 0; i < 2 && call->count == first + 2 && fine; i++) {
        double *out = i ? direction : from;
        conus_place place;
        fine = !conus_place_find(&place, call->viewer->atlases[0].atlas, call->arguments[first + i], &options);
        options.other = from;
        memcpy(out, place.point, fine ? sizeof place.point : 0);
    }
    for (int a = 0; a < 3 && fine && !*is_wrong; a++) {
        direction[a] -= from[a];
    }
    return fine && !*is_wrong;
}

/* The commands: false where the arguments are wrong, or it could not be done. */

static bool do_key(struct call *call)
{
    return window_press(call->window, call->arguments[0]);
}

static bool do_aim(struct call *call)
{
    double from[3];
    double direction[3];
    bool is_wrong;
    if (!read_line(&is_wrong, from, direction, call, 0)) {
        return !is_wrong && is_done(CONUS_ERROR_ARGUMENT);
    }
    tool_aim_along(call->viewer, FIRST_TOOL, from, direction);
    return true;
}

static bool do_crosshair(struct call *call)
{
    return viewer_to_world(call->viewer->crosshair, call->viewer, call->numbers) || is_done(CONUS_ERROR_ARGUMENT);
}

static bool do_orbit(struct call *call)
{
    call->viewer->orbit.azimuth = call->numbers[0] * M_PI / 180;
    call->viewer->orbit.elevation = call->numbers[1] * M_PI / 180;
    return true;
}

static bool do_zoom(struct call *call)
{
    orbit_zoom(&call->viewer->orbit, call->numbers[0]);
    return true;
}

/* Points by the mouse at a place of the 3-D pane, parts of its width and height. */
static bool do_point(struct call *call)
{
    double direction[3];
    struct eye eye;
    conus_pose pose;
    window_eye(call->window, &eye);
    eye_ray(direction, &eye, (double[]){1, 1}, call->numbers);
    if (tool_moved_by(call->viewer, POINT_BY_MOUSE) == SECOND_TOOL) {
        inputs_point(&call->window->inputs, call->viewer, eye.camera.world_from_device + 12, direction);
    } else if (point_find(&pose, call->viewer, eye.camera.world_from_device + 12, direction)) {
        tool_aim(call->viewer, FIRST_TOOL, &pose);
    }
    return true;
}

static bool do_type(struct call *call)
{
    struct start *start = &call->window->start;
    const char *text = call->arguments[0];
    if (call->window->dialog.on) {
        dialog_set(&call->window->dialog, text);
        return true;
    }
    size_t size = strlen(text) + 1;
    bool fine = start->on && size <= sizeof start->typed;
    memcpy(start->typed, text, fine ? size : 0);
    return fine;
}

static bool do_drop(struct call *call)
{
    window_request_files(call->window, call->count, (const char *const *)call->arguments);
    return true;
}

static bool do_take_out(struct call *call)
{
    const json_t *words = window_words(call->window);
    size_t index = additions_index(words, call->arguments[0]);
    bool fine = index < json_array_size(words);
    if (fine) {
        window_change(call->window, index, ADDITION_COUNT, NULL);
    }
    return fine;
}

/* Adds a file: the command's name is that of the option. The window says why a file cannot be added, as with the mouse.
 */
static bool do_add(struct call *call)
{
    window_change(call->window, SIZE_MAX, (enum addition)find_name(call->words[0], addition_names, ADDITION_COUNT),
                  call->arguments[0]);
    call->window->files.requested.is_needed = call->script;
    return true;
}

/* Places the screen: its middle, a point behind it in the line of sight, its width and height. */
static bool do_screen(struct call *call)
{
    const double *given = call->numbers;
    double away[3];
    struct head *head = &call->viewer->head;
    conus_pose screen;
    if (!(given[6] > 0) || !(given[7] > 0)) {
        return false;
    }
    for (int a = 0; a < 3; a++) {
        away[a] = given[3 + a] - given[a];
    }
    bool fine = is_done(conus_pose_along(&screen, given, away, NULL));
    if (fine) {
        *head = (struct head){
            .named = head->named, .screen = screen, .size = {given[6], given[7]}, .number = head->number + 1};
    }
    return fine;
}

static bool do_head(struct call *call)
{
    double eye[3];
    struct head *head = &call->viewer->head;
    if (call->count == 1 && is_word(call, 0, "lost")) {
        head_set_state(head, STATION_LOST);
        return true;
    }
    bool fine = head->size[0] > 0 && call->count == 3 && numbers(eye, call, 0, 3);
    if (fine) {
        head->on = true;
        head_set_state(head, STATION_SEEN);
        head_move(head, eye, &head->screen);
    }
    return fine;
}

static bool do_ask(struct call *call)
{
    char *words[SCRIPT_WORDS]; /* the options' parser may reorder them */
    memcpy(words, call->words, (1 + call->count) * sizeof *words);
    return query_set_words(call->viewer, words, 1 + (int)call->count);
}

/* Begins the study that the command is called after, with its numbers; "off" ends it. */
static bool do_study_of(struct call *call)
{
    struct study_settings study = call->viewer->study.settings;
    const bool sweeps = strcmp(call->words[0], "sweep") == 0;
    double *const out[2][3] = {{&study.tilt_deg, &study.shift_mm, &study.samples},
                               {&study.angles[0], &study.angles[1], &study.angles[2]}};
    bool ends = call->count == 1 && is_word(call, 0, "off");
    bool fine = ends || call->count >= (sweeps ? 3 : 2);
    for (size_t i = 0; i < call->count && fine && !ends; i++) {
        fine = numbers(out[sweeps][i], call, i, 1);
    }
    study.kind = ends ? STUDY_NONE : sweeps ? STUDY_SWEEP : STUDY_JITTER;
    return fine && is_fine(studies_use(call->viewer, &study), call->viewer->message);
}

/* Writes the table that conus sweep would write. */
static bool do_study(struct call *call)
{
    const char *text = studies_text(call->viewer);
    if (!text) {
        return is_fine(false, call->viewer->message);
    }
    bool is_written = !conus_write_file(call->arguments[0], text, strlen(text));
    return is_fine(is_written, conus_message());
}

static bool do_planned(struct call *call)
{
    double row = call->numbers[0];
    return is_fine(row >= 1 && row == floor(row), "rows are counted from 1") &&
           is_fine(plans_go(call->viewer, (size_t)row - 1), call->viewer->message);
}

static bool do_row(struct call *call)
{
    const double row = call->numbers[0];
    const size_t count = conus_pose_list_count(call->viewer->points.poses);
    const bool is = row >= 0 && row <= (double)count && row == floor(row);
    if (is) {
        points_choose(call->viewer, (uint32_t)row);
    }
    return is_fine(is, "no such row of a list of points");
}

/* Writes the table that conus plan would write. */
static bool do_plan(struct call *call)
{
    const char *why;
    const struct plan_list *list = plans_list(call->viewer, &why);
    if (!list || plans_is_behind(call->viewer)) {
        return is_fine(false, why[0] ? why : "there is no list of a plan");
    }
    return is_fine(!conus_write_file(call->arguments[0], list->text, strlen(list->text)), conus_message());
}

static bool do_search(struct call *call)
{
    struct shown_objects *shown = &call->viewer->drawn->shown;
    snprintf(shown->search, sizeof shown->search, "%s", call->count ? call->arguments[0] : "");
    return true;
}

static bool do_choose(struct call *call)
{
    uint32_t object = search_best(call->viewer->drawn->atlas, call->arguments[0]);
    viewer_choose(call->viewer, object);
    return object;
}

/* Asks the plan for a target, or for none without a name; or to avoid an area, or not any more. */
static bool do_asked(struct call *call)
{
    const bool is_target = strcmp(call->words[0], "target") == 0;
    const conus_atlas *atlas = call->viewer->atlases->atlas;
    const conus_object *object = call->count ? conus_atlas_object(atlas, search_best(atlas, call->arguments[0])) : NULL;
    bool fine = (object || !call->count) && (call->count < 2 || is_word(call, 1, "off"));
    if (fine) {
        window_request_asked(call->window, is_target ? CONUS_CONSTRAINT_REACH : CONUS_CONSTRAINT_AVOID,
                             object ? object->name : "", call->count == 1);
    }
    return fine;
}

static bool choose_pointer(struct call *call, enum tool_number tool, size_t argument)
{
    size_t pointer = find_name(call->arguments[argument], pointer_names, POINTER_COUNT);
    bool fine = pointer < POINTER_COUNT && (tool == FIRST_TOOL || pointer != POINT_BY_REPLAY);
    if (fine) {
        tool_choose(call->viewer, tool, (enum pointer)pointer);
    }
    return fine;
}

static bool do_pointer(struct call *call)
{
    return choose_pointer(call, FIRST_TOOL, 0);
}

/* Connects, in place of what was connected, or ends that. */
static bool do_tracker(struct call *call)
{
    struct inputs *inputs = &call->window->inputs;
    inputs_disconnect(inputs, call->viewer);
    if (is_word(call, 0, "off")) {
        return true;
    }
    snprintf(inputs->address, sizeof inputs->address, "%s", call->arguments[0]);
    return window_connect(call->window);
}

static bool aim_second(struct call *call)
{
    double from[3];
    double direction[3];
    bool is_wrong;
    conus_pose pose;
    bool is_read = read_line(&is_wrong, from, direction, call, 1);
    if (is_wrong) {
        return false;
    }
    bool fine = is_done(is_read ? conus_pose_along(&pose, from, direction, NULL) : CONUS_ERROR_ARGUMENT);
    if (fine) {
        tool_aim(call->viewer, SECOND_TOOL, &pose);
    }
    return fine;
}

static bool do_second(struct call *call)
{
    if (call->count == 1 && (is_word(call, 0, "on") || is_word(call, 0, "off"))) {
        tool_use_second(call->viewer, is_word(call, 0, "on"));
        return true;
    }
    if (call->count == 1 && is_word(call, 0, "hold")) {
        tool_hold(call->viewer, SECOND_TOOL);
        return true;
    }
    if (call->count == 1 && is_word(call, 0, "confirm")) {
        tool_confirm(call->viewer, SECOND_TOOL);
        return true;
    }
    if (is_word(call, 0, "aim")) {
        return aim_second(call);
    }
    if (is_word(call, 0, "angle")) {
        return property_set_words(call->window, PROPERTY_SECOND_ANGLE, call->arguments + 1, call->count - 1);
    }
    if (call->count == 2 && is_word(call, 0, "pointer")) {
        return choose_pointer(call, SECOND_TOOL, 1);
    }
    if (call->count == 2 && is_word(call, 0, "results")) {
        tool_update_second(call->viewer);
        return is_done(viewer_write_results(call->viewer, SECOND_TOOL, call->arguments[1]));
    }
    return false;
}

static bool do_threshold(struct call *call)
{
    uint32_t object = search_best(call->viewer->drawn->atlas, call->arguments[0]);
    const conus_volume_info *info = view_atlas_pathway(call->viewer->drawn, object);
    double threshold;
    bool fine = info && numbers(&threshold, call, 1, 1) && threshold >= info->minimum && threshold <= info->maximum;
    if (fine) {
        viewer_set_threshold(call->viewer, object, threshold);
    }
    return fine;
}

static bool do_grey(struct call *call)
{
    const struct view_atlas *drawn = call->viewer->drawn;
    double grey[2] = {0, 0};
    bool has_context = view_atlas_context(drawn) < conus_atlas_volume_count(drawn->atlas);
    bool fine = has_context && (call->count == 0 || (numbers(grey, call, 0, 2) && grey[0] < grey[1]));
    if (fine) {
        viewer_set_grey(call->viewer, grey[0], grey[1]);
    }
    return fine;
}

/* Sets an area, or all that the cone does not hit, which is never invisible. */
static bool do_opacity(struct call *call)
{
    double opacity = NAN;
    size_t last = call->count - 1;
    uint32_t object = last ? search_best(call->viewer->drawn->atlas, call->arguments[0]) : 0;
    bool resets = object && is_word(call, last, "reset");
    bool fine =
        (!last || object) &&
        (resets || (numbers(&opacity, call, last, 1) && opacity >= 0 && opacity <= 1 && (object || opacity > 0)));
    if (fine) {
        viewer_set_opacity(call->viewer, object, opacity);
    }
    return fine;
}

static bool do_haze(struct call *call)
{
    const conus_atlas *atlas = call->viewer->drawn->atlas;
    uint32_t pathway = search_best(atlas, call->arguments[0]);
    size_t haze = haze_find(call->arguments[1]);
    bool fine = pathway && conus_atlas_object(atlas, pathway)->kind == CONUS_KIND_PATHWAY && haze < HAZE_LIMIT;
    if (fine) {
        viewer_set_haze(call->viewer, pathway, haze);
    }
    return fine;
}

static bool do_streamline_colour(struct call *call)
{
    size_t colour = tract_colour_find(call->viewer->drawn->atlas, call->arguments[0]);
    bool fine = colour != TRACT_COLOUR_LIMIT;
    if (fine) {
        viewer_colour_streamlines(call->viewer, colour);
    }
    return fine;
}

static bool do_preset(struct call *call)
{
    const char *found = NULL;
    for (size_t i = 0; call->count && (found = conus_transfer_preset(i)) && !is_word(call, 0, found); i++) {
    }
    bool fine = !call->count || found;
    if (fine) {
        viewer_use_preset(call->viewer, found);
    }
    return fine;
}

static bool do_hemispheres(struct call *call)
{
    size_t how = find_name(call->arguments[0], settings_hemispheres, HEMISPHERES_COUNT);
    if (how < HEMISPHERES_COUNT) {
        window_request_hemispheres(call->window, (conus_hemispheres)how);
    }
    return how < HEMISPHERES_COUNT;
}

static bool do_side(struct call *call)
{
    size_t side = find_name(call->arguments[0], side_names, SIDE_COUNT);
    bool fine = side < SIDE_COUNT && side_known(call->viewer) == SIDE_BOTH;
    if (fine) {
        side_show(call->viewer, (enum side)side);
    }
    return fine;
}

static bool do_wait(struct call *call)
{
    bool fine = call->numbers[0] >= 0 && call->numbers[0] < 1e6;
    call->script->waiting = fine ? (unsigned)call->numbers[0] : 0;
    return fine;
}

/* Waits for a file, for programs that drive the window from outside. */
static bool do_until(struct call *call)
{
    free(call->script->awaited);
    call->script->awaited = strdup(call->arguments[0]);
    return call->script->awaited;
}

static void settle(struct script *script, unsigned frames)
{
    script->settling = true;
    script->settled = frames;
    script->until = clock_ms() + settle_limit_ms;
}

static bool do_settle(struct call *call)
{
    settle(call->script, SETTLE_FRAMES);
    return true;
}

/* The window does what it does while nobody touches it: what it shows then no frame of a script has made right. */
static bool do_state(struct call *call)
{
    struct script *script = call->script;
    free(script->state);
    script->state = strdup(call->arguments[0]);
    script->until = clock_ms() + settle_limit_ms;
    return script->state;
}

/* The window does what it does while nobody touches it. */
static bool do_pause(struct call *call)
{
    double seconds = call->numbers[0];
    call->script->pausing = seconds >= 0 && seconds <= 3600;
    call->script->until = clock_ms() + 1e3 * seconds;
    return call->script->pausing;
}

static bool do_screenshot(struct call *call)
{
    return is_done(window_write(call->window, call->arguments[0]));
}

static bool write_figure(struct call *call, size_t pane, const struct figure_settings *settings)
{
    char why[FIGURE_REASON];
    return is_fine(figure_write(call->window, pane, settings, call->arguments[0], why), why);
}

/* Width and height in pixels, from argument @p first on. */
static bool read_size(uint32_t out[2], const struct call *call, size_t first)
{
    double size[2];
    bool fine = numbers(size, call, first, 2) && size[0] >= 1 && size[1] >= 1 && size[0] <= PICTURE_LIMIT &&
                size[1] <= PICTURE_LIMIT;
    for (int i = 0; i < 2 && fine; i++) {
        out[i] = (uint32_t)size[i];
    }
    return fine;
}

/* The 3-D view as conus render draws it by itself, whatever the sheet of figures is. */
static bool do_picture(struct call *call)
{
    const struct view_atlas *drawn = call->viewer->drawn;
    struct figure_settings settings = {.background = backdrop_of_figures(call->viewer->display.backdrop),
                                       .streamline_colour =
                                           appearance_streamline_colour(&drawn->appearance, drawn->atlas)};
    return read_size(settings.size, call, 1) && write_figure(call, PANE_3D, &settings);
}

static bool do_angle(struct call *call)
{
    bool fine = property_set_words(call->window, PROPERTY_ANGLE, call->arguments, call->count);
    double radius = call->viewer->cone.options.radius;
    if (fine && radius > 0) {
        viewer_say(call->viewer, "the tool is a cylinder of %.4g mm radius: its opening does not count", radius);
    }
    return fine;
}

static bool do_figure(struct call *call)
{
    struct figure_settings settings;
    size_t pane = call->count == 2 ? find_name(call->arguments[1], figure_panes, PANE_COUNT) : PANE_3D;
    figure_of_window(&settings, call->window);
    return pane < PANE_COUNT && write_figure(call, pane, &settings);
}

static bool do_sheet(struct call *call)
{
    double dpi;
    double size[2];
    if (call->count == 3) {
        bool in_mm = is_word(call, 0, "mm");
        enum property_id which = in_mm ? PROPERTY_FIGURE_MM : PROPERTY_FIGURE_PIXELS;
        bool fine = (in_mm || is_word(call, 0, "pixels")) && numbers(size, call, 1, 2) && size[0] >= 1 &&
                    size[1] >= 1 && property_set_words(call->window, which, call->arguments + 1, 2);
        call->window->sheet.in_mm = fine ? in_mm : call->window->sheet.in_mm;
        return fine;
    }
    if (is_word(call, 0, "dpi") && (!numbers(&dpi, call, 1, 1) || (dpi != 0 && dpi < SHEET_DPI_LEAST))) {
        return false;
    }
    enum property_id id = is_word(call, 0, "dpi")      ? PROPERTY_FIGURE_DPI
                          : is_word(call, 0, "legend") ? PROPERTY_FIGURE_LEGEND
                          : is_word(call, 0, "text")   ? PROPERTY_FIGURE_TEXT
                                                       : PROPERTY_COUNT;
    return id < PROPERTY_COUNT && property_set_words(call->window, id, call->arguments + 1, 1);
}

static bool do_save(struct call *call)
{
    char why[PROPERTY_REASON];
    return is_fine(session_save(call->window, call->arguments[0], why), why);
}

static bool do_open(struct call *call)
{
    char why[PROPERTY_REASON];
    return is_fine(session_load(call->window, call->arguments[0], why), why);
}

static bool do_times(struct call *call)
{
    return is_done(times_write(&call->window->times, call->arguments[0]));
}

static bool do_size(struct call *call)
{
    uint32_t size[2];
    bool fine = read_size(size, call, 0);
    if (fine) {
        glfwSetWindowSize(call->window->handle, (int)size[0], (int)size[1]); /* the screen may give another one */
    }
    return fine;
}

/* Widths of the panels, pixels at scale 1, and parts of the middle, all 0 as at first. */
static bool do_panes(struct call *call)
{
    const double *given = call->numbers;
    struct layout layout = {.panels = {given[0], given[1]}, .division = {given[2], given[3]}};
    bool fine = layout_is_fine(&layout);
    if (fine) {
        call->window->screen.layout = layout;
    }
    return fine;
}

/* Writes the list as conus query would. */
static bool do_results(struct call *call)
{
    return is_done(viewer_write_results(call->viewer, FIRST_TOOL, call->arguments[0]));
}

static bool do_export(struct call *call)
{
    char why[EXPORT_WHY];
    return is_fine(export_results(call->viewer, call->arguments[0], why), why);
}

static bool do_columns(struct call *call)
{
    return result_choose(call->viewer, call->arguments, call->count);
}

/* Orders as a click above the column does. */
static bool do_order(struct call *call)
{
    size_t column = result_find(call->arguments[0]);
    if (column < RESULT_COLUMNS) {
        result_order_by(call->viewer, column);
    }
    return column < RESULT_COLUMNS;
}

/* [least, most] arguments. A command does something, or sets a property. */
static const struct script_command {
    const char *name;
    size_t least, most;
    const char *arguments;
    bool (*act)(struct call *call); /* NULL = it sets the property */
    enum property_id sets;
    size_t numbers;   /* as many arguments, the first ones, are numbers */
    bool is_anywhere; /* it needs no atlas */
} commands[] = {
    {"key", 1, 1, "KEY", .act = do_key, .is_anywhere = true},
    {"drop", 1, SCRIPT_WORDS - 1, "PATH...", .act = do_drop, .is_anywhere = true},
    {"type", 1, 1, "PATH, on the start page or where a file is chosen", .act = do_type, .is_anywhere = true},
    {"context", 1, 1, "FILE", .act = do_add},
    {"pathway", 1, 1, "FILE[,threshold=T][,name=S][,unit=S][,volume=K] or FILE,band=LOW:HIGH:NAME", .act = do_add},
    {"streamlines", 1, 1, "FILE[,radius=R][,name=S][,space=S][,moves]", .act = do_add},
    {"atlas", 1, 1, "FILE or NAME", .act = do_add},
    {"pose", 1, 1, "FILE, a list of points or poses", .act = do_add},
    {"row", 1, 1, "ROW of that list, from 1; 0 = none", .act = do_row, .numbers = 1},
    {"take-out", 1, 1, "FILE that was added", .act = do_take_out},
    {"aim", 2, 6, "X Y Z TX TY TZ, or PLACE PLACE", .act = do_aim},
    {"point", 2, 2, "RIGHT DOWN, parts of the 3-D pane", .act = do_point, .numbers = 2},
    {"screen", 8, 8, "X Y Z TX TY TZ WIDTH HEIGHT", .act = do_screen, .numbers = 8},
    {"head", 1, 3, "X Y Z, after screen, or lost", .act = do_head},
    {"angle", 1, 1, "DEGREES", .act = do_angle},
    {"ask", 0, SCRIPT_WORDS - 1, "OPTION..., those of conus query that say how the cone asks", .act = do_ask},
    {"sweep", 1, 3, "LOW HIGH STEP, degrees, or off", .act = do_study_of},
    {"jitter", 1, 3, "DEGREES MM [SAMPLES], or off", .act = do_study_of},
    {"study", 1, 1, "FILE.tsv", .act = do_study},
    {"target", 0, 1, "[NAME]", .act = do_asked},
    {"avoid", 1, 2, "NAME [off]", .act = do_asked},
    {"planned", 1, 1, "ROW of the plan, from 1", .act = do_planned, .numbers = 1},
    {"plan", 1, 1, "FILE.tsv", .act = do_plan},
    {"pointer", 1, 1, "mouse|wand|replay|tracker|spacemouse|gamepad", .act = do_pointer},
    {"tracker", 1, 1, "HOST[:PORT], or off", .act = do_tracker},
    {"speed", 1, 1, "MM a second, 1 to 400", .sets = PROPERTY_SPEED},
    {"second", 1, 7,
     "on|off|hold|confirm, aim X Y Z TX TY TZ or PLACE PLACE, angle DEGREES, pointer "
     "mouse|wand|tracker|spacemouse|gamepad, results FILE.tsv",
     .act = do_second},
    {"crosshair", 3, 3, "X Y Z", .act = do_crosshair, .numbers = 3},
    {"orbit", 2, 2, "AZIMUTH ELEVATION, degrees", .act = do_orbit, .numbers = 2},
    {"zoom", 1, 1, "CLICKS", .act = do_zoom, .numbers = 1},
    {"search", 0, 1, "[TEXT]", .act = do_search},
    {"choose", 1, 1, "NAME", .act = do_choose},
    {"wait", 1, 1, "FRAMES", .act = do_wait, .numbers = 1, .is_anywhere = true},
    {"pause", 1, 1, "SECONDS", .act = do_pause, .numbers = 1, .is_anywhere = true},
    {"settle", 0, 0, "", .act = do_settle, .is_anywhere = true},
    {"until", 1, 1, "FILE", .act = do_until, .is_anywhere = true},
    {"state", 1, 1, "FILE.json", .act = do_state},
    {"screenshot", 1, 1, "FILE.png", .act = do_screenshot, .is_anywhere = true},
    {"picture", 3, 3, "FILE.png WIDTH HEIGHT", .act = do_picture},
    {"results", 1, 1, "FILE.tsv", .act = do_results},
    {"export", 1, 1, "FILE.tsv|csv|json", .act = do_export},
    {"columns", 0, SCRIPT_WORDS - 1, "[NAME] ..., columns of conus query's tables", .act = do_columns},
    {"order", 1, 1, "NAME, a column of conus query's tables", .act = do_order},
    {"times", 1, 1, "FILE.json", .act = do_times, .is_anywhere = true},
    {"size", 2, 2, "WIDTH HEIGHT", .act = do_size, .is_anywhere = true},
    {"panes", 4, 4, "LEFT RIGHT COLUMN ROW", .act = do_panes, .numbers = 4, .is_anywhere = true},
    {"save", 1, 1, "FILE.json", .act = do_save},
    {"open", 1, 1, "FILE.json", .act = do_open},
    {"fade", 1, 1, "PART", .sets = PROPERTY_FADE},
    {"hemispheres", 1, 1, "as-is|split|merged", .act = do_hemispheres},
    {"side", 1, 1, "both|left|right, of an atlas that has sides", .act = do_side},
    {"threshold", 2, 2, "PATHWAY VALUE", .act = do_threshold},
    {"grey", 0, 2, "[BLACK WHITE], with a context", .act = do_grey},
    {"opacity", 1, 2, "[AREA] PART, or AREA reset", .act = do_opacity},
    {"haze", 2, 2, "PATHWAY solid|own|PRESET", .act = do_haze},
    {"preset", 0, 1, "[NAME]", .act = do_preset},
    {"streamline-colour", 1, 1, "bundle|direction|NAME", .act = do_streamline_colour},
    {"background", 1, 1, "theme|light|white|black|transparent", .sets = PROPERTY_BACKGROUND},
    {"sheet", 2, 3, "pixels|mm WIDTH HEIGHT, dpi N, legend auto|right|below|none, text on|off", .act = do_sheet},
    {"figure", 1, 2, "FILE.png [3d|axial|coronal|sagittal]", .act = do_figure},
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

const char *script_command_name(const char **arguments, size_t index)
{
    *arguments = index < COMMANDS ? commands[index].arguments : NULL;
    return index < COMMANDS ? commands[index].name : NULL;
}

static const struct script_command *find_command(const char *name)
{
    for (size_t i = 0; i < COMMANDS; i++) {
        if (strcmp(commands[i].name, name) == 0) {
            return &commands[i];
        }
    }
    return NULL;
}

/* Whether it could be done. */
static bool run_words(struct script *script, struct window *window, char *const *words, size_t count,
                      const struct script_command *command)
{
    struct call call = {.script = script,
                        .window = window,
                        .viewer = window->viewer,
                        .words = words,
                        .arguments = words + 1,
                        .count = count - 1};
    bool fits = call.count >= command->least && call.count <= command->most &&
                numbers(call.numbers, &call, 0, command->numbers);
    return fits &&
           (command->act ? command->act(&call) : property_set_words(window, command->sets, call.arguments, call.count));
}

bool script_do(struct window *window, char *const *words, size_t count)
{
    const struct script_command *command = find_command(words[0]);
    return command && (window->viewer || command->is_anywhere) && run_words(NULL, window, words, count, command);
}

int script_load(struct script **out, const char *path)
{
    struct script *script = calloc(1, sizeof *script);
    if (script) {
        script->path = strdup(path);
        script->file = system_stream(path, "r");
    }
    if (!script || !script->path || !script->file) {
        print_error_line("%s: cannot be opened", path);
        script_destroy(script);
        return EXIT_DATA;
    }
    *out = script;
    return EXIT_DONE;
}

void script_destroy(struct script *script)
{
    if (script) {
        if (script->file) {
            fclose(script->file);
        }
        free(script->path);
        free(script->awaited);
        free(script->state);
        free(script);
    }
}

static bool fail_line(const struct script *script, const char *what)
{
    print_error_line("%s:%u: %s", script->path, script->number, what);
    return false;
}

/* Runs the line that was read, of @p count words; false where it fails, with an error line. */
static bool run_line(struct script *script, struct window *window, char *const *words, size_t count)
{
    const struct script_command *command = find_command(words[0]);
    if (!command) {
        print_error_line("%s:%u: unknown command \"%s\"", script->path, script->number, words[0]);
        return false;
    }
    if (!window->viewer && !command->is_anywhere) {
        print_error_line("%s:%u: %s needs an atlas, and none is open", script->path, script->number, words[0]);
        return false;
    }
    bool fine = run_words(script, window, words, count, command);
    if (!fine) {
        print_error_line("%s:%u: %s %s is needed, or it could not be done", script->path, script->number, words[0],
                         command->arguments);
    }
    return fine;
}

bool script_waits(struct script *script, const struct window *window)
{
    double now = clock_ms();
    script->pausing = script->pausing && now < script->until;
    if (script->awaited && system_allows(script->awaited, 0)) {
        free(script->awaited);
        script->awaited = NULL;
    }
    if (script->state && (window_rests(window) || now >= script->until)) {
        script->is_unwritten =
            !state_write(window, script->state) && !fail_line(script, "state FILE.json: the file cannot be written");
        free(script->state);
        script->state = NULL;
    }
    bool unsettled = script->settling && !window_is_settled(window) && now < script->until;
    return script->pausing || script->awaited || script->state || unsettled;
}

/* Whether the frame was one to let pass. */
static bool let_pass(struct script *script, const struct window *window)
{
    if (script->waiting) {
        script->waiting -= !window->events.count; /* frames that take events come before */
        return true;
    }
    if (script->settling && window_is_settled(window)) {
        script->settling = --script->settled > 0;
        return script->settling;
    }
    return script->settling && clock_ms() < script->until;
}

/* Whether a line is about what the 3-D pane shows, which lags behind what is asked. */
static bool is_of_pane(const char *line)
{
    return strncmp(line, "figure ", strlen("figure ")) == 0 || strncmp(line, "picture ", strlen("picture ")) == 0;
}

bool script_step(struct script *script, struct window *window, int *code)
{
    char *words[SCRIPT_WORDS];
    size_t count = 0;
    if (script->is_unwritten) {
        *code = EXIT_DATA;
        return true;
    }
    if (let_pass(script, window)) {
        return false;
    }
    const bool is_new = !script->settling && !script->is_held;
    if (is_new && !fgets(script->line, sizeof script->line, script->file)) {
        return true;
    }
    script->number += is_new;
    script->is_held = is_new && is_of_pane(script->line) && window->viewer && !window_is_settled(window);
    if (script->is_held) {
        settle(script, 1);
        return false;
    }
    bool fine = script->settling ? fail_line(script, "the pictures were not fine after 600 s")
                : strlen(script->line) > LINE_LIMIT && script->line[LINE_LIMIT] != '\n'
                    ? fail_line(script, "more than 65536 bytes in a line")
                : !script_split(words, &count, script->line) ? fail_line(script, "more than 8 words")
                                                             : !count || run_line(script, window, words, count);
    *code = fine ? *code : EXIT_DATA;
    return !fine;
}
