/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes, checks and follows indexes of gzip files, through zlib's public interface. */
#include "base/formats/gzip_index.h"

#include "base/byte_order.h"
#include "base/memory.h"
#include "base/system/system.h"
#include "base/text.h"

#include <assert.h>
#include <errno.h>
#include <libdeflate.h>
#include <stdalign.h>
#include <string.h>
#include <zlib.h>

enum { WINDOW_LEVEL = 6, GZIP = 16 + MAX_WBITS, RAW = -MAX_WBITS, TRAILER = 8, LAST_BITS = 7 };

/* Ahead of the points, which are ahead of the windows. */
struct index_head {
    uint64_t unpacked, packed, junk, trailer, begin, zlib, count, windows_size;
    char sha256[72];
};

static uint32_t index_crc_of(uint32_t sum, const uint8_t *data, size_t size)
{
    return size ? libdeflate_crc32(sum, data, size) : sum; /* without data it would begin anew */
}

void gzip_indexer_init(struct gzip_indexer *out, uint64_t total)
{
    uint64_t spacing = total / GZIP_INDEX_POINTS + 1;
    *out = (struct gzip_indexer){.spacing = spacing > GZIP_INDEX_SPAN ? spacing : GZIP_INDEX_SPAN,
                                 .compressor = libdeflate_alloc_compressor(WINDOW_LEVEL)};
    out->failed = !out->compressor;
}

void gzip_indexer_finish(struct gzip_indexer *indexer)
{
    buffer_finish(&indexer->points);
    buffer_finish(&indexer->windows);
    libdeflate_free_compressor(indexer->compressor);
    *indexer = (struct gzip_indexer){0};
}

void gzip_indexer_add(struct gzip_indexer *indexer, const uint8_t *data, size_t size)
{
    indexer->sum = index_crc_of(indexer->sum, data, size);
}

static struct gzip_point *last_point(const struct gzip_indexer *indexer)
{
    size_t count = indexer->points.size / sizeof(struct gzip_point);
    return count ? (struct gzip_point *)(void *)indexer->points.data + (count - 1) : NULL;
}

/* Packs what inflate() can still copy from; the packed bytes, 0 = nothing, or it failed. */
static uint32_t append_window(struct gzip_indexer *indexer, z_stream *z)
{
    enum { PACKED = GZIP_INDEX_WINDOW + GZIP_INDEX_WINDOW / 8 };
    uInt size = 0;
    size_t used = 0;
    uint8_t *window = memory_raw(GZIP_INDEX_WINDOW + PACKED, 1); /* and the packed window behind it */
    indexer->failed = indexer->failed || !window || inflateGetDictionary(z, window, &size) != Z_OK;
    if (!indexer->failed && size) {
        used = libdeflate_deflate_compress(indexer->compressor, window, size, window + GZIP_INDEX_WINDOW, PACKED);
        indexer->failed = !used;
        buffer_append(&indexer->windows, window + GZIP_INDEX_WINDOW, used);
    }
    memory_free(window);
    return (uint32_t)used;
}

void gzip_indexer_stop(struct gzip_indexer *indexer, struct z_stream_s *z, uint64_t unpacked, uint64_t packed)
{
    enum { IN_LAST_BLOCK = 64 };
    struct gzip_point *last = last_point(indexer);
    bool begins = (z->data_type & GZIP_BEFORE_A_BLOCK) && !(z->data_type & IN_LAST_BLOCK);
    if (indexer->failed || !begins || (last && unpacked - last->unpacked < indexer->spacing)) {
        return;
    }
    struct gzip_point point = {.unpacked = unpacked,
                               .packed = indexer->begin + packed,
                               .bits = (uint32_t)z->data_type & LAST_BITS,
                               .window = (uint32_t)indexer->windows.size};
    if (last) {
        last->sum = indexer->sum;
    }
    point.window_size = append_window(indexer, z);
    buffer_append_more(&indexer->points, &point, sizeof point);
    indexer->sum = 0;
    indexer->failed = indexer->failed || indexer->points.failed || indexer->windows.failed;
}

