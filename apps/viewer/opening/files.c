/* SPDX-License-Identifier: BSD-3-Clause */
/* Looks at files, and tells what they are. */
#include "viewer/opening/files.h"

#include "options/messages.h"
#include "settings/atlas_input.h"
#include "viewer/model/session_file.h"
#include "viewer/opening/waiting.h"

#include <GLFW/glfw3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum kind { IS_OTHER = 0, IS_TRACTOGRAM, IS_SESSION };

struct looking {
    const struct wanted *wanted;
    const char *session; /* that surely is one, so that it is said why it cannot be read; NULL = none */
    enum kind *kinds;    /* [wanted->count] */
};

static enum kind look_at(const char *path)
{
    struct session_file file = {0};
    bool is_session = session_file_read(&file, path);
    session_file_finish(&file);
    return is_session ? IS_SESSION : conus_path_is_tractogram(path) ? IS_TRACTOGRAM : IS_OTHER;
}

bool files_may_be_atlas(const char *path)
{
    return look_at(path) == IS_OTHER;
}

/* On the other thread. */
static void look(void *user)
{
    const struct looking *looking = user;
    for (size_t i = 0; i < looking->wanted->count; i++) {
        const char *path = looking->wanted->paths[i];
        bool is_named = looking->session && strcmp(path, looking->session) == 0;
        looking->kinds[i] = is_named ? IS_SESSION : look_at(path);
    }
}

/* Whether there is an atlas at `path`; else `why` says why not. */
static bool is_atlas(struct window *window, const char *path, const struct view_settings *settings,
                     char why[LOADER_WHY])
{
    struct atlas_settings alone = {
        .max_memory = settings->atlas.max_memory, .no_cache = settings->atlas.no_cache, .image_is_fine = true};
    const struct context_choice none = {.opacity = 0};
    const struct loading what = {.path = path, .settings = &alone, .context = &none, .wake = glfwPostEmptyEvent};
    struct atlases atlases = {0};
    bool is = wait_load(window, &what, &atlases, why);
    atlases_finish(&atlases);
    return is;
}

static bool refuse_second(const char *one, const char *other, const char *kind, char why[LOADER_WHY])
{
    snprintf(why, LOADER_WHY, "%.200s and %.200s are two %s: open one of them", one, other, kind);
    print_error_line("%s", why);
    return false;
}

/* Takes over what opens first. */
static bool use_atlas(struct sorted *sorted, const char *path, bool is_session, char why[LOADER_WHY])
{
    if (sorted->atlas) {
        return refuse_second(sorted->atlas, path, "atlases or sessions", why);
    }
    sorted->atlas = path;
    sorted->is_session = is_session;
    return true;
}

/* Of several that may be atlases one is, and another is an image; false: why not. */
static bool find_atlas(struct sorted *sorted, struct window *window, const struct view_settings *settings,
                       char why[LOADER_WHY])
{
    size_t count = sorted->image_count;
    bool fine = true;
    sorted->image_count = 0;
    for (size_t i = 0; i < count && fine; i++) {
        const char *path = sorted->images[i];
        if (is_atlas(window, path, settings, why)) {
            fine = use_atlas(sorted, path, false, why);
        } else {
            fine = atlas_input_is_image(why) &&
                   (!sorted->image_count || refuse_second(sorted->images[0], path, "images", why));
            sorted->images[sorted->image_count++] = path;
        }
    }
    why[0] = fine ? '\0' : why[0];
    return fine;
}

static bool put(struct sorted *out, const struct looking *looking, char why[LOADER_WHY])
{
    bool fine = true;
    for (size_t i = 0; i < looking->wanted->count && fine; i++) {
        const char *path = looking->wanted->paths[i];
        if (looking->kinds[i] == IS_SESSION) {
            fine = use_atlas(out, path, true, why);
        } else if (looking->kinds[i] == IS_TRACTOGRAM) {
            out->tractograms[out->tractogram_count++] = path;
        } else {
            out->images[out->image_count++] = path;
        }
    }
    return fine;
}

bool files_sort(struct sorted *out, struct window *window, const struct wanted *wanted,
                const struct view_settings *settings, char why[LOADER_WHY])
{
    struct looking looking = {wanted, settings->session, calloc(wanted->count + 1, sizeof *looking.kinds)};
    *out = (struct sorted){.images = calloc(wanted->count + 1, sizeof *out->images),
                           .tractograms = calloc(wanted->count + 1, sizeof *out->tractograms)};
    bool fine = looking.kinds && out->images && out->tractograms;
    snprintf(why, LOADER_WHY, "%s", fine ? "" : "not enough memory");
    fine = fine && wait_look(window, wanted->paths[0], look, &looking, why) && put(out, &looking, why);
    if (fine && !out->atlas && out->image_count == 1) { /* which it is, opening it tells */
        out->atlas = out->images[0];
        out->image_count = 0;
    } else if (fine && out->image_count) {
        fine = find_atlas(out, window, settings, why);
    }
    free(looking.kinds);
    return fine;
}

void files_finish(struct sorted *sorted)
{
    free((void *)sorted->images);
    free((void *)sorted->tractograms);
}

json_t *files_add(const json_t *words, const struct sorted *sorted)
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
