/* SPDX-License-Identifier: BSD-3-Clause */
/* All layers (Eq. 10) of phantoms against answers worked out on paper: path lengths, entries and exits of every ray,
 * and the rate at which means over the cone approach their integrals. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "selection/cone/cone.h"
#include "test.h"

struct view {
    struct phantom_drawing drawing;
    conus_atlas *atlas;
    double slack; /* half a voxel's diagonal: a painted shape lies between itself shrunk and grown by it */
};

static const conus_phantom_options grids[] = {
    {0},
    {.size = 128, .spacing = {0.5, 0.5, 0.5}},
    {.spacing = {1, 1, 2.5}, .flip = {true, false, false}},
    {.oblique = 0.7 * 180 / MATH3_PI, .flip = {false, true, true}},
};
enum { GRIDS = sizeof grids / sizeof grids[0] };

static struct view open_phantom(const char *kind, const conus_phantom_options *options)
{
    struct view view = {0};
    assert_ok(phantom_draw(&view.drawing, kind, options));
    assert_ok(phantom_drawing_atlas(&view.atlas, &view.drawing));
    view.slack = vec3_length(view.drawing.grid.spacing) / 2;
    return view;
}

static void close_view(struct view *view)
{
    conus_atlas_destroy(view->atlas);
    phantom_drawing_finish(&view->drawing);
}

static conus_selection *select_from(const struct view *view, const struct cone *cone)
{
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL,
                                            .resolution = cone->resolution,
                                            .radius = cone->radius,
                                            .range = {cone->range[0], cone->range[1]}};
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    assert_ok(conus_selector_create(&selector, view->atlas, &options));
    assert_ok(conus_select(&selection, selector, &cone->pose, degrees_from_radians(cone->angle)));
    conus_selector_destroy(selector);
    return selection;
}

static struct cone cone_along(const double origin[3], const double direction[3], double degrees, uint32_t n)
{
    struct cone cone = {.angle = radians_from_degrees(degrees), .resolution = n};
    assert_ok(conus_pose_along(&cone.pose, origin, direction, NULL));
    return cone;
}

/* Length of the ray of `pixel` inside the object, and its number of intervals. */
static double length_in(const conus_selection *selection, uint32_t pixel, uint32_t object, unsigned *interval_count)
{
    size_t count;
    const conus_interval *intervals = conus_selection_intervals(&count, selection);
    double length = 0;
    *interval_count = 0;
    for (size_t i = 0; i < count; i++) {
        if (intervals[i].pixel == pixel && intervals[i].object == object) {
            length += intervals[i].exit - intervals[i].entry;
            ++*interval_count;
        }
    }
    return length;
}

/* Length of a ray inside a ball whose centre it passes at the distance `beside`. */
static double chord(double radius, double beside)
{
    return beside < radius ? 2 * sqrt(radius * radius - beside * beside) : 0;
}

static void a_ball_is_as_long_as_its_chords(void **state)
{
    (void)state;
    for (size_t g = 0; g < GRIDS; g++) {
        struct view view = open_phantom("sphere", &grids[g]);
        const struct cone cone = cone_along((double[]){60, -64, 48}, (double[]){-60, 64, -48}, 26, 16);
        conus_selection *selection = select_from(&view, &cone);
        unsigned hit = 0;
        for (uint32_t pixel = 0; pixel < 256; pixel++) {
            double off = atan(cone_radius(&cone, pixel % 16, pixel / 16) * tan(cone.angle / 2));
            double beside = 100 * sin(off);
            unsigned interval_count;
            double length = length_in(selection, pixel, 1, &interval_count);
            hit += interval_count > 0;
            assert_true(length >= chord(20 - view.slack, beside) - 1e-9);
            assert_true(length <= chord(20 + view.slack, beside) + 1e-9);
        }
        assert_true(hit > 150);
        conus_selection_destroy(selection);
        close_view(&view);
    }
}

/* Two slabs of 6 mm, 12 mm apart: a ray at the angle `off` runs for 6 / cos(off) in each, occluded or not. */
static void hidden_slabs_are_as_long_as_seen_ones(void **state)
{
    (void)state;
    struct view view = open_phantom("slabs", NULL);
    const struct cone cone = cone_along((double[]){3.3, 100, 2.2}, (double[]){0, -1, 0}, 10, 16);
    conus_selection *selection = select_from(&view, &cone);
    const uint32_t front = conus_selection_result(selection, 0)->object;
    for (size_t i = 0; i < 2; i++) {
        const conus_result *slab = conus_selection_result(selection, i);
        double sum = 0;
        for (uint32_t pixel = 0; pixel < 256; pixel++) {
            uint32_t column = pixel % 16;
            uint32_t row = pixel / 16;
            unsigned interval_count;
            double per_depth = cone_per_depth(&cone, column, row);
            assert_near(length_in(selection, pixel, slab->object, &interval_count), 6 * per_depth, 1e-9);
            assert_int_equal(interval_count, 1);
            sum += cone_has_pixel(&cone, column, row) ? 6 * per_depth : 0;
        }
        assert_int_equal(slab->pierced, 208);
        assert_int_equal(slab->pixels, slab->object == front ? 208 : 0);
        assert_near(slab->path, sum / 208, 1e-9);
        assert_near(slab->entry, (i ? 106 : 88) * cone_per_depth(&cone, 7, 7), 1e-9);
        assert_near(slab->exit, (i ? 112 : 94) * cone_per_depth(&cone, 5, 0), 1e-9);
    }
    conus_selection_destroy(selection);
    close_view(&view);
}

