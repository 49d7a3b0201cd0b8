/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds out what files are, loads them while the window says how far that is, and shows them in place of others. */
#include "viewer/opening/opening.h"

#include "base/path.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/settings.h"
#include "sources/names.h"
#include "viewer/model/additions.h"
#include "viewer/model/viewer.h"
#include "viewer/opening/parts.h"
#include "viewer/session/session.h"
#include "viewer/window/window.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The file to open first, and the files to add to it. Paths are borrowed. */
struct file_set {
    const char *atlas;   /* Or a session, or an image, which opening it tells; NULL = there is none. */
    bool is_session;     /* It is a session. */
    bool is_known;       /* It is an atlas. */
    const char **images; /* [image_count] */
    const char **tractograms;
    size_t image_count, tractogram_count;
    const char *points; /* A list; NULL = there is none. */
};

enum { RESUME_WHY = 512 };

/* A session that is opened, with its atlas: what prepare_session() is asked for, and what it found. */
struct resume {
    const char *session;
    const char *atlas;                    /* A path that somebody named in place of the session's; NULL = none. */
    const struct view_settings *settings; /* Those of the command line, */
    bool with_options;                    /* whose options come before the session's. */

    bool fine, missing;     /* Missing: the atlas was not found. */
    char why[RESUME_WHY];   /* Why it is not fine. */
    char path[SYSTEM_PATH]; /* Path or name of the atlas. */
    struct session_file file;
    struct worded worded; /* Its settings. */
    json_t *lost;         /* Its entries of files that were added then, and are not found now. */
    json_t *words;        /* Its options without those of missing files. */
};

enum kind { IS_OTHER = 0, IS_TRACTOGRAM, IS_SESSION, IS_POINTS };

struct looking {
    const struct open_request *request;
    const char *session; /* certainly a session, so a failure to read it has its own message; NULL = none */
    struct file_set *set;
    bool fine;
    char why[LOADER_WHY];
};

enum { NAMING_BYTES = 4096 /* in which JSON says what it is */ };

/* Whether a JSON file names @p key at its beginning, however damaged the rest is. */
static bool json_names(const char *path, const char *key)
{
    char text[NAMING_BYTES + 1];
    struct system_stat info;
    bool may_be = path_ends_in(path, ".json") && system_stat(&info, path) && info.kind == SYSTEM_FILE;
    FILE *in = may_be ? system_stream(path, "rb") : NULL;
    text[in ? fread(text, 1, NAMING_BYTES, in) : 0] = '\0';
    if (in) {
        fclose(in);
    }
    return strstr(text, key);
}

/* Whether it is a list of points or poses; an atlas has none of these endings. */
static bool is_list(const char *path)
{
    conus_pose_stream *stream = NULL;
    bool is = ending_length(path, strlen(path), ROLE_POSES) && !conus_pose_stream_open(&stream, path, NULL);
    conus_pose_stream_destroy(stream);
    return is;
}

static enum kind find_kind(const char *path)
{
    struct session_file file = {0};
    bool is_session = session_file_read(&file, path);
    session_file_finish(&file);
    return is_session || json_names(path, "\"conus_session\"") ? IS_SESSION
           : conus_path_is_tractogram(path)                    ? IS_TRACTOGRAM
           : is_list(path)                                     ? IS_POINTS
                                                               : IS_OTHER;
}

/* Whether what is at `path` may be an atlas by itself: it is no session, tractogram or list. Reads it. */
static bool files_may_be_atlas(const char *path)
{
    return find_kind(path) == IS_OTHER;
}

/* Whether there is an atlas at `path`; else `why` says why not. */
static bool is_atlas(struct window *window, const char *path, const struct view_settings *settings,
                     char why[LOADER_WHY])
{
    struct atlas_settings alone = {.max_memory = settings->atlas.max_memory, .image_is_fine = true};
    const struct context_choice none = {.opacity = 0};
    const struct loading request = {.path = path, .settings = &alone, .context = &none};
    struct atlases atlases = {0};
    bool is = wait_load(window, &request, &atlases, why);
    atlases_finish(&atlases);
    return is;
}

