/* SPDX-License-Identifier: BSD-3-Clause */
/* Deformation fields whose map is known in closed form. tests/oracles/compare_warps.py compares them with numpy. */
#include "atlas/deformation/deformation.h"
#include "base/geometry/math3.h"
#include "test.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* A field of displacements, RAS mm, on nodes 2 mm apart, the first at (-10, -12, -14). */
struct made {
    struct deformation field;
    float vectors[3 * 11 * 13 * 15];
};

static struct made *make(void (*way)(double out[3], const double p[3]))
{
    struct made *made = calloc(1, sizeof *made);
    struct deformation *field = &made->field;
    *field = (struct deformation){.dim = {11, 13, 15}, .vectors = made->vectors, .is_borrowed = true};
    mat4_identity(field->world_from_voxel);
    for (int a = 0; a < 3; a++) {
        field->world_from_voxel[5 * a] = 2;
        field->world_from_voxel[12 + a] = -10 - 2 * a;
    }
    assert_true(mat4_invert_affine(field->voxel_from_world, field->world_from_voxel));
    memcpy(field->base, field->world_from_voxel, sizeof field->base);
    mat4_identity(field->linear);
    for (size_t n = 0; n < (size_t)11 * 13 * 15; n++) {
        const size_t k = n / 143;
        const double node[3] = {(double)(n % 11), (double)(n / 11 % 13), (double)k};
        double p[3];
        double moved[3];
        mat4_point(p, field->world_from_voxel, node);
        way(moved, p);
        for (int a = 0; a < 3; a++) {
            made->vectors[3 * n + (size_t)a] = (float)moved[a];
        }
    }
    return made;
}

/* Linear, so that values between nodes are exact. (x, y, z) goes to (1.25 x + 0.5 y + 1, y - 0.25 z, z + 3). */
static void shear(double out[3], const double p[3])
{
    out[0] = 0.25 * p[0] + 0.5 * p[1] + 1;
    out[1] = -0.25 * p[2];
    out[2] = 3;
}

/* Slopes below 0.75: no fold. */
static void wave(double out[3], const double p[3])
{
    out[0] = 2 * sin(p[1] / 4);
    out[1] = 1.5 * cos(p[0] / 3 + p[2] / 5);
    out[2] = 2 * sin(p[0] / 5 + 1);
}

static void stay(double out[3], const double p[3])
{
    (void)p;
    memset(out, 0, 3 * sizeof *out);
}

static void a_linear_field_is_exact_between_nodes(void **state)
{
    (void)state;
    struct made *made = make(shear);
    uint64_t random = 1;
    for (int i = 0; i < 1000; i++) {
        const double p[3] = {test_random(&random, -10, 10), test_random(&random, -12, 12),
                             test_random(&random, -14, 14)};
        double q[3];
        double way[3];
        double columns[3][3];
        assert_true(deformation_point(q, &made->field, p));
        shear(way, p);
        vec3_add_scaled(way, way, 1, p);
        assert_near(q[0], way[0], 1e-5); /* the vectors are of single precision */
        assert_near(q[1], way[1], 1e-5);
        assert_near(q[2], way[2], 1e-5);
        mat4_point(q, made->field.voxel_from_world, p);
        deformation_slope(way, columns, &made->field, q);
        assert_near(columns[0][0], 2 * 1.25, 1e-5); /* mm a node, of 2 mm */
        assert_near(columns[1][0], 2 * 0.5, 1e-5);
        assert_near(columns[2][1], 2 * -0.25, 1e-5);
        assert_near(columns[2][2], 2, 1e-5);
        assert_near(columns[0][1], 0, 1e-5);
    }
    free(made);
}

/* Node (5, 6, 7) is at (0, 0, 0), (6, 6, 7) at (2, 0, 0): a quarter of the way between vectors (1, 0, 0) and (5, 0, 0).
 */
static void a_point_between_two_nodes_has_a_part_of_both(void **state)
{
    (void)state;
    struct made *made = make(stay);
    size_t node = 5 + 11 * (6 + 13 * 7);
    double p[3] = {0.5, 0, 0};
    made->vectors[3 * node] = 1;
    made->vectors[3 * (node + 1)] = 5;
    assert_true(deformation_point(p, &made->field, p));
    assert_near(p[0], 0.5 + 2, 1e-12);
    assert_near(p[1], 0, 1e-12);
    double q[3] = {5, 6.5, 7}; /* in indices, between (1, 0, 0) and (0, 0, 0) */
    deformation_at(p, &made->field, q);
    assert_near(p[0], 0.5, 1e-12);
    assert_near(p[1], 1, 1e-12);
    free(made);
}

