/* SPDX-License-Identifier: BSD-3-Clause */
/* Names in manifests that are written, of real atlases, and of tables that are too large; tests/corpus/search/ has
 * small volumes with the tables beside them. */
#include "base/memory.h"
#include "builders/label_row.h"
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "loaders/labels/label_format.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* An atlas whose index k is called "area k", but that 2 and 3 have each other's name, and one whose points prove it. */
static const char swapped[] =
    "<atlas><type>Label</type><images><imagefile>/v</imagefile></images><label index=\"1\">area 1</label>"
    "<label index=\"2\">area 3</label><label index=\"3\">area 2</label><label index=\"4\">area 4</label></atlas>";
static const char proved[] =
    "<atlas><type>Probabilistic</type><images><imagefile>/prob</imagefile><summaryimagefile>/v</summaryimagefile></"
    "images>"
    "<label index=\"1\" x=\"1\" y=\"0\" z=\"0\">area 1</label><label index=\"2\" x=\"2\" y=\"0\" z=\"0\">area 2</label>"
    "<label index=\"3\" x=\"3\" y=\"0\" z=\"0\">area 3</label><label index=\"4\" x=\"4\" y=\"0\" z=\"0\">area "
    "4</label></atlas>";

static void a_manifest_is_written_with_the_proved_names(void **state)
{
    (void)state;
    test_folder("compared");
    row_write("v.nii", 5, 1);
    row_text(test_in("a.xml"), swapped);
    row_text(test_in("v.xml"), proved);
    assert_ok(conus_manifest_write(test_in("m.atlas.json"), NULL));
    assert_row_of("m.atlas.json", "area 2", 2, "FSL atlas XML in v.xml", "used is the XML, whose x y z agree");
}

