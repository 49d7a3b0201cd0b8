/* SPDX-License-Identifier: BSD-3-Clause */
/* MRtrix's tractograms: rounding, blocks, files that are mapped; and detecting a file's format. */
#include "base/files/file.h"
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "loaders/tracts/tracts.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>

#define PLAIN "mrtrix tracks\ndatatype: Float32LE\nfile: . 100\ncount: 3\nEND\n"

static void append_number(struct buffer *bytes, double value, bool wide, bool big)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    if (wide) {
        append_ordered(bytes, bits, 8, big);
    } else {
        append_float(bytes, value, big);
    }
}

static void append_triples(struct buffer *bytes, const double *values, size_t count, bool wide, bool big)
{
    for (size_t i = 0; i < 3 * count; i++) {
        append_number(bytes, values[i], wide, big);
    }
}

/* A header, filled up with zeros to byte 100. */
static void begin(struct buffer *bytes, const char *header)
{
    static const uint8_t zeros[100];
    buffer_clear(bytes);
    buffer_text(bytes, header);
    if (bytes->size < sizeof zeros) {
        buffer_append(bytes, zeros, sizeof zeros - bytes->size);
    }
}

/* Streamlines of 2, 0 and 1 points, and the end: 7 triples. */
static const double three[7][3] = {{1, 2, 3},
                                   {4, 5, 6.5},
                                   {NAN, NAN, NAN},
                                   {NAN, NAN, NAN},
                                   {-7, 8, 0.25},
                                   {NAN, NAN, NAN},
                                   {INFINITY, INFINITY, INFINITY}};

static void begin_three(struct buffer *bytes, const char *header)
{
    begin(bytes, header);
    append_triples(bytes, three[0], 7, false, false);
}

static void assert_three(const struct tractogram *out)
{
    static const uint64_t first[4] = {0, 2, 2, 3};
    static const size_t places[3] = {0, 1, 4};
    assert_int_equal(out->streamline_count, 3);
    assert_int_equal(out->point_count, 3);
    assert_memory_equal(out->first, first, sizeof first);
    for (size_t i = 0; i < 9; i++) {
        assert_true((double)out->points[i] == three[places[i / 3]][i % 3]);
    }
    assert_int_equal(out->scalar_count, 0);
    assert_int_equal(out->group_count, 0);
}

static void assert_refused(const struct buffer *bytes, const char *words)
{
    struct tractogram out = {0};
    struct notes notes = {0};
    assert_fails(tract_parse(&out, bytes, 0, &notes), CONUS_ERROR_DATA);
    if (!strstr(conus_message(), words)) {
        fail_msg("'%s' lacks '%s'", conus_message(), words);
    }
    assert_null(out.points);
    notes_finish(&notes);
}

/* 1 + 2^-24 lies in the middle between the floats 1 and 1 + 2^-23, and is rounded to the even one, which is 1; 1 +
 * 2^-24 + 2^-52 is rounded up. */
static void doubles_are_rounded_once(void **state)
{
    (void)state;
    const double values[3][3] = {
        {1 + 0x1p-24, 1 + 0x1p-24 + 0x1p-52, 0.1}, {NAN, NAN, NAN}, {INFINITY, INFINITY, INFINITY}};
    struct buffer bytes = {0};
    struct tractogram out = {0};
    struct notes notes = {0};
    begin(&bytes, "mrtrix tracks\nfile: . 100\ndatatype: Float64LE\nEND\n");
    append_triples(&bytes, values[0], 3, true, false);
    assert_ok(tract_parse(&out, &bytes, 0, &notes));
    assert_true(out.points[0] == 1.0F && out.points[1] == 1 + 0x1p-23F && out.points[2] == 0.1F);
    tractogram_finish(&out);
    notes_finish(&notes);
    buffer_finish(&bytes);
}

