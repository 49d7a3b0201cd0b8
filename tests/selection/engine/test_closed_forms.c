/* SPDX-License-Identifier: BSD-3-Clause */
/* Phantoms through the public interface, against answers worked out on paper.
 *
 * A painted shape holds every voxel whose centre is inside. So with d half a voxel's diagonal it contains the shape
 * shrunk by d and lies in the shape grown by d, and the hits of these two are bounds for a ray's hit (Eq. 5). */
#include "atlas/phantom/phantom.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "selection/cone/cone.h"
#include "test.h"

#include <string.h>

struct view {
    struct phantom_drawing drawing;
    conus_atlas *atlas;
    conus_selector *selector;
    conus_selection *selection;
    conus_pose pose;
    double angle;
    double slack; /* d */
};

static void open_selector(struct view *view, uint32_t resolution, const char *score)
{
    const conus_selector_options options = {.engine = CONUS_ENGINE_RAYS, .resolution = resolution, .score = score};
    conus_selector_destroy(view->selector);
    assert_ok(conus_selector_create(&view->selector, view->atlas, &options));
}

static struct view open_phantom(const char *kind, const conus_phantom_options *options, uint32_t resolution)
{
    struct view view = {0};
    assert_ok(phantom_draw(&view.drawing, kind, options));
    assert_ok(phantom_drawing_atlas(&view.atlas, &view.drawing));
    open_selector(&view, resolution, NULL);
    view.slack = vec3_length(view.drawing.grid.spacing) / 2;
    return view;
}

static void close_view(struct view *view)
{
    conus_selection_destroy(view->selection);
    conus_selector_destroy(view->selector);
    conus_atlas_destroy(view->atlas);
    phantom_drawing_finish(&view->drawing);
}

static void aim(struct view *view, const conus_pose *pose, double degrees)
{
    conus_selection_destroy(view->selection);
    view->selection = NULL;
    view->pose = *pose;
    view->angle = radians_from_degrees(degrees);
    assert_ok(conus_select(&view->selection, view->selector, pose, degrees_from_radians(view->angle)));
}

static void aim_along(struct view *view, const double origin[3], const double direction[3], double degrees)
{
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, origin, direction, NULL));
    aim(view, &pose, degrees);
}

/* The result of the area with this label, or NULL. */
static const conus_result *result_of(const struct view *view, uint32_t label)
{
    for (size_t i = 0; i < conus_selection_count(view->selection); i++) {
        const conus_result *result = conus_selection_result(view->selection, i);
        if (result->object && conus_atlas_object(view->atlas, result->object)->label == label) {
            return result;
        }
    }
    return NULL;
}

/* Fails unless the whole cone hits the one area `label` first, 0 for none. */
static void assert_only(const struct view *view, uint32_t label)
{
    const conus_result *first = conus_selection_result(view->selection, 0);
    const conus_object *area = conus_atlas_object(view->atlas, first->object);
    assert_int_equal(area ? area->label : 0, label);
    assert_near(first->share, 1, 1e-12);
    assert_int_equal(conus_selection_count(view->selection), label ? 2 : 1);
}

static const conus_phantom_options grids[] = {
    {0},
    {.size = 128, .spacing = {0.5, 0.5, 0.5}},
    {.spacing = {1, 1, 2.5}, .flip = {true, false, false}},
    {.oblique = 0.7 * 180 / MATH3_PI, .flip = {false, true, true}},
    {.size = 96, .spacing = {2.0 / 3, 1, 0.8}, .oblique = -1.9 * 180 / MATH3_PI, .flip = {true, true, true}},
};
enum { GRIDS = sizeof grids / sizeof grids[0] };

/* A ring seen from its axis (a sphere is a ring of radius 0). */

struct ring {
    double distance; /* of the apex from the ring's plane */
    double radius, tube;
};

/* By symmetry each ray lies in a half-plane through the axis, in which the ring is one disc. Its centre is at an angle
 * of `towards` to the axis, `away` from the apex. */
static double ring_away(const struct ring *ring)
{
    return hypot(ring->distance, ring->radius);
}

static double ring_towards(const struct ring *ring)
{
    return atan2(ring->radius, ring->distance);
}

/* Distance along a ray at the angle `off` to the axis; INFINITY = it misses. */
static double ring_distance(const struct ring *ring, double off)
{
    double away = ring_away(ring);
    double beside = away * sin(off - ring_towards(ring));
    return ring->tube > fabs(beside)
               ? away * cos(off - ring_towards(ring)) - sqrt(ring->tube * ring->tube - beside * beside)
               : INFINITY;
}

