/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_load(): from the cache, else from the files. */
#include "loaders/scene/load.h"
#include "base/options.h"
#include "cache/atlas_cache.h"

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
    if (!atlas) {
        atlas_cache_watch(&cache);
        status = atlas_load_files(&atlas, path, &cache.options);
        atlas_cache_watched(&cache);
        if (!status) {
            atlas_cache_keep(&cache, &atlas);
        }
    } else if (options->progress &&
               !options->progress(options->progress_user, path, 0, 1)) { /* it counts as one file */
        status = fail(CONUS_ERROR_CANCELLED, "%s: cancelled before it was read", path);
    }
    atlas_cache_finish(&cache);
    if (status) {
        conus_atlas_destroy(atlas);
        return status;
    }
    *out = atlas;
    return CONUS_OK;
}
