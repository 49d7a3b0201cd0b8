/* SPDX-License-Identifier: BSD-3-Clause */
/* Clusters of a region of interest in closed form: neighbours, order, centres, maxima; their parts sum to the overlap.
 */
#include "atlas/volume.h"
#include "base/memory.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "region_scene.h"
#include "scene.h"
#include "tables.h"
#include "test.h"

#include <math.h>
#include <string.h>

static conus_table *part(const conus_atlas *atlas, const conus_roi *roi)
{
    conus_selector *selector = NULL;
    conus_table *clusters = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_clusters(&clusters, selector, roi));
    conus_selector_destroy(selector);
    return clusters;
}

/* Clusters of a map in the two slabs, x < 4 and x >= 4, of 1 mm voxels: of voxels of `edge` mm from `corner` on. */
static conus_table *part_map(const float *values, const size_t dim[3], double edge, const double corner[3],
                             double threshold)
{
    conus_atlas *atlas = region_scene_slabs();
    const conus_voxels voxels = region_scene_cubes(values, dim, edge, corner);
    conus_roi *roi = region_scene_make(&voxels, threshold);
    conus_table *clusters = part(atlas, roi);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
    return clusters;
}

/* Which row is number `index`, from 0, of this kind; as many as there are rows past the last. */
static size_t row_of(const conus_table *clusters, const char *kind, size_t index)
{
    size_t row = 0;
    while (row < conus_table_rows(clusters) &&
           (strcmp(table_text_at(clusters, "kind", row), kind) != 0 || index-- > 0)) {
        row++;
    }
    return row;
}

static bool has(const conus_table *clusters, const char *kind, size_t index)
{
    return row_of(clusters, kind, index) < conus_table_rows(clusters);
}

static double number_of(const conus_table *clusters, const char *kind, size_t index, const char *column)
{
    return table_number_at(clusters, column, row_of(clusters, kind, index));
}

static void check_voxels(const conus_table *clusters, size_t index, int64_t wanted)
{
    assert_int_equal(table_count_at(clusters, "voxels", row_of(clusters, "cluster", index)), wanted);
}

static void check_place(const conus_table *clusters, const char *prefix, size_t row, double x, double y, double z)
{
    double place[3];
    table_point_at(place, clusters, prefix, row);
    assert_near(place[0], x, 1e-9);
    assert_near(place[1], y, 1e-9);
    assert_near(place[2], z, 1e-9);
}

/* A voxel of 2 mm from x = 3 to 5: 4 mm3 are in the slab up to 3.5, 4 in the other; each slab has 256 mm3. */
static void one_voxel_is_a_cluster(void **state)
{
    (void)state;
    const float values[] = {0, 0, 7, 0};
    conus_table *clusters = part_map(values, (const size_t[]){4, 1, 1}, 2, (const double[]){-0.5, 3, 3}, 3);
    assert_int_equal(conus_table_rows(clusters), 4);
    assert_string_equal(table_text_at(clusters, "kind", 0), "cluster");
    assert_null(table_text_at(clusters, "name", 0));
    assert_int_equal(conus_table_objects(clusters)[0], 0);
    assert_int_equal(table_count_at(clusters, "cluster", 0), 1);
    check_voxels(clusters, 0, 1);
    assert_near(table_number_at(clusters, "volume_mm3", 0), 8, 1e-12);
    assert_true(isnan(table_number_at(clusters, "fraction", 0)));
    assert_near(table_number_at(clusters, "cluster_fraction", 0), 1, 0);
    assert_near(table_number_at(clusters, "peak", 0), 7, 0);
    check_place(clusters, "peak_", 0, 3.5, 3, 3);
    check_place(clusters, "centre_", 0, 3.5, 3, 3);
    for (size_t i = 1; i < 3; i++) {
        assert_string_equal(table_text_at(clusters, "kind", i), "area");
        assert_int_equal(conus_table_objects(clusters)[i], i);
        assert_near(table_number_at(clusters, "volume_mm3", i), 4, 1e-12);
        assert_near(table_number_at(clusters, "fraction", i), 4 / 256.0, 1e-12);
        assert_near(table_number_at(clusters, "cluster_fraction", i), 0.5, 1e-12);
        assert_true(isnan(table_number_at(clusters, "centre_x", i)));
        assert_true(conus_table_find(clusters, "voxels")->missing[i]);
    }
    assert_string_equal(table_text_at(clusters, "kind", 3), "maximum");
    assert_int_equal(conus_table_objects(clusters)[3], 1); /* of equal parts the first */
    assert_true(isnan(table_number_at(clusters, "volume_mm3", 3)));
    assert_near(table_number_at(clusters, "peak", 3), 7, 0);
    conus_table_destroy(clusters);
}

