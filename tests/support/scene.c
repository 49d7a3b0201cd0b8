/* SPDX-License-Identifier: BSD-3-Clause */
/* Random small atlases and poses. */
#include "scene.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "made_atlas.h"
#include "test.h"
#include "value_maps.h"

#include <string.h>

static size_t random_index(uint64_t *state, size_t count)
{
    return (size_t)test_random(state, 0, (double)count);
}

static void random_vector(uint64_t *state, double out[3], double size)
{
    for (int a = 0; a < 3; a++) {
        out[a] = test_random(state, -size, size);
    }
}

static void random_linear(uint64_t *state, double m[16])
{
    mat4_identity(m);
    bool plain = test_random(state, 0, 1) < 0.3;
    for (int column = 0; column < 3; column++) {
        double size = plain ? 1 + (double)random_index(state, 2) : test_random(state, 0.4, 3);
        m[5 * column] = test_random(state, 0, 1) < 0.5 ? size : -size;
        for (int row = 0; row < 3 && !plain; row++) {
            m[4 * column + row] += test_random(state, -0.3, 0.3) * size;
        }
    }
}

conus_volume_info scene_plain_grid(const size_t dim[3], const double world_from_voxel[16])
{
    conus_volume_info info = {
        .role = CONUS_ROLE_PARCELLATION, .path = "scene", .dim = {dim[0], dim[1], dim[2]}, .slope = 1};
    double identity[16];
    mat4_identity(identity);
    assert_ok(space_describe(&info, world_from_voxel ? world_from_voxel : identity, "scene"));
    return info;
}

conus_volume_info scene_grid(uint64_t *state, const size_t dim[3])
{
    double m[16];
    random_linear(state, m);
    double centre[3] = {0.5 * (double)(dim[0] - 1), 0.5 * (double)(dim[1] - 1), 0.5 * (double)(dim[2] - 1)};
    mat4_direction(centre, m, centre);
    for (int a = 0; a < 3; a++) {
        m[12 + a] = -floor(centre[a]) + (double)random_index(state, 3);
    }
    return scene_plain_grid(dim, m);
}

conus_atlas *scene_parcellation(const conus_volume_info *grid, const uint32_t *labels)
{
    struct label_table table = {0};
    struct notes notes = {0};
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create(&atlas, grid, labels, &table, "scene", &notes));
    notes_finish(&notes);
    return atlas;
}

static size_t voxels_of(const size_t dim[3])
{
    return dim[0] * dim[1] * dim[2];
}

static void random_dim(uint64_t *state, size_t dim[3], size_t limit)
{
    for (int a = 0; a < 3; a++) {
        dim[a] = test_random(state, 0, 1) < 0.15 ? 1 : 1 + random_index(state, limit);
    }
}

/* Boxes of labels 1 to 6 and single voxels, from almost nothing to full. */
static void paint(uint64_t *state, uint32_t *labels, const size_t dim[3])
{
    size_t count = voxels_of(dim);
    for (size_t box = random_index(state, 4); box > 0; box--) {
        size_t low[3], high[3];
        for (int a = 0; a < 3; a++) {
            low[a] = random_index(state, dim[a]);
            high[a] = low[a] + random_index(state, dim[a] / 3 + 1);
        }
        uint32_t label = 1 + (uint32_t)random_index(state, 6);
        for (size_t v = 0; v < count; v++) {
            size_t i = v % dim[0], j = v / dim[0] % dim[1], k = v / dim[0] / dim[1];
            if (i >= low[0] && i <= high[0] && j >= low[1] && j <= high[1] && k >= low[2] && k <= high[2]) {
                labels[v] = label;
            }
        }
    }
    size_t specks = (size_t)((double)count * pow(10, test_random(state, -5, 0)));
    for (size_t speck = 0; speck <= specks; speck++) {
        labels[random_index(state, count)] = (uint32_t)random_index(state, 7);
    }
}

static float *random_values(uint64_t *state, const size_t dim[3])
{
    size_t count = voxels_of(dim);
    float *values = memory_raw(count, sizeof *values);
    assert_non_null(values);
    for (size_t v = 0; v < count; v++) {
        values[v] = (float)test_random(state, 0, 1);
    }
    return values;
}

