/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 18: rays through streamlines, by the tree and by a loop over all capsules. */
#include "atlas/tracts/tract_node.h"
#include "atlas/tracts/tractogram.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/engine/tracts/tract_rays.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS = 6000, STREAMLINES = 400, GROUPS = 4, RAYS = 64 };

/* Streamlines, and objects of them: all, or groups that overlap. */
struct scene {
    float points[3 * POINTS];
    uint16_t halves[3 * POINTS];
    uint64_t first[STREAMLINES + 1];
    uint32_t members[GROUPS][STREAMLINES];
    struct tract_group groups[GROUPS];
    struct tractogram tractogram;
    struct tract_object objects[GROUPS];
    size_t object_count;
};

static struct scene scene;
static double directions[3][TRACT_RAYS_LIMIT];

static void add_point(uint64_t *random, double size, double step)
{
    uint64_t at = scene.tractogram.point_count++;
    bool begins = at == scene.first[scene.tractogram.streamline_count];
    bool repeats = !begins && test_random(random, 0, 1) < 0.1;
    assert_true(at < POINTS);
    for (uint64_t a = 0; a < 3; a++) {
        float before = begins ? (float)test_random(random, -size, size) : scene.points[3 * (at - 1) + a];
        scene.points[3 * at + a] = begins || repeats ? before : before + (float)test_random(random, -step, step);
    }
}

/* Walks within about @p size mm of 0, with steps of up to @p step mm along each axis. One of ten streamlines has no
 * point and one has a single point; one of ten points repeats the one before it. */
static void fill(uint64_t *random, size_t streamlines, double size, double step, double radius)
{
    scene.tractogram = (struct tractogram){.points = scene.points, .first = scene.first, .radius = radius};
    for (size_t s = 0; s < streamlines; s++) {
        double kind = test_random(random, 0, 10);
        int count = kind < 1 ? 0 : kind < 2 ? 1 : (int)test_random(random, 2, 40);
        for (int i = 0; i < count && scene.tractogram.point_count < POINTS; i++) {
            add_point(random, size, step);
        }
        scene.first[++scene.tractogram.streamline_count] = scene.tractogram.point_count;
    }
}

/* The same points rounded to half precision, in both forms. */
static void round_to_halves(void)
{
    for (uint64_t i = 0; i < 3 * scene.tractogram.point_count; i++) { /* within 8 to 16, 1/128 apart */
        double fraction = fabs((double)scene.points[i]) * 128;
        scene.halves[i] = (uint16_t)(0x4800 + ((unsigned)fraction & 0x3ff) + (scene.points[i] < 0 ? 0x8000 : 0));
        scene.points[i] = (float)tract_from_half(scene.halves[i]);
    }
}

/* One object of all streamlines, or up to four groups: a streamline may be in several of them, or in none. */
static void choose_objects(uint64_t *random)
{
    bool all = test_random(random, 0, 2) < 1;
    scene.object_count = all ? 1 : GROUPS;
    for (uint32_t g = 0; g < scene.object_count; g++) {
        scene.groups[g] = (struct tract_group){.members = scene.members[g]};
        for (uint32_t s = 0; s < scene.tractogram.streamline_count; s++) {
            if (test_random(random, 0, 3) < 1) {
                scene.members[g][scene.groups[g].count++] = s;
            }
        }
        scene.objects[g] = (struct tract_object){&scene.tractogram, all ? NULL : &scene.groups[g], 3 + 2 * g};
    }
}

static bool is_in(const struct tract_object *object, uint32_t streamline)
{
    bool found = !object->group;
    for (size_t i = 0; object->group && i < object->group->count; i++) {
        found = found || object->group->members[i] == streamline;
    }
    return found;
}

/* Rays towards points of streamlines, or past them, from one origin @p away mm off. */
static struct tract_bundle random_rays(uint64_t *random, double origin[3], double size, double away)
{
    struct tract_bundle bundle = {
        .count = RAYS, .origin = origin, .direction = (const double(*)[TRACT_RAYS_LIMIT])directions};
    double out[3];
    do {
        for (int a = 0; a < 3; a++) {
            out[a] = test_random(random, -1, 1);
        }
    } while (!vec3_normalise(out, out));
    vec3_scale(origin, out, away);
    for (size_t ray = 0; ray < RAYS; ray++) {
        double direction[3];
        uint64_t target = (uint64_t)test_random(random, 0, (double)scene.tractogram.point_count);
        for (uint64_t a = 0; a < 3; a++) {
            double shift = test_random(random, 0, 2) < 1 ? 0 : test_random(random, -size, size) / 10;
            direction[a] = (double)scene.points[3 * target + a] + shift - origin[a];
        }
        if (ray < 3 || !vec3_normalise(direction, direction)) { /* along the axes, with zeros */
            memset(direction, 0, sizeof direction);
            direction[ray % 3] = origin[ray % 3] > 0 ? -1 : 1;
        }
        for (int a = 0; a < 3; a++) {
            directions[a][ray] = direction[a];
        }
        bundle.t[ray] = ray % 8 == 7 ? away : INFINITY; /* the hit of a volume, of object 4 */
        bundle.object[ray] = ray % 8 == 7 ? 4 : 0;
        bundle.point[ray] = ray % 8 == 7 ? 12345 : UINT64_MAX;
    }
    return bundle;
}

