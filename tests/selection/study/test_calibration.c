/* SPDX-License-Identifier: BSD-3-Clause */
/* Quantiles of calibration (Eq. 34) by published tables, errors of single trials, and no memory.
 * tests/python/test_calibrate.py has an oracle by scipy. */
#include "atlas/phantom/phantom.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "selection/study/study.h"
#include "test.h"

#include <math.h>
#include <string.h>

/* NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2 and 1.3.6.7.4. */
static void quantiles_are_those_of_tables(void **state)
{
    (void)state;
    static const struct {
        size_t degrees;
        double lower, upper;
    } chi[] = {{1, 0.001, 5.024}, {2, 0.051, 7.378}, {9, 2.700, 19.023}, {30, 16.791, 46.979}, {100, 74.222, 129.561}};
    static const struct {
        size_t degrees;
        double upper;
    } t[] = {{2, 4.303}, {8, 2.306}, {20, 2.086}, {100, 1.984}};
    for (size_t i = 0; i < sizeof chi / sizeof *chi; i++) {
        assert_near(quantile_chi_squared(0.025, chi[i].degrees), chi[i].lower, 6e-4);
        assert_near(quantile_chi_squared(0.975, chi[i].degrees), chi[i].upper, 6e-4);
    }
    for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
        assert_near(quantile_t(0.975, t[i].degrees), t[i].upper, 6e-4);
    }
    assert_near(quantile_t(0.975, 20000000), NORMAL_975, 1e-6);
}

enum { TRIALS = 5 };

/* Devices that look down -z from the origin, with +y up, at points so many degrees to the right and up of the axis. */
static void make_trials(conus_trial trials[TRIALS])
{
    static const double off[TRIALS][2] = {{1, 0}, {3, 0}, {2, 1}, {2, -1}, {2, 0}};
    for (size_t i = 0; i < TRIALS; i++) {
        const double angle = hypot(off[i][0], off[i][1]) * acos(-1) / 180;
        const double across = sin(angle) / hypot(off[i][0], off[i][1]);
        trials[i] = (conus_trial){.pose = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
                                  .aim = {100 * across * off[i][0], 100 * across * off[i][1], -100 * cos(angle)},
                                  .angle = 10,
                                  .range = {NAN, NAN},
                                  .meant = 1};
    }
}

/* The axis points to the left of what lies to its right. */
static void errors_are_of_the_axis(void **state)
{
    (void)state;
    conus_trial trials[TRIALS];
    conus_table *table = NULL;
    make_trials(trials);
    assert_ok(conus_calibrate(&table, trials, TRIALS));
    const double *value = conus_table_numbers(table, "value");
    assert_string_equal(conus_table_texts(table, "parameter")[0], "bias_x");
    assert_near(value[0], -2, 1e-12);
    assert_near(value[1], 0, 1e-12);
    assert_near(value[2], sqrt(4.0 / 8), 1e-12); /* Σ |e - b|² = 4, ν = 8 */
    assert_near(value[3], sqrt(2.0 / 4), 1e-12);
    assert_near(value[5], 5, 1e-9); /* S = 0.4 I, q = 1 / 0.4 of four of five */
    assert_near(value[6], 0, 1e-12);
    conus_table_destroy(table);
    for (size_t i = 0; i < TRIALS; i++) {
        trials[i].aim[1] = 0; /* on a line */
    }
    assert_ok(conus_calibrate(&table, trials, TRIALS));
    assert_true(isnan(conus_table_numbers(table, "value")[5]) && isnan(conus_table_numbers(table, "p")[6]));
    conus_table_destroy(table);
    assert_fails(conus_calibrate(&table, trials, TRIALS - 1), CONUS_ERROR_DATA);
}

/* The last trial aims at nothing, at the device itself, and behind it; then all trials are one. */
static void trials_that_tell_no_error_are_refused(void **state)
{
    (void)state;
    static const char *const why[] = {
        "trial 5: no point that was aimed at: ", "trial 5: the device is where it was aimed at: ",
        "trial 5: the device points 90 degrees or more away from what was aimed at: ",
        "all 5 trials are off alike: no spread can be found"};
    conus_trial trials[TRIALS];
    conus_table *table = NULL;
    for (size_t i = 0; i < 4; i++) {
        make_trials(trials);
        conus_trial *last = &trials[TRIALS - 1];
        const double *m = last->pose.world_from_device; /* its position is the last column, its axis -z */
        for (int a = 0; a < 3; a++) {
            last->aim[a] = i == 0 ? NAN : m[12 + a] + (i == 2 ? 10 * m[8 + a] : 0);
        }
        for (size_t k = 0; k < TRIALS && i == 3; k++) {
            trials[k] = trials[0];
        }
        assert_fails(conus_calibrate(&table, trials, TRIALS), CONUS_ERROR_DATA);
        assert_int_equal(strncmp(conus_message(), why[i], strlen(why[i])), 0);
        assert_null(table);
    }
}

static conus_status calibrate(void *data)
{
    conus_trial trials[TRIALS];
    conus_table *table = NULL;
    make_trials(trials);
    (void)data;
    conus_status status = conus_calibrate(&table, trials, TRIALS);
    conus_table_destroy(table);
    return status;
}

static conus_status ask(void *atlas)
{
    conus_trial trials[TRIALS];
    conus_table *table = NULL;
    conus_weight *weight = NULL;
    conus_selector *selector = NULL;
    make_trials(trials);
    conus_status status = conus_weight_create(&weight, "gauss=1");
    const conus_selector_options options = {.weight = weight, .prior = "equal", .resolution = 16};
    status = status ? status : conus_selector_create(&selector, atlas, &options);
    status = status ? status : conus_reliability(&table, selector, trials, TRIALS, NULL, NULL);
    conus_table_destroy(table);
    conus_selector_destroy(selector);
    conus_weight_destroy(weight);
    return status;
}

static bool stop(void *user, size_t done, size_t total)
{
    (void)user;
    return done < total / 2;
}

static void studies_end_cleanly(void **state)
{
    (void)state;
    struct phantom_drawing drawing = {0};
    conus_atlas *atlas = NULL;
    conus_selector *selector = NULL;
    conus_table *table = NULL;
    conus_trial trials[TRIALS];
    assert_ok(phantom_draw(&drawing, "u-shape", &(conus_phantom_options){0}));
    assert_ok(phantom_drawing_atlas(&atlas, &drawing));
    phantom_drawing_finish(&drawing);
    assert_ok(calibrate(NULL));
    assert_ok(ask(atlas));
    test_every_allocation(calibrate, NULL);
    test_every_allocation(ask, atlas);
    make_trials(trials);
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_fails(conus_reliability(&table, selector, trials, TRIALS, NULL, NULL), CONUS_ERROR_ARGUMENT);
    conus_selector_destroy(selector);
    conus_weight *weight = NULL;
    assert_ok(conus_weight_create(&weight, "gauss=1"));
    const conus_selector_options options = {.weight = weight, .prior = "equal", .resolution = 16};
    assert_ok(conus_selector_create(&selector, atlas, &options));
    assert_fails(conus_reliability(&table, selector, trials, TRIALS, stop, NULL), CONUS_ERROR_CANCELLED);
    assert_null(table);
    conus_selector_destroy(selector);
    conus_weight_destroy(weight);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(calibration)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantiles_are_those_of_tables),
        cmocka_unit_test(errors_are_of_the_axis),
        cmocka_unit_test(trials_that_tell_no_error_are_refused),
        cmocka_unit_test(studies_end_cleanly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
