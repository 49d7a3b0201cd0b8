/* SPDX-License-Identifier: BSD-3-Clause */
/* First hits of meshes (Eq. 9) by the gl engine against those by the rays engine; edges may differ by the driver's
 * rounding. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/selection.h"
#include "gl_edge.h"
#include "gl_pair.h"
#include "loaders/extraction/parts.h"
#include "mesh_scene.h"
#include "scene.h"
#include "test.h"

#include <glob.h>
#include <stdio.h>
#include <string.h>

static bool is_mesh(const conus_atlas *atlas, uint32_t object)
{
    return object && atlas_object_mesh(atlas, object);
}

static bool may_differ(const struct gl_pair *pair, const struct cone *cone, const struct evidence *evidence,
                       size_t pixel)
{
    uint32_t object = evidence->object[pixel];
    return is_mesh(pair->atlas, object) &&
           gl_edge_is_near(cone, atlas_object_mesh(pair->atlas, object), evidence->voxel[pixel], pixel);
}

static void compare_pixel(struct gl_pair *pair, const struct cone *cone, const struct evidence *got,
                          const struct evidence *wanted, size_t pixel)
{
    pair->counts.compared++;
    pair->counts.hits += wanted->object[pixel] != 0;
    if (got->object[pixel] == wanted->object[pixel] && got->voxel[pixel] == wanted->voxel[pixel]) {
        /* the same triangle, or voxel: the same distance, to the last bit */
        assert_true(got->distance[pixel] == wanted->distance[pixel]);
    } else if (may_differ(pair, cone, got, pixel) || may_differ(pair, cone, wanted, pixel)) {
        pair->counts.at_edges++;
        pair->counts.other_object += got->object[pixel] != wanted->object[pixel];
    } else {
        fail_msg("pixel %zu of %u x %u, %g degrees: object %u, triangle %llu, %.17g mm; wanted %u, %llu, %.17g", pixel,
                 cone->resolution, cone->resolution, degrees_from_radians(cone->angle), got->object[pixel],
                 (unsigned long long)got->voxel[pixel], got->distance[pixel], wanted->object[pixel],
                 (unsigned long long)wanted->voxel[pixel], wanted->distance[pixel]);
    }
}

static void compare_traces(struct gl_pair *pair, const struct cone *cone)
{
    struct evidence got = gl_pair_trace(pair->gl, cone);
    struct evidence wanted = gl_pair_trace(pair->rays, cone);
    for (size_t pixel = 0; pixel < (size_t)cone->resolution * cone->resolution; pixel++) {
        compare_pixel(pair, cone, &got, &wanted, pixel);
    }
    evidence_finish(&got);
    evidence_finish(&wanted);
}

static void assert_agreement(const struct gl_counts *counts, double hit_part)
{
    print_message("%zu pixels, %zu hits, at edges %zu apart, %zu of them in the object\n", counts->compared,
                  counts->hits, counts->at_edges, counts->other_object);
    assert_true((double)counts->hits > hit_part * (double)counts->compared);
    assert_true(counts->other_object <= 1 + counts->compared / 1000);
    assert_true(counts->at_edges <= 1 + counts->compared / 200); /* triangles may be as small as pixels */
}

static void compare_100_poses(uint64_t *random, const conus_atlas *atlas, double size)
{
    struct gl_counts counts = {0};
    gl_pair_compare_poses(&counts, random, atlas, compare_traces, size, 100, 5);
    assert_agreement(&counts, 0.3);
}

