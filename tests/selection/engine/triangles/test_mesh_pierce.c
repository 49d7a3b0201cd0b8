/* SPDX-License-Identifier: BSD-3-Clause */
/* All layers of surfaces (Eq. 10): against every triangle tried in double, and against first hits. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "mesh_scene.h"
#include "selection/selection.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

/* Single precision may put a ray on the other side of an edge if it passes within this part of the scene's size. */
#define EDGE 1e-6

enum { CROSSINGS = 1000 };

static conus_selection *select_all(const conus_atlas *atlas, const struct cone *cone)
{
    const conus_selector_options options = {
        .layers = CONUS_LAYERS_ALL, .resolution = cone->resolution, .radius = cone->radius};
    return mesh_scene_select(atlas, &options, cone);
}

enum { SIDE = 8 };

/* A selector with SIDE x SIDE pixels, for several poses. */
static conus_selector *selector_of_all(const conus_atlas *atlas)
{
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .resolution = SIDE};
    conus_selector *selector = NULL;
    assert_ok(conus_selector_create(&selector, atlas, &options));
    return selector;
}

static conus_selection *select_by(conus_selector *selector, const struct cone *cone)
{
    conus_selection *selection = NULL;
    assert_ok(conus_select(&selection, selector, &cone->pose, degrees_from_radians(cone->angle)));
    return selection;
}

static void random_point(uint64_t *random, double out[3], double size)
{
    for (int a = 0; a < 3; a++) {
        out[a] = test_random(random, -size, size);
    }
}

struct compared {
    size_t rays, intervals, inside, at_edges;
};

/* The intervals of closed surfaces: a place is inside if not as many exits as entries lie ahead of it. */
static size_t oracle_intervals(conus_interval *out, const struct crossing *crossings, size_t count)
{
    size_t interval_count = 0;
    int depth = 0;
    for (size_t i = 0; i < count; i++) {
        depth -= crossings[i].side;
    }
    if (depth != 0) {
        out[interval_count++] = (conus_interval){.entry = 0};
    }
    for (size_t i = 0; i < count; i++) {
        int next = depth + crossings[i].side;
        if (depth == 0 && next != 0) {
            out[interval_count++] = (conus_interval){.entry = crossings[i].t};
        } else if (depth != 0 && next == 0) {
            out[interval_count - 1].exit = crossings[i].t;
        }
        depth = next;
    }
    return interval_count;
}

/* Whether the ray passes an edge of the triangle so closely that single precision may see it otherwise. */
static bool is_at_edge(const struct mesh *mesh, const double origin[3], const double direction[3], double size)
{
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        if (mesh_scene_edge_distance(mesh, i, origin, direction) <= EDGE * size) {
            return true;
        }
    }
    return false;
}

static bool are_equal(const conus_interval *got, size_t got_count, const conus_interval *wanted, size_t wanted_count)
{
    bool equal = got_count == wanted_count;
    for (size_t i = 0; equal && i < wanted_count; i++) {
        double tolerance = 1e-9 * (1 + wanted[i].exit);
        equal = fabs(got[i].entry - wanted[i].entry) <= tolerance && fabs(got[i].exit - wanted[i].exit) <= tolerance;
    }
    return equal;
}

