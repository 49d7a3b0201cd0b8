/* SPDX-License-Identifier: BSD-3-Clause */
/* The Allen CCF in an atlas, and positions in it and from bregma.
 *
 * The expected values follow from the words alone. The CCF's grid is 13.2 x 8 x 11.4 mm along AP, DV and ML, so of 66 x
 * 40 x 57 voxels of 200 um; AP grows backward, DV downward, ML to the right; voxel n of an axis has its centre at
 * 200 (n + 1/2) um. Here the corner lies at (-5.7, 3, 1) mm of a RAS world, so that
 *     x = -5.7 + ML / 1000,  y = 3 - AP / 1000,  z = 1 - DV / 1000. */
#include "atlas/atlas.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"
#include "scene.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

static const size_t ccf_dim[3] = {66, 40, 57}; /* AP, DV, ML */
static const double corner[3] = {-5.7, 3, 1};

static void expect_near(const double *found, const double *wanted, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!(fabs(found[i] - wanted[i]) <= 1e-9 * (1 + fabs(wanted[i])))) {
            fail_msg("%zu: found %.12g, wanted %.12g", i, found[i], wanted[i]);
        }
    }
}

static void world_of_ccf(double world[3], const double ccf[3])
{
    world[0] = corner[0] + ccf[2] / 1000;
    world[1] = corner[1] - ccf[0] / 1000;
    world[2] = corner[2] - ccf[1] / 1000;
}

static conus_atlas *atlas_of(const size_t dim[3], const double m[16])
{
    conus_volume_info grid = scene_plain_grid(dim, m);
    uint32_t *labels = calloc(dim[0] * dim[1] * dim[2], sizeof *labels);
    labels[7] = 1;
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    free(labels);
    return atlas;
}

/* The CCF as a volume whose axis `order[a]` runs along CCF's axis a, from its end if `back[a]`. */
static conus_atlas *layout(const int order[3], const bool back[3])
{
    static const int rows[3] = {1, 2, 0}; /* world axes of AP, DV, ML */
    static const double signs[3] = {-1, -1, 1};
    size_t dim[3];
    double m[16] = {0};
    m[15] = 1;
    memcpy(m + 12, corner, sizeof corner);
    for (int a = 0; a < 3; a++) {
        double length = 0.2 * (double)ccf_dim[a];
        dim[order[a]] = ccf_dim[a];
        m[4 * order[a] + rows[a]] = signs[a] * (back[a] ? -0.2 : 0.2);
        m[12 + rows[a]] += signs[a] * (back[a] ? length - 0.1 : 0.1);
    }
    return atlas_of(dim, m);
}

static void every_layout_of_the_grid_is_one_place(void **state)
{
    (void)state;
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    static const double points[][3] = {{100, 100, 100}, {5400, 332, 5739}, {13100, 7900, 11300}, {-2000, 50, 12000}};
    for (int k = 0; k < 48; k++) {
        const bool back[3] = {k & 1, k & 2, k & 4};
        conus_atlas *atlas = layout(orders[k / 8], back);
        conus_frame frame;
        assert_ok(conus_frame_find(&frame, atlas, CONUS_SPACE_CCF, NULL));
        assert_int_equal(conus_atlas_brain(atlas).brain, CONUS_BRAIN_TEMPLATE);
        assert_string_equal(conus_atlas_brain(atlas).words, "Allen CCF");
        struct midline midline;
        frame_midline(&midline, atlas);
        assert_true(midline.is_ccf && !midline.is_turned);
        for (size_t i = 0; i < sizeof points / sizeof points[0]; i++) {
            double world[3];
            double wanted[3];
            world_of_ccf(wanted, points[i]);
            assert_ok(conus_frame_to_world(world, &frame, points[i]));
            expect_near(world, wanted, 3);
            mat4_point(world, midline.side_from_own, wanted);
            assert_float_equal(world[0], (points[i][2] - 5700) / 1000, 1e-9); /* mm to the right */
            conus_frame_from_world(world, &frame, wanted);
            expect_near(world, points[i], 3);
        }
        conus_atlas_destroy(atlas);
    }
}

