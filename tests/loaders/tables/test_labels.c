/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables that are text: the format is detected, and bad cells are named with their line. */
#include "builders/parsed_labels.h"
#include "loaders/labels/label_file.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

static const struct label_use no_use;

static const struct sample samples[] = {
    {"MRIcron text",
     "1 Precentral_L 2001\r\n2 Precentral_R 2002\r\n3 A 2101\r\n4 B 2102\r\n5 C 2111\r\n6 D 2112\r\n7 E 2201\r\n"
     "8 F 2202\r\n\r\n",
     "1 Precentral_L; 2 Precentral_R; 3 A; 4 B; 5 C; 6 D; 7 E; 8 F"},
    {"MRIcron text", "1 Area 17\n2 Crus 1\n3 Lobule 4\n", "1 Area 17; 2 Crus 1; 3 Lobule 4"},
    {"MRIcron text", "1 \"Frontal Pole\"\n2 \"B\"\n", "1 Frontal Pole; 2 B"},
    {"MRIcron text", "1 Area 17\n2 Area 18\n", "1 Area 17; 2 Area 18"},
    {"MRIcron text", "1 V 1\n2 A 1\n", "1 V 1; 2 A 1"},
    {"MRIcron text", "1\tArea 17\n2\tPole 18\n", "1 Area 17; 2 Pole 18"},
    {"MRIcron text", "0\tUnclassified\r1\tFrontal Pole\r4294967295\tInsular Cortex  ",
     "1 Frontal Pole; 4294967295 Insular Cortex"},
    {"MRIcron text", "\xef\xbb\xbf# a comment\n\n 7   Gyrus, \"pars\" # 3\n", "7 Gyrus, \"pars\" # 3"},
    {"MRIcron text", "3 c\n1 a\n2\n", "1 a; 2 -; 3 c"},
    {"MRIcron text",
     "1 Br\xc3\xbc"
     "cke\n2 Ge\xdf\n",
     "1 Br\xc3\xbc"
     "cke; 2 Ge\xc3\x9f"},
    {"MRIcron text", "1 Broca\x92s \x96 area\n2 \x8cuvre\n", "1 Broca\xe2\x80\x99s \xe2\x80\x93 area; 2 \xc5\x92uvre"},
    {"JSON map of names", "{\"1\": \"Broca\x92s\"}", "1 Broca\xe2\x80\x99s"},
    {"AAL text", "FAG Precentral_L 2001\nFAD Precentral_R 2002\n", "2001 Precentral_L (FAG); 2002 Precentral_R (FAD)"},
    {"AAL text", "Insula_L 3\nInsula_R 4\n", "3 Insula_L; 4 Insula_R"},
    {"FreeSurfer colour table", "#No. Label Name: R G B A\n0 Unknown 0 0 0 0\n17 Left-Hippocampus 220 216 20 0\n",
     "17 Left-Hippocampus #dcd814"},
    {"FreeSurfer colour table", "1 Left Hippocampus 1 2 3 0\n2 Right 1 4 5 6 255\n3 Pole 4 5 6 7\n",
     "1 Left Hippocampus #010203; 2 Right 1 #040506; 3 Pole #040506"},
    {"FreeSurfer colour table", "5 a 1 2 3\n6 b 4 5 6\n", "5 a #010203; 6 b #040506"},
    {"MRtrix or FreeSurfer colour table", "1 L.H Left-Hip 1 2 3 255\n2 L.A Left-Amy 4 5 6 255\n",
     "1 Left-Hip (L.H) #010203; 2 Left-Amy (L.A) #040506"},
    {"MRtrix or FreeSurfer colour table", "1 Left Hip 1 2 3 255\n2 Left Amy 4 5 6 255\n",
     "1 Left Hip #010203; 2 Left Amy #040506"},
    {"MRtrix or FreeSurfer colour table",
     "36 L.TH Left-Thalamus 1 2 3 255\n36 L.TH Left-Thalamus-Proper 1 2 3 255\n37 L.CA Left-Caudate 4 5 6 255\n",
     "36 Left-Thalamus (L.TH) #010203; 37 Left-Caudate (L.CA) #040506"},
    {"BIDS label table", "# by hand\ncolor\tindex\tname\n#ff0000\t1\tA\n#00ff00\t2\tB\n", "1 A #ff0000; 2 B #00ff00"},
    {"BIDS label table", "label\tname\themi\tr\tg\tb\n1\tG temp sup\tL\t220\t20\t30\n", "1 G temp sup #dc141e L"},
    {"CSV label table", "index,label\n3,c\n", "3 c"},
    {"ITK-SNAP labels", "1 1 2 3 255 1 1 \"Left Region\"\n", "1 Left Region #010203"},
    {"Slicer colour table", "# Color table file /tmp/x.ctbl\n# 3 values\n0 background 0 0 0 0\n1 left_lung 1 2 3 255\n",
     "1 left lung #010203"},
    {"Slicer colour table",
     "LabelValue,Name,Color_R,Color_G,Color_B,Color_A\n1,\"lung, \"\"left\"\"\",1,2,3,255\n2,heart,4,5,6,255\n",
     "1 lung, \"left\" #010203; 2 heart #040506"},
    {"FSLeyes colour table", "1  0.00000 0.93333 1.00000 Frontal Pole\n2 0 0 0 Insular Cortex\n",
     "1 Frontal Pole #00eeff; 2 Insular Cortex #000000"},
    {"ITK-SNAP labels",
     "################\n# ITK-SnAP Label Description File\n    0     0    0    0        0  0  0    \"Clear Label\"\n"
     "    1   255    0    7     1.00  1  1    \"Label 1\"\r\n",
     "1 Label 1 #ff0007"},
    {"BIDS label table",
     "name\tindex\tabbreviation\tcolor\themisphere\tmapping\textra\nVisual 1\t1\tV1\t#FF0a00\tL\t17\tx\n"
     "Visual 2\t2\tn/a\tn/a\tn/a\tn/a\tn/a\n",
     "1 Visual 1 (V1) #ff0a00 L; 2 Visual 2"},
    {"CSV label table",
     "id,acronym,name,parent_structure_id,color_hex_triplet\n8,grey,\"Grey, all\",997,BFDBE2\n997,root,root,,FFFFFF\n",
     "8 Grey, all (grey) #bfdbe2 <997; 997 root (root) #ffffff"},
    {"CSV label table",
     "ROIid;ROIabbr;ROIname;ROIoname\n1;lPre;Left Precentral;Precentral\n2;rPre;Right Precentral;x\n",
     "1 Left Precentral (lPre); 2 Right Precentral (rPre)"},
    {"Workbench label list", "LEFT AREA 1\n1 10 20 30 255\nRIGHT 2\n2 40 50 60 255\n",
     "1 LEFT AREA 1 #0a141e; 2 RIGHT 2 #28323c"},
    {"BrainGlobe structures",
     "[{\"acronym\":\"root\",\"id\":997,\"name\":\"root\",\"structure_id_path\":[997],\"rgb_triplet\":[255,255,255]},"
     "{\"acronym\":\"CH\",\"id\":312782656,\"name\":\"Cerebrum\",\"structure_id_path\":[997,312782656],\"rgb_triplet\":"
     "null}]",
     "997 root (root) #ffffff; 312782656 Cerebrum (CH) <997"},
    {"NiiVue labels", "{\"R\":[0,205],\"G\":[0,62],\"B\":[0,78],\"labels\":[\"\",\"Red nucleus\"]}",
     "1 Red nucleus #cd3e4e"},
    {"NiiVue labels", "{\"R\":[0,1],\"G\":[0,2],\"B\":[0,3],\"I\":[-1,5],\"labels\":[\"none\",\"x\"]}", "5 x #010203"},
    {"CSV without a header", "1,Precentral_L,2001\n2,Precentral_R,2002\n", "1 Precentral_L; 2 Precentral_R"},
    {"CSV without a header",
     "# id, name\r\n0;Background\r\n3 ; \"Gyrus; left\"\r\n7;\"Pole \"\"a\"\"\"\r\n9;\r\n8;6\r\n",
     "3 Gyrus; left; 7 Pole \"a\"; 8 6; 9 -"},
    {"CSV without a header", "30 , FLW , frontal left WM\n210 , FLG , frontal left GM\n", "30 FLW; 210 FLG"},
    {"CSV without a header", "1,Caudate\n2,Caudate\n", "1 Caudate; 2 Caudate"},
    {"CSV label table", "value,label\n3,Hippocampus\n4,12\n5,Pole\n", "3 Hippocampus; 4 12; 5 Pole"},
    {"BIDS label table", "value\tlabel\torig_label\themisphere\n1\torbital\t260\tleft\n2\ttecta\t261\tleft\n",
     "1 orbital L; 2 tecta L"},
    {"CSV label table", "value,label,name\n0.5,3,Pole\n", "3 Pole"},
    {"FSLeyes colours", "1 0 0.5 1\n2 1 1 1\n300 0.2 0 0\n", "1 - #0080ff; 2 - #ffffff; 300 - #330000"},
    {"JSON map of names", "{ \"17\" : \"Hippocampus\", \"0\": \"Unknown\", \"5\": \"V1\" }", "5 V1; 17 Hippocampus"},
    {"JSON list of labels",
     "[ {\"label\": 2, \"name\": \"b\", \"color\": \"#0a0b0c\"}, {\"name\": \"a\", \"abbreviation\": \"A\", \"label\": "
     "1}]",
     "1 a (A); 2 b #0a0b0c"},
    {"JSON list of labels", "[{\"index\": 4, \"label\": \"d\"}]", "4 d"},
    {"JSON list of labels", /* MeshView's: a tree */
     "[{\"id\":1000,\"name\":\"Brain\",\"children\":[{\"id\":1001,\"name\":\"White matter\",\"children\":[{\"id\":180,"
     "\"name\":\"tract\",\"color\":\"ff00dd\"}]},{\"id\":67,\"name\":\"callosum\",\"color\":\"#ff6e00\"}]}]",
     "67 callosum #ff6e00 <1000; 180 tract #ff00dd <1001; 1000 Brain; 1001 White matter <1000"},
    {"JSON list of labels", "{\"id\": 1, \"name\": \"a\", \"children\": [{\"id\": 2, \"name\": \"b\"}]}",
     "1 a; 2 b <1"},
    {"BrainGlobe structures", /* Allen's answer to StructureGraph */
     "{\"success\":true,\"msg\":[{\"id\":997,\"acronym\":\"root\",\"name\":\"root\",\"color_hex_triplet\":\"FFFFFF\","
     "\"parent_structure_id\":null,\"children\":[{\"id\":8,\"acronym\":\"grey\",\"name\":\"Grey\","
     "\"color_hex_triplet\":\"BFDAE3\",\"children\":[]}]}]}",
     "8 Grey (grey) #bfdae3 <997; 997 root (root) #ffffff"},
    {"BIDS label table", "index\tname\tcolor\n1\ta\trgba(0,0,0,0)\n2\tb\trgb(255, 127,1)\n3\tc\trgba(1,2,3,0.5)\n",
     "1 a #000000; 2 b #ff7f01; 3 c #010203"},
    {"FSLeyes colours", "1 0.1 0.2 0.4  1\n2 0.6 0.4 1  1\n", "1 - #1a3366; 2 - #9966ff"},
    {"FSLeyes colours", "1 0.1 0.2 0.4 1\n7 0.6 0.4 1 7\n", "1 - #1a3366; 7 - #9966ff"},
    {"JSON list of labels", "[{\"id\": 1, \"name\": \"a\"}]", "1 a"},
    {"OME image-label", /* of version 0.5, in zarr.json */
     "{\"attributes\":{\"ome\":{\"image-label\":{\"colors\":[{\"label-value\":3,\"rgba\":[1,2,3,255]},{\"label-value\":"
     "1,"
     "\"rgba\":[4,5,6,0]},{\"label-value\":0,\"rgba\":[0,0,0,0]}],\"properties\":[{\"label-value\":2,\"class\":\"b\","
     "\"area\":"
     "7},{\"label-value\":1,\"label\":\"x\",\"name\":\"a\"}]}}}}",
     "1 a #040506; 2 b; 3 - #010203"},
    {"OME image-label", /* of version 0.4, in .zattrs */
     "{\"multiscales\":[],\"image-label\":{\"properties\":[{\"label-value\":5,\"label\":\"c\"},{\"label-value\":4}]}}",
     "4 -; 5 c"},
    {"NiiVue labels", "{\"R\":[1],\"G\":[2],\"B\":[3],\"I\":[500],\"labels\":[\"x\"]}", "500 x #010203"},
};
static void formats_are_detected_from_content(void **state)
{
    (void)state;
    assert_samples(samples, sizeof samples / sizeof samples[0]);
}

