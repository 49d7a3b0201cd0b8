/* SPDX-License-Identifier: BSD-3-Clause */
/* OpenIGTLink's messages: a written message is read again in whatever pieces it arrives; a broken or hostile one is
 * counted and never makes a pose. */
#include "link/station.h"
#include "test.h"

#include <math.h>
#include <string.h>

enum { CAPACITY = 4096 };

/* The last message that a listener received. */
struct heard {
    struct igtl_poses poses;
    unsigned messages;
};

static void hear(void *user, const struct igtl_poses *poses)
{
    struct heard *heard = user;
    heard->poses = *poses;
    heard->messages++;
}

static const double turned[16] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, -20.5, 30.25, 1};

static struct igtl_reader *new_reader(void)
{
    static struct igtl_reader reader;
    memset(&reader, 0, sizeof reader);
    return &reader;
}

static size_t write_turned(uint8_t *out)
{
    size_t size = igtl_write_transform(out, CAPACITY, "Pointer", 1.5, turned);
    assert_int_equal(size, IGTL_HEADER + 48);
    return size;
}

/* ECMA-182's check value: CRC-64 of "123456789". */
static void the_checksum_is_ecma_182(void **state)
{
    (void)state;
    assert_true(igtl_crc((const uint8_t *)"123456789", 9) == UINT64_C(0x6C40DF5F0B497347));
}

static void a_transform_is_read_as_written(void **state)
{
    (void)state;
    uint8_t bytes[CAPACITY];
    struct heard heard = {0};
    size_t size = write_turned(bytes);
    assert_true(igtl_read(new_reader(), bytes, size, hear, &heard));
    assert_int_equal(heard.messages, 1);
    assert_int_equal(heard.poses.count, 1);
    assert_string_equal(heard.poses.tools[0].name, "Pointer");
    assert_false(heard.poses.tools[0].lost);
    assert_near(heard.poses.time_s, 1.5, 1e-9);
    for (int i = 0; i < 16; i++) {
        assert_near(heard.poses.tools[0].matrix[i], turned[i], 0);
    }
}

static void it_may_arrive_in_any_pieces(void **state)
{
    (void)state;
    uint8_t bytes[CAPACITY];
    size_t size = write_turned(bytes);
    size += igtl_write_string(bytes + size, CAPACITY - size, "x", 0, "text that is passed over");
    size += write_turned(bytes + size);
    for (size_t piece = 1; piece <= size; piece++) {
        struct heard heard = {0};
        struct igtl_reader *reader = new_reader();
        for (size_t at = 0; at < size; at += piece) {
            assert_true(igtl_read(reader, bytes + at, at + piece < size ? piece : size - at, hear, &heard));
        }
        assert_int_equal(heard.messages, 2);
        assert_int_equal(reader->counts.messages, 3);
        assert_int_equal(reader->counts.poses, 2);
        assert_int_equal(reader->counts.broken, 0);
    }
}

/* No prefix of a message is a pose. */
static void every_prefix_waits(void **state)
{
    (void)state;
    uint8_t bytes[CAPACITY];
    size_t size = write_turned(bytes);
    for (size_t length = 0; length < size; length++) {
        struct heard heard = {0};
        struct igtl_reader *reader = new_reader();
        assert_true(igtl_read(reader, bytes, length, hear, &heard));
        assert_int_equal(heard.messages, 0);
        assert_int_equal(reader->counts.messages, 0);
    }
}

static void put(uint8_t *bytes, size_t size, uint64_t value)
{
    for (size_t i = size; i > 0; i--) {
        bytes[i - 1] = (uint8_t)value;
        value >>= 8;
    }
}

/* A message of any type around a body; version 2 with metadata around the content. */
static size_t wrap(uint8_t *out, const char *type, uint64_t version, const uint8_t *content, size_t size)
{
    uint8_t *body = out + IGTL_HEADER;
    size_t length = size;
    memset(out, 0, IGTL_HEADER);
    put(out, 2, version);
    memcpy(out + 2, type, strlen(type));
    memcpy(out + 14, "Tool", 4);
    if (version == 2) {
        memset(body, 0, 12);
        put(body, 2, 12);
        put(body + 2, 2, 2);
        put(body + 4, 4, 3);
        memcpy(body + 12, content, size);
        memcpy(body + 12 + size, "metas", 5);
        length = 12 + size + 5;
    } else {
        memcpy(body, content, size);
    }
    put(out + 42, 8, length);
    put(out + 50, 8, igtl_crc(body, length));
    return IGTL_HEADER + length;
}

static void put_float(uint8_t *bytes, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(bytes, 4, bits);
}

static struct heard read_one(const char *type, uint64_t version, const uint8_t *content, size_t size)
{
    uint8_t bytes[CAPACITY];
    struct heard heard = {0};
    assert_true(igtl_read(new_reader(), bytes, wrap(bytes, type, version, content, size), hear, &heard));
    return heard;
}

