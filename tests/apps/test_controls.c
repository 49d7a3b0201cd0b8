/* SPDX-License-Identifier: BSD-3-Clause */
/* The window's settings for queries and studies, without a window. */
#include "viewer/commands/commands.h"
#include "viewer/model/columns.h"
#include "viewer/model/viewer.h"
#include "viewer/session/session.h"

#include "conus/own.h"
#include "selection/table/table.h"
#include "session_words.h"
#include "tables.h"
#include "test.h"

#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double eye[3] = {2, 90, 3};
static const double back[3] = {0, -1, 0};

/* Balls of 24, 16 and 8 mm, one in the other. */
static void load(struct viewer *out)
{
    conus_atlas *atlas = NULL;
    test_folder("phantom");
    assert_ok(conus_phantom_write("nested", test_in(""), NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("nested.nii.gz"), NULL));
    assert_ok(viewer_create(out, &(struct view_source){.atlas = atlas, .path = "nested"}, 1, NULL, NULL, NULL));
}

/* Asserts that the rows of the list are those of the table that the window copies, which the library sorts. */
static void assert_listed_as_in_table(struct viewer *viewer)
{
    const conus_selection *selection = viewer_selection(viewer);
    char *table = viewer_results_text(viewer);
    char *rest = table;
    size_t *order = result_order(viewer, viewer->drawn, selection);
    strsep(&rest, "\n"); /* of the column's names */
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, order ? order[i] : i);
        const conus_object *object = conus_atlas_object(viewer->drawn->atlas, result->object);
        char *row = strsep(&rest, "\n");
        for (int column = 0; column < 3; column++) { /* query, kind, index */
            strsep(&row, "\t");
        }
        assert_string_equal(strsep(&row, "\t"), object ? object->name : "unassigned");
    }
    free(order);
    free(table);
}

/* With all layers an occluded object has an entry but no distance. This score ranks it before the outer ball, which is
 * hit first; by depth it comes after it. */
static void lists_are_sorted_as_tables_are(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer);
    viewer.tools[FIRST_TOOL].angle = 30;
    viewer.cone.options.score = "-proximity";
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    for (int way = 0; way < 4; way++) {
        viewer.cone.options.layers = way & 1 ? CONUS_LAYERS_ALL : CONUS_LAYERS_VISIBLE;
        viewer.cone.order = way & 2 ? CONUS_ORDER_DEPTH : CONUS_ORDER_RANK;
        tool_reselect(&viewer);
        assert_listed_as_in_table(&viewer);
    }
    viewer.cone.one_ray = true; /* has first hits only, whatever the layers */
    tool_reselect(&viewer);
    assert_listed_as_in_table(&viewer);
    viewer_finish(&viewer);
}

/* In the tree Ball > (Shell > (Outer, Inner), Core) the first hit is in Outer. */
static void levels_go_round(void **state)
{
    static const char tree[] = "index\tname\tparent_id\n1\tOuter\t20\n300\tInner\t20\n20\tShell\t40\n"
                               "4000000001\tCore\t40\n40\tBall\tn/a\n";
    static const char *const names[] = {"Ball", "Shell", "Outer", "Outer"};
    struct viewer viewer;
    conus_atlas *atlas = NULL;
    char labels[600];
    (void)state;
    test_folder("phantom");
    snprintf(labels, sizeof labels, "%s", test_in("tree.tsv"));
    assert_ok(conus_write_file(labels, tree, strlen(tree)));
    assert_ok(conus_phantom_write("nested", test_in(""), NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("nested.nii.gz"), &(conus_load_options){.labels = labels}));
    assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas}, 1, NULL, NULL, NULL));
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    assert_int_equal(query_deepest(&viewer), 3);
    for (unsigned depth = 1; depth <= 4; depth++) {
        query_next_level(&viewer);
        assert_int_equal(query_depth(&viewer), depth % 4);
        uint32_t best = conus_selection_result(viewer_selection(&viewer), 0)->object;
        assert_string_equal(conus_atlas_object(atlas, best)->name, names[depth - 1]);
    }
    assert_true(query_set_level(&viewer, "Shell,Core"));
    assert_int_equal(query_depth(&viewer), 0);
    viewer_finish(&viewer);
}

