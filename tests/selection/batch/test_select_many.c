/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses in arrays: the answers of conus_select() to the bit, whatever the threads and blocks; refused poses; ends. */
#include "base/geometry/math3.h"
#include "conus/selection.h"
#include "same_answer.h"
#include "scene.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POSES = 300, BAD = 11 }; /* every BAD-th pose is at fault */

struct fixture {
    conus_atlas *atlas;
    conus_selector *selector;
    double matrix[POSES][16], origin[POSES][3], direction[POSES][3], up[POSES][3], angle[POSES];
};

/* The answers that a sink receives. */
struct received {
    size_t poses, stop_after; /* poses; 0 = never */
    size_t starts[POSES + 1];
    conus_status status[POSES];
    conus_result *results;
    bool as_expected; /* whole blocks in order */
};

static bool receive(void *user, const conus_answers *answers)
{
    struct received *received = user;
    size_t start = received->starts[received->poses], count = answers->starts[answers->poses];
    received->as_expected = received->as_expected && answers->first == received->poses && answers->starts[0] == 0;
    received->results = realloc(received->results, (start + count + 1) * sizeof *received->results);
    if (count) {
        memcpy(received->results + start, answers->results, count * sizeof *answers->results);
    }
    for (size_t i = 0; i < answers->poses; i++) {
        received->status[received->poses] = answers->status[i];
        received->starts[++received->poses] = start + answers->starts[i + 1];
    }
    return !received->stop_after || received->poses < received->stop_after;
}

static int set_up(void **state)
{
    static struct fixture fixture;
    uint64_t seed = 3;
    fixture.atlas = scene_atlas(&seed, 24, 2);
    assert_ok(
        conus_selector_create(&fixture.selector, fixture.atlas, &(conus_selector_options){.layers = CONUS_LAYERS_ALL}));
    for (size_t i = 0; i < POSES; i++) {
        conus_pose pose = scene_generic_pose(&seed, fixture.atlas);
        memcpy(fixture.matrix[i], pose.world_from_device, sizeof fixture.matrix[i]);
        for (int k = 0; k < 3; k++) {
            fixture.origin[i][k] = pose.world_from_device[12 + k];
            fixture.direction[i][k] = -2 * pose.world_from_device[8 + k];
            fixture.up[i][k] = pose.world_from_device[4 + k];
        }
        fixture.angle[i] = i % 3 ? 5 + (double)(i % 40) : 0;
        if (i % BAD == 0) {
            fixture.matrix[i][12] = fixture.origin[i][0] = i % 2 ? INFINITY : NAN;
        }
    }
    *state = &fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    conus_selector_destroy(fixture->selector);
    conus_atlas_destroy(fixture->atlas);
    return 0;
}

static const conus_many_options twenty_degrees = {.angle = 20};

static void check_pose(const struct fixture *fixture, const struct received *received, size_t i, const conus_pose *pose)
{
    conus_selection *selection = NULL;
    double angle = fixture->angle[i] != 0 ? fixture->angle[i] : twenty_degrees.angle;
    assert_int_equal(received->status[i], CONUS_OK);
    assert_ok(conus_select(&selection, fixture->selector, pose, angle));
    size_t count = conus_selection_count(selection), start = received->starts[i];
    assert_int_equal(received->starts[i + 1] - start, count);
    for (size_t n = 0; n < count; n++) {
        assert_same_result(received->results + start + n, conus_selection_result(selection, n), 0);
    }
    conus_selection_destroy(selection);
}

/* The oracle answers each pose on its own; `along` = the array had origins and directions. */
static void check_answers(const struct fixture *fixture, const struct received *received, bool along)
{
    assert_int_equal(received->poses, POSES);
    assert_true(received->as_expected);
    for (size_t i = 0; i < POSES; i++) {
        conus_pose pose;
        if (i % BAD == 0) {
            assert_int_equal(received->status[i], CONUS_ERROR_ARGUMENT);
            assert_int_equal(received->starts[i + 1], received->starts[i]);
            continue;
        }
        assert_ok(along ? conus_pose_along(&pose, fixture->origin[i], fixture->direction[i], fixture->up[i])
                        : conus_pose_from_matrix(&pose, fixture->matrix[i]));
        check_pose(fixture, received, i, &pose);
    }
}

