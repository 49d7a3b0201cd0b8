/* SPDX-License-Identifier: BSD-3-Clause */
/* Probes of ProbeInterface: reading, places of contacts, refused files; every prefix, every failing allocation. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
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

static conus_probe *load(const char *name, double tip)
{
    conus_probe *probe = NULL;
    assert_ok(conus_probe_load(&probe, sample(name), &(conus_probe_options){.tip = tip}));
    return probe;
}

static void assert_offset(const conus_probe *probe, size_t index, double x, double y, double z)
{
    const conus_probe_contact *contact = conus_probe_at(probe, index);
    assert_non_null(contact);
    assert_near(contact->offset[0], x, 1e-12);
    assert_near(contact->offset[1], y, 1e-12);
    assert_near(contact->offset[2], z, 1e-12);
}

static void assert_tip(const conus_probe *probe, size_t index, double x, double y)
{
    double tip[3];
    conus_probe_tip(tip, probe, index);
    assert_near(tip[0], x, 1e-9);
    assert_near(tip[1], y, 1e-9);
}

/* Two shanks end at one height: the tip is that of the left one, at (16, -175) um. */
static void two_shanks(void **state)
{
    (void)state;
    conus_probe *probe = load("two_shanks.json", 0);
    static const char *const ids[] = {"a0", "a1", "a2", "b0", "b1"};
    static const char *const shanks[] = {"0", "0", "0", "1", "1"};
    static const int channels[] = {4, 3, -1, 1, 0};
    assert_int_equal(conus_probe_count(probe), 1);
    assert_int_equal(conus_probe_contact_count(probe), 5);
    assert_null(conus_probe_at(probe, 5));
    for (size_t i = 0; i < 5; i++) {
        const conus_probe_contact *contact = conus_probe_at(probe, i);
        assert_string_equal(contact->id, ids[i]);
        assert_string_equal(contact->shank, shanks[i]);
        assert_string_equal(contact->probe, "probe1");
        assert_int_equal(contact->channel, channels[i]);
        assert_true(isnan(contact->position[2]));
    }
    assert_tip(probe, 0, 16, -175);
    assert_offset(probe, 0, 0.016, 0, 0.175);
    assert_offset(probe, 4, 0.266, 0, 0.195);
    assert_near(conus_probe_at(probe, 4)->position[0], 282, 0);
    conus_probe_destroy(probe);
    conus_probe_destroy(NULL);
}

/* The first probe's shank runs along z, as its plane says; its bottom is an edge from x = 0 to 0.2 mm. The direction
 * off its plane, x cross z, is -y, which is the device's +y. */
static void three_dimensions_and_several_probes(void **state)
{
    (void)state;
    conus_probe *probe = load("upright.json", 0);
    static const char *const ids[] = {"probe1:0", "probe1:1", "probe1:2", "probe2:0"};
    assert_int_equal(conus_probe_count(probe), 2);
    for (size_t i = 0; i < 4; i++) {
        assert_string_equal(conus_probe_at(probe, i)->id, ids[i]);
        assert_string_equal(conus_probe_at(probe, i)->shank, "");
        assert_int_equal(conus_probe_at(probe, i)->channel, -2);
    }
    assert_offset(probe, 0, 0, 0, 0.3);
    assert_offset(probe, 1, 0, 0, 0.1);
    assert_offset(probe, 2, 0, 1, 0.2);
    assert_near(conus_probe_at(probe, 2)->position[2], 200, 1e-9);
    assert_offset(probe, 3, 0, 0, 1); /* in metres */
    conus_probe_destroy(probe);
}

/* Without a contour the tip is below the lowest contacts, in the middle between them. */
static void a_distance_replaces_the_contour(void **state)
{
    (void)state;
    conus_probe *probe = NULL;
    assert_fails(conus_probe_load(&probe, sample("no_contour.json"), NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "no_contour.json: probes[0]: probe_planar_contour: there is none"));
    probe = load("no_contour.json", 0.3);
    assert_tip(probe, 0, 20, -260);
    assert_offset(probe, 0, -0.01, 0, 0.3);
    assert_offset(probe, 2, 0, 0, 0.32);
    conus_probe_destroy(probe);
    probe = load("two_shanks.json", 0.1); /* the left one of the lowest is of the left shank */
    assert_tip(probe, 0, 16, -100);
    conus_probe_destroy(probe);
    assert_fails(conus_probe_load(&probe, sample("no_contour.json"), &(conus_probe_options){.tip = -1}),
                 CONUS_ERROR_ARGUMENT);
    assert_fails(conus_probe_load(&probe, sample("no_contour.json"), &(conus_probe_options){.max_memory = 9}),
                 CONUS_ERROR_MEMORY);
}

