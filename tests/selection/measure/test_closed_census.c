/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes in a cone (Eq. 10) against closed forms: the rate at which the census of shapes painted in voxels
 * converges. */
#include "atlas/atlas.h"
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "selection/selection.h"
#include "test.h"

#include <string.h>

enum { SIZES = 4, GRIDS = 16 };

/* A cone or cylinder in a phantom, and the volume, mm^3, in closed form. */
struct question {
    const char *phantom, *what;
    uint32_t label;
    double origin[3], direction[3];
    double degrees, radius, range[2];
    double volume;
    double error[SIZES]; /* root mean square of the relative error, per cent, for each size of voxels. It is that of
                            counting centres, so it follows from counted_one_by_one(); docs/model.md has it. */
};

/* A ball of radius R, apex at a distance D < R from its centre, the axis through that: 2 pi/3 times the integral of t^3
 * over the cosine c of the angle, t = D c + sqrt(R^2 - D^2 (1 - c^2)); by Simpson's rule. */
static double cone_in_ball(double radius, double away, double half_angle)
{
    enum { STEPS = 2000 };
    double from = cos(half_angle);
    double sum = 0;
    for (int i = 0; i <= STEPS; i++) {
        double c = from + (1 - from) * i / STEPS;
        double t = away * c + sqrt(radius * radius - away * away * (1 - c * c));
        sum += t * t * t * (i == 0 || i == STEPS ? 1 : i % 2 ? 4 : 2);
    }
    return 2 * MATH3_PI / 3 * sum * (1 - from) / (3 * STEPS);
}

/* Above the height z, between the centre line of a torus and its inner side: rings from ring - s to ring. */
static double inside_torus_above(double ring, double tube, double z)
{
    enum { STEPS = 20000 };
    double step = (tube - z) / STEPS;
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        double height = z + (i + 0.5) * step;
        double s = sqrt(tube * tube - height * height);
        sum += MATH3_PI * (2 * ring * s - s * s) * step;
    }
    return sum;
}

static double frustum(double half_angle, double near, double far)
{
    return MATH3_PI / 3 * pow(tan(half_angle), 2) * (far * far * far - near * near * near);
}

static conus_atlas *painted(const struct question *question, double spacing, double oblique)
{
    const conus_phantom_options options = {
        .size = (uint32_t)(PHANTOM_EDGE / spacing), .spacing = {spacing, spacing, spacing}, .oblique = oblique};
    struct phantom_drawing drawing;
    conus_atlas *atlas = NULL;
    assert_ok(phantom_draw(&drawing, question->phantom, &options));
    assert_ok(phantom_drawing_atlas(&atlas, &drawing));
    phantom_drawing_finish(&drawing);
    return atlas;
}

static double counted(const struct question *question, const conus_atlas *atlas)
{
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL,
                                            .resolution = 1,
                                            .radius = question->radius,
                                            .range = {question->range[0], question->range[1]}};
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    double volume = 0;
    assert_ok(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_pose_along(&pose, question->origin, question->direction, NULL));
    assert_ok(conus_select(&selection, selector, &pose, question->degrees));
    for (size_t i = 0; i + 1 < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        volume += conus_atlas_object(atlas, result->object)->label == question->label ? result->volume : 0;
    }
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return volume;
}

/* The same by definition: every voxel of the label whose centre lies in the cone or cylinder and in the range, tested
 * one by one. */
static double counted_one_by_one(const struct question *question, const conus_atlas *atlas)
{
    const struct volume *volume = &atlas->volumes[0];
    const size_t *dim = volume->info.dim;
    const double *m = volume->info.world_from_voxel;
    double across[3], side[3], axis[3];
    double count = 0;
    vec3_scale(axis, question->direction, 1 / vec3_length(question->direction));
    for (size_t v = 0; v < volume->voxel_count; v++) {
        uint32_t object = volume_object(volume, v);
        if (!object || atlas->objects[object - 1].label != question->label) {
            continue;
        }
        size_t row = v / dim[0];
        size_t slice = row / dim[1];
        double at[3] = {(double)(v % dim[0]), (double)(row % dim[1]), (double)slice};
        mat4_point(at, m, at);
        vec3_sub(at, at, question->origin);
        double depth = vec3_dot(at, axis);
        vec3_cross(across, at, axis);
        double widest =
            question->radius > 0 ? question->radius : depth * tan(radians_from_degrees(question->degrees) / 2);
        bool is_near = question->range[1] <= 0 || (depth >= question->range[0] && depth <= question->range[1]);
        count += depth > 0 && is_near && vec3_length(across) <= widest;
    }
    vec3_cross(side, m, m + 4);
    return count * fabs(vec3_dot(side, m + 8)); /* a voxel's volume */
}

