/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of tractograms: the limits of their contents, and measures of their streamlines. */
#include "atlas/tracts/tractogram.h"
#include "base/memory.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Streamline 0 has two sides of the triangle 3, 4, 5; 1 has no point, 2 has one, 3 no point, 4 a diagonal of a unit
 * cube. */
static float points[6][3] = {{0, 0, 0}, {3, 0, 0}, {3, 4, 0}, {9, 9, 9}, {0, 0, 0}, {1, 1, 1}};
static uint16_t halves[6][3] = {{0, 0, 0}, {0x4200, 0, 0},          {0x4200, 0x4400, 0}, {0x4880, 0x4880, 0x4880},
                                {0, 0, 0}, {0x3c00, 0x3c00, 0x3c00}};
static uint64_t first[6] = {0, 3, 3, 4, 4, 6};
static uint32_t members[3] = {0, 2, 4};
static struct tract_group group = {"arcuate", members, 3};

static const struct tractogram example = {.points = points[0],
                                          .point_count = 6,
                                          .first = first,
                                          .streamline_count = 5,
                                          .groups = &group,
                                          .group_count = 1,
                                          .radius = TRACT_RADIUS,
                                          .has_borrowed_points = true,
                                          .is_borrowed = true};

/* The same in half precision: 3 = 1.5 * 2, 4 = 1 * 4, 9 = 1.125 * 8, 1 = 1 * 1. */
static struct tractogram half_example(void)
{
    struct tractogram tractogram = example;
    tractogram.points = NULL;
    tractogram.halves = halves[0];
    return tractogram;
}

/* IEEE 754, binary16: sign, five bits of exponent (bias 15), ten of fraction; by ldexp(), another way. */
static void all_halves_are_what_the_standard_says(void **state)
{
    (void)state;
    for (unsigned h = 0; h < 1U << 16; h++) {
        double sign = h >> 15 ? -1 : 1;
        int exponent = (int)(h >> 10 & 31);
        int fraction = (int)(h & 1023);
        double got = tract_from_half((uint16_t)h);
        if (exponent == 31) {
            assert_true(fraction ? isnan(got) : isinf(got) && got * sign > 0);
        } else {
            double wanted = sign * (exponent ? ldexp(1024 + fraction, exponent - 25) : ldexp(fraction, -24));
            assert_true(got == wanted && !signbit(got) == !signbit(wanted));
        }
    }
    assert_true(tract_from_half(0x7bff) == 65504.0);
}

static void points_know_their_streamline(void **state)
{
    (void)state;
    static const uint32_t wanted[6] = {0, 0, 0, 2, 4, 4};
    for (uint64_t i = 0; i < 6; i++) {
        assert_int_equal(tractogram_streamline_of(&example, i), wanted[i]);
    }
}

/* 3 + 4; nothing; nothing; nothing; sqrt(3). The same of halves, which these coordinates fit exactly. */
static void lengths_are_sums_of_segments(void **state)
{
    (void)state;
    static const double wanted[5] = {7, 0, 0, 0, 1.7320508075688772};
    const struct tractogram half = half_example();
    for (uint32_t k = 0; k < 5; k++) {
        assert_near(tractogram_length(&example, k), wanted[k], 1e-15);
        assert_near(tractogram_length(&half, k), wanted[k], 1e-15);
    }
}

static void short_streamlines_are_noted(void **state)
{
    (void)state;
    struct notes notes = {0};
    assert_ok(tractogram_check(&example, &notes));
    assert_int_equal(notes.count, 1);
    assert_string_equal(notes.lines[0], "streamlines: of 5, 2 have no point and 1 have one");
    notes_cut(&notes, 0);
    const struct tractogram half = half_example();
    assert_ok(tractogram_check(&half, &notes));
    assert_int_equal(notes.count, 1);
    notes_cut(&notes, 0);
    struct tractogram empty = {.first = first, .radius = TRACT_RADIUS_LIMIT};
    assert_ok(tractogram_check(&empty, &notes));
    assert_int_equal(notes.count, 0);
    notes_finish(&notes);
}

static void assert_refused(const struct tractogram *tractogram, conus_status status, const char *words)
{
    struct notes notes = {0};
    assert_fails(tractogram_check(tractogram, &notes), status);
    if (!strstr(conus_message(), words)) {
        fail_msg("'%s' lacks '%s'", conus_message(), words);
    }
    assert_int_equal(notes.count, 0);
}

static void points_beyond_the_limit_are_refused(void **state)
{
    (void)state;
    static const float bad[] = {NAN, INFINITY, -INFINITY, 1.0001e9F, -1.0001e9F};
    for (size_t i = 0; i < 5; i++) {
        points[5][i % 3] = bad[i];
        assert_refused(&example, CONUS_ERROR_DATA, "point 1 of streamline 4 (both from 0): found (");
        points[5][i % 3] = i % 2 ? 1e9F : -1e9F; /* the limit itself is allowed */
        struct notes notes = {0};
        assert_ok(tractogram_check(&example, &notes));
        notes_finish(&notes);
        points[5][i % 3] = 1;
    }
    const struct tractogram half = half_example();
    halves[3][1] = 0x7c00;
    assert_refused(&half, CONUS_ERROR_DATA,
                   "point 0 of streamline 2 (both from 0): found (9, inf, 9) mm, allowed is within 1e9 of 0");
    halves[3][1] = 0x4880;
}

