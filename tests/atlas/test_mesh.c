/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces: closed or not, volume, area and centroid in closed form, and what is refused. */
#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "test.h"

#include <string.h>

/* A box from (0, 0, 0) to `size`, moved by `by`, triangles facing outwards. */
static conus_status make_box(struct mesh *out, const double size[3], double by)
{
    static const uint32_t triangles[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                           2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    conus_status status = mesh_init(out, 8, 12);
    for (size_t i = 0; !status && i < 24; i++) {
        out->positions[i] = (float)((i / 3 >> i % 3 & 1 ? size[i % 3] : 0) + by);
    }
    if (!status) {
        memcpy(out->triangles, triangles, sizeof triangles);
    }
    return status;
}

static void a_box_is_closed_and_measured(void **state)
{
    (void)state;
    const double sizes[2][3] = {{1, 2, 3}, {4, 0.5, 7}};
    for (int i = 0; i < 2; i++) {
        struct mesh mesh;
        struct mesh_shape shape;
        struct notes notes = {0};
        assert_ok(make_box(&mesh, sizes[i], 1000));
        assert_ok(mesh_check(&mesh, &notes));
        assert_int_equal(notes.count, 0);
        assert_ok(mesh_measure(&shape, &mesh));
        assert_true(shape.closed && shape.has_volume);
        assert_near(shape.volume_mm3, sizes[i][0] * sizes[i][1] * sizes[i][2], 1e-9);
        for (int a = 0; a < 3; a++) {
            assert_near(shape.centroid[a], 1000 + sizes[i][a] / 2, 1e-9);
            assert_near(shape.low[a], 1000, 0);
            assert_near(shape.high[a], 1000 + sizes[i][a], 0);
        }
        mesh_finish(&mesh);
    }
}

static void mirrors_keep_triangles_outward(void **state)
{
    (void)state;
    struct mesh mesh;
    struct mesh_shape shape;
    double mirror[16];
    mat4_identity(mirror);
    mirror[0] = -2;
    assert_ok(make_box(&mesh, (double[]){1, 1, 1}, 0));
    mesh_transform(&mesh, mirror);
    assert_ok(mesh_measure(&shape, &mesh));
    assert_near(shape.volume_mm3, 2, 1e-12);
    assert_near(shape.low[0], -2, 0);
    mesh_finish(&mesh);
}

static void open_and_flat_parts_are_noted(void **state)
{
    (void)state;
    struct mesh mesh;
    struct mesh_shape shape;
    struct notes notes = {0};
    assert_ok(make_box(&mesh, (double[]){1, 1, 1}, 0));
    mesh.triangles[35] = mesh.triangles[34]; /* the last triangle loses its area */
    assert_ok(mesh_check(&mesh, &notes));
    assert_int_equal(mesh.triangle_count, 11);
    assert_int_equal(notes.count, 2);
    assert_non_null(strstr(notes.lines[0], "1 triangles without area"));
    assert_non_null(strstr(notes.lines[1], "not closed"));
    assert_ok(mesh_measure(&shape, &mesh));
    assert_false(shape.closed);
    notes_finish(&notes);
    mesh_finish(&mesh);
}

static void a_turned_triangle_is_not_closed(void **state)
{
    (void)state;
    struct mesh mesh;
    struct mesh_shape shape;
    assert_ok(make_box(&mesh, (double[]){1, 1, 1}, 0));
    mesh.triangles[1] = 1;
    mesh.triangles[2] = 2;
    assert_ok(mesh_measure(&shape, &mesh));
    assert_false(shape.closed);
    mesh_finish(&mesh);
}

static void put(struct mesh *mesh, const float (*positions)[3], size_t vertices, const uint32_t (*triangles)[3],
                size_t count)
{
    assert_ok(mesh_init(mesh, vertices, count));
    memcpy(mesh->positions, positions, 3 * vertices * sizeof *mesh->positions);
    memcpy(mesh->triangles, triangles, 3 * count * sizeof *mesh->triangles);
}

/* Checks and measures a mesh of these triangles; returns how many were left out. */
static size_t examine(struct mesh_shape *shape, const float (*positions)[3], size_t vertices,
                      const uint32_t (*triangles)[3], size_t count)
{
    struct mesh mesh;
    struct notes notes = {0};
    put(&mesh, positions, vertices, triangles, count);
    assert_ok(mesh_check(&mesh, &notes));
    assert_ok(mesh_measure(shape, &mesh));
    size_t left_out = count - mesh.triangle_count;
    assert_int_equal(notes.count, (left_out > 0) + !shape->closed);
    notes_finish(&notes);
    mesh_finish(&mesh);
    return left_out;
}

/* A tetrahedron with the corner (0, 0, 6) written twice, once with a negative zero: volume 6 * 6 * 6 / 6. */
static void vertices_at_equal_positions_are_one(void **state)
{
    (void)state;
    static const float positions[5][3] = {{0, 0, 0}, {6, 0, 0}, {0, 6, 0}, {0, 0, 6}, {-0.0F, 0, 6}};
    static const uint32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 4, 2}, {1, 2, 3}};
    struct mesh_shape shape;
    assert_int_equal(examine(&shape, positions, 5, triangles, 4), 0);
    assert_true(shape.closed);
    assert_near(shape.volume_mm3, 36, 1e-12);
    examine(&shape, positions, 5, triangles, 3); /* without one side */
    assert_false(shape.closed);
    static const float moved[5][3] = {{0, 0, 0}, {6, 0, 0}, {0, 6, 0}, {0, 0, 6}, {0, 1e-6F, 6}};
    examine(&shape, moved, 5, triangles, 4); /* not quite equal */
    assert_false(shape.closed);
}

