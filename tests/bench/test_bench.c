/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the code that the scenarios of conus-bench share: which runs count, when a ratio is null, and that one
 * failing scenario leaves the others alone. No time is asserted. */
#include "bench/all.h"
#include "test.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <unistd.h>

static struct bench make_bench(void)
{
    return (struct bench){.options = {.atlas = "a", .context = "c", .angle = 5, .poses = 2, .repeats = 3},
                          .folder = "/tmp",
                          .runs = json_array(),
                          .ratios = json_object(),
                          .left_out = json_object()};
}

static void finish_bench(struct bench *bench)
{
    json_decref(bench->runs);
    json_decref(bench->ratios);
    json_decref(bench->left_out);
}

struct counts {
    int prepared, run;
};

static void prepare(void *data)
{
    ((struct counts *)data)->prepared++;
}

static void run_variant(void *data)
{
    ((struct counts *)data)->run++;
}

static const json_t *run_at(const struct bench *bench, size_t index, const char *key)
{
    return json_object_get(json_array_get(bench->runs, index), key);
}

static void every_round_runs_all_cold_and_warm(void **state)
{
    (void)state;
    struct bench bench = make_bench();
    struct counts counts[2] = {{0}};
    struct bench_variant variants[] = {
        {.name = "one", .run = run_variant, .data = &counts[0], .prepare = prepare, .equal = true, .per = 7},
        {.name = "two", .run = run_variant, .data = &counts[1], .more = json_pack("{s:i}", "wrong", 4)}};
    assert_ok(bench_measure(&bench, "test", variants, 2, 5, 20));
    for (int v = 0; v < 2; v++) {
        assert_int_equal(counts[v].run, 3 * (1 + 3));
        assert_true(variants[v].min_ms <= variants[v].median_ms && variants[v].median_ms <= variants[v].p90_ms);
        assert_true(variants[v].cold_ms >= 0);
        assert_int_equal(json_integer_value(run_at(&bench, (size_t)v, "repeats")), 3);
        assert_string_equal(json_string_value(run_at(&bench, (size_t)v, "variant")), variants[v].name);
        assert_true(json_number_value(run_at(&bench, (size_t)v, "angle_deg")) == 20);
    }
    assert_int_equal(counts[0].prepared, 3 * (1 + 3));
    assert_int_equal(json_integer_value(run_at(&bench, 0, "count")), 7);
    assert_int_equal(json_integer_value(run_at(&bench, 1, "count")), 5);
    assert_int_equal(json_integer_value(run_at(&bench, 1, "wrong")), 4);
    assert_true(json_is_true(run_at(&bench, 0, "equal")) && json_is_false(run_at(&bench, 1, "equal")));
    finish_bench(&bench);
}

static void take_long(void *data)
{
    ((struct counts *)data)->run++;
    usleep(300000);
}

static void long_runs_count_at_once_and_time_ends_rounds(void **state)
{
    (void)state;
    struct bench bench = make_bench();
    struct counts counts = {0};
    struct bench_variant variant = {.name = "long", .run = take_long, .data = &counts, .equal = true};
    bench.options.seconds = 0.1;
    assert_ok(bench_measure(&bench, "test", &variant, 1, 1, 0));
    assert_int_equal(counts.run, 1);
    assert_true(isnan(variant.cold_ms));
    assert_true(json_is_null(run_at(&bench, 0, "cold_ms")));
    assert_int_equal(json_integer_value(run_at(&bench, 0, "repeats")), 1);
    finish_bench(&bench);
}

static void a_ratio_of_different_answers_is_null_and_says_why(void **state)
{
    (void)state;
    struct bench bench = make_bench();
    const struct bench_variant slow = {.name = "slow", .equal = true, .median_ms = 6};
    const struct bench_variant fast = {.name = "fast", .equal = true, .median_ms = 2};
    struct bench_variant wrong = fast;
    wrong.equal = false;
    assert_ok(bench_ratio(&bench, "good", &slow, &fast));
    assert_ok(bench_ratio(&bench, "bad", &slow, &wrong));
    assert_ok(bench_value(&bench, "none", (double)NAN, true));
    assert_true(json_number_value(json_object_get(bench.ratios, "good")) == 3);
    assert_true(json_is_null(json_object_get(bench.ratios, "bad")));
    assert_string_equal(json_string_value(json_object_get(bench.ratios, "bad_null_because")), "the answers differ");
    assert_true(json_is_null(json_object_get(bench.ratios, "none")));
    assert_null(json_object_get(bench.ratios, "good_null_because"));
    finish_bench(&bench);
}

static size_t faults(const struct bench *bench)
{
    json_t *settings = json_object();
    json_t *root = report_create(bench, settings, 0.5);
    assert_non_null(root);
    size_t count = report_check(root);
    json_decref(root);
    json_decref(settings);
    return count;
}

static void a_check_finds_what_differs_and_what_is_null(void **state)
{
    (void)state;
    struct bench bench = make_bench();
    struct counts counts = {0};
    struct bench_variant variants[] = {
        {.name = "one", .run = run_variant, .data = &counts, .equal = true},
        {.name = "slices", .run = run_variant, .data = &counts, .other_by_design = true},
        {.name = "wrong", .run = run_variant, .data = &counts},
    };
    assert_int_equal(faults(&bench), 1); /* nothing was run */
    assert_ok(bench_measure(&bench, "test", variants, 2, 1, 0));
    assert_ok(bench_ratio(&bench, "good", &variants[0], &variants[0]));
    assert_int_equal(faults(&bench), 0);
    assert_ok(bench_measure(&bench, "test", variants, 3, 1, 0));
    assert_int_equal(faults(&bench), 1);
    assert_ok(bench_ratio(&bench, "bad", &variants[0], &variants[2]));
    assert_int_equal(faults(&bench), 2);
    finish_bench(&bench);
}

