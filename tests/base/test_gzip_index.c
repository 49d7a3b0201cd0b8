/* SPDX-License-Identifier: BSD-3-Clause */
/* Indexes of gzip files: ranges unpacked with them equal those of gzip_unpack(), or the index is refused. */
#include "base/formats/gzip_index.h"

#include "base/memory.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

enum { SIZE = 240000, SPACING = 16000 };

/* Runs, distant copies and noise, so that windows matter and there are many blocks. */
static void fill(struct buffer *out)
{
    uint64_t random = 7;
    while (out->size < SIZE) {
        size_t length = (size_t)test_random(&random, 1, 400);
        bool copies = out->size > 30000 && test_random(&random, 0, 1) < 0.4;
        size_t from = copies ? out->size - (size_t)test_random(&random, 1000, 30000) : 0;
        for (size_t i = 0; i < length; i++) {
            uint8_t byte = copies ? (uint8_t)out->data[from + i] : (uint8_t)test_random(&random, 0, 90);
            buffer_append(out, &byte, 1);
        }
    }
}

/* Appends a member made by zlib, with a file name in its header if `named`. */
static void append_member(struct buffer *out, const char *data, size_t size, int level, int strategy, bool named)
{
    z_stream z = {0};
    gz_header header = {.name = (Bytef *)"name.nii"};
    size_t most = size + size / 2 + 1000;
    uint8_t *packed = malloc(most);
    assert_int_equal(deflateInit2(&z, level, Z_DEFLATED, 16 + MAX_WBITS, 1 /* small blocks */, strategy), Z_OK);
    assert_int_equal(named ? deflateSetHeader(&z, &header) : Z_OK, Z_OK);
    z.next_in = (z_const Bytef *)data;
    z.avail_in = (uInt)size;
    z.next_out = packed;
    z.avail_out = (uInt)most;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    buffer_append(out, packed, most - z.avail_out);
    deflateEnd(&z);
    free(packed);
}

/* A packed file, its plain bytes, and its index. */
struct indexed {
    struct buffer plain, packed, bytes;
    struct gzip_index index; /* in bytes */
    int descriptor;
};

static int file_of(const void *data, size_t size)
{
    int file = memfd_create("packed", MFD_CLOEXEC);
    assert_true(file >= 0);
    assert_int_equal(pwrite(file, data, size, 0), size);
    return file;
}

/* Unpacks the range with an indexer, which must not change it, and keeps the index's bytes. */
static void make_index(struct indexed *indexed, struct gzip_range range)
{
    struct gzip_indexer indexer;
    struct gzip_index whole = {.packed = indexed->packed.size,
                               .sha256 = "0123456789012345678901234567890123456789"
                                         "012345678901234567890123"};
    struct gzip_range same = range;
    struct bytes with = {0};
    struct bytes without = {0};
    const uint8_t *packed = (const uint8_t *)indexed->packed.data;
    gzip_indexer_init(&indexer, range.total);
    assert_int_equal(indexer.spacing, GZIP_INDEX_SPAN);
    indexer.spacing = SPACING;
    range.indexer = &indexer;
    assert_ok(gzip_unpack(&with, &range, packed, indexed->packed.size));
    assert_ok(gzip_unpack(&without, &same, packed, indexed->packed.size));
    assert_int_equal(with.size, without.size);
    assert_memory_equal(with.data, without.data, with.size);
    assert_true(range.extra == same.extra && range.junk == same.junk);
    whole.unpacked = range.total + range.extra;
    whole.junk = range.junk;
    buffer_clear(&indexed->bytes);
    assert_true(gzip_indexer_write(&indexed->bytes, &indexer, &whole));
    gzip_indexer_finish(&indexer);
    bytes_finish(&with);
    bytes_finish(&without);
    assert_true(gzip_index_parse(&indexed->index, (const uint8_t *)indexed->bytes.data, indexed->bytes.size));
}

static void finish(struct indexed *indexed)
{
    buffer_finish(&indexed->plain);
    buffer_finish(&indexed->packed);
    buffer_finish(&indexed->bytes);
    close(indexed->descriptor);
}

