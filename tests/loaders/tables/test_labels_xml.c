/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables in XML, and in AFNI's NIML, which looks like it. */
#include "base/buffer.h"
#include "builders/parsed_labels.h"
#include "loaders/labels/fsl_atlas.h"
#include "loaders/labels/label_format.h"
#include "test.h"

#include <string.h>

#define WORKBENCH_LABELS                                                                                               \
    "<LabelTable><Label Key=\"0\" Red=\"1\" Green=\"1\" Blue=\"1\" Alpha=\"0\"><![CDATA[???]]></Label>"                \
    "<Label Key=\"7\" Red=\"1\" Green=\"0.5\" Blue=\"0\" Alpha=\"1\">Caudate &amp; Putamen</Label></LabelTable>"

#define AFNI_TABLE                                                                                                     \
    "&lt;VALUE_LABEL_DTABLE ni_type=&quot;2*String&quot; ni_dimen=&quot;2&quot; &gt;&#x0a;&quot;21&quot; "             \
    "&quot;postcentral&quot;&#x0a;&quot;7&quot; &quot;Heschl&apos;s&quot;&#x0a;&lt;/VALUE_LABEL_DTABLE&gt;~"

static const struct sample samples[] = {
    {"Workbench label table",
     /* as Workbench writes it, and with the root element that other programs give it */
     "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<CaretExtension><Date><![CDATA[2026-01-02T03:04:05]]></Date>"
     "<VolumeInformation Index=\"0\">" WORKBENCH_LABELS
     "<StudyMetaDataLinkSet></StudyMetaDataLinkSet><VolumeType><![CDATA[Label]]></VolumeType></VolumeInformation>"
     "</CaretExtension>",
     "7 Caudate & Putamen #ff8000"},
    {"Workbench label table",
     "<CaretVolumeExtension Version=\"1.0\"><VolumeInformation Index=\"0\">"
     "<MetaData/>" WORKBENCH_LABELS "<VolumeType>Label</VolumeType></VolumeInformation></CaretVolumeExtension>",
     "7 Caudate & Putamen #ff8000"},
    {"Workbench label table", "<LabelTable><Label Index=\"3\">old</Label></LabelTable>", "3 old"},
    {"FSL atlas XML",
     "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<atlas version=\"1.0\"><header><name>A</name><type>Label</type>"
     "<images><imagefile>/A/a</imagefile></images></header><data>\n"
     "<label index=\"0\" x=\"0\" y=\"0\" z=\"0\">Unclassified</label>\n"
     "<label index=\"1\" x=\"9\" y=\"8\" z=\"7\">Br\xfc"
     "cke  </label>\n</data></atlas>\n",
     "1 Br\xc3\xbc"
     "cke"},
    {"FSL atlas XML",
     "<atlas><header><type>Probabalistic</type></header><data><label index=\"0\">Motor</label>"
     "<label index=\"1\">Sensory</label></data></atlas>",
     "1 Motor; 2 Sensory"},
    {"FSL atlas XML",
     "\n<atlas><type>Label</type><label index=\"2\">Stra\xdf"
     "e</label></atlas>",
     "2 Stra\xc3\x9f"
     "e"},
    {"SPM atlas XML",
     "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<atlas version=\"2.0\"><header><name>A</name>"
     "<type>Label</type><images><imagefile>a.nii</imagefile></images></header><data>\n"
     "<label><index>2001</index><short_name>lPre</short_name><name>Left Precentral</name>"
     "<RGBA></RGBA><XYZmm>1,2,3</XYZmm></label>\n"
     "<label><name>Br\xfc"
     "cke</name><index> 7 </index></label></data></atlas>\n",
     "7 Br\xc3\xbc"
     "cke; 2001 Left Precentral (lPre)"},
    {"SPM atlas XML",
     "<atlas><data><label><index>0</index><name>Unknown</name></label><label><index>1</index></label>"
     "</data></atlas>",
     "1 -"},
    {"AFNI label table",
     "<VALUE_LABEL_DTABLE\n  ni_type=\"2*String\"\n  ni_dimen=\"2\" >\n\"21\" \"post central\"\n"
     "\"3\" \"a &lt; b\"\n</VALUE_LABEL_DTABLE>\n",
     "3 a < b; 21 post central"},
    {"AFNI label table",
     "<?xml version='1.0' ?>\n<AFNI_attributes\n  self_idcode=\"XYZ\"\n  ni_form=\"ni_group\" >\n"
     "<AFNI_atr\n  ni_type=\"String\"\n  ni_dimen=\"1\"\n  atr_name=\"HISTORY_NOTE\" >\n \"x > y\"\n</AFNI_atr>\n"
     "<AFNI_atr ni_type=\"String\" ni_dimen=1 AFNI_name=\"VALUE_LABEL_DTABLE\" >\n \"" AFNI_TABLE "\"\n</AFNI_atr>\n"
     "</AFNI_attributes>",
     "7 Heschl's; 21 postcentral"},
    {"AFNI label table",
     "<ATLAS_LABEL_TABLE ni_form=\"ni_group\">\n<ATLAS_POINT\n data_type=\"atlas_point\"\n STRUCT=\"R_CA1\"\n "
     "VAL=\"17\"\n"
     " LONGNAME=\"CA1 (Hippocampus)\" COG=\"1 2 3\" />\n<ATLAS_POINT STRUCT='L &amp; M' VAL=18 LONGNAME=\"None\"/>\n"
     "</ATLAS_LABEL_TABLE>",
     "17 CA1 (Hippocampus) (R_CA1); 18 L & M"},
};
static void formats_are_detected_from_content(void **state)
{
    (void)state;
    assert_samples(samples, sizeof samples / sizeof samples[0]);
}