/* Points are checked in blocks: tried are the last one of the first block and the first of the second. */
static void points_are_looked_at_to_the_last(void **state)
{
    (void)state;
    enum { COUNT = 5000 };
    struct tractogram many = {.point_count = COUNT, .first = (uint64_t[]){0, COUNT}, .streamline_count = 1};
    many.points = memory_zeroed(COUNT, 3 * sizeof *many.points);
    many.radius = 1;
    assert_non_null(many.points);
    static const uint64_t places[] = {0, 4095, 4096, COUNT - 1};
    for (size_t i = 0; i < 4; i++) {
        char words[64];
        many.points[3 * places[i] + 2] = NAN;
        snprintf(words, sizeof words, "point %u of streamline 0 (both from 0): found (0, 0, nan) mm",
                 (unsigned)places[i]);
        assert_refused(&many, CONUS_ERROR_DATA, words);
        many.points[3 * places[i] + 2] = 0;
    }
    memory_free(many.points);
}

static void what_contradicts_itself_is_refused(void **state)
{
    (void)state;
    struct tractogram bad = example;
    bad.first = (uint64_t[]){0, 3, 2, 4, 4, 6};
    assert_refused(&bad, CONUS_ERROR_DATA, "streamline 1 (from 0): begins at point 3 and ends before point 2");
    bad.first = (uint64_t[]){1, 3, 3, 4, 4, 6};
    assert_refused(&bad, CONUS_ERROR_DATA, "they have the points 1 to 6, needed are all from 0 to 6");
    bad.first = (uint64_t[]){0, 3, 3, 4, 4, 5};
    assert_refused(&bad, CONUS_ERROR_DATA, "they have the points 0 to 5, needed are all from 0 to 6");
    bad = example;
    bad.streamline_count = UINT32_MAX;
    assert_refused(&bad, CONUS_ERROR_DATA, "streamlines: found 4294967295, allowed are 4294967294");
    members[2] = 5;
    assert_refused(&example, CONUS_ERROR_DATA, "group 'arcuate': found streamline 5, the file has 5, from 0");
    members[2] = 2;
    assert_refused(&example, CONUS_ERROR_DATA, "found streamline 2 after 2, needed are ascending numbers");
    members[2] = 4;
}

static void a_radius_is_above_0_and_at_most_100(void **state)
{
    (void)state;
    static const double radii[] = {0, -1, NAN, INFINITY, 100.001};
    struct tractogram bad = example;
    for (size_t i = 0; i < 5; i++) {
        bad.radius = radii[i];
        assert_refused(&bad, CONUS_ERROR_ARGUMENT, " mm, allowed is above 0 and at most 100");
    }
}

/* All of it is on the heap; the sanitizers find leaks and double frees. */
static conus_status make_owned(struct tractogram *out)
{
    *out = example;
    out->path = memory_text("a", 1);
    out->scalars = memory_zeroed(1, sizeof *out->scalars);
    out->groups = memory_zeroed(1, sizeof *out->groups);
    if (!out->path || !out->scalars || !out->groups) {
        return CONUS_ERROR_MEMORY;
    }
    *out->scalars = (struct tract_scalar){memory_text("FA", 2), true, 1, NULL};
    *out->groups = (struct tract_group){memory_text("CST", 3), members, 3};
    out->scalar_count = out->group_count = 1;
    return out->scalars->name && out->groups->name ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static void finishing_frees_what_it_owns(void **state)
{
    (void)state;
    struct tractogram tractogram = {0};
    tractogram_finish(&tractogram);
    assert_ok(make_owned(&tractogram)); /* borrows its numbers */
    tractogram_finish(&tractogram);
    assert_null(tractogram.path);
    assert_ok(make_owned(&tractogram));
    tractogram.has_borrowed_points = tractogram.is_borrowed = false;
    tractogram.points = memory_copy(points, 6, sizeof points[0]);
    tractogram.halves = memory_copy(halves, 6, sizeof halves[0]);
    tractogram.first = memory_copy(first, 6, sizeof first[0]);
    tractogram.scalars->values = memory_zeroed(6, sizeof(float));
    tractogram.groups->members = memory_copy(members, 3, sizeof members[0]);
    tractogram_finish(&tractogram);
    assert_null(tractogram.points);
    tractogram_finish(&tractogram);
}

TEST_GROUP(tractogram)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_halves_are_what_the_standard_says), cmocka_unit_test(points_know_their_streamline),
        cmocka_unit_test(lengths_are_sums_of_segments),          cmocka_unit_test(short_streamlines_are_noted),
        cmocka_unit_test(points_beyond_the_limit_are_refused),   cmocka_unit_test(points_are_looked_at_to_the_last),
        cmocka_unit_test(what_contradicts_itself_is_refused),    cmocka_unit_test(a_radius_is_above_0_and_at_most_100),
        cmocka_unit_test(finishing_frees_what_it_owns),
    };
    return cmocka_run_group_tests_name("tractogram", tests, NULL, NULL);
}
