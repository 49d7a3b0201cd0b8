/* SPDX-License-Identifier: BSD-3-Clause */
/* Transfer functions: values between points, files, presets and errors. */
#include "base/memory.h"
#include "conus/own.h"
#include "render/colour/colour.h"
#include "render/image/image.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char example[] = "# a step, then a ramp\n"
                              "0   0 0 0 0\n"
                              "10  0 0 0 0   # up to here nothing\n"
                              "10  1 0 0 0.5\r\n"
                              "\n"
                              "20  1 1 0 1\n";

static conus_status parse_text(struct transfer *out, const char *text)
{
    return transfer_parse(out, (const uint8_t *)text, strlen(text));
}

/* Eq. 8: linear between points, held outside, the later of two equal points from there on. */
static void values_between_points_are_linear(void **state)
{
    (void)state;
    static const struct {
        double value, rgba[4];
    } wanted[] = {{-5, {0, 0, 0, 0}},      {9.999, {0, 0, 0, 0}}, {10, {1, 0, 0, 0.5}},
                  {15, {1, 0.5, 0, 0.75}}, {20, {1, 1, 0, 1}},    {1e300, {1, 1, 0, 1}}};
    struct transfer transfer;
    assert_ok(parse_text(&transfer, example));
    assert_false(transfer.relative);
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        double rgba[4];
        transfer_at(rgba, &transfer, wanted[i].value);
        for (int c = 0; c < 4; c++) {
            assert_near(rgba[c], wanted[i].rgba[c], 1e-12);
        }
    }
    transfer_finish(&transfer);
}

static void bright_voxels_do_not_widen_the_window(void **state)
{
    (void)state;
    float values[1000];
    for (int i = 0; i < 1000; i++) {
        values[i] = i < 500 ? 100 : 100 + (float)(i - 499); /* 100, and 101 to 600 once each */
    }
    values[999] = 1e9F; /* one hot voxel */
    struct volume volume = {.values = values, .voxel_count = 1000};
    volume.info.minimum = 100;
    volume.info.maximum = 1e9;
    double low, high;
    assert_ok(transfer_window(&low, &high, &volume));
    assert_near(low, 100, 0);
    assert_near(high, 597, 2); /* the 99.5th percentile of 101 to 600 */
}

static void a_function_spans_its_points(void **state)
{
    (void)state;
    struct transfer transfer;
    double low, high;
    assert_ok(parse_text(&transfer, "relative\n0.5 0 0 0 0\n1 1 1 1 1\n"));
    assert_true(transfer.relative);
    transfer_span(&low, &high, &transfer);
    assert_near(low, 0.5, 0);
    assert_near(high, 1, 0);
    transfer_finish(&transfer);
    assert_ok(parse_text(&transfer, "7 0 0 0 0\n7 1 1 1 1\n"));
    transfer_span(&low, &high, &transfer);
    assert_near(low, 7, 0);
    assert_true(high > low);
    transfer_finish(&transfer);
}

static void a_constant_volume_has_a_window(void **state)
{
    (void)state;
    float values[8] = {3, 3, 3, 3, 3, 3, 3, 3};
    struct volume volume = {.values = values, .voxel_count = 8};
    volume.info.minimum = volume.info.maximum = 3;
    double low, high;
    assert_ok(transfer_window(&low, &high, &volume));
    assert_near(low, 3, 0);
    assert_true(high > low);
}

/* Extinction: 2^-e of the light is left after 1 mm, so an opacity of 3/4 is 2. */
static void the_table_holds_linear_light_and_extinction(void **state)
{
    (void)state;
    struct transfer transfer;
    float table[5 * 4];
    assert_ok(parse_text(&transfer, "0 0.5 1 0 0\n4 0.5 1 0 1\n"));
    transfer_table(table, 5, &transfer);
    assert_near(table[0], linear_from_srgb(0.5), 1e-6);
    assert_near(table[1], 1, 1e-6);
    assert_near(table[3], 0, 0);
    assert_near(table[4 * 3 + 3], 2, 1e-6);
    assert_near(table[4 * 4 + 3], 24, 1e-6);
    transfer_finish(&transfer);
}