static bool refuse_second(const char *one, const char *other, const char *kind, char why[LOADER_WHY])
{
    snprintf(why, LOADER_WHY, "%.200s and %.200s are two %s: open one of them", one, other, kind);
    print_error_line("%s", why);
    return false;
}

/* Takes over the file that opens first; refuses a second one. */
static bool use_atlas(struct file_set *set, const char *path, bool is_session, char why[LOADER_WHY])
{
    if (set->atlas) {
        return refuse_second(set->atlas, path, "atlases or sessions", why);
    }
    set->atlas = path;
    set->is_session = is_session;
    return true;
}

/* Runs on another thread: finds out what each file is. */
static void look_at_files(void *user)
{
    struct looking *looking = user;
    struct file_set *set = looking->set;
    for (size_t i = 0; i < looking->request->count && looking->fine; i++) {
        const char *path = looking->request->paths[i];
        bool is_named = looking->session && strcmp(path, looking->session) == 0;
        enum kind kind = is_named ? IS_SESSION : find_kind(path);
        if (kind == IS_SESSION) {
            looking->fine = use_atlas(set, path, true, looking->why);
        } else if (kind == IS_TRACTOGRAM) {
            set->tractograms[set->tractogram_count++] = path;
        } else if (kind == IS_POINTS) {
            looking->fine = !set->points || refuse_second(set->points, path, "lists of points", looking->why);
            set->points = path;
        } else {
            set->images[set->image_count++] = path;
        }
    }
}

/* Finds the one atlas among several files that may be atlases; one other may be an image. False: `why` says why not. */
static bool find_atlas(struct file_set *set, struct window *window, const struct view_settings *settings,
                       char why[LOADER_WHY])
{
    size_t count = set->image_count;
    bool fine = true;
    set->image_count = 0;
    for (size_t i = 0; i < count && fine; i++) {
        const char *path = set->images[i];
        if (is_atlas(window, path, settings, why)) {
            fine = use_atlas(set, path, false, why);
            set->is_known = true;
        } else {
            fine =
                atlas_input_is_image(why) && (!set->image_count || refuse_second(set->images[0], path, "images", why));
            set->images[set->image_count++] = path;
        }
    }
    why[0] = fine ? '\0' : why[0];
    return fine;
}

/* Finds out what each file of `request` is, on another thread. False: the user cancelled, or `why` has the reason. The
 * lists of `out` are the caller's to free in any case. */
static bool file_set_find(struct file_set *out, struct window *window, const struct open_request *request,
                          const struct view_settings *settings, char why[LOADER_WHY])
{
    struct looking looking = {.request = request, .session = settings->session, .set = out, .fine = true};
    *out = (struct file_set){.images = calloc(request->count + 1, sizeof *out->images),
                             .tractograms = calloc(request->count + 1, sizeof *out->tractograms)};
    bool fine = out->images && out->tractograms;
    snprintf(why, LOADER_WHY, "%s", fine ? "" : "not enough memory");
    fine = fine && wait_look(window, request->paths[0], look_at_files, &looking, why);
    if (fine && !looking.fine) {
        memcpy(why, looking.why, LOADER_WHY);
        return false;
    }
    if (fine && !out->atlas && out->image_count == 1) { /* which it is, opening it tells */
        out->atlas = out->images[0];
        out->image_count = 0;
    } else if (fine && out->image_count) {
        fine = find_atlas(out, window, settings, why);
    }
    return fine;
}

/* Looks for the session's atlas among recent and installed ones, and by name if it was opened by name. */
static bool find_session_atlas(char out[SYSTEM_PATH], const struct session_file *file, const char *session)
{
    struct start start = {.on = true};
    const conus_installed *named = NULL;
    start_look(&start);
    size_t installed = conus_catalogue_count(start.catalogue);
    const char **others = calloc(start.recent.count + installed + 1, sizeof *others);
    size_t count = 0;
    for (size_t i = 0; others && i < start.recent.count; i++) {
        others[count++] = start.recent.paths[i];
    }
    for (size_t i = 0; others && i < installed; i++) {
        others[count++] = conus_catalogue_atlas(start.catalogue, i)->path;
    }
    bool found = session_file_find(out, file, session, others, count);
    if (!found && start.catalogue && path_is_name(file->atlas) &&
        !conus_catalogue_find(&named, start.catalogue, file->atlas)) {
        found = snprintf(out, SYSTEM_PATH, "%s", file->atlas) < SYSTEM_PATH;
    }
    free(others);
    start_finish(&start);
    return found;
}

