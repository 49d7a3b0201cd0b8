/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces that a manifest names: their place, and the sums of their files. tests/corpus/scene/ has labels and names.
 */
#include "atlas/atlas.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "conus/own.h"
#include "loaders/surfaces/surfaces.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static void write_text(const char *name, const char *text)
{
    assert_ok(conus_write_file(test_in(name), text, strlen(text)));
}

/* A tetrahedron of 6 mm^3 whose corner nearest to the origin is at (x, 0, 0). */
static conus_status write_tetrahedron(const char *name, float x)
{
    float positions[12] = {x, 0, 0, x + 6, 0, 0, x, 3, 0, x, 0, 2};
    uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    struct mesh mesh = {.positions = positions, .vertex_count = 4, .triangles = triangles, .triangle_count = 4};
    struct mesh_title title = {.label = 1, .name = "In the file", .space = "NIFTI_XFORM_SCANNER_ANAT"};
    struct buffer file = {0};
    conus_status status = mesh_format(&file, &mesh, &title, CONUS_MESH_GIFTI);
    status = status ? status : conus_write_file(test_in(name), file.data, file.size);
    buffer_finish(&file);
    return status;
}

static int write_files(void **state)
{
    (void)state;
    test_folder("areas");
    mkdir(test_in("set"), 0777);
    mkdir(test_in("plain"), 0777);
    conus_status status = conus_phantom_write("slabs", test_in(""), &(conus_phantom_options){.size = 16});
    status = status ? status : conus_phantom_write("sphere", test_in(""), &(conus_phantom_options){.size = 16});
    status = status ? status : write_tetrahedron("a.gii", 10);
    status = status ? status : write_tetrahedron("b.gii", 20);
    status = status ? status : write_tetrahedron("set/area_07.gii", 30);
    status = status ? status : write_tetrahedron("set/area_02.gii", 40);
    status = status ? status : write_tetrahedron("plain/left.gii", 30);
    return status || write_tetrahedron("plain/right.gii", 40);
}

/* Loads a manifest with these keys; a failure must leave nothing behind. */
static conus_status load(conus_atlas **atlas, const char *keys)
{
    struct buffer text = {0};
    *atlas = NULL;
    buffer_format(&text, "{\"conus_atlas\": 1, %s}", keys);
    assert_ok(buffer_status(&text));
    assert_ok(conus_write_file(test_in("test.atlas.json"), text.data, text.size));
    buffer_finish(&text);
    conus_status status = conus_atlas_load(atlas, test_in("test.atlas.json"), NULL);
    assert_true(!status == (*atlas != NULL));
    return status;
}

static conus_atlas *loaded(const char *keys)
{
    conus_atlas *atlas;
    assert_ok(load(&atlas, keys));
    return atlas;
}

static void the_space_of_surfaces_can_be_stated(void **state)
{
    (void)state;
    conus_atlas *atlas = loaded("\"space\": \"lps\", \"areas\": [{\"file\": \"a.gii\", \"label\": 1}]");
    assert_near(atlas_object_mesh(atlas, 1)->positions[3], -16, 0);
    assert_near(atlas_object_mesh(atlas, 1)->positions[7], -3, 0);
    assert_near(atlas_object_mesh(atlas, 1)->positions[11], 2, 0);
    conus_atlas_destroy(atlas);
}

/* A cone that hits a mesh, a labelled volume and a pathway. */
static void shapes_of_all_kinds_are_hit_by_one_cone(void **state)
{
    (void)state;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    conus_atlas *atlas = loaded("\"parcellation\": \"slabs.nii.gz\", \"areas\": [{\"file\": \"a.gii\", \"label\": 5}],"
                                "\"pathways\": [{\"file\": \"sphere.nii.gz\", \"name\": \"Ball\"}]");
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.engine = CONUS_ENGINE_RAYS}));
    assert_ok(conus_pose_along(&pose, (double[]){25, 1, 1}, (double[]){-1, 0, 0}, NULL));
    assert_ok(conus_select(&selection, selector, &pose, 30));
    bool hit[4] = {false};
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        assert_true(result->object <= 4);
        if (result->object && result->pixels) {
            hit[result->object - 1] = true;
        }
    }
    assert_true(hit[2] && hit[3]); /* the surface before the ball */
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static void a_folder_of_surfaces_is_an_atlas(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_in("set"), NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 2);
    assert_int_equal(conus_atlas_object(atlas, 1)->label, 2);
    assert_int_equal(conus_atlas_object(atlas, 2)->label, 7);
    assert_int_equal(atlas->files.count, 2);
    assert_int_equal(strlen(atlas->files.items[1].sha256), 64);
    assert_string_equal(atlas_path(atlas), test_in("set")); /* the path of the request, not that of its first surface */
    conus_atlas_destroy(atlas);
    atlas = loaded("\"areas\": [{\"file\": \"a.gii\", \"label\": 4}]");
    assert_int_equal(atlas->files.count, 2);
    assert_non_null(strstr(atlas_path(atlas), "test.atlas.json"));
    conus_atlas_destroy(atlas);
    assert_fails(conus_atlas_load(&atlas, test_scratch(""), NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "no surfaces in this folder"));
}

