/* SPDX-License-Identifier: BSD-3-Clause */
/* The options of trackers and of a tracked screen, and the start of a station. */
#include "settings/settings.h"

#include "options/messages.h"
#include "options/options.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ADDRESS_SIZE = 256 };

/* In the order of conus_axis, whose first is -z here. */
static const char *const axes[] = {"-z", "+x", "-x", "+y", "-y", "+z", NULL};

const struct option station_options_table[] = {
    {OPTION_VALUED("listen", struct station_settings, listen, "[ADDRESS:]PORT"),
     .help =
         "wait for a tracker that sends OpenIGTLink, as a server; its usual port is 18944, and without an address only "
         "this machine may connect",
     .role = OPTION_LIVE, .excludes = "connect"},
    {OPTION_VALUED("connect", struct station_settings, connect, "HOST[:PORT]"),
     .help = "or connect to one as a client (default port 18944); tries again until the tracker answers",
     .role = OPTION_LIVE},
    {OPTION_VALUED("tool", struct station_settings, tool, "NAME"),
     .help = "the tool that points, as the tracker calls it (Pointer, or PointerToTracker)",
     .otherwise = "the first that comes"},
    {OPTION_VALUED("reference", struct station_settings, reference, "NAME"),
     .help = "poses are relative to this tool, for instance one on the head"},
    {OPTION_VALUED("tool-axis", struct station_settings, axis, "AXIS"),
     .help = "axis of the tool along which it points:", .choices = axes},
    {OPTION_VALUED("world-from-tracker", struct station_settings, world_from_tracker, "FILE"),
     .help = "4x4 matrix, rows of four numbers, from the tracker's (or the reference's) mm to the atlas's mm",
     .holds = HOLDS_TRANSFORM},
    {OPTION_NAMED("tracker-lps", struct station_settings, lps),
     .help = "the tracker's positions are LPS: x to the left, y to the back"},
    {OPTION_VALUED("enlarge", struct station_settings, enlarged, "FACTOR"),
     .help = "show the brain enlarged by this factor about the atlas's origin: poses are moved nearer to the origin by "
             "the same factor",
     OPTION_FROM_TO(0.001, 1000)},
    {0},
};

const struct option screen_options_table[] = {
    {OPTION_VALUED("head", struct station_settings, head, "NAME"),
     .help = "the tool on the viewer's head: the 3-D pane shows what this eye sees through the screen",
     .needs = "screen-mm"},
    {OPTION_VALUED("screen-mm", struct station_settings, screen_mm, "WxH"), .help = "size of the whole screen, mm",
     OPTION_FROM_TO(1, 1000000), .needs = "head", .unit = "mm"},
    {OPTION_VALUED("screen-pose", struct station_settings, screen_pose, "FILE"),
     .help =
         "4x4 matrix from the screen's mm (origin in its middle, x right, y up, z to the viewer) to the tracker's mm",
     .otherwise = "the identity", .needs = "head", .holds = HOLDS_TRANSFORM},
    {OPTION_VALUED("eye", struct station_settings, eye, "X,Y,Z"),
     .help = "position of the eye in the head tool's frame, mm", .standard = "0,0,0", .needs = "head", .unit = "mm"},
    {0},
};

const struct option second_options_table[] = {
    {OPTION_VALUED("second-tool", struct station_settings, second_tool, "NAME"),
     .help = "another tool that points, with a cone and a list of its own: of the same tracker, or of the one of "
             "--second-listen or --second-connect",
     .otherwise = "the first that comes there"},
    {OPTION_VALUED("second-listen", struct station_settings, second_listen, "[ADDRESS:]PORT"),
     .help = "wait for the second tool's own tracker, as with --listen", .excludes = "second-connect"},
    {OPTION_VALUED("second-connect", struct station_settings, second_connect, "HOST[:PORT]"),
     .help = "or connect to it, as with --connect"},
    {OPTION_VALUED("second-world-from-tracker", struct station_settings, second_world_from_tracker, "FILE"),
     .help = "4x4 matrix of that tracker", .otherwise = "that of --world-from-tracker", .holds = HOLDS_TRANSFORM},
    {0},
};

