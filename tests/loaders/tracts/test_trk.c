/* SPDX-License-Identifier: BSD-3-Clause */
/* TrackVis files: scalars by name, and blocks. tests/corpus/tract/ has positions and headers that contradict
 * themselves. */
#include "builders/nifti_builder.h"
#include "builders/trk_builder.h"
#include "loaders/tracts/tracts.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static conus_status parse_with(struct tractogram *out, const struct trk_builder *trk, struct notes *notes)
{
    return tract_parse(out, &trk->bytes, 0, notes);
}

static void assert_parses(struct tractogram *out, const struct trk_builder *trk, size_t notes_wanted)
{
    struct notes notes = {0};
    assert_ok(parse_with(out, trk, &notes));
    assert_int_equal(notes.count, notes_wanted);
    notes_finish(&notes);
}

static void append_streamline(struct trk_builder *trk, const double *values, size_t points, size_t floats)
{
    trk_append_i32(trk, (int64_t)points);
    trk_append_floats(trk, values, floats);
}

static void assert_point(const struct tractogram *tractogram, uint64_t index, const double wanted[3])
{
    for (uint64_t a = 0; a < 3; a++) {
        assert_near(tractogram->points[3 * index + a], wanted[a], 1e-5);
    }
}

/* Two streamlines, of 2 points and of none, with 4 numbers per point and 5 per streamline. */
static void begin_scalars(struct trk_builder *trk)
{
    trk_begin(trk);
    trk_put_i16(trk, TRK_N_SCALARS, 4);
    trk_put_text(trk, TRK_SCALAR_NAME, "colours\0003", 9);
    trk_put_text(trk, TRK_SCALAR_NAME + 40, "fa", 2); /* the second name is empty */
    trk_put_i16(trk, TRK_N_PROPERTIES, 5);
    trk_put_text(trk, TRK_PROPERTY_NAME, "twenty bytes of text", 20);
    append_streamline(trk, (const double[]){.5, .5, .5, 1, 2, 3, .25, .5, .5, 1.5, 4, 5, 6, NAN}, 2, 14);
    trk_append_floats(trk, (const double[]){10, 11, 12, 13, 14}, 5);
    append_streamline(trk, NULL, 0, 0);
    trk_append_floats(trk, (const double[]){20, 21, 22, 23, 24}, 5);
    trk_put_i32(trk, TRK_N_COUNT, 2);
}

static void assert_scalar(const struct tract_scalar *scalar, const char *name, bool per_point, uint32_t components)
{
    assert_string_equal(scalar->name, name);
    assert_int_equal(scalar->per_point, per_point);
    assert_int_equal(scalar->components, components);
}

static void scalars_are_kept_by_name(void **state)
{
    (void)state;
    for (int big = 0; big < 2; big++) {
        struct trk_builder trk = {.big = big};
        struct tractogram out = {0};
        begin_scalars(&trk);
        assert_parses(&out, &trk, 1);
        assert_int_equal(out.scalar_count, 4);
        assert_scalar(&out.scalars[0], "colours", true, 3);
        assert_scalar(&out.scalars[1], "fa", true, 1);
        assert_scalar(&out.scalars[2], "twenty bytes of text", false, 1);
        assert_scalar(&out.scalars[3], "properties", false, 4);
        for (int i = 0; i < 6; i++) {
            assert_near(out.scalars[0].values[i], i + 1, 0);
        }
        assert_near(out.scalars[1].values[0], 0.25, 0);
        assert_true(isnan(out.scalars[1].values[1]));
        for (size_t k = 0; k < 2; k++) {
            assert_near(out.scalars[2].values[k], 10 * (double)(k + 1), 0);
            for (size_t c = 0; c < 4; c++) {
                assert_near(out.scalars[3].values[4 * k + c], 10 * (double)(k + 1) + 1 + (double)c, 0);
            }
        }
        assert_int_equal(out.first[1], 2);
        assert_int_equal(out.first[2], 2);
        assert_point(&out, 1, (const double[]){0, 0, 1});
        tractogram_finish(&out);
        buffer_finish(&trk.bytes);
    }
}