/* Whether `name` is among the atlas's files, with the sum that sha256sum prints for it. */
static void assert_file(const conus_atlas *atlas, const char *name)
{
    char command[600];
    char sum[65] = "";
    snprintf(command, sizeof command, "sha256sum %s", test_in(name));
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    assert_int_equal(fread(sum, 1, 64, pipe), 64);
    pclose(pipe);
    for (size_t i = 0; i < atlas->files.count; i++) {
        const char *at = strstr(atlas->files.items[i].path, name);
        if (at && strlen(at) == strlen(name)) {
            assert_string_equal(atlas->files.items[i].sha256, sum);
            return;
        }
    }
    fail_msg("%s is not among the %zu files", name, atlas->files.count);
}

static void write_brainglobe(void)
{
    static const char obj[] = "v 1000 2000 3000\nv 4000 2000 3000\nv 1000 6000 3000\nv 1000 2000 8000\n"
                              "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    mkdir(test_in("globe"), 0777);
    mkdir(test_in("globe/meshes"), 0777);
    write_text(
        "globe/structures.json",
        "[{\"id\": 997, \"acronym\": \"root\", \"name\": \"root\", \"structure_id_path\": [997], \"rgb_triplet\": "
        "[1, 2, 3]}, {\"id\": 8, \"acronym\": \"grey\", \"name\": \"Grey\", \"structure_id_path\": [997, 8]},"
        "{\"id\": 312782628, \"acronym\": \"P\", \"name\": \"Part\", \"structure_id_path\": [997, 8, 312782628]},"
        "{\"id\": 5, \"acronym\": \"x\", \"name\": \"Without mesh\", \"structure_id_path\": [997, 5]}]");
    write_text("globe/meshes/997.obj", obj);
    write_text("globe/meshes/312782628.obj", obj);
}

static void brainglobe_folders_are_placed_and_grouped(void **state)
{
    (void)state;
    write_brainglobe();
    conus_atlas *atlas = loaded("\"areas\": [{\"brainglobe\": \"globe\"}]");
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    assert_int_equal(conus_atlas_object(atlas, 1)->label, 312782628);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "Part");
    assert_near(conus_atlas_object(atlas, 1)->volume_mm3, 10, 1e-4); /* 3 * 4 * 5 / 6 */
    const float *corner = atlas_object_mesh(atlas, 1)->positions;
    assert_near(corner[0], -3, 1e-5); /* from the anterior, superior, right corner: x = -axis 2, y = -axis 0 */
    assert_near(corner[1], -1, 1e-5);
    assert_near(corner[2], -2, 1e-5);
    const conus_object *grey = conus_atlas_object(atlas, conus_atlas_object(atlas, 1)->parent);
    assert_string_equal(grey->name, "Grey");
    assert_string_equal(conus_atlas_object(atlas, grey->parent)->name, "root");
    assert_true(test_has_note(atlas, "axes start at \"asr\""));
    assert_int_equal(atlas->files.count, 3); /* the area is one of the two meshes */
    assert_file(atlas, "test.atlas.json");
    assert_file(atlas, "globe/structures.json");
    assert_file(atlas, "globe/meshes/312782628.obj");
    conus_atlas_destroy(atlas);

    assert_ok(conus_atlas_load(&atlas, test_in("globe"), NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    conus_atlas_destroy(atlas);

    write_text("globe/metadata.json", "{\"orientation\": \"lpi\"}");
    atlas = loaded("\"areas\": [{\"brainglobe\": \"globe\", \"structures\": \"all\", \"scale\": 1}]");
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    assert_int_equal(conus_atlas_object(atlas, 1)->label, 997);
    assert_int_equal(conus_atlas_object(atlas, 1)->triangles, 4);
    assert_near(atlas_object_mesh(atlas, 1)->positions[0], 1000, 0);
    assert_near(atlas_object_mesh(atlas, 1)->positions[1], 2000, 0);
    assert_int_equal(atlas->files.count, 5);
    assert_file(atlas, "globe/metadata.json");
    assert_file(atlas, "globe/meshes/997.obj");
    conus_atlas_destroy(atlas);
}

static void files_have_sums(void **state)
{
    (void)state;
    write_text("names.txt", "2 Two\n7 Seven\n");
    conus_atlas *atlas =
        loaded("\"prefer\": \"areas\", \"parcellation\": \"slabs.nii.gz\", \"areas\": ["
               "{\"files\": \"set/*.gii\", \"labels\": \"names.txt\", \"parent\": 40},"
               "{\"file\": \"a.gii\", \"label\": 300}], \"tree\": [{\"label\": 40, \"name\": \"Whole\"}]");
    assert_file(atlas, "names.txt");
    assert_file(atlas, "slabs.tsv");
    assert_file(atlas, "a.gii");
    conus_atlas_destroy(atlas);
}

TEST_GROUP(manifest_areas)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_space_of_surfaces_can_be_stated),
        cmocka_unit_test(shapes_of_all_kinds_are_hit_by_one_cone),
        cmocka_unit_test(a_folder_of_surfaces_is_an_atlas),
        cmocka_unit_test(brainglobe_folders_are_placed_and_grouped),
        cmocka_unit_test(files_have_sums),
    };
    return cmocka_run_group_tests(tests, write_files, NULL);
}
