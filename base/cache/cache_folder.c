/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the cache's folder, says whose it is, and removes its oldest entries. */
#include "base/cache/cache_folder.h"

#include "base/memory.h"
#include "base/order.h"
#include "base/path.h"
#include "base/system/system.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

conus_status cache_folder_path(struct buffer *out)
{
    const char *cache = system_variable("XDG_CACHE_HOME");
    cache = cache ? cache : system_variable(SYSTEM_CACHE_HOME);
    const char *home = system_variable("HOME");
    if (path_is_whole(cache)) { /* the specification: relative ones are ignored */
        buffer_format(out, "%s/conus", cache);
    } else if (path_is_whole(home)) {
        buffer_format(out, "%s/.cache/conus", home);
    }
    return buffer_status(out);
}

int cache_folder_open(const char *path, bool *theirs)
{
    int folder = system_open_folder(path);
    struct system_stat info;
    bool is_link = folder < 0 && system_stat_link(&info, SYSTEM_HERE, path) && info.kind == SYSTEM_LINK;
    *theirs = folder >= 0 ? !(system_stat_open(&info, folder) && info.ours_alone) : is_link;
    if (folder >= 0 && *theirs) {
        close(folder);
        folder = -1;
    }
    return folder;
}

static bool make_folder(void *user, const char *path)
{
    (void)user;
    return system_make_folder(path, true) || errno == EEXIST;
}

bool cache_folder_make(char *path)
{
    return path_each_folder(path, 1, make_folder, NULL);
}

void cache_listing_finish(struct cache_listing *listing)
{
    memory_free(listing->items);
    *listing = (struct cache_listing){0};
}

static int compare_use(const void *a, const void *b)
{
    const struct cache_item *x = a;
    const struct cache_item *y = b;
    int order = (x->used_s > y->used_s) - (x->used_s < y->used_s);
    return order ? order : (x->used_ns > y->used_ns) - (x->used_ns < y->used_ns);
}

/* What cache_folder_list() looks for, and where. */
struct search {
    struct cache_listing *out;
    const char *ending;
    int folder;
    conus_status status;
};

static bool take_entry(void *user, const char *name)
{
    struct search *search = user;
    struct cache_listing *out = search->out;
    struct system_stat info;
    struct cache_item item = {0};
    size_t length = strlen(name);
    size_t tail = strlen(search->ending);
    if (length >= sizeof item.name || length <= tail || strcmp(name + length - tail, search->ending) != 0 ||
        !system_stat_link(&info, search->folder, name) || info.kind != SYSTEM_FILE) {
        return true;
    }
    if (!memory_reserve(&out->items, &out->capacity, out->count + 1, sizeof item)) {
        search->status = CONUS_ERROR_MEMORY;
        return false;
    }
    memcpy(item.name, name, length + 1);
    item.used_s = info.used.tv_sec;
    item.used_ns = info.used.tv_nsec;
    item.size = info.size;
    out->size += item.size;
    out->items[out->count++] = item;
    return true;
}

conus_status cache_folder_list(struct cache_listing *out, const char *path, const char *ending)
{
    struct search search = {.out = out, .ending = ending, .folder = system_open(path, SYSTEM_READ | SYSTEM_AT_ONCE)};
    if (search.folder >= 0) {
        system_list(path, take_entry, &search);
        close(search.folder);
    }
    order_sort(out->items, out->count, sizeof *out->items, compare_use);
    return search.status;
}

conus_status cache_folder_fit(const char *path, const char *ending, uint64_t limit)
{
    struct cache_listing list = {0};
    conus_status status = cache_folder_list(&list, path, ending);
    int folder = system_open(path, SYSTEM_READ | SYSTEM_AT_ONCE);
    for (size_t i = 0; !status && folder >= 0 && list.size > limit && i < list.count; i++) {
        system_remove_in(folder, list.items[i].name);
        list.size -= list.items[i].size;
    }
    if (folder >= 0) {
        close(folder);
    }
    cache_listing_finish(&list);
    return status;
}
