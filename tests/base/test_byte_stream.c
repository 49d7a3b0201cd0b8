/* SPDX-License-Identifier: BSD-3-Clause */
/* Files read block by block, plain and packed, against their bytes. */
#include "base/formats/byte_stream.h"

#include "base/files/file.h"
#include "builders/nifti_builder.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* Bytes with a long period, so that a block in the wrong place is noticed. */
static void fill(struct buffer *out, size_t size)
{
    buffer_append(out, NULL, 0); /* gives it an address */
    for (size_t i = 0; i < size; i++) {
        uint8_t byte = (uint8_t)(i * i / 7 + i % 5);
        buffer_append(out, &byte, 1);
    }
}

/* Reads everything, in steps of @p step bytes, and compares. */
static conus_status read_all(struct byte_stream *stream, const struct buffer *plain, size_t step, char sum[65])
{
    conus_status status = CONUS_OK;
    for (size_t at = 0; !status && at < plain->size;) {
        size_t wanted = plain->size - at < step ? plain->size - at : step;
        assert_int_equal(stream->position, at);
        status = byte_stream_need(stream, step);
        if (!status) {
            assert_true(stream->size >= wanted);
            assert_memory_equal(stream->data, plain->data + at, wanted);
            byte_stream_skip(stream, wanted);
            at += wanted;
        }
    }
    status = status ? status : byte_stream_need(stream, 1);
    if (!status) {
        assert_int_equal(stream->size, 0);
        status = byte_stream_sum(sum, stream);
    }
    return status;
}

static conus_status read_memory(const struct buffer *stored, const struct buffer *plain, size_t step, char sum[65])
{
    struct byte_stream stream = {0};
    conus_status status = byte_stream_of(&stream, (const uint8_t *)stored->data, stored->size);
    status = status ? status : read_all(&stream, plain, step, sum);
    byte_stream_finish(&stream);
    return status;
}

static void assert_reads(const struct buffer *stored, const struct buffer *plain, size_t step)
{
    char wanted[65];
    char sum[2][65];
    struct byte_stream stream = {0};
    file_sha256(wanted, &(const struct bytes){(uint8_t *)stored->data, stored->size});
    assert_ok(read_memory(stored, plain, step, sum[0]));
    assert_ok(byte_stream_open(&stream, write_bytes("stream", stored)));
    assert_ok(read_all(&stream, plain, step, sum[1]));
    byte_stream_finish(&stream);
    assert_string_equal(sum[0], wanted);
    assert_string_equal(sum[1], wanted);
}

/* Sizes around those of a plain and of a packed block, and gzip members that end at different places. */
static void files_of_all_sizes(void **state)
{
    (void)state;
    static const size_t sizes[] = {
        0, 1, 2, 3, 4, 1000, BYTE_STREAM_BLOCK, BYTE_STREAM_BLOCK + 1, 3 * BYTE_STREAM_BLOCK - 1};
    static const size_t steps[] = {77777, BYTE_STREAM_BLOCK};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct buffer plain = {0};
        struct buffer packed = {0};
        struct buffer members = {0};
        fill(&plain, sizes[i]);
        append_gzip(&packed, plain.data, plain.size);
        append_gzip(&members, plain.data, plain.size / 3);
        append_gzip(&members, plain.data, 0);
        append_gzip(&members, plain.data + plain.size / 3, plain.size - plain.size / 3);
        buffer_append(&members, "\0\0\0\0\0", 5);
        for (size_t s = 0; s < 2; s++) {
            assert_reads(&plain, &plain, steps[s]);
            assert_reads(&packed, &plain, steps[s]);
            assert_reads(&members, &plain, steps[s]);
        }
        buffer_finish(&plain);
        buffer_finish(&packed);
        buffer_finish(&members);
    }
}

static void how_much_is_left_is_known(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct byte_stream stream = {0};
    fill(&plain, 2 * BYTE_STREAM_BLOCK);
    assert_ok(byte_stream_of(&stream, (const uint8_t *)plain.data, plain.size));
    assert_false(stream.is_packed);
    assert_int_equal(byte_stream_most(&stream), plain.size);
    assert_ok(byte_stream_need(&stream, 100));
    byte_stream_skip(&stream, 100);
    assert_int_equal(byte_stream_most(&stream), plain.size - 100);
    byte_stream_finish(&stream);
    struct buffer zeros = {0};
    struct buffer packed = {0};
    fill(&zeros, plain.size);
    memset(zeros.data, 0, zeros.size); /* zeros pack best: no more than the greatest possible rest */
    append_gzip(&packed, zeros.data, zeros.size);
    assert_ok(byte_stream_of(&stream, (const uint8_t *)packed.data, packed.size));
    assert_true(stream.is_packed);
    for (size_t at = 0; at < zeros.size; at += 1000) {
        assert_true(byte_stream_most(&stream) >= zeros.size - at);
        assert_ok(byte_stream_need(&stream, 1000));
        byte_stream_skip(&stream, stream.size < 1000 ? stream.size : 1000);
    }
    assert_true(byte_stream_most(&stream) < 100000); /* the checksum and the size are left */
    byte_stream_finish(&stream);
    buffer_finish(&zeros);
    buffer_finish(&packed);
    buffer_finish(&plain);
}

