/* SPDX-License-Identifier: BSD-3-Clause */
/* Stores and finds results by key, and removes the oldest ones. */
#include "loaders/child/mesh_cache.h"

#include "base/byte_order.h"
#include "base/cache/cache_folder.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "base/path.h"
#include "base/system/system.h"

#include <errno.h>
#include <libdeflate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An entry: the content, then these bytes, u64 bytes of content and u32 their CRC-32, both little-endian, u32 0. */
static const char magic[8] = "CONUSMC1";
static const char ending[] = ".mesh";

enum { TAIL_SIZE = 24, SWAPPED = !BIG_ENDIAN_IS_SWAPPED };

static conus_status entry_path(struct buffer *out, const char *key)
{
    conus_status status = cache_folder_path(out);
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
    order_put(tail + 8, size, 8);
    order_put(tail + 16, sum, 4);
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

static conus_status note_others(struct notes *notes, const char *path)
{
    return notes_add(notes, "%s: not used, since others can write to it or own it", path);
}

/* Opens the folder; -1 if there is none or, with a note, if it is not ours alone. */
static conus_status open_folder(int *out, const char *path, struct notes *notes)
{
    bool theirs;
    *out = cache_folder_open(path, &theirs);
    return theirs ? note_others(notes, path) : CONUS_OK;
}

/* Takes the content of an open entry; none if it cannot be read. */
static conus_status take_entry(struct bytes *out, int descriptor, const char *path, struct notes *notes)
{
    struct system_stat info;
    if (!system_stat_open(&info, descriptor) || info.kind != SYSTEM_FILE || !info.ours_alone) {
        return note_others(notes, path);
    }
    if (info.size < TAIL_SIZE || info.size > MESH_CACHE_LIMIT) {
        return CONUS_OK;
    }
    struct bytes entry = {memory_raw((size_t)info.size, 1), 0};
    if (!entry.data) {
        return CONUS_ERROR_MEMORY;
    }
    ptrdiff_t got = system_read_at(descriptor, entry.data, (size_t)info.size, 0);
    entry.size = got > 0 ? (size_t)got : 0;
    size_t size = mesh_cache_content(entry.data, entry.size);
    if (size == SIZE_MAX) {
        memory_free(entry.data);
        return CONUS_OK;
    }
    *out = (struct bytes){entry.data, size};
    system_set_used(descriptor);
    return CONUS_OK;
}

conus_status mesh_cache_find(struct bytes *out, const char *key, struct notes *notes)
{
    struct buffer folder_path = {0};
    struct buffer path = {0};
    int folder = -1;
    conus_status status = cache_folder_path(&folder_path);
    status = status ? status : entry_path(&path, key);
    if (!status && path.size && folder_path.data) {
        status = open_folder(&folder, folder_path.data, notes);
    }
    if (folder >= 0) {
        int entry = system_open_in(folder, path_base(path.data), SYSTEM_READ | SYSTEM_NO_LINK | SYSTEM_AT_ONCE);
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

/* Writes an entry. The checksum detects a damaged one, so that nothing need wait for the disk. */
static conus_status write_entry(const struct buffer *path, const struct buffer *content)
{
    struct buffer temporary = {0};
    uint8_t tail[TAIL_SIZE];
    buffer_format(&temporary, "%s.XXXXXX%s", path->data, ending); /* an entry like others, should it be left behind */
    conus_status status = buffer_status(&temporary);
    int descriptor = status ? -1 : system_open_temporary(temporary.data, strlen(ending), true);
    if (descriptor >= 0) {
        write_tail(tail, content->data, content->size);
        bool written =
            system_write(descriptor, content->data, content->size) && system_write(descriptor, tail, sizeof tail);
        written = close(descriptor) == 0 && written;
        if (!written || !system_rename(temporary.data, path->data, true)) {
            system_remove(temporary.data);
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
    if (!status && path.size && content->size + TAIL_SIZE <= limit && cache_folder_make(path.data)) {
        char *cut = path_cut(path.data);
        status = open_folder(&folder, path.data, &said);
        path_join_again(cut);
        status = status || folder < 0 ? status : write_entry(&path, content);
        (void)path_cut(path.data);
        status = status || folder < 0 ? status : cache_folder_fit(path.data, ending, limit);
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
