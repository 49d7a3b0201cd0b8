/* SPDX-License-Identifier: BSD-3-Clause */
/* The transforms of a manifest: the files that they move, and their order. */
#include "conus/own.h"
#include "test.h"

#include <string.h>

static void write_text(const char *name, const char *text)
{
    assert_ok(conus_write_file(test_in(name), text, strlen(text)));
}

static const char *write_manifest(const char *text)
{
    write_text("test.atlas.json", text);
    return test_in("test.atlas.json");
}

/* Where the first voxel of volume `index` is in x. */
static double first_x(const conus_atlas *atlas, size_t index)
{
    return conus_atlas_volume(atlas, index)->world_from_voxel[12];
}

/* The first file and then the second take a point x of the poses to 2 x + 7 in the areas' space. So a point at X comes
 * to (X - 7) / 2, and nothing else moves. The option's x + 4 comes on top: a pose's x is then x + 4 in the scene. */
static void a_transform_moves_the_areas_and_what_is_said_to_move(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    conus_atlas *plain = NULL;
    double point[3] = {1, 2, 3};
    write_text("twice.txt", "2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    write_text("less.txt", "1 0 0 -7\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    write_text("on_top.txt", "1 0 0 4\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    const char *path = write_manifest(
        "{\"conus_atlas\": 1, \"parcellation\": \"slabs.nii.gz\", \"threshold\": 0.5, "
        "\"transform\": [\"twice.txt\", {\"file\": \"less.txt\", \"inverse\": true}],"
        "\"pathways\": [{\"file\": \"sphere.nii.gz\", \"name\": \"Stays\"}, "
        "{\"file\": \"sphere.nii.gz\", \"name\": \"Moves\", \"moves\": true}], \"context\": \"sphere.nii.gz\"}");
    assert_ok(conus_atlas_load(&plain, test_in("sphere.nii.gz"), NULL));
    const double home = first_x(plain, 0);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_string_equal(conus_atlas_object(atlas, 3)->name, "Moves");
    assert_string_equal(conus_atlas_object(atlas, 4)->name, "Stays");
    assert_near(first_x(atlas, 0), (home - 7) / 2, 1e-12);
    assert_near(first_x(atlas, 1), (home - 7) / 2, 1e-12);
    assert_near(first_x(atlas, 2), home, 0);
    assert_near(first_x(atlas, 3), home, 0);
    conus_atlas_own_point(point, atlas, point);
    assert_near(point[0], 2 * 1 + 7, 1e-12);
    assert_string_equal(strrchr(conus_atlas_file(atlas, conus_atlas_file_count(atlas) - 1), '/'), "/twice.txt");
    assert_ok(conus_atlas_transform(atlas, test_in("on_top.txt"), NULL));
    assert_near(first_x(atlas, 0), (home - 7) / 2 - 4, 1e-12);
    assert_near(first_x(atlas, 3), home - 4, 1e-12);
    conus_atlas_own_point(point, atlas, (const double[]){1, 2, 3});
    assert_near(point[0], 2 * (1 + 4) + 7, 1e-12);
    conus_atlas_destroy(atlas);
    conus_atlas_destroy(plain);
}

struct attempt {
    char path[256];
};

static int write_volumes(void **state)
{
    (void)state;
    test_folder("moves");
    conus_status status = conus_phantom_write("slabs", test_in(""), &(conus_phantom_options){.size = 16});
    return status || conus_phantom_write("sphere", test_in(""), &(conus_phantom_options){.size = 16});
}

TEST_GROUP(manifest_move)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_transform_moves_the_areas_and_what_is_said_to_move),
    };
    return cmocka_run_group_tests(tests, write_volumes, NULL);
}
