/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists the entries of the cache, and removes them. */
#include "base/cache/cache_entry.h"
#include "base/cache/cache_folder.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "base/system/system.h"
#include "base/text.h"
#include "cache/atlas_cache.h"
#include "conus/cache.h"

#include <errno.h>
#include <string.h>

struct conus_cache {
    struct buffer folder;
    struct conus_cache_entry *entries; /* its strings are owned, except the kind */
    size_t count, capacity;
    const char *problem; /* why nothing is kept; NULL = there is none */
    bool theirs;         /* the problem is that others own the folder or can write to it */
};

static const struct kind {
    const char *ending, *word;
    bool has_key; /* which has the path of a file */
} kinds[] = {{ATLAS_CACHE_ENDING, "atlas", true}};

void conus_cache_destroy(conus_cache *cache)
{
    if (!cache) {
        return;
    }
    for (size_t i = 0; i < cache->count; i++) {
        memory_free((char *)cache->entries[i].file);
        memory_free((char *)cache->entries[i].path);
    }
    memory_free(cache->entries);
    buffer_finish(&cache->folder);
    memory_free(cache);
}

/* Without links and dots: the path of the file, else of its folder and the name in it, else as it is. NULL without
 * memory. */
static char *plain_path(const char *path)
{
    char real[SYSTEM_PATH];
    struct buffer plain = {0};
    char *folder = path_folder(path);
    if (system_real_path(real, path)) {
        buffer_text(&plain, real);
    } else if (folder && system_real_path(real, folder)) {
        buffer_format(&plain, "%s/%s", strcmp(real, "/") == 0 ? "" : real, path_base(path));
    } else {
        buffer_text(&plain, path);
    }
    memory_free(folder);
    char *copy = buffer_status(&plain) ? NULL : memory_text(plain.data, plain.size);
    buffer_finish(&plain);
    return copy;
}

/* The path in the key of the entry `name`; "" where it has none. NULL without memory. */
static char *path_of(int folder, const char *name)
{
    /* to be listed is not to be used: the time of use says what leaves first */
    int file = system_open_in(folder, name, SYSTEM_READ | SYSTEM_NO_LINK | SYSTEM_AT_ONCE | SYSTEM_UNUSED);
    struct system_stat info;
    bool readable = file >= 0 && system_stat_open(&info, file) && info.kind == SYSTEM_FILE && info.ours_alone;
    size_t size = readable ? (size_t)info.size : 0;
    void *memory = size ? system_map(file, size) : NULL;
    struct cache_entry entry;
    struct buffer path = {0};
    if (memory) {
        if (cache_entry_parse(&entry, memory, size)) {
            cache_key_path(&path, entry.key.data, entry.key.size);
        }
        system_unmap(memory, size);
    }
    if (file >= 0) {
        close(file);
    }
    char *copy = buffer_status(&path) ? NULL : path.size ? plain_path(path.data) : memory_text("", 0);
    buffer_finish(&path);
    return copy;
}

static conus_status add_entry(conus_cache *cache, int folder, const struct cache_item *item, const struct kind *kind)
{
    char *file = memory_text(item->name, strlen(item->name));
    char *path = kind->has_key ? path_of(folder, item->name) : memory_text("", 0);
    if (!file || !path ||
        !memory_reserve(&cache->entries, &cache->capacity, cache->count + 1, sizeof *cache->entries)) {
        memory_free(file);
        memory_free(path);
        return CONUS_ERROR_MEMORY;
    }
    cache->entries[cache->count++] = (struct conus_cache_entry){file, kind->word, path, item->size, item->used_s};
    return CONUS_OK;
}

static conus_status list_folder(conus_cache *cache)
{
    uint64_t limit;
    conus_status status = cache_folder_path(&cache->folder);
    int folder = !status && cache->folder.size ? cache_folder_open(cache->folder.data, &cache->theirs) : -1;
    cache->problem = !cache->folder.size    ? "neither XDG_CACHE_HOME nor HOME is an absolute path"
                     : cache->theirs        ? "others can write to the folder or own it, or it is a link"
                     : !cache_limit(&limit) ? "$CONUS_CACHE is not " CACHE_LIMITS
                                            : NULL;
    for (size_t i = 0; folder >= 0 && !status && i < sizeof kinds / sizeof kinds[0]; i++) {
        struct cache_listing list = {0};
        status = cache_folder_list(&list, cache->folder.data, kinds[i].ending);
        for (size_t k = 0; !status && k < list.count; k++) {
            status = add_entry(cache, folder, &list.items[k], &kinds[i]);
        }
        cache_listing_finish(&list);
    }
    if (folder >= 0) {
        close(folder);
    }
    return status;
}

conus_status conus_cache_create(conus_cache **out)
{
    conus_cache *cache = memory_zeroed(1, sizeof *cache);
    conus_status status = cache ? list_folder(cache) : CONUS_ERROR_MEMORY;
    if (status) {
        conus_cache_destroy(cache);
        return status;
    }
    *out = cache;
    return CONUS_OK;
}

const char *conus_cache_folder(const conus_cache *cache)
{
    return cache->folder.size ? cache->folder.data : "";
}

const char *conus_cache_problem(const conus_cache *cache)
{
    return cache->problem;
}

uint64_t conus_cache_limit(void)
{
    uint64_t limit;
    return cache_limit(&limit) ? limit : 0;
}

size_t conus_cache_count(const conus_cache *cache)
{
    return cache ? cache->count : 0;
}

const conus_cache_entry *conus_cache_entry_at(const conus_cache *cache, size_t index)
{
    return cache && index < cache->count ? &cache->entries[index] : NULL;
}

conus_status conus_cache_clear(void)
{
    conus_cache *cache = NULL;
    bool theirs;
    conus_status status = conus_cache_create(&cache);
    if (status) {
        return status;
    }
    if (cache->theirs) {
        status = fail(CONUS_ERROR_IO, "%s: not cleared, since %s", cache->folder.data, cache->problem);
    }
    int folder = !status && cache->folder.size ? cache_folder_open(cache->folder.data, &theirs) : -1;
    for (size_t i = 0; folder >= 0 && i < cache->count; i++) {
        const char *name = cache->entries[i].file;
        if (!system_remove_in(folder, name) && errno != ENOENT) {
            status = fail(CONUS_ERROR_IO, "%s/%s: cannot remove: %s", cache->folder.data, name, text_error(errno));
        }
    }
    if (folder >= 0) {
        close(folder);
    }
    conus_cache_destroy(cache);
    return status;
}
