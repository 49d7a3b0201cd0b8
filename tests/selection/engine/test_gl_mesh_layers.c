/* SPDX-License-Identifier: BSD-3-Clause */
/* All layers (Eq. 10) of meshes in the gl engine against those in the rays engine. */
#include "base/geometry/math3.h"
#include "conus/selection.h"
#include "gl_edge.h"
#include "gl_pair.h"
#include "mesh_scene.h"
#include "scene.h"
#include "test.h"

#include <stdio.h>

static void assert_agreement(const struct gl_counts *counts, size_t least)
{
    print_message("%zu intervals of %zu objects in pixels, %zu apart at edges, %zu in length, %zu hit by one engine\n",
                  counts->hits, counts->compared, counts->at_edges, counts->other_length, counts->other_object);
    assert_true(counts->compared >= least);
    assert_true(counts->at_edges <= 1 + counts->compared / 50); /* triangles may be as small as pixels */
    assert_true(counts->other_length <= 1 + counts->compared / 500);
    assert_true(counts->other_object <= 1 + counts->compared / 1000);
}

/* One pixel's intervals. */
struct stack {
    const conus_interval *intervals;
    size_t count;
};

static struct stack take_pixel(const struct layers *layers, size_t *at, size_t pixel)
{
    struct stack stack = {.intervals = layers->intervals + *at};
    while (*at < layers->count && layers->intervals[*at].pixel == pixel) {
        ++*at;
        stack.count++;
    }
    return stack;
}

/* The object's next interval from place *at on; NULL = none. */
static const conus_interval *next_of(const struct stack *stack, size_t *at, uint32_t object)
{
    while (*at < stack->count) {
        const conus_interval *interval = &stack->intervals[(*at)++];
        if (interval->object == object) {
            return interval;
        }
    }
    return NULL;
}

/* Whether both have the same intervals of the object, bit for bit. */
static bool are_same(const struct stack *got, const struct stack *wanted, uint32_t object)
{
    size_t i = 0, j = 0;
    for (;;) {
        const conus_interval *a = next_of(got, &i, object);
        const conus_interval *b = next_of(wanted, &j, object);
        if (!a || !b) {
            return a == b;
        }
        if (!gl_pair_same_interval(a, b)) {
            return false;
        }
    }
}

static bool has_object(const struct stack *stack, uint32_t object)
{
    size_t at = 0;
    return next_of(stack, &at, object) != NULL;
}

static double length_in(const struct stack *stack, uint32_t object)
{
    double length = 0;
    size_t at = 0;
    for (const conus_interval *interval; (interval = next_of(stack, &at, object));) {
        length += interval->exit - interval->entry;
    }
    return length;
}

/* Whether the lengths inside the object differ by more than a tenth of a pixel there. */
static bool is_other_length(const struct cone *cone, const struct stack *got, const struct stack *wanted,
                            const conus_interval *interval)
{
    double half = cone->radius > 0 ? cone->radius : tan(cone->angle / 2) * interval->exit;
    return fabs(length_in(got, interval->object) - length_in(wanted, interval->object)) >
           0.1 * 2 * half / cone->resolution;
}

/* Whether the driver may see another triangle of the object there, or none. */
static bool may_differ(const struct gl_pair *pair, const struct cone *cone, uint32_t object, size_t pixel)
{
    const struct mesh *mesh = atlas_object_mesh(pair->atlas, object);
    for (size_t triangle = 0; mesh && triangle < mesh->triangle_count; triangle++) {
        if (gl_edge_is_near(cone, mesh, triangle, pixel)) {
            return true;
        }
    }
    return false;
}

static void print_stack(const char *what, const struct stack *stack, uint32_t object)
{
    for (size_t i = 0; i < stack->count; i++) {
        const conus_interval *interval = &stack->intervals[i];
        if (interval->object == object) {
            print_message("%s %.17g to %.17g, triangle %llu\n", what, interval->entry, interval->exit,
                          (unsigned long long)interval->voxel);
        }
    }
}

