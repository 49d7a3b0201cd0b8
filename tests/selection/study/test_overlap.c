/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 16: what a region of interest covers, against a search of every part of every voxel and in closed form; and the
 * crossings of lattice lines that tell the inside of surfaces. */
#include "atlas/atlas.h"
#include "atlas/roi.h"
#include "atlas/surface/mesh_lines.h"
#include "base/math3.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/study/overlap.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Regions ---------------------------------------------------------------------------------------------------- */

/* Of values on a grid of cubes, the first voxel's middle at `corner`. */
static conus_voxels cubes(const float *values, const size_t dim[3], double edge, const double corner[3])
{
    conus_voxels voxels = {.data = values, .type = CONUS_SCALAR_FLOAT32, .dim = {dim[0], dim[1], dim[2]}};
    for (int a = 0; a < 3; a++) {
        voxels.world_from_voxel[5 * a] = edge;
        voxels.world_from_voxel[12 + a] = corner[a];
    }
    voxels.world_from_voxel[15] = 1;
    return voxels;
}

static conus_roi *region_of(const conus_voxels *voxels, double threshold)
{
    conus_roi *roi = NULL;
    assert_ok(conus_roi_create(&roi, voxels, &(conus_roi_options){.threshold = threshold}));
    return roi;
}

/* All of a grid of `count` cubes along each edge. */
static conus_roi *whole_region(size_t count, double edge, const double corner[3])
{
    static float ones[32 * 32 * 32];
    for (size_t i = 0; i < sizeof ones / sizeof *ones; i++) {
        ones[i] = 1;
    }
    const conus_voxels voxels = cubes(ones, (const size_t[]){count, count, count}, edge, corner);
    return region_of(&voxels, 0);
}

static conus_overlap *overlap_of(const conus_atlas *atlas, const conus_roi *roi, const char *level)
{
    conus_selector *selector = NULL;
    conus_overlap *overlap = NULL;
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.level = level}));
    assert_ok(conus_overlap_create(&overlap, selector, roi));
    conus_selector_destroy(selector);
    return overlap;
}

static const conus_coverage *find(const conus_overlap *overlap, uint32_t object)
{
    for (size_t i = 0; i < conus_overlap_count(overlap); i++) {
        if (conus_overlap_coverage(overlap, i)->object == object) {
            return conus_overlap_coverage(overlap, i);
        }
    }
    return NULL;
}

/* ---- Volumes ---------------------------------------------------------------------------------------------------- */

/* What a search of every part finds: parts in each object, 0 = in none, and the peak. */
struct found {
    uint64_t parts;
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
    bool more = !found->parts || (down ? value < found->peak : value > found->peak);
    found->peak = more ? value : found->peak;
    found->parts++;
}

/* Notes what holds the middle of part `n` of a voxel. */
static void search_part(struct found *found, const conus_atlas *atlas, const struct volume *region, size_t voxel,
                        size_t n, const size_t parts[3])
{
    const size_t *dim = region->info.dim;
    const size_t part[3] = {n % parts[0], n / parts[0] % parts[1], n / parts[0] / parts[1]};
    const size_t at[3] = {voxel % dim[0], voxel / dim[0] % dim[1], voxel / dim[0] / dim[1]};
    double value = (double)region->values[voxel];
    bool down = region->info.threshold < 0;
    double point[3];
    bool any = false;
    for (int a = 0; a < 3; a++) {
        point[a] = (double)at[a] + ((double)part[a] + 0.5) / (double)parts[a] - 0.5;
    }
    mat4_point(point, region->info.world_from_voxel, point);
    for (size_t v = 0; v < atlas->volume_count; v++) {
        uint32_t object = object_at(&atlas->volumes[v], point);
        if (object) {
            note(&found[object], value, down);
            any = true;
        }
    }
    if (!any) {
        note(&found[0], value, down);
    }
}

/* Returns how many parts the region has. */
static uint64_t search(struct found *found, const conus_atlas *atlas, const conus_roi *roi, const size_t parts[3])
{
    const struct volume *region = &roi->volume;
    double threshold = (double)(float)region->info.threshold;
    size_t each = parts[0] * parts[1] * parts[2];
    uint64_t count = 0;
    for (size_t voxel = 0; voxel < region->voxel_count; voxel++) {
        double value = (double)region->values[voxel];
        bool belongs = threshold > 0 ? value >= threshold : value <= threshold;
        for (size_t n = 0; belongs && n < each; n++, count++) {
            search_part(found, atlas, region, voxel, n, parts);
        }
    }
    return count;
}

