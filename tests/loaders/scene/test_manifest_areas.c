/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces that a manifest names: files, patterns, BrainGlobe folders, their labels, names, place and tree. */
#include "atlas/atlas.h"
#include "base/buffer.h"
#include "base/files/file.h"
#include "conus/file.h"
#include "conus/phantom.h"
#include "conus/selection.h"
#include "loaders/surfaces/mesh_format.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
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

static void assert_refused(const char *keys, const char *message)
{
    conus_atlas *atlas;
    assert_fails(load(&atlas, keys), CONUS_ERROR_DATA);
    const char *after = strstr(conus_message(), "test.atlas.json: ");
    assert_non_null(after);
    assert_string_equal(after + strlen("test.atlas.json: "), message);
}

static void files_get_what_the_manifest_says(void **state)
{
    (void)state;
    conus_atlas *atlas =
        loaded("\"areas\": [{\"file\": \"b.gii\", \"label\": 9, \"name\": \"B\", \"abbreviation\": \"b\","
               "\"color\": \"#102030\", \"hemisphere\": \"L\", \"parent\": 4},"
               "{\"file\": \"a.gii\", \"label\": 4}]");
    const conus_object *first = conus_atlas_object(atlas, 1);
    const conus_object *second = conus_atlas_object(atlas, 2);
    assert_int_equal(conus_atlas_object_count(atlas), 2);
    assert_int_equal(first->label, 4);
    assert_string_equal(first->name, "In the file");
    assert_int_equal(first->triangles, 4);
    assert_near(first->volume_mm3, 6, 1e-6);
    assert_near(atlas_object_mesh(atlas, 1)->positions[0], 10, 0);
    assert_int_equal(second->label, 9);
    assert_string_equal(second->name, "B");
    assert_string_equal(second->abbreviation, "b");
    assert_int_equal(second->rgb[2], 0x30);
    assert_int_equal(second->hemisphere, 'L');
    assert_int_equal(second->parent, 1);
    assert_true(second->named);
    assert_near(atlas_object_mesh(atlas, 2)->positions[0], 20, 0);
    conus_atlas_destroy(atlas);
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

static void patterns_number_by_file_name(void **state)
{
    (void)state;
    write_text("names.txt", "2 Two\n7 Seven\n");
    conus_atlas *atlas =
        loaded("\"areas\": [{\"files\": \"set/*.gii\", \"labels\": \"names.txt\", \"label_offset\": 100,"
               "\"hemisphere\": \"R\"}, {\"files\": \"plain/*t.gii\"}]");
    static const struct {
        uint32_t label;
        const char *name;
        float x;
        char hemisphere;
    } wanted[] = {{1, "In the file", 30, 0}, {2, "In the file", 40, 0}, {102, "Two", 40, 'R'}, {107, "Seven", 30, 'R'}};
    assert_int_equal(conus_atlas_object_count(atlas), 4);
    for (size_t i = 0; i < 4; i++) {
        const conus_object *area = conus_atlas_object(atlas, i + 1);
        assert_int_equal(area->label, wanted[i].label);
        assert_string_equal(area->name, wanted[i].name);
        assert_int_equal(area->hemisphere, wanted[i].hemisphere);
        assert_near(atlas_object_mesh(atlas, (uint32_t)i + 1)->positions[0], wanted[i].x, 0);
    }
    conus_atlas_destroy(atlas);
}

/* 100 + 4294967290 would overflow to 94. */
static void parents_of_patterns_are_raised_or_refused(void **state)
{
    (void)state;
    write_text("far.tsv", "index\tname\tparent_id\n2\tTwo\t\n7\tSeven\t2\n");
    conus_atlas *atlas =
        loaded("\"areas\": [{\"files\": \"set/*.gii\", \"labels\": \"far.tsv\", \"label_offset\": 5}]");
    assert_int_equal(conus_atlas_object(atlas, 2)->label, 12);
    assert_int_equal(conus_atlas_object(atlas, 2)->parent, 1);
    conus_atlas_destroy(atlas);
    write_text("far.tsv", "index\tname\tparent_id\n2\tTwo\t4294967290\n7\tSeven\t2\n");
    assert_refused("\"areas\": [{\"files\": \"set/*.gii\", \"labels\": \"far.tsv\", \"label_offset\": 100}]",
                   "areas[0]: label_offset: 100 + 4294967290 is above 4294967295");
}

static void labels_that_clash_are_refused(void **state)
{
    (void)state;
    assert_refused("\"areas\": [{\"file\": \"a.gii\", \"label\": 4}, {\"file\": \"b.gii\", \"label\": 4}]",
                   "areas[1]: label 4 is that of a.gii and of b.gii: each needs its own (label, label_offset)");
    assert_refused("\"areas\": [{\"files\": \"*.gii\"}, {\"file\": \"set/area_02.gii\"}]",
                   "areas[1]: label 2 is that of b.gii and of area_02.gii: each needs its own (label, label_offset)");
    assert_refused("\"areas\": [\"a.gii\"]",
                   "areas[0]: label is missing (there is no number in the name a.gii either)");
    assert_refused("\"areas\": [{\"files\": \"*.ply\"}]", "areas[0]: files: no file matches *.ply");
    assert_refused("\"areas\": [{\"file\": \"a.gii\", \"label\": 1}], \"parcellation\": \"slabs.nii.gz\"",
                   "areas[0]: label 1 of a.gii is in the parcellation, too: say \"prefer\": \"areas\" or "
                   "\"parcellation\"");
    assert_ok(write_tetrahedron("set/other.gii", 0));
    assert_refused("\"areas\": [{\"files\": \"set/*\"}]",
                   "areas[0]: files: 2 of the 3 names hold a number, which gives the label: all or none must");
    remove(test_in("set/other.gii"));
}

static void a_surface_may_replace_voxels(void **state)
{
    (void)state;
    static const char keys[] =
        "\"prefer\": \"%s\", \"parcellation\": \"slabs.nii.gz\","
        "\"areas\": [{\"file\": \"a.gii\", \"label\": 300}, {\"file\": \"b.gii\", \"label\": 8}]";
    char text[512];
    snprintf(text, sizeof text, keys, "areas");
    conus_atlas *atlas = loaded(text);
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "Slab anterior");
    assert_int_equal(conus_atlas_object(atlas, 2)->label, 8);
    assert_string_equal(conus_atlas_object(atlas, 3)->name, "Slab posterior");
    assert_int_equal(conus_atlas_object(atlas, 3)->triangles, 4);
    const struct volume *volume = atlas_parcellation(atlas);
    for (size_t i = 0; i < volume->voxel_count; i++) {
        assert_true(volume_object(volume, i) <= 1);
    }
    assert_true(test_has_note(atlas, "both a surface and voxels: 1, the surfaces are taken"));
    conus_atlas_destroy(atlas);

    snprintf(text, sizeof text, keys, "parcellation");
    atlas = loaded(text);
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    assert_int_equal(conus_atlas_object(atlas, 2)->label, 300);
    assert_int_equal(conus_atlas_object(atlas, 2)->triangles, 0);
    assert_true(conus_atlas_object(atlas, 2)->voxels > 0);
    assert_int_equal(conus_atlas_object(atlas, 3)->label, 8);
    conus_atlas_destroy(atlas);
}

