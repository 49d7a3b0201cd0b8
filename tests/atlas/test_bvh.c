/* SPDX-License-Identifier: BSD-3-Clause */
/* Trees of boxes: a search finds every box that a ray hits, each once. */
#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "test.h"

#include <string.h>

enum { LIMIT = 3000 };

struct scene {
    struct bvh_box boxes[LIMIT]; /* Box number k is boxes[k]: a tree gets a copy, which it reorders. */
    size_t count;
    struct bvh bvh;
};

static conus_status make_tree(void *data)
{
    struct scene *scene = data;
    struct bvh_box copy[LIMIT];
    memcpy(copy, scene->boxes, sizeof copy);
    scene->bvh = (struct bvh){0};
    return bvh_init(&scene->bvh, copy, scene->count);
}

static conus_status make_and_drop_tree(void *data)
{
    struct scene *scene = data;
    conus_status status = make_tree(scene);
    bvh_finish(&scene->bvh);
    return status;
}

/* Boxes within 10 mm of 0, each up to @p size mm long: some flat, some a point. */
static void fill(struct scene *scene, uint64_t *random, size_t count, double size)
{
    scene->count = count;
    for (size_t i = 0; i < count; i++) {
        scene->boxes[i] = bvh_box_empty((uint32_t)i);
        for (int corner = 0; corner < 2; corner++) {
            float p[3];
            for (int a = 0; a < 3; a++) {
                p[a] = corner ? scene->boxes[i].low[a] + (float)fmax(0, test_random(random, -size / 4, size))
                              : (float)test_random(random, -10, 10);
            }
            bvh_box_extend(&scene->boxes[i], p);
        }
    }
}

/* Whether a ray, at @p limit or before, comes so near to the middle of a box that it meets a ball inside the box: a
 * test without slabs that the box is surely hit. */
static bool is_surely_hit(const struct bvh_box *box, const double origin[3], const double direction[3], double limit)
{
    double to[3];
    double radius = INFINITY;
    for (int a = 0; a < 3; a++) {
        double low = (double)box->low[a];
        double high = (double)box->high[a];
        to[a] = (low + high) / 2 - origin[a];
        radius = fmin(radius, (high - low) / 2);
    }
    double t = fmin(fmax(vec3_dot(to, direction) / vec3_dot(direction, direction), 0), limit);
    vec3_add_scaled(to, to, -t, direction);
    return vec3_length(to) < radius;
}

static void count_found(unsigned char found[LIMIT], const struct scene *scene, const double origin[3],
                        const double direction[3], double limit)
{
    struct bvh_search search;
    memset(found, 0, LIMIT);
    bvh_search_init(&search, &scene->bvh, origin, direction);
    for (uint32_t number; bvh_search_next(&number, &search, limit);) {
        assert_true(number < scene->count);
        assert_int_equal(found[number]++, 0);
    }
}

/* A ray to the boxes, now and then along an axis, with zeros of either sign. */
static void random_ray(uint64_t *random, double origin[3], double direction[3])
{
    int kind = (int)test_random(random, 0, 12);
    for (int a = 0; a < 3; a++) {
        bool along = kind >= 6 || kind / 2 == a;
        origin[a] = along ? test_random(random, -20, 20) : test_random(random, -8, 8);
        direction[a] = along ? test_random(random, -8, 8) - origin[a] : kind % 2 ? -0.0 : 0.0;
    }
}

static void every_box_on_the_ray_is_found_once(void **state)
{
    (void)state;
    static struct scene scene;
    unsigned char found[LIMIT];
    uint64_t random = 21;
    size_t hits = 0;
    for (size_t round = 0; round < 400; round++) {
        fill(&scene, &random, round < 70 ? round : (size_t)test_random(&random, 1, LIMIT), round % 3 ? 2 : 12);
        assert_ok(make_tree(&scene));
        for (int ray = 0; ray < 20; ray++) {
            double origin[3], direction[3];
            random_ray(&random, origin, direction);
            double limit = ray % 2 ? INFINITY : test_random(&random, 0, 2);
            count_found(found, &scene, origin, direction, limit);
            for (size_t i = 0; i < scene.count; i++) {
                bool hit = is_surely_hit(&scene.boxes[i], origin, direction, limit);
                hits += hit;
                assert_true(!hit || found[i]);
            }
        }
        bvh_finish(&scene.bvh);
    }
    assert_true(hits > 10000);
}

