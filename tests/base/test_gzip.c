/* SPDX-License-Identifier: BSD-3-Clause */
/* Gzip files: members, ranges, bombs, flipped bits. */
#include "base/formats/packed.h"

#include "builders/nifti_builder.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* Bytes that pack badly enough to be spread over the packed data: a counter with a long period. */
static void fill(struct buffer *out, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        uint8_t byte = (uint8_t)(i * i / 7 + i % 5);
        buffer_append(out, &byte, 1);
    }
}

static conus_status unpack(struct bytes *out, struct gzip_range *range, const struct buffer *packed)
{
    return gzip_unpack(out, range, (const uint8_t *)packed->data, packed->size);
}

static void assert_unpacks(const struct buffer *packed, const struct buffer *plain, uint64_t extra, size_t junk)
{
    struct bytes bytes;
    struct gzip_range range = {.count = plain->size, .total = plain->size};
    assert_ok(unpack(&bytes, &range, packed));
    assert_int_equal(bytes.size, plain->size);
    assert_memory_equal(bytes.data, plain->data, plain->size);
    assert_int_equal(range.extra, extra);
    assert_int_equal(range.junk, junk);
    bytes_finish(&bytes);
}

static void one_member(void **state)
{
    (void)state;
    for (size_t size = 1; size < 300000; size = 3 * size + 1) {
        struct buffer plain = {0};
        struct buffer packed = {0};
        fill(&plain, size);
        append_gzip(&packed, plain.data, plain.size);
        assert_true(gzip_is((const uint8_t *)packed.data, packed.size));
        assert_false(gzip_is((const uint8_t *)plain.data, plain.size));
        assert_unpacks(&packed, &plain, 0, 0);
        buffer_finish(&plain);
        buffer_finish(&packed);
    }
}

static void ranges_in_the_middle(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct buffer packed = {0};
    fill(&plain, 200000);
    append_gzip(&packed, plain.data, plain.size);
    const size_t cases[][2] = {{0, 10}, {352, 199648}, {1, 70000}, {70000, 70000}, {199999, 1}, {65536, 65536}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct bytes bytes;
        struct gzip_range range = {.from = cases[i][0], .count = cases[i][1], .total = plain.size};
        assert_ok(unpack(&bytes, &range, &packed));
        assert_int_equal(bytes.size, cases[i][1]);
        assert_memory_equal(bytes.data, plain.data + cases[i][0], bytes.size);
        bytes_finish(&bytes);
    }
    buffer_finish(&plain);
    buffer_finish(&packed);
}

static void several_members_padding_and_junk(void **state)
{
    (void)state;
    static const uint8_t zeros[512];
    struct buffer plain = {0};
    struct buffer packed = {0};
    fill(&plain, 5000);
    append_gzip(&packed, plain.data, 1000);
    append_gzip(&packed, plain.data + 1000, 0);
    append_gzip(&packed, plain.data + 1000, 4000);
    assert_unpacks(&packed, &plain, 0, 0);
    buffer_append(&packed, zeros, sizeof zeros);
    assert_unpacks(&packed, &plain, 0, 0);
    buffer_text(&packed, "junk");
    assert_unpacks(&packed, &plain, 0, 516);
    buffer_finish(&packed);
    append_gzip(&packed, plain.data, plain.size);
    append_gzip(&packed, "more", 4);
    assert_unpacks(&packed, &plain, 4, 0);
    buffer_finish(&packed);
    buffer_finish(&plain);
}

static void the_head_alone(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct buffer packed = {0};
    struct bytes head;
    fill(&plain, 100000);
    append_gzip(&packed, plain.data, plain.size);
    assert_ok(gzip_head(&head, (const uint8_t *)packed.data, packed.size / 2, 540));
    assert_int_equal(head.size, 540);
    assert_memory_equal(head.data, plain.data, 540);
    bytes_finish(&head);
    assert_ok(gzip_head(&head, (const uint8_t *)packed.data, packed.size, SIZE_MAX));
    assert_int_equal(head.size, plain.size);
    bytes_finish(&head);
    assert_ok(gzip_head(&head, (const uint8_t *)packed.data, 5, 540));
    assert_int_equal(head.size, 0);
    bytes_finish(&head);
    buffer_finish(&plain);
    buffer_finish(&packed);
}

