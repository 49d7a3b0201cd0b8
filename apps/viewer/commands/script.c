/* SPDX-License-Identifier: BSD-3-Clause */
/* The commands of scripts, and their run over frames. */
#include "viewer/commands/script.h"

#include "options/messages.h"
#include "viewer/commands/script_add.h"
#include "viewer/commands/script_figure.h"
#include "viewer/commands/script_head.h"
#include "viewer/commands/script_look.h"
#include "viewer/commands/script_second.h"
#include "viewer/commands/script_sides.h"
#include "viewer/commands/script_study.h"
#include "viewer/commands/script_words.h"
#include "viewer/model/columns.h"
#include "viewer/model/question.h"
#include "viewer/model/search.h"
#include "viewer/session/session.h"
#include "viewer/tools/inputs.h"
#include "viewer/tools/point.h"
#include "viewer/window/window.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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
    char *awaited; /* a file that must be there before the next command; NULL = none */
};

/* What a command works on. */
struct call {
    struct script *script;
    struct window *window;
    char *words[SCRIPT_WORDS];
    size_t count; /* of arguments, without the command's name */
};

static bool numbers(double *out, const struct call *call, size_t first, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (first + i >= call->count || !script_number(&out[i], call->words[1 + first + i])) {
            return false;
        }
    }
    return true;
}

static bool is_done(conus_status status)
{
    if (status) {
        print_status(status);
    }
    return !status;
}

/* The commands: false where the arguments are wrong. */

static bool do_key(struct call *call)
{
    return window_press(call->window, call->words[1]);
}

static bool do_aim(struct call *call)
{
    double given[6];
    double direction[3];
    if (!numbers(given, call, 0, 6)) {
        return false;
    }
    struct viewer *viewer = call->window->viewer;
    if (!viewer_to_world(given, viewer, given) || !viewer_to_world(given + 3, viewer, given + 3)) {
        return is_done(CONUS_ERROR_ARGUMENT);
    }
    for (int a = 0; a < 3; a++) {
        direction[a] = given[3 + a] - given[a];
    }
    tool_aim_along(viewer, FIRST_TOOL, given, direction);
    return true;
}

static bool do_crosshair(struct call *call)
{
    double given[3];
    struct viewer *viewer = call->window->viewer;
    if (!numbers(given, call, 0, 3)) {
        return false;
    }
    return viewer_to_world(viewer->crosshair, viewer, given) || is_done(CONUS_ERROR_ARGUMENT);
}

static bool do_orbit(struct call *call)
{
    double given[2];
    if (!numbers(given, call, 0, 2)) {
        return false;
    }
    call->window->viewer->orbit.azimuth = given[0] * M_PI / 180;
    call->window->viewer->orbit.elevation = given[1] * M_PI / 180;
    return true;
}

static bool do_zoom(struct call *call)
{
    double clicks;
    bool fine = numbers(&clicks, call, 0, 1);
    if (fine) {
        orbit_zoom(&call->window->viewer->orbit, clicks);
    }
    return fine;
}

/* Points by the mouse at a place of the 3-D pane, parts of its width and height. */
static bool do_point(struct call *call)
{
    double part[2];
    double direction[3];
    struct sight sight;
    if (!numbers(part, call, 0, 2)) {
        return false;
    }
    window_sight(call->window, &sight);
    sight_ray(direction, &sight, (double[]){1, 1}, part);
    if (tool_moved_by(call->window->viewer, POINT_BY_MOUSE) == SECOND_TOOL) {
        inputs_point(&call->window->inputs, call->window->viewer, sight.camera.world_from_device + 12, direction);
    } else {
        point_through(call->window->viewer, sight.camera.world_from_device + 12, direction);
    }
    return true;
}

static bool do_add(struct call *call)
{
    return script_add(call->window, call->words, call->count);
}

static bool do_screen(struct call *call)
{
    return script_screen(call->window->viewer, call->words + 1);
}

static bool do_head(struct call *call)
{
    return script_head(call->window->viewer, call->words + 1, call->count);
}

static bool do_angle(struct call *call)
{
    double angle;
    bool fine = numbers(&angle, call, 0, 1) && angle > 0 && angle < 180;
    if (fine) {
        call->window->viewer->tools[FIRST_TOOL].angle = angle;
        viewer_reselect(call->window->viewer);
    }
    return fine;
}

static bool do_ask(struct call *call)
{
    return ask_words(call->window->viewer, call->words, 1 + (int)call->count);
}

static bool do_sweep(struct call *call)
{
    return script_sweep(call->window->viewer, call->words + 1, call->count);
}

