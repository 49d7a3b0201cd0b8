/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads an atlas, or several, while the window says how far that is, and puts it in place of what was open before. */
#include "viewer/open.h"

#include "common/messages.h"
#include "settings/atlas_name.h"
#include "settings/atlas_notes.h"
#include "viewer/added.h"
#include "viewer/hands/hands.h"
#include "viewer/loop.h"
#include "viewer/open_all.h"
#include "viewer/open_parts.h"
#include "viewer/reload.h"
#include "viewer/reopen.h"
#include "viewer/session/session.h"
#include "viewer/session/undo.h"
#include "viewer/window/screen.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Between two looks at how far loading is. */
static const double progress_s = 0.1;

/* ---- Loading ----------------------------------------------------------------------------------------------------- */

/* What is read, and a bar of the files that are. */
static void draw_progress(const struct window *window, const struct loader_progress *progress, double seconds)
{
    static const ui_colour light = {235, 235, 240, 255};
    static const ui_colour dim = {255, 255, 255, 25};
    static const ui_colour full = {66, 150, 250, 255};
    float line = ui_line();
    float wide = fminf(420 * window->scale, 0.8F * (float)window->width);
    struct ui_box bar = {((float)window->width - wide) / 2, (float)window->height / 2, wide, 0.4F * line};
    char text[160];
    snprintf(text, sizeof text, "reading %s   %.1f s", progress->file, seconds);
    ui_draw_text((float[]){bar.x + 3, bar.y - 1.5F * line}, light, text);
    ui_draw_text((float[]){bar.x + 3, bar.y + line}, light,
                 window->stops ? "Escape: this file is the last one that is read" : "Escape ends that");
    ui_draw_box(bar, dim, 0);
    bar.width *= (float)progress->part;
    ui_draw_box(bar, full, 0);
}

static void draw_loading(struct window *window, struct loader *loader, double seconds)
{
    struct loader_progress progress;
    loader_ask(loader, &progress);
    window_lay_out(window);
    window_clear(window);
    ui_begin();
    ui_panel("loading", (struct ui_box){0, 0, (float)window->width, (float)window->height}, UI_PLAIN);
    draw_progress(window, &progress, seconds);
    ui_panel_end();
    ui_end();
    glfwSwapBuffers(window->handle);
}

/* All that keys do meanwhile. */
static bool press_while_loading(struct window *window, const char *key)
{
    bool ends = strcmp(key, "escape") == 0;
    window->stops = window->stops || ends;
    return ends;
}

/* Waits with the window open. False: nobody wants them any more, or `why` has the reason. */
bool open_load(struct window *window, const struct loading *what, struct atlases *out, char why[LOADER_WHY])
{
    struct loader *loader = NULL;
    double begun = glfwGetTime();
    if (!loader_start(&loader, what)) {
        print_error_line("not enough memory");
        snprintf(why, LOADER_WHY, "not enough memory");
        return false;
    }
    window->press = press_while_loading;
    window->stops = false;
    while (!loader_done(loader) && !glfwWindowShouldClose(window->handle)) {
        if (window_wants(window) || window->stops) {
            loader_cancel(loader);
        }
        draw_loading(window, loader, glfwGetTime() - begun);
        glfwWaitEventsTimeout(progress_s);
    }
    if (glfwWindowShouldClose(window->handle)) { /* the file that is being read is read to its end */
        loader_cancel(loader);
        glfwHideWindow(window->handle);
    }
    window->press = NULL;
    bool fine = loader_finish(loader, out, why);
    if (!fine && !why[0] && window->stops) {
        snprintf(why, LOADER_WHY, "not read: Escape ended that");
    }
    return fine;
}

/* ---- Opening ----------------------------------------------------------------------------------------------------- */

static void set_head(struct head *head, const struct station_settings *settings)
{
    double enlarged = settings->enlarged > 0 ? settings->enlarged : 1;
    head->named = head->on = settings->head;
    head->size[0] = settings->screen_mm[0] / enlarged; /* in the world */
    head->size[1] = settings->screen_mm[1] / enlarged;
}

static void finish(struct viewer *viewer)
{
    if (viewer) {
        viewer_finish(viewer);
        free(viewer);
    }
}

static void prepare(const struct atlases *atlases, const struct view_settings *settings)
{
    for (size_t i = 0; i < atlases->count && settings->safe_colours; i++) {
        conus_atlas_use_safe_colours(atlases->items[i].atlas);
    }
    atlases_say_notes(atlases, &settings->common);
    atlases_say_spaces(atlases, &settings->common);
}