static void bad_cells_are_named_with_their_line(void **state)
{
    (void)state;
    assert_refused("1 a\n3.5 b\n", "MRIcron text: line 2: label \"3.5\", a whole number from 0 to 4294967295");
    assert_refused("# c\n1 a\n\n-2 b\n", "line 4: label \"-2\"");
    assert_refused("4294967296 a\n", "line 1: label \"4294967296\"");
    assert_refused("1 a\n2 b\nc d\n", "line 3: label \"c\"");
    assert_refused("1 a 0 nan 0 0\n", "line 1: green is \"nan\", a whole number from 0 to 255");
    assert_refused("1 a 0 0 256 0\n", "line 1: blue is \"256\"");
    assert_refused("1 a 0.5 0 6 0\n", "line 1: red is \"0.5\"");
    assert_refused("1 a 1 2 3 4\n2 b 1 2 3 4\n3 c 1 2 3\n", "line 3: 3 numbers after the name, 4 (R G B A)");
    assert_refused("1 0.5 0.5 1.5 a\n", "line 1: blue is \"1.5\", a number from 0 to 1");
    assert_refused("1 1 2 3 1.0 1 1 \"open\n", "line 1: no name in quotation marks");
    assert_refused("1 1 2 3 nan 1 1 \"a\"\n", "line 1: opacity is not a number from 0 to 255");
    assert_refused("index\tname\n1\ta\nx\tb\n", "BIDS label table: line 3: label \"x\"");
    assert_refused("index\tname\tcolor\n1\ta\tred\n", "line 2: colour \"red\", #rrggbb");
    assert_refused("index\tname\n1\ta\tb\n", "line 2: 3 columns, the header has 2");
    assert_refused("index\tname\tindex\n1\ta\t2\n", "line 1: two columns are called index");
    assert_refused("[{\"id\":1,\"acronym\":\"a\\u0000\"}]", "BrainGlobe structures: line 1, column 28: \\u0000");
    assert_refused("id,name\n1,\"a\n", "line 2: a quotation mark is not closed");
    assert_refused("[{\"id\":1.5,\"acronym\":\"a\"}]", "structure 1: id must be a whole number");
    assert_refused("[{\"id\":7,\"acronym\":\"a\",\"structure_id_path\":[1,8]}]",
                   "structure_id_path ends in 8, its own id 7");
    assert_refused("[{\"id\":7,\"acronym\":\"a\",\"rgb_triplet\":[1,2]}]", "three whole numbers");
    assert_refused("[{\"id\":7,\"acronym\":\"a\"},]", "BrainGlobe structures: line 1");
    assert_refused("{\"R\":[0,1],\"G\":[0],\"B\":[0],\"labels\":[\"\"]}", "R has 2 entries, labels has 1");
    assert_refused("{\"R\":[1],\"G\":[1],\"B\":[1],\"I\":[1.5],\"labels\":[\"x\"]}", "labels[0]: I must be a whole");
    assert_refused("1,a\n2.5,b\n3,c\n", "CSV without a header: line 2: label \"2.5\"");
    assert_refused("1,a\n2,Gyrus, left\n", "line 2: 3 columns, the first line has 2");
    assert_refused("1,a,b\n2,\"c\n3,d,e\n", "line 2: a quotation mark is not closed");
    assert_refused("1,Left,Caudate\n2,Right,Caudate\n3,Left,Putamen\n", "labels 1 and 3 are both \"Left\" in column 2");
    assert_refused("{\"1\": \"a\", \"x\": \"b\"}", "JSON map of names: a key: label \"x\"");
    assert_refused("{\"1\": \"a\", \"2\": 3}", "key 2: the name of the label must be a text");
    assert_refused("{\"1\": \"a\", \"1\": \"b\"}", "JSON map of names: line 1");
    assert_refused("[{\"id\": 1, \"name\": \"a\"}, {\"id\": -2, \"name\": \"b\"}]",
                   "object 2: id must be a whole number");
    assert_refused("[{\"id\": 1, \"name\": \"a\"}, {\"id\": 2, \"label\": \"b\"}]", "object 2: name must be a text");
    assert_refused("[{\"id\": 1.5, \"name\": \"a\"}]", "the first object has no whole number");
    assert_refused("0 nothing\n", "no label but 0");
}

