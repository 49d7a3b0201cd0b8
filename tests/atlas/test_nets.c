/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces of all areas at once: closed, facing outside, as large as the areas, with the same border for neighbours. */
#include "atlas/nets/nets.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "mesh_scene.h"
#include "picture_scene.h"
#include "test.h"
#include "tract_scene.h"

/* A ball of 30 mm, whose left half is 1 and right half 2. */
static double two_halves(const double world[3])
{
    return vec3_length(world) >= 30 ? 0 : world[0] < 0 ? 1 : 2;
}

/* The same and one voxel about (2.5, 2.5, 2.5). */
static double with_a_voxel(const double world[3])
{
    const double from[3] = {world[0] - 2.5, world[1] - 2.5, world[2] - 2.5};
    return vec3_length(from) < 0.5 ? 3 : two_halves(world);
}

static conus_atlas *make_atlas(picture_function labels)
{
    const conus_volume_info grid = picture_grid((size_t[]){80, 80, 80}, (double[]){1, 1, 1}, picture_identity);
    return picture_atlas(&grid, labels, NULL, NULL);
}

/* The surface of an object as a mesh of its own, to be finished. */
static struct mesh take_surface(const struct nets *nets, uint32_t object)
{
    struct mesh mesh;
    const size_t count = nets->first[object + 1] - nets->first[object];
    assert_ok(mesh_init(&mesh, nets->vertex_count, count / 3));
    memcpy(mesh.positions, nets->positions, 3 * nets->vertex_count * sizeof *mesh.positions);
    memcpy(mesh.triangles, nets->corners + nets->first[object], count * sizeof *mesh.triangles);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(nets->objects[mesh.triangles[i]], object);
    }
    return mesh;
}

/* Half a ball of radius r has 2/3 pi r^3. Smoothing takes the edge of the plane away: 8 % at cubes of 1 mm. */
static void areas_are_closed_and_as_large_as_they_are(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(two_halves);
    struct nets nets;
    assert_ok(nets_make(&nets, atlas, 90));
    assert_true(nets.is_closed);
    assert_int_equal(nets.first[1], 0);
    assert_int_equal(nets.first[3], nets.corner_count);
    for (uint32_t object = 1; object <= 2; object++) {
        struct mesh mesh = take_surface(&nets, object);
        bool is_closed = false;
        assert_ok(mesh_is_closed(&is_closed, &mesh));
        assert_true(is_closed);
        assert_ok(mesh_measure(&mesh.shape, &mesh));
        const double wanted = 2 * MATH3_PI / 3 * 30 * 30 * 30;
        assert_near(mesh.shape.volume_mm3, wanted, 0.08 * wanted);
        assert_near(mesh.shape.low[0], object == 1 ? -30 : 0, 1);
        assert_near(mesh.shape.high[0], object == 1 ? 0 : 30, 1);
        mesh_finish(&mesh);
    }
    nets_finish(&nets);
    conus_atlas_destroy(atlas);
}

/* On the ball the normal is the radius; in the plane between the halves it is the x axis, away from the own half. */
static void normals_face_outside(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(two_halves);
    struct nets nets;
    assert_ok(nets_make(&nets, atlas, 90));
    size_t on_ball = 0;
    size_t in_plane = 0;
    for (size_t v = 0; v < nets.vertex_count; v++) {
        const float *p = nets.positions + 3 * v;
        const int8_t *n = nets.normals + 4 * v;
        const double at[3] = {(double)p[0], (double)p[1], (double)p[2]};
        const double normal[3] = {n[0] / 127.0, n[1] / 127.0, n[2] / 127.0};
        assert_near(vec3_length(normal), 1, 0.02);
        assert_int_equal(n[3], 0);
        if (fabs(at[0]) > 3) {
            assert_true(vec3_dot(normal, at) > 0.85 * vec3_length(at));
            on_ball++;
        } else if (vec3_length(at) < 26) {
            assert_near(normal[0], nets.objects[v] == 1 ? 1 : -1, 0.01);
            in_plane++;
        }
    }
    assert_true(on_ball > 5000 && in_plane > 2000);
    nets_finish(&nets);
    conus_atlas_destroy(atlas);
}

/* So that there is no gap: each vertex of one in the plane is one of the other. Its triangles are not among the outer
 * ones, and all others are. */
