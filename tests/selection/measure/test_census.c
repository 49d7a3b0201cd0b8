/* SPDX-License-Identifier: BSD-3-Clause */
/* The census of Eq. 10: the fast walk finds exactly the voxels of the predicate, each once and in order. */
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "report_scene.h"
#include "scene.h"
#include "selection/region/region.h"
#include "selection/selection.h"
#include "test.h"

#include <string.h>

/* State of a walk, which must report exactly the voxels in the region, in order. */
struct expected {
    const struct region *region;
    const struct volume *volume;
    size_t next; /* linear index of the first voxel that was not reported yet */
    size_t found;
};

static bool voxel_is_in(const struct expected *expected, size_t voxel)
{
    double p[3];
    scene_voxel(p, expected->volume, voxel);
    return region_has(expected->region, p);
}

static void check_row(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    struct expected *expected = user;
    const size_t *dim = volume->info.dim;
    assert_ptr_equal(volume, expected->volume);
    assert_true(count > 0 && at[0] + count <= dim[0] && at[1] < dim[1] && at[2] < dim[2]);
    size_t first = at[0] + dim[0] * (at[1] + dim[1] * at[2]);
    assert_true(first >= expected->next);
    for (; expected->next < first; expected->next++) {
        assert_false(voxel_is_in(expected, expected->next));
    }
    for (; expected->next < first + count; expected->next++) {
        assert_true(voxel_is_in(expected, expected->next));
    }
    expected->found += count;
}

static size_t check_walk(const struct region *region, const struct volume *volume)
{
    struct expected expected = {region, volume, 0, 0};
    census_walk(region, volume, check_row, &expected);
    for (; expected.next < volume->voxel_count; expected.next++) {
        assert_false(voxel_is_in(&expected, expected.next));
    }
    return expected.found;
}

/* A region in the place of the cone; its borders are often at whole and half millimetres. */
static struct region random_region(uint64_t *state, const struct cone *cone)
{
    struct region region;
    double size = pow(10, test_random(state, -1, 2));
    size = test_random(state, 0, 1) < 0.5 ? ceil(2 * size) / 2 : size;
    if (test_random(state, 0, 1) < 0.2) {
        region_ball(&region, cone->pose.world_from_device + 12, size);
        return region;
    }
    region_from_cone(&region, cone);
    if (test_random(state, 0, 1) < 0.4) {
        region.shape = REGION_CYLINDER;
        region.radius = size;
        region.slope = region.sine = 0;
        region.cosine = 1;
    }
    if (test_random(state, 0, 1) < 0.4) {
        region.near = floor(test_random(state, 0, 10));
        region.far = test_random(state, 0, 1) < 0.5 ? region.near + floor(test_random(state, 0, 30)) : INFINITY;
    }
    return region;
}

static double random_angle(uint64_t *state)
{
    static const double angles[] = {1e-6, 1, 53.13010235415598, 60, 90, 120, 179, 179.999999};
    size_t pick = (size_t)test_random(state, 0, 16);
    return radians_from_degrees(pick < 8 ? angles[pick] : test_random(state, 0.1, 179.9));
}

static void test_walk_is_predicate(void **unused)
{
    (void)unused;
    uint64_t state = 1;
    size_t found = 0;
    for (int scene = 0; scene < 150; scene++) {
        conus_atlas *atlas = scene_atlas(&state, 24, 0);
        for (int i = 0; i < 30; i++) {
            struct cone cone = {.pose = scene_pose(&state, atlas), .angle = random_angle(&state), .resolution = 16};
            cone.aperture = (conus_aperture)(i % 3 == 0);
            struct region region = random_region(&state, &cone);
            found += check_walk(&region, &atlas->volumes[0]);
        }
        conus_atlas_destroy(atlas);
    }
    assert_true(found > 1000000);
}

/* Doubles are added, multiplied and divided alike by every instruction set, so the borders have the same bits. */
static void check_kernels(const struct region *region, const struct volume *volume, size_t k)
{
    struct region_rows rows;
    struct region_cut cut, other;
    const size_t *dim = volume->info.dim;
    const size_t limit[2] = {dim[0] / 4, dim[0] - 1};
    region_rows_init(&rows, region, volume, (const int[]){0, 1, 2});
    region_rows_place(&rows, k);
    assert_ptr_equal(rows.cut, region_rows_kernel(0));
    rows.cut(&cut, &rows, dim[1] / 3, dim[1] - dim[1] / 3, limit);
    for (size_t kernel = 1; region_rows_kernel(kernel); kernel++) {
        region_rows_kernel(kernel)(&other, &rows, dim[1] / 3, dim[1] - dim[1] / 3, limit);
        for (size_t r = 0; r < dim[1] - dim[1] / 3; r++) {
            for (int end = 0; end < 2; end++) {
                assert_int_equal(other.maybe[end][r], cut.maybe[end][r]);
                assert_int_equal(other.sure[end][r], cut.sure[end][r]);
            }
        }
    }
}

