/* SPDX-License-Identifier: BSD-3-Clause */
/* Names, believes and writes entries of the cache. */
#include "base/cache/cache_store.h"

#include "base/cache/cache_folder.h"
#include "base/files/file_trace.h"
#include "base/memory.h"
#include "base/path.h"
#include "base/system/build_id.h"
#include "base/system/system.h"
#include "conus/version.h"

#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined __x86_64__
#define CPU "x86-64"
#elif defined __aarch64__
#define CPU "arm64"
#else
#define CPU "other"
#endif

bool cache_limit(uint64_t *out)
{
    static const char units[] = "KMGT";
    const char *text = system_variable("CONUS_CACHE");
    char *end = NULL;
    *out = CACHE_LIMIT;
    if (!text || !*text) {
        return true;
    }
    errno = 0;
    uint64_t size = strtoull(text, &end, 10);
    const char *unit = *end ? strchr(units, *end) : NULL;
    unsigned shift = unit ? 10 * (unsigned)(unit - units + 1) : 0;
    bool is_size =
        text[0] >= '0' && text[0] <= '9' && !errno && (!*end || (unit && !end[1])) && size <= UINT64_MAX >> shift;
    *out = is_size ? size << shift : 0;
    return is_size || strcmp(text, "off") == 0;
}

conus_status cache_check_limit(void)
{
    uint64_t limit;
    return cache_limit(&limit) ? CONUS_OK
                               : fail(CONUS_ERROR_ARGUMENT, "$CONUS_CACHE: \"%s\"; allowed is " CACHE_LIMITS,
                                      system_variable("CONUS_CACHE"));
}

/* Appends a string and its end; a mark tells NULL from an empty one. */
void cache_key_append(struct buffer *key, const char *text)
{
    buffer_append(key, text ? "=" : "-", 1);
    buffer_append(key, text ? text : "", strlen(text ? text : "") + 1);
}

bool cache_store_begin(struct cache_store *store, const char *ending, const char *path, bool relative)
{
    char build[BUILD_ID_SIZE];
    char here[SYSTEM_PATH] = "";
    *store = (struct cache_store){.ending = ending, .small = CACHE_SMALL};
    if (!cache_limit(&store->limit) || !store->limit || !build_id_find(build)) {
        return false;
    }
    cache_key_append(&store->key, "conus " CONUS_VERSION);
    cache_key_append(&store->key, build);
    cache_key_append(&store->key, __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? CPU " little" : CPU " big");
    cache_key_append(&store->key, relative && system_here(here) ? here : NULL);
    cache_key_append(&store->key, path);
    return true;
}

void cache_store_name(struct cache_store *store)
{
    char name[65];
    const struct bytes bytes = {(uint8_t *)store->key.data, store->key.size};
    if (buffer_status(&store->key) || cache_folder_path(&store->path) || !store->path.size) {
        buffer_clear(&store->path);
        return;
    }
    file_sha256(name, &bytes);
    buffer_format(&store->path, "/%s%s", name, store->ending);
    if (buffer_status(&store->path)) {
        buffer_clear(&store->path);
    }
}

void cache_store_finish(struct cache_store *store)
{
    buffer_finish(&store->key);
    buffer_finish(&store->path);
}

/* The string of a key behind `before` others, NULL where there is none. */
static const char *key_string(const uint8_t *key, size_t size, int before)
{
    for (const uint8_t *end; (end = memchr(key, 0, size)) && end != key; before--) {
        if (!before) {
            return (const char *)key + 1;
        }
        size -= (size_t)(end + 1 - key);
        key = end + 1;
    }
    return NULL;
}

void cache_key_path(struct buffer *out, const uint8_t *key, size_t size)
{
    enum { HERE = 3, PATH = 4 };
    const char *here = key_string(key, size, HERE);
    const char *path = key_string(key, size, PATH);
    if (path && !path_is_whole(path) && here && here[0]) {
        buffer_format(out, "%s/", here);
    }
    buffer_text(out, path ? path : "");
}