/* The rest is the difference between a double and its float: 0.1 is 1.5e-9 more as a float. */
static void doubles_are_whole(void **state)
{
    (void)state;
    struct made *made = make(stay);
    size_t node = 5 + 11 * (6 + 13 * 7);
    size_t count = (size_t)3 * 11 * 13 * 15;
    made->field.rest = calloc(count, sizeof *made->field.rest);
    for (size_t n = node; n < node + 2; n++) {
        made->vectors[3 * n + 1] = 0.1F;
        made->field.rest[3 * n + 1] = (float)(0.1 - (double)0.1F);
    }
    double p[3] = {0.5, 0, 0};
    const double q[3] = {5, 6, 7};
    assert_true(deformation_point(p, &made->field, p));
    assert_near(p[1], 0.1, 1e-16);
    deformation_at(p, &made->field, q);
    assert_near(p[1], 0.1, 1e-16);
    free(made->field.rest);
    free(made);
}

/* An affine before the field, the field, an affine after it; outside of the field only the two affines. And back. */
static void affines_become_parts_of_a_field(void **state)
{
    (void)state;
    static const double before[16] = {0.8, 0.6, 0, 0, -0.6, 0.8, 0, 0, 0, 0, 1.25, 0, 1, 2, 3, 1};
    static const double after[16] = {1, 0.25, 0, 0, 0, 0.5, 0, 0, 0.5, 0, -1, 0, -4, 5, 6, 1};
    struct made *plain = make(wave);
    struct made *made = make(wave);
    uint64_t random = 3;
    plain->field.stays_outside = made->field.stays_outside = true;
    deformation_fold(&made->field, before, after);
    assert_ok(deformation_measure(&plain->field));
    assert_ok(deformation_measure(&made->field));
    for (int i = 0; i < 400; i++) {
        const double p[3] = {test_random(&random, -15, 15), test_random(&random, -15, 15),
                             test_random(&random, -15, 15)};
        double got[3];
        double wanted[3];
        double back[3];
        assert_true(deformation_point(got, &made->field, p));
        mat4_point(wanted, before, p);
        double inner[3];
        memcpy(inner, wanted, sizeof inner);
        assert_true(deformation_point(wanted, &plain->field, wanted));
        mat4_point(wanted, after, wanted);
        vec3_sub(wanted, wanted, got);
        assert_near(vec3_length(wanted), 0, 1e-12);
        mat4_point(inner, plain->field.voxel_from_world, inner);
        if (deformation_find(back, &made->field, got) == DEFORMATION_FOUND) {
            assert_true(deformation_point(back, &made->field, back));
        } else { /* a point that lies outside and was not moved by the field */
            assert_false(deformation_holds(&plain->field, inner));
            assert_true(deformation_point(back, &made->field, back));
        }
        vec3_sub(back, back, got);
        assert_near(vec3_length(back), 0, 2e-6);
    }
    free(plain);
    free(made);
}

/* The way back through two fields is the way back through one, then through the other. */
static void several_fields_are_gone_back_through_in_turn(void **state)
{
    (void)state;
    struct made *first = make(wave);
    struct made *second = make(shear);
    assert_ok(deformation_measure(&first->field));
    assert_ok(deformation_measure(&second->field));
    const struct deformation fields[2] = {first->field, second->field};
    const double start[3] = {1, -2, 3};
    const double far[3] = {500, 0, 0};
    double p[3];
    assert_true(deformation_point(p, &second->field, start));
    assert_true(deformation_point(p, &first->field, p));
    assert_int_equal(deformations_find(p, fields, 2, p), DEFORMATION_FOUND);
    vec3_sub(p, p, start);
    assert_near(vec3_length(p), 0, 1e-5);
    assert_int_equal(deformations_find(p, fields, 2, far), DEFORMATION_OUTSIDE);
    assert_true(isnan(p[0]));
    free(first);
    free(second);
}

/* The last node along x is at 10, so the grid ends at 11; there the vector is the border's, (3, 0, 0). */
static void the_grid_ends_half_a_step_outside_of_its_nodes(void **state)
{
    (void)state;
    struct made *made = make(stay);
    for (size_t n = 0; n < (size_t)11 * 13 * 15; n++) {
        made->vectors[3 * n] = 3;
    }
    const double last[3] = {10.999, 0, 0};
    const double first[3] = {-11, 0, 0};
    const double beyond[3] = {11, 0, 0};
    double out[3];
    assert_true(deformation_point(out, &made->field, last));
    assert_near(out[0], 13.999, 1e-12);
    assert_true(deformation_point(out, &made->field, first));
    assert_near(out[0], -8, 1e-12);
    assert_false(deformation_point(out, &made->field, beyond));
    assert_true(isnan(out[0]) && isnan(out[2]));
    made->field.stays_outside = true;
    assert_true(deformation_point(out, &made->field, beyond));
    assert_near(out[0], 11, 0);
    free(made);
}

