/* SPDX-License-Identifier: BSD-3-Clause */
/* Balls: distances to cells and surfaces against other ways of finding them, volumes by Eq. 10. */
#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "conus/image.h"
#include "mesh_scene.h"
#include "report_scene.h"
#include "scene.h"
#include "selection/selection.h"
#include "test.h"

#include <string.h>

/* The cell of a voxel as a closed surface of 12 triangles. */
static void cell_mesh(struct mesh *out, const double world_from_voxel[16], const double voxel[3])
{
    static const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    assert_ok(mesh_init(out, 8, 12));
    for (uint32_t corner = 0; corner < 8; corner++) {
        double p[3];
        for (uint32_t a = 0; a < 3; a++) {
            p[a] = voxel[a] + (corner >> a & 1 ? 0.5 : -0.5);
        }
        mat4_point(p, world_from_voxel, p);
        for (uint32_t a = 0; a < 3; a++) {
            out->positions[3 * corner + a] = (float)p[a];
        }
    }
    for (size_t q = 0; q < 6; q++) {
        const uint32_t *c = quads[q];
        const uint32_t triangles[6] = {c[0], c[1], c[2], c[0], c[2], c[3]};
        memcpy(out->triangles + 6 * q, triangles, sizeof triangles);
    }
}

static bool holds(const struct volume *volume, const double voxel[3], const double point[3])
{
    double at[3];
    mat4_point(at, volume->voxel_from_world, point);
    return fabs(at[0] - voxel[0]) <= 0.5 && fabs(at[1] - voxel[1]) <= 0.5 && fabs(at[2] - voxel[2]) <= 0.5;
}

/* Least distance from the point to a cell of each object, with every voxel as a polyhedron. */
static void measure(double *distances, const struct volume *volume, const double point[3])
{
    const size_t *dim = volume->info.dim;
    for (size_t v = 0; v < volume->voxel_count; v++) {
        uint32_t object = volume_object(volume, v);
        size_t i = v % dim[0];
        size_t j = v / dim[0] % dim[1];
        size_t k = v / dim[0] / dim[1];
        const double voxel[3] = {(double)i, (double)j, (double)k};
        if (object) {
            struct mesh cell = {0};
            double nearest[3];
            cell_mesh(&cell, volume->info.world_from_voxel, voxel);
            double distance = holds(volume, voxel, point) ? 0 : mesh_nearest(nearest, &cell, point, INFINITY);
            distances[object] = fmin(distances[object], distance);
            mesh_finish(&cell);
        }
    }
}

static void check_row(const conus_result *result, double distance, const double centre[3])
{
    double offset[3];
    assert_near(result->distance, distance, 2e-5); /* the polyhedra are of floats */
    vec3_sub(offset, result->contact, centre);
    assert_near(vec3_length(offset), result->distance, 1e-9);
    assert_int_equal(result->pixels, 0);
}

/* Returns the number of objects that are near, but not around the centre. */
static size_t check_ball(const conus_selection *selection, const conus_atlas *atlas)
{
    const struct region *ball = &selection->region;
    double distances[16];
    size_t beside = 0;
    size_t count = conus_selection_count(selection);
    for (size_t i = 0; i < 16; i++) {
        distances[i] = INFINITY;
    }
    for (size_t v = 0; v < atlas->volume_count; v++) {
        measure(distances, &atlas->volumes[v], ball->origin);
    }
    for (size_t i = 0; i + 1 < count; i++) {
        const conus_result *result = conus_selection_result(selection, i);
        check_row(result, distances[result->object], ball->origin);
        assert_true(i == 0 || !(result->share > conus_selection_result(selection, i - 1)->share));
        distances[result->object] = INFINITY;
        beside += result->distance > 0;
    }
    for (size_t object = 1; object <= atlas->object_count; object++) {
        assert_true(distances[object] > ball->radius - 2e-5); /* every object within the radius has a row */
    }
    return beside;
}