/* As many numbers as the header can state. */
static void as_many_numbers_as_a_header_has(void **state)
{
    (void)state;
    enum { MOST = 32767 };
    struct trk_builder trk = {0};
    struct tractogram out = {0};
    trk_begin(&trk);
    trk_put_i16(&trk, TRK_N_SCALARS, MOST);
    trk_put_i16(&trk, TRK_N_PROPERTIES, MOST);
    trk_append_i32(&trk, 9);
    for (int i = 0; i < 9 * (3 + MOST) + MOST; i++) { /* 9 points are more than a block */
        trk_append_floats(&trk, (const double[]){i}, 1);
    }
    assert_parses(&out, &trk, 1);
    assert_int_equal(out.scalars[0].components, MOST);
    assert_near(out.scalars[0].values[9 * MOST - 1], 9 * (3 + MOST) - 1, 0);
    assert_near(out.scalars[1].values[MOST - 1], 9 * (3 + MOST) + MOST - 1, 0);
    assert_near(out.points[3 * 8], 8 * (3 + MOST) - 0.5, 0);
    tractogram_finish(&out);
    buffer_finish(&trk.bytes);
}

/* 70,000 points of 20 bytes are more than a block, and a block does not hold a whole number of points. */
static void a_streamline_longer_than_a_block(void **state)
{
    (void)state;
    enum { COUNT = 70000 };
    struct trk_builder trk = {.big = true};
    trk_begin(&trk);
    trk_put_i16(&trk, TRK_N_SCALARS, 2);
    for (size_t k = 0; k < 2; k++) {
        trk_append_i32(&trk, COUNT);
        for (size_t i = 0; i < COUNT; i++) {
            trk_append_floats(&trk, (const double[]){(double)i, (double)k, 0.5, (double)i + 0.25, -(double)i}, 5);
        }
    }
    for (int packed = 0; packed < 2; packed++) {
        struct tractogram out = {0};
        struct notes notes = {0};
        const char *path = (packed ? write_packed : write_bytes)("long.trk", &trk.bytes);
        assert_true(tract_file_is(path));
        assert_ok(tract_read(&out, path, 0, &notes));
        assert_string_equal(out.path, path);
        assert_string_equal(out.format, packed ? "TrackVis 2, gzip, big-endian" : "TrackVis 2, big-endian");
        assert_int_equal(out.point_count, 2 * COUNT);
        for (size_t i = 0; i < 2 * (size_t)COUNT; i++) {
            assert_true(out.points[3 * i] == (float)(i % COUNT) - 0.5F && out.points[3 * i + 2] == 0.0F);
            assert_true(out.scalars[0].values[2 * i] == (float)(i % COUNT) + 0.25F);
            assert_true(out.scalars[0].values[2 * i + 1] == -(float)(i % COUNT));
        }
        tractogram_finish(&out);
        assert_fails(tract_read(&out, path, 2 * COUNT * 20, &notes), CONUS_ERROR_MEMORY);
        assert_non_null(strstr(conus_message(), "take more than the 2800000 bytes that are allowed (--max-memory)"));
        assert_ok(tract_read(&out, path, 2 * COUNT * 20 + 70 * 8, &notes)); /* and room for streamlines */
        tractogram_finish(&out);
        notes_finish(&notes);
    }
    buffer_finish(&trk.bytes);
}

static conus_status read_and_finish(void *path)
{
    struct tractogram out = {0};
    struct notes notes = {0};
    conus_status status = tract_read(&out, path, 0, &notes);
    tractogram_finish(&out);
    notes_finish(&notes);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct trk_builder trk = {0};
    char path[300];
    begin_scalars(&trk);
    trk_put_i32(&trk, TRK_N_COUNT, 0);
    snprintf(path, sizeof path, "%s", write_bytes("a.trk", &trk.bytes));
    test_every_allocation(read_and_finish, path);
    snprintf(path, sizeof path, "%s", write_packed("a.trk.gz", &trk.bytes));
    test_every_allocation(read_and_finish, path);
    buffer_finish(&trk.bytes);
}

TEST_GROUP(trk)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scalars_are_kept_by_name),
        cmocka_unit_test(as_many_numbers_as_a_header_has),
        cmocka_unit_test(a_streamline_longer_than_a_block),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests_name("trk", tests, NULL, NULL);
}