/* Three volumes of two voxels, 50 and 100, and a table of their names. */
static void a_manifest_is_written_with_the_names_of_volumes(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct nifti_builder file;
    test_folder("written");
    nifti_begin(&file, 1, false, 2, (const int64_t[3]){2, 1, 1});
    nifti_set(&file, "dim", 0, 4);
    nifti_set(&file, "dim", 4, 3);
    for (int i = 0; i < 6; i++) {
        nifti_voxel(&file, 50 + 50 * (i % 2));
    }
    assert_ok(conus_write_file(test_in("p.nii"), file.bytes.data, file.bytes.size));
    buffer_finish(&file.bytes);
    row_text(test_in("p.txt"), "AF\nCST\nUF\n");
    assert_ok(conus_manifest_write(test_in("s.atlas.json"), NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("s.atlas.json"), NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "AF");
    assert_string_equal(conus_atlas_object(atlas, 3)->name, "UF");
    conus_atlas_destroy(atlas);
}

static void background_says_that_nothing_is_there(void **state)
{
    (void)state;
    static const char *const background[] = {
        "Air",         "air",
        "na",          "N/A",
        "*.*.*.*.*",   "*.*.*",
        "???",         "-",
        "0",           "Unknown",
        "no label",    "Outside brain",
        "Clear Label", "Background+FreeSurfer_Defined_Medial_Wall",
        "non-brain",   "unclassified",
        "_void_",      "",
    };
    static const char *const areas[] = {
        "Frontal Pole", "1", "V1", "airway", "Nucleus basalis", "Left I-IV", "\xc3\xa9tage", "Noradrenergic", "A 0",
    };
    for (size_t i = 0; i < sizeof background / sizeof background[0]; i++) {
        assert_true(label_is_background(text_from(background[i])));
    }
    for (size_t i = 0; i < sizeof areas / sizeof areas[0]; i++) {
        assert_false(label_is_background(text_from(areas[i])));
    }
}

static void real_atlases_have_no_contradictions(void **state)
{
    (void)state;
    static const char *const files[] = {
        "labelvol/bigbrain-subcort/bigbrain.nii.gz",
        "labelvol/julich31/JulichBrainAtlas31_LH.nii.gz",
        "labelvol/julich31/JulichBrainAtlas31_RH.nii.gz",
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        conus_atlas *atlas = NULL;
        assert_ok(conus_atlas_load(&atlas, test_shared(files[i]), NULL));
        assert_true(conus_atlas_object(atlas, 1)->named);
        assert_false(test_has_note(atlas, "which is used"));
        assert_false(test_has_note(atlas, "off by one"));
        conus_atlas_destroy(atlas);
    }
}

/* FSL's own files: every image of labels agrees with its XML, on either grid. */
static void real_fsl_atlases_are_proved(void **state)
{
    (void)state;
    static const struct {
        const char *image, *first;
    } images[] = {
        {"JHU/JHU-ICBM-labels-1mm", "Middle cerebellar peduncle"},
        {"JHU/JHU-ICBM-labels-2mm", "Middle cerebellar peduncle"},
        {"JHU/JHU-ICBM-tracts-maxprob-thr25-1mm", "Anterior thalamic radiation L"},
        {"JHU/JHU-ICBM-tracts-maxprob-thr25-2mm", "Anterior thalamic radiation L"},
        {"Thalamus/Thalamus-maxprob-thr25-2mm", "Primary motor"},
    };
    for (size_t i = 0; i < sizeof images / sizeof images[0]; i++) {
        conus_atlas *atlas = NULL;
        char path[256];
        snprintf(path, sizeof path, "prob/fsl/atlases/%s.nii.gz", images[i].image);
        assert_ok(conus_atlas_load(&atlas, test_shared(path), NULL));
        assert_string_equal(conus_atlas_object(atlas, 1)->name, images[i].first);
        assert_false(test_has_note(atlas, "although"));
        assert_false(test_has_note(atlas, "contradict"));
        assert_false(test_has_note(atlas, "off by one"));
        conus_atlas_destroy(atlas);
    }
}

/* Fails to load v.nii with the labels `name` for lack of allowed memory. */
static void assert_too_large(const char *name, uint64_t max_memory, const char *message)
{
    conus_atlas *atlas = NULL;
    char labels[512];
    snprintf(labels, sizeof labels, "%s", test_in(name));
    const conus_load_options options = {.labels = labels, .max_memory = max_memory};
    assert_fails(conus_atlas_load(&atlas, test_in("v.nii"), &options), CONUS_ERROR_MEMORY);
    if (!strstr(conus_message(), message)) {
        fail_msg("\"%s\" is not in \"%s\"", message, conus_message());
    }
}

static void write_repeated(const char *name, const char *start, const char *piece, size_t count, const char *end)
{
    struct buffer text = {0};
    buffer_text(&text, start);
    for (size_t i = 0; i < count; i++) {
        buffer_text(&text, piece);
    }
    buffer_text(&text, end);
    assert_ok(buffer_status(&text));
    assert_ok(conus_write_file(test_in(name), text.data, text.size));
    buffer_finish(&text);
}

/* A row of 4 bytes becomes an entry of 56 and a name; an object of 3 bytes of JSON some 200. */
static void tables_take_no_more_memory_than_is_allowed(void **state)
{
    (void)state;
    enum { MILLION = 1 << 20, MIB = 1 << 20 };
    test_folder("large");
    row_write("v.nii", 4, 1);
    write_repeated("rows.txt", "2 b\n3 c\n", "1 a\n", MILLION - 1, "");
    assert_too_large("rows.txt", 0, "more than 1048576 labels");
    assert_too_large("rows.txt", 64 * MIB, "file of 4194308 bytes, allowed are 1048576 (--max-memory)");
    write_repeated("list.json", "[{\"id\":1,\"acronym\":\"A\"}", ",{}", MILLION, "]");
    assert_too_large("list.json", 0, "that would take");
    write_repeated("sparse.txt", "1 a\n", "2 b\n", 10, "");
    assert_int_equal(truncate(test_in("sparse.txt"), 1LL << 32), 0);
    assert_too_large("sparse.txt", 0, "file of 4294967296 bytes, allowed are 16777216");
    assert_null(strstr(conus_message(), "--max-memory")); /* it would not help */
    assert_int_equal(rename(test_in("sparse.txt"), test_in("v.txt")), 0);
    row_text(test_in("v.csv"), "id,name\n1,A\n");
    assert_row("A", 1, "CSV label table in v.csv", "v.txt: 4294967296 bytes, a label table may have 16777216: passed");
}

TEST_GROUP(label_sources)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_manifest_is_written_with_the_proved_names),
        cmocka_unit_test(a_manifest_is_written_with_the_names_of_volumes),
        cmocka_unit_test(background_says_that_nothing_is_there),
        cmocka_unit_test(real_fsl_atlases_are_proved),
        cmocka_unit_test(real_atlases_have_no_contradictions),
        cmocka_unit_test(tables_take_no_more_memory_than_is_allowed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
