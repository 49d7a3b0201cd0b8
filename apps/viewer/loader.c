/* SPDX-License-Identifier: BSD-3-Clause */
/* The thread that loads the atlas, and its progress. */
#include "viewer/loader.h"

#include "common/messages.h"
#include "settings/atlas_input.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct loader {
    pthread_t thread;
    struct loading what;
    conus_atlas *atlas;
    size_t total; /* files but for the context; the thread's own */
    char why[LOADER_WHY];
    atomic_bool cancelled;
    pthread_mutex_t lock; /* guards what follows */
    bool done;
    struct loader_progress progress;
};

/* What is read is shown, so that who waits knows what for. */
static bool note(void *user, const char *path, size_t done, size_t total)
{
    struct loader *loader = user;
    const char *slash = strrchr(path, '/');
    loader->total = total;
    total += loader->what.context != NULL;
    pthread_mutex_lock(&loader->lock);
    snprintf(loader->progress.file, sizeof loader->progress.file, "%s", slash && slash[1] ? slash + 1 : path);
    make_plain_line(loader->progress.file);
    loader->progress.part = done < total ? (double)done / (double)total : 1;
    pthread_mutex_unlock(&loader->lock);
    return !atomic_load(&loader->cancelled);
}

static void *load(void *user)
{
    struct loader *loader = user;
    const struct loading *what = &loader->what;
    struct atlas_settings settings = *what->settings;
    settings.progress = note;
    settings.progress_user = loader;
    int code = settings_load_atlas(&loader->atlas, what->path, &settings);
    if (!code && what->context) {
        bool goes_on = note(loader, what->context, loader->total, loader->total);
        code = goes_on ? settings_load_context(loader->atlas, what->context, 0, what->settings) : EXIT_DATA;
    }
    if (code || atomic_load(&loader->cancelled)) {
        snprintf(loader->why, sizeof loader->why, "%s", atomic_load(&loader->cancelled) ? "" : error_line());
        conus_atlas_destroy(loader->atlas);
        loader->atlas = NULL;
    }
    pthread_mutex_lock(&loader->lock);
    loader->done = true;
    pthread_mutex_unlock(&loader->lock);
    what->wake();
    return NULL;
}

bool loader_start(struct loader **out, const struct loading *what)
{
    struct loader *loader = calloc(1, sizeof *loader);
    if (!loader) {
        return false;
    }
    loader->what = *what;
    pthread_mutex_init(&loader->lock, NULL);
    if (pthread_create(&loader->thread, NULL, load, loader)) {
        pthread_mutex_destroy(&loader->lock);
        free(loader);
        return false;
    }
    *out = loader;
    return true;
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

bool loader_done(struct loader *loader)
{
    pthread_mutex_lock(&loader->lock);
    bool done = loader->done;
    pthread_mutex_unlock(&loader->lock);
    return done;
}

conus_atlas *loader_finish(struct loader *loader, char why[LOADER_WHY])
{
    pthread_join(loader->thread, NULL);
    conus_atlas *atlas = loader->atlas;
    memcpy(why, loader->why, LOADER_WHY);
    pthread_mutex_destroy(&loader->lock);
    free(loader);
    return atlas;
}
