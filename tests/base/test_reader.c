/* SPDX-License-Identifier: BSD-3-Clause */
/* The reader: numbers of both orders, lines and words over the ends of blocks, gzip of several members, every prefix,
 * and each primitive failing. */
#include "base/job/job.h"

#include "base/memory.h"
#include "sources/source.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

static void numbers_come_in_either_order(void **state)
{
    (void)state;
    /* 1; 0x0102; 0x01020304; 1.5 as IEEE 754 in 64 bits, in 32 (0x3fc00000): by hand, the highest byte first. */
    static const char bytes[] = "\x01\x01\x02\x01\x02\x03\x04\x3f\xf8\0\0\0\0\0\0\x3f\xc0\0\0";
    struct job job = {0};
    struct reader r = reader_of(&job, (struct text){bytes, sizeof bytes - 1});
    r.swapped = BIG_ENDIAN_IS_SWAPPED;
    assert_int_equal(*reader_take(&r, 1), 1);
    assert_int_equal(reader_u16(&r), 0x0102);
    assert_int_equal(reader_u32(&r), 0x01020304);
    assert_near(reader_f64(&r), 1.5, 0);
    assert_near(reader_f32(&r), 1.5, 0);
    assert_int_equal(reader_at(&r), sizeof bytes - 1);
    assert_int_equal(reader_u16(&r), 0);
    assert_int_equal(reader_at(&r), sizeof bytes - 1);
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "cut off at byte 19, where 2 more are needed");
}

static void lines_end_as_they_do_elsewhere(void **state)
{
    (void)state;
    static const char *const wanted[] = {"a b", "", "c\rd", "e"};
    struct job job = {0};
    struct reader r = reader_of(&job, text_from("a b\n\r\nc\rd\r\ne"));
    struct text line;
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        assert_true(reader_line(&r, &line));
        assert_true(text_equal(line, wanted[i]));
    }
    assert_false(reader_line(&r, &line));
    assert_int_equal(line.size, 0);
    job_end(&job);
}

/* Appends `size` bytes as a member of gzip. */
static void append_packed(struct buffer *out, const char *data, size_t size)
{
    uint8_t packed[4096];
    z_stream z = {
        .next_in = (z_const Bytef *)data, .avail_in = (uInt)size, .next_out = packed, .avail_out = sizeof packed};
    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    buffer_append(out, packed, sizeof packed - z.avail_out);
    assert_int_equal(deflateEnd(&z), Z_OK);
}

/* 500 words of 1 to 9 letters, each on a line, so that words and lines lie over the ends of blocks of 64 bytes. */
static void append_words(struct buffer *out)
{
    for (size_t i = 0; i < 500; i++) {
        buffer_append(out, "abcdefghi", 1 + i % 9);
        buffer_append(out, "\n", 1);
    }
}

static const char *write_scratch(const char *name, const struct buffer *content)
{
    const char *path = test_scratch(name);
    assert_ok(file_write(path, content->data, content->size));
    return path;
}

static void check_words(const char *path)
{
    struct job job = {0};
    struct reader r = source_reader(&job, source_open(&job, path));
    struct text text;
    for (size_t i = 0; i < 500; i++) {
        assert_true(i % 2 ? reader_line(&r, &text) : reader_word(&r, &text));
        assert_int_equal(text.size, 1 + i % 9);
        assert_memory_equal(text.data, "abcdefghi", text.size);
        if (i % 2 == 0) {
            assert_int_equal(*reader_take(&r, 1), '\n');
        }
    }
    assert_false(reader_has(&r, 1));
    assert_true(job_ok(&job));
    job_end(&job);
}

static void words_and_lines_cross_blocks_and_members(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct buffer packed = {0};
    append_words(&plain);
    check_words(write_scratch("plain", &plain));
    for (size_t at = 0, size = 0; at < plain.size; at += size) { /* in members of 700 bytes */
        size = plain.size - at < 700 ? plain.size - at : 700;
        append_packed(&packed, plain.data + at, size);
    }
    check_words(write_scratch("packed", &packed));
    buffer_append(&packed, "\0\0\0\0", 4);
    check_words(write_scratch("padded", &packed));
    buffer_finish(&plain);
    buffer_finish(&packed);
}

static void assert_refused(const char *path, conus_status status, const char *message)
{
    struct job job = {0};
    struct reader r = source_reader(&job, source_open(&job, path));
    reader_skip(&r, 10);
    assert_fails(job_close(&job, NULL, NULL), status);
    assert_string_equal(conus_message(), message);
}

static void every_prefix_of_a_packed_file_is_cut_off(void **state)
{
    (void)state;
    struct buffer packed = {0};
    append_packed(&packed, "one line\n", 9);
    for (size_t size = 3; size < packed.size; size++) {
        const struct buffer prefix = {.data = packed.data, .size = size};
        assert_refused(write_scratch("cut", &prefix), CONUS_ERROR_DATA, "gzip: cut off, an intact file is needed");
    }
    buffer_append(&packed, "\0\0x", 3);
    assert_refused(write_scratch("more", &packed), CONUS_ERROR_DATA,
                   "gzip: 3 bytes after the end of the packed data, allowed are zeros");
    packed.size -= 3;
    packed.data[packed.size - 5] ^= 1; /* the sum of the bytes */
    assert_refused(write_scratch("damaged", &packed), CONUS_ERROR_DATA,
                   "gzip: damaged (incorrect data check), an intact file is needed");
    buffer_finish(&packed);
}

