/* SPDX-License-Identifier: BSD-3-Clause */
/* Weights (Eq. 30): forms at single places, and no memory. tests/python/test_weight.py tests Eq. 31 and Eq. 32
 * by an oracle and by samples, test_dose.py Eq. 33 by brute force, test_errors.py Eq. 29. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "selection/weight/weight.h"
#include "test.h"

#include <math.h>
#include <stdio.h>

static const char *write_file(const char *name, const char *text)
{
    const char *path = test_scratch(name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
    return path;
}

/* exp(-2) at 2 sigma; times theta / sin theta. */
static void gauss_is_a_density_per_solid_angle(void **state)
{
    (void)state;
    conus_weight *weight = NULL;
    assert_ok(conus_weight_create(&weight, "gauss=10,bias=3:-4"));
    assert_near(conus_weight_at(weight, 0, 0), 1, 0);
    assert_near(conus_weight_at(weight, 20, 0), exp(-2) * radians_from_degrees(20) / sin(radians_from_degrees(20)),
                1e-15);
    assert_near(conus_weight_angle(weight), 80, 0);
    assert_near(conus_weight_sigma(weight), 10, 0);
    assert_true(isnan(conus_weight_radius(weight)));
    conus_weight_destroy(weight);
    conus_weight_destroy(NULL);
}

static void a_table_is_linear_between_its_rows(void **state)
{
    (void)state;
    conus_weight *weight = NULL;
    assert_ok(conus_weight_create(&weight, write_file("offsets.csv", "weight,offset_mm\n4,3\n2,1\n0,7\n")));
    const double wanted[][2] = {{0, 2}, {1, 2}, {2, 3}, {3, 4}, {5, 2}, {7, 0}, {7.5, 0}};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        assert_near(conus_weight_at(weight, wanted[i][0], 0), wanted[i][1], 1e-15);
    }
    const double largest[][2] = {{0.5, 2}, {1.5, 2.5}, {3, 4}, {6, 4}, {9, 4}};
    for (size_t i = 0; i < sizeof largest / sizeof largest[0]; i++) {
        assert_near(conus_weight_largest(weight, largest[i][0], (const double[]){0, 0}), largest[i][1], 1e-15);
    }
    assert_near(conus_weight_radius(weight), 7, 0);
    assert_true(isnan(conus_weight_angle(weight)));
    conus_weight_destroy(weight);
}

/* Half at d and at w; half its largest at half of l and a from the focus; 1 at the fibre's tip, 0 before it. */
static void forms_with_depth_fall_by_half_where_they_say(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double x, z, value, radius, range[2];
    } wanted[] = {{"coil=20:9", 0, 20, 0.5, 27, {0, 180}},
                  {"coil=20:9", 9, 0, 0.5, 27, {0, 180}},
                  {"focus=50:4:20", 2, 50, 0.5, 6, {20, 80}},
                  {"focus=50:4:20", 0, 60, 0.5, 6, {20, 80}},
                  {"focus=10:4:20", 0, 10, 1, 6, {0, 40}}};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        conus_weight *weight = NULL;
        double range[2];
        assert_ok(conus_weight_create(&weight, wanted[i].text));
        assert_near(conus_weight_at(weight, wanted[i].x, wanted[i].z), wanted[i].value, 1e-15);
        assert_near(conus_weight_radius(weight), wanted[i].radius, 1e-12);
        assert_true(conus_weight_range(range, weight) && conus_weight_needs_layers(weight));
        assert_near(range[0], wanted[i].range[0], 1e-12);
        assert_near(range[1], wanted[i].range[1], 1e-12);
        assert_true(isnan(conus_weight_angle(weight)));
        assert_near(conus_weight_largest(weight, 5, range),
                    wanted[i].text[0] == 'c' ? 1 : conus_weight_at(weight, 0, i == 4 ? 10 : 50), 0);
        conus_weight_destroy(weight);
    }
    conus_weight *fibre = NULL;
    double range[2];
    assert_ok(conus_weight_create(&fibre, "fibre=0.1:0.39"));
    assert_true(conus_weight_range(range, fibre));
    assert_near(conus_weight_at(fibre, 0, 0), 1, 1e-15);
    assert_near(conus_weight_at(fibre, 0, -0.01), 0, 0);
    assert_near(conus_weight_at(fibre, 0, range[1]), 1.0 / 512, 1e-9);
    conus_weight_destroy(fibre);
}

/* Only what ends in a number of its second row is a table. */
static void no_other_prefix_of_a_table_is_read(void **state)
{
    (void)state;
    const char text[] = "angle_deg\tweight\n0\t1\n4\t25\n";
    for (size_t size = 0; size < sizeof text; size++) {
        conus_weight *weight = NULL;
        char prefix[sizeof text] = "";
        memcpy(prefix, text, size);
        conus_status status = conus_weight_create(&weight, write_file("prefix.tsv", prefix));
        assert_int_equal(status, size < sizeof "angle_deg\tweight\n0\t1\n4\t" ? CONUS_ERROR_DATA : CONUS_OK);
        conus_weight_destroy(weight);
    }
}

/* The device points 30 degrees to its right of what is meant, or up; its x and y are world axes, x turned round, too.
 */
