/* SPDX-License-Identifier: BSD-3-Clause */
/* manifest.json of BrainGlobe's third release, and a whole atlas of it. Samples of another writer:
 * tests/oracles/compare_brainglobe.py. */
#include "loaders/brainglobe/brainglobe.h"

#include "atlas/atlas.h"
#include "base/memory.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define SIZES "\"name\":\"toy\",\"resolution\":[1000,2000,4000],\"shape\":[2,3,4]"
#define ANNOTATION "\"annotation_set\":{\"location\":\"/sets/a/1_2\"}"
#define NAMES "\"terminology\":{\"location\":\"/names/a/1_0\"}"
#define TEMPLATE "\"template\":{\"location\":\"/templates/a/1_1\"}"
#define WHOLE "{" SIZES ",\"symmetric\":false," ANNOTATION "," NAMES "," TEMPLATE "}"

static void places_count_from_the_root(void **state)
{
    (void)state;
    struct job job = {0};
    struct brainglobe_atlas atlas = brainglobe_atlas_parse(&job, text_from(WHOLE));
    assert_string_equal(atlas.annotation, "sets/a/1_2");
    assert_string_equal(atlas.terminology, "names/a/1_0");
    assert_string_equal(atlas.template, "templates/a/1_1");
    assert_near(atlas.metadata.resolution[2], 4000, 0);
    assert_int_equal(atlas.metadata.shape[2], 4);
    assert_false(atlas.is_symmetric);
    atlas = brainglobe_atlas_parse(&job, text_from("{" SIZES "," ANNOTATION "," NAMES "}"));
    assert_null(atlas.template);
    assert_true(atlas.is_symmetric);
    static const char inside[] = "{" SIZES ",\"annotation_set\":{\"location\":\"a\"," TEMPLATE "}," NAMES "}";
    atlas = brainglobe_atlas_parse(&job, text_from(inside));
    assert_string_equal(atlas.template, "templates/a/1_1");
    assert_ok(job_close(&job, NULL, NULL));
}

static void write_file(const char *folder, const char *name, const void *data, size_t size)
{
    char path[256];
    for (const char *slash = strchr(folder, '/'); slash; slash = strchr(slash + 1, '/')) {
        snprintf(path, sizeof path, "%.*s", (int)(slash - folder), folder);
        test_folder(path);
    }
    test_folder(folder);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_ok(file_write(test_scratch(path), data, size));
}

/* A store of one level, called fine, whose only chunk holds `voxels`, 2 x 3 x 4 of them; NULL = without that chunk. */
static void write_store(const char *folder, const void *voxels)
{
    static const char group[] =
        "{\"attributes\":{\"ome\":{\"multiscales\":[{\"axes\":[{\"unit\":\"millimeter\"},{\"unit\":\"millimeter\"},"
        "{\"unit\":\"millimeter\"}],\"datasets\":[{\"path\":\"fine\",\"coordinateTransformations\":[{\"type\":"
        "\"scale\",\"scale\":[1,2,4]}]}]}]}}}";
    static const char array[] =
        "{\"zarr_format\":3,\"node_type\":\"array\",\"attributes\":{},\"shape\":[2,3,4],\"data_type\":\"uint8\","
        "\"chunk_grid\":{\"name\":\"regular\",\"configuration\":{\"chunk_shape\":[2,3,4]}},\"chunk_key_encoding\":"
        "{\"name\":\"default\"},\"fill_value\":0,\"codecs\":[{\"name\":\"bytes\"}]}";
    char path[128];
    write_file(folder, "zarr.json", group, strlen(group));
    snprintf(path, sizeof path, "%s/fine", folder);
    write_file(path, "zarr.json", array, strlen(array));
    if (voxels) {
        snprintf(path, sizeof path, "%s/fine/c/0/0", folder);
        write_file(path, "0", voxels, 24);
        return;
    }
    static const char *const parts[] = {"c/0/0/0", "c/0/0", "c/0", "c"}; /* left by the test before */
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        snprintf(path, sizeof path, "%s/fine/%s", folder, parts[i]);
        remove(test_scratch(path));
    }
}

#define STORE "root/sets/a/1_2/annotations_compressed.ome.zarr"

/* Label 8 in 6 of 24 voxels, 9 in 3; identifiers are 10 times the labels. */
static void write_atlas(bool annotation, bool template)
{
    static const uint8_t voxels[24] = {8, 8, 8, 8, 8, 8, 9, 9, 9};
    static const char names[] =
        "identifier,parent_identifier,annotation_value,name,abbreviation,color_hex_triplet,root_identifier_path\n"
        "70,,7,root,root,#FFFFFF,[70]\n"
        "80,70,8,\"Area, layer 1\",NA,#08858C,\"[70, 80]\"\n"
        "90,80,9,Nucleus,nan,#010203,\"[70, 80, 90]\"\n";
    test_folder("root");
    write_file("root/atlases/toy_1000um/1_9", "manifest.json", "{\"annotation_set\":0}", 20);
    write_file("root/atlases/toy_1000um/1_10", "manifest.json", WHOLE, strlen(WHOLE));
    write_file("root/names/a/1_0", "terminology.csv", names, strlen(names));
    write_store(STORE, annotation ? voxels : NULL);
    write_store("root/templates/a/1_1/template.ome.zarr", template ? voxels : NULL);
    test_folder(STORE "/../hemispheres.ome.zarr");
}