/* The user says which columns of a table with other headings are labels and names. */
static void columns_are_chosen_by_name(void **state)
{
    (void)state;
    static const struct {
        const char *text, *columns[2], *wanted; /* `wanted` begins with '!' if it is a message */
    } cases[] = {
        {"Nr;Bezeichnung\n1;Hippokampus\n2;\"Kern; roter\"\n", {"Nr", "Bezeichnung"}, "1 Hippokampus; 2 Kern; roter"},
        {"Nr;Titel;Kern, Rinde\n1;a;b\n", {"Nr", "Titel"}, "1 a"}, /* the comma is no separator: there are fewer */
        {"Bezeichnung\tNr\nA, b\t3\n", {"Nr", "Bezeichnung"}, "3 A, b"},
        {"Label No,Full name,color\n7,\"a \"\"b\"\"\",#102030\n", {"Label No", "Full name"}, "7 a \"b\" #102030"},
        {"Nr,Titel, deutsch;x\n",
         {"Nr", ""},
         "!line 1: no column is called \"name\", there are \"Nr\", \"Titel\", \"deutsch;x\""},
        {"index,name,Kurz\n1,a,b\n", {"", "Kurz"}, "1 b"},
        {"index,code,name\n1,5,a\n", {"code", ""}, "5 a"},
        {"Nr;Bezeichnung\n1;a\n",
         {"Nr", "Name"},
         "!line 1: no column is called \"Name\", there are \"Nr\", \"Bezeichnung\""},
        {"Nr;Bezeichnung\n1.5;a\n", {"Nr", "Bezeichnung"}, "!line 2: label \"1.5\""},
        {"# nothing\n", {"Nr", ""}, "!no header row"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct parsed parsed = {0};
        const struct label_use use = {.columns = {text_from(cases[i].columns[0]), text_from(cases[i].columns[1])}};
        const char *text = cases[i].text;
        conus_status status = parsed_from_bytes(&parsed, &(const struct bytes){(uint8_t *)text, strlen(text)}, &use);
        if (cases[i].wanted[0] == '!') {
            assert_fails(status, CONUS_ERROR_DATA);
            assert_non_null(strstr(conus_message(), cases[i].wanted + 1));
        } else {
            assert_ok(status);
            assert_string_equal(parsed_text(&parsed.table), cases[i].wanted);
        }
        parsed_finish(&parsed);
    }
}

/* The message names the columns that were found and those that are needed. */
static void a_header_of_other_words_is_named(void **state)
{
    (void)state;
    assert_refused(
        "Nr;Bezeichnung\n1;Hippokampus\n",
        "not a label table of a known format: its columns are \"Nr\", \"Bezeichnung\"; needed are a label (index, "
        "LabelValue, annotation_value, id, key, ROIid, label) and a name (name, region, structure, ROIname, label), or "
        "FILE,label=COLUMN,name=COLUMN");
    assert_refused("no,title,x\n1,a,2\n", "its columns are \"no\", \"title\", \"x\"; needed");
    assert_refused("About this atlas\n", "(known: ");
}

static void what_is_no_table_is_refused(void **state)
{
    (void)state;
    static const char known[] = "not a label table of a known format";
    assert_refused("", known);
    assert_refused(" \n\n", known);
    assert_refused("# only comments\n", known);
    assert_refused("<!DOCTYPE html><html><body>404 Not Found</body></html>", known);
    assert_refused("About this atlas: it was made from 20 brains.\nSee http://example.org\n", known);
    assert_refused("value,label\n0.53,1\n0.61,2\n", known);                 /* a table of results */
    assert_refused("value,label\n53,1\n61,2\n", known);                     /* likewise */
    assert_refused("name,value\nHippocampus,3512\n", known);                /* likewise */
    assert_refused("label,value\nHippocampus,3512\n", known);               /* likewise */
    assert_refused("1,0.5,0.25\n2,0.5,0.125\n", known);                     /* likewise */
    assert_refused("Hippocampus,3512\nCaudate,1200\n", known);              /* likewise */
    assert_refused("1,2,Caudate\n2,1,Putamen\n", known);                    /* two numbers: ambiguous */
    assert_refused("[{\"id\": \"T1\", \"name\": \"a\"}]", known);           /* no number */
    assert_refused("[{\"name\": \"Hippocampus\", \"value\": 7}]", known);   /* a result */
    assert_refused("{\"EchoTime\": 1, \"labels\": {\"1\": \"a\"}}", known); /* a sidecar */
    assert_refused("{\"1\": 2}", known);
    assert_refused("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", known); /* a transform */
    assert_refused("1 0.5 0.5 0.5\n", known);
    assert_refused("1 0 0 10\n0 1 0 20\n0 0 1 30\n0 0 0 1\n", known); /* a transform */
    assert_refused("1\n2\n3\n", known);
    assert_refused("{\"Name\": \"a BIDS sidecar\"}", known);
    assert_refused("\xff\xfe"
                   "1\n",
                   "UTF-16");
    struct parsed parsed = {0};
    uint8_t zeros[512] = {0};
    assert_fails(parsed_from_bytes(&parsed, &(const struct bytes){zeros, sizeof zeros}, &no_use), CONUS_ERROR_DATA);
}

static void oddities_are_noted(void **state)
{
    (void)state;
    struct parsed parsed;
    assert_ok(
        parsed_from(&parsed, "index\tname\themisphere\n0\tLeft Frontal Pole\tL\n1\tRight\tmiddle\n1\tWrong\tR\n"));
    assert_int_equal(parsed.table.count, 1);
    assert_true(notes_have(&parsed.notes, "calls label 0 \"Left Frontal Pole\""));
    assert_true(notes_have(&parsed.notes, "hemisphere \"middle\" is none of L, R, B"));
    assert_true(notes_have(&parsed.notes, "label 1 is named twice"));
    parsed_finish(&parsed);
    assert_ok(parsed_from(&parsed, "1 a\n1 b\n1 c\n1 d\n1 e\n1 f\n1 g\n1 h\n1 i\n1 j\n1 k\n1 a\n"));
    assert_int_equal(parsed.notes.count, 9);
    assert_true(notes_have(&parsed.notes, "2 more labels are named twice"));
    parsed_finish(&parsed);
    assert_ok(parsed_from(&parsed, "index,label,name\n1,10,a\n2,20,b\n"));
    assert_int_equal(parsed.notes.count, 1);
    assert_true(notes_have(&parsed.notes, "line 2: two columns could be the label's number, 1 and 10: 1 is used"));
    parsed_finish(&parsed);
    assert_ok(parsed_from(&parsed, "label,id,name\n1,1,a\n2,2,b\n"));
    assert_int_equal(parsed.notes.count, 0);
    parsed_finish(&parsed);
    assert_ok(parsed_from(&parsed, "0\tUnclassified\n1\ta\n"));
    assert_int_equal(parsed.notes.count, 0);
    parsed_finish(&parsed);
}

/* The volume has the labels 1 to 3; by hand, which column names most of them. */
static void the_column_that_fits_the_volume_is_the_number(void **state)
{
    (void)state;
    static const struct {
        const char *text, *table, *note;
    } tables[] = {
        {"index,label,name\n0,1,a\n1,2,b\n2,3,c\n", "1 a; 2 b; 3 c", "\"label\" is the label's number"},
        {"label,id,name\n1,101,a\n2,102,b\n3,103,c\n", "1 a; 2 b; 3 c", "(3) than \"id\""},
        {"id;key;name\nT1;1;a\nT2;2;b\n", "1 a; 2 b", "\"key\" is the label's number"},
        {"name\tid\tvalue\na\t7\t1\nb\t8\t3\n", "1 a; 3 b", "\"value\" is the label's number"},
        {"index,label,name\n1,3,a\n2,1,b\n3,2,c\n", "1 a; 2 b; 3 c",
         "two columns could be the label's number, 1 and 3"},
        {"index,label,name\n7,8,a\n9,7,b\n", "7 a; 9 b", "two columns could be the label's number, 7 and 8"},
        {"[{\"id\": 11, \"label\": 2, \"name\": \"a\"}, {\"id\": 3, \"label\": 1, \"name\": \"b\"}]", "1 b; 2 a",
         "\"label\" is the label's number"},
        {"index,region,name\n1,Insula,ins\n2,Pole,po\n", "1 ins; 2 po",
         "could be the label's name, \"ins\" and \"Insula\""},
        {"index,label,name\n1,1,a\n2,2,b\n", "1 a; 2 b", NULL},
    };
    static const uint32_t labels[] = {0, 1, 2, 3};
    struct label_voxels voxels;
    assert_ok(label_voxels_of(&voxels, labels, 4));
    for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
        struct parsed parsed = {0};
        const struct label_use use = {.voxels = &voxels};
        const struct bytes bytes = {(uint8_t *)tables[i].text, strlen(tables[i].text)};
        assert_ok(parsed_from_bytes(&parsed, &bytes, &use));
        assert_string_equal(parsed_text(&parsed.table), tables[i].table);
        assert_true(tables[i].note ? notes_have(&parsed.notes, tables[i].note) : !parsed.notes.count);
        parsed_finish(&parsed);
        const struct label_use asked = {.voxels = &voxels, .columns = {text_from("index")}};
        if (i < 2 && !parsed_from_bytes(&parsed, &bytes, &asked)) {
            assert_int_equal(i, 0); /* the second has no such column */
            assert_string_equal(parsed_text(&parsed.table), "1 b; 2 c");
            parsed_finish(&parsed);
        }
    }
    label_voxels_finish(&voxels);
}