/* As AFNI writes it: cut into pieces of 1000 characters, at any place. */
static void afni_tables_are_joined_from_pieces(void **state)
{
    (void)state;
    struct buffer whole = {0};
    struct buffer file = {0};
    buffer_text(&whole, "<VALUE_LABEL_DTABLE ni_dimen=\"300\" >");
    for (int i = 1; i <= 300; i++) {
        buffer_format(&whole, "\"%d\" \"area %d & more\"\n", i, i);
    }
    buffer_text(&whole, "</VALUE_LABEL_DTABLE>~");
    buffer_text(&file, "<?xml version='1.0' ?><AFNI_attributes><AFNI_atr ni_type=\"String\" "
                       "atr_name=\"VALUE_LABEL_DTABLE\" >\n");
    for (size_t at = 0; at < whole.size; at++) {
        char c = whole.data[at];
        buffer_text(&file, at % 1000 ? "" : at ? "\"\n \"" : " \"");
        if (c == '"' || c == '<' || c == '>' || c == '&') {
            buffer_text(&file, c == '"' ? "&quot;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : "&amp;");
        } else {
            buffer_append(&file, &c, 1);
        }
    }
    buffer_text(&file, "\"\n</AFNI_atr></AFNI_attributes>");
    struct parsed parsed;
    assert_ok(parsed_from(&parsed, file.data));
    assert_int_equal(parsed.table.count, 300);
    assert_string_equal(parsed.table.entries[99].name, "area 100 & more");
    parsed_finish(&parsed);
    buffer_finish(&whole);
    buffer_finish(&file);
}

static void damage_is_named_with_its_line(void **state)
{
    (void)state;
    assert_refused("<atlas>\n<type>Label</type>\n<label index=\"1.5\">a</label></atlas>",
                   "FSL atlas XML: line 3: label \"1.5\", a whole number");
    assert_refused("<atlas><label index=\"1\">a</label></atlas>", "no <type>");
    assert_refused("<atlas><type>Labels</type></atlas>", "type \"Labels\", allowed are Label");
    assert_refused("<atlas><type>Label</type>\n</header></atlas>", "line 2: not well-formed XML: mismatched tag");
    assert_refused("<atlas><label><index>1</index>\n<index>2</index></label></atlas>",
                   "SPM atlas XML: line 2: a second index of one label");
    assert_refused("<atlas>\n<label><index>1.5</index></label></atlas>", "line 2: label \"1.5\", a whole number");
    assert_refused("<atlas><label><name>a</name></label>\n<!--<index>--></atlas>", "line 1: a label without an index");
    assert_refused("<atlas><label><index>1</index>\n<label><index>2</index></label></label></atlas>",
                   "line 2: a label inside a label");
    assert_refused("<atlas><label><index>1</index></label>\n<label index=\"2\">b</label></atlas>",
                   "line 2: a label with the attribute index, others lack it");
    assert_refused("<atlas><label index=\"2\">b</label>\n<label><index>1</index></label></atlas>",
                   "line 2: a label without the attribute index, others have it");
    assert_refused("<atlas><type>Probabilistic</type><label><index>1</index></label></atlas>",
                   "type \"Probabilistic\" of an atlas of SPM, allowed is Label");
    assert_refused("<!DOCTYPE atlas [<!ENTITY a \"b\">]>\n<atlas>&a;</atlas>", "line 1: a document type");
    assert_refused("<atlas><type>Label</type><label index=\"0\">x</label></atlas>", "no label but 0");
    assert_refused("<LabelTable><Label Key=\"-1\">a</Label></LabelTable>", "line 1: label \"-1\"");
    assert_refused("<LabelTable><Label Key=\"1\" Red=\"2\" Green=\"0\" Blue=\"0\">a</Label></LabelTable>",
                   "red is \"2\", a number from 0 to 1");
    assert_refused("<LabelTable><Label Key=\"1\" Red=\"nan\" Green=\"0\" Blue=\"0\">a</Label></LabelTable>",
                   "red is \"nan\"");
    assert_refused("<CaretVolumeExtension><VolumeInformation/></CaretVolumeExtension>", "needs Index");
    assert_refused("<VALUE_LABEL_DTABLE>\"1\" \"a\" \"2\"</VALUE_LABEL_DTABLE>", "entry 2: no name after the number");
    assert_refused("<VALUE_LABEL_DTABLE>\"x\" \"a\"</VALUE_LABEL_DTABLE>", "entry 1: label \"x\"");
    assert_refused("<html><body/></html>", "not a label table of a known format");
    struct buffer deep = {0};
    for (int i = 0; i < 100; i++) {
        buffer_text(&deep, "<atlas>");
    }
    assert_refused(deep.data, "nested deeper than 64");
    buffer_finish(&deep);
}

static void afni_tables_written_by_hand_are_read(void **state)
{
    (void)state;
    struct parsed parsed;
    assert_ok(parsed_from(&parsed, "   <VALUE_LABEL_DTABLE\n   ni_type=\"2*String\"\n   ni_dimen=\"200\"\n"
                                   "   pbar_name=\"ROI_i256\">\n   \"0\" \"Unknown\"\n   122 \"L A1\"\n 92 L_V1\n"));
    assert_string_equal(parsed_text(&parsed.table), "92 L_V1; 122 L A1");
    assert_true(notes_have(&parsed.notes, "has 3 entries, though its ni_dimen says 200"));
    parsed_finish(&parsed);
}

static void each_volume_of_workbench_has_its_own_table(void **state)
{
    (void)state;
    static const char text[] = "<CaretExtension><VolumeInformation Index=\"0\">" WORKBENCH_LABELS
                               "</VolumeInformation><VolumeInformation Index=\"1\"><LabelTable><Label Key=\"9\">nine"
                               "</Label></LabelTable></VolumeInformation></CaretExtension>";
    struct parsed parsed = {0};
    const conus_volume_info info = {.volume = 1};
    const struct label_use second = {.info = &info};
    const struct label_format *format = label_format_of(text_from(text));
    struct job job = {0};
    label_text_parse(&job, &parsed.table, format, text_from(text), &second);
    assert_ok(job_close(&job, &parsed.notes, NULL));
    assert_string_equal(parsed_text(&parsed.table), "9 nine");
    parsed_finish(&parsed);
}

static void fsl_atlases_name_their_images(void **state)
{
    (void)state;
    static const struct {
        const char *path;
        bool is_label;
        size_t images, labels;
        const char *image, *summary, *first;
    } files[] = {
        {"prob/fsl/atlases/JHU-labels.xml", true, 2, 48, "/JHU/JHU-ICBM-labels-1mm", "/JHU/JHU-ICBM-labels-1mm",
         "Middle cerebellar peduncle"},
        {"prob/fsl/atlases/JHU-tracts.xml", false, 2, 20, "/JHU/JHU-ICBM-tracts-prob-1mm",
         "/JHU/JHU-ICBM-tracts-maxprob-thr25-1mm", "Anterior thalamic radiation L"},
        {"prob/fsl/atlases/Thalamus.xml", false, 2, 7, "/Thalamus/Thalamus-prob-1mm",
         "/Thalamus/Thalamus-maxprob-thr25-1mm", "Primary motor"},
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        struct bytes bytes = {0};
        struct job job = {0};
        assert_ok(file_read(&bytes, test_shared(files[i].path), 1 << 20));
        struct fsl_atlas *atlas = fsl_atlas_parse(&job, text_from_bytes(bytes.data, bytes.size));
        fsl_atlas_number(&job, atlas, &(struct label_use){0});
        assert_true(job_ok(&job));
        assert_int_equal(atlas->is_label, files[i].is_label);
        assert_int_equal(atlas->image_count, files[i].images);
        assert_int_equal(atlas->labels.count, files[i].labels);
        assert_string_equal(atlas->images[0].image, files[i].image);
        assert_string_equal(atlas->images[0].summary, files[i].summary);
        assert_int_equal(atlas->labels.entries[0].number, 1);
        assert_string_equal(atlas->labels.entries[0].name, files[i].first);
        job_end(&job);
        bytes_finish(&bytes);
    }
}

TEST_GROUP(labels_xml)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formats_are_detected_from_content),
        cmocka_unit_test(afni_tables_are_joined_from_pieces),
        cmocka_unit_test(afni_tables_written_by_hand_are_read),
        cmocka_unit_test(damage_is_named_with_its_line),
        cmocka_unit_test(each_volume_of_workbench_has_its_own_table),
        cmocka_unit_test(fsl_atlases_name_their_images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