static void one_sphere(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh sphere = mesh_scene_sphere((double[]){1, 2, 3}, 20, 24, 48);
    mesh_scene_add(atlas, &sphere);
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    struct cone cone = mesh_scene_cone((double[]){-80, 10, 5}, (double[]){1, 2, 3}, 40, 64);
    compare_traces(&pair, &cone);
    assert_agreement(&pair.counts, 0.3);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

/* Eq. 9 in general position. */
static void random_triangles(void **state)
{
    (void)state;
    uint64_t random = 31;
    struct gl_counts counts = {0};
    gl_pair_compare_triangles(&counts, &random, compare_traces, 40, 0);
    assert_agreement(&counts, 0.3);
}

static void one_hundred_poses_of_nested_spheres(void **state)
{
    (void)state;
    uint64_t random = 32;
    conus_atlas *atlas = mesh_scene_nested();
    compare_100_poses(&random, atlas, 50);
    conus_atlas_destroy(atlas);
}

static void one_hundred_poses_of_the_brain(void **state)
{
    (void)state;
    uint64_t random = 35;
    conus_atlas *atlas = mesh_scene_brain();
    compare_100_poses(&random, atlas, 60);
    conus_atlas_destroy(atlas);
}

/* A manifest of Julich-Brain's areas, many of which share borders (the right side's are OBJ, which conus-mesh reads),
 * and the Juelich atlas's 18 pathways. */
static const char *julich_manifest(void)
{
    const char *path = test_scratch("julich.atlas.json");
    const char *shared = test_shared("");
    char *program = NULL;
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "{\"conus_atlas\": 1, \"allow_outside\": true, \"space\": \"ras\", \"areas\": [");
    fprintf(file, "{\"files\": \"%smeshes/julich31-areas/lh/*.gii\"}", shared);
    if (mesh_child_find(&program)) {
        print_message("left side only: %s\n", conus_message());
    } else {
        fprintf(file, ", {\"files\": \"%smeshes/julich31-areas/rh/*.obj\", \"label_offset\": 1000}", shared);
    }
    memory_free(program);
    glob_t pathways;
    char pattern[1024];
    snprintf(pattern, sizeof pattern, "%sprob/juelich-fibre-pathways-u16/*.nii.gz", shared);
    assert_int_equal(glob(pattern, 0, NULL, &pathways), 0);
    assert_int_equal(pathways.gl_pathc, 18);
    for (size_t i = 0; i < pathways.gl_pathc; i++) {
        fprintf(file, "%s\"%s\"", i ? ", " : "], \"pathways\": [", pathways.gl_pathv[i]);
    }
    globfree(&pathways);
    fprintf(file, "]}\n");
    assert_int_equal(fclose(file), 0);
    return path;
}

static void one_hundred_poses_of_julich_brain(void **state)
{
    (void)state;
    uint64_t random = 36;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, julich_manifest(), NULL));
    assert_true(conus_atlas_object_count(atlas) >= 207 + 18);
    compare_100_poses(&random, atlas, 60);
    conus_atlas_destroy(atlas);
}

/* The scene itself far from the world's origin. */
static void far_from_the_origin(void **state)
{
    (void)state;
    uint64_t random = 33;
    const double far[3] = {-8e4, 6e4, 3e4};
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < 3; i++) {
        double centre[3];
        for (int a = 0; a < 3; a++) {
            centre[a] = test_random(&random, -30, 30);
        }
        vec3_add_scaled(centre, centre, 1, far);
        struct mesh sphere = mesh_scene_sphere(centre, 20, 12, 20);
        mesh_scene_add(atlas, &sphere);
    }
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    for (int pose = 0; pose < 40; pose++) {
        struct cone cone = mesh_scene_random_cone(&random, 40);
        for (int a = 0; a < 3; a++) {
            cone.pose.world_from_device[12 + a] += far[a];
        }
        compare_traces(&pair, &cone);
    }
    assert_agreement(&pair.counts, 0.3);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

/* Voxels and triangles hide each other. */
static void meshes_among_voxels(void **state)
{
    (void)state;
    uint64_t random = 34;
    struct gl_counts counts = {0};
    gl_pair_compare_mixed(&counts, &random, compare_traces, 20);
    assert_agreement(&counts, 0.2);
}

static struct mesh one_triangle(double x, double y, double z, double edge)
{
    struct mesh mesh;
    const double corners[3][2] = {{0, -edge}, {edge, edge}, {-edge, edge}};
    assert_ok(mesh_init(&mesh, 3, 1));
    for (uint32_t k = 0; k < 3; k++) {
        mesh.positions[3 * k] = (float)x;
        mesh.positions[3 * k + 1] = (float)(y + corners[k][0]);
        mesh.positions[3 * k + 2] = (float)(z + corners[k][1]);
        mesh.triangles[k] = k;
    }
    return mesh;
}

