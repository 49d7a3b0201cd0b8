/* SPDX-License-Identifier: BSD-3-Clause */
/* Convex polyhedra cut by planes, against closed forms (Eq. 16). */
#include "base/geometry/math3.h"
#include "conus/status.h"
#include "test.h"

#include <math.h>

static const double ZERO[3] = {0, 0, 0};
static const double ONE[3] = {1, 1, 1};

/* Checks the volumes on the two sides of a plane. */
static void check_cut(struct convex_stack *stack, const struct convex *convex, int axis, double at, double below)
{
    for (int above = 0; above < 2; above++) {
        struct convex part;
        size_t count = stack->count;
        assert_true(convex_cut(&part, stack, convex, axis, at, above));
        assert_near(part.volume, above ? convex->volume - below : below, 1e-13);
        assert_near((above ? part.low : part.high)[axis], at, 0);
        stack->count = count;
    }
}

/* The plane at t along an axis leaves (1 - t)³ / 6 of the corner of a cube, whichever way its corners run round. */
static void a_tetrahedron_is_cut(void **state)
{
    (void)state;
    struct convex_stack stack = {0};
    static const double corners[2][4][3] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                            {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}}};
    for (int turned = 0; turned < 2; turned++) {
        struct convex tetrahedron;
        assert_true(convex_tetrahedron(&tetrahedron, &stack, corners[turned]));
        assert_near(tetrahedron.volume, 1 / 6.0, 1e-16);
        for (int axis = 0; axis < 3; axis++) {
            assert_near(tetrahedron.low[axis], 0, 0);
            assert_near(tetrahedron.high[axis], 1, 0);
            for (int i = 1; i < 20; i++) {
                check_cut(&stack, &tetrahedron, axis, i / 20.0, 1 / 6.0 - pow(1 - i / 20.0, 3) / 6);
            }
        }
        stack.count = 0;
    }
    convex_finish(&stack);
}

static void boxes_stay_boxes(void **state)
{
    (void)state;
    struct convex_stack stack = {0};
    const double turned[16] = {[2] = 2, [4] = -3, [9] = 0.5, [12] = 7, [13] = 8, [14] = 9, [15] = 1};
    const struct convex box = convex_box((const double[]){1, 2, 3}, (const double[]){2, 4, 7});
    struct convex moved;
    assert_near(box.volume, 8, 0);
    assert_true(convex_move(&moved, &stack, &box, turned)); /* x = 7 - 3 y, y = 8 + z / 2, z = 9 + 2 x */
    assert_int_equal(moved.count, 0);
    const double wanted[6] = {-5, 9.5, 11, 1, 11.5, 13};
    for (int a = 0; a < 3; a++) {
        assert_near(moved.low[a], wanted[a], 0);
        assert_near(moved.high[a], wanted[3 + a], 0);
    }
    assert_near(moved.volume, 24, 0);
    check_cut(&stack, &moved, 0, -4, 4);
    assert_int_equal(stack.count, 0);
    convex_finish(&stack);
}

/* z = x + y + z of a cube cut at t: t^3 / 6 below 1; between 1 and 2 that less 3 (t - 1)^3 / 6; above by symmetry. */
static void a_cube_on_its_corner_is_cut(void **state)
{
    (void)state;
    struct convex_stack stack = {0};
    const double corner[16] = {[0] = 1, [5] = 1, [2] = 1, [6] = 1, [10] = 1, [15] = 1};
    const struct convex cube = convex_box(ZERO, ONE);
    struct convex moved;
    assert_true(convex_move(&moved, &stack, &cube, corner));
    assert_int_equal(moved.count, 24);
    assert_near(moved.volume, 1, 1e-15);
    assert_near(moved.high[2], 3, 0);
    for (int i = 1; i < 60; i++) { /* 1 and 2, where the plane passes three corners, among them */
        double t = i / 20.0;
        double below = (t * t * t - 3 * pow(fmax(t - 1, 0), 3) + 3 * pow(fmax(t - 2, 0), 3)) / 6;
        check_cut(&stack, &moved, 2, t, below);
    }
    convex_finish(&stack);
}

/* The cuts at z = 1 and x = 1/2 of the corner x + y + z <= 1 of a cube leave (1/2)^3 / 6 beyond. */
static void cut_parts_are_cut_again(void **state)
{
    (void)state;
    struct convex_stack stack = {0};
    const double corner[16] = {[0] = 1, [5] = 1, [2] = 1, [6] = 1, [10] = 1, [15] = 1};
    const struct convex cube = convex_box(ZERO, ONE);
    struct convex moved;
    struct convex part;
    assert_true(convex_move(&moved, &stack, &cube, corner));
    assert_true(convex_cut(&part, &stack, &moved, 2, 1, false));
    check_cut(&stack, &part, 0, 0.5, 1 / 6.0 - 1 / 48.0);
    check_cut(&stack, &part, 1, 0.5, 1 / 6.0 - 1 / 48.0);
    assert_true(convex_cut(&part, &stack, &part, 0, 0.5, false));
    assert_true(convex_cut(&part, &stack, &part, 1, 0.5, false)); /* 1/6 less two such corners */
    assert_near(part.volume, 1 / 6.0 - 2 / 48.0, 1e-14);
    convex_finish(&stack);
}

/* Random parallelepipeds are cut again and again, also through their corners: the parts sum to the whole, and faraway
 * parts have few edges. */
static void parts_sum_to_the_whole(void **state)
{
    (void)state;
    uint64_t seed = 4;
    struct convex_stack stack = {0};
    for (int turn = 0; turn < 300; turn++) {
        double m[16] = {[15] = 1};
        struct convex convex = convex_box(ZERO, ONE);
        for (int i = 0; i < 12; i++) {
            m[i + i / 3] = test_random(&seed, -3, 3);
            m[i + i / 3] = turn % 2 ? round(m[i + i / 3]) : m[i + i / 3];
        }
        stack.count = 0;
        assert_true(convex_move(&convex, &stack, &convex, m));
        assert_near(convex.volume, fabs(mat4_determinant3(m)), 1e-12);
        for (int cut = 0; convex.volume > 1e-9 && cut < 12; cut++) {
            struct convex parts[2];
            int axis = (int)test_random(&seed, 0, 3);
            double t = turn % 3 ? test_random(&seed, 0.05, 0.95) : 0.5;
            double at = convex.low[axis] + t * (convex.high[axis] - convex.low[axis]);
            assert_true(convex_cut(&parts[0], &stack, &convex, axis, at, false));
            assert_true(convex_cut(&parts[1], &stack, &convex, axis, at, true));
            assert_near(parts[0].volume + parts[1].volume, convex.volume, 1e-13);
            convex = parts[cut % 2];
            assert_true(convex.count <= 60); /* 12 faces have at most 30 edges */
        }
    }
    convex_finish(&stack);
}

static conus_status cut_once(void *data)
{
    struct convex_stack stack = {0};
    struct convex part;
    const struct convex cube = convex_box(ZERO, ONE);
    bool fits = convex_move(&part, &stack, &cube, data) && convex_cut(&part, &stack, &part, 2, 1, true);
    convex_finish(&stack);
    return fits ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    double corner[16] = {[0] = 1, [5] = 1, [2] = 1, [6] = 1, [10] = 1, [15] = 1};
    test_every_allocation(cut_once, corner);
}

TEST_GROUP(convex)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tetrahedron_is_cut),        cmocka_unit_test(boxes_stay_boxes),
        cmocka_unit_test(a_cube_on_its_corner_is_cut), cmocka_unit_test(cut_parts_are_cut_again),
        cmocka_unit_test(parts_sum_to_the_whole),      cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
