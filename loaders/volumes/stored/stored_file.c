/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens a file whole or by its index, and gives bytes of it. */
#include "loaders/volumes/stored/stored_file.h"

#include "base/files/file_trace.h"
#include "base/memory.h"
#include "base/system/system.h"
#include "base/text.h"

#include <errno.h>
#include <nettle/sha2.h>
#include <string.h>

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

static bool map_index(struct kept_index *out, const char *real, const struct bytes *header)
{
    struct cache_store store = {0};
    find_store(&store, real, header);
    bool found = cache_store_map(&out->mapping, &store);
    const struct cache_entry *entry = &out->mapping.entry;
    struct file_trace trace = {0}; /* of this open file, and nothing else */
    bool fits = found && file_trace_parse(&trace, entry->trace.data, entry->trace.size) && trace.count == 1 &&
                trace.items[0].kind == TRACE_FILE && file_state_equal(&trace.items[0].state, &out->before) &&
                gzip_index_parse(&out->index, entry->packed.data, entry->packed.size) &&
                out->index.packed == out->before.size && gzip_index_fits(&out->index, out->descriptor);
    if (found && !fits) {
        cache_mapping_finish(&out->mapping);
    }
    file_trace_finish(&trace);
    cache_store_finish(&store);
    return fits;
}

bool kept_index_open(struct kept_index *out, const char *path, const struct bytes *header)
{
    char real[SYSTEM_PATH];
    struct system_stat info;
    struct kept_index kept = {.descriptor = system_open(path, SYSTEM_READ | SYSTEM_AT_ONCE)};
    bool found = kept.descriptor >= 0 && system_stat_open(&info, kept.descriptor) && info.kind == SYSTEM_FILE;
    if (found) {
        file_state_take(&kept.before, &info);
        found = system_real_path(real, path) && map_index(&kept, real, header);
    }
    if (!found) {
        kept_index_finish(&kept);
        return false;
    }
    file_trace_input(path, &info);
    *out = kept;
    return true;
}

/* Whether the open file is still as it was. */
static bool is_unchanged(int descriptor, const struct file_state *before)
{
    struct file_state now;
    return file_state_of(&now, descriptor) && file_state_equal(&now, before);
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
    char real[SYSTEM_PATH];
    struct system_stat info;
    *out = (struct index_keeper){0};
    struct traced *item = memory_zeroed(1, sizeof *item);
    clock_gettime(CLOCK_REALTIME, &out->trace.begun);
    if (!item || !system_real_path(real, path) || !system_stat(&info, real) || info.kind != SYSTEM_FILE) {
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
    return system_write_at(file, index->data, index->size, at);
}

/* A file that is not packed, read slab by slab: it is never in memory as a whole. */
struct plain_file {
    int descriptor;
    struct file_state before; /* when it was opened */
    char sha256[65];          /* once plain_file_range() has read it */
};

enum { TESTED = 540 };

/* Reads `size` bytes, which the file has. */
static conus_status read_at(const struct plain_file *plain, uint8_t *out, size_t size, uint64_t at)
{
    ptrdiff_t got = system_read_at(plain->descriptor, out, size, at);
    if (got < 0 || (size_t)got < size) {
        file_trace_failed();
        return got < 0 ? fail(CONUS_ERROR_IO, "cannot read: %s", text_error(errno))
                       : fail(CONUS_ERROR_IO, FILE_CHANGED);
    }
    return CONUS_OK;
}

static void plain_file_finish(struct plain_file *plain)
{
    if (plain->descriptor >= 0) {
        close(plain->descriptor);
    }
    plain->descriptor = -1;
}

/* The first `limit` bytes, or fewer. CONUS_ERROR_IO, CONUS_ERROR_MEMORY. */
static conus_status plain_file_head(struct bytes *out, const struct plain_file *plain, size_t limit)
{
    size_t size = smaller_of(limit, plain->before.size);
    uint8_t *head = memory_raw(size, 1);
    conus_status status = head ? read_at(plain, head, size, 0) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(head);
        return status;
    }
    *out = (struct bytes){head, size};
    return CONUS_OK;
}

/* One pass through a plain file. */
struct reading {
    const struct plain_file *plain;
    const struct gzip_range *range;
    struct sha256_ctx sum;
    uint8_t *slab; /* [GZIP_SLAB] */
    uint8_t *kept; /* of the range; NULL = it goes to the sink */
};

/* Reads the stretch [at, end), and gives it if it is `wanted`. */
static conus_status read_stretch(struct reading *reading, uint64_t at, uint64_t end, bool wanted)
{
    conus_status status = CONUS_OK;
    while (!status && at < end) {
        size_t size = smaller_of(GZIP_SLAB, end - at);
        uint8_t *to = wanted && reading->kept ? reading->kept + (at - reading->range->from) : reading->slab;
        status = read_at(reading->plain, to, size, at);
        if (!status) {
            sha256_update(&reading->sum, size, to);
        }
        if (!status && wanted && reading->range->sink) {
            status = reading->range->sink(reading->range->user, to, size);
        }
        at += size;
    }
    return status;
}