/* Part of the cone's solid angle (Eq. 4): (1 - cos asin(R / D)) / (1 - cos(angle / 2)) for a sphere. */
static double ring_share(const struct ring *ring, double angle)
{
    double half = asin(ring->tube / ring_away(ring));
    double inner = fmax(ring_towards(ring) - half, 0);
    double outer = fmin(ring_towards(ring) + half, angle / 2);
    return (cos(inner) - cos(outer)) / (1 - cos(angle / 2));
}

static struct ring ring_grown(struct ring ring, double by)
{
    ring.tube += by;
    return ring;
}

/* Pixels are decided by their centres, so the area that is counted wrongly lies within half a pixel's diagonal of a
 * border: of the object's borders and, for the whole by which it is divided, of the cone's. A circle of rho pixels has
 * a band of pi (sqrt(2) rho + 1/2) square pixels on either side; the cone has pi n^2 / 4. The heaviest pixel of Eq. 4
 * weighs tan^2(angle/2) / (2 (1 - cos(angle/2))) times the mean. The bound shrinks with 1/n. */
static double pixel_bound(const struct ring *ring, double share, double angle, uint32_t n)
{
    double slope = tan(angle / 2);
    double half = asin(ring->tube / ring_away(ring));
    double border = tan(ring_towards(ring) + half) + fmax(tan(ring_towards(ring) - half), 0); /* rho of both circles */
    double heaviest = slope * slope / (2 * (1 - cos(angle / 2)));
    double object_band = (2 * sqrt(2) * border / slope / n + 4.0 / n / n) * heaviest;
    double cone_band = (2 * sqrt(2) / n + 2.0 / n / n) * heaviest;
    return object_band + share * cone_band;
}

static void check_rays(const struct view *view, const struct ring *ring)
{
    conus_evidence evidence = conus_selection_evidence(view->selection);
    uint32_t n = evidence.resolution;
    const struct cone cone = {.pose = view->pose, .angle = view->angle, .resolution = n};
    const struct ring grown = ring_grown(*ring, view->slack);
    const struct ring shrunk = ring_grown(*ring, -view->slack);
    for (uint32_t pixel = 0; pixel < n * n; pixel++) {
        double off = atan(cone_radius(&cone, pixel % n, pixel / n) * tan(view->angle / 2));
        assert_true(evidence.distance[pixel] >= ring_distance(&grown, off) - 1e-9);
        assert_true(evidence.distance[pixel] <= ring_distance(&shrunk, off) + 1e-9);
        assert_int_equal(evidence.object[pixel], isfinite(evidence.distance[pixel]));
    }
}

/* Eq. 3, 4, 5, 11: every ray's distance, the share, and the contact on the axis. */
static void check_ring(struct view *view, const struct ring *ring, double degrees, uint32_t n)
{
    double direction[3] = {0, 0, -1};
    double origin[3] = {0, 0, ring->distance};
    aim_along(view, origin, direction, degrees);
    check_rays(view, ring);
    const conus_result *result = result_of(view, 1);
    double share = ring_share(ring, view->angle);
    const struct ring grown = ring_grown(*ring, view->slack);
    const struct ring shrunk = ring_grown(*ring, -view->slack);
    double voxel_bound = ring_share(&grown, view->angle) - ring_share(&shrunk, view->angle);
    assert_near(result ? result->share : 0, share, voxel_bound + pixel_bound(ring, share, view->angle, n));
    if (n % 2 && ring->radius == 0) {
        assert_near(result->distance, ring->distance - ring->tube, view->slack);
        assert_near(result->contact[0], 0, 1e-9);
        assert_near(result->contact[1], 0, 1e-9);
        assert_near(result->contact[2], ring->tube, view->slack);
        assert_near(result->centre_px, 0, 1e-12);
        assert_near(result->offset, 0, 1e-12);
    }
}

static void a_sphere_has_its_solid_angle(void **state)
{
    (void)state;
    for (size_t g = 0; g < GRIDS; g++) {
        for (uint32_t n = 1; n <= 64; n += g ? 9 : 1) {
            struct view view = open_phantom("sphere", &grids[g], n);
            check_ring(&view, &(struct ring){.distance = 45, .tube = 20}, 70, n);
            check_ring(&view, &(struct ring){.distance = 100, .tube = 20}, 30, n);
            check_ring(&view, &(struct ring){.distance = 1000, .tube = 20}, 5, n);
            close_view(&view);
        }
    }
}

