/* SPDX-License-Identifier: BSD-3-Clause */
/* Values of options, and suggestions for misspelled names. */
#include "options/messages.h"
#include "options/options.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void only_decimal_numbers_are_numbers(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double value;
    } good[] = {{"0", 0},
                {"-90", -90},
                {"+1.5", 1.5},
                {".5", 0.5},
                {"5.", 5},
                {"1e3", 1000},
                {"1E-3", 1e-3},
                {"-0.25e+2", -25},
                {"0x10", NAN},
                {"nan", NAN},
                {"inf", NAN},
                {"-Infinity", NAN},
                {"1e999", NAN},
                {" 1", NAN},
                {"1 ", NAN},
                {"1,5", NAN},
                {"1e", NAN},
                {"1e+", NAN},
                {"\xe2\x88\x92"
                 "3.1",
                 -3.1},
                {"\xe2\x80\x93"
                 ".5",
                 -0.5},
                {"\xc2\xad"
                 "2",
                 -2},
                {"\xe2\x88\x92", NAN},
                {"\xe2\x88\x92-1", NAN},
                {"\xe2\x80\x94"
                 "1",
                 NAN},
                {".", NAN},
                {"", NAN},
                {"-", NAN},
                {"1.2.3", NAN},
                {"--1", NAN},
                {"1_000", NAN}};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        double number = 77;
        assert_int_equal(number_parse(good[i].text, &number), !isnan(good[i].value));
        assert_near(number, isnan(good[i].value) ? 77 : good[i].value, 0);
    }
}

static void only_digits_are_counts(void **state)
{
    (void)state;
    static const char *const bad[] = {"", "-1", "+1", "1.0", "1e3", "0x1", " 1", "1 ", "18446744073709551616", "9x"};
    uint64_t number = 77;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(count_parse(bad[i], UINT64_MAX, &number));
    }
    assert_false(count_parse("11", 10, &number));
    assert_int_equal(number, 77);
    assert_true(count_parse("18446744073709551615", UINT64_MAX, &number));
    assert_true(number == UINT64_MAX);
}

static bool reads(enum option_type type, void *field, const char *text)
{
    const struct option option = {.name = "test", .type = type, .value = "V"};
    return option_read(&option, field, text);
}

static void vectors_are_three_numbers(void **state)
{
    (void)state;
    static const char *const bad[] = {"", "1", "1,2", "1,2,3,4", "1,2,", ",,", "1,2,nan", "1;2;3", "1, 2,3", "a,b,c"};
    double v[3];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(reads(OPTION_VECTOR, v, bad[i]));
    }
    assert_true(reads(OPTION_VECTOR, v, "-90,2e1,.5"));
    assert_near(v[0], -90, 0);
    assert_near(v[1], 20, 0);
    assert_near(v[2], 0.5, 0);
    char giant[1000];
    memset(giant, '1', sizeof giant - 1);
    giant[sizeof giant - 1] = '\0';
    assert_false(reads(OPTION_VECTOR, v, giant));
}

static void sizes_are_two_counts(void **state)
{
    (void)state;
    static const char *const bad[] = {"", "1400", "1400x", "x1050", "1400X1050", "1400x1050x3", "-1x5", "4294967296x1"};
    uint32_t size[2];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(reads(OPTION_SIZE, size, bad[i]));
    }
    assert_true(reads(OPTION_SIZE, size, "1400x1050"));
    assert_int_equal(size[0], 1400);
    assert_int_equal(size[1], 1050);
}

static void bytes_have_binary_units(void **state)
{
    (void)state;
    static const char *const bad[] = {"", "0", "G", "1.5G", "2g", "2GB", "-2G", "17179869184G", "18446744073709551616"};
    uint64_t bytes = 0;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(reads(OPTION_BYTES, &bytes, bad[i]));
    }
    assert_true(reads(OPTION_BYTES, &bytes, "2G"));
    assert_true(bytes == UINT64_C(2) << 30);
    assert_true(reads(OPTION_BYTES, &bytes, "512K"));
    assert_true(bytes == 512 * 1024);
    assert_true(reads(OPTION_BYTES, &bytes, "77"));
    assert_true(bytes == 77);
}

