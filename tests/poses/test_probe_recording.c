/* SPDX-License-Identifier: BSD-3-Clause */
/* Probes of recordings by SpikeGLX and Open Ephys: places of contacts, what is refused; every prefix, every failing
 * allocation. Places are worked out by hand from ProbeTable's numbers: an electrode is the column e mod 2 of the row
 * e / 2. */
#include "base/files/file.h"
#include "conus/own.h"
#include "pose_checks.h"
#include "poses/programs/pose_programs.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *sample(const char *name)
{
    static char path[4096];
    snprintf(path, sizeof path, "%s/../probe_interface/%s", pose_sample("."), name);
    return path;
}

struct expected {
    const char *id, *shank;
    int channel;
    double x, y; /* micrometres */
};

static void check(const char *name, double tip_mm, const double tip[2], const struct expected *contacts, size_t count)
{
    conus_probe *probe = NULL;
    double found[3];
    assert_ok(conus_probe_load(&probe, sample(name), &(conus_probe_options){.tip = tip_mm}));
    conus_probe_tip(found, probe, 0);
    assert_near(found[0], tip[0], 1e-9);
    assert_near(found[1], tip[1], 1e-9);
    assert_int_equal(conus_probe_contact_count(probe), count);
    for (size_t i = 0; i < count; i++) {
        const conus_probe_contact *contact = conus_probe_at(probe, i);
        assert_string_equal(contact->id, contacts[i].id);
        assert_string_equal(contact->shank, contacts[i].shank);
        assert_int_equal(contact->channel, contacts[i].channel);
        assert_near(contact->position[0], contacts[i].x, 1e-9);
        assert_near(contact->position[1], contacts[i].y, 1e-9);
        assert_near(contact->offset[0], (contacts[i].x - tip[0]) / 1000, 1e-12);
        assert_near(contact->offset[2], (contacts[i].y - tip[1]) / 1000, 1e-12);
    }
    conus_probe_destroy(probe);
}

/* Neuropixels 1.0: even rows begin 27 um from the edge, odd ones 11; banks of 384, so that 387 is in row 193. */
static void a_table_of_sites(void **state)
{
    (void)state;
    static const struct expected contacts[] = {
        {"AP0", "0", 0, 27, 0}, {"AP1", "0", 1, 59, 0}, {"AP2", "0", 2, 11, 20}, {"AP3", "0", 3, 43, 3860}};
    check("np1.imro", 0, (double[]){35, -209}, contacts, 4);
    check("np1.imro", 0.3, (double[]){35, -300}, contacts, 4); /* from the lowest row, recorded or not */
}

/* Four shanks, 250 um from each other; channel 1 was not saved, and 4 is no contact. */
static void saved_channels_of_four_shanks(void **state)
{
    (void)state;
    static const struct expected contacts[] = {
        {"AP0", "2", 0, 559, 30}, {"AP2", "0", 1, 27, 9585}, {"AP3", "3", 2, 777, 30}};
    check("np2.ap.meta", 0, (double[]){35, -206}, contacts, 3);
}

/* Where the file has a map, that counts, for the saved channels in their order. */
static void a_map_of_positions(void **state)
{
    (void)state;
    static const struct expected contacts[] = {
        {"AP0", "0", 0, 14, 0}, {"AP2", "0", 1, 20.5, 0}, {"AP3", "0", 2, 26, 6}};
    check("ultra.ap.meta", 0, (double[]){35, -206.5}, contacts, 3);
}

/* The first probe's x are 19 um less than from the edge; the second one is switched off; the third's are from there. */
static void settings_of_open_ephys(void **state)
{
    (void)state;
    static const struct expected contacts[] = {{"probe1:CH0", "0", 0, 27, 0},
                                               {"probe1:CH3", "0", 3, 59, 2895},
                                               {"probe1:CH1", "0", 1, 59, 0},
                                               {"probe2:CH0", "1", 0, 277, 15},
                                               {"probe2:CH1", "3", 1, 809, 0}};
    check("settings.xml", 0, (double[]){35, -206}, contacts, 5);
}