/* Two tetrahedra with the edge from (0, 0, 0) to (0, 0, 6) in common, on which lie four triangles. */
static void an_edge_may_have_four_triangles(void **state)
{
    (void)state;
    static const float positions[6][3] = {{0, 0, 0}, {0, 0, 6}, {6, 0, 0}, {0, 6, 0}, {-6, 0, 0}, {0, -6, 0}};
    uint32_t triangles[8][3] = {{0, 3, 2}, {0, 2, 1}, {0, 1, 3}, {2, 3, 1}, {0, 5, 4}, {0, 4, 1}, {0, 1, 5}, {4, 5, 1}};
    struct mesh_shape shape;
    examine(&shape, positions, 6, (const uint32_t(*)[3])triangles, 8);
    assert_true(shape.closed);
    assert_near(shape.volume_mm3, 72, 1e-12);
    examine(&shape, positions, 6, (const uint32_t(*)[3])triangles, 7);
    assert_false(shape.closed);
    for (int i = 4; i < 8; i++) { /* the second one turned: four triangles on the edge all the same */
        uint32_t kept = triangles[i][0];
        triangles[i][0] = triangles[i][1];
        triangles[i][1] = kept;
    }
    examine(&shape, positions, 6, (const uint32_t(*)[3])triangles, 8);
    assert_true(shape.closed);
    assert_near(shape.volume_mm3, 0, 1e-12);
    triangles[7][0] = 4; /* and one of its sides turned back */
    triangles[7][1] = 5;
    examine(&shape, positions, 6, (const uint32_t(*)[3])triangles, 8);
    assert_false(shape.closed);
}

/* Vertex 4 lies in the middle of the edge from 0 to 1, and only a triangle without area joins the two sides there. */
static void triangles_without_area_close_what_they_join(void **state)
{
    (void)state;
    static const float positions[5][3] = {{0, 0, 0}, {6, 0, 0}, {0, 6, 0}, {0, 0, 6}, {3, 0, 0}};
    static const uint32_t triangles[6][3] = {{0, 2, 4}, {4, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 1}};
    struct mesh_shape shape;
    assert_int_equal(examine(&shape, positions, 5, triangles, 6), 1);
    assert_true(shape.closed);
    assert_near(shape.volume_mm3, 36, 1e-12);
    assert_int_equal(examine(&shape, positions, 5, triangles, 5), 0);
    assert_false(shape.closed);
}