static void compare_object(const conus_selection *selection, uint32_t pixel, uint32_t object, double size,
                           struct compared *tally)
{
    const struct cone *cone = &selection->cone;
    const struct mesh *mesh = atlas_object_mesh(selection->atlas, object);
    struct crossing crossings[CROSSINGS];
    conus_interval wanted[CROSSINGS], got[CROSSINGS];
    size_t got_count = 0;
    double origin[3], direction[3];
    cone_origin(origin, cone, pixel % cone->resolution, pixel / cone->resolution);
    cone_ray(direction, cone, pixel % cone->resolution, pixel / cone->resolution);
    size_t wanted_count =
        oracle_intervals(wanted, crossings, mesh_scene_all(crossings, CROSSINGS, mesh, origin, direction));
    for (size_t s = 0; s < selection->layers.count; s++) {
        const conus_interval *interval = &selection->layers.intervals[s];
        if (interval->pixel == pixel && interval->object == object) {
            got[got_count++] = *interval;
        }
    }
    tally->rays++;
    tally->intervals += wanted_count;
    tally->inside += wanted_count && wanted[0].entry == 0;
    if (!are_equal(got, got_count, wanted, wanted_count)) {
        tally->at_edges++;
        if (!is_at_edge(mesh, origin, direction, size)) {
            fail_msg("pixel %u, object %u: %zu intervals (%.12g %.12g), wanted %zu (%.12g %.12g)", pixel, object,
                     got_count, got_count ? got[0].entry : NAN, got_count ? got[0].exit : NAN, wanted_count,
                     wanted_count ? wanted[0].entry : NAN, wanted_count ? wanted[0].exit : NAN);
        }
    }
}

/* Eq. 9 and Eq. 10 agree: the first hit is the first interval, unless the apex is inside. */
static void compare_visible(const conus_selection *selection)
{
    const struct evidence *evidence = &selection->evidence;
    size_t s = 0;
    for (uint32_t pixel = 0; pixel < evidence->resolution * evidence->resolution; pixel++) {
        const conus_interval *first = NULL;
        bool inside = false;
        for (; s < selection->layers.count && selection->layers.intervals[s].pixel == pixel; s++) {
            inside = inside || selection->layers.intervals[s].entry == 0;
            first = first ? first : &selection->layers.intervals[s];
        }
        if (!inside) {
            assert_int_equal(evidence->object[pixel], first ? first->object : 0);
            assert_true(first ? evidence->distance[pixel] == first->entry : isinf(evidence->distance[pixel]));
            assert_true(evidence->voxel[pixel] == (first ? first->voxel : EVIDENCE_NO_VOXEL));
        }
    }
}

static void compare_selection(const conus_selection *selection, double size, struct compared *tally)
{
    uint32_t n = selection->cone.resolution;
    for (uint32_t pixel = 0; pixel < n * n; pixel++) {
        for (uint32_t object = 1; object <= selection->atlas->object_count; object++) {
            compare_object(selection, pixel, object, size, tally);
        }
    }
    compare_visible(selection);
}

/* Spheres and tori, nested and overlapping, now and then two shells in one mesh. */
static conus_atlas *random_atlas(uint64_t *random, double size)
{
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < 5; i++) {
        double centre[3];
        random_point(random, centre, size / 2);
        double radius = size * test_random(random, 0.2, 0.6);
        struct mesh mesh = i % 2 ? mesh_scene_torus(radius, radius * test_random(random, 0.1, 0.8), 14, 9)
                                 : mesh_scene_sphere(centre, radius, 9, 13);
        mesh_scene_add(atlas, &mesh);
    }
    return atlas;
}