static void neighbours_share_their_border(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(two_halves);
    struct nets nets;
    assert_ok(nets_make(&nets, atlas, 90));
    /* Squares of a ball of unit cubes: pi r^2 along each axis from either side, and pi r^2 twice in the plane. */
    const double disc = MATH3_PI * 30 * 30;
    const size_t shared = nets.corner_count - nets.outer_count;
    assert_near((double)nets.outer_count / 6, 6 * disc, 0.03 * 6 * disc);
    assert_near((double)shared / 6, 2 * disc, 0.03 * 2 * disc);
    for (size_t i = 0; i < nets.outer_count; i++) {
        const float *p = nets.positions + 3 * (size_t)nets.outer[i];
        assert_true(sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])) > 27.5);
    }
    size_t found = 0;
    for (size_t v = 0; v < nets.vertex_count; v += 7) {
        const float *p = nets.positions + 3 * v;
        const bool is_shared = fabs((double)p[0]) < 0.5 && hypot((double)p[1], (double)p[2]) < 26;
        bool has_other = false;
        for (size_t w = 0; is_shared && w < nets.vertex_count; w++) {
            const float *q = nets.positions + 3 * w;
            const bool is_there = q[0] == p[0] && q[1] == p[1] && q[2] == p[2];
            has_other = has_other || (is_there && nets.objects[w] != nets.objects[v]);
        }
        assert_int_equal(has_other, is_shared);
        found += is_shared;
    }
    assert_true(found > 300);
    nets_finish(&nets);
    conus_atlas_destroy(atlas);
}

/* Cubes of 5.5 mm about the origin: none of their middles is in the voxel. */
static void an_area_smaller_than_a_cube_has_a_surface(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(with_a_voxel);
    struct nets nets;
    assert_int_equal(atlas->objects[2].voxels, 1);
    assert_ok(nets_make(&nets, atlas, 11));
    struct mesh mesh = take_surface(&nets, 3);
    assert_int_equal(mesh.triangle_count, 12);
    for (size_t i = 0; i < 36; i++) {
        const float *p = mesh.positions + 3 * (size_t)mesh.triangles[i];
        assert_true(sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])) < 11);
    }
    mesh_finish(&mesh);
    nets_finish(&nets);
    conus_atlas_destroy(atlas);
}

static double all(const double world[3])
{
    (void)world;
    return 1;
}

/* Areas at the border of their image, of one voxel, a line and a plane, however large the voxels are. */
static void every_shape_of_an_image_is_closed(void **state)
{
    (void)state;
    static const size_t dims[][3] = {{1, 1, 1}, {80, 1, 1}, {1, 40, 60}, {3, 4, 5}};
    static const double sizes[][3] = {{1, 1, 1}, {1e-3, 1e-3, 1e-3}, {1e3, 1e3, 1e3}, {1, 1, 20}};
    for (size_t i = 0; i < 16; i++) {
        const conus_volume_info grid = picture_grid(dims[i / 4], sizes[i % 4], picture_identity);
        conus_atlas *atlas = picture_atlas(&grid, all, NULL, NULL);
        struct nets nets;
        assert_ok(nets_make(&nets, atlas, 90));
        struct mesh mesh = take_surface(&nets, 1);
        bool is_closed = false;
        assert_ok(mesh_is_closed(&is_closed, &mesh));
        assert_true(is_closed);
        assert_ok(mesh_measure(&mesh.shape, &mesh));
        assert_true(mesh.shape.volume_mm3 > 0);
        mesh_finish(&mesh);
        nets_finish(&nets);
        conus_atlas_destroy(atlas);
    }
}

static void meshes_are_as_they_are(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh first = mesh_scene_box((double[]){-1, -1, -1}, (double[]){1, 1, 1});
    struct mesh second = mesh_scene_sphere((double[]){9, 0, 0}, 4, 12, 24);
    mesh_scene_add(atlas, &first);
    mesh_scene_add(atlas, &second);
    struct nets nets;
    assert_ok(nets_make(&nets, atlas, 90));
    assert_false(nets.is_closed);
    assert_int_equal(nets.outer_count, nets.corner_count);
    for (uint32_t object = 1; object <= 2; object++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, object);
        assert_int_equal(nets.first[object + 1] - nets.first[object], 3 * mesh->triangle_count);
        for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
            const uint32_t corner = nets.corners[nets.first[object] + i];
            assert_int_equal(nets.objects[corner], object);
            assert_memory_equal(nets.positions + 3 * (size_t)corner, mesh->positions + 3 * (size_t)mesh->triangles[i],
                                3 * sizeof(float));
        }
    }
    nets_finish(&nets);
    conus_atlas_destroy(atlas);
}

