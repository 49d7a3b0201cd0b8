/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays through meshes: hits, edges, limits and objects. */
#include "base/geometry/math3.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/engine/triangles/mesh_tracer.h"
#include "test.h"

#include <string.h>

static const unsigned widths[] = {1, 4, 8, 16};

enum { WIDTHS = 4 };

/* The tracers; every test below runs with each. */
static const struct mesh_tracer *const tracers[] = {
#if CONUS_EMBREE
    &mesh_embree,
#endif
    &mesh_bvh};

enum { TRACERS = sizeof tracers / sizeof tracers[0] };

/* Single precision may put a ray on the other side of an edge if it passes within this part of the scene's size. */
#define EDGE 1e-6

struct tally {
    size_t rays, hits, at_edges;
};

/* Whether a hit differs from the true one only because the ray passes an edge that closely. */
static bool is_at_edge(const conus_atlas *atlas, const struct mesh_hit *hit, const double origin[3],
                       const double direction[3], double size)
{
    const struct mesh *mesh = hit->object ? atlas_object_mesh(atlas, hit->object) : NULL;
    return mesh && mesh_scene_edge_distance(mesh, (size_t)hit->triangle, origin, direction) <= EDGE * size;
}

static void compare(const conus_atlas *atlas, const struct mesh_hit *got, const double origin[3],
                    const double direction[3], double size, struct tally *tally)
{
    struct mesh_hit wanted = mesh_scene_first(atlas, origin, direction);
    tally->rays++;
    tally->hits += wanted.object != 0;
    if (got->object != wanted.object || got->triangle != wanted.triangle) {
        if (!is_at_edge(atlas, got, origin, direction, size) && !is_at_edge(atlas, &wanted, origin, direction, size)) {
            fail_msg("ray from %g %g %g along %g %g %g: object %u, triangle %llu, %.17g mm; wanted %u, %llu, %.17g",
                     origin[0], origin[1], origin[2], direction[0], direction[1], direction[2], got->object,
                     (unsigned long long)got->triangle, got->t, wanted.object, (unsigned long long)wanted.triangle,
                     wanted.t);
        }
        tally->at_edges++;
    } else if (wanted.object) {
        assert_near(got->t, wanted.t, 1e-9 * (1 + wanted.t));
    } else {
        assert_true(isinf(got->t));
    }
}

static void random_point(uint64_t *random, double out[3], double size)
{
    for (int a = 0; a < 3; a++) {
        out[a] = test_random(random, -size, size);
    }
}

/* Random rays from @p origin at points within @p size mm of 0 on every axis, without a hit yet. */
static void aim(uint64_t *random, struct mesh_bundle *out, double direction[3][MESH_RAYS_LIMIT], const double origin[3],
                double size)
{
    out->origin = origin;
    out->direction = (const double(*)[MESH_RAYS_LIMIT])direction;
    for (size_t ray = 0; ray < out->count; ray++) {
        double d[3];
        random_point(random, d, size);
        vec3_sub(d, d, origin);
        assert_true(vec3_normalise(d, d));
        direction[0][ray] = d[0], direction[1][ray] = d[1], direction[2][ray] = d[2];
        out->object[ray] = 0;
        out->t[ray] = INFINITY;
        out->triangle[ray] = 0;
    }
}

static void compare_bundle(uint64_t *state, struct mesh_rays *rays, const conus_atlas *atlas, double size, double away,
                           struct tally *tally)
{
    double origin[3], direction[3][MESH_RAYS_LIMIT];
    struct mesh_bundle bundle = {.count = 1 + (size_t)test_random(state, 0, 40)};
    random_point(state, origin, away);
    aim(state, &bundle, direction, origin, size);
    assert_ok(mesh_rays_trace(rays, &bundle, widths[(size_t)test_random(state, 0, WIDTHS)]));
    for (size_t ray = 0; ray < bundle.count; ray++) {
        const struct mesh_hit got = {bundle.object[ray], bundle.triangle[ray], bundle.t[ray]};
        const double d[3] = {direction[0][ray], direction[1][ray], direction[2][ray]};
        compare(atlas, &got, origin, d, size, tally);
    }
}

