/* SPDX-License-Identifier: BSD-3-Clause */
/* An index of a gzip file that somebody else may have written. The first eight bytes choose a range. The rest is an
 * index; and then, three by three, places and values of up to four bytes in a valid index. Either index leads to the
 * file's own bytes, or to nothing. The file and its index are made once, always the same. */
#include "base/formats/gzip_index.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { PLAIN = 60000, SPACING = 6000, FIRST = 8, EDIT = 3, EDITS = 4 };

static struct {
    uint8_t plain[PLAIN];
    int file;
    struct buffer index;
} right;

static void must(bool holds)
{
    if (!holds) {
        abort();
    }
}

static void pack(struct bytes *out)
{
    z_stream z = {0};
    *out = (struct bytes){memory_raw(2 * (size_t)PLAIN, 1), 0};
    must(out->data && deflateInit2(&z, 6, Z_DEFLATED, 16 + MAX_WBITS, 1, Z_DEFAULT_STRATEGY) == Z_OK);
    z.next_in = right.plain;
    z.avail_in = PLAIN;
    z.next_out = out->data;
    z.avail_out = 2 * PLAIN;
    must(deflate(&z, Z_FINISH) == Z_STREAM_END);
    out->size = z.total_out;
    deflateEnd(&z);
}

/* Makes two equal halves of noise: the second is a copy of the first, as far as a window reaches. */
static void make_right(void)
{
    uint32_t random = 1;
    struct bytes packed;
    struct bytes none = {0};
    struct gzip_indexer indexer;
    struct gzip_range range = {.count = 1, .total = PLAIN, .indexer = &indexer};
    for (size_t i = 0; i < PLAIN; i++) {
        random = random * 1664525 + 1013904223; /* Knuth and Lewis */
        right.plain[i] = i < PLAIN / 2 || i % 50 == 0 ? (uint8_t)(random >> 26) : right.plain[i - PLAIN / 2];
    }
    pack(&packed);
    gzip_indexer_init(&indexer, PLAIN);
    indexer.spacing = SPACING;
    must(!gzip_unpack(&none, &range, packed.data, packed.size));
    struct gzip_index whole = {.unpacked = PLAIN, .packed = packed.size};
    memset(whole.sha256, '0', sizeof whole.sha256 - 1);
    must(gzip_indexer_write(&right.index, &indexer, &whole));
    right.file = memfd_create("packed", MFD_CLOEXEC);
    must(right.file >= 0 && write(right.file, packed.data, packed.size) == (ssize_t)packed.size);
    gzip_indexer_finish(&indexer);
    bytes_finish(&packed);
    bytes_finish(&none);
}

static conus_status keep_slab(void *user, const uint8_t *data, size_t size)
{
    buffer_append(user, data, size);
    return CONUS_OK;
}

/* Unpacks the range into memory and to a sink; returns whether that succeeds. */
static bool follow(struct bytes *out, const struct gzip_index *index, struct gzip_range range)
{
    struct buffer got = {0};
    struct bytes none = {0};
    struct gzip_range slabs = range;
    slabs.sink = keep_slab;
    slabs.user = &got;
    conus_status status = gzip_index_unpack(out, &range, index, right.file);
    must(gzip_index_unpack(&none, &slabs, index, right.file) == status);
    must(status || (got.size == out->size && (!got.size || memcmp(got.data, out->data, got.size) == 0)));
    buffer_finish(&got);
    return !status;
}

static bool parse_and_follow(const uint8_t *index, size_t size, struct gzip_range range, struct bytes *out)
{
    struct gzip_index parsed;
    uint8_t *memory = memory_copy(index, size, 1); /* of exactly this size, for sanitizers */
    must(memory);
    bool followed = gzip_index_parse(&parsed, memory, size) && follow(out, &parsed, range);
    (void)(gzip_index_parse(&parsed, memory, size) && gzip_index_fits(&parsed, right.file));
    memory_free(memory);
    return followed;
}

static size_t two_bytes(const uint8_t *data)
{
    return data[0] | (size_t)data[1] << 8;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct bytes out = {0};
    if (size < FIRST) {
        return 0;
    }
    if (!right.index.data) {
        make_right();
    }
    struct gzip_range range = {.from = two_bytes(data) % PLAIN, .total = PLAIN};
    range.count = two_bytes(data + 2) % (PLAIN - range.from + 1);
    (void)parse_and_follow(data + FIRST, size - FIRST, range, &out);
    bytes_finish(&out);
    uint8_t *index = memory_copy(right.index.data, right.index.size, 1);
    must(index);
    for (size_t i = 0; i < EDITS && FIRST + (i + 1) * EDIT <= size; i++) {
        const uint8_t *edit = data + FIRST + i * EDIT;
        index[two_bytes(edit) % right.index.size] ^= edit[2];
    }
    if (parse_and_follow(index, right.index.size, range, &out)) {
        must(memcmp(out.data, right.plain + range.from, range.count) == 0);
    }
    memory_free(index);
    bytes_finish(&out);
    return 0;
}
