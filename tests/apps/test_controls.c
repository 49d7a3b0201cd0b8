/* SPDX-License-Identifier: BSD-3-Clause */
/* How the window asks, without a window. */
#include "viewer/question/question.h"

#include "test.h"

#include <math.h>
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

/* The names in the rows of the table that the window copies, which the library sorts. */
static void assert_listed_as_in_table(struct viewer *viewer)
{
    const conus_selection *selection = viewer_selection(viewer);
    char *table = viewer_results_text(viewer);
    char *rest = table;
    size_t *order = question_order(viewer, selection);
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

/* With all layers what is occluded has no distance, but an entry. By this score it ranks before the outer ball, which
 * is hit first, in the order of depth behind it. */
static void lists_are_sorted_as_tables_are(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer);
    viewer.cone.angle = 30;
    viewer.cone.options.score = "-proximity";
    viewer_aim_along(&viewer, eye, back);
    for (int way = 0; way < 4; way++) {
        viewer.cone.options.layers = way & 1 ? CONUS_LAYERS_ALL : CONUS_LAYERS_VISIBLE;
        viewer.cone.order = way & 2 ? CONUS_ORDER_DEPTH : CONUS_ORDER_RANK;
        viewer_reselect(&viewer);
        assert_listed_as_in_table(&viewer);
    }
    viewer.cone.one_ray = true; /* has first hits only, whatever the layers */
    viewer_reselect(&viewer);
    assert_listed_as_in_table(&viewer);
    viewer_finish(&viewer);
}

/* Of the tree Ball > Shell > Outer, Inner; Ball > Core, the first hit is in Outer. */
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
    viewer_aim_along(&viewer, eye, back);
    assert_int_equal(question_deepest(&viewer), 3);
    for (unsigned depth = 1; depth <= 4; depth++) {
        question_next_level(&viewer);
        assert_int_equal(question_depth(&viewer), depth % 4);
        uint32_t best = conus_selection_result(viewer_selection(&viewer), 0)->object;
        assert_string_equal(conus_atlas_object(atlas, best)->name, names[depth - 1]);
    }
    assert_true(question_set_level(&viewer, "Shell,Core"));
    assert_int_equal(question_depth(&viewer), 0);
    viewer_finish(&viewer);
}

static void what_cannot_be_asked_changes_nothing(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer);
    viewer_aim_along(&viewer, eye, back);
    assert_true(question_set_range(&viewer, 10, 80));
    size_t count = conus_selection_count(viewer_selection(&viewer));
    assert_false(question_set_range(&viewer, 80, 10));
    assert_non_null(strstr(viewer.message, "range"));
    assert_false(question_set_level(&viewer, "2"));
    assert_non_null(strstr(viewer.message, "no area tree"));
    question_next_level(&viewer);
    assert_non_null(strstr(viewer.message, "no area tree"));
    assert_string_equal(viewer.cone.level, "");
    assert_true(viewer.cone.options.range[0] == 10 && viewer.cone.options.range[1] == 80);
    assert_int_equal(conus_selection_count(viewer_selection(&viewer)), count);
    char level[LEVEL_LIMIT + 1];
    memset(level, 'x', LEVEL_LIMIT);
    level[LEVEL_LIMIT] = '\0';
    assert_false(question_set_level(&viewer, level));
    assert_non_null(strstr(viewer.message, "1024 bytes, allowed are 1023"));
    assert_true(question_move_range(&viewer, -20, -1)); /* no nearer than 0 */
    assert_true(viewer.cone.options.range[0] == 0 && viewer.cone.options.range[1] == 79);
    viewer_finish(&viewer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_are_sorted_as_tables_are),
        cmocka_unit_test(levels_go_round),
        cmocka_unit_test(what_cannot_be_asked_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