static struct mesh_rays *mesh_rays_of(const struct mesh_tracer *tracer, const conus_atlas *atlas)
{
    struct mesh_object objects[16] = {0};
    struct mesh_rays *rays = NULL;
    assert_true(atlas->object_count <= 16);
    for (uint32_t i = 0; i < atlas->object_count; i++) {
        objects[i].mesh = atlas_object_mesh(atlas, i + 1);
    }
    assert_ok(mesh_rays_create_with(&rays, tracer, objects, atlas->object_count));
    return rays;
}

static void compare_atlas(uint64_t *state, const conus_atlas *atlas, double size, struct tally tallies[TRACERS])
{
    uint64_t start = *state;
    for (int k = 0; k < TRACERS; k++) {
        struct mesh_rays *rays = mesh_rays_of(tracers[k], atlas);
        *state = start;
        for (int i = 0; i < 12; i++) {
            double away = i % 3 == 0 ? size : i % 3 == 1 ? 5 * size : 1e5;
            compare_bundle(state, rays, atlas, size, away, &tallies[k]);
        }
        mesh_rays_destroy(rays);
    }
}

static void finds_the_first_triangle_of_random_ones(void **test)
{
    (void)test;
    uint64_t random = 9;
    struct tally tallies[TRACERS] = {0};
    for (int i = 0; i < 60; i++) {
        conus_atlas *atlas = mesh_scene_atlas();
        double size = pow(10, test_random(&random, -1, 3));
        for (int k = 0; k < 1 + i % 7; k++) {
            struct mesh soup = mesh_scene_soup(&random, 1 + (size_t)test_random(&random, 0, 60), size,
                                               size * test_random(&random, 0.05, 1));
            mesh_scene_add(atlas, &soup);
        }
        compare_atlas(&random, atlas, size, tallies);
        conus_atlas_destroy(atlas);
    }
    for (int k = 0; k < TRACERS; k++) {
        const struct tally *tally = &tallies[k];
        assert_true(tally->rays > 10000 && tally->hits > tally->rays / 3);
        assert_true(tally->at_edges < tally->rays / 1000);
    }
}

static void finds_the_outermost_of_nested_spheres(void **test)
{
    (void)test;
    uint64_t random = 10;
    struct tally tallies[TRACERS] = {0};
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < 6; i++) {
        struct mesh sphere = mesh_scene_sphere((double[]){3, -2, 1}, 50 - i * pow(10, -i), 12, 17);
        mesh_scene_add(atlas, &sphere);
    }
    for (int i = 0; i < 10; i++) {
        compare_atlas(&random, atlas, 60, tallies);
    }
    for (int k = 0; k < TRACERS; k++) {
        const struct tally *tally = &tallies[k];
        assert_true(tally->hits > tally->rays / 2);
        assert_true(tally->at_edges < tally->rays / 1000);
    }
    conus_atlas_destroy(atlas);
}

#if CONUS_EMBREE

/* Traces the same rays with both; they may differ only at edges. */
static void compare_tracers(uint64_t *random, struct mesh_rays *const rays[2], const conus_atlas *atlas,
                            const double origin[3], struct tally *tally)
{
    double direction[3][MESH_RAYS_LIMIT];
    struct mesh_bundle bundles[2] = {{.count = MESH_RAYS_LIMIT}};
    aim(random, &bundles[0], direction, origin, 70);
    bundles[1] = bundles[0];
    for (int k = 0; k < 2; k++) {
        assert_ok(mesh_rays_trace(rays[k], &bundles[k], 16));
    }
    for (size_t ray = 0; ray < MESH_RAYS_LIMIT; ray++) {
        const struct mesh_hit hits[] = {{bundles[0].object[ray], bundles[0].triangle[ray], bundles[0].t[ray]},
                                        {bundles[1].object[ray], bundles[1].triangle[ray], bundles[1].t[ray]}};
        const double d[3] = {direction[0][ray], direction[1][ray], direction[2][ray]};
        tally->rays++;
        tally->hits += hits[1].object != 0;
        if (hits[0].object != hits[1].object || hits[0].triangle != hits[1].triangle) {
            assert_true(is_at_edge(atlas, &hits[0], origin, d, 100) || is_at_edge(atlas, &hits[1], origin, d, 100));
            tally->at_edges++;
        } else {
            assert_true(hits[0].t == hits[1].t);
        }
    }
}

