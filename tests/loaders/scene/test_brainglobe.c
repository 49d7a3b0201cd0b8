/* SPDX-License-Identifier: BSD-3-Clause */
/* BrainGlobe folders with stacks: parcellation, context and manifest. tests/oracles/compare_brainglobe.py has all of
 * AAL in several orientations. */
#include "atlas/atlas.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "builders/tiff_builder.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { PAGES = 6, ROWS = 3, COLUMNS = 4 };

/* Six pages of 4 x 3: labels 1 and 2 fill a half each, or grey values that are no labels. */
static void write_stack(const char *name, bool grey)
{
    struct tiff_builder b;
    tiff_begin(&b);
    for (int page = 0; page < PAGES; page++) {
        uint8_t pixels[ROWS * COLUMNS];
        for (int i = 0; i < ROWS * COLUMNS; i++) {
            pixels[i] = (uint8_t)(grey ? 20 * page + i : page < PAGES / 2 ? 1 : 2);
        }
        tiff_add_page(&b, pixels, sizeof pixels, NULL, 0);
    }
    assert_ok(conus_write_file(test_in(name), b.bytes.data, b.bytes.size));
    buffer_finish(&b.bytes);
}

static void write_text(const char *name, const char *text)
{
    assert_ok(conus_write_file(test_in(name), text, strlen(text)));
}

static int write_folder(void **state)
{
    (void)state;
    test_folder("globes");
    mkdir(test_in("mouse"), 0777);
    mkdir(test_in("mouse/meshes"), 0777);
    write_stack("mouse/annotation.tiff", false);
    write_stack("mouse/reference.tiff", true);
    write_stack("mouse/hemispheres.tiff", false);
    write_text("mouse/metadata.json",
               "{\"orientation\": \"asr\", \"resolution\": [1000, 2000, 4000], \"shape\": [6, 3, 4]}");
    write_text("mouse/structures.json",
               "[{\"id\": 997, \"acronym\": \"root\", \"name\": \"Root\", \"structure_id_path\": [997], "
               "\"rgb_triplet\": [1, 2, 3]}, {\"id\": 1, \"acronym\": \"F\", \"name\": \"Front\", "
               "\"structure_id_path\": [997, 1]}, {\"id\": 2, \"acronym\": \"B\", \"name\": \"Back\", "
               "\"structure_id_path\": [997, 2]}]");
    write_text("mouse/meshes/1.obj",
               "v 0 0 0\nv 1000 0 0\nv 0 2000 0\nv 0 0 3000\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    return 0;
}

static void assert_voxels(const conus_atlas *atlas)
{
    assert_int_equal(conus_atlas_object(atlas, 1)->label, 1);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "Front");
    assert_near(conus_atlas_object(atlas, 1)->volume_mm3, 36 * 8, 1e-9); /* of 1 x 2 x 4 mm each */
    assert_string_equal(conus_atlas_object(atlas, 2)->name, "Back");
    assert_string_equal(conus_atlas_object(atlas, conus_atlas_object(atlas, 1)->parent)->name, "Root");
}

static void a_folder_is_its_voxels_and_its_reference(void **state)
{
    (void)state;
    conus_atlas *atlas;
    assert_ok(conus_atlas_load(&atlas, test_in("mouse"), NULL));
    assert_voxels(atlas);
    assert_int_equal(conus_atlas_volume_count(atlas), 2);
    assert_int_equal(conus_atlas_volume(atlas, 1)->role, CONUS_ROLE_CONTEXT);
    assert_true(test_has_note(atlas, "hemispheres.tiff (1 is left, 2 is right) is not used"));
    assert_int_equal(atlas->files.count, 2); /* metadata.json, structures.json */
    conus_atlas_destroy(atlas);

    assert_ok(conus_atlas_load(&atlas, test_in("mouse/annotation.tiff"), NULL));
    assert_voxels(atlas);
    assert_int_equal(conus_atlas_volume_count(atlas), 1);
    assert_false(test_has_note(atlas, "hemispheres"));
    conus_atlas_destroy(atlas);
}

static void its_meshes_are_named_and_placed_likewise(void **state)
{
    (void)state;
    test_need_conus_mesh();
    static const char *const paths[] = {"mouse/meshes", "mouse/meshes/"};
    for (size_t i = 0; i < 2; i++) {
        conus_atlas *atlas;
        assert_ok(conus_atlas_load(&atlas, test_in(paths[i]), NULL));
        assert_string_equal(conus_atlas_object(atlas, 1)->name, "Front");
        assert_near(conus_atlas_object(atlas, 1)->volume_mm3, 1, 1e-5); /* 1 * 2 * 3 / 6 */
        const float *positions = atlas_object_mesh(atlas, 1)->positions;
        const float wanted[3] = {-3, -1, -2}; /* axis 2 goes to the left, axis 0 backwards, axis 1 down */
        for (size_t k = 0; k < 3; k++) {
            float least = 0;
            for (size_t v = 0; v < 4; v++) {
                least = positions[3 * v + k] < least ? positions[3 * v + k] : least;
            }
            assert_near(least, wanted[k], 1e-6);
        }
        assert_true(test_has_note(atlas, "axes start at \"asr\""));
        conus_atlas_destroy(atlas);
    }
}

static void a_manifest_of_it_loads(void **state)
{
    (void)state;
    conus_atlas *atlas;
    struct bytes text = {0};
    static const char wanted[] = "{\n  \"conus_atlas\": 1,\n  \"parcellation\": {\n    \"file\": \"annotation.tiff\"\n"
                                 "  },\n  \"context\": {\n    \"file\": \"reference.tiff\"\n  }\n}\n";
    assert_ok(conus_manifest_write(test_in("mouse/made.atlas.json"), NULL));
    assert_ok(file_read(&text, test_in("mouse/made.atlas.json"), 1 << 20));
    assert_int_equal(text.size, strlen(wanted));
    assert_memory_equal(text.data, wanted, text.size);
    bytes_finish(&text);
    assert_ok(conus_atlas_load(&atlas, test_in("mouse/made.atlas.json"), NULL));
    assert_voxels(atlas);
    conus_atlas_destroy(atlas);
    remove(test_in("mouse/made.atlas.json"));
}

/* Without a stack that can be placed, conus manifest takes the meshes, as it does without any stack. */
static void what_cannot_be_placed_is_left_out(void **state)
{
    (void)state;
    conus_atlas *atlas;
    test_need_conus_mesh();
    write_text("mouse/metadata.json",
               "{\"orientation\": \"asr\", \"resolution\": [1000, 2000, 4000], \"shape\": [6, 4, 3]}");
    assert_fails(conus_atlas_load(&atlas, test_in("mouse"), NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "shape: metadata.json says 6 x 4 x 3, the stack has 6 pages of 3 rows"));
    assert_ok(conus_manifest_write(test_in("mouse/made.atlas.json"), NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("mouse/made.atlas.json"), NULL));
    assert_int_equal(conus_atlas_volume_count(atlas), 0);
    conus_atlas_destroy(atlas);
    remove(test_in("mouse/made.atlas.json"));
    write_folder(state);
}

TEST_GROUP(brainglobe)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_folder_is_its_voxels_and_its_reference),
        cmocka_unit_test(its_meshes_are_named_and_placed_likewise),
        cmocka_unit_test(a_manifest_of_it_loads),
        cmocka_unit_test(what_cannot_be_placed_is_left_out),
    };
    return cmocka_run_group_tests(tests, write_folder, NULL);
}
