/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 20: the area at a point or near it, in closed form, and against a search of every cell. */
#include "selection/connectivity/connectivity.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "mesh_scene.h"
#include "scene.h"
#include "test.h"
#include "value_maps.h"

enum { SCENES = 60, POINTS = 200 };

/* Finds it as one of few points and as one of many, for which distances are prepared. */
static uint32_t find(const conus_atlas *atlas, double radius, double x, double y, double z)
{
    uint32_t found[2];
    for (size_t i = 0; i < 2; i++) {
        struct area_search search = {0};
        assert_ok(area_search_init(&search, atlas, radius, i ? SIZE_MAX : 1));
        found[i] = area_at(&search, (const double[]){x, y, z});
        area_search_finish(&search);
    }
    assert_int_equal(found[0], found[1]);
    return found[0];
}

/* Cells of 1 mm along x: label 2 at x from -0.5 to 0.5, label 1 from 3.5 to 4.5. Areas are numbered by label. */
static void test_the_nearest_cell_within_the_radius(void **state)
{
    (void)state;
    const conus_volume_info grid = scene_plain_grid((const size_t[]){5, 1, 1}, NULL);
    conus_atlas *atlas = scene_parcellation(&grid, (const uint32_t[]){2, 0, 0, 0, 1});
    assert_int_equal(find(atlas, 0, 0.25, 0, 0), 2);
    assert_int_equal(find(atlas, 0, 0.75, 0, 0), 0);
    assert_int_equal(find(atlas, 1, 1.5, 0, 0), 2); /* 1 mm away: the radius counts */
    assert_int_equal(find(atlas, 0.999, 1.5, 0, 0), 0);
    assert_int_equal(find(atlas, 9, 2, 0, 0), 1); /* 1.5 mm from both: the lower number, though it is found later */
    assert_int_equal(find(atlas, 9, 1.99, 0, 0), 2);
    assert_int_equal(find(atlas, 5, 4, 3.5, 4.5), 1); /* 3 and 4 mm beside the cell: 5 mm */
    assert_int_equal(find(atlas, 4.999, 4, 3.5, 4.5), 0);
    assert_int_equal(find(atlas, 100, 1e9, 0, 0), 0);
    assert_ok(conus_atlas_show(atlas, NULL, "1")); /* the label */
    assert_int_equal(find(atlas, 0, 4, 0, 0), 0);
    assert_int_equal(find(atlas, 9, 4, 0, 0), 2);
    conus_atlas_destroy(atlas);
}

/* Two grids of one cell of 2 mm each: label 7 round x = 0, label 3 round x = 1. They share x from 0 to 1. */
static void test_the_first_of_several_grids_counts(void **state)
{
    (void)state;
    static const double second[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 0, 0, 1};
    static const double first[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1};
    const size_t dim[3] = {1, 1, 1};
    const conus_volume_info infos[2] = {scene_plain_grid(dim, first), scene_plain_grid(dim, second)};
    struct label_voxels labels[2] = {0};
    assert_ok(label_voxels_of(&labels[0], (const uint32_t[]){7}, 1));
    assert_ok(label_voxels_of(&labels[1], (const uint32_t[]){3}, 1));
    struct labelled_volume volumes[2] = {{.info = &infos[0], .labels = &labels[0]},
                                         {.info = &infos[1], .labels = &labels[1]}};
    const struct label_table none = {0};
    struct notes notes = {0};
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_of(&atlas, volumes, 2, &none, "grids", &notes));
    assert_int_equal(atlas->objects[find(atlas, 0, 0.5, 0, 0) - 1].label, 7);
    assert_int_equal(atlas->objects[find(atlas, 0, 1.5, 0, 0) - 1].label, 3);
    assert_int_equal(find(atlas, 0, 2.5, 0, 0), 0);
    notes_finish(&notes);
    label_voxels_finish(&labels[0]);
    label_voxels_finish(&labels[1]);
    conus_atlas_destroy(atlas);
}

static void add_chances(conus_atlas *atlas, const char *name, uint32_t label, const float chances[4])
{
    conus_volume_info info = scene_plain_grid((const size_t[]){4, 1, 1}, NULL);
    const conus_object area = {
        .kind = CONUS_KIND_AREA, .label = label, .name = name, .abbreviation = "", .named = true};
    float *values = memory_copy(chances, 4, sizeof *values);
    assert_non_null(values);
    info.role = CONUS_ROLE_PROBABILITY;
    info.threshold = 0.25;
    assert_ok(area_of_values(atlas, &info, values, &area));
}

