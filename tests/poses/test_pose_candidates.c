/* SPDX-License-Identifier: BSD-3-Clause */
/* Candidates: every pair of an entry and a target, rings of tilted directions, ids, depths, refused input. */
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double entries[][3] = {{0, 0, 50}, {10, 0, 40}, {-20, 30, 5}};
static const double normals[][3] = {{0, 0, 2}, {1, 0, 0}, {-3, 4, 0}};
static const double targets[][3] = {{0, 0, 0}, {5, -5, 10}};

enum { ENTRIES = 3, TARGETS = 2 };

static const conus_candidates pairs = {
    .entries = entries[0], .entry_count = ENTRIES, .targets = targets[0], .target_count = TARGETS};

static conus_pose_stream *open_candidates(conus_candidates candidates)
{
    conus_pose_stream *stream = NULL;
    assert_ok(conus_candidates_open(&stream, &candidates));
    return stream;
}

static bool read_one(conus_pose_row *row, conus_pose_stream *stream)
{
    size_t count = 9;
    assert_ok(conus_pose_stream_read(row, &count, stream, 1));
    return count == 1;
}

/* The angle between the row's axis and a vector, by its cosine. */
static double angle_to(const conus_pose_row *row, double x, double y, double z)
{
    const double *m = row->pose.world_from_device;
    return acos(fmax(-1, fmin(1, -(m[8] * x + m[9] * y + m[10] * z) / sqrt(x * x + y * y + z * z))));
}

static void every_entry_goes_to_every_target(void **state)
{
    (void)state;
    conus_candidates asked = pairs;
    asked.to_target = true;
    asked.beyond = 3;
    conus_pose_stream *stream = open_candidates(asked);
    uint64_t number = 0;
    assert_ok(conus_pose_stream_count(&number, stream));
    assert_int_equal(number, ENTRIES * TARGETS);
    assert_true(conus_pose_stream_facts(stream).has_ranges);
    assert_false(conus_pose_stream_facts(stream).has_points);
    assert_false(conus_pose_stream_facts(stream).is_live);
    for (size_t i = 0; i < (size_t)ENTRIES * TARGETS; i++) {
        conus_pose_row row;
        char id[32];
        const double *e = entries[i / TARGETS];
        const double *t = targets[i % TARGETS];
        assert_true(read_one(&row, stream));
        snprintf(id, sizeof id, "e%zu-t%zu", i / TARGETS + 1, i % TARGETS + 1);
        assert_string_equal(row.id, id);
        assert_int_equal(row.line, i + 1);
        assert_int_equal(row.entry, i / TARGETS + 1);
        assert_int_equal(row.target, i % TARGETS + 1);
        assert_true(isnan(row.normal[0]) && isnan(row.range[0]));
        assert_memory_equal(row.pose.world_from_device + 12, e, sizeof entries[0]);
        assert_near(angle_to(&row, t[0] - e[0], t[1] - e[1], t[2] - e[2]), 0, 1e-7);
        assert_near(row.range[1], hypot(hypot(t[0] - e[0], t[1] - e[1]), t[2] - e[2]) + 3, 1e-12);
    }
    conus_pose_row row;
    assert_false(read_one(&row, stream));
    conus_pose_stream_destroy(stream);
}

static void rows_passed_over_are_counted(void **state)
{
    (void)state;
    conus_pose_stream *stream = open_candidates(pairs);
    conus_pose_row row;
    assert_ok(conus_pose_stream_skip(stream, 4));
    assert_true(read_one(&row, stream));
    assert_string_equal(row.id, "e3-t1");
    assert_ok(conus_pose_stream_skip(stream, UINT64_MAX));
    assert_false(read_one(&row, stream));
    conus_pose_stream_destroy(stream);
}

static void without_targets_the_normal_leads_in(void **state)
{
    (void)state;
    conus_candidates asked = {.entries = entries[0], .normals = normals[0], .entry_count = ENTRIES};
    conus_pose_stream *stream = open_candidates(asked);
    conus_pose_row row;
    for (size_t i = 0; i < ENTRIES; i++) {
        char id[8];
        assert_true(read_one(&row, stream));
        snprintf(id, sizeof id, "e%zu", i + 1);
        assert_string_equal(row.id, id);
        assert_int_equal(row.target, 0);
        assert_near(angle_to(&row, -normals[i][0], -normals[i][1], -normals[i][2]), 0, 1e-7);
        assert_near(vec3_length(row.normal), 1, 1e-15);
        assert_near(vec3_dot(row.normal, normals[i]), vec3_length(normals[i]), 1e-12);
    }
    conus_pose_stream_destroy(stream);
}

/* For every ring of a tilt: its angle to the direction, its number of directions, and their distances along it. The
 * first of them points towards the device's +y, the second towards its +x. */