static void compare(const conus_overlap *overlap, const struct found *found, const conus_atlas *atlas, uint64_t parts,
                    double voxel_mm3)
{
    double part_mm3 = voxel_mm3 / (double)(overlap->parts[0] * overlap->parts[1] * overlap->parts[2]);
    size_t rows = 0;
    for (uint32_t object = 0; object <= atlas->object_count; object++) {
        const conus_coverage *row = find(overlap, object);
        assert_int_equal(row != NULL, found[object].parts > 0);
        if (!row) {
            continue;
        }
        double volume = (double)found[object].parts * part_mm3;
        rows++;
        assert_near(row->volume, volume, 1e-9 * volume);
        assert_near(row->roi_fraction, (double)found[object].parts / (double)parts, 1e-12);
        assert_true(row->peak == found[object].peak);
        if (object) {
            assert_near(row->fraction, fmin(1, volume / atlas->objects[object - 1].volume_mm3), 1e-9);
        } else {
            assert_true(isnan(row->fraction));
        }
    }
    assert_int_equal(conus_overlap_count(overlap), rows);
}

static void volumes_are_counted_part_by_part(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int round = 0; round < 60; round++) {
        conus_atlas *atlas = scene_atlas(&seed, 12, round % 3);
        const size_t dim[3] = {1 + (size_t)test_random(&seed, 0, 9), 1 + (size_t)test_random(&seed, 0, 9),
                               1 + (size_t)test_random(&seed, 0, 9)};
        conus_volume_info grid = round % 2 ? atlas->volumes[0].info : scene_grid(&seed, dim);
        size_t count = grid.dim[0] * grid.dim[1] * grid.dim[2];
        float *values = malloc(count * sizeof *values);
        for (size_t i = 0; i < count; i++) {
            values[i] = (float)test_random(&seed, -1, 1);
        }
        values[count - 1] = round % 4 < 2 ? 1 : -1; /* so that there is a region */
        values[0] = count > 1 ? NAN : values[0];
        conus_voxels voxels = {
            .data = values, .type = CONUS_SCALAR_FLOAT32, .dim = {grid.dim[0], grid.dim[1], grid.dim[2]}};
        memcpy(voxels.world_from_voxel, grid.world_from_voxel, sizeof voxels.world_from_voxel);
        conus_roi *roi = region_of(&voxels, round % 4 < 2 ? 0.3 : -0.3);
        conus_overlap *overlap = overlap_of(atlas, roi, NULL);
        struct found *found = calloc(atlas->object_count + 1, sizeof *found);
        uint64_t parts = search(found, atlas, roi, overlap->parts);
        compare(overlap, found, atlas, parts, fabs(mat4_determinant3(grid.world_from_voxel)));
        free(found);
        free(values);
        conus_overlap_destroy(overlap);
        conus_roi_destroy(roi);
        conus_atlas_destroy(atlas);
    }
}

/* Two slabs of 1 mm voxels, x < 4 and x >= 4, of 8 x 8 x 8. */
static conus_atlas *two_slabs(void)
{
    uint32_t labels[512];
    for (size_t i = 0; i < 512; i++) {
        labels[i] = i % 8 < 4 ? 1 : 2;
    }
    const conus_volume_info grid = scene_plain_grid((const size_t[]){8, 8, 8}, NULL);
    return scene_parcellation(&grid, labels);
}

/* Cubes of 2 mm whose edges are those of the atlas's voxels: each holds 8 of them. 2 x 2 x 2 cubes from -0.5 mm on hold
 * 64 voxels of the first slab; moved by 2 mm along x, half of them are the second's. */
