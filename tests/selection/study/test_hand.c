/* SPDX-License-Identifier: BSD-3-Clause */
/* A trembling hand that presses a button (Eq. 12): the value of a history, and of looking back at the press.
 * docs/model.md has the same figures. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/text.h"
#include "conus/own.h"
#include "test.h"
#include "tests/support/hand.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TRIALS = 200 };

/* Frequencies need all trials. */
static void need_all_trials(void)
{
    if (test_trials(TRIALS) < TRIALS) {
        skip();
    }
}

struct fixture {
    conus_atlas *atlas;
    struct hand_outcome outcome;
    struct buffer record;
};

static int set_up(void **state)
{
    static struct fixture fixture;
    FILE *there = fopen("/usr/share/mricron/templates/aal.nii.gz", "rb");
    fixture = (struct fixture){0};
    *state = &fixture;
    if (!there) {
        return 0;
    }
    fclose(there);
    assert_ok(conus_atlas_load(&fixture.atlas, "/usr/share/mricron/templates/aal.nii.gz", NULL));
    assert_ok(hand_run(&fixture.outcome, fixture.atlas, test_trials(TRIALS), test_random, &fixture.record));
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    buffer_finish(&fixture->record);
    conus_atlas_destroy(fixture->atlas);
    return 0;
}

static size_t method_called(const char *name)
{
    for (size_t i = 0; i < HAND_METHODS; i++) {
        if (!strcmp(hand_methods[i].name, name)) {
            return i;
        }
    }
    fail_msg("no method %s", name);
    return 0;
}

static size_t hits_of(const struct fixture *fixture, const char *name)
{
    return fixture->outcome.hits[method_called(name)];
}

static void histories_find_what_is_meant_more_often_than_a_ray(void **state)
{
    const struct fixture *fixture = *state;
    (void)test_mricron("aal.nii.gz"); /* or skip */
    need_all_trials();
    size_t ray = hits_of(fixture, "ray");
    size_t ray_before = hits_of(fixture, "ray, 0.15 s before");
    assert_true(hits_of(fixture, "intenselect") > ray + TRIALS / 10);
    assert_true(hits_of(fixture, "intenselect_plus") > hits_of(fixture, "intenselect") + TRIALS / 20);
    assert_true(ray_before > ray + TRIALS / 10);
    assert_true(hits_of(fixture, "intenselect, 0.15 s before") > ray_before);
    assert_true(hits_of(fixture, "intenselect_plus, 0.15 s before") > ray_before);
    size_t still = fixture->outcome.changes[method_called("intenselect_plus")];
    assert_true(4 * fixture->outcome.changes[method_called("intenselect")] < fixture->outcome.changes[0]);
    assert_true(2 * still < 3 * fixture->outcome.changes[method_called("intenselect")]);
}

/* The number before `unit` in the table's row of the method. */
static double figure_in_docs(const char *page, const char *name, int column)
{
    const char *table = strstr(page, "### A trembling hand");
    assert_non_null(table);
    struct text rest = text_from(table);
    struct text line;
    char start[64];
    snprintf(start, sizeof start, "| %s |", name);
    while (text_line(&rest, &line)) {
        struct text field = {0};
        bool more = true;
        double number = NAN;
        if (text_starts(line, start)) {
            for (int i = 0; i <= column; i++) {
                assert_true(text_field(&line, '|', &more, &field));
            }
            assert_true(text_word(&field, &line) && text_to_double(line, &number));
            return number;
        }
    }
    fail_msg("docs/model.md has no row \"%s\"", start);
    return 0;
}

/* The figures are equal to the last digit, but for a borderline trial that another libm may decide otherwise. */
static void the_documents_say_so(void **state)
{
    const struct fixture *fixture = *state;
    (void)test_mricron("aal.nii.gz");
    need_all_trials();
    struct bytes bytes = {0};
    assert_ok(file_read(&bytes, CONUS_SOURCE_DIR "/docs/model.md", 1 << 20));
    char *page = calloc(bytes.size + 1, 1);
    memcpy(page, bytes.data, bytes.size);
    for (size_t i = 0; i < HAND_METHODS; i++) {
        const char *name = hand_methods[i].name;
        assert_near(figure_in_docs(page, name, 2), 100.0 * (double)fixture->outcome.hits[i] / TRIALS, 1.01);
        assert_near(figure_in_docs(page, name, 3), (double)fixture->outcome.changes[i] / fixture->outcome.seconds, 0.1);
    }
    free(page);
    bytes_finish(&bytes);
}