static struct viewer *create(const struct atlases *atlases, const char *path, const struct view_settings *settings)
{
    struct viewer *viewer = malloc(sizeof *viewer);
    struct view_source *sources = calloc(atlases->count, sizeof *sources);
    for (size_t i = 0; sources && i < atlases->count; i++) {
        sources[i] = (struct view_source){.atlas = atlases->items[i].atlas,
                                          .path = i ? settings->atlas.more.items[i - 1] : path,
                                          .name = atlases->items[i].name};
    }
    if (!viewer || !sources ||
        viewer_create(viewer, sources, atlases->count, settings->transfer, settings->common.verbose ? log_line : NULL,
                      loop_wake)) {
        print_error_line("not enough memory");
        free(viewer);
        viewer = NULL;
    } else {
        viewer->display.safe_colours = settings->safe_colours;
        set_head(&viewer->head, &settings->station);
    }
    free(sources);
    return viewer;
}

int open_poses(struct window *window, const struct view_settings *settings, const conus_frame *frame)
{
    const conus_pose_options options = {.max_memory = settings->atlas.max_memory, .frame = frame};
    conus_status status = conus_pose_list_load(&window->replay.poses, settings->poses, &options);
    if (status) {
        return print_status(status);
    }
    if (!conus_pose_list_count(window->replay.poses)) {
        print_error_line("%s: no poses in it to replay", settings->poses);
        return EXIT_DATA;
    }
    return EXIT_DONE;
}

/* In which space positions are typed and shown; and the poses that need it. False with an error line. */
static bool find_frame(conus_frame *frame, struct window *window, const struct atlases *atlases,
                       const struct view_settings *settings)
{
    bool waits = settings->poses && !window->replay.poses;
    int code = settings_frame(frame, atlases, &settings->space, settings->common.quiet);
    code = code || !waits ? code : open_poses(window, settings, frame);
    return code == EXIT_DONE;
}

/* Shows it as the options say; false where the session does not fit. */
static bool show(struct window *window, struct viewer *viewer, const struct view_settings *settings, char *why)
{
    window_show(window, viewer);
    viewer->cone.pointer = window->station ? POINT_BY_TRACKER : window->replay.poses ? POINT_BY_REPLAY : POINT_BY_MOUSE;
    if (window->second_station || window->has_second_tool) {
        hands_choose(window, SECOND_HAND, POINT_BY_TRACKER);
        second_use(&window->second, viewer, true);
    }
    if (window->replay.poses) {
        replay_show(&window->replay, viewer, 0);
    }
    if (settings->session && !session_load(window, settings->session, why)) {
        print_error_line("%s", why);
        return false;
    }
    if (settings->full_screen) {
        window_fill_screen(window, true);
    }
    return true;
}

/* For sessions; the catalogue's labels, too. */
static json_t *describe(const struct viewer *viewer, const struct atlas_name *name,
                        const struct view_settings *settings)
{
    const char *labels = settings->atlas.labels ? NULL : atlas_name_labels(name, NULL);
    json_t *words = view_words(settings->arguments, labels);
    return words ? opened_describe(viewer->atlases->atlas, name->path, words) : NULL;
}

/* Those were for another atlas, which may be of another brain, with other names. */
void open_leave_options(struct view_settings *settings)
{
    settings->atlas =
        (struct atlas_settings){.max_memory = settings->atlas.max_memory, .no_cache = settings->atlas.no_cache};
    settings->context = (struct context_choice){0};
    settings->transfer = settings->session = NULL;
    settings->poses = NULL;
    settings->arguments = NULL;
    settings->space = (struct space_settings){0};
}

/* What the window keeps of the atlas that is open, for the case that another one cannot take its place. */
struct aside {
    struct changes changes;
    char *session_path;
    json_t *opened;
    struct hemispheres hemispheres;
    struct replay replay;
    bool lists_added; /* the panel of what was added was open */
};

static struct aside set_aside(struct window *window)
{
    struct aside aside = {.changes = window->changes,
                          .session_path = window->session_path,
                          .opened = window->opened,
                          .hemispheres = window->hemispheres,
                          .replay = window->replay,
                          .lists_added = window->added.open};
    window->changes = (struct changes){.count = 0};
    window->session_path = NULL;
    window->opened = NULL;
    return aside;
}