static void test_kernels_agree(void **unused)
{
    (void)unused;
    uint64_t state = 7;
    for (int scene = 0; scene < 60; scene++) {
        conus_atlas *atlas = scene_atlas(&state, 24, 0);
        const struct volume *volume = &atlas->volumes[0];
        for (int i = 0; i < 60; i++) {
            struct cone cone = {.pose = scene_pose(&state, atlas), .angle = random_angle(&state), .resolution = 16};
            cone.aperture = (conus_aperture)(i % 3 == 0);
            struct region region = random_region(&state, &cone);
            check_kernels(&region, volume, (size_t)i % volume->info.dim[2]);
        }
        conus_atlas_destroy(atlas);
    }
}

struct sums {
    uint64_t voxels;
    double value, maximum, weight, moment[3];
};

static void add_voxel(struct sums *sum, const double point[3], double value, double weight)
{
    sum->maximum = sum->voxels ? fmax(sum->maximum, value) : value;
    sum->voxels++;
    sum->value += value;
    sum->weight += weight;
    vec3_add_scaled(sum->moment, sum->moment, weight, point);
}

/* Adds up one voxel after the other, without leaving any out: [object_count + 1], [0] is the background of the
 * parcellation. */
static void sum_up(struct sums *sums, const conus_atlas *atlas, const struct region *region)
{
    for (size_t v = 0; v < atlas->volume_count; v++) {
        const struct volume *volume = &atlas->volumes[v];
        for (size_t voxel = 0; voxel < volume->voxel_count; voxel++) {
            uint32_t object = volume_object(volume, voxel);
            double value = volume_has_values(volume) ? (double)volume_value(volume, voxel) : 0;
            double p[3];
            scene_voxel(p, volume, voxel);
            if (region_has(region, p) && (object || v == 0)) {
                add_voxel(&sums[object], p, value, volume_has_values(volume) ? value : 1);
            }
        }
    }
}

static double area_mm3(const struct sums *sums, const conus_atlas *atlas)
{
    double mm3 = 0;
    for (size_t area = 1; area <= atlas->area_count; area++) {
        mm3 += (double)sums[area].voxels * space_voxel_mm3(&atlas->volumes[0].info);
    }
    return mm3;
}

static void check_pathway(const conus_result *result, const struct sums *sum)
{
    assert_near(result->sum_value, sum->value, 1e-9 * sum->value);
    assert_true(isnan(result->cone_fraction));
    if (sum->voxels) {
        assert_near(result->mean_value, sum->value / (double)sum->voxels, 1e-9);
        assert_near(result->max_value, sum->maximum, 0);
    } else {
        assert_true(isnan(result->mean_value) && isnan(result->max_value));
    }
}

static void check_result(const conus_result *result, const struct sums *sum, const conus_atlas *atlas, double areas)
{
    const conus_object *object = &atlas->objects[result->object - 1];
    assert_int_equal(result->voxels, sum->voxels);
    double mm3 = (double)sum->voxels * space_voxel_mm3(&atlas_object_volume(atlas, result->object)->info);
    assert_near(result->volume, mm3, 1e-12 * mm3);
    assert_near(result->fraction, (double)sum->voxels / (double)object->voxels, 1e-12);
    for (int a = 0; a < 3 && sum->voxels; a++) {
        assert_near(result->centroid[a], sum->moment[a] / sum->weight, 1e-9);
    }
    if (object->kind == CONUS_KIND_PATHWAY) {
        check_pathway(result, sum);
    } else {
        assert_true(isnan(result->sum_value) && isnan(result->mean_value) && isnan(result->max_value));
        assert_true(areas > 0 ? fabs(result->cone_fraction - mm3 / areas) < 1e-12 : isnan(result->cone_fraction));
    }
}

static void check_selection(const conus_selection *selection, const conus_atlas *atlas)
{
    struct sums *sums = memory_zeroed(atlas->object_count + 1, sizeof *sums);
    assert_non_null(sums);
    sum_up(sums, atlas, &selection->region);
    double areas = area_mm3(sums, atlas);
    size_t count = conus_selection_count(selection);
    for (size_t i = 0; i + 1 < count; i++) {
        const conus_result *result = conus_selection_result(selection, i);
        check_result(result, &sums[result->object], atlas, areas);
        sums[result->object].voxels = 0;
    }
    assert_int_equal(conus_selection_result(selection, count - 1)->voxels, sums[0].voxels);
    for (size_t object = 1; object <= atlas->object_count; object++) {
        assert_int_equal(sums[object].voxels, 0); /* whatever has a voxel in the cone has a row */
    }
    memory_free(sums);
}