static void ratios_are_compared_with_their_bounds(void **state)
{
    (void)state;
    struct bench bench = make_bench();
    json_t *settings = json_object();
    assert_ok(bench_value(&bench, "naive_over_gl", 48.7, true));
    assert_ok(bench_value(&bench, "id_over_colour_gl", 0.01, true));
    assert_ok(bench_value(&bench, "naive_over_rays", 1000, false));
    json_t *root = report_create(&bench, settings, 0.5);
    const json_t *holds = json_object_get(root, "holds");
    assert_int_equal(json_object_size(holds), 3);
    assert_true(json_is_true(json_object_get(json_object_get(holds, "naive_over_gl"), "met")));
    assert_true(json_is_false(json_object_get(json_object_get(holds, "id_over_colour_gl"), "met")));
    assert_true(json_is_false(json_object_get(json_object_get(holds, "naive_over_rays"), "met"))); /* null */
    report_print_holds(root);
    json_decref(root);
    json_decref(settings);
    finish_bench(&bench);
}

static conus_status measure_one(struct bench *bench)
{
    struct counts counts = {0};
    struct bench_variant variant = {.name = "one", .run = run_variant, .data = &counts, .equal = true};
    bench->one_thread = true;
    snprintf(bench->driver, sizeof bench->driver, "rays, test; gl, test");
    conus_status status = bench_measure(bench, "good", &variant, 1, bench->options.poses, 0);
    return status ? status : bench_value(bench, "value", (double)bench->options.poses, true);
}

static conus_status refuse(struct bench *bench)
{
    (void)bench;
    return fail(CONUS_ERROR_DATA, "no such thing");
}

static conus_status crash(struct bench *bench)
{
    (void)bench;
    raise(SIGKILL);
    return CONUS_OK;
}

static conus_status leave_a_part_out(struct bench *bench)
{
    (void)fail(CONUS_ERROR_GL, "no GL");
    return bench_leave_out(bench, "a part");
}

static void scenarios_do_not_affect_each_other(void **state)
{
    (void)state;
    static const struct bench_scenario scenarios[] = {{.name = "refuses", .run = refuse},
                                                      {.name = "crashes", .run = crash},
                                                      {.name = "partly", .run = leave_a_part_out},
                                                      {.name = "good", .run = measure_one, .poses = 11, .repeats = 2},
                                                      {.name = "again", .run = measure_one}};
    struct bench bench = make_bench();
    json_t *settings = json_object();
    assert_ok(bench_all(&bench, settings, scenarios, 5));
    assert_int_equal(json_object_size(bench.left_out), 3);
    assert_string_equal(json_string_value(json_object_get(bench.left_out, "refuses")), "no such thing");
    assert_string_equal(json_string_value(json_object_get(bench.left_out, "crashes")), "it was ended by signal 9");
    assert_string_equal(json_string_value(json_object_get(bench.left_out, "a part")), "no GL");
    assert_int_equal(bench.crashed, 1);
    assert_int_equal(faults(&bench), 1);
    assert_int_equal(json_array_size(bench.runs), 2);
    assert_int_equal(json_integer_value(run_at(&bench, 0, "count")), 11);
    assert_int_equal(json_integer_value(run_at(&bench, 0, "repeats")), 2);
    assert_int_equal(json_integer_value(run_at(&bench, 1, "count")), 2);
    assert_int_equal(json_object_size(settings), 3);
    const json_t *own = json_object_get(settings, "good");
    assert_int_equal(json_integer_value(json_object_get(own, "poses")), 11);
    assert_string_equal(json_string_value(json_object_get(own, "clock")), "CPU time of one thread");
    assert_string_equal(json_string_value(json_object_get(own, "driver")), "rays, test; gl, test");
    json_decref(settings);
    finish_bench(&bench);
}

/* In logarithms to base 10 the bent curve has the points (0, 0), (1, 0), (2, 1), with means 1 and 1/3; so its slope is
 * (-1 * -1/3 + 0 + 1 * 2/3) / (1 + 0 + 1) = 1/2. */
static void an_exponent_is_the_slope_of_the_logarithms(void **state)
{
    (void)state;
    const double x[] = {2, 8, 50, 1000};
    const double bent_x[] = {1, 10, 100};
    const double bent[] = {1, 1, 10};
    const double same[] = {3, 3, 3};
    double root[4];
    double square[4];
    for (int i = 0; i < 4; i++) {
        root[i] = 7 * sqrt(x[i]);
        square[i] = 0.1 / (x[i] * x[i]);
    }
    assert_true(fabs(bench_exponent(x, root, 4) - 0.5) < 1e-12);
    assert_true(fabs(bench_exponent(x, square, 4) + 2) < 1e-12);
    assert_true(fabs(bench_exponent(bent_x, bent, 3) - 0.5) < 1e-12);
    assert_true(fabs(bench_exponent(bent_x, same, 3)) < 1e-12);
    assert_true(isnan(bench_exponent(same, bent, 2)));
    assert_true(isnan(bench_exponent(x, root, 1)));
    assert_true(isnan(bench_exponent(x, root, 0)));
}

TEST_GROUP(bench)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_round_runs_all_cold_and_warm),
        cmocka_unit_test(long_runs_count_at_once_and_time_ends_rounds),
        cmocka_unit_test(a_ratio_of_different_answers_is_null_and_says_why),
        cmocka_unit_test(a_check_finds_what_differs_and_what_is_null),
        cmocka_unit_test(ratios_are_compared_with_their_bounds),
        cmocka_unit_test(scenarios_do_not_affect_each_other),
        cmocka_unit_test(an_exponent_is_the_slope_of_the_logarithms),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