static void distances_are_those_of_cells(void **unused)
{
    (void)unused;
    uint64_t state = 3;
    size_t beside = 0;
    for (int scene = 0; scene < 40; scene++) {
        conus_atlas *atlas = scene_atlas(&state, 9, scene % 3);
        conus_selector *selector = NULL;
        assert_ok(conus_selector_create(&selector, atlas, NULL));
        for (int i = 0; i < 12; i++) {
            conus_selection *selection = NULL;
            const conus_volume_info *info = &atlas->volumes[0].info;
            double centre[3];
            for (int a = 0; a < 3; a++) {
                centre[a] = test_random(&state, -3, (double)info->dim[a] + 3);
            }
            mat4_point(centre, info->world_from_voxel, centre);
            assert_ok(conus_select_ball(&selection, selector, centre, pow(10, test_random(&state, -1, 1.3))));
            beside += check_ball(selection, atlas);
            conus_selection_destroy(selection);
        }
        conus_selector_destroy(selector);
        conus_atlas_destroy(atlas);
    }
    assert_true(beside > 400);
}

/* A cube of 10 mm as voxels and as a mesh. */

struct fixture {
    conus_atlas *atlas;
    conus_selector *selector;
};

static int set_up(void **state)
{
    static struct fixture fixture;
    uint32_t labels[16 * 16 * 16] = {0};
    const conus_volume_info grid = scene_plain_grid((size_t[]){16, 16, 16}, NULL);
    for (size_t v = 0; v < 4096; v++) {
        size_t i = v % 16, j = v / 16 % 16, k = v / 256;
        labels[v] = i >= 3 && i < 13 && j >= 3 && j < 13 && k >= 3 && k < 13 ? 7 : 0;
    }
    fixture.atlas = scene_parcellation(&grid, labels);
    double doubled[16];
    struct mesh mesh;
    mat4_identity(doubled);
    doubled[0] = doubled[5] = doubled[10] = 10; /* the unit cell around 0, 10 mm wide and 40 mm to the right */
    doubled[12] = 47.5;
    doubled[13] = doubled[14] = 7.5;
    cell_mesh(&mesh, doubled, (double[]){0, 0, 0});
    mesh_scene_add(fixture.atlas, &mesh);
    assert_ok(conus_selector_create(&fixture.selector, fixture.atlas, NULL));
    *state = &fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    conus_selector_destroy(fixture->selector);
    conus_atlas_destroy(fixture->atlas);
    return 0;
}

static conus_selection *ball(const struct fixture *fixture, double x, double y, double z, double radius)
{
    conus_selection *selection = NULL;
    assert_ok(conus_select_ball(&selection, fixture->selector, (double[]){x, y, z}, radius));
    return selection;
}

static void assert_nearest(const struct fixture *fixture, double x, double y, double z, const double wanted[4])
{
    conus_selection *selection = ball(fixture, x, y, z, 8);
    const conus_result *result = conus_selection_result(selection, 0);
    assert_int_equal(conus_selection_count(selection), 2);
    assert_near(result->distance, wanted[3], 1e-12);
    for (int a = 0; a < 3; a++) {
        assert_near(result->contact[a], wanted[a], 1e-12);
    }
    conus_selection_destroy(selection);
}

static void cells_and_surfaces_are_as_near(void **state)
{
    const struct fixture *fixture = *state;
    for (int mesh = 0; mesh < 2; mesh++) {
        double right = mesh ? 40 : 0; /* x of the voxels' cube, and of the same cube as a mesh */
        assert_nearest(fixture, right + 7, 8, 9, (double[]){right + 7, 8, 9, 0});
        assert_nearest(fixture, right + 15.5, 8, 9, (double[]){right + 12.5, 8, 9, 3});
        assert_nearest(fixture, right + 15.5, 16.5, 9, (double[]){right + 12.5, 12.5, 9, 5});
        assert_nearest(fixture, right + 1.5, 0.5, 0.5, (double[]){right + 2.5, 2.5, 2.5, 3});
    }
}

