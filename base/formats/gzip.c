/* SPDX-License-Identifier: BSD-3-Clause */
/* Unpacks gzip, through zlib. */
#include "base/formats/packed.h"

#include "base/byte_order.h"
#include "base/memory.h"

#include <libdeflate.h>
#include <limits.h>
#include <string.h>
#include <zlib.h>

enum { SCRATCH_SIZE = 1 << 17, INFLATE_RATIO = 1032 /* a match of 258 bytes takes at least 2 bits */ };

/* Streams through all members; of the unpacked bytes those in [from, from + count) land in `kept`. zlib inflates, and
 * reads the header and trailer of its own format; those of gzip (RFC 1952) are read here, because libdeflate sums
 * several times as fast. */
struct stream {
    z_stream z;
    const uint8_t *rest; /* packed bytes that zlib has not seen */
    size_t rest_size;
    bool in_member;    /* behind its header */
    uint32_t sum;      /* CRC-32 of the member so far */
    uint64_t begun;    /* unpacked bytes before the member */
    uint64_t position; /* unpacked so far */
    uint64_t from;
    size_t count;
    uint8_t *kept;
    bool ended; /* after the last member */
    bool zlib;  /* which has no members */
    uint8_t scratch[SCRATCH_SIZE];
};

/* Points zlib at where the next unpacked bytes belong, at most `limit` of them. */
static size_t set_output(struct stream *stream, uint64_t limit)
{
    uint64_t end = stream->from + stream->count;
    size_t space_left;
    if (stream->position >= stream->from && stream->position < end) {
        stream->z.next_out = stream->kept + (stream->position - stream->from);
        space_left = smaller_of(end - stream->position, limit);
    } else {
        stream->z.next_out = stream->scratch;
        space_left = smaller_of(SCRATCH_SIZE, limit);
        space_left =
            stream->position < stream->from ? smaller_of(space_left, stream->from - stream->position) : space_left;
    }
    space_left = smaller_of(space_left, INT_MAX);
    stream->z.avail_out = (uInt)space_left;
    return space_left;
}

static conus_status fail_damaged(const struct stream *stream, const char *how)
{
    return fail(CONUS_ERROR_DATA, "gzip: damaged near unpacked byte %llu (%s), an intact file is needed",
                (unsigned long long)stream->position, how);
}

/* Finds where the header of a member ends: 0 = it is cut off. The first four bytes are there. */
static size_t find_header_end(const uint8_t *data, size_t size)
{
    enum { FIXED = 10, HAS_SUM = 2, HAS_EXTRA = 4, HAS_NAME = 8, HAS_COMMENT = 16, FLAGS = 3 };
    size_t end = FIXED;
    if (data[FLAGS] & HAS_EXTRA) {
        end += size < end + 2 ? 2 : 2 + (size_t)data[end] + ((size_t)data[end + 1] << 8);
    }
    for (unsigned flag = HAS_NAME; flag <= HAS_COMMENT; flag *= 2) {
        const uint8_t *zero = data[FLAGS] & flag && end < size ? memchr(data + end, 0, size - end) : NULL;
        end = zero ? (size_t)(zero - data) + 1 : data[FLAGS] & flag ? size + 1 : end;
    }
    end += data[FLAGS] & HAS_SUM ? 2 : 0;
    return end <= size ? end : 0;
}

/* Reads the header of a member; where it is cut off, all that is left of the packed bytes is passed over. */
static conus_status begin_member(struct stream *stream)
{
    enum { FLAGS = 3, HAS_SUM = 2, RESERVED = 0xe0 };
    const uint8_t *data = stream->rest;
    size_t size = stream->rest_size;
    if (size >= 3 && !gzip_is(data, size)) {
        return fail_damaged(stream, "incorrect header check");
    }
    if (size > FLAGS && data[FLAGS] & RESERVED) {
        return fail_damaged(stream, "unknown header flags set");
    }
    size_t end = size > FLAGS ? find_header_end(data, size) : 0;
    if (end && data[FLAGS] & HAS_SUM &&
        (libdeflate_crc32(0, data, end - 2) & 0xffff) != (data[end - 2] | (unsigned)data[end - 1] << 8)) {
        return fail_damaged(stream, "header crc mismatch");
    }
    stream->in_member = end > 0;
    stream->rest += end ? end : size;
    stream->rest_size -= end ? end : size;
    stream->sum = 0;
    stream->begun = stream->position;
    return CONUS_OK;
}

