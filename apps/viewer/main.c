/* SPDX-License-Identifier: BSD-3-Clause */
/* conus-view: the window. Its options are read and explained by the same tables as those of conus. */
#include "base/system/system.h"
#include "conus/own.h"
#include "options/messages.h"
#include "pages/pages.h"
#include "settings/settings.h"
#include "viewer/commands/commands.h"
#include "viewer/loop.h"
#include "viewer/opening/opening.h"

#include <stdio.h>
#include <string.h>

enum { DEFAULT_WIDTH = 1500, DEFAULT_HEIGHT = 940 };

static const char *const themes[] = {"auto", "dark", "light", NULL};

static const struct option own_options[] = {
    {OPTION_VALUED("size", struct view_settings, size, "WxH"), .help = "size of the window, pixels",
     .otherwise = "1500x940, no larger than the screen", .low = 1, .high = 16384, .unit = "pixels"},
    {OPTION_VALUED("scale", struct view_settings, scale, "FACTOR"), .help = "scale of texts and panels, 0.5 to 4",
     .otherwise = "the screen's", .low = 0.5, .high = 4},
    {OPTION_VALUED("session", struct view_settings, session, "FILE.json"),
     .help = "open as a saved session was left; without ATLAS its own atlas, with the options that it had",
     OPTION_READING(SESSION)},
    {OPTION_VALUED("script", struct view_settings, script, "FILE"),
     .help = "do what the file says (docs/viewer.md), then close", OPTION_READING(TEXT)},
    {OPTION_NAMED("safe-colours", struct view_settings, safe_colours),
     .help = "colours for any colour vision, instead of the atlas's own"},
    {OPTION_VALUED("theme", struct view_settings, theme, "NAME"),
     .help = "colours of panels, auto by the desktop's setting (with --script dark):", .choices = themes},
    {OPTION_NAMED("full-screen", struct view_settings, full_screen),
     .help = "start with the 3-D pane alone, over the screen that the window was on (F11)"},
    {OPTION_NAMED("hidden", struct view_settings, hidden),
     .help = "with --script: do not show the window (it still needs a display)", .needs = "script"},
    {0},
};

static const struct option_group groups[] = {
    {"What is shown", context_choice_options, offsetof(struct view_settings, context)},
    {"", map_options, offsetof(struct view_settings, context)},
    {"", scene_options, 0},
    {"", own_options, 0},
    {"", atlas_options, offsetof(struct view_settings, atlas)},
    {"", side_options, offsetof(struct view_settings, atlas)},
    {"", shown_options, offsetof(struct view_settings, atlas)},
    {"", more_atlas_options, offsetof(struct view_settings, atlas)},
    {"", space_options, offsetof(struct view_settings, space)},
    {"A plan: what must hold, all of it, wherever the first tool is", constraint_options,
     offsetof(struct view_settings, constraints)},
    {"", shank_options, offsetof(struct view_settings, constraints)},
    {"", needle_options, 0},
    {"A tracker that points", station_options_table, offsetof(struct view_settings, station)},
    {"A second tool", second_options_table, offsetof(struct view_settings, station)},
    {"A tracked head", screen_options_table, offsetof(struct view_settings, station)},
    {"", quiet_options, offsetof(struct view_settings, common)},
    {0},
};

/* Atlases one after the other, with the start page before and between them. It says, too, why ATLAS cannot be opened:
 * where a desktop has started the program nobody sees stderr. */
static int run_window(struct window *window, const struct view_settings *settings, const char *path,
                      struct script *script, double started)
{
    int code = EXIT_DONE;
    bool failed = false;
    struct view_settings later = *settings;
    later.session = NULL; /* it is for the first, or waits for its atlas */
    window->press = keys_press;
    window->wake = loop_wake;
    window->files.remembers = !script;
    if (path || settings->session) {
        window_request_file(window, path ? path : settings->session);
    }
    if (window_has_request(window) && !open_requested(window, settings, true, started, &failed) &&
        !window_has_request(window) && failed) {
        code = EXIT_DATA;
    }
    if (window->start.on) {
        start_look(&window->start);
    }
    while (!(code && script) && loop_run(window, script, &code)) {
        const bool is_needed = window->files.requested.is_needed;
        open_requested(window, &later, !path && !window->viewer, clock_ms(), &failed);
        code = is_needed && failed ? EXIT_DATA : code;
    }
    open_finish(window);
    return code;
}

static int start_sources(struct window *window, const struct view_settings *settings)
{
    struct inputs *inputs = &window->inputs;
    inputs->asked = &settings->station;
    snprintf(inputs->address, sizeof inputs->address, "%s", settings->station.connect ? settings->station.connect : "");
    int code = station_settings_start(&inputs->station, &settings->station);
    if (inputs->station) {
        station_on_pose(inputs->station, loop_wake);
    }
    code = code ? code : station_settings_start_second(&inputs->second_station, &settings->station);
    if (inputs->second_station) {
        station_on_pose(inputs->second_station, loop_wake);
    }
    inputs->has_second_tool = settings->station.second_tool;
    if (code || !settings->poses || constraints_are_given(settings->arguments) ||
        space_settings_needs_atlas(&settings->space)) {
        return code; /* open.c loads the poses, once it knows the atlas */
    }
    conus_frame frame;
    code = space_settings_frame(&frame, &(struct atlases){0}, &settings->space, true);
    return code ? code : open_poses(window, settings, &frame);
}

