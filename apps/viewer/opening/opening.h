/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Opening atlases: the options as words, the thread that loads, the page that is shown meanwhile, and one
 * atlas after the other in the same window. */
#ifndef CONUS_VIEWER_OPENING_OPENING_H
#define CONUS_VIEWER_OPENING_OPENING_H

#include "settings/settings.h"
#include "viewer/window/window.h"

#include <jansson.h>

/* The options that say what is opened, as words that a session keeps, and back. */

struct view_settings {
    struct atlas_settings atlas;
    struct common_settings common;
    struct space_settings space;
    struct station_settings station;
    const char *poses, *pose;
    struct context_choice context;
    struct constraint_settings constraints;
    double depth, radius; /* mm, of the first tool; 0 = not given */
    const char *transfer, *script, *session;
    uint32_t size[2];
    double scale;
    size_t theme; /* 0 = the desktop's, else that of enum theme, from 1 */
    bool hidden, safe_colours, full_screen;
    const struct arguments *arguments; /* no option: that these came from; NULL = from none */
};

/** --transfer. */
extern const struct option scene_options[];
/** --pose, --poses, --depth, --radius. */
extern const struct option needle_options[];

/** Those of @p arguments (NULL = none) that are of the atlas, its context, its space and a plan, but for --max-memory,
 * --only and --hide: an array of "--name=value". Files that are there have their absolute paths. @p labels: of
 * --labels, where the catalogue chose them; or NULL. NULL without memory, or where a value is not UTF-8. */
json_t *view_words(const struct arguments *arguments, const char *labels);

/** Settings that came out of words. */
struct worded {
    struct view_settings settings; /**< Those that are to be used. */
    struct view_settings read;     /**< The words' own. */
    struct arguments arguments;
    char **words; /**< [arguments.count] */
};

/** Reads @p words (NULL = none), an array of texts: as @p given, but for what the words say and the command line, if
 * that @p counts, does not. Returns the exit code and prints an error unless it is 0; *out is the caller's to
 * worded_finish() in any case, and borrows from @p given. */
int worded_parse(struct worded *out, const json_t *words, const struct view_settings *given, bool counts);
void worded_finish(struct worded *worded);

/* Loads ATLAS and those of --atlas, or looks at files, on a thread of its own, while the window is open. */

enum { LOADER_WHY = 512 };

struct loader;

struct loading {
    const char *path; /**< Path or name of the first atlas. */
    const struct atlas_settings *settings;
    const struct context_choice *context; /**< Without files the first atlas's own. Another atlas that has none of its
                                             own gets the same. */
    bool again;                           /**< The files are those that are open: tractograms stay as they are. */
    bool (*may_be)(const char *path);     /**< Asked first, on that thread: false = nothing is loaded, nor said why.
                                             NULL = it is. */
    void (*task)(void *user);             /**< Called in place of loading, with user; NULL = it loads. */
    void *user;
};

/** How far it is. */
struct loader_progress {
    char file[96]; /**< That is read now; "" before the first.      */
    double part;   /**< The part of the files that is read, 0 to 1; 0 while there is one. */
    bool done;
};

/** False without memory or threads. Strings of @p request must outlive the loader. */
bool loader_start(struct loader **out, const struct loading *request);
void loader_ask(struct loader *loader, struct loader_progress *out);
const char *loader_path(const struct loader *loader);
/** Cancels the loader: it ends after the file that it is reading. */
void loader_cancel(struct loader *loader);
/** Waits, and ends the loader. @p out is the caller's. False where there is no atlas: unless the loader was cancelled,
 * stderr says why, and @p why repeats it. True where it looked at files and was not cancelled. */
bool loader_finish(struct loader *loader, struct atlases *out, char why[LOADER_WHY]);

/* The page that is shown while files are read, on a thread of their own. */

/** Ends what open_begin() began and wait_load() did not wait for. */
void wait_leave(struct window *window);
/** Loads, or continues what was begun, while the window shows the progress, unless it is quick. False: the user
 * cancelled, or @p why has the reason. */
bool wait_load(struct window *window, const struct loading *request, struct atlases *out, char why[LOADER_WHY]);
/** Calls @p look on the loader's thread, which looks at the file @p path and others, and waits likewise. */
bool wait_look(struct window *window, const char *path, void (*look)(void *user), void *user, char why[LOADER_WHY]);

/* Opens one atlas after the other in the same window. */

/** Begins to load @p path on another thread, before there is a window: for open_requested(). NULL: nothing is begun. */
struct loader *open_begin(const char *path, const struct view_settings *settings);
/** Opens window->files.requested in place of what is open, or adds it; @p begun is the clock from which times count.
 * With @p with_options, where nothing is open, all @p settings apply; else not those for one atlas: labels, pathways,
 * hidden objects, context, transfer function, session, space. False: window and atlas stay as they were. Then stderr
 * and the window say why, and *failed is set; or the window was closed, or the user asked for something else. */
bool open_requested(struct window *window, const struct view_settings *settings, bool with_options, double begun,
                    bool *failed);
/** Loads --poses, in the space of @p frame. Returns the exit code and prints an error unless it is 0. */
int open_poses(struct window *window, const struct view_settings *settings, const conus_frame *frame);
/** Closes the atlas, if there is one. */
void open_finish(struct window *window);

#endif