static void test_results_are_sums_over_voxels(void **unused)
{
    (void)unused;
    uint64_t state = 2;
    for (int scene = 0; scene < 60; scene++) {
        conus_atlas *atlas = scene_atlas(&state, 16, scene % 3);
        conus_selector *selector = NULL;
        const conus_selector_options options = {.layers = CONUS_LAYERS_ALL,
                                                .resolution = 4,
                                                .aperture = (conus_aperture)(scene % 2),
                                                .radius = scene % 5 ? 0 : 3,
                                                .range = {0, scene % 4 ? 0 : 15}};
        assert_ok(conus_selector_create(&selector, atlas, &options));
        for (int i = 0; i < 10; i++) {
            conus_selection *selection = NULL;
            conus_pose pose = scene_pose(&state, atlas);
            assert_ok(
                conus_select(&selection, selector, &pose, degrees_from_radians(scene % 5 ? random_angle(&state) : 0)));
            check_selection(selection, atlas);
            conus_selection_destroy(selection);
        }
        conus_selector_destroy(selector);
        conus_atlas_destroy(atlas);
    }
}

/* Blocks of voxels, where in some rows the corner's voxel is another object. Every second volume is so fine that runs
 * would take more memory than labels. */
static conus_atlas *blocks(uint64_t *state, bool fine)
{
    size_t dim[3];
    for (int a = 0; a < 3; a++) {
        dim[a] = (size_t)test_random(state, 20, 60);
    }
    const conus_volume_info grid = scene_plain_grid(dim, NULL);
    uint32_t *labels = memory_zeroed(dim[0] * dim[1] * dim[2], sizeof *labels);
    assert_non_null(labels);
    size_t width = fine ? 2 : (size_t)test_random(state, 14, 40);
    for (size_t v = 0; v < dim[0] * dim[1] * dim[2]; v++) {
        size_t i = v % dim[0];
        size_t j = v / dim[0] % dim[1];
        size_t k = v / dim[0] / dim[1];
        labels[v] = i == 0 && (j + k) % 5 == 0 ? 9 : (uint32_t)(i / width + j / (width - 1) + k / (width + 1)) % 4;
    }
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    memory_free(labels);
    return atlas;
}

static conus_status find_runs_and_finish(void *data)
{
    struct label_runs runs;
    label_runs_init(&runs, data, 0);
    conus_status status = runs.rows ? CONUS_OK : CONUS_ERROR_MEMORY;
    label_runs_finish(&runs);
    return status;
}

/* Counts the runs of rows along an axis, one voxel after the other. */
static size_t runs_along(const struct volume *volume, int axis)
{
    const size_t *dim = volume->info.dim;
    const size_t stride = axis == 0 ? 1 : axis == 1 ? dim[0] : dim[0] * dim[1];
    size_t count = 0;
    for (size_t v = 0; v < volume->voxel_count; v++) {
        bool is_first = v / stride % dim[axis] == 0;
        count += is_first || volume_object(volume, v) != volume_object(volume, v - stride);
    }
    return count;
}