static void a_torus_has_its_annulus(void **state)
{
    (void)state;
    for (size_t g = 0; g < GRIDS; g++) {
        for (uint32_t n = 1; n <= 64; n += 9) {
            struct view view = open_phantom("torus", &grids[g], n);
            check_ring(&view, &(struct ring){.distance = 50, .radius = 18, .tube = 6}, 75, n);
            check_ring(&view, &(struct ring){.distance = 150, .radius = 18, .tube = 6}, 25, n);
            close_view(&view);
        }
    }
}

/* With many pixels, the share's error halves with the voxel's edge: a silhouette of voxels is that of the shape grown
 * by about half a voxel (measured: 5.4 % and 2.8 % of this share at 1 and 1/2 mm). */
static void shares_converge(void **state)
{
    (void)state;
    for (uint32_t fineness = 1; fineness <= 4; fineness *= 2) {
        double edge = 2.0 / fineness;
        const conus_phantom_options options = {.size = 32 * fineness, .spacing = {edge, edge, edge}};
        struct view view = open_phantom("sphere", &options, 400);
        const struct ring sphere = {.distance = 100, .tube = 20};
        aim_along(&view, (double[]){60, 64, 48}, (double[]){-60, -64, -48}, 30);
        double share = ring_share(&sphere, view.angle);
        assert_near(result_of(&view, 1)->share, share, 0.06 * edge * share);
        close_view(&view);
    }
}

static void the_first_slab_hides_the_second(void **state)
{
    (void)state;
    struct view view = open_phantom("slabs", NULL, 16);
    aim_along(&view, (double[]){3.3, 100, 2.2}, (double[]){0, -1, 0}, 10);
    assert_only(&view, 1);
    assert_near(result_of(&view, 1)->distance, 88 / cos(atan(tan(view.angle / 2) * sqrt(2) / 16)), 1e-9);
    aim_along(&view, (double[]){3.3, -100, 2.2}, (double[]){0, 1, 0}, 10);
    assert_only(&view, 300);
    aim_along(&view, (double[]){3.3, 0, 2.2}, (double[]){0, 1, 0}, 10); /* from between them */
    assert_only(&view, 1);
    assert_near(result_of(&view, 1)->contact[1], 6, 1e-9);
    close_view(&view);
}

static void the_outermost_of_nested_balls_is_hit(void **state)
{
    (void)state;
    static const struct {
        double z;
        uint32_t label;
        double distance;
    } cases[] = {{100, 1, 76}, {20, 1, 0}, {12, 300, 0}, {0, 4000000001U, 0}};
    for (size_t g = 0; g < GRIDS; g++) {
        struct view view = open_phantom("nested", &grids[g], 15);
        for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
            aim_along(&view, (double[]){0, 0, cases[i].z}, (double[]){0, 0, -1}, 8);
            assert_only(&view, cases[i].label);
            assert_near(result_of(&view, cases[i].label)->distance, cases[i].distance,
                        cases[i].distance > 0 ? view.slack : 0); /* an apex inside is at distance 0 */
        }
        close_view(&view);
    }
}

static void through_the_hole_of_a_torus_there_is_nothing(void **state)
{
    (void)state;
    for (size_t g = 0; g < GRIDS; g++) {
        struct view view = open_phantom("torus", &grids[g], 16);
        aim_along(&view, (double[]){0, 0, 80}, (double[]){0, 0, -1}, 12);
        assert_only(&view, 0);
        aim_along(&view, (double[]){0, 0, 0}, (double[]){1, 1, 0}, 12); /* from the hole, outwards */
        assert_only(&view, 1);
        assert_near(result_of(&view, 1)->distance, 12, view.slack);
        close_view(&view);
    }
}