/* The name of the entry in its folder. */
static const char *name_in_folder(const struct cache_store *store)
{
    return path_base(store->path.data);
}

/* The folder, -1 where it is not there, or not ours alone. */
static int open_folder(const struct cache_store *store)
{
    bool theirs;
    char *cut = path_cut(store->path.data);
    int folder = cache_folder_open(store->path.data, &theirs);
    path_join_again(cut);
    return folder;
}

/* Whether every file and folder is as it was. */
static bool sources_hold(const struct cache_entry *entry, const struct cache_part *written)
{
    struct file_trace trace = {0};
    if (written->size && written->size == entry->trace.size &&
        memcmp(written->data, entry->trace.data, written->size) == 0) {
        return true;
    }
    bool same = file_trace_parse(&trace, entry->trace.data, entry->trace.size) && file_trace_holds(&trace);
    if (same) {
        file_trace_tell(&trace);
    }
    file_trace_finish(&trace);
    return same;
}

/* Writes into the open entry that all of it was verified. Whatever writes to it later changes the file's time of
 * writing. */
static void mark_verified(int descriptor)
{
    int file = system_open_again(descriptor);
    if (file >= 0) {
        uint8_t stamp[CACHE_STAMP_SIZE];
        struct timespec now;
        bool marked = clock_gettime(CLOCK_REALTIME, &now) == 0 && cache_stamp_find(stamp, file, &now) &&
                      system_write_at(file, stamp, sizeof stamp, cache_entry_stamp_at()) &&
                      system_set_changed(file, &now);
        (void)marked; /* else it is verified again */
        close(file);
    }
}

/* Small entries are verified each time, large ones once in each run of the kernel and after they were written to. */
static bool verify(const struct cache_entry *entry, uint64_t small, int descriptor)
{
    uint8_t stamp[CACHE_STAMP_SIZE];
    struct system_stat info;
    bool verified = system_stat_open(&info, descriptor) && cache_stamp_find(stamp, descriptor, &info.changed) &&
                    memcmp(stamp, entry->stamp, sizeof stamp) == 0;
    if (verified && entry->packed.size > small) {
        return true;
    }
    if (!cache_entry_is_whole(entry)) {
        return false;
    }
    if (!verified && entry->packed.size > small) {
        mark_verified(descriptor);
    }
    return true;
}

void cache_mapping_finish(struct cache_mapping *mapping)
{
    if (mapping->memory) {
        system_unmap(mapping->memory, mapping->size);
    }
    *mapping = (struct cache_mapping){0};
}

static bool map_believed(struct cache_mapping *out, const struct cache_store *store, int descriptor)
{
    struct system_stat info;
    if (!system_stat_open(&info, descriptor) || info.kind != SYSTEM_FILE || !info.ours_alone || !info.size) {
        return false;
    }
    void *memory = system_map(descriptor, (size_t)info.size);
    if (!memory) {
        return false;
    }
    struct cache_mapping mapping = {.memory = memory, .size = (size_t)info.size};
    bool believed = cache_entry_parse(&mapping.entry, mapping.memory, mapping.size) &&
                    mapping.entry.key.size == store->key.size &&
                    memcmp(mapping.entry.key.data, store->key.data, mapping.entry.key.size) == 0 &&
                    sources_hold(&mapping.entry, &store->written) && verify(&mapping.entry, store->small, descriptor);
    if (!believed) {
        cache_mapping_finish(&mapping);
        return false;
    }
    system_set_used(descriptor);
    *out = mapping;
    return true;
}

bool cache_store_map(struct cache_mapping *out, const struct cache_store *store)
{
    int folder = store->path.size ? open_folder(store) : -1;
    int entry =
        folder < 0 ? -1 : system_open_in(folder, name_in_folder(store), SYSTEM_READ | SYSTEM_NO_LINK | SYSTEM_AT_ONCE);
    bool believed = entry >= 0 && map_believed(out, store, entry);
    if (entry >= 0) {
        close(entry);
    }
    if (folder >= 0) {
        close(folder);
    }
    return believed;
}

