/* SPDX-License-Identifier: BSD-3-Clause */
/* Atlases from files: the source of names, FSL atlases, pathways and contexts. */
#include "base/files/file.h"
#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void assert_note(const conus_atlas *atlas, const char *part)
{
    for (size_t i = 0; !test_has_note(atlas, part) && i < conus_atlas_note_count(atlas); i++) {
        print_message("note: %s\n", conus_atlas_note(atlas, i));
    }
    assert_true(test_has_note(atlas, part));
}

static void put16(uint8_t *at, uint16_t value)
{
    memcpy(at, &value, sizeof value);
}

/* A NIfTI-1 file of four voxels 1, 2, 2, 9 along i, of `edge` mm each. `between` comes before the voxels, in an
 * extension of code `code`, or plain if that is 0. */
static conus_status write_volume(const char *path, float edge, uint16_t code, const char *between)
{
    static const uint8_t labels[4] = {1, 2, 2, 9};
    uint8_t file[8192] = {0};
    size_t length = between ? strlen(between) : 0;
    size_t padded = between ? (length + 8 + 15) / 16 * 16 : 0;
    uint16_t dim[8] = {3, sizeof labels, 1, 1, 1, 1, 1, 1};
    float pixdim[8] = {1, edge, edge, edge, 1, 1, 1, 1};
    float rows[12] = {edge, 0, 0, 0, 0, edge, 0, 0, 0, 0, edge, 0};
    float offset = (float)(352 + padded);
    assert_true(352 + padded + sizeof labels <= sizeof file);
    put16(file, 348), put16(file + 70, 2), put16(file + 72, 8), put16(file + 254, 1);
    memcpy(file + 40, dim, sizeof dim);
    memcpy(file + 76, pixdim, sizeof pixdim);
    memcpy(file + 108, &offset, sizeof offset);
    memcpy(file + 280, rows, sizeof rows);
    memcpy(file + 344, "n+1", 4);
    if (code) {
        file[348] = 1;
        put16(file + 352, (uint16_t)padded), put16(file + 356, code);
    }
    if (between) {
        memcpy(file + (code ? 360 : 352), between, length + 1);
    }
    memcpy(file + 352 + padded, labels, sizeof labels);
    return conus_write_file(path, file, 352 + padded + sizeof labels);
}

static void write_text(const char *path, const char *text)
{
    assert_ok(conus_write_file(path, text, strlen(text)));
}

static void assert_source(const char *path, const char *source, const char *first_name)
{
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_string_equal(conus_atlas_label_source(atlas), source);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, first_name);
    conus_atlas_destroy(atlas);
}

static void the_aal_atlas_has_its_names_and_colours(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 116);
    const conus_object *first = conus_atlas_object(atlas, 1);
    assert_string_equal(first->name, "Precentral_L");
    assert_int_equal(first->rgb[0], 204);
    assert_string_equal(conus_atlas_label_source(atlas), "MRIcron text in aal.nii.txt, colours in aal.nii.lut");
    const conus_volume_info *info = conus_atlas_volume(atlas, 0);
    assert_int_equal(info->role, CONUS_ROLE_PARCELLATION);
    assert_int_equal(strlen(info->sha256), 64);
    conus_atlas_destroy(atlas);
}