/* A range whose ends lie in the slabs leaves the part between them. */
static void a_range_leaves_a_part_of_a_slab(void **state)
{
    (void)state;
    struct view view = open_phantom("slabs", NULL);
    struct cone cone = cone_along((double[]){3.3, 100, 2.2}, (double[]){0, -1, 0}, 10, 16);
    cone.range[0] = 90;
    cone.range[1] = 107;
    conus_selection *selection = select_from(&view, &cone);
    const conus_result *front = conus_selection_result(selection, 0);
    const conus_result *back = conus_selection_result(selection, 1);
    assert_near(front->entry, 90 * cone_per_depth(&cone, 7, 7), 1e-9);
    assert_near(front->distance, front->entry, 0);
    assert_near(front->path / back->path, 4, 1e-9); /* 90 to 94 and 106 to 107 */
    assert_int_equal(back->pierced, 208);
    conus_selection_destroy(selection);
    close_view(&view);
}

/* From the side, through the hole: two tubes, each as long as its chord. */
static void a_torus_is_pierced_twice(void **state)
{
    (void)state;
    for (size_t g = 0; g < GRIDS; g++) {
        struct view view = open_phantom("torus", &grids[g]);
        const struct cone cone = cone_along((double[]){0, 90, 0}, (double[]){0, -1, 0}, 1, 1);
        conus_selection *selection = select_from(&view, &cone);
        const conus_result *torus = conus_selection_result(selection, 0);
        unsigned interval_count;
        assert_near(length_in(selection, 0, torus->object, &interval_count), 24, 4 * view.slack);
        assert_int_equal(interval_count, 2);
        assert_int_equal(torus->pierced, 1);
        assert_near(torus->path, 24, 4 * view.slack);
        assert_near(torus->entry, 66, view.slack);
        assert_near(torus->exit, 114, view.slack);
        conus_selection_destroy(selection);
        close_view(&view);
    }
}

/* A cylinder of radius a about a ball's centre, on voxels of `edge` mm: mean chord over its cross-section, which is
 * 4 / (3 a^2) (R^3 - (R^2 - a^2)^(3/2)). */
static double mean_path_error(double edge, uint32_t n)
{
    const double radius = 20;
    const double a = 17;
    const conus_phantom_options options = {.size = (uint32_t)(64 / edge), .spacing = {edge, edge, edge}};
    struct view view = open_phantom("sphere", &options);
    struct cone cone = cone_along((double[]){60, -64, 48}, (double[]){-60, 64, -48}, 1, n);
    cone.angle = 0;
    cone.radius = a;
    conus_selection *selection = select_from(&view, &cone);
    const conus_result *ball = conus_selection_result(selection, 0);
    double mean = 4 / (3 * a * a) * (pow(radius, 3) - pow(radius * radius - a * a, 1.5));
    double error = ball->path / mean - 1;
    conus_selection_destroy(selection);
    close_view(&view);
    return fabs(error);
}

/* The mean over the pixels is a midpoint rule over a disc whose rim is cut to pixels: its error falls about as 1/n, and
 * with the voxels' edge (docs/model.md, Eq. 10). */
static void mean_paths_converge(void **state)
{
    (void)state;
    assert_true(mean_path_error(0.5, 16) < 0.012);
    assert_true(mean_path_error(0.5, 32) < 0.004);
    assert_true(mean_path_error(0.5, 128) < 0.0007);
    assert_true(mean_path_error(1, 128) < 0.0007);
    assert_true(mean_path_error(2, 128) < 0.003);
    assert_true(mean_path_error(4, 128) < 0.022);
}

/* A ball of 20 mm, 60 mm below, in a cylinder of 17 mm: the rays in the middle enter first and leave last, at 40 and 80
 * mm; those at the rim, which are the first and the last pixels, from 49.5 to 70.5. */
static void entry_and_exit_are_the_outermost(void **state)
{
    (void)state;
    for (int i = 0; i < GRIDS; i++) {
        struct view view = open_phantom("sphere", &grids[i]);
        struct cone cone = cone_along((double[]){0, 0, 60}, (double[]){0, 0, -1}, 1, 17);
        cone.angle = 0;
        cone.radius = 17;
        conus_selection *selection = select_from(&view, &cone);
        const conus_result *ball = conus_selection_result(selection, 0);
        assert_near(ball->entry, 40, view.slack);
        assert_near(ball->exit, 80, view.slack);
        conus_selection_destroy(selection);
        close_view(&view);
    }
}

TEST_GROUP(closed_layers)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_is_as_long_as_its_chords),
        cmocka_unit_test(hidden_slabs_are_as_long_as_seen_ones),
        cmocka_unit_test(a_range_leaves_a_part_of_a_slab),
        cmocka_unit_test(a_torus_is_pierced_twice),
        cmocka_unit_test(mean_paths_converge),
        cmocka_unit_test(entry_and_exit_are_the_outermost),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