/* MRIcron's colours have 768 bytes, too. */
static void a_text_of_768_bytes_is_no_lut(void **state)
{
    (void)state;
    char text[769];
    int length = snprintf(text, sizeof text, "1 Ge\xdf%*s2 Pole%*s", 375, "\n", 382, "\n");
    assert_int_equal(length, 5 + 375 + 6 + 382);
    struct parsed parsed;
    assert_ok(parsed_from(&parsed, text));
    assert_string_equal(parsed_text(&parsed.table), "1 Ge\xc3\x9f; 2 Pole");
    parsed_finish(&parsed);
}

/* A parent is the row with that identifier; of several the first, whatever their order among the others. */
static void an_identifier_of_several_rows_is_noted(void **state)
{
    (void)state;
    struct parsed parsed;
    assert_ok(
        parsed_from(&parsed, "identifier,parent_identifier,index,name\n7,3,1,a\n3,,9,b\n3,,2,c\n3,,4,d\n5,7,6,e\n"));
    static const uint32_t parents[] = {9, 0, 0, 0, 1}; /* of a to e */
    assert_int_equal(parsed.table.count, 5);
    for (size_t i = 0; i < 5; i++) {
        const struct label *label = &parsed.table.entries[i];
        assert_int_equal(label->parent, parents[label->name[0] - 'a']);
    }
    assert_int_equal(parsed.notes.count, 1);
    assert_true(notes_have(&parsed.notes, "several rows have the identifier 3: as a parent it means the first of them, "
                                          "label 9"));
    parsed_finish(&parsed);
    assert_ok(parsed_from(&parsed, "identifier,parent_identifier,index,name\n3,,9,a\n3,,9,a\n4,3,8,b\n"));
    assert_false(notes_have(&parsed.notes, "several rows have the identifier"));
    parsed_finish(&parsed);
}