/* Corner to corner is one cluster; a voxel between two is none of theirs. */
static void corners_connect(void **state)
{
    (void)state;
    const float touching[8] = {[0] = 5, [7] = 4};
    conus_table *clusters = part_map(touching, (const size_t[]){2, 2, 2}, 1, (const double[]){0, 0, 0}, 3);
    check_voxels(clusters, 0, 2);
    assert_false(has(clusters, "cluster", 1));
    check_place(clusters, "centre_", 0, 4 / 9.0, 4 / 9.0, 4 / 9.0); /* weighted by 5 and 4 */
    conus_table_destroy(clusters);
    const float apart[3] = {5, 2, 4};
    clusters = part_map(apart, (const size_t[]){3, 1, 1}, 1, (const double[]){0, 0, 0}, 3);
    assert_int_equal(table_count_at(clusters, "cluster", row_of(clusters, "cluster", 1)), 2);
    conus_table_destroy(clusters);
    /* Rows and slices do not go on at the other end of the grid. */
    const float rows[4] = {0, 5, 0, 0};
    const float ends[6] = {0, 0, 5, 5, 0, 0};
    clusters = part_map(rows, (const size_t[]){2, 2, 1}, 1, (const double[]){0, 0, 0}, 3);
    check_voxels(clusters, 0, 1);
    conus_table_destroy(clusters);
    clusters = part_map(ends, (const size_t[]){3, 2, 1}, 1, (const double[]){0, 0, 0}, 3);
    check_voxels(clusters, 0, 1);
    check_voxels(clusters, 1, 1);
    conus_table_destroy(clusters);
}

/* Eight voxels round a hole: its middle is their centre of mass, as a mask. A mask has no maxima. */
static void a_ring_is_one_cluster(void **state)
{
    (void)state;
    const float values[9] = {2, 2, 2, 2, 0, 2, 2, 2, 2};
    conus_table *clusters = part_map(values, (const size_t[]){3, 3, 1}, 1, (const double[]){0, 0, 0}, 0);
    assert_int_equal(conus_table_rows(clusters), 2);
    check_voxels(clusters, 0, 8);
    check_place(clusters, "centre_", 0, 1, 1, 0);
    check_place(clusters, "peak_", 0, 0, 0, 0);
    assert_near(table_number_at(clusters, "cluster_fraction", 1), 1, 1e-12);
    conus_table_destroy(clusters);
}

/* Along x: two voxels, then single ones of 5, 7, 7. */
static void clusters_are_ordered_by_size_peak_and_place(void **state)
{
    (void)state;
    const float values[] = {5, 0, 7, 0, 7, 0, 4, 4};
    conus_table *clusters = part_map(values, (const size_t[]){8, 1, 1}, 1, (const double[]){0, 0, 0}, 3);
    static const double x[] = {6, 2, 4, 0};
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(table_count_at(clusters, "cluster", row_of(clusters, "cluster", i)), i + 1);
        assert_near(number_of(clusters, "cluster", i, "peak_x"), x[i], 1e-12);
    }
    conus_table_destroy(clusters);
}

/* One row of voxels of 1 mm from x = 0 on; maxima are at these, the highest first. */
static void check_maxima(const float *values, size_t count, double threshold, const double *x, size_t wanted)
{
    conus_table *clusters = part_map(values, (const size_t[]){count, 1, 1}, 1, (const double[]){0, 0, 0}, threshold);
    for (size_t i = 0; i < wanted; i++) {
        assert_near(number_of(clusters, "maximum", i, "peak_x"), x[i], 1e-12);
        assert_near(number_of(clusters, "maximum", i, "peak"), values[(size_t)x[i]], 0);
    }
    assert_false(has(clusters, "maximum", wanted));
    assert_false(has(clusters, "cluster", 1));
    conus_table_destroy(clusters);
}