static double coordinate(const conus_pose_list *list, size_t index, int axis)
{
    const conus_pose_row *row = conus_pose_list_row(list, index);
    assert_true(row->is_point);
    assert_int_equal(row->line, index + 1);
    return row->pose.world_from_device[12 + axis];
}

/* Pointing down along -z, the device's +x is the world's, and +y is anterior. A roll of 90 degrees takes +y to +x, so
 * that the device's +x is -y of the world. */
static void poses_place_contacts(void **state)
{
    (void)state;
    conus_probe *probe = load("two_shanks.json", 0);
    conus_pose_list *list = NULL;
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){1, 2, 3}, (double[]){0, 0, -1}, NULL));
    assert_ok(conus_probe_place(&list, probe, &pose, 1, 0));
    assert_int_equal(conus_pose_list_count(list), 5);
    assert_string_equal(conus_pose_list_row(list, 4)->id, "b1");
    assert_near(coordinate(list, 4, 0), 1.266, 1e-12);
    assert_near(coordinate(list, 4, 1), 2, 1e-12);
    assert_near(coordinate(list, 4, 2), 3.195, 1e-12);
    conus_pose_list_destroy(list);
    assert_ok(conus_probe_place(&list, probe, &pose, 1, 90));
    assert_near(coordinate(list, 4, 0), 1, 1e-12);
    assert_near(coordinate(list, 4, 1), 2 - 0.266, 1e-12);
    assert_near(coordinate(list, 4, 2), 3.195, 1e-12);
    conus_pose_list_destroy(list);
    assert_fails(conus_probe_place(&list, probe, &pose, 1, NAN), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_probe_place(&list, probe, &pose, 0, 0), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "found 0, wanted are 1"));
    conus_probe_destroy(probe);
}

#define PROBE(rest) "{\"specification\":\"probeinterface\",\"probes\":[{\"ndim\":2,\"si_units\":\"um\"," rest "}]}"
#define SPACE(rest) "{\"specification\":\"probeinterface\",\"probes\":[{\"ndim\":3,\"si_units\":\"um\"," rest "}]}"
#define TWO "\"contact_positions\":[[0,1],[0,2]],\"probe_planar_contour\":[[0,0],[1,9],[-1,9]],"
#define DEEP                                                                                                           \
    "\"contact_positions\":[[0,1,0],[0,2,0]],\"probe_planar_contour\":[[0,0,0],[1,9,0]],\"contact_plane_axes\":"

