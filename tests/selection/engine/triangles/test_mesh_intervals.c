/* SPDX-License-Identifier: BSD-3-Clause */
/* From crossings to intervals (Eq. 10), with crossings made by hand. */
#include "conus/selection.h"
#include "mesh_scene.h"
#include "test.h"

#include <string.h>

/* Objects of the atlas: spheres of radius 10 at 0 of 8 x 12 quadrilaterals; the last is a half, open below. */
enum { CLOSED = 1, INWARD, HALF };

enum { RINGS = 8, SECTORS = 12 };

/* Triangles of the sphere without a common corner, and two that share an edge with the first. */
enum { SOUTH = 0, MIDDLE = 60, NORTH = 150, BESIDE_MIDDLE = 61 };

static conus_atlas *make_atlas(void)
{
    conus_atlas *atlas = mesh_scene_atlas();
    for (int object = CLOSED; object <= HALF; object++) {
        struct mesh sphere = mesh_scene_sphere((double[]){0, 0, 0}, 10, RINGS, SECTORS);
        if (object == INWARD) {
            mesh_scene_turn(&sphere);
        } else if (object == HALF) {
            size_t dropped = sphere.triangle_count / 2;
            memmove(sphere.triangles, sphere.triangles + 3 * dropped, 3 * dropped * sizeof *sphere.triangles);
            sphere.triangle_count -= dropped;
        }
        mesh_scene_add(atlas, &sphere);
    }
    return atlas;
}

/* An interval, and the crossings that lead to it. */
struct crossed {
    int side;
    double t;
    uint32_t triangle;
};

struct interval {
    double entry, exit;
    uint32_t triangle;
};

/* One ray from @p depth below 0 on the z axis, through crossings in the wrong order. */
static void assert_intervals(uint32_t object, double depth, const struct crossed *crossed, size_t count,
                             const struct interval *wanted, size_t wanted_count)
{
    conus_atlas *atlas = make_atlas();
    struct mesh_intervals intervals;
    struct layers layers = {0};
    struct cone cone = mesh_scene_cone((double[]){0, 0, -depth}, (double[]){0, 0, 100}, 1, 1);
    mesh_intervals_init(&intervals, atlas);
    for (size_t i = 0; i < count; i++) {
        const struct crossed *c = &crossed[(i * 7 + 3) % count];
        assert_true(count % 7 != 0);
        assert_ok(mesh_intervals_add(&intervals, &(struct crossing){0, object, c->triangle, c->side, c->t}));
    }
    assert_ok(mesh_intervals_pair(&layers, &intervals, &cone));
    assert_int_equal(intervals.count, 0);
    assert_int_equal(layers.count, wanted_count);
    for (size_t i = 0; i < wanted_count; i++) {
        assert_int_equal(layers.intervals[i].object, object);
        assert_int_equal(layers.intervals[i].voxel, wanted[i].triangle);
        assert_near(layers.intervals[i].entry, wanted[i].entry, 0);
        assert_near(layers.intervals[i].exit, wanted[i].exit, 0);
    }
    layers_finish(&layers);
    mesh_intervals_finish(&intervals);
    conus_atlas_destroy(atlas);
}

#define CROSSED(...)                                                                                                   \
    (const struct crossed[]){__VA_ARGS__}, sizeof((struct crossed[]){__VA_ARGS__}) / sizeof(struct crossed)
#define INTERVALS(...)                                                                                                 \
    (const struct interval[]){__VA_ARGS__}, sizeof((struct interval[]){__VA_ARGS__}) / sizeof(struct interval)

static void an_interval_is_from_entry_to_exit(void **state)
{
    (void)state;
    assert_intervals(CLOSED, 30, CROSSED({1, 20, SOUTH}, {-1, 40, NORTH}), INTERVALS({20, 40, SOUTH}));
    assert_intervals(CLOSED, 30, CROSSED({1, 20, SOUTH}, {-1, 25, MIDDLE}, {1, 30, NORTH}, {-1, 40, SOUTH}),
                     INTERVALS({20, 25, SOUTH}, {30, 40, NORTH}));
}

static void an_inward_mesh_is_turned_around(void **state)
{
    (void)state;
    assert_intervals(INWARD, 30, CROSSED({-1, 20, SOUTH}, {1, 40, NORTH}), INTERVALS({20, 40, SOUTH}));
}