/* At the end of what zlib inflates: reads the trailer, and goes on with the next member, if there is one. */
static conus_status end_member(struct stream *stream)
{
    enum { TRAILER = 8, SWAPPED = !BIG_ENDIAN_IS_SWAPPED };
    const uint8_t *next = stream->z.next_in;
    size_t size = stream->z.avail_in + stream->rest_size; /* both lie in the same file, one behind the other */
    size_t trailer = stream->zlib ? 0 : TRAILER;
    stream->z.avail_in = 0;
    stream->in_member = stream->zlib;
    if (trailer && size >= 4 && order_u32(next, SWAPPED) != stream->sum) {
        return fail_damaged(stream, "incorrect data check");
    }
    if (trailer && size >= TRAILER && order_u32(next + 4, SWAPPED) != (uint32_t)(stream->position - stream->begun)) {
        return fail_damaged(stream, "incorrect length check");
    }
    bool is_cut = size < trailer;
    stream->rest = next + (is_cut ? size : trailer);
    stream->rest_size = is_cut ? 0 : size - trailer;
    stream->ended =
        !is_cut && (stream->zlib || !gzip_is(stream->rest, stream->rest_size) || inflateReset(&stream->z) != Z_OK);
    return CONUS_OK;
}

/* Lets zlib inflate once; its code. */
static int inflate_some(struct stream *stream, uint64_t limit)
{
    if (!stream->z.avail_in) {
        size_t size = smaller_of(stream->rest_size, INT_MAX);
        stream->z.next_in = (z_const Bytef *)stream->rest;
        stream->z.avail_in = (uInt)size;
        stream->rest += size;
        stream->rest_size -= size;
    }
    size_t space_left = set_output(stream, limit);
    const uint8_t *out = stream->z.next_out;
    int code = inflate(&stream->z, Z_NO_FLUSH);
    size_t got = space_left - stream->z.avail_out;
    stream->position += got;
    stream->sum = stream->zlib ? 0 : libdeflate_crc32(stream->sum, out, got);
    return code;
}

/* Inflates until `until` bytes are unpacked, the stream ends or the packed bytes are used up. */
static conus_status inflate_until(struct stream *stream, uint64_t until)
{
    conus_status status = CONUS_OK;
    while (!status && !stream->ended && stream->position < until) {
        if (!stream->in_member) {
            status = begin_member(stream);
            if (!stream->in_member) {
                return status;
            }
        }
        uint64_t before = stream->position;
        int code = inflate_some(stream, until - stream->position);
        if (code == Z_STREAM_END) {
            status = end_member(stream);
        } else if (code == Z_MEM_ERROR) {
            status = fail(CONUS_ERROR_MEMORY, "gzip: no memory to unpack");
        } else if (code == Z_BUF_ERROR && stream->position == before) {
            return CONUS_OK;
        } else if (code != Z_OK && code != Z_BUF_ERROR) {
            status = fail_damaged(stream, stream->z.msg ? stream->z.msg : "preset dictionary");
        }
    }
    return status;
}

static conus_status stream_open(struct stream **out, const uint8_t *data, size_t size, bool zlib)
{
    struct stream *stream = memory_zeroed(1, sizeof *stream);
    if (!stream) {
        return CONUS_ERROR_MEMORY;
    }
    stream->rest = data;
    stream->rest_size = size;
    stream->zlib = stream->in_member = zlib;
    if (inflateInit2(&stream->z, zlib ? MAX_WBITS : -MAX_WBITS) != Z_OK) {
        memory_free(stream);
        return fail(CONUS_ERROR_MEMORY, "gzip: no memory to unpack");
    }
    *out = stream;
    return CONUS_OK;
}

static void stream_close(struct stream *stream)
{
    inflateEnd(&stream->z);
    memory_free(stream);
}