void gzip_indexer_end_member(struct gzip_indexer *indexer, uint64_t packed)
{
    indexer->members++;
    indexer->members_end = indexer->begin + packed;
}

bool gzip_indexer_write(struct buffer *out, struct gzip_indexer *indexer, const struct gzip_index *whole)
{
    const struct buffer *points = &indexer->points;
    struct index_head head = {.unpacked = whole->unpacked,
                              .packed = whole->packed,
                              .junk = whole->junk,
                              .trailer = indexer->members == 1 && !indexer->zlib ? indexer->members_end - TRAILER : 0,
                              .begin = indexer->begin,
                              .zlib = indexer->zlib,
                              .count = points->size / sizeof(struct gzip_point),
                              .windows_size = indexer->windows.size};
    memcpy(head.sha256, whole->sha256, sizeof whole->sha256);
    if (indexer->failed || head.count < 2) {
        return false;
    }
    last_point(indexer)->sum = indexer->sum;
    buffer_append(out, &head, sizeof head);
    buffer_append(out, points->data, points->size);
    buffer_append(out, indexer->windows.data, indexer->windows.size);
    return !out->failed && out->size <= GZIP_INDEX_LIMIT;
}

bool gzip_index_parse(struct gzip_index *out, const uint8_t *data, size_t size)
{
    struct index_head head;
    if (size < sizeof head || size > GZIP_INDEX_LIMIT) {
        return false;
    }
    memcpy(&head, data, sizeof head);
    size -= sizeof head;
    if (head.count > size / sizeof(struct gzip_point) || head.windows_size > size ||
        head.count * sizeof(struct gzip_point) + head.windows_size != size || !head.count ||
        head.unpacked > INT64_MAX || head.packed > INT64_MAX || /* as off_t has them */
        head.trailer > head.packed || head.begin > head.packed || head.zlib > 1 ||
        memchr(head.sha256, 0, sizeof head.sha256) != head.sha256 + sizeof out->sha256 - 1) {
        return false;
    }
    struct gzip_index index = {.unpacked = head.unpacked,
                               .packed = head.packed,
                               .junk = head.junk,
                               .trailer = head.trailer,
                               .begin = head.begin,
                               .zlib = head.zlib,
                               .points = (const void *)(data + sizeof head),
                               .count = (size_t)head.count,
                               .windows_size = (size_t)head.windows_size};
    static_assert(sizeof head % alignof(struct gzip_point) == 0, "points are aligned");
    memcpy(index.sha256, head.sha256, sizeof index.sha256);
    index.windows = (const uint8_t *)(index.points + index.count);
    bool fine = true;
    for (size_t i = 0; fine && i < index.count; i++) {
        const struct gzip_point *point = &index.points[i];
        bool ascends =
            i == 0 ? point->unpacked == 0 : point->unpacked > point[-1].unpacked && point->packed >= point[-1].packed;
        fine = ascends && point->unpacked < index.unpacked && point->packed > 0 && point->packed <= index.packed &&
               point->bits <= LAST_BITS && point->window <= index.windows_size &&
               point->window_size <= index.windows_size - point->window;
    }
    *out = fine ? index : *out;
    return fine;
}

enum { STORED_BLOCK = 1 << 16, SCRATCH = 1 << 16 };

struct follower {
    const struct gzip_index *index;
    int descriptor;
    size_t point;      /* whose span it is in */
    uint64_t position; /* in the unpacked file */
    uint64_t packed;   /* of the next byte to read */
    uint32_t sum;      /* of the span so far */
    bool raw;          /* before the end of the member in which it began: zlib does not verify such a part */
    z_stream z;
    uint8_t stored[STORED_BLOCK], scratch[SCRATCH];
};

static conus_status fail_mismatch(void)
{
    return fail(CONUS_ERROR_DATA, "gzip: the index does not fit the file");
}

/* Reads the next packed bytes, which are there. */
static conus_status feed(struct follower *follower)
{
    ptrdiff_t got = system_read_at(follower->descriptor, follower->stored, STORED_BLOCK, follower->packed);
    if (got <= 0) {
        return got ? fail(CONUS_ERROR_IO, "cannot read: %s", text_error(errno)) : fail_mismatch();
    }
    follower->packed += (uint64_t)got;
    follower->z.next_in = follower->stored;
    follower->z.avail_in = (uInt)got;
    return CONUS_OK;
}