static bool do_jitter(struct call *call)
{
    return script_jitter(call->window->viewer, call->words + 1, call->count);
}

static bool do_study(struct call *call)
{
    return script_study(call->window->viewer, call->words[1]);
}

static bool do_search(struct call *call)
{
    struct viewer *viewer = call->window->viewer;
    snprintf(viewer->drawn->shown.search, sizeof viewer->drawn->shown.search, "%s", call->count ? call->words[1] : "");
    return true;
}

static bool do_choose(struct call *call)
{
    uint32_t object = search_best(call->window->viewer->drawn->atlas, call->words[1]);
    viewer_choose(call->window->viewer, object);
    return object;
}

static bool do_pointer(struct call *call)
{
    for (int i = 0; i < POINTER_COUNT; i++) {
        if (strcmp(pointer_names[i], call->words[1]) == 0) {
            tool_choose(call->window->viewer, FIRST_TOOL, (enum pointer)i);
            return true;
        }
    }
    return false;
}

static bool do_speed(struct call *call)
{
    double speed;
    bool fine = numbers(&speed, call, 0, 1) && speed >= SOURCE_LEAST_SPEED && speed <= SOURCE_MOST_SPEED;
    if (fine) {
        devices_set_speed(&call->window->inputs.devices, speed);
        call->window->viewer->version++;
    }
    return fine;
}

static bool do_second(struct call *call)
{
    return script_second(call->window, (const char *const *)call->words + 1, call->count);
}

static bool do_quiet_status(struct call *call)
{
    call->window->quiet_status = true;
    return true;
}

static bool do_wait(struct call *call)
{
    double frames;
    bool fine = numbers(&frames, call, 0, 1) && frames >= 0 && frames < 1e6;
    call->script->waiting = fine ? (unsigned)frames : 0;
    return fine;
}

/* For programs that drive the window from outside. */
static bool do_until(struct call *call)
{
    free(call->script->awaited);
    call->script->awaited = strdup(call->words[1]);
    return call->script->awaited;
}

static bool do_settle(struct call *call)
{
    call->script->settling = true;
    call->script->settled = SETTLE_FRAMES;
    call->script->until = clock_ms() + settle_limit_ms;
    return true;
}

/* The window does what it does while nobody touches it. */
static bool do_pause(struct call *call)
{
    double seconds = 0;
    bool fine = numbers(&seconds, call, 0, 1) && seconds >= 0 && seconds <= 3600;
    call->script->pausing = fine;
    call->script->until = clock_ms() + 1e3 * seconds;
    return fine;
}

static bool do_screenshot(struct call *call)
{
    return is_done(window_write(call->window, call->words[1]));
}

/* The 3-D view as conus render draws it by itself, whatever the sheet of figures is. */
static bool do_picture(struct call *call)
{
    double size[2];
    bool fine = numbers(size, call, 1, 2) && size[0] >= 1 && size[1] >= 1 && size[0] <= PICTURE_LIMIT &&
                size[1] <= PICTURE_LIMIT;
    return fine && script_picture(call->window, call->words[1], size);
}

static bool do_save(struct call *call)
{
    char why[PROPERTY_REASON];
    bool fine = session_save(call->window, call->words[1], why);
    if (!fine) {
        print_error_line("%s", why);
    }
    return fine;
}

static bool do_open(struct call *call)
{
    char why[PROPERTY_REASON];
    bool fine = session_load(call->window, call->words[1], why);
    if (!fine) {
        print_error_line("%s", why);
    }
    return fine;
}

static bool do_times(struct call *call)
{
    return is_done(times_write(&call->window->times, call->words[1]));
}

static bool do_size(struct call *call)
{
    double size[2];
    bool fine = numbers(size, call, 0, 2) && size[0] >= 1 && size[1] >= 1 && size[0] <= PICTURE_LIMIT &&
                size[1] <= PICTURE_LIMIT;
    if (fine) {
        window_resize(call->window, (int)size[0], (int)size[1]);
    }
    return fine;
}

/* Widths of the panels, pixels at scale 1, and parts of the middle, all 0 as at first. */
static bool do_panes(struct call *call)
{
    double given[4] = {0};
    bool fine = numbers(given, call, 0, 4);
    struct layout layout = {.panels = {given[0], given[1]}, .division = {given[2], given[3]}};
    fine = fine && layout_is_fine(&layout);
    if (fine) {
        call->window->screen.layout = layout;
    }
    return fine;
}