static void rings_surround_the_direction(void **state)
{
    (void)state;
    const double step = 5 * MATH3_PI / 180;
    conus_candidates asked = pairs;
    asked.entry_count = asked.target_count = 1;
    asked.tilt_most = 15;
    asked.tilt_step = 5;
    conus_pose_stream *stream = open_candidates(asked);
    conus_pose_row row;
    assert_true(read_one(&row, stream));
    assert_string_equal(row.id, "k1");
    double m[16];
    memcpy(m, row.pose.world_from_device, sizeof m);
    size_t number = 1;
    for (int ring = 1; ring <= 3; ring++) {
        /* 2 pi sin(5, 10, 15 degrees) / (5 degrees) = 6.28, 12.5, 18.6 */
        const size_t sizes[] = {0, 7, 13, 19};
        for (size_t i = 0; i < sizes[ring]; i++) {
            char id[16];
            assert_true(read_one(&row, stream));
            snprintf(id, sizeof id, "k%zu", ++number);
            assert_string_equal(row.id, id);
            double axis[3];
            vec3_scale(axis, row.pose.world_from_device + 8, -1);
            assert_near(acos(-vec3_dot(axis, m + 8)), ring * step, 1e-12);
            double turn = atan2(vec3_dot(axis, m), vec3_dot(axis, m + 4)); /* from +y to +x */
            double wanted = 2 * MATH3_PI * (double)i / (double)sizes[ring];
            assert_near(remainder(turn - wanted, 2 * MATH3_PI), 0, 1e-12);
        }
    }
    assert_false(read_one(&row, stream));
    conus_pose_stream_destroy(stream);
    asked.tilt_most = asked.tilt_step = 90; /* 4 sideways */
    stream = open_candidates(asked);
    uint64_t count;
    assert_ok(conus_pose_stream_count(&count, stream));
    assert_int_equal(count, 5);
    conus_pose_stream_destroy(stream);
}

/* Three turns of each tilt, 120 degrees apart, from +y towards +x, about the same axis. */
static void turns_about_the_axis(void **state)
{
    (void)state;
    conus_candidates asked = pairs;
    asked.entry_count = asked.target_count = 1;
    asked.tilt_most = asked.tilt_step = 90; /* 5 directions */
    asked.roll_step = 120;
    conus_pose_stream *stream = open_candidates(asked);
    for (int tilt = 1; tilt <= 5; tilt++) {
        double first[16];
        for (int turn = 0; turn < 3; turn++) {
            conus_pose_row row;
            char id[16];
            assert_true(read_one(&row, stream));
            snprintf(id, sizeof id, "k%d-r%d", tilt, turn + 1);
            assert_string_equal(row.id, id);
            const double *m = row.pose.world_from_device;
            memcpy(first, turn ? first : m, sizeof first);
            assert_near(vec3_dot(m + 8, first + 8), 1, 1e-12);
            assert_memory_equal(m + 12, first + 12, 3 * sizeof *m);
            double angle = atan2(vec3_dot(m + 4, first), vec3_dot(m + 4, first + 4));
            assert_near(remainder(angle - turn * 2 * MATH3_PI / 3, 2 * MATH3_PI), 0, 1e-12);
        }
    }
    conus_pose_row row;
    assert_false(read_one(&row, stream));
    conus_pose_stream_destroy(stream);
}

static void one_candidate_has_an_id(void **state)
{
    (void)state;
    conus_candidates asked = pairs;
    asked.entry_count = asked.target_count = 1;
    conus_pose_stream *stream = open_candidates(asked);
    conus_pose_row row;
    assert_true(read_one(&row, stream));
    assert_string_equal(row.id, "e1");
    conus_pose_stream_destroy(stream);
}

static void an_entry_at_its_target_is_no_pose(void **state)
{
    (void)state;
    conus_candidates asked = pairs;
    asked.targets = entries[0];
    conus_pose_stream *stream = open_candidates(asked);
    conus_pose_row row;
    assert_true(read_one(&row, stream));
    assert_non_null(row.error);
    assert_string_equal(row.id, "e1-t1");
    assert_true(read_one(&row, stream));
    assert_null(row.error);
    conus_pose_stream_destroy(stream);
}