conus_status gzip_head(struct bytes *out, const uint8_t *data, size_t size, size_t limit)
{
    struct stream *stream = NULL;
    limit = smaller_of(limit, INFLATE_RATIO * ((uint64_t)size + 1));
    uint8_t *kept = memory_raw(limit, 1);
    conus_status status = kept ? stream_open(&stream, data, size, false) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(kept);
        return status;
    }
    stream->kept = kept;
    stream->count = limit;
    status = inflate_until(stream, limit);
    status = GIVE(status, out, ((struct bytes){kept, (size_t)stream->position}), memory_free(kept));
    stream_close(stream);
    return status;
}

/* The usual case, one intact member of just the right size, in one fast call. Not where the gzip header has a checksum
 * of its own, which libdeflate does not verify. */
static bool unpack_at_once(uint8_t *out, size_t total, const uint8_t *data, size_t size, bool zlib)
{
    enum { FLAGS = 3, FLAG_HEADER_CHECKSUM = 2 };
    if (!zlib && (size <= FLAGS || data[FLAGS] & FLAG_HEADER_CHECKSUM)) {
        return false;
    }
    struct libdeflate_decompressor *decompressor = libdeflate_alloc_decompressor();
    size_t used = 0;
    size_t got = 0;
    bool done = decompressor &&
                (zlib ? libdeflate_zlib_decompress_ex : libdeflate_gzip_decompress_ex)(
                    decompressor, data, size, out, total, &used, &got) == LIBDEFLATE_SUCCESS &&
                used == size && got == total;
    libdeflate_free_decompressor(decompressor);
    return done;
}

static size_t count_junk(const uint8_t *data, size_t size)
{
    while (size && data[size - 1] == 0) { /* tapes and disks pad with zeros */
        size--;
    }
    return size;
}

/* Unpacks what is behind the range, and checks where it ends. */
static conus_status finish_range(struct stream *stream, struct gzip_range *range)
{
    conus_status status = inflate_until(stream, range->total + GZIP_EXTRA_LIMIT + 1);
    if (!status && stream->position > range->total + GZIP_EXTRA_LIMIT) {
        status = fail(CONUS_ERROR_DATA, "gzip: unpacks to more than the %llu bytes that the header asks for",
                      (unsigned long long)range->total);
    } else if (!status && (!stream->ended || stream->position < range->total)) {
        status = fail(CONUS_ERROR_DATA, "gzip: %s after %llu unpacked bytes, the header asks for %llu",
                      stream->ended ? "ends" : "cut off", (unsigned long long)stream->position,
                      (unsigned long long)range->total);
    }
    range->extra = status ? 0 : stream->position - range->total;
    range->junk = status ? 0 : count_junk(stream->rest, stream->rest_size);
    return status;
}

/* Gives the range to the sink. Of a stream that ends too early it gets the whole slabs. */
static conus_status give_slabs(struct stream *stream, const struct gzip_range *range)
{
    conus_status status = CONUS_OK;
    size_t got = 0;
    for (bool ends = false; !status && !ends && got < range->count;) {
        stream->from = range->from + got;
        stream->count = smaller_of(GZIP_SLAB, range->count - got);
        status = inflate_until(stream, stream->from + stream->count);
        ends = stream->position < stream->from + stream->count;
        status = status || ends ? status : range->sink(range->user, stream->kept, stream->count);
        got += stream->count;
    }
    stream->count = 0; /* nothing more is kept */
    return status;
}

/* Unpacks the range into `kept`, or through it, a slab, to the sink. */
static conus_status unpack_in_pieces(uint8_t *kept, struct gzip_range *range, const uint8_t *data, size_t size)
{
    struct stream *stream = NULL;
    conus_status status = stream_open(&stream, data, size, range->zlib);
    if (status) {
        return status;
    }
    stream->kept = kept;
    if (range->sink) {
        status = give_slabs(stream, range);
    } else {
        stream->from = range->from;
        stream->count = range->count;
    }
    status = status ? status : finish_range(stream, range);
    stream_close(stream);
    return status;
}

