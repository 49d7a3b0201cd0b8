/* SPDX-License-Identifier: BSD-3-Clause */
/* Densities, gradients and ranges of volumes of all small sizes, against their definitions voxel by voxel. */
#include "base/math3.h"
#include "render/colour/field.h"
#include "tests/support/test.h"

#include <stdlib.h>

enum { LONGEST = 27, VOXELS = LONGEST * LONGEST * LONGEST, FILTER = 5 };

/* One byte per voxel. */
struct grid {
    size_t dim[3];
    uint8_t at[VOXELS];
};

/* The value there, or at the border next to it. */
static int held(const struct grid *grid, const ptrdiff_t at[3])
{
    size_t place[3];
    for (int a = 0; a < 3; a++) {
        ptrdiff_t last = (ptrdiff_t)grid->dim[a] - 1;
        place[a] = (size_t)(at[a] < 0 ? 0 : at[a] > last ? last : at[a]);
    }
    return grid->at[place[0] + grid->dim[0] * (place[1] + grid->dim[1] * place[2])];
}

static size_t count_of(const size_t dim[3])
{
    return dim[0] * dim[1] * dim[2];
}

static void place_of(ptrdiff_t out[3], const size_t dim[3], size_t v)
{
    out[0] = (ptrdiff_t)(v % dim[0]);
    out[1] = (ptrdiff_t)(v / dim[0] % dim[1]);
    out[2] = (ptrdiff_t)(v / dim[0] / dim[1]);
}

/* 1 4 6 4 1 sixteenths along each axis in turn, rounded to the nearest, half up. */
static void blur(struct grid *grid)
{
    static const int weights[FILTER] = {1, 4, 6, 4, 1};
    struct grid before;
    for (int a = 0; a < 3; a++) {
        before = *grid;
        for (size_t v = 0; v < count_of(grid->dim); v++) {
            int sum = 8;
            for (int n = 0; n < FILTER; n++) {
                ptrdiff_t at[3];
                place_of(at, grid->dim, v);
                at[a] += n - 2;
                sum += weights[n] * held(&before, at);
            }
            grid->at[v] = (uint8_t)(sum / 16);
        }
    }
}

/* g / (|g| + FIELD_SOFTNESS) as 128 and 127 steps, g the change per mm of the whole range, in world axes: by the chain
 * rule the transpose of voxel_from_world times the change per voxel. */
static void assert_gradient(const uint8_t texel[3], const struct grid *grid, size_t v, const double m[16])
{
    double change[3], g[3];
    for (int a = 0; a < 3; a++) {
        ptrdiff_t below[3], above[3];
        place_of(below, grid->dim, v);
        place_of(above, grid->dim, v);
        double apart = (double)((below[a] > 0) + (above[a] + 1 < (ptrdiff_t)grid->dim[a]));
        below[a]--;
        above[a]++;
        change[a] = apart > 0 ? (held(grid, above) - held(grid, below)) / apart : 0;
    }
    for (int a = 0; a < 3; a++) {
        g[a] = (m[4 * a] * change[0] + m[4 * a + 1] * change[1] + m[4 * a + 2] * change[2]) / 255;
    }
    for (int a = 0; a < 3; a++) {
        double wanted = 128 + 127 * g[a] / (vec3_length(g) + FIELD_SOFTNESS);
        assert_true(fabs(texel[a] - wanted) <= 0.5 + 1e-9);
    }
}

/* What a trilinear sample in the brick, or up to one voxel outside it, can take. */
static void assert_range(const struct field *field, const struct grid *grid, size_t index)
{
    enum { REACH = 2 };
    ptrdiff_t brick[3];
    int low = UINT8_MAX;
    int high = 0;
    place_of(brick, field->brick_dim, index);
    for (ptrdiff_t k = -REACH; k < BRICKS_EDGE + REACH; k++) {
        for (ptrdiff_t j = -REACH; j < BRICKS_EDGE + REACH; j++) {
            for (ptrdiff_t i = -REACH; i < BRICKS_EDGE + REACH; i++) {
                const ptrdiff_t at[] = {brick[0] * BRICKS_EDGE + i, brick[1] * BRICKS_EDGE + j,
                                        brick[2] * BRICKS_EDGE + k};
                int value = held(grid, at);
                low = value < low ? value : low;
                high = value > high ? value : high;
            }
        }
    }
    assert_int_equal(field->low[index], low);
    assert_int_equal(field->high[index], high);
}