/* A point between a node with a value and one without a value has none. The node with a value has its own. */
static void nodes_without_a_value_take_points_nowhere(void **state)
{
    (void)state;
    struct made *made = make(stay);
    size_t node = 5 + 11 * (6 + 13 * 7); /* at (0, 0, 0) */
    double p[3] = {0, 0, 0};
    made->vectors[3 * node + 1] = NAN;
    assert_false(deformation_point(p, &made->field, p));
    const double beside[3] = {2, 0, 0};
    assert_true(deformation_point(p, &made->field, beside));
    const double before[3] = {-2, 0, 0};
    assert_true(deformation_point(p, &made->field, before));
    const double between[3] = {1.9, 0, 0};
    assert_false(deformation_point(p, &made->field, between));
    struct deformation_facts facts;
    assert_ok(deformation_measure(&made->field));
    assert_ok(deformation_facts_find(&facts, &made->field));
    assert_int_equal(facts.nodes, 11 * 13 * 15);
    assert_int_equal(facts.unstated, 1);
    assert_int_equal(facts.folds, 0);
    free(made);
}

static void check_way_back(void (*way)(double out[3], const double p[3]), double reach)
{
    struct made *made = make(way);
    uint64_t random = 2;
    assert_ok(deformation_measure(&made->field));
    for (int i = 0; i < 2000; i++) {
        const double p[3] = {test_random(&random, -reach, reach), test_random(&random, -reach, reach),
                             test_random(&random, -reach, reach)};
        double there[3];
        double back[3];
        assert_true(deformation_point(there, &made->field, p));
        assert_int_equal(deformation_find(back, &made->field, there), DEFORMATION_FOUND);
        for (int a = 0; a < 3; a++) {
            assert_near(back[a], p[a], 1e-5); /* the tolerance, by the slope of the way back, below 10 */
        }
    }
    free(made);
}

static void the_way_back_leads_back(void **state)
{
    (void)state;
    check_way_back(shear, 9);
    check_way_back(wave, 9);
    check_way_back(stay, 9.9);
}

/* Cells of one step along x, in which x goes to x + v: v of 0 and -3 at neighbours 2 mm apart is a slope of -0.5. */
static void folds_are_counted_cell_by_cell(void **state)
{
    (void)state;
    struct made *made = make(stay);
    struct deformation_facts facts;
    size_t node = 5 + 11 * (6 + 13 * 7);
    made->vectors[3 * node] = -3; /* the edge before it turns over, that behind it does not */
    assert_ok(deformation_measure(&made->field));
    assert_ok(deformation_facts_find(&facts, &made->field));
    assert_int_equal(facts.cells, 10 * 12 * 14);
    assert_int_equal(facts.folds, 4); /* the four cells round that edge */
    assert_near(facts.farthest, 3, 1e-6);
    assert_near(facts.growth, 1, 0.01);
    assert_false(facts.mirrors || facts.half_turn);
    free(made);
}

static void mirror(double out[3], const double p[3])
{
    out[0] = -2 * p[0];
    out[1] = out[2] = 0;
}

static void half_turn(double out[3], const double p[3])
{
    out[0] = -2 * p[0];
    out[1] = -2 * p[1];
    out[2] = p[2];
}

static void the_whole_is_seen_to_mirror_turn_and_grow(void **state)
{
    (void)state;
    struct deformation_facts facts;
    struct made *made = make(mirror);
    assert_ok(deformation_measure(&made->field));
    assert_ok(deformation_facts_find(&facts, &made->field));
    assert_true(facts.mirrors && !facts.half_turn && facts.folds == 0);
    free(made);
    made = make(half_turn);
    assert_ok(deformation_measure(&made->field));
    assert_ok(deformation_facts_find(&facts, &made->field));
    assert_true(!facts.mirrors && facts.half_turn && facts.folds == 0);
    assert_near(facts.growth, 2, 1e-6);
    free(made);
}

/* All of it shifted by 5 mm along x: from -15 to 16 - 11 + ... the nodes go to -5 to 15, the grid's ends to -6 to 16.
 */
static void five(double out[3], const double p[3])
{
    (void)p;
    out[0] = 5;
    out[1] = out[2] = 0;
}

