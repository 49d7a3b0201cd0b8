/* SPDX-License-Identifier: BSD-3-Clause */
/* The thread that reads files, and its progress. */
#include "viewer/opening/opening.h"

#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/settings.h"

#include <GLFW/glfw3.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct loader {
    pthread_t thread;
    struct loading request;
    struct atlases atlases;
    size_t before, total; /* files of the atlases before, and with those of the one at hand; the thread's own */
    size_t ahead;         /* atlases behind it, a file each, and one for the context; likewise */
    char why[LOADER_WHY];
    bool stopped; /* a load, because it was cancelled; the thread's own */
    atomic_bool cancelled;
    pthread_mutex_t lock; /* guards what follows */
    struct loader_progress progress;
};

/* Notes the file that is read, for the window. False: the user cancelled. */
static bool show_file(struct loader *loader, const char *path, size_t done, size_t total)
{
    pthread_mutex_lock(&loader->lock);
    snprintf(loader->progress.file, sizeof loader->progress.file, "%s", path_name(path));
    make_plain_line(loader->progress.file);
    loader->progress.part = done < total ? (double)done / (double)total : 1;
    pthread_mutex_unlock(&loader->lock);
    loader->stopped = atomic_load(&loader->cancelled);
    return !loader->stopped;
}

/* Adds the files of the atlases before: each atlas counts its own files from 0. */
static bool note_progress(void *user, const char *path, size_t done, size_t total)
{
    struct loader *loader = user;
    if (!done) {
        loader->before = loader->total;
        loader->ahead--;
    }
    loader->total = loader->before + total;
    return show_file(loader, path, loader->before + done, loader->total + loader->ahead);
}

/* The paths of an atlas's context, as conus_atlas_load() takes them. */
struct own_context {
    struct context_choice choice;
    char *volume; /* of which it is the first, if there is one */
};

static void own_context_finish(struct own_context *own)
{
    free(own->choice.files.items);
    free(own->volume);
}

static void own_context_find(struct own_context *out, const conus_atlas *atlas)
{
    size_t surfaces = conus_atlas_context_surface_count(atlas);
    struct option_list *files = &out->choice.files;
    *out = (struct own_context){0};
    files->items = calloc(surfaces + 1, sizeof *files->items);
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        const conus_volume_info *info = conus_atlas_volume(atlas, i);
        if (info->role == CONUS_ROLE_CONTEXT &&
            asprintf(&out->volume, info->volume_count > 1 ? "%s,volume=%zu" : "%s", info->path, info->volume) < 0) {
            out->volume = NULL;
        }
    }
    if (files->items && out->volume) {
        files->items[files->count++] = out->volume;
    }
    for (size_t i = 0; i < surfaces && files->items; i++) {
        conus_context_surface surface = CONUS_CONTEXT_SURFACE_INIT;
        if (!conus_atlas_context_surface(&surface, atlas, i)) {
            files->items[files->count++] = surface.path;
            out->choice.opacity = surface.opacity;
        }
    }
}

static bool has_context(const conus_atlas *atlas)
{
    struct own_context own;
    own_context_find(&own, atlas);
    bool has = own.choice.files.count > 0;
    own_context_finish(&own);
    return has;
}

static int set_context(struct loader *loader, size_t index, const struct context_choice *choice)
{
    const char *path = choice->files.count ? choice->files.items[0] : choice->map;
    bool goes_on = show_file(loader, path, loader->total, loader->total + 1);
    return goes_on ? context_choice_load(loader->atlases.items[index].atlas, choice, loader->request.settings)
                   : EXIT_DATA;
}

/* Any atlas may be drawn: each has the context, or its own. What no option asked for is no reason to load nothing. */
static int set_contexts(struct loader *loader)
{
    const struct atlases *atlases = &loader->atlases;
    const struct context_choice *given = loader->request.context;
    struct own_context own;
    own_context_find(&own, atlases->items[0].atlas);
    const struct context_choice *choice = given->files.count ? given : &own.choice;
    int code = given->files.count || given->map ? set_context(loader, 0, given) : EXIT_DONE;
    for (size_t i = 1; i < atlases->count && choice->files.count && !code; i++) {
        int failed = has_context(atlases->items[i].atlas) ? EXIT_DONE : set_context(loader, i, choice);
        code = given->files.count ? failed : EXIT_DONE;
    }
    own_context_finish(&own);
    return code;
}

static void load(struct loader *loader)
{
    const struct loading *request = &loader->request;
    struct atlas_settings settings = *request->settings;
    settings.progress = note_progress;
    settings.progress_user = loader;
    if (request->may_be && !request->may_be(request->path)) {
        return;
    }
    if (settings.shelf) {
        tract_shelf_begin(settings.shelf, request->again);
    }
    loader->ahead = settings.more.count + 1 + (request->context->files.count || request->context->map);
    int code = atlases_load(&loader->atlases, request->path, &settings, NULL);
    code = code ? code : set_contexts(loader);
    if (code || atomic_load(&loader->cancelled)) {
        snprintf(loader->why, sizeof loader->why, "%s", code && !loader->stopped ? error_line() : "");
        atlases_finish(&loader->atlases);
    }
}

static void *run(void *user)
{
    struct loader *loader = user;
    if (loader->request.task) {
        (void)show_file(loader, loader->request.path, 0, 1);
        loader->request.task(loader->request.user);
    } else {
        load(loader);
    }
    pthread_mutex_lock(&loader->lock);
    loader->progress.done = true;
    pthread_mutex_unlock(&loader->lock);
    glfwPostEmptyEvent();
    return NULL;
}

bool loader_start(struct loader **out, const struct loading *request)
{
    struct loader *loader = calloc(1, sizeof *loader);
    if (!loader) {
        return false;
    }
    loader->request = *request;
    pthread_mutex_init(&loader->lock, NULL);
    if (pthread_create(&loader->thread, NULL, run, loader)) {
        pthread_mutex_destroy(&loader->lock);
        free(loader);
        return false;
    }
    *out = loader;
    return true;
}

const char *loader_path(const struct loader *loader)
{
    return loader->request.path;
}

void loader_ask(struct loader *loader, struct loader_progress *out)
{
    pthread_mutex_lock(&loader->lock);
    *out = loader->progress;
    pthread_mutex_unlock(&loader->lock);
}

void loader_cancel(struct loader *loader)
{
    atomic_store(&loader->cancelled, true);
}

bool loader_finish(struct loader *loader, struct atlases *out, char why[LOADER_WHY])
{
    pthread_join(loader->thread, NULL);
    *out = loader->atlases;
    memcpy(why, loader->why, LOADER_WHY);
    bool fine = loader->request.task ? !atomic_load(&loader->cancelled) : out->count > 0;
    pthread_mutex_destroy(&loader->lock);
    free(loader);
    return fine;
}