static void invalid_queries_change_nothing(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer);
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    assert_true(query_set_range(&viewer, 10, 80));
    size_t count = conus_selection_count(viewer_selection(&viewer));
    assert_false(query_set_range(&viewer, 80, 10));
    assert_non_null(strstr(viewer.message, "range"));
    assert_false(query_set_level(&viewer, "2"));
    assert_non_null(strstr(viewer.message, "no area tree"));
    query_next_level(&viewer);
    assert_non_null(strstr(viewer.message, "no area tree"));
    assert_string_equal(viewer.cone.level, "");
    assert_true(viewer.cone.options.range[0] == 10 && viewer.cone.options.range[1] == 80);
    assert_int_equal(conus_selection_count(viewer_selection(&viewer)), count);
    char level[LEVEL_LIMIT + 1];
    memset(level, 'x', LEVEL_LIMIT);
    level[LEVEL_LIMIT] = '\0';
    assert_false(query_set_level(&viewer, level));
    assert_non_null(strstr(viewer.message, "1024 bytes, allowed are 1023"));
    assert_true(query_move_range(&viewer, -20, -1)); /* no nearer than 0 */
    assert_true(viewer.cone.options.range[0] == 0 && viewer.cone.options.range[1] == 79);
    viewer_finish(&viewer);
}

static const struct study_settings two_angles = {STUDY_SWEEP, {10, 40, 30}, 2, 1.5, 64};
static const struct study_settings shaken = {STUDY_JITTER, {10, 40, 30}, 2, 1.5, 64};

/* Waits for the study of the current question; the thread finishes it without being asked again. */
static void await_study(struct viewer *viewer)
{
    do {
        studies_step(viewer);
        sched_yield();
    } while (studies_is_old(viewer));
}

/* The shares at each angle and the probabilities equal those of the library, asked for each of them alone. */
static void studies_answer_as_the_library_does(void **state)
{
    struct viewer viewer;
    conus_table *jitter = NULL;
    (void)state;
    load(&viewer);
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    assert_true(studies_use(&viewer, &two_angles));
    assert_null(studies_text(&viewer));
    assert_string_equal(viewer.message, "the study is not done yet");
    await_study(&viewer);
    const struct study_answer *answer = viewer.study.answer;
    assert_int_equal(answer->angle_count, 2);
    for (size_t angle = 0; angle < 2; angle++) {
        viewer.tools[FIRST_TOOL].angle = answer->angles[angle];
        tool_reselect(&viewer);
        for (size_t i = 0; i < answer->tables[0].curve_count; i++) {
            const struct study_curve *curve = &answer->tables[0].curves[i];
            double share = 0;
            const conus_result *result;
            for (size_t r = 0; (result = conus_selection_result(viewer_selection(&viewer), r)); r++) {
                share += result->object == curve->object ? result->share : 0;
            }
            assert_true(curve->shares[angle] == share && curve->most >= share);
        }
    }
    assert_false(studies_is_old(&viewer)); /* a sweep has angles of its own, so the cone's angle does not count */
    assert_true(studies_use(&viewer, &shaken));
    await_study(&viewer);
    const struct study_table *table = viewer.study.answer->tables;
    const conus_jitter_options options = {.tilt = 2, .shift = 1.5, .samples = 64};
    assert_ok(conus_jitter(&jitter, viewer.drawn->selector, &viewer.tools[FIRST_TOOL].pose, 40, &options));
    assert_same_tables(table->chances, jitter);
    conus_table_destroy(jitter);
    viewer_finish(&viewer);
}

/* Without all layers nothing is known of what lies behind; what is no object cannot lie there. */
static void areas_that_nothing_ever_hits_are_not_listed(void **state)
{
    static const struct chance {
        struct table_object object;
        double hit, seen, in_cone;
        bool is_listed, is_behind;
    } rows[] = {{.object.number = 1, .hit = 0.5, .seen = 0.75, .in_cone = 1, true, false},
                {.object.number = 1, .seen = 0.25, .in_cone = 0.5, true, false},
                {.object.number = 1, .in_cone = 0.25, true, true},
                {.object.number = 1, .in_cone = 0, false, false},
                {.object.number = 1, .in_cone = NAN, false, false},
                {.object.number = 1, .seen = 0.25, .in_cone = NAN, true, false},
                {.object.number = 0, .hit = 0.25, .in_cone = NAN, true, false},
                {.object.number = 0, .in_cone = 1, false, false}};
    static const struct table_field columns[] = {{"p_hit", NULL, "", TABLE_OF(NUMBER, struct chance, hit)},
                                                 {"p_seen", NULL, "", TABLE_OF(NUMBER, struct chance, seen)},
                                                 {"p_in_cone", NULL, "", TABLE_OF(NUMBER, struct chance, in_cone)}};
    static const struct table_fields fields = {columns, sizeof columns / sizeof *columns};
    const struct table_source source = {.frame = &(conus_frame){.space = CONUS_SPACE_RAS}};
    size_t count = sizeof rows / sizeof *rows;
    conus_table *chances = NULL;
    (void)state;
    assert_ok(table_create(&chances, &source, &fields, &(struct table_question){0}, rows, sizeof *rows, count));
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(chance_is_listed(chances, i), rows[i].is_listed);
        assert_int_equal(chance_is_behind(chances, i), rows[i].is_behind);
    }
    conus_table_destroy(chances);
}

