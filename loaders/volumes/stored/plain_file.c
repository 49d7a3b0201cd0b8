/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a file from its beginning to its end, and gives a part of it. */
#include "loaders/volumes/stored/plain_file.h"

#include "base/files/file_trace.h"
#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <nettle/sha2.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { TESTED = 540 };

static size_t smaller_of(uint64_t a, uint64_t b)
{
    return (size_t)(a < b ? a : b);
}

/* Reads `size` bytes, which the file has. */
static conus_status read_at(const struct plain_file *plain, uint8_t *out, size_t size, uint64_t at)
{
    while (size) {
        ssize_t got = pread(plain->descriptor, out, size, (off_t)at);
        if (got == 0 || (got < 0 && errno != EINTR)) {
            file_trace_failed();
            return got ? fail(CONUS_ERROR_IO, "cannot read: %s", strerror(errno)) : fail(CONUS_ERROR_IO, FILE_CHANGED);
        }
        out += got > 0 ? got : 0;
        at += got > 0 ? (uint64_t)got : 0;
        size -= got > 0 ? (size_t)got : 0;
    }
    return CONUS_OK;
}

static bool passes(const struct plain_file *plain, plain_file_test *test)
{
    uint8_t head[TESTED];
    size_t size = smaller_of(sizeof head, plain->before.size);
    return !read_at(plain, head, size, 0) && test(head, size);
}

bool plain_file_open(struct plain_file *out, const char *path, uint64_t least, plain_file_test *test)
{
    struct stat info;
    struct plain_file plain = {.descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    bool found = plain.descriptor >= 0 && fstat(plain.descriptor, &info) == 0 && S_ISREG(info.st_mode);
    if (found) {
        file_state_take(&plain.before, &info);
        found = plain.before.size > least && passes(&plain, test);
    }
    if (!found) {
        plain_file_finish(&plain);
        return false;
    }
    file_trace_path(path, &info);
    *out = plain;
    return true;
}

void plain_file_finish(struct plain_file *plain)
{
    if (plain->descriptor >= 0) {
        close(plain->descriptor);
    }
    plain->descriptor = -1;
}

conus_status plain_file_head(struct bytes *out, const struct plain_file *plain, size_t limit)
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

/* What goes through the file. */
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

static conus_status read_all(struct reading *reading)
{
    const struct gzip_range *range = reading->range;
    uint64_t end = range->from + range->count;
    conus_status status = read_stretch(reading, 0, range->from, false);
    status = status ? status : read_stretch(reading, range->from, end, true);
    return status ? status : read_stretch(reading, end, reading->plain->before.size, false);
}

static conus_status check_unchanged(const struct plain_file *plain)
{
    struct file_state now;
    bool same = file_state_of(&now, plain->descriptor) && file_state_equal(&now, &plain->before);
    if (!same) {
        file_trace_failed();
    }
    return same ? CONUS_OK : fail(CONUS_ERROR_IO, FILE_CHANGED);
}

conus_status plain_file_range(struct bytes *out, struct gzip_range *range, struct plain_file *plain)
{
    if (plain->before.size < range->total) {
        return fail(CONUS_ERROR_DATA, "voxels: the file has %llu bytes, the header asks for %llu",
                    (unsigned long long)plain->before.size, (unsigned long long)range->total);
    }
    struct reading reading = {.plain = plain, .range = range, .slab = memory_raw(GZIP_SLAB, 1)};
    reading.kept = reading.slab && !range->sink ? memory_raw(range->count, 1) : NULL;
    conus_status status = reading.slab && (reading.kept || range->sink) ? CONUS_OK : CONUS_ERROR_MEMORY;
    sha256_init(&reading.sum);
    status = status ? status : read_all(&reading);
    status = status ? status : check_unchanged(plain);
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
