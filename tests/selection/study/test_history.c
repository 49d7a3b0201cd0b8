/* SPDX-License-Identifier: BSD-3-Clause */
/* A track's history (Eq. 12): filters that are exact in time, and a window of entries and exits. */
#include "base/geometry/math3.h"
#include "selection/measure/score.h"
#include "test.h"

/* The state after many tiny Euler steps. */
static double euler(double state, double growth, double decay, double from, double to, double dt)
{
    enum { STEPS = 400000 };
    for (int i = 0; i < STEPS; i++) {
        double u = from + (to - from) * (i + 0.5) / STEPS;
        state += (u > state ? growth : decay) * (u - state) * dt / STEPS;
    }
    return state;
}

static void filters_solve_their_equation(void **state)
{
    (void)state;
    uint64_t seed = 12;
    for (int i = 0; i < 40; i++) {
        double start = test_random(&seed, 0, 1);
        double from = test_random(&seed, 0, 1);
        double to = test_random(&seed, 0, 1);
        double dt = test_random(&seed, 0.001, 0.5);
        double growth = test_random(&seed, 1, 40);
        double decay = test_random(&seed, 1, 40);
        assert_near(filter_linear(start, growth, from, to, dt), euler(start, growth, growth, from, to, dt), 2e-5);
        assert_near(filter_asymmetric(start, growth, decay, from, to, dt), euler(start, growth, decay, from, to, dt),
                    2e-5);
    }
}

/* A step may be cut in two whose inputs lie on one line: nothing changes, wherever the input and the state cross. */
static void steps_may_be_cut(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int i = 0; i < 2000; i++) {
        double start = test_random(&seed, 0, 1);
        double from = i % 7 ? test_random(&seed, 0, 1) : start;
        double to = i % 5 ? test_random(&seed, 0, 1) : from;
        double dt = test_random(&seed, 0, 0.3);
        double part = test_random(&seed, 0, 1);
        double middle = from + (to - from) * part;
        double half = filter_asymmetric(start, 15, 4, from, middle, part * dt);
        assert_near(filter_asymmetric(half, 15, 4, middle, to, (1 - part) * dt),
                    filter_asymmetric(start, 15, 4, from, to, dt), 1e-12);
        half = filter_linear(start, 40, from, middle, part * dt);
        assert_near(filter_linear(half, 40, middle, to, (1 - part) * dt), filter_linear(start, 40, from, to, dt),
                    1e-12);
    }
}

static void filters_stay_between_their_inputs(void **state)
{
    (void)state;
    assert_near(filter_linear(0.3, 40, 1, 1, 0), 0.3, 0); /* no time, no change */
    assert_near(filter_asymmetric(0.3, 40, 10, 1, 1, 0), 0.3, 0);
    assert_near(filter_linear(0.3, 40, 0.7, 0.7, 1e9), 0.7, 1e-12);
    assert_near(filter_asymmetric(0, 15, 10, 1, 1, 1e9), 1, 1e-12); /* Euler's steps diverge beyond 0.27 s */
    assert_near(filter_asymmetric(0.5, 15, 10, 0.5, 0.5, 3), 0.5, 0);
    assert_near(filter_linear(0.5, 1e-12, 1, 0, 1e-9), 0.5, 1e-12);
}

/* c_s = c_g = 1/2 at 60 Hz, as in the tracker. */
static struct history_constants constants(void)
{
    return (struct history_constants){
        .window = 2, .intent_rate = 60 * log(2), .intent_gain = 1, .growth = 7.5, .decay = 5};
}

static struct history open_history(void)
{
    struct history history;
    const struct history_constants all = constants();
    assert_ok(history_init(&history, 9, &all));
    return history;
}

/* Object 1 with this contribution, below 0: not in the cone. */
static void step(struct history *history, double time, double contribution)
{
    const struct history_sample sample = {1, contribution};
    size_t count = contribution >= 0;
    assert_ok(history_reserve(history, &sample, count));
    history_step(history, time, &sample, count);
}

static void time_is_the_part_of_the_window(void **state)
{
    (void)state;
    struct history history = open_history();
    step(&history, 10, 0.5);
    assert_near(history_time(&history, history_find(&history, 1)), 0, 0); /* one row: no time has passed */
    assert_near(history_stability(&history, history_find(&history, 1)), 1, 0);
    step(&history, 10.5, 0.5);
    assert_near(history_time(&history, history_find(&history, 1)), 0.25, 1e-12);
    step(&history, 11, -1); /* left at 10.75 */
    assert_near(history_time(&history, history_find(&history, 1)), 0.375, 1e-12);
    assert_near(history_stability(&history, history_find(&history, 1)), 1 - 1 / 40.0, 1e-12);
    step(&history, 12.5, -1); /* the window began at 10.5 */
    assert_near(history_time(&history, history_find(&history, 1)), 0.125, 1e-12);
    step(&history, 12.7, 0); /* back at 12.6; 10.7 to 10.75 are still in the window */
    assert_near(history_time(&history, history_find(&history, 1)), (0.05 + 0.1) / 2, 1e-12);
    assert_near(history_stability(&history, history_find(&history, 1)), 1 - 2 / 40.0, 1e-12);
    step(&history, 14.6, 0);
    assert_near(history_time(&history, history_find(&history, 1)), 1, 1e-12);
    assert_near(history_stability(&history, history_find(&history, 1)), 1, 1e-12); /* the entry is 2 s ago */
    history_finish(&history);
}