static void a_lut_gives_colours_only(void **state)
{
    (void)state;
    struct parsed parsed = {0};
    uint8_t lut[768] = {0};
    lut[7] = 10, lut[256 + 7] = 20, lut[512 + 7] = 30;
    assert_ok(parsed_from_bytes(&parsed, &(const struct bytes){lut, sizeof lut}, &no_use));
    assert_string_equal(parsed.format, "MRIcron colours");
    const struct label *seven = label_table_find(&parsed.table, 7);
    assert_non_null(seven);
    assert_null(seven->name);
    assert_true(seven->has_rgb);
    assert_int_equal(seven->rgb[1], 20);
    assert_false(label_table_find(&parsed.table, 8)->has_rgb); /* black: an unused entry */
    parsed_finish(&parsed);
}

static conus_status parsed_from_file(struct parsed *out, const char *path)
{
    struct job job = {0};
    label_file_read(&job, &out->table, &out->format, path, NULL);
    return job_close(&job, &out->notes, NULL);
}

/* Number of labels, first and last name of tables by other programs. */
static void real_tables_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *path, *format;
        size_t count;
        const char *first, *last;
    } files[] = {
        {"labels/bids/tpl-MNI152NLin2009cAsym_atlas-4S_scale-156_res-01_dseg.tsv", "BIDS label table", 156, "LH_Vis_1",
         "Cerebellar_Region10"},
        {"labels/bids/tpl-MNI152NLin6Asym_atlas-HOCPAL_dseg.tsv", "BIDS label table", 51, "Right Frontal Pole",
         "Right Occipital Pole"},
        {"labels/brainglobe/ccf25.structures.json", "BrainGlobe structures", 840,
         "Tuberomammillary nucleus, ventral part", NULL},
        {"labels/freesurfer/FreeSurferColorLUT.txt", "FreeSurfer colour table", 0, "Left-Cerebral-Exterior",
         "wm_rh_S_temporal_transverse"},
        {"labels/fsleyes-lut/harvard-oxford-cortical.lut", "FSLeyes colour table", 48, "Frontal Pole",
         "Occipital Pole"},
        {"labels/itksnap/MRIcrop-seg.label", "ITK-SNAP labels", 0, "vent-lat", "arteries"},
        {"labelvol/bigbrain-subcort/bigbrain.json", "NiiVue labels", 22, "Left-red-nucleus", "Right-amygdala"},
        {"labelvol/julich31/Julich.json", "NiiVue labels", 207, "Area 3b (PostCG)", "Area TeI (STG)"},
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        struct parsed parsed = {0};
        assert_ok(parsed_from_file(&parsed, test_shared(files[i].path)));
        assert_string_equal(parsed.format, files[i].format);
        assert_true(!files[i].count || files[i].count == parsed.table.count);
        assert_string_equal(parsed.table.entries[0].name, files[i].first);
        if (files[i].last) {
            assert_string_equal(parsed.table.entries[parsed.table.count - 1].name, files[i].last);
        }
        parsed_finish(&parsed);
    }
}