/* Axes that call AP x, DV y and ML z, as the Allen Institute's own arrays do: each counts from its first voxel. */
static void plain_axes_count_from_the_first_voxel(void **state)
{
    (void)state;
    const double m[16] = {-0.2, 0, 0, 0, 0, -0.2, 0, 0, 0, 0, 0.2, 0, 4, 5, 6, 1}; /* the centre of voxel 0, 0, 0 */
    conus_atlas *atlas = atlas_of(ccf_dim, m);
    conus_frame frame;
    double world[3];
    assert_ok(conus_frame_find(&frame, atlas, CONUS_SPACE_CCF, NULL));
    assert_ok(conus_frame_to_world(world, &frame, (double[3]){100 + 3 * 200, 100 + 5 * 200, 100 + 50 * 200}));
    expect_near(world, (double[3]){4 - 0.6, 5 - 1, 6 + 10}, 3);
    conus_atlas_destroy(atlas);
}

/* Refused: another size, micrometres that are called mm, axes that are neither anatomical nor the Allen Institute's, no
 * voxels. */
static void other_atlases_are_refused(void **state)
{
    (void)state;
    const double fine[16] = {0, -0.2, 0, 0, 0, 0, -0.2, 0, 0.2, 0, 0, 0, 0, 0, 0, 1};
    const double large[16] = {0, -200, 0, 0, 0, 0, -200, 0, 200, 0, 0, 0, 0, 0, 0, 1};
    const double swapped[16] = {0, 0, -0.2, 0, 0, -0.2, 0, 0, 0.2, 0, 0, 0, 0, 0, 0, 1};
    const size_t dims[3][3] = {{66, 40, 56}, {66, 40, 57}, {40, 66, 57}};
    const double *const matrices[3] = {fine, large, fine};
    conus_frame frame = {.space = CONUS_SPACE_LPS};
    for (int i = 0; i < 3; i++) {
        conus_atlas *atlas = atlas_of(dims[i], matrices[i]);
        assert_fails(conus_frame_find(&frame, atlas, CONUS_SPACE_BREGMA, NULL), CONUS_ERROR_UNSUPPORTED);
        assert_int_equal(frame.space, CONUS_SPACE_LPS);
        conus_atlas_destroy(atlas);
    }
    conus_atlas *atlas = atlas_of(ccf_dim, swapped); /* AP, DV and ML in their order, though called otherwise */
    assert_ok(conus_frame_find(&frame, atlas, CONUS_SPACE_CCF, NULL));
    conus_atlas_destroy(atlas);
    assert_fails(conus_frame_find(&frame, NULL, CONUS_SPACE_CCF, NULL), CONUS_ERROR_UNSUPPORTED);
    assert_fails(conus_frame_find(&frame, NULL, (conus_space)4, NULL), CONUS_ERROR_ARGUMENT);
}

/* Bregma is AP 5400, DV 332, ML 5739 um; AP + forward, ML + right, DV + up. */
static void bregma_is_where_its_source_has_it(void **state)
{
    (void)state;
    conus_atlas *atlas = layout((const int[3]){0, 1, 2}, (const bool[3]){false, false, false});
    conus_frame frame;
    double world[3];
    double wanted[3];
    assert_ok(conus_frame_find(&frame, atlas, CONUS_SPACE_BREGMA, NULL));
    const double steps[3][3] = {{-3.4, 2, -2.5}, {1, 0, 0}, {0, 0, 0}};
    const double ccf[3][3] = {{8800, 2832, 7739}, {4400, 332, 5739}, {5400, 332, 5739}};
    for (int i = 0; i < 3; i++) {
        world_of_ccf(wanted, ccf[i]);
        assert_ok(conus_frame_to_world(world, &frame, steps[i]));
        expect_near(world, wanted, 3);
    }
    conus_frame_direction_to_world(world, &frame, (double[3]){0, 1, 0});
    assert_true(world[0] > 0 && world[1] == 0 && world[2] == 0); /* ML, to the right */
    conus_frame_direction_from_world(world, &frame, (double[3]){0, 0, -7});
    expect_near(world, (double[3]){0, 0, -1}, 3); /* DV, of length 1 */
    assert_ok(conus_frame_find(&frame, atlas, CONUS_SPACE_BREGMA, (double[3]){5000, 300, 5700}));
    world_of_ccf(wanted, (double[3]){5000, 300, 5700});
    assert_ok(conus_frame_to_world(world, &frame, (double[3]){0, 0, 0}));
    expect_near(world, wanted, 3);
    assert_fails(conus_frame_find(&frame, atlas, CONUS_SPACE_BREGMA, (double[3]){5400, 332, 11401}),
                 CONUS_ERROR_ARGUMENT);
    assert_fails(conus_frame_find(&frame, atlas, CONUS_SPACE_BREGMA, (double[3]){NAN, 332, 5739}),
                 CONUS_ERROR_ARGUMENT);
    conus_atlas_destroy(atlas);
}