static void bring_back(struct window *window, struct viewer *viewer, struct aside *aside)
{
    json_decref(window->opened);
    window_show(window, viewer);
    window->changes = aside->changes;
    window->session_path = aside->session_path;
    window->opened = aside->opened;
    window->hemispheres = aside->hemispheres;
    window->added.open = aside->lists_added;
    *aside = (struct aside){.opened = NULL};
}

static void aside_finish(struct aside *aside)
{
    changes_finish(&aside->changes);
    free(aside->session_path);
    json_decref(aside->opened);
}

/* What the user set stays, but for what is of a file that is not there any more. */
static bool carry(struct window *window, const struct viewer *before, struct aside *aside, const char *session,
                  char *why)
{
    if (!session) {
        snprintf(why, LOADER_WHY, "not enough memory, or a name that is not UTF-8");
    }
    if (!session || !session_parse(window, session, strlen(session), why)) {
        return false;
    }
    added_choose(window->viewer, before);
    window->replay = aside->replay;
    window->added.open = aside->lists_added;
    window->changes = aside->changes;
    window->session_path = aside->session_path;
    aside->changes = (struct changes){.count = 0};
    aside->session_path = NULL;
    undo_renew(window);
    return true;
}

/* Shows the viewer in place of the one before, which stays where the session does not fit. */
static bool replace(struct window *window, struct viewer *viewer, const struct atlas_name *name,
                    const struct view_settings *settings, char *why)
{
    struct viewer *before = window->viewer;
    char *session = settings->again ? session_text(window) : NULL;
    struct aside aside = set_aside(window);
    window->opened = describe(viewer, name, settings);
    conus_hemispheres how = (conus_hemispheres)settings->atlas.hemispheres;
    window->hemispheres = (struct hemispheres){
        .now = how, .wanted = how, .no_cache = settings->atlas.no_cache, .max_memory = settings->atlas.max_memory};
    bool fine = show(window, viewer, settings, why);
    fine = fine && (!settings->again || carry(window, before, &aside, session, why));
    if (!fine) {
        bring_back(window, before, &aside);
    }
    free(session);
    aside_finish(&aside);
    return fine;
}

/* Streamlines that hardly lie where the areas are: the user asks for them twice. */
static bool is_doubtful(const struct window *window, const struct atlases *atlases, struct again *again, char *why)
{
    if (!again || !window->viewer) {
        return false;
    }
    const conus_atlas *before = window->viewer->atlases->atlas;
    const char *doubt = added_note(before, atlases->items[0].atlas, "bundle ");
    const char *note = added_note(before, atlases->items[0].atlas, "");
    snprintf(again->note, sizeof again->note, "%s", note ? note : "");
    again->doubts = doubt && !again->trusts;
    if (again->doubts) {
        snprintf(why, LOADER_WHY, "not added: %s If all is well, add it once more.", doubt);
        print_error_line("%s", why);
    }
    return again->doubts;
}

/* The viewer has them then. */
static void hand_over(struct atlases *atlases)
{
    for (size_t i = 0; i < atlases->count; i++) {
        atlases->items[i].atlas = NULL;
    }
}

/* `text` is the path, or the name of an installed atlas and `name` what that means. */
static bool open_path(struct window *window, const char *text, const struct atlas_name *name,
                      struct view_settings settings, char *why)
{
    const char *path = name->path;
    struct viewer *before = window->viewer;
    struct viewer *viewer = NULL;
    struct atlases atlases = {0};
    conus_frame frame = {0};
    const struct loading what = {text, &settings.atlas, &settings.context, glfwPostEmptyEvent};
    if (before) {
        settings.safe_colours = before->display.safe_colours;
        settings.full_screen = false;
    }
    if (open_load(window, &what, &atlases, why)) {
        prepare(&atlases, &settings);
        bool goes_on =
            !is_doubtful(window, &atlases, settings.again, why) && find_frame(&frame, window, &atlases, &settings);
        viewer = goes_on ? create(&atlases, path, &settings) : NULL;
    }
    if (viewer) {
        viewer->frame = frame;
        hand_over(&atlases);
    } else if (atlases.count && !why[0]) {
        snprintf(why, LOADER_WHY, "%s", error_line());
    }
    atlases_finish(&atlases);
    if (before && viewer) {
        viewer->display.radiological = before->display.radiological;
    }
    bool fine = viewer && replace(window, viewer, name, &settings, why);
    finish(fine ? before : viewer);
    return fine;
}