/* The checksum of the written bytes, as they are read back. */
static bool sum_file(uint32_t *out, int file, size_t at, size_t size)
{
    enum { CHUNK = 1 << 20 };
    uint8_t *chunk = memory_raw(CHUNK, 1);
    uint32_t sum = 0;
    while (chunk && size) {
        ptrdiff_t n = system_read_at(file, chunk, size < CHUNK ? size : CHUNK, at);
        if (n <= 0) {
            break;
        }
        sum = cache_crc(sum, chunk, (size_t)n);
        at += (size_t)n;
        size -= (size_t)n;
    }
    bool whole = chunk && size == 0;
    memory_free(chunk);
    *out = sum;
    return whole;
}

/* A large one is on the disk before it has a name: an error of the disk shows here, and a crash leaves no half of it.
 * The checksum of a small one is verified each time. */
static bool write_entry(int file, struct cache_entry *entry, uint64_t small, cache_writer *write, void *user)
{
    size_t at = cache_entry_packed_at(entry);
    size_t size = at + entry->packed.size;
    struct timespec now = {0};
    clock_gettime(CLOCK_REALTIME, &now);
    cache_stamp_find(entry->stamp, file, &now); /* else it is verified each time */
    if (!system_reserve(file, size) || !write(user, file, at) ||
        !sum_file(&entry->packed_crc, file, at, entry->packed.size)) {
        return false;
    }
    struct buffer ahead = {0};
    cache_entry_write(&ahead, entry);
    bool written = !buffer_status(&ahead) && system_write_at(file, ahead.data, ahead.size, 0);
    buffer_finish(&ahead);
    return written && (entry->packed.size <= small || system_to_disk(file)) && system_set_changed(file, &now);
}

/* Under a name of its own at first; an entry like others, should it be left behind. */
static bool write_and_rename(struct cache_store *store, int folder, struct cache_entry *entry, cache_writer *write,
                             void *user)
{
    struct buffer temporary = {0};
    buffer_format(&temporary, "%s.XXXXXX%s", store->path.data, store->ending);
    int file = buffer_status(&temporary) ? -1 : system_open_temporary(temporary.data, strlen(store->ending), true);
    bool written = file >= 0 && write_entry(file, entry, store->small, write, user);
    if (file >= 0) {
        const char *name = path_base(temporary.data);
        written = close(file) == 0 && written;
        if (!written || !system_rename_in(folder, name, name_in_folder(store))) {
            system_remove_in(folder, name);
            written = false;
        }
    }
    buffer_finish(&temporary);
    return written;
}

/* Makes space for an entry: others leave, those unused for longest first. False where it is too large for the cache,
 * for a limit on the sizes of files (ulimit -f), which ends programs that exceed it, or for the disk, which must have
 * as much again for others. */
static bool make_space(struct cache_store *store, int folder, uint64_t size)
{
    if (size > store->limit || !system_has_room(folder, size)) {
        return false;
    }
    char *cut = path_cut(store->path.data);
    conus_status status = cache_folder_fit(store->path.data, store->ending, store->limit - size);
    path_join_again(cut);
    return !status;
}

bool cache_store_keep(struct cache_store *store, struct cache_entry *entry, cache_writer *write, void *user)
{
    int folder = store->path.size && cache_folder_make(store->path.data) ? open_folder(store) : -1;
    if (folder < 0) {
        return false;
    }
    entry->key = (struct cache_part){(const uint8_t *)store->key.data, store->key.size};
    bool kept = make_space(store, folder, cache_entry_packed_at(entry) + entry->packed.size) &&
                write_and_rename(store, folder, entry, write, user);
    close(folder);
    return kept;
}
