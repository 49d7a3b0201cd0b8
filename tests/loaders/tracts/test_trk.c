/* SPDX-License-Identifier: BSD-3-Clause */
/* TrackVis files: positions of points, by hand; scalars by name; headers that contradict themselves. */
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "builders/trk_builder.h"
#include "loaders/tracts/tract_file.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static conus_status parse_with(struct tractogram *out, const struct trk_builder *trk, struct notes *notes)
{
    return tract_file_parse(out, (const uint8_t *)trk->bytes.data, trk->bytes.size, 0, notes);
}

static void assert_parses(struct tractogram *out, const struct trk_builder *trk, size_t notes_wanted)
{
    struct notes notes = {0};
    assert_ok(parse_with(out, trk, &notes));
    assert_int_equal(notes.count, notes_wanted);
    notes_finish(&notes);
}

static void assert_refused(const struct trk_builder *trk, conus_status status, const char *words)
{
    struct tractogram out = {0};
    struct notes notes = {0};
    assert_fails(parse_with(&out, trk, &notes), status);
    if (!strstr(conus_message(), words)) {
        fail_msg("'%s' lacks '%s'", conus_message(), words);
    }
    assert_null(out.points);
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

/* Voxels of 2 mm, the file along LPS, vox_to_ras along RAS; the point (3, 5, 7) mm is (1.5, 2.5, 3.5) voxels from the
 * corner, so that its indices along L, P and S are (1, 2, 3). Along R and A they are 90 - 1 and 108 - 2. The matrix
 * then gives 2 (89, 106, 3) - (90, 126, 72). The corner of the grid, 0 mm, is half a voxel, 1 mm, outside voxel 0. */
static void the_example_of_the_documents(void **state)
{
    (void)state;
    for (int round = 0; round < 4; round++) {
        struct trk_builder trk = {.big = round & 1};
        struct tractogram out = {0};
        trk_begin(&trk);
        for (size_t i = 0; i < 3; i++) {
            trk_put_i16(&trk, TRK_DIM + 2 * i, i == 1 ? 109 : 91);
        }
        trk_put_space(&trk, (const double[]){2, 2, 2}, (const double[]){-90, -126, -72});
        trk_put_text(&trk, TRK_VOXEL_ORDER, round & 2 ? "LPS" : "lps", 3);
        append_streamline(&trk, (const double[]){3, 5, 7, 0, 0, 0}, 2, 6);
        trk_put_i32(&trk, TRK_N_COUNT, 1);
        struct notes notes = {0};
        assert_ok(parse_with(&out, &trk, &notes));
        assert_int_equal(notes.count, 1);
        assert_string_equal(notes.lines[0],
                            round & 2 ? "voxel_order: LPS, vox_to_ras has RAS: the axes that differ are turned round"
                                      : "voxel_order: lps, vox_to_ras has RAS: the axes that differ are turned round");
        notes_finish(&notes);
        assert_int_equal(out.streamline_count, 1);
        assert_int_equal(out.point_count, 2);
        assert_point(&out, 0, (const double[]){88, 86, -66});
        assert_point(&out, 1, (const double[]){91, 91, -73});
        assert_string_equal(out.format, round & 1 ? "TrackVis 2, big-endian" : "TrackVis 2");
        assert_near(out.radius, 0.5, 0);
        tractogram_finish(&out);
        buffer_finish(&trk.bytes);
    }
}

/* All eight directions of the file's axes. With the identity, point (1, 2, 3) has the indices (0.5, 1.5, 2.5); an axis
 * of n voxels that runs the other way gives n - 1 minus that. */
static void axes_that_run_the_other_way_are_turned(void **state)
{
    (void)state;
    for (unsigned flips = 0; flips < 8; flips++) {
        struct trk_builder trk = {0};
        struct tractogram out = {0};
        const char order[3] = {flips & 1 ? 'L' : 'R', flips & 2 ? 'P' : 'A', flips & 4 ? 'I' : 'S'};
        trk_begin(&trk);
        trk_put_text(&trk, TRK_VOXEL_ORDER, order, 3);
        append_streamline(&trk, (const double[]){1, 2, 3}, 1, 3);
        trk_put_i32(&trk, TRK_N_COUNT, 1);
        assert_parses(&out, &trk, flips ? 2 : 1); /* a streamline of one point */
        assert_point(
            &out, 0,
            (const double[]){flips & 1 ? 9 - 0.5 : 0.5, flips & 2 ? 19 - 1.5 : 1.5, flips & 4 ? 29 - 2.5 : 2.5});
        tractogram_finish(&out);
        buffer_finish(&trk.bytes);
    }
}

/* A grid turned by 30 degrees about z: i runs along (cos 30, sin 30), j along (-sin 30, cos 30); still RAS. A point 1.5
 * voxels of 2 mm along i and 0.5 along j from the corner is index (1, 0): 2 mm along i from the origin (10, 0, 0). */
static void an_oblique_grid(void **state)
{
    (void)state;
    struct trk_builder trk = {0};
    struct tractogram out = {0};
    double c = 2 * sqrt(0.75);
    trk_begin(&trk);
    trk_put_space(&trk, (const double[]){2, 2, 2}, (const double[]){10, 0, 0});
    trk_put_float(&trk, TRK_VOX_TO_RAS, c);
    trk_put_float(&trk, TRK_VOX_TO_RAS + 4, -1);
    trk_put_float(&trk, TRK_VOX_TO_RAS + 16, 1);
    trk_put_float(&trk, TRK_VOX_TO_RAS + 20, c);
    append_streamline(&trk, (const double[]){3, 1, 1, 1, 1, 1}, 2, 6);
    trk_put_i32(&trk, TRK_N_COUNT, 1);
    assert_parses(&out, &trk, 0);
    assert_point(&out, 0, (const double[]){10 + c, 1, 0});
    assert_point(&out, 1, (const double[]){10, 0, 0});
    tractogram_finish(&out);
    buffer_finish(&trk.bytes);
}

/* Without a matrix voxel indices are taken as mm, as nibabel does. That is only right for voxels of 1 mm. */
static void a_missing_matrix_and_order_are_warned_of(void **state)
{
    (void)state;
    for (int version = 1; version <= 2; version++) {
        struct trk_builder trk = {0};
        struct tractogram out = {0};
        struct notes notes = {0};
        trk_begin(&trk);
        trk_put_i32(&trk, TRK_VERSION, version);
        trk_put_float(&trk, TRK_VOX_TO_RAS + 12, 7); /* not recorded, hence not read */
        trk_put_float(&trk, TRK_VOX_TO_RAS + 60, version == 1 ? 1 : 0);
        trk_put_text(&trk, TRK_VOXEL_ORDER, "\0\0\0", 3);
        append_streamline(&trk, (const double[]){1, 2, 3, 1, 2, 3}, 2, 6);
        trk_put_i32(&trk, TRK_N_COUNT, 1);
        assert_ok(parse_with(&out, &trk, &notes));
        assert_int_equal(notes.count, 3);
        assert_non_null(strstr(notes.lines[0], "vox_to_ras: not recorded, taken as the identity"));
        assert_string_equal(notes.lines[1], "voxel_order: not stated, taken as LPS, TrackVis's own");
        assert_int_equal(notes.marks[0].severity, CONUS_SEVERITY_WARNING);
        assert_point(&out, 0, (const double[]){8.5, 17.5, 2.5}); /* LPS, the identity RAS: 9 - 0.5, 19 - 1.5 */
        assert_string_equal(out.format, version == 1 ? "TrackVis 1" : "TrackVis 2");
        tractogram_finish(&out);
        notes_finish(&notes);
        trk_put_float(&trk, TRK_VOXEL_SIZE + 4, 2);
        assert_refused(&trk, CONUS_ERROR_DATA, "vox_to_ras: not recorded, and voxel_size is 2 mm of axis 1;");
        buffer_finish(&trk.bytes);
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

static void numbers_without_names_have_names(void **state)
{
    (void)state;
    struct trk_builder trk = {0};
    struct tractogram out = {0};
    trk_begin(&trk);
    trk_put_i16(&trk, TRK_N_SCALARS, 1);
    append_streamline(&trk, (const double[]){1, 1, 1, 9, 2, 2, 2, 8}, 2, 8);
    assert_parses(&out, &trk, 1); /* n_count is not stated */
    assert_int_equal(out.scalar_count, 1);
    assert_scalar(&out.scalars[0], "scalars", true, 1);
    assert_near(out.scalars[0].values[1], 8, 0);
    tractogram_finish(&out);
    buffer_finish(&trk.bytes);
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

static void names_that_fit_no_number_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *name, *words;
    } cases[] = {
        {"colours\0005\0\0\0\0\0\0\0\0\0\0", "scalar_name: the names have more numbers than the 4 of n_scalars"},
        {"colours\0000\0\0\0\0\0\0\0\0\0\0", "scalar_name: found other bytes after \"colours\""},
        {"colours\0x\0\0\0\0\0\0\0\0\0\0", "scalar_name: found other bytes after \"colours\""},
        {"colours\0003\0x\0\0\0\0\0\0\0\0", "scalar_name: found other bytes after \"colours\""},
        {"colours\0\0x\0\0\0\0\0\0\0\0\0", "scalar_name: found other bytes after \"colours\""},
        {"fa\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", "scalars: found 'fa' twice"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct trk_builder trk = {0};
        begin_scalars(&trk);
        trk_put_text(&trk, TRK_SCALAR_NAME, cases[i].name, 18);
        assert_refused(&trk, CONUS_ERROR_DATA, cases[i].words);
        buffer_finish(&trk.bytes);
    }
}

/* Streamlines of 2, 0 and 1 points. */
static void begin_counts(struct trk_builder *trk, int64_t count)
{
    trk_begin(trk);
    append_streamline(trk, (const double[]){1, 2, 3, 4, 5, 6}, 2, 6);
    append_streamline(trk, NULL, 0, 0);
    append_streamline(trk, (const double[]){7, 8, 9}, 1, 3);
    trk_put_i32(trk, TRK_N_COUNT, count);
}

static void a_count_of_0_is_counted(void **state)
{
    (void)state;
    struct trk_builder trk = {0};
    struct tractogram out = {0};
    struct notes notes = {0};
    begin_counts(&trk, 0);
    assert_ok(parse_with(&out, &trk, &notes));
    assert_int_equal(notes.count, 2);
    assert_string_equal(notes.lines[0], "n_count: not stated, the file has 3");
    assert_int_equal(out.streamline_count, 3);
    assert_int_equal(out.first[1], 2);
    assert_int_equal(out.first[2], 2);
    assert_int_equal(out.first[3], 3);
    tractogram_finish(&out);
    notes_finish(&notes);
    buffer_finish(&trk.bytes);
}

static void counts_that_lie_are_refused(void **state)
{
    (void)state;
    struct trk_builder trk = {0};
    begin_counts(&trk, 2);
    assert_refused(&trk, CONUS_ERROR_DATA, "n_count: found 2, the file goes on after that many streamlines");
    begin_counts(&trk, 4);
    assert_refused(&trk, CONUS_ERROR_DATA,
                   "streamline 3 (from 0): the file ends within its number of points; n_count is 4");
    begin_counts(&trk, 13); /* 48 bytes are 12 counts */
    assert_refused(&trk, CONUS_ERROR_DATA, "n_count: found 13, the file has room for 12 at most");
    begin_counts(&trk, -1);
    assert_refused(&trk, CONUS_ERROR_DATA, "n_count: found -1, allowed are 0 (not stated) and more");
    for (int64_t points = -1; points <= 4; points += 5) {
        begin_counts(&trk, 3);
        trk_put_i32(&trk, 1000, points); /* 44 bytes are 3 points */
        assert_refused(&trk, CONUS_ERROR_DATA,
                       points < 0 ? "streamline 0 (from 0): found -1 points, the file has room"
                                  : "found 4 points, the file has room for 0 to 3");
    }
    begin_counts(&trk, 3);
    trk_put_i32(&trk, 1000, INT32_MAX);
    assert_refused(&trk, CONUS_ERROR_DATA, "found 2147483647 points, the file has room for 0 to 3");
    buffer_finish(&trk.bytes);
}

static void headers_that_contradict_themselves_are_refused(void **state)
{
    (void)state;
    static const struct {
        size_t offset;
        enum { I16, I32, FLOAT, TEXT } type;
        double value;
        const char *text;
        conus_status status;
        const char *words;
    } cases[] = {
        {TRK_HDR_SIZE, I32, 999, NULL, CONUS_ERROR_DATA, "hdr_size: found 999, needed is 1000 in either byte order"},
        {TRK_VERSION, I32, 0, NULL, CONUS_ERROR_UNSUPPORTED, "version: found 0, allowed are 1 and 2"},
        {TRK_VERSION, I32, 3, NULL, CONUS_ERROR_UNSUPPORTED, "version: found 3"},
        {TRK_N_SCALARS, I16, -1, NULL, CONUS_ERROR_DATA, "n_scalars: found -1"},
        {TRK_N_PROPERTIES, I16, -32768, NULL, CONUS_ERROR_DATA, "n_properties: found -32768"},
        {TRK_VOXEL_SIZE + 8, FLOAT, 0, NULL, CONUS_ERROR_DATA, "voxel_size: found 0 of axis 2, allowed is above 0 mm"},
        {TRK_VOXEL_SIZE, FLOAT, -1, NULL, CONUS_ERROR_DATA, "voxel_size: found -1 of axis 0"},
        {TRK_VOXEL_SIZE, FLOAT, NAN, NULL, CONUS_ERROR_DATA, "voxel_size: found nan"},
        {TRK_VOXEL_SIZE, FLOAT, INFINITY, NULL, CONUS_ERROR_DATA, "voxel_size: found inf"},
        {TRK_VOXEL_SIZE + 4, FLOAT, 1.02, NULL, CONUS_ERROR_DATA,
         "voxel_size: found 1.01999998 mm of axis 1, vox_to_ras has 1; needed is the same"},
        {TRK_VOX_TO_RAS, FLOAT, 1.02, NULL, CONUS_ERROR_DATA, "vox_to_ras has 1.01999998"},
        {TRK_VOX_TO_RAS, FLOAT, 0, NULL, CONUS_ERROR_DATA, "vox_to_ras: is singular or not finite"},
        {TRK_VOX_TO_RAS + 12, FLOAT, INFINITY, NULL, CONUS_ERROR_DATA, "vox_to_ras: is singular or not finite"},
        {TRK_VOX_TO_RAS + 60, FLOAT, 2, NULL, CONUS_ERROR_DATA, "vox_to_ras: last row 0 0 0 2, 0 0 0 1 is"},
        {TRK_VOX_TO_RAS + 52, FLOAT, 1, NULL, CONUS_ERROR_DATA, "vox_to_ras: last row 0 1 0 1, 0 0 0 1 is"},
        {TRK_VOX_TO_RAS + 60, FLOAT, NAN, NULL, CONUS_ERROR_DATA, "vox_to_ras: last row 0 0 0 nan"},
        {TRK_VOXEL_ORDER, TEXT, 4, "RAA", CONUS_ERROR_DATA, "voxel_order: found \"RAA\", needed is one letter of each"},
        {TRK_VOXEL_ORDER, TEXT, 4, "RA\0", CONUS_ERROR_DATA, "voxel_order: found \"RA\""},
        {TRK_VOXEL_ORDER, TEXT, 4, "R\033S", CONUS_ERROR_DATA, "voxel_order: found \"R S\""},
        {TRK_VOXEL_ORDER, TEXT, 4, "RASR", CONUS_ERROR_DATA, "voxel_order: found \"RASR\""},
        {TRK_VOXEL_ORDER, TEXT, 4, "ARS", CONUS_ERROR_UNSUPPORTED, "voxel_order: found ARS, vox_to_ras has RAS"},
        {TRK_VOXEL_ORDER, TEXT, 4, "ASR", CONUS_ERROR_UNSUPPORTED, "voxel_order: found ASR, vox_to_ras has RAS"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct trk_builder trk = {0};
        begin_counts(&trk, 3);
        if (cases[i].type == I16) {
            trk_put_i16(&trk, cases[i].offset, (int)cases[i].value);
        } else if (cases[i].type == I32) {
            trk_put_i32(&trk, cases[i].offset, (int64_t)cases[i].value);
        } else if (cases[i].type == FLOAT) {
            trk_put_float(&trk, cases[i].offset, cases[i].value);
        } else {
            trk_put_text(&trk, cases[i].offset, cases[i].text, 4);
        }
        assert_refused(&trk, cases[i].status, cases[i].words);
        buffer_finish(&trk.bytes);
    }
}

/* The size of an axis counts only if the axis is reversed; sizes may differ by 1 %. */
static void what_is_not_used_may_be_wrong(void **state)
{
    (void)state;
    struct trk_builder trk = {0};
    struct tractogram out = {0};
    begin_counts(&trk, 3);
    trk_put_i16(&trk, TRK_DIM, 0);
    trk_put_float(&trk, TRK_VOX_TO_RAS, 1.009);
    trk_put_float(&trk, TRK_VOX_TO_RAS + 60, 0.99999994); /* the float before 1 */
    assert_parses(&out, &trk, 1);
    tractogram_finish(&out);
    trk_put_text(&trk, TRK_VOXEL_ORDER, "LAS", 3);
    assert_refused(&trk, CONUS_ERROR_DATA,
                   "dim: found 0 of axis 0, which voxel_order LAS turns; allowed are 1 and more");
    buffer_finish(&trk.bytes);
}

static void points_that_are_nowhere_are_refused(void **state)
{
    (void)state;
    static const double bad[] = {NAN, INFINITY, 2e9};
    for (size_t i = 0; i < 3; i++) {
        struct trk_builder trk = {0};
        begin_counts(&trk, 3);
        trk_put_float(&trk, 1000 + 4 + 16, bad[i]);
        assert_refused(&trk, CONUS_ERROR_DATA, "point 1 of streamline 0 (both from 0): found (");
        buffer_finish(&trk.bytes);
    }
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
        assert_ok(tract_file_read(&out, path, NULL, 0, 0, &notes));
        assert_string_equal(out.path, path);
        assert_string_equal(out.format, packed ? "TrackVis 2, gzip, big-endian" : "TrackVis 2, big-endian");
        assert_int_equal(out.point_count, 2 * COUNT);
        for (size_t i = 0; i < 2 * (size_t)COUNT; i++) {
            assert_true(out.points[3 * i] == (float)(i % COUNT) - 0.5F && out.points[3 * i + 2] == 0.0F);
            assert_true(out.scalars[0].values[2 * i] == (float)(i % COUNT) + 0.25F);
            assert_true(out.scalars[0].values[2 * i + 1] == -(float)(i % COUNT));
        }
        tractogram_finish(&out);
        assert_fails(tract_file_read(&out, path, NULL, 2 * COUNT * 20, 0, &notes), CONUS_ERROR_MEMORY);
        assert_non_null(strstr(conus_message(), "take more than the 2800000 bytes that are allowed (--max-memory)"));
        assert_ok(tract_file_read(&out, path, NULL, 2 * COUNT * 20 + 70 * 8, 0, &notes)); /* and room for streamlines */
        tractogram_finish(&out);
        notes_finish(&notes);
    }
    buffer_finish(&trk.bytes);
}

/* With a count every prefix is refused; without one a prefix that ends with a streamline is a shorter file. */
static void every_prefix(void **state)
{
    (void)state;
    for (int counted = 0; counted < 2; counted++) {
        struct trk_builder trk = {0};
        size_t whole = 0;
        begin_scalars(&trk);
        trk_put_i32(&trk, TRK_N_COUNT, counted ? 2 : 0);
        for (size_t size = 0; size < trk.bytes.size; size++) {
            struct tractogram out = {0};
            struct notes notes = {0};
            uint8_t *exact = memory_copy(trk.bytes.data, size, 1);
            assert_non_null(exact);
            if (!tract_file_parse(&out, exact, size, 0, &notes)) {
                assert_true(!counted && (size == 1000 || size == 1000 + 4 + 2 * 28 + 20));
                whole++;
            }
            tractogram_finish(&out);
            notes_finish(&notes);
            memory_free(exact);
        }
        assert_int_equal(whole, counted ? 0 : 2);
        buffer_finish(&trk.bytes);
    }
}

static conus_status read_and_finish(void *path)
{
    struct tractogram out = {0};
    struct notes notes = {0};
    conus_status status = tract_file_read(&out, path, NULL, 0, 0, &notes);
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
        cmocka_unit_test(the_example_of_the_documents),
        cmocka_unit_test(axes_that_run_the_other_way_are_turned),
        cmocka_unit_test(an_oblique_grid),
        cmocka_unit_test(a_missing_matrix_and_order_are_warned_of),
        cmocka_unit_test(scalars_are_kept_by_name),
        cmocka_unit_test(numbers_without_names_have_names),
        cmocka_unit_test(as_many_numbers_as_a_header_has),
        cmocka_unit_test(names_that_fit_no_number_are_refused),
        cmocka_unit_test(a_count_of_0_is_counted),
        cmocka_unit_test(counts_that_lie_are_refused),
        cmocka_unit_test(headers_that_contradict_themselves_are_refused),
        cmocka_unit_test(what_is_not_used_may_be_wrong),
        cmocka_unit_test(points_that_are_nowhere_are_refused),
        cmocka_unit_test(a_streamline_longer_than_a_block),
        cmocka_unit_test(every_prefix),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests_name("trk", tests, NULL, NULL);
}