static void maxima_are_apart_and_have_no_higher_neighbour(void **state)
{
    (void)state;
    /* 8 mm from each other; 7 mm; one that is too near the first, though not the second. */
    check_maxima((const float[]){9, 5, 5, 5, 5, 5, 5, 5, 8}, 9, 3, (const double[]){0, 8}, 2);
    check_maxima((const float[]){9, 5, 5, 5, 5, 5, 5, 8}, 8, 3, (const double[]){0}, 1);
    check_maxima((const float[]){9, 5, 5, 5, 7, 5, 5, 5, 5, 5, 5, 5, 8}, 13, 3, (const double[]){0, 12}, 2);
    /* A plateau counts once, by its first voxel; a shoulder has a higher neighbour, and is none. */
    check_maxima((const float[]){4, 8, 8, 8, 4}, 5, 3, (const double[]){1}, 1);
    check_maxima((const float[]){5, 5, 6, 6, 6, 6, 6, 6, 6, 6, 6, 7}, 12, 3, (const double[]){11}, 1);
    check_maxima((const float[]){6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 5}, 12, 3, (const double[]){0}, 1);
    /* Below 0 the lowest is the highest; of equal ones the first in the file. */
    check_maxima((const float[]){-4, -6, -4, -4, -4, -4, -4, -4, -4, -6, -4}, 11, -3, (const double[]){1, 9}, 2);
}

static void a_negative_threshold_has_clusters_below_it(void **state)
{
    (void)state;
    const float values[] = {-5, -3, 9, -3, -8, NAN, -4, INFINITY};
    conus_table *clusters = part_map(values, (const size_t[]){8, 1, 1}, 1, (const double[]){0, 0, 0}, -3);
    static const double peaks[] = {-8, -5, -4};
    static const int64_t sizes[] = {2, 2, 1};
    for (size_t i = 0; i < 3; i++) {
        assert_near(number_of(clusters, "cluster", i, "peak"), peaks[i], 0);
        check_voxels(clusters, i, sizes[i]);
    }
    assert_false(has(clusters, "cluster", 3));
    assert_near(table_number_at(clusters, "centre_x", 0), (3 * 3 + 4 * 8) / 11.0, 1e-9);
    conus_table_destroy(clusters);
}

/* Voxels of 1.3 mm, oblique, of random values, in voxels and perhaps in surfaces that lie in one another: then what is
 * in no object is estimated, in the region and in each cluster. */
