/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes small atlases and puts them into the cache. */
#include "builders/cache_builder.h"

#include "base/files/file.h"
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "loaders/scene/load.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const conus_load_options caching = {.struct_size = sizeof caching, .cache = true};

const char *cached_atlas(const char *name, int label)
{
    static char paths[4][8192];
    static int turn;
    static const int64_t dim[3] = {3, 3, 3};
    char here[4096];
    char table[8192 + 8];
    char *path = paths[turn++ % 4];
    struct nifti_builder builder;
    assert_non_null(getcwd(here, sizeof here));
    snprintf(path, sizeof paths[0], "%s/%s", here, test_scratch(name));
    nifti_begin(&builder, 1, false, 4 /* int16 */, dim);
    for (int i = 0; i < CACHED_VOXELS; i++) {
        nifti_voxel(&builder, i == CACHED_VOXELS - 1 ? label : i % 3);
    }
    assert_ok(file_write_soon(path, builder.bytes.data, builder.bytes.size));
    snprintf(table, sizeof table, "%.*s.txt", (int)(strlen(path) - strlen(".nii")), path);
    static const char rows[] = "1 One\n2 Two\n5 Five\n6 Six\n";
    assert_ok(file_write_soon(table, rows, strlen(rows)));
    buffer_finish(&builder.bytes);
    return path;
}

conus_atlas *load_and_keep_rested(const char *path, const conus_load_options *options)
{
    struct atlas_cache cache;
    conus_atlas *atlas = NULL;
    atlas_cache_init(&cache, path, "atlas", options ? options : &caching);
    atlas_cache_begin_reading(&cache);
    conus_status status = atlas_load_files(&atlas, path, &cache.options);
    atlas_cache_end_reading(&cache);
    cache.trace.begun.tv_sec += 2 * TRACE_REST_ELSEWHERE_SECONDS;
    if (!status) {
        atlas_cache_keep(&cache, &atlas);
    }
    atlas_cache_finish(&cache);
    return atlas;
}

conus_atlas *find_in_cache(const char *path, const conus_load_options *options, uint64_t small)
{
    struct atlas_cache cache;
    atlas_cache_init(&cache, path, "atlas", options ? options : &caching);
    cache.store.small = small;
    conus_atlas *atlas = atlas_cache_find(&cache);
    atlas_cache_finish(&cache);
    return atlas;
}

bool is_in_cache(const char *path)
{
    conus_atlas *atlas = find_in_cache(path, NULL, UINT64_MAX);
    conus_atlas_destroy(atlas);
    return atlas;
}

const char *entry_of(const char *path)
{
    static char entry[8192];
    struct atlas_cache cache;
    atlas_cache_init(&cache, path, "atlas", &caching);
    snprintf(entry, sizeof entry, "%s", cache.store.path.size ? cache.store.path.data : "");
    atlas_cache_finish(&cache);
    return entry;
}

struct bytes packed_bytes(const conus_atlas *atlas)
{
    enum { LINE = 64 };
    size_t size = conus_atlas_packed_size(atlas);
    struct bytes bytes = {aligned_alloc(LINE, (size + LINE - 1) / LINE * LINE), size};
    assert_non_null(bytes.data);
    memset(bytes.data, 0, size);
    assert_ok(conus_atlas_pack(bytes.data, size, atlas));
    return bytes;
}

void assert_cached_is_loaded(const char *path)
{
    conus_atlas *loaded = NULL;
    conus_atlas *cached = find_in_cache(path, NULL, UINT64_MAX);
    assert_non_null(cached);
    assert_ok(conus_atlas_load(&loaded, path, NULL));
    struct bytes a = packed_bytes(loaded);
    struct bytes b = packed_bytes(cached);
    assert_int_equal(a.size, b.size);
    for (size_t i = 0; i < a.size; i++) {
        if (a.data[i] != b.data[i]) {
            print_message("byte %zu of %zu: %d, in the cache %d\n", i, a.size, a.data[i], b.data[i]);
            break;
        }
    }
    assert_memory_equal(a.data, b.data, a.size);
    bytes_finish(&a);
    bytes_finish(&b);
    conus_atlas_destroy(loaded);
    conus_atlas_destroy(cached);
}