static void compare_random(uint64_t *random, double size, double away, double radius, struct compared *tally)
{
    conus_atlas *atlas = random_atlas(random, size);
    double origin[3], target[3];
    random_point(random, origin, away);
    random_point(random, target, size / 2);
    uint32_t n = 1 + (uint32_t)test_random(random, 0, 20);
    double wide = degrees_from_radians(2 * atan(size / away));
    struct cone cone = mesh_scene_cone(origin, target, away > size ? wide : test_random(random, 5, 120), n);
    cone.radius = radius;
    conus_selection *selection = select_all(atlas, &cone);
    compare_selection(selection, fmax(size, radius), tally);
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

static void intervals_are_those_of_all_triangles_in_double(void **state)
{
    (void)state;
    uint64_t random = 71;
    struct compared tally = {0};
    for (int i = 0; i < 60; i++) {
        double size = pow(10, test_random(&random, -1, 3));
        compare_random(&random, size, i % 3 == 0 ? size : i % 3 == 1 ? 5 * size : 1e3 * size, 0, &tally);
    }
    assert_true(tally.rays > 10000 && tally.intervals > tally.rays / 10 && tally.inside > 100);
    assert_true(tally.at_edges < tally.rays / 1000);
}

static void a_cylinder_s_intervals_are_too(void **state)
{
    (void)state;
    uint64_t random = 72;
    struct compared tally = {0};
    for (int i = 0; i < 20; i++) {
        compare_random(&random, 50, i % 2 ? 50 : 200, 30, &tally);
    }
    assert_true(tally.rays > 5000 && tally.intervals > tally.rays / 20 && tally.inside > 100);
    assert_true(tally.at_edges < tally.rays / 1000);
}

/* Solid angle of a triangle with unit corners, by L'Huilier's theorem for its sides, signed by its orientation. */
static double solid_angle(double corner[3][3])
{
    double side[3], normal[3];
    for (int k = 0; k < 3; k++) {
        const double *a = corner[(k + 1) % 3], *b = corner[(k + 2) % 3];
        vec3_cross(normal, a, b);
        side[k] = atan2(vec3_length(normal), vec3_dot(a, b));
    }
    double half = (side[0] + side[1] + side[2]) / 2;
    double product = tan(half / 2);
    for (int k = 0; k < 3; k++) {
        product *= tan((half - side[k]) / 2);
    }
    vec3_cross(normal, corner[1], corner[2]);
    return copysign(4 * atan(sqrt(fmax(product, 0))), vec3_dot(corner[0], normal));
}

/* Winding number of a closed surface around a point: the sum of all solid angles over 4 pi. */
static bool is_wound(const struct mesh *mesh, const double point[3])
{
    double sum = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double corner[3][3];
        for (size_t k = 0; k < 3; k++) {
            const float *p = &mesh->positions[3 * (size_t)mesh->triangles[3 * i + k]];
            vec3_sub(corner[k], (const double[]){(double)p[0], (double)p[1], (double)p[2]}, point);
            vec3_scale(corner[k], corner[k], 1 / vec3_length(corner[k]));
        }
        sum += solid_angle(corner);
    }
    double winding = sum / (4 * MATH3_PI);
    assert_true(fabs(winding - nearbyint(winding)) < 1e-6);
    return nearbyint(winding) != 0;
}

/* A copy in which every corner is a separate vertex, as in STL files. */
static struct mesh exploded(struct mesh *mesh)
{
    struct mesh out;
    assert_ok(mesh_init(&out, 3 * mesh->triangle_count, mesh->triangle_count));
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++) {
        memcpy(&out.positions[3 * (size_t)i], &mesh->positions[3 * (size_t)mesh->triangles[i]], 3 * sizeof(float));
        out.triangles[i] = i;
    }
    mesh_finish(mesh);
    return out;
}

/* Cubes with edges of 4 as surfaces of an atlas, many of which share only an edge or a corner; some are turned
 * around. */
static struct mesh cubes(uint64_t *random)
{
    struct mesh all = {0};
    for (int i = 0; i < 27; i++) {
        const int at[3] = {i % 3, i / 3 % 3, i / 9};
        const double low[3] = {4 * (at[0] - 1.5), 4 * (at[1] - 1.5), 4 * (at[2] - 1.5)};
        if (all.triangle_count && test_random(random, 0, 1) < 0.6) {
            continue;
        }
        struct mesh box = mesh_scene_box(low, (const double[]){low[0] + 4, low[1] + 4, low[2] + 4});
        if (test_random(random, 0, 1) < 0.3) {
            mesh_scene_turn(&box);
        }
        all = all.triangle_count ? mesh_scene_join(&all, &box) : box;
    }
    return test_random(random, 0, 1) < 0.5 ? exploded(&all) : all;
}

