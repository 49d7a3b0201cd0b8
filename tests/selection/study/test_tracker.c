/* SPDX-License-Identifier: BSD-3-Clause */
/* A device tracked over time (Eq. 12): the ranking with a history, and what a press of the trigger confirms. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "selection/report/report.h"
#include "test.h"

#include <string.h>

/* A ball of 6 mm around the origin, between the arms of a U at x = -17 and 17, 5 mm to each side. */
struct track {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_tracker *tracker;
    conus_selection *selection;
    double degrees; /* of the cone */
};

static struct track open_track(const char *score, uint32_t resolution, const conus_tracker_options *options)
{
    struct track track = {.degrees = 3};
    struct phantom_drawing drawing = {0};
    const conus_selector_options selector = {.score = score, .resolution = resolution};
    assert_ok(phantom_draw(&drawing, "u-shape", &(conus_phantom_options){0}));
    assert_ok(phantom_drawing_atlas(&track.atlas, &drawing));
    phantom_drawing_finish(&drawing);
    assert_ok(conus_selector_create(&track.selector, track.atlas, &selector));
    assert_ok(conus_tracker_create(&track.tracker, track.selector, options));
    return track;
}

static void close_track(struct track *track)
{
    conus_selection_destroy(track->selection);
    conus_tracker_destroy(track->tracker);
    conus_selector_destroy(track->selector);
    conus_atlas_destroy(track->atlas);
}

/* A step with the device above (x, 0), looking down. */
static conus_status try_step(struct track *track, double time, double x, bool trigger)
{
    conus_pose pose;
    conus_selection *selection = NULL;
    assert_ok(conus_pose_along(&pose, (double[]){x, 0, 150}, (double[]){0, 0, -1}, NULL));
    conus_status status = conus_tracker_step(&selection, track->tracker, time, &pose, track->degrees, trigger);
    if (!status) {
        conus_selection_destroy(track->selection);
        track->selection = selection;
    }
    return status;
}

static const conus_step *step(struct track *track, double time, double x, bool trigger)
{
    assert_ok(try_step(track, time, x, trigger));
    return conus_selection_step(track->selection);
}

/* x at which the cone, of about 4 mm there, sees one area only, or nothing. */
#define AT_BALL 0.0
#define AT_ARM 17.0
#define AT_NOTHING 60.0

enum { ARM = 1, BALL = 2 }; /* object numbers, too */

static const conus_result *find(const struct track *track, uint32_t object)
{
    for (size_t i = 0; i < conus_selection_count(track->selection); i++) {
        const conus_result *result = conus_selection_result(track->selection, i);
        if (result->object == object) {
            return result;
        }
    }
    return NULL;
}

static double score_of(const struct track *track, uint32_t object)
{
    const conus_result *result = find(track, object);
    return result ? result->score : 0;
}

static void one_row_is_a_beginning(void **state)
{
    (void)state;
    struct track track = open_track("intenselect", 0, NULL);
    const conus_step *first = step(&track, 5, AT_BALL, false);
    assert_near(first->time_s, 5, 0);
    assert_int_equal(first->selected, BALL);
    assert_int_equal(first->confirmed, 0);
    assert_near(score_of(&track, BALL), 0, 0); /* no time has passed */
    assert_int_equal(conus_tracker_selected(track.tracker, 0), BALL);
    assert_int_equal(conus_tracker_selected(track.tracker, 1), BALL);
    close_track(&track);
}

/* 0.3 - 0.1 is a little less than 0.2 in binary; the object selected at 0.2 was selected 0.1 s ago nevertheless. */
static void a_moment_ago_is_not_missed_by_rounding(void **state)
{
    (void)state;
    assert_true(0.3 - 0.1 < 0.2);
    struct track track = open_track("intenselect", 0, NULL);
    assert_int_equal(step(&track, 0.1, AT_NOTHING, false)->selected, 0);
    assert_int_equal(step(&track, 0.2, AT_BALL, false)->selected, BALL);
    assert_int_equal(step(&track, 0.3, AT_BALL, false)->selected, BALL);
    assert_int_equal(conus_tracker_selected(track.tracker, 0.1), BALL);
    assert_int_equal(conus_tracker_selected(track.tracker, 0.11), 0);
    close_track(&track);
}

