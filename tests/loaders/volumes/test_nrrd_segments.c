/* SPDX-License-Identifier: BSD-3-Clause */
/* The segments of 3D Slicer in NRRD files: each layer has its own names, and no wrong ones. */
#include "builders/bent_text.h"
#include "builders/nifti_builder.h"
#include "loaders/volumes/text/text_volume.h"
#include "loaders/volumes/volume_file.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* Two layers that are stored together, as 3D Slicer writes overlapping segments. */
static const char layers[] =
    "NRRD0004\ntype: uchar\ndimension: 4\nspace: RAS\nsizes: 2 2 1 2\n"
    "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\nencoding: raw\n"
    "space origin: (0,0,0)\nmeasurement frame: (1,0,0) (0,1,0) (0,0,1)\n"
    "Segment0_Name:=Tumour\\nold\nSegment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Color:=1 0.5 0\n"
    "Segment1_Name:=Vessel\nSegment1_LabelValue:=1\nSegment1_Layer:=1\nSegment1_Color:=0 0 1\n"
    "Segment1_Tags:=x|y\nSegment2_ID:=Segment_3\nSegment2_LabelValue:=7\nSegment2_Layer:=0\n"
    "Segmentation_ReferenceImageExtentOffset:=5 6 7\n\n";

static conus_status parse_bent(struct text_volume *out, const char *text, const char *from, const char *to)
{
    struct buffer bytes = {0};
    struct notes notes = {0};
    append_bent(&bytes, text, from, to);
    conus_status status = parse_header(out, nrrd_parse, &bytes, &notes);
    buffer_finish(&bytes);
    notes_finish(&notes);
    return status;
}

static void each_layer_has_its_own_names(void **state)
{
    (void)state;
    struct text_volume volume;
    struct label_table table = {0};
    struct notes notes = {0};
    assert_ok(parse_bent(&volume, layers, NULL, NULL));
    assert_ok(text_volume_labels(&table, &volume, 0, &notes));
    assert_int_equal(table.count, 2);
    assert_int_equal(table.entries[0].number, 1);
    assert_string_equal(table.entries[0].name, "Tumour old");
    assert_true(table.entries[0].has_rgb);
    assert_int_equal(table.entries[0].rgb[0], 255);
    assert_int_equal(table.entries[0].rgb[1], 128); /* 0.5 of 255, rounded */
    assert_int_equal(table.entries[0].rgb[2], 0);
    assert_int_equal(table.entries[1].number, 7);
    assert_string_equal(table.entries[1].name, "Segment_3");
    assert_false(table.entries[1].has_rgb);
    label_table_finish(&table);
    assert_ok(text_volume_labels(&table, &volume, 1, &notes));
    assert_int_equal(table.count, 1);
    assert_string_equal(table.entries[0].name, "Vessel");
    label_table_finish(&table);
    end_header();
}

static void a_layer_is_an_atlas(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    buffer_text(&bytes, layers);
    buffer_append(&bytes, "\1\0\1\1\0\1\7\1", 8); /* voxels 1 1 0 7, and 0 1 1 1 */
    const char *path = write_bytes("s.seg.nrrd", &bytes);
    static const char *const names[2][2] = {{"Tumour old", "Segment_3"}, {"Vessel", NULL}};
    for (size_t k = 0; k < 2; k++) {
        conus_atlas *atlas = NULL;
        char chosen[300];
        snprintf(chosen, sizeof chosen, "%s,volume=%zu", path, k);
        assert_ok(conus_atlas_load(&atlas, chosen, NULL));
        assert_int_equal(conus_atlas_object_count(atlas), k ? 1 : 2);
        for (size_t i = 0; i < conus_atlas_object_count(atlas); i++) {
            assert_string_equal(conus_atlas_object(atlas, i + 1)->name, names[k][i]);
        }
        conus_atlas_destroy(atlas);
    }
    buffer_finish(&bytes);
}

