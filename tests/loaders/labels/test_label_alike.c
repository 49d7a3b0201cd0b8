/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables with another name in a volume's folder: those that belong to it are taken, similar ones that do not are
 * not. */
#include "base/files/file.h"
#include "builders/label_row.h"
#include "builders/nifti_builder.h"
#include "conus/atlas.h"
#include "loaders/labels/label_words.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* A row of 11 voxels holds labels 1 to 10. */
enum { COUNT = 11 };
static const char ten[] = "1 a\n2 b\n3 c\n4 d\n5 e\n6 f\n7 g\n8 h\n9 i\n10 j\n";
static const char other_ten[] = "1 q\n2 r\n3 s\n4 t\n5 u\n6 v\n7 w\n8 x\n9 y\n10 z\n";

static const char *words_of(const char *stem)
{
    static char text[256];
    struct label_words words;
    label_words_find(&words, text_from(stem));
    text[0] = '\0';
    for (size_t i = 0; i < words.count; i++) {
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "%s%.*s", i ? " " : "", (int)words.items[i].size,
                 words.items[i].data);
    }
    return text;
}

static void names_are_cut_into_words(void **state)
{
    (void)state;
    static const struct {
        const char *stem, *words;
    } names[] = {
        {"atl-Anatom", "Anatom"},
        {"atl-Anatom_space-MNI_dseg", "Anatom"},
        {"labels_X", "X"},
        {"JulichBrainAtlas31_LH", "Julich Brain 31"},
        {"AAL3v1_2mm", "AAL 3 v 1"},
        {"Schaefer2018_100Parcels_7Networks_order", "Schaefer 2018 100 Parcels 7 Networks order"},
        {"tpl-MNI152NLin6Asym_res-01_atlas-HOCPAL_desc-th25_dseg", "HOCPAL th 25"},
        {"atlas labels", ""},
        {"", ""},
        {"mm", "mm"},
        {"12 mm", "12 mm"},
    };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        assert_string_equal(words_of(names[i].stem), names[i].words);
    }
}

static void long_names_compare_with_none(void **state)
{
    (void)state;
    struct label_words words;
    struct label_words none = {.count = 0};
    char stem[3 * (LABEL_WORDS + 1) + 1] = "";
    for (size_t i = 0; i <= LABEL_WORDS; i++) {
        snprintf(stem + 3 * i, 4, "x%zu_", i % 10);
    }
    label_words_find(&words, text_from(stem));
    assert_true(words.overflow);
    assert_false(label_words_contain(&words, &none));
    assert_false(label_words_equal(&words, &words));
}

static void a_table_with_the_words_of_the_volume_is_taken(void **state)
{
    (void)state;
    static const char *const names[] = {"labels_X.txt", "X-atlas.csv", "x.txt", "atl-X.tsv", "X_2mm.lut", "names.txt"};
    test_folder("words");
    row_write("atlas_X.nii", COUNT, 1, NULL);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char source[64];
        char note[256];
        row_text(test_in(names[i]), ten);
        snprintf(source, sizeof source, "MRIcron text in %s", names[i]);
        snprintf(note, sizeof note,
                 "%s is taken for the label table of atlas_X.nii by its name: all labels have a name in it, and 10 of "
                 "its 10 names have voxels; --labels chooses another",
                 names[i]);
        assert_row_of("atlas_X.nii", "c", 3, source, note);
        unlink(test_in(names[i]));
    }
}

static void foreign_words_keep_a_table_away(void **state)
{
    (void)state;
    static const char *const names[] = {"labels_Y.txt", "X17.txt", "XY.txt", "X.md", "README.txt", "X_results.txt"};
    test_folder("foreign");
    row_write("atlas_X.nii", COUNT, 1, NULL);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        row_text(test_in(names[i]), ten);
        assert_row_of("atlas_X.nii", "3", 3, "none found", NULL);
        unlink(test_in(names[i]));
    }
}