static void nothing_in_the_cone_is_nothing_selected(void **state)
{
    (void)state;
    struct track track = open_track("intenselect", 0, NULL);
    assert_int_equal(step(&track, 0, AT_NOTHING, true)->selected, 0);
    assert_int_equal(conus_selection_step(track.selection)->confirmed, 0);
    assert_int_equal(conus_selection_count(track.selection), 1);
    assert_int_equal(step(&track, 1, AT_BALL, false)->selected, BALL);
    assert_int_equal(conus_tracker_selected(track.tracker, 0.5), 0);
    close_track(&track);
}

static void what_left_stays_until_its_score_is_gone(void **state)
{
    (void)state;
    struct track track = open_track("intenselect_plus", 0, NULL);
    for (int i = 0; i <= 10; i++) {
        step(&track, i / 10.0, AT_BALL, false);
    }
    double before = score_of(&track, BALL);
    assert_true(before > 0.9);
    step(&track, 1.1, AT_NOTHING, false);
    const conus_result *ball = find(&track, BALL);
    assert_int_equal(ball->pixels, 0);
    assert_near(ball->share, 0, 0);
    assert_true(isnan(ball->distance) && isnan(ball->contact[2]) && isnan(ball->offset));
    assert_int_equal(ball->rank, 1);
    assert_int_equal(ball->kind, CONUS_KIND_AREA);
    assert_true(ball->score < before && ball->score > before * exp(-0.5));
    assert_int_equal(conus_selection_step(track.selection)->selected, BALL);
    assert_int_equal(conus_selection_result(track.selection, 1)->kind, CONUS_KIND_UNASSIGNED);
    assert_near(conus_selection_result(track.selection, 1)->share, 1, 1e-12);
    for (int i = 12; i < 60; i++) {
        step(&track, i / 10.0, AT_NOTHING, false);
    }
    assert_null(find(&track, BALL));
    assert_int_equal(conus_selection_step(track.selection)->selected, 0);
    close_track(&track);
}

/* A row is there also with a score that has no history: otherwise a press could confirm an object without a row. */
static void what_could_be_confirmed_has_a_row(void **state)
{
    (void)state;
    struct track track = open_track(NULL, 0, NULL);
    step(&track, 0, AT_BALL, false);
    step(&track, 0.5, AT_ARM, true);
    assert_int_equal(conus_selection_step(track.selection)->selected, ARM);
    assert_int_equal(conus_selection_step(track.selection)->confirmed, BALL);
    assert_non_null(find(&track, BALL));
    assert_near(find(&track, BALL)->score, 0, 0);
    step(&track, 0.65, AT_ARM, true);
    assert_non_null(find(&track, BALL)); /* it was selected up to 0.5 */
    step(&track, 0.66, AT_ARM, true);
    assert_null(find(&track, BALL));
    close_track(&track);
}

static void a_press_confirms_what_was_selected_before_it(void **state)
{
    (void)state;
    struct track track = open_track("share", 0, &(conus_tracker_options){.delay = 0.1});
    step(&track, 10.00, AT_BALL, false);
    step(&track, 10.10, AT_BALL, false);
    assert_int_equal(step(&track, 10.15, AT_ARM, true)->confirmed, BALL); /* at 10.05 */
    assert_int_equal(step(&track, 10.20, AT_ARM, true)->confirmed, 0);    /* still held down */
    assert_int_equal(step(&track, 10.30, AT_ARM, false)->confirmed, 0);
    assert_int_equal(step(&track, 10.40, AT_BALL, true)->confirmed, ARM);
    step(&track, 10.45, AT_BALL, false);
    assert_int_equal(step(&track, 10.50, AT_ARM, true)->confirmed, BALL); /* exactly at 10.40, where it changed */
    close_track(&track);
    track = open_track("share", 0, &(conus_tracker_options){.delay = -1});
    step(&track, 0, AT_BALL, false);
    assert_int_equal(step(&track, 0.2, AT_ARM, true)->confirmed, ARM);
    close_track(&track);
    track = open_track("share", 0, NULL); /* pressed before there is a past: the oldest that is known */
    step(&track, 0, AT_BALL, false);
    assert_int_equal(step(&track, 0.1, AT_ARM, true)->confirmed, BALL);
    close_track(&track);
}

static void refuse(struct track *track, double time, const char *message)
{
    const conus_selection *before = track->selection;
    assert_fails(try_step(track, time, AT_ARM, true), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), message));
    assert_ptr_equal(track->selection, before);
}

