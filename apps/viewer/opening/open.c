/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads an atlas, or several, while the window says how far that is, and puts it in place of what was open before. */
#include "viewer/opening/open.h"

#include "options/messages.h"
#include "settings/atlas_input.h"
#include "settings/atlas_name.h"
#include "settings/atlas_notes.h"
#include "viewer/model/hemisphere_words.h"
#include "viewer/opening/again.h"
#include "viewer/opening/files.h"
#include "viewer/opening/reopen.h"
#include "viewer/opening/waiting.h"
#include "viewer/session/session.h"
#include "viewer/window/screen.h"

#include <GLFW/glfw3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

static struct viewer *create(const struct atlases *atlases, const char *path, const struct view_settings *settings,
                             void (*wake)(void))
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
                      wake)) {
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
    conus_status status = conus_pose_list_load(&window->inputs.replay.poses, settings->poses, &options);
    if (status) {
        return print_status(status);
    }
    if (!conus_pose_list_count(window->inputs.replay.poses)) {
        print_error_line("%s: no poses in it to replay", settings->poses);
        return EXIT_DATA;
    }
    return EXIT_DONE;
}

/* In which space positions are typed and shown; and the poses that need it. False with an error line. */
static bool find_frame(conus_frame *frame, struct window *window, const struct atlases *atlases,
                       const struct view_settings *settings)
{
    bool waits = settings->poses && !window->inputs.replay.poses;
    int code = settings_frame(frame, atlases, &settings->space, settings->common.quiet);
    code = code || !waits ? code : open_poses(window, settings, frame);
    return code == EXIT_DONE;
}