static void larger_voxels_are_cut_into_parts(void **state)
{
    (void)state;
    conus_atlas *atlas = two_slabs();
    conus_roi *roi = whole_region(2, 2, (const double[]){0.5, 0.5, 0.5});
    conus_overlap *overlap = overlap_of(atlas, roi, NULL);
    assert_int_equal(overlap->parts[0], 2);
    assert_int_equal(conus_overlap_count(overlap), 1);
    assert_near(find(overlap, 1)->volume, 64, 1e-12);
    assert_near(find(overlap, 1)->fraction, 64 / 256.0, 1e-12);
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    roi = whole_region(2, 2, (const double[]){2.5, 0.5, 0.5});
    overlap = overlap_of(atlas, roi, NULL);
    assert_near(find(overlap, 1)->volume, 32, 1e-12);
    assert_near(find(overlap, 2)->volume, 32, 1e-12);
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* One row, the part outside of everything: 4 of the 8 cubes from x = 6.5 on. */
static void what_is_in_nothing_comes_last(void **state)
{
    (void)state;
    conus_atlas *atlas = two_slabs();
    conus_roi *roi = whole_region(2, 2, (const double[]){6.5, 0.5, 0.5});
    conus_overlap *overlap = overlap_of(atlas, roi, NULL);
    assert_int_equal(conus_overlap_count(overlap), 2);
    const conus_coverage *rest = conus_overlap_coverage(overlap, 1);
    assert_int_equal(rest->kind, CONUS_KIND_UNASSIGNED);
    assert_near(rest->volume, 32, 1e-12);
    assert_near(rest->roi_fraction, 0.5, 1e-12);
    assert_null(conus_overlap_coverage(overlap, 2));
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* The peak is the value farthest from 0 on the threshold's side, of equal ones the first. */
static void peaks_are_found(void **state)
{
    (void)state;
    conus_atlas *atlas = two_slabs();
    const float values[] = {3, 5, -4, 5, -6, 1, NAN, -6};
    const conus_voxels voxels = cubes(values, (const size_t[]){8, 1, 1}, 1, (const double[]){0, 0, 0});
    conus_roi *roi = region_of(&voxels, 2);
    conus_overlap *overlap = overlap_of(atlas, roi, NULL);
    assert_int_equal(conus_roi_voxels(roi), 3);
    assert_int_equal(conus_overlap_count(overlap), 1);
    assert_near(find(overlap, 1)->peak, 5, 0);
    assert_near(find(overlap, 1)->peak_point[0], 1, 1e-12);
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    roi = region_of(&voxels, -4);
    overlap = overlap_of(atlas, roi, NULL);
    assert_near(find(overlap, 1)->peak, -4, 0);
    assert_near(find(overlap, 2)->peak, -6, 0);
    assert_near(find(overlap, 2)->peak_point[0], 4, 1e-12);
    assert_near(find(overlap, 2)->volume, 2, 1e-12);
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Of two peaks the first in the file, (1, 0, 0), counts, though the other, (0, 0, 1), is on an earlier line along k. */
static void of_equal_peaks_the_first_counts(void **state)
{
    (void)state;
    conus_atlas *atlas = two_slabs();
    const float values[] = {0, 5, 5, 0};
    const conus_voxels voxels = cubes(values, (const size_t[]){2, 1, 2}, 1, (const double[]){0, 0, 0});
    conus_roi *roi = region_of(&voxels, 0);
    conus_overlap *overlap = overlap_of(atlas, roi, NULL);
    assert_near(find(overlap, 1)->peak_point[0], 1, 1e-12);
    assert_near(find(overlap, 1)->peak_point[2], 0, 1e-12);
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Hidden areas are as if never loaded. */
static void what_is_hidden_is_not_covered(void **state)
{
    (void)state;
    conus_atlas *atlas = two_slabs();
    assert_ok(conus_atlas_set_hidden(atlas, (const bool[]){false, true, false}));
    conus_roi *roi = whole_region(8, 1, (const double[]){0, 0, 0});
    conus_overlap *overlap = overlap_of(atlas, roi, NULL);
    assert_int_equal(conus_overlap_count(overlap), 2);
    assert_near(find(overlap, 2)->volume, 256, 1e-9);
    assert_near(find(overlap, 0)->volume, 256, 1e-9);
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* ---- Surfaces --------------------------------------------------------------------------------------------------- */

static void add_box(conus_atlas *atlas, const double low[3], const double high[3])
{
    struct mesh box = mesh_scene_box(low, high);
    mesh_scene_add(atlas, &box);
}

/* A box whose faces and the diagonals on them run through the middles of voxels: 4 x 3 x 2 mm hold 24 of them. */
static void lines_along_edges_lose_nothing(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_box(atlas, (const double[]){0, 0, 0}, (const double[]){4, 3, 2});
    conus_roi *roi = whole_region(8, 1, (const double[]){-2, -2, -2});
    conus_overlap *overlap = overlap_of(atlas, roi, NULL);
    assert_near(find(overlap, 1)->volume, 24, 1e-9);
    assert_near(find(overlap, 1)->fraction, 1, 1e-9);
    assert_near(find(overlap, 0)->volume, 512 - 24, 1e-9);
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Half a ball of 10 mm in a region that ends at z = 0: 2/3 pi 1000 mm^3. Voxels of 1 mm miss that by less than one in a
 * hundred, and so does the inscribed surface. */
static void a_ball_is_counted_by_its_inside(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh ball = mesh_scene_sphere((const double[]){0.1, 0.2, 0}, 10, 60, 90);
    mesh_scene_add(atlas, &ball);
    conus_roi *roi = whole_region(30, 1, (const double[]){-15, -15, -29.5});
    conus_overlap *overlap = overlap_of(atlas, roi, NULL);
    double half = 2 * MATH3_PI / 3 * 1000;
    assert_near(find(overlap, 1)->volume, half, 0.01 * half);
    assert_near(find(overlap, 1)->fraction, 0.5, 0.01);
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* A surface that faces inwards has the same inside; one that is open has none. */
static void facing_does_not_matter_but_holes_do(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh turned = mesh_scene_box((const double[]){0, 0, 0}, (const double[]){2, 2, 2});
    struct mesh open = mesh_scene_box((const double[]){3, 0, 0}, (const double[]){5, 2, 2});
    mesh_scene_turn(&turned);
    open.triangle_count--;
    mesh_scene_add(atlas, &turned);
    mesh_scene_add(atlas, &open);
    conus_roi *roi = whole_region(8, 1, (const double[]){-0.5, -0.5, -0.5});
    conus_overlap *overlap = overlap_of(atlas, roi, NULL);
    assert_near(find(overlap, 1)->volume, 8, 1e-9);
    assert_null(find(overlap, 2));
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Two boxes that share 1 of 2 x 8 mm^3, reported as the area above them: what is in both counts once. */
static void a_level_counts_what_is_in_two_parts_once(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_box(atlas, (const double[]){0, 0, 0}, (const double[]){2, 2, 2});
    add_box(atlas, (const double[]){1, 1, 1}, (const double[]){3, 3, 3});
    assert_ok(atlas_add_group(
        atlas, &(conus_object){.kind = CONUS_KIND_AREA, .label = 9, .name = "both", .abbreviation = ""}));
    atlas->objects[0].parent = atlas->objects[1].parent = 3;
    conus_roi *roi = whole_region(8, 1, (const double[]){-0.5, -0.5, -0.5});
    conus_overlap *overlap = overlap_of(atlas, roi, "1");
    assert_int_equal(conus_overlap_count(overlap), 2);
    assert_near(find(overlap, 3)->volume, 15, 1e-9);
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Along every line of the lattice a closed surface is entered as often as it is left, wherever its vertices are. */
static void closed_surfaces_are_left_as_often_as_entered(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int round = 0; round < 40; round++) {
        struct mesh mesh = mesh_scene_sphere((const double[]){8, 8, 8}, test_random(&seed, 1, 8), 5, 8);
        struct mesh_lines lines = {.step = {1, 1}, .count = {17, 17}};
        int sum = 0;
        for (size_t i = 0; i < 3 * mesh.vertex_count; i++) {
            mesh.positions[i] = roundf(mesh.positions[i]); /* onto the lines */
        }
        for (size_t i = 0; i < mesh.triangle_count; i++) {
            assert_ok(mesh_lines_cross(&lines, 1, &mesh, i, NULL));
        }
        mesh_lines_sort(&lines);
        assert_true(lines.crossing_count > 0);
        for (size_t i = 0; i < lines.crossing_count; i++) {
            bool begins = i == 0 || lines.crossings[i - 1].line != lines.crossings[i].line;
            assert_true(!begins || sum == 0);
            sum += lines.crossings[i].side;
        }
        assert_int_equal(sum, 0);
        mesh_lines_finish(&lines);
        mesh_finish(&mesh);
    }
}

/* ---- Bad input -------------------------------------------------------------------------------------------------- */

static void check_refused(const float *values, double threshold, conus_status wanted, const char *words)
{
    conus_roi *roi = NULL;
    const conus_voxels voxels = cubes(values, (const size_t[]){4, 1, 1}, 1, (const double[]){0, 0, 0});
    assert_fails(conus_roi_create(&roi, &voxels, &(conus_roi_options){.threshold = threshold}), wanted);
    assert_non_null(strstr(conus_message(), words));
    assert_null(roi);
}

static void what_is_no_region_is_refused(void **state)
{
    (void)state;
    const float map[] = {0, 1, 2.5F, -3};
    const float mask[] = {0, 2, 2, NAN};
    const float nothing[] = {0, 0, 0, 0};
    check_refused(map, 0, CONUS_ERROR_ARGUMENT, "values from -3 to 2.5 and is no mask");
    check_refused(map, 2.6, CONUS_ERROR_ARGUMENT, "threshold 2.6, but its values are from -3 to 2.5");
    check_refused(map, -3.5, CONUS_ERROR_ARGUMENT, "threshold -3.5");
    check_refused(map, INFINITY, CONUS_ERROR_ARGUMENT, "finite");
    check_refused(map, NAN, CONUS_ERROR_ARGUMENT, "finite");
    check_refused(nothing, 0, CONUS_ERROR_DATA, "no voxel differs from 0");
    conus_voxels voxels = cubes(mask, (const size_t[]){4, 1, 1}, 1, (const double[]){0, 0, 0});
    conus_roi *roi = region_of(&voxels, 0);
    assert_int_equal(conus_roi_voxels(roi), 2);
    assert_true(conus_roi_volume(roi)->threshold == 0);
    conus_roi_destroy(roi);
    assert_fails(conus_roi_load(&roi, "no such file", NULL), CONUS_ERROR_IO);
    assert_fails(conus_roi_load(NULL, "x", NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_roi_create(NULL, &voxels, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_overlap_create(NULL, NULL, NULL), CONUS_ERROR_ARGUMENT);
    conus_roi_destroy(NULL);
    conus_overlap_destroy(NULL);
    assert_int_equal(conus_roi_voxels(NULL), 0);
    assert_int_equal(conus_overlap_count(NULL), 0);
}

static conus_status make_overlap(void *data)
{
    const float values[] = {0, 1, 1, 0};
    const conus_voxels voxels = cubes(values, (const size_t[]){4, 1, 1}, 1, (const double[]){0, 1, 1});
    conus_roi *roi = NULL;
    conus_overlap *overlap = NULL;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_roi_create(&roi, &voxels, NULL);
    status = status ? status : conus_overlap_create(&overlap, data, roi);
    status =
        status ? status : conus_report_create(&report, data, &(conus_report_options){.rows = CONUS_ROWS_COVERAGES});
    status = status ? status : conus_report_add_overlap(report, "region", overlap);
    status = status ? status : conus_report_text(&text, &size, report);
    conus_report_destroy(report);
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_atlas *atlas = two_slabs();
    conus_selector *selector = NULL;
    add_box(atlas, (const double[]){0, 0, 0}, (const double[]){4, 3, 2});
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    test_every_allocation(make_overlap, selector);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static void rows_belong_into_a_report_of_theirs(void **state)
{
    (void)state;
    conus_atlas *atlas = two_slabs();
    conus_selector *selector = NULL;
    conus_report *report = NULL;
    conus_roi *roi = whole_region(2, 1, (const double[]){0, 0, 0});
    conus_overlap *overlap = overlap_of(atlas, roi, NULL);
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_report_create(&report, selector, NULL));
    assert_fails(conus_report_add_overlap(report, "region", overlap), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(report);
    conus_selector_destroy(selector);
    conus_overlap_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_are_counted_part_by_part),
        cmocka_unit_test(larger_voxels_are_cut_into_parts),
        cmocka_unit_test(what_is_in_nothing_comes_last),
        cmocka_unit_test(peaks_are_found),
        cmocka_unit_test(of_equal_peaks_the_first_counts),
        cmocka_unit_test(what_is_hidden_is_not_covered),
        cmocka_unit_test(lines_along_edges_lose_nothing),
        cmocka_unit_test(a_ball_is_counted_by_its_inside),
        cmocka_unit_test(facing_does_not_matter_but_holes_do),
        cmocka_unit_test(a_level_counts_what_is_in_two_parts_once),
        cmocka_unit_test(closed_surfaces_are_left_as_often_as_entered),
        cmocka_unit_test(what_is_no_region_is_refused),
        cmocka_unit_test(every_failing_allocation_is_survived),
        cmocka_unit_test(rows_belong_into_a_report_of_theirs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