static void destroy_viewer(struct viewer *viewer)
{
    if (viewer) {
        viewer_finish(viewer);
        free(viewer);
    }
}

static struct viewer *create_viewer(const struct atlases *atlases, const char *path,
                                    const struct view_settings *settings, void (*wake)(void))
{
    assert(atlases->count);
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
        double enlarged = settings->station.enlarged > 0 ? settings->station.enlarged : 1;
        viewer->head.named = viewer->head.on = settings->station.head;
        viewer->head.size[0] = settings->station.screen_mm[0] / enlarged; /* in the world */
        viewer->head.size[1] = settings->station.screen_mm[1] / enlarged;
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
    for (size_t i = 0; i < conus_pose_list_count(window->inputs.replay.poses); i++) {
        const double *range = conus_pose_list_row(window->inputs.replay.poses, i)->range;
        if (isfinite(range[0]) || isfinite(range[1])) {
            print_error_line("%s: near and far: the window has one range for all poses", settings->poses);
            return EXIT_DATA;
        }
    }
    return EXIT_DONE;
}

/* Shows the viewer as the options say; false where the session does not fit. */
static bool show_viewer(struct window *window, struct viewer *viewer, const struct view_settings *settings, char *why)
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

/* Drops the options that were for another atlas, whose brain and names may differ. */
static void leave_options(struct view_settings *settings)
{
    settings->atlas = (struct atlas_settings){.max_memory = settings->atlas.max_memory, .shelf = settings->atlas.shelf};
    settings->context = (struct context_choice){0};
    settings->transfer = settings->session = NULL;
    settings->poses = settings->pose = NULL;
    settings->depth = settings->radius = 0;
    settings->arguments = NULL;
    settings->space = (struct space_settings){0};
}

/* Shows the viewer in place of the one before, which stays, with its changes, where the session does not fit. */
static bool replace(struct window *window, struct viewer *viewer, const struct atlas_name *name,
                    const struct view_settings *settings, char *why)
{
    struct viewer *before = window->viewer;
    struct history history = window->history;
    json_t *opened = window->files.opened;
    conus_hemispheres hemispheres = window->files.hemispheres;
    json_t *words = view_words(settings->arguments, settings->atlas.labels ? NULL : atlas_name_labels(name, NULL));
    window->history = (struct history){.session_path = NULL};
    window->files.opened = words ? opened_describe(viewer->atlases->atlas, name->path, words) : NULL;
    window->files.hemispheres = (conus_hemispheres)settings->atlas.hemispheres;
    if (!show_viewer(window, viewer, settings, why)) {
        json_decref(window->files.opened);
        window_show(window, before);
        window->history = history;
        window->files.opened = opened;
        window->files.hemispheres = hemispheres;
        return false;
    }
    window_history_finish(&history);
    json_decref(opened);
    json_decref(window->files.lost);
    window->files.lost = NULL;
    return true;
}