/* A triangle that repeats a vertex changes nothing, wherever it is. */
static void triangles_of_two_corners_change_nothing(void **state)
{
    (void)state;
    static const float positions[5][3] = {{0, 0, 0}, {6, 0, 0}, {0, 6, 0}, {0, 0, 6}, {6, 0, 0}};
    static const uint32_t triangles[7][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {4, 2, 3},
                                             {1, 4, 2}, {3, 3, 3}, {2, 2, 0}};
    struct mesh_shape shape;
    assert_int_equal(examine(&shape, positions, 5, triangles, 7), 3);
    assert_true(shape.closed);
}

/* Two triangles with areas of 18 and 9 and centroids (2, 2, 0) and (0, 1, 2): 36 / 27, 45 / 27 and 18 / 27. */
static void an_open_surface_has_the_centroid_of_its_area(void **state)
{
    (void)state;
    static const float positions[5][3] = {{0, 0, 0}, {6, 0, 0}, {0, 6, 0}, {0, 0, 6}, {0, 3, 0}};
    static const uint32_t triangles[2][3] = {{0, 1, 2}, {0, 3, 4}};
    struct mesh_shape shape;
    examine(&shape, positions, 5, triangles, 2);
    assert_false(shape.closed);
    assert_near(shape.centroid[0], 36. / 27, 1e-12);
    assert_near(shape.centroid[1], 45. / 27, 1e-12);
    assert_near(shape.centroid[2], 18. / 27, 1e-12);
}

/* A triangle from z = 10 to 20. The ray along z beside it meets its plane elsewhere: (b - a) x (c - a) is (10, 0,
 * -0.001), so that t is (10 (0 - x) - 0.01) / -0.001, 10 + 10,000 x. Eq. 9 limits it to 10 to 20. */
static void crossings_stay_within_the_triangle_s_reach(void **state)
{
    (void)state;
    static const float positions[3][3] = {{0, 0, 10}, {0, 1, 10}, {0x1p-10F, 0, 20}};
    static const uint32_t triangles[1][3] = {{0, 1, 2}};
    struct mesh mesh;
    put(&mesh, positions, 3, triangles, 1);
    const double up[3] = {0, 0, 1};
    assert_near(mesh_distance(&mesh, 0, (const double[]){0.01, 0.2, 0}, up), 20, 0);
    assert_near(mesh_distance(&mesh, 0, (const double[]){-0.01, 0.2, 0}, up), 10, 0);
    assert_near(mesh_distance(&mesh, 0, (const double[]){0x1p-11, 0.2, 0}, up), 15, 1e-9);
    mesh_finish(&mesh);
}

/* Whole numbers with i v - j u = 1, for u and v without a common divisor (Euclid). */
static void find_cofactors(int64_t *i, int64_t *j, int64_t u, int64_t v)
{
    int64_t remainder[2] = {v, u}, of_v[2] = {1, 0}, of_u[2] = {0, 1};
    while (remainder[1] != 0) {
        int64_t quotient = remainder[0] / remainder[1];
        int64_t next[3] = {remainder[0] - quotient * remainder[1], of_v[0] - quotient * of_v[1],
                           of_u[0] - quotient * of_u[1]};
        remainder[0] = remainder[1], of_v[0] = of_v[1], of_u[0] = of_u[1];
        remainder[1] = next[0], of_v[1] = next[1], of_u[1] = next[2];
    }
    assert_int_equal(remainder[0], 1);
    *i = of_v[0];
    *j = -of_u[0];
}

/* The edge goes from (0, 0) to 2^18 (u, v), a triangle lies on either side. The line along z stands in (k u + s i,
 * k v + s j). Twice the area between it and the edge is 2^18 (k u + s i) v - 2^18 (k v + s j) u = s 2^18, while both
 * products have up to 81 bits, so rounded ones are equal. Where s > 0 it stands right of the edge. */
