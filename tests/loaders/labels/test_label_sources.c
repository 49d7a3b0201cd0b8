/* SPDX-License-Identifier: BSD-3-Clause */
/* The number to which a name belongs: the points of FSL atlas XMLs, and tables that contradict each other. */
#include "base/buffer.h"
#include "base/files/file.h"
#include "builders/label_row.h"
#include "builders/nifti_builder.h"
#include "conus/file.h"
#include "conus/manifest.h"
#include "loaders/labels/label_cells.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { AREAS = 6 };

/* An atlas whose label of index k, "area k", is at voxel k + shift[k] of the row `image` (no point where that is out
 * of the row). */
static void write_xml(const char *name, const char *type, const char *image, const int shift[AREAS + 1])
{
    struct buffer xml = {0};
    buffer_format(&xml, "<atlas><header><type>%s</type><images><imagefile>/prob</imagefile>", type);
    buffer_format(&xml, "<summaryimagefile>/%s</summaryimagefile></images></header><data>", image);
    for (int k = 0; k <= AREAS; k++) {
        buffer_format(&xml, "<label index=\"%d\" x=\"%d\" y=\"0\" z=\"0\">area %d</label>", k, k + shift[k], k);
    }
    buffer_text(&xml, "</data></atlas>");
    assert_ok(buffer_status(&xml));
    row_text(test_in(name), xml.data);
    buffer_finish(&xml);
}

static void assert_contradiction(const char *message)
{
    conus_atlas *atlas = NULL;
    assert_fails(conus_atlas_load(&atlas, test_in("v.nii"), NULL), CONUS_ERROR_DATA);
    if (!strstr(conus_message(), message)) {
        fail_msg("\"%s\" is not in \"%s\"", message, conus_message());
    }
    assert_null(atlas);
}

enum { AWAY = 99 };
#define BY_INDEX                                                                                                       \
    {                                                                                                                  \
        0, 0, 0, 0, 0, 0, 0                                                                                            \
    }
#define BY_NEXT                                                                                                        \
    {                                                                                                                  \
        1, 1, 1, 1, 1, 1, 1                                                                                            \
    }
#define NOWHERE                                                                                                        \
    {                                                                                                                  \
        AWAY, AWAY, AWAY, AWAY, AWAY, AWAY, AWAY                                                                       \
    }
static const int by_index[] = BY_INDEX;
static const int nowhere[] = NOWHERE;

/* The row has label x at voxel x. A point at voxel k means that index k is the label; one at k + 1 that the label is k
 * + 1. */
static void points_decide_between_index_and_the_next(void **state)
{
    (void)state;
    static const struct {
        const char *type;
        int shift[AREAS + 1];
        uint32_t area_2; /* number of the label with index 2 */
        const char *note;
    } cases[] = {
        {"Probabilistic", BY_NEXT, 3, NULL},
        {"Label", BY_INDEX, 2, NULL},
        {"Probabilistic", BY_INDEX, 2, "index of a label is its number in the volume: so say x y z of 6 of 7 labels"},
        {"Label", BY_NEXT, 3, "index + 1 of a label is its number in the volume: so say x y z of 7 of 7 labels"},
        {"Probabilistic", NOWHERE, 3, NULL},
        {"Label", NOWHERE, 2, "the label table calls label 0 \"area 0\", but 0 is background"},
        /* one point may be an accident, and so may less than half of them */
        {"Probabilistic", {AWAY, 0, AWAY, AWAY, AWAY, AWAY, AWAY}, 3, NULL},
        {"Probabilistic", {AWAY, 0, 0, AWAY, AWAY, AWAY, AWAY}, 2, "so say x y z of 2 of 2"},
        {"Probabilistic", {3, 0, 0, 3, 3, -2, -3}, 3, NULL},
        {"Probabilistic", {3, 0, 0, 0, 3, -2, AWAY}, 2, "so say x y z of 3 of 6"},
        /* four to one is too little, five to one enough */
        {"Probabilistic", {AWAY, 0, 0, 0, 0, 1, AWAY}, 3, NULL},
        {"Probabilistic", {1, 0, 0, 0, 0, 0, AWAY}, 2, "so say x y z of 5 of 6"},
    };
    test_folder("points");
    row_write("v.nii", 8, 1, NULL);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_xml("a.xml", cases[i].type, "v", cases[i].shift);
        assert_row("area 2", cases[i].area_2, "FSL atlas XML in a.xml", cases[i].note);
    }
}

