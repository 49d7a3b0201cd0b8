/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens a file, and gives bytes of it. */
#include "loaders/volumes/stored/stored_file.h"

#include "base/memory.h"
#include "base/system/system.h"
#include "base/text.h"

#include <errno.h>
#include <nettle/sha2.h>
#include <string.h>

/* Whether the open file is still as it was. */
static bool is_unchanged(int descriptor, const struct file_state *before)
{
    struct file_state now;
    return file_state_of(&now, descriptor) && file_state_equal(&now, before);
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
    if (stored->plain) {
        plain_file_finish(stored->plain);
    }
    memory_free(stored->plain);
    *stored = (struct stored){0};
}

/* Reads all of `path`: from `file`, unless it is NULL. */
static conus_status read_whole(struct stored *out, const char *path, const struct open_file *file, uint64_t limit)
{
    struct stored stored = {.path = memory_text(path, strlen(path))};
    conus_status status = !stored.path ? CONUS_ERROR_MEMORY
                          : file       ? file_read_open(&stored.bytes, file, SIZE_MAX, limit, FILE_MAX_MEMORY)
                                       : file_read_allowed(&stored.bytes, path, limit);
    if (status) {
        stored_finish(&stored);
        return status;
    }
    stored.packed = gzip_is(stored.bytes.data, stored.bytes.size);
    *out = stored;
    return CONUS_OK;
}

conus_status stored_open(struct stored *out, const char *path, uint64_t limit)
{
    return read_whole(out, path, NULL, limit);
}

/* Opens a plain file if it has more than STORED_LARGE bytes and passes the test; else reads it whole. */
static conus_status open_slabs(struct stored *out, const char *path, const struct open_file *file, uint64_t limit,
                               plain_file_test *test)
{
    uint8_t head[TESTED];
    struct plain_file plain = {.descriptor = file->descriptor, .before = file->before};
    size_t size = smaller_of(sizeof head, plain.before.size);
    if (plain.before.size <= STORED_LARGE || read_at(&plain, head, size, 0) || !test(head, size) ||
        (plain.descriptor = system_copy(file->descriptor)) < 0) {
        return read_whole(out, path, file, limit);
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
                               plain_file_test *test)
{
    struct open_file own;
    if (file) {
        return open_slabs(out, path, file, limit, test);
    }
    if (file_open(&own, path)) {
        return read_whole(out, path, NULL, limit); /* which says why */
    }
    conus_status status = open_slabs(out, path, &own, limit, test);
    file_close(&own);
    return status;
}

conus_status stored_head(struct bytes *out, const struct stored *stored, size_t limit)
{
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
    if (stored->plain) {
        memcpy(out, stored->plain->sha256, sizeof stored->plain->sha256);
    }
    return stored->plain;
}

conus_status stored_range(struct bytes *out, struct gzip_range *range, struct stored *stored)
{
    return stored->plain    ? plain_file_range(out, range, stored->plain)
           : stored->packed ? gzip_unpack(out, range, stored->bytes.data, stored->bytes.size)
                            : gzip_keep(out, range, &stored->bytes);
}