/* No area has less than 0.25. The first area is the nearest of the last cell: its cell ends 0.5 mm before x = 3. */
static void test_the_most_probable_area_counts(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, "none"));
    add_chances(atlas, "one", 1, (const float[]){0.5F, 0.5F, 0.75F, 0});
    add_chances(atlas, "two", 2, (const float[]){0.75F, 0.5F, 0.5F, 0.125F});
    assert_int_equal(find(atlas, 0, 0, 0, 0), 2);
    assert_int_equal(find(atlas, 0, 1, 0, 0), 1); /* as probable: the lower number */
    assert_int_equal(find(atlas, 0, 2, 0, 0), 1);
    assert_int_equal(find(atlas, 0, 3, 0, 0), 0);
    assert_int_equal(find(atlas, 0.5, 3, 0, 0), 1);
    conus_atlas_destroy(atlas);
}

/* A box of 10 mm and, 4 mm beside it, another. Triangles that face inwards have an inside, too. */
static void test_surfaces_have_an_inside_and_a_distance(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh box = mesh_scene_box((const double[]){0, 0, 0}, (const double[]){10, 10, 10});
    struct mesh turned = mesh_scene_box((const double[]){14, 0, 0}, (const double[]){24, 10, 10});
    mesh_scene_turn(&turned);
    mesh_scene_add(atlas, &box);
    mesh_scene_add(atlas, &turned);
    assert_int_equal(find(atlas, 0, 5, 5, 5), 1);
    assert_int_equal(find(atlas, 0, 15, 5, 5), 2);
    assert_int_equal(find(atlas, 0, 11, 5, 5), 0);
    assert_int_equal(find(atlas, 1, 11, 5, 5), 1);
    assert_int_equal(find(atlas, 9, 12, 5, 5), 1); /* 2 mm from both */
    assert_int_equal(find(atlas, 9, 12.5, 5, 5), 2);
    assert_int_equal(find(atlas, 0.5, 11, 5, 5), 0);
    conus_atlas_destroy(atlas);
}

/* near_take() tries every cell in the ball, in the order of the file. */
static uint32_t search_all(const conus_atlas *atlas, struct near *near, const double point[3], double radius)
{
    struct region ball;
    uint32_t best = 0;
    region_ball(&ball, point, radius);
    near_take(near, atlas, &ball);
    for (uint32_t area = 1; area <= atlas->area_count; area++) {
        double distance = near->objects[area].distance;
        if (distance <= radius && (!best || distance < near->objects[best].distance)) {
            best = area;
        }
    }
    return best;
}

static void test_random_scenes_as_a_search_of_all_cells(void **state)
{
    (void)state;
    uint64_t random = 20;
    size_t in = 0;
    size_t near_by = 0;
    for (int scene = 0; scene < SCENES; scene++) {
        conus_atlas *atlas = scene_atlas(&random, 12, 1);
        struct near near = {0};
        assert_ok(near_prepare(&near, atlas));
        for (int i = 0; i < POINTS; i++) {
            double radius = test_random(&random, 0.01, 6);
            double point[3];
            for (int a = 0; a < 3; a++) {
                point[a] = test_random(&random, -7, 7);
            }
            uint32_t wanted = search_all(atlas, &near, point, radius);
            uint32_t here = find(atlas, 0, point[0], point[1], point[2]);
            assert_int_equal(find(atlas, radius, point[0], point[1], point[2]), wanted);
            in += here != 0;
            near_by += wanted && !here;
        }
        near_finish(&near);
        conus_atlas_destroy(atlas);
    }
    assert_true(in > 100 && near_by > 1000); /* both ways were taken */
}

TEST_GROUP(area_at)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_nearest_cell_within_the_radius),
        cmocka_unit_test(test_the_first_of_several_grids_counts),
        cmocka_unit_test(test_the_most_probable_area_counts),
        cmocka_unit_test(test_surfaces_have_an_inside_and_a_distance),
        cmocka_unit_test(test_random_scenes_as_a_search_of_all_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
