/* SPDX-License-Identifier: BSD-3-Clause */
/* The functions that the web page calls, on this machine, linked with the stubs for OpenGL and pictures
 * (CONUS_PICTURES=OFF). A change that makes answers or cuts need drawing code fails here. */
#include "web/web.c" // NOLINT: linked with what stands for OpenGL, so not in the room's program

#include "conus/own.h"
#include "test.h"

#include <unistd.h>

/* Two boxes across y, |x| and |z| at most 20 mm: the anterior one from y = 6 to 12, object 1, the posterior one from
 * -12 to -6, object 2. */
static int open_slabs(void **state)
{
    (void)state;
    static char folder[] = "web-XXXXXX";
    char path[64];
    assert_non_null(mkdtemp(folder));
    assert_int_equal(conus_phantom_write("slabs", folder, NULL), CONUS_OK);
    snprintf(path, sizeof path, "%s/slabs.nii.gz", folder);
    const char *said = web_open(path);
    assert_non_null(strstr(said, "\"name\":\"slabs.nii.gz\""));
    assert_non_null(strstr(said, "\"objects\":2"));
    assert_null(strstr(said, "identity"));
    assert_non_null(strstr(said, "\"low\":[-20.0,-12.0,-20.0],\"high\":[20.0,12.0,20.0]"));
    return 0;
}

static void test_objects_have_names_and_colours(void **state)
{
    (void)state;
    assert_string_equal(web_objects(), "[[\"Slab anterior\",242,186,133,\"\"],[\"Slab posterior\",121,105,191,\"\"]]");
}

/* Asserts that a question is answered by these objects, in brackets, and mm along the axis to the deepest hit. */
static void asks_well(const char *answer, const char *hits, double depth)
{
    static const char start[] = "{\"depth\":";
    assert_memory_equal(answer, start, strlen(start));
    assert_float_equal(strtod(answer + strlen(start), NULL), depth, 1e-6);
    assert_non_null(strstr(answer, hits));
}

enum { CSV = 2 }; /* its place in conus_format_at() */

/* Down the y axis from y = 50, the anterior box begins at a distance of 38 mm and hides the other. All layers have no
 * deepest hit. */
static void test_rows_of_an_answer(void **state)
{
    (void)state;
    asks_well(web_ask(3, 50, 4, 3, 0, 4, "angle=1&resolution=16", 0, 0),
              "\"hits\":[1],\"ranks\":[1],\"colours\":[\"#d2246c\"]}", 38);
    const char *first = web_rows(CSV);
    assert_non_null(strstr(first, "Slab anterior,SlA,1,1,208,1,"));
    assert_null(strstr(first, "Slab posterior"));
    asks_well(web_ask(3, 50, 4, 3, 0, 4, "angle=1&resolution=16&layers=all", 0, 0),
              "\"ranks\":[1,2],\"colours\":[\"#d2246c\",\"#009ca8\"]}", 0);
    assert_non_null(strstr(web_rows(CSV), "Slab posterior"));
    assert_non_null(strstr(web_sidecar(), "\"sha256\""));
}

/* The anterior box ends at a distance of 44 mm, the other one begins at 56: it is the first one beyond 50 mm. */
static void test_a_range_has_what_is_first_in_it(void **state)
{
    (void)state;
    asks_well(web_ask(3, 50, 4, 3, 0, 4, "angle=1&resolution=16&range=50,1000", 0, 0), "\"hits\":[2]", 56);
    assert_non_null(strstr(web_ask(3, 50, 4, 3, 0, 4, "angle=1&resolution=16&range=45,55", 0, 0), "\"hits\":[]"));
    asks_well(web_ask(3, 50, 4, 3, 0, 4, "angle=1&resolution=16", 0, 0), "\"hits\":[1]", 38); /* and no range stays */
    assert_non_null(strstr(web_ask(3, 50, 4, 3, 0, 4, "range=55,45", 0, 0), "--range: "));
}

/* Steps look at the anterior box; after 0.4 s the hand is behind the other one, where a press confirms what was
 * selected 0.15 s before, though nothing of it is hit. A question that is no step has no such columns, and changes no
 * track; the next track knows nothing of this one. */