/* A change of the pose, the range or the hidden objects makes the answer old. */
static void a_change_of_the_query_makes_a_study_old(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer);
    assert_null(studies_text(&viewer));
    assert_string_equal(viewer.message, "there is no cone to study");
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    for (int change = 0; change < 6; change++) {
        assert_true(studies_use(&viewer, change % 2 ? &two_angles : &shaken));
        await_study(&viewer);
        assert_non_null(studies_text(&viewer));
        if (change < 2) {
            tool_aim_along(&viewer, FIRST_TOOL, (double[]){change, 80, 3}, back);
        } else if (change < 4) {
            query_set_range(&viewer, change, 100);
        } else {
            viewer_hide(&viewer, 1, change == 4);
        }
        assert_true(studies_is_old(&viewer));
        assert_null(studies_text(&viewer));
    }
    await_study(&viewer);
    viewer.cone.options.radius = 3;
    tool_reselect(&viewer);
    await_study(&viewer);
    assert_null(studies_text(&viewer));
    assert_string_equal(viewer.message, "a cylinder has no angle to sweep");
    tool_clear(&viewer);
    assert_false(studies_is_on(&viewer));
    viewer_finish(&viewer);
}

/* 2^20 poses take minutes. Hiding an area and closing wait for one pose at most, and an area that is hidden then is not
 * in the answer. */
static void the_atlas_does_not_wait_for_a_long_study(void **state)
{
    struct viewer viewer;
    struct study_settings longest = shaken;
    (void)state;
    longest.samples = 1048576;
    load(&viewer);
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    assert_true(studies_use(&viewer, &longest));
    studies_step(&viewer);
    viewer_hide(&viewer, 1, true);
    studies_step(&viewer);
    assert_null(viewer.study.answer);
    viewer_hide(&viewer, 1, false);
    viewer_hide(&viewer, 2, true);
    viewer_set_threshold(&viewer, 1, 0.5); /* which it refuses, since it is no pathway */
    assert_true(studies_use(&viewer, &two_angles));
    studies_step(&viewer);
    viewer_use_safe_colours(&viewer, true);
    await_study(&viewer);
    assert_int_equal(viewer.study.answer->tables[0].curve_count, 3);
    for (size_t i = 0; i < 3; i++) {
        assert_true(viewer.study.answer->tables[0].curves[i].object != 2);
    }
    assert_true(studies_use(&viewer, &longest));
    studies_step(&viewer);
    assert_true(studies_use(&viewer, &shaken)); /* a newer question, too, does not wait for minutes */
    await_study(&viewer);
    assert_true(studies_use(&viewer, &longest));
    studies_step(&viewer);
    viewer_finish(&viewer);
}

static void studies_have_limits(void **state)
{
    static const struct {
        struct study_settings settings;
        const char *why;
    } cases[] = {
        {{STUDY_SWEEP, {10, 5, 1}, 2, 1, 64}, "from, to and by"},
        {{STUDY_SWEEP, {10, 20, 0}, 2, 1, 64}, "from, to and by"},
        {{STUDY_SWEEP, {10, NAN, 1}, 2, 1, 64}, "from, to and by"},
        {{STUDY_SWEEP, {1, 101, 0.1}, 2, 1, 64}, "more than 1000"},
        {{STUDY_SWEEP, {0, 20, 1}, 2, 1, 64}, "more than 0 and less than 180"},
        {{STUDY_SWEEP, {10, 180, 10}, 2, 1, 64}, "more than 0 and less than 180"},
        {{STUDY_JITTER, {10, 20, 1}, 91, 1, 64}, "0 to 90"},
        {{STUDY_JITTER, {10, 20, 1}, 2, -1, 64}, "0 to 1000000"},
        {{STUDY_JITTER, {10, 20, 1}, 2, 1, 65}, "power of two"},
        {{STUDY_JITTER, {10, 20, 1}, 2, 1, 8}, "power of two"},
        {{STUDY_JITTER, {10, 20, 1}, 2, 1, 2097152}, "power of two"},
    };
    struct viewer viewer;
    (void)state;
    load(&viewer);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_false(studies_use(&viewer, &cases[i].settings));
        assert_non_null(strstr(viewer.message, cases[i].why));
        assert_int_equal(viewer.study.settings.kind, STUDY_NONE);
    }
    viewer_finish(&viewer);
}