static void a_gap_longer_than_the_window_starts_afresh(void **state)
{
    (void)state;
    struct history history = open_history();
    step(&history, 0, 1);
    step(&history, 2, 1); /* exactly the window: no gap */
    assert_near(history_time(&history, history_find(&history, 1)), 1, 0);
    assert_near(history_find(&history, 1)->intent, 1, 1e-6);
    step(&history, 4.0001, 1);
    assert_near(history_time(&history, history_find(&history, 1)), 0, 0);
    assert_near(history_find(&history, 1)->intent, 0, 0);
    assert_near(history_find(&history, 1)->plus, 0, 0);
    assert_int_equal(history.steps, 1);
    history_finish(&history);
}

static void what_is_long_gone_is_forgotten(void **state)
{
    (void)state;
    struct history history = open_history();
    const struct history_sample both[] = {{3, 1}, {1, 1}};
    for (int i = 0; i < 10; i++) {
        assert_ok(history_reserve(&history, both, 2));
        history_step(&history, i / 10.0, both, 2);
    }
    history_choose(&history, 3);
    for (int i = 10; i < 28; i++) {
        step(&history, i / 10.0, 1);
    }
    assert_non_null(history_find(&history, 3)); /* was in the window's cone */
    for (int i = 28; i < 40; i++) {
        step(&history, i / 10.0, 1);
    }
    assert_null(history_find(&history, 3));
    assert_near(history_find(&history, 1)->plus, 1, 1e-3);
    assert_int_equal(history.count, 1);
    assert_null(history_find(&history, 2));
    history_finish(&history);
}

/* At the reference rate the filter's zero-order hold is the original's recurrence: s = s c_s + c c_g. */
static void at_the_reference_rate_it_is_the_original(void **state)
{
    (void)state;
    const double c_s = 0.7;
    const double c_g = 0.2;
    double original = 0;
    double ours = 0;
    uint64_t seed = 3;
    for (int i = 0; i < 100; i++) {
        double contribution = test_random(&seed, 0, 1);
        double input = contribution * c_g / (1 - c_s);
        original = fmax(0, original * c_s + contribution * c_g);
        ours = filter_linear(ours, -90 * log(c_s), input, input, 1 / 90.0);
        assert_near(ours, original, 1e-12);
    }
}

/* A contribution that changes like the drift of a hand: more slowly than half of the lowest rate. */
static double hand(double t)
{
    return 0.5 + 0.3 * sin(2 * MATH3_PI * 0.6 * t) + 0.15 * sin(2 * MATH3_PI * 1.9 * t + 1);
}

struct scores_at_end {
    double intent, plus, time, stability;
};

/* In the cone while t is in [0.31, 2.83) and from 3.02 on. */
static struct scores_at_end run_at(double rate, bool drop_frames)
{
    struct history history = open_history();
    uint64_t seed = 99;
    struct scores_at_end out;
    for (int i = 0; i <= (int)(4 * rate + 0.5); i++) {
        double t = i / rate;
        bool inside = (t >= 0.31 && t < 2.83) || t >= 3.02;
        bool last = i == (int)(4 * rate + 0.5);
        if (!drop_frames || last || test_random(&seed, 0, 1) < 0.5) {
            step(&history, t, inside ? hand(t) : -1);
        }
    }
    const struct memory *memory = history_find(&history, 1);
    out = (struct scores_at_end){memory->intent, memory->plus, history_time(&history, memory),
                                 history_stability(&history, memory)};
    history_finish(&history);
    return out;
}

static void assert_same_scores(struct scores_at_end got, struct scores_at_end wanted)
{
    assert_near(got.intent, wanted.intent, 0.01);
    assert_near(got.plus, wanted.plus, 0.01);
    assert_near(got.time, wanted.time, 0.01);
    assert_near(got.stability, wanted.stability, 0);
}

static void every_rate_gives_the_same(void **state)
{
    (void)state;
    const struct scores_at_end wanted = run_at(1000, false);
    assert_near(wanted.time, (0.83 + 0.98) / 2, 1e-3);
    assert_near(wanted.stability, 1 - 2 / 40.0, 1e-12); /* out and in again; the first entry is 3.7 s ago */
    assert_same_scores(run_at(30, false), wanted);
    assert_same_scores(run_at(90, false), wanted);
    assert_same_scores(run_at(90, true), wanted);
    assert_same_scores(run_at(1000, true), wanted);
}

static conus_status remember(void *data)
{
    (void)data;
    struct history history = {0};
    const struct history_constants all = constants();
    const struct history_sample samples[] = {{1, 1}, {2, 0.5}, {9, 0}};
    conus_status status = history_init(&history, 9, &all);
    for (int i = 0; !status && i < 12; i++) {
        size_t count = i % 2 ? 1 : 3;
        status = history_reserve(&history, samples, count);
        if (!status) {
            history_step(&history, i * 0.01, samples, count);
        }
    }
    history_finish(&history);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    test_every_allocation(remember, NULL);
}

TEST_GROUP(history)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(filters_solve_their_equation),
        cmocka_unit_test(steps_may_be_cut),
        cmocka_unit_test(filters_stay_between_their_inputs),
        cmocka_unit_test(time_is_the_part_of_the_window),
        cmocka_unit_test(a_gap_longer_than_the_window_starts_afresh),
        cmocka_unit_test(what_is_long_gone_is_forgotten),
        cmocka_unit_test(at_the_reference_rate_it_is_the_original),
        cmocka_unit_test(every_rate_gives_the_same),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
