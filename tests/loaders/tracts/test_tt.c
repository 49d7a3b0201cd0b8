/* SPDX-License-Identifier: BSD-3-Clause */
/* DSI Studio's tractograms: two streamlines in voxels, and a long one. tests/corpus/tract/ has wrong ones. */
#include "builders/nifti_builder.h"
#include "loaders/tracts/tracts.h"
#include "test.h"
#include "tract_scene.h"

#include <stdio.h>
#include <string.h>

/* A header of five numbers, then the name and a NUL. */
static void begin_variable(struct buffer *out, const char *name, uint32_t type, uint32_t rows, uint32_t columns)
{
    append_ordered(out, type, 4, false);
    append_ordered(out, rows, 4, false);
    append_ordered(out, columns, 4, false);
    append_ordered(out, 0, 4, false);
    append_ordered(out, strlen(name) + 1, 4, false);
    buffer_append(out, name, strlen(name) + 1);
}

static void append_dimension(struct buffer *out)
{
    begin_variable(out, "dimension", 20, 1, 3);
    for (uint64_t i = 0; i < 3; i++) {
        append_ordered(out, 100, 4, false);
    }
}

/* x' = -2 x + 90, y' = -2 y + 126, z' = 2 z - 72: voxels of 2 mm along L, P and S. */
static const double affine[16] = {-2, 0, 0, 90, 0, -2, 0, 126, 0, 0, 2, -72, 0, 0, 0, 1};

static void append_affine(struct buffer *out, const double *values, bool wide)
{
    begin_variable(out, "trans_to_mni", wide ? 0 : 10, 4, 4);
    for (size_t i = 0; i < 16; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        if (wide) {
            append_ordered(out, bits, 8, false);
        } else {
            append_float(out, values[i], false);
        }
    }
}

static void append_clusters(struct buffer *out, const int *values, size_t count)
{
    begin_variable(out, "cluster", 40, 1, (uint32_t)count);
    for (size_t i = 0; i < count; i++) {
        append_ordered(out, (uint64_t)values[i], 2, false);
    }
}

static void append_streamline(struct buffer *out, uint32_t coordinates, const int *start, const int *steps,
                              size_t count)
{
    append_ordered(out, coordinates, 4, false);
    for (size_t a = 0; a < 3; a++) {
        append_ordered(out, (uint64_t)(int64_t)start[a], 4, false);
    }
    for (size_t i = 0; i < count; i++) {
        append_ordered(out, (uint64_t)(int64_t)steps[i], 1, false);
    }
}

/* Voxels (1, 2, 3), (1.5, 2, -0.96875) and (1.5, 5.96875, -0.96875): steps of 16 and 0, of -127, of 127. */
static const int start[3] = {32, 64, 96};
static const int steps[6] = {16, 0, -127, 0, 127, 0};
static const int alone[3] = {-32, 0, 3200000};

enum { FIRST_BYTES = 16 + 6, SECOND_BYTES = 16 };

static void append_tracks(struct buffer *out)
{
    begin_variable(out, "track", 50, FIRST_BYTES + SECOND_BYTES, 1);
    append_streamline(out, 9, start, steps, 6);
    append_streamline(out, 3, alone, NULL, 0);
}

static void build(struct buffer *out)
{
    static const int clusters[2] = {7, 300};
    append_dimension(out);
    append_affine(out, affine, false);
    begin_variable(out, "report", 50, 1, 5);
    buffer_text(out, "words");
    append_clusters(out, clusters, 2);
    append_tracks(out);
}

/* Asserts the points that follow from the affine above by hand. */
static void assert_points(const struct tractogram *t)
{
    static const float points[12] = {88, 122, -66, 87, 122, -73.9375F, 87, 114.0625F, -73.9375F, 92, 126, 199928};
    assert_int_equal(t->streamline_count, 2);
    assert_int_equal(t->point_count, 4);
    assert_int_equal(t->first[1], 3);
    for (size_t i = 0; i < 12; i++) {
        assert_near(t->points[i], points[i], 0);
    }
}

static void two_streamlines(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct buffer packed = {0};
    struct tractogram t;
    struct notes notes = {0};
    build(&bytes);
    append_gzip(&packed, bytes.data, bytes.size);
    for (int is_packed = 0; is_packed < 2; is_packed++) {
        assert_ok(tract_parse(&t, is_packed ? &packed : &bytes, 0, &notes));
        assert_points(&t);
        assert_string_equal(t.format, is_packed ? "DSI Studio, gzip" : "DSI Studio");
        assert_int_equal(t.scalar_count, 1);
        assert_string_equal(t.scalars[0].name, "cluster");
        assert_false(t.scalars[0].per_point);
        assert_near(t.scalars[0].values[0], 7, 0);
        assert_near(t.scalars[0].values[1], 300, 0);
        assert_non_null(strstr(notes.lines[0], "trans_to_mni was used"));
        tractogram_finish(&t);
        notes_finish(&notes);
        notes = (struct notes){0};
    }
    buffer_finish(&bytes);
    buffer_finish(&packed);
}

/* More steps than fit into the buffer: n of (1, 0, -1), so that the last point is n / 32 voxels away. */
static void a_long_streamline(void **state)
{
    (void)state;
    enum { POINTS = 500001 };
    static const int far_start[3] = {0, 0, 0};
    static const signed char step[3] = {1, 0, -1};
    struct buffer bytes = {0};
    struct tractogram t;
    struct notes notes = {0};
    append_dimension(&bytes);
    append_affine(&bytes, affine, false);
    begin_variable(&bytes, "track", 50, 16 + 3 * (POINTS - 1), 1);
    append_streamline(&bytes, 3 * POINTS, far_start, NULL, 0);
    for (int i = 1; i < POINTS; i++) {
        buffer_append(&bytes, step, sizeof step);
    }
    assert_ok(tract_parse(&t, &bytes, 0, &notes));
    assert_int_equal(t.point_count, POINTS);
    assert_near(t.points[3 * (POINTS - 1)], 90 - 2 * 15625, 0);
    assert_near(t.points[3 * (POINTS - 1) + 2], -72 - 2 * 15625, 0);
    tractogram_finish(&t);
    assert_fails(tract_parse(&t, &bytes, 1000000, &notes), CONUS_ERROR_MEMORY);
    notes_finish(&notes);
    buffer_finish(&bytes);
}

static conus_status attempt(void *data)
{
    struct tractogram t = {0};
    struct notes notes = {0};
    conus_status status = tract_read(&t, data, 0, &notes);
    tractogram_finish(&t);
    notes_finish(&notes);
    return status;
}

static void every_allocation(void **state)
{
    (void)state;
    char path[4096];
    struct buffer bytes = {0};
    build(&bytes);
    snprintf(path, sizeof path, "%s", test_scratch("a.tt"));
    assert_ok(file_write(path, bytes.data, bytes.size));
    test_every_allocation(attempt, path);
    buffer_finish(&bytes);
}

TEST_GROUP(tt)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_streamlines),
        cmocka_unit_test(a_long_streamline),
        cmocka_unit_test(every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
