/* SPDX-License-Identifier: BSD-3-Clause */
/* Queries and pictures of areas of probabilities; tests/corpus/probabilities/ has the files. All expected numbers
 * follow from the three volumes of 4 x 1 x 1 voxels below. */
#include "atlas/atlas.h"
#include "atlas/volume.h"
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "render/colour/colour.h"
#include "selection/selection.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* In percent: A reaches 25 % in voxels 2 and 3, B in 1 and 2, C nowhere; C's values alone could be taken for 0 to 1. */
static const double percent[3][4] = {{10, 24, 25, 80}, {0, 60, 90, 0}, {0, 0, 1, 0}};

static const char *xml(const char *type)
{
    static char text[512];
    snprintf(text, sizeof text,
             "<atlas><header><type>%s</type><images><imagefile>/maps</imagefile></images></header><data>"
             "<label index=\"0\">A</label><label index=\"1\">B</label><label index=\"2\">C</label></data></atlas>",
             type);
    return text;
}

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

/* The volumes divided by `divisor`, of 2 x 3 x 4 mm, the first voxel at (-10, -20, -30). */
static void write_maps(const char *path, int datatype, double divisor, size_t count)
{
    struct nifti_builder builder;
    nifti_begin(&builder, 1, false, datatype, (int64_t[]){4, 1, 1});
    nifti_set(&builder, "dim", 0, 4);
    nifti_set(&builder, "dim", 4, (double)count);
    for (size_t i = 0; i < 4 * count; i++) {
        nifti_voxel(&builder, percent[i / 4][i % 4] / divisor);
    }
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(builder.bytes.data, 1, builder.bytes.size, file), builder.bytes.size);
    assert_int_equal(fclose(file), 0);
    buffer_finish(&builder.bytes);
}

static conus_atlas *load(const char *name)
{
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_in(name), NULL));
    return atlas;
}

/* The code times the scale that was meant is T; the scale in float32 makes it 2e-8 less, or more. That voxel belongs to
 * T and more, and not to what is below T. */
static void what_is_written_as_a_threshold_reaches_it(void **state)
{
    (void)state;
    static const struct {
        double slope;
        int code; /* of three voxels one; the others have one less and one more */
        double threshold;
    } cases[] = {{0.01, 30, 0.3}, {0.01, 60, 0.6}, {0.01, 80, 0.8}, {1.0 / 255, 51, 0.2},
                 {1.0 / 3, 3, 1}, {0.1, 70, 7},    {0.1, 3, 0.3}};
    test_folder("thresholds");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct nifti_builder builder;
        conus_atlas *atlas = NULL;
        conus_roi *roi = NULL;
        double t = cases[i].threshold;
        assert_near(cases[i].code * cases[i].slope, t, 1e-12);
        nifti_begin(&builder, 1, i % 2, 4, (int64_t[]){3, 1, 1});
        nifti_set(&builder, "scl_slope", 0, cases[i].slope);
        for (int k = -1; k <= 1; k++) {
            nifti_voxel(&builder, cases[i].code + k);
        }
        assert_ok(conus_write_file(test_in("t.nii"), builder.bytes.data, builder.bytes.size));
        buffer_finish(&builder.bytes);
        const conus_band bands[] = {{-INFINITY, t, "below"}, {t, INFINITY, "above"}};
        assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
        assert_ok(conus_atlas_add_pathway(atlas, test_in("t.nii"), &(conus_pathway_options){.threshold = t}));
        assert_ok(conus_atlas_add_pathway(atlas, test_in("t.nii"),
                                          &(conus_pathway_options){.bands = bands, .band_count = 2}));
        assert_int_equal(conus_atlas_object(atlas, 1)->voxels, 2);
        assert_int_equal(conus_atlas_object(atlas, 2)->voxels, 1);
        assert_int_equal(conus_atlas_object(atlas, 3)->voxels, 2);
        assert_ok(conus_atlas_set_threshold(atlas, 1, t * (1 + 1e-5)));
        assert_int_equal(conus_atlas_object(atlas, 1)->voxels, 1);
        conus_atlas_destroy(atlas);
        assert_ok(conus_roi_load(&roi, test_in("t.nii"), &(conus_roi_options){.threshold = t}));
        assert_int_equal(roi->voxels, 2);
        conus_roi_destroy(roi);
    }
}