/* Packs the same bytes in one of PACKINGS ways. */
static void pack(struct indexed *out, int how)
{
    static const uint8_t zeros[100];
    *out = (struct indexed){0};
    fill(&out->plain);
    const char *data = out->plain.data;
    size_t size = out->plain.size;
    size_t step = how == 4 ? 5000 : how == 5 ? 130000 : size;
    for (size_t at = 0; at < size; at += step) {
        size_t part = size - at < step ? size - at : step;
        append_member(&out->packed, data + at, part, how == 1 ? 1 : 6, how == 2 ? Z_HUFFMAN_ONLY : Z_DEFAULT_STRATEGY,
                      how == 3 || at);
        if (how == 5) {
            append_member(&out->packed, "", 0, 6, Z_DEFAULT_STRATEGY, false);
        }
    }
    buffer_append(&out->packed, zeros, how == 3 ? sizeof zeros : 0);
    buffer_text(&out->packed, how == 2 ? "junk" : "");
    out->descriptor = file_of(out->packed.data, out->packed.size);
    make_index(out, (struct gzip_range){.from = 1000, .count = 5000, .total = size - 10});
}

enum { PACKINGS = 6 };

static conus_status keep_slab(void *user, const uint8_t *data, size_t size)
{
    buffer_append(user, data, size);
    return CONUS_OK;
}

/* Whether the range is unpacked as in the plain file, kept and to a sink alike; otherwise it must fail both times. */
static bool gives(const struct indexed *indexed, const struct gzip_index *index, size_t from, size_t count)
{
    struct buffer got = {0};
    struct bytes bytes = {0};
    struct bytes none = {0};
    struct gzip_range range = {.from = from, .count = count, .total = indexed->plain.size - 10};
    struct gzip_range slabs = range;
    slabs.sink = keep_slab;
    slabs.user = &got;
    conus_status status = gzip_index_unpack(&bytes, &range, index, indexed->descriptor);
    assert_int_equal(gzip_index_unpack(&none, &slabs, index, indexed->descriptor), status);
    assert_null(none.data);
    assert_true(!status || status == CONUS_ERROR_DATA);
    if (!status) {
        assert_int_equal(bytes.size, count);
        assert_memory_equal(bytes.data, indexed->plain.data + from, count);
        assert_int_equal(got.size, count);
        assert_memory_equal(got.data, bytes.data, count);
        assert_int_equal(range.extra, index->unpacked - range.total);
    }
    bytes_finish(&bytes);
    buffer_finish(&got);
    return !status;
}

static void ranges_are_what_unpacking_gives(void **state)
{
    (void)state;
    uint64_t random = 1;
    for (int how = 0; how < PACKINGS; how++) {
        struct indexed indexed;
        pack(&indexed, how);
        const struct gzip_index *index = &indexed.index;
        size_t total = indexed.plain.size - 10;
        assert_int_equal(index->junk, how == 2 ? 4 : 0);
        assert_true(index->count > 8 && index->count <= SIZE / SPACING + 1);
        assert_true(index->trailer == 0 ? how >= 4 : how < 4);
        assert_true(gzip_index_fits(index, indexed.descriptor));
        for (size_t i = 0; i < index->count; i++) { /* from each point, up to each, and across */
            size_t at = (size_t)index->points[i].unpacked;
            assert_true(gives(&indexed, index, at, 1));
            assert_true(gives(&indexed, index, at ? at - 1 : 0, 2));
            assert_true(gives(&indexed, index, 0, at));
        }
        for (int i = 0; i < 40; i++) {
            size_t from = (size_t)test_random(&random, 0, (double)total);
            assert_true(gives(&indexed, index, from, (size_t)test_random(&random, 0, (double)(total - from))));
        }
        assert_true(gives(&indexed, index, 0, total));
        assert_true(gives(&indexed, index, total, 0));
        finish(&indexed);
    }
}

static void the_head_and_what_is_not_there(void **state)
{
    (void)state;
    struct indexed indexed;
    struct bytes head = {0};
    pack(&indexed, 0);
    assert_ok(gzip_index_head(&head, &indexed.index, 540, indexed.descriptor));
    assert_int_equal(head.size, 540);
    assert_memory_equal(head.data, indexed.plain.data, 540);
    bytes_finish(&head);
    assert_ok(gzip_index_head(&head, &indexed.index, SIZE_MAX, indexed.descriptor));
    assert_int_equal(head.size, indexed.plain.size);
    bytes_finish(&head);
    struct gzip_range more = {.from = 5, .count = 1, .total = indexed.plain.size + 1};
    assert_fails(gzip_index_unpack(&head, &more, &indexed.index, indexed.descriptor), CONUS_ERROR_DATA);
    struct gzip_range turned = {.from = 9, .count = SIZE_MAX - 2, .total = 100};
    assert_fails(gzip_index_unpack(&head, &turned, &indexed.index, indexed.descriptor), CONUS_ERROR_DATA);
    assert_fails(gzip_index_head(&head, &indexed.index, 5, -1), CONUS_ERROR_IO);
    assert_null(head.data);
    finish(&indexed);
}

