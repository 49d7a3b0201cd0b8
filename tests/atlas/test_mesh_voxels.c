/* SPDX-License-Identifier: BSD-3-Clause */
/* The inside of meshes voxel by voxel (Eq. 16): boxes against polyhedra cut by planes, and sums against volumes. */
#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "mesh_scene.h"
#include "test.h"

#include <math.h>

/* Part of the cuboid `box`, taken to index coordinates, that is in a voxel. */
static double part_of_voxel(struct convex_stack *stack, const struct convex *box, const double m[16],
                            const size_t at[3])
{
    struct convex part;
    stack->count = 0;
    assert_true(convex_move(&part, stack, box, m));
    for (int side = 0; side < 6; side++) {
        int a = side / 2;
        double plane = (double)at[a] + (side % 2 ? 0.5 : -0.5);
        bool above = side % 2 == 0;
        if (above ? part.high[a] <= plane : part.low[a] >= plane) {
            return 0;
        }
        if (part.low[a] < plane && part.high[a] > plane) {
            assert_true(convex_cut(&part, stack, &part, a, plane, above));
        }
    }
    return part.volume;
}

/* The measured part in a voxel; 0 outside of the box. */
static double inside(const struct voxel_box *voxels, const size_t at[3])
{
    bool there = voxels->inside != NULL;
    size_t index = 0;
    for (int a = 2; a >= 0; a--) {
        there = there && at[a] >= voxels->low[a] && at[a] <= voxels->high[a];
        index = index * voxels->count[a] + at[a] - voxels->low[a];
    }
    return there ? voxels->inside[index] : 0;
}

static void compare(const struct mesh *mesh, const struct convex *box, const double m[16], const size_t low[3],
                    const size_t high[3])
{
    struct convex_stack stack = {0};
    struct voxel_box voxels = {.low = {low[0], low[1], low[2]}, .high = {high[0], high[1], high[2]}};
    const size_t count[3] = {high[0] - low[0] + 1, high[1] - low[1] + 1, high[2] - low[2] + 1};
    assert_ok(mesh_voxels_measure(&voxels, mesh, m));
    for (size_t i = 0; i < count[0] * count[1] * count[2]; i++) {
        const size_t at[3] = {low[0] + i % count[0], low[1] + i / count[0] % count[1],
                              low[2] + i / count[0] / count[1]};
        assert_near(inside(&voxels, at), part_of_voxel(&stack, box, m, at), 1e-10);
    }
    memory_free(voxels.inside);
    convex_finish(&stack);
}

/* Boxes within, across and beyond the voxels, oblique ones, and some whose faces are borders of voxels. */
static void boxes_are_as_cut_polyhedra(void **state)
{
    (void)state;
    uint64_t seed = 9;
    const size_t low[3] = {2, 1, 3};
    const size_t high[3] = {6, 7, 6};
    for (int turn = 0; turn < 200; turn++) {
        double m[16] = {[0] = 1, [5] = 1, [10] = 1, [15] = 1};
        double ends[2][3];
        for (int a = 0; a < 3; a++) {
            ends[0][a] = floor(test_random(&seed, -8, 32)) / 4;
            ends[1][a] = ends[0][a] + floor(test_random(&seed, 1, 24)) / 4;
        }
        for (int i = 0; turn % 3 && i < 12; i++) {
            m[i + i / 3] += test_random(&seed, -0.6, 0.6);
        }
        if (turn % 2) {
            m[0] = -m[0], m[12] += 8; /* its triangles then face inwards */
        }
        struct mesh mesh = mesh_scene_box(ends[0], ends[1]);
        struct convex box = convex_box(ends[0], ends[1]);
        compare(&mesh, &box, m, low, high);
        mesh_finish(&mesh);
    }
}

/* Voxels that hold all of a ball sum to what its triangles enclose. */
static void parts_of_a_ball_sum_to_it(void **state)
{
    (void)state;
    const double m[16] = {
        [0] = 0.8, [1] = 0.3, [4] = -0.2, [5] = 0.9, [6] = 0.1, [10] = -1.1, [12] = 9, [13] = 9, [14] = 9, [15] = 1};
    struct mesh ball = mesh_scene_sphere((const double[]){0.1, 0.2, 0.3}, 5, 20, 30);
    struct voxel_box voxels = {.high = {19, 19, 19}};
    double sum = 0;
    double volume = 0;
    assert_ok(mesh_voxels_measure(&voxels, &ball, m));
    for (size_t i = 0; i < voxels.count[0] * voxels.count[1] * voxels.count[2]; i++) {
        assert_true(voxels.inside[i] > -1e-12 && voxels.inside[i] < 1 + 1e-12);
        sum += voxels.inside[i];
    }
    for (size_t i = 0; i < ball.triangle_count; i++) {
        double p[3][3];
        double cross[3];
        for (size_t k = 0; k < 3; k++) {
            for (size_t a = 0; a < 3; a++) {
                p[k][a] = (double)ball.positions[3 * (size_t)ball.triangles[3 * i + k] + a];
            }
        }
        vec3_cross(cross, p[1], p[2]);
        volume += vec3_dot(p[0], cross) / 6;
    }
    assert_near(sum, fabs(volume * mat4_determinant3(m)), 1e-9);
    memory_free(voxels.inside);
    mesh_finish(&ball);
}

static conus_status measure_box(void *data)
{
    const double m[16] = {[0] = 1, [5] = 1, [10] = 1, [15] = 1};
    struct voxel_box voxels = {.high = {3, 3, 3}};
    conus_status status = mesh_voxels_measure(&voxels, data, m);
    memory_free(voxels.inside);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    struct mesh mesh = mesh_scene_box((const double[]){0, 0, 0}, (const double[]){2, 2, 2});
    test_every_allocation(measure_box, &mesh);
    mesh_finish(&mesh);
}

TEST_GROUP(mesh_voxels)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_are_as_cut_polyhedra),
        cmocka_unit_test(parts_of_a_ball_sum_to_it),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