/* `text` is the path, or the name of an installed atlas and `name` what that means. */
static bool open_path(struct window *window, const char *text, const struct atlas_name *name,
                      struct view_settings settings, char *why)
{
    const char *path = name->path;
    struct viewer *before = window->viewer;
    struct viewer *viewer = NULL;
    struct atlases atlases = {0};
    struct point_list points = {0};
    conus_frame frame = {0};
    const struct loading request = {.path = text, .settings = &settings.atlas, .context = &settings.context};
    if (before) {
        settings.safe_colours = before->display.safe_colours;
        settings.full_screen = false;
    }
    if (wait_load(window, &request, &atlases, why)) {
        if (before) {
            warnings_forget(0); /* which were about it */
        }
        for (size_t i = 0; i < atlases.count && settings.safe_colours; i++) {
            conus_atlas_use_safe_colours(atlases.items[i].atlas);
        }
        atlases_say_notes(&atlases, &settings.common);
        atlases_say_spaces(&atlases, &settings.common);
        bool waits = settings.poses && !window->inputs.replay.poses && /* which need the frame */
                     !constraints_are_given(settings.arguments);
        int code = space_settings_frame(&frame, &atlases, &settings.space, settings.common.quiet);
        code = code || !waits ? code : open_poses(window, &settings, &frame);
        if (!code && settings.poses && window->inputs.replay.poses) {
            code =
                pose_settings_match_list(window->inputs.replay.poses, settings.poses, &atlases, NULL, &settings.common);
        }
        code = code || !settings.pose ? code
                                      : points_load(&points, settings.pose, &atlases, &frame, settings.radius,
                                                    &settings.common, settings.atlas.max_memory);
        viewer = code ? NULL : create_viewer(&atlases, path, &settings, window->wake);
    }
    if (viewer) {
        viewer->frame = frame;
        points_use(viewer, &points);
        for (size_t i = 0; i < atlases.count; i++) {
            atlases.items[i].atlas = NULL; /* they are the viewer's now */
        }
        if (plans_open(viewer, settings.arguments, settings.poses, settings.depth, settings.radius)) {
            snprintf(why, LOADER_WHY, "%s", error_line());
            destroy_viewer(viewer);
            viewer = NULL;
        }
    } else if (atlases.count && !why[0]) {
        snprintf(why, LOADER_WHY, "%s", error_line());
    }
    points_finish(&points);
    atlases_finish(&atlases);
    if (before && viewer) {
        viewer->display.radiological = before->display.radiological;
    }
    bool fine = viewer && replace(window, viewer, name, &settings, why);
    destroy_viewer(fine ? before : viewer);
    if (fine && settings.atlas.shelf) {
        tract_shelf_drop(settings.atlas.shelf);
    }
    return fine;
}

/* Opens a path, or an installed atlas by its name; its path is remembered. */
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

/* Says which added files are missing now, or are others. */
static void say_added(struct window *window, const struct resume *resume, char *why)
{
    const json_t *then = json_object_get(json_object_get(resume->file.root, "opened"), "added");
    char name[ADDITIONS_MISSING];
    if (additions_differ(name, then, json_object_get(window->files.opened, "added"))) {
        viewer_say(window->viewer, "the session has another %s than this: numbers may differ", name);
    }
    if (json_array_size(resume->lost)) {
        additions_names(name, resume->lost);
        snprintf(why, LOADER_WHY, "%.100s is opened; not found: %s", path_name(resume->session), name);
        print_error_line("%s", why);
    }
}

/* Finds the atlas of a session and how it was opened, on another thread: it reads the files beside the session. */
static void prepare_session(void *user)
{
    struct resume *of = user;
    const struct session_file *file = &of->file;
    if (!session_file_read(&of->file, of->session)) {
        char why[PROPERTY_REASON];
        bool is_json = session_check(of->session, why);
        snprintf(of->why, RESUME_WHY, is_json ? "%.300s: no session of conus view" : "%.300s: a damaged session",
                 is_json ? of->session : why);
        print_error_line("%s", of->why);
        return;
    }
    of->fine = of->atlas ? snprintf(of->path, SYSTEM_PATH, "%s", of->atlas) < SYSTEM_PATH
                         : find_session_atlas(of->path, file, of->session);
    of->missing = !of->fine;
    of->lost = json_array();
    of->words = additions_find(of->lost, file->options, json_object_get(json_object_get(file->root, "opened"), "added"),
                               of->session, of->fine && !path_is_name(of->path) ? of->path : NULL);
    if (!of->words) {
        snprintf(of->why, RESUME_WHY, "%.200s: not enough memory", of->session);
        return;
    }
    if (worded_parse(&of->worded, of->words, of->settings, of->with_options)) {
        snprintf(of->why, RESUME_WHY, "%.200s: opened: options: %.200s", of->session, error_line());
        return;
    }
    of->worded.settings.session = of->session;
    if (of->missing) {
        const char *joint = file->folder[0] && !path_is_whole(file->atlas) ? "/" : "";
        snprintf(of->why, RESUME_WHY,
                 "%.100s: its atlas is not found: %.150s%s%.150s. It was looked for there, beside the session, and "
                 "among recent and installed atlases. Open or drop it, and the session goes on.",
                 path_name(of->session), joint[0] ? file->folder : "", joint, file->atlas);
        print_error_line("%s", of->why);
    }
}

