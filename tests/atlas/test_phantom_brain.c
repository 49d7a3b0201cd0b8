/* SPDX-License-Identifier: BSD-3-Clause */
/* The brain phantom: its exact size, closed surfaces that are not convex and do not touch, the pathway's tube. */
#include "atlas/atlas.h"
#include "atlas/phantom/phantom.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void vertex_of(double out[3], const struct mesh *mesh, size_t vertex)
{
    for (int i = 0; i < 3; i++) {
        out[i] = (double)mesh->positions[3 * vertex + (size_t)i];
    }
}

static void surfaces_are_closed_and_as_many_triangles_as_stated(void **state)
{
    (void)state;
    size_t triangles = 0;
    for (size_t i = 0; i < PHANTOM_BRAIN_AREAS; i++) {
        struct mesh mesh;
        struct mesh_shape shape;
        struct notes notes = {0};
        assert_ok(phantom_brain_mesh(&mesh, i));
        assert_ok(mesh_check(&mesh, &notes));
        assert_int_equal(notes.count, 0);
        assert_ok(mesh_measure(&shape, &mesh));
        assert_true(shape.closed);
        assert_true(shape.volume_mm3 > 30000 && shape.volume_mm3 < 60000);
        triangles += mesh.triangle_count;
        mesh_finish(&mesh);
    }
    assert_int_equal(triangles, PHANTOM_BRAIN_TRIANGLES);
}

/* The vertices of two areas are on different sides of the bisector between them, so no two areas meet. */
static void areas_keep_to_their_own_cells(void **state)
{
    (void)state;
    for (size_t area = 0; area < PHANTOM_BRAIN_AREAS; area++) {
        struct mesh mesh;
        assert_ok(phantom_brain_mesh(&mesh, area));
        for (size_t v = 0; v < mesh.vertex_count; v++) {
            double world[3];
            double p[3];
            vertex_of(world, &mesh, v);
            phantom_brain_straighten(p, world);
            for (size_t other = 0; other < PHANTOM_BRAIN_AREAS; other++) {
                double between[3];
                double off[3];
                vec3_sub(between, phantom_brain_area(other)->seed, phantom_brain_area(area)->seed);
                vec3_sub(off, p, phantom_brain_area(area)->seed);
                assert_true(other == area || vec3_dot(off, between) < 0.495 * vec3_dot(between, between));
            }
        }
        mesh_finish(&mesh);
    }
}

/* In every area some vertex lies clearly outside the plane of some triangle that faces outwards. */
static void no_area_is_convex(void **state)
{
    (void)state;
    for (size_t area = 0; area < PHANTOM_BRAIN_AREAS; area++) {
        struct mesh mesh;
        double most = 0;
        assert_ok(phantom_brain_mesh(&mesh, area));
        for (size_t t = 0; t < mesh.triangle_count; t += 97) {
            double a[3];
            double b[3];
            double c[3];
            double normal[3];
            vertex_of(a, &mesh, mesh.triangles[3 * t]);
            vertex_of(b, &mesh, mesh.triangles[3 * t + 1]);
            vertex_of(c, &mesh, mesh.triangles[3 * t + 2]);
            vec3_sub(b, b, a);
            vec3_sub(c, c, a);
            vec3_cross(normal, b, c);
            assert_true(vec3_normalise(normal, normal));
            for (size_t v = 0; v < mesh.vertex_count; v += 13) {
                vertex_of(b, &mesh, v);
                vec3_sub(b, b, a);
                most = fmax(most, vec3_dot(b, normal));
            }
        }
        assert_true(most > 3);
        mesh_finish(&mesh);
    }
}

static void the_pathway_is_a_tube_at_the_default_threshold(void **state)
{
    (void)state;
    double angle = 0.7;
    for (int side = -1; side <= 1; side++) {
        double off = side * PHANTOM_BRAIN_TUBE;
        double world[3] = {(49 + off) * cos(angle), -18, 10 + (49 + off) * sin(angle)};
        assert_near(phantom_brain_pathway(world), side == 0 ? 65535 : 65535 / 4.0, 1);
    }
    assert_int_equal(phantom_brain_pathway((double[]){0, -18, 10}), 0);
}