static void bad_lines_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "no points"},
        {"# nothing\n", "no points"},
        {"relative\n", "no points"},
        {"1 0 0 0\n", "line 1: 4 numbers"},
        {"\n1 0 0 0 0 0\n", "line 2: \"0\" where a point has five numbers"},
        {"1 0 0 red 0\n", "line 1: \"red\""},
        {"1 0 0 0 1.5\n", "line 1: a = 1.5; allowed is 0 to 1"},
        {"1 -0.1 0 0 0\n", "line 1: r = -0.1; allowed is 0 to 1"},
        {"1 0 nan 0 0\n", "line 1: g = "},
        {"inf 0 0 0 0\n", "line 1: value = inf"},
        {"nan 0 0 0 0\n", "line 1: value = "},
        {"2 0 0 0 0\n1 0 0 0 0\n", "line 2: value 1 after 2; values may not fall"},
        {"2 0 0 0 0\n2 0 0 0 0\n2 0 0 0 0\n", "line 3: value 2 for the third time"},
        {"1 0 0 0 0\nrelative\n", "line 2: \"relative\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct transfer transfer = {.count = 77};
        assert_fails(parse_text(&transfer, cases[i].text), CONUS_ERROR_DATA);
        assert_int_equal(transfer.count, 77);
        if (!strstr(conus_message(), cases[i].message)) {
            fail_msg("\"%s\" lacks \"%s\"", conus_message(), cases[i].message);
        }
    }
}

static void too_many_points_are_refused(void **state)
{
    (void)state;
    size_t size = (size_t)(TRANSFER_POINT_LIMIT + 1) * 24;
    char *text = memory_zeroed(size + 1, 1);
    for (int i = 0; i <= TRANSFER_POINT_LIMIT; i++) {
        snprintf(text + strlen(text), 24, "%d 0 0 0 0\n", i);
    }
    struct transfer transfer;
    assert_fails(parse_text(&transfer, text), CONUS_ERROR_DATA);
    memory_free(text);
}

/* The text of whole points is a function; one that is cut off is an error; nothing is read beyond its end. */
static void every_prefix_is_survived(void **state)
{
    (void)state;
    for (size_t size = 0; size < sizeof example; size++) {
        uint8_t *exact = malloc(size ? size : 1);
        memcpy(exact, example, size);
        struct transfer transfer = {0};
        conus_status status = transfer_parse(&transfer, exact, size);
        assert_true(status == CONUS_OK || status == CONUS_ERROR_DATA);
        assert_true((status == CONUS_OK) == (transfer.count > 0));
        transfer_finish(&transfer);
        free(exact);
    }
}

static conus_status load_brain(void *data)
{
    (void)data;
    struct transfer transfer = {0};
    conus_status status = transfer_load(&transfer, "brain");
    transfer_finish(&transfer);
    return status;
}

static conus_status load_file(void *data)
{
    struct transfer transfer = {0};
    conus_status status = transfer_load(&transfer, data);
    transfer_finish(&transfer);
    return status;
}

static void allocations_may_fail(void **state)
{
    (void)state;
    const char *path = test_scratch("example.tf");
    assert_ok(conus_write_file(path, example, sizeof example - 1));
    test_every_allocation(load_brain, NULL);
    test_every_allocation(load_file, (void *)path);
}

static void presets_are_functions(void **state)
{
    (void)state;
    size_t count = 0;
    for (; conus_transfer_preset(count); count++) {
        struct transfer transfer;
        assert_ok(transfer_load(&transfer, conus_transfer_preset(count)));
        assert_true(transfer.relative);
        double rgba[4];
        transfer_at(rgba, &transfer, 0);
        assert_near(rgba[3], 0, 0); /* background never shows */
        transfer_at(rgba, &transfer, 1);
        assert_int_equal(rgba[3] > 0, strcmp(conus_transfer_preset(count), "none") != 0);
        for (size_t i = 1; i < transfer.count; i++) {
            assert_true(transfer.points[i].value > transfer.points[i - 1].value);
        }
        transfer_finish(&transfer);
    }
    assert_true(count >= 4);
    assert_string_equal(conus_transfer_preset(0), "brain");
}

static void unknown_names_list_the_presets(void **state)
{
    (void)state;
    struct transfer transfer;
    assert_fails(transfer_load(&transfer, "brian"), CONUS_ERROR_ARGUMENT);
    for (size_t i = 0; conus_transfer_preset(i); i++) {
        assert_non_null(strstr(conus_message(), conus_transfer_preset(i)));
    }
    assert_fails(transfer_load(&transfer, "/nowhere/a.tf"), CONUS_ERROR_IO);
    const char *path = test_scratch("bad.tf");
    assert_ok(conus_write_file(path, "1 2\n", 4));
    assert_fails(transfer_load(&transfer, path), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), path));
}

TEST_GROUP(transfer)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_between_points_are_linear),
        cmocka_unit_test(bright_voxels_do_not_widen_the_window),
        cmocka_unit_test(a_function_spans_its_points),
        cmocka_unit_test(a_constant_volume_has_a_window),
        cmocka_unit_test(the_table_holds_linear_light_and_extinction),
        cmocka_unit_test(bad_lines_are_named),
        cmocka_unit_test(too_many_points_are_refused),
        cmocka_unit_test(every_prefix_is_survived),
        cmocka_unit_test(allocations_may_fail),
        cmocka_unit_test(presets_are_functions),
        cmocka_unit_test(unknown_names_list_the_presets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
