/* SPDX-License-Identifier: BSD-3-Clause */
/* The direction into a head whose surface is known: a sphere in an image, a box of triangles, the hull of voxels. */
#include "atlas/atlas.h"
#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "builders/area_rows.h"
#include "conus/arrays.h"
#include "conus/atlas.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { X = 12, Y = 10, Z = 8, EDGE = 128 };

/* Two blocks at the ends of the grid's diagonal: x -5.5 to -3.5, y -4.5 to -2.5, z -3.5 to -1.5, and mirrored. */
static conus_atlas *make_atlas(bool whole)
{
    static const struct area_row rows[] = {{1, "A", 0, NULL, 0}, {0}};
    static uint32_t labels[X * Y * Z];
    conus_atlas *atlas = NULL;
    for (size_t i = 0; i < X * Y * Z; i++) {
        const size_t x = i % X, y = i / X % Y, z = i / X / Y;
        labels[i] = whole || (x < 3 && y < 3 && z < 3) || (x > 8 && y > 6 && z > 4);
    }
    assert_ok(area_rows_atlas(&atlas, (const size_t[]){X, Y, Z}, labels, rows));
    return atlas;
}

static double random_number(void)
{
    static uint32_t state = 7;
    state = state * 1664525 + 1013904223;
    return (double)(state >> 8) / (1 << 24) - 0.5;
}

/* The hull of a box of voxels is the box of their centres: the nearest point is where each coordinate is cut off. */
static void without_a_head_the_hull_is_nearest(void **state)
{
    (void)state;
    static const double half[3] = {5.5, 4.5, 3.5};
    conus_atlas *atlas = make_atlas(true);
    for (int trial = 0; trial < 300; trial++) {
        double point[3], way[3], found[3];
        conus_inward from = CONUS_INWARD_SURFACE;
        for (int a = 0; a < 3; a++) {
            point[a] = 30 * random_number();
            way[a] = fmax(-half[a], fmin(half[a], point[a])) - point[a];
        }
        if (vec3_length(way) < 1e-3) {
            assert_fails(conus_atlas_inward(found, &from, atlas, point), CONUS_ERROR_ARGUMENT);
            assert_non_null(strstr(conus_message(), "it lies in the hull of the atlas"));
            continue;
        }
        assert_ok(conus_atlas_inward(found, &from, atlas, point));
        assert_int_equal(from, CONUS_INWARD_ATLAS);
        assert_true(vec3_normalise(way, way));
        for (int a = 0; a < 3; a++) {
            assert_near(found[a], way[a], 1e-6);
        }
    }
    conus_atlas_destroy(atlas);
}

/* Between the blocks no voxel lies, but their hull does: its foremost edge there is known from both corners. */
static void a_hull_bridges_what_is_hollow(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(false);
    double found[3];
    assert_fails(conus_atlas_inward(found, NULL, atlas, (const double[]){0, 0, 0}), CONUS_ERROR_ARGUMENT);
    /* The plane through the upper edges along x: from (-3.5, -2.5, -1.5) to (5.5, 4.5, 3.5) and the like. */
    assert_ok(conus_atlas_inward(found, NULL, atlas, (const double[]){0, -40, 40}));
    assert_true(found[1] > 0.5 && found[2] < -0.5);
    assert_near(vec3_length(found), 1, 1e-12);
    for (int part = 0; part < 2; part++) { /* no corner is before the plane through the nearest point */
        const double at[3] = {part ? 3.5 : -5.5, part ? 2.5 : -4.5, part ? 3.5 : -1.5};
        double way[3];
        vec3_sub(way, at, (const double[]){0, -40, 40});
        assert_true(vec3_dot(way, found) > 40);
    }
    conus_atlas_destroy(atlas);
}