/* 234,444 triangles, from inside, from nearby and from far away. */
static void embree_and_the_own_tree_agree_on_the_brain(void **test)
{
    (void)test;
    uint64_t random = 13;
    struct tally tally = {0};
    conus_atlas *atlas = mesh_scene_brain();
    struct mesh_rays *rays[2] = {mesh_rays_of(&mesh_embree, atlas), mesh_rays_of(&mesh_bvh, atlas)};
    for (int round = 0; round < 300; round++) {
        double origin[3];
        random_point(&random, origin, round % 3 == 0 ? 30 : round % 3 == 1 ? 300 : 1e5);
        compare_tracers(&random, rays, atlas, origin, &tally);
    }
    assert_true(tally.hits > tally.rays / 5 && tally.at_edges < tally.rays / 1000);
    mesh_rays_destroy(rays[0]);
    mesh_rays_destroy(rays[1]);
    conus_atlas_destroy(atlas);
}

#endif

/* A bundle from @p origin at random points of edges, from @p low to @p high of their length. */
static void aim_at_edges(uint64_t *random, double direction[3][MESH_RAYS_LIMIT], const struct mesh *mesh,
                         const double origin[3], double low, double high)
{
    for (size_t ray = 0; ray < MESH_RAYS_LIMIT; ray++) {
        const uint32_t *corners = &mesh->triangles[3 * (size_t)test_random(random, 0, (double)mesh->triangle_count)];
        double s = test_random(random, low, high);
        double d[3];
        for (uint32_t a = 0; a < 3; a++) {
            double from = (double)mesh->positions[3 * corners[0] + a];
            d[a] = from + s * ((double)mesh->positions[3 * corners[1] + a] - from) - origin[a];
        }
        assert_true(vec3_normalise(d, d));
        direction[0][ray] = d[0], direction[1][ray] = d[1], direction[2][ray] = d[2];
    }
}

/* Rays at the edges of a closed sphere, from inside and far outside, but not at its silhouette; returns the number of
 * rays that hit nothing. */
static size_t count_lost(const struct mesh_tracer *tracer, double low, double high, size_t *aimed)
{
    uint64_t random = 11;
    size_t lost = 0;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh sphere = mesh_scene_sphere((double[]){0, 0, 0}, 80, 24, 31);
    mesh_scene_add(atlas, &sphere);
    struct mesh_rays *rays = mesh_rays_of(tracer, atlas);
    for (int round = 0; round < 400; round++) {
        double origin[3], direction[3][MESH_RAYS_LIMIT];
        struct mesh_bundle bundle = {.count = MESH_RAYS_LIMIT, .origin = origin};
        double away = round % 2 ? 30 : 1e4;
        random_point(&random, origin, away);
        aim_at_edges(&random, direction, atlas_object_mesh(atlas, 1), origin, low, high);
        bundle.direction = (const double(*)[MESH_RAYS_LIMIT])direction;
        for (size_t ray = 0; ray < bundle.count; ray++) {
            bundle.t[ray] = INFINITY;
        }
        assert_ok(mesh_rays_trace(rays, &bundle, widths[round / 2 % WIDTHS]));
        for (size_t ray = 0; ray < bundle.count; ray++) {
            const double d[3] = {direction[0][ray], direction[1][ray], direction[2][ray]};
            double along = vec3_dot(origin, d);
            bool certain = vec3_dot(origin, origin) - along * along < 75 * 75;
            *aimed += certain;
            lost += certain && !bundle.object[ray];
        }
    }
    mesh_rays_destroy(rays);
    conus_atlas_destroy(atlas);
    return lost;
}

static void no_ray_slips_between_two_triangles(void **test)
{
    (void)test;
    for (int k = 0; k < TRACERS; k++) {
        size_t aimed = 0;
        assert_int_equal(count_lost(tracers[k], 0.01, 0.99, &aimed), 0);
        assert_true(aimed > 60000);
    }
}

/* At a point where many triangles meet, a ray that hits it to seven digits may slip through Embree: once in
 * thousands. */
static void hardly_any_ray_slips_through_a_vertex(void **test)
{
    (void)test;
    for (int k = 0; k < TRACERS; k++) {
        size_t aimed = 0;
        size_t lost = count_lost(tracers[k], 0, 0, &aimed);
        assert_true(aimed > 60000 && lost < aimed / 1000);
        assert_true(tracers[k] != &mesh_bvh || lost == 0);
    }
}