static void edges_are_decided_exactly(void **state)
{
    (void)state;
    uint64_t random = 31;
    const uint32_t triangles[2][3] = {{0, 1, 2}, {1, 0, 3}}; /* left and right of the edge */
    for (int round = 0; round < 3000; round++) {
        int64_t u = (int64_t)test_random(&random, 1, 1 << 22) | 1;
        int64_t v = (int64_t)1 << (int)test_random(&random, 0, 22);
        int64_t i, j;
        find_cofactors(&i, &j, u, v);
        const float to[2] = {(float)(u << 18), (float)(v << 18)};
        const float positions[4][3] = {{0, 0, 0}, {to[0], to[1], 0}, {-to[1], to[0], 0}, {to[1], -to[0], 0}};
        struct mesh mesh;
        put(&mesh, positions, 4, triangles, 2);
        int64_t k = (int64_t)test_random(&random, 1 << 16, 1 << 17);
        for (int side = -1; side <= 1; side++) {
            const double origin[3] = {(double)(k * u + side * i), (double)(k * v + side * j), -5};
            bool left = mesh_is_passed(&mesh, 0, origin, (const double[]){0, 0, 1});
            bool right = mesh_is_passed(&mesh, 1, origin, (const double[]){0, 0, 1});
            assert_true(left != right);
            assert_true(side == 0 || right == (side > 0));
        }
        mesh_finish(&mesh);
    }
}

/* A square of two triangles in each plane of two axes, and lines along the third, either way, upright and aslant. */
static void lines_along_every_axis_pass_a_square_once(void **state)
{
    (void)state;
    const uint32_t triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
    for (int axis = 0; axis < 3; axis++) {
        float positions[4][3] = {0};
        for (int k = 0; k < 4; k++) {
            positions[k][(axis + 1) % 3] = k == 1 || k == 2 ? 4 : -4;
            positions[k][(axis + 2) % 3] = k >= 2 ? 4 : -4;
        }
        struct mesh mesh;
        put(&mesh, (const float(*)[3])positions, 4, triangles, 2);
        for (int kind = 0; kind < 8; kind++) {
            double origin[3], direction[3];
            double beside = kind & 1 ? 7 : 0; /* 3 mm past the square's edge */
            double slope = kind & 2 ? 0.25 : 0;
            double way = kind & 4 ? -1 : 1;
            origin[axis] = -3 * way, direction[axis] = way;
            origin[(axis + 1) % 3] = beside - 3 * slope, direction[(axis + 1) % 3] = slope;
            origin[(axis + 2) % 3] = 1, direction[(axis + 2) % 3] = 0;
            int passed = mesh_is_passed(&mesh, 0, origin, direction) + mesh_is_passed(&mesh, 1, origin, direction);
            assert_int_equal(passed, kind & 1 ? 0 : 1);
        }
        mesh_finish(&mesh);
    }
}

static void impossible_meshes_are_refused(void **state)
{
    (void)state;
    struct mesh mesh;
    struct notes notes = {0};
    assert_ok(make_box(&mesh, (double[]){1, 1, 1}, 0));
    mesh.positions[4] = NAN;
    assert_fails(mesh_check(&mesh, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "vertex 1"));
    mesh.positions[4] = 0;
    mesh.triangles[7] = 8;
    assert_fails(mesh_check(&mesh, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "triangle 2: vertex index 8"));
    mesh.triangles[7] = 5;
    mesh.triangle_count = 0;
    assert_fails(mesh_check(&mesh, &notes), CONUS_ERROR_DATA);
    mesh_finish(&mesh);
}

/* A cube of edge 10 at the origin and one of edge `size` that is moved by `by` along x, y and z, perhaps turned
 * inside out. */
static conus_status make_cubes(struct mesh *out, double size, double by, bool turned)
{
    struct mesh cubes[2];
    conus_status status = mesh_init(out, 16, 24);
    assert_ok(make_box(&cubes[0], (double[]){10, 10, 10}, 0));
    assert_ok(make_box(&cubes[1], (double[]){size, size, size}, by));
    for (size_t i = 0; !status && i < 72; i++) {
        size_t corner = i % 36;
        size_t from = i >= 36 && turned ? corner - corner % 3 + (3 - corner % 3) % 3 : corner;
        out->triangles[i] = cubes[i / 36].triangles[from] + (i < 36 ? 0 : 8);
        out->positions[i % 48] = cubes[i % 48 / 24].positions[i % 24];
    }
    mesh_finish(&cubes[0]);
    mesh_finish(&cubes[1]);
    return status;
}