/* Access points are limited in number, whatever the file: about total / 512 apart, but never nearer than 1 MiB. */
static void points_are_not_too_many(void **state)
{
    (void)state;
    struct gzip_indexer indexer;
    const uint64_t totals[][2] = {{0, 1 << 20}, {1 << 29, (1 << 20) + 1}, {UINT64_C(1) << 40, (UINT64_C(1) << 31) + 1}};
    for (size_t i = 0; i < 3; i++) {
        gzip_indexer_init(&indexer, totals[i][0]);
        assert_int_equal(indexer.spacing, totals[i][1]);
        gzip_indexer_finish(&indexer);
    }
}

/* Counts the spans that are unpacked; gives() asserts that they are right. */
static size_t count_right(const struct indexed *indexed, const struct gzip_index *index)
{
    size_t right = 0;
    for (size_t i = 0; i < indexed->index.count; i++) {
        right += gives(indexed, index, (size_t)indexed->index.points[i].unpacked, 1);
    }
    return right;
}

static void a_changed_point_gives_nothing_wrong(void **state)
{
    (void)state;
    struct indexed indexed;
    pack(&indexed, 0);
    struct gzip_index index = indexed.index;
    struct gzip_point *points = memory_copy(index.points, index.count, sizeof *points);
    index.points = points;
    for (size_t i = 0; i < index.count; i++) {
        const struct gzip_point right = points[i];
        for (size_t byte = 0; byte < sizeof right; byte++) {
            ((uint8_t *)&points[i])[byte] ^= (uint8_t)(1 << (i + byte) % 8);
            points[i].unpacked = right.unpacked; /* the order, which gzip_index_parse() has checked */
            points[i].window = points[i].window % (uint32_t)(index.windows_size + 1);
            points[i].window_size %= (uint32_t)(index.windows_size - points[i].window + 1);
            points[i].bits %= 8;
            points[i].packed = points[i].packed % index.packed + 1;
            (void)gives(&indexed, &index, (size_t)right.unpacked, 1);
            points[i] = right;
        }
        points[i].sum ^= 1;
        assert_false(gives(&indexed, &index, (size_t)right.unpacked, 1));
        assert_false(gives(&indexed, &index, 0, indexed.plain.size - 10));
        assert_false(gzip_index_fits(&index, indexed.descriptor));
        points[i] = right;
        points[i].packed++;
        assert_false(gives(&indexed, &index, (size_t)right.unpacked, 1));
        points[i] = right;
        points[i].bits = (right.bits + 1) % 8;
        assert_false(gives(&indexed, &index, (size_t)right.unpacked, 1));
        points[i] = right;
    }
    for (size_t i = 1; i < index.count; i++) { /* a border between spans elsewhere */
        points[i].unpacked--;
        assert_false(gives(&indexed, &index, (size_t)points[i].unpacked, 1));
        assert_false(gives(&indexed, &index, (size_t)points[i - 1].unpacked, 1));
        points[i].unpacked++;
    }
    assert_int_equal(count_right(&indexed, &index), index.count);
    memory_free(points);
    finish(&indexed);
}

static void a_changed_window_gives_nothing_wrong(void **state)
{
    (void)state;
    struct indexed indexed;
    pack(&indexed, 0);
    struct gzip_index index = indexed.index;
    uint8_t *windows = memory_copy(index.windows, index.windows_size, 1);
    index.windows = windows;
    size_t found_out = 0;
    for (size_t i = 1; i < index.count; i++) {
        size_t at = index.points[i].window + index.points[i].window_size / 2;
        memset(windows + at, 0x55, 100);
        found_out += !gives(&indexed, &index, (size_t)index.points[i].unpacked, 1);
        memcpy(windows + at, indexed.index.windows + at, 100);
    }
    assert_true(found_out > index.count / 2); /* bytes that no later byte copies may be anything */
    memset(windows, 0, index.windows_size);
    assert_int_equal(count_right(&indexed, &index), 1); /* the first point needs none */
    memory_free(windows);
    finish(&indexed);
}