/* What the list shows, as conus query would write it. */
static bool do_results(struct call *call)
{
    return is_done(viewer_write_results(call->window->viewer, FIRST_TOOL, call->words[1]));
}

static bool do_export(struct call *call)
{
    char why[EXPORT_WHY];
    bool fine = export_results(call->window->viewer, call->words[1], why);
    if (!fine) {
        print_error_line("%s", why);
    }
    return fine;
}

static bool do_columns(struct call *call)
{
    return result_choose(call->window->viewer, call->words + 1, call->count);
}

/* As a click above the column. */
static bool do_order(struct call *call)
{
    size_t column = result_find(call->words[1]);
    if (column < RESULT_COLUMNS) {
        result_order_by(call->window->viewer, column);
    }
    return column < RESULT_COLUMNS;
}

static const struct {
    const char *name;
    size_t least, most; /* arguments */
    bool (*act)(struct call *call);
    const char *arguments;
    bool at_start; /* needs no atlas */
} commands[] = {
    {"key", 1, 1, do_key, "KEY", true},
    {"drop", 1, SCRIPT_WORDS - 1, do_add, "PATH...", true},
    {"type", 1, 1, do_add, "PATH, on the start page or where a file is chosen", true},
    {"context", 1, 1, do_add, "FILE", false},
    {"pathway", 1, 1, do_add, "FILE[,threshold=T][,name=S][,volume=K] or FILE,band=LOW:HIGH:NAME", false},
    {"streamlines", 1, 1, do_add, "FILE[,radius=R][,name=S][,moves]", false},
    {"take-out", 1, 1, do_add, "FILE that was added", false},
    {"aim", 6, 6, do_aim, "X Y Z TX TY TZ", false},
    {"point", 2, 2, do_point, "RIGHT DOWN, parts of the 3-D pane", false},
    {"screen", 8, 8, do_screen, "X Y Z TX TY TZ WIDTH HEIGHT", false},
    {"head", 1, 3, do_head, "X Y Z, after screen, or lost", false},
    {"angle", 1, 1, do_angle, "DEGREES", false},
    {"ask", 0, SCRIPT_WORDS - 1, do_ask, "OPTION..., those of conus query that say how the cone asks", false},
    {"sweep", 1, 3, do_sweep, "LOW HIGH STEP, degrees, or off", false},
    {"jitter", 1, 3, do_jitter, "DEGREES MM [SAMPLES], or off", false},
    {"study", 1, 1, do_study, "FILE.tsv", false},
    {"pointer", 1, 1, do_pointer, "mouse|wand|replay|tracker|spacemouse|gamepad", false},
    {"speed", 1, 1, do_speed, "MM a second, 1 to 400", false},
    {"second", 1, 7, do_second, script_second_arguments, false},
    {"crosshair", 3, 3, do_crosshair, "X Y Z", false},
    {"orbit", 2, 2, do_orbit, "AZIMUTH ELEVATION, degrees", false},
    {"zoom", 1, 1, do_zoom, "CLICKS", false},
    {"search", 0, 1, do_search, "[TEXT]", false},
    {"choose", 1, 1, do_choose, "NAME", false},
    {"quiet-status", 0, 0, do_quiet_status, "", true},
    {"wait", 1, 1, do_wait, "FRAMES", true},
    {"pause", 1, 1, do_pause, "SECONDS", true},
    {"settle", 0, 0, do_settle, "", true},
    {"until", 1, 1, do_until, "FILE", true},
    {"screenshot", 1, 1, do_screenshot, "FILE.png", true},
    {"picture", 3, 3, do_picture, "FILE.png WIDTH HEIGHT", false},
    {"results", 1, 1, do_results, "FILE.tsv", false},
    {"export", 1, 1, do_export, "FILE.tsv|csv|json", false},
    {"columns", 0, SCRIPT_WORDS - 1, do_columns, "[NAME] ..., columns of conus query's tables", false},
    {"order", 1, 1, do_order, "NAME, a column of conus query's tables", false},
    {"times", 1, 1, do_times, "FILE.json", true},
    {"size", 2, 2, do_size, "WIDTH HEIGHT", true},
    {"panes", 4, 4, do_panes, "LEFT RIGHT COLUMN ROW", true},
    {"save", 1, 1, do_save, "FILE.json", false},
    {"open", 1, 1, do_open, "FILE.json", false},
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

/* Those that need an atlas, and nothing of the script. */
static const struct {
    const char *name;
    size_t least, most;
    bool (*use)(struct window *window, char *const *arguments, size_t count);
    const char *arguments;
} uses[] = {
    {"fade", 1, 1, script_fade, "PART"},
    {"hemispheres", 1, 1, script_hemispheres, "as-is|split|merged"},
    {"side", 1, 1, script_side, "both|left|right, of an atlas that has sides"},
    {"threshold", 2, 2, script_threshold, "PATHWAY VALUE"},
    {"grey", 0, 2, script_grey, "[BLACK WHITE], with a context"},
    {"opacity", 1, 2, script_opacity, "[AREA] PART, or AREA reset"},
    {"haze", 2, 2, script_haze, "PATHWAY solid|own|PRESET"},
    {"preset", 0, 1, script_preset, "[NAME]"},
    {"streamline-colour", 1, 1, script_streamlines, "bundle|direction|NAME"},
    {"background", 1, 1, script_background, "light|white|black|transparent"},
    {"sheet", 2, 3, script_sheet, "pixels|mm WIDTH HEIGHT, dpi N, legend inside|right|below|none, text on|off"},
    {"figure", 1, 2, script_figure, "FILE.png [3d|axial|coronal|sagittal]"},
};
enum { USES = sizeof uses / sizeof uses[0] };

int script_load(struct script **out, const char *path)
{
    struct script *script = calloc(1, sizeof *script);
    if (script) {
        script->path = strdup(path);
        script->file = fopen(path, "r");
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
        free(script);
    }
}

/* False, and said why, where one needs an atlas and there is none. */
static bool has_atlas(const struct call *call)
{
    bool has = call->window->viewer;
    if (!has) {
        print_error_line("%s:%u: %s needs an atlas, and none is open", call->script->path, call->script->number,
                         call->words[0]);
    }
    return has;
}

static bool refuse(const struct call *call, const char *arguments)
{
    print_error_line("%s:%u: %s %s is needed, or it could not be done", call->script->path, call->script->number,
                     call->words[0], arguments);
    return false;
}

static bool act(struct call *call)
{
    for (size_t i = 0; i < COMMANDS; i++) {
        if (strcmp(commands[i].name, call->words[0]) == 0) {
            bool fits = call->count >= commands[i].least && call->count <= commands[i].most;
            return (commands[i].at_start || has_atlas(call)) &&
                   ((fits && commands[i].act(call)) || refuse(call, commands[i].arguments));
        }
    }
    for (size_t i = 0; i < USES; i++) {
        if (strcmp(uses[i].name, call->words[0]) == 0) {
            bool fits = call->count >= uses[i].least && call->count <= uses[i].most;
            return has_atlas(call) && ((fits && uses[i].use(call->window, call->words + 1, call->count)) ||
                                       refuse(call, uses[i].arguments));
        }
    }
    print_error_line("%s:%u: unknown command \"%s\"", call->script->path, call->script->number, call->words[0]);
    return false;
}

bool script_waits(struct script *script, const struct window *window)
{
    double now = clock_ms();
    script->pausing = script->pausing && now < script->until;
    if (script->awaited && !access(script->awaited, F_OK)) {
        free(script->awaited);
        script->awaited = NULL;
    }
    bool unsettled = script->settling && !window_is_settled(window) && now < script->until;
    return script->pausing || script->awaited || unsettled;
}

/* Whether the frame was one to let pass. */
static bool let_pass(struct script *script, const struct window *window)
{
    if (script->waiting) {
        script->waiting--;
        return true;
    }
    if (script->settling && window_is_settled(window)) {
        script->settling = --script->settled > 0;
        return script->settling;
    }
    return script->settling && clock_ms() < script->until;
}

static bool fail_line(struct script *script, int *code, const char *what)
{
    print_error_line("%s:%u: %s", script->path, script->number, what);
    *code = EXIT_DATA;
    return true;
}

bool script_step(struct script *script, struct window *window, int *code)
{
    struct call call = {.script = script, .window = window};
    size_t words;
    if (let_pass(script, window)) {
        return false;
    }
    if (script->settling) {
        return fail_line(script, code, "the pictures were not fine after 600 s");
    }
    if (!fgets(script->line, sizeof script->line, script->file)) {
        return true;
    }
    script->number++;
    if (strlen(script->line) > LINE_LIMIT && script->line[LINE_LIMIT] != '\n') {
        return fail_line(script, code, "more than 65536 bytes in a line");
    }
    if (!script_split(call.words, &words, script->line)) {
        return fail_line(script, code, "more than 8 words");
    }
    call.count = words ? words - 1 : 0;
    if (words && !act(&call)) {
        *code = EXIT_DATA;
        return true;
    }
    return false;
}
