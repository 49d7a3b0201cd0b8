/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of scores (Eq. 12): each score by its definition, in its range and units, and formulas of scores. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "scene.h"
#include "selection/measure/score.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

static const struct cone ten_degrees = {.pose.world_from_device = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                                        .degrees = 10,
                                        .angle = MATH3_PI / 18,
                                        .resolution = 16};

/* How far from the middle the pixel of a ray that is so far off the axis is. */
static double pixel_of(double tangent)
{
    return 8 * tangent / tan(MATH3_PI / 36);
}

/* An object whose contact is `depth` mm along the axis and `off` beside it. */
static conus_result result_at(double depth, double off)
{
    return (conus_result){.object = 1,
                          .pixels = 1,
                          .centre_px = off > 0 ? pixel_of(off / depth) : 0,
                          .distance = hypot(depth, off),
                          .contact = {off, 0, -depth}};
}

static double contribution(double depth, double off, double exponent)
{
    const conus_result result = result_at(depth, off);
    return score_contribution(&result, &ten_degrees, exponent);
}

static void with_k_1_it_is_0_on_the_surface_of_the_cone(void **state)
{
    (void)state;
    for (int i = 0; i < 11; i++) {
        double depth = pow(3, i);
        double rim = depth * tan(MATH3_PI / 36);
        assert_near(contribution(depth, rim, 1), 0, 1e-12);
        assert_near(contribution(depth, 0.99 * rim, 1), 1 - atan(0.99 * rim / depth) / (MATH3_PI / 36), 1e-12);
        assert_near(contribution(depth, 0, 1), 1, 0);
        assert_near(contribution(depth, 2 * rim, 1), 0, 0); /* not below */
    }
}

/* The constants of de Haan's formula have all lengths in metres, and k is a real number: 4 / 5 is 0 to a C compiler,
 * and then the distance would not matter. */
static void k_is_four_fifths_and_the_unit_the_metre(void **state)
{
    (void)state;
    const double theta = MATH3_PI / 36;
    const double k = 4.0 / 5.0;
    for (int i = 0; i < 9; i++) {
        double depth = 50 * pow(1.7, i);
        double off = depth * tan(theta) / 3;
        double wanted = 1 - atan(off / 1000 / pow(depth / 1000, k)) / theta;
        assert_near(contribution(depth, off, k), fmax(0, wanted), 1e-12);
        assert_true(fabs(contribution(depth, off, k) - (1 - atan(off / 1000) / theta)) > 1e-3 ||
                    fabs(depth - 1000) < 9);
    }
    assert_near(contribution(1000, 30, k), contribution(1000, 30, 1), 1e-12); /* at one metre k does not matter */
    assert_true(contribution(100, 3, k) > contribution(100, 3, 1));
    assert_true(contribution(3000, 90, k) < contribution(3000, 90, 1));
}

static void inside_an_object_it_is_the_limit(void **state)
{
    (void)state;
    assert_near(contribution(0, 0, 0.8), 1, 0);
    conus_result around = {.object = 1, .pixels = 208, .centre_px = pixel_of(tan(0.01)), .contact = {0, 0, 0}};
    assert_near(score_contribution(&around, &ten_degrees, 0.8), 1, 0);
    assert_near(score_contribution(&around, &ten_degrees, 1), 1 - 0.01 / (MATH3_PI / 36), 1e-12);
    around.pixels = 0; /* hidden */
    assert_near(score_contribution(&around, &ten_degrees, 0.8), 0, 0);
}

static void in_a_cylinder_it_is_linear(void **state)
{
    (void)state;
    struct cone cylinder = ten_degrees;
    cylinder.angle = 0;
    cylinder.radius = 5;
    const conus_result result = {.object = 1, .pixels = 3, .centre_px = 2, .contact = {0, 0, -70}};
    assert_near(score_contribution(&result, &cylinder, 0.8), 0.75, 1e-12);
}

struct view {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_selection *selection;
};

/* By 16 x 16 rays where none are said. */
static void select_from(struct view *view, const conus_selector_options *options, const conus_pose *pose,
                        double degrees)
{
    conus_selector_destroy(view->selector);
    conus_selection_destroy(view->selection);
    view->selector = NULL;
    view->selection = NULL;
    conus_selector_options of16 = *options;
    of16.resolution = of16.resolution ? of16.resolution : 16;
    assert_ok(conus_selector_create(&view->selector, view->atlas, &of16));
    assert_ok(conus_select(&view->selection, view->selector, pose, degrees));
}

static void open_phantom(struct view *view, const char *kind)
{
    struct phantom_drawing drawing = {0};
    *view = (struct view){0};
    assert_ok(phantom_draw(&drawing, kind, &(conus_phantom_options){0}));
    assert_ok(phantom_drawing_atlas(&view->atlas, &drawing));
    phantom_drawing_finish(&drawing);
}