/* The side that the manifest states has priority over the table's. */
static void a_side_is_the_manifests(void **state)
{
    (void)state;
    static const struct {
        const char *stated;
        char hemisphere;
    } cases[] = {{"", 'R'}, {", \"hemisphere\": \"L\"", 'L'}, {", \"hemisphere\": \"R\"", 'R'}};
    static const char table[] = "index\tname\themisphere\n1\tSlab anterior\tL\n300\tSlab posterior\tR\n";
    assert_ok(conus_write_file(test_in("sides.tsv"), table, strlen(table)));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[512];
        snprintf(text, sizeof text,
                 "\"prefer\": \"areas\", \"parcellation\": {\"file\": \"slabs.nii.gz\", \"labels\": \"sides.tsv\"}, "
                 "\"areas\": [{\"file\": \"a.gii\", \"label\": 300%s}]",
                 cases[i].stated);
        conus_atlas *atlas = loaded(text);
        assert_int_equal(conus_atlas_object(atlas, 1)->hemisphere, 'L');
        assert_int_equal(conus_atlas_object(atlas, 2)->label, 300);
        assert_int_equal(conus_atlas_object(atlas, 2)->hemisphere, cases[i].hemisphere);
        conus_atlas_destroy(atlas);
    }
}

static void voxels_may_lie_in_a_surface(void **state)
{
    (void)state;
    write_text("tree.tsv", "index\tname\tparent_id\n1\tAnterior\t\n300\tPosterior\t1\n");
    conus_atlas *atlas =
        loaded("\"prefer\": \"areas\", \"parcellation\": {\"file\": \"slabs.nii.gz\", \"labels\": \"tree.tsv\"}, "
               "\"areas\": [{\"file\": \"a.gii\", \"label\": 1}]");
    assert_int_equal(conus_atlas_object_count(atlas), 2);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "Posterior");
    assert_string_equal(conus_atlas_object(atlas, 2)->name, "Anterior");
    assert_int_equal(conus_atlas_object(atlas, 1)->parent, 2);
    assert_false(test_has_note(atlas, "treated as a root"));
    conus_atlas_destroy(atlas);

    atlas = loaded("\"prefer\": \"areas\", \"parcellation\": {\"file\": \"slabs.nii.gz\", \"labels\": \"tree.tsv\"}, "
                   "\"areas\": [{\"file\": \"a.gii\", \"label\": 1}], \"tree\": [{\"label\": 7, \"name\": \"Whole\"}, "
                   "{\"label\": 300, \"parent\": 7}]");
    assert_string_equal(conus_atlas_object(atlas, 3)->name, "Whole");
    assert_int_equal(conus_atlas_object(atlas, 1)->parent, 3);
    conus_atlas_destroy(atlas);
}