/* Of zeros, which pack best, there are never more left than is said. */
static void how_much_is_left_is_known(void **state)
{
    (void)state;
    enum { SIZE = 1 << 21 };
    struct buffer zeros = {0};
    struct buffer packed = {0};
    const char part[4096] = {0};
    for (size_t at = 0; at < SIZE; at += sizeof part) {
        buffer_append(&zeros, part, sizeof part);
    }
    for (int packs = 0; packs < 2; packs++) {
        struct job job = {0};
        if (packs) {
            append_packed(&packed, zeros.data, zeros.size);
        }
        struct reader r = source_reader(&job, source_open(&job, write_scratch("zeros", packs ? &packed : &zeros)));
        for (size_t at = 0; at < SIZE; at += 1024) {
            assert_true(packs ? reader_most(&r) >= SIZE - at : reader_most(&r) == SIZE - at);
            reader_skip(&r, 1024);
        }
        assert_true(reader_most(&r) < 100000);      /* the checksum and the size are left */
        assert_false(reader_has(&r, SIZE_MAX / 2)); /* no memory is taken for what cannot be there */
        assert_false(reader_has(&r, 1));
        assert_int_equal(reader_most(&r), 0);
        assert_ok(job_close(&job, NULL, NULL));
    }
    buffer_finish(&zeros);
    buffer_finish(&packed);
}

static void an_empty_file_is_cut_off(void **state)
{
    (void)state;
    struct job job = {0};
    struct reader r = source_reader(&job, source_open(&job, write_scratch("empty", &(struct buffer){0})));
    assert_null(reader_take(&r, 1));
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "cut off at byte 0, where 1 more are needed");
}

static void a_file_that_changes_is_refused(void **state)
{
    (void)state;
    struct buffer plain = {0};
    append_words(&plain);
    for (int grows = 0; grows < 2; grows++) {
        struct job job = {0};
        const char *path = write_scratch("changing", &plain);
        struct reader r = source_reader(&job, source_open(&job, path));
        FILE *file = fopen(path, grows ? "ab" : "wb");
        assert_non_null(file);
        assert_int_equal(fputc('x', file), 'x');
        assert_int_equal(fclose(file), 0);
        reader_skip(&r, plain.size);
        assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_IO);
        assert_string_equal(conus_message(), "changed while it was read");
    }
    buffer_finish(&plain);
}

static void some_come_in_whole_things(void **state)
{
    (void)state;
    struct job job = {0};
    struct reader r = reader_of(&job, text_from("abcdefgh"));
    size_t size;
    assert_memory_equal(reader_some(&r, 7, 3, &size), "abcdef", 6);
    assert_int_equal(size, 6);
    assert_null(reader_some(&r, 100, 3, &size)); /* two are left */
    assert_int_equal(size, 0);
    reader_skip(&r, 2);
    assert_true(job_ok(&job));
    reader_skip(&r, 1);
    assert_false(job_ok(&job));
    assert_null(reader_some(&r, 100, 1, &size));
    assert_int_equal(reader_at(&r), 8); /* the end, so that loops stop */
    job_end(&job);
}

static void an_open_file_outlives_its_readers_and_their_memory(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct buffer packed = {0};
    struct open_file file;
    append_words(&plain);
    append_packed(&packed, plain.data, plain.size);
    assert_ok(file_open(&file, write_scratch("open", &packed)));
    for (int i = 0; i < 2; i++) { /* each from the beginning */
        struct job job = {0};
        struct reader r = reader_on(&job, &file);
        const struct text first = reader_keep(&r, 5);
        struct job_mark mark = job_mark(&job);
        uint64_t at = first.size;
        size_t size = 1;
        assert_memory_equal(first.data, plain.data, 5);
        for (; job_ok(&job) && at < plain.size; at += size) { /* its window is not the job's */
            job_raw(&job, 100, 1);
            const uint8_t *some = reader_some(&r, 1000, 1, &size);
            assert_non_null(some);
            assert_memory_equal(some, plain.data + at, size);
            job_release(&job, mark);
        }
        assert_int_equal(at, plain.size);
        const struct text none = reader_keep(&r, 1);
        assert_int_equal(none.size, 0);
        assert_string_equal(none.data, "");
        assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    }
    file_close(&file);
    buffer_finish(&plain);
    buffer_finish(&packed);
}

/* Reads a packed file in each way. */
static conus_status read_all(void *data)
{
    struct job job = {0};
    struct reader r = source_reader(&job, source_open(&job, data));
    struct text text;
    size_t size = 1;
    (void)reader_line(&r, &text);
    (void)reader_word(&r, &text);
    (void)reader_u32(&r);
    (void)reader_keep(&r, 3);
    while (reader_some(&r, 50, 1, &size)) {
    }
    return job_close(&job, NULL, NULL);
}

static void every_failing_primitive_and_allocation(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct buffer packed = {0};
    char path[256];
    append_words(&plain);
    append_packed(&packed, plain.data, plain.size);
    snprintf(path, sizeof path, "%s", write_scratch("all", &packed));
    assert_true(test_every_primitive(read_all, path) > 10);
    test_every_allocation(read_all, path);
    buffer_finish(&plain);
    buffer_finish(&packed);
}

TEST_GROUP(reader)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_come_in_either_order),
        cmocka_unit_test(lines_end_as_they_do_elsewhere),
        cmocka_unit_test(words_and_lines_cross_blocks_and_members),
        cmocka_unit_test(every_prefix_of_a_packed_file_is_cut_off),
        cmocka_unit_test(how_much_is_left_is_known),
        cmocka_unit_test(an_empty_file_is_cut_off),
        cmocka_unit_test(a_file_that_changes_is_refused),
        cmocka_unit_test(some_come_in_whole_things),
        cmocka_unit_test(an_open_file_outlives_its_readers_and_their_memory),
        cmocka_unit_test(every_failing_primitive_and_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