static void without_an_atlas_a_key_means_nothing(void **state)
{
    struct window window = {.press = NULL}; /* no atlas is loaded yet */
    (void)state;
    assert_false(window_press(&window, "a"));
}

/* What was said is of the state before: the next key ends it, whatever it does. */
static void a_message_stands_until_the_next_key(void **state)
{
    struct viewer viewer;
    struct window window = {.viewer = &viewer, .press = keys_press};
    (void)state;
    load(&viewer);
    assert_true(window_press(&window, "escape"));
    assert_string_equal(viewer.message, "cleared");
    assert_true(window_press(&window, "r"));
    assert_string_equal(viewer.message, "");
    viewer_finish(&viewer);
}

/* Of three balls: one, the others of one that is alone, none. */
static void hidden_areas_are_counted(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer);
    viewer_hide(&viewer, 2, true);
    assert_int_equal(view_atlas_hidden(viewer.drawn), 1);
    viewer_isolate(&viewer, 2);
    assert_int_equal(view_atlas_hidden(viewer.drawn), 2);
    viewer_show_all(&viewer);
    assert_int_equal(view_atlas_hidden(viewer.drawn), 0);
    viewer_finish(&viewer);
}

static void a_session_has_the_study(void **state)
{
    struct viewer viewer;
    struct window window = {.screen.enlarged = -1, .viewer = &viewer};
    char why[PROPERTY_REASON];
    (void)state;
    load(&viewer);
    char *before = session_text(&window);
    assert_true(studies_use(&viewer, &shaken));
    property_set(&window, PROPERTY_ORDER, CONUS_ORDER_DEPTH);
    char *text = session_text(&window);
    assert_true(session_parse(&window, before, strlen(before), why));
    assert_int_equal(viewer.study.settings.kind, STUDY_NONE);
    assert_int_equal(viewer.cone.order, CONUS_ORDER_RANK);
    assert_true(session_parse(&window, text, strlen(text), why));
    assert_int_equal(viewer.study.settings.kind, STUDY_JITTER);
    assert_true(viewer.study.settings.angles[2] == 30 && viewer.study.settings.samples == 64);
    assert_int_equal(viewer.cone.order, CONUS_ORDER_DEPTH);
    char *at = strstr(strstr(text, "\"jitter\""), "64.0");
    assert_non_null(at);
    at[1] = '5';
    assert_false(session_parse(&window, text, strlen(text), why));
    assert_string_equal(why, "session: jitter: samples: a power of two from 16 to 1048576 is needed");
    free(before);
    free(text);
    viewer_finish(&viewer);
}

/* Each key has one meaning, but arrows, which move the wand where that is chosen and the view otherwise. */
static void no_key_does_two_things(void **state)
{
    const struct key *key;
    const struct key *other;
    size_t i = 0;
    (void)state;
    for (; (key = keys_row(i)); i++) {
        assert_true(key->act || key->view || key->tool || key->step || key->move || key->sets);
        for (size_t j = 0; j < i; j++) {
            other = keys_row(j);
            assert_true(strcmp(key->key, other->key) != 0 || (other->is_of_wand && !key->is_of_wand));
        }
    }
    assert_in_range(i, 90, 128);
}

TEST_GROUP(controls)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_are_sorted_as_tables_are),
        cmocka_unit_test(levels_go_round),
        cmocka_unit_test(invalid_queries_change_nothing),
        cmocka_unit_test(studies_answer_as_the_library_does),
        cmocka_unit_test(areas_that_nothing_ever_hits_are_not_listed),
        cmocka_unit_test(a_change_of_the_query_makes_a_study_old),
        cmocka_unit_test(the_atlas_does_not_wait_for_a_long_study),
        cmocka_unit_test(studies_have_limits),
        cmocka_unit_test(without_an_atlas_a_key_means_nothing),
        cmocka_unit_test(a_message_stands_until_the_next_key),
        cmocka_unit_test(hidden_areas_are_counted),
        cmocka_unit_test(a_session_has_the_study),
        cmocka_unit_test(no_key_does_two_things),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