static void check_sums(bool has_surfaces)
{
    enum { EDGE = 8, COUNT = EDGE * EDGE * EDGE, OBJECTS = 4 };
    float values[COUNT];
    uint64_t seed = 9;
    for (size_t i = 0; i < COUNT; i++) {
        seed = seed * 6364136223846793005U + 1442695040888963407U;
        values[i] = (float)(seed >> 40) / (1 << 24);
    }
    conus_atlas *atlas = region_scene_slabs();
    struct mesh boxes[] = {mesh_scene_box((const double[]){-1, -1, -1}, (const double[]){2.3, 5, 6}),
                           mesh_scene_box((const double[]){1, 1, 1}, (const double[]){6, 3.3, 4})};
    for (size_t i = 0; i < 2; i++) {
        if (has_surfaces) {
            mesh_scene_add(atlas, &boxes[i]);
        } else {
            mesh_finish(&boxes[i]);
        }
    }
    conus_voxels voxels =
        region_scene_cubes(values, (const size_t[]){EDGE, EDGE, EDGE}, 1.3, (const double[]){-1, -0.7, -0.6});
    voxels.world_from_voxel[1] = 0.4;
    conus_roi *roi = region_scene_make(&voxels, 0.9);
    conus_table *overlap = region_scene_overlap(atlas, roi, NULL);
    conus_table *clusters = part(atlas, roi);
    double sum[OBJECTS + 1] = {0};
    int64_t voxels_in = 0;
    size_t count = 0;
    for (size_t i = 0; i < conus_table_rows(clusters); i++) {
        const char *kind = table_text_at(clusters, "kind", i);
        bool is_whole = strcmp(kind, "cluster") == 0;
        bool is_part = !is_whole && strcmp(kind, "maximum") != 0;
        sum[conus_table_objects(clusters)[i]] += is_part ? table_number_at(clusters, "volume_mm3", i) : 0;
        voxels_in += table_count_at(clusters, "voxels", i); /* 0 where it is n/a */
        count += is_whole;
    }
    assert_true(count > 10);
    assert_int_equal(voxels_in, roi->voxels);
    assert_int_equal(conus_table_rows(overlap), has_surfaces ? OBJECTS + 1 : 3);
    for (size_t i = 0; i < conus_table_rows(overlap); i++) {
        uint32_t object = conus_table_objects(overlap)[i];
        double error = table_number_at(overlap, "volume_error_mm3", i);
        assert_near(sum[object], table_number_at(overlap, "volume_mm3", i), 1e-9 + error);
        assert_true((error > 0) == (has_surfaces && !object));
    }
    conus_table_destroy(clusters);
    conus_table_destroy(overlap);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

static void parts_sum_to_the_overlap(void **state)
{
    (void)state;
    check_sums(false);
    check_sums(true);
}

static void rows_are_written(void **state)
{
    (void)state;
    conus_atlas *atlas = region_scene_slabs();
    const float values[] = {0, 0, 7, 0};
    const conus_voxels voxels = region_scene_cubes(values, (const size_t[]){4, 1, 1}, 2, (const double[]){-0.5, 3, 3});
    conus_roi *roi = region_scene_make(&voxels, 3);
    conus_table *clusters = part(atlas, roi);
    conus_selector *selector = NULL;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    const conus_report_options options = {.rows = "clusters", .format = "tsv"};
    assert_ok(conus_report_create(&report, selector, &options));
    assert_ok(conus_report_add_table(report, "map", clusters));
    assert_ok(conus_report_text(&text, &size, report));
    assert_string_equal(text,
                        "query\tcluster\tkind\tindex\tname\tvolume_mm3\tfraction\tcluster_fraction\tpeak\tpeak_x\t"
                        "peak_y\tpeak_z\tvoxels\tcentre_x\tcentre_y\tcentre_z\n"
                        "map\t1\tcluster\tn/a\tn/a\t8\tn/a\t1\t7\t3.5\t3\t3\t1\t3.5\t3\t3\n"
                        "map\t1\tarea\t1\t1\t4\t0.015625\t0.5\t7\t3.5\t3\t3\tn/a\tn/a\tn/a\tn/a\n"
                        "map\t1\tarea\t2\t2\t4\t0.015625\t0.5\t7\t3.5\t3\t3\tn/a\tn/a\tn/a\tn/a\n"
                        "map\t1\tmaximum\t1\t1\tn/a\tn/a\tn/a\t7\t3.5\t3\t3\tn/a\tn/a\tn/a\tn/a\n");
    conus_report_destroy(report);
    assert_ok(conus_report_create(&report, selector, NULL));
    assert_fails(conus_report_add_table(report, "map", clusters), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(report);
    conus_selector_destroy(selector);
    conus_table_destroy(clusters);
    conus_roi_destroy(roi);
    conus_atlas_destroy(atlas);
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    conus_atlas *atlas = region_scene_slabs();
    conus_selector *selector = NULL;
    conus_table *clusters = NULL;
    double nodes[4][3] = {{0, 0, 0}, {6, 0, 0}, {0, 6, 0}, {0, 0, 6}};
    conus_roi *roi = region_scene_whole(2, 1, (const double[]){0, 0, 0});
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_fails(conus_clusters(NULL, selector, roi), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_clusters(&clusters, NULL, roi), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_clusters(&clusters, selector, NULL), CONUS_ERROR_ARGUMENT);
    roi->nodes = nodes;
    assert_fails(conus_clusters(&clusters, selector, roi), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "clusters are of voxels"));
    roi->nodes = NULL;
    assert_null(clusters);
    conus_roi_destroy(roi);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static conus_status make_clusters(void *data)
{
    const float values[] = {5, 0, 5, 4, 4, 0, 9, 0};
    conus_voxels voxels = region_scene_cubes(values, (const size_t[]){8, 1, 1}, 1, (const double[]){0, 1, 1});
    voxels.world_from_voxel[1] = 0.3; /* oblique: polyhedra need memory */
    conus_roi *roi = NULL;
    conus_table *clusters = NULL;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_roi_create(&roi, &voxels, &(conus_roi_options){.threshold = 3});
    status = status ? status : conus_clusters(&clusters, data, roi);
    status = status ? status : conus_report_create(&report, data, &(conus_report_options){.rows = "clusters"});
    status = status ? status : conus_report_add_table(report, "region", clusters);
    status = status ? status : conus_report_text(&text, &size, report);
    conus_report_destroy(report);
    conus_table_destroy(clusters);
    conus_roi_destroy(roi);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_atlas *atlas = region_scene_slabs();
    conus_selector *selector = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    test_every_allocation(make_clusters, selector);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(region_clusters)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_voxel_is_a_cluster),
        cmocka_unit_test(corners_connect),
        cmocka_unit_test(a_ring_is_one_cluster),
        cmocka_unit_test(clusters_are_ordered_by_size_peak_and_place),
        cmocka_unit_test(maxima_are_apart_and_have_no_higher_neighbour),
        cmocka_unit_test(a_negative_threshold_has_clusters_below_it),
        cmocka_unit_test(parts_sum_to_the_overlap),
        cmocka_unit_test(rows_are_written),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
