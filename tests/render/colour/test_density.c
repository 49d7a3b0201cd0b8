/* SPDX-License-Identifier: BSD-3-Clause */
/* Densities, gradients and ranges of volumes of all small sizes, against their definitions voxel by voxel. */
#include "base/geometry/math3.h"
#include "render/colour/colour.h"
#include "tests/support/test.h"

#include <stdlib.h>

enum { LONGEST = 27, VOXELS = LONGEST * LONGEST * LONGEST, FILTER = 5, RELAXED = 4 };

/* One byte per voxel. */
struct grid {
    size_t dim[3];
    uint8_t at[VOXELS];
};

/* The value at a voxel, or at the nearest voxel of the border. */
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

/* Asserts a density, or an end of a range; all levels that do not show count as equal. */
static void assert_level(int level, int wanted, int unseen)
{
    assert_true(level == wanted || (level <= unseen && wanted <= unseen));
}

/* Asserts that a brick's range is that of all trilinear samples in it and up to one voxel outside of it. */
static void assert_range(const struct field *field, const struct grid *grid, size_t index, int unseen)
{
    enum { REACH = 2 };
    ptrdiff_t brick[3];
    int low = UINT8_MAX;
    int high = 0;
    place_of(brick, field->brick_dim, index);
    for (ptrdiff_t k = -REACH; k < BRICKS_EDGE + REACH; k++) {
        for (ptrdiff_t j = -REACH; j < BRICKS_EDGE + REACH; j++) {
            for (ptrdiff_t i = -REACH; i < BRICKS_EDGE + REACH; i++) {
                const ptrdiff_t at[] = {(ptrdiff_t)field->first[0] + brick[0] * BRICKS_EDGE + i,
                                        (ptrdiff_t)field->first[1] + brick[1] * BRICKS_EDGE + j,
                                        (ptrdiff_t)field->first[2] + brick[2] * BRICKS_EDGE + k};
                int value = held(grid, at);
                low = value < low ? value : low;
                high = value > high ? value : high;
            }
        }
    }
    assert_level(field->low[index], low, unseen);
    assert_level(field->high[index], high, unseen);
}

/* Whether the voxel, or one of the 26 around it, shows. */
static bool is_near(const struct grid *density, size_t v, int unseen)
{
    ptrdiff_t at[3];
    int most = 0;
    place_of(at, density->dim, v);
    for (ptrdiff_t n = 0; n < 27; n++) {
        const ptrdiff_t beside[] = {at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1};
        int value = held(density, beside);
        most = value > most ? value : most;
    }
    return most > unseen;
}

/* The box begins with a brick, and reaches at most seven voxels and a brick beyond the voxels that show. */
static void assert_box(const struct field *field, const struct grid *density, int unseen)
{
    enum { MOST = RELAXED + 3 };
    for (int a = 0; a < 3; a++) {
        ptrdiff_t first = PTRDIFF_MAX;
        ptrdiff_t end = BRICKS_EDGE - MOST;
        for (size_t v = 0; v < count_of(density->dim); v++) {
            ptrdiff_t at[3];
            place_of(at, density->dim, v);
            bool shows = density->at[v] > unseen;
            first = shows && at[a] < first ? at[a] : first;
            end = shows && at[a] >= end ? at[a] + 1 : end;
        }
        assert_int_equal(field->first[a] % BRICKS_EDGE, 0);
        assert_true(first == PTRDIFF_MAX || (ptrdiff_t)field->first[a] + MOST + BRICKS_EDGE > first);
        assert_true(field->first[a] + field->dim[a] <= density->dim[a]);
        assert_true((ptrdiff_t)(field->first[a] + field->dim[a]) <= end + MOST);
        assert_int_equal(field->brick_dim[a], (field->dim[a] + BRICKS_EDGE - 1) / BRICKS_EDGE);
    }
}

/* The texel of a voxel of the whole volume, NULL outside the field's box. */
static const uint8_t *texel_of(const uint8_t *texels, const struct field *field, const size_t dim[3], size_t v)
{
    ptrdiff_t at[3];
    place_of(at, dim, v);
    for (int a = 0; a < 3; a++) {
        at[a] -= (ptrdiff_t)field->first[a];
        if (at[a] < 0 || at[a] >= (ptrdiff_t)field->dim[a]) {
            return NULL;
        }
    }
    return texels + 4 * ((size_t)at[0] + field->dim[0] * ((size_t)at[1] + field->dim[1] * (size_t)at[2]));
}

/* Densities up to `unseen` do not show. */
static void assert_field(const struct field *field, const struct grid *density, const struct grid *slopes,
                         const double voxel_from_world[16], int unseen)
{
    static uint8_t texels[4 * VOXELS];
    size_t slice = field->dim[0] * field->dim[1];
    size_t half = field->dim[2] / 2;
    assert_box(field, density, unseen);
    field_texels(texels, field, 0, half);
    field_texels(texels + 4 * slice * half, field, half, field->dim[2] - half);
    for (size_t v = 0; v < count_of(density->dim); v++) {
        const uint8_t *texel = texel_of(texels, field, density->dim, v);
        if (is_near(density, v, unseen)) {
            assert_non_null(texel);
            assert_int_equal(texel[3], density->at[v]);
            assert_gradient(texel, slopes, v, voxel_from_world);
        } else if (texel) {
            assert_true(texel[3] <= unseen);
        }
    }
    for (size_t b = 0; b < count_of(field->brick_dim); b++) {
        assert_range(field, density, b, unseen);
    }
}