static void another_file_is_found_out(void **state)
{
    (void)state;
    struct indexed indexed;
    struct indexed other;
    pack(&indexed, 0);
    pack(&other, 1);                                                          /* the same bytes, packed otherwise */
    assert_true(count_right(&indexed, &other.index) < other.index.count / 2); /* equal spans are right */
    for (size_t i = 0; i < indexed.packed.size; i += 4001) {
        uint8_t changed = (uint8_t)(indexed.packed.data[i] ^ 0x10);
        assert_int_equal(pwrite(indexed.descriptor, &changed, 1, (off_t)i), 1);
        assert_true(count_right(&indexed, &indexed.index) >= indexed.index.count - 2); /* far from it all is right */
        assert_int_equal(pwrite(indexed.descriptor, indexed.packed.data + i, 1, (off_t)i), 1);
    }
    for (size_t size = 0; size < indexed.packed.size; size += 5003) {
        assert_int_equal(ftruncate(indexed.descriptor, (off_t)size), 0);
        assert_false(gives(&indexed, &indexed.index, 0, indexed.plain.size - 10));
        assert_false(gzip_index_fits(&indexed.index, indexed.descriptor));
    }
    finish(&indexed);
    finish(&other);
}

static void every_prefix_and_byte(void **state)
{
    (void)state;
    struct indexed indexed;
    struct gzip_index index;
    pack(&indexed, 4);
    uint8_t *bytes = memory_copy(indexed.bytes.data, indexed.bytes.size, 1);
    for (size_t size = 0; size < indexed.bytes.size; size++) {
        assert_false(gzip_index_parse(&index, bytes, size));
    }
    size_t ahead = (size_t)(indexed.index.windows - (const uint8_t *)indexed.bytes.data);
    for (size_t i = 0; i < ahead; i++) {
        bytes[i] ^= (uint8_t)(1 << i % 8);
        if (gzip_index_parse(&index, bytes, indexed.bytes.size) && index.unpacked >= SIZE) {
            (void)gives(&indexed, &index, i * (SIZE / ahead), 100);
        }
        bytes[i] ^= (uint8_t)(1 << i % 8);
    }
    assert_true(gzip_index_parse(&index, bytes, indexed.bytes.size));
    memory_free(bytes);
    finish(&indexed);
}

/* Places of the index's numbers in its bytes. */
enum {
    HEAD_UNPACKED = 0,
    HEAD_PACKED = 8,
    HEAD_BEGIN = 32,
    HEAD_ZLIB = 40,
    HEAD_COUNT = 48,
    HEAD_WINDOWS = 56,
    POINTS = 136
};