static conus_pose_array matrices_of(const struct fixture *fixture)
{
    return (conus_pose_array){.count = POSES, .matrix = fixture->matrix[0], .angle = fixture->angle};
}

static void answers_do_not_depend_on_threads_or_blocks(void **state)
{
    struct fixture *fixture = *state;
    static const uint32_t settings[][2] = {{1, 1}, {1, 0}, {2, 1}, {2, 16}, {3, 100}, {8, 7}, {5, 65536}};
    const conus_pose_array check = {.count = POSES,
                                    .origin = fixture->origin[0],
                                    .direction = fixture->direction[0],
                                    .up = fixture->up[0],
                                    .angle = fixture->angle};
    const conus_pose_array matrices = matrices_of(fixture);
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        conus_many_options options = twenty_degrees;
        options.threads = settings[i][0];
        options.block = settings[i][1];
        for (int along = 0; along < 2; along++) {
            struct received received = {.as_expected = true};
            assert_ok(
                conus_select_many(NULL, fixture->selector, along ? &check : &matrices, &options, receive, &received));
            check_answers(fixture, &received, along);
            free(received.results);
        }
    }
}

/* The oracle is a selector whose options have the range of the pose: each end is the pose's own or the common one. */
static void each_pose_may_have_its_range(void **state)
{
    struct fixture *fixture = *state;
    enum { KINDS = 5 };
    static const double ranges[KINDS][2] = {{NAN, NAN}, {0, 20}, {NAN, 25}, {12, NAN}, {8, 30}};
    const conus_selector_options layers[] = {{.range = {5, 40}}, {.range = {5, 40}, .layers = CONUS_LAYERS_ALL}};
    double all[POSES][2];
    conus_pose_array poses = matrices_of(fixture);
    poses.range = all[0];
    for (size_t i = 0; i < POSES; i++) {
        memcpy(all[i], ranges[i % KINDS], sizeof all[i]);
    }
    all[1][1] = -1; /* at fault */
    for (size_t l = 0; l < 2; l++) {
        struct fixture own = *fixture;
        struct received received = {.as_expected = true};
        conus_selector *selector = NULL;
        assert_ok(conus_selector_create(&selector, fixture->atlas, &layers[l]));
        conus_many_options options = twenty_degrees;
        options.threads = 2;
        options.block = 7;
        assert_ok(conus_select_many(NULL, selector, &poses, &options, receive, &received));
        assert_int_equal(received.status[1], CONUS_ERROR_ARGUMENT);
        for (size_t k = 0; k < KINDS; k++) {
            conus_selector_options with = layers[l];
            with.range[0] = isnan(ranges[k][0]) ? with.range[0] : ranges[k][0];
            with.range[1] = isnan(ranges[k][1]) ? with.range[1] : ranges[k][1];
            assert_ok(conus_selector_create(&own.selector, fixture->atlas, &with));
            for (size_t i = k; i < POSES; i += KINDS) {
                conus_pose pose;
                if (i % BAD && i != 1) {
                    assert_ok(conus_pose_from_matrix(&pose, fixture->matrix[i]));
                    check_pose(&own, &received, i, &pose);
                }
            }
            conus_selector_destroy(own.selector);
        }
        free(received.results);
        conus_selector_destroy(selector);
    }
}

static void no_poses_are_no_answers(void **state)
{
    struct fixture *fixture = *state;
    struct received received = {.as_expected = true};
    conus_pose_findings findings = {.poses = 9};
    assert_ok(
        conus_select_many(&findings, fixture->selector, &(conus_pose_array){.count = 0}, NULL, receive, &received));
    assert_int_equal(received.poses, 0);
    assert_int_equal(findings.poses, 0);
    free(received.results);
}