/* The mean over grids turned in several ways, so that no voxel's centre happens to be on a border. */
static double relative_error(const struct question *question, double spacing)
{
    uint64_t random = 11;
    double sum = 0;
    for (int grid = 0; grid < GRIDS; grid++) {
        conus_atlas *atlas = painted(question, spacing, degrees_from_radians(test_random(&random, 0.1, 0.9)));
        double volume = counted(question, atlas);
        assert_near(volume, counted_one_by_one(question, atlas), 1e-9 * volume);
        double error = volume / question->volume - 1;
        sum += error * error;
        conus_atlas_destroy(atlas);
    }
    return 100 * sqrt(sum / GRIDS);
}

static void check(const struct question *question)
{
    double error[SIZES];
    for (int size = 0; size < SIZES; size++) {
        error[size] = relative_error(question, 4 / pow(2, size));
    }
    print_message("%s: %.1f mm^3: %.4f %.4f %.4f %.4f %%, order %.2f\n", question->what, question->volume, error[0],
                  error[1], error[2], error[3], log2(error[0] / error[3]) / (SIZES - 1));
    for (int size = 0; size < SIZES; size++) {
        assert_near(error[size], question->error[size], 0.0006);
    }
}

static void cones_in_a_ball(void **state)
{
    (void)state;
    double half = radians_from_degrees(20);
    struct question question = {.phantom = "sphere",
                                .what = "cone of 40 degrees in a ball",
                                .label = 1,
                                .origin = {-4, 0, 0},
                                .direction = {1, 0, 0},
                                .degrees = 40,
                                .volume = cone_in_ball(20, 4, half),
                                .error = {3.4577, 2.3228, 0.4338, 0.1067}};
    check(&question);
}

static void cones_in_a_slab(void **state)
{
    (void)state;
    struct question question = {.phantom = "slabs",
                                .what = "cone of 30 degrees in a slab",
                                .label = 1,
                                .origin = {1, -50, 2},
                                .direction = {0, 1, 0},
                                .degrees = 30,
                                .error = {3.4026, 0.8456, 0.1683, 0.0305}};
    question.volume = frustum(radians_from_degrees(15), 50 + 6, 50 + 12);
    check(&question);
}

static void cylinders_in_a_torus(void **state)
{
    (void)state;
    /* the inner half of the tube, by Pappus: area pi r^2 / 2, its centroid 4 r / (3 pi) inwards of the centre line */
    double tube = 6;
    double ring = 18;
    struct question question = {.phantom = "torus",
                                .what = "cylinder through the middle of a torus",
                                .label = 1,
                                .origin = {0, 0, 40},
                                .direction = {0, 0, -1},
                                .radius = ring,
                                .volume =
                                    MATH3_PI * MATH3_PI * ring * tube * tube - 4 * MATH3_PI / 3 * tube * tube * tube,
                                .error = {9.3965, 1.6083, 0.3816, 0.0993}};
    check(&question);
    question.what = "the same above 2 mm, by a range";
    question.range[0] = 10;
    question.range[1] = 38;
    question.volume = inside_torus_above(ring, tube, 2);
    memcpy(question.error, (double[SIZES]){12.4952, 3.5340, 0.5839, 0.1000}, sizeof question.error);
    check(&question);
}

TEST_GROUP(closed_census)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cones_in_a_ball),
        cmocka_unit_test(cones_in_a_slab),
        cmocka_unit_test(cylinders_in_a_torus),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