/* Both ends of the cylinder lie outside: it holds all four centres. A's voxels are 2 and 3, B's 1 and 2. */
static void overlapping_areas_are_all_reported(void **state)
{
    (void)state;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    test_folder("overlap");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    write_text(test_in("a.xml"), xml("Probabilistic"));
    conus_atlas *atlas = load("a.xml");
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .radius = 0.5, .resolution = 1};
    assert_ok(conus_pose_along(&pose, (double[]){-30, -20, -30}, (double[]){1, 0, 0}, NULL));
    assert_ok(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_select(&selection, selector, &pose, 0));
    const conus_result *b = conus_selection_result(selection, 0); /* from x = -9 on, 21 mm away */
    const conus_result *a = conus_selection_result(selection, 1); /* from x = -7 on */
    assert_int_equal(b->object, 2);
    assert_near(b->share, 1, 1e-12);
    assert_near(b->distance, 21, 1e-9);
    assert_near(b->mean_value, 0.75, 1e-7);
    assert_near(b->max_value, 0.9, 1e-7);
    assert_near(b->contact_value, 0.6, 1e-7); /* voxel 1 */
    assert_near(b->exit, 25, 1e-9);
    assert_int_equal(a->object, 1);
    assert_int_equal(a->pixels, 0);
    assert_near(a->entry, 23, 1e-9);
    assert_near(a->exit, 27, 1e-9);
    assert_near(a->mean_value, (0.25 + 0.8) / 2, 1e-7);
    assert_near(a->max_value, 0.8, 1e-7);
    assert_true(isnan(a->contact_value));      /* occluded: it has no contact */
    assert_near(a->cone_fraction, 0.5, 1e-12); /* 48 of 96 mm^3: voxel 2 counts for both */
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    assert_ok(conus_atlas_show(atlas, "A", NULL));
    assert_ok(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_select(&selection, selector, &pose, 0));
    assert_int_equal(conus_selection_result(selection, 0)->object, 1);
    assert_near(conus_selection_result(selection, 0)->distance, 23, 1e-9);
    assert_near(conus_selection_result(selection, 0)->contact_value, 0.25, 1e-7); /* voxel 2 */
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* Voxel 2 is A's with 0.25 and B's with 0.9, whichever comes first in the atlas. */
static void pictures_show_the_most_probable(void **state)
{
    (void)state;
    static const char *const orders[] = {"0}, {\"file\": \"maps.nii\", \"volume\": 1",
                                         "1}, {\"file\": \"maps.nii\", \"volume\": 0"};
    static const uint32_t wanted[][4] = {{0, 2, 2, 1}, {0, 1, 1, 2}};
    const conus_cut_view view = {.centre = {-7, -20, -30}, .mm_per_pixel = 2, .width = 4, .height = 1};
    test_folder("pictures");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    for (size_t i = 0; i < 2; i++) {
        char text[256];
        uint8_t rgba[16];
        uint32_t objects[4];
        struct volume joint;
        snprintf(text, sizeof text,
                 "{\"conus_atlas\": 1, \"probabilities\": [{\"file\": \"maps.nii\", \"volume\": %s}]}", orders[i]);
        write_text(test_in("m.atlas.json"), text);
        conus_atlas *atlas = load("m.atlas.json");
        assert_ok(conus_cut(rgba, objects, atlas, &view));
        assert_memory_equal(objects, wanted[i], sizeof objects);
        assert_ok(pathways_join(&joint, atlas, NULL, NULL));
        assert_int_equal(joint.voxel_count, 4);
        assert_memory_equal(joint.objects32, wanted[i], sizeof objects);
        volume_finish(&joint);
        conus_atlas_destroy(atlas);
    }
}

static void what_needs_labels_is_refused(void **state)
{
    (void)state;
    test_folder("labels");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    write_text(test_in("a.xml"), xml("Probabilistic"));
    conus_atlas *atlas = load("a.xml");
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT), CONUS_ERROR_UNSUPPORTED);
    assert_non_null(strstr(conus_message(), "areas of probabilities overlap"));
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED), CONUS_ERROR_UNSUPPORTED);
    assert_ok(conus_atlas_set_threshold(atlas, 2, 0.7));
    assert_int_equal(conus_atlas_object(atlas, 2)->voxels, 1);
    conus_atlas_destroy(atlas);
}

static void thresholds_are_probabilities(void **state)
{
    (void)state;
    static const double wrong[] = {-0.1, 1.01, NAN};
    conus_load_options options = {0};
    conus_atlas *atlas = NULL;
    test_folder("asked");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    write_text(test_in("a.xml"), xml("Probabilistic"));
    for (size_t i = 0; i < 3; i++) {
        options.probability = wrong[i];
        assert_fails(conus_atlas_load(&atlas, test_in("a.xml"), &options), CONUS_ERROR_ARGUMENT);
        assert_null(atlas);
    }
}

/* Each volume is read once, so its note stands once. */
static void what_is_no_number_is_said_once_for_a_volume(void **state)
{
    (void)state;
    test_folder("nan");
    write_maps(test_in("maps.nii"), 16, NAN, 3);
    write_text(test_in("m.atlas.json"), "{\"conus_atlas\": 1, \"probabilities\": [{\"file\": \"maps.nii\", \"names\": "
                                        "[\"a\", \"b\", \"c\"], \"scale\": 1}]}");
    conus_atlas *atlas = load("m.atlas.json");
    size_t said = 0;
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        said += strstr(conus_atlas_note(atlas, i), "4 voxels are not finite numbers") != NULL;
    }
    assert_int_equal(said, 3);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(probabilities)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_as_a_threshold_reaches_it),
        cmocka_unit_test(overlapping_areas_are_all_reported),
        cmocka_unit_test(pictures_show_the_most_probable),
        cmocka_unit_test(what_needs_labels_is_refused),
        cmocka_unit_test(thresholds_are_probabilities),
        cmocka_unit_test(what_is_no_number_is_said_once_for_a_volume),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