/* Each labelled volume of mricron: its areas, and the source of their names. */
static void every_mricron_atlas_finds_its_table(void **state)
{
    (void)state;
    static const struct {
        const char *name, *source, *first;
        size_t areas;
    } atlases[] = {
        {"AICHAmc.nii.gz", "MRIcron text in AICHAmc.nii.txt, colours in AICHAmc.nii.lut", "G_Frontal_Sup-1", 192},
        {"HarvardOxford-cort-maxprob-thr0-1mm.nii.gz", "MRIcron text inside HarvardOxford-cort-maxprob-thr0-1mm.nii.gz",
         "Frontal Pole", 48},
        {"JHU-WhiteMatter-labels-1mm.nii.gz",
         "MRIcron text in JHU-WhiteMatter-labels-1mm.nii.txt, colours in JHU-WhiteMatter-labels-1mm.nii.lut",
         "Middle_cerebellar_peduncle", 48},
        {"brodmann.nii.gz", "none found, colours in brodmann.nii.lut", "1", 41},
        {"inia19-NeuroMaps.nii.gz", "MRIcron text inside inia19-NeuroMaps.nii.gz", "l_occipital_gyrus_(macaque)", 0},
        {"jhu189.nii.gz", "MRIcron text inside jhu189.nii.gz", "SFG_L", 189},
        {"natbrainlab.nii.gz", "MRIcron text inside natbrainlab.nii.gz", "Anterior_Commissure_Left", 0},
    };
    for (size_t i = 0; i < sizeof atlases / sizeof atlases[0]; i++) {
        conus_atlas *atlas = NULL;
        assert_ok(conus_atlas_load(&atlas, test_mricron(atlases[i].name), NULL));
        assert_string_equal(conus_atlas_label_source(atlas), atlases[i].source);
        assert_string_equal(conus_atlas_object(atlas, 1)->name, atlases[i].first);
        assert_true(!atlases[i].areas || conus_atlas_object_count(atlas) == atlases[i].areas);
        conus_atlas_destroy(atlas);
    }
}

static void an_atlas_without_names_is_called_by_numbers(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("brodmann.nii.gz"), NULL));
    const conus_object *area = conus_atlas_object(atlas, 1);
    assert_false(area->named);
    assert_int_equal(area->label, 1);
    assert_int_equal(area->rgb[0], 203);
    assert_note(atlas, "no label table found");
    assert_false(test_has_note(atlas, "does not name"));
    conus_atlas_destroy(atlas);
}

static void tables_inside_the_file_come_first(void **state)
{
    (void)state;
    test_folder("inside");
    write_text(test_in("v.txt"), "1 beside\n2 b\n");
    assert_ok(write_volume(test_in("v.nii"), 1, 30,
                           "<CaretExtension><VolumeInformation Index=\"0\"><LabelTable>"
                           "<Label Key=\"1\">one</Label></LabelTable></VolumeInformation>"
                           "</CaretExtension>"));
    assert_source(test_in("v.nii"), "Workbench label table inside v.nii", "one");
    assert_ok(write_volume(test_in("v.nii"), 1, 4,
                           "<?xml version='1.0' ?><AFNI_attributes><AFNI_atr atr_name="
                           "\"VALUE_LABEL_DTABLE\">\"&lt;VALUE_LABEL_DTABLE&gt;&quot;1&quot; "
                           "&quot;eins&quot;&lt;/VALUE_LABEL_DTABLE&gt;\"</AFNI_atr>"
                           "</AFNI_attributes>"));
    assert_source(test_in("v.nii"), "AFNI label table inside v.nii", "eins");
    assert_ok(write_volume(test_in("v.nii"), 1, 0, "1\tuno\n2\tdos\n"));
    assert_source(test_in("v.nii"), "MRIcron text inside v.nii", "uno");
    assert_ok(write_volume(test_in("v.nii"), 1, 6, "1\ta comment is no table\n"));
    assert_source(test_in("v.nii"), "MRIcron text in v.txt", "beside");
}