static void volumes_are_those_of_voxels(void **state)
{
    conus_selection *selection = ball(*state, 7, 7, 7, 1); /* a voxel and its 6 neighbours */
    const conus_result *area = conus_selection_result(selection, 0);
    assert_int_equal(area->voxels, 7);
    assert_near(area->volume, 7, 0);
    assert_near(area->fraction, 0.007, 1e-15);
    assert_near(area->share, 1, 0);
    assert_near(area->score, 1, 0);
    assert_near(area->centroid[0], 7, 1e-15);
    conus_selection_destroy(selection);
    selection = ball(*state, 2, 7, 7, 1); /* one of seven is in the area */
    area = conus_selection_result(selection, 0);
    assert_near(area->share, 1.0 / 7, 1e-15);
    assert_near(conus_selection_result(selection, 1)->share, 6.0 / 7, 1e-15);
    conus_selection_destroy(selection);
    selection = ball(*state, 2.4, 7.4, 7.4, 0.2); /* no voxel's centre, but a cell */
    area = conus_selection_result(selection, 0);
    assert_int_equal(area->voxels, 0);
    assert_near(area->distance, 0.1, 1e-12);
    assert_near(area->volume, 0, 0);
    assert_true(isnan(area->share));
    conus_selection_destroy(selection);
}

static void a_mesh_has_no_voxels(void **state)
{
    conus_selection *selection = ball(*state, 47, 8, 9, 3);
    const conus_result *area = conus_selection_result(selection, 0);
    assert_int_equal(area->object, 2);
    assert_near(area->distance, 0, 0);
    assert_near(area->volume, 36 * MATH3_PI, 1e-9); /* the ball lies in the cube */
    assert_near(area->fraction, 0.036 * MATH3_PI, 1e-12);
    assert_int_equal(area->voxels, 0);
    assert_true(isnan(area->share));
    conus_selection_destroy(selection);
}

static void winding_tells_inside(void **unused)
{
    (void)unused;
    struct mesh sphere = mesh_scene_sphere((double[]){1, 2, 3}, 20, 24, 48);
    assert_near(mesh_winding(&sphere, (double[]){5, 2, -3}), 1, 1e-6);
    assert_near(mesh_winding(&sphere, (double[]){25, 2, 3}), 0, 1e-6);
    sphere.triangle_count /= 2; /* half of it: from its centre half a turn */
    assert_near(fabs(mesh_winding(&sphere, (double[]){1, 2, 3})), 0.5, 1e-6);
    mesh_finish(&sphere);
}

/* The cubes are [2.5, 12.5] and [42.5, 52.5] along x, [2.5, 12.5] along y and z. */
static void a_point_has_what_holds_it_or_the_nearest(void **state)
{
    static const struct {
        double x;
        double wanted[2]; /* distance of the voxels' cube and of the mesh; NAN = it has no row */
    } cases[] = {{0.6, {1.9, NAN}},    {0, {2.5, NAN}},      {7.5, {0, NAN}},   {47.5, {NAN, 0}},
                 {-100, {102.5, NAN}}, {1000, {NAN, 947.5}}, {27, {14.5, NAN}}, {27.5, {15, 15}}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_selection *selection = ball(*state, cases[i].x, 7.5, 7.5, 0);
        double found[3] = {NAN, NAN, NAN};
        for (size_t k = 0; k < conus_selection_count(selection); k++) {
            const conus_result *result = conus_selection_result(selection, k);
            found[result->object] = result->distance;
            assert_int_equal(result->rank, k + 1);
            assert_true(isnan(result->share) && isnan(result->score) && isnan(result->volume));
        }
        assert_near(conus_selection_ball(selection), 0, 0);
        assert_true(isnan(found[0])); /* what is at no object has no row */
        for (size_t k = 0; k < 2; k++) {
            assert_int_equal(!isnan(found[k + 1]), !isnan(cases[i].wanted[k]));
            assert_true(isnan(found[k + 1]) || fabs(found[k + 1] - cases[i].wanted[k]) < 1e-12);
        }
        conus_selection_destroy(selection);
    }
}