#define META "acqApLfSy=2,2,1\nsnsApLfSy=2,0,1\nsnsSaveChanSubset=0:1,4\n"
#define XML(probe, version, channels, x, y)                                                                            \
    "<S><INFO><VERSION>" version "</VERSION></INFO><NP_PROBE probe_part_number=\"" probe "\"><CHANNELS " channels      \
    "/><ELECTRODE_XPOS " x "/><ELECTRODE_YPOS " y "/></NP_PROBE></S>"

static void what_is_wrong_is_said(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
    } wrong[] = {
        {"(0,2)(0 0 0 500 250 1)", "1 entries, it says 2"},
        {"(0,1)(1 0 0 500 250 1)", "\"(1 0 0 500 250 1)\", an entry of a probe NP1000 is needed, its channel below 1"},
        {"(0,1)(0 0.5 0 500 250 1)", "\"(0 0.5 0 500 250 1)\", an entry"},
        {"(0,1)(0 3 0 500 250 1)", "channel 0: electrode 1152 of shank 0, which a probe NP1000 does not have"},
        {"(24,1)(0 4 0 0 1)", "electrode 1 of shank 4"},
        {"(24,1)(0 0 0 1)", "an entry of a probe NP2010"},
        {"(24,2)(0 0 0 0 1)(0 0 0 0 2)", "contact_ids: two contacts are called \"AP0\""},
        {"(1100,1)(0 0 0 500 250 1)", "probe \"NP1100\": its positions are not known"},
        {"(641251209,3,384)(0 0 0 500 250)", "probe \"NP641251209\": its positions are not known"},
        {"(", "no table of sites"},
        {"snsApLfSy=1,0,1\n~imroTbl=(0,1)(0 0 0 500 250 1)\n", "acqApLfSy and snsApLfSy are needed"},
        {"acqApLfSy=1,1,1\nsnsApLfSy=0,1,1\n~imroTbl=(0,1)(0 0 0 1 1 1)\n", "no AP channels"},
        {"imProbeOpt=3\n~imroTbl=(1,3,1)(0 0 0 500 250)\n", "phase 3A"},
        {META, "neither ~snsGeomMap nor ~imroTbl"},
        {META "~imroTbl=(0,1)(0 0 0 500 250 1)\n", "saved channel 1 has no entry"},
        {META "~snsGeomMap=(NP1000,1,0,70)(0:27:0:1)\n", "saved channel 1 has no entry"},
        {META "~snsGeomMap=(NP1000,1,0,70)(0:27:0:1)(0:59:0:1)(0:11:20:1)\n", "3 contacts, 2 channels are saved"},
        {META "~snsGeomMap=(NP1000,1,0,70)(0:27:0:1)(1:59:0:1)\n", "\"(1:59:0:1)\", SHANK:X:Z:USED is needed"},
        {META "~snsGeomMap=(NP1000,1)(0:27:0:1)(0:59:0:1)\n", "(PART,SHANKS,PITCH,WIDTH)"},
        {META "~snsGeomMap=(NP9999,1,0,70)(0:27:0:1)(0:59:0:1)\n", "probe \"NP9999\", whose tip is not known"},
        {"acqApLfSy=2,2,1\nsnsApLfSy=1,0,1\nsnsSaveChanSubset=0:1\n~imroTbl=(0,2)(0 0 0 1 1 1)(1 0 0 1 1 1)\n",
         "snsApLfSy: 1 AP channels, snsSaveChanSubset has 2"},
        {"acqApLfSy=2,2,1\nsnsApLfSy=2,0,1\nsnsSaveChanSubset=1:0\n~imroTbl=(0,1)(0 0 0 1 1 1)\n",
         "\"1:0\" is no range"},
        {"<SETTINGS/>", "XML without a probe <NP_PROBE>"},
        {"<S>", "line 1"},
        {XML("NP1100", "1.0.0", "CH0=\"0\"", "CH0=\"14\"", "CH0=\"0\""), "\"NP1100\", whose geometry is not known"},
        {XML("NP2000", "1.0.0", "CH0=\"0\"", "CH1=\"27\"", "CH0=\"0\""), "without an ELECTRODE_XPOS and"},
        {XML("NP2000", "1.0.0", "CH0=\"0:1\"", "CH0=\"27\"", "CH0=\"0\""), "on a shank that it has"},
        {XML("NP2000", "1.0.0", "CH0=\"0\" CH1=\"0\"", "CH0=\"27\" CH1=\"60\"", "CH0=\"0\" CH1=\"0\""),
         "do not say on which rows and columns of a probe NP2000"},
        {XML("NP2000", "1.0.0", "CH0=\"0\"", "CH0=\"8\"", "CH0=\"0\""), "do not say on which"}, /* of two columns */
        {XML("NP2000", "1.0.0", "CH0=\"0\"", "CH0=\"27\"", "CH0=\"250\""), "do not say on which"},
        {XML("NP2014", "0.5.5", "CH0=\"0:3\"", "CH0=\"777\"", "CH0=\"750\""), "by Open Ephys before 0.6"},
        {XML("NP2020", "1.0.0", "CH0_1=\"0\"", "CH0_1=\"27\"", "CH0_1=\"0\""),
         "<CHANNELS CH0_1=\"0\">: CH and a number"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        conus_probe *probe = NULL;
        assert_fails(probe_parse(&probe, text_from(wrong[i].text), NULL), CONUS_ERROR_DATA);
        if (!strstr(conus_message(), wrong[i].part)) {
            fail_msg("\"%s\" is not in \"%s\"", wrong[i].part, conus_message());
        }
    }
}