/* Boxes of length 0, each hit by a ray that ends at it. */
static void boxes_that_are_points_are_found_too(void **state)
{
    (void)state;
    static struct scene scene;
    unsigned char found[LIMIT];
    uint64_t random = 22;
    fill(&scene, &random, 500, 0);
    assert_ok(make_tree(&scene));
    for (size_t i = 0; i < scene.count; i++) {
        double origin[3], direction[3], point[3];
        for (int a = 0; a < 3; a++) {
            origin[a] = test_random(&random, -20, 20);
            point[a] = (double)scene.boxes[i].low[a];
        }
        vec3_sub(direction, point, origin);
        count_found(found, &scene, origin, direction, 1 + 1e-9);
        assert_int_equal(found[i], 1);
    }
    bvh_finish(&scene.bvh);
}

/* All boxes lie in -10 .. 22 on every axis. */
static void boxes_out_of_reach_cost_nothing(void **state)
{
    (void)state;
    static struct scene scene;
    unsigned char found[LIMIT];
    const unsigned char none[LIMIT] = {0};
    uint64_t random = 23;
    fill(&scene, &random, 1000, 12);
    assert_ok(make_tree(&scene));
    count_found(found, &scene, (double[]){30, 0, 0}, (double[]){1, 0.1, 0}, INFINITY); /* away from them */
    assert_memory_equal(found, none, LIMIT);
    count_found(found, &scene, (double[]){0, 0, 50}, (double[]){1, 0, 0}, INFINITY); /* past them */
    assert_memory_equal(found, none, LIMIT);
    count_found(found, &scene, (double[]){0, 0, 50}, (double[]){0, 0, -1}, 27); /* 28 mm before the first */
    assert_memory_equal(found, none, LIMIT);
    bvh_finish(&scene.bvh);
}

static void an_empty_tree_has_nothing(void **state)
{
    (void)state;
    static struct scene scene;
    unsigned char found[LIMIT];
    scene.count = 0;
    assert_ok(make_tree(&scene));
    count_found(found, &scene, (double[]){0, 0, 0}, (double[]){1, 0, 0}, INFINITY);
    bvh_finish(&scene.bvh);
}

/* Halving at the median must end where all middles are equal. */
static void equal_boxes_are_all_found(void **state)
{
    (void)state;
    static struct scene scene;
    unsigned char found[LIMIT];
    scene.count = LIMIT;
    for (size_t i = 0; i < LIMIT; i++) {
        scene.boxes[i] = (struct bvh_box){{-1, -1, -1}, {1, 1, 1}, (uint32_t)i};
    }
    assert_ok(make_tree(&scene));
    count_found(found, &scene, (double[]){0, 0, 5}, (double[]){0, 0, -1}, INFINITY);
    for (size_t i = 0; i < LIMIT; i++) {
        assert_int_equal(found[i], 1);
    }
    bvh_finish(&scene.bvh);
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    static struct scene scene;
    uint64_t random = 24;
    fill(&scene, &random, 100, 2);
    test_every_allocation(make_and_drop_tree, &scene);
}

TEST_GROUP(bvh)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_box_on_the_ray_is_found_once), cmocka_unit_test(boxes_that_are_points_are_found_too),
        cmocka_unit_test(boxes_out_of_reach_cost_nothing),    cmocka_unit_test(an_empty_tree_has_nothing),
        cmocka_unit_test(equal_boxes_are_all_found),          cmocka_unit_test(every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