/* The paper's Figure 1: an object between the arms of a U is inside the U's bounding box. */
static void a_bounding_box_selects_nothing(void **state)
{
    (void)state;
    for (size_t g = 0; g < GRIDS; g++) {
        struct view view = open_phantom("u-shape", &grids[g], 16);
        aim_along(&view, (double[]){0, 0, 60}, (double[]){0, 0, -1}, 4); /* through the gap onto the ball */
        assert_only(&view, 2);
        assert_near(result_of(&view, 2)->distance, 49, view.slack);
        aim_along(&view, (double[]){0, 60, 6}, (double[]){0, -1, 0}, 4); /* from the front, onto the ball */
        assert_only(&view, 2);
        aim_along(&view, (double[]){8.5, 60, 8}, (double[]){0, -1, 0}, 2); /* between ball and arm, right through */
        assert_only(&view, 0);
        aim_along(&view, (double[]){17, 60, 8}, (double[]){0, -1, 0}, 4); /* onto the arm */
        assert_only(&view, 1);
        aim_along(&view, (double[]){0, 0, 60}, (double[]){0, 0, -1}, 40); /* both */
        assert_non_null(result_of(&view, 1));
        assert_non_null(result_of(&view, 2));
        close_view(&view);
    }
}

/* From the middle of its circle a tube is seen from the side, at the circle's radius less its own. */
static void tubes_are_hit_at_their_wall(void **state)
{
    (void)state;
    for (size_t g = 0; g < 2; g++) {
        struct view view = open_phantom("tubes", &grids[g], 1);
        for (size_t s = 1; s < view.drawing.phantom->shape_count; s++) { /* a tube of 1 voxel has gaps */
            const struct phantom_shape *tube = &view.drawing.shapes[s];
            for (int step = 0; step < 75; step++) {
                double off = radians_from_degrees(25 + 1.7 * step);
                aim_along(&view, tube->centre, (double[]){0, cos(off), sin(off)}, 1);
                assert_only(&view, tube->label);
                assert_near(result_of(&view, tube->label)->distance, tube->radius - tube->tube, view.slack);
            }
        }
        close_view(&view);
    }
}

static void random_pose(conus_pose *pose, uint64_t *random)
{
    double origin[3];
    double target[3];
    for (int axis = 0; axis < 3; axis++) {
        origin[axis] = test_random(random, -80, 80);
        target[axis] = test_random(random, -20, 20);
    }
    assert_ok(conus_pose_toward(pose, origin, target, NULL));
}

/* Eq. 4 for any object, any position and any number of pixels. */
static void shares_sum_to_one(void **state)
{
    (void)state;
    uint64_t random = 11;
    for (size_t kind = 0; phantom_entry(kind); kind++) {
        struct view view = open_phantom(phantom_entry(kind)->info.name, &grids[kind % GRIDS], 1);
        for (uint32_t n = 1; n <= 64; n++) {
            conus_pose pose;
            double sum = 0;
            uint32_t pixels = 0;
            open_selector(&view, n, NULL);
            random_pose(&pose, &random);
            aim(&view, &pose, test_random(&random, 1, 170));
            for (size_t i = 0; i < conus_selection_count(view.selection); i++) {
                sum += conus_selection_result(view.selection, i)->share;
                pixels += conus_selection_result(view.selection, i)->pixels;
            }
            conus_evidence evidence = conus_selection_evidence(view.selection);
            for (uint32_t i = 0; i < n * n; i++) {
                pixels -= evidence.in_cone[i];
            }
            assert_near(sum, 1, 1e-6);
            assert_int_equal(pixels, 0);
        }
        close_view(&view);
    }
}

static void assert_same_pixels(const struct view *a, const struct view *b, bool mirrored)
{
    conus_evidence first = conus_selection_evidence(a->selection);
    conus_evidence second = conus_selection_evidence(b->selection);
    uint32_t n = first.resolution;
    for (uint32_t pixel = 0; pixel < n * n; pixel++) {
        uint32_t other = mirrored ? pixel / n * n + (n - 1 - pixel % n) : pixel;
        assert_int_equal(first.object[pixel], second.object[other]);
        if (first.object[pixel]) {
            assert_near(first.distance[pixel], second.distance[other], 1e-9);
        }
    }
}

static void rigid_matrix(double out[16], uint64_t *random)
{
    conus_pose turn;
    random_pose(&turn, random);
    memcpy(out, turn.world_from_device, sizeof turn.world_from_device);
}