static void a_lut_beside_an_override_colours_it(void **state)
{
    (void)state;
    struct parsed parsed = {0};
    assert_ok(parsed_from_file(&parsed, test_mricron("aal.nii.txt")));
    assert_int_equal(parsed.table.count, 116);
    assert_string_equal(parsed.table.entries[115].name, "Vermis_10");
    assert_true(parsed.table.entries[0].has_rgb);
    assert_int_equal(parsed.table.entries[0].rgb[0], 204);
    parsed_finish(&parsed);
}

TEST_GROUP(labels)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formats_are_detected_from_content),
        cmocka_unit_test(bad_cells_are_named_with_their_line),
        cmocka_unit_test(columns_are_chosen_by_name),
        cmocka_unit_test(a_header_of_other_words_is_named),
        cmocka_unit_test(what_is_no_table_is_refused),
        cmocka_unit_test(oddities_are_noted),
        cmocka_unit_test(an_identifier_of_several_rows_is_noted),
        cmocka_unit_test(the_column_that_fits_the_volume_is_the_number),
        cmocka_unit_test(a_text_of_768_bytes_is_no_lut),
        cmocka_unit_test(a_lut_gives_colours_only),
        cmocka_unit_test(real_tables_are_read),
        cmocka_unit_test(a_lut_beside_an_override_colours_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
