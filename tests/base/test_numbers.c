/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers as people paste them: what is read, what may be a name, and what is refused. */
#include "base/text.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

#define MINUS "\xe2\x88\x92"
#define EN_DASH "\xe2\x80\x93"
#define FIRM_HYPHEN "\xe2\x80\x91"
#define SOFT_HYPHEN "\xc2\xad"
#define FIRM_SPACE "\xc2\xa0"
#define THIN_SPACE "\xe2\x80\x89"
#define NARROW_SPACE "\xe2\x80\xaf"

struct reading {
    const char *text;
    double value[3];
};

static const struct reading read[] = {
    {"-42,-20,50", {-42, -20, 50}},
    {"-42 -20 50", {-42, -20, 50}},
    {"  -42\t-20  50\n", {-42, -20, 50}},
    {"(-42, -20, 50)", {-42, -20, 50}},
    {"[-42 -20 50]", {-42, -20, 50}},
    {"[[-42, -20, 50]]", {-42, -20, 50}},
    {"{-42; -20; 50}", {-42, -20, 50}},
    {"(-42) (-20) (50)", {-42, -20, 50}},
    {"[-42, -20, 50,]", {-42, -20, 50}},
    {MINUS "42; " MINUS "20; 50 mm", {-42, -20, 50}},
    {EN_DASH "42 " FIRM_HYPHEN "20 " SOFT_HYPHEN "50", {-42, -20, -50}},
    {"-42" FIRM_SPACE "-20" THIN_SPACE "50" NARROW_SPACE, {-42, -20, 50}},
    {"x = -42, y = -20, z = 50", {-42, -20, 50}},
    {"x=-42,y=-20,z=50", {-42, -20, 50}},
    {"X: -42 Y: -20 Z: 50", {-42, -20, 50}},
    {"(x, y, z) = (-42, -20, 50)", {-42, -20, 50}},
    {"x y z -42 -20 50", {-42, -20, 50}},
    {"x=12,5 y=3 z=4", {12.5, 3, 4}},
    {"MNI -42, -20, 50", {-42, -20, 50}},
    {"MNI: (-42, -20, 50)", {-42, -20, 50}},
    {"peak at -42 -20 50 (MNI152)", {-42, -20, 50}},
    {"42L 20P 50S", {-42, -20, 50}},
    {"42 R, 20 A, 50 I", {42, 20, -50}},
    {"-42L -20P 50S", {-42, -20, 50}},
    {"42,5L 20P 50S", {-42.5, -20, 50}},
    {"42.5L -20 50", {-42.5, -20, 50}},
    {"-42.5 1e1 .5", {-42.5, 10, 0.5}},
    {"[ 1. 2. -3. ]", {1, 2, -3}},
    {"+42 +20 -50", {42, 20, -50}},
    {"-42,5 12,0 30,1", {-42.5, 12, 30.1}},
    {"-42,5; 12; 30", {-42.5, 12, 30}},
    {"-42,5 12 30", {-42.5, 12, 30}},
    {"12,5,30", {12, 5, 30}},
    {"12,5,-30", {12, 5, -30}},
    {"5739,5400,332", {5739, 5400, 332}},
    {"-42,500 12,0 30,1", {-42.5, 12, 30.1}},
    {"0,250 12 30", {0.25, 12, 30}},
    {"5739,250 12 30", {5739.25, 12, 30}},
    {"1,250 2.5 300", {1250, 2.5, 300}},
    {"1,250.5; 2; 3", {1250.5, 2, 3}},
    {"1,234,567 2,345 3", {1234567, 2345, 3}},
};

static void numbers_are_read_as_they_are_pasted(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof read / sizeof read[0]; i++) {
        struct numbers found;
        enum numbers_found is = numbers_read(&found, text_from(read[i].text));
        if (is != NUMBERS_FOUND) {
            fail_msg("%s: %s", read[i].text, found.why ? found.why : "no numbers");
        }
        for (int a = 0; a < 3; a++) {
            if (found.value[a] != read[i].value[a]) {
                fail_msg("%s: number %d is %g, not %g", read[i].text, a + 1, found.value[a], read[i].value[a]);
            }
        }
    }
}

static void words_beside_them_are_told(void **state)
{
    (void)state;
    struct numbers found;
    assert_int_equal(numbers_read(&found, text_from("mni -42 20 50 mm")), NUMBERS_FOUND);
    assert_true(found.says_mni && found.says_mm && !found.says_ras && !found.has_letters);
    assert_int_equal(numbers_read(&found, text_from("RAS 42 20P 50")), NUMBERS_FOUND);
    assert_true(found.says_ras && found.has_letters && !found.says_mni && !found.says_mm);
    assert_int_equal(numbers_read(&found, text_from("L 42 P 20 S 50")), NUMBERS_FOUND);
    assert_true(found.value[0] == -42 && found.value[1] == -20 && found.value[2] == 50);
    assert_int_equal(numbers_read(&found, text_from("L42, P20, S50")), NUMBERS_FOUND);
    assert_true(found.value[0] == -42 && found.value[1] == -20 && found.value[2] == 50);
}

static void names_are_no_numbers(void **state)
{
    (void)state;
    static const char *const names[] = {"",     " ",          "Hippocampus_L", "17", "C3", "Cerebelum_4_5_L",
                                        "A1",   "7A 8",       "near:17",       "L",  "x",  "MNI152",
                                        "1, 2", "Area 4a -3", "\xff\xfe",      "()"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        struct numbers found;
        assert_int_equal(numbers_read(&found, text_from(names[i])), NUMBERS_NONE);
        assert_null(found.why);
    }
}

