/* SPDX-License-Identifier: BSD-3-Clause */
/* Changes made to areas in the window are carried over to an atlas with another choice of hemispheres; showing one side
 * only. */
#include "viewer/model/viewer.h"
#include "viewer/opening/parts.h"

#include "builders/area_rows.h"
#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* x from -3.5 to 3.5: Four and Nine lie on both sides, A_L and A_R are a pair. */
static const size_t dim[3] = {8, 2, 1};
static const uint32_t labels[16] = {4, 4, 4, 4, 4, 4, 9, 9, 9, 9, 9, 9, 1, 1, 2, 2};
static const struct area_row rows[] = {{1, "A_L", 20, NULL, 0}, {2, "A_R", 20, NULL, 0}, {4, "Four", 20, NULL, 0},
                                       {9, "Nine", 0, NULL, 0}, {20, "Top", 0, NULL, 0}, {0}};
static const struct area_row others[] = {{1, "A_L", 20, NULL, 0}, {2, "A_R", 20, NULL, 0}, {4, "Fourth", 20, NULL, 0},
                                         {9, "Nine", 0, NULL, 0}, {20, "Top", 0, NULL, 0}, {0}};

static conus_atlas *make(const struct area_row *table, conus_hemispheres how)
{
    conus_atlas *atlas = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, labels, table));
    assert_ok(area_rows_add_pathway(atlas, "Tract"));
    assert_ok(conus_atlas_set_hemispheres(atlas, how));
    return atlas;
}

static void open_viewer(struct viewer *out, conus_hemispheres how)
{
    const struct view_source source = {make(rows, how), "rows.nii", NULL};
    assert_ok(viewer_create(out, &source, 1, NULL, NULL, NULL));
}

static void change(struct viewer *viewer, conus_hemispheres before, conus_hemispheres how)
{
    conus_atlas *atlas = make(rows, how);
    char why[64];
    const struct replacement now = {&atlas, before, how, NULL};
    assert_true(viewer_replace(viewer, &now, why, sizeof why));
    assert_ptr_equal(viewer->atlases[0].atlas, atlas);
    assert_ptr_equal(viewer->names[0], viewer->atlases[0].name);
}

static uint32_t number_of(const struct viewer *viewer, const char *name)
{
    uint32_t number = area_rows_number(viewer->drawn->atlas, name);
    assert_true(number > 0);
    return number;
}

/* Names of the hidden areas, with commas between; asserts that the atlas hides the same. */
static const char *hidden(const struct viewer *viewer)
{
    static char text[256];
    int used = 0;
    text[0] = '\0';
    for (uint32_t number = 1; number <= viewer->drawn->object_count; number++) {
        bool is = viewer->drawn->shown.hidden[number];
        assert_int_equal(is, conus_atlas_is_hidden(viewer->drawn->atlas, number));
        if (is) {
            used += snprintf(text + used, sizeof text - (size_t)used, "%s%s", used ? "," : "",
                             conus_atlas_object(viewer->drawn->atlas, number)->name);
        }
    }
    return text;
}

static double opacity(const struct viewer *viewer, const char *name)
{
    return viewer->drawn->appearance.opacity[number_of(viewer, name)];
}

static void halves_are_as_the_whole_was(void **state)
{
    struct viewer viewer;
    (void)state;
    open_viewer(&viewer, CONUS_HEMISPHERES_AS_IS);
    viewer_hide(&viewer, number_of(&viewer, "Four"), true);
    viewer_set_opacity(&viewer, number_of(&viewer, "Nine"), 0.25);
    viewer_set_opacity(&viewer, 0, 0.5);
    viewer_set_haze(&viewer, number_of(&viewer, "Tract"), HAZE_OWN);
    viewer_choose(&viewer, number_of(&viewer, "A_R"));
    change(&viewer, CONUS_HEMISPHERES_AS_IS, CONUS_HEMISPHERES_SPLIT);
    assert_string_equal(hidden(&viewer), "Four left,Four right");
    assert_near(opacity(&viewer, "Nine left"), 0.25, 0);
    assert_near(opacity(&viewer, "Nine right"), 0.25, 0);
    assert_true(isnan(opacity(&viewer, "A_R")));
    assert_near(viewer.drawn->appearance.opacity[0], 0.5, 0);
    assert_int_equal(viewer.drawn->appearance.haze[number_of(&viewer, "Tract")], HAZE_OWN);
    assert_int_equal(viewer.drawn->shown.chosen, number_of(&viewer, "A_R"));
    /* joined again */
    change(&viewer, CONUS_HEMISPHERES_SPLIT, CONUS_HEMISPHERES_AS_IS);
    assert_string_equal(hidden(&viewer), "Four");
    assert_near(opacity(&viewer, "Nine"), 0.25, 0);
    viewer_finish(&viewer);
}