static void a_bias_is_taken_off_in_the_device_s_own_axes(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        const double hand = k % 2 ? -1 : 1; /* left-handed where the world is a mirror image of the pose's space */
        const bool upward = k / 2;
        conus_weight *weight = NULL;
        conus_pose pose = {{hand, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}};
        assert_ok(conus_weight_create(&weight, upward ? "gauss=1,bias=0:30" : "gauss=1,bias=30:0"));
        weight_turn(&pose, weight);
        const double *m = pose.world_from_device;
        const double z[3] = {upward ? 0 : hand * 0.5, upward ? 0.5 : 0, sqrt(0.75)};
        for (int a = 0; a < 3; a++) {
            assert_near(m[8 + a], z[a], 1e-12);
            assert_near(m[12 + a], 5 + a, 0);
        }
        assert_near(mat4_determinant3(m), hand, 1e-12);
        conus_weight_destroy(weight);
    }
}

static void paths_end_before_keys(void **state)
{
    (void)state;
    assert_int_equal(conus_weight_path_length("gauss=2,bias=1:1"), 0);
    assert_int_equal(conus_weight_path_length("size,power=2"), 0);
    assert_int_equal(conus_weight_path_length("a,b.tsv,bias=1:1"), 7);
    assert_int_equal(conus_weight_path_length("equal.tsv"), 9);
}

/* What is asked without memory. */
struct poor {
    const conus_atlas *atlas;
    char weight[512], prior[512];
};

static conus_status ask(void *data)
{
    const struct poor *poor = data;
    conus_weight *weight = NULL;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_status status = conus_weight_create(&weight, poor->weight);
    const conus_selector_options options = {.weight = weight,
                                            .prior = poor->prior,
                                            .score = "posterior",
                                            .resolution = 24,
                                            .layers = CONUS_LAYERS_ALL,
                                            .range = {0, 200}};
    conus_pose pose;
    (void)!conus_pose_along(&pose, (double[]){0, 0, 150}, (double[]){0, 0, -1}, NULL);
    status = status ? status : conus_selector_create(&selector, poor->atlas, &options);
    status = status ? status : conus_select(&selection, selector, &pose, 8);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_weight_destroy(weight);
    return status;
}

/* Angles are of a cone, offsets of a cylinder; only a weight of rays says how probable an axis is (Eq. 30 to 32). */
static void a_weight_of_another_region_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *weight, *prior, *score;
        double radius;
        const char *message;
    } bad[] = {
        {NULL, "equal", NULL, 0, "prior: needs a weight"},
        {NULL, NULL, "posterior", 0, "score: posterior needs a weight"},
        {"gauss=2", NULL, NULL, 4, "weight: an angle needs a cone, and a radius makes a cylinder"},
        {"coil=20:9", "equal", NULL, 0,
         "prior: the posterior needs a weight of rays, and this one depends on the depth"},
        {"coil=20:9", NULL, "weight", 0, "score: weight needs a weight of rays, and this one depends on the depth"},
        {"off", NULL, NULL, 0, "weight: an offset needs a cylinder, which has a radius"},
        {"ball", NULL, "weight", 4,
         "score: weight needs a weight of rays, and this one depends on the distance from a point"},
    };
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, ""));
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        const char *text = bad[i].weight;
        conus_selector *selector = NULL;
        conus_weight *weight = NULL;
        text = text && text[0] == 'o' ? write_file("off.csv", "weight,offset_mm\n4,3\n0,7\n") : text;
        text = text && text[0] == 'b' ? write_file("ball.csv", "weight,distance_mm\n4,3\n0,7\n") : text;
        assert_ok(text ? conus_weight_create(&weight, text) : CONUS_OK);
        const conus_selector_options options = {
            .weight = weight, .prior = bad[i].prior, .score = bad[i].score, .radius = bad[i].radius};
        assert_fails(conus_selector_create(&selector, atlas, &options), CONUS_ERROR_ARGUMENT);
        assert_string_equal(conus_message(), bad[i].message);
        assert_null(selector);
        conus_weight_destroy(weight);
    }
    conus_atlas_destroy(atlas);
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    struct phantom_drawing drawing = {0};
    conus_atlas *atlas = NULL;
    assert_ok(phantom_draw(&drawing, "u-shape", &(conus_phantom_options){0}));
    assert_ok(phantom_drawing_atlas(&atlas, &drawing));
    phantom_drawing_finish(&drawing);
    struct poor poor = {.atlas = atlas};
    snprintf(poor.weight, sizeof poor.weight, "%s", write_file("bell.tsv", "angle_deg\tweight\n0\t1\n4\t0.5\n"));
    snprintf(poor.prior, sizeof poor.prior, "%s", write_file("prior.tsv", "index\tprior\n1\t2\n"));
    assert_ok(ask(&poor));
    test_every_allocation(ask, &poor);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(weight)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gauss_is_a_density_per_solid_angle),
        cmocka_unit_test(a_table_is_linear_between_its_rows),
        cmocka_unit_test(forms_with_depth_fall_by_half_where_they_say),
        cmocka_unit_test(no_other_prefix_of_a_table_is_read),
        cmocka_unit_test(a_bias_is_taken_off_in_the_device_s_own_axes),
        cmocka_unit_test(paths_end_before_keys),
        cmocka_unit_test(a_weight_of_another_region_is_refused),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