static void assert_fails_with(const struct buffer *stored, const struct buffer *plain, const char *words)
{
    char sum[65];
    assert_fails(read_memory(stored, plain, 1000, sum), CONUS_ERROR_DATA);
    if (!strstr(conus_message(), words)) {
        fail_msg("'%s' lacks '%s'", conus_message(), words);
    }
}

/* The last eight bytes of a member are its checksum and its size. */
static void damage_is_found(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct buffer packed = {0};
    fill(&plain, 5000);
    append_gzip(&packed, plain.data, plain.size);
    for (size_t at = packed.size - 8; at < packed.size; at++) {
        packed.data[at] ^= 1;
        assert_fails_with(&packed, &plain, "gzip: damaged near unpacked byte 5000 (incorrect ");
        packed.data[at] ^= 1;
    }
    buffer_append(&packed, "\0\0x", 3);
    assert_fails_with(&packed, &plain, "gzip: 3 bytes after the end of the packed data, allowed are zeros");
    packed.size -= 3;
    while (packed.size > 3) { /* with fewer bytes it is not gzip */
        packed.size--;
        assert_fails_with(&packed, &plain, "gzip: cut off after ");
    }
    buffer_finish(&plain);
    buffer_finish(&packed);
}

static void a_file_that_changes_is_refused(void **state)
{
    (void)state;
    for (int grows = 0; grows < 2; grows++) {
        struct buffer plain = {0};
        struct byte_stream stream = {0};
        char sum[65];
        fill(&plain, 2 * BYTE_STREAM_BLOCK);
        const char *path = write_bytes("changing", &plain);
        assert_ok(byte_stream_open(&stream, path));
        assert_ok(byte_stream_need(&stream, 1));
        FILE *file = fopen(path, grows ? "ab" : "wb");
        assert_non_null(file);
        assert_int_equal(fputc('x', file), 'x');
        assert_int_equal(fclose(file), 0);
        assert_fails(read_all(&stream, &plain, 5000, sum), CONUS_ERROR_IO);
        assert_string_equal(conus_message(), "changed while it was read");
        byte_stream_finish(&stream);
        buffer_finish(&plain);
    }
}

static void what_is_no_file_is_refused(void **state)
{
    (void)state;
    struct byte_stream stream = {0};
    assert_fails(byte_stream_open(&stream, test_scratch("absent")), CONUS_ERROR_IO);
    assert_non_null(strstr(conus_message(), "cannot open: No such file"));
    test_folder("a folder");
    assert_fails(byte_stream_open(&stream, test_in("")), CONUS_ERROR_IO);
    assert_string_equal(conus_message(), "cannot read: a regular file is needed");
    assert_null(stream.source);
    byte_stream_finish(&stream);
}

struct attempt {
    struct buffer plain, stored;
};

static conus_status attempt_read(void *data)
{
    const struct attempt *attempt = data;
    char sum[65];
    return read_memory(&attempt->stored, &attempt->plain, 1000, sum);
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct attempt attempt = {0};
    fill(&attempt.plain, 2000);
    append_gzip(&attempt.stored, attempt.plain.data, attempt.plain.size);
    test_every_allocation(attempt_read, &attempt);
    buffer_finish(&attempt.stored);
    buffer_append(&attempt.stored, attempt.plain.data, attempt.plain.size);
    test_every_allocation(attempt_read, &attempt);
    buffer_finish(&attempt.stored);
    buffer_finish(&attempt.plain);
}

TEST_GROUP(byte_stream)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_of_all_sizes),
        cmocka_unit_test(how_much_is_left_is_known),
        cmocka_unit_test(damage_is_found),
        cmocka_unit_test(a_file_that_changes_is_refused),
        cmocka_unit_test(what_is_no_file_is_refused),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests_name("byte_stream", tests, NULL, NULL);
}