static void units_that_cannot_be_meant_are_refused(void **state)
{
    (void)state;
    conus_atlas *atlas = layout((const int[3]){2, 1, 0}, (const bool[3]){true, false, true});
    conus_frame ccf;
    conus_frame bregma;
    double world[3] = {1, 2, 3};
    assert_ok(conus_frame_find(&ccf, atlas, CONUS_SPACE_CCF, NULL));
    assert_ok(conus_frame_find(&bregma, atlas, CONUS_SPACE_BREGMA, NULL));
    assert_fails(conus_frame_to_world(world, &ccf, (double[3]){5.4, 0.332, 5.739}), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "not mm"));
    assert_fails(conus_frame_to_world(world, &bregma, (double[3]){-3400, 2000, -2500}), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "not micrometres"));
    assert_fails(conus_frame_to_world(world, &bregma, (double[3]){0, INFINITY, 0}), CONUS_ERROR_ARGUMENT);
    expect_near(world, (double[3]){1, 2, 3}, 3);
    assert_ok(conus_frame_to_world(world, &ccf, (double[3]){0, 20, 0})); /* the outermost place that is taken */
    assert_ok(conus_frame_to_world(world, &bregma, (double[3]){0, 0, 100}));
    conus_atlas_destroy(atlas);
}

static void people_have_right_and_left(void **state)
{
    (void)state;
    conus_frame frame;
    double p[3] = {1, -2, 3};
    assert_ok(conus_frame_find(&frame, NULL, CONUS_SPACE_RAS, NULL));
    assert_ok(conus_frame_to_world(p, &frame, p));
    expect_near(p, (double[3]){1, -2, 3}, 3);
    assert_ok(conus_frame_find(&frame, NULL, CONUS_SPACE_LPS, NULL));
    assert_ok(conus_frame_to_world(p, &frame, p));
    expect_near(p, (double[3]){-1, 2, 3}, 3);
    conus_frame_direction_to_world(p, &frame, p);
    conus_frame_direction_from_world(p, &frame, p);
    expect_near(p, (double[3]){-1, 2, 3}, 3);
}

/* An atlas that was moved takes the CCF with it: the point p is now at (p - shift) / 2. */
static void a_moved_atlas_moves_its_positions(void **state)
{
    (void)state;
    const double atlas_from_world[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 10, 20, 30, 1};
    conus_atlas *atlas = layout((const int[3]){1, 0, 2}, (const bool[3]){false, true, true});
    conus_frame frame;
    double world[3];
    double wanted[3];
    assert_ok(conus_atlas_move(atlas, atlas_from_world));
    assert_ok(conus_frame_find(&frame, atlas, CONUS_SPACE_CCF, NULL));
    assert_ok(conus_frame_to_world(world, &frame, (double[3]){5400, 332, 5739}));
    world_of_ccf(wanted, (double[3]){5400, 332, 5739});
    for (int i = 0; i < 3; i++) {
        wanted[i] = (wanted[i] - atlas_from_world[12 + i]) / 2;
    }
    expect_near(world, wanted, 3);
    conus_atlas_destroy(atlas);
}