static void assert_range_fails(const struct buffer *packed, size_t count, uint64_t total, const char *part)
{
    struct bytes bytes;
    struct gzip_range range = {.count = count, .total = total};
    assert_fails(unpack(&bytes, &range, packed), CONUS_ERROR_DATA);
    if (!strstr(conus_message(), part)) {
        fail_msg("\"%s\" does not say \"%s\"", conus_message(), part);
    }
}

static void assert_unpack_fails(const struct buffer *packed, uint64_t total, const char *part)
{
    assert_range_fails(packed, 100, total, part);
}

static void sizes_must_agree_with_the_header(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct buffer packed = {0};
    struct buffer cut = {0};
    fill(&plain, 5000);
    append_gzip(&packed, plain.data, plain.size);
    assert_unpack_fails(&packed, 5001, "gzip: ends after 5000 unpacked bytes, the header asks for 5001");
    cut = (struct buffer){.data = packed.data, .size = packed.size - 1};
    assert_unpack_fails(&cut, 5000, "gzip: cut off after 5000 unpacked bytes");
    cut.size = packed.size / 2;
    assert_unpack_fails(&cut, 5000, "gzip: cut off after");
    assert_unpack_fails(&packed, UINT64_C(1) << 40, "cannot unpack to the 1099511627776 that the header asks for");
    buffer_finish(&plain);
    buffer_finish(&packed);
}

/* Data that inflate far beyond the size in the header are refused; up to GZIP_EXTRA_LIMIT bytes more are ignored. */
static void bombs_are_stopped(void **state)
{
    (void)state;
    size_t size = GZIP_EXTRA_LIMIT + 1000;
    struct buffer plain = {.data = calloc(2 * size, 1), .size = 2 * size};
    struct buffer packed = {0};
    struct bytes bytes;
    struct gzip_range range = {.count = 1000, .total = 1000};
    assert_non_null(plain.data);
    append_gzip(&packed, plain.data, size);
    assert_ok(unpack(&bytes, &range, &packed));
    assert_int_equal(range.extra, GZIP_EXTRA_LIMIT);
    bytes_finish(&bytes);
    buffer_finish(&packed);
    append_gzip(&packed, plain.data, size + 1);
    assert_unpack_fails(&packed, 1000, "gzip: unpacks to more than the 1000 bytes that the header asks for");
    free(plain.data);
    buffer_finish(&packed);
}

/* A flipped bit is an error or changes nothing, except in the fields that gzip itself does not check (time, system,
 * flags of no effect). */
static void flipped_bits_are_found(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct buffer packed = {0};
    size_t refused = 0;
    fill(&plain, 1500);
    append_gzip(&packed, plain.data, plain.size);
    for (size_t bit = 8 * 3; bit < 8 * packed.size; bit++) {
        struct bytes bytes;
        struct gzip_range range = {.count = plain.size, .total = plain.size};
        packed.data[bit / 8] = (char)(packed.data[bit / 8] ^ 1 << bit % 8);
        if (unpack(&bytes, &range, &packed)) {
            refused++;
        } else {
            assert_memory_equal(bytes.data, plain.data, plain.size);
            bytes_finish(&bytes);
        }
        packed.data[bit / 8] = (char)(packed.data[bit / 8] ^ 1 << bit % 8);
    }
    assert_true(refused >= 8 * (packed.size - 10)); /* all behind the gzip header */
    buffer_finish(&plain);
    buffer_finish(&packed);
}

/* RFC 1952: flag FHCRC, and behind the header the low two bytes of its CRC-32. It is checked, though the fast way does
 * not. */
static void a_header_may_have_a_checksum(void **state)
{
    (void)state;
    enum { FLAGS = 3, HEADER = 10, FHCRC = 2 };
    struct buffer plain = {0};
    struct buffer bare = {0};
    fill(&plain, 3000);
    append_gzip(&bare, plain.data, plain.size);
    bare.data[FLAGS] |= FHCRC;
    uint32_t crc = (uint32_t)crc32(0, (const Bytef *)bare.data, HEADER);
    for (uint32_t wrong = 0; wrong < 4; wrong++) { /* in neither, the low, the high, both bytes */
        const uint8_t sum[2] = {(uint8_t)(crc ^ (wrong & 1)), (uint8_t)(crc >> 8 ^ wrong >> 1)};
        struct buffer packed = {0};
        buffer_append(&packed, bare.data, HEADER);
        buffer_append(&packed, sum, sizeof sum);
        buffer_append(&packed, bare.data + HEADER, bare.size - HEADER);
        if (wrong) {
            const char part[] = "gzip: damaged near unpacked byte 0 (header crc mismatch)";
            assert_range_fails(&packed, plain.size, plain.size, part);
            assert_range_fails(&packed, 100, plain.size, part);
        } else {
            assert_unpacks(&packed, &plain, 0, 0);
        }
        buffer_finish(&packed);
    }
    buffer_finish(&plain);
    buffer_finish(&bare);
}