static void ranges_may_be_open(void **state)
{
    (void)state;
    const struct option angle = {.name = "angle", .type = OPTION_NUMBER, .value = "D", .high = 180, .open = true};
    const struct option count = {.name = "count", .type = OPTION_COUNT, .value = "N", .low = 1, .high = 1024};
    double degrees;
    uint32_t number;
    assert_false(option_read(&angle, &degrees, "0"));
    assert_false(option_read(&angle, &degrees, "180"));
    assert_true(option_read(&angle, &degrees, "179.9"));
    assert_false(option_read(&count, &number, "0"));
    assert_true(option_read(&count, &number, "1024"));
    assert_false(option_read(&count, &number, "1025"));
    assert_false(option_read(&count, &number, "4294967297"));
}

static void numbers_may_have_their_unit(void **state)
{
    (void)state;
    const struct option radius = {.name = "radius", .type = OPTION_NUMBER, .unit = "mm", .high = 100};
    const struct option angle = {.name = "angle", .type = OPTION_NUMBER, .unit = "degrees", .high = 180};
    const struct option share = {.name = "share", .type = OPTION_NUMBER, .value = "F"};
    static const struct {
        const char *text;
        double mm, degrees; /* -1: refused */
    } cases[] = {{"5mm", 5, -1},    {"5 mm", 5, -1},   {"0.5cm", 5, -1},       {"11cm", -1, -1},  {"5e-1MM", 0.5, -1},
                 {"5m", -1, -1},    {"mm", -1, -1},    {" mm", -1, -1},        {"5  mm", -1, -1}, {"5mmm", -1, -1},
                 {"15deg", -1, 15}, {"15°", -1, 15},   {"15 degrees", -1, 15}, {"200°", -1, -1},  {"0.2rad", -1, -1},
                 {"°", -1, -1},     {"nanmm", -1, -1}, {"0x5mm", -1, -1},      {"7", 7, 7}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double number = -1;
        assert_int_equal(option_read(&radius, &number, cases[i].text), cases[i].mm >= 0);
        assert_near(number, cases[i].mm, 1e-12);
        number = -1;
        assert_int_equal(option_read(&angle, &number, cases[i].text), cases[i].degrees >= 0);
        assert_near(number, cases[i].degrees, 1e-12);
        assert_int_equal(option_read(&share, &number, cases[i].text), cases[i].mm == 7);
    }
}

static const char *name_at(const void *list, size_t index)
{
    return ((const char *const *)list)[index];
}

static void the_closest_name_is_suggested(void **state)
{
    (void)state;
    static const char *const names[] = {"origin", "toward", "angle", "aperture", NULL};
    assert_string_equal(closest_name("orign", name_at, names), "origin");
    assert_string_equal(closest_name("angel", name_at, names), "angle");
    assert_string_equal(closest_name("apert", name_at, names), "aperture");
    assert_string_equal(closest_name("towards", name_at, names), "toward");
    /* The name with the fewest edits wins, also against longer names that begin with the word. */
    static const char *const alike[] = {"poses-format", "pose", "up", "output", NULL};
    assert_string_equal(closest_name("poses", name_at, alike), "pose");  /* 1 edit, against 7 */
    assert_string_equal(closest_name("poses-", name_at, alike), "pose"); /* 2 edits, against 6 */
    assert_string_equal(closest_name("poses-f", name_at, alike), "poses-format");
    assert_string_equal(closest_name("out", name_at, alike), "output"); /* 3 edits; "up" has 2, and 1 is allowed */
    /* Among names with equally many edits the first one wins. */
    assert_string_equal(closest_name("abz", name_at, (const char *const[]){"abx", "aby", NULL}), "abx");
    assert_null(closest_name("layers", name_at, names));
    assert_null(closest_name("x", name_at, names));
    assert_null(closest_name("", name_at, names));
}