static void refuse_pose(struct track *track, double time)
{
    conus_pose pose = {.world_from_device = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, NAN, 0, 1}};
    conus_selection *selection = NULL;
    assert_fails(conus_tracker_step(&selection, track->tracker, time, &pose, degrees_from_radians(1), true),
                 CONUS_ERROR_ARGUMENT);
    pose.world_from_device[13] = 0;
    assert_fails(conus_tracker_step(&selection, track->tracker, time, &pose, degrees_from_radians(4), true),
                 CONUS_ERROR_ARGUMENT);
    assert_null(selection);
}

/* Refused steps change nothing: the track is the same as without them. */
static void bad_steps_leave_no_trace(void **state)
{
    (void)state;
    struct track clean = open_track("intenselect", 0, NULL);
    struct track dirty = open_track("intenselect", 0, NULL);
    for (int i = 0; i < 40; i++) {
        double x = 25 * sin(i * 0.3);
        bool trigger = i % 10 == 9;
        step(&clean, i * 0.02, x, trigger);
        step(&dirty, i * 0.02, x, trigger);
        refuse_pose(&dirty, i * 0.02 + 0.01);
        if (i) {
            refuse(&dirty, i * 0.02 - 0.01, "is before the last step");
        }
        refuse(&dirty, NAN, "time_s: nan, allowed are finite numbers");
        refuse(&dirty, INFINITY, "time_s: inf");
        assert_near(score_of(&dirty, BALL), score_of(&clean, BALL), 0);
        assert_near(score_of(&dirty, ARM), score_of(&clean, ARM), 0);
        assert_int_equal(conus_selection_step(dirty.selection)->confirmed,
                         conus_selection_step(clean.selection)->confirmed);
    }
    close_track(&clean);
    close_track(&dirty);
}

static void the_later_of_two_steps_at_one_time_counts(void **state)
{
    (void)state;
    struct track track = open_track("intenselect_plus", 0, NULL);
    for (int i = 0; i <= 10; i++) {
        step(&track, i / 10.0, AT_BALL, false);
    }
    double before = score_of(&track, BALL);
    step(&track, 1, AT_ARM, false);
    assert_near(score_of(&track, BALL), before, 0);
    assert_near(score_of(&track, ARM), 0, 0);
    step(&track, 1.1, AT_ARM, false);
    double steep = score_of(&track, ARM); /* as if the object had been there since 1 */
    close_track(&track);
    track = open_track("intenselect_plus", 0, NULL);
    step(&track, 1, AT_ARM, false);
    step(&track, 1.1, AT_ARM, false);
    assert_near(score_of(&track, ARM), steep, 1e-12);
    close_track(&track);
}

static void a_long_gap_starts_afresh(void **state)
{
    (void)state;
    struct track track = open_track("intenselect_plus", 0, &(conus_tracker_options){.window = 1});
    for (int i = 0; i <= 10; i++) {
        step(&track, i / 10.0, AT_BALL, false);
    }
    step(&track, 2.5, AT_ARM, true);
    assert_null(find(&track, BALL));
    assert_near(score_of(&track, ARM), 0, 0);
    assert_int_equal(conus_selection_step(track.selection)->selected, ARM);
    assert_int_equal(conus_selection_step(track.selection)->confirmed, ARM); /* nothing older is known */
    close_track(&track);
}