/* Voxel k of the first image, of 2 mm, is at 2k mm, where the row of 1 mm has label 2k. Read as voxels of the row
 * itself, the point of index k would be at label k. */
static void points_are_voxels_of_the_first_image(void **state)
{
    (void)state;
    struct buffer xml = {0};
    test_folder("first");
    row_write("v.nii", 16, 1, NULL);
    row_write("coarse.nii", 8, 2, NULL);
    for (int k = 0; k < 2; k++) {
        buffer_clear(&xml);
        buffer_format(&xml, "<atlas><type>Probabilistic</type><images><summaryimagefile>/coarse</summaryimagefile>"
                            "</images><images><summaryimagefile>/v</summaryimagefile></images>");
        for (int voxel = 1; voxel < 7; voxel++) {
            buffer_format(&xml, "<label index=\"%d\" x=\"%d\" y=\"0\" z=\"0\">at %d mm</label>", 2 * voxel - k, voxel,
                          2 * voxel);
        }
        buffer_text(&xml, "</atlas>");
        row_text(test_in("a.xml"), xml.data);
        assert_row("at 6 mm", 6, "FSL atlas XML in a.xml", k ? NULL : "so say x y z of 6 of 6 labels");
    }
    buffer_finish(&xml);
}

static void an_index_0_that_is_background_counts_by_value(void **state)
{
    (void)state;
    test_folder("zero");
    row_write("v.nii", 4, 1, NULL);
    row_text(test_in("a.xml"),
             "<atlas><type>Probabilistic</type><images><summaryimagefile>/v</summaryimagefile></images>"
             "<label index=\"0\">*.*.*.*.*</label><label index=\"1\">one</label></atlas>");
    assert_row("one", 1, "FSL atlas XML in a.xml", "since index 0 is background");
}

static void a_given_atlas_is_checked_likewise(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    char xml[512];
    test_folder("given");
    row_write("v.nii", 8, 1, NULL);
    row_text(test_in("b.xml"),
             "<atlas><type>Label</type><images><imagefile>/v</imagefile></images>"
             "<label index=\"0\" x=\"1\" y=\"0\" z=\"0\">A</label><label index=\"1\" x=\"2\" y=\"0\" z=\"0\">B"
             "</label></atlas>");
    assert_ok(conus_atlas_load(&atlas, test_in("b.xml"), NULL));
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "A");
    conus_atlas_destroy(atlas);
    atlas = NULL;
    snprintf(xml, sizeof xml, "%s", test_in("b.xml"));
    const conus_load_options options = {.labels = xml};
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), &options));
    assert_string_equal(conus_atlas_object(atlas, 2)->name, "B");
    conus_atlas_destroy(atlas);
}

