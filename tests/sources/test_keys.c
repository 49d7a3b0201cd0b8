/* SPDX-License-Identifier: BSD-3-Clause */
/* FILE,key=value: where the file ends, what its keys say, and which texts are refused. */
#include "sources/names.h"

#include "base/files/file.h"
#include "base/system/system.h"
#include "test.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Each text stands behind the scratch folder and '/'. "a.nii" is there, and "b,volume=1.nii", and no other but what
 * a case says. */
static void put(const char *name)
{
    assert_ok(file_write_soon(test_scratch(name), "x", 1));
}

static void make_folder(const char *name)
{
    assert_true(system_make_folder(test_scratch(name), false) || errno == EEXIST);
}

static void what_is_cut_off(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum key_kind kind;
        const char *file;
        size_t count;
    } cases[] = {
        {"a.nii", KEYS_ATLAS, "a.nii", 0},
        {"a.nii,volume=1", KEYS_ATLAS, "a.nii", 1},
        {"a.nii,volume=1,template=none,map=x, y,space=/other/image,1.nii", KEYS_ATLAS, "a.nii", 4},
        {"b,volume=1.nii", KEYS_VOLUME, "b,volume=1.nii", 0},
        {"b,volume=1.nii,volume=2", KEYS_VOLUME, "b,volume=1.nii", 1},
        {"gone, b.nii,volume=2", KEYS_VOLUME, "gone, b.nii", 1},
        {"gone,moves.trk", KEYS_STREAMLINES, "gone,moves.trk", 0},
        {"gone.trk,moves", KEYS_STREAMLINES, "gone.trk", 1},
        {"gone.trk,moves", KEYS_PATHWAY, "gone.trk,moves", 0},
        {"gone.nii,foo=1", KEYS_PATHWAY, "gone.nii,foo=1", 0},
        {"gone.nii,foo=1,threshold=2", KEYS_PATHWAY, "gone.nii,foo=1", 1},
        {"a.nii,name=in/out,unit=%", KEYS_PATHWAY, "a.nii", 2},
        {"a.nii,band=0:9:x,band=9::y", KEYS_PATHWAY, "a.nii", 2},
        {"a.nii,from=m, n.nii,inverse,to=/z.nii", KEYS_TRANSFORM, "a.nii", 3},
        {"-,x=a, mm,y=b,z=c", KEYS_POSES, "-", 3},
        {"a.nii,within=4", KEYS_CLEARANCE, "a.nii", 1},
        {"poses.csv,x=a,y=b,z=c,5,shank=all", KEYS_APART, "poses.csv,x=a,y=b,z=c,5", 1},
        {"A,\"B, left\",length=5,part=1:2", KEYS_REACH, "A,\"B, left\"", 2},
        {"s.gii,space=t.tif,resolution=1000,orientation=asr", KEYS_SCENE, "s.gii", 1},
        {"s.gii,volume=1,space=t.nii,volume=0,map=a,template=none", KEYS_ATLAS, "s.gii", 3},
        {"s.gii,space=ras,map=1", KEYS_SCENE, "s.gii", 2},
        {"m,level=1/a.nii", KEYS_VOLUME, "m,level=1/a.nii", 0},
        {"m,level=1/a.nii,volume=2", KEYS_VOLUME, "m,level=1/a.nii", 1},
        {"m,level=1/gone.nii", KEYS_VOLUME, "m,level=1/gone.nii", 0},
        {"m,level=1/x,y.tsv,within=4", KEYS_CLEARANCE, "m,level=1/x,y.tsv", 1},
        {"m,within=../y.nii", KEYS_ENTRIES, "m", 1},
    };
    make_folder("m");
    make_folder("m,level=1");
    put("m,level=1/a.nii");
    put("a.nii");
    put("b,volume=1.nii");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct source_keys keys;
        char kept[4096 + 256];
        char text[4096 + 256];
        snprintf(text, sizeof text, "%s", test_scratch(cases[i].text));
        const char *name = cases[i].text + strlen(cases[i].file);
        if (!keys_read(&keys, text, cases[i].kind)) {
            fail_msg("%s: %s", cases[i].text, keys.why);
        }
        assert_string_equal(text + keys.length, name);
        assert_int_equal(keys.count, cases[i].count);
        assert_int_equal(keys_file_length(text, cases[i].kind), keys.length);
        keys_keep(kept, text, &keys, 0);
        assert_int_equal(strlen(kept), keys.length);
        if (cases[i].kind != KEYS_TRANSFORM && !(keys.given & KEY_BIT(KEY_MOVES))) {
            keys_keep(kept, text, &keys, cases[i].kind);
            assert_string_equal(kept, text);
        }
    }
}