static void compare_object(struct gl_pair *pair, const struct cone *cone, const struct stack *got,
                           const struct stack *wanted, const conus_interval *interval)
{
    pair->counts.compared++;
    if (are_same(got, wanted, interval->object)) {
        return;
    }
    if (!may_differ(pair, cone, interval->object, interval->pixel)) {
        print_stack("got", got, interval->object);
        print_stack("wanted", wanted, interval->object);
        fail_msg("pixel %u of %u x %u, %g degrees, %g mm, object %u", interval->pixel, cone->resolution,
                 cone->resolution, degrees_from_radians(cone->angle), cone->radius, interval->object);
    }
    pair->counts.at_edges++;
    pair->counts.other_length += is_other_length(cone, got, wanted, interval);
    pair->counts.other_object += has_object(got, interval->object) != has_object(wanted, interval->object);
}

/* Whether the object of the interval at `index` comes earlier in the stack. */
static bool is_known(const struct stack *stack, size_t index)
{
    const struct stack earlier = {stack->intervals, index};
    return has_object(&earlier, stack->intervals[index].object);
}

static void compare_layers(struct gl_pair *pair, const struct cone *cone)
{
    struct layers got = gl_pair_pierce(pair->gl, cone);
    struct layers wanted = gl_pair_pierce(pair->rays, cone);
    size_t i = 0, j = 0;
    for (size_t pixel = 0; pixel < (size_t)cone->resolution * cone->resolution; pixel++) {
        struct stack a = take_pixel(&got, &i, pixel);
        struct stack b = take_pixel(&wanted, &j, pixel);
        for (size_t k = 0; k < b.count; k++) {
            if (!is_known(&b, k)) {
                compare_object(pair, cone, &a, &b, &b.intervals[k]);
            }
        }
        for (size_t k = 0; k < a.count; k++) {
            if (!is_known(&a, k) && !has_object(&b, a.intervals[k].object)) {
                compare_object(pair, cone, &a, &b, &a.intervals[k]);
            }
        }
    }
    assert_int_equal(i, got.count);
    assert_int_equal(j, wanted.count);
    pair->counts.hits += wanted.count;
    layers_finish(&got);
    layers_finish(&wanted);
}

static void compare_100_poses(uint64_t *random, const conus_atlas *atlas, double size, size_t least)
{
    struct gl_counts counts = {0};
    gl_pair_compare_poses(&counts, random, atlas, compare_layers, size, 100, 4);
    assert_agreement(&counts, least);
}

static void nested_spheres(void **state)
{
    (void)state;
    uint64_t random = 81;
    conus_atlas *atlas = mesh_scene_nested();
    compare_100_poses(&random, atlas, 50, 80000);
    conus_atlas_destroy(atlas);
}

/* Surfaces that are open, cut each other and themselves. */
static void random_triangles(void **state)
{
    (void)state;
    uint64_t random = 82;
    struct gl_counts counts = {0};
    gl_pair_compare_triangles(&counts, &random, compare_layers, 30, 4);
    assert_agreement(&counts, 60000);
}

static void tori_in_rows(void **state)
{
    (void)state;
    uint64_t random = 83;
    enum { EDGE = 7 };
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < EDGE * EDGE * EDGE; i++) {
        const int at[3] = {i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE};
        double place[3], wxyz[4];
        conus_pose pose;
        for (int a = 0; a < 3; a++) {
            place[a] = 12.5 * (at[a] - 3);
        }
        for (int k = 0; k < 4; k++) {
            wxyz[k] = test_random(&random, -0.5, 0.5);
        }
        struct mesh torus = mesh_scene_torus(3.5, 1.5, 16, 16);
        assert_ok(conus_pose_from_quaternion(&pose, place, wxyz));
        mesh_transform(&torus, pose.world_from_device);
        mesh_scene_add(atlas, &torus);
    }
    compare_100_poses(&random, atlas, 44, 50000);
    conus_atlas_destroy(atlas);
}

static void one_hundred_poses_of_the_brain(void **state)
{
    (void)state;
    uint64_t random = 84;
    conus_atlas *atlas = mesh_scene_brain();
    compare_100_poses(&random, atlas, 60, 80000);
    conus_atlas_destroy(atlas);
}

