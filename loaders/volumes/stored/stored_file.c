/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens a file whole or by its index, and gives bytes of it. */
#include "loaders/volumes/stored/stored_file.h"

#include "base/memory.h"

#include <string.h>

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

/* Takes the index if there is one; who may not read so large a file is told so where it is read. */
static void find_index(struct stored *stored, uint64_t limit, const struct bytes *header)
{
    struct kept_index kept;
    if (!kept_index_open(&kept, stored->path, header)) {
        return;
    }
    stored->index = kept.before.size <= limit ? memory_copy(&kept, 1, sizeof kept) : NULL;
    if (!stored->index) {
        kept_index_finish(&kept);
    }
    stored->packed = stored->index && !kept.index.begin && !kept.index.zlib;
}

static conus_status read_whole(struct stored *stored, uint64_t limit, enum stored_use use, const struct bytes *header)
{
    if (use != STORED_PLAIN) {
        stored->keeper = memory_raw(1, sizeof *stored->keeper);
        if (!stored->keeper) {
            return CONUS_ERROR_MEMORY;
        }
        index_keeper_begin(stored->keeper, stored->path, header);
    }
    conus_status status = file_read_allowed(&stored->bytes, stored->path, limit);
    stored->packed = !status && gzip_is(stored->bytes.data, stored->bytes.size);
    return status;
}

conus_status stored_open(struct stored *out, const char *path, uint64_t limit, enum stored_use use,
                         const struct bytes *header)
{
    struct stored stored = {.path = memory_text(path, strlen(path))};
    conus_status status = use == STORED_PLAIN ? CONUS_OK : cache_check_limit();
    status = status || stored.path ? status : CONUS_ERROR_MEMORY;
    if (!status && use == STORED_INDEX) {
        find_index(&stored, limit, header);
    }
    status = status || stored.index ? status : read_whole(&stored, limit, use, header);
    if (status) {
        stored_finish(&stored);
        return status;
    }
    *out = stored;
    return CONUS_OK;
}

conus_status stored_open_slabs(struct stored *out, const char *path, uint64_t limit, enum stored_use use,
                               plain_file_test *test)
{
    struct plain_file plain;
    if (!plain_file_open(&plain, path, STORED_LARGE, test)) {
        return stored_open(out, path, limit, use, NULL);
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

/* What is ahead of the stream that the index is of, as it is stored. */
static conus_status head_before_stream(struct bytes *out, const struct kept_index *kept, size_t limit)
{
    const struct plain_file plain = {.descriptor = kept->descriptor, .before = kept->before};
    return plain_file_head(out, &plain, kept->index.begin < limit ? (size_t)kept->index.begin : limit);
}

conus_status stored_head(struct bytes *out, const struct stored *stored, size_t limit)
{
    if (stored->index && !stored->packed) {
        return head_before_stream(out, stored->index, limit);
    }
    if (stored->index) {
        return gzip_index_head(out, &stored->index->index, limit, stored->index->descriptor);
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

static conus_status follow_index(struct bytes *out, struct gzip_range *range, const struct kept_index *kept)
{
    conus_status status = gzip_index_unpack(out, range, &kept->index, kept->descriptor);
    if (!status && !kept_index_holds(kept)) {
        bytes_finish(out);
        status = fail(CONUS_ERROR_IO, FILE_CHANGED);
    }
    return status;
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
        index_keeper_keep(keeper, &whole);
    }
    return status;
}

conus_status stored_stream(struct bytes *out, struct gzip_range *range, struct stored *stored, size_t begin,
                           size_t size, const char *sha256)
{
    return stored->index              ? follow_index(out, range, stored->index)
           : sha256 && stored->keeper ? unpack_and_keep(out, range, stored, begin, size, sha256)
                                      : gzip_unpack(out, range, stored->bytes.data + begin, size);
}

conus_status stored_range(struct bytes *out, struct gzip_range *range, struct stored *stored, const char *sha256)
{
    return stored->plain                       ? plain_file_range(out, range, stored->plain)
           : !stored->packed && !stored->index ? gzip_keep(out, range, &stored->bytes)
                                               : stored_stream(out, range, stored, 0, stored->bytes.size, sha256);
}