static void what_is_wrong_is_said(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
    } wrong[] = {
        {"", "specification: \"probeinterface\" is needed"},
        {"x\ty\tz\n1\t2\t3\n", "not a file of ProbeInterface"},
        {"{", "line 1"},
        {"[]", "specification"},
        {"{\"specification\":\"other\",\"probes\":[]}", "specification"},
        {"{\"specification\":\"probeinterface\",\"probes\":[]}", "probes: found 0"},
        {"{\"specification\":\"probeinterface\",\"probes\":[7]}", "contact_positions"},
        {PROBE("\"contact_positions\":[]"), "contact_positions: a list of at least one"},
        {PROBE("\"contact_positions\":[[0,1,2]]"), "contact_positions[0]: 2 numbers"},
        {PROBE("\"contact_positions\":[[0,\"1\"]]"), "contact_positions[0]: 2 numbers"},
        {PROBE("\"contact_positions\":[[0,1000001]]"), "is si_units right"},
        {"{\"specification\":\"probeinterface\",\"probes\":[{\"ndim\":4,\"contact_positions\":[[0,1]]}]}", "ndim"},
        {"{\"specification\":\"probeinterface\",\"probes\":[{\"ndim\":2,\"si_units\":\"nm\",\"contact_positions\":[[0,"
         "1]]}]}",
         "si_units: \"nm\", allowed are um, mm, cm and m"},
        {PROBE(TWO "\"contact_ids\":[\"a\"]"), "contact_ids: found 1 entries, wanted is a list of 2"},
        {PROBE(TWO "\"contact_ids\":\"ab\""), "contact_ids: found 0 entries"},
        {PROBE(TWO "\"contact_ids\":[\"a\",\"a\"]"), "two contacts are called \"a\""},
        {PROBE(TWO "\"contact_ids\":[\"a\",\"\"]"), "contact_ids[1]: empty"},
        {PROBE(TWO "\"contact_ids\":[\"a\",5]"), "contact_ids[1]: a text"},
        {PROBE(TWO "\"contact_ids\":[\"a\",\"b\\n\"]"),
         "contact_ids[1]: a text of up to 223 bytes without control characters"},
        {PROBE(TWO "\"shank_ids\":[0,1]"), "shank_ids[0]: a text"},
        {PROBE(TWO "\"device_channel_indices\":[0,0]"), "two contacts of probe1 have the channel 0"},
        {PROBE(TWO "\"device_channel_indices\":[0,-2]"), "device_channel_indices[1]"},
        {PROBE(TWO "\"device_channel_indices\":[0,1.5]"), "device_channel_indices[1]"},
        {PROBE("\"contact_positions\":[[0,-1]],\"probe_planar_contour\":[[0,0],[1,9],[-1,9]]"), "1 um below the tip"},
        {PROBE("\"contact_positions\":[[0,1]],\"probe_planar_contour\":[[0,0],[1,0]]"), "has no lowest point"},
        {PROBE("\"contact_positions\":[[0,1]],\"probe_planar_contour\":[[0,0],[1]]"), "probe_planar_contour[1]"},
        {PROBE(TWO "\"contact_plane_axes\":[[[1,0],[0,1]],[[-1,0],[0,-1]]]"), /* the tip is up */
         "contact_plane_axes[1]: the second axis is not y"},
        {PROBE(TWO "\"contact_plane_axes\":[[[0,1],[-1,0]],[[0,1],[-1,0]]]"),
         "contact_plane_axes[0]: the second axis is not y"},
        {PROBE(TWO "\"contact_plane_axes\":[[1,0],[0,1]]"), "contact_plane_axes[0]: two axes"},
        {SPACE(DEEP "[[[1,0,0],[0,1,0]]]"), "contact_plane_axes: found 1"},
        {SPACE(DEEP "[[[1,0,0],[0,1,0]],[[1,0,0],[0,0,1]]]"), "contact_plane_axes[1]: the second axis"},
        {SPACE(DEEP "[[[1,0,0],[1,1,0]],[[1,0,0],[0,1,0]]]"), "contact_plane_axes[0]: two axes"},
        {SPACE(DEEP "[[[0,0,0],[0,1,0]],[[1,0,0],[0,1,0]]]"), "contact_plane_axes[0]: two axes"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        conus_probe *probe = NULL;
        assert_fails(probe_parse(&probe, text_from(wrong[i].text), NULL), CONUS_ERROR_DATA);
        if (!strstr(conus_message(), wrong[i].part)) {
            fail_msg("\"%s\" is not in \"%s\"", wrong[i].part, conus_message());
        }
    }
}

/* All contacts may be wired, each to a different channel; any number may be unwired. */
static void contacts_may_all_be_unwired(void **state)
{
    (void)state;
    conus_probe *probe = NULL;
    assert_ok(probe_parse(&probe, text_from(PROBE(TWO "\"device_channel_indices\":[-1,-1]")), NULL));
    assert_int_equal(conus_probe_at(probe, 1)->channel, -1);
    conus_probe_destroy(probe);
}

/* In a flat probe x is that of the positions, whatever a contact's own plane. */
static void planes_of_flat_probes_turn_nothing(void **state)
{
    (void)state;
    conus_probe *probe = NULL;
    assert_ok(probe_parse(&probe,
                          text_from(PROBE("\"contact_positions\":[[3,1]],\"probe_planar_contour\":[[0,0],[9,9],[-9,9]],"
                                          "\"contact_plane_axes\":[[[-1,0],[0,1]]]")),
                          NULL));
    assert_offset(probe, 0, 0.003, 0, 0.001);
    conus_probe_destroy(probe);
}

static const char *const samples[] = {"two_shanks.json", "upright.json"};

