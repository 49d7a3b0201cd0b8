/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses that lie or point where they hardly should (conus_pose_check): cones and boxes against many rays, counts by
 * hand. */
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/study/study.h"
#include "test.h"

#include <string.h>

static double random_part(uint64_t *state)
{
    return test_random(state, 0, 1);
}

/* The smallest angle to the axis, as a tangent, of points of the box: points of a fine grid on its faces and inside. */
static double least_slope(const conus_pose *pose, const double low[3], const double high[3])
{
    enum { STEPS = 40 };
    double least = INFINITY;
    for (int n = 0; n < (STEPS + 1) * (STEPS + 1) * (STEPS + 1); n++) {
        const int at[3] = {n % (STEPS + 1), n / (STEPS + 1) % (STEPS + 1), n / (STEPS + 1) / (STEPS + 1)};
        double v[3];
        const double *m = pose->world_from_device;
        for (int a = 0; a < 3; a++) {
            v[a] = low[a] + (high[a] - low[a]) * at[a] / STEPS - m[12 + a];
        }
        double depth = -vec3_dot(m + 8, v);
        if (depth > 0) {
            least = fmin(least, hypot(vec3_dot(m, v), vec3_dot(m + 4, v)) / depth);
        }
    }
    return least;
}

/* No point of the grid is farther than the box, and the box is hardly nearer than the grid. So a cone that holds a
 * point of it never misses the box, and a cone narrower by the grid's spacing does. */
static void a_cone_misses_a_box_that_it_holds_no_point_of(void **state)
{
    (void)state;
    uint64_t random = 3;
    int missed = 0;
    for (int i = 0; i < 300; i++) {
        double low[3];
        double high[3];
        double origin[3];
        double direction[3];
        for (int a = 0; a < 3; a++) {
            low[a] = test_random(&random, -20, 0);
            high[a] = low[a] + test_random(&random, 1, 20);
            origin[a] = test_random(&random, -60, 60);
            direction[a] = test_random(&random, -1, 1);
        }
        struct cone cone = {.resolution = 1};
        assert_ok(conus_pose_along(&cone.pose, origin, direction, NULL));
        double least = least_slope(&cone.pose, low, high);
        bool before = least < INFINITY;
        if (before && least > 0.02) {
            cone.angle = 2 * atan(least * 1.001);
            assert_false(pose_check_past(&cone, low, high));
            cone.angle = 2 * atan(least * 0.9 - 0.02);
            missed += cone.angle > 0 && pose_check_past(&cone, low, high);
        }
        if (!before) {
            cone.angle = radians_from_degrees(170 * random_part(&random) + 1);
            assert_true(pose_check_past(&cone, low, high));
        }
    }
    assert_true(missed > 100);
}

/* By hand: the box [-1, 1]^3, seen from (0, 0, 10) past its edge at x = 1, z = 1: atan(1/9) off straight down. */
static void the_border_is_sharp(void **state)
{
    (void)state;
    const double low[3] = {-1, -1, -1};
    const double high[3] = {1, 1, 1};
    struct cone cone = {.resolution = 1};
    double edge = atan(1.0 / 9);
    double off = edge + radians_from_degrees(20);
    assert_ok(conus_pose_along(&cone.pose, (double[]){0, 0, 10}, (double[]){sin(off), 0, -cos(off)}, NULL));
    cone.angle = 2 * radians_from_degrees(20.0001);
    assert_false(pose_check_past(&cone, low, high));
    cone.angle = 2 * radians_from_degrees(19.9999);
    assert_true(pose_check_past(&cone, low, high));
    cone.aperture = CONUS_APERTURE_SQUARE; /* the cone around the pyramid reaches sqrt(2) tan 20 degrees */
    assert_false(pose_check_past(&cone, low, high));
    assert_ok(conus_pose_along(&cone.pose, (double[]){3, 0, 10}, (double[]){0, 0, -1}, NULL));
    cone.aperture = CONUS_APERTURE_CIRCLE;
    cone.angle = 0;
    cone.radius = 2.001;
    assert_false(pose_check_past(&cone, low, high));
    cone.radius = 1.999;
    assert_true(pose_check_past(&cone, low, high));
    assert_ok(conus_pose_along(&cone.pose, (double[]){0, 0, 0}, (double[]){0, 0, -1}, NULL)); /* inside, looking out */
    assert_false(pose_check_past(&cone, low, high));
}

