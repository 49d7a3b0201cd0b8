/* SPDX-License-Identifier: BSD-3-Clause */
/* Selectors that share their tables answer at the same time, each like the first one alone. */
#include "base/geometry/math3.h"
#include "test.h"
#include "test_gl.h"

#include "conus/arrays.h"
#include "conus/selection.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

enum { EDGE = 24, POSES = 64, THREADS = 4 };

/* The first results of each pose, asked by one selector. */
struct answers {
    conus_selector *selector;
    size_t counts[POSES];
    conus_result first[POSES];
    conus_status status;
};

static void *ask_all(void *data)
{
    struct answers *answers = data;
    for (size_t n = 0; n < POSES && !answers->status; n++) {
        conus_selection *selection = NULL;
        conus_pose pose;
        const double a = 0.1 * (double)n;
        answers->status = conus_pose_toward(&pose, (double[]){90 * cos(a), 90 * sin(a), 4 * a},
                                            (double[]){3 * cos(7 * a), 3 * sin(5 * a), 0}, NULL);
        if (!answers->status) {
            answers->status = conus_select(&selection, answers->selector, &pose, degrees_from_radians(0.2));
        }
        if (!answers->status) {
            answers->counts[n] = conus_selection_count(selection);
            answers->first[n] = *conus_selection_result(selection, 0);
        }
        conus_selection_destroy(selection);
    }
    return NULL;
}

/* A cube of 48 mm about the origin: areas 1 to 9, cells of a chess board of 16 mm. */
static conus_atlas *make_board(void)
{
    static uint8_t labels[EDGE * EDGE * EDGE];
    conus_atlas *atlas = NULL;
    for (size_t n = 0; n < sizeof labels; n++) {
        labels[n] = (uint8_t)(1 + n % EDGE / 8 + 3 * (n / EDGE % EDGE / 8));
    }
    conus_voxels voxels = {.data = labels,
                           .type = CONUS_SCALAR_UINT8,
                           .dim = {EDGE, EDGE, EDGE},
                           .world_from_voxel = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, -23, -23, -23, 1}};
    assert_int_equal(conus_atlas_create(&atlas, &voxels, NULL, 0, NULL), CONUS_OK);
    return atlas;
}

static void check_same(const struct answers *a, const struct answers *b)
{
    assert_memory_equal(a->counts, b->counts, sizeof a->counts);
    for (size_t n = 0; n < POSES; n++) {
        const conus_result *x = &a->first[n], *y = &b->first[n];
        assert_int_equal(x->object, y->object);
        assert_int_equal(x->pixels, y->pixels);
        assert_int_equal(x->voxels, y->voxels);
        assert_memory_equal(&x->share, &y->share, sizeof x->share);
        assert_memory_equal(&x->score, &y->score, sizeof x->score);
        assert_memory_equal(x->contact, y->contact, sizeof x->contact);
    }
}

static void check_threads(conus_selector_options options)
{
    conus_atlas *atlas = make_board();
    struct answers alone = {0}, shared[THREADS] = {0};
    pthread_t threads[THREADS];
    options.score = "centre";
    assert_gl(conus_selector_create(&alone.selector, atlas, &options));
    for (size_t i = 0; i < THREADS; i++) {
        assert_int_equal(conus_selector_share(&shared[i].selector, alone.selector), CONUS_OK);
        assert_int_equal(pthread_create(&threads[i], NULL, ask_all, &shared[i]), 0);
    }
    ask_all(&alone);
    assert_int_equal(alone.status, CONUS_OK);
    for (size_t i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        assert_int_equal(shared[i].status, CONUS_OK);
        check_same(&shared[i], &alone);
        conus_selector_destroy(shared[i].selector);
    }
    struct answers again = {.selector = alone.selector}; /* by a thread that did not make it */
    assert_int_equal(pthread_create(&threads[0], NULL, ask_all, &again), 0);
    pthread_join(threads[0], NULL);
    assert_int_equal(again.status, CONUS_OK);
    check_same(&again, &alone);
    assert_true(alone.counts[0] > 1); /* an area and unassigned */
    conus_selector_destroy(alone.selector);
    conus_atlas_destroy(atlas);
}

static void threads_answer_as_one(void **state)
{
    (void)state;
    check_threads((conus_selector_options){.layers = CONUS_LAYERS_ALL});
}

/* The device is one thread's at a time. */
static void threads_answer_as_one_with_gl(void **state)
{
    (void)state;
    check_threads((conus_selector_options){.engine = CONUS_ENGINE_GL});
    check_threads((conus_selector_options){.engine = CONUS_ENGINE_GL, .layers = CONUS_LAYERS_ALL});
}

/* Python's collector destroys the members of a reference cycle in any order. */
static void destroying_needs_no_atlas(void **state)
{
    (void)state;
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL};
    conus_atlas *atlas = make_board();
    struct answers all = {0};
    assert_int_equal(conus_selector_create(&all.selector, atlas, &options), CONUS_OK);
    ask_all(&all);
    assert_int_equal(all.status, CONUS_OK);
    conus_atlas_destroy(atlas);
    conus_selector_destroy(all.selector);
}

TEST_GROUP(share)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_answer_as_one),
        cmocka_unit_test(destroying_needs_no_atlas),
        cmocka_unit_test(threads_answer_as_one_with_gl),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