static void an_atlas_has_names_parents_and_its_template(void **state)
{
    (void)state;
    static const char *const ways[] = {"root/atlases/toy_1000um/1_10", "root/atlases/toy_1000um/1_10/",
                                       "root/atlases/toy_1000um", "root/atlases/toy_1000um/1_10/manifest.json"};
    write_atlas(true, true);
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        conus_atlas *atlas;
        assert_ok(conus_atlas_load(&atlas, test_scratch(ways[i]), NULL));
        assert_int_equal(conus_atlas_volume_count(atlas), 2);
        assert_int_equal(conus_atlas_volume(atlas, 1)->role, CONUS_ROLE_CONTEXT);
        for (size_t n = 1; n <= 3; n++) {
            static const char *const names[] = {"root", "Area, layer 1", "Nucleus"};
            static const char *const short_names[] = {"root", "NA", "nan"};
            static const double volumes[] = {0, 6 * 8, 3 * 8}; /* voxels of 1 x 2 x 4 mm */
            const conus_object *object = conus_atlas_object(atlas, n);
            assert_int_equal(object->label, 6 + n);
            assert_string_equal(object->name, names[n - 1]);
            assert_string_equal(object->abbreviation, short_names[n - 1]);
            assert_int_equal(object->parent, n - 1); /* identifiers 70 and 80, labels 7 and 8 */
            assert_near(object->volume_mm3, volumes[n - 1], 1e-9);
        }
        assert_true(test_has_note(atlas, "hemispheres.ome.zarr (1 is left, 2 is right) is not used"));
        conus_atlas_destroy(atlas);
    }
}

static void what_was_not_downloaded_is_no_empty_brain(void **state)
{
    (void)state;
    conus_atlas *atlas;
    write_atlas(false, true);
    assert_fails(conus_atlas_load(&atlas, test_scratch("root/atlases/toy_1000um"), NULL), CONUS_ERROR_IO);
    assert_non_null(strstr(conus_message(), "the annotation of 1000 micrometres was not downloaded; python3 -c 'from "
                                            "brainglobe_atlasapi import BrainGlobeAtlas as B; "
                                            "B(\"toy_1000um\").annotation' does so"));
    write_atlas(true, false);
    assert_ok(conus_atlas_load(&atlas, test_scratch("root/atlases/toy_1000um"), NULL));
    assert_int_equal(conus_atlas_volume_count(atlas), 1);
    assert_true(test_has_note(atlas, "the template of 1000 micrometres was not downloaded, and is left out"));
    conus_atlas_destroy(atlas);
}

static void an_array_of_another_shape_is_refused(void **state)
{
    (void)state;
    static const char other[] =
        "{\"name\":\"toy\",\"resolution\":[1000,2000,4000],\"shape\":[2,3,5]," ANNOTATION "," NAMES "}";
    static const char finer[] =
        "{\"name\":\"toy\",\"resolution\":[500,1000,2000],\"shape\":[2,3,4]," ANNOTATION "," NAMES "}";
    conus_atlas *atlas;
    write_atlas(true, true);
    write_file("root/atlases/toy_1000um/1_10", "manifest.json", other, strlen(other));
    assert_fails(conus_atlas_load(&atlas, test_scratch("root/atlases/toy_1000um"), NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "shape: manifest.json says 2 x 3 x 5, the array has 2 x 3 x 4"));
    write_file("root/atlases/toy_1000um/1_10", "manifest.json", finer, strlen(finer));
    assert_fails(conus_atlas_load(&atlas, test_scratch("root/atlases/toy_1000um"), NULL), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "no level has voxels of 500 x 1000 x 2000 micrometres"));
}

static void a_link_out_of_the_root_is_refused(void **state)
{
    (void)state;
    conus_atlas *atlas;
    write_atlas(true, true);
    write_file("elsewhere", "terminology.csv", "", 0);
    remove(test_scratch("root/names/a/1_0/terminology.csv"));
    assert_int_equal(rmdir(test_scratch("root/names/a/1_0")), 0);
    assert_int_equal(symlink("../../../elsewhere", test_scratch("root/names/a/1_0")), 0);
    assert_fails(conus_atlas_load(&atlas, test_scratch("root/atlases/toy_1000um"), NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "a link leads to "));
    remove(test_scratch("root/names/a/1_0"));
}

TEST_GROUP(brainglobe_atlas)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_count_from_the_root),
        cmocka_unit_test(an_atlas_has_names_parents_and_its_template),
        cmocka_unit_test(what_was_not_downloaded_is_no_empty_brain),
        cmocka_unit_test(an_array_of_another_shape_is_refused),
        cmocka_unit_test(a_link_out_of_the_root_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