static struct mesh square_at(double z, bool turned)
{
    struct mesh mesh;
    assert_ok(mesh_init(&mesh, 4, 2));
    const float positions[] = {-10, -10, (float)z, 10, -10, (float)z, 10, 10, (float)z, -10, 10, (float)z};
    const uint32_t up[] = {0, 1, 2, 0, 2, 3}, down[] = {2, 1, 0, 3, 2, 0};
    memcpy(mesh.positions, positions, sizeof positions);
    memcpy(mesh.triangles, turned ? down : up, sizeof up);
    return mesh;
}

static void assert_all(const conus_atlas *atlas, const struct cone *cone, uint32_t object, double depth)
{
    struct evidence evidence;
    uint32_t n = cone->resolution;
    mesh_scene_trace(&evidence, atlas, cone);
    for (uint32_t pixel = 0; pixel < n * n; pixel++) {
        double ray[3];
        cone_ray(ray, cone, pixel % n, pixel / n);
        assert_int_equal(evidence.object[pixel], object);
        if (object) {
            assert_near(evidence.distance[pixel] * -vec3_dot(ray, cone->pose.world_from_device + 8), depth,
                        1e-9 * depth);
        }
    }
    evidence_finish(&evidence);
}

static void both_faces_count_and_open_surfaces_do(void **test)
{
    (void)test;
    for (int turned = 0; turned < 2; turned++) {
        conus_atlas *atlas = mesh_scene_atlas();
        struct mesh square = square_at(3, turned);
        mesh_scene_add(atlas, &square);
        for (int below = 0; below < 2; below++) {
            struct cone cone = mesh_scene_cone((double[]){0.1, 0.2, below ? -20 : 20}, (double[]){0.1, 0.2, 3}, 20, 16);
            assert_all(atlas, &cone, 1, below ? 23 : 17);
        }
        conus_atlas_destroy(atlas);
    }
}

static void what_lies_behind_the_apex_is_not_hit(void **test)
{
    (void)test;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh behind = square_at(-1e-7, false), ahead = square_at(5, false);
    mesh_scene_add(atlas, &behind);
    mesh_scene_add(atlas, &ahead);
    struct cone cone = mesh_scene_cone((double[]){0, 0, 0}, (double[]){0.2, 0.1, 5}, 30, 16);
    struct evidence evidence;
    mesh_scene_trace(&evidence, atlas, &cone);
    for (uint32_t pixel = 0; pixel < 256; pixel++) {
        assert_int_equal(evidence.object[pixel], 2);
    }
    evidence_finish(&evidence);
    conus_atlas_destroy(atlas);
}

static void the_lower_object_of_two_equal_surfaces_wins(void **test)
{
    (void)test;
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < 5; i++) {
        struct mesh square = square_at(i == 0 ? 2 : 3, i % 2);
        mesh_scene_add(atlas, &square);
    }
    struct cone cone = mesh_scene_cone((double[]){0, 0.3, 40}, (double[]){0, 0.3, 3}, 20, 24);
    assert_all(atlas, &cone, 2, 37);
    conus_atlas_destroy(atlas);
}

/* Half a millimetre between two surfaces at a distance of 100 m is more than single precision could tell from the
 * apex. */
static void far_contacts_are_exact(void **test)
{
    (void)test;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh back = square_at(3, false), front = square_at(3.001, false);
    mesh_scene_add(atlas, &back);
    mesh_scene_add(atlas, &front);
    struct cone cone = mesh_scene_cone((double[]){0.5, -0.5, 1e5}, (double[]){0.5, -0.5, 3}, 0.008, 16);
    double z = (double)atlas->meshes[1].positions[2];
    assert_all(atlas, &cone, 2, 1e5 - z);
    conus_atlas_destroy(atlas);
}

static conus_atlas *slab_of_voxels(void)
{
    static const uint32_t labels[8] = {7, 7, 7, 7, 7, 7, 7, 7};
    const double m[16] = {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, -5, -5, -5, 1};
    const conus_volume_info grid = scene_plain_grid((size_t[]){2, 2, 2}, m);
    return scene_parcellation(&grid, labels);
}