/* A pose that hits something by conus_select() never counts as missing. */
static void what_is_hit_is_not_missed(void **state)
{
    (void)state;
    uint64_t random = 21;
    int away = 0;
    for (int i = 0; i < 200; i++) {
        conus_atlas *atlas = scene_atlas(&random, 12, 1);
        const struct cone cone = scene_cone(&random, atlas);
        conus_selector *selector = NULL;
        conus_selection *selection = NULL;
        conus_pose_check *check = NULL;
        double low[3];
        double high[3];
        const conus_selector_options options = {.aperture = i % 2 ? CONUS_APERTURE_SQUARE : CONUS_APERTURE_CIRCLE};
        assert_ok(conus_selector_create(&selector, atlas, &options));
        assert_ok(conus_select(&selection, selector, &cone.pose, degrees_from_radians(cone.angle)));
        assert_ok(conus_pose_check_create(&check, selector));
        conus_pose_check_add(check, 1, &cone.pose, degrees_from_radians(cone.angle));
        const conus_pose_findings *found = conus_pose_check_found(check);
        const conus_result *first = conus_selection_result(selection, 0);
        assert_int_equal(found->poses, conus_atlas_bounds(low, high, atlas) == CONUS_OK);
        assert_true(!first->object || found->away.count == 0);
        away += (int)found->away.count;
        if (found->inside.count) {
            assert_near(first->distance, 0, 0);
        }
        conus_pose_check_destroy(check);
        conus_selection_destroy(selection);
        conus_selector_destroy(selector);
        conus_atlas_destroy(atlas);
    }
    assert_true(away > 20);
}

/* 20 mm wide around (x, y, 0): 1 below, 2 above z = 0. */
static conus_atlas *block_at(double x, double y)
{
    uint32_t labels[8] = {1, 1, 1, 1, 2, 2, 2, 2};
    const double m[16] = {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, x - 5, y - 5, -5, 1};
    const conus_volume_info grid = scene_plain_grid((size_t[]){2, 2, 2}, m);
    return scene_parcellation(&grid, labels);
}

static conus_atlas *block(void)
{
    return block_at(0, 0);
}

static conus_pose looking_up_from(double x, double y, double z)
{
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){x, y, z}, (double[]){0, 0, 1}, NULL));
    return pose;
}

static void poses_are_counted_by_kind(void **state)
{
    (void)state;
    static const double places[][3] = {{1, 1, -50}, {0.5, 0.5, 50}, {3, 3, 5}, {3, 3, -5}, {0.5, 0, -0.5}, {40, 0, 0}};
    conus_atlas *atlas = block();
    conus_selector *selector = NULL;
    conus_pose_check *check = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_pose_check_create(&check, selector));
    for (size_t i = 6; i > 0; i--) { /* the lowest number counts, not the first call */
        const conus_pose pose = looking_up_from(places[i - 1][0], places[i - 1][1], places[i - 1][2]);
        conus_pose_check_add(check, i + 1, &pose, 12);
    }
    const conus_pose pose = looking_up_from(0, 0, 0);
    conus_pose_check_add(check, 20, &pose, 181); /* not an angle */
    const conus_pose_findings *found = conus_pose_check_found(check);
    assert_int_equal(found->poses, 6);
    assert_int_equal(found->inside.count, 3);
    assert_int_equal(found->inside.first, 4);
    assert_int_equal(found->inside.object, 2);
    assert_int_equal(found->away.count, 2);
    assert_int_equal(found->away.first, 3);
    assert_near(found->away.angle, 12, 0);
    assert_near(found->away.pose.world_from_device[14], 50, 0);
    assert_int_equal(found->tiny.count, 1);
    assert_int_equal(found->tiny.first, 6);
    conus_pose_findings sum = *found;
    conus_pose_findings more = *found;
    more.inside.first = 2;
    more.inside.object = 1;
    pose_check_merge(&sum, &more);
    pose_check_merge(&sum, &(conus_pose_findings){.poses = 1});
    assert_int_equal(sum.poses, 13);
    assert_int_equal(sum.inside.count, 6);
    assert_int_equal(sum.inside.first, 2);
    assert_int_equal(sum.inside.object, 1);
    assert_int_equal(sum.away.count, 4);
    assert_int_equal(sum.away.first, 3);
    conus_pose_check_destroy(check);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* A needle may begin inside. */