/* Cuts "address:port" in two; a port alone is one where @p port_alone. */
static bool split_address(char address[ADDRESS_SIZE], uint16_t *port, const char *text, bool port_alone)
{
    uint64_t number = STATION_PORT;
    const char *colon = strrchr(text, ':');
    const char *digits = colon ? colon + 1 : port_alone ? text : NULL;
    size_t length = colon ? (size_t)(colon - text) : port_alone ? 0 : strlen(text);
    if (length >= ADDRESS_SIZE || (digits && (!count_parse(digits, UINT16_MAX, &number) || number == 0))) {
        return false;
    }
    memcpy(address, text, length);
    address[length] = '\0';
    *port = (uint16_t)number;
    return true;
}

/* Where a station listens or connects to, and its option's prefix. */
struct end {
    const char *listen, *connect, *prefix;
};

static struct end end_of(const struct station_settings *settings, bool is_second)
{
    return is_second ? (struct end){settings->second_listen, settings->second_connect, "second-"}
                     : (struct end){settings->listen, settings->connect, ""};
}

static bool check_address(const struct end *end)
{
    char address[ADDRESS_SIZE];
    uint16_t port;
    const char *given = end->listen ? end->listen : end->connect;
    bool fine = !given || (split_address(address, &port, given, end->listen) && (end->listen || address[0]));
    if (!fine) {
        print_error_line("--%s%s: \"%s\" is no address and port", end->prefix, end->listen ? "listen" : "connect",
                         given);
    }
    return fine;
}

bool station_settings_check(const struct station_settings *settings, const struct arguments *arguments)
{
    const struct end end = end_of(settings, false);
    bool given = option_given(arguments, "listen") || option_given(arguments, "connect");
    for (const struct option *option = station_options_table; !given && option->name; option++) {
        if (option_given(arguments, option->name)) {
            return refuse("--%s needs --listen or --connect with it", option->name);
        }
    }
    return check_address(&end);
}

bool station_settings_check_second(const struct station_settings *settings, const struct arguments *arguments)
{
    const char *others[] = {settings->tool, settings->reference, settings->head};
    static const char *const names[] = {"tool", "reference", "head"};
    bool is_alone = settings->second_listen || settings->second_connect;
    bool first = option_given(arguments, "listen") || option_given(arguments, "connect");
    for (size_t i = 0; settings->second_tool && !is_alone && i < 3; i++) {
        if (others[i] && strcmp(settings->second_tool, others[i]) == 0) {
            return refuse("--second-tool: %s is the --%s", settings->second_tool, names[i]);
        }
    }
    if (is_alone) {
        /* The second tool's own tracker uses all options of the first one but the name. */
        if (settings->tool && !first) {
            return refuse("--tool needs --listen or --connect with it");
        }
        const struct end ends[] = {end_of(settings, false), end_of(settings, true)};
        return check_address(&ends[0]) && check_address(&ends[1]);
    }
    if (settings->second_tool && !first) {
        return refuse("--second-tool needs --listen, --connect, --second-listen or --second-connect with it");
    }
    if (settings->second_world_from_tracker) {
        return refuse("--second-world-from-tracker needs --second-listen or --second-connect with it");
    }
    return station_settings_check(settings, arguments);
}

bool station_settings_check_screen(const struct station_settings *settings, const struct arguments *arguments)
{
    const char *others[] = {settings->tool, settings->reference};
    for (size_t i = 0; settings->head && i < 2; i++) {
        if (others[i] && strcmp(settings->head, others[i]) == 0) {
            return refuse("--head: %s is the --%s", settings->head, i ? "reference" : "tool");
        }
    }
    if (settings->head && !option_given(arguments, "listen") && !option_given(arguments, "connect")) {
        return refuse("--head needs --listen or --connect with it");
    }
    return true;
}