static void options_have_ranges(void **state)
{
    (void)state;
    struct track track = open_track("time", 0, NULL);
    static const struct {
        conus_tracker_options options;
        const char *message;
    } bad[] = {
        {{.window = -1}, "window: -1, allowed is more than 0"},
        {{.window = NAN}, "window: nan"},
        {{.stickiness = 1}, "stickiness: 1, allowed is more than 0 and less than 1"},
        {{.stickiness = -0.5}, "stickiness: -0.5"},
        {{.snappiness = 2}, "snappiness: 2, allowed is more than 0 and at most 1"},
        {{.rate = -60}, "rate: -60"},
        {{.growth = INFINITY}, "growth: inf"},
        {{.decay = -1}, "decay: -1"},
        {{.exponent = 1.5}, "exponent: 1.5, allowed is more than 0 and at most 1"},
        {{.delay = 3}, "delay: 3 s, allowed is at most the window, 2 s"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        conus_tracker *tracker = NULL;
        assert_fails(conus_tracker_create(&tracker, track.selector, &bad[i].options), CONUS_ERROR_ARGUMENT);
        assert_non_null(strstr(conus_message(), bad[i].message));
        assert_null(tracker);
    }
    close_track(&track);
    conus_tracker_destroy(NULL);
    assert_int_equal(conus_tracker_selected(NULL, 0), 0);
    assert_null(conus_selection_step(NULL));
}

enum { CHECKS = 4 };

/* The scores of arm and ball at every half second, during a sweep to and fro. A contribution changes by at least 2 / n
 * of its range, so n is larger than in normal use. */
static void sweep(double scores[CHECKS][2], const char *score, uint32_t resolution, double rate, bool drop_frames)
{
    struct track track = open_track(score, resolution, &(conus_tracker_options){.exponent = 1});
    track.degrees = 6;
    uint64_t seed = 8;
    int per_check = (int)(rate / 2);
    for (int i = 0; i <= CHECKS * per_check; i++) {
        double time = i / rate;
        bool is_check = i && i % per_check == 0;
        if (!drop_frames || is_check || test_random(&seed, 0, 1) < 0.6) {
            step(&track, time, 7 - 10 * cos(2 * MATH3_PI * 0.4 * time), false);
        }
        if (is_check) {
            scores[i / per_check - 1][0] = score_of(&track, ARM);
            scores[i / per_check - 1][1] = score_of(&track, BALL);
        }
    }
    close_track(&track);
}

static void assert_same_scores(double got[CHECKS][2], double wanted[CHECKS][2])
{
    for (int i = 0; i < CHECKS; i++) {
        assert_near(got[i][0], wanted[i][0], 0.01);
        assert_near(got[i][1], wanted[i][1], 0.01);
    }
}

/* 30, 90 and 1000 Hz, and two frames in five lost: within 1 % of the scores' range. */
static void every_rate_gives_the_same_scores(void **state)
{
    (void)state;
    static const struct {
        const char *score;
        uint32_t resolution;
    } runs[] = {{"stability", 16}, {"time", 16}, {"intenselect_plus", 64}, {"intenselect", 128}};
    for (size_t i = 0; i < test_trials(sizeof runs / sizeof runs[0]); i++) {
        double wanted[CHECKS][2];
        double got[CHECKS][2];
        double largest = 0;
        sweep(wanted, runs[i].score, runs[i].resolution, 1000, false);
        sweep(got, runs[i].score, runs[i].resolution, 90, false);
        assert_same_scores(got, wanted);
        sweep(got, runs[i].score, runs[i].resolution, 30, false);
        assert_same_scores(got, wanted);
        sweep(got, runs[i].score, runs[i].resolution, 200, true);
        assert_same_scores(got, wanted);
        for (int k = 0; k < CHECKS; k++) {
            largest = fmax(largest, wanted[k][1]);
        }
        assert_true(largest > 0.5);
    }
}

static void senseshapes_are_from_0_to_1(void **state)
{
    (void)state;
    static const char *const scores[] = {"time", "stability", "0.5*time + 0.5*stability"};
    uint64_t seed = 17;
    for (size_t s = 0; s < sizeof scores / sizeof scores[0]; s++) {
        struct track track = open_track(scores[s], 0, &(conus_tracker_options){.window = 0.5});
        double time = -3;
        for (int i = 0; i < 400; i++) {
            time += test_random(&seed, 0, 1) < 0.02 ? test_random(&seed, 0, 1) : test_random(&seed, 0, 0.02);
            step(&track, time, test_random(&seed, -30, 30), false);
            for (size_t r = 0; r + 1 < conus_selection_count(track.selection); r++) {
                double score = conus_selection_result(track.selection, r)->score;
                assert_true(score >= 0 && score <= 1);
            }
        }
        close_track(&track);
    }
}

static conus_status follow(void *data)
{
    struct track *track = data;
    conus_tracker *tracker = NULL;
    conus_report *report = NULL;
    const conus_report_options options = {.format = "tsv"};
    conus_status status = conus_tracker_create(&tracker, track->selector, NULL);
    conus_report_options of_tracker = options;
    of_tracker.tracker = tracker;
    status = status ? status : conus_report_create(&report, track->selector, &of_tracker);
    for (int i = 0; !status && i < 12; i++) {
        conus_selection *selection = NULL;
        conus_pose pose;
        const char *text;
        size_t size;
        (void)!conus_pose_along(&pose, (double[]){20 * sin(i), 0, 150}, (double[]){0, 0, -1}, NULL);
        status = conus_tracker_step(&selection, tracker, i * 0.1, &pose, degrees_from_radians(0.1), i == 5);
        status = status ? status : conus_report_add(report, "1", selection);
        status = status ? status : conus_report_take(&text, &size, report);
        conus_selection_destroy(selection);
    }
    conus_report_destroy(report);
    conus_tracker_destroy(tracker);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    struct track track = open_track("intenselect+smallest", 0, NULL);
    test_every_allocation(follow, &track);
    close_track(&track);
}

/* A step that failed for lack of memory can be repeated, and gives the same answer. */
static void a_step_without_memory_changes_nothing(void **state)
{
    (void)state;
    struct track clean = open_track("intenselect_plus", 0, NULL);
    struct track poor = open_track("intenselect_plus", 0, NULL);
    for (int i = 0; i < 20; i++) {
        double x = i % 4 < 2 ? AT_BALL : AT_ARM;
        step(&clean, i * 0.05, x, false);
        for (long n = 0; n < 12; n += 1 + i % 2) {
            test_fail_allocation(n);
            conus_status status = try_step(&poor, i * 0.05, x, false);
            bool failed = test_allocation_failed();
            test_fail_allocation(-1);
            if (!status) {
                break;
            }
            assert_true(failed);
            assert_int_equal(status, CONUS_ERROR_MEMORY);
        }
        step(&poor, i * 0.05, x, false);
        assert_near(score_of(&poor, BALL), score_of(&clean, BALL), 0);
        assert_near(score_of(&poor, ARM), score_of(&clean, ARM), 0);
    }
    close_track(&clean);
    close_track(&poor);
}

static void steps_are_reported_as_they_come(void **state)
{
    (void)state;
    struct track track = open_track("share", 0, NULL);
    conus_report *report = NULL;
    const char *text;
    size_t size;
    const conus_report_options options = {.format = "tsv", .tracker = track.tracker, .selected_only = true};
    assert_ok(conus_report_create(&report, track.selector, &options));
    step(&track, 1700000000.125, AT_BALL, false);
    assert_ok(conus_report_add(report, "a", track.selection));
    assert_ok(conus_report_take(&text, &size, report));
    assert_int_equal(strncmp(text, "query\tkind\t", 11), 0);
    assert_non_null(strstr(text, "\tcontact_value\ttime_s\tselected\tconfirmed\na\tarea\t2\t"));
    assert_non_null(strstr(text, "\t1700000000.125\t1\t0\n"));
    assert_null(strstr(text, "unassigned"));
    step(&track, 1700000000.5, AT_ARM, true);
    assert_ok(conus_report_add(report, "b", track.selection));
    assert_ok(conus_report_take(&text, &size, report));
    assert_int_equal(strncmp(text, "b\tarea\t1\t", 9), 0); /* no header again, and a is not there any more */
    assert_non_null(strstr(text, "\t1700000000.5\t1\t0\nb\tarea\t2\t"));
    assert_non_null(strstr(text, "\t1700000000.5\t0\t1\n"));
    assert_ok(conus_report_take(&text, &size, report));
    assert_int_equal(size, 0);
    assert_ok(conus_report_sidecar(&text, &size, report));
    assert_non_null(strstr(text, "\"score\": \"share\""));
    assert_non_null(strstr(text, "\"window_s\": 2.0"));
    assert_non_null(strstr(text, "\"delay_s\": 0.15"));
    conus_report_destroy(report);
    close_track(&track);
}

TEST_GROUP(tracker)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_row_is_a_beginning),
        cmocka_unit_test(a_moment_ago_is_not_missed_by_rounding),
        cmocka_unit_test(nothing_in_the_cone_is_nothing_selected),
        cmocka_unit_test(what_left_stays_until_its_score_is_gone),
        cmocka_unit_test(what_could_be_confirmed_has_a_row),
        cmocka_unit_test(a_press_confirms_what_was_selected_before_it),
        cmocka_unit_test(bad_steps_leave_no_trace),
        cmocka_unit_test(the_later_of_two_steps_at_one_time_counts),
        cmocka_unit_test(a_long_gap_starts_afresh),
        cmocka_unit_test(options_have_ranges),
        cmocka_unit_test(every_rate_gives_the_same_scores),
        cmocka_unit_test(senseshapes_are_from_0_to_1),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(a_step_without_memory_changes_nothing),
        cmocka_unit_test(steps_are_reported_as_they_come),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