/* Reads all of the file once, for its sum, and gives the bytes of the range: kept, or to the sink slab by slab.
 * CONUS_ERROR_DATA where the file has fewer bytes than range->total, CONUS_ERROR_IO where it changed meanwhile. */
static conus_status plain_file_range(struct bytes *out, struct gzip_range *range, struct plain_file *plain)
{
    if (plain->before.size < range->total) {
        return fail(CONUS_ERROR_DATA, "voxels: the file has %llu bytes, the header asks for %llu",
                    (unsigned long long)plain->before.size, (unsigned long long)range->total);
    }
    struct reading reading = {.plain = plain, .range = range, .slab = memory_raw(GZIP_SLAB, 1)};
    reading.kept = reading.slab && !range->sink ? memory_raw(range->count, 1) : NULL;
    conus_status status = reading.slab && (reading.kept || range->sink) ? CONUS_OK : CONUS_ERROR_MEMORY;
    sha256_init(&reading.sum);
    uint64_t end = range->from + range->count;
    status = status ? status : read_stretch(&reading, 0, range->from, false);
    status = status ? status : read_stretch(&reading, range->from, end, true);
    status = status ? status : read_stretch(&reading, end, plain->before.size, false);
    if (!status && !is_unchanged(plain->descriptor, &plain->before)) {
        file_trace_failed();
        status = fail(CONUS_ERROR_IO, FILE_CHANGED);
    }
    memory_free(reading.slab);
    if (status) {
        memory_free(reading.kept);
        return status;
    }
    file_sha256_end(plain->sha256, &reading.sum);
    range->extra = plain->before.size - range->total;
    range->junk = 0;
    *out = (struct bytes){reading.kept, reading.kept ? range->count : 0};
    return CONUS_OK;
}

void stored_finish(struct stored *stored)
{
    memory_free(stored->path);
    bytes_finish(&stored->bytes);
    if (stored->index) {
        kept_index_finish(stored->index);
    }
    if (stored->keeper) {
        index_keeper_finish(stored->keeper);
    }
    if (stored->plain) {
        plain_file_finish(stored->plain);
    }
    memory_free(stored->index);
    memory_free(stored->plain);
    memory_free(stored->keeper);
    *stored = (struct stored){0};
}

/* An index belongs to the file that the path leads to now: `file`, opened before, is not read for it. */
static conus_status stored_read_whole(struct stored *stored, const struct open_file *file, uint64_t limit,
                                      enum stored_use use, const struct bytes *header)
{
    if (use != STORED_PLAIN) {
        stored->keeper = memory_raw(1, sizeof *stored->keeper);
        if (!stored->keeper) {
            return CONUS_ERROR_MEMORY;
        }
        index_keeper_begin(stored->keeper, stored->path, header);
    }
    conus_status status = file && use == STORED_PLAIN
                              ? file_read_open(&stored->bytes, file, SIZE_MAX, limit, FILE_MAX_MEMORY)
                              : file_read_allowed(&stored->bytes, stored->path, limit);
    stored->packed = !status && gzip_is(stored->bytes.data, stored->bytes.size);
    return status;
}

static conus_status open_whole(struct stored *out, const char *path, const struct open_file *file, uint64_t limit,
                               enum stored_use use, const struct bytes *header)
{
    struct stored stored = {.path = memory_text(path, strlen(path))};
    conus_status status = use == STORED_PLAIN ? CONUS_OK : cache_check_limit();
    status = status || stored.path ? status : CONUS_ERROR_MEMORY;
    struct kept_index kept;
    if (!status && use == STORED_INDEX && kept_index_open(&kept, path, header)) {
        /* who may not read so large a file is told so where it is read */
        stored.index = kept.before.size <= limit ? memory_copy(&kept, 1, sizeof kept) : NULL;
        if (!stored.index) {
            kept_index_finish(&kept);
        }
        stored.packed = stored.index && !kept.index.begin && !kept.index.zlib;
    }
    status = status || stored.index ? status : stored_read_whole(&stored, file, limit, use, header);
    if (status) {
        stored_finish(&stored);
        return status;
    }
    *out = stored;
    return CONUS_OK;
}

conus_status stored_open(struct stored *out, const char *path, uint64_t limit, enum stored_use use,
                         const struct bytes *header)
{
    return open_whole(out, path, NULL, limit, use, header);
}

/* Opens a plain file if it has more than STORED_LARGE bytes and passes the test; else reads it whole. */
static conus_status open_slabs(struct stored *out, const char *path, const struct open_file *file, uint64_t limit,
                               enum stored_use use, plain_file_test *test)
{
    uint8_t head[TESTED];
    struct plain_file plain = {.descriptor = file->descriptor, .before = file->before};
    size_t size = smaller_of(sizeof head, plain.before.size);
    if (plain.before.size <= STORED_LARGE || read_at(&plain, head, size, 0) || !test(head, size) ||
        (plain.descriptor = system_copy(file->descriptor)) < 0) {
        return open_whole(out, path, file, limit, use, NULL);
    }
    struct stored stored = {.path = memory_text(path, strlen(path)), .plain = memory_copy(&plain, 1, sizeof plain)};
    if (!stored.path || !stored.plain) {
        plain_file_finish(&plain);
        memory_free(stored.path);
        memory_free(stored.plain);
        return CONUS_ERROR_MEMORY;
    }
    *out = stored;
    return CONUS_OK;
}