static void a_cylinder_may_begin_inside(void **state)
{
    (void)state;
    conus_atlas *atlas = block();
    conus_selector *selector = NULL;
    conus_pose_check *check = NULL;
    const conus_pose inside = looking_up_from(3, 3, 5);
    const conus_pose beyond = looking_up_from(3, 3, 50);
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.radius = 1}));
    assert_ok(conus_pose_check_create(&check, selector));
    conus_pose_check_add(check, 1, &inside, 0);
    conus_pose_check_add(check, 2, &beyond, 0);
    assert_int_equal(conus_pose_check_found(check)->poses, 2);
    assert_int_equal(conus_pose_check_found(check)->inside.count, 0);
    assert_int_equal(conus_pose_check_found(check)->away.count, 1);
    conus_pose_check_destroy(check);
    conus_pose_check_destroy(NULL);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* From the corner (x + 3, y + 4, z) of the box the distance is 5 mm. */
static void points_may_lie_apart(void **state)
{
    (void)state;
    conus_atlas *atlas = block();
    conus_selector *selector = NULL;
    conus_pose_check *check = NULL;
    double low[3];
    double high[3];
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.radius = 5}));
    assert_ok(conus_pose_check_create(&check, selector));
    assert_ok(conus_atlas_bounds(low, high, atlas));
    const double corner[3] = {high[0] + 3, high[1] + 4, high[2]};
    const double under[3] = {low[0], low[1], low[2] - 6};
    conus_pose_check_add_point(check, 1, low, 5);
    conus_pose_check_add_point(check, 2, corner, 5);
    conus_pose_check_add_point(check, 3, (const double[]){NAN, 0, 0}, 5);
    assert_int_equal(conus_pose_check_found(check)->apart.count, 0);
    conus_pose_check_add_point(check, 7, corner, 4.99);
    conus_pose_check_add_point(check, 5, under, 5);
    const conus_pose_findings *found = conus_pose_check_found(check);
    assert_int_equal(found->points, 4);
    assert_int_equal(found->poses, 0);
    assert_int_equal(found->apart.count, 2);
    assert_int_equal(found->apart.first, 5);
    assert_near(found->apart.pose.world_from_device[14], low[2] - 6, 0);
    conus_pose_findings sum = *found;
    pose_check_merge(&sum, found);
    assert_int_equal(sum.points, 8);
    assert_int_equal(sum.apart.count, 4);
    conus_pose_check_destroy(check);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static uint64_t inside_first(const conus_atlas *atlas, const conus_selector_options *options, const double (*places)[3],
                             size_t count, uint32_t *object)
{
    conus_selector *selector = NULL;
    conus_pose_check *check = NULL;
    assert_ok(conus_selector_create(&selector, atlas, options));
    assert_ok(conus_pose_check_create(&check, selector));
    for (size_t i = 0; i < count; i++) {
        const conus_pose pose = looking_up_from(places[i][0], places[i][1], places[i][2]);
        conus_pose_check_add(check, i + 1, &pose, degrees_from_radians(options->radius > 0 ? 0 : 0.2));
    }
    const conus_pose_finding inside = conus_pose_check_found(check)->inside;
    assert_true(inside.count <= 1);
    *object = inside.object;
    conus_pose_check_destroy(check);
    conus_selector_destroy(selector);
    return inside.count ? inside.first : 0;
}

/* A box of 20 mm that faces inwards; number 2 is a box in it of 4 mm, number 3 an open box elsewhere. The coordinates
 * show where points lie. */