/* A part number that is not known needs a tip; x as they are, from the edge, need not tell their columns. */
static void what_is_not_known_may_be_stated(void **state)
{
    (void)state;
    conus_probe *probe = NULL;
    assert_ok(probe_parse(&probe, text_from(META "~snsGeomMap=(NP9999,1,0,80)(0:27:0:1)(0:59:0:1)\n"),
                          &(conus_probe_options){.tip = 0.25}));
    assert_near(conus_probe_at(probe, 1)->offset[0], 0.019, 1e-12);
    assert_near(conus_probe_at(probe, 1)->offset[2], 0.25, 1e-12);
    conus_probe_destroy(probe);
    assert_ok(probe_parse(&probe, text_from(XML("NP2000", "0.5.5", "CH0=\"0\"", "CH0=\"59\"", "CH0=\"0\"")), NULL));
    assert_near(conus_probe_at(probe, 0)->position[0], 59, 0);
    conus_probe_destroy(probe);
}

static const char *const samples[] = {"np1.imro", "np2.ap.meta", "ultra.ap.meta", "settings.xml"};

enum { SAMPLES = sizeof samples / sizeof samples[0] };

static void every_prefix_is_refused(void **state)
{
    (void)state;
    for (size_t k = 0; k < SAMPLES; k++) {
        struct bytes bytes = {0};
        conus_probe *probe = NULL;
        assert_ok(file_read(&bytes, sample(samples[k]), 1 << 20));
        for (size_t size = 0; size + 1 < bytes.size; size++) { /* the last byte ends the line */
            char *exact = malloc(size + !size);                /* so that a sanitizer notices one byte too many */
            memcpy(exact, bytes.data, size);
            assert_fails(probe_parse(&probe, (struct text){exact, size}, NULL), CONUS_ERROR_DATA);
            free(exact);
        }
        assert_null(probe);
        bytes_finish(&bytes);
    }
}

static conus_status load(void *path)
{
    conus_probe *probe = NULL;
    conus_status status = conus_probe_load(&probe, path, NULL);
    conus_probe_destroy(probe);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    for (size_t k = 0; k < SAMPLES; k++) {
        char path[4096];
        snprintf(path, sizeof path, "%s", sample(samples[k]));
        test_every_allocation(load, path);
    }
}

TEST_GROUP(probe_recording)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_table_of_sites),        cmocka_unit_test(saved_channels_of_four_shanks),
        cmocka_unit_test(a_map_of_positions),      cmocka_unit_test(settings_of_open_ephys),
        cmocka_unit_test(what_is_wrong_is_said),   cmocka_unit_test(what_is_not_known_may_be_stated),
        cmocka_unit_test(every_prefix_is_refused), cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