/* Each table is removed in turn: the next one in the documented order is used. */
static void tables_beside_the_file_follow_in_order(void **state)
{
    (void)state;
    static const struct {
        const char *name, *text, *source;
    } files[] = {
        {"sub-1_res-2_dseg.nii.txt", "1 A\n2 b\n", "MRIcron text in sub-1_res-2_dseg.nii.txt"},
        {"sub-1_res-2_dseg.txt", "1 A\n2 b\n", "MRIcron text in sub-1_res-2_dseg.txt"},
        {"sub-1_res-2_dseg.tsv", "index\tname\n1\tA\n", "BIDS label table in sub-1_res-2_dseg.tsv"},
        {"sub-1_res-2_dseg.json", "{\"R\":[0],\"G\":[0],\"B\":[0],\"I\":[1],\"labels\":[\"A\"]}",
         "NiiVue labels in sub-1_res-2_dseg.json"},
        {"sub-1_res-2_dseg.label", "1 0 0 0 1 1 1 \"A\"\n", "ITK-SNAP labels in sub-1_res-2_dseg.label"},
        {"sub-1_res-2_dseg.ctbl", "1 A 0 0 0 255\n", "FreeSurfer colour table in sub-1_res-2_dseg.ctbl"},
        {"sub-1_res-2_dseg.niml.lt", "<VALUE_LABEL_DTABLE>\"1\" \"A\"</VALUE_LABEL_DTABLE>",
         "AFNI label table in sub-1_res-2_dseg.niml.lt"},
        {"sub-1_res-2_dseg.csv", "id,name\n1,A\n", "CSV label table in sub-1_res-2_dseg.csv"},
        {"sub-1_res-2_dseg.lut", "1 0 0 0 A\n2 0 0 1 B\n", "FSLeyes colour table in sub-1_res-2_dseg.lut"},
        {"sub-1_dseg.tsv", "index\tname\n1\tA\n", "BIDS label table in sub-1_dseg.tsv"},
        {"dseg.tsv", "index\tname\n1\tA\n", "BIDS label table in dseg.tsv"},
        {"atlas.xml",
         "<atlas><type>Label</type><images><imagefile>/sub-1_res-2_dseg</imagefile></images><label "
         "index=\"1\">A</label>"
         "</atlas>",
         "FSL atlas XML in atlas.xml"},
        {"../order.xml",
         "<atlas><type>Statistic</type><images><summaryimagefile>/order/sub-1_res-2_dseg.nii.gz</summaryimagefile>"
         "</images><label index=\"0\">A</label></atlas>",
         "FSL atlas XML in order.xml"},
        {"structures.json", "[{\"id\":1,\"acronym\":\"A\"},{\"id\":2,\"acronym\":\"B\"},{\"id\":9,\"acronym\":\"C\"}]",
         "BrainGlobe structures in structures.json"},
        {"FreeSurferColorLUT.txt", "1 A 0 0 0 0\n", "FreeSurfer colour table in FreeSurferColorLUT.txt"},
    };
    enum { COUNT = sizeof files / sizeof files[0] };
    test_folder("order");
    const char *volume = test_scratch("order/sub-1_res-2_dseg.nii");
    assert_ok(write_volume(volume, 1, 0, NULL));
    write_text(test_in("sub-2_dseg.tsv"), "index\tname\n1\tof another\n");
    write_text(test_in("a.xml"), "<atlas><type>Label</type><images><imagefile>/other</imagefile></images></atlas>");
    write_text(test_in("b.xml"), "<atlas>damaged");
    for (size_t i = 0; i < COUNT; i++) {
        write_text(test_in(files[i].name), files[i].text);
    }
    for (size_t i = 0; i < COUNT; i++) {
        assert_source(volume, files[i].source, "A");
        unlink(test_in(files[i].name));
    }
    assert_source(volume, "none found", "1");
}

/* A mouse's table in the folder of somebody's own segmentation called label 17, a hippocampus, "Superior colliculus".
 */