static void meshes_among_voxels(void **state)
{
    (void)state;
    uint64_t random = 85;
    struct gl_counts counts = {0};
    gl_pair_compare_mixed(&counts, &random, compare_layers, 10);
    assert_agreement(&counts, 10000);
}

/* Julich-Brain's left areas, many of which share borders. */
static void one_hundred_poses_of_julich_brain(void **state)
{
    (void)state;
    uint64_t random = 86;
    const char *path = test_scratch("julich.atlas.json");
    const char *shared = test_shared("meshes/julich31-areas/lh");
    conus_atlas *atlas = NULL;
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "{\"conus_atlas\": 1, \"allow_outside\": true, \"space\": \"ras\", ");
    fprintf(file, "\"areas\": [{\"files\": \"%s/*.gii\"}]}\n", shared);
    assert_int_equal(fclose(file), 0);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    compare_100_poses(&random, atlas, 60, 20000);
    conus_atlas_destroy(atlas);
}

/* A cylinder among spheres behind it, around its apex and before it: nothing behind the plane of its apex is in it. */
static void nothing_behind_a_cylinder_is_in_it(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = -2; i <= 2; i++) {
        struct mesh sphere = mesh_scene_sphere((double[]){20 * i, 0, 0}, 8, 20, 40);
        mesh_scene_add(atlas, &sphere);
    }
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    struct cone cone = mesh_scene_cone((double[]){0, 0.123, 0.045}, (double[]){1, 0.123, 0.045}, 10, 16);
    cone.angle = 0;
    cone.radius = 1.5;
    compare_layers(&pair, &cone);
    struct layers layers = gl_pair_pierce(pair.gl, &cone);
    assert_int_equal(layers.count, 3 * 16 * 16);
    for (size_t i = 0; i < layers.count; i++) {
        const conus_interval *interval = &layers.intervals[i];
        assert_int_equal(interval->object, 3 + i % 3);
        assert_near(interval->entry, interval->object == 3 ? 0 : 20 * (interval->object - 3.0) - 7.75, 0.3);
        assert_near(interval->exit, 20 * (interval->object - 3.0) + 7.75, 0.3);
    }
    layers_finish(&layers);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

/* Far more triangles over a pixel than the list has room for at first. */
static void a_thousand_layers(void **state)
{
    (void)state;
    enum { LAYERS = 1000, N = 24 };
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < LAYERS; i++) {
        struct mesh sphere = mesh_scene_sphere((double[]){0, 0, 0}, 10 + 0.01 * i, 6, 8);
        mesh_scene_add(atlas, &sphere);
    }
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    struct cone cone = mesh_scene_cone((double[]){-50, 1.234, 2.345}, (double[]){0, 0.321, 0.123}, 6, N);
    compare_layers(&pair, &cone);
    assert_int_equal(pair.counts.hits, (size_t)LAYERS * N * N);
    assert_agreement(&pair.counts, (size_t)LAYERS * N * N);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < 3; i++) {
        struct mesh sphere = mesh_scene_sphere((double[]){0, 0, 0}, 10 + i, 8, 16);
        mesh_scene_add(atlas, &sphere);
    }
    struct cone cone = mesh_scene_cone((double[]){-50, 0, 0}, (double[]){0, 0, 0}, 30, 24);
    gl_pair_every_allocation(atlas, &cone, true);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(gl_mesh_layers)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nested_spheres),
        cmocka_unit_test(random_triangles),
        cmocka_unit_test(tori_in_rows),
        cmocka_unit_test(one_hundred_poses_of_the_brain),
        cmocka_unit_test(meshes_among_voxels),
        cmocka_unit_test(one_hundred_poses_of_julich_brain),
        cmocka_unit_test(nothing_behind_a_cylinder_is_in_it),
        cmocka_unit_test(a_thousand_layers),
        cmocka_unit_test(every_failing_allocation_is_reported),
        cmocka_unit_test(the_driver_was_silent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
