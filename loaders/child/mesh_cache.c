/* SPDX-License-Identifier: BSD-3-Clause */
/* Stores and finds results by key, and removes the oldest ones. */
#include "loaders/child/mesh_cache.h"

#include "base/byte_order.h"
#include "base/folder.h"
#include "base/memory.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <libdeflate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* An entry: the content, then these bytes, u64 bytes of content and u32 their CRC-32, both little-endian, u32 0. */
static const char magic[8] = "CONUSMC1";
static const char ending[] = ".mesh";

enum { TAIL_SIZE = 24, SWAPPED = !BIG_ENDIAN_IS_SWAPPED };

conus_status mesh_cache_folder(struct buffer *out)
{
    const char *cache = getenv("XDG_CACHE_HOME");
    const char *home = getenv("HOME");
    if (cache && cache[0] == '/') { /* the specification: relative ones are ignored */
        buffer_format(out, "%s/conus", cache);
    } else if (home && home[0] == '/') {
        buffer_format(out, "%s/.cache/conus", home);
    }
    return buffer_status(out);
}

static conus_status entry_path(struct buffer *out, const char *key)
{
    conus_status status = mesh_cache_folder(out);
    if (!status && out->size) {
        buffer_format(out, "/%s%s", key, ending);
        status = buffer_status(out);
    }
    return status;
}

void mesh_cache_key(char key[MESH_CACHE_KEY_SIZE], const struct buffer *recipe)
{
    const struct bytes bytes = {(uint8_t *)recipe->data, recipe->size};
    file_sha256(key, &bytes);
}

static void write_tail(uint8_t tail[TAIL_SIZE], const void *content, uint64_t size)
{
    uint32_t sum = libdeflate_crc32(0, content, (size_t)size);
    memset(tail, 0, TAIL_SIZE);
    memcpy(tail, magic, sizeof magic);
    for (int i = 0; i < 8; i++) {
        tail[8 + i] = (uint8_t)(size >> 8 * i);
    }
    for (int i = 0; i < 4; i++) {
        tail[16 + i] = (uint8_t)(sum >> 8 * i);
    }
}

size_t mesh_cache_content(const void *entry, size_t size)
{
    uint8_t tail[TAIL_SIZE];
    if (!entry || size < TAIL_SIZE) {
        return SIZE_MAX;
    }
    write_tail(tail, entry, size - TAIL_SIZE);
    bool whole = memcmp(tail, (const uint8_t *)entry + size - TAIL_SIZE, TAIL_SIZE) == 0;
    return whole ? size - TAIL_SIZE : SIZE_MAX;
}

/* ---- Whose it is --------------------------------------------------------------------------------------------- */

/* What others can write is not to be believed, and nothing of it is kept. */
static bool is_ours(int descriptor, mode_t kind)
{
    struct stat info;
    return fstat(descriptor, &info) == 0 && (info.st_mode & S_IFMT) == kind && info.st_uid == geteuid() &&
           !(info.st_mode & (S_IWGRP | S_IWOTH));
}

static conus_status note_others(struct notes *notes, const char *path)
{
    return notes_warn(notes, "%s: not used, since others can write to it or own it", path);
}

/* The folder, -1 if there is none or if it is not ours alone, which is noted. */
static conus_status open_folder(int *out, const char *path, struct notes *notes)
{
    conus_status status = CONUS_OK;
    *out = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (*out >= 0 && !is_ours(*out, S_IFDIR)) {
        close(*out);
        *out = -1;
        status = note_others(notes, path);
    }
    return status;
}

/* The bytes of an open entry; none if they cannot be read. */
static conus_status read_entry(struct bytes *out, int descriptor)
{
    struct stat info;
    if (fstat(descriptor, &info) || info.st_size < TAIL_SIZE || (uint64_t)info.st_size > MESH_CACHE_LIMIT) {
        return CONUS_OK;
    }
    struct bytes entry = {memory_raw((size_t)info.st_size, 1), 0};
    if (!entry.data) {
        return CONUS_ERROR_MEMORY;
    }
    for (ssize_t got = 1; got > 0 || (got < 0 && errno == EINTR);) {
        got = read(descriptor, entry.data + entry.size, (size_t)info.st_size - entry.size);
        entry.size += got > 0 ? (size_t)got : 0;
    }
    *out = entry;
    return CONUS_OK;
}

static conus_status take_entry(struct bytes *out, int descriptor, const char *path, struct notes *notes)
{
    struct bytes entry = {0};
    conus_status status = is_ours(descriptor, S_IFREG) ? read_entry(&entry, descriptor) : note_others(notes, path);
    size_t size = mesh_cache_content(entry.data, entry.size);
    if (!status && size != SIZE_MAX) {
        *out = (struct bytes){entry.data, size};
        entry = (struct bytes){0};
        futimens(descriptor, NULL); /* used just now */
    }
    memory_free(entry.data);
    return status;
}