static void close_view(struct view *view)
{
    conus_selection_destroy(view->selection);
    conus_selector_destroy(view->selector);
    conus_atlas_destroy(view->atlas);
}

static const conus_result *result_of(const struct view *view, uint32_t label)
{
    for (size_t i = 0; i < conus_selection_count(view->selection); i++) {
        const conus_result *result = conus_selection_result(view->selection, i);
        const conus_object *object = conus_atlas_object(view->atlas, result->object);
        if (object && object->label == label) {
            return result;
        }
    }
    fail_msg("area %u is not met", label);
    return NULL;
}

static conus_pose pose_above(double height)
{
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){3, -2, height}, (double[]){0, 0, -1}, NULL));
    return pose;
}

static double score_of(struct view *view, const char *score, uint32_t label)
{
    const conus_pose pose = pose_above(60);
    const conus_selector_options options = {.score = score, .layers = CONUS_LAYERS_ALL};
    select_from(view, &options, &pose, 50);
    return result_of(view, label)->score;
}

static void each_score_follows_its_definition(void **state)
{
    (void)state;
    struct view view;
    open_phantom(&view, "u-shape");
    (void)score_of(&view, NULL, 1);
    const conus_result u = *result_of(&view, 1);
    const conus_result ball = *result_of(&view, 2);
    double contact[3];
    vec3_sub(contact, ball.contact, (double[]){3, -2, 60});
    assert_near(score_of(&view, "visibility", 1), u.pixels / 208.0, 1e-12);
    assert_near(score_of(&view, "proximity", 1), 1 - u.centre_px / 8, 1e-12);
    assert_near(score_of(&view, "unoccluded", 2), (double)ball.pixels / ball.pierced, 1e-12);
    assert_true(u.pierced > u.pixels);
    assert_near(score_of(&view, "unoccluded", 1), (double)u.pixels / u.pierced, 1e-12);
    assert_near(score_of(&view, "mrtk", 2), -(0.25 * vec3_length(contact) / 1000 + 1.0 * ball.offset), 1e-12);
    /* The phantom's shapes, not the grid that they are painted in, reach from (-22, -6, -18) to (22, 6, 18): they begin
     * 42 mm below the apex at (3, -2, 60). */
    double far = sqrt(25.0 * 25 + 8.0 * 8 + 78.0 * 78);
    assert_near(score_of(&view, "nearness", 2), 1 - (ball.distance - 42) / (far - 42), 1e-12);
    close_view(&view);
}

/* The ball is small and in the middle; the arms of the U reach the rim. */
static void the_smallest_wins_unless_it_touches_the_rim(void **state)
{
    (void)state;
    struct view view;
    open_phantom(&view, "u-shape");
    double ball = score_of(&view, "smallest", 2);
    assert_near(ball, 2 - result_of(&view, 2)->pixels / 208.0, 1e-12);
    const conus_pose pose = pose_above(60);
    select_from(&view, &(conus_selector_options){.score = "smallest"}, &pose, 20);
    assert_near(result_of(&view, 1)->score, result_of(&view, 1)->pixels / 208.0, 1e-12);
    select_from(&view, &(conus_selector_options){.score = "smallest", .resolution = 1}, &pose, 20); /* all rim */
    assert_near(conus_selection_result(view.selection, 0)->score, 1, 0);
    close_view(&view);
}

/* 16 x 16 voxels, each under one pixel of a cone of 90 degrees that is 8 mm above them. The four voxels in the middle
 * of the sides have labels 1 to 4, and all of them touch the rim, whichever side it is. */
static void every_side_of_the_rim_counts(void **state)
{
    (void)state;
    const double m[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -7.5, -7.5, -0.5, 1};
    const conus_volume_info grid = scene_plain_grid((size_t[]){16, 16, 1}, m);
    uint32_t labels[256];
    for (size_t i = 0; i < 256; i++) {
        labels[i] = 5;
    }
    labels[7] = 1;
    labels[7 + 15 * 16] = 2;
    labels[7 * 16] = 3;
    labels[15 + 7 * 16] = 4;
    struct view view = {.atlas = scene_parcellation(&grid, labels)};
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 8}, (double[]){0, 0, -1}, (double[]){0, 1, 0}));
    select_from(&view, &(conus_selector_options){.score = "smallest"}, &pose, 90);
    for (uint32_t object = 1; object <= 4; object++) {
        assert_int_equal(result_of(&view, object)->pixels, 1);
        assert_near(result_of(&view, object)->score, 1 / 208.0, 1e-12);
    }
    close_view(&view);
}