static void a_device_may_lie_inside_a_closed_surface(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh outer = mesh_scene_box((double[]){-10, -10, -10}, (double[]){10, 10, 10});
    struct mesh inner = mesh_scene_box((double[]){1, 1, 1}, (double[]){5, 5, 5});
    struct mesh open = mesh_scene_box((double[]){30, -10, -10}, (double[]){50, 10, 10});
    const conus_selector_options plain = {0};
    uint32_t object;
    mesh_scene_turn(&outer); /* its volume is below 0 */
    open.triangle_count--;   /* the rest is not closed */
    mesh_scene_add(atlas, &outer);
    mesh_scene_add(atlas, &inner);
    mesh_scene_add(atlas, &open);
    assert_false(atlas_object_mesh(atlas, 3)->shape.closed);
    assert_int_equal(inside_first(atlas, &plain, (const double[][3]){{-2, 0.3, 0.1}}, 1, &object), 1);
    assert_int_equal(object, 1);
    assert_int_equal(inside_first(atlas, &plain, (const double[][3]){{2, 2.3, 2.1}}, 1, &object), 1);
    assert_int_equal(object, 2); /* in both, and that is the smaller */
    const double none[][3] = {{40, 0.3, 0.1}, {0.1, 0.3, -11}, {0.1, 0.3, 11}, {-11, 0.3, 0.1}, {0.2, 10.5, 0.1}};
    assert_int_equal(inside_first(atlas, &plain, none, 5, &object), 0);
    const conus_selector_options needle = {.radius = 1};
    assert_int_equal(inside_first(atlas, &needle, (const double[][3]){{-2, 0.3, 0.1}}, 1, &object), 0);
    conus_atlas_destroy(atlas);
}

/* Boxes of 4 and of 20 mm around a point, the smaller one first or last in the atlas: the smaller one counts. */
static void the_smallest_surface_around_counts_in_any_order(void **state)
{
    (void)state;
    const conus_selector_options plain = {0};
    for (int smaller = 1; smaller <= 3; smaller++) {
        conus_atlas *atlas = mesh_scene_atlas();
        for (int i = 1; i <= 3; i++) {
            double half = i == smaller ? 2 : 10 + i;
            struct mesh box = mesh_scene_box((double[]){-half, -half, -half}, (double[]){half, half, half});
            mesh_scene_add(atlas, &box);
        }
        uint32_t object;
        assert_int_equal(inside_first(atlas, &plain, (const double[][3]){{0.1, 0.3, 0.2}}, 1, &object), 1);
        assert_int_equal(object, smaller);
        conus_atlas_destroy(atlas);
    }
}

/* In the box around a torus of radii 10 and 3 mm only places in its tube are inside. */
static void the_box_of_a_surface_is_not_its_inside(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh torus = mesh_scene_torus(10, 3, 64, 32);
    const conus_selector_options plain = {0};
    uint32_t object;
    mesh_scene_add(atlas, &torus);
    const double none[][3] = {{0.1, 0.2, 0}, {10.5, 10.5, 0.2}, {9, 0.3, -2.95}};
    const double last[][3] = {{0.1, 0.2, 0}, {10.5, 10.5, 0.2}, {9, 0.3, -1}};
    assert_int_equal(inside_first(atlas, &plain, none, 3, &object), 0);
    assert_int_equal(inside_first(atlas, &plain, last, 3, &object), 3);
    assert_int_equal(object, 1);
    const conus_selector_options sliced = {.sampling = CONUS_SAMPLING_SLICES};
    assert_int_equal(inside_first(atlas, &sliced, last, 3, &object), 0); /* slices know no inside */
    conus_atlas_destroy(atlas);
}

/* Counts a pose that looks along `forward`, and reads it. */
static conus_pose_suggestion reading_of(conus_selector *selector, const double from[3], const double forward[3])
{
    conus_pose_check *check = NULL;
    conus_pose pose;
    conus_pose_suggestion reading = {.object = 99};
    assert_ok(conus_pose_check_create(&check, selector));
    assert_ok(conus_pose_along(&pose, from, forward, NULL));
    conus_pose_check_add(check, 1, &pose, degrees_from_radians(0.2));
    assert_ok(conus_pose_check_suggest(&reading, conus_pose_check_found(check), selector));
    conus_pose_check_destroy(check);
    return reading;
}

/* All poses were meant to be at (160, 42, -5) and to look along -x, which hits 1 at x = 110. If x and y change their
 * signs, the cone passes the block at a distance of 72 - 270 tan 0.1 = 45 mm or more. */