static void assert_field(const struct field *field, const struct grid *density, const struct grid *slopes,
                         const double voxel_from_world[16])
{
    static uint8_t texels[4 * VOXELS];
    size_t slice = density->dim[0] * density->dim[1];
    size_t half = density->dim[2] / 2;
    field_texels(texels, field, 0, half);
    field_texels(texels + 4 * slice * half, field, half, density->dim[2] - half);
    for (size_t v = 0; v < count_of(density->dim); v++) {
        assert_int_equal(texels[4 * v + 3], density->at[v]);
        assert_gradient(texels + 4 * v, slopes, v, voxel_from_world);
    }
    for (size_t b = 0; b < count_of(field->brick_dim); b++) {
        assert_range(field, density, b);
    }
}

/* Blobs in emptiness, so that some is flat and some is not. */
static void pick_grid(struct grid *out, uint64_t *random)
{
    static const double most[] = {3.5, 8.5, 18.5, LONGEST + 0.5};
    double middle[3];
    double radius = test_random(random, 0, 9);
    for (int a = 0; a < 3; a++) {
        double limit = most[(size_t)test_random(random, 0, 4) % 4];
        out->dim[a] = (size_t)test_random(random, 1, limit);
        middle[a] = test_random(random, 0, (double)out->dim[a]);
    }
    for (size_t v = 0; v < count_of(out->dim); v++) {
        ptrdiff_t at[3];
        place_of(at, out->dim, v);
        double away[3] = {(double)at[0] - middle[0], (double)at[1] - middle[1], (double)at[2] - middle[2]};
        out->at[v] = (uint8_t)(vec3_length(away) < radius ? test_random(random, 0, 256) : 0);
    }
}

static void pick_matrix(double out[16], uint64_t *random)
{
    mat4_identity(out);
    for (int i = 0; i < 11; i++) {
        out[i] = i % 4 < 3 ? test_random(random, -2, 2) : 0;
    }
}

static void grey_values_are_densities(void **state)
{
    (void)state;
    uint64_t random = 21;
    for (int scene = 0; scene < 60; scene++) {
        struct grid grid;
        float values[VOXELS];
        struct field field;
        struct volume volume = {.values = values};
        pick_grid(&grid, &random);
        pick_matrix(volume.voxel_from_world, &random);
        for (int a = 0; a < 3; a++) {
            volume.info.dim[a] = grid.dim[a];
        }
        volume.voxel_count = count_of(grid.dim);
        for (size_t v = 0; v < volume.voxel_count; v++) { /* 50 to 152 are all of the range; beyond it is held */
            bool beyond = grid.at[v] == 0 || grid.at[v] == UINT8_MAX;
            values[v] = (float)(50 + 0.4 * grid.at[v] + (beyond ? (grid.at[v] ? 30 : -30) : 0));
        }
        assert_ok(field_of_values(&field, &volume, 50, 152));
        assert_field(&field, &grid, &grid, volume.voxel_from_world);
        field_finish(&field);
    }
}

/* Clear of the surface by 3 steps. */
static void keep_sides(struct grid *density, const uint16_t *objects)
{
    for (size_t v = 0; v < count_of(density->dim); v++) {
        int least = objects[v] ? FIELD_SURFACE + 3 : 0;
        int most = objects[v] ? UINT8_MAX : FIELD_SURFACE - 3;
        int value = density->at[v];
        density->at[v] = (uint8_t)(value < least ? least : value > most ? most : value);
    }
}

static void objects_are_blurred_and_keep_their_voxels(void **state)
{
    (void)state;
    uint64_t random = 22;
    for (int scene = 0; scene < 60; scene++) {
        struct grid grid;
        struct grid density;
        uint16_t objects[VOXELS];
        struct field field;
        struct volume volume = {.objects16 = objects};
        pick_grid(&grid, &random);
        pick_matrix(volume.voxel_from_world, &random);
        for (int a = 0; a < 3; a++) {
            volume.info.dim[a] = grid.dim[a];
        }
        volume.voxel_count = count_of(grid.dim);
        for (size_t v = 0; v < volume.voxel_count; v++) {
            objects[v] = grid.at[v] > 60 ? grid.at[v] : 0;
            grid.at[v] = objects[v] ? UINT8_MAX : 0;
        }
        blur(&grid);
        density = grid;
        keep_sides(&density, objects);
        blur(&grid);
        assert_ok(field_of_objects(&field, &volume));
        assert_field(&field, &density, &grid, volume.voxel_from_world);
        field_finish(&field);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grey_values_are_densities),
        cmocka_unit_test(objects_are_blurred_and_keep_their_voxels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