static void test_a_press_confirms_what_was_selected_before(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        const char *answer =
            web_ask(3, 50, 4, 3, 0, 4, "angle=1&resolution=16", i == 0 ? STEP | STEP_BEGINS : STEP, 0.2 * i);
        asks_well(answer, "\"hits\":[1]", 38);
    }
    web_ask(3, 50, 4, 3, 0, 4, "angle=1", 0, 0);
    assert_null(strstr(web_rows(CSV), "confirmed"));
    web_ask(3, -50, 4, 3, 0, 4, "angle=1&resolution=16", STEP | STEP_PRESSED, 0.45);
    const char *lines = web_rows(CSV);
    assert_non_null(strstr(lines, ",time_s,selected,confirmed\r\n"));
    const char *anterior = strstr(lines, "Slab anterior,SlA,1,");
    assert_non_null(anterior);
    assert_memory_equal(strchr(anterior, '\r') - strlen(",0.45,1,1"), ",0.45,1,1", strlen(",0.45,1,1"));
    web_ask(3, -50, 4, 3, 0, 4, "angle=1&resolution=16", STEP | STEP_PRESSED | STEP_BEGINS, 0);
    assert_null(strstr(web_rows(CSV), "Slab anterior"));
    const char *ranged = web_ask(3, 50, 4, 3, 0, 4, "angle=1&resolution=16&range=50,1000", STEP | STEP_BEGINS, 0);
    asks_well(ranged, "\"hits\":[2]", 56); /* and each step has its own range */
    asks_well(web_ask(3, 50, 4, 3, 0, 4, "angle=1&resolution=16", STEP, 0.1), "\"hits\":[", 38);
}

/* What is not said is as its row says: 64 rays along a side, 20 degrees, first hits. */
static void test_the_form_is_what_is_asked(void **state)
{
    (void)state;
    json_t *rows = json_loads(web_form(), 0, NULL);
    assert_int_equal(json_array_size(rows), 5);
    assert_string_equal(json_string_value(json_object_get(json_array_get(rows, 0), "name")), "angle");
    assert_string_equal(json_string_value(json_object_get(json_array_get(rows, 0), "default")), "20");
    json_decref(rows);
    web_ask(3, 50, 4, 3, 0, 4, "", 0, 0);
    char *plain = strdup(web_rows(CSV));
    assert_non_null(strstr(plain, "Slab anterior"));
    web_ask(3, 50, 4, 3, 0, 4, "&angle=20&layers=visible&resolution=64", 0, 0);
    assert_string_equal(web_rows(CSV), plain);
    web_ask(3, 50, 4, 3, 0, 4, "&angle=21", 0, 0);
    assert_string_not_equal(web_rows(CSV), plain);
    free(plain);
}