/* A quarter turn about z, at (1, 2, 3), is the same pose in every type and both versions. */
static void all_types_say_the_same(void **state)
{
    (void)state;
    const float half = sqrtf(0.5F);
    const float columns[12] = {0, 1, 0, -1, 0, 0, 0, 0, 1, 1, 2, 3};
    const float quaternion[7] = {1, 2, 3, 0, 0, half, half};
    uint8_t tdata[70] = "Tool";
    uint8_t qtdata[50] = "Tool";
    uint8_t transform[48];
    uint8_t position[28];
    for (size_t i = 0; i < 12; i++) {
        put_float(tdata + 22 + 4 * i, columns[i]);
        put_float(transform + 4 * i, columns[i]);
    }
    for (size_t i = 0; i < 7; i++) {
        put_float(qtdata + 22 + 4 * i, quaternion[i]);
        put_float(position + 4 * i, quaternion[i]);
    }
    const struct {
        const char *type;
        const uint8_t *content;
        size_t size;
    } cases[] = {{"TDATA", tdata, 70},       {"QTDATA", qtdata, 50},     {"TRANSFORM", transform, 48},
                 {"POSITION", position, 28}, {"POSITION", position, 24}, {"QTRANS", position, 28}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (uint64_t version = 1; version <= 2; version++) {
            struct heard heard = read_one(cases[i].type, version, cases[i].content, cases[i].size);
            assert_int_equal(heard.poses.count, 1);
            assert_string_equal(heard.poses.tools[0].name, "Tool");
            const double *m = heard.poses.tools[0].matrix;
            for (size_t k = 0; k < 12; k++) {
                assert_near(m[k / 3 * 4 + k % 3], (double)columns[k], 1e-6);
            }
        }
    }
    struct heard only_position = read_one("POSITION", 1, position, 12);
    assert_near(only_position.poses.tools[0].matrix[0], 1, 0);
    assert_near(only_position.poses.tools[0].matrix[14], 3, 0);
}

static void many_tools_come_in_one_message(void **state)
{
    (void)state;
    static uint8_t bytes[IGTL_HEADER + 40 * 70];
    static uint8_t content[40 * 70];
    struct heard heard = {0};
    struct igtl_reader *reader = new_reader();
    for (size_t i = 0; i < 40; i++) {
        content[70 * i] = (uint8_t)('A' + i % 26);
        for (size_t k = 0; k < 4; k++) {
            put_float(content + 70 * i + 22 + 4 * (4 * k % 12), 1);
        }
        put_float(content + 70 * i + 22 + 36, (float)i);
    }
    assert_true(igtl_read(reader, bytes, wrap(bytes, "TDATA", 1, content, sizeof content), hear, &heard));
    assert_int_equal(heard.poses.count, IGTL_TOOLS);
    assert_int_equal(reader->counts.refused, 40 - IGTL_TOOLS);
    assert_near(heard.poses.tools[31].matrix[12], 31, 0);
}

static void an_identity_is_a_lost_tool(void **state)
{
    (void)state;
    const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    uint8_t bytes[CAPACITY];
    struct heard heard = {0};
    size_t size = igtl_write_transform(bytes, CAPACITY, "Pointer", 0, identity);
    assert_true(igtl_read(new_reader(), bytes, size, hear, &heard));
    assert_true(heard.poses.tools[0].lost);
}

static void what_is_no_pose_is_counted(void **state)
{
    (void)state;
    const double mirrored[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const double scaled[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1};
    double nan_place[16];
    double nan_turn[16];
    memcpy(nan_place, turned, sizeof turned);
    memcpy(nan_turn, turned, sizeof turned);
    nan_place[13] = NAN;
    nan_turn[1] = NAN;
    const double *const bad[] = {mirrored, scaled, nan_place, nan_turn};
    for (size_t i = 0; i < 4; i++) {
        uint8_t bytes[CAPACITY];
        struct heard heard = {0};
        struct igtl_reader *reader = new_reader();
        size_t size = igtl_write_transform(bytes, CAPACITY, "Pointer", 0, bad[i]);
        assert_true(igtl_read(reader, bytes, size, hear, &heard));
        assert_int_equal(heard.messages, 0);
        assert_int_equal(reader->counts.refused, 1);
        assert_int_equal(reader->counts.mirrored, bad[i] == mirrored);
    }
    uint8_t quaternion[28] = {0};
    put_float(quaternion + 24, 0.5F); /* w alone, half as long as it should be */
    assert_int_equal(read_one("POSITION", 1, quaternion, 28).messages, 0);
}

static void broken_messages_are_counted_and_passed(void **state)
{
    (void)state;
    uint8_t bytes[CAPACITY];
    struct heard heard = {0};
    struct igtl_reader *reader = new_reader();
    size_t size = write_turned(bytes);
    bytes[IGTL_HEADER + 3] ^= 1; /* the checksum is another now */
    size += write_turned(bytes + size);
    assert_true(igtl_read(reader, bytes, size, hear, &heard));
    assert_int_equal(heard.messages, 1);
    assert_int_equal(reader->counts.broken, 1);
    assert_int_equal(reader->valid, 1); /* one of the two messages was valid */
    assert_int_equal(read_one("TRANSFORM", 1, bytes, 47).messages, 0);
    assert_int_equal(read_one("TRANSFORM", 1, bytes, 0).messages, 0);
    assert_int_equal(read_one("QTDATA", 1, bytes, 51).messages, 0);
    assert_int_equal(read_one("POSITION", 2, bytes, 152).messages, 0); /* pyigtl sends such messages */
}

static void hostile_headers_end_the_connection(void **state)
{
    (void)state;
    static const uint64_t sizes[] = {UINT64_MAX, UINT64_MAX - IGTL_HEADER, INT64_MAX, UINT64_C(1) << 32,
                                     (uint64_t)IGTL_SKIP_LIMIT + 1};
    uint8_t bytes[CAPACITY];
    struct heard heard = {0};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        size_t size = write_turned(bytes);
        put(bytes + 42, 8, sizes[i]);
        assert_false(igtl_read(new_reader(), bytes, size, hear, &heard));
    }
    static const uint64_t versions[] = {0, 3, 0x4854 /* "HT", of HTTP */, 0xffff};
    for (size_t i = 0; i < sizeof versions / sizeof versions[0]; i++) {
        size_t size = write_turned(bytes);
        put(bytes, 2, versions[i]);
        assert_false(igtl_read(new_reader(), bytes, size, hear, &heard));
    }
    assert_int_equal(heard.messages, 0);
}