/* Segment number k of a streamline: a point without a next one is a segment only if it is the only point. */
static bool segment_of(double interval[2], const struct tract_bundle *bundle, size_t ray, uint64_t from, uint64_t to,
                       uint64_t at)
{
    double direction[3] = {directions[0][ray], directions[1][ray], directions[2][ray]};
    double a[3];
    double b[3];
    if (at + 1 == to && to > from + 1) {
        return false;
    }
    tractogram_point(a, &scene.tractogram, at);
    tractogram_point(b, &scene.tractogram, at + 1 < to ? at + 1 : at);
    return capsule_interval(interval, bundle->origin, direction, a, b, scene.tractogram.radius) && interval[1] >= 0;
}

/* Objects and points come in ascending order, so the first of equals stays. */
static void keep_nearer(struct tract_bundle *bundle, size_t ray, double t, uint32_t number, uint64_t at)
{
    if (t < bundle->t[ray] || (t == bundle->t[ray] && number < bundle->object[ray])) {
        bundle->t[ray] = t;
        bundle->object[ray] = number;
        bundle->point[ray] = at;
    }
}

static void loop_hits(struct tract_bundle *bundle, size_t ray, const struct tract_object *object)
{
    for (uint32_t s = 0; s < scene.tractogram.streamline_count; s++) {
        for (uint64_t at = scene.first[s]; is_in(object, s) && at < scene.first[s + 1]; at++) {
            double interval[2];
            if (segment_of(interval, bundle, ray, scene.first[s], scene.first[s + 1], at)) {
                keep_nearer(bundle, ray, fmax(interval[0], 0), object->number, at);
            }
        }
    }
}

/* A place where the ray enters or leaves a capsule. */
struct event {
    double t;
    int step; /* 1 or -1 */
    uint64_t point;
};

/* By t, entries before exits, then by the point. */
static int compare_events(const void *a, const void *b)
{
    const struct event *one = a;
    const struct event *other = b;
    if (one->t != other->t) {
        return one->t < other->t ? -1 : 1;
    }
    return one->step != other->step ? other->step - one->step : one->point < other->point ? -1 : 1;
}

static size_t events_of(struct event *out, const struct tract_bundle *bundle, size_t ray,
                        const struct tract_object *object)
{
    size_t count = 0;
    for (uint32_t s = 0; s < scene.tractogram.streamline_count; s++) {
        for (uint64_t at = scene.first[s]; is_in(object, s) && at < scene.first[s + 1]; at++) {
            double interval[2];
            if (segment_of(interval, bundle, ray, scene.first[s], scene.first[s + 1], at)) {
                out[count++] = (struct event){fmax(interval[0], 0), 1, at};
                out[count++] = (struct event){interval[1], -1, at};
            }
        }
    }
    qsort(out, count, sizeof *out, compare_events);
    return count;
}

/* The intervals between the places where the number of capsules around the ray rises from 0 and falls back to 0. */
static size_t loop_intervals(conus_interval *out, const struct tract_bundle *bundle, size_t ray,
                             const struct tract_object *object)
{
    static struct event events[2 * POINTS];
    size_t events_count = events_of(events, bundle, ray, object);
    size_t count = 0;
    int depth = 0;
    for (size_t i = 0; i < events_count; i++) {
        if (depth == 0) {
            out[count] = (conus_interval){(uint32_t)(1000 + ray), object->number, events[i].t, 0, events[i].point};
        }
        depth += events[i].step;
        if (depth == 0) {
            out[count++].exit = events[i].t;
        }
    }
    return count;
}