static int read_matrix(double out[16], const char *path)
{
    conus_pose_list *list = NULL;
    const conus_pose_options options = {.format = "matrix"};
    conus_status status = conus_pose_list_load(&list, path, &options);
    if (status) {
        return print_status(status);
    }
    const conus_pose_row *row = conus_pose_list_row(list, 0);
    int code = EXIT_DONE;
    if (row->error) {
        code = print_data_error("%s: %s", path, row->error);
    }
    memcpy(out, row->pose.world_from_device, sizeof row->pose.world_from_device);
    conus_pose_list_destroy(list);
    return code;
}

/* Starts the station of one end, if it has any. `options` has its tool and what only this station needs. */
static int start_at(struct station **out, const struct end *end, const struct station_settings *settings,
                    const char *world_from_tracker, struct station_options options)
{
    char address[ADDRESS_SIZE];
    char why[256];
    if (!end->listen && !end->connect) {
        return EXIT_DONE;
    }
    bool fine = split_address(address, &options.port, end->listen ? end->listen : end->connect, end->listen);
    assert(fine && "check_address()");
    (void)fine;
    options.listen = end->listen && address[0] ? address : NULL;
    options.host = end->connect ? address : NULL;
    options.reference = settings->reference;
    options.enlarged = settings->enlarged;
    options.lps = settings->lps;
    options.axis = (conus_axis)settings->axis;
    int code = settings->screen_pose && options.head ? read_matrix(options.tracker_from_screen, settings->screen_pose)
                                                     : EXIT_DONE;
    if (!code && world_from_tracker) {
        code = read_matrix(options.world_from_tracker, world_from_tracker);
    }
    return code || station_start(out, &options, why, sizeof why) ? code : print_data_error("%s", why);
}

int station_settings_start(struct station **out, const struct station_settings *settings)
{
    const struct end end = end_of(settings, false);
    bool is_alone = settings->second_listen || settings->second_connect;
    return start_at(out, &end, settings, settings->world_from_tracker,
                    (struct station_options){.tool = settings->tool,
                                             .second = is_alone ? NULL : settings->second_tool,
                                             .head = settings->head,
                                             .eye = {settings->eye[0], settings->eye[1], settings->eye[2]}});
}

int station_settings_connect(struct station **out, const struct station_settings *settings, const char *address)
{
    struct station_settings with = *settings;
    with.listen = NULL;
    with.connect = address;
    const struct end end = end_of(&with, false);
    return check_address(&end) ? station_settings_start(out, &with) : EXIT_USAGE;
}

int station_settings_start_second(struct station **out, const struct station_settings *settings)
{
    const struct end end = end_of(settings, true);
    const char *matrix = settings->second_world_from_tracker;
    return start_at(out, &end, settings, matrix ? matrix : settings->world_from_tracker,
                    (struct station_options){.tool = settings->second_tool});
}

void station_settings_text(char *out, size_t size, struct station *station, const struct station_update *update)
{
    static const char *const states[] = {"waiting for a connection", "connected, no pose of the tool yet",
                                         "the tool is lost", "no pose for half a second", "tracking"};
    bool failed = update->state == STATION_WAITING && update->trouble;
    const char *host = station_host(station);
    int used = snprintf(out, size, "%s%s%s on port %u%s%s", failed ? "no answer yet" : states[update->state],
                        host ? " from " : "", host ? host : "", station_port(station), failed ? ": " : "",
                        failed ? update->trouble : "");
    unsigned long long bad = update->counts.broken + update->counts.refused + update->dropped;
    if (bad && used > 0 && (size_t)used < size) {
        snprintf(out + used, size - (size_t)used, "; %llu messages or poses dropped%s", bad,
                 update->counts.mirrored ? ", mirrored poses among them" : "");
    }
}