/* The poses read back from a file, with digits cut off, lead to the same. */
static void the_record_can_be_followed(void **state)
{
    const struct fixture *fixture = *state;
    (void)test_mricron("aal.nii.gz");
    const char *path = test_scratch("hand.tsv");
    conus_pose_list *poses = NULL;
    conus_selector *selector = NULL;
    conus_tracker *tracker = NULL;
    size_t presses = 0;
    assert_ok(buffer_status(&fixture->record));
    assert_ok(conus_write_file(path, fixture->record.data, fixture->record.size));
    assert_ok(conus_pose_list_load(&poses, path, NULL));
    assert_ok(conus_selector_create(&selector, fixture->atlas, &(conus_selector_options){.score = "intenselect"}));
    assert_ok(conus_tracker_create(&tracker, selector, NULL));
    for (size_t i = 0; i < conus_pose_list_count(poses); i++) {
        const conus_pose_row *row = conus_pose_list_row(poses, i);
        conus_selection *selection = NULL;
        assert_null(row->error);
        if (row->time_s > 10 * 20) {
            break;
        }
        assert_ok(conus_tracker_step(&selection, tracker, row->time_s, &row->pose, 10, row->trigger));
        presses += conus_selection_step(selection)->confirmed != 0;
        conus_selection_destroy(selection);
    }
    assert_int_equal(presses, 20);
    conus_tracker_destroy(tracker);
    conus_selector_destroy(selector);
    conus_pose_list_destroy(poses);
}

enum { CHECKS = 40, OBJECTS = 117 };

/* Scores during a quick sweep over the left hemisphere, ten times a second for four seconds; 0 if there is none. */
static void sweep(double scores[CHECKS][OBJECTS], const conus_atlas *atlas, const char *score, int rate)
{
    conus_selector *selector = NULL;
    conus_tracker *tracker = NULL;
    memset(scores, 0, CHECKS * sizeof *scores);
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.score = score}));
    assert_ok(conus_tracker_create(&tracker, selector, NULL));
    for (int i = 0; i <= 4 * rate; i++) {
        double t = (double)i / rate;
        const double target[3] = {0, 40 * sin(2 * MATH3_PI * 0.3 * t) + 8 * sin(2 * MATH3_PI * 1.3 * t),
                                  30 * cos(2 * MATH3_PI * 0.23 * t)};
        conus_pose pose;
        conus_selection *selection = NULL;
        assert_ok(conus_pose_toward(&pose, (double[]){-400, 0, 0}, target, NULL));
        assert_ok(conus_tracker_step(&selection, tracker, t, &pose, 10, false));
        for (size_t r = 0; i && i % (rate / 10) == 0 && r + 1 < conus_selection_count(selection); r++) {
            const conus_result *result = conus_selection_result(selection, r);
            scores[i / (rate / 10) - 1][result->object] = result->score;
        }
        conus_selection_destroy(selection);
    }
    conus_tracker_destroy(tracker);
    conus_selector_destroy(selector);
}

/* Root mean square over the entries that either of them has. */
static double difference(double a[CHECKS][OBJECTS], double b[CHECKS][OBJECTS])
{
    double sum = 0;
    size_t count = 0;
    for (int i = 0; i < CHECKS; i++) {
        for (int k = 0; k < OBJECTS; k++) {
            double d = a[i][k] - b[i][k];
            sum += d * d;
            count += a[i][k] != 0 || b[i][k] != 0;
        }
    }
    return sqrt(sum / (double)count);
}

/* Areas appear from behind others, and contributions jump by pixels: a filter cannot know what happens between two
 * frames. The limits are a little above the figures of docs/model.md. */
static void rates_differ_by_what_happens_between_frames(void **state)
{
    const struct fixture *fixture = *state;
    (void)test_mricron("aal.nii.gz");
    static const struct {
        const char *score;
        double at_30, at_90;
    } limits[] = {
        {"intenselect", 0.05, 0.02}, {"intenselect_plus", 0.02, 0.01}, {"time", 0.02, 0.01}, {"stability", 0.3, 0.1}};
    static double wanted[CHECKS][OBJECTS];
    static double got[CHECKS][OBJECTS];
    assert_true(conus_atlas_object_count(fixture->atlas) < OBJECTS);
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
        sweep(wanted, fixture->atlas, limits[i].score, 1000);
        sweep(got, fixture->atlas, limits[i].score, 30);
        assert_true(difference(got, wanted) < limits[i].at_30);
        sweep(got, fixture->atlas, limits[i].score, 90);
        assert_true(difference(got, wanted) < limits[i].at_90);
    }
}

TEST_GROUP(hand)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(histories_find_what_is_meant_more_often_than_a_ray),
        cmocka_unit_test(the_documents_say_so),
        cmocka_unit_test(the_record_can_be_followed),
        cmocka_unit_test(rates_differ_by_what_happens_between_frames),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
