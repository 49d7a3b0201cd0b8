/* SPDX-License-Identifier: BSD-3-Clause */
#include "viewer/loader.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

struct loader {
    pthread_t thread;
    struct loading what;
    conus_atlas *atlas;
    atomic_bool done;
};

static void *load(void *user)
{
    struct loader *loader = user;
    const struct loading *what = &loader->what;
    int code = settings_load_atlas(&loader->atlas, what->path, what->settings);
    if (!code && settings_load_context(loader->atlas, what->context, 0, what->settings)) {
        conus_atlas_destroy(loader->atlas);
        loader->atlas = NULL;
    }
    atomic_store(&loader->done, true);
    return NULL;
}

bool loader_start(struct loader **out, const struct loading *what)
{
    struct loader *loader = calloc(1, sizeof *loader);
    if (!loader) {
        return false;
    }
    loader->what = *what;
    atomic_init(&loader->done, false);
    if (pthread_create(&loader->thread, NULL, load, loader)) {
        free(loader);
        return false;
    }
    *out = loader;
    return true;
}

bool loader_done(struct loader *loader)
{
    return atomic_load(&loader->done);
}

conus_atlas *loader_finish(struct loader *loader)
{
    pthread_join(loader->thread, NULL);
    conus_atlas *atlas = loader->atlas;
    free(loader);
    return atlas;
}