/* What a large ball says of distances, a point says of the least of them. */
static void a_point_agrees_with_large_balls(void **unused)
{
    (void)unused;
    uint64_t state = 8;
    size_t far = 0;
    for (int scene = 0; scene < 30; scene++) {
        conus_atlas *atlas = scene_atlas(&state, 9, scene % 3);
        conus_selector *selector = NULL;
        assert_ok(conus_selector_create(&selector, atlas, NULL));
        for (int i = 0; i < 40; i++) {
            conus_selection *large = NULL;
            conus_selection *point = NULL;
            const conus_volume_info *info = &atlas->volumes[0].info;
            double centre[3];
            for (int a = 0; a < 3; a++) {
                centre[a] = i % 4 ? test_random(&state, -12, (double)info->dim[a] + 12) : 0.5 * (i % 19);
            }
            mat4_point(centre, info->world_from_voxel, centre);
            assert_ok(conus_select_ball(&large, selector, centre, 1000));
            assert_ok(conus_select_ball(&point, selector, centre, 0));
            double least = INFINITY;
            size_t wanted = 0;
            size_t count = conus_selection_count(large) - 1; /* without what is no object's */
            for (size_t k = 0; k < count; k++) {
                least = fmin(least, conus_selection_result(large, k)->distance);
            }
            for (size_t k = 0; k < count; k++) {
                wanted += conus_selection_result(large, k)->distance <= least + 1e-9;
            }
            assert_int_equal(conus_selection_count(point), wanted);
            for (size_t k = 0; k < wanted; k++) {
                const conus_result *result = conus_selection_result(point, k);
                double offset[3];
                vec3_sub(offset, result->contact, centre);
                assert_near(result->distance, least, 2e-9);
                assert_near(vec3_length(offset), least, 2e-9);
            }
            far += least > 5;
            conus_selection_destroy(large);
            conus_selection_destroy(point);
        }
        conus_selector_destroy(selector);
        conus_atlas_destroy(atlas);
    }
    assert_true(far > 100);
}

static void bad_balls_are_refused(void **state)
{
    const struct fixture *fixture = *state;
    const double radii[] = {-1, -1e-300, NAN, INFINITY};
    conus_selection *selection = NULL;
    conus_image *image = NULL;
    for (size_t i = 0; i < 4; i++) {
        assert_fails(conus_select_ball(&selection, fixture->selector, (double[]){0, 0, 0}, radii[i]),
                     CONUS_ERROR_ARGUMENT);
    }
    assert_fails(conus_select_ball(&selection, fixture->selector, (double[]){0, NAN, 0}, 1), CONUS_ERROR_ARGUMENT);
    conus_selector *deep = NULL;
    assert_ok(conus_selector_create(&deep, fixture->atlas, &(conus_selector_options){.range = {0, 5}}));
    assert_fails(conus_select_ball(&selection, deep, (double[]){0, 0, 0}, 1), CONUS_ERROR_ARGUMENT);
    conus_selector_destroy(deep);
    assert_null(selection);
    selection = ball(fixture, 0, 0, 0, 1);
    assert_fails(conus_selection_image(&image, selection), CONUS_ERROR_ARGUMENT);
    assert_int_equal(conus_selection_evidence(selection).resolution, 0);
    conus_selection_destroy(selection);
}

static void survives_every_failing_allocation(void **state)
{
    const struct fixture *fixture = *state;
    report_every_allocation(&(struct report_attempt){
        .atlas = fixture->atlas, .report = {.all_voxels = true}, .centre = {4, 4, 4}, .radius = 3});
}

TEST_GROUP(ball)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_are_those_of_cells),
        cmocka_unit_test_setup_teardown(cells_and_surfaces_are_as_near, set_up, tear_down),
        cmocka_unit_test_setup_teardown(volumes_are_those_of_voxels, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_mesh_has_no_voxels, set_up, tear_down),
        cmocka_unit_test(winding_tells_inside),
        cmocka_unit_test_setup_teardown(a_point_has_what_holds_it_or_the_nearest, set_up, tear_down),
        cmocka_unit_test(a_point_agrees_with_large_balls),
        cmocka_unit_test_setup_teardown(bad_balls_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(survives_every_failing_allocation, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