static conus_status follower_next_member(struct follower *follower)
{
    if (follower->index->zlib) {
        return follower->z.avail_out ? fail_mismatch() : CONUS_OK;
    }
    conus_status status = CONUS_OK;
    for (size_t left = follower->raw ? TRAILER : 0; !status && left;) {
        status = follower->z.avail_in ? CONUS_OK : feed(follower);
        size_t part = smaller_of(left, follower->z.avail_in);
        follower->z.next_in += part;
        follower->z.avail_in -= (uInt)part;
        left -= part;
    }
    follower->raw = false;
    return status || inflateReset2(&follower->z, GZIP) == Z_OK ? status : fail_mismatch();
}

/* Unpacks `size` bytes of one span. */
static conus_status inflate_part(struct follower *follower, uint8_t *out, size_t size)
{
    conus_status status = CONUS_OK;
    z_stream *z = &follower->z;
    z->next_out = out;
    z->avail_out = (uInt)size;
    while (!status && z->avail_out) {
        status = z->avail_in ? CONUS_OK : feed(follower);
        int code = status ? Z_OK : inflate(z, Z_NO_FLUSH);
        if (code == Z_STREAM_END) {
            status = follower_next_member(follower);
        } else if (code == Z_MEM_ERROR) {
            status = fail(CONUS_ERROR_MEMORY, "gzip: no memory to unpack");
        } else if (code != Z_OK && code != Z_BUF_ERROR) {
            status = fail_mismatch();
        }
    }
    follower->sum = index_crc_of(follower->sum, out, size - z->avail_out);
    follower->position += size - z->avail_out;
    return status;
}

static uint64_t span_end(const struct gzip_index *index, size_t point)
{
    return point + 1 < index->count ? index->points[point + 1].unpacked : index->unpacked;
}

bool gzip_index_fits(const struct gzip_index *index, int descriptor)
{
    enum { SWAPPED = !BIG_ENDIAN_IS_SWAPPED };
    uint8_t stored[TRAILER];
    uLong sum = 0;
    if (!index->trailer) {
        return true;
    }
    for (size_t i = 0; i < index->count; i++) {
        sum = crc32_combine(sum, index->points[i].sum, (z_off_t)(span_end(index, i) - index->points[i].unpacked));
    }
    return system_read_at(descriptor, stored, sizeof stored, index->trailer) == (ptrdiff_t)sizeof stored &&
           order_u32(stored, SWAPPED) == sum && order_u32(stored + 4, SWAPPED) == (uint32_t)index->unpacked;
}

/* Unpacks `size` bytes, of several spans perhaps. */
static conus_status inflate_bytes(struct follower *follower, uint8_t *out, size_t size)
{
    enum { AT_ONCE = 1 << 30 };
    conus_status status = CONUS_OK;
    while (!status && size) {
        uint64_t end = span_end(follower->index, follower->point);
        size_t part = smaller_of(smaller_of(size, AT_ONCE), end - follower->position);
        status = inflate_part(follower, out, part);
        if (!status && follower->position >= end) {
            bool same = follower->sum == follower->index->points[follower->point].sum;
            follower->sum = 0;
            follower->point++;
            status = same ? CONUS_OK : fail_mismatch();
        }
        out += part;
        size -= part;
    }
    return status;
}

static conus_status pass_to(struct follower *follower, uint64_t position)
{
    conus_status status = CONUS_OK;
    while (!status && follower->position < position) {
        status = inflate_bytes(follower, follower->scratch, smaller_of(SCRATCH, position - follower->position));
    }
    return status;
}

/* Unpacks the rest of the span, without which its checksum says nothing. */
static conus_status verify_rest(struct follower *follower)
{
    const struct gzip_index *index = follower->index;
    bool inside = follower->point < index->count && follower->position > index->points[follower->point].unpacked;
    return inside ? pass_to(follower, span_end(index, follower->point)) : CONUS_OK;
}