/* A block of voxels from -10 to 10 on every axis, and squares before, behind and on its face. */
static void meshes_and_volumes_are_merged_by_distance(void **test)
{
    (void)test;
    for (int place = 0; place < 3; place++) {
        conus_atlas *atlas = slab_of_voxels();
        struct mesh square = square_at(place == 0 ? 12 : place == 1 ? 8 : 10, false);
        mesh_scene_add(atlas, &square);
        struct cone cone = mesh_scene_cone((double[]){0.1, 0.2, 60}, (double[]){0.1, 0.2, 0}, 10, place == 2 ? 1 : 16);
        assert_all(atlas, &cone, place == 0 ? 2 : 1, place == 0 ? 48 : 50);
        conus_atlas_destroy(atlas);
    }
}

static void widths_answer_alike_and_sparse_blocks_too(void **test)
{
    (void)test;
    for (uint32_t n = 1; n < 40; n += 5) {
        conus_atlas *atlas = mesh_scene_atlas();
        struct mesh square = square_at(3, false);
        mesh_scene_add(atlas, &square);
        struct cone cone = mesh_scene_cone((double[]){0.1, 0.2, 30}, (double[]){0.1, 0.2, 3}, n % 2 ? 5 : 35, n);
        assert_all(atlas, &cone, 1, 27);
        conus_atlas_destroy(atlas);
    }
}

enum { PLACES = 5 };

/* The same torus at random places: as objects that share its triangles, and as an atlas of moved copies; the fourth
 * object is a copy, too. */
static void place_tori(uint64_t *random, const struct mesh *shape, double places[PLACES][16],
                       struct mesh_object objects[PLACES], conus_atlas *atlas)
{
    for (size_t i = 0; i < PLACES; i++) {
        conus_pose pose;
        double origin[3];
        random_point(random, origin, 40);
        assert_ok(conus_pose_toward(&pose, origin, (double[]){50, 60, 70}, NULL));
        memcpy(places[i], pose.world_from_device, sizeof places[i]);
        struct mesh moved = mesh_scene_torus(20, 8, 24, 12);
        mesh_transform(&moved, places[i]);
        mesh_scene_add(atlas, &moved);
        objects[i] = (struct mesh_object){shape, places[i]};
    }
    objects[3] = (struct mesh_object){atlas_object_mesh(atlas, 4), NULL};
}

/* Counts rays with equal hits, and rays that differ. */
static void compare_places(uint64_t *random, struct mesh_rays *placed, struct mesh_rays *moved, size_t *hits,
                           size_t *differ)
{
    double origin[3], direction[3][MESH_RAYS_LIMIT];
    struct mesh_bundle bundle = {.count = MESH_RAYS_LIMIT}, other;
    random_point(random, origin, 200);
    aim(random, &bundle, direction, origin, 50);
    other = bundle;
    unsigned width = widths[(size_t)test_random(random, 0, WIDTHS)];
    assert_ok(mesh_rays_trace(placed, &bundle, width));
    assert_ok(mesh_rays_trace(moved, &other, width));
    for (size_t ray = 0; ray < MESH_RAYS_LIMIT; ray++) {
        bool same = bundle.object[ray] == other.object[ray] && bundle.triangle[ray] == other.triangle[ray];
        *differ += !same;
        if (same && other.object[ray]) {
            *hits += 1;
            assert_near(bundle.t[ray], other.t[ray], 1e-3); /* moved vertices are rounded */
        }
    }
}

static void compare_places_of(const struct mesh_tracer *tracer)
{
    uint64_t random = 12;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh shape = mesh_scene_torus(20, 8, 24, 12);
    double places[PLACES][16];
    struct mesh_object objects[PLACES];
    place_tori(&random, &shape, places, objects, atlas);
    struct mesh_rays *placed = NULL;
    assert_ok(mesh_rays_create_with(&placed, tracer, objects, PLACES));
    struct mesh_rays *moved = mesh_rays_of(tracer, atlas);
    size_t hits = 0, differ = 0;
    for (int round = 0; round < 20; round++) {
        compare_places(&random, placed, moved, &hits, &differ);
    }
    assert_true(hits > 500 && differ <= 2);
    mesh_rays_destroy(placed);
    mesh_rays_destroy(moved);
    mesh_finish(&shape);
    conus_atlas_destroy(atlas);
}