static void extended_headers_must_fit(void **state)
{
    (void)state;
    static const struct {
        size_t at, bytes;
        uint64_t value;
    } lies[] = {{0, 2, 0}, {0, 2, 11}, {0, 2, 0xffff}, {2, 2, 0xffff}, {4, 4, 0xffffffff}, {4, 4, 1000}};
    for (size_t i = 0; i < sizeof lies / sizeof lies[0]; i++) {
        uint8_t bytes[CAPACITY];
        uint8_t content[48] = {0};
        struct heard heard = {0};
        struct igtl_reader *reader = new_reader();
        size_t size = wrap(bytes, "TRANSFORM", 2, content, sizeof content);
        put(bytes + IGTL_HEADER + lies[i].at, lies[i].bytes, lies[i].value);
        put(bytes + 50, 8, igtl_crc(bytes + IGTL_HEADER, size - IGTL_HEADER));
        assert_true(igtl_read(reader, bytes, size, hear, &heard));
        assert_int_equal(reader->counts.broken, 1);
    }
}

/* An image of 10 MB is skipped, and the pose after it is found. */
static void big_messages_of_other_kinds_are_passed_over(void **state)
{
    (void)state;
    static uint8_t zeros[1 << 16];
    uint8_t bytes[CAPACITY];
    struct heard heard = {0};
    struct igtl_reader *reader = new_reader();
    memset(bytes, 0, IGTL_HEADER);
    put(bytes, 2, 1);
    memcpy(bytes + 2, "IMAGE", 5);
    put(bytes + 42, 8, 160 * sizeof zeros);
    assert_true(igtl_read(reader, bytes, IGTL_HEADER, hear, &heard));
    for (int i = 0; i < 160; i++) {
        assert_true(igtl_read(reader, zeros, sizeof zeros, hear, &heard));
    }
    size_t size = write_turned(bytes);
    assert_true(igtl_read(reader, bytes, size, hear, &heard));
    assert_int_equal(heard.messages, 1);
}

static void what_does_not_fit_is_not_written(void **state)
{
    (void)state;
    uint8_t bytes[CAPACITY];
    const struct igtl_point point = {.name = "Insula_L", .rgb = {1, 2, 3}, .position = {4, 5, 6}};
    assert_int_equal(igtl_write_string(bytes, IGTL_HEADER + 4 + 2, "x", 0, "abc"), 0);
    assert_int_equal(igtl_write_string(bytes, IGTL_HEADER + 4 + 3, "x", 0, "abc"), IGTL_HEADER + 7);
    assert_int_equal(igtl_write_points(bytes, IGTL_HEADER + 135, "x", 0, &point, 1), 0);
    assert_int_equal(igtl_write_points(bytes, IGTL_HEADER + 136, "x", 0, &point, 1), IGTL_HEADER + 136);
    assert_int_equal(igtl_write_points(bytes, 10, "x", 0, &point, 0), 0);
    assert_int_equal(igtl_write_transform(bytes, 100, "x", 0, turned), 0);
    assert_int_equal(igtl_write_start(bytes, 90, "STT_TDATA", 20), 0);
}

TEST_GROUP(igtl)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_checksum_is_ecma_182),
        cmocka_unit_test(a_transform_is_read_as_written),
        cmocka_unit_test(it_may_arrive_in_any_pieces),
        cmocka_unit_test(every_prefix_waits),
        cmocka_unit_test(all_types_say_the_same),
        cmocka_unit_test(many_tools_come_in_one_message),
        cmocka_unit_test(an_identity_is_a_lost_tool),
        cmocka_unit_test(what_is_no_pose_is_counted),
        cmocka_unit_test(broken_messages_are_counted_and_passed),
        cmocka_unit_test(hostile_headers_end_the_connection),
        cmocka_unit_test(extended_headers_must_fit),
        cmocka_unit_test(big_messages_of_other_kinds_are_passed_over),
        cmocka_unit_test(what_does_not_fit_is_not_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
