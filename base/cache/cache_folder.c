/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the cache's folder, says whose it is, and removes its oldest entries. */
#include "base/cache/cache_folder.h"

#include "base/memory.h"
#include "base/path.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

conus_status cache_folder_path(struct buffer *out)
{
    const char *cache = getenv("XDG_CACHE_HOME");
    const char *home = getenv("HOME");
    if (path_is_whole(cache)) { /* the specification: relative ones are ignored */
        buffer_format(out, "%s/conus", cache);
    } else if (path_is_whole(home)) {
        buffer_format(out, "%s/.cache/conus", home);
    }
    return buffer_status(out);
}

bool cache_is_ours(int descriptor, mode_t kind)
{
    struct stat info;
    return fstat(descriptor, &info) == 0 && (info.st_mode & S_IFMT) == kind && info.st_uid == geteuid() &&
           !(info.st_mode & (S_IWGRP | S_IWOTH));
}

int cache_folder_open(const char *path, bool *theirs)
{
    int folder = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    struct stat info;
    bool is_link = folder < 0 && lstat(path, &info) == 0 && S_ISLNK(info.st_mode);
    *theirs = folder >= 0 ? !cache_is_ours(folder, S_IFDIR) : is_link;
    if (folder >= 0 && *theirs) {
        close(folder);
        folder = -1;
    }
    return folder;
}

static bool make_folder(void *user, const char *path)
{
    (void)user;
    return mkdir(path, 0700) == 0 || errno == EEXIST;
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

conus_status cache_folder_list(struct cache_listing *out, const char *path, const char *ending)
{
    DIR *folder = opendir(path);
    size_t tail = strlen(ending);
    conus_status status = CONUS_OK;
    for (struct dirent *entry; folder && !status && (entry = readdir(folder));) {
        struct stat info;
        struct cache_item item = {0};
        size_t length = strlen(entry->d_name);
        if (length >= sizeof item.name || length <= tail || strcmp(entry->d_name + length - tail, ending) != 0 ||
            fstatat(dirfd(folder), entry->d_name, &info, AT_SYMLINK_NOFOLLOW) || !S_ISREG(info.st_mode)) {
            continue;
        }
        if (!memory_reserve(&out->items, &out->capacity, out->count + 1, sizeof item)) {
            status = CONUS_ERROR_MEMORY;
            break;
        }
        memcpy(item.name, entry->d_name, length + 1);
        item.used_s = info.st_atim.tv_sec;
        item.used_ns = info.st_atim.tv_nsec;
        item.size = (uint64_t)info.st_size;
        out->size += item.size;
        out->items[out->count++] = item;
    }
    if (folder) {
        closedir(folder);
    }
    if (out->count) {
        qsort(out->items, out->count, sizeof *out->items, compare_use);
    }
    return status;
}

conus_status cache_folder_fit(const char *path, const char *ending, uint64_t limit)
{
    struct cache_listing list = {0};
    conus_status status = cache_folder_list(&list, path, ending);
    int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    for (size_t i = 0; !status && folder >= 0 && list.size > limit && i < list.count; i++) {
        unlinkat(folder, list.items[i].name, 0);
        list.size -= list.items[i].size;
    }
    if (folder >= 0) {
        close(folder);
    }
    cache_listing_finish(&list);
    return status;
}