/* The numbers must be those of the volume: 1 to 10. */
static void other_numbers_keep_a_table_away(void **state)
{
    (void)state;
    static const struct {
        const char *text, *note;
    } cases[] = {
        {"1 a\n2 b\n3 c\n4 d\n5 e\n6 f\n7 g\n8 h\n9 i\n",
         "labels.txt is not taken for the label table: it has no name for label 10 (of 10 voxels 1 have no name); "
         "--labels labels.txt uses it all the same"},
        {"0 a\n1 b\n2 c\n3 d\n4 e\n5 f\n6 g\n7 h\n8 i\n9 j\n", "it has no name for label 10"}, /* off by one */
        {"2 a\n3 b\n4 c\n5 d\n6 e\n7 f\n8 g\n9 h\n10 i\n11 j\n", "it has no name for label 1 (of 10"},
        {"0 z\n1 a\n2 b\n3 c\n4 d\n5 e\n6 f\n7 g\n8 h\n9 i\n10 j\n",
         "of its 10 names 10 have voxels, and it calls 0 an area; --labels"},
        {"0 Unknown\n1 a\n2 b\n3 c\n4 d\n5 e\n6 f\n7 g\n8 h\n9 i\n10 j\n11 k\n12 l\n",
         "of its 12 names 10 have voxels; --labels labels.txt uses it"}, /* 83 % */
    };
    test_folder("numbers");
    row_write("v.nii", COUNT, 1, NULL);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        row_text(test_in("labels.txt"), cases[i].text);
        assert_row("3", 3, "none found", cases[i].note);
    }
    row_text(test_in("labels.txt"), "0 Unknown\n1 a\n2 b\n3 c\n4 d\n5 e\n6 f\n7 g\n8 h\n9 i\n10 j\n11 k\n"); /* 91 % */
    assert_row("c", 3, "MRIcron text in labels.txt", "10 of its 11 names have voxels");
    row_text(test_in("labels.txt"), "1 a\n2.5 b\n");
    assert_row("3", 3, "none found", "labels.txt: MRIcron text: line 2: label \"2.5\"");
}

/* Labels 1 and 2 in 99,998 or 99,999 voxels and one stray voxel of label 9: one in 100,000 may have no name. */
static void a_stray_voxel_costs_no_names(void **state)
{
    (void)state;
    test_folder("stray");
    row_text(test_in("labels.txt"), "1 a\n2 b\n");
    for (int64_t named = 99998; named <= 99999; named++) {
        struct nifti_builder builder;
        nifti_begin(&builder, 1, false, 2, (int64_t[]){1000, 101, 1});
        for (int64_t i = 0; i < 101000; i++) {
            nifti_voxel(&builder, i < 50000 ? 1 : i < named ? 2 : i == named ? 9 : 0);
        }
        assert_ok(file_write(test_in("v.nii"), builder.bytes.data, builder.bytes.size));
        buffer_finish(&builder.bytes);
        if (named == 99998) {
            assert_row("2", 2, "none found", "it has no name for label 9 (of 99999 voxels 1 have no name)");
        } else {
            assert_row("b", 2, "MRIcron text in labels.txt",
                       "label 9 has no name in labels.txt: of 100000 voxels 1 have none");
        }
    }
}

static void a_table_of_another_volume_is_not_taken(void **state)
{
    (void)state;
    test_folder("several");
    row_write("v.nii", COUNT, 1, NULL);
    row_write("w.nii", COUNT, 1, NULL);
    row_text(test_in("labels.txt"), ten); /* it is unknown which one it belongs to */
    assert_row("3", 3, "none found", NULL);
    assert_row_of("w.nii", "3", 3, "none found", NULL);
    unlink(test_in("labels.txt"));
    row_text(test_in("labels_w.txt"), ten);
    assert_row("3", 3, "none found", NULL);
    assert_row_of("w.nii", "c", 3, "MRIcron text in labels_w.txt", "taken for the label table of w.nii");
    row_write("w_v.nii", COUNT, 1, NULL); /* has the word, too, and more: w.nii has just it */
    assert_row_of("w_v.nii", "3", 3, "none found", NULL);
    assert_row_of("w.nii", "c", 3, "MRIcron text in labels_w.txt", "taken for");
    unlink(test_in("w.nii"));
    unlink(test_in("labels_w.txt"));
    row_write("w_u.nii", COUNT, 1, NULL);
    row_text(test_in("labels_w.txt"), ten); /* w_v or w_u? */
    assert_row_of("w_v.nii", "3", 3, "none found", NULL);
    assert_row_of("w_u.nii", "3", 3, "none found", NULL);
    unlink(test_in("w_v.nii"));
    row_write("w_u_2mm.nii", 6, 2, NULL); /* one atlas in two sizes; the second has even labels only, half of them */
    assert_row_of("w_u.nii", "c", 3, "MRIcron text in labels_w.txt", "taken for");
    assert_row_of("w_u_2mm.nii", "4", 4, "none found", "of its 10 names 5 have voxels");
}