static void points_without_a_preimage_are_outside(void **state)
{
    (void)state;
    struct made *made = make(five);
    double out[3];
    assert_ok(deformation_measure(&made->field));
    const double held[3] = {-5.9, 0, 0};
    assert_int_equal(deformation_find(out, &made->field, held), DEFORMATION_FOUND);
    assert_near(out[0], -10.9, 1e-6);
    const double before[3] = {-6.1, 0, 0};
    assert_int_equal(deformation_find(out, &made->field, before), DEFORMATION_OUTSIDE);
    assert_true(isnan(out[0]));
    const double far[3] = {500, 0, 0};
    assert_int_equal(deformation_find(out, &made->field, far), DEFORMATION_OUTSIDE);
    made->field.stays_outside = true;
    assert_int_equal(deformation_find(out, &made->field, far), DEFORMATION_OUTSIDE);
    assert_near(out[0], 500, 0);
    assert_int_equal(deformation_find(out, &made->field, before), DEFORMATION_OUTSIDE); /* it would go away itself */
    assert_true(isnan(out[0]));
    free(made);
}

static void constant(double out[3], const double p[3])
{
    vec3_scale(out, p, -1);
}

static void a_field_to_one_point_is_none(void **state)
{
    (void)state;
    struct made *made = make(constant);
    assert_fails(deformation_measure(&made->field), CONUS_ERROR_DATA);
    for (size_t i = 0; i < 3 * (size_t)11 * 13 * 15; i++) {
        made->vectors[i] = NAN;
    }
    assert_fails(deformation_measure(&made->field), CONUS_ERROR_DATA);
    free(made);
}

/* Cubic B-splines are polynomials again where coefficients are: the sum of w_i i is x, of w_i i^2 it is x^2 + 1/3, and
 * of w_i i^3 it is x^3 + x, for the sums of the weights' moments about x are 0, 1/3 and 0. Nodes are 2 mm apart. */
static void splines_are_the_polynomials_of_their_coefficients(void **state)
{
    (void)state;
    enum { NODES = 5 * 6 * 7 };
    double c[3 * NODES];
    struct deformation field = {.dim = {5, 6, 7}, .coefficients = c, .stays_outside = true, .is_borrowed = true};
    for (size_t n = 0; n < NODES; n++) {
        const size_t layer = n / 30;
        const size_t row = n / 5 % 6;
        const double i = (double)(n % 5), j = (double)row, k = (double)layer;
        c[n] = 0.25 * i - 0.5 * j;
        c[NODES + n] = 0.125 * j * j;
        c[2 * NODES + n] = 0.03125 * k * k * k + 0.25 * i * j;
    }
    mat4_identity(field.world_from_voxel);
    mat4_identity(field.linear);
    for (int a = 0; a < 3; a++) {
        field.world_from_voxel[5 * a] = 2;
    }
    memcpy(field.base, field.world_from_voxel, sizeof field.base);
    assert_true(mat4_invert_affine(field.voxel_from_world, field.world_from_voxel));
    assert_ok(deformation_measure(&field));
    uint64_t random = 3;
    for (int n = 0; n < 1000; n++) {
        const double q[3] = {test_random(&random, 1, 3), test_random(&random, 1, 4), test_random(&random, 1, 5)};
        const double wanted[3] = {2 * q[0] + 0.25 * q[0] - 0.5 * q[1], 2 * q[1] + 0.125 * (q[1] * q[1] + 1 / 3.0),
                                  2 * q[2] + 0.03125 * (q[2] * q[2] * q[2] + q[2]) + 0.25 * q[0] * q[1]};
        double p[3];
        double out[3];
        double columns[3][3];
        mat4_point(p, field.world_from_voxel, q);
        assert_true(deformation_point(out, &field, p));
        for (int a = 0; a < 3; a++) {
            assert_near(out[a], wanted[a], 1e-12);
        }
        deformation_slope(p, columns, &field, q);
        assert_near(p[2], wanted[2], 1e-12);
        assert_near(columns[0][0], 2.25, 1e-12);
        assert_near(columns[1][0], -0.5, 1e-12);
        assert_near(columns[1][1], 2 + 0.25 * q[1], 1e-12);
        assert_near(columns[2][2], 2 + 0.03125 * (3 * q[2] * q[2] + 1), 1e-12);
        assert_near(columns[1][2], 0.25 * q[0], 1e-12);
        assert_int_equal(deformation_find(p, &field, out), DEFORMATION_FOUND);
        deformation_point(p, &field, p);
        vec3_sub(p, p, out);
        assert_true(vec3_length(p) <= DEFORMATION_TOLERANCE);
    }
}