/* Whether a point lies in a plane of the cubes' sides. */
static bool is_on_side(const double point[3])
{
    bool on = false;
    for (int a = 0; a < 3; a++) {
        on = on || fabs(remainder(point[a] - 2, 4)) < 1e-6;
    }
    return on;
}

/* Asserts whether the ray is inside between two places, unless they are too near to tell. */
static void assert_between(const struct mesh *mesh, const double origin[3], const double ray[3], double from, double to,
                           bool inside)
{
    double place[3];
    vec3_add_scaled(place, origin, 0.63 * from + 0.37 * to, ray);
    if (to - from > 1e-3 && !is_on_side(place)) {
        assert_int_equal(is_wound(mesh, place), inside);
    }
}

static void check_rays(const conus_selection *selection, size_t *interval_count)
{
    const struct mesh *mesh = atlas_object_mesh(selection->atlas, 1);
    const struct cone *cone = &selection->cone;
    const conus_interval *intervals = selection->layers.intervals;
    size_t s = 0;
    for (uint32_t pixel = 0; pixel < cone->resolution * cone->resolution; pixel++) {
        double origin[3], ray[3], last = 0;
        cone_origin(origin, cone, pixel % cone->resolution, pixel / cone->resolution);
        cone_ray(ray, cone, pixel % cone->resolution, pixel / cone->resolution);
        assert_false(is_at_edge(mesh, origin, ray, 6));
        for (; s < selection->layers.count && intervals[s].pixel == pixel; s++) {
            assert_between(mesh, origin, ray, last, intervals[s].entry, false);
            assert_between(mesh, origin, ray, intervals[s].entry, intervals[s].exit, true);
            last = intervals[s].exit;
            ++*interval_count;
        }
        assert_between(mesh, origin, ray, last, last + 100, false); /* 37 farther, out of all cubes */
    }
}

static void intervals_are_where_the_surface_winds(void **state)
{
    (void)state;
    uint64_t random = 78;
    size_t interval_count = 0;
    for (size_t i = 0; i < test_trials(150); i++) {
        conus_atlas *atlas = mesh_scene_atlas();
        struct mesh mesh = cubes(&random);
        mesh_scene_add(atlas, &mesh);
        assert_true(atlas_object_mesh(atlas, 1)->shape.closed);
        double origin[3], target[3];
        random_point(&random, origin, i % 2 ? 5 : 20);
        random_point(&random, target, 4);
        struct cone cone = mesh_scene_cone(origin, target, i % 2 ? 100 : 30, 7);
        conus_selection *selection = select_all(atlas, &cone);
        check_rays(selection, &interval_count);
        conus_selection_destroy(selection);
        conus_atlas_destroy(atlas);
    }
    assert_true(interval_count > 1000);
}

/* Two tetrahedra with a common edge along x. The ray runs along z, 1e-5 beside the edge: through the first one from
 * -1e-5 to 1e-5 (its sides are z = y and z = -y there), into the second one at 2e-5 (z = 2y) and out of it at 5.7,
 * where x + z = 6. Entries as near to each other as these still count twice. */
