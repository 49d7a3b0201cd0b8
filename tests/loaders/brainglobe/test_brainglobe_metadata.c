/* SPDX-License-Identifier: BSD-3-Clause */
/* metadata.json, and the placement of a stack of each of the 48 orientations. */
#include "loaders/brainglobe/brainglobe.h"

#include "test.h"

#include <string.h>

/* A letter is the side at which an axis starts; from it follows the axis's direction. */
static const struct {
    char letter;
    double way[3];
} sides[] = {{'R', {-1, 0, 0}}, {'L', {1, 0, 0}},  {'A', {0, -1, 0}},
             {'P', {0, 1, 0}},  {'S', {0, 0, -1}}, {'I', {0, 0, 1}}};

/* The first voxel's centre lies half a voxel from the corner, which is the origin, along each axis; column, row and
 * page then go one voxel along axis 2, 1 and 0. All 216 words of three letters are tried, of which 48 name each pair of
 * sides once. */
static void all_orientations_follow_the_letters(void **state)
{
    (void)state;
    size_t good = 0;
    for (size_t word = 0; word < 216; word++) {
        const size_t letter[3] = {word / 36, word / 6 % 6, word % 6};
        struct brainglobe_metadata m = {.resolution = {10, 20, 40}};
        double matrix[16];
        bool apart = letter[0] / 2 != letter[1] / 2 && letter[0] / 2 != letter[2] / 2 && letter[1] / 2 != letter[2] / 2;
        for (size_t axis = 0; axis < 3; axis++) {
            char c = sides[letter[axis]].letter;
            m.orientation[axis] = (char)(word & 1 ? c : c - 'A' + 'a');
        }
        assert_fails(brainglobe_voxels(matrix, &m), apart ? CONUS_OK : CONUS_ERROR_DATA);
        for (size_t row = 0; apart && row < 3; row++) {
            double corner = 0;
            for (size_t axis = 0; axis < 3; axis++) {
                double step = m.resolution[axis] / 1000 * sides[letter[axis]].way[row];
                assert_near(matrix[4 * (2 - axis) + row], step, 1e-15);
                corner += step / 2;
            }
            assert_near(matrix[12 + row], corner, 1e-15);
        }
        good += apart;
    }
    assert_int_equal(good, 48);
}

static void orientations_of_other_letters_are_refused(void **state)
{
    (void)state;
    static const char *const words[] = {"", "as", "asrr", "xsr", "a r", "aSs", "asrasras"};
    const double scale[3] = {1, 1, 1};
    double matrix[16];
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        assert_fails(brainglobe_axes(matrix, words[i], scale), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), "one letter each of R or L, A or P, S or I is needed"));
    }
}

static conus_status parse(struct brainglobe_metadata *out, const char *text)
{
    struct job job = {0};
    brainglobe_metadata_parse(&job, out, text_from(text));
    return job_close(&job, NULL, NULL);
}

static void metadata_is_taken_or_named(void **state)
{
    (void)state;
    struct brainglobe_metadata m = {.orientation = "ras"};
    assert_ok(parse(&m, "{\"resolution\": [25, 25.5, 1e2], \"shape\": [528, 320.0, 456]}"));
    assert_string_equal(m.orientation, "ras");
    assert_near(m.resolution[1], 25.5, 0);
    assert_near(m.resolution[2], 100, 0);
    assert_int_equal(m.shape[0], 528);
    assert_int_equal(m.shape[1], 320);
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"{\"orientation\": 5}", "orientation: a text of three letters is needed"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct brainglobe_metadata before = m;
        assert_fails(parse(&m, cases[i].text), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), cases[i].part));
        assert_memory_equal(&before, &m, sizeof m);
    }
}

TEST_GROUP(brainglobe_metadata)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_orientations_follow_the_letters),
        cmocka_unit_test(orientations_of_other_letters_are_refused),
        cmocka_unit_test(metadata_is_taken_or_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