static void the_tree_groups_areas(void **state)
{
    (void)state;
    conus_atlas *atlas =
        loaded("\"areas\": [{\"file\": \"a.gii\", \"label\": 1}, {\"file\": \"b.gii\", \"label\": 2,"
               "\"parent\": 50}], \"pathways\": [\"sphere.nii.gz\"], \"tree\": [{\"label\": 40, \"name\":"
               "\"Whole\"}, {\"label\": 50, \"parent\": 40, \"name\": \"Part\"}, {\"label\": 1, \"parent\": "
               "40}]");
    assert_int_equal(conus_atlas_object_count(atlas), 5);
    assert_string_equal(conus_atlas_object(atlas, 3)->name, "Whole");
    assert_int_equal(conus_atlas_object(atlas, 1)->parent, 3);
    assert_int_equal(conus_atlas_object(atlas, 2)->parent, 4);
    assert_int_equal(conus_atlas_object(atlas, 4)->parent, 3);
    assert_null(atlas_object_mesh(atlas, 3));
    assert_null(atlas_object_volume(atlas, 3));
    assert_int_equal(conus_atlas_object(atlas, 5)->kind, CONUS_KIND_PATHWAY);
    conus_atlas_destroy(atlas);

    atlas = loaded("\"parcellation\": \"slabs.nii.gz\", \"tree\": [{\"label\": 300, \"parent\": 1}]");
    assert_int_equal(conus_atlas_object(atlas, 2)->parent, 1);
    conus_atlas_destroy(atlas);

    assert_refused("\"areas\": [{\"file\": \"a.gii\", \"label\": 1, \"parent\": 2}, {\"file\": \"b.gii\", \"label\": 2,"
                   "\"parent\": 1}]",
                   "tree: label 1 lies below itself");
    struct buffer deep = {0};
    for (int i = 2; i < 68; i++) { /* label 1 has 67 - 1 areas above it */
        buffer_format(&deep, "{\"label\": %d, \"name\": \"part\", \"parent\": %d}, ", i - 1, i);
    }
    buffer_format(&deep, "{\"label\": 67, \"name\": \"part\"}");
    struct buffer manifest = {0};
    buffer_format(&manifest, "\"areas\": [{\"file\": \"a.gii\", \"label\": 1}], \"tree\": [%s]", deep.data);
    assert_refused(manifest.data, "tree: label 1 has more than 64 areas above it");
    buffer_finish(&deep);
    buffer_finish(&manifest);
    assert_refused("\"areas\": [{\"file\": \"a.gii\", \"label\": 1, \"parent\": 3}]",
                   "label 1: its parent 3 is no area (tree may name one)");
    assert_refused("\"areas\": [{\"file\": \"a.gii\", \"label\": 1}], \"tree\": [{\"label\": 3}]",
                   "tree: label 3 is no area, and a new one needs a name");
}