static const struct {
    const char *text, *at, *why;
} refused[] = {
    {"talairach -42 -20 50", "talairach", "known word"},
    {"-42 -20 50 foo", "foo", "known word"},
    {"-42 \xe2\x80\xa2"
     "20 50",
     "\xe2\x80\xa2", "known word"},
    {"-42 \xff"
     "20 50",
     "\xff", "known word"},
    {"- 42 20 50", "-", "known word"},
    {"-42 20 \xe2\x80\x94"
     "50",
     "\xe2\x80\x94", "known word"},
    {"-42 -20 50 6.3", "6.3", "too many"},
    {"MNI 152 -42 -20 50", "50", "too many"},
    {"-42,5,12,0,30,1", "0", "too many"},
    {"-42,5, 12, 30", "5", "decimal points"},
    {"-42,5, 12,0, 30,1", "5", "decimal points"},
    {"12,5, 30", "5", "decimal points"},
    {"12,5 30", "5", "decimal points"},
    {"12,5 30 1 2", "1", "too many"},
    {"-1,250 2 3", "-1,250", "three digits"},
    {"-1,250; 2,500; 3", "-1,250", "three digits"},
    {"1,25 2.5 3", "1", "contradict"},
    {"1.5,2 3 4", "1.5,2", "neither"},
    {"1,2,3 4 5", "1,2,3", "neither"},
    {"-42-20 50", "-20", "directly behind"},
    {"10" EN_DASH "20 30", EN_DASH "20", "directly behind"},
    {"-42,,20,50", "20", "missing"},
    {",-42,20,50", "-42", "missing"},
    {"-42,-20,50,,", "-42", "more"},
    {"(-42, -20, 50", "-42", "not closed"},
    {"-42, -20, 50)", ")", "counterpart"},
    {"(-42, -20, 50]", "]", "counterpart"},
    {"-42:-20:50", ":", "known word"},
    {"y=-42 x=-20 z=50", "y", "do not stand"},
    {"x=-42 -20 50", "x", "do not stand"},
    {"-42 x -20 y 50 z", "x", "do not stand"},
    {"-42R 20 50", "-42", "contradict"},
    {"+42L 20 50", "+42", "contradict"},
    {"20P 42L 50S", "20", "another axis"},
    {"42L R 20 50", "R", "of its own"},
    {"42, L 20 50", "L", "of its own"},
    {"1e999 2 3", "1e999", "range"},
};

static void all_else_is_refused_with_its_place(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        struct numbers found;
        enum numbers_found is = numbers_read(&found, text_from(refused[i].text));
        bool is_right = is == NUMBERS_WRONG && found.why && strstr(found.why, refused[i].why) &&
                        text_equal(found.at, refused[i].at);
        if (!is_right) {
            fail_msg("%s: %d, \"%.*s\" %s", refused[i].text, is, (int)found.at.size, found.at.data,
                     found.why ? found.why : "");
        }
    }
}

/* Of every prefix: no byte behind it is read, and what is found is finite. */
static void every_prefix_is_read_or_refused(void **state)
{
    (void)state;
    size_t count = sizeof read / sizeof read[0] + sizeof refused / sizeof refused[0];
    for (size_t i = 0; i < count; i++) {
        size_t known = sizeof read / sizeof read[0];
        const char *text = i < known ? read[i].text : refused[i - known].text;
        for (size_t size = 0; size <= strlen(text); size++) {
            char *copy = malloc(size + 1);
            struct numbers found;
            memcpy(copy, text, size);
            char *exact = realloc(copy, size ? size : 1);
            enum numbers_found is = numbers_read(&found, (struct text){exact, size});
            assert_true(is == NUMBERS_WRONG ? found.why && found.at.size : !found.why);
            assert_true(is != NUMBERS_FOUND ||
                        (isfinite(found.value[0]) && isfinite(found.value[1]) && isfinite(found.value[2])));
            free(exact);
        }
    }
}

/* Whatever numbers are printed, in whatever form that is read: they come back. */
static void what_is_printed_is_read(void **state)
{
    (void)state;
    static const char *const forms[] = {"%.3g,%.3g,%.3g",     "%.9g %.9g %.9g",       "(%g, %g, %g)", "[%e %e %e]",
                                        "x=%g, y=%g, z=%.1f", "MNI %.2f; %.2f; %.2f", "%+g %+g %+g"};
    uint64_t random = 5;
    for (int i = 0; i < 20000; i++) {
        double value[3];
        for (int a = 0; a < 3; a++) {
            value[a] = round(test_random(&random, -200000, 200000)) / 1000;
            value[a] = test_random(&random, 0, 4) > 1 ? value[a] : floor(value[a]);
        }
        for (size_t f = 0; f < sizeof forms / sizeof forms[0]; f++) {
            char text[128];
            struct numbers found;
            double shown[3];
            snprintf(text, sizeof text, forms[f], value[0], value[1], value[2]);
            char *at = text;
            for (int a = 0; a < 3; a++) {
                at += strcspn(at, "+-0123456789");
                shown[a] = strtod(at, &at);
            }
            if (numbers_read(&found, text_from(text)) != NUMBERS_FOUND || found.value[0] != shown[0] ||
                found.value[1] != shown[1] || found.value[2] != shown[2]) {
                fail_msg("%s: %s", text, found.why ? found.why : "other numbers");
            }
        }
    }
}

TEST_GROUP(numbers)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_read_as_they_are_pasted),
        cmocka_unit_test(words_beside_them_are_told),
        cmocka_unit_test(names_are_no_numbers),
        cmocka_unit_test(all_else_is_refused_with_its_place),
        cmocka_unit_test(every_prefix_is_read_or_refused),
        cmocka_unit_test(what_is_printed_is_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