/* A voxel's centre is (x, y, z) from the middle: x is whole, y and z are whole and a half. The value is 65535 * 2^(-2t)
 * with t = d^2 / 25, half way between two numbers only for t = 1/2: d^2 = (r - 49)^2 + y^2 = 12.5, where r^2 = x^2 +
 * z^2. (d is algebraic, so that no other t but a whole half has a rational power.) Above the arc's ends (2r)^2 is then
 * that of an odd number: y = 1/2 wants 2r = 105 or 91, y = 5/2 103 or 93, y = 7/2 99 or 97; and (2x, 2z) are the legs
 * of these: (0, 2r), and of 5 * 21 = 105 (84, 63), of 13 * 7 = 91 (84, 35), of 97 (72, 65). Halves round up: 32768. */
static void the_pathway_is_rounded_up_half_way(void **state)
{
    (void)state;
    static const double halves[][3] = {{0, 1, 105}, {0, 1, 91},  {0, 5, 103}, {0, 5, 93}, {0, 7, 99},
                                       {0, 7, 97},  {84, 1, 63}, {84, 1, 35}, {72, 7, 65}};
    for (size_t i = 0; i < sizeof halves / sizeof halves[0]; i++) {
        for (int signs = 0; signs < 4; signs++) {
            const double x = signs & 1 ? -halves[i][0] : halves[i][0];
            const double y = signs & 2 ? -halves[i][1] : halves[i][1];
            assert_int_equal(phantom_brain_pathway((double[]){x / 2, y / 2 - 18, halves[i][2] / 2 + 10}), 32768);
        }
    }
}

static void the_files_are_one_scene(void **state)
{
    (void)state;
    char folder[256];
    char path[300];
    conus_atlas *atlas = NULL;
    snprintf(folder, sizeof folder, "%s", test_scratch("brain"));
    snprintf(path, sizeof path, "%s/brain.atlas.json", folder);
    assert_ok(conus_phantom_write("brain", folder, NULL));
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 12);
    uint64_t triangles = 0;
    for (size_t i = 1; i <= 11; i++) {
        const conus_object *area = conus_atlas_object(atlas, i);
        assert_string_equal(area->name, phantom_brain_area(i - 1)->name);
        assert_int_equal(area->hemisphere, phantom_brain_area(i - 1)->hemisphere);
        triangles += area->triangles;
    }
    assert_int_equal(triangles, PHANTOM_BRAIN_TRIANGLES);
    assert_int_equal(conus_atlas_object(atlas, 12)->kind, CONUS_KIND_PATHWAY);
    assert_string_equal(conus_atlas_object(atlas, 12)->name, "Arc");
    double arc = MATH3_PI * 25 * 49 * (200 * MATH3_PI / 180) + 4.0 / 3 * MATH3_PI * 125;
    assert_near(conus_atlas_object(atlas, 12)->volume_mm3, arc, 0.02 * arc);
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        const conus_volume_info *info = conus_atlas_volume(atlas, i);
        assert_string_equal(info->datatype, "uint16");
        assert_int_equal(info->dim[0], 151);
        assert_int_equal(info->dim[1], 188);
        assert_int_equal(info->dim[2], 154);
    }
    assert_string_equal(atlas->transfer, "brain");
    assert_int_equal(conus_atlas_note_count(atlas), 1); /* the pathway's scale */
    conus_atlas_destroy(atlas);
    assert_fails(conus_phantom_write("brain", folder, &(conus_phantom_options){.size = 32}), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_phantom_write("brain", folder, &(conus_phantom_options){.spacing = {1, 1, 1}}),
                 CONUS_ERROR_ARGUMENT);
}

TEST_GROUP(phantom_brain)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_are_closed_and_as_many_triangles_as_stated),
        cmocka_unit_test(areas_keep_to_their_own_cells),
        cmocka_unit_test(no_area_is_convex),
        cmocka_unit_test(the_pathway_is_a_tube_at_the_default_threshold),
        cmocka_unit_test(the_pathway_is_rounded_up_half_way),
        cmocka_unit_test(the_files_are_one_scene),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