/* A command with as many options as are allowed: --x0 to --x125, and two more with other names. */
static void each_option_counts_for_itself(void **state)
{
    (void)state;
    enum { COUNT = OPTION_LIMIT - 2 };
    static char names[COUNT][8];
    static struct option options[COUNT + 3];
    static bool fields[COUNT + 2];
    for (size_t i = 0; i < COUNT + 2; i++) {
        snprintf(names[i % COUNT], sizeof names[0], "x%zu", i % COUNT);
        options[i] = (struct option){.name = i < COUNT    ? names[i]
                                             : i == COUNT ? "help"
                                                          : "version",
                                     .type = OPTION_FLAG,
                                     .offset = i * sizeof(bool)};
    }
    const struct option_group groups[] = {{"All", options, 0}, {NULL, NULL, 0}};
    const struct command command = {.name = "test", .groups = groups};
    struct arguments arguments;
    char *words[] = {"conus", "test", "--x0", "--x64", "--x125"};
    assert_int_equal(options_parse(&arguments, fields, &command, NULL, 5, words, 2), -1);
    for (size_t i = 0; i < COUNT; i++) {
        assert_int_equal(option_given(&arguments, names[i]), i == 0 || i == 64 || i == 125);
    }
    options_finish(fields, &arguments);
    char *twice[] = {"conus", "test", "--x64", "--x64"};
    assert_int_equal(options_parse(&arguments, fields, &command, NULL, 4, twice, 2), 2);
    options_finish(fields, &arguments);
}

/* As where nothing is given: no field, no use, nothing that excludes another; any other value counts. */
static void a_standard_value_is_none(void **state)
{
    (void)state;
    static const char *const kinds[] = {"first", "second", NULL};
    struct {
        double angle;
        size_t kind, open;
        const char *point;
        bool help, version;
    } fields = {0};
#define AT(member) offsetof(__typeof__(fields), member)
    const struct option options[] = {
        {.name = "angle",
         .type = OPTION_NUMBER,
         .offset = AT(angle),
         .value = "A",
         .standard = "10",
         .excludes = "point"},
        {.name = "kind", .type = OPTION_CHOICE, .offset = AT(kind), .value = "K", .choices = kinds, .needs = "point"},
        {.name = "open", .type = OPTION_CHOICE, .offset = AT(open), .value = "K", .choices = kinds, .otherwise = "any"},
        {.name = "point", .type = OPTION_TEXT, .offset = AT(point), .value = "P"},
        {.name = "help", .type = OPTION_FLAG, .offset = AT(help)},
        {.name = "version", .type = OPTION_FLAG, .offset = AT(version)},
        {0},
    };
    const struct option_group groups[] = {{"All", options, 0}, {NULL, NULL, 0}};
    struct command command = {.name = "test", .groups = groups};
    struct arguments arguments;
    char *words[] = {"conus", "test", "--angle=1e1", "--kind", "FIRST", "--open", "first", "--point", "p"};
    assert_int_equal(options_parse(&arguments, &fields, &command, NULL, 9, words, 2), -1);
    assert_true(fields.angle == 0 && !option_given(&arguments, "angle") && !option_given(&arguments, "kind"));
    assert_true(option_given(&arguments, "open") && arguments.use_count == 2);
    options_finish(&fields, &arguments);
    char *other[] = {"conus", "test", "--angle", "10.5", "--point", "p"};
    assert_int_equal(options_parse(&arguments, &fields, &command, NULL, 6, other, 2), 2);
    options_finish(&fields, &arguments);
    command.resumes = true;
    assert_int_equal(options_parse(&arguments, &fields, &command, NULL, 3, words, 2), -1);
    assert_true(fields.angle == 10 && option_given(&arguments, "angle"));
    options_finish(&fields, &arguments);
}

/* Messages are part of the test, not of this program's output. */
static int silence(void **state)
{
    (void)state;
    return freopen("/dev/null", "w", stderr) ? 0 : -1;
}

TEST_GROUP(options)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_may_have_their_unit),
        cmocka_unit_test(only_decimal_numbers_are_numbers),
        cmocka_unit_test(only_digits_are_counts),
        cmocka_unit_test(vectors_are_three_numbers),
        cmocka_unit_test(sizes_are_two_counts),
        cmocka_unit_test(bytes_have_binary_units),
        cmocka_unit_test(ranges_may_be_open),
        cmocka_unit_test(the_closest_name_is_suggested),
        cmocka_unit_test(each_option_counts_for_itself),
        cmocka_unit_test(a_standard_value_is_none),
    };
    return cmocka_run_group_tests(tests, silence, NULL);
}