/* Opens what the user named, a path or an installed atlas, whose path is what is remembered. */
bool open_named(struct window *window, const char *text, const struct view_settings *settings, bool remember,
                char why[LOADER_WHY])
{
    struct atlas_name name;
    bool fine = atlas_name_find(&name, text) == EXIT_DONE;
    if (fine) {
        fine = open_path(window, text, &name, *settings, why);
    } else {
        snprintf(why, LOADER_WHY, "%s", error_line());
    }
    if (fine && remember) {
        recent_add(name.path);
    }
    atlas_name_finish(&name);
    return fine;
}

/* What of the files that were added then is not there now, or another. */
static void say_added(struct window *window, const struct reopening *reopening, const char *session, char *why)
{
    const json_t *then = json_object_get(json_object_get(reopening->file.root, "opened"), "added");
    char name[ADDITIONS_MISSING];
    if (additions_differ(name, then, json_object_get(window->opened, "added"))) {
        viewer_say(window->viewer, "the session is of another %s than this: numbers may differ", name);
    }
    if (reopening->missing[0]) {
        const char *slash = strrchr(session, '/');
        snprintf(why, LOADER_WHY, "%.100s is opened without what is not found: %s", slash ? slash + 1 : session,
                 reopening->missing);
        print_error_line("%s", why);
    }
}

/* A session, whose atlas is opened unless it is open already; `atlas`: in place of it, or NULL. */
static bool open_session(struct window *window, const char *session, const char *atlas,
                         const struct view_settings *settings, bool with_options, char why[LOADER_WHY])
{
    struct reopening reopening;
    bool missing;
    bool fine = reopening_prepare(&reopening, session, atlas, settings, with_options, &missing, why);
    bool was_open = fine && !atlas && reopening_is_open(&reopening, window);
    if (was_open) {
        fine = session_load(window, session, why);
        window->start.on = window->start.on && !fine;
    } else if (fine) {
        fine = open_named(window, reopening.path, &reopening.worded.settings, window->remembers, why);
    }
    if (fine && session_file_differs(&reopening.file, window->viewer->atlases->atlas)) {
        viewer_say(window->viewer, "the session is of another file than this %s: numbers and names may differ",
                   window->viewer->atlases->path);
    }
    if (fine && !was_open) {
        say_added(window, &reopening, session, why);
    }
    if (fine && window->remembers) {
        recent_add(session);
    }
    if (fine || missing) {
        char *waits = missing ? strdup(session) : NULL;
        free(window->session_waits);
        window->session_waits = waits;
        window->start.on = window->start.on || missing;
    }
    reopening_finish(&reopening);
    return fine;
}

/* What is named, a session or an atlas, or the atlas that a session waits for. */
bool open_either(struct window *window, const char *path, const struct view_settings *settings, bool with_options,
                 char why[LOADER_WHY])
{
    struct session_file file = {0};
    char *session = NULL;
    bool is_session = session_file_read(&file, path) || (settings->session && strcmp(path, settings->session) == 0);
    if (is_session) {
        session_file_finish(&file);
        session = strdup(path);
    } else if (window->session_waits) {
        session = strdup(window->session_waits);
    }
    bool fine = session ? open_session(window, session, is_session ? NULL : path, settings, with_options, why)
                        : open_named(window, path, settings, window->remembers, why);
    free(session);
    return fine;
}

bool open_wanted(struct window *window, const struct view_settings *settings, bool with_options, double begun,
                 bool *failed)
{
    struct view_settings used = *settings;
    char why[LOADER_WHY] = "";
    struct wanted wanted = window->wanted;
    reload_end(window);
    bool (*press)(struct window *, const char *) = window->press;
    window->wanted = (struct wanted){.count = 0};
    window->press = NULL;
    if (!with_options) {
        open_leave_options(&used);
    }
    bool fine = wanted.words ? open_again(window, wanted.words, &used, why)
                             : open_all(window, &wanted, &used, with_options, why);
    window->press = press;
    *failed = !fine && why[0] && !window->session_waits; /* for an atlas */
    if (fine) {
        times_start(&window->times, begun);
    }
    if (why[0]) {
        window_say(window, why);
    }
    wanted_finish(&wanted);
    return fine;
}

void open_finish(struct window *window)
{
    struct viewer *viewer = window->viewer;
    reload_end(window);
    window->press = NULL;
    window_show(window, NULL);
    finish(viewer);
}