/* Appends a member with `flags` (RFC 1952) and all that they announce. */
static void append_flagged(struct buffer *out, unsigned flags, const struct buffer *plain)
{
    enum { FLAGS = 3, HEADER = 10, FHCRC = 2, FEXTRA = 4, FNAME = 8, FCOMMENT = 16 };
    struct buffer bare = {0};
    struct buffer header = {0};
    append_gzip(&bare, plain->data, plain->size);
    bare.data[FLAGS] = (char)flags;
    buffer_append(&header, bare.data, HEADER);
    buffer_append(&header, "\3\0a\0b", flags & FEXTRA ? 5 : 0);
    buffer_append(&header, "name", flags & FNAME ? 5 : 0);
    buffer_append(&header, "", flags & FCOMMENT ? 1 : 0);
    uint32_t crc = (uint32_t)crc32(0, (const Bytef *)header.data, (uInt)header.size);
    buffer_append(&header, (const uint8_t[]){(uint8_t)crc, (uint8_t)(crc >> 8)}, flags & FHCRC ? 2 : 0);
    buffer_append(out, header.data, header.size);
    buffer_append(out, bare.data + HEADER, bare.size - HEADER);
    buffer_finish(&bare);
    buffer_finish(&header);
}

/* What zlib makes of it: the number of unpacked bytes, all members together, or -1. */
static ptrdiff_t unpack_by_zlib(uint8_t *out, size_t limit, const uint8_t *data, size_t size)
{
    z_stream z = {.next_out = out, .avail_out = (uInt)limit};
    int code = Z_STREAM_END;
    assert_int_equal(inflateInit2(&z, 16 + MAX_WBITS), Z_OK);
    z.next_in = (z_const Bytef *)data;
    z.avail_in = (uInt)size;
    for (bool more = true; more; more = code == Z_STREAM_END && gzip_is(z.next_in, z.avail_in)) {
        inflateReset(&z);
        code = inflate(&z, Z_FINISH);
    }
    for (; z.avail_in && !*z.next_in; z.avail_in--) {
        z.next_in++;
    }
    ptrdiff_t got = code == Z_STREAM_END && !z.avail_in ? z.next_out - out : -1;
    inflateEnd(&z);
    return got;
}

static void assert_as_zlib(const uint8_t *data, size_t size)
{
    enum { LIMIT = 4096 };
    uint8_t expected[LIMIT];
    struct bytes bytes;
    uint8_t *exact = malloc(size ? size : 1);
    assert_non_null(exact);
    memcpy(exact, data, size);
    ptrdiff_t count = unpack_by_zlib(expected, LIMIT, exact, size);
    conus_status status = gzip_unpack_all(&bytes, exact, size, LIMIT);
    assert_int_equal(status == CONUS_OK, count >= 0);
    if (!status) {
        assert_int_equal(bytes.size, count);
        assert_memory_equal(bytes.data, expected, bytes.size);
        bytes_finish(&bytes);
    }
    free(exact);
}

/* Every kind of header, in two members, cut off anywhere and with each bit flipped. */
static void headers_and_trailers_are_read_as_zlib_reads_them(void **state)
{
    (void)state;
    struct buffer plain = {0};
    fill(&plain, 40);
    for (unsigned flags = 0; flags < 32; flags++) {
        struct buffer packed = {0};
        append_flagged(&packed, flags, &plain);
        append_flagged(&packed, 31 - flags, &plain);
        uint8_t *data = (uint8_t *)packed.data;
        for (size_t size = 0; size <= packed.size; size++) {
            assert_as_zlib(data, size);
        }
        for (size_t bit = 0; bit < 8 * packed.size; bit++) {
            data[bit / 8] ^= (uint8_t)(1 << bit % 8);
            assert_as_zlib(data, packed.size);
            data[bit / 8] ^= (uint8_t)(1 << bit % 8);
        }
        buffer_finish(&packed);
    }
    buffer_finish(&plain);
}

