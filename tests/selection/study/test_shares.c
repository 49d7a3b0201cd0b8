/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 16: the volumes that voxels of two grids have in common, in closed form, as products of lengths, and against a
 * search of a lattice of points in every voxel. */
#include "atlas/atlas.h"
#include "atlas/volume.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "region_scene.h"
#include "scene.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cubes of 2 mm whose edges are those of the atlas's voxels: each holds 8 of them. 2 x 2 x 2 cubes from -0.5 mm on hold
 * 64 voxels of the first slab; moved by 2 mm along x, half of them are the second's. */
static void larger_voxels_hold_several(void **state)
{
    (void)state;
    conus_atlas *atlas = region_scene_slabs();
    conus_roi *roi = region_scene_whole(2, 2, (const double[]){0.5, 0.5, 0.5});
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_int_equal(conus_table_rows(overlap), 1);
    assert_near(region_scene_find(overlap, 1).volume, 64, 1e-12);
    assert_near(region_scene_find(overlap, 1).fraction, 64 / 256.0, 1e-12);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    roi = region_scene_whole(2, 2, (const double[]){2.5, 0.5, 0.5});
    overlap = region_scene_overlap(atlas, roi, NULL);
    assert_near(region_scene_find(overlap, 1).volume, 32, 1e-12);
    assert_near(region_scene_find(overlap, 2).volume, 32, 1e-12);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* The border of the slabs is at x = 3.5; the atlas ends at x, y, z = -0.5 and 7.5. */
static void check_cube(double edge, const double middle[3], double first, double second)
{
    conus_atlas *atlas = region_scene_slabs();
    conus_roi *roi = region_scene_whole(1, edge, middle);
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    double rest = edge * edge * edge - first - second;
    const double wanted[3] = {rest, first, second};
    for (uint32_t object = 0; object < 3; object++) {
        const struct region_scene_row row = region_scene_find(overlap, object);
        assert_int_equal(row.is_there, wanted[object] > 1e-9);
        assert_near(row.volume, wanted[object], 1e-9);
    }
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* A cube of 2 mm in the middle of the border, as maps of 2 mm have on atlases of 1 mm, is half on each side. */
static void cubes_across_a_border_are_divided(void **state)
{
    (void)state;
    check_cube(2, (const double[]){3.5, 3, 3}, 4, 4);
    check_cube(2, (const double[]){3, 3, 3}, 6, 2);
    check_cube(2, (const double[]){4, 4, 4}, 2, 6);
    check_cube(2, (const double[]){3, -0.5, 7.5}, 1.5, 0.5);
    check_cube(2.5, (const double[]){3.25, 3, 3}, 1.5 * 6.25, 6.25);
    check_cube(0.1, (const double[]){3.48, 3, 3}, 0.0007, 0.0003);
    check_cube(16, (const double[]){3.5, 3.5, 3.5}, 256, 256);
    check_cube(1, (const double[]){-1.5, 3, 3}, 0, 0);
}

/* A shift as small as a header's rounding is no overlap; a thousandth of a voxel is one. */
static void rounding_crosses_no_border(void **state)
{
    (void)state;
    check_cube(1, (const double[]){3 + 9e-5, 3 - 9e-5, 3}, 1, 0);
    check_cube(1, (const double[]){3.001, 3, 3}, 0.999, 0.001);
    check_cube(1, (const double[]){3.999, 3, 3}, 0.001, 0.999);
}

/* Slices of a quarter of a millimetre along one axis belong to two areas in turn: a voxel of 1 mm is half in each. */
static void thin_slices_along_any_axis_count(void **state)
{
    (void)state;
    for (size_t axis = 0; axis < 3; axis++) {
        size_t dim[3] = {4, 4, 4};
        double place[16] = {[0] = 1, [5] = 1, [10] = 1, [15] = 1};
        uint32_t labels[256];
        dim[axis] = 16;
        place[5 * axis] = 0.25;
        for (size_t i = 0; i < 256; i++) {
            const size_t at[3] = {i % dim[0], i / dim[0] % dim[1], i / dim[0] / dim[1]};
            labels[i] = 1 + (uint32_t)(at[axis] % 2);
        }
        const conus_volume_info grid = scene_plain_grid(dim, place);
        conus_atlas *atlas = scene_parcellation(&grid, labels);
        conus_roi *roi = region_scene_whole(1, 1, (const double[]){1.3, 1.4, 1.5});
        conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
        assert_int_equal(conus_table_rows(overlap), 2);
        assert_near(region_scene_find(overlap, 1).volume, 0.5, 1e-12);
        assert_near(region_scene_find(overlap, 2).volume, 0.5, 1e-12);
        conus_table_destroy(overlap);
        conus_roi_destroy(roi);
        conus_atlas_destroy(atlas);
    }
}

/* A grid whose axes are those of the world in some order and direction. Borders are at multiples of 1/16 mm, so that
 * two coincide or are clearly apart. */
static conus_volume_info random_parallel(uint64_t *seed)
{
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const int *order = orders[(int)test_random(seed, 0, 6)];
    double place[16] = {[15] = 1};
    size_t dim[3];
    for (int a = 0; a < 3; a++) {
        dim[a] = 2 + (size_t)test_random(seed, 0, 5);
        place[4 * a + order[a]] = floor(test_random(seed, 4, 21)) / 8 * (test_random(seed, -1, 1) < 0 ? -1 : 1);
        place[12 + order[a]] = -place[4 * a + order[a]] * (double)dim[a] / 2 + floor(test_random(seed, -8, 9)) / 8;
    }
    return scene_plain_grid(dim, place);
}

/* Ends of voxel (i, j, k) along world axis `axis`. */
static void find_ends(double ends[2], const conus_volume_info *grid, size_t voxel, int axis)
{
    const size_t at[3] = {voxel % grid->dim[0], voxel / grid->dim[0] % grid->dim[1],
                          voxel / grid->dim[0] / grid->dim[1]};
    double middle = grid->world_from_voxel[12 + axis];
    double edge = 0;
    for (int a = 0; a < 3; a++) {
        middle += grid->world_from_voxel[4 * a + axis] * (double)at[a];
        edge += fabs(grid->world_from_voxel[4 * a + axis]);
    }
    ends[0] = middle - edge / 2, ends[1] = middle + edge / 2;
}

static double common_mm3(const conus_volume_info *a, size_t of_a, const conus_volume_info *b, size_t of_b)
{
    double volume = 1;
    for (int axis = 0; axis < 3; axis++) {
        double x[2];
        double y[2];
        find_ends(x, a, of_a, axis);
        find_ends(y, b, of_b, axis);
        volume *= fmax(0, fmin(x[1], y[1]) - fmax(x[0], y[0]));
    }
    return volume;
}

static void check_products(const conus_atlas *atlas, const conus_roi *roi)
{
    const conus_volume_info *grid = &atlas->volumes[0].info;
    const conus_volume_info *region = conus_roi_volume(roi);
    double volumes[4] = {0};
    double sum = 0;
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    for (size_t i = 0; i < roi->volume.voxel_count; i++) {
        for (size_t k = 0; roi_has(roi, i) && k < atlas->volumes[0].voxel_count; k++) {
            volumes[volume_object(&atlas->volumes[0], k)] += common_mm3(region, i, grid, k);
        }
    }
    for (uint32_t object = 1; object <= atlas->object_count; object++) {
        const struct region_scene_row row = region_scene_find(overlap, object);
        assert_near(row.volume, volumes[object], 1e-10);
        sum += volumes[object];
    }
    double all = (double)roi->voxels * fabs(mat4_determinant3(region->world_from_voxel));
    const struct region_scene_row rest = region_scene_find(overlap, 0);
    assert_near(rest.volume, all - sum, 1e-10);
    conus_table_destroy(overlap);
}

static void parallel_grids_have_products_of_lengths_in_common(void **state)
{
    (void)state;
    uint64_t seed = 8;
    for (int round = 0; round < 100; round++) {
        uint32_t labels[216];
        float values[216];
        const conus_volume_info grid = random_parallel(&seed);
        const conus_volume_info region = random_parallel(&seed);
        for (size_t i = 0; i < 216; i++) {
            labels[i] = 1 + (uint32_t)test_random(&seed, 0, 3);
            values[i] = i && test_random(&seed, 0, 1) < 0.5 ? 0 : 1;
        }
        conus_atlas *atlas = scene_parcellation(&grid, labels);
        conus_voxels voxels = region_scene_cubes(values, region.dim, 1, (const double[]){0, 0, 0});
        memcpy(voxels.world_from_voxel, region.world_from_voxel, sizeof voxels.world_from_voxel);
        conus_roi *roi = region_scene_make(&voxels, 0);
        check_products(atlas, roi);
        conus_roi_destroy(roi);
        conus_atlas_destroy(atlas);
    }
}

enum { POINTS = 11 }; /* of the lattice in a voxel, along each axis */

/* Result of a search over every lattice point: points in each object, 0 = in none, and the peak. */
struct found {
    uint64_t points;
    double peak;
};

/* Object of the cell that holds a point: the voxel whose index coordinates, rounded, are the point's. */
static uint32_t object_at(const struct volume *volume, const double point[3])
{
    double at[3];
    mat4_point(at, volume->voxel_from_world, point);
    size_t index[3];
    for (int a = 0; a < 3; a++) {
        double cell = floor(at[a] + 0.5);
        if (cell < 0 || cell >= (double)volume->info.dim[a]) {
            return 0;
        }
        index[a] = (size_t)cell;
    }
    return volume_object(volume, index[0] + volume->info.dim[0] * (index[1] + volume->info.dim[1] * index[2]));
}

static void note(struct found *found, double value, bool down)
{
    bool more = !found->points || (down ? value < found->peak : value > found->peak);
    found->peak = more ? value : found->peak;
    found->points++;
}

/* Notes the object and the voxel that hold point `n` of a voxel. */
static void search_point(struct found *found, const conus_atlas *atlas, const struct volume *region, size_t voxel,
                         size_t n)
{
    const size_t *dim = region->info.dim;
    const size_t of_lattice[3] = {n % POINTS, n / POINTS % POINTS, n / POINTS / POINTS};
    const size_t at[3] = {voxel % dim[0], voxel / dim[0] % dim[1], voxel / dim[0] / dim[1]};
    double value = (double)region->values[voxel];
    bool down = region->info.threshold < 0;
    double point[3];
    bool any = false;
    for (int a = 0; a < 3; a++) {
        point[a] = (double)at[a] + ((double)of_lattice[a] + 0.5) / POINTS - 0.5;
    }
    mat4_point(point, region->info.world_from_voxel, point);
    for (size_t v = 0; v < atlas->volume_count; v++) {
        bool is_context = atlas->volumes[v].info.role == CONUS_ROLE_CONTEXT;
        uint32_t object = is_context ? 0 : object_at(&atlas->volumes[v], point);
        if (object) {
            note(&found[object], value, down);
            any = true;
        }
    }
    if (!any) {
        note(&found[0], value, down);
    }
}

static void search(struct found *found, const conus_atlas *atlas, const conus_roi *roi)
{
    const struct volume *region = &roi->volume;
    double threshold = (double)(float)region->info.threshold;
    for (size_t voxel = 0; voxel < region->voxel_count; voxel++) {
        double value = (double)region->values[voxel];
        bool belongs = threshold > 0 ? value >= threshold : value <= threshold;
        for (size_t n = 0; belongs && n < POINTS * POINTS * POINTS; n++) {
            search_point(found, atlas, region, voxel, n);
        }
    }
}

/* On one side of a plane through a voxel a lattice misses the volume by less than one in POINTS, mostly by far less, in
 * either direction: for n voxels by about sqrt(n) times that. On one grid it misses nothing. */
static void compare(const conus_table *overlap, const struct found *found, const conus_atlas *atlas, uint64_t voxels,
                    double voxel_mm3, bool one_grid)
{
    double tolerance = one_grid ? 1e-9 : 0.1 * sqrt((double)voxels) * voxel_mm3;
    for (uint32_t object = 0; object <= atlas->object_count; object++) {
        const struct region_scene_row row = region_scene_find(overlap, object);
        double volume = (double)found[object].points / (POINTS * POINTS * POINTS) * voxel_mm3;
        assert_true(row.is_there || !found[object].points);
        assert_near(row.volume, volume, tolerance);
        if (row.is_there && found[object].points) {
            assert_near(row.roi_fraction, row.volume / (voxel_mm3 * (double)voxels), 1e-12);
            assert_true(one_grid ? row.peak == found[object].peak : fabs(row.peak) >= fabs(found[object].peak));
        }
        if (row.is_there && object) {
            assert_near(row.fraction, fmin(1, row.volume / atlas->objects[object - 1].volume_mm3), 1e-9);
        } else if (row.is_there) {
            assert_true(isnan(row.fraction));
        }
    }
}

static void volumes_are_as_a_lattice_finds_them(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int round = 0; round < 60; round++) {
        conus_atlas *atlas = scene_atlas(&seed, 12, round % 3);
        if (round % 5 == 0) { /* a context is nothing that could be covered */
            scene_add_blockers(atlas, &seed, (const size_t[]){6, 6, 6}, 0.3);
        }
        const size_t dim[3] = {1 + (size_t)test_random(&seed, 0, 6), 1 + (size_t)test_random(&seed, 0, 6),
                               1 + (size_t)test_random(&seed, 0, 6)};
        conus_volume_info grid = round % 2 ? atlas->volumes[0].info : scene_grid(&seed, dim);
        size_t count = grid.dim[0] * grid.dim[1] * grid.dim[2];
        float *values = malloc(count * sizeof *values);
        for (size_t i = 0; i < count; i++) {
            values[i] = (float)test_random(&seed, -1, 1);
        }
        values[count - 1] = round % 4 < 2 ? 1 : -1; /* so that the region is not empty */
        values[0] = count > 1 ? NAN : values[0];
        conus_voxels voxels = {
            .data = values, .type = CONUS_SCALAR_FLOAT32, .dim = {grid.dim[0], grid.dim[1], grid.dim[2]}};
        memcpy(voxels.world_from_voxel, grid.world_from_voxel, sizeof voxels.world_from_voxel);
        conus_roi *roi = region_scene_make(&voxels, round % 4 < 2 ? 0.3 : -0.3);
        conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
        struct found *found = calloc(atlas->object_count + 1, sizeof *found);
        search(found, atlas, roi);
        compare(overlap, found, atlas, roi->voxels, fabs(mat4_determinant3(grid.world_from_voxel)),
                round % 2 && round % 3 == 0);
        free(found);
        free(values);
        conus_table_destroy(overlap);
        conus_roi_destroy(roi);
        conus_atlas_destroy(atlas);
    }
}

TEST_GROUP(shares)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_are_as_a_lattice_finds_them),
        cmocka_unit_test(larger_voxels_hold_several),
        cmocka_unit_test(cubes_across_a_border_are_divided),
        cmocka_unit_test(rounding_crosses_no_border),
        cmocka_unit_test(thin_slices_along_any_axis_count),
        cmocka_unit_test(parallel_grids_have_products_of_lengths_in_common),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