/* A written direction that is read again is the same, and so are the two axes across it. */
static void a_pose_is_made_of_its_own_axis_again(void **state)
{
    (void)state;
    uint64_t random = 7;
    for (int i = 0; i < 10000; i++) {
        conus_pose pose;
        conus_pose again;
        double d[3];
        const double origin[3] = {test_random(&random, -100, 100), 0, 1};
        for (int a = 0; a < 3; a++) {
            d[a] = test_random(&random, -1, 1) * (i % 7 ? 1 : 1e-3);
        }
        assert_ok(conus_pose_along(&pose, origin, d, NULL));
        vec3_scale(d, pose.world_from_device + 8, -1);
        assert_ok(conus_pose_along(&again, origin, d, NULL));
        assert_memory_equal(&again, &pose, sizeof pose);
    }
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    static const double nowhere[] = {0, 0, 50, 1, NAN, 3};
    static const double flat[] = {0, 0, 1, 0, 0, 0, 1, 0, 0};
    static const struct {
        conus_candidates asked;
        const char *message;
    } cases[] = {
        {{.entries = entries[0], .targets = targets[0], .target_count = 1}, "no candidate: there is no entry"},
        {{.entries = entries[0], .entry_count = 1, .targets = targets[0]}, "no candidate: there is no target"},
        {{.entries = nowhere, .entry_count = 2, .targets = targets[0], .target_count = 1}, "entry 2: 1,nan,3"},
        {{.entries = entries[0], .entry_count = 2, .targets = nowhere, .target_count = 2}, "target 2: 1,nan,3"},
        {{.entries = entries[0], .entry_count = 2}, "entry 1 has no normal"},
        {{.entries = entries[0], .entry_count = 3, .normals = flat}, "entry 2 has no normal"},
        {{.entries = entries[0], .entry_count = 1, .normals = flat, .to_target = true}, "there is none"},
        {{.entries = entries[0], .entry_count = 1, .normals = flat, .tilt_most = 60}, "tilt: up to"},
        {{.entries = entries[0], .entry_count = 1, .normals = flat, .tilt_most = 6, .tilt_step = 12}, "tilt: up to"},
        {{.entries = entries[0], .entry_count = 1, .normals = flat, .tilt_most = 60, .tilt_step = 0.006},
         "tilt: up to"},
        {{.entries = entries[0], .entry_count = 1, .normals = flat, .tilt_most = 115, .tilt_step = 60}, "tilt: up to"},
        {{.entries = entries[0], .entry_count = 1, .normals = flat, .tilt_most = NAN, .tilt_step = 60}, "tilt: up to"},
        {{.entries = entries[0], .entry_count = 1, .normals = flat, .beyond = NAN}, "beyond"},
        {{.entries = entries[0], .entry_count = 1, .normals = flat, .roll_step = 230}, "roll: in steps of"},
        {{.entries = entries[0], .entry_count = 1, .normals = flat, .roll_step = NAN}, "roll: in steps of"},
        {{.angles = flat, .entry_count = 1, .back = 5}, "angles: targets go with them"},
        {{.angles = flat, .entries = flat, .entry_count = 1, .targets = flat, .target_count = 1, .back = 5},
         "angles: targets go with them"},
        {{.angles = nowhere, .entry_count = 3, .targets = flat, .target_count = 1, .back = 5},
         "angles: finite numbers"},
        {{.angles = flat, .entry_count = 1, .targets = flat, .target_count = 1}, "back: 0 mm"},
        {{.angles = flat, .entry_count = 1, .targets = flat, .target_count = 1, .back = INFINITY}, "back: inf mm"},
        {{.angles = flat, .targets = flat, .target_count = 1, .back = 5}, "there is no entry"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_pose_stream *stream = NULL;
        assert_fails(conus_candidates_open(&stream, &cases[i].asked), CONUS_ERROR_ARGUMENT);
        assert_non_null(strstr(conus_message(), cases[i].message));
        assert_null(stream);
    }
}

/* 2^20 entries and 2^20 targets are the limit, one tilt more is too much; no memory is needed for them. */
static void too_many_candidates_are_refused(void **state)
{
    (void)state;
    enum { MANY = 1 << 20 };
    double *points = calloc(3 * (size_t)MANY, sizeof *points);
    assert_non_null(points);
    conus_candidates asked = {.entries = points, .entry_count = MANY, .targets = points, .target_count = MANY};
    conus_pose_stream *stream = open_candidates(asked);
    uint64_t count;
    assert_ok(conus_pose_stream_count(&count, stream));
    assert_int_equal(count, CONUS_CANDIDATE_LIMIT);
    conus_pose_stream_destroy(stream);
    asked.tilt_most = asked.tilt_step = 6;
    assert_fails(conus_candidates_open(&stream, &asked), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "allowed are 1.1e+12"));
    free(points);
}

static conus_status read_all(void *data)
{
    (void)data;
    conus_candidates asked = pairs;
    asked.targets = entries[0];
    asked.tilt_most = asked.tilt_step = 30;
    conus_pose_stream *stream = NULL;
    conus_pose_row rows[7];
    size_t count = 1;
    conus_status status = conus_candidates_open(&stream, &asked);
    while (!status && count) {
        status = conus_pose_stream_read(rows, &count, stream, 7);
    }
    conus_pose_stream_destroy(stream);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    test_every_allocation(read_all, NULL);
}

TEST_GROUP(pose_candidates)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_entry_goes_to_every_target),
        cmocka_unit_test(rows_passed_over_are_counted),
        cmocka_unit_test(without_targets_the_normal_leads_in),
        cmocka_unit_test(rings_surround_the_direction),
        cmocka_unit_test(turns_about_the_axis),
        cmocka_unit_test(one_candidate_has_an_id),
        cmocka_unit_test(an_entry_at_its_target_is_no_pose),
        cmocka_unit_test(a_pose_is_made_of_its_own_axis_again),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(too_many_candidates_are_refused),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
