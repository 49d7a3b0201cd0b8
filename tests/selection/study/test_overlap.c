/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 16: rows, peaks and surfaces in a region of interest, in closed form; and the crossings of lines that decide the
 * inside of surfaces. */
#include "atlas/atlas.h"
#include "atlas/surface/mesh.h"
#include "atlas/volume.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "region_scene.h"
#include "scene.h"
#include "selection/study/study.h"
#include "tables.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One row, for the part outside of the atlas: 4 of the 8 cubes, from x = 6.5 on. */
static void what_is_in_nothing_comes_last(void **state)
{
    (void)state;
    conus_atlas *atlas = region_scene_slabs();
    conus_roi *roi = region_scene_whole(2, 2, (const double[]){6.5, 0.5, 0.5});
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_int_equal(conus_table_rows(overlap), 2);
    assert_int_equal(conus_table_objects(overlap)[1], 0);
    assert_int_equal(table_count_at(overlap, "rank", 0), 1);
    assert_true(conus_table_find(overlap, "rank")->missing[1]);
    assert_string_equal(table_text_at(overlap, "kind", 1), "unassigned");
    assert_near(table_number_at(overlap, "volume_mm3", 1), 32, 1e-12);
    assert_near(table_number_at(overlap, "region_fraction", 1), 0.5, 1e-12);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* The peak is the value farthest from 0 on the threshold's side, and the first of equal ones. */
static void peaks_are_found(void **state)
{
    (void)state;
    conus_atlas *atlas = region_scene_slabs();
    const float values[] = {3, 5, -4, 5, -6, -5, NAN, -6};
    const conus_voxels voxels = region_scene_cubes(values, (const size_t[]){8, 1, 1}, 1, (const double[]){0, 0, 0});
    conus_roi *roi = region_scene_make(&voxels, 2);
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_int_equal(roi->voxels, 3);
    assert_int_equal(conus_table_rows(overlap), 1);
    assert_near(region_scene_find(overlap, 1).peak, 5, 0);
    assert_near(region_scene_find(overlap, 1).peak_point[0], 1, 1e-12);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    roi = region_scene_make(&voxels, -4);
    overlap = region_scene_overlap(atlas, roi, NULL);
    assert_near(region_scene_find(overlap, 1).peak, -4, 0);
    assert_near(region_scene_find(overlap, 2).peak, -6, 0);
    assert_near(region_scene_find(overlap, 2).peak_point[0], 4, 1e-12);
    assert_near(region_scene_find(overlap, 2).volume, 3, 1e-12);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* The first of two equal peaks in the file, (1, 0, 0), counts, though the other, (0, 0, 1), is on an earlier line along
 * k. */
static void the_first_of_equal_peaks_counts(void **state)
{
    (void)state;
    conus_atlas *atlas = region_scene_slabs();
    const float values[] = {0, 5, 5, 0};
    const conus_voxels voxels = region_scene_cubes(values, (const size_t[]){2, 1, 2}, 1, (const double[]){0, 0, 0});
    conus_roi *roi = region_scene_make(&voxels, 0);
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_near(region_scene_find(overlap, 1).peak_point[0], 1, 1e-12);
    assert_near(region_scene_find(overlap, 1).peak_point[2], 0, 1e-12);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Hidden areas are as if they had not been loaded. */
static void what_is_hidden_is_not_covered(void **state)
{
    (void)state;
    conus_atlas *atlas = region_scene_slabs();
    assert_ok(conus_atlas_set_hidden(atlas, (const bool[]){false, true, false}));
    conus_roi *roi = region_scene_whole(8, 1, (const double[]){0, 0, 0});
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_int_equal(conus_table_rows(overlap), 2);
    assert_near(region_scene_find(overlap, 2).volume, 256, 1e-9);
    assert_near(region_scene_find(overlap, 0).volume, 256, 1e-9);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* With areas and pathways hidden, nothing is left that could be covered. */
static void hidden_pathways_are_not_covered(void **state)
{
    (void)state;
    uint64_t seed = 6;
    bool hidden[300];
    conus_atlas *atlas = scene_atlas(&seed, 6, 2);
    memset(hidden, true, sizeof hidden);
    hidden[0] = false;
    assert_true(atlas->object_count < 300);
    assert_ok(conus_atlas_set_hidden(atlas, hidden));
    conus_roi *roi = region_scene_whole(32, 1, (const double[]){-16, -16, -16});
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_int_equal(conus_table_rows(overlap), 1);
    assert_near(region_scene_find(overlap, 0).roi_fraction, 1, 0);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

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
    conus_roi *roi = region_scene_whole(8, 1, (const double[]){-2, -2, -2});
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_near(region_scene_find(overlap, 1).volume, 24, 1e-9);
    assert_near(region_scene_find(overlap, 1).fraction, 1, 1e-9);
    assert_near(region_scene_find(overlap, 0).volume, 512 - 24, 1e-9);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Half a ball in a region of cubes that ends in its middle: half of the volume of its triangles. */
static void check_ball(double radius, double edge, double tolerance)
{
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh ball = mesh_scene_sphere((const double[]){0.1, 0.2, 0}, radius, 60, 90);
    mesh_scene_add(atlas, &ball);
    conus_roi *roi = region_scene_whole(30, edge, (const double[]){-15 * edge, -15 * edge, -29.5 * edge});
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_near(region_scene_find(overlap, 1).fraction, 0.5, 0.5 * tolerance);
    assert_near(region_scene_find(overlap, 1).volume, atlas->objects[0].volume_mm3 / 2,
                tolerance * atlas->objects[0].volume_mm3);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

static void a_ball_is_counted_by_its_inside(void **state)
{
    (void)state;
    check_ball(10, 1, 1e-7);
    check_ball(5, 2, 1e-7);
    check_ball(0.7, 2, 1e-7);
}

/* A plate of 0.05 mm has 0.2 mm^3, whatever the voxels are. Two plates reported as one area are measured by lines, with
 * bars of 1/4 mm around them: only the plates are counted. */
static void thin_surfaces_count_as_they_are(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_box(atlas, (const double[]){0.1, 0.5, 0.5}, (const double[]){0.15, 2.5, 2.5});
    add_box(atlas, (const double[]){-1.9, 0.5, 0.5}, (const double[]){-1.85, 2.5, 2.5});
    assert_ok(atlas_add_group(
        atlas, &(conus_object){.kind = CONUS_KIND_AREA, .label = 9, .name = "both", .abbreviation = ""}));
    atlas->objects[0].parent = atlas->objects[1].parent = 3;
    conus_roi *roi = region_scene_whole(8, 1, (const double[]){-3, -3, -3});
    for (uint32_t object = 1; object < 4; object++) {
        conus_table *overlap = region_scene_overlap(atlas, roi, object < 3 ? NULL : "1");
        double wanted = object < 3 ? 0.2 : 0.4;
        assert_near(region_scene_find(overlap, object).volume, wanted, 1e-6);
        assert_near(region_scene_find(overlap, object).fraction, 1, object < 3 ? 1e-6 : 0);
        assert_near(region_scene_find(overlap, object).roi_fraction, wanted / 512, 1e-8);
        conus_table_destroy(overlap);
    }
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* A bar through four voxels, a quarter of each; the region is two of them. */
static void surfaces_count_in_the_region_only(void **state)
{
    (void)state;
    const float values[] = {0, 4, 2, 9};
    const conus_voxels voxels = region_scene_cubes(values, (const size_t[]){4, 1, 1}, 1, (const double[]){0, 0, 0});
    conus_atlas *atlas = mesh_scene_atlas();
    add_box(atlas, (const double[]){-0.5, -0.25, -0.25}, (const double[]){1.75, 0.25, 0.25});
    add_box(atlas, (const double[]){1.75, -0.25, -0.25}, (const double[]){3.5, 0.25, 0.25});
    conus_roi *roi = region_scene_make(&voxels, 3);
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_near(region_scene_find(overlap, 1).volume, 0.25, 1e-7);
    assert_near(region_scene_find(overlap, 2).volume, 0.25, 1e-7);
    assert_near(region_scene_find(overlap, 2).peak, 9, 0);
    assert_near(region_scene_find(overlap, 2).peak_point[0], 3, 0);
    assert_near(region_scene_find(overlap, 0).volume, 1.5, 1e-7);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Along a line a surface counts from crossing to crossing, wherever in a voxel these are: 0.3 mm of a box 2 mm wide. */
static void surfaces_count_between_crossings(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_box(atlas, (const double[]){0.5, 0.5, 0.6}, (const double[]){2.5, 2.5, 0.9});
    conus_roi *roi = region_scene_whole(8, 1, (const double[]){-3, -3, -3});
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_near(region_scene_find(overlap, 1).volume, 1.2, 1e-6);
    assert_near(region_scene_find(overlap, 0).volume, 512 - 1.2, 1e-6);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* A surface that faces inwards has the same inside; an open one has none. */
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
    conus_roi *roi = region_scene_whole(8, 1, (const double[]){-0.5, -0.5, -0.5});
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_near(region_scene_find(overlap, 1).volume, 8, 1e-9);
    assert_false(region_scene_find(overlap, 2).is_there);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Two boxes that share 1 of 2 x 8 mm^3, reported as their parent: the common part counts once. */
static void a_level_counts_what_is_in_two_parts_once(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_box(atlas, (const double[]){0, 0, 0}, (const double[]){2, 2, 2});
    add_box(atlas, (const double[]){1, 1, 1}, (const double[]){3, 3, 3});
    assert_ok(atlas_add_group(
        atlas, &(conus_object){.kind = CONUS_KIND_AREA, .label = 9, .name = "both", .abbreviation = ""}));
    atlas->objects[0].parent = atlas->objects[1].parent = 3;
    conus_roi *roi = region_scene_whole(8, 1, (const double[]){-0.5, -0.5, -0.5});
    conus_table *overlap = region_scene_overlap(atlas, roi, "1");
    assert_int_equal(conus_table_rows(overlap), 2);
    assert_near(region_scene_find(overlap, 3).volume, 15, 1e-9);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Along every line of the lattice a closed surface is entered as often as it is left, wherever its vertices are. */
/* Two balls and, in one of them, a third, as parts of one area, in half a region. The balls of one area do not meet, so
 * it has the sum of the two volumes that are reported without a level, each of them exact (a_ball_is_counted...); what
 * is below the outer ball in the tree and lies in it adds nothing; and the rest of the region is in nothing. */
static void what_does_not_overlap_is_exact(void **state)
{
    (void)state;
    const double centres[3][3] = {{0.13, 6.2, 0}, {0.31, -7.4, 0}, {0.2, 6.3, 0.1}};
    const double radii[3] = {5.3, 6.1, 2.9};
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < 3; i++) {
        struct mesh ball = mesh_scene_sphere(centres[i], radii[i], 60, 90);
        mesh_scene_add(atlas, &ball);
    }
    assert_ok(atlas_add_group(atlas,
                              &(conus_object){.kind = CONUS_KIND_AREA, .label = 9, .name = "all", .abbreviation = ""}));
    atlas->objects[0].parent = atlas->objects[1].parent = 4;
    atlas->objects[2].parent = 1;
    conus_roi *roi = region_scene_whole(15, 3, (const double[]){-21, -21, -43.5}); /* up to z = 0 */
    conus_table *alone = region_scene_overlap(atlas, roi, NULL);
    conus_table *all = region_scene_overlap(atlas, roi, "1");
    double sum = region_scene_find(alone, 1).volume + region_scene_find(alone, 2).volume;
    double region = 15 * 15 * 15 * 27;
    assert_near(sum, (atlas->objects[0].volume_mm3 + atlas->objects[1].volume_mm3) / 2, 1e-6 * sum);
    assert_near(region_scene_find(all, 4).volume, sum, 1e-9 * sum);
    assert_near(region_scene_find(all, 4).volume_error, 0, 0);
    assert_near(region_scene_find(all, 0).volume, region - sum, 1e-9 * region);
    assert_near(region_scene_find(alone, 0).volume, region - sum, 1e-9 * region);
    assert_near(region_scene_find(alone, 0).volume_error, 0, 0);
    conus_table_destroy(alone);
    conus_table_destroy(all);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Boxes whose common part is in no line with voxels: 2.1^3 + 2.08^3 - 1.05^3 mm^3. Lines see the common part only, 1.15
 * mm^3, which is off by less than the row says; and a region in the second box that is in the first one, too, is the
 * other way round: nothing is in no object. */
static void what_overlaps_is_off_by_no_more_than_is_said(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_box(atlas, (const double[]){0.01, 0.02, 0.03}, (const double[]){2.11, 2.12, 2.13});
    add_box(atlas, (const double[]){1.06, 1.07, 1.08}, (const double[]){3.14, 3.15, 3.16});
    assert_ok(atlas_add_group(
        atlas, &(conus_object){.kind = CONUS_KIND_AREA, .label = 9, .name = "both", .abbreviation = ""}));
    atlas->objects[0].parent = atlas->objects[1].parent = 3;
    conus_roi *roi = region_scene_whole(8, 1, (const double[]){-1.5, -1.5, -1.5});
    conus_table *overlap = region_scene_overlap(atlas, roi, "1");
    const double wanted = 2.1 * 2.1 * 2.1 + 2.08 * 2.08 * 2.08 - 1.05 * 1.05 * 1.05;
    const struct region_scene_row both = region_scene_find(overlap, 3);
    const struct region_scene_row none = region_scene_find(overlap, 0);
    assert_in_range(both.volume_error * 1000, 100, 3000);
    assert_near(both.volume, wanted, both.volume_error);
    assert_near(none.volume, 512 - wanted, none.volume_error);
    assert_near(both.volume + none.volume, 512, 1e-9);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Boxes with a sheet of 0.2 mm in common, 10 x 10 mm, between the lines of voxels of 1 mm, which are at -4.875 and
 * -4.625: no line sees it, so that it is counted twice, and 20 mm^3 are what the row may be off at least. A third box
 * that only touches is exact: its bounds meet no others. */
static void what_lines_pass_by_is_said(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_box(atlas, (const double[]){-5, -5, -5}, (const double[]){-4.65, 5, 5});
    add_box(atlas, (const double[]){-4.85, -5, -5}, (const double[]){5, 5, 5});
    add_box(atlas, (const double[]){5, -5, -5}, (const double[]){7, 5, 5});
    for (uint32_t label = 9; label < 11; label++) {
        assert_ok(atlas_add_group(
            atlas, &(conus_object){.kind = CONUS_KIND_AREA, .label = label, .name = "all", .abbreviation = ""}));
    }
    atlas->objects[0].parent = atlas->objects[1].parent = 4;
    atlas->objects[2].parent = 5;
    conus_roi *roi = region_scene_whole(20, 1, (const double[]){-9.5, -9.5, -9.5});
    conus_table *overlap = region_scene_overlap(atlas, roi, "1");
    const struct region_scene_row both = region_scene_find(overlap, 4);
    const struct region_scene_row none = region_scene_find(overlap, 0);
    assert_near(both.volume, 1000, both.volume_error + 1e-6);
    assert_near(none.volume, 8000 - 1200, none.volume_error + 1e-6);
    assert_in_range(both.volume_error * 1000, 20 * 999, 40000);
    assert_true(region_scene_find(overlap, 5).is_there);
    assert_near(region_scene_find(overlap, 5).volume_error, 0, 0);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

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

static void check_refused(const float *values, double threshold, conus_status wanted, const char *words)
{
    conus_roi *roi = NULL;
    const conus_voxels voxels = region_scene_cubes(values, (const size_t[]){4, 1, 1}, 1, (const double[]){0, 0, 0});
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
    conus_voxels voxels = region_scene_cubes(mask, (const size_t[]){4, 1, 1}, 1, (const double[]){0, 0, 0});
    conus_roi *roi = region_scene_make(&voxels, 0);
    assert_int_equal(roi->voxels, 2);
    assert_true(conus_roi_volume(roi)->threshold == 0);
    conus_roi_destroy(roi);
    assert_fails(conus_roi_load(&roi, "no such file", NULL), CONUS_ERROR_IO);
    /* with the sanitizers nothing is left of the name, either */
    assert_fails(conus_roi_load(&roi, "/proc/self/exe,tissue=2", NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_roi_load(NULL, "x", NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_roi_create(NULL, &voxels, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_overlap(NULL, NULL, NULL), CONUS_ERROR_ARGUMENT);
    conus_roi_destroy(NULL);
}

/* The region of these tetrahedra, each of value 1 and with four separate nodes. */
static conus_roi *tetrahedra_region(const double (*corners)[3], size_t count)
{
    const conus_volume_info info = {.path = "mesh"};
    struct roi_mesh mesh = {.nodes = memory_copy(corners, 4 * count, sizeof *corners),
                            .node_count = 4 * count,
                            .tetrahedra = memory_zeroed(count, sizeof *mesh.tetrahedra),
                            .count = count};
    conus_roi *roi = NULL;
    assert_true(mesh.nodes && mesh.tetrahedra);
    for (uint32_t i = 0; i < count; i++) {
        mesh.tetrahedra[i] = (struct tetrahedron){{4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3}, 1};
    }
    assert_ok(roi_create_mesh(&roi, &info, &mesh));
    return roi;
}

/* The plane x = 3.5 leaves (t / 3)³ of a tetrahedron whose corner lies t beyond it and whose opposite face is parallel
 * to it. */
static void tetrahedra_are_cut_by_voxels(void **state)
{
    (void)state;
    static const double corners[2][4][3] = {{{2, 1, 1}, {2, 6, 1}, {2, 1, 6}, {5, 3, 3}},
                                            {{5, 1, 1}, {5, 1, 6}, {5, 6, 1}, {2, 3, 3}}};
    for (size_t i = 0; i < 2; i++) {
        conus_atlas *atlas = region_scene_slabs();
        conus_roi *roi = tetrahedra_region(corners[i], 1);
        conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
        assert_int_equal(conus_table_rows(overlap), 2);
        for (uint32_t object = 1; object <= 2; object++) {
            const struct region_scene_row row = region_scene_find(overlap, object);
            double part = object == (i ? 1 : 2) ? 0.125 : 0.875;
            assert_near(row.volume, 12.5 * part, 1e-12);
            assert_near(row.roi_fraction, part, 1e-14);
            assert_near(row.fraction, 12.5 * part / 256, 1e-14);
            assert_near(row.peak_point[1], 11 / 4.0, 1e-14);
        }
        conus_table_destroy(overlap);
        conus_roi_destroy(roi);
        conus_atlas_destroy(atlas);
    }
}

/* Six tetrahedra around a diagonal fill a box. Half a ball lies in it, measured by lines of half a millimetre; the rest
 * is in no object. A face across the lines is met exactly. */
static void tetrahedra_meet_surfaces(void **state)
{
    (void)state;
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    double corners[24][3];
    for (size_t i = 0; i < 6; i++) { /* from (-9, -9, -9) to (9, 9, 0), along the axes in each order */
        for (size_t k = 0; k < 4; k++) {
            for (size_t a = 0; a < 3; a++) {
                corners[4 * i + k][a] = -9;
            }
            for (size_t step = 0; step < k; step++) {
                corners[4 * i + k][orders[i][step]] = orders[i][step] == 2 ? 0 : 9;
            }
        }
    }
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh ball = mesh_scene_sphere((const double[]){0.1, 0.2, 0}, 7, 60, 90);
    mesh_scene_add(atlas, &ball);
    conus_roi *roi = tetrahedra_region((const double(*)[3])corners, 6);
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_int_equal(roi->voxels, 6);
    assert_near(region_scene_find(overlap, 1).fraction, 0.5, 0.001);
    assert_near(region_scene_find(overlap, 1).volume + region_scene_find(overlap, 0).volume, 18.0 * 18 * 9, 1e-9);
    conus_table_destroy(overlap);
    conus_atlas_destroy(atlas);
    atlas = mesh_scene_atlas();
    add_box(atlas, (const double[]){-20, -20, -20}, (const double[]){20, 20, -4.5});
    overlap = region_scene_overlap(atlas, roi, NULL);
    assert_near(region_scene_find(overlap, 1).roi_fraction, 0.5, 1e-9);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

/* Entries lie at the border of voxels; the answer says whether one is in a region of tetrahedra, too. */
static void sites_know_tetrahedra(void **state)
{
    (void)state;
    static const double corners[4][3] = {{0, 0, 0}, {6, 0, 0}, {0, 6, 0}, {0, 0, 6}};
    static const double points[4][3] = {{1, 1, 1}, {1.9, 1.9, 2.1}, {2.1, 2.1, 2}, {-0.1, 1, 1}};
    conus_roi *roi = tetrahedra_region(corners, 1);
    conus_sites *sites = NULL;
    assert_fails(conus_sites_of_roi(&sites, roi), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "tetrahedra of a mesh"));
    for (int inside = 0; inside < 2; inside++) {
        assert_ok(conus_sites_create(&sites, points[0], 4));
        conus_sites_keep_roi(sites, roi, inside);
        assert_int_equal(conus_sites_count(sites), 2);
        conus_sites_destroy(sites);
    }
    conus_roi_destroy(roi);
}

static conus_status make_overlap(void *data)
{
    const float values[] = {0, 1, 1, 0};
    conus_voxels voxels = region_scene_cubes(values, (const size_t[]){4, 1, 1}, 1, (const double[]){0, 1, 1});
    voxels.world_from_voxel[1] = 0.3; /* oblique: polyhedra need memory */
    conus_roi *roi = NULL;
    conus_table *overlap = NULL;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_roi_create(&roi, &voxels, NULL);
    status = status ? status : conus_overlap(&overlap, data, roi);
    status = status ? status : conus_report_create(&report, data, &(conus_report_options){.rows = "coverages"});
    status = status ? status : conus_report_add_table(report, "region", overlap);
    status = status ? status : conus_report_text(&text, &size, report);
    conus_report_destroy(report);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    return status;
}

struct asked {
    conus_selector *selector;
    conus_roi *roi;
};

static conus_status cover_tetrahedra(void *data)
{
    const struct asked *asked = data;
    conus_table *overlap = NULL;
    conus_status status = conus_overlap(&overlap, asked->selector, asked->roi);
    conus_table_destroy(overlap);
    return status;
}

/* What a report could not take is not in it, also once the table has ended. */
static conus_status report_cover(void *data)
{
    const struct asked *asked = data;
    conus_table *overlap = NULL;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_overlap(&overlap, asked->selector, asked->roi);
    status = status ? status
                    : conus_report_create(&report, asked->selector,
                                          &(conus_report_options){.rows = "coverages", .format = "tsv"});
    conus_status added = status ? status : conus_report_add_table(report, "taken", overlap);
    conus_table_destroy(overlap);
    if (!status && !conus_report_text(&text, &size, report)) {
        assert_int_equal(strstr(text, "\ntaken\t") != NULL, !added);
    }
    if (!status && !conus_report_sidecar(&text, &size, report)) {
        assert_int_equal(strstr(text, "\"taken\"") != NULL, !added);
    }
    status = status ? status : added ? added : conus_report_sidecar(&text, &size, report);
    conus_report_destroy(report);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_atlas *atlas = region_scene_slabs();
    conus_selector *selector = NULL;
    add_box(atlas, (const double[]){0, 0, 0}, (const double[]){4, 3, 2});
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    test_every_allocation(make_overlap, selector);
    static const double corners[4][3] = {{2, 1, 1}, {2, 6, 1}, {2, 1, 6}, {5, 3, 3}};
    struct asked asked = {selector, tetrahedra_region(corners, 1)};
    test_every_allocation(cover_tetrahedra, &asked);
    test_every_allocation(report_cover, &asked);
    conus_roi_destroy(asked.roi);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static void rows_belong_into_a_report_of_theirs(void **state)
{
    (void)state;
    conus_atlas *atlas = region_scene_slabs();
    conus_selector *selector = NULL;
    conus_report *report = NULL;
    conus_roi *roi = region_scene_whole(2, 1, (const double[]){0, 0, 0});
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_report_create(&report, selector, NULL));
    assert_fails(conus_report_add_table(report, "region", overlap), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(report);
    conus_selector_destroy(selector);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(overlap)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_in_nothing_comes_last),
        cmocka_unit_test(peaks_are_found),
        cmocka_unit_test(the_first_of_equal_peaks_counts),
        cmocka_unit_test(what_is_hidden_is_not_covered),
        cmocka_unit_test(hidden_pathways_are_not_covered),
        cmocka_unit_test(lines_along_edges_lose_nothing),
        cmocka_unit_test(a_ball_is_counted_by_its_inside),
        cmocka_unit_test(thin_surfaces_count_as_they_are),
        cmocka_unit_test(surfaces_count_in_the_region_only),
        cmocka_unit_test(surfaces_count_between_crossings),
        cmocka_unit_test(facing_does_not_matter_but_holes_do),
        cmocka_unit_test(tetrahedra_are_cut_by_voxels),
        cmocka_unit_test(tetrahedra_meet_surfaces),
        cmocka_unit_test(sites_know_tetrahedra),
        cmocka_unit_test(a_level_counts_what_is_in_two_parts_once),
        cmocka_unit_test(what_does_not_overlap_is_exact),
        cmocka_unit_test(what_overlaps_is_off_by_no_more_than_is_said),
        cmocka_unit_test(what_lines_pass_by_is_said),
        cmocka_unit_test(closed_surfaces_are_left_as_often_as_entered),
        cmocka_unit_test(what_is_no_region_is_refused),
        cmocka_unit_test(every_failing_allocation_is_survived),
        cmocka_unit_test(rows_belong_into_a_report_of_theirs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