/* Without value and layer each segment is a volume of 0 and 1. */
static void segments_without_layers_are_volumes(void **state)
{
    (void)state;
    struct text_volume volume;
    struct label_table table = {0};
    struct notes notes = {0};
    const char *at = strstr(layers, "Segment0_Name");
    struct buffer text = {0};
    buffer_append(&text, layers, (size_t)(at - layers));
    buffer_text(&text, "Segment0_Name:=A\nSegment1_Name:=B\n\n");
    assert_ok(parse_bent(&volume, text.data, NULL, NULL));
    for (size_t k = 0; k < 2; k++) {
        assert_ok(text_volume_labels(&table, &volume, k, &notes));
        assert_int_equal(table.count, 1);
        assert_int_equal(table.entries[0].number, 1);
        assert_string_equal(table.entries[0].name, k ? "B" : "A");
        label_table_finish(&table);
    }
    end_header();
    buffer_finish(&text);
}

static void segments_that_contradict_are_refused(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        {"Segment2_LabelValue:=7", "Segment2_LabelValue:=1",
         "label 1 of layer 0 is both \"Tumour old\" and \"Segment_3\""},
        {"Segment1_Layer:=1", "Segment1_Layer:=2", "Segment1_Layer: found 2, allowed are 0 to 1"},
        {"Segment1_Layer:=1\n", "", "Segment1_Layer: missing"},
        {"Segment0_LabelValue:=1\n", "", "Segment0_LabelValue: missing"},
        {"Segment0_LabelValue:=1", "Segment0_LabelValue:=0", "Segment0_LabelValue: found \"0\""},
        {"Segment0_LabelValue:=1", "Segment0_LabelValue:=4294967296", "allowed are 1 to 4294967295"},
        {"Color:=1 0.5 0", "Color:=1 0.5 2", "Segment0_Color: found 2, allowed are 0 to 1"},
        {"Color:=1 0.5 0", "Color:=1 0.5", "Segment0_Color: found \"1 0.5\", 3 numbers are needed"},
        {"Segment2_ID", "Segment1_Name", "Segment1_Name: found twice"},
        {"Segment2_ID", "Segment4096_ID", "Segment4096_ID: allowed are segments 0 to 4095"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct text_volume volume;
        assert_fails(parse_bent(&volume, layers, cases[i][0], cases[i][1]), CONUS_ERROR_DATA);
        assert_said(cases[i][2]);
    }
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    buffer_text(&bytes, layers);
    buffer_append(&bytes, "\1\0\1\1\0\1\7\1", 8);
    for (size_t size = 0; size < bytes.size; size++) {
        const struct buffer prefix = {.data = bytes.data, .size = size};
        struct volume_file file;
        struct notes notes = {0};
        char path[300];
        snprintf(path, sizeof path, "%s,volume=1", write_bytes("prefix.nrrd", &prefix));
        assert_fails(volume_file_open(&file, path, 0, &notes), CONUS_ERROR_DATA);
    }
    buffer_finish(&bytes);
}

static conus_status attempt(void *path)
{
    struct volume_file file = {0};
    struct notes notes = {0};
    struct label_table table = {0};
    conus_status status = volume_file_open(&file, path, 0, &notes);
    status = status ? status : text_volume_labels(&table, file.text, 0, &notes);
    label_table_finish(&table);
    volume_file_finish(&file);
    notes_finish(&notes);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    char path[300];
    buffer_text(&bytes, layers);
    buffer_append(&bytes, "\1\0\1\1\0\1\7\1", 8);
    snprintf(path, sizeof path, "%s,volume=1", write_bytes("layers.seg.nrrd", &bytes));
    test_every_allocation(attempt, path);
    assert_true(test_every_primitive(attempt, path) > 0);
    buffer_finish(&bytes);
}

TEST_GROUP(nrrd_segments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_layer_has_its_own_names),
        cmocka_unit_test(a_layer_is_an_atlas),
        cmocka_unit_test(segments_without_layers_are_volumes),
        cmocka_unit_test(segments_that_contradict_are_refused),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