/* A session, whose atlas is opened unless it is open already; `atlas`: in place of it, or NULL. */
static bool open_session(struct window *window, const char *session, const char *atlas,
                         const struct view_settings *settings, bool with_options, char why[LOADER_WHY])
{
    struct resume resume = {.session = session, .atlas = atlas, .settings = settings, .with_options = with_options};
    bool is_read = wait_look(window, session, prepare_session, &resume, why);
    bool fine = is_read && resume.fine;
    bool missing = is_read && resume.missing;
    if (is_read) {
        snprintf(why, LOADER_WHY, "%s", resume.why);
    }
    /* The window shows it already: the same atlas, opened in the same way. */
    bool was_open = fine && !atlas && window->viewer && window->files.opened &&
                    json_equal(json_object_get(resume.file.root, "opened"), window->files.opened) &&
                    strcmp(resume.file.atlas, window->viewer->atlases->path) == 0;
    if (was_open) {
        fine = session_load(window, session, why);
        if (!fine) {
            print_error_line("%s", why);
        }
        window->start.on = window->start.on && !fine;
    } else if (fine) {
        fine = open_named(window, resume.path, &resume.worded.settings, why);
    }
    const conus_volume_info *volume = fine ? conus_atlas_volume(window->viewer->atlases->atlas, 0) : NULL;
    if (volume && resume.file.sha256[0] && strcmp(resume.file.sha256, volume->sha256) != 0) {
        viewer_say(window->viewer, "the session has another file than this %s: numbers and names may differ",
                   window->viewer->atlases->path);
    }
    if (fine && !was_open) {
        say_added(window, &resume, why);
    }
    if (fine) { /* its file keeps the entries of missing files, and the session has more of them */
        const bool any = json_array_size(resume.lost) > 0;
        json_decref(window->files.lost);
        window->files.lost =
            any ? json_pack("{s: O, s: O}", "session", resume.file.root, "entries", resume.lost) : NULL;
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
    if (resume.worded.words) {
        worded_finish(&resume.worded);
    }
    json_decref(resume.words);
    json_decref(resume.lost);
    session_file_finish(&resume.file);
    return fine;
}

/* The present number of the atlas that had `number` then, both from 1; 0 = it is gone. The lists are of further
 * atlases. */
static size_t find_number(json_int_t number, const json_t *then, const json_t *now)
{
    size_t place = number > 1 ? words_place(now, json_array_get(then, (size_t)number - 2)) : 0;
    return number > 1 ? place + (place > 0) : 1;
}

/* Has a session that was left with the further atlases `then` fit the window, which has others. */
static void fit_session(json_t *session, const struct viewer *viewer, const json_t *then, const json_t *now)
{
    const json_t *before = json_object_get(session, "further_atlases");
    json_t *further = viewer->atlas_count > 1 ? session_further(viewer) : NULL;
    json_t *pins = json_object_get(session, "confirmed");
    size_t drawn = find_number(json_integer_value(json_object_get(session, "drawn")), then, now);
    for (size_t i = 0; i < json_array_size(further); i++) {
        size_t place = words_place(then, json_array_get(now, i));
        (void)(place && json_array_set(further, i, json_array_get(before, place - 1)));
    }
    for (size_t i = json_array_size(pins); i-- > 0;) {
        json_t *pin = json_array_get(pins, i);
        size_t number = find_number(json_integer_value(json_object_get(pin, "atlas")), then, now);
        if (number) {
            json_object_set_new(pin, "atlas", json_integer((json_int_t)number));
        } else {
            json_array_remove(pins, i);
        }
    }
    json_object_del(session, "further_atlases");
    json_object_del(session, "drawn");
    if (further) {
        json_object_set_new(session, "further_atlases", further);
        json_object_set_new(session, "drawn", json_integer((json_int_t)(drawn ? drawn : 1)));
    }
}

/* Opens the atlas with other further ones. All stays as it is set, but what could be taken back. */
static bool open_anew(struct window *window, const json_t *words, const struct view_settings *settings,
                      char why[LOADER_WHY])
{
    struct worded worded;
    char refused[PROPERTY_REASON] = "";
    char *path = strdup(window->viewer->atlases->path);
    char *saved = window->history.session_path ? strdup(window->history.session_path) : NULL;
    bool lists = window->forms.added.open;
    json_t *session = session_json(window);
    json_t *kept = json_incref(window->history.kept);
    json_t *lost = json_incref(window->files.lost);
    json_t *then = additions_atlases(json_object_get(window->files.opened, "options"));
    bool fine = worded_parse(&worded, words, settings, false) == EXIT_DONE;
    if (!fine) {
        snprintf(why, LOADER_WHY, "%s", error_line());
    } else if (!path || !session || !then) {
        fine = false;
        snprintf(why, LOADER_WHY, "not enough memory");
    } else {
        fine = open_named(window, path, &worded.settings, why);
    }
    if (fine) {
        json_t *now = additions_atlases(json_object_get(window->files.opened, "options"));
        fit_session(session, window->viewer, then, now);
        fine = session_read(window, session, "session", refused);
        json_decref(now);
        window->history.session_path = saved;
        window->history.kept = json_incref(kept);
        window->files.lost = json_incref(lost);
        window->forms.added = (struct added_form){.open = lists, .kind = ADD_ATLAS, .is_set = true};
        viewer_say(window->viewer, "%s",
                   fine ? "opened with these atlases; Ctrl+Z takes back later changes only" : refused);
    } else {
        free(saved);
    }
    worded_finish(&worded);
    json_decref(session);
    json_decref(kept);
    json_decref(lost);
    json_decref(then);
    free(path);
    return fine;
}

/* Opens the atlas that is open with other options. */
static bool open_words(struct window *window, const json_t *words, int step, const struct view_settings *settings,
                       char why[LOADER_WHY])
{
    json_t *then = additions_atlases(json_object_get(window->files.opened, "options"));
    json_t *now = additions_atlases(words);
    bool fine =
        json_equal(then, now) ? reopen(window, words, step, settings, why) : open_anew(window, words, settings, why);
    json_decref(then);
    json_decref(now);
    return fine;
}

/* Adds images, tractograms, an atlas and a list to the atlas that is open. */
static bool add_all(struct window *window, const struct file_set *set, const struct view_settings *settings,
                    char why[LOADER_WHY])
{
    const size_t volumes = set->image_count;
    const size_t files = volumes + set->tractogram_count;
    const struct {
        enum addition kind;
        const char *path;
    } others[] = {{ADD_ATLAS, set->atlas}, {ADD_POSE, set->points}};
    const char *first = set->atlas ? set->atlas : volumes ? set->images[0] : files ? set->tractograms[0] : set->points;
    if (!window->viewer) {
        snprintf(why, LOADER_WHY, "%.300s: %s: open the atlas that it belongs to first, then this", first,
                 volumes ? "an image"
                 : files ? "a tractogram"
                         : "a list of points");
        print_error_line("%s", why);
        return false;
    }
    const json_t *words = window_words(window);
    json_t *all = json_copy((json_t *)words);
    for (size_t i = 0; i < files + 2 && all; i++) {
        enum addition kind = i < volumes ? ADD_CONTEXT : i < files ? ADD_STREAMLINES : others[i - files].kind;
        const char *path = i < volumes ? set->images[i]
                           : i < files ? set->tractograms[i - volumes]
                                       : others[i - files].path;
        json_t *more = path ? additions_with(all, kind, path) : json_incref(all);
        json_decref(all);
        all = more;
    }
    bool fine = all && open_words(window, all, 0, settings, why);
    if (words && !all) {
        snprintf(why, LOADER_WHY, "%.300s: not enough memory, or a name that is not UTF-8", first);
        print_error_line("%s", why);
    }
    json_decref(all);
    return fine;
}

/* Opens an atlas in place of the open one, or adds it. */
static bool open_sorted(struct window *window, struct file_set *set, enum opening how,
                        const struct view_settings *settings, bool with_options, char why[LOADER_WHY])
{
    struct view_settings later = *settings;
    bool fine = true;
    if (set->atlas && how != OPEN_ADDS) {
        const char *waiting = set->is_session ? set->atlas : window->files.session_waits;
        char *session = waiting ? strdup(waiting) : NULL; /* what waits is freed when it opens */
        fine = session ? open_session(window, session, set->is_session ? NULL : set->atlas, settings, with_options, why)
                       : open_named(window, set->atlas, settings, why);
        free(session);
        set->atlas = NULL;
    }
    leave_options(&later);
    bool adds = set->atlas || set->image_count || set->tractogram_count || set->points;
    return fine && (!adds || add_all(window, set, &later, why));
}

/* Whether to ask the user how the files open: an atlas may join the open one or replace it, and a session ends what was
 * confirmed. An image is added without asking. False, too, where there is no such atlas, as `why` says. */
static bool has_question(struct window *window, struct file_set *set, struct open_request *request,
                         const struct view_settings *settings, char why[LOADER_WHY])
{
    if (!window->viewer || window->files.session_waits || request->how != OPEN_ASKS || !set->atlas) {
        return false;
    }
    request->asked_of = set->atlas;
    request->may_be_added = !set->is_session;
    if (set->is_session || set->is_known) {
        return !set->is_session || window->viewer->pin_count;
    }
    bool is = is_atlas(window, set->atlas, settings, why);
    if (!is && atlas_input_is_image(why)) {
        set->images[set->image_count++] = set->atlas;
        set->atlas = NULL;
        why[0] = '\0';
    }
    return is;
}

/* The files of `request`, in any order, once the user has said how. */
static bool open_files(struct window *window, struct open_request *request, const struct view_settings *settings,
                       bool with_options, char why[LOADER_WHY])
{
    struct file_set set;
    bool fine = file_set_find(&set, window, request, settings, why);
    const char *other = fine && !set.is_session ? set.atlas : NULL;
    bool asks = fine && has_question(window, &set, request, settings, why);
    fine = fine && !asks && !why[0] && open_sorted(window, &set, request->how, settings, with_options, why);
    free((void *)set.images);
    free((void *)set.tractograms);
    size_t said = strlen(why);
    if (said && !fine && other && path_ends_in(other, ".json") && !json_names(other, "\"conus_atlas\"")) {
        static const char either[] = "it is no session of conus view either";
        snprintf(why + said, LOADER_WHY - said, "; %s", either);
        print_error_line("%s: %s", other, either);
    }
    if (asks) {
        window_ask(window, request);
    }
    return fine;
}

/* Begins no session, whose options are in its file, and no name, which the catalogue has to find. */
struct loader *open_begin(const char *path, const struct view_settings *settings)
{
    const struct loading request = {
        .path = path, .settings = &settings->atlas, .context = &settings->context, .may_be = files_may_be_atlas};
    struct loader *loader = NULL;
    if (path && conus_atlas_is_path(path) && !settings->session) {
        (void)loader_start(&loader, &request);
    }
    return loader;
}

bool open_requested(struct window *window, const struct view_settings *settings, bool with_options, double begun,
                    bool *failed)
{
    struct view_settings used = *settings;
    char why[LOADER_WHY] = "";
    struct open_request request = window->files.requested;
    bool (*press)(struct window *, const char *) = window->press;
    window->files.requested = (struct open_request){.count = 0};
    window->press = NULL;
    if (!with_options) {
        leave_options(&used);
    }
    bool fine = request.words ? open_words(window, request.words, request.step, &used, why)
                              : open_files(window, &request, &used, with_options, why);
    wait_leave(window); /* it was a session, and its atlas is another */
    window->press = press;
    *failed = !fine && why[0] && !window->files.session_waits; /* for an atlas */
    if (fine) {
        times_start(&window->times, begun);
    }
    if (*failed && request.by_dialog) {
        dialog_complain(&window->dialog, why);
    } else if (why[0]) {
        window_say(window, why);
    }
    open_request_finish(&request);
    return fine;
}

void open_finish(struct window *window)
{
    struct viewer *viewer = window->viewer;
    wait_leave(window);
    window->press = NULL;
    window_show(window, NULL);
    destroy_viewer(viewer);
}
