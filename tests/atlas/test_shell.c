/* SPDX-License-Identifier: BSD-3-Clause */
/* The shell around areas and head: closed, as large as what it is around, with gaps filled. */
#include "base/geometry/math3.h"
#include "conus/atlas.h"
#include "mesh_scene.h"
#include "picture_scene.h"
#include "test.h"

/* Hollow: the hole and a gap towards -x do not count. */
static double hollow_ball(const double world[3])
{
    const double r = vec3_length(world);
    return r < 40 && r > 25 && !(world[0] < 0 && fabs(world[1]) < 4 && fabs(world[2]) < 4);
}

static double ball_of_60(const double world[3])
{
    return vec3_length(world) < 60 ? 100 : 0;
}

static double two_balls(const double world[3])
{
    return vec3_length((const double[]){fabs(world[0]) - 30, world[1], world[2]}) < 16;
}

/* Balls of radius r whose middles are so far from the origin, at both sides along x; in a box with that longest edge:
 * cubes of a 96th of it, and the surface is 0.84 of one outside, by the standard deviation of the smoothing. A half of
 * one is left for what the voxels make of a ball. */
static void check_balls(const conus_atlas *atlas, double aside, double radius, double longest)
{
    const double edge = longest / 96;
    const double wanted = radius + 0.84 * edge;
    const double balls = aside > 0 ? 2 : 1;
    assert_int_equal(atlas->context_surface_count, 1);
    const struct mesh *mesh = &atlas->context_surfaces[0].mesh;
    assert_true(mesh->shape.closed && mesh->shape.has_volume);
    assert_near(cbrt(mesh->shape.volume_mm3 / balls * 3 / (4 * MATH3_PI)), wanted, 0.3 * edge);
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const float *at = mesh->positions + 3 * i;
        const double r = vec3_length((const double[]){fabs((double)at[0]) - aside, (double)at[1], (double)at[2]});
        assert_near(r, wanted, 1.2 * edge);
    }
}

static void it_is_around_areas_and_head(void **state)
{
    (void)state;
    const conus_volume_info grid = picture_grid((size_t[]){128, 128, 128}, (double[]){1, 1, 1}, picture_identity);
    for (int has_head = 0; has_head < 2; has_head++) {
        conus_atlas *atlas = picture_atlas(&grid, hollow_ball, NULL, has_head ? ball_of_60 : NULL);
        assert_ok(conus_atlas_add_shell(atlas, 0.3));
        check_balls(atlas, 0, has_head ? 60 : 40, has_head ? 128 : 80);
        assert_near(atlas->context_surfaces[0].opacity, 0.3, 0);
        conus_atlas_destroy(atlas);
    }
}

/* What lies between areas along one axis alone is outside: nothing joins the two. */
static void areas_apart_have_shells_apart(void **state)
{
    (void)state;
    const conus_volume_info grid = picture_grid((size_t[]){128, 128, 128}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, two_balls, NULL, NULL);
    assert_ok(conus_atlas_add_shell(atlas, 0));
    check_balls(atlas, 30, 16, 92);
    conus_atlas_destroy(atlas);
}

static void what_has_no_shell_is_refused(void **state)
{
    (void)state;
    const conus_volume_info grid = picture_grid((size_t[]){8, 8, 8}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ten, NULL, NULL);
    assert_fails(conus_atlas_add_shell(atlas, 1.5), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_add_shell(atlas, -1), CONUS_ERROR_ARGUMENT);
    assert_int_equal(atlas->context_surface_count, 0);
    conus_atlas_destroy(atlas);
    atlas = mesh_scene_atlas();
    struct mesh box = mesh_scene_box((double[]){-1, -1, -1}, (double[]){1, 1, 1});
    mesh_scene_add(atlas, &box);
    assert_fails(conus_atlas_add_shell(atlas, 0), CONUS_ERROR_ARGUMENT);
    conus_atlas_destroy(atlas);
}

static conus_status add_once(void *data)
{
    const size_t before = ((conus_atlas *)data)->context_surface_count;
    conus_status status = conus_atlas_add_shell(data, 0);
    atlas_cut_context_surfaces(data, before);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    const conus_volume_info grid = picture_grid((size_t[]){8, 8, 8}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ten, NULL, picture_ten);
    test_every_allocation(add_once, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(shell)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_around_areas_and_head),
        cmocka_unit_test(areas_apart_have_shells_apart),
        cmocka_unit_test(what_has_no_shell_is_refused),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