static void structures_are_those_of_annotation_alone_unless_they_name_every_label(void **state)
{
    (void)state;
    static const char all[] =
        "[{\"id\":1,\"acronym\":\"A\"},{\"id\":2,\"acronym\":\"B\"},{\"id\":9,\"acronym\":\"C\"}]";
    static const char one[] = "[{\"id\":1,\"acronym\":\"A\"}]";
    static const struct {
        const char *volume, *text, *source, *name;
    } cases[] = {
        {"v.nii", all, "BrainGlobe structures in structures.json", "A"},
        {"v.nii", one, "none found", "1"},
        {"aparc+aseg.nii", all, "none found", "1"},
        {"annotation_25.nii", one, "BrainGlobe structures in structures.json", "A"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        test_folder("mouse_beside");
        const char *volume = test_in(cases[i].volume);
        assert_ok(write_volume(volume, 1, 0, NULL));
        write_text(test_in("structures.json"), cases[i].text);
        assert_source(volume, cases[i].source, cases[i].name);
        unlink(volume);
    }
}

static void notes_that_are_no_table_are_passed_over(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    test_folder("readme");
    const char *volume = test_in("v.nii");
    assert_ok(write_volume(volume, 1, 0, NULL));
    write_text(test_in("v.txt"), "This atlas was drawn by hand.\nIt has 2 areas.\n");
    write_text(test_in("v.json"), "{\"Name\": \"a sidecar\"}");
    assert_ok(conus_atlas_load(&atlas, volume, NULL));
    assert_note(atlas, "v.txt is not a label table of a known format: passed over");
    assert_false(test_has_note(atlas, "v.json is"));
    assert_note(atlas, "no label table found");
    conus_atlas_destroy(atlas);
    write_text(test_in("v.csv"), "id,name\n1,A\n");
    assert_source(volume, "CSV label table in v.csv", "A");
}

static void a_damaged_table_is_an_error_unless_another_is_found(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    test_folder("damaged");
    assert_ok(write_volume(test_in("v.nii"), 1, 0, NULL));
    write_text(test_in("v.txt"), "1 A\n2.5 B\n");
    assert_fails(conus_atlas_load(&atlas, test_in("v.nii"), NULL), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "v.txt: MRIcron text: line 2: label \"2.5\", a whole number from 0 to "
                                         "4294967295 is needed");
    write_text(test_in("v.csv"), "id,name\n1,A\n");
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), NULL));
    assert_note(atlas, "v.txt: MRIcron text: line 2: label \"2.5\", a whole number from 0 to 4294967295 is needed: "
                       "passed over");
    conus_atlas_destroy(atlas);
}

static void an_override_replaces_every_table(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    test_folder("override");
    assert_ok(write_volume(test_in("v.nii"), 1, 0, "1\tinside\n2\tb\n"));
    write_text(test_in("mine.txt"), "1 mine\n5 absent\n");
    char labels[512];
    snprintf(labels, sizeof labels, "%s", test_in("mine.txt"));
    conus_load_options options = {.labels = labels};
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), &options));
    assert_int_equal(conus_atlas_object_count(atlas), 4); /* 1, 2, 5, 9 */
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "mine");
    assert_non_null(strstr(conus_atlas_label_source(atlas), "MRIcron text in "));
    assert_note(atlas, "does not name: 2 (2, 9)");
    assert_note(atlas, "without a voxel: 1 (5)");
    conus_atlas_destroy(atlas);
    atlas = NULL;
    write_text(labels, "<html></html>");
    assert_fails(conus_atlas_load(&atlas, test_in("v.nii"), &options), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "mine.txt: this is a web page; needed is a label table"));
    options.labels = "no-such-file";
    assert_fails(conus_atlas_load(&atlas, test_in("v.nii"), &options), CONUS_ERROR_IO);
    assert_null(atlas);
}

static void real_fsl_atlases_load(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_shared("prob/fsl/atlases/JHU-labels.xml"), NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 48);
    assert_near(conus_atlas_volume(atlas, 0)->spacing[0], 1, 1e-6);
    assert_string_equal(conus_atlas_object(atlas, 3)->name, "Genu of corpus callosum");
    conus_atlas_destroy(atlas);
    assert_source(test_shared("prob/fsl/atlases/JHU/JHU-ICBM-labels-2mm.nii.gz"), "FSL atlas XML in JHU-labels.xml",
                  "Middle cerebellar peduncle");
    assert_source(test_shared("prob/fsl/atlases/JHU/JHU-ICBM-tracts-maxprob-thr25-2mm.nii.gz"),
                  "FSL atlas XML in JHU-tracts.xml", "Anterior thalamic radiation L");
    assert_source(test_shared("labelvol/julich31/JulichBrainAtlas31_LH.nii.gz"),
                  "MRIcron text inside JulichBrainAtlas31_LH.nii.gz", "Area 3b (PostCG)");
}