static void both_tetrahedra_at_an_edge_are_hit(void **state)
{
    (void)state;
    static const float positions[6][3] = {{-6, 0, 0}, {6, 0, 0}, {0, 6, -6}, {0, 6, 6}, {0, 3, 6}, {0, 0, 6}};
    static const uint32_t triangles[8][3] = {{0, 3, 2}, {1, 2, 3}, {0, 1, 3}, {0, 2, 1},
                                             {0, 5, 4}, {1, 4, 5}, {0, 1, 5}, {0, 4, 1}};
    struct mesh mesh;
    conus_atlas *atlas = mesh_scene_atlas();
    assert_ok(mesh_init(&mesh, 6, 8));
    memcpy(mesh.positions, positions, sizeof positions);
    memcpy(mesh.triangles, triangles, sizeof triangles);
    mesh_scene_add(atlas, &mesh);
    assert_true(atlas_object_mesh(atlas, 1)->shape.closed);
    struct cone cone = mesh_scene_cone((double[]){0.3, 1e-5, -3}, (double[]){0.3, 1e-5, 0}, 1, 1);
    conus_selection *selection = select_all(atlas, &cone);
    assert_int_equal(selection->layers.count, 2);
    const conus_interval *intervals = selection->layers.intervals;
    assert_near(intervals[0].entry, 3 - 1e-5, 1e-9);
    assert_near(intervals[0].exit, 3 + 1e-5, 1e-9);
    assert_near(intervals[1].entry, 3 + 2e-5, 1e-9);
    assert_near(intervals[1].exit, 3 + 5.7, 1e-9);
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

/* A surface with holes has no intervals to compare. Compared are whether a ray crosses it, and where first. */
static void compare_open(const conus_selection *selection, uint32_t pixel, uint32_t object, struct compared *tally)
{
    const struct cone *cone = &selection->cone;
    struct crossing crossings[CROSSINGS];
    double origin[3], direction[3];
    const conus_interval *first = NULL;
    cone_origin(origin, cone, pixel % cone->resolution, pixel / cone->resolution);
    cone_ray(direction, cone, pixel % cone->resolution, pixel / cone->resolution);
    size_t wanted =
        mesh_scene_all(crossings, CROSSINGS, atlas_object_mesh(selection->atlas, object), origin, direction);
    for (size_t s = selection->layers.count; s-- > 0;) {
        const conus_interval *interval = &selection->layers.intervals[s];
        first = interval->pixel == pixel && interval->object == object ? interval : first;
    }
    tally->rays++;
    tally->intervals += wanted > 0;
    tally->at_edges +=
        (wanted > 0) != (first != NULL) || (first && fabs(first->entry - crossings[0].t) > 1e-9 * crossings[0].t);
}

static void compare_poses(uint64_t *random, const conus_atlas *atlas, size_t poses, struct compared *tally)
{
    conus_selector *selector = selector_of_all(atlas);
    for (size_t k = 0; k < poses; k++) {
        double origin[3], target[3];
        random_point(random, origin, k % 2 ? 60 : 250);
        random_point(random, target, 40);
        struct cone cone = mesh_scene_cone(origin, target, k % 2 ? 60 : 15, SIDE);
        conus_selection *selection = select_by(selector, &cone);
        for (uint32_t i = 0; i < SIDE * SIDE * atlas->object_count; i++) {
            uint32_t object = 1 + i / (SIDE * SIDE);
            if (atlas_object_mesh(atlas, object)->shape.closed) {
                compare_object(selection, i % (SIDE * SIDE), object, 100, tally);
            } else {
                compare_open(selection, i % (SIDE * SIDE), object, tally);
            }
        }
        compare_visible(selection);
        conus_selection_destroy(selection);
    }
    conus_selector_destroy(selector);
}

static void the_brain_phantom_s_areas(void **state)
{
    (void)state;
    uint64_t random = 74;
    struct compared tally = {0};
    conus_atlas *atlas = mesh_scene_atlas();
    for (size_t i = 0; i < PHANTOM_BRAIN_AREAS; i++) {
        struct mesh mesh;
        assert_ok(phantom_brain_mesh(&mesh, i));
        mesh_scene_add(atlas, &mesh);
    }
    compare_poses(&random, atlas, test_trials(6), &tally);
    print_message("brain: %zu rays x areas, %zu intervals, %zu from an apex inside, %zu at edges\n", tally.rays,
                  tally.intervals, tally.inside, tally.at_edges);
    assert_true(tally.intervals > test_trials(300) && tally.at_edges <= 1);
    conus_atlas_destroy(atlas);
}

static void julich_brain_s_areas(void **state)
{
    (void)state;
    uint64_t random = 75;
    struct compared tally = {0};
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_shared("meshes/julich31-areas/lh"), NULL));
    size_t closed = 0;
    for (uint32_t object = 1; object <= atlas->object_count; object++) {
        closed += atlas_object_mesh(atlas, object)->shape.closed;
    }
    compare_poses(&random, atlas, test_trials(6), &tally);
    print_message(
        "Julich-Brain: %zu of %zu areas closed; %zu rays x areas, %zu intervals, %zu from an apex inside, %zu at "
        "edges\n",
        closed, atlas->object_count, tally.rays, tally.intervals, tally.inside, tally.at_edges);
    assert_true(tally.intervals > test_trials(300) && tally.at_edges <= tally.intervals / 500);
    conus_atlas_destroy(atlas);
}