/* The oracle calls conus_pose_check_add() for each pose. */
static void findings_are_those_of_the_poses(void **state)
{
    struct fixture *fixture = *state;
    const conus_pose_array poses = matrices_of(fixture);
    conus_pose_check *check = NULL;
    assert_ok(conus_pose_check_create(&check, fixture->selector));
    for (size_t i = 0; i < POSES; i++) {
        conus_pose pose;
        if (conus_pose_from_matrix(&pose, fixture->matrix[i]) == CONUS_OK) {
            conus_pose_check_add(check, i, &pose, fixture->angle[i] != 0 ? fixture->angle[i] : twenty_degrees.angle);
        }
    }
    const conus_pose_findings *wanted = conus_pose_check_found(check);
    for (uint32_t threads = 1; threads < 4; threads++) {
        conus_many_options options = twenty_degrees;
        struct received received = {.as_expected = true};
        conus_pose_findings found;
        options.threads = threads;
        options.block = 32;
        assert_ok(conus_select_many(&found, fixture->selector, &poses, &options, receive, &received));
        assert_int_equal(found.poses, POSES - (POSES + BAD - 1) / BAD);
        assert_int_equal(found.poses, wanted->poses);
        assert_int_equal(found.inside.count, wanted->inside.count);
        assert_int_equal(found.away.count, wanted->away.count);
        assert_int_equal(found.away.first, wanted->away.first);
        free(received.results);
    }
    conus_pose_check_destroy(check);
}

static void a_sink_ends_the_run(void **state)
{
    struct fixture *fixture = *state;
    const conus_pose_array poses = matrices_of(fixture);
    for (uint32_t threads = 1; threads <= 4; threads++) {
        struct received received = {.stop_after = 40, .as_expected = true};
        const conus_many_options options = {.threads = threads, .block = 20};
        conus_pose_findings findings = {.poses = 9};
        assert_fails(conus_select_many(&findings, fixture->selector, &poses, &options, receive, &received),
                     CONUS_ERROR_CANCELLED);
        assert_int_equal(received.poses, 40);
        assert_int_equal(findings.poses, 9); /* untouched */
        free(received.results);
    }
}

static void what_is_out_of_range(void **state)
{
    struct fixture *fixture = *state;
    struct received received = {.as_expected = true};
    const conus_pose_array good = matrices_of(fixture);
    const double *origin = fixture->origin[0];
    const conus_pose_array bad[] = {{.count = 1},
                                    {.count = 1, .origin = origin, .up = origin},
                                    {.count = 1, .direction = origin},
                                    {.count = 1, .matrix = fixture->matrix[0], .origin = origin}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_fails(conus_select_many(NULL, fixture->selector, &bad[i], NULL, receive, &received),
                     CONUS_ERROR_ARGUMENT);
    }
    const conus_many_options options[] = {{.threads = 1025}, {.block = 65537}, {.radius = -1}, {.radius = INFINITY}};
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        assert_fails(conus_select_many(NULL, fixture->selector, &good, &options[i], receive, &received),
                     CONUS_ERROR_ARGUMENT);
    }
    assert_int_equal(received.poses, 0);
}

/* An opening angle that no cone can have is an error of each pose. */
static void an_angle_out_of_range_is_a_pose_s_fault(void **state)
{
    struct fixture *fixture = *state;
    struct received received = {.as_expected = true};
    const double angles[] = {-1, NAN, 181};
    const conus_pose_array poses = {.count = 3, .matrix = fixture->matrix[1], .angle = angles};
    assert_ok(conus_select_many(NULL, fixture->selector, &poses, NULL, receive, &received));
    assert_int_equal(received.poses, 3);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(received.status[i], CONUS_ERROR_ARGUMENT);
    }
    free(received.results);
}

static bool count_poses(void *user, const conus_answers *answers)
{
    *(size_t *)user += answers->poses;
    return true;
}

static conus_status count_forty(void *data)
{
    struct fixture *fixture = data;
    conus_pose_array poses = matrices_of(fixture);
    size_t count = 0;
    poses.count = 40;
    return conus_select_many(NULL, fixture->selector, &poses, &(conus_many_options){.threads = 1, .block = 16},
                             count_poses, &count);
}

static void every_failing_allocation_is_clean(void **state)
{
    test_every_allocation(count_forty, *state);
}

TEST_GROUP(select_many)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(answers_do_not_depend_on_threads_or_blocks),
        cmocka_unit_test(each_pose_may_have_its_range),
        cmocka_unit_test(no_poses_are_no_answers),
        cmocka_unit_test(findings_are_those_of_the_poses),
        cmocka_unit_test(a_sink_ends_the_run),
        cmocka_unit_test(what_is_out_of_range),
        cmocka_unit_test(an_angle_out_of_range_is_a_pose_s_fault),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
