/* SPDX-License-Identifier: BSD-3-Clause */
/* The rate at which thin objects in a cone are found: by the census of Eq. 10, by rays, and on the planes of Eq. 7.
 * This test keeps the figures in docs/model.md true. Each tube is alone in its grid, so that nothing hides it. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "scene.h"
#include "selection/selection.h"
#include "test.h"

#include <string.h>

enum { POSES = 500 };

/* The phantom `tubes` with only the tube `label` in it. */
static conus_atlas *one_tube(uint32_t label)
{
    struct phantom_drawing drawing;
    conus_atlas *atlas = NULL;
    assert_ok(phantom_draw(&drawing, "tubes", &(conus_phantom_options){0}));
    size_t count = drawing.grid.dim[0] * drawing.grid.dim[1] * drawing.grid.dim[2];
    for (size_t v = 0; v < count; v++) {
        drawing.labels[v] = drawing.labels[v] == label ? label : 0;
    }
    assert_ok(phantom_drawing_atlas(&atlas, &drawing));
    phantom_drawing_finish(&drawing);
    return atlas;
}

/* A pose 200 mm away, towards a place within 12 mm of a voxel of the tube: its cones hold the tube, graze it or miss
 * it. */
static conus_pose aim(const struct volume *volume, uint64_t *random)
{
    double target[3];
    double origin[3];
    conus_pose pose;
    size_t voxel;
    do {
        voxel = (size_t)test_random(random, 0, (double)volume->voxel_count);
    } while (!volume_object(volume, voxel));
    scene_voxel(target, volume, voxel);
    double z = test_random(random, -1, 1);
    double turn = test_random(random, 0, 2 * MATH3_PI);
    const double out[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
    for (int a = 0; a < 3; a++) {
        target[a] += test_random(random, -12, 12);
    }
    vec3_add_scaled(origin, target, 200, out);
    assert_ok(conus_pose_toward(&pose, origin, target, NULL));
    return pose;
}

/* Whether any of the tube's voxels has its centre in the cone: by the angle to the axis. */
static bool is_in_cone(const struct volume *volume, const conus_pose *pose, double angle)
{
    const double *m = pose->world_from_device;
    for (size_t voxel = 0; voxel < volume->voxel_count; voxel++) {
        double v[3];
        if (volume_object(volume, voxel)) {
            scene_voxel(v, volume, voxel);
            vec3_sub(v, v, m + 12);
            if (acos(-vec3_dot(v, m + 8) / vec3_length(v)) <= angle / 2) {
                return true;
            }
        }
    }
    return false;
}

static bool is_found(conus_selector *selector, const conus_pose *pose, double angle)
{
    conus_selection *selection = NULL;
    assert_ok(conus_select(&selection, selector, pose, degrees_from_radians(angle)));
    bool found = conus_selection_count(selection) > 1;
    conus_selection_destroy(selection);
    return found;
}

/* Ways to find it: the census, rays without it, N/5 and N planes. */
enum { CENSUS, RAYS, FIFTH, PLANES, WAYS };

static void make_selectors(conus_selector *selectors[WAYS], const conus_atlas *atlas)
{
    static const conus_selector_options options[WAYS] = {
        [CENSUS] = {.resolution = 16, .layers = CONUS_LAYERS_ALL},
        [RAYS] = {.resolution = 16},
        [FIFTH] = {.resolution = 16, .sampling = CONUS_SAMPLING_SLICES},
        [PLANES] = {.resolution = 16, .sampling = CONUS_SAMPLING_SLICES, .slices = 5 * 90}};
    for (int way = 0; way < WAYS; way++) {
        selectors[way] = NULL;
        assert_ok(conus_selector_create(&selectors[way], atlas, &options[way]));
    }
}

/* Per cent of the cones that hold the tube in which it is not found. */
static void measure(double lost[WAYS], uint32_t label, double degrees)
{
    conus_atlas *atlas = one_tube(label);
    const struct volume *volume = &atlas->volumes[0];
    const double angle = radians_from_degrees(degrees);
    conus_selector *selectors[WAYS];
    size_t missing[WAYS] = {0};
    size_t cones = 0;
    uint64_t random = 2010;
    make_selectors(selectors, atlas);
    for (int i = 0; i < POSES; i++) {
        conus_pose pose = aim(volume, &random);
        bool in_cone = is_in_cone(volume, &pose, angle);
        cones += in_cone;
        for (int way = 0; way < WAYS; way++) {
            missing[way] += in_cone && !is_found(selectors[way], &pose, angle);
        }
    }
    assert_true(cones > 300);
    for (int way = 0; way < WAYS; way++) {
        lost[way] = 100 * (double)missing[way] / (double)cones;
        conus_selector_destroy(selectors[way]);
    }
    print_message("tube of %u voxels, %zu cones of %g degrees: lost by the census %.2f %%, rays %.2f %%, N/5 planes "
                  "%.2f %%, N planes %.2f %%\n",
                  label, cones, degrees, lost[CENSUS], lost[RAYS], lost[FIFTH], lost[PLANES]);
    conus_atlas_destroy(atlas);
}

static void no_tube_in_the_cone_is_missing(void **state)
{
    (void)state;
    static const struct {
        uint32_t tube;
        double degrees, lost[WAYS];
    } rows[] = {
        {1, 5, {0.00, 0.00, 18.60, 0.54}},   {2, 5, {0.00, 0.00, 8.46, 0.00}},   {3, 5, {0.00, 0.00, 7.29, 0.25}},
        {4, 5, {0.00, 0.00, 2.82, 0.00}},    {5, 5, {0.00, 0.00, 1.42, 0.00}},   {6, 5, {0.00, 0.00, 1.12, 0.00}},
        {1, 20, {0.00, 5.00, 60.20, 10.40}}, {2, 20, {0.00, 1.00, 13.60, 1.00}}, {3, 20, {0.00, 0.20, 1.60, 0.40}},
        {4, 20, {0.00, 0.00, 0.00, 0.00}},   {5, 20, {0.00, 0.00, 0.00, 0.00}},  {6, 20, {0.00, 0.00, 0.00, 0.00}}};
    for (size_t row = 0; row < sizeof rows / sizeof rows[0]; row++) {
        double lost[WAYS];
        measure(lost, rows[row].tube, rows[row].degrees);
        for (int way = 0; way < WAYS; way++) {
            assert_near(lost[way], rows[row].lost[way], 0.006);
        }
    }
}

TEST_GROUP(recall)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_tube_in_the_cone_is_missing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