static void a_whole_is_as_both_halves_were(void **state)
{
    struct viewer viewer;
    (void)state;
    open_viewer(&viewer, CONUS_HEMISPHERES_SPLIT);
    viewer_hide(&viewer, number_of(&viewer, "Four left"), true); /* one of two */
    viewer_hide(&viewer, number_of(&viewer, "Nine left"), true);
    viewer_hide(&viewer, number_of(&viewer, "Nine right"), true);
    viewer_set_opacity(&viewer, number_of(&viewer, "Four right"), 0.25);
    viewer_choose(&viewer, number_of(&viewer, "Four right"));
    change(&viewer, CONUS_HEMISPHERES_SPLIT, CONUS_HEMISPHERES_AS_IS);
    assert_string_equal(hidden(&viewer), "Nine");
    assert_true(isnan(opacity(&viewer, "Four")));
    assert_int_equal(viewer.drawn->shown.chosen, number_of(&viewer, "Four"));
    change(&viewer, CONUS_HEMISPHERES_AS_IS, CONUS_HEMISPHERES_SPLIT);
    assert_int_equal(viewer.drawn->shown.chosen, 0); /* a chosen area that becomes two is not chosen */
    viewer_finish(&viewer);
}

/* Split areas are merged at once, without the pair of the file between. */
static void a_pair_is_as_both_areas_were(void **state)
{
    struct viewer viewer;
    (void)state;
    open_viewer(&viewer, CONUS_HEMISPHERES_SPLIT);
    viewer_hide(&viewer, number_of(&viewer, "A_L"), true);
    viewer_set_opacity(&viewer, number_of(&viewer, "A_L"), 0.25);
    viewer_set_opacity(&viewer, number_of(&viewer, "A_R"), 0.25);
    change(&viewer, CONUS_HEMISPHERES_SPLIT, CONUS_HEMISPHERES_MERGED);
    assert_string_equal(hidden(&viewer), "A_L");
    assert_near(opacity(&viewer, "A"), 0.25, 0);
    viewer_hide(&viewer, number_of(&viewer, "A_R"), true);
    change(&viewer, CONUS_HEMISPHERES_MERGED, CONUS_HEMISPHERES_AS_IS);
    assert_string_equal(hidden(&viewer), "A_L,A_R");
    change(&viewer, CONUS_HEMISPHERES_AS_IS, CONUS_HEMISPHERES_MERGED);
    assert_string_equal(hidden(&viewer), "A_L,A_R,A");
    viewer_finish(&viewer);
}

static void confirmed_areas_keep_their_names(void **state)
{
    struct viewer viewer;
    (void)state;
    open_viewer(&viewer, CONUS_HEMISPHERES_SPLIT);
    viewer_pin(&viewer, (struct pin){.object = number_of(&viewer, "Four left"), .share = 0.5, .distance = 1});
    viewer_pin(&viewer, (struct pin){.object = number_of(&viewer, "A_R"), .share = 0.5, .distance = 1});
    viewer_pin(&viewer, (struct pin){.object = number_of(&viewer, "Tract"), .share = 0.5, .distance = 1});
    change(&viewer, CONUS_HEMISPHERES_SPLIT, CONUS_HEMISPHERES_AS_IS);
    assert_string_equal(viewer.pins[0].name, "Four left");
    assert_int_equal(viewer.pins[0].object, 0);
    assert_int_equal(viewer.pins[1].object, number_of(&viewer, "A_R"));
    assert_int_equal(viewer.pins[2].object, number_of(&viewer, "Tract"));
    viewer_finish(&viewer);
}

