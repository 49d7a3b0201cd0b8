/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_load(): from the cache, else from the files. */
#include "loaders/scene/load.h"
#include "base/options.h"
#include "cache/atlas_cache.h"

/* Reports a cached atlas as one file. */
static conus_status report(const char *path, const conus_load_options *options)
{
    return !options->progress || options->progress(options->progress_user, path, 0, 1)
               ? CONUS_OK
               : fail(CONUS_ERROR_CANCELLED, "%s: cancelled before it was read", path);
}

static conus_status load_and_keep(conus_atlas **out, struct atlas_cache *cache, const char *path)
{
    atlas_cache_watch(cache);
    conus_status status = atlas_load_files(out, path, &cache->options);
    atlas_cache_watched(cache);
    if (!status) {
        atlas_cache_keep(cache, out);
    }
    return status;
}

conus_status conus_atlas_load(conus_atlas **out, const char *path, const conus_load_options *options)
{
    struct atlas_cache cache;
    if (!out || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_load: a result and a path are needed");
    }
    options = options_of(conus_load_options, options);
    conus_status status = options->cache ? cache_check_limit() : CONUS_OK;
    if (status) {
        return status;
    }
    atlas_cache_init(&cache, path, options);
    conus_atlas *atlas = atlas_cache_find(&cache);
    status = atlas ? report(path, options) : load_and_keep(&atlas, &cache, path);
    atlas_cache_finish(&cache);
    if (status) {
        conus_atlas_destroy(atlas);
        return status;
    }
    *out = atlas;
    return CONUS_OK;
}