static void parts_that_contradict_are_refused(void **state)
{
    (void)state;
    struct indexed indexed;
    struct gzip_index index;
    pack(&indexed, 0);
    uint8_t *bytes = memory_copy(indexed.bytes.data, indexed.bytes.size, 1);
    const uint64_t huge[] = {0, UINT64_MAX, UINT64_MAX / 40 + 2, indexed.index.count + 1};
    for (size_t i = 0; i < 4; i++) {
        memcpy(bytes + HEAD_COUNT, &huge[i], 8);
        assert_false(gzip_index_parse(&index, bytes, indexed.bytes.size));
        memcpy(bytes, indexed.bytes.data, indexed.bytes.size);
        memcpy(bytes + HEAD_WINDOWS, &huge[i], 8);
        assert_false(gzip_index_parse(&index, bytes, indexed.bytes.size));
        memcpy(bytes, indexed.bytes.data, indexed.bytes.size);
    }
    /* 2^63 is the first size that no file can have: off_t ends before it. */
    const uint64_t sizes[] = {INT64_MAX, INT64_MAX + UINT64_C(1)};
    for (size_t i = 0; i < 2; i++) {
        memcpy(bytes + HEAD_UNPACKED, &sizes[i], 8);
        assert_int_equal(gzip_index_parse(&index, bytes, indexed.bytes.size), i == 0);
        assert_false(i == 0 && gzip_index_fits(&index, indexed.descriptor));
        memcpy(bytes, indexed.bytes.data, indexed.bytes.size);
        memcpy(bytes + HEAD_PACKED, &sizes[i], 8);
        assert_int_equal(gzip_index_parse(&index, bytes, indexed.bytes.size), i == 0);
        memcpy(bytes, indexed.bytes.data, indexed.bytes.size);
    }
    memcpy(bytes + HEAD_BEGIN, &huge[1], 8);
    assert_false(gzip_index_parse(&index, bytes, indexed.bytes.size));
    memcpy(bytes, indexed.bytes.data, indexed.bytes.size);
    bytes[HEAD_ZLIB] = 2;
    assert_false(gzip_index_parse(&index, bytes, indexed.bytes.size));
    bytes[HEAD_ZLIB] = 0;
    struct gzip_point *points = (void *)(bytes + POINTS);
    assert_int_equal(points[0].unpacked, 0);
    const struct gzip_point wrong[] = {
        {.unpacked = 0, .packed = points[1].packed}, /* not behind the first */
        {.unpacked = points[2].unpacked, .packed = points[1].packed},
        {.unpacked = points[1].unpacked, .packed = 0},
        {.unpacked = points[1].unpacked, .packed = points[0].packed - 1},
        {.unpacked = points[1].unpacked, .packed = indexed.packed.size + 1},
        {.unpacked = points[1].unpacked, .packed = points[1].packed, .bits = 8},
        {.unpacked = points[1].unpacked, .packed = points[1].packed, .window = UINT32_MAX},
        {.unpacked = points[1].unpacked, .packed = points[1].packed, .window = 1, .window_size = UINT32_MAX},
    };
    const struct gzip_point right = points[1];
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        points[1] = wrong[i];
        assert_false(gzip_index_parse(&index, bytes, indexed.bytes.size));
    }
    points[1] = right;
    assert_true(gzip_index_parse(&index, bytes, indexed.bytes.size));
    points[0].unpacked = 1;
    assert_false(gzip_index_parse(&index, bytes, indexed.bytes.size));
    memory_free(bytes);
    finish(&indexed);
}

static conus_status attempt(void *data)
{
    const struct indexed *indexed = data;
    struct bytes bytes = {0};
    struct gzip_range range = {.from = 100000, .count = 50000, .total = SIZE};
    conus_status status = gzip_index_unpack(&bytes, &range, &indexed->index, indexed->descriptor);
    bytes_finish(&bytes);
    return status;
}

/* Without memory for an index unpacking goes on. */
static conus_status attempt_making(void *data)
{
    const struct indexed *indexed = data;
    struct gzip_indexer indexer;
    struct buffer index = {0};
    struct bytes bytes = {0};
    struct gzip_index whole = {.unpacked = indexed->plain.size, .packed = indexed->packed.size};
    struct gzip_range range = {.from = 5, .count = 50000, .total = indexed->plain.size, .indexer = &indexer};
    gzip_indexer_init(&indexer, range.total);
    indexer.spacing = SPACING;
    conus_status status = gzip_unpack(&bytes, &range, (const uint8_t *)indexed->packed.data, indexed->packed.size);
    memset(whole.sha256, '0', sizeof whole.sha256 - 1);
    bool made = gzip_indexer_write(&index, &indexer, &whole);
    assert_true(status || memcmp(bytes.data, indexed->plain.data + 5, bytes.size) == 0);
    assert_true(made || status || test_allocation_failed());
    gzip_indexer_finish(&indexer);
    buffer_finish(&index);
    bytes_finish(&bytes);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct indexed indexed;
    pack(&indexed, 0);
    test_every_allocation(attempt, &indexed);
    test_every_allocation(attempt_making, &indexed);
    finish(&indexed);
}

TEST_GROUP(gzip_index)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ranges_are_what_unpacking_gives),
        cmocka_unit_test(the_head_and_what_is_not_there),
        cmocka_unit_test(points_are_not_too_many),
        cmocka_unit_test(a_changed_point_gives_nothing_wrong),
        cmocka_unit_test(a_changed_window_gives_nothing_wrong),
        cmocka_unit_test(another_file_is_found_out),
        cmocka_unit_test(every_prefix_and_byte),
        cmocka_unit_test(parts_that_contradict_are_refused),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