static void nested_and_overlapping_shells_are_one(void **state)
{
    (void)state;
    assert_intervals(CLOSED, 30, CROSSED({1, 20, 1}, {1, 25, MIDDLE}, {-1, 30, NORTH}, {-1, 40, 9}),
                     INTERVALS({20, 40, 1}));
    assert_intervals(CLOSED, 30,
                     CROSSED({1, 20, 1}, {1, 21, MIDDLE}, {-1, 22, 5}, {1, 23, NORTH}, {-1, 24, 70}, {-1, 40, 9}),
                     INTERVALS({20, 40, 1}));
}

static void a_cavity_is_left_out(void **state)
{
    (void)state;
    assert_intervals(CLOSED, 30, CROSSED({1, 20, 1}, {-1, 25, MIDDLE}, {1, 35, NORTH}, {-1, 40, 9}),
                     INTERVALS({20, 25, 1}, {35, 40, NORTH}));
}

static void an_edge_counts_once(void **state)
{
    (void)state;
    const double near = 20 + 1e-6;
    assert_intervals(CLOSED, 30, CROSSED({1, 20, MIDDLE}, {1, 20, BESIDE_MIDDLE}, {-1, 40, NORTH}),
                     INTERVALS({20, 40, MIDDLE}));
    assert_intervals(CLOSED, 30, CROSSED({1, 20, BESIDE_MIDDLE}, {1, near, MIDDLE}, {-1, 40, NORTH}),
                     INTERVALS({20, 40, BESIDE_MIDDLE}));
    assert_intervals(CLOSED, 5, CROSSED({-1, 20, BESIDE_MIDDLE}, {-1, near, MIDDLE}),
                     INTERVALS({0, 20, BESIDE_MIDDLE}));
    assert_intervals(CLOSED, 5, CROSSED({1, 3, 150}, {-1, 20, BESIDE_MIDDLE}, {-1, near, MIDDLE}, {-1, near, MIDDLE}),
                     INTERVALS({3, 20, 150}));
}

/* Every triangle of this sphere has separate vertices. A ray through the pole finds all of the south cap, which count
 * once. */
static void vertices_at_equal_positions_are_one_corner(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh sphere = mesh_scene_sphere((double[]){0, 0, 0}, 10, RINGS, SECTORS);
    struct mesh apart;
    assert_ok(mesh_init(&apart, 3 * sphere.triangle_count, sphere.triangle_count));
    for (uint32_t i = 0; i < 3 * sphere.triangle_count; i++) {
        memcpy(&apart.positions[3 * (size_t)i], &sphere.positions[3 * (size_t)sphere.triangles[i]], 3 * sizeof(float));
        apart.triangles[i] = i;
    }
    mesh_finish(&sphere);
    mesh_scene_add(atlas, &apart);
    struct mesh_intervals intervals;
    struct layers layers = {0};
    struct cone cone = mesh_scene_cone((double[]){0, 0, -30}, (double[]){0, 0, 100}, 1, 1);
    mesh_intervals_init(&intervals, atlas);
    for (uint32_t cap = 0; cap < SECTORS; cap++) {
        assert_ok(mesh_intervals_add(&intervals, &(struct crossing){0, 1, cap, 1, 20 + 1e-9 * cap}));
    }
    assert_ok(mesh_intervals_add(&intervals, &(struct crossing){0, 1, NORTH, -1, 40}));
    assert_ok(mesh_intervals_pair(&layers, &intervals, &cone));
    assert_int_equal(layers.count, 1);
    assert_near(layers.intervals[0].entry, 20, 0);
    assert_near(layers.intervals[0].exit, 40, 0);
    layers_finish(&layers);
    mesh_intervals_finish(&intervals);
    conus_atlas_destroy(atlas);
}

static void a_graze_has_no_length_whichever_way_round(void **state)
{
    (void)state;
    const double near = 20 + 1e-6;
    assert_intervals(CLOSED, 30, CROSSED({1, 20, MIDDLE}, {-1, near, BESIDE_MIDDLE}), INTERVALS({20, near, MIDDLE}));
    assert_intervals(CLOSED, 5, CROSSED({-1, 20, MIDDLE}, {1, near, BESIDE_MIDDLE}), INTERVALS({20, near, MIDDLE}));
    assert_intervals(CLOSED, 5, CROSSED({0, 20, MIDDLE}, {0, 20, BESIDE_MIDDLE}), INTERVALS({20, 20, MIDDLE}));
}