/* A pathway's threshold and the colours are kept; the query is answered again. */
static void thresholds_colours_and_answers_are_kept(void **state)
{
    struct viewer viewer;
    (void)state;
    open_viewer(&viewer, CONUS_HEMISPHERES_AS_IS);
    uint32_t tract = number_of(&viewer, "Tract");
    const conus_volume_info *info = view_atlas_pathway(viewer.drawn, tract);
    double threshold = info->threshold + 0.5 * (info->maximum - info->threshold) + 0.01;
    viewer_set_threshold(&viewer, tract, threshold);
    viewer_use_safe_colours(&viewer, true);
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){-2, -60, 0}, (double[]){0, 1, 0});
    unsigned before = viewer.tools[FIRST_TOOL].answer_number;
    change(&viewer, CONUS_HEMISPHERES_AS_IS, CONUS_HEMISPHERES_SPLIT);
    uint8_t rgb[3];
    conus_atlas *other = make(rows, CONUS_HEMISPHERES_SPLIT);
    conus_atlas_use_safe_colours(other);
    viewer.display.own_colours = true; /* else with a cone all that is not hit is grey */
    viewer_colour(rgb, &viewer, 1);
    assert_memory_equal(rgb, conus_atlas_object(other, 1)->rgb, 3);
    conus_atlas_destroy(other);
    assert_near(view_atlas_pathway(viewer.drawn, number_of(&viewer, "Tract"))->threshold, threshold, 0);
    assert_true(viewer.tools[FIRST_TOOL].answer_number > before);
    const conus_selection *selection = viewer_selection(&viewer);
    uint32_t best = conus_selection_result(selection, 0)->object;
    const char *name = conus_atlas_object(viewer.drawn->atlas, best)->name;
    assert_true(strcmp(name, "Four left") == 0 || strcmp(name, "Tract") == 0);
    viewer_finish(&viewer);
}

static void another_table_is_refused(void **state)
{
    struct viewer viewer;
    conus_atlas *atlas = make(others, CONUS_HEMISPHERES_SPLIT);
    (void)state;
    open_viewer(&viewer, CONUS_HEMISPHERES_AS_IS);
    const conus_atlas *before = viewer.drawn->atlas;
    char why[128];
    const struct replacement now = {&atlas, CONUS_HEMISPHERES_AS_IS, CONUS_HEMISPHERES_SPLIT, NULL};
    assert_false(viewer_replace(&viewer, &now, why, sizeof why));
    assert_string_equal(why, "the areas have other names or labels than when the atlas was opened");
    assert_ptr_equal(viewer.drawn->atlas, before);
    conus_atlas_destroy(atlas);
    viewer_finish(&viewer);
}

static void one_side_is_shown(void **state)
{
    struct viewer viewer;
    (void)state;
    open_viewer(&viewer, CONUS_HEMISPHERES_SPLIT); /* Top is cut as well */
    assert_int_equal(side_known(&viewer), SIDE_BOTH);
    viewer_hide(&viewer, number_of(&viewer, "A_L"), true);
    viewer_hide(&viewer, number_of(&viewer, "Tract"), true);
    assert_int_equal(side_shown(&viewer), SIDE_BOTH);
    side_show(&viewer, SIDE_LEFT);
    assert_int_equal(side_shown(&viewer), SIDE_LEFT);
    assert_string_equal(hidden(&viewer), "A_L,A_R,Four right,Nine right,Top right,Tract");
    side_show(&viewer, SIDE_RIGHT); /* it was hidden whole; and the left is now */
    assert_string_equal(hidden(&viewer), "A_L,Four left,Nine left,Top left,Tract");
    side_show_next(&viewer);
    assert_int_equal(side_shown(&viewer), SIDE_BOTH);
    assert_string_equal(hidden(&viewer), "Tract");
    assert_string_equal(viewer.message, "both sides are shown");
    viewer_finish(&viewer);
}

/* With all areas of both sides hidden no side counts as shown, and either can be shown. */
static void hidden_sides_are_shown_again(void **state)
{
    struct viewer viewer;
    (void)state;
    open_viewer(&viewer, CONUS_HEMISPHERES_SPLIT);
    viewer_isolate(&viewer, number_of(&viewer, "Tract"));
    assert_int_equal(side_shown(&viewer), SIDE_COUNT);
    side_show(&viewer, SIDE_RIGHT);
    assert_int_equal(side_shown(&viewer), SIDE_RIGHT);
    viewer_isolate(&viewer, number_of(&viewer, "Tract"));
    side_show_next(&viewer);
    assert_int_equal(side_shown(&viewer), SIDE_BOTH);
    viewer_finish(&viewer);
}

static void areas_without_sides_stay(void **state)
{
    static const struct area_row plain[] = {{1, "One", 0, NULL, 0}, {2, "Two", 0, NULL, 0}, {0}};
    struct viewer viewer;
    conus_atlas *atlas = NULL;
    (void)state;
    assert_ok(area_rows_atlas(&atlas, dim, labels, plain));
    const struct view_source source = {atlas, "plain.nii", NULL};
    assert_ok(viewer_create(&viewer, &source, 1, NULL, NULL, NULL));
    assert_int_equal(side_known(&viewer), SIDE_COUNT);
    side_show_next(&viewer);
    assert_string_equal(hidden(&viewer), "");
    assert_string_equal(viewer.message, "no left or right areas are known; F8 splits areas");
    viewer_finish(&viewer);
}