/* The Allen atlas's meshes from places inside and beside each: every one bounds a solid, though most have edges with
 * four triangles. */
static void compare_allen(uint64_t *random, conus_selector *selector, const struct mesh *mesh, uint32_t object,
                          struct compared *tally)
{
    for (size_t k = 0; k < test_trials(2); k++) {
        size_t vertex = mesh->triangles[3 * (size_t)test_random(random, 0, (double)mesh->triangle_count)];
        double origin[3], target[3];
        for (int a = 0; a < 3; a++) {
            origin[a] = (double)mesh->positions[3 * vertex + (size_t)a] + test_random(random, -0.1, 0.1);
            target[a] = test_random(random, mesh->shape.low[a], mesh->shape.high[a]);
        }
        struct cone cone = mesh_scene_cone(origin, target, 60, SIDE);
        conus_selection *selection = select_by(selector, &cone);
        for (uint32_t pixel = 0; pixel < SIDE * SIDE; pixel++) {
            compare_object(selection, pixel, object, 10, tally);
        }
        conus_selection_destroy(selection);
    }
}

static void allen_areas(void **state)
{
    (void)state;
    uint64_t random = 76;
    struct compared tally = {0};
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_shared("meshes/brainglobe-allen-ccf2017-subset"), NULL));
    size_t meshes = 0;
    conus_selector *selector = selector_of_all(atlas);
    for (uint32_t object = 1; object <= atlas->object_count; object++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, object);
        if (mesh) {
            meshes++;
            assert_true(mesh->shape.closed);
            compare_allen(&random, selector, mesh, object, &tally);
        }
    }
    conus_selector_destroy(selector);
    print_message("Allen: %zu areas; %zu rays x areas, %zu intervals, %zu from an apex inside, %zu at edges\n", meshes,
                  tally.rays, tally.intervals, tally.inside, tally.at_edges);
    assert_int_equal(meshes, 55);
    assert_true(tally.intervals > test_trials(300) && tally.inside > test_trials(1000));
    conus_atlas_destroy(atlas);
}

static conus_status create_and_pierce(void *data)
{
    const conus_atlas *atlas = data;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL};
    struct cone cone = mesh_scene_cone((double[]){1, 2, 300}, (double[]){0, 0, 0}, 10, 16);
    conus_status status = conus_selector_create(&selector, atlas, &options);
    status = status ? status : conus_select(&selection, selector, &cone.pose, degrees_from_radians(cone.angle));
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return status;
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    uint64_t random = 73;
    conus_atlas *atlas = random_atlas(&random, 50);
    test_every_allocation(create_and_pierce, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(mesh_pierce)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(intervals_are_those_of_all_triangles_in_double),
        cmocka_unit_test(a_cylinder_s_intervals_are_too),
        cmocka_unit_test(intervals_are_where_the_surface_winds),
        cmocka_unit_test(both_tetrahedra_at_an_edge_are_hit),
        cmocka_unit_test(the_brain_phantom_s_areas),
        cmocka_unit_test(julich_brain_s_areas),
        cmocka_unit_test(allen_areas),
        cmocka_unit_test(every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