static void what_keys_say(void **state)
{
    (void)state;
    struct source_keys keys;
    assert_true(keys_read(&keys, "f,tissue=7:2,volume=12,resolution=25:20:10,map= a, b ", KEYS_VOLUME));
    const struct key_value *tissue = keys_value(&keys, KEY_TISSUE);
    assert_int_equal(tissue->count, 2);
    assert_near(tissue->numbers[1], 2, 0);
    assert_near(keys_value(&keys, KEY_VOLUME)->numbers[0], 12, 0);
    assert_near(keys_value(&keys, KEY_RESOLUTION)->numbers[2], 10, 0);
    assert_true(text_equal(keys_value(&keys, KEY_MAP)->text, " a, b "));
    assert_int_equal(keys_value(&keys, KEY_LEVEL)->text.size, 0);
    assert_int_equal(keys_value(&keys, KEY_LEVEL)->count, 0);
    char kept[64];
    keys_keep(kept, "f,tissue=7:2,volume=12,resolution=25:20:10,map= a, b ", &keys, KEYS_PATHWAY);
    assert_string_equal(kept, "f,volume=12,resolution=25:20:10");
    char why[KEYS_WHY];
    assert_false(keys_fit(why, &keys, KEY_BIT(KEY_VOLUME)));
    assert_non_null(strstr(why, "tissue is for results of SimNIBS"));
    assert_true(keys_fit(why, &keys, ~UINT64_C(0)));
    assert_true(keys_read(&keys, "f,range=-1:2.5", KEYS_MAP));
    assert_near(keys_value(&keys, KEY_RANGE)->numbers[0], -1, 0);
    assert_true(keys_read(&keys,
                          "f,range=\xe2\x88\x92"
                          "2:2",
                          KEYS_MAP)); /* as texts have a minus */
    assert_near(keys_value(&keys, KEY_RANGE)->numbers[0], -2, 0);
    assert_true(keys_read(&keys, "f,sides= anyway ", KEYS_POSES));
    const char *image = "f,space=a.nii,volume=3,orientation=asr";
    assert_true(keys_read(&keys, image, KEYS_SCENE));
    assert_true(text_equal(keys_value(&keys, KEY_SPACE)->text, image + strlen("f,space=")));
}

static void what_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum key_kind kind;
        const char *why;
    } cases[] = {
        {"f,volume=x", KEYS_VOLUME, "volume: found \"x\", allowed are whole numbers from 0"},
        {"f,volume=", KEYS_VOLUME, "volume: found \"\""},
        {"f,volume=1:2", KEYS_VOLUME, "volume: found \"1:2\""},
        {"f,volume=-1", KEYS_VOLUME, "volume: found \"-1\""},
        {"f,volume=99999999999999999999", KEYS_VOLUME, "volume: found"},
        {"f,volume=4294967295", KEYS_VOLUME, "volume: found \"4294967295\", allowed are whole numbers from 0 to 42949"},
        {"f,volume=0,=3", KEYS_VOLUME, "found \"=3\", allowed are volume"},
        {"f,space=,volume=0", KEYS_SCENE, "space: found \"\", allowed are ras, lps and an image"},
        {"f,range=\xe2\x88\x92-2:2", KEYS_MAP, "range: found"},
        {"f,range=\xe2\x88\x92:2", KEYS_MAP, "range: found"},
        {"A,Tip=3", KEYS_REACH, "allowed are length, tip, "},
        {"A,Tip=3", KEYS_REACH, "; did you mean tip?"},
        {"A,=3", KEYS_REACH, "found \"=3\", allowed are length"},
        {"f,level=2147483648", KEYS_VOLUME, "level: found"},
        {"f,tissue=1:2:3:4:5:6:7:8:9:1:2:3:4:5:6:7:8", KEYS_VOLUME, "tissue: found"},
        {"f,resolution=1:2", KEYS_VOLUME, "resolution: found \"1:2\""},
        {"f,resolution=0", KEYS_VOLUME, "resolution: found \"0\""},
        {"f,resolution=inf", KEYS_VOLUME, "resolution: found \"inf\""},
        {"f,resolution=1:1:1:1", KEYS_VOLUME, "resolution: found"},
        {"f,range=1", KEYS_MAP, "range: found \"1\""},
        {"f,threshold=nan", KEYS_PATHWAY, "threshold: found \"nan\", allowed is a number above 0"},
        {"f,threshold=0,5", KEYS_PATHWAY, "\"threshold=0,5\" has a comma in it; a number has a decimal point"},
        {"f,name=A,B,radius=1", KEYS_STREAMLINES, "\"name=A,B\" has a comma in it"},
        {"f,volume=0,foo=1", KEYS_VOLUME,
         "found \"foo=1\", allowed are volume, resolution, orientation, level, field, tissue, map"},
        {"f,volume=0,volume=0", KEYS_VOLUME, "volume is given twice"},
        {"f,moves,moves", KEYS_STREAMLINES, "moves is given twice"},
        {"f,moves,space=up", KEYS_STREAMLINES, "space: found \"up\", allowed are ras and lps"},
        {"f,template=", KEYS_ATLAS, "template: found \"\", allowed are mni152"},
        {"f,map=", KEYS_VERTICES, "map: found \"\", a number from 0 or a name is needed"},
        {"f,with=3", KEYS_CLEARANCE, "found \"with=3\", allowed are within; did you mean within?"},
        {"f,within", KEYS_CLEARANCE, "within: a value is needed"},
        {"A,tip=3", KEYS_REACH, "tip: no value is allowed"},
        {"A,part=3:1", KEYS_REACH, "part: found \"3:1\""},
        {",length=3", KEYS_REACH, "\",length=3\" names no structure"},
        {",most=2", KEYS_ARCS, "\",most=2\" names no degrees"},
        {",nasion=1:2:3", KEYS_SCALP, "\",nasion=1:2:3\" names no file"},
        {"f,unit=mm,sides=no", KEYS_POSES, "sides: found \"no\", allowed is anyway"},
    };
    struct source_keys keys;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_false(keys_read(&keys, cases[i].text, cases[i].kind));
        if (!strstr(keys.why, cases[i].why)) {
            fail_msg("%s: \"%s\" does not say \"%s\"", cases[i].text, keys.why, cases[i].why);
        }
    }
    enum { BAND = 9 };
    char many[(KEYS_MOST + 1) * BAND + 2] = "f";
    for (size_t i = 0; i <= KEYS_MOST; i++) {
        memcpy(many + 1 + i * BAND, ",band=::x", BAND + 1);
    }
    many[1 + KEYS_MOST * BAND] = '\0'; /* one less */
    assert_true(keys_read(&keys, many, KEYS_PATHWAY));
    many[1 + KEYS_MOST * BAND] = ',';
    assert_false(keys_read(&keys, many, KEYS_PATHWAY));
    assert_non_null(strstr(keys.why, "there are 128 keys"));
    assert_true(keys_read_alone(&keys, "x=a, mm,unit=cm", KEYS_POSES));
    assert_int_equal(keys.count, 2);
    assert_false(keys_read_alone(&keys, "w=a", KEYS_POSES));
    assert_non_null(strstr(keys.why, "found \"w=a\", allowed are x, y, z, name, place, unit, sides"));
}