static void pathways_know_their_scale(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    test_folder("pathway");
    assert_ok(write_volume(test_in("v.nii"), 1, 0, NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), NULL));
    conus_pathway_options options = {.threshold = 2, .name = "tract"};
    assert_ok(conus_atlas_add_pathway(atlas, test_in("v.nii"), &options));
    const conus_object *pathway = conus_atlas_object(atlas, conus_atlas_object_count(atlas));
    assert_string_equal(pathway->name, "tract");
    assert_int_equal(pathway->voxels, 3);
    size_t notes = conus_atlas_note_count(atlas);
    options.threshold = NAN;
    assert_fails(conus_atlas_add_pathway(atlas, test_in("v.nii"), &options), CONUS_ERROR_ARGUMENT);
    options.threshold = 9 + 1e-9; /* 9 in float32, the type of the values in memory */
    assert_ok(conus_atlas_add_pathway(atlas, test_in("v.nii"), &options));
    options.threshold = 9.5;
    assert_fails(conus_atlas_add_pathway(atlas, test_in("v.nii"), &options), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "threshold 9.5, allowed is above 0 to 9"));
    options.threshold = -1;
    assert_fails(conus_atlas_add_pathway(atlas, test_in("v.nii"), &options), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_add_pathway(atlas, test_in("v.nii"), NULL), CONUS_ERROR_DATA); /* 25 % of 100 is above 9 */
    assert_fails(conus_atlas_add_pathway(atlas, test_in("none.nii"), NULL), CONUS_ERROR_IO);
    assert_int_equal(conus_atlas_note_count(atlas), notes);
    assert_int_equal(conus_atlas_volume_count(atlas), 3);
    assert_ok(conus_atlas_set_context(atlas, test_in("v.nii"), NULL));
    assert_int_equal(conus_atlas_volume(atlas, 3)->role, CONUS_ROLE_CONTEXT);
    conus_atlas_destroy(atlas);
}

static void pathways_are_named_by_an_fsl_atlas_or_their_file(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    conus_pathway_options options = {.threshold = 2};
    test_folder("named");
    assert_ok(write_volume(test_in("v.nii"), 1, 0, NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), NULL));
    assert_ok(conus_atlas_add_pathway(atlas, test_in("v.nii"), &options));
    write_text(test_in("a.xml"), "<atlas><type>Label</type><images><imagefile>/v</imagefile></images>"
                                 "<label index=\"0\">not this</label></atlas>");
    write_text(test_in("b.xml"), "<atlas><type>Statistic</type><images><imagefile>/v.nii.gz</imagefile></images>"
                                 "<label index=\"0\">Fornix</label></atlas>");
    assert_ok(conus_atlas_add_pathway(atlas, test_in("v.nii"), &options));
    options.name = "mine";
    assert_ok(conus_atlas_add_pathway(atlas, test_in("v.nii"), &options));
    static const char *const names[] = {"v", "Fornix", "mine"};
    for (size_t i = 0; i < 3; i++) {
        assert_string_equal(conus_atlas_object(atlas, conus_atlas_object_count(atlas) - 2 + i)->name, names[i]);
    }
    conus_atlas_destroy(atlas);
}

static void real_pathways_get_a_quarter_of_their_scale(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    char percent[1100];
    snprintf(percent, sizeof percent, "%s,volume=2",
             test_shared("prob/fsl/atlases/JHU/JHU-ICBM-tracts-prob-2mm.nii.gz"));
    assert_ok(conus_atlas_load(&atlas, test_shared("prob/fsl/atlases/JHU-labels.xml"), NULL));
    assert_ok(conus_atlas_add_pathway(atlas, percent, NULL));
    assert_ok(conus_atlas_add_pathway(atlas, test_shared("prob/juelich-fibre-pathways-u16/Acoustic_radiation_L.nii.gz"),
                                      NULL));
    assert_string_equal(conus_atlas_object(atlas, 49)->name, "Corticospinal tract L");
    assert_near(conus_atlas_volume(atlas, 1)->threshold, 25, 0);
    assert_note(atlas, "taken as percent; threshold 25");
    assert_note(atlas, "pathway Corticospinal tract L: named by JHU-tracts.xml");
    assert_string_equal(conus_atlas_object(atlas, 50)->name, "Acoustic_radiation_L");
    assert_near(conus_atlas_volume(atlas, 2)->threshold, 65535 / 4.0, 0);
    conus_atlas_destroy(atlas);
}