static void contradictions_are_never_silent(void **state)
{
    (void)state;
    test_folder("two");
    row_write("v.nii", 8, 1, NULL);
    write_xml("a.xml", "Probabilistic", "v", nowhere);
    write_xml("b.xml", "Label", "v", nowhere);
    assert_contradiction("v.nii: two label tables contradict each other: \"area 1\" is label 2 in FSL atlas XML in "
                         "a.xml, 1 in FSL atlas XML in b.xml; choose one with --labels");
    write_xml("b.xml", "Label", "v", by_index); /* proved: it wins, wherever it stands */
    assert_row("area 1", 1, "FSL atlas XML in b.xml", "\"area 1\" is label 2 in FSL atlas XML in a.xml, 1 in FSL");
    write_xml("a.xml", "Label", "v", by_index);
    write_xml("b.xml", "Probabilistic", "v", nowhere);
    assert_row("area 1", 1, "FSL atlas XML in a.xml", "used is the XML, whose x y z agree with the volume");
    write_xml("b.xml", "Probabilistic", "v", by_index); /* both atlases agree with the labels */
    assert_row("area 1", 1, "FSL atlas XML in a.xml", NULL);
    unlink(test_in("b.xml"));
    row_text(test_in("v.txt"), "1 area_1\n2 Area 2\n3 AREA-3\n");
    assert_row("area_1", 1, "MRIcron text in v.txt", NULL);
    row_text(test_in("v.txt"), "2 area_1\n3 Area 2\n4 AREA-3\n"); /* the points prove it wrong */
    assert_row("area 1", 1, "FSL atlas XML in a.xml", "\"area_1\" is label 2 in MRIcron text in v.txt, 1 in FSL");
    write_xml("a.xml", "Label", "v", nowhere);
    assert_contradiction("\"area_1\" is label 2 in MRIcron text in v.txt, 1 in FSL atlas XML in a.xml");
    unlink(test_in("a.xml"));
    row_text(test_in("v.csv"), "id,name\n1,area_1\n3,Area 2\n4,AREA-3\n"); /* one of three */
    assert_row("area_1", 2, "MRIcron text in v.txt",
               "\"area_1\" is label 2 in MRIcron text in v.txt, which is used, but 1 in CSV label table in v.csv");
    row_text(test_in("v.csv"), "id,name\n2,Motor\n3,Visual\n4,area 3\n");
    assert_row("area_1", 2, "MRIcron text in v.txt",
               "label 2 is \"area_1\" in MRIcron text in v.txt, which is used, but \"Motor\" in CSV label table");
    row_text(test_in("v.csv"), "id,name\n2,Motor\n3,area 2\n4,area 3\n"); /* two spellings */
    assert_row(
        "area_1", 2, "MRIcron text in v.txt",
        "label 2 is \"area_1\" in MRIcron text in v.txt, which is used, but \"Motor\" in CSV label table in v.csv "
        "(1 of 3 such labels)");
    row_text(test_in("v.csv"), "id,name\n2,area-1\n3,area 2\n4,area 3\n"); /* three */
    assert_row("area_1", 2, "MRIcron text in v.txt", NULL);
    row_text(test_in("v.csv"), "id,name,abbreviation\n2,Motor,area 1\n3,Visual,AREA_2\n"); /* long and short names */
    assert_row("area_1", 2, "MRIcron text in v.txt", NULL);
    row_text(test_in("v.csv"), "id,name\n1,damaged\n2.5,x\n");
    assert_row("area_1", 2, "MRIcron text in v.txt", "v.csv: CSV label table: line 3");
}

/* An atlas of type Label whose index k is called "area k", but that 2 and 3 have each other's name. */
static const char swapped[] =
    "<atlas><type>Label</type><images><imagefile>/v</imagefile></images><label index=\"1\">area 1</label>"
    "<label index=\"2\">area 3</label><label index=\"3\">area 2</label><label index=\"4\">area 4</label>"
    "<label index=\"5\">area 5</label><label index=\"6\">area 6</label></atlas>";

/* Two of six names have two numbers. The points of v.xml prove its own. */
static void an_atlas_is_compared_with_its_volume(void **state)
{
    (void)state;
    static const char note[] =
        "\"area 2\" is label 3 in FSL atlas XML in a.xml, which is used, but 2 in FSL atlas XML in "
        "v.xml (2 of 6 such names)";
    test_folder("compared");
    row_write("v.nii", 7, 1, NULL);
    row_text(test_in("a.xml"), swapped);
    write_xml("v.xml", "Probabilistic", "v", by_index);
    assert_row("area 2", 2, "FSL atlas XML in v.xml", "\"area 2\" is label 2 in FSL atlas XML in v.xml, 3 in FSL");
    assert_row_of("a.xml", "area 3", 2, "FSL atlas XML in a.xml", note);
    assert_ok(conus_manifest_write(test_in("m.atlas.json"), NULL));
    assert_row_of("m.atlas.json", "area 2", 2, "FSL atlas XML in v.xml", "used is the XML, whose x y z agree");
    row_text(test_in("v.txt"), "1 one\n"); /* a table beside the volume counts as well */
    assert_row_of(
        "a.xml", "area 3", 2, "FSL atlas XML in a.xml",
        "label 1 is \"area 1\" in FSL atlas XML in a.xml, which is used, but \"one\" in MRIcron text in v.txt");
    row_text(test_in("v.txt"), "1 area 2\n2 area 1\n"); /* and so does that the volume's tables contradict each other */
    write_xml("v.xml", "Label", "v", nowhere);
    assert_row_of("a.xml", "area 3", 2, "FSL atlas XML in a.xml", "v.nii: two label tables contradict each other");
}

/* Without a proof for either the XML with the volume's own name counts: X.xml is that of X-2mm.nii. */
static void a_volumes_own_name_comes_first(void **state)
{
    (void)state;
    test_folder("own");
    row_write("v.nii", 7, 1, NULL);
    write_xml("v.xml", "Label", "v", nowhere);
    row_text(test_in("a.xml"), swapped);
    assert_row("area 2", 2, "FSL atlas XML in v.xml", "which is used, but 3 in FSL atlas XML in a.xml");
    rename(test_in("v.xml"), test_in("w.xml"));
    assert_row("area 3", 2, "FSL atlas XML in a.xml", "which is used, but 2 in FSL atlas XML in w.xml");
}