/* Asserts that the volume of the two cubes is `volume`, if it is known; returns whether it is. */
static bool volume_is_known(double size, double by, bool turned, double volume)
{
    struct mesh mesh;
    struct mesh_shape shape;
    assert_ok(make_cubes(&mesh, size, by, turned));
    assert_ok(mesh_measure(&shape, &mesh));
    assert_true(shape.closed);
    if (shape.has_volume) {
        assert_near(shape.volume_mm3, volume, 1e-9);
    }
    mesh_finish(&mesh);
    return shape.has_volume;
}

/* Two solids beside each other and a solid with a cavity have the volumes 1000 + 1000 and 1000 - 216. In all other
 * cases the signed sum is wrong: it is 0 where the second cube is turned inside out beside the first; 1000 + 216 where
 * it lies in the first without being turned; 2000 for 1875 where it overlaps the first by 5 x 5 x 5; 2000 for 1000
 * where it equals the first. */
static void the_volume_of_parts_is_known_where_they_wind_once(void **state)
{
    (void)state;
    assert_true(volume_is_known(10, 20, false, 2000));
    assert_true(volume_is_known(6, 2, true, 784));
    assert_false(volume_is_known(10, 20, true, NAN));
    assert_false(volume_is_known(6, 2, false, NAN));
    assert_false(volume_is_known(10, 5, false, NAN));
    assert_false(volume_is_known(10, 0, false, NAN));
    /* A cube of edge 1 over the first one's corner: 0.5 x 0.5 x 0.5 is counted twice, less than a hundredth. */
    assert_true(volume_is_known(1, 9.5, false, 1001));
}

/* All triangles are turned: -1000 + 216, a solid whose triangles face inwards. */
static void a_solid_that_faces_inwards_has_a_volume(void **state)
{
    (void)state;
    struct mesh mesh;
    struct mesh_shape shape;
    assert_ok(make_cubes(&mesh, 6, 2, true));
    for (size_t i = 0; i < 72; i += 3) {
        uint32_t kept = mesh.triangles[i];
        mesh.triangles[i] = mesh.triangles[i + 1];
        mesh.triangles[i + 1] = kept;
    }
    assert_ok(mesh_measure(&shape, &mesh));
    assert_true(shape.has_volume);
    assert_near(shape.volume_mm3, -784, 1e-9);
    mesh_finish(&mesh);
}

static conus_status check_box(void *data)
{
    struct mesh mesh = {0};
    struct mesh_shape shape;
    struct notes notes = {0};
    (void)data;
    conus_status status = make_box(&mesh, (double[]){1, 1, 1}, 0);
    status = status ? status : mesh_check(&mesh, &notes);
    status = status ? status : mesh_measure(&shape, &mesh);
    notes_finish(&notes);
    mesh_finish(&mesh);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    test_every_allocation(check_box, NULL);
}

TEST_GROUP(mesh)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_is_closed_and_measured),
        cmocka_unit_test(mirrors_keep_triangles_outward),
        cmocka_unit_test(open_and_flat_parts_are_noted),
        cmocka_unit_test(a_turned_triangle_is_not_closed),
        cmocka_unit_test(vertices_at_equal_positions_are_one),
        cmocka_unit_test(an_edge_may_have_four_triangles),
        cmocka_unit_test(triangles_without_area_close_what_they_join),
        cmocka_unit_test(triangles_of_two_corners_change_nothing),
        cmocka_unit_test(an_open_surface_has_the_centroid_of_its_area),
        cmocka_unit_test(crossings_stay_within_the_triangle_s_reach),
        cmocka_unit_test(edges_are_decided_exactly),
        cmocka_unit_test(lines_along_every_axis_pass_a_square_once),
        cmocka_unit_test(impossible_meshes_are_refused),
        cmocka_unit_test(the_volume_of_parts_is_known_where_they_wind_once),
        cmocka_unit_test(a_solid_that_faces_inwards_has_a_volume),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