static void a_ccf_frame_must_fit_the_grid(void **state)
{
    (void)state;
    conus_atlas *atlas = layout((const int[3]){0, 1, 2}, (const bool[3]){false, false, false});
    assert_fails(frame_set_ccf(atlas, false), CONUS_ERROR_DATA); /* the corner is not the origin */
    assert_false(atlas->has_ccf);
    conus_atlas_destroy(atlas);
    const double small[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    atlas = atlas_of((const size_t[3]){9, 9, 9}, small);
    conus_frame frame;
    double world[3];
    assert_ok(frame_set_ccf(atlas, true));
    assert_ok(conus_frame_find(&frame, atlas, CONUS_SPACE_CCF, NULL));
    assert_ok(conus_frame_to_world(world, &frame, (double[3]){1000, 2000, 3000}));
    expect_near(world, (double[3]){-3, -1, -2}, 3);
    assert_ok(frame_set_ccf(atlas, false));
    assert_ok(conus_frame_find(&frame, atlas, CONUS_SPACE_CCF, NULL));
    assert_ok(conus_frame_to_world(world, &frame, (double[3]){1000, 2000, 3000}));
    expect_near(world, (double[3]){3, -1, -2}, 3);
    conus_atlas_destroy(atlas);
}

/* Right, anterior and superior are right-handed. A world may have each of its axes the other way, so be a mirror image;
 * then so is the device's frame. With the tip down and up to the front, x is to the right in every one; leaning to the
 * front by 30 degrees up is dorsal, without one given. */
static void a_device_is_turned_as_its_space_has_it(void **state)
{
    (void)state;
    for (int k = 0; k < 16; k++) {
        const bool is_ccf = k & 8;
        const double right[3] = {k & 1 ? -1 : 1}, front[3] = {0, k & 2 ? -1 : 1}, above[3] = {0, 0, k & 4 ? -1 : 1};
        conus_frame frame = {.space = is_ccf ? CONUS_SPACE_CCF : CONUS_SPACE_BREGMA};
        mat4_identity(frame.world_from_space);
        for (int a = 0; a < 3; a++) {
            double *m = frame.world_from_space + a;
            m[0] = is_ccf ? -front[a] / 1000 : front[a];
            m[4] = is_ccf ? -above[a] / 1000 : right[a];
            m[8] = is_ccf ? right[a] / 1000 : above[a];
        }
        conus_pose pose;
        double down[3];
        double leaning[3];
        vec3_scale(down, above, -1);
        assert_ok(conus_pose_along(&pose, (const double[]){1, 2, 3}, down, front));
        conus_frame_turn_pose(&pose, &frame, true);
        expect_near(pose.world_from_device, right, 3);
        expect_near(pose.world_from_device + 4, front, 3);
        expect_near(pose.world_from_device + 12, (const double[]){1, 2, 3}, 3);
        assert_ok(pose_roll(&pose, MATH3_PI / 2)); /* y to where x was, and that backward */
        expect_near(pose.world_from_device + 4, right, 3);
        vec3_scale(down, front, -1);
        expect_near(pose.world_from_device, down, 3);
        vec3_scale(leaning, above, -sqrt(0.75));
        vec3_add_scaled(leaning, leaning, 0.5, front);
        assert_ok(conus_pose_along(&pose, corner, leaning, NULL));
        conus_frame_turn_pose(&pose, &frame, false);
        vec3_scale(down, front, sqrt(0.75));
        vec3_add_scaled(down, down, 0.5, above);
        expect_near(pose.world_from_device, right, 3);
        expect_near(pose.world_from_device + 4, down, 3);
        assert_int_equal(pose_is_mirrored(&pose), (k ^ k >> 1 ^ k >> 2) & 1);
        assert_int_equal(conus_pose_from_matrix(&pose, pose.world_from_device) != CONUS_OK, (k ^ k >> 1 ^ k >> 2) & 1);
        assert_ok(pose_settle_in(&pose, pose.world_from_device, &frame));
    }
}

static void spaces_have_names(void **state)
{
    (void)state;
    assert_string_equal(conus_space_name(CONUS_SPACE_BREGMA), "bregma");
    assert_null(conus_space_name(4));
    assert_string_equal(conus_space_axis(CONUS_SPACE_CCF, 1), "DV");
    assert_string_equal(conus_space_axis(CONUS_SPACE_BREGMA, 1), "ML");
    assert_null(conus_space_axis(CONUS_SPACE_CCF, 3));
    assert_null(conus_space_axis((conus_space)4, 0));
    assert_string_equal(conus_space_unit(CONUS_SPACE_CCF), "um");
    assert_null(conus_space_unit((conus_space)4));
}

TEST_GROUP(frame)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout_of_the_grid_is_one_place),
        cmocka_unit_test(plain_axes_count_from_the_first_voxel),
        cmocka_unit_test(other_atlases_are_refused),
        cmocka_unit_test(bregma_is_where_its_source_has_it),
        cmocka_unit_test(units_that_cannot_be_meant_are_refused),
        cmocka_unit_test(people_have_right_and_left),
        cmocka_unit_test(a_moved_atlas_moves_its_positions),
        cmocka_unit_test(a_ccf_frame_must_fit_the_grid),
        cmocka_unit_test(a_device_is_turned_as_its_space_has_it),
        cmocka_unit_test(spaces_have_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
