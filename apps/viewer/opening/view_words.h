/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The options that say what is opened, as words that a session keeps, and back. */
#ifndef CONUS_VIEWER_VIEW_WORDS_H
#define CONUS_VIEWER_VIEW_WORDS_H

#include "settings/constraints.h"
#include "settings/settings.h"
#include "settings/station_settings.h"
#include <jansson.h>

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

#endif