static void add_pathway(uint64_t *state, conus_atlas *atlas, size_t dim_limit)
{
    size_t dim[3];
    random_dim(state, dim, dim_limit);
    bool same = test_random(state, 0, 1) < 0.5; /* on the parcellation's own grid: contacts at equal distances */
    conus_volume_info info = same ? atlas->volumes[0].info : scene_grid(state, dim);
    info.role = CONUS_ROLE_SCALAR;
    info.threshold = test_random(state, 0.5, 0.999);
    assert_ok(pathway_of_values(atlas, &info, random_values(state, info.dim), "tract"));
}

void scene_add_blockers(conus_atlas *atlas, uint64_t *state, const size_t dim[3], double share)
{
    conus_volume_info info = scene_grid(state, dim);
    info.role = CONUS_ROLE_CONTEXT;
    info.threshold = 1 - share;
    assert_ok(atlas_set_context(atlas, &info, random_values(state, dim)));
}

conus_atlas *scene_atlas(uint64_t *state, size_t dim_limit, int pathways)
{
    size_t dim[3];
    random_dim(state, dim, dim_limit);
    conus_volume_info info = scene_grid(state, dim);
    uint32_t *labels = memory_zeroed(voxels_of(dim), sizeof *labels);
    assert_non_null(labels);
    paint(state, labels, dim);
    conus_atlas *atlas = scene_parcellation(&info, labels);
    memory_free(labels);
    for (int i = 0; i < pathways; i++) {
        add_pathway(state, atlas, dim_limit);
    }
    return atlas;
}

void scene_voxel(double out[3], const struct volume *volume, size_t voxel)
{
    const size_t *dim = volume->info.dim;
    size_t i = voxel % dim[0];
    size_t j = voxel / dim[0] % dim[1];
    size_t k = voxel / dim[0] / dim[1];
    mat4_point(out, volume->info.world_from_voxel, (double[]){(double)i, (double)j, (double)k});
}

/* A point of the first volume's grid, in index space; often exactly on faces of cells, or their centres. */
static void grid_point(uint64_t *state, const conus_volume_info *info, double out[3])
{
    bool exact = test_random(state, 0, 1) < 0.4;
    for (int a = 0; a < 3; a++) {
        double x = test_random(state, -1, (double)info->dim[a] + 1);
        out[a] = exact ? floor(2 * x) / 2 : x;
    }
}

static conus_pose looking(const double origin[3], const double direction[3])
{
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, origin, direction, NULL));
    return pose;
}

conus_pose scene_pose(uint64_t *state, const conus_atlas *atlas)
{
    const conus_volume_info *info = &atlas->volumes[0].info;
    double origin[3], target[3], direction[3];
    grid_point(state, info, origin);
    grid_point(state, info, target);
    mat4_point(origin, info->world_from_voxel, origin);
    mat4_point(target, info->world_from_voxel, target);
    random_vector(state, direction, 1);
    if (test_random(state, 0, 1) < 0.3) {
        size_t axis = random_index(state, 3);
        memcpy(direction, info->world_from_voxel + 4 * axis, sizeof direction);
    }
    double kind = test_random(state, 0, 1);
    double away = kind < 0.35 ? 0 : kind < 0.9 ? test_random(state, 1, 200) : 1e5;
    if (away > 0) { /* outside, looking back at the target */
        vec3_add_scaled(origin, target, -away / vec3_length(direction), direction);
    }
    return looking(origin, direction);
}

conus_pose scene_generic_pose(uint64_t *state, const conus_atlas *atlas)
{
    const conus_volume_info *info = &atlas->volumes[0].info;
    double target[3], direction[3];
    for (int a = 0; a < 3; a++) {
        target[a] = test_random(state, 0, (double)info->dim[a] - 1);
    }
    mat4_point(target, info->world_from_voxel, target);
    random_vector(state, direction, 1);
    vec3_add_scaled(target, target, -test_random(state, 0, 60) / vec3_length(direction), direction);
    return looking(target, direction);
}

struct cone scene_cone(uint64_t *state, const conus_atlas *atlas)
{
    struct cone cone = {.pose = scene_pose(state, atlas)};
    cone.angle =
        radians_from_degrees(test_random(state, 0, 1) < 0.5 ? test_random(state, 1, 20) : test_random(state, 1, 170));
    cone.resolution = 1 + (uint32_t)test_random(state, 0, test_random(state, 0, 1) < 0.2 ? 64 : 17);
    return cone;
}