/* As an atlas of a surface of one hemisphere has them. */
static void one_side_may_be_all_there_is(void **state)
{
    static const struct area_row lefts[] = {{1, "Left One", 0, NULL, 0}, {2, "Left Two", 0, NULL, 0}, {0}};
    struct viewer viewer;
    conus_atlas *atlas = NULL;
    (void)state;
    assert_ok(area_rows_atlas(&atlas, dim, labels, lefts));
    const struct view_source source = {atlas, "left.nii", NULL};
    assert_ok(viewer_create(&viewer, &source, 1, NULL, NULL, NULL));
    assert_int_equal(side_known(&viewer), SIDE_LEFT);
    side_show_next(&viewer);
    assert_string_equal(hidden(&viewer), "");
    assert_string_equal(viewer.message, "no right areas are known; F8 splits areas");
    viewer_finish(&viewer);
}

static void words_say_how(void **state)
{
    json_t *words = json_pack("[s, s, s]", "--labels=a", "--hemispheres=split", "--atlas=b");
    json_t *merged = hemispheres_put_in_words(words, CONUS_HEMISPHERES_MERGED);
    json_t *plain = hemispheres_put_in_words(merged, CONUS_HEMISPHERES_AS_IS);
    (void)state;
    assert_int_equal(hemispheres_of_words(NULL), CONUS_HEMISPHERES_AS_IS);
    assert_int_equal(hemispheres_of_words(words), CONUS_HEMISPHERES_SPLIT);
    assert_int_equal(hemispheres_of_words(merged), CONUS_HEMISPHERES_MERGED);
    assert_int_equal(json_array_size(merged), 3);
    assert_int_equal(json_array_size(plain), 2);
    assert_int_equal(hemispheres_of_words(plain), CONUS_HEMISPHERES_AS_IS);
    assert_string_equal(json_string_value(json_array_get(plain, 1)), "--atlas=b");
    json_decref(plain);
    json_decref(merged);
    json_decref(words);
}

/* Without a pathway, which would be as large as all areas. */
static conus_atlas *split_areas(void)
{
    conus_atlas *atlas = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT));
    return atlas;
}

/* All cells of the atlas are from x = -4 to 4 and y = -1 to 1, whatever is hidden, also when it is opened again. */
static void the_frame_is_that_of_the_whole(void **state)
{
    struct viewer viewer;
    (void)state;
    for (int hides = 0; hides < 2; hides++) {
        conus_atlas *atlas = split_areas();
        bool *hidden = calloc(conus_atlas_object_count(atlas) + 1, sizeof *hidden);
        const uint32_t one = area_rows_number(atlas, "Four left");
        hidden[one] = hidden[area_rows_number(atlas, "Nine left")] = hides; /* all that lies at x < 0 */
        assert_ok(conus_atlas_set_hidden(atlas, hidden));
        const struct view_source source = {atlas, "rows.nii", NULL};
        assert_ok(viewer_create(&viewer, &source, 1, NULL, NULL, NULL));
        assert_int_equal(conus_atlas_is_hidden(atlas, one), hides);
        for (int anew = 0; anew < 2; anew++) {
            char why[64];
            assert_near(viewer.centre[0], 0, 0);
            assert_near(viewer.half[0], 4, 0);
            assert_near(viewer.centre[1], 0, 0);
            assert_near(viewer.half[1], 1, 0);
            side_show(&viewer, SIDE_RIGHT);
            atlas = split_areas();
            const struct replacement now = {&atlas, CONUS_HEMISPHERES_SPLIT, CONUS_HEMISPHERES_SPLIT, NULL};
            assert_true(viewer_replace(&viewer, &now, why, sizeof why));
            assert_int_equal(side_shown(&viewer), SIDE_RIGHT);
        }
        free(hidden);
        viewer_finish(&viewer);
    }
}

TEST_GROUP(replace)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(halves_are_as_the_whole_was),
        cmocka_unit_test(a_whole_is_as_both_halves_were),
        cmocka_unit_test(a_pair_is_as_both_areas_were),
        cmocka_unit_test(confirmed_areas_keep_their_names),
        cmocka_unit_test(thresholds_colours_and_answers_are_kept),
        cmocka_unit_test(another_table_is_refused),
        cmocka_unit_test(one_side_is_shown),
        cmocka_unit_test(the_frame_is_that_of_the_whole),
        cmocka_unit_test(hidden_sides_are_shown_again),
        cmocka_unit_test(areas_without_sides_stay),
        cmocka_unit_test(one_side_may_be_all_there_is),
        cmocka_unit_test(words_say_how),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