/* Shows it as the options say; false where the session does not fit. */
static bool show(struct window *window, struct viewer *viewer, const struct view_settings *settings, char *why)
{
    window_show(window, viewer);
    viewer->tools[FIRST_TOOL].pointer = window->inputs.station        ? POINT_BY_TRACKER
                                        : window->inputs.replay.poses ? POINT_BY_REPLAY
                                                                      : POINT_BY_MOUSE;
    if (window->inputs.second_station || window->inputs.has_second_tool) {
        tool_choose(window->viewer, SECOND_TOOL, POINT_BY_TRACKER);
        tool_use_second(viewer, true);
    }
    if (window->inputs.replay.poses) {
        replay_show(&window->inputs.replay, viewer, 0);
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
static void leave_options(struct view_settings *settings)
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
    conus_hemispheres hemispheres;
};

static struct aside set_aside(struct window *window)
{
    struct aside aside = {.changes = window->history.changes,
                          .session_path = window->history.session_path,
                          .opened = window->files.opened,
                          .hemispheres = window->files.hemispheres};
    window->history.changes = (struct changes){.count = 0};
    window->history.session_path = NULL;
    window->files.opened = NULL;
    return aside;
}

static void bring_back(struct window *window, struct viewer *viewer, struct aside *aside)
{
    json_decref(window->files.opened);
    window_show(window, viewer);
    window->history.changes = aside->changes;
    window->history.session_path = aside->session_path;
    window->files.opened = aside->opened;
    window->files.hemispheres = aside->hemispheres;
    *aside = (struct aside){.opened = NULL};
}

static void aside_finish(struct aside *aside)
{
    changes_finish(&aside->changes);
    free(aside->session_path);
    json_decref(aside->opened);
}

/* Shows the viewer in place of the one before, which stays where the session does not fit. */
static bool replace(struct window *window, struct viewer *viewer, const struct atlas_name *name,
                    const struct view_settings *settings, char *why)
{
    struct viewer *before = window->viewer;
    struct aside aside = set_aside(window);
    window->files.opened = describe(viewer, name, settings);
    window->files.hemispheres = (conus_hemispheres)settings->atlas.hemispheres;
    bool fine = show(window, viewer, settings, why);
    if (!fine) {
        bring_back(window, before, &aside);
    }
    aside_finish(&aside);
    return fine;
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
    const struct loading what = {
        .path = text, .settings = &settings.atlas, .context = &settings.context, .wake = glfwPostEmptyEvent};
    if (before) {
        settings.safe_colours = before->display.safe_colours;
        settings.full_screen = false;
    }
    if (wait_load(window, &what, &atlases, why)) {
        prepare(&atlases, &settings);
        viewer =
            find_frame(&frame, window, &atlases, &settings) ? create(&atlases, path, &settings, window->wake) : NULL;
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

/* What the user named, a path or an installed atlas, whose path is what is remembered. */
static bool open_named(struct window *window, const char *text, const struct view_settings *settings,
                       char why[LOADER_WHY])
{
    struct atlas_name name;
    bool fine = atlas_name_find(&name, text) == EXIT_DONE;
    if (fine) {
        fine = open_path(window, text, &name, *settings, why);
    } else {
        snprintf(why, LOADER_WHY, "%s", error_line());
    }
    if (fine && window->files.remembers) {
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
    if (additions_differ(name, then, json_object_get(window->files.opened, "added"))) {
        viewer_say(window->viewer, "the session is of another %s than this: numbers may differ", name);
    }
    if (reopening->missing[0]) {
        const char *slash = strrchr(session, '/');
        snprintf(why, LOADER_WHY, "%.100s is opened without what is not found: %s", slash ? slash + 1 : session,
                 reopening->missing);
        print_error_line("%s", why);
    }
}

/* For another thread: finding the atlas reads what is beside the session. */
struct preparation {
    struct reopening *out;
    const char *session, *atlas;
    const struct view_settings *settings;
    bool with_options, fine, missing;
    char why[REOPEN_WHY];
};

static void prepare_session(void *user)
{
    struct preparation *of = user;
    of->fine =
        reopening_prepare(of->out, of->session, of->atlas, of->settings, of->with_options, &of->missing, of->why);
}

/* A session, whose atlas is opened unless it is open already; `atlas`: in place of it, or NULL. */
static bool open_session(struct window *window, const char *session, const char *atlas,
                         const struct view_settings *settings, bool with_options, char why[LOADER_WHY])
{
    struct reopening reopening = {.path = ""};
    struct preparation of = {&reopening, session, atlas, settings, .with_options = with_options};
    bool is_read = wait_look(window, session, prepare_session, &of, why);
    bool fine = is_read && of.fine;
    bool missing = is_read && of.missing;
    if (is_read) {
        snprintf(why, LOADER_WHY, "%s", of.why);
    }
    bool was_open = fine && !atlas && reopening_is_open(&reopening, window);
    if (was_open) {
        fine = session_load(window, session, why);
        window->start.on = window->start.on && !fine;
    } else if (fine) {
        fine = open_named(window, reopening.path, &reopening.worded.settings, why);
    }
    if (fine && session_file_differs(&reopening.file, window->viewer->atlases->atlas)) {
        viewer_say(window->viewer, "the session is of another file than this %s: numbers and names may differ",
                   window->viewer->atlases->path);
    }
    if (fine && !was_open) {
        say_added(window, &reopening, session, why);
    }
    if (fine && window->files.remembers) {
        recent_add(session);
    }
    if (fine || missing) {
        char *waits = missing ? strdup(session) : NULL;
        free(window->files.session_waits);
        window->files.session_waits = waits;
        window->start.on = window->start.on || missing;
    }
    reopening_finish(&reopening);
    return fine;
}

/* What opens first: a session, an atlas, or the atlas that a session waits for. */
static bool open_first(struct window *window, const struct sorted *sorted, const struct view_settings *settings,
                       bool with_options, char why[LOADER_WHY])
{
    const char *waiting = sorted->is_session ? sorted->atlas : window->files.session_waits;
    char *session = waiting ? strdup(waiting) : NULL;
    bool fine =
        session ? open_session(window, session, sorted->is_session ? NULL : sorted->atlas, settings, with_options, why)
                : open_named(window, sorted->atlas, settings, why);
    free(session);
    return fine;
}

/* In addition to what is open. */
static bool add_all(struct window *window, const struct sorted *sorted, const struct view_settings *settings,
                    char why[LOADER_WHY])
{
    const char *first = sorted->image_count ? sorted->images[0] : sorted->tractograms[0];
    if (!window->viewer) {
        snprintf(why, LOADER_WHY, "%.300s: %s: open the atlas that it belongs to first, then this", first,
                 sorted->image_count ? "an image" : "a tractogram");
        print_error_line("%s", why);
        return false;
    }
    const json_t *words = window_words(window);
    json_t *all = words ? files_add(words, sorted) : NULL;
    bool fine = all && open_again(window, all, 0, settings, why);
    if (words && !all) {
        snprintf(why, LOADER_WHY, "%.300s: not enough memory, or a name that is not UTF-8", first);
        print_error_line("%s", why);
    }
    json_decref(all);
    return fine;
}

/* What is wanted, told apart. An atlas is opened in place of what is open, or what is none is added as context. */
static bool open_sorted(struct window *window, struct sorted *sorted, const struct view_settings *settings,
                        bool with_options, char why[LOADER_WHY])
{
    struct view_settings first = *settings;
    struct view_settings later = *settings;
    bool fine = true;
    if (sorted->atlas) {
        first.atlas.image_is_fine = window->viewer && !window->files.session_waits && !sorted->is_session;
        fine = open_first(window, sorted, &first, with_options, why);
        if (!fine && first.atlas.image_is_fine && atlas_input_is_image(why)) {
            sorted->images[sorted->image_count++] = sorted->atlas;
            why[0] = '\0';
            fine = true;
        }
    }
    leave_options(&later);
    return fine && (!(sorted->image_count + sorted->tractogram_count) || add_all(window, sorted, &later, why));
}

/* The files of `wanted`, in any order; but where another atlas may be among them and what was confirmed would be lost,
 * the start page asks first. */
static bool open_files(struct window *window, const struct wanted *wanted, const struct view_settings *settings,
                       bool with_options, char why[LOADER_WHY])
{
    struct sorted sorted;
    bool fine = files_sort(&sorted, window, wanted, settings, why);
    if (fine && wanted->asks && (sorted.atlas || sorted.image_count)) {
        window_ask(window, wanted);
        fine = false;
    }
    fine = fine && open_sorted(window, &sorted, settings, with_options, why);
    files_finish(&sorted);
    return fine;
}

/* Not for sessions, whose options are in their file, nor for names, which the catalogue has to find. */
struct loader *open_begin(const char *path, const struct view_settings *settings)
{
    const struct loading what = {.path = path,
                                 .settings = &settings->atlas,
                                 .context = &settings->context,
                                 .wake = glfwPostEmptyEvent,
                                 .may_be = files_may_be_atlas};
    return path && conus_atlas_is_path(path) && !settings->session ? wait_begin(&what) : NULL;
}

bool open_wanted(struct window *window, const struct view_settings *settings, bool with_options, double begun,
                 bool *failed)
{
    struct view_settings used = *settings;
    char why[LOADER_WHY] = "";
    struct wanted wanted = window->files.wanted;
    bool (*press)(struct window *, const char *) = window->press;
    window->files.wanted = (struct wanted){.count = 0};
    window->press = NULL;
    if (!with_options) {
        leave_options(&used);
    }
    bool fine = wanted.words ? open_again(window, wanted.words, wanted.step, &used, why)
                             : open_files(window, &wanted, &used, with_options, why);
    wait_leave(window); /* it was a session, and its atlas is another */
    window->press = press;
    *failed = !fine && why[0] && !window->files.session_waits; /* for an atlas */
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
    wait_leave(window);
    window->press = NULL;
    window_show(window, NULL);
    finish(viewer);
}