/* Numbers that fit neither 16 bits nor a float that was blended. */
static void more_meshes_than_16_bits_hold(void **state)
{
    (void)state;
    enum { SIDE = 265 };
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < SIDE * SIDE; i++) {
        int column = i % SIDE;
        int row = i / SIDE;
        struct mesh mesh = one_triangle(0, column, row, 0.45);
        mesh_scene_add(atlas, &mesh);
    }
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    struct cone cone = mesh_scene_cone((double[]){-300, 240, 255}, (double[]){0, 240, 255}, 4, 128);
    compare_traces(&pair, &cone);
    assert_agreement(&pair.counts, 0.2);
    struct evidence evidence = gl_pair_trace(pair.gl, &cone);
    size_t large = 0;
    for (size_t i = 0; i < (size_t)128 * 128; i++) {
        large += evidence.object[i] > UINT16_MAX;
    }
    assert_true(large > 1000);
    evidence_finish(&evidence);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

/* Eq. 9: the lowest number of equally near objects wins, however many there are. */
static void the_lower_of_equals_wins(void **state)
{
    (void)state;
    enum { PLATES = 40 };
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < PLATES; i++) {
        struct mesh plate = one_triangle(i < 5 ? 1 : 0, 0, 0, 50); /* the first five behind the others */
        mesh_scene_add(atlas, &plate);
    }
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    struct cone cone = mesh_scene_cone((double[]){-20, 0, 1}, (double[]){0, 1, 0}, 30, 16);
    compare_traces(&pair, &cone);
    struct evidence evidence = gl_pair_trace(pair.gl, &cone);
    for (int i = 0; i < 16 * 16; i++) {
        assert_int_equal(evidence.object[i], 6);
        assert_int_equal(evidence.voxel[i], 0);
    }
    evidence_finish(&evidence);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

/* The device is among large triangles a hundredth of a millimetre before and behind it. Of a cylinder what is just
 * behind the device is drawn, too, and hides nothing. */
static void nothing_before_the_apex_is_clipped(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh plates[] = {one_triangle(-0.01, 0, 0, 5), one_triangle(0.01, 0, 0, 5), one_triangle(1e4, 0, 0, 1e6)};
    for (int i = 0; i < 3; i++) {
        mesh_scene_add(atlas, &plates[i]);
    }
    struct mesh around = mesh_scene_sphere((double[]){0, 0, 0}, 3, 6, 8);
    mesh_scene_add(atlas, &around);
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    const struct {
        double from[3], to[3];
        uint32_t hit;
        double radius;
    } cases[] = {{{0, 0, 0}, {1, 0, 0}, 2, 0},      {{0, 0, 0}, {-1, 0, 0}, 1, 0},  {{0.02, 0, 0}, {1, 0, 0}, 4, 0},
                 {{-0.02, 0, 0}, {1, 0, 0}, 1, 0},  {{10, 0, 0}, {11, 0, 0}, 3, 0}, {{0, 60, 0}, {0, 61, 0}, 0, 0},
                 {{-0.0095, 0, 0}, {1, 0, 0}, 2, 2}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct cone cone = mesh_scene_cone(cases[i].from, cases[i].to, i % 2 ? 20 : 120, 15);
        cone.radius = cases[i].radius;
        cone.angle = cone.radius > 0 ? 0 : cone.angle;
        compare_traces(&pair, &cone);
        struct evidence evidence = gl_pair_trace(pair.gl, &cone);
        assert_int_equal(evidence.object[7 * 15 + 7], cases[i].hit);
        evidence_finish(&evidence);
    }
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < 12; i++) { /* equals, so that pixels need more memory */
        struct mesh sphere = mesh_scene_sphere((double[]){0, 0, 0}, 10, 8, 16);
        mesh_scene_add(atlas, &sphere);
    }
    struct cone cone = mesh_scene_cone((double[]){-50, 0, 0}, (double[]){0, 0, 0}, 40, 4);
    gl_pair_every_allocation(atlas, &cone, false);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(gl_mesh)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_sphere),
        cmocka_unit_test(random_triangles),
        cmocka_unit_test(one_hundred_poses_of_nested_spheres),
        cmocka_unit_test(one_hundred_poses_of_the_brain),
        cmocka_unit_test(one_hundred_poses_of_julich_brain),
        cmocka_unit_test(far_from_the_origin),
        cmocka_unit_test(meshes_among_voxels),
        cmocka_unit_test(more_meshes_than_16_bits_hold),
        cmocka_unit_test(the_lower_of_equals_wins),
        cmocka_unit_test(nothing_before_the_apex_is_clipped),
        cmocka_unit_test(every_failing_allocation_is_reported),
        cmocka_unit_test(the_driver_was_silent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