/* Each volume has 0 and the label's number; "area 2" and "area 3" are exchanged in one of two XMLs. */
static void two_atlases_of_the_same_volumes_are_compared(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    char path[512];
    test_folder("volumes");
    struct nifti_builder builder;
    nifti_begin(&builder, 1, false, 2, (int64_t[]){3, 1, 1});
    nifti_set(&builder, "dim", 0, 4);
    nifti_set(&builder, "dim", 4, 3);
    for (int i = 0; i < 9; i++) {
        nifti_voxel(&builder, i % 4 == 0 ? i / 3 + 1 : 0);
    }
    assert_ok(file_write(test_in("p.nii"), builder.bytes.data, builder.bytes.size));
    buffer_finish(&builder.bytes);
    for (int k = 0; k < 2; k++) {
        struct buffer xml = {0};
        buffer_format(&xml, "<atlas><type>Probabilistic</type><images><imagefile>/p</imagefile></images>"
                            "<label index=\"0\">area 1</label>");
        buffer_format(&xml, "<label index=\"1\">area %d</label><label index=\"2\">area %d</label></atlas>", 2 + k,
                      3 - k);
        row_text(test_in(k ? "b.xml" : "a.xml"), xml.data);
        buffer_finish(&xml);
    }
    snprintf(path, sizeof path, "%s", test_in("a.xml"));
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_string_equal(conus_atlas_object(atlas, 2)->name, "area 2");
    assert_true(
        test_has_note(atlas, "\"area 2\" is label 2 in a.xml, which is used, but 3 in b.xml (2 of 3 such names)"));
    conus_atlas_destroy(atlas);
}

/* An index of SPM is the voxel's value, whatever the rest of the file: it has no points and no type. */
static void an_atlas_of_spm_names_its_image(void **state)
{
    (void)state;
    static const char labels[] = "<data><label><index>1</index><name>one</name></label><label><index>2</index><name>two"
                                 "</name></label></data></atlas>";
    struct buffer xml = {0};
    test_folder("spm");
    row_write("v.nii", 4, 1, NULL);
    row_write("w.nii", 4, 1, NULL);
    buffer_format(&xml, "<atlas><header><type>Label</type></header>%s", labels); /* names nothing: by its name */
    row_text(test_in("w.xml"), xml.data);
    assert_row("1", 1, "none found", NULL);
    row_text(test_in("v.xml"), xml.data);
    assert_row("two", 2, "SPM atlas XML in v.xml", NULL);
    unlink(test_in("w.xml"));
    buffer_clear(&xml); /* names an image that is there: that one's, not the one's that is called alike */
    buffer_format(&xml, "<atlas><header><images><imagefile>w.nii</imagefile></images></header>%s", labels);
    row_text(test_in("v.xml"), xml.data);
    assert_row("1", 1, "none found", NULL);
    unlink(test_in("w.nii")); /* renamed, both of them */
    assert_row("one", 1, "SPM atlas XML in v.xml", NULL);
    unlink(test_in("v.xml"));
    buffer_clear(&xml);
    buffer_format(&xml, "<atlas><header><images><imagefile>v.nii</imagefile></images></header>%s", labels);
    row_text(test_in("any.xml"), xml.data);
    assert_row("one", 1, "SPM atlas XML in any.xml", NULL);
    row_text(test_in("v.csv"), "ROIid;ROIabbr;ROIname\n2;lO;one\n3;lT;two\n"); /* CAT12's, off by one */
    assert_contradiction("\"one\" is label 2 in CSV label table in v.csv, 1 in SPM atlas XML in any.xml");
    unlink(test_in("v.csv"));
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_in("any.xml"), NULL));
    assert_string_equal(conus_atlas_object(atlas, 2)->name, "two");
    assert_string_equal(conus_atlas_label_source(atlas), "SPM atlas XML in any.xml");
    conus_atlas_destroy(atlas);
    buffer_finish(&xml);
}