static void what_is_no_tractogram_is_said(void **state)
{
    (void)state;
    struct tractogram out = {0};
    struct notes notes = {0};
    struct buffer bytes = {0};
    buffer_text(&bytes, "solid thing\n");
    const char *path = write_bytes("surface.tck", &bytes);
    assert_false(tract_file_is(path));
    assert_fails(tract_read(&out, path, 0, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "surface.tck: this is an STL surface"));
    assert_non_null(
        strstr(conus_message(), "needed is a tractogram: TrackVis, MRtrix, DSI Studio, TRX or polylines of VTK"));
    assert_false(tract_file_is(test_scratch("none.tck")) || conus_path_is_tractogram(test_scratch("none.tck")));
    assert_false(conus_path_is_tractogram(NULL));
    assert_fails(tract_read(&out, test_scratch("none.tck"), 0, &notes), CONUS_ERROR_IO);
    test_folder("folder.tck");
    assert_false(tract_file_is(test_in("")));
    assert_fails(tract_read(&out, test_in(""), 0, &notes), CONUS_ERROR_IO);
    assert_non_null(strstr(conus_message(), "is a folder"));
    buffer_clear(&bytes);
    buffer_append(&bytes, "mrtrix tracks\0", 14);
    assert_refused(&bytes, "needed is a tractogram");
    buffer_finish(&bytes);
    notes_finish(&notes);
}

/* 200,000 points in streamlines of 1 to 7: three blocks of 1 MiB. */
static void more_than_a_block(void **state)
{
    (void)state;
    enum { COUNT = 200000 };
    struct buffer bytes = {0};
    size_t ends = 0;
    begin(&bytes, "mrtrix tracks\ndatatype: Float32BE\nfile: . 100\nEND\n");
    for (size_t i = 0, left = 1; i < COUNT; i++) {
        append_triples(&bytes, (const double[]){(double)i, -(double)i, 0.5}, 1, false, true);
        if (--left == 0 || i == COUNT - 1) {
            append_triples(&bytes, three[2], 1, false, true);
            left = ++ends % 7 + 1;
        }
    }
    append_triples(&bytes, three[6], 1, false, true);
    for (int packed = 0; packed < 2; packed++) {
        struct tractogram out = {0};
        struct notes notes = {0};
        const char *path = (packed ? write_packed : write_bytes)("long.tck", &bytes);
        assert_ok(tract_read(&out, path, 0, &notes));
        assert_int_equal(out.point_count, COUNT);
        assert_int_equal(out.streamline_count, ends);
        for (size_t i = 0; i < COUNT; i++) {
            assert_true(out.points[3 * i] == (float)i && out.points[3 * i + 1] == -(float)i);
        }
        for (size_t k = 0; k + 1 < ends; k++) {
            assert_int_equal(out.first[k + 1] - out.first[k], k % 7 + 1);
        }
        tractogram_finish(&out);
        assert_fails(tract_read(&out, path, 12 * COUNT, &notes), CONUS_ERROR_MEMORY);
        assert_non_null(strstr(conus_message(), "that are allowed (--max-memory)"));
        notes_finish(&notes);
    }
    buffer_finish(&bytes);
}

static void every_type_gives_the_same_points(void **state)
{
    (void)state;
    static const char *const types[] = {"Float32LE", "Float32BE", "Float64LE", "Float64BE"};
    for (size_t i = 0; i < 8; i++) {
        struct tractogram out = {0};
        struct notes notes = {0};
        struct buffer bytes = {0};
        char words[64];
        snprintf(words, sizeof words, "mrtrix tracks\nfile: . 100\ndatatype: %s\nEND\n", types[i / 2]);
        begin(&bytes, words);
        append_triples(&bytes, three[0], 7, i / 2 > 1, i / 2 & 1);
        const char *path = (i & 1 ? write_packed : write_bytes)("type.tck", &bytes);
        assert_ok(tract_read(&out, path, 0, &notes));
        assert_three(&out);
        tractogram_finish(&out);
        notes_finish(&notes);
        buffer_finish(&bytes);
    }
}

static conus_status parse_and_finish(void *bytes)
{
    struct tractogram out = {0};
    struct notes notes = {0};
    conus_status status = tract_parse(&out, bytes, 0, &notes);
    tractogram_finish(&out);
    notes_finish(&notes);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer plain = {0};
    struct buffer packed = {0};
    begin_three(&plain, PLAIN);
    append_gzip(&packed, plain.data, plain.size);
    test_every_allocation(parse_and_finish, &plain);
    test_every_allocation(parse_and_finish, &packed);
    buffer_finish(&packed);
    buffer_finish(&plain);
}

TEST_GROUP(tck)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(doubles_are_rounded_once), cmocka_unit_test(what_is_no_tractogram_is_said),
        cmocka_unit_test(more_than_a_block),        cmocka_unit_test(every_type_gives_the_same_points),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests_name("tck", tests, NULL, NULL);
}