conus_status mesh_cache_find(struct bytes *out, const char *key, struct notes *notes)
{
    struct buffer folder_path = {0};
    struct buffer path = {0};
    int folder = -1;
    conus_status status = mesh_cache_folder(&folder_path);
    status = status ? status : entry_path(&path, key);
    if (!status && path.size && folder_path.data) {
        status = open_folder(&folder, folder_path.data, notes);
    }
    if (folder >= 0) {
        int entry = openat(folder, path_base(path.data), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        status = entry >= 0       ? take_entry(out, entry, path.data, notes)
                 : errno == ELOOP ? note_others(notes, path.data)
                                  : CONUS_OK;
        if (entry >= 0) {
            close(entry);
        }
        close(folder);
    }
    buffer_finish(&folder_path);
    buffer_finish(&path);
    return status;
}

/* ---- Keeping ------------------------------------------------------------------------------------------------ */

static bool make_folders(char *path)
{
    for (char *c = path + 1; *c; c++) {
        if (*c == '/') {
            *c = '\0';
            bool there = mkdir(path, 0700) == 0 || errno == EEXIST;
            *c = '/';
            if (!there) {
                return false;
            }
        }
    }
    return true;
}

struct entry {
    char name[96];
    struct timespec used;
    uint64_t size;
};

struct listing {
    struct entry *entries;
    size_t count, capacity;
    uint64_t size;
};

static conus_status list_entry(struct listing *list, int folder, const char *name)
{
    struct stat info;
    struct entry entry = {0};
    size_t length = strlen(name);
    size_t tail = strlen(ending);
    if (length >= sizeof entry.name || length <= tail || strcmp(name + length - tail, ending) != 0 ||
        fstatat(folder, name, &info, AT_SYMLINK_NOFOLLOW) || !S_ISREG(info.st_mode)) {
        return CONUS_OK;
    }
    if (list->count == list->capacity) {
        size_t capacity = 2 * list->capacity + 64;
        struct entry *grown = memory_resize(list->entries, capacity, sizeof *grown);
        if (!grown) {
            return CONUS_ERROR_MEMORY;
        }
        list->entries = grown;
        list->capacity = capacity;
    }
    memcpy(entry.name, name, length + 1);
    entry.used = info.st_mtim;
    entry.size = (uint64_t)info.st_size;
    list->size += entry.size;
    list->entries[list->count++] = entry;
    return CONUS_OK;
}

static int compare_use(const void *a, const void *b)
{
    const struct timespec *x = &((const struct entry *)a)->used;
    const struct timespec *y = &((const struct entry *)b)->used;
    if (x->tv_sec != y->tv_sec) {
        return x->tv_sec > y->tv_sec ? 1 : -1;
    }
    return (x->tv_nsec > y->tv_nsec) - (x->tv_nsec < y->tv_nsec);
}

/* Removes what was not used for longest, until the rest fits. */
static conus_status make_space(const char *folder_path, uint64_t limit)
{
    DIR *folder = opendir(folder_path);
    struct listing list = {0};
    conus_status status = CONUS_OK;
    if (!folder) {
        return CONUS_OK;
    }
    for (struct dirent *item; !status && (item = readdir(folder));) {
        status = list_entry(&list, dirfd(folder), item->d_name);
    }
    if (list.count) {
        qsort(list.entries, list.count, sizeof *list.entries, compare_use);
    }
    for (size_t i = 0; !status && list.size > limit && i < list.count; i++) {
        unlinkat(dirfd(folder), list.entries[i].name, 0);
        list.size -= list.entries[i].size;
    }
    closedir(folder);
    memory_free(list.entries);
    return status;
}

/* A checksum detects a damaged entry, so that nothing need wait for the disk. */
static conus_status write_entry(const struct buffer *path, const struct buffer *content)
{
    struct buffer temporary = {0};
    uint8_t tail[TAIL_SIZE];
    buffer_format(&temporary, "%s.XXXXXX%s", path->data, ending); /* an entry like others, should it be left behind */
    conus_status status = buffer_status(&temporary);
    int descriptor = status ? -1 : mkostemps(temporary.data, (int)strlen(ending), O_CLOEXEC);
    if (descriptor >= 0) {
        write_tail(tail, content->data, content->size);
        bool written = file_write_fully(descriptor, content->data, content->size) &&
                       file_write_fully(descriptor, tail, sizeof tail);
        written = close(descriptor) == 0 && written;
        if (!written || rename(temporary.data, path->data)) {
            unlink(temporary.data);
        }
    }
    buffer_finish(&temporary);
    return status;
}

conus_status mesh_cache_keep_within(const char *key, const struct buffer *content, uint64_t limit)
{
    struct buffer path = {0};
    struct notes said = {0}; /* when it was looked for */
    int folder = -1;
    conus_status status = entry_path(&path, key);
    if (!status && path.size && content->size + TAIL_SIZE <= limit && make_folders(path.data)) {
        char *end = strrchr(path.data, '/');
        *end = '\0';
        status = open_folder(&folder, path.data, &said);
        *end = '/';
        status = status || folder < 0 ? status : write_entry(&path, content);
        *end = '\0';
        status = status || folder < 0 ? status : make_space(path.data, limit);
    }
    if (folder >= 0) {
        close(folder);
    }
    notes_finish(&said);
    buffer_finish(&path);
    return status;
}

conus_status mesh_cache_keep(const char *key, const struct buffer *content)
{
    return mesh_cache_keep_within(key, content, MESH_CACHE_LIMIT);
}