enum { LINES = 4500, RING = 2000 };

/* Lines of 100 mm along x, 1 mm apart, and a circle of radius 50 mm with points each 0.16 mm: of 4501 streamlines every
 * third is shown. A straight band is 2 radius wide, so that its triangles have 2 radius * 100 mm^2; the ring's points
 * are 8 mm of way apart, where a chord is 0.18 mm from the circle. */
static void streamlines_are_bands(void **state)
{
    (void)state;
    const double radius = 0.25;
    struct tract_builder builder;
    tract_begin(&builder);
    for (int line = 0; line < LINES; line++) {
        for (int i = 0; i < 100; i += 33) {
            tract_add_point(&builder, (double[]){i == 99 ? 100 : i, line, 7});
        }
        tract_end_streamline(&builder);
    }
    for (int i = 0; i < RING; i++) {
        tract_add_point(&builder,
                        (double[]){50 * cos(i * 2 * MATH3_PI / RING), 50 * sin(i * 2 * MATH3_PI / RING), -90});
    }
    tract_end_streamline(&builder);
    builder.made.radius = radius;
    conus_atlas *atlas = mesh_scene_atlas();
    assert_ok(atlas_add_tractogram(atlas, &builder.made, "lines"));
    struct nets nets;
    assert_ok(nets_make(&nets, atlas, 90));
    assert_false(nets.is_closed);
    assert_int_equal(nets.outer_count, nets.corner_count);
    assert_int_equal(nets.first[2], nets.corner_count);
    double area = 0;
    size_t lines = 0;
    for (size_t i = 0; i < nets.corner_count; i += 3) {
        double p[3][3];
        double cross[3];
        for (size_t k = 0; k < 9; k++) {
            p[k / 3][k % 3] = (double)nets.positions[3 * (size_t)nets.corners[i + k / 3] + k % 3];
        }
        vec3_sub(p[1], p[1], p[0]);
        vec3_sub(p[2], p[2], p[0]);
        vec3_cross(cross, p[1], p[2]);
        area += p[0][2] > 0 ? vec3_length(cross) / 2 : 0;
    }
    for (size_t v = 0; v < nets.vertex_count; v++) {
        const float *p = nets.positions + 3 * v;
        assert_int_equal(nets.objects[v], 1);
        if (p[2] > 0) {
            const double line = round((double)p[1]);
            assert_near((double)p[2], 7, 1e-5);
            assert_near(fabs((double)p[1] - line), radius, 1e-3);
            assert_int_equal((int)line % 3, 0);
            lines += p[0] == 0;
        } else {
            assert_near(hypot((double)p[0], (double)p[1]), 50, radius + 0.2);
        }
    }
    assert_int_equal(lines, 2 * LINES / 3);
    assert_near(area, 1500 * 2 * radius * 100, 0.01 * area);
    assert_in_range(nets.vertex_count - LINES / 3 * 8, 2 * 38, 2 * 40);
    nets_finish(&nets);
    atlas->places[0].is_hidden = true;
    assert_fails(nets_make(&nets, atlas, 90), CONUS_ERROR_ARGUMENT);
    conus_atlas_destroy(atlas);
}

static void what_has_no_surface_is_refused(void **state)
{
    (void)state;
    struct nets nets;
    conus_atlas *atlas = mesh_scene_atlas();
    assert_fails(nets_make(&nets, atlas, 90), CONUS_ERROR_ARGUMENT);
    const size_t count = atlas->object_count;
    atlas->object_count = 65536;
    assert_fails(nets_make(&nets, atlas, 90), CONUS_ERROR_UNSUPPORTED);
    atlas->object_count = count;
    conus_atlas_destroy(atlas);
}

static conus_status make_once(void *data)
{
    struct nets nets = {0};
    conus_status status = nets_make(&nets, data, 8);
    nets_finish(&nets);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(two_halves);
    test_every_allocation(make_once, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(nets)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_are_closed_and_as_large_as_they_are),
        cmocka_unit_test(normals_face_outside),
        cmocka_unit_test(neighbours_share_their_border),
        cmocka_unit_test(an_area_smaller_than_a_cube_has_a_surface),
        cmocka_unit_test(every_shape_of_an_image_is_closed),
        cmocka_unit_test(meshes_are_as_they_are),
        cmocka_unit_test(streamlines_are_bands),
        cmocka_unit_test(what_has_no_surface_is_refused),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