/* What may be two files is neither; a word behind a file that is there is a key with another name. */
static void files_decide(void **state)
{
    (void)state;
    struct source_keys keys;
    char path[4096];
    put("c.nii");
    put("c.nii,volume=1");
    snprintf(path, sizeof path, "%s", test_scratch("c.nii,volume=1"));
    assert_false(keys_read(&keys, path, KEYS_VOLUME));
    assert_non_null(strstr(keys.why, "c.nii,volume=1\" is there, and so is \""));
    assert_non_null(strstr(keys.why, "c.nii\""));
    assert_true(keys_read(&keys, path, KEYS_STREAMLINES)); /* which have no such key */
    snprintf(path, sizeof path, "%s", test_scratch("c.nii,volume=1,level=0"));
    assert_false(keys_read(&keys, path, KEYS_VOLUME));
    assert_non_null(strstr(keys.why, "c.nii,volume=1\" is there, and so is \"")); /* without what is not */
    snprintf(path, sizeof path, "%s", test_scratch("c.nii,volume=2"));
    assert_true(keys_read(&keys, path, KEYS_VOLUME));
    snprintf(path, sizeof path, "%s", test_scratch("c.nii,treshold=2"));
    assert_false(keys_read(&keys, path, KEYS_PATHWAY));
    assert_non_null(strstr(keys.why, "found \"treshold=2\", allowed are "));
    static const char *const unknown[] = {"c.nii,Treshold=2", "c.nii,trehsold", "c.nii,=", "c.nii,x,threshold=2"};
    for (size_t i = 0; i < sizeof unknown / sizeof unknown[0]; i++) {
        snprintf(path, sizeof path, "%s", test_scratch(unknown[i]));
        assert_false(keys_read(&keys, path, KEYS_PATHWAY));
        assert_non_null(strstr(keys.why, "found \""));
        assert_string_equal(path + keys_file_length(path, KEYS_PATHWAY), unknown[i] + strlen("c.nii"));
    }
    put("e,x=1.csv"); /* its name has what looks like a key: "e" is not there */
    snprintf(path, sizeof path, "%s,colour=3", test_scratch("e,x=1.csv"));
    assert_false(keys_read(&keys, path, KEYS_POSES));
    assert_non_null(strstr(keys.why, "found \"colour=3\", allowed are x, y, z"));
    assert_string_equal(path + keys_file_length(path, KEYS_POSES), ",colour=3");
    make_folder("n");
    snprintf(path, sizeof path, "%s", test_scratch("n,o.nii"));
    assert_true(keys_read(&keys, path, KEYS_PATHWAY)); /* beside a folder */
    snprintf(path, sizeof path, "%s", test_scratch("n,o=1"));
    assert_false(keys_read(&keys, path, KEYS_PATHWAY));
    char longer[SYSTEM_PATH + 16]; /* than any path: nothing is there, and keys are cut off all the same */
    memset(longer, 'a', SYSTEM_PATH);
    memcpy(longer + SYSTEM_PATH, ",volume=1", sizeof ",volume=1");
    assert_int_equal(keys_file_length(longer, KEYS_VOLUME), SYSTEM_PATH);
}

TEST_GROUP(keys)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_cut_off),
        cmocka_unit_test(what_keys_say),
        cmocka_unit_test(what_is_refused),
        cmocka_unit_test(files_decide),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