static void write_vertex_labels(const char *labels, int count)
{
    char text[1024];
    snprintf(
        text, sizeof text,
        "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"1\"><LabelTable><Label Key=\"0\">unknown</Label>"
        "<Label Key=\"3\" Red=\"1\" Green=\"0\" Blue=\"0\">Three</Label><Label Key=\"5\">Five</Label></LabelTable>"
        "<DataArray Intent=\"NIFTI_INTENT_LABEL\" DataType=\"NIFTI_TYPE_INT32\" ArrayIndexingOrder=\"RowMajorOrder\" "
        "Dimensionality=\"1\" Dim0=\"%d\" Encoding=\"ASCII\" Endian=\"LittleEndian\" ExternalFileName=\"\" "
        "ExternalFileOffset=\"\"><Data>%s</Data></DataArray></GIFTI>",
        count, labels);
    write_text("a.label.gii", text);
}

static void labels_of_vertices_cut_a_surface(void **state)
{
    (void)state;
    static const char keys[] = "\"areas\": [{\"file\": \"a.gii\", \"vertex_labels\": \"a.label.gii\","
                               "\"label_offset\": 10, \"hemisphere\": \"L\"}]";
    write_vertex_labels("3 3 5 5", 4);
    conus_atlas *atlas = loaded(keys);
    assert_int_equal(conus_atlas_object_count(atlas), 2);
    assert_int_equal(conus_atlas_object(atlas, 1)->label, 13);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "Three");
    assert_int_equal(conus_atlas_object(atlas, 1)->rgb[0], 255);
    assert_int_equal(conus_atlas_object(atlas, 1)->hemisphere, 'L');
    assert_int_equal(conus_atlas_object(atlas, 1)->triangles, 2);
    assert_int_equal(conus_atlas_object(atlas, 2)->label, 15);
    assert_int_equal(conus_atlas_object(atlas, 2)->triangles, 2);
    conus_atlas_destroy(atlas);

    write_vertex_labels("3 3 3 5", 4);
    atlas = loaded(keys);
    assert_int_equal(conus_atlas_object_count(atlas), 1);
    assert_int_equal(conus_atlas_object(atlas, 1)->triangles, 4);
    assert_true(test_has_note(atlas, "label 5 is on no triangle, left out"));
    conus_atlas_destroy(atlas);

    write_vertex_labels("3 3 3", 3);
    assert_refused(keys, "areas: vertex_labels: 3 labels, a.gii has 4 vertices: they must be as many");
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
    assert_ok(conus_select(&selection, selector, &pose, 30 * 3.14159265358979 / 180));
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
    assert_refused("\"areas\": [{\"brainglobe\": \"globe\", \"orientation\": \"asa\"}]",
                   "areas[0]: orientation: found \"asa\", one letter each of R or L, A or P, S or I is needed");
    write_text("globe/metadata.json", "{\"orientation\": \"lp");
    assert_fails(load(&atlas, "\"areas\": [{\"brainglobe\": \"globe\"}]"), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "globe/metadata.json: line 1, column 19:"));
    write_text("globe/metadata.json", "{\"orientation\": [\"lpi\"]}");
    assert_fails(load(&atlas, "\"areas\": [{\"brainglobe\": \"globe\"}]"), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "globe/metadata.json: orientation: a text of three letters is needed"));
    atlas = loaded("\"areas\": [{\"brainglobe\": \"globe\", \"orientation\": \"asr\"}]"); /* stated: not read */
    conus_atlas_destroy(atlas);
}

static conus_status load_again(void *data)
{
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, data, NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static void every_failing_allocation_is_reported(void **state)
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
    test_every_allocation(load_again, (void *)test_in("test.atlas.json"));
    assert_true(test_every_primitive(load_again, (void *)test_in("test.atlas.json")) > 5);
}

TEST_GROUP(manifest_areas)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_get_what_the_manifest_says),
        cmocka_unit_test(the_space_of_surfaces_can_be_stated),
        cmocka_unit_test(patterns_number_by_file_name),
        cmocka_unit_test(parents_of_patterns_are_raised_or_refused),
        cmocka_unit_test(labels_that_clash_are_refused),
        cmocka_unit_test(a_surface_may_replace_voxels),
        cmocka_unit_test(a_side_is_the_manifests),
        cmocka_unit_test(voxels_may_lie_in_a_surface),
        cmocka_unit_test(the_tree_groups_areas),
        cmocka_unit_test(labels_of_vertices_cut_a_surface),
        cmocka_unit_test(shapes_of_all_kinds_are_hit_by_one_cone),
        cmocka_unit_test(a_folder_of_surfaces_is_an_atlas),
        cmocka_unit_test(brainglobe_folders_are_placed_and_grouped),
        cmocka_unit_test(every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, write_files, NULL);
}