static void every_prefix_is_refused(void **state)
{
    (void)state;
    for (size_t k = 0; k < 2; k++) {
        struct bytes bytes = {0};
        conus_probe *probe = NULL;
        assert_ok(file_read(&bytes, sample(samples[k]), 1 << 20));
        for (size_t size = 0; size < bytes.size; size++) {
            char *exact = malloc(size + !size); /* so that a sanitizer notices one byte too many */
            memcpy(exact, bytes.data, size);
            assert_fails(probe_parse(&probe, (struct text){exact, size}, NULL), CONUS_ERROR_DATA);
            free(exact);
        }
        assert_null(probe);
        bytes_finish(&bytes);
    }
}

/* Contacts of each have those of the one, with its name; what is twice, too long or of several is refused. */
static void one_probe_is_repeated(void **state)
{
    (void)state;
    static const char *const names[] = {"left", "right"};
    static const char *const same[] = {"left", "left"};
    char large[256] = "";
    memset(large, 'x', sizeof large - 1);
    conus_probe *probe = load("two_shanks.json", 0);
    conus_probe *two = NULL;
    assert_ok(conus_probe_repeat(&two, probe, names, 2));
    assert_int_equal(conus_probe_count(two), 2);
    assert_int_equal(conus_probe_contact_count(two), 10);
    for (size_t i = 0; i < 10; i++) {
        const conus_probe_contact *contact = conus_probe_at(two, i);
        const conus_probe_contact *one = conus_probe_at(probe, i % 5);
        char id[64];
        snprintf(id, sizeof id, "%s:%s", names[i / 5], one->id);
        assert_string_equal(contact->id, id);
        assert_string_equal(contact->probe, names[i / 5]);
        assert_string_equal(contact->shank, one->shank);
        assert_int_equal(contact->index, i / 5);
        assert_int_equal(contact->channel, one->channel);
        assert_memory_equal(contact->offset, one->offset, sizeof one->offset);
    }
    conus_probe *none = NULL;
    assert_fails(conus_probe_repeat(&none, probe, same, 2), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_probe_repeat(&none, probe, names, 0), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_probe_repeat(&none, probe, (const char *const[]){large}, 1), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_probe_repeat(&none, two, names, 2), CONUS_ERROR_ARGUMENT);
    assert_null(none);
    conus_probe_destroy(two);
    conus_probe_destroy(probe);
}

static conus_status load_and_place(void *path)
{
    conus_probe *probe = NULL;
    conus_pose_list *list = NULL;
    const conus_pose poses[2] = {{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
                                 {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}};
    conus_status status = conus_probe_load(&probe, path, NULL);
    status = status ? status : conus_probe_place(&list, probe, poses, conus_probe_count(probe), 57);
    conus_pose_list_destroy(list);
    conus_probe *two = NULL;
    bool is_one = !status && conus_probe_count(probe) == 1;
    status = is_one ? conus_probe_repeat(&two, probe, (const char *const[]){"a", "b"}, 2) : status;
    conus_probe_destroy(two);
    conus_probe_destroy(probe);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    for (size_t k = 0; k < 2; k++) {
        char path[4096];
        snprintf(path, sizeof path, "%s", sample(samples[k]));
        test_every_allocation(load_and_place, path);
    }
}

/* Files of the same standard from elsewhere; their writer states tips and first contacts. */
static void shared_samples(void **state)
{
    (void)state;
    char path[4096];
    static const char *const names[] = {"one.json", "four_shanks.json"};
    static const size_t counts[] = {16, 32};
    for (size_t k = 0; k < 2; k++) {
        conus_probe *probe = NULL;
        snprintf(path, sizeof path, "files-2026/probeinterface/%s", names[k]);
        assert_ok(conus_probe_load(&probe, test_shared(path), NULL));
        assert_int_equal(conus_probe_contact_count(probe), counts[k]);
        assert_tip(probe, 0, 16, -175);
        assert_offset(probe, 0, 0.016, 0, 0.175);
        conus_probe_destroy(probe);
    }
}

TEST_GROUP(probe_interface)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_shanks),
        cmocka_unit_test(three_dimensions_and_several_probes),
        cmocka_unit_test(a_distance_replaces_the_contour),
        cmocka_unit_test(poses_place_contacts),
        cmocka_unit_test(what_is_wrong_is_said),
        cmocka_unit_test(contacts_may_all_be_unwired),
        cmocka_unit_test(planes_of_flat_probes_turn_nothing),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(one_probe_is_repeated),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(shared_samples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
