/* SPDX-License-Identifier: BSD-3-Clause */
/* Tells what files are, and opens the atlas again with what is added. */
#include "viewer/open_all.h"

#include "common/messages.h"
#include "common/output.h"
#include "viewer/added.h"
#include "viewer/open_parts.h"
#include "viewer/opening/session_file.h"
#include "viewer/view_words.h"

#include <GLFW/glfw3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* As the options are, and all that the user set stays. */
static bool open_with_words(struct window *window, const json_t *words, const struct view_settings *settings,
                            struct again *again, char why[LOADER_WHY])
{
    struct worded worded;
    char *path = strdup(window->viewer->atlases->path);
    bool fine = path && !worded_parse(&worded, words, settings, false);
    if (fine) {
        worded.settings.again = again;
        worded.settings.common.quiet = true; /* its notes were said */
        fine = open_named(window, path, &worded.settings, false, why);
    } else {
        snprintf(why, LOADER_WHY, "%s", path ? error_line() : "not enough memory");
    }
    if (path) {
        worded_finish(&worded);
    }
    free(path);
    return fine;
}

bool open_again(struct window *window, const json_t *words, const struct view_settings *settings, char why[LOADER_WHY])
{
    char *text = json_dumps(words, JSON_COMPACT);
    json_t *then = json_incref(json_object_get(window->opened, "options"));
    struct again again = {.trusts = text && window->doubted && strcmp(text, window->doubted) == 0};
    bool fine = open_with_words(window, words, settings, &again, why);
    free(window->doubted);
    window->doubted = again.doubts ? text : NULL;
    if (fine) {
        added_news(why, LOADER_WHY, then, words);
        size_t used = strlen(why);
        snprintf(why + used, LOADER_WHY - used, "%s%s", again.note[0] ? "; " : "", again.note);
    }
    if (!again.doubts) {
        free(text);
    }
    json_decref(then);
    return fine;
}

/* What is to be opened first, and what is to be added to it. */
struct sorted {
    const char *atlas; /* or a session, or an image; NULL = there is none */
    const char **images, **tractograms;
    size_t image_count, tractogram_count;
};

/* The library's word for what is no atlas, but can be around one. */
static bool is_image(const char *why)
{
    return strstr(why, "--context draws");
}

/* Whether there is an atlas at `path`; *image: there is an image. */
static bool is_atlas(struct window *window, const char *path, const struct view_settings *settings, bool *image,
                     char why[LOADER_WHY])
{
    struct session_file file = {0};
    struct atlas_settings alone = {.max_memory = settings->atlas.max_memory, .no_cache = settings->atlas.no_cache};
    const struct context_choice none = {.opacity = 0};
    const struct loading what = {path, &alone, &none, glfwPostEmptyEvent};
    struct atlases atlases = {0};
    *image = false;
    if (session_file_read(&file, path)) {
        session_file_finish(&file);
        return true;
    }
    bool is = open_load(window, &what, &atlases, why);
    *image = !is && is_image(why);
    atlases_finish(&atlases);
    return is;
}

static bool refuse_second(const char *one, const char *other, const char *kind, char why[LOADER_WHY])
{
    snprintf(why, LOADER_WHY, "%.200s and %.200s are two %s: open one of them", one, other, kind);
    print_error_line("%s", why);
    return false;
}

/* Of several that are no tractograms one is the atlas, and the others are images; false: why not. */
static bool find_atlas(struct sorted *sorted, struct window *window, const struct view_settings *settings,
                       char why[LOADER_WHY])
{
    const char *atlas = NULL;
    size_t count = sorted->image_count;
    bool fine = true;
    sorted->image_count = 0;
    for (size_t i = 0; i < count && fine; i++) {
        bool image;
        const char *path = sorted->images[i];
        if (is_atlas(window, path, settings, &image, why)) {
            fine = !atlas || refuse_second(atlas, path, "atlases or sessions", why);
            atlas = path;
        } else {
            fine = image && (!sorted->image_count || refuse_second(sorted->images[0], path, "images", why));
            sorted->images[sorted->image_count++] = path;
        }
    }
    if (fine) {
        why[0] = '\0';
        sorted->atlas = atlas;
    }
    return fine;
}

/* Where no atlas is open yet, only files that are named so are read here, on the window's thread: while the loader
 * reads the others, the window can be closed. */
static bool is_tractogram(const struct window *window, const char *path)
{
    static const char *const ends[] = {".trk", ".trk.gz", ".tck", ".tck.gz", ".trx", ".tt.gz"};
    bool is_looked_at = window->viewer;
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        is_looked_at = is_looked_at || path_ends(path, ends[i]);
    }
    return is_looked_at && conus_path_is_tractogram(path);
}

static bool sort(struct sorted *out, struct window *window, const struct wanted *wanted,
                 const struct view_settings *settings, char why[LOADER_WHY])
{
    out->images = calloc(wanted->count + 1, sizeof *out->images);
    out->tractograms = calloc(wanted->count + 1, sizeof *out->tractograms);
    if (!out->images || !out->tractograms) {
        snprintf(why, LOADER_WHY, "not enough memory");
        return false;
    }
    for (size_t i = 0; i < wanted->count; i++) {
        const char *path = wanted->paths[i];
        if (is_tractogram(window, path)) {
            out->tractograms[out->tractogram_count++] = path;
        } else {
            out->images[out->image_count++] = path;
        }
    }
    if (out->image_count == 1) { /* which it is, opening it tells */
        out->atlas = out->images[0];
        out->image_count = 0;
    }
    return out->image_count < 2 || find_atlas(out, window, settings, why);
}

/* The options with all that is to be added; NULL without memory, or where a name is not UTF-8. */
static json_t *with_all(const json_t *words, const struct sorted *sorted)
{
    json_t *all = json_copy((json_t *)words);
    for (size_t i = 0; i < sorted->image_count + sorted->tractogram_count && all; i++) {
        bool is_image = i < sorted->image_count;
        const char *path = is_image ? sorted->images[i] : sorted->tractograms[i - sorted->image_count];
        json_t *more = additions_with(all, is_image ? ADD_CONTEXT : ADD_STREAMLINES, path);
        json_decref(all);
        all = more;
    }
    return all;
}

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
    json_t *all = words ? with_all(words, sorted) : NULL;
    bool fine = all && open_again(window, all, settings, why);
    if (words && !all) {
        snprintf(why, LOADER_WHY, "%.300s: not enough memory, or a name that is not UTF-8", first);
        print_error_line("%s", why);
    }
    json_decref(all);
    return fine;
}

bool open_all(struct window *window, const struct wanted *wanted, const struct view_settings *settings,
              bool with_options, char why[LOADER_WHY])
{
    struct sorted sorted = {0};
    struct view_settings later = *settings;
    bool fine = sort(&sorted, window, wanted, settings, why);
    if (fine && sorted.atlas) {
        fine = open_either(window, sorted.atlas, settings, with_options, why);
        if (!fine && window->viewer && !window->session_waits && is_image(why)) {
            sorted.images[sorted.image_count++] = sorted.atlas;
            why[0] = '\0';
            fine = true;
        }
    }
    open_leave_options(&later);
    if (fine && sorted.image_count + sorted.tractogram_count) {
        fine = add_all(window, &sorted, &later, why);
    }
    free(sorted.images);
    free(sorted.tractograms);
    return fine;
}