static conus_status attempt(void *data)
{
    const struct buffer *packed = data;
    struct bytes bytes = {0};
    struct gzip_range range = {.from = 10, .count = 100, .total = 5000};
    conus_status status = gzip_head(&bytes, (const uint8_t *)packed->data, packed->size, 540);
    bytes_finish(&bytes);
    if (!status) {
        status = unpack(&bytes, &range, packed);
        bytes_finish(&bytes);
    }
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct buffer packed = {0};
    fill(&plain, 5000);
    append_gzip(&packed, plain.data, plain.size);
    test_every_allocation(attempt, &packed);
    buffer_finish(&plain);
    buffer_finish(&packed);
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct buffer packed = {0};
    fill(&plain, 700);
    append_gzip(&packed, plain.data, plain.size);
    for (size_t size = 0; size < packed.size; size++) {
        uint8_t *exact = malloc(size ? size : 1);
        struct bytes bytes;
        struct gzip_range range = {.count = plain.size, .total = plain.size};
        assert_non_null(exact);
        memcpy(exact, packed.data, size);
        assert_fails(gzip_unpack(&bytes, &range, exact, size), CONUS_ERROR_DATA);
        free(exact);
    }
    buffer_finish(&plain);
    buffer_finish(&packed);
}

/* Files of unknown size: one member or two, padded with zeros, and nothing else behind them. */
static void a_whole_of_unknown_size(void **state)
{
    (void)state;
    static const char *const tails[] = {"", "\0\0\0", "\0x"};
    for (size_t i = 0; i < 6; i++) {
        struct buffer plain = {0};
        struct buffer packed = {0};
        struct bytes bytes;
        size_t size = i % 2 ? 300000 : 4000000; /* all zeros: packs a thousandfold */
        char *zeros = calloc(size, 1);
        assert_non_null(zeros);
        fill(&plain, 1000);
        append_gzip(&packed, plain.data, plain.size);
        append_gzip(&packed, zeros, size);
        buffer_append(&packed, tails[i / 2], i / 2 + (i / 2 > 0));
        buffer_append(&plain, zeros, size);
        conus_status status = gzip_unpack_all(&bytes, (const uint8_t *)packed.data, packed.size, plain.size);
        assert_fails(status, i / 2 == 2 ? CONUS_ERROR_DATA : CONUS_OK);
        if (!status) {
            assert_int_equal(bytes.size, plain.size);
            assert_memory_equal(bytes.data, plain.data, plain.size);
            bytes_finish(&bytes);
        }
        assert_fails(gzip_unpack_all(&bytes, (const uint8_t *)packed.data, packed.size, plain.size - 1),
                     CONUS_ERROR_MEMORY);
        free(zeros);
        buffer_finish(&plain);
        buffer_finish(&packed);
    }
}

static conus_status attempt_all(void *data)
{
    const struct buffer *packed = data;
    struct bytes bytes = {0};
    conus_status status = gzip_unpack_all(&bytes, (const uint8_t *)packed->data, packed->size, UINT64_C(1) << 30);
    bytes_finish(&bytes);
    return status;
}

static void a_whole_with_failing_allocations_and_prefixes(void **state)
{
    (void)state;
    static const char zeros[300000];
    struct buffer packed = {0};
    struct bytes bytes;
    append_gzip(&packed, zeros, sizeof zeros);
    test_every_allocation(attempt_all, &packed);
    for (size_t size = 0; size < packed.size; size++) {
        assert_fails(gzip_unpack_all(&bytes, (const uint8_t *)packed.data, size, 1 << 30), CONUS_ERROR_DATA);
    }
    packed.data[packed.size - 5] ^= 1; /* a byte of the checksum */
    assert_fails(gzip_unpack_all(&bytes, (const uint8_t *)packed.data, packed.size, 1 << 30), CONUS_ERROR_DATA);
    buffer_finish(&packed);
}

TEST_GROUP(gzip)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_whole_of_unknown_size),
        cmocka_unit_test(a_whole_with_failing_allocations_and_prefixes),
        cmocka_unit_test(one_member),
        cmocka_unit_test(ranges_in_the_middle),
        cmocka_unit_test(several_members_padding_and_junk),
        cmocka_unit_test(the_head_alone),
        cmocka_unit_test(sizes_must_agree_with_the_header),
        cmocka_unit_test(bombs_are_stopped),
        cmocka_unit_test(a_header_may_have_a_checksum),
        cmocka_unit_test(headers_and_trailers_are_read_as_zlib_reads_them),
        cmocka_unit_test(flipped_bits_are_found),
        cmocka_unit_test(every_failing_allocation),
        cmocka_unit_test(every_prefix_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