/* A table of FSLeyes has colours without names: it neither keeps away a table with names nor counts as one. */
static void colours_without_names_only_colour(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    test_folder("colours");
    row_write("v.nii", 4, 1, NULL);
    row_text(test_in("v.lut"), "1 0 1 0\n2 0.2 0 1\n");
    assert_row("2", 2, "none found, colours in v.lut", NULL);
    write_xml("a.xml", "Label", "v", by_index);
    assert_row("area 2", 2, "FSL atlas XML in a.xml, colours in v.lut", NULL);
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), NULL));
    assert_int_equal(conus_atlas_object(atlas, 2)->rgb[0], 51); /* 0.2 of 255 */
    assert_int_equal(conus_atlas_object(atlas, 2)->rgb[2], 255);
    conus_atlas_destroy(atlas);
}

static void an_embedded_table_counts_as_one(void **state)
{
    (void)state;
    test_folder("embedded");
    row_write("v.nii", 4, 1,
              "<CaretExtension><VolumeInformation Index=\"0\"><LabelTable><Label Key=\"1\">A</Label>"
              "<Label Key=\"2\">B</Label></LabelTable></VolumeInformation></CaretExtension>");
    assert_row("A", 1, "Workbench label table inside v.nii", NULL);
    row_text(test_in("v.txt"), "1 A\n2 B\n3 C\n");
    assert_row("A", 1, "Workbench label table inside v.nii", NULL);
    row_text(test_in("v.txt"), "2 A\n3 B\n");
    assert_contradiction("\"A\" is label 1 in Workbench label table inside v.nii, 2 in MRIcron text in v.txt");
    row_text(test_in("FreeSurferColorLUT.txt"), "2 A 0 0 0 0\n3 B 0 0 0 0\n"); /* a table for all volumes */
    unlink(test_in("v.txt"));
    assert_row("A", 1, "Workbench label table inside v.nii", NULL);
}

/* --labels FILE,label=COLUMN,name=COLUMN, and the same in a manifest. */
static void columns_of_a_given_table_are_named(void **state)
{
    (void)state;
    static const char *const bad[] = {"t.csv,label=Nr,label=Nr", "t.csv,name=", "t.csv,label=Nr,volume=1"};
    conus_atlas *atlas = NULL;
    char path[600];
    char file[512];
    test_folder("columns");
    row_write("v.nii", 4, 1, NULL);
    row_text(test_in("t.csv"), "Bezeichnung;Nr\n\"Kern; roter\";1\nPol;2\n");
    row_text(test_in("m.atlas.json"), "{\"conus_atlas\": 1, \"parcellation\": {\"file\": \"v.nii\", \"labels\": "
                                      "\"t.csv,name=Bezeichnung,label=Nr\"}}");
    assert_ok(conus_atlas_load(&atlas, test_in("m.atlas.json"), NULL));
    assert_string_equal(conus_atlas_object(atlas, 2)->name, "Pol");
    assert_non_null(strstr(conus_atlas_label_source(atlas), "label table in "));
    conus_atlas_destroy(atlas);
    snprintf(file, sizeof file, "%s", test_in("v.nii"));
    snprintf(path, sizeof path, "%s,label=Nr,name=Bezeichnung", test_in("t.csv"));
    const conus_load_options options = {.labels = path};
    assert_ok(conus_atlas_load(&atlas, file, &options));
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "Kern; roter");
    conus_atlas_destroy(atlas);
    atlas = NULL;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        snprintf(path, sizeof path, "%s", test_in(bad[i]));
        assert_fails(conus_atlas_load(&atlas, file, &options), CONUS_ERROR_ARGUMENT);
        assert_non_null(strstr(conus_message(), "needed are label=COLUMN and name=COLUMN, once each"));
    }
    row_text(test_in("w,label=1.txt"), "1 one\n"); /* a file may be called so */
    snprintf(path, sizeof path, "%s", test_in("w,label=1.txt"));
    assert_ok(conus_atlas_load(&atlas, file, &options));
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "one");
    conus_atlas_destroy(atlas);
}

static void pathways_have_one_name(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    const conus_pathway_options unnamed = {.threshold = 2};
    const conus_pathway_options named = {.threshold = 2, .name = "mine"};
    static const char format[] = "<atlas><type>Probabilistic</type><images><imagefile>/v</imagefile></images>"
                                 "<label index=\"0\">%s</label></atlas>";
    char text[512];
    test_folder("pathway");
    row_write("v.nii", 4, 1, NULL);
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), NULL));
    snprintf(text, sizeof text, format, "Fornix");
    row_text(test_in("a.xml"), text);
    row_text(test_in("b.xml"), text);
    assert_ok(conus_atlas_add_pathway(atlas, test_in("v.nii"), &unnamed));
    assert_string_equal(conus_atlas_object(atlas, 4)->name, "Fornix");
    snprintf(text, sizeof text, format, "Cingulum");
    row_text(test_in("b.xml"), text);
    assert_fails(conus_atlas_add_pathway(atlas, test_in("v.nii"), &unnamed), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "volume 0 is \"Fornix\" in a.xml, \"Cingulum\" in b.xml; name it"));
    assert_ok(conus_atlas_add_pathway(atlas, test_in("v.nii"), &named));
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
    row_write("v.nii", 4, 1, NULL);
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