static void test_errors_are_words(void **state)
{
    (void)state;
    assert_non_null(strstr(web_open("nothing.nii.gz"), "{\"error\":\"nothing.nii.gz"));
    assert_non_null(strstr(web_ask(1, 1, 1, 1, 1, 1, "angle=20&resolution=16", 0, 0), "{\"error\":\"toward"));
    static const char *const wrong[][2] = {
        {"angle=171", "--angle: 171 is out of range"},
        {"angle=", "--angle: "},
        {"layers=some", "--layers: "},
        {"angle=20&cut=1,2,3", "cut: a page asks"},
        {"angle", "angle: a page"},
        {"resolution=16.5", "--resolution: "},
        {"angle=20&&origin=1", "origin: a page asks"},
        {"=", ": a page asks"},
        {"resolution=1025", "--resolution: 1025"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const char *said = web_ask(3, 50, 4, 3, 0, 4, wrong[i][0], 0, 0);
        assert_memory_equal(said, "{\"error\":\"", 10);
        assert_memory_equal(said + 10, wrong[i][1], strlen(wrong[i][1]));
        assert_memory_equal(web_rows(CSV), "{\"error\"", 8); /* nor the answer before */
    }
    asks_well(web_ask(3, 50, 4, 3, 0, 4, "angle=1&resolution=16", 0, 0), "[1]", 38); /* the atlas is still open */
}

static void is_about(const uint8_t *rgb, unsigned colour)
{
    for (int c = 0; c < 3; c++) {
        const unsigned right = colour >> (16 - 8 * c) & 255;
        assert_in_range(rgb[c] + 1, right, right + 1); /* to rounding, which only makes darker */
    }
}

/* What is hit has its colour in the cut, and none once a question was refused. */
static void test_a_refused_question_takes_the_answer_away(void **state)
{
    (void)state;
    const size_t at = 4 * (23 * 64 + 32);
    asks_well(web_ask(0, 50, 0, 0, 0, 0, "angle=1&resolution=16", 0, 0), "[1]", 38);
    is_about(web_cut(0, 1, 0, 0, 0, 64, 64, 1, 1, 0, 0) + at, LOOK_RANK_1);
    assert_non_null(strstr(web_ask(1, 1, 1, 1, 1, 1, "angle=90&resolution=16", 0, 0), "{\"error\":\"toward"));
    assert_null(strstr(web_rows(CSV), "Slab"));
    is_about(web_cut(0, 1, 0, 0, 0, 64, 64, 1, 1, 0, 0) + at, LOOK_NOT_HIT);
}

/* One pixel a mm, x to the right and y to the top: y = 9 is 9 rows above the middle. */
static void test_cut_has_its_top_row_first(void **state)
{
    (void)state;
    assert_non_null(web_cut(0, 1, 0, 0, 0, 64, 64, 1, 0.5, 0, 0));
    const uint32_t *objects = web_part(6);
    assert_int_equal(objects[23 * 64 + 32], 1);
    assert_int_equal(objects[32 * 64 + 32], 0);
    assert_int_equal(objects[41 * 64 + 32], 2);
}

/* From the left the front is at the left. At the boxes, 80 mm away, half of 64 pixels are 80 tan(15°) = 21.4 mm: y = 9
 * is 13 columns from the middle. With the eye at the height of their upper edge they fill the lower half. */
static void test_view_is_upright_and_not_mirrored(void **state)
{
    (void)state;
    assert_non_null(web_view(64, -100, 0, 20, 0, 0, 20, 30, 0));
    const uint32_t *objects = web_part(7);
    assert_int_equal(objects[48 * 64 + 18], 1);
    assert_int_equal(objects[48 * 64 + 45], 2);
    assert_int_equal(objects[16 * 64 + 18], 0);
    assert_true(fabs(((const float *)web_part(8))[32 * 64 + 18] - 80 / cos(atan(13.5 / 32 * tan(15 * RADIANS)))) < 0.5);
    assert_null(web_view(100000, -100, 0, 20, 0, 0, 20, 30, 0));
}

/* A flat face that is seen from straight ahead has its colour in the middle, to rounding: that of its place in the
 * answer, of the file, or none. Here it is the anterior one's. */
static void test_view_is_lit_from_the_eye(void **state)
{
    (void)state;
    const size_t middle = 4 * (32 * 64 + 32);
    asks_well(web_ask(0, -50, 0, 0, 0, 0, "angle=1&resolution=16", 0, 0), "[2]", 38); /* the posterior one alone */
    is_about(web_view(64, 0, 100, 0, 0, 0, 0, 10, 0) + middle, LOOK_NOT_HIT);
    asks_well(web_ask(0, 50, 0, 0, 0, 0, "angle=1&resolution=16", 0, 0), "[1]", 38);
    const uint8_t *rgba = web_view(64, 0, 100, 0, 0, 0, 0, 10, 0) + middle;
    is_about(rgba, LOOK_RANK_1);
    assert_int_equal(rgba[3], 255);
    web_use_colours(COLOURS_OF_FILE);
    asks_well(web_ask(0, 50, 0, 0, 0, 0, "angle=1&resolution=16", 0, 0), "[1]", 38);
    is_about(web_view(64, 0, 100, 0, 0, 0, 0, 10, 0) + middle, 0xF2BA85);
    rgba = web_view(64, 0, 100, 0, 0, 0, 0, 10, 2); /* another is chosen */
    assert_in_range(rgba[middle], 95, 97);
    web_use_colours(COLOURS_OF_ANSWER);
}

/* A cone that the posterior one has but a few pixels of: it has a little of its colour, in the answer as in the view,
 * and the rest is grey, as conus_selection_weight() says. */
static void test_what_has_little_is_pale(void **state)
{
    char hex[8];
    (void)state;
    const char *answer = web_ask(-50, 8, 0, 0, 8, 0, "angle=28&resolution=128", 0, 0);
    const char *list = strstr(answer, "\"colours\":[\"#");
    assert_non_null(strstr(answer, "\"hits\":[1,2]"));
    const conus_result *small = conus_selection_result(page.selection, 1);
    assert_true(small->share > 0 && small->share < 0.2);
    const double weight = conus_selection_weight(page.selection, 2);
    const uint8_t *rgb = web_view(64, -100, -9, 0, 0, -9, 0, 10, 0) + (size_t)4 * (32 * 64 + 32);
    assert_true(weight < 0.7 && list);
    assert_memory_equal(list + 11, "\"#d2246c\",\"#", 12);
    snprintf(hex, sizeof hex, "%.6s", list + 23);
    const unsigned colour = (unsigned)strtoul(hex, NULL, 16);
    assert_int_equal(colour >> 16, (int)(weight * (LOOK_RANK_2 >> 16) + (1 - weight) * (LOOK_NOT_HIT >> 16) + 0.5));
    is_about(rgb, colour);
}

/* From behind the posterior one hides the other, which is the second of all layers: stripes of its colour and grey. */
static void test_what_is_behind_has_stripes(void **state)
{
    (void)state;
    int coloured = 0;
    asks_well(web_ask(0, -50, 0, 0, 0, 0, "angle=1&resolution=16&layers=all", 0, 0), "[2,1]", 0);
    const uint8_t *row = web_view(64, 0, 100, 0, 0, 0, 0, 10, 0) + (size_t)4 * 32 * 64;
    for (int x = 24; x < 40; x++) {
        const bool is_stripe = row[4 * x] < 100;
        is_about(row + 4 * x, is_stripe ? LOOK_RANK_2 : LOOK_NOT_HIT);
        coloured += is_stripe;
    }
    assert_int_equal(coloured, 8);
}

/* One symbol of each folder that draws. They are weak: a name here does not link its file into the program, and is NULL
 * unless another file has done so. */
extern char gl_context_create[] __attribute__((weak)), font_destroy[] __attribute__((weak)),
    renderer_include[] __attribute__((weak)), id_pass_create[] __attribute__((weak)),
    picture_legend_finish[] __attribute__((weak));

static void test_nothing_that_draws_is_linked(void **state)
{
    (void)state;
    assert_null(gl_context_create);
    assert_null(font_destroy);
    assert_null(renderer_include);
    assert_null(id_pass_create);
    assert_null(picture_legend_finish);
}

static void test_pictures_are_refused(void **state)
{
    (void)state;
    conus_image *image = NULL;
    assert_int_equal(conus_render(&image, NULL, NULL), CONUS_ERROR_UNSUPPORTED);
    const conus_selector_options gl = {.engine = CONUS_ENGINE_GL};
    conus_selector *selector = NULL;
    assert_int_equal(conus_selector_create(&selector, page.atlas, &gl), CONUS_ERROR_UNSUPPORTED);
    assert_non_null(strstr(conus_message(), "rays"));
}

/* A published atlas is named with its reference; the slabs were not. */
static void test_which_atlas_it_is(void **state)
{
    (void)state;
    static const char aal[] = "/usr/share/mricron/templates/aal.nii.gz";
    if (access(aal, R_OK) != 0) {
        skip(); /* no mricron-data */
    }
    const char *said = web_open(aal);
    assert_non_null(
        strstr(said, "\"identity\":\"AAL, 116 areas, 1 mm, on Colin 27\",\"reference\":\"N. Tzourio-Mazoyer"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_objects_have_names_and_colours),
        cmocka_unit_test(test_rows_of_an_answer),
        cmocka_unit_test(test_a_range_has_what_is_first_in_it),
        cmocka_unit_test(test_a_press_confirms_what_was_selected_before),
        cmocka_unit_test(test_the_form_is_what_is_asked),
        cmocka_unit_test(test_errors_are_words),
        cmocka_unit_test(test_a_refused_question_takes_the_answer_away),
        cmocka_unit_test(test_cut_has_its_top_row_first),
        cmocka_unit_test(test_view_is_upright_and_not_mirrored),
        cmocka_unit_test(test_view_is_lit_from_the_eye),
        cmocka_unit_test(test_what_has_little_is_pale),
        cmocka_unit_test(test_what_is_behind_has_stripes),
        cmocka_unit_test(test_pictures_are_refused),
        cmocka_unit_test(test_nothing_that_draws_is_linked),
        cmocka_unit_test(test_which_atlas_it_is),
    };
    return cmocka_run_group_tests(tests, open_slabs, NULL);
}