static size_t compare_hits(const struct tract_rays *rays, const struct tract_bundle *bundle)
{
    size_t hits = 0;
    struct tract_bundle got = *bundle;
    struct tract_bundle wanted = *bundle;
    tract_rays_trace(rays, &got);
    for (size_t ray = 0; ray < bundle->count; ray++) {
        for (size_t g = 0; g < scene.object_count; g++) {
            loop_hits(&wanted, ray, &scene.objects[g]);
        }
        assert_true(got.t[ray] == wanted.t[ray]);
        assert_int_equal(got.object[ray], wanted.object[ray]);
        assert_true(got.point[ray] == wanted.point[ray]);
        hits += got.object[ray] != 0 && got.point[ray] != 12345;
    }
    return hits;
}

static size_t compare_intervals(const struct tract_rays *rays, const struct tract_bundle *bundle)
{
    static conus_interval wanted[POINTS];
    struct layers layers = {0};
    size_t pixels[RAYS];
    size_t at = 0;
    for (size_t ray = 0; ray < RAYS; ray++) {
        pixels[ray] = 1000 + ray;
    }
    assert_ok(tract_rays_pierce(rays, bundle, &layers, pixels));
    for (size_t ray = 0; ray < bundle->count; ray++) {
        for (size_t g = 0; g < scene.object_count; g++) {
            size_t count = loop_intervals(wanted, bundle, ray, &scene.objects[g]);
            for (size_t i = 0; i < count; i++, at++) {
                const conus_interval *got = &layers.intervals[at];
                assert_true(at < layers.count);
                assert_true(got->pixel == wanted[i].pixel && got->object == wanted[i].object);
                assert_true(got->entry == wanted[i].entry && got->exit == wanted[i].exit);
                assert_true(got->voxel == wanted[i].voxel);
            }
        }
    }
    assert_int_equal(at, layers.count);
    layers_finish(&layers);
    return at;
}

struct counts {
    size_t hits, intervals;
};

/* With every kernel, from a far, a near and an inner origin. */
static void compare_scene(struct counts *counts, uint64_t *random, double size)
{
    static const double away[] = {1e5, 3, 0.4};
    for (size_t i = 0; i < sizeof away / sizeof away[0]; i++) {
        double origin[3];
        struct tract_bundle bundle = random_rays(random, origin, size, i ? size * away[i] : away[i]);
        for (size_t k = 0; k < TRACT_SEARCH_KERNELS; k++) {
            struct tract_rays *rays;
            if (tract_search_kernel(k)) {
                assert_ok(tract_rays_create_with(&rays, tract_search_kernel(k), scene.objects, scene.object_count));
                counts->hits += compare_hits(rays, &bundle);
                counts->intervals += compare_intervals(rays, &bundle);
                tract_rays_destroy(rays);
            }
        }
    }
}

/* The point of a leaf's runs that is farthest along a direction. */
static void find_farthest(double out[3], size_t leaf, const double along[3])
{
    double most = -INFINITY;
    const struct tractogram *tractogram = &scene.tractogram;
    for (size_t r = leaf * TRACT_LEAF; r < (leaf + 1) * TRACT_LEAF && r < tractogram->tree.run_count; r++) {
        struct tract_run run = tract_run_at(tractogram, r);
        for (uint64_t k = 0; k <= run.segments; k++) {
            double point[3];
            tractogram_point(point, tractogram, run.point + k);
            if (vec3_dot(point, along) > most) {
                most = vec3_dot(point, along);
                memcpy(out, point, sizeof point);
            }
        }
    }
}

/* One ray, perpendicular to @p along, that just touches the ball around a point. */
static struct tract_bundle touching_ray(uint64_t *random, double origin[3], const double point[3],
                                        const double along[3])
{
    double across[3];
    double direction[3];
    for (int a = 0; a < 3; a++) {
        across[a] = test_random(random, -1, 1);
    }
    vec3_cross(direction, along, across);
    assert_true(vec3_normalise(direction, direction));
    vec3_add_scaled(origin, point, scene.tractogram.radius * (1 - 1e-6), along);
    vec3_add_scaled(origin, origin, -test_random(random, 1, 50), direction);
    for (int a = 0; a < 3; a++) {
        directions[a][0] = direction[a];
    }
    return (struct tract_bundle){.count = 1,
                                 .origin = origin,
                                 .direction = (const double(*)[TRACT_RAYS_LIMIT])directions,
                                 .t = {INFINITY},
                                 .point = {UINT64_MAX}};
}

/* Returns the number of rays. */
static size_t touch_all_leaves(struct counts *counts, uint64_t *random, const struct tract_rays *rays,
                               const double along[3])
{
    size_t leaves = tract_leaf_count(scene.tractogram.tree.run_count);
    for (size_t leaf = 0; leaf < leaves; leaf++) {
        double point[3] = {0};
        double origin[3];
        find_farthest(point, leaf, along);
        struct tract_bundle bundle = touching_ray(random, origin, point, along);
        counts->hits += compare_hits(rays, &bundle);
        counts->intervals += compare_intervals(rays, &bundle);
    }
    return leaves;
}