static void senseshapes_are_from_0_to_1(void **state)
{
    (void)state;
    static const char *const scores[] = {"nearness", "visibility", "proximity", "unoccluded"};
    uint64_t seed = 41;
    for (int i = 0; i < 30; i++) {
        struct view view = {.atlas = scene_atlas(&seed, 24, i % 2)};
        const conus_pose pose = scene_pose(&seed, view.atlas);
        double degrees = test_random(&seed, 1, 170);
        for (size_t s = 0; s < sizeof scores / sizeof scores[0]; s++) {
            const conus_selector_options options = {.score = scores[s],
                                                    .layers = CONUS_LAYERS_ALL,
                                                    .aperture = i % 3 ? CONUS_APERTURE_CIRCLE : CONUS_APERTURE_SQUARE,
                                                    .resolution = 1 + (uint32_t)i};
            select_from(&view, &options, &pose, degrees);
            for (size_t r = 0; r + 1 < conus_selection_count(view.selection); r++) {
                double score = conus_selection_result(view.selection, r)->score;
                assert_true(score >= 0 && score <= 1);
            }
        }
        close_view(&view);
    }
}

static void formulas_weigh_scores(void **state)
{
    (void)state;
    struct view view;
    open_phantom(&view, "u-shape");
    double share = score_of(&view, "share", 2);
    double centre = score_of(&view, "centre", 2);
    assert_near(score_of(&view, "0.5*share + 0.5*centre", 2), (share + centre) / 2, 1e-12);
    assert_near(score_of(&view, "-share", 2), -share, 0);
    assert_int_equal(result_of(&view, 2)->rank, 1); /* the fewest pixels */
    close_view(&view);
}

/* Objects without a score come last, in the order of ties. */
static void what_has_no_value_ranks_last(void **state)
{
    (void)state;
    struct view view;
    open_phantom(&view, "u-shape");
    const conus_pose pose = pose_above(60);
    select_from(&view, &(conus_selector_options){0}, &pose, 50);
    char formula[64];
    snprintf(formula, sizeof formula, "1/(visibility - %u/208)", conus_selection_result(view.selection, 0)->pixels);
    uint32_t most = conus_selection_result(view.selection, 0)->object;
    select_from(&view, &(conus_selector_options){.score = formula}, &pose, 50);
    assert_int_equal(conus_selection_count(view.selection), 3);
    assert_int_equal(conus_selection_result(view.selection, 1)->object, most);
    assert_true(isnan(conus_selection_result(view.selection, 1)->score));
    assert_int_equal(conus_selection_result(view.selection, 1)->rank, 2);
    assert_int_equal(conus_selection_result(view.selection, 2)->kind, CONUS_KIND_UNASSIGNED);
    close_view(&view);
}

static void needs_are_known_and_checked(void **state)
{
    (void)state;
    struct view view;
    open_phantom(&view, "u-shape");
    conus_score_info info;
    assert_ok(conus_score_parse(&info, NULL));
    assert_string_equal(info.name, "share");
    assert_false(info.needs_history || info.needs_layers);
    assert_ok(conus_score_parse(&info, "unoccluded + 0*time"));
    assert_string_equal(info.name, "unoccluded + 0*time");
    assert_true(info.needs_history && info.needs_layers);
    assert_fails(conus_score_parse(&info, "unocluded"), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "score: \"unocluded\" is unknown; did you mean unoccluded?");
    const conus_selector_options visible = {.score = "2*unoccluded"};
    assert_fails(conus_selector_create(&view.selector, view.atlas, &visible), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "score: 2*unoccluded needs all layers");
    const conus_selector_options moving = {.score = "intenselect"};
    const conus_pose pose = pose_above(60);
    assert_ok(conus_selector_create(&view.selector, view.atlas, &moving));
    assert_fails(conus_select(&view.selection, view.selector, &pose, degrees_from_radians(1)), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "score: intenselect needs a history, which only a track has");
    close_view(&view);
}

/* Every score that needs no history gives a finite number, and all have a description. */
static void the_whole_table_works(void **state)
{
    (void)state;
    struct view view;
    open_phantom(&view, "u-shape");
    const conus_score_info *score;
    size_t count = 0;
    for (size_t i = 0; (score = conus_score(i)); i++) {
        count++;
        assert_true(score->description[0]);
        if (!score->needs_history && !score->needs_weight) { /* those of a weight: tests/python/test_dose.py */
            assert_true(isfinite(score_of(&view, score->name, 1)));
        }
    }
    assert_int_equal(count, 18);
    close_view(&view);
}

TEST_GROUP(scores)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(with_k_1_it_is_0_on_the_surface_of_the_cone),
        cmocka_unit_test(k_is_four_fifths_and_the_unit_the_metre),
        cmocka_unit_test(inside_an_object_it_is_the_limit),
        cmocka_unit_test(in_a_cylinder_it_is_linear),
        cmocka_unit_test(each_score_follows_its_definition),
        cmocka_unit_test(the_smallest_wins_unless_it_touches_the_rim),
        cmocka_unit_test(every_side_of_the_rim_counts),
        cmocka_unit_test(senseshapes_are_from_0_to_1),
        cmocka_unit_test(formulas_weigh_scores),
        cmocka_unit_test(what_has_no_value_ranks_last),
        cmocka_unit_test(needs_are_known_and_checked),
        cmocka_unit_test(the_whole_table_works),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