static conus_status load(void *data)
{
    (void)data;
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, test_in("v.nii"), NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    test_folder("allocation");
    row_write("v.nii", 8, 1, NULL);
    write_xml("a.xml", "Label", "v", by_index);
    write_xml("b.xml", "Probabilistic", "v", nowhere);
    row_text(test_in("v.txt"), "1 area 1\n3 area 2\n7 area 6\n");
    test_every_allocation(load, NULL);
}

/* Searches that find, compare, replace, pass over and refuse tables of all kinds. */
static void every_failing_primitive_is_clean(void **state)
{
    (void)state;
    static const char identified[] = "index,name,identifier,parent_identifier\n1,area 0,7,\n2,area 1,7,8\n4,b,9,7\n";
    static const struct {
        const char *file, *text;
    } tables[] = {
        {"v.txt", "1 area 1\n3 area 2\n7 area 6\n"},                    /* as the XMLs */
        {"v.txt", "1 area 0\n2 area 1\n3 area 2\n0 area 9\n1 twice\n"}, /* contradicts the proved one */
        {"v.csv", identified},
        {"v.tsv", "index\tlabel\tname\n7\t2\tarea 1\n9\t3\tarea 2\n"}, /* label is the number */
        {"v.json", "[{\"id\": 9, \"label\": 2, \"name\": \"a\"}, {\"id\": 8, \"label\": 1, \"name\": \"b\"}]"},
        {"v.label", "1 10 20 30 1 1 1 \"a\"\n2 10 20 30 1 1 \n3 10 20 30 1 1 1 \"c\"\n"}, /* damaged */
        {"v.lut", "1 0.5 0.25 0\n2 0.5 0.25 1\n"},
        {"w_labels.txt", "1 a\n2 b\n3 c\n4 d\n5 e\n6 f\n7 g\n"},
        {"structures.json", "[{\"id\": 1, \"acronym\": \"a\", \"name\": \"A\", \"rgb_triplet\": [1, 2, 3]}]"},
    };
    for (int xml = 0; xml < 2; xml++) {
        test_folder(xml ? "primitives_xml" : "primitives");
        row_write("v.nii", 8, 1, NULL);
        if (xml) {
            write_xml("a.xml", "Label", "v", by_index);
            write_xml("b.xml", "Probabilistic", "v", nowhere);
        }
        for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
            row_text(test_in(tables[i].file), tables[i].text);
            if (load(NULL) == CONUS_OK) {
                assert_in_range(test_every_primitive(load, NULL), 20, 2000);
            }
            unlink(test_in(tables[i].file));
        }
    }
}

TEST_GROUP(label_sources)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_decide_between_index_and_the_next),
        cmocka_unit_test(points_are_voxels_of_the_first_image),
        cmocka_unit_test(an_index_0_that_is_background_counts_by_value),
        cmocka_unit_test(a_given_atlas_is_checked_likewise),
        cmocka_unit_test(contradictions_are_never_silent),
        cmocka_unit_test(an_atlas_is_compared_with_its_volume),
        cmocka_unit_test(a_volumes_own_name_comes_first),
        cmocka_unit_test(two_atlases_of_the_same_volumes_are_compared),
        cmocka_unit_test(an_atlas_of_spm_names_its_image),
        cmocka_unit_test(colours_without_names_only_colour),
        cmocka_unit_test(an_embedded_table_counts_as_one),
        cmocka_unit_test(columns_of_a_given_table_are_named),
        cmocka_unit_test(pathways_have_one_name),
        cmocka_unit_test(background_says_that_nothing_is_there),
        cmocka_unit_test(real_fsl_atlases_are_proved),
        cmocka_unit_test(real_atlases_have_no_contradictions),
        cmocka_unit_test(tables_take_no_more_memory_than_is_allowed),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(every_failing_primitive_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