static conus_status load_everything(void *data)
{
    (void)data;
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, test_in("sub_dseg.nii"), NULL);
    if (!status) {
        conus_pathway_options options = {.threshold = 2};
        status = conus_atlas_add_pathway(atlas, test_in("sub_dseg.nii"), &options);
    }
    status = status ? status : conus_atlas_set_context(atlas, test_in("sub_dseg.nii"), NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static conus_status load_xml(void *data)
{
    (void)data;
    conus_atlas *atlas = NULL;
    conus_load_options options = {.labels = test_in("mine.csv")};
    conus_status status = conus_atlas_load(&atlas, test_in("a.xml"), &options);
    conus_atlas_destroy(atlas);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    test_folder("allocation");
    assert_ok(write_volume(test_in("sub_dseg.nii"), 1, 4, "<AFNI_attributes>VALUE_LABEL_DTABLE</AFNI_attributes>"));
    write_text(test_in("sub_dseg.txt"), "notes\n");
    test_every_allocation(load_everything, NULL);
    assert_true(test_every_primitive(load_everything, NULL) > 5);
    write_text(test_in("a.xml"), "<atlas><type>Label</type><images><imagefile>/sub_dseg</imagefile></images>"
                                 "<label index=\"1\">one</label></atlas>");
    test_every_allocation(load_everything, NULL);
    assert_true(test_every_primitive(load_everything, NULL) > 5);
    write_text(test_in("mine.csv"), "id,name\n1,A\n");
    test_every_allocation(load_xml, NULL);
    assert_true(test_every_primitive(load_xml, NULL) > 5);
    write_text(test_in("dseg.tsv"), "index\tname\n1\tA\n");
    test_every_allocation(load_everything, NULL);
    assert_true(test_every_primitive(load_everything, NULL) > 5);
    write_text(test_in("a.xml"), "<atlas><type>Statistic</type><images><imagefile>/sub_dseg</imagefile></images>"
                                 "<label index=\"0\">one</label></atlas>");
    test_every_allocation(load_everything, NULL);
    assert_true(test_every_primitive(load_everything, NULL) > 5);
}

static void arguments_are_checked(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_fails(conus_atlas_load(&atlas, NULL, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_load(NULL, "x", NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_load(&atlas, "no-such-file.nii", NULL), CONUS_ERROR_IO);
    assert_fails(conus_atlas_add_pathway(NULL, "x", NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_set_context(NULL, "x", NULL), CONUS_ERROR_ARGUMENT);
    assert_null(atlas);
}

TEST_GROUP(load)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_aal_atlas_has_its_names_and_colours),
        cmocka_unit_test(every_mricron_atlas_finds_its_table),
        cmocka_unit_test(an_atlas_without_names_is_called_by_numbers),
        cmocka_unit_test(tables_inside_the_file_come_first),
        cmocka_unit_test(tables_beside_the_file_follow_in_order),
        cmocka_unit_test(structures_are_those_of_annotation_alone_unless_they_name_every_label),
        cmocka_unit_test(notes_that_are_no_table_are_passed_over),
        cmocka_unit_test(a_damaged_table_is_an_error_unless_another_is_found),
        cmocka_unit_test(an_override_replaces_every_table),
        cmocka_unit_test(real_fsl_atlases_load),
        cmocka_unit_test(pathways_know_their_scale),
        cmocka_unit_test(pathways_are_named_by_an_fsl_atlas_or_their_file),
        cmocka_unit_test(real_pathways_get_a_quarter_of_their_scale),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(arguments_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