conus_status gzip_unpack(struct bytes *out, struct gzip_range *range, const uint8_t *data, size_t size)
{
    range->extra = range->junk = 0;
    if (range->total / INFLATE_RATIO > size) {
        return fail(CONUS_ERROR_DATA, "gzip: %zu bytes cannot unpack to the %llu that the header asks for", size,
                    (unsigned long long)range->total);
    }
    if (range->sink) {
        uint8_t *slab = memory_raw(GZIP_SLAB, 1);
        conus_status status = slab ? unpack_in_pieces(slab, range, data, size) : CONUS_ERROR_MEMORY;
        memory_free(slab);
        *out = status ? *out : (struct bytes){0};
        return status;
    }
    bool whole = range->from + range->count == range->total && range->from <= SCRATCH_SIZE;
    size_t needed = whole ? (size_t)range->total : range->count;
    struct bytes bytes = {memory_raw(needed, 1), range->count};
    if (!bytes.data) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = CONUS_OK;
    if (whole && unpack_at_once(bytes.data, needed, data, size, range->zlib)) {
        memmove(bytes.data, bytes.data + range->from, range->count);
    } else {
        status = unpack_in_pieces(bytes.data, range, data, size);
    }
    return GIVE(status, out, bytes, bytes_finish(&bytes));
}

/* Unpacks into stream->kept, which grows and is the caller's to free. */
static conus_status unpack_growing(struct stream *stream, uint64_t limit)
{
    while (!stream->ended) {
        if (stream->position == stream->count && stream->position == limit) {
            return fail(CONUS_ERROR_MEMORY, "gzip: unpacks to more than the %llu bytes that are allowed",
                        (unsigned long long)limit);
        }
        if (stream->position == stream->count) {
            size_t count = smaller_of(limit, 2 * (uint64_t)stream->count);
            uint8_t *kept = memory_resize(stream->kept, count, 1);
            if (!kept) {
                return CONUS_ERROR_MEMORY;
            }
            stream->kept = kept;
            stream->count = count;
        }
        uint64_t before = stream->position;
        conus_status status = inflate_until(stream, stream->count);
        if (status) {
            return status;
        }
        if (!stream->ended && stream->position == before) {
            return fail(CONUS_ERROR_DATA, "gzip: cut off after %llu unpacked bytes", (unsigned long long)before);
        }
    }
    return count_junk(stream->rest, stream->rest_size)
               ? fail(CONUS_ERROR_DATA, "gzip: %zu bytes after the end of the packed data", stream->rest_size)
               : CONUS_OK;
}

static conus_status unpack_all(struct bytes *out, const uint8_t *data, size_t size, uint64_t limit, bool zlib)
{
    struct stream *stream = NULL;
    conus_status status = stream_open(&stream, data, size, zlib);
    if (status) {
        return status;
    }
    stream->count = smaller_of(limit, 4 * (uint64_t)size + SCRATCH_SIZE);
    stream->kept = memory_raw(stream->count, 1);
    status = stream->kept ? unpack_growing(stream, limit) : CONUS_ERROR_MEMORY;
    status = GIVE(status, out, ((struct bytes){stream->kept, (size_t)stream->position}), memory_free(stream->kept));
    stream_close(stream);
    return status;
}

conus_status gzip_unpack_all(struct bytes *out, const uint8_t *data, size_t size, uint64_t limit)
{
    return unpack_all(out, data, size, limit, false);
}

conus_status gzip_unpack_zlib(struct bytes *out, const uint8_t *data, size_t size, uint64_t limit)
{
    return unpack_all(out, data, size, limit, true);
}

conus_status gzip_read(struct bytes *out, const char *path, uint64_t limit)
{
    struct bytes stored = {0};
    conus_status status = file_read_allowed(&stored, path, limit);
    if (!status && !gzip_is(stored.data, stored.size)) {
        *out = stored;
        return CONUS_OK;
    }
    if (!status) {
        status = gzip_unpack_all(out, stored.data, stored.size, limit);
        status = status ? fail_in(status, path) : CONUS_OK;
    }
    bytes_finish(&stored);
    return status;
}