/* Blobs in emptiness, so that some bricks are uniform and some are not. */
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
        static const int unseen[] = {-1, 0, 100, UINT8_MAX};
        const struct field_scale scale = {50, 152, unseen[scene % 4]};
        assert_ok(field_of_values(&field, &volume, &scale));
        assert_field(&field, &grid, &grid, volume.voxel_from_world, scale.unseen);
        field_finish(&field);
    }
}

/* Keeps densities away from the surface by 3 steps. */
static void keep_sides(struct grid *density, const uint16_t *objects)
{
    for (size_t v = 0; v < count_of(density->dim); v++) {
        int least = objects[v] ? FIELD_SURFACE + 3 : 0;
        int most = objects[v] ? UINT8_MAX : FIELD_SURFACE - 3;
        int value = density->at[v];
        density->at[v] = (uint8_t)(value < least ? least : value > most ? most : value);
    }
}

/* Lets voxels that lie on the limit, none of whose neighbours lies above it, and both of whose neighbours along an axis
 * are outside, reach half way to the densest neighbour outside. */
static void keep_thin(struct grid *density, const struct grid *held_back, const uint16_t *objects)
{
    for (size_t v = 0; v < count_of(density->dim); v++) {
        int outside = 0;
        int before = 0;
        bool is_thin = objects[v] && held_back->at[v] == FIELD_SURFACE + 3;
        bool is_between = false;
        for (int n = 0; n < 6; n++) {
            ptrdiff_t at[3];
            place_of(at, density->dim, v);
            at[n / 2] += n % 2 ? 1 : -1;
            const bool is_in = at[n / 2] >= 0 && at[n / 2] < (ptrdiff_t)density->dim[n / 2];
            const int other = is_in ? held(held_back, at) : 0;
            is_thin = is_thin && other <= FIELD_SURFACE + 3;
            outside = other < FIELD_SURFACE && other > outside ? other : outside;
            is_between = is_between || (n % 2 && before < FIELD_SURFACE && other < FIELD_SURFACE);
            before = other;
        }
        density->at[v] = is_thin && is_between ? (uint8_t)(255 - outside) : density->at[v];
    }
}

static void objects_are_blurred_and_keep_their_voxels(void **state)
{
    (void)state;
    uint64_t random = 22;
    for (int scene = 0; scene < 60; scene++) {
        struct grid grid;
        struct grid density = {0};
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
        for (int n = 0; n < RELAXED; n++) {
            blur(&grid);
            keep_sides(&grid, objects);
            if (n == 0) {
                density = grid;
                keep_thin(&density, &grid, objects);
            }
        }
        blur(&grid);
        blur(&grid);
        assert_ok(field_of_objects(&field, &volume));
        assert_field(&field, &density, &grid, volume.voxel_from_world, FIELD_SURFACE - 1);
        field_finish(&field);
    }
}

/* Slabs follow each other, and their texels are the field's, whichever thread makes them. */
static void assert_slabs(struct field_task *task, const struct field *field, const uint8_t *texels)
{
    const struct field *made = NULL;
    struct field_slab slab;
    size_t slice = 4 * field->dim[0] * field->dim[1];
    size_t slices = 0;
    size_t slabs = 0;
    assert_ok(field_task_wait(&made, task));
    assert_memory_equal(made->dim, field->dim, sizeof field->dim);
    for (; field_task_next(&slab, task); slabs++) {
        assert_int_equal(slab.first, slices);
        assert_memory_equal(slab.texels, texels + slice * slab.first, slice * slab.count);
        slices += slab.count;
    }
    assert_int_equal(slices, field->dim[2]);
    assert_true(slabs > 20); /* more than are made ahead */
    assert_false(field_task_next(&slab, task));
}

static void threads_make_the_same_texels(void **state)
{
    (void)state;
    enum { ACROSS = 364, SLICES = 24 };
    const size_t count = (size_t)ACROSS * ACROSS * SLICES;
    struct volume volume = {.info.dim = {ACROSS, ACROSS, SLICES}, .voxel_count = count};
    struct field_task tasks[3];
    struct field field;
    const struct field *made = NULL;
    struct field_slab slab;
    uint8_t *texels = malloc(4 * count);
    volume.values = malloc(count * sizeof *volume.values);
    assert_true(texels && volume.values);
    mat4_identity(volume.voxel_from_world);
    for (size_t v = 0; v < count; v++) {
        volume.values[v] = (float)(v % 251);
    }
    const struct field_scale scale = {0, 255, -1};
    assert_ok(field_of_values(&field, &volume, &scale));
    field_texels(texels, &field, 0, SLICES);
    for (size_t n = 0; n < 3; n++) {
        tasks[n] = (struct field_task){.volume = &volume, .is_values = true, .scale = scale};
        if (n < 2) {
            field_task_start(&tasks[n]);
        }
    }
    assert_slabs(&tasks[0], &field, texels);
    assert_ok(field_task_wait(&made, &tasks[1])); /* it is left while it waits for room */
    assert_true(field_task_next(&slab, &tasks[1]));
    assert_slabs(&tasks[2], &field, texels);
    for (size_t n = 0; n < 3; n++) {
        field_task_end(&tasks[n]);
    }
    field_finish(&field);
    free(volume.values);
    free(texels);
}

TEST_GROUP(density)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grey_values_are_densities),
        cmocka_unit_test(objects_are_blurred_and_keep_their_voxels),
        cmocka_unit_test(threads_make_the_same_texels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