/* Six nodes 2 mm apart along each axis: the spline is of 2 to 8 mm. Coefficients of 1 sum to 1. */
static void splines_end_at_the_last_node_but_one(void **state)
{
    (void)state;
    double c[3 * 216];
    struct deformation field = {.dim = {6, 6, 6}, .coefficients = c, .stays_outside = true, .is_borrowed = true};
    struct deformation_facts facts;
    for (size_t n = 0; n < 3 * (size_t)216; n++) {
        c[n] = n < 216;
    }
    mat4_identity(field.world_from_voxel);
    mat4_identity(field.linear);
    for (int a = 0; a < 3; a++) {
        field.world_from_voxel[5 * a] = 2;
    }
    memcpy(field.base, field.world_from_voxel, sizeof field.base);
    assert_true(mat4_invert_affine(field.voxel_from_world, field.world_from_voxel));
    for (int a = 0; a < 3; a++) {
        const double ends[][2] = {{2, 1}, {8, 1}, {1.999999, 0}, {8.000001, 0}, {-50, 0}};
        for (size_t e = 0; e < 5; e++) {
            double p[3] = {5, 5, 5};
            double out[3];
            p[a] = ends[e][0];
            assert_true(deformation_point(out, &field, p));
            assert_near(out[0], p[0] + ends[e][1], 1e-12);
            assert_near(out[1], p[1], 1e-12);
        }
    }
    assert_ok(deformation_measure(&field));
    assert_ok(deformation_facts_find(&facts, &field));
    assert_int_equal(facts.nodes, 7 * 7 * 7); /* every half step of three */
    assert_int_equal(facts.cells, 6 * 6 * 6);
    assert_int_equal(facts.folds, 0);
    assert_near(facts.farthest, 1, 1e-12);
    double out[3];
    const double gap[3] = {2.5, 5, 5}; /* the point there moved 1 mm further, and none came in its place */
    assert_int_equal(deformation_find(out, &field, gap), DEFORMATION_OUTSIDE);
    assert_true(isnan(out[0]));
    const double away[3] = {-9, 5, 5};
    assert_int_equal(deformation_find(out, &field, away), DEFORMATION_OUTSIDE);
    assert_near(out[0], -9, 0);
    c[2 + 6 * (2 + 6 * 2)] = -20; /* 2 mm and 20 mm, by slopes of up to 1/2 2/3 2/3 */
    assert_ok(deformation_measure(&field));
    assert_ok(deformation_facts_find(&facts, &field));
    assert_true(facts.folds > 0);
}

/* Points go through the last one first: 5 to the right, doubled behind that, then sheared, 1 added behind. */
static void warps_are_a_chain(void **state)
{
    (void)state;
    struct made *first = make(shear);
    struct made *last = make(five);
    struct warp warps[2] = {{.field = first->field}, {.field = last->field}};
    mat4_identity(warps[0].after);
    warps[0].after[12] = 1;
    mat4_identity(warps[1].after);
    warps[1].after[0] = 0.5;
    double p[3] = {1, 4, 8}; /* (6, 4, 8), (3, 4, 8), (1.25 3 + 2 + 1, 4 - 2, 11), and 1 to the right */
    assert_true(warps_point(p, warps, 2, p));
    assert_near(p[0], 7.75, 1e-5);
    assert_near(p[1], 2, 1e-5);
    assert_near(p[2], 11, 1e-5);
    const double outside[3] = {0, 0, 90};
    assert_false(warps_point(p, warps, 2, outside));
    assert_true(isnan(p[0]));
    free(first);
    free(last);
}

TEST_GROUP(deformation)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_linear_field_is_exact_between_nodes),
        cmocka_unit_test(a_point_between_two_nodes_has_a_part_of_both),
        cmocka_unit_test(doubles_are_whole),
        cmocka_unit_test(affines_become_parts_of_a_field),
        cmocka_unit_test(several_fields_are_gone_back_through_in_turn),
        cmocka_unit_test(the_grid_ends_half_a_step_outside_of_its_nodes),
        cmocka_unit_test(nodes_without_a_value_take_points_nowhere),
        cmocka_unit_test(the_way_back_leads_back),
        cmocka_unit_test(folds_are_counted_cell_by_cell),
        cmocka_unit_test(the_whole_is_seen_to_mirror_turn_and_grow),
        cmocka_unit_test(points_without_a_preimage_are_outside),
        cmocka_unit_test(a_field_to_one_point_is_none),
        cmocka_unit_test(splines_are_the_polynomials_of_their_coefficients),
        cmocka_unit_test(splines_end_at_the_last_node_but_one),
        cmocka_unit_test(warps_are_a_chain),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