static void an_interval_begins_at_an_apex_inside(void **state)
{
    (void)state;
    assert_intervals(CLOSED, 0, CROSSED({-1, 10, NORTH}), INTERVALS({0, 10, NORTH}));
    assert_intervals(INWARD, 0, CROSSED({1, 10, NORTH}), INTERVALS({0, 10, NORTH}));
    assert_intervals(CLOSED, 0, CROSSED({-1, 3, SOUTH}, {1, 5, MIDDLE}, {-1, 10, NORTH}),
                     INTERVALS({0, 3, SOUTH}, {5, 10, MIDDLE}));
    assert_intervals(CLOSED, 0, CROSSED({-1, 3, SOUTH}, {-1, 10, NORTH}),
                     INTERVALS({0, 10, SOUTH})); /* in two shells */
}

static void what_has_no_partner_has_no_length(void **state)
{
    (void)state;
    assert_intervals(CLOSED, 30, CROSSED({-1, 10, NORTH}), INTERVALS({10, 10, NORTH})); /* the apex is outside */
    assert_intervals(HALF, 0, CROSSED({-1, 10, 80}), INTERVALS({10, 10, 80}));
    assert_intervals(HALF, 30, CROSSED({1, 10, 80}), INTERVALS({10, 10, 80}));
    assert_intervals(HALF, 30, CROSSED({1, 10, 1}, {-1, 12, 80}), INTERVALS({10, 12, 1}));
    assert_intervals(HALF, 30, CROSSED({1, 10, 1}, {1, 12, 40}, {-1, 14, 80}), INTERVALS({10, 10, 1}, {12, 14, 40}));
}

/* Pixels and objects at random: each ray passes each object once, and its interval comes back whole. */
static void crossings_may_come_in_any_order(void **state)
{
    (void)state;
    enum { SIDE = 9, PIXELS = SIDE * SIDE, COUNT = 2 * PIXELS * 2 * 40 };
    conus_atlas *atlas = make_atlas();
    struct cone cone = mesh_scene_cone((double[]){0, 0, -30}, (double[]){0, 0, 100}, 1, SIDE);
    struct mesh_intervals intervals;
    struct layers layers = {0};
    mesh_intervals_init(&intervals, atlas);
    for (uint32_t round = 0; round < 2; round++) {
        for (uint32_t i = 0; i < COUNT; i++) {
            uint32_t k = (uint32_t)((uint64_t)i * 10007 % COUNT);
            uint32_t pixel = k % PIXELS, object = 1 + k / PIXELS % 2, step = k / PIXELS / 2;
            int side = (step % 2 ? -1 : 1) * (object == INWARD ? -1 : 1);
            assert_ok(mesh_intervals_add(&intervals, &(struct crossing){pixel, object, step, side, pixel + step}));
        }
        layers_clear(&layers);
        assert_ok(mesh_intervals_pair(&layers, &intervals, &cone));
        assert_int_equal(layers.count, COUNT / 2);
        for (uint32_t i = 0; i < layers.count; i++) {
            const conus_interval *interval = &layers.intervals[i];
            assert_int_equal(interval->voxel % 2, 0);
            assert_near(interval->entry, interval->pixel + (double)interval->voxel, 0);
            assert_near(interval->exit, interval->entry + 1, 0);
        }
    }
    layers_finish(&layers);
    mesh_intervals_finish(&intervals);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(mesh_intervals)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_interval_is_from_entry_to_exit),
        cmocka_unit_test(an_inward_mesh_is_turned_around),
        cmocka_unit_test(nested_and_overlapping_shells_are_one),
        cmocka_unit_test(a_cavity_is_left_out),
        cmocka_unit_test(an_edge_counts_once),
        cmocka_unit_test(vertices_at_equal_positions_are_one_corner),
        cmocka_unit_test(a_graze_has_no_length_whichever_way_round),
        cmocka_unit_test(an_interval_begins_at_an_apex_inside),
        cmocka_unit_test(what_has_no_partner_has_no_length),
        cmocka_unit_test(crossings_may_come_in_any_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