static void a_placed_mesh_is_hit_as_if_it_were_moved(void **test)
{
    (void)test;
    for (int k = 0; k < TRACERS; k++) {
        compare_places_of(tracers[k]);
    }
}

static void a_place_without_inverse_is_refused(void **test)
{
    (void)test;
    const double flat[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    struct mesh square = square_at(0, false);
    const struct mesh_object object = {&square, flat};
    struct mesh_rays *rays = NULL;
    for (int k = 0; k < TRACERS; k++) {
        assert_fails(mesh_rays_create_with(&rays, tracers[k], &object, 1), CONUS_ERROR_ARGUMENT);
        assert_null(rays);
    }
    mesh_finish(&square);
}

static conus_status create_and_look(void *data)
{
    const conus_atlas *atlas = data;
    struct engine *engine = NULL;
    conus_status status = engine_rays_create(&engine, atlas, &(struct engine_options){0});
    struct evidence evidence = {0};
    status = status ? status : evidence_init(&evidence, 16);
    if (!status) {
        struct cone cone = mesh_scene_cone((double[]){0, 0, 60}, (double[]){0, 0, 0}, 10, 16);
        status = engine->functions->trace(engine, &evidence, &cone);
    }
    evidence_finish(&evidence);
    engine_destroy(engine);
    return status;
}

/* Two objects, of which the second is placed. */
static conus_status create_own(void *data)
{
    const struct mesh *mesh = data;
    double place[16];
    mat4_identity(place);
    const struct mesh_object objects[] = {{mesh, NULL}, {mesh, place}, {0}};
    struct mesh_rays *rays = NULL;
    conus_status status = mesh_rays_create_with(&rays, &mesh_bvh, objects, 3);
    mesh_rays_destroy(rays);
    return status;
}

static void every_failing_allocation_is_reported(void **test)
{
    (void)test;
    conus_atlas *atlas = slab_of_voxels();
    struct mesh square = square_at(12, false);
    mesh_scene_add(atlas, &square);
    test_every_allocation(create_and_look, atlas);
    test_every_allocation(create_own, (void *)atlas_object_mesh(atlas, 2));
    conus_atlas_destroy(atlas);
}

/* Eq. 9 has t >= 0: a surface through the apex is hit there. */
static void a_surface_through_the_apex_is_hit_at_0(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh box = mesh_scene_box((const double[]){-4, -4, 0}, (const double[]){4, 4, 8});
    mesh_scene_add(atlas, &box);
    struct cone cone = mesh_scene_cone((const double[]){1, 0.5, 0}, (const double[]){1, 0.5, 5}, 20, 4);
    struct evidence evidence = {0};
    mesh_scene_trace(&evidence, atlas, &cone);
    for (size_t pixel = 0; pixel < 16; pixel++) {
        assert_int_equal(evidence.object[pixel], 1);
        assert_true(evidence.distance[pixel] == 0);
        assert_in_range(evidence.voxel[pixel], 0, 1); /* mesh_scene_box()'s first two: the side at z = 0 */
    }
    evidence_finish(&evidence);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(mesh_rays)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_surface_through_the_apex_is_hit_at_0),
        cmocka_unit_test(finds_the_first_triangle_of_random_ones),
        cmocka_unit_test(finds_the_outermost_of_nested_spheres),
#if CONUS_EMBREE
        cmocka_unit_test(embree_and_the_own_tree_agree_on_the_brain),
#endif
        cmocka_unit_test(no_ray_slips_between_two_triangles),
        cmocka_unit_test(hardly_any_ray_slips_through_a_vertex),
        cmocka_unit_test(both_faces_count_and_open_surfaces_do),
        cmocka_unit_test(what_lies_behind_the_apex_is_not_hit),
        cmocka_unit_test(the_lower_object_of_two_equal_surfaces_wins),
        cmocka_unit_test(far_contacts_are_exact),
        cmocka_unit_test(meshes_and_volumes_are_merged_by_distance),
        cmocka_unit_test(widths_answer_alike_and_sparse_blocks_too),
        cmocka_unit_test(a_placed_mesh_is_hit_as_if_it_were_moved),
        cmocka_unit_test(a_place_without_inverse_is_refused),
        cmocka_unit_test(every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