static void check_runs(const struct volume *volume, int axis)
{
    const size_t *dim = volume->info.dim;
    const size_t stride = axis == 0 ? 1 : axis == 1 ? dim[0] : dim[0] * dim[1];
    size_t count = runs_along(volume, axis);
    struct label_runs runs;
    label_runs_init(&runs, volume, axis);
    assert_int_equal(runs.rows != NULL, count <= volume->voxel_count / 8);
    for (size_t v = 0; v < volume->voxel_count && runs.rows; v++) {
        const size_t at[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
        size_t row = axis == 0 ? at[1] + dim[1] * at[2] : axis == 1 ? at[0] + dim[0] * at[2] : at[0] + dim[0] * at[1];
        uint32_t run[2];
        label_runs_between(run, &runs, row, at[axis] / 3, at[axis]);
        assert_int_equal(runs.objects[run[0]], volume_object(volume, v - stride * (at[axis] - at[axis] / 3)));
        assert_int_equal(runs.objects[run[1]], volume_object(volume, v));
        assert_in_range(at[axis], runs.starts[run[1]], dim[axis] - 1);
        assert_int_equal(runs.rows[dim[0] * dim[1] * dim[2] / dim[axis]], count);
    }
    label_runs_finish(&runs);
}

static void test_runs_are_labels(void **unused)
{
    (void)unused;
    uint64_t state = 8;
    for (int scene = 0; scene < 8; scene++) {
        conus_atlas *atlas = blocks(&state, scene % 2);
        for (int axis = 0; axis < 3; axis++) {
            check_runs(&atlas->volumes[0], axis);
        }
        if (scene == 0) {
            test_every_allocation(find_runs_and_finish, &atlas->volumes[0]);
        }
        conus_atlas_destroy(atlas);
    }
}

/* A census that has counted enough to find the runs gives the same as a new one, which has none. */
static void test_runs_count_alike(void **unused)
{
    (void)unused;
    uint64_t state = 9;
    conus_atlas *atlas = blocks(&state, false);
    struct census_labels *labels;
    struct census_labels *unread;
    struct census by_runs = {0};
    assert_ok(census_labels_create(&labels, atlas));
    assert_ok(census_prepare(&by_runs, atlas, labels));
    for (int i = 0; i < 300; i++) {
        struct cone cone = {.pose = scene_pose(&state, atlas), .angle = random_angle(&state), .resolution = 16};
        struct region region = random_region(&state, &cone);
        struct census fresh = {0};
        assert_ok(census_labels_create(&unread, atlas));
        assert_ok(census_prepare(&fresh, atlas, unread));
        census_take(&by_runs, atlas, &region);
        census_take(&fresh, atlas, &region);
        assert_int_equal(by_runs.touched_count, fresh.touched_count);
        for (size_t object = 0; object <= atlas->object_count; object++) {
            assert_int_equal(by_runs.counts[object].voxels, fresh.counts[object].voxels);
            assert_memory_equal(by_runs.counts[object].index, fresh.counts[object].index, sizeof fresh.counts->index);
        }
        census_finish(&fresh);
        census_labels_destroy(unread, atlas->volume_count);
    }
    for (int axis = 0; axis < 3; axis++) { /* cones of all directions took each */
        assert_non_null(labels[0].runs[axis].rows);
    }
    census_finish(&by_runs);
    census_labels_destroy(labels, atlas->volume_count);
    conus_atlas_destroy(atlas);
}

enum { MANY = 72783, MANY_EDGE = 42 };

/* As many areas as an atlas of voxels may have, a voxel each. */
static conus_atlas *many_areas(void)
{
    const conus_volume_info grid = scene_plain_grid((size_t[]){MANY_EDGE, MANY_EDGE, MANY_EDGE}, NULL);
    uint32_t *labels = memory_zeroed((size_t)MANY_EDGE * MANY_EDGE * MANY_EDGE, sizeof *labels);
    assert_non_null(labels);
    for (uint32_t v = 0; v < MANY; v++) {
        labels[v] = 4000000000U + v * 7919U % MANY;
    }
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    memory_free(labels);
    return atlas;
}

static void test_many_areas(void **unused)
{
    (void)unused;
    conus_atlas *atlas = many_areas();
    conus_selector *selector = NULL;
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .resolution = 1};
    uint64_t state = 4;
    assert_int_equal(conus_atlas_object_count(atlas), MANY);
    assert_ok(conus_selector_create(&selector, atlas, &options));
    for (int i = 0; i < 20; i++) {
        conus_selection *selection = NULL;
        conus_pose pose = scene_pose(&state, atlas);
        assert_ok(conus_select(&selection, selector, &pose, degrees_from_radians(random_angle(&state))));
        check_selection(selection, atlas);
        conus_selection_destroy(selection);
    }
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static void test_memory(void **unused)
{
    (void)unused;
    uint64_t state = 5;
    conus_atlas *atlas = scene_atlas(&state, 12, 1);
    struct report_attempt attempt = {.atlas = atlas,
                                     .options = {.layers = CONUS_LAYERS_ALL, .resolution = 2},
                                     .report = {.all_voxels = true},
                                     .angle = 29};
    assert_ok(conus_pose_toward(&attempt.pose, (double[]){-30, 5, 1}, (double[]){0, 1, 2}, NULL));
    report_every_allocation(&attempt);
    conus_atlas_destroy(atlas);
}

static void test_bad_regions(void **unused)
{
    (void)unused;
    static const conus_selector_options bad[] = {{.range = {20, 10}},  {.range = {-1, 10}}, {.range = {5, 5}},
                                                 {.range = {NAN, 10}}, {.range = {0, NAN}}, {.range = {0, INFINITY}},
                                                 {.radius = -1},       {.radius = NAN},     {.radius = INFINITY}};
    uint64_t state = 6;
    conus_atlas *atlas = scene_atlas(&state, 5, 0);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        conus_selector *selector = NULL;
        assert_fails(conus_selector_create(&selector, atlas, &bad[i]), CONUS_ERROR_ARGUMENT);
        assert_null(selector);
    }
    conus_atlas_destroy(atlas);
}

TEST_GROUP(census)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_walk_is_predicate),
        cmocka_unit_test(test_kernels_agree),
        cmocka_unit_test(test_results_are_sums_over_voxels),
        cmocka_unit_test(test_runs_are_labels),
        cmocka_unit_test(test_runs_count_alike),
        cmocka_unit_test(test_many_areas),
        cmocka_unit_test(test_memory),
        cmocka_unit_test(test_bad_regions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