static void a_pose_is_read_in_other_ways(void **state)
{
    (void)state;
    static const struct {
        double from[3], forward[3];
        bool of_tiny;
        const char *words;
    } cases[] = {
        {{-160, -42, -5}, {1, 0, 0}, false, "with x and y negated (LPS for RAS)"},
        {{160, 42, -5}, {1, 0, 0}, false, "looking the other way"},
        {{-160, -42, -5}, {-1, 0, 0}, false, "with x and y of its position negated (LPS for RAS)"},
        {{0.16, 0.042, -0.005}, {-1, 0, 0}, true, "with its position times 1000 (metres for mm)"},
        {{-0.16, -0.042, -0.005}, {1, 0, 0}, true, "with x and y negated (LPS for RAS) and times 1000 (metres)"},
        {{16e4, 4.2e4, -5e3}, {-1, 0, 0}, false, "with its position divided by 1000 (micrometres for mm)"},
        {{-16e4, -4.2e4, -5e3}, {1, 0, 0}, false, "with x and y negated (LPS for RAS) and divided by 1000"},
    };
    conus_atlas *atlas = block_at(100, 40);
    conus_selector *selector = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const conus_pose_suggestion reading = reading_of(selector, cases[i].from, cases[i].forward);
        const double *m = reading.pose.world_from_device;
        assert_int_equal(reading.object, 1);
        assert_int_equal(reading.of_tiny, cases[i].of_tiny);
        assert_string_equal(reading.words, cases[i].words);
        assert_near(m[12], 160, 1e-9);
        assert_near(m[13], 42, 1e-9);
        assert_near(m[14], -5, 1e-9);
        assert_near(m[8], 1, 1e-12); /* its own -z is its axis */
    }
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* From (0, 0, 50) no reading of an upward pose hits the block, and a pose that hits needs none. The last pose hits the
 * block from less than 1 mm: with x and y of its position negated it would, too, but for such a pose only the unit is
 * doubted, and from (200, 80, 0) it points away. */
static void a_pose_may_have_no_other_reading(void **state)
{
    (void)state;
    static const double places[][3] = {{0, 0, 50}, {0.1, 0.1, 0.05}, {100, 40, -50}, {0.2, 0.08, 0}};
    static const double ways[][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {1, 0.4, 0}};
    conus_atlas *atlas = block_at(100, 40);
    conus_selector *selector = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    for (size_t i = 0; i < 4; i++) {
        const conus_pose_suggestion reading = reading_of(selector, places[i], ways[i]);
        assert_int_equal(reading.object, 0);
        assert_false(reading.of_tiny);
        assert_null(reading.words);
    }
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static void a_reading_without_memory_is_an_error(void **state)
{
    (void)state;
    conus_atlas *atlas = block();
    conus_selector *selector = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    conus_pose_findings found = {.away = {.count = 1, .angle = 12, .pose = looking_up_from(1, 1, 50)}};
    conus_pose_suggestion reading = {.object = 99};
    long failures = 0;
    conus_status status = CONUS_ERROR_MEMORY;
    while (status) {
        test_fail_allocation(failures++);
        status = conus_pose_check_suggest(&reading, &found, selector);
        test_fail_allocation(-1);
        assert_true(status == CONUS_OK || status == CONUS_ERROR_MEMORY);
        assert_int_equal(reading.object, status ? 99 : 2);
    }
    assert_true(failures > 1);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(pose_check)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cone_misses_a_box_that_it_holds_no_point_of),
        cmocka_unit_test(the_border_is_sharp),
        cmocka_unit_test(what_is_hit_is_not_missed),
        cmocka_unit_test(poses_are_counted_by_kind),
        cmocka_unit_test(a_cylinder_may_begin_inside),
        cmocka_unit_test(points_may_lie_apart),
        cmocka_unit_test(a_device_may_lie_inside_a_closed_surface),
        cmocka_unit_test(the_smallest_surface_around_counts_in_any_order),
        cmocka_unit_test(the_box_of_a_surface_is_not_its_inside),
        cmocka_unit_test(a_pose_is_read_in_other_ways),
        cmocka_unit_test(a_pose_may_have_no_other_reading),
        cmocka_unit_test(a_reading_without_memory_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