/* The faces of voxels within 5 mm of a point on a sphere are those of its cap, so that they sum up to its normal. */
static void the_head_of_an_image_has_a_normal(void **state)
{
    (void)state;
    static const double RADIUS = 50;
    static const double start = -(EDGE - 1) / 2.0;
    conus_atlas *atlas = make_atlas(true);
    float *values = malloc(sizeof *values * EDGE * EDGE * EDGE);
    conus_voxels voxels = CONUS_VOXELS_INIT;
    double worst = 0;
    double sum = 0;
    for (size_t i = 0; i < EDGE * EDGE * EDGE; i++) {
        const size_t index[3] = {i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE};
        double at[3];
        for (int a = 0; a < 3; a++) {
            at[a] = start + (double)index[a];
        }
        values[i] = vec3_length(at) <= RADIUS ? 100 : 0;
    }
    voxels.data = values;
    voxels.type = CONUS_SCALAR_FLOAT32;
    for (int a = 0; a < 3; a++) {
        voxels.dim[a] = EDGE;
        voxels.world_from_voxel[5 * a] = 1;
        voxels.world_from_voxel[12 + a] = start;
    }
    voxels.world_from_voxel[15] = 1;
    assert_ok(conus_atlas_set_context_voxels(atlas, &voxels, NULL));
    for (int trial = 0; trial < 100; trial++) {
        double point[3] = {random_number(), random_number(), random_number()};
        double found[3];
        conus_inward from;
        assert_true(vec3_normalise(point, point));
        vec3_scale(point, point, RADIUS);
        assert_ok(conus_atlas_inward(found, &from, atlas, point));
        assert_int_equal(from, CONUS_INWARD_IMAGE);
        double angle = degrees_from_radians(MATH3_PI - vec3_angle(found, point));
        worst = fmax(worst, angle);
        sum += angle;
    }
    if (worst > 8 || sum / 100 > 4) {
        fail_msg("%.1f degrees off, %.1f on average", worst, sum / 100);
    }
    /* Far from it there is no surface: the way to the atlas. */
    conus_inward from;
    double found[3];
    assert_ok(conus_atlas_inward(found, &from, atlas, (const double[]){0, 0, 60}));
    assert_true(from == CONUS_INWARD_ATLAS && found[2] == -1);
    free(values);
    conus_atlas_destroy(atlas);
}

/* A box of triangles, wound either way, in the context: the normals of its faces. */
static void a_surface_has_a_normal(void **state)
{
    (void)state;
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    for (int turned = 0; turned < 2; turned++) {
        conus_atlas *atlas = make_atlas(true);
        struct context_surface surface = {.opacity = 0.5};
        struct notes notes = {0};
        assert_ok(mesh_init(&surface.mesh, 8, 12));
        for (int c = 0; c < 24; c++) {
            surface.mesh.positions[c] = c / 3 >> c % 3 & 1 ? 9.0F : -9.0F;
        }
        for (size_t i = 0; i < 36; i++) {
            surface.mesh.triangles[i] = faces[i / 3][turned ? 2 - i % 3 : i % 3];
        }
        assert_ok(mesh_check(&surface.mesh, &notes));
        assert_ok(atlas_add_context_surface(atlas, &surface));
        double found[3];
        conus_inward from;
        assert_ok(conus_atlas_inward(found, &from, atlas, (const double[]){9, 0, 0}));
        assert_int_equal(from, CONUS_INWARD_SURFACE);
        assert_near(found[0], -1, 1e-12);
        assert_ok(conus_atlas_inward(found, &from, atlas, (const double[]){0, -9, 0}));
        assert_near(found[1], 1, 1e-12);
        notes_finish(&notes);
        conus_atlas_destroy(atlas);
    }
}

static conus_status find(void *user)
{
    double found[3];
    return conus_atlas_inward(found, NULL, user, (const double[]){0, 0, 60});
}

static void memory_may_fail(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(true);
    test_every_allocation(find, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(inward)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_head_the_hull_is_nearest),
        cmocka_unit_test(a_hull_bridges_what_is_hollow),
        cmocka_unit_test(the_head_of_an_image_has_a_normal),
        cmocka_unit_test(a_surface_has_a_normal),
        cmocka_unit_test(memory_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