static void a_volume_without_words_has_the_table_without_words(void **state)
{
    (void)state;
    test_folder("wordless");
    row_write("atlas.nii", COUNT, 1, NULL);
    row_write("._atlas.nii", COUNT, 1, NULL); /* macOS's, which counts for nothing */
    row_text(test_in("._labels.csv"), other_ten);
    row_write("t1.nii", COUNT, 1, NULL);
    row_text(test_in("labels.csv"), ten);
    assert_row_of("atlas.nii", "c", 3, "MRIcron text in labels.csv", "taken for the label table of atlas.nii");
    assert_row_of("t1.nii", "3", 3, "none found", NULL);
    row_write("parcellation.nii", COUNT, 1, NULL); /* it is unknown which one it belongs to */
    assert_row_of("atlas.nii", "3", 3, "none found", NULL);
}

static void two_tables_are_compared(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    test_folder("pair");
    row_write("atlas_X.nii", COUNT, 1, NULL);
    row_text(test_in("labels.txt"), ten);
    row_text(test_in("names.txt"), other_ten); /* two without words: which? */
    assert_row_of("atlas_X.nii", "3", 3, "none found", NULL);
    unlink(test_in("names.txt"));
    unlink(test_in("labels.txt"));
    row_text(test_in("X-labels.txt"), ten);
    row_text(test_in("X-names.txt"), ten);
    assert_row_of("atlas_X.nii", "c", 3, "MRIcron text in X-labels.txt",
                  "X-names.txt fits the labels, too: --labels chooses it");
    row_text(test_in("X-names.txt"), other_ten);
    assert_row_of("atlas_X.nii", "c", 3, "MRIcron text in X-labels.txt",
                  "label 1 is \"a\" in MRIcron text in X-labels.txt, which is used, but \"q\" in MRIcron text in");
    row_text(test_in("X-names.txt"), "2 a\n3 b\n4 c\n5 d\n6 e\n7 f\n8 g\n9 h\n10 i\n1 j\n");
    assert_fails(conus_atlas_load(&atlas, test_in("atlas_X.nii"), NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "two label tables contradict each other: \"a\" is label 1 in"));
    row_text(test_in("atlas_X.txt"), other_ten); /* its own name counts more than any */
    assert_row_of("atlas_X.nii", "s", 3, "MRIcron text in atlas_X.txt", NULL);
}

static conus_status load(void *data)
{
    (void)data;
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, test_in("atlas_X.nii"), NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    test_folder("memory");
    row_write("atlas_X.nii", COUNT, 1, NULL);
    row_text(test_in("labels.csv"), ten);
    test_every_allocation(load, NULL);
    row_text(test_in("labels.csv"), "1 a\n");
    test_every_allocation(load, NULL);
    test_every_primitive(load, NULL);
}

TEST_GROUP(label_alike)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_cut_into_words),
        cmocka_unit_test(long_names_compare_with_none),
        cmocka_unit_test(a_table_with_the_words_of_the_volume_is_taken),
        cmocka_unit_test(foreign_words_keep_a_table_away),
        cmocka_unit_test(other_numbers_keep_a_table_away),
        cmocka_unit_test(a_stray_voxel_costs_no_names),
        cmocka_unit_test(a_table_of_another_volume_is_not_taken),
        cmocka_unit_test(a_volume_without_words_has_the_table_without_words),
        cmocka_unit_test(two_tables_are_compared),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