/* The tree gives the same as the loop, to the bit: hits, objects, points and intervals. */
static void rays_find_what_a_loop_finds(void **state)
{
    (void)state;
    static const struct {
        size_t streamlines;
        double size, step, radius;
    } scenes[] = {{0, 10, 1, 0.5},    {1, 10, 1, 0.5},         {3, 10, 1, 0.5},   {100, 10, 1, 0.5},
                  {100, 20, 1, 0.01}, {100, 50, 3, 1e-6},      {100, 5, 10, 0.1}, {100, 10, 1, 100},
                  {20, 1000, 90, 30}, {100, 0.01, 1e-3, 5e-4}, {100, 10, 0, 0.5}, {100, 1e6, 1e4, 50},
                  {30, 1e9, 1e8, 0.5}};
    uint64_t random = 5;
    struct counts counts = {0};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        fill(&random, scenes[i].streamlines, scenes[i].size, scenes[i].step, scenes[i].radius);
        choose_objects(&random);
        assert_ok(tractogram_grow_tree(&scene.tractogram));
        compare_scene(&counts, &random, scenes[i].size);
        tract_tree_finish(&scene.tractogram.tree);
    }
    print_message("%zu hits, %zu intervals\n", counts.hits, counts.intervals);
    assert_true(counts.hits > 500 && counts.intervals > 1500);
}

/* Leaves are cut along axes and diagonals; a ray that just touches a point at a cut hits. */
static void touched_points_are_hit(void **state)
{
    (void)state;
    uint64_t random = 8;
    struct counts counts = {0};
    size_t rays_count = 0;
    fill(&random, 100, 10, 1, 0.5);
    scene.object_count = 1;
    scene.objects[0] = (struct tract_object){&scene.tractogram, NULL, 3};
    assert_ok(tractogram_grow_tree(&scene.tractogram));
    for (size_t k = 0; k < TRACT_SEARCH_KERNELS; k++) {
        struct tract_rays *rays;
        if (tract_search_kernel(k)) {
            assert_ok(tract_rays_create_with(&rays, tract_search_kernel(k), scene.objects, 1));
            for (int i = 0; i < 27; i++) { /* axes and diagonals, of boxes and of their sides */
                int way[3] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
                double along[3] = {way[0], way[1], way[2]};
                rays_count += vec3_normalise(along, along) ? touch_all_leaves(&counts, &random, rays, along) : 0;
            }
            tract_rays_destroy(rays);
        }
    }
    assert_true(rays_count >= 500);
    assert_int_equal(counts.hits, rays_count);
    tract_tree_finish(&scene.tractogram.tree);
}

static void halves_are_hit_as_their_floats(void **state)
{
    (void)state;
    uint64_t random = 6;
    struct counts counts = {0};
    fill(&random, 100, 10, 1, 0.5);
    round_to_halves();
    scene.tractogram.points = NULL;
    scene.tractogram.halves = scene.halves;
    choose_objects(&random);
    assert_ok(tractogram_grow_tree(&scene.tractogram));
    compare_scene(&counts, &random, 10);
    assert_true(counts.hits > 50);
    tract_tree_finish(&scene.tractogram.tree);
}

/* A straight streamline along x from 0 to 10 of radius 1, and one across it. Seen from -z the two are equally near
 * where they cross, at (5, 0, 0): the lower object is hit, and within one object the lower point. From inside t is
 * 0. */