/* Moving atlas and device together changes nothing. */
static void rigid_motion_changes_nothing(void **state)
{
    (void)state;
    uint64_t random = 5;
    for (size_t kind = 0; phantom_entry(kind); kind++) {
        struct view still = open_phantom(phantom_entry(kind)->info.name, NULL, 16);
        struct view moved = {0};
        double motion[16];
        rigid_matrix(motion, &random);
        assert_ok(phantom_draw(&moved.drawing, phantom_entry(kind)->info.name, NULL));
        mat4_multiply(motion, motion, still.drawing.grid.world_from_voxel);
        assert_ok(space_describe(&moved.drawing.grid, motion, "moved"));
        assert_ok(phantom_drawing_atlas(&moved.atlas, &moved.drawing));
        open_selector(&moved, 16, NULL);
        double voxel_from_world[16] = {0};
        assert_true(mat4_invert_affine(voxel_from_world, still.drawing.grid.world_from_voxel));
        mat4_multiply(motion, motion, voxel_from_world);
        for (int i = 0; i < 50; i++) {
            conus_pose pose;
            conus_pose with_it;
            random_pose(&pose, &random);
            mat4_multiply(with_it.world_from_device, motion, pose.world_from_device);
            aim(&still, &pose, 25);
            aim(&moved, &with_it, 25);
            assert_same_pixels(&still, &moved, false);
        }
        close_view(&moved);
        close_view(&still);
    }
}

/* Phantoms that are their own mirror image in x look mirrored from the mirrored place. */
static void mirrored_poses_see_mirrored_pictures(void **state)
{
    (void)state;
    const char *const kinds[] = {"sphere", "nested", "slabs", "torus", "u-shape"};
    uint64_t random = 3;
    for (size_t kind = 0; kind < sizeof kinds / sizeof kinds[0]; kind++) {
        struct view one = open_phantom(kinds[kind], NULL, 17);
        struct view other = open_phantom(kinds[kind], &(conus_phantom_options){.flip = {true, false, true}}, 17);
        for (int i = 0; i < 50; i++) {
            conus_pose pose;
            conus_pose mirrored;
            random_pose(&pose, &random);
            const double *m = pose.world_from_device;
            assert_ok(conus_pose_along(&mirrored, (double[]){-m[12], m[13], m[14]}, (double[]){m[8], -m[9], -m[10]},
                                       (double[]){-m[4], m[5], m[6]}));
            aim(&one, &pose, 25);
            aim(&other, &mirrored, 25);
            assert_same_pixels(&one, &other, true);
        }
        close_view(&other);
        close_view(&one);
    }
}

/* Eq. 12: a wide slab far away, and a small ball near the axis but not on it. Each score ranks another one first. */
static void scores_rank_by_what_they_say(void **state)
{
    (void)state;
    struct view view = open_phantom("u-shape", NULL, 15);
    const double origin[3] = {0, 0, 60};
    const double down[3] = {0, 0, -1};
    aim_along(&view, origin, down, 50);
    assert_true(result_of(&view, 1)->share > result_of(&view, 2)->share);
    assert_int_equal(result_of(&view, 1)->rank, 1);
    assert_near(result_of(&view, 1)->score, result_of(&view, 1)->share, 0);
    open_selector(&view, 15, "centre");
    aim_along(&view, origin, down, 50);
    assert_int_equal(result_of(&view, 2)->rank, 1);
    assert_near(result_of(&view, 2)->score, 1, 1e-12);
    double off = radians_from_degrees(result_of(&view, 1)->offset);
    assert_near(result_of(&view, 1)->score, 1 - off / radians_from_degrees(25), 1e-12);
    open_selector(&view, 15, "distance");
    aim_along(&view, origin, down, 50);
    assert_int_equal(result_of(&view, 1)->rank, 1); /* the arms reach up to z = 18, the ball to 11 */
    assert_near(result_of(&view, 2)->score, -49, view.slack);
    close_view(&view);
}

TEST_GROUP(closed_forms)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_has_its_solid_angle),
        cmocka_unit_test(a_torus_has_its_annulus),
        cmocka_unit_test(shares_converge),
        cmocka_unit_test(the_first_slab_hides_the_second),
        cmocka_unit_test(the_outermost_of_nested_balls_is_hit),
        cmocka_unit_test(through_the_hole_of_a_torus_there_is_nothing),
        cmocka_unit_test(a_bounding_box_selects_nothing),
        cmocka_unit_test(tubes_are_hit_at_their_wall),
        cmocka_unit_test(shares_sum_to_one),
        cmocka_unit_test(rigid_motion_changes_nothing),
        cmocka_unit_test(mirrored_poses_see_mirrored_pictures),
        cmocka_unit_test(scores_rank_by_what_they_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