static conus_status set_window(struct follower *follower, const struct gzip_point *point)
{
    struct libdeflate_decompressor *decompressor = libdeflate_alloc_decompressor();
    size_t size = 0;
    if (!decompressor) {
        return fail(CONUS_ERROR_MEMORY, "gzip: no memory to unpack");
    }
    bool whole =
        libdeflate_deflate_decompress(decompressor, follower->index->windows + point->window, point->window_size,
                                      follower->scratch, GZIP_INDEX_WINDOW, &size) == LIBDEFLATE_SUCCESS &&
        inflateSetDictionary(&follower->z, follower->scratch, (uInt)size) == Z_OK;
    libdeflate_free_decompressor(decompressor);
    return whole ? CONUS_OK : fail_mismatch();
}

static size_t find_point(const struct gzip_index *index, uint64_t position)
{
    size_t low = 0;
    for (size_t high = index->count; high - low > 1;) {
        size_t middle = low + (high - low) / 2;
        bool before = index->points[middle].unpacked <= position;
        low = before ? middle : low;
        high = before ? high : middle;
    }
    return low;
}

/* Goes to the last point that is not behind `position`. */
static conus_status go_to(struct follower *follower, uint64_t position)
{
    follower->point = find_point(follower->index, position);
    const struct gzip_point *point = &follower->index->points[follower->point];
    follower->position = point->unpacked;
    follower->packed = point->packed - (point->bits > 0);
    follower->raw = true;
    conus_status status = feed(follower);
    if (!status && point->bits) {
        int byte = *follower->z.next_in++;
        follower->z.avail_in--;
        status = inflatePrime(&follower->z, (int)point->bits, byte >> (8 - point->bits)) == Z_OK ? CONUS_OK
                                                                                                 : fail_mismatch();
    }
    return status || !point->window_size ? status : set_window(follower, point);
}

static conus_status follower_give_slabs(struct follower *follower, const struct gzip_range *range)
{
    conus_status status = CONUS_OK;
    uint8_t *slab = memory_raw(GZIP_SLAB, 1);
    if (!slab) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t got = 0; !status && got < range->count;) {
        size_t part = smaller_of(GZIP_SLAB, range->count - got);
        status = inflate_bytes(follower, slab, part);
        status = status ? status : range->sink(range->user, slab, part);
        got += part;
    }
    memory_free(slab);
    return status;
}

static conus_status follow(uint8_t *kept, const struct gzip_range *range, struct follower *follower)
{
    if (inflateInit2(&follower->z, RAW) != Z_OK) {
        return fail(CONUS_ERROR_MEMORY, "gzip: no memory to unpack");
    }
    conus_status status = go_to(follower, range->from);
    status = status ? status : pass_to(follower, range->from);
    status = status        ? status
             : range->sink ? follower_give_slabs(follower, range)
                           : inflate_bytes(follower, kept, range->count);
    status = status ? status : verify_rest(follower);
    inflateEnd(&follower->z);
    return status;
}

conus_status gzip_index_unpack(struct bytes *out, struct gzip_range *range, const struct gzip_index *index,
                               int descriptor)
{
    if (range->from > range->total || range->count > range->total - range->from || range->total > index->unpacked) {
        return fail_mismatch();
    }
    struct follower *follower = memory_zeroed(1, sizeof *follower);
    struct bytes bytes = {range->sink || !follower ? NULL : memory_raw(range->count, 1), range->count};
    conus_status status = follower && (bytes.data || range->sink) ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        follower->index = index;
        follower->descriptor = descriptor;
        status = follow(bytes.data, range, follower);
    }
    memory_free(follower);
    if (status) {
        bytes_finish(&bytes);
        return status;
    }
    range->extra = index->unpacked - range->total;
    range->junk = (size_t)index->junk;
    *out = range->sink ? (struct bytes){0} : bytes;
    return CONUS_OK;
}

conus_status gzip_index_head(struct bytes *out, const struct gzip_index *index, size_t limit, int descriptor)
{
    size_t size = smaller_of(limit, index->unpacked);
    struct gzip_range range = {.count = size, .total = size};
    return gzip_index_unpack(out, &range, index, descriptor);
}