/* Refuses constraints, candidates and a list before there is a window. */
static int check_files(const char *pose, const char *poses, const struct arguments *arguments)
{
    struct constraints constraints;
    conus_pose_stream *stream = NULL;
    conus_status status = CONUS_OK;
    int code = constraints_parse(&constraints, arguments);
    for (size_t i = 0; i < constraints.count && !code; i++) {
        if (constraints.items[i].kind == CONUS_CONSTRAINT_ENTRY_ANGLE) {
            code =
                print_usage_error("--entry-angle is for candidates of conus plan: a tool has no normal at its entry");
        }
    }
    if (!code && constraints.count && poses && strcmp(poses, "-") == 0) {
        code = print_usage_error("--poses -: the window reads candidates more than once, so they have to be a file");
    } else if (!code && pose && strcmp(pose, "-") == 0) {
        code = print_usage_error("--pose -: the window reads the list more than once, so it has to be a file");
    } else if (!code && constraints.count && poses) {
        status = conus_pose_stream_open(&stream, poses, NULL);
        conus_pose_stream_destroy(stream);
    }
    constraints_finish(&constraints);
    return status ? pose_settings_print_error(status, poses, "poses", arguments) : code;
}

/* Scripts see the same window everywhere. */
static void find_window_options(struct window_options *out, const struct view_settings *settings)
{
    *out = (struct window_options){.place = {.width = DEFAULT_WIDTH, .height = DEFAULT_HEIGHT},
                                   .scale = settings->scale,
                                   .theme = settings->theme    ? (enum theme)(settings->theme - 1)
                                            : settings->script ? THEME_DARK
                                                               : desktop_theme(),
                                   .hidden = settings->hidden,
                                   .fits_screen = !settings->script};
    if (!settings->script) {
        place_load(&out->place);
    }
    if (settings->size[0]) {
        out->place.width = (int)settings->size[0];
        out->place.height = (int)settings->size[1];
    }
}

/* The atlas is read while the display makes the window. False: nothing is open. */
static bool open_window(struct window *out, const struct window_options *options, const char *path,
                        const struct view_settings *settings)
{
    bool has_display = window_find_display();
    struct loader *begun = has_display ? open_begin(path, settings) : NULL;
    bool fine = has_display && window_open(out, options);
    out->files.begun = begun;
    if (fine) {
        events_hear(out);
    } else {
        wait_leave(out);
        print_error_line("conus view needs a display and OpenGL 4.5; conus render draws pictures without a window");
    }
    return fine;
}

static int run_view(const void *given, const struct arguments *arguments)
{
    struct tract_shelf shelf = {0}; /* what is opened again is not read again */
    struct view_settings own = *(const struct view_settings *)given;
    const struct view_settings *settings = &own;
    own.atlas.shelf = &shelf;
    double started = clock_ms();
    struct script *script = NULL;
    struct window window;
    struct window_options options;
    if (!station_settings_check_second(&settings->station, arguments) ||
        !space_settings_check(arguments, &settings->space) ||
        !station_settings_check_screen(&settings->station, arguments)) {
        return EXIT_USAGE;
    }
    int code = check_files(settings->pose, settings->poses, arguments);
    code = code || !settings->script ? code : script_load(&script, settings->script);
    if (code) {
        return code;
    }
    find_window_options(&options, settings);
    if (!open_window(&window, &options, arguments->operands[0], settings)) {
        tract_shelf_finish(&shelf);
        script_destroy(script);
        return EXIT_NO_GL;
    }
    times_start(&window.times, started);
    code = start_sources(&window, settings);
    code = code ? code : run_window(&window, settings, arguments->operands[0], script, started);
    station_stop(window.inputs.station);
    station_stop(window.inputs.second_station);
    conus_pose_list_destroy(window.inputs.replay.poses);
    if (!code && !settings->script) {
        struct place place;
        window_place(&window, &place);
        if (options.scale > 0) { /* keys changed that one */
            place.zoom = options.place.zoom;
        }
        place_save(&place);
    }
    window_close(&window);
    tract_shelf_finish(&shelf);
    script_destroy(script);
    return code;
}

static const struct command cmd_view = {
    .name = "view",
    .summary = "browse an atlas in a window and point at it",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .optional = true,
    .resumes = true,
    .description =
        "Four panes: the brain in 3-D and its axial, coronal and sagittal cuts. The cone follows the mouse, from the\n"
        "surface under it, or a wand moved by keys; the areas that it hits are named, ranked and highlighted. A click\n"
        "holds it, Escape clears it. Press ? in the window for the keys.\n\n"
        "Without ATLAS the window opens with a page that lists the installed atlases (conus atlases), which can be\n"
        "searched by name, and what was opened lately. Drop a file or a folder on it, or type a path. Drop a "
        "tractogram\n"
        "or an image on an atlas that is open: bundles and a context are added to it.",
    .examples =
        "  conus view aal --context ch2bet.nii.gz --depth 70 --reach Hippocampus_L --avoid Insula_L,margin=2\n"
        "  conus view /usr/share/mricron/templates/aal.nii.gz --context /usr/share/mricron/templates/ch2bet.nii.gz\n"
        "  conus view aal --atlas /usr/share/mricron/templates/brodmann.nii.gz\n",
    .groups = groups,
    .settings_size = sizeof(struct view_settings),
};

int main(int count, char **words)
{
    static const struct command *const commands[] = {&cmd_view, NULL};
    static const struct program program = {.name = "conus-view", .commands = commands};
    struct arguments arguments;
    struct view_settings settings = {0};
    int code;
    system_begin(&count, &words, false); /* a file that may not grow is an error of writing */
    if (pages_answer(&code, &program, count, words)) {
        return code;
    }
    code = options_parse(&arguments, &settings, &cmd_view, NULL, count, words, 1);
    if (code < 0 && !(code = print_status(conus_inputs_keep()))) {
        settings.arguments = &arguments;
        conus_inputs_add(settings.script);
        code = run_view(&settings, &arguments);
    }
    options_finish(&settings, &arguments);
    return code;
}