static void equally_near_ones_have_an_order(void **state)
{
    (void)state;
    static const float points[] = {0, 0, 0, 10, 0, 0, 5, -5, 0, 5, 5, 0, 5, -5, 0, 5, 5, 0};
    static const uint64_t first[] = {0, 2, 4, 6};
    static uint32_t members[3] = {0, 1, 2};
    struct tract_group groups[3] = {{NULL, members, 1}, {NULL, members + 1, 1}, {NULL, members, 3}};
    scene.tractogram = (struct tractogram){.points = scene.points, .first = scene.first, .radius = 1};
    scene.tractogram.streamline_count = 3;
    scene.tractogram.point_count = 6;
    memcpy(scene.points, points, sizeof points);
    memcpy(scene.first, first, sizeof first);
    assert_ok(tractogram_grow_tree(&scene.tractogram));
    static const struct {
        int groups[3]; /* Which are objects 1, 2 and 3; -1 = none. */
        double z;
        uint32_t object;
        uint64_t point;
        double t;
    } cases[] = {{{0, 1, -1}, -7, 1, 0, 6}, {{1, 0, -1}, -7, 1, 2, 6},  {{2, 0, 1}, -7, 1, 0, 6},
                 {{1, 2, -1}, -7, 1, 2, 6}, {{1, -1, 2}, 0.5, 1, 2, 0}, {{-1, 1, 0}, 0.5, 2, 2, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct tract_object objects[3];
        size_t count = 0;
        for (uint32_t k = 0; k < 3; k++) {
            if (cases[i].groups[k] >= 0) {
                objects[count++] = (struct tract_object){&scene.tractogram, &groups[cases[i].groups[k]], k + 1};
            }
        }
        double origin[3] = {5, 0, cases[i].z};
        struct tract_bundle bundle = {
            .count = 1, .origin = origin, .direction = (const double(*)[TRACT_RAYS_LIMIT])directions, .t = {INFINITY}};
        struct tract_rays *rays;
        directions[0][0] = directions[1][0] = 0;
        directions[2][0] = 1;
        assert_ok(tract_rays_create(&rays, objects, count));
        tract_rays_trace(rays, &bundle);
        assert_true(bundle.t[0] == cases[i].t);
        assert_int_equal(bundle.object[0], cases[i].object);
        assert_true(bundle.point[0] == cases[i].point);
        tract_rays_destroy(rays);
    }
    tract_tree_finish(&scene.tractogram.tree);
}

/* Balls of radius 1 round (0, 0, 0), (0, 0, 2) and (0, 0, 5), seen from 7 mm before the first: from 6 to 8 mm, from 8
 * to 10, and from 11 to 13. The first two touch, so they are one. */
static void touching_tubes_are_one_interval(void **state)
{
    (void)state;
    static const float points[] = {0, 0, 2, 0, 0, 0, 0, 0, 5};
    static const uint64_t first[] = {0, 1, 2, 3};
    static const size_t pixel = 9;
    double origin[3] = {0, 0, -7};
    struct tract_bundle bundle = {.count = 1, .origin = origin};
    struct tract_rays *rays;
    struct layers layers = {0};
    scene.tractogram = (struct tractogram){.points = scene.points, .first = scene.first, .radius = 1};
    scene.tractogram.streamline_count = scene.tractogram.point_count = 3;
    memcpy(scene.points, points, sizeof points);
    memcpy(scene.first, first, sizeof first);
    directions[0][0] = directions[1][0] = 0;
    directions[2][0] = 1;
    bundle.direction = (const double(*)[TRACT_RAYS_LIMIT])directions;
    assert_ok(tractogram_grow_tree(&scene.tractogram));
    assert_ok(tract_rays_create(&rays, &(struct tract_object){&scene.tractogram, NULL, 4}, 1));
    assert_ok(tract_rays_pierce(rays, &bundle, &layers, &pixel));
    assert_int_equal(layers.count, 2);
    assert_true(layers.intervals[0].entry == 6 && layers.intervals[0].exit == 10 && layers.intervals[0].voxel == 1);
    assert_true(layers.intervals[1].entry == 11 && layers.intervals[1].exit == 13 && layers.intervals[1].voxel == 2);
    assert_true(layers.intervals[0].pixel == 9 && layers.intervals[0].object == 4);
    layers_finish(&layers);
    tract_rays_destroy(rays);
    tract_tree_finish(&scene.tractogram.tree);
}

static conus_status create_and_pierce(void *data)
{
    const struct tract_bundle *bundle = data;
    struct tract_rays *rays;
    struct layers layers = {0};
    size_t pixels[RAYS] = {0};
    conus_status status = tract_rays_create(&rays, scene.objects, scene.object_count);
    if (!status) {
        status = tract_rays_pierce(rays, bundle, &layers, pixels);
        layers_finish(&layers);
        tract_rays_destroy(rays);
    }
    return status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    uint64_t random = 7;
    double origin[3];
    fill(&random, 100, 10, 1, 0.5);
    do {
        choose_objects(&random);
    } while (scene.object_count == 1);
    assert_ok(tractogram_grow_tree(&scene.tractogram));
    struct tract_bundle bundle = random_rays(&random, origin, 10, 30);
    test_every_allocation(create_and_pierce, &bundle);
    tract_tree_finish(&scene.tractogram.tree);
}

TEST_GROUP(tract_rays)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_find_what_a_loop_finds),     cmocka_unit_test(halves_are_hit_as_their_floats),
        cmocka_unit_test(equally_near_ones_have_an_order), cmocka_unit_test(touching_tubes_are_one_interval),
        cmocka_unit_test(touched_points_are_hit),          cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