conus_status stored_open_slabs(struct stored *out, const char *path, const struct open_file *file, uint64_t limit,
                               enum stored_use use, plain_file_test *test)
{
    struct open_file own;
    if (file) {
        return open_slabs(out, path, file, limit, use, test);
    }
    if (file_open(&own, path)) {
        return open_whole(out, path, NULL, limit, use, NULL); /* which says why */
    }
    conus_status status = open_slabs(out, path, &own, limit, use, test);
    file_close(&own);
    return status;
}

conus_status stored_head(struct bytes *out, const struct stored *stored, size_t limit)
{
    const struct kept_index *kept = stored->index;
    if (kept && !stored->packed) { /* the bytes before the stream that has the index, as stored */
        const struct plain_file plain = {.descriptor = kept->descriptor, .before = kept->before};
        return plain_file_head(out, &plain, kept->index.begin < limit ? (size_t)kept->index.begin : limit);
    }
    if (kept) {
        return gzip_index_head(out, &kept->index, limit, kept->descriptor);
    }
    if (stored->plain) {
        return plain_file_head(out, stored->plain, limit);
    }
    if (stored->packed) {
        return gzip_head(out, stored->bytes.data, stored->bytes.size, limit);
    }
    size_t size = stored->bytes.size < limit ? stored->bytes.size : limit;
    uint8_t *copy = memory_raw(size, 1);
    if (!copy) {
        return CONUS_ERROR_MEMORY;
    }
    memcpy(copy, stored->bytes.data, size);
    *out = (struct bytes){copy, size};
    return CONUS_OK;
}

bool stored_known_sum(char out[65], const struct stored *stored)
{
    const char *sum = stored->index ? stored->index->index.sha256 : stored->plain ? stored->plain->sha256 : NULL;
    if (sum) {
        memcpy(out, sum, sizeof stored->plain->sha256);
    }
    return sum;
}

/* Keeps the index of the unpacked file. Does not where the file changed just now. */
static void keep_index(struct index_keeper *keeper, struct gzip_index *whole)
{
    if (!keeper->store.path.size || !file_trace_is_settled(&keeper->trace) || !file_trace_holds(&keeper->trace)) {
        return;
    }
    struct buffer index = {0};
    struct buffer trace = {0};
    whole->packed = keeper->trace.items[0].state.size;
    if (gzip_indexer_write(&index, &keeper->indexer, whole)) {
        file_trace_write(&trace, &keeper->trace);
        struct cache_entry entry = {.trace = {(const uint8_t *)trace.data, trace.size}, .packed = {NULL, index.size}};
        if (!trace.failed) {
            (void)cache_store_keep(&keeper->store, &entry, write_index, &index);
        }
    }
    buffer_finish(&trace);
    buffer_finish(&index);
}

static conus_status unpack_and_keep(struct bytes *out, struct gzip_range *range, struct stored *stored, size_t begin,
                                    size_t size, const char *sha256)
{
    struct index_keeper *keeper = stored->keeper;
    struct gzip_index whole = {0};
    gzip_indexer_init(&keeper->indexer, range->total);
    keeper->indexer.begin = begin;
    keeper->indexer.zlib = range->zlib;
    range->indexer = &keeper->indexer;
    conus_status status = gzip_unpack(out, range, stored->bytes.data + begin, size);
    range->indexer = NULL;
    if (!status && keeper->trace.count && keeper->trace.items[0].state.size == stored->bytes.size) {
        whole.unpacked = range->total + range->extra;
        whole.junk = range->junk;
        memcpy(whole.sha256, sha256, sizeof whole.sha256);
        keep_index(keeper, &whole);
    }
    return status;
}

conus_status stored_stream(struct bytes *out, struct gzip_range *range, struct stored *stored, size_t begin,
                           size_t size, const char *sha256)
{
    const struct kept_index *kept = stored->index;
    if (!kept) {
        return sha256 && stored->keeper ? unpack_and_keep(out, range, stored, begin, size, sha256)
                                        : gzip_unpack(out, range, stored->bytes.data + begin, size);
    }
    conus_status status = gzip_index_unpack(out, range, &kept->index, kept->descriptor);
    if (!status && !is_unchanged(kept->descriptor, &kept->before)) {
        bytes_finish(out);
        status = fail(CONUS_ERROR_IO, FILE_CHANGED);
    }
    return status;
}

conus_status stored_range(struct bytes *out, struct gzip_range *range, struct stored *stored, const char *sha256)
{
    return stored->plain                       ? plain_file_range(out, range, stored->plain)
           : !stored->packed && !stored->index ? gzip_keep(out, range, &stored->bytes)
                                               : stored_stream(out, range, stored, 0, stored->bytes.size, sha256);
}
