/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds and keeps indexes as entries of the cache. */
#include "loaders/volumes/stored/kept_index.h"

#include "base/memory.h"

#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The entry of `path`, whose name does not depend on how the file is called; without a path where nothing is kept. */
static void find_store(struct cache_store *out, const char *real, const struct bytes *header)
{
    char sum[65] = "";
    if (cache_store_begin(out, KEPT_INDEX_ENDING, real, false)) {
        if (header) {
            file_sha256(sum, header);
        }
        cache_key_append(&out->key, "gzip index");
        cache_key_append(&out->key, header ? sum : NULL);
        out->limit = out->limit < KEPT_INDEX_LIMIT ? out->limit : KEPT_INDEX_LIMIT;
        cache_store_name(out);
    }
}

/* Whether the entry is about this open file, and nothing else. */
static bool is_about(const struct cache_entry *entry, const struct file_state *state)
{
    struct file_trace trace = {0};
    bool same = file_trace_parse(&trace, entry->trace.data, entry->trace.size) && trace.count == 1 &&
                trace.items[0].kind == TRACE_FILE && file_state_equal(&trace.items[0].state, state);
    file_trace_finish(&trace);
    return same;
}

static bool map_index(struct kept_index *out, const char *real, const struct bytes *header)
{
    struct cache_store store = {0};
    find_store(&store, real, header);
    bool found = cache_store_map(&out->mapping, &store);
    const struct cache_entry *entry = &out->mapping.entry;
    bool fits = found && is_about(entry, &out->before) &&
                gzip_index_parse(&out->index, entry->packed.data, entry->packed.size) &&
                out->index.packed == out->before.size && gzip_index_fits(&out->index, out->descriptor);
    if (found && !fits) {
        cache_mapping_finish(&out->mapping);
    }
    cache_store_finish(&store);
    return fits;
}

bool kept_index_open(struct kept_index *out, const char *path, const struct bytes *header)
{
    char real[PATH_MAX];
    struct stat info;
    struct kept_index kept = {.descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    bool found = kept.descriptor >= 0 && fstat(kept.descriptor, &info) == 0 && S_ISREG(info.st_mode);
    if (found) {
        file_state_take(&kept.before, &info);
        found = realpath(path, real) && map_index(&kept, real, header);
    }
    if (!found) {
        kept_index_finish(&kept);
        return false;
    }
    file_trace_path(path, &info);
    *out = kept;
    return true;
}

bool kept_index_holds(const struct kept_index *kept)
{
    struct file_state now;
    return file_state_of(&now, kept->descriptor) && file_state_equal(&now, &kept->before);
}

void kept_index_finish(struct kept_index *kept)
{
    cache_mapping_finish(&kept->mapping);
    if (kept->descriptor >= 0) {
        close(kept->descriptor);
    }
    *kept = (struct kept_index){.descriptor = -1};
}

void index_keeper_begin(struct index_keeper *out, const char *path, const struct bytes *header)
{
    char real[PATH_MAX];
    struct stat info;
    *out = (struct index_keeper){0};
    struct traced *item = memory_zeroed(1, sizeof *item);
    clock_gettime(CLOCK_REALTIME, &out->trace.begun);
    if (!item || !realpath(path, real) || stat(real, &info) || !S_ISREG(info.st_mode)) {
        memory_free(item);
        return;
    }
    item->kind = TRACE_FILE;
    item->path = memory_text(real, strlen(real));
    file_state_take(&item->state, &info);
    out->trace.items = item;
    out->trace.count = out->trace.capacity = 1;
    if (item->path) {
        find_store(&out->store, real, header);
    }
}

void index_keeper_finish(struct index_keeper *keeper)
{
    gzip_indexer_finish(&keeper->indexer);
    cache_store_finish(&keeper->store);
    file_trace_finish(&keeper->trace);
}

static bool write_index(void *user, int file, size_t at)
{
    const struct buffer *index = user;
    return pwrite(file, index->data, index->size, (off_t)at) == (ssize_t)index->size;
}

static bool keep(struct index_keeper *keeper, struct buffer *index)
{
    struct buffer trace = {0};
    file_trace_write(&trace, &keeper->trace);
    struct cache_entry entry = {.trace = {(const uint8_t *)trace.data, trace.size}, .packed = {NULL, index->size}};
    bool kept = !trace.failed && cache_store_keep(&keeper->store, &entry, write_index, index);
    buffer_finish(&trace);
    return kept;
}

bool index_keeper_keep(struct index_keeper *keeper, struct gzip_index *whole)
{
    struct buffer index = {0};
    bool may = keeper->store.path.size && file_trace_is_settled(&keeper->trace) && file_trace_holds(&keeper->trace);
    if (may) {
        whole->packed = keeper->trace.items[0].state.size;
    }
    bool kept = may && gzip_indexer_write(&index, &keeper->indexer, whole) && keep(keeper, &index);
    buffer_finish(&index);
    return kept;
}
