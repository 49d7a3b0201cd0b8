/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of points: loaded, chosen from, kept by sessions, in the phantom of balls of 8, 16 and 24 mm around 0. */
#include "viewer/commands/commands.h"
#include "viewer/model/columns.h"
#include "viewer/model/viewer.h"
#include "viewer/panes/panes.h"
#include "viewer/session/session.h"
#include "viewer/tools/tools.h"

#include "options/messages.h"
#include "settings/settings.h"
#include "test.h"
#include "viewer/model/additions.h"
#include "window_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char points_text[] = "name,x,y,z\nA1,0,0,0\nA2,20,0,0\nA3,40,0,0\nA4,oops,0,0\nA5,-50,0,0\n";
static const char poses_text[] = "name,x,y,z,tx,ty,tz\nB1,-50,0,0,0,0,0\nB2,0,60,0,0,0,0\n";

struct list_scene {
    struct window window;
    struct viewer viewer;
    struct named_atlas named;
    struct atlases atlases;
};

/* Gives 0, and the viewer the list, or says why not by the exit code. */
static int use_list(struct list_scene *scene, const char *text)
{
    static const struct common_settings quiet = {.quiet = true};
    struct point_list list = {0};
    const char *path = test_scratch("list.csv");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    int code = points_load(&list, path, &scene->atlases, &scene->viewer.frame, 0, &quiet, 0);
    assert_int_equal(!code, list.count > 0);
    if (!code) {
        points_use(&scene->viewer, &list);
    }
    return code;
}

static void open_list(struct list_scene *out)
{
    window_scene_open(&out->window, &out->viewer);
    out->window.viewer = &out->viewer;
    out->named = (struct named_atlas){.atlas = out->viewer.atlases->atlas, .given = "nested"};
    out->atlases = (struct atlases){.items = &out->named, .count = 1};
    assert_int_equal(use_list(out, points_text), 0);
}

static const char *best_of(const struct viewer *viewer)
{
    const conus_result *best = conus_selection_result(viewer_selection(viewer), 0);
    return best && best->object ? conus_atlas_object(viewer->atlases->atlas, best->object)->name : "";
}

static void rows_are_balls_and_a_row_with_an_error_is_none(void **state)
{
    struct list_scene scene;
    (void)state;
    open_list(&scene);
    const struct point_list *list = &scene.viewer.points;
    assert_int_equal(list->count, 4);
    assert_int_equal(list->rows[3], 5);
    assert_string_equal(list->points[1].name, "A2");
    assert_true(isnan(list->points[1].end[0]));
    assert_near(list->points[3].at[0], -50, 1e-9);
    assert_true(list->has_electrodes);
    assert_string_equal(list->points[3].group, "A");
    assert_int_equal(use_list(&scene, poses_text), 0);
    assert_int_equal(list->count, 2);
    assert_near(list->points[0].end[0], -24, 1e-9); /* where its axis meets the outer ball */
    viewer_finish(&scene.viewer);
}

static void a_chosen_point_is_asked_about(void **state)
{
    static const struct {
        uint32_t row;
        const char *best;
        const char *more;
        double distance;
    } wanted[] = {{1, "Core", "at the point", 0},
                  {2, "Shell outer", "at the point", 0},
                  {3, "Shell outer", "nearest to the point \u00b7\u00a016.0 mm from it", 16}};
    struct list_scene scene;
    (void)state;
    open_list(&scene);
    struct viewer *viewer = &scene.viewer;
    assert_null(points_chosen(viewer));
    for (size_t i = 0; i < 3; i++) {
        struct headline headline;
        points_choose(viewer, wanted[i].row);
        headline_find(&headline, viewer);
        assert_string_equal(best_of(viewer), wanted[i].best);
        assert_string_equal(headline.what, wanted[i].best);
        assert_string_equal(headline.more, wanted[i].more);
        assert_near(conus_selection_result(viewer_selection(viewer), 0)->distance, wanted[i].distance, 1e-6);
        assert_ptr_equal(points_chosen(viewer), &viewer->points.points[wanted[i].row - 1]);
        assert_near(viewer->crosshair[0], viewer->points.points[wanted[i].row - 1].at[0], 1e-9);
        assert_false(tool_has_cone(viewer, FIRST_TOOL)); /* nor a needle, nor a sweep */
        viewer->study.settings.kind = STUDY_SWEEP;
        assert_false(studies_is_on(viewer));
    }
    points_choose(viewer, 4); /* it has an error: all stays */
    assert_int_equal(viewer->chosen_point, 3);
    assert_non_null(strstr(viewer->message, "line 5"));
    points_choose(viewer, 0);
    assert_null(viewer_selection(viewer));
    assert_int_equal(viewer->tools[FIRST_TOOL].pointer, POINT_BY_MOUSE);
    viewer_finish(&scene.viewer);
}

/* A ball of 10 mm around 0 has the core's 2176 voxels, and 2048 of the inner shell. */
static void a_point_with_a_radius_is_a_ball(void **state)
{
    struct list_scene scene;
    struct headline headline;
    (void)state;
    open_list(&scene);
    scene.viewer.cone.options.radius = 10;
    scene.viewer.cone.options.range[1] = 30; /* which a ball has not */
    points_choose(&scene.viewer, 1);
    assert_near(conus_selection_result(viewer_selection(&scene.viewer), 0)->share, 2176.0 / 4224, 1e-9);
    assert_near(conus_selection_result(viewer_selection(&scene.viewer), 1)->share, 2048.0 / 4224, 1e-9);
    headline_find(&headline, &scene.viewer);
    assert_non_null(strstr(headline.more, "% of the ball"));
    viewer_finish(&scene.viewer);
}

static void a_chosen_pose_is_a_cone(void **state)
{
    struct list_scene scene;
    (void)state;
    open_list(&scene);
    points_choose(&scene.viewer, 1);
    assert_int_equal(use_list(&scene, poses_text), 0);
    assert_null(points_chosen(&scene.viewer));
    assert_int_equal(scene.viewer.tools[FIRST_TOOL].pointer, POINT_BY_MOUSE);
    points_choose(&scene.viewer, 1);
    assert_true(tool_has_cone(&scene.viewer, FIRST_TOOL));
    assert_string_equal(best_of(&scene.viewer), "Shell outer");
    assert_near(conus_selection_result(viewer_selection(&scene.viewer), 0)->distance, 26, 0.5);
    tool_clear(&scene.viewer); /* Escape */
    assert_null(points_chosen(&scene.viewer));
    viewer_finish(&scene.viewer);
}

static void a_session_keeps_what_is_chosen(void **state)
{
    struct list_scene scene;
    char why[PROPERTY_REASON];
    (void)state;
    open_list(&scene);
    points_choose(&scene.viewer, 2);
    json_t *session = session_json(&scene.window);
    points_choose(&scene.viewer, 5);
    assert_true(session_read(&scene.window, session, "session", why));
    assert_int_equal(scene.viewer.chosen_point, 2);
    assert_true(scene.viewer.tools[FIRST_TOOL].is_point);
    assert_string_equal(best_of(&scene.viewer), "Shell outer");
    assert_int_equal(use_list(&scene, "name,x,y,z\nA1,0,0,0\nA2,0,20,0\n"), 0); /* row 2 is another place now */
    assert_true(session_read(&scene.window, session, "session", why));
    assert_int_equal(scene.viewer.chosen_point, 0);
    assert_near(scene.viewer.tools[FIRST_TOOL].pose.world_from_device[12], 20, 0);
    json_decref(session);
    viewer_finish(&scene.viewer);
}

static void lists_that_cannot_be_drawn_are_refused(void **state)
{
    struct list_scene scene;
    (void)state;
    open_list(&scene);
    points_choose(&scene.viewer, 1);
    assert_int_not_equal(use_list(&scene, "name,x,y,z\n"), 0);
    assert_int_not_equal(use_list(&scene, "name,x,y,z\nA,oops,0,0\n"), 0);
    assert_int_not_equal(use_list(&scene, "nonsense"), 0);
    assert_int_equal(scene.viewer.chosen_point, 1); /* the list from before is still there */
    assert_int_equal(use_list(&scene, "name,x,y,z\nC1,0,0,0\n"), 0);
    assert_int_equal(scene.viewer.points.count, 1); /* it has another name at the same place */
    assert_null(points_chosen(&scene.viewer));
    viewer_finish(&scene.viewer);
}

static void a_list_takes_the_place_of_another_one(void **state)
{
    (void)state;
    json_t *words = json_pack("[s, s, s]", "--pose=a.csv", "--context=c.nii", "--pathway=p.nii");
    json_t *with = additions_with(words, ADD_POSE, "b.csv");
    assert_int_equal(json_array_size(with), 3);
    assert_string_equal(json_string_value(json_array_get(with, 0)), "--context=c.nii");
    assert_string_equal(json_string_value(json_array_get(with, 2)), "--pose=b.csv");
    json_decref(words);
    json_decref(with);
}

static size_t count_hits(const struct viewer *viewer)
{
    const conus_result *result;
    size_t count = 0;
    for (size_t i = 0; (result = conus_selection_result(viewer_selection(viewer), i)); i++) {
        count += result->object > 0;
    }
    return count;
}

/* From x = -50 the largest ball begins at 26 mm, the middle one at 34: a needle of 30 mm ends before that, and what is
 * drawn is what is asked. The next row has no end, and the mouse has none after it. */
static void a_needle_of_a_list_ends(void **state)
{
    static const char text[] = "name,x,y,z,dx,dy,dz,far\nN1,-50,0,0,1,0,0,30\nN2,-50,0,0,1,0,0,n/a\n";
    struct list_scene scene;
    (void)state;
    open_list(&scene);
    assert_int_equal(use_list(&scene, text), 0);
    scene.viewer.cone.options.radius = 1;
    scene.viewer.cone.options.layers = CONUS_LAYERS_ALL;
    points_choose(&scene.viewer, 1);
    assert_near(scene.viewer.cone.options.range[1], 30, 0);
    assert_int_equal(count_hits(&scene.viewer), 1);
    points_choose(&scene.viewer, 2);
    assert_near(scene.viewer.cone.options.range[1], 0, 0);
    assert_int_equal(count_hits(&scene.viewer), 3);
    points_choose(&scene.viewer, 1);
    points_choose(&scene.viewer, 0);
    assert_near(scene.viewer.cone.options.range[1], 0, 0);
    scene.viewer.cone.options.sampling = CONUS_SAMPLING_SLICES; /* which have no depths, as conus query says */
    points_choose(&scene.viewer, 1);
    assert_int_equal(scene.viewer.chosen_point, 0);
    assert_non_null(strstr(scene.viewer.message, "needs exact sampling"));
    scene.viewer.cone.options.layers = CONUS_LAYERS_VISIBLE;
    points_choose(&scene.viewer, 2);
    assert_int_equal(scene.viewer.chosen_point, 2);
    viewer_finish(&scene.viewer);
}

/* A list that is loaded again, as after a file was added, keeps the row where the tool is, with the depths that the
 * list has now: 36 mm from x = -50 are 2 mm behind where the middle ball begins. A row that has turned, is wider, or is
 * another one in its place, is not what was asked, and leaves the mouse without its depths. */
static void a_row_stays_where_the_list_still_has_it(void **state)
{
    static const char kept[] = "name,x,y,z,dx,dy,dz,far\nN1,-50,0,0,1,0,0,30\nN2,-50,0,9,1,0,0,36\n";
    static const struct {
        const char *text;
        uint32_t row;
        double far;
        size_t hits;
    } wanted[] = {{kept, 1, 30, 1},
                  {"name,x,y,z,dx,dy,dz,far\nN1,-50,0,0,1,0,0,36\n", 1, 36, 2},
                  {"name,x,y,z,dx,dy,dz\nN1,-50,0,0,1,0,0\n", 1, 0, 3},
                  {"name,x,y,z,dx,dy,dz,far\nN1,-50,0,0,0,1,0,30\n", 0, 0, 3},
                  {"name,x,y,z,dx,dy,dz,far,angle\nN1,-50,0,0,1,0,0,30,9\n", 0, 0, 3},
                  {"name,x,y,z,dx,dy,dz,far\nN0,-50,0,9,1,0,0,36\nN1,-50,0,0,1,0,0,30\n", 0, 0, 3},
                  {"name,x,y,z\nN1,-50,0,0\n", 0, 0, 3}};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        struct list_scene scene;
        struct viewer *viewer = &scene.viewer;
        open_list(&scene);
        assert_int_equal(use_list(&scene, kept), 0);
        viewer->cone.options.radius = 1;
        viewer->cone.options.layers = CONUS_LAYERS_ALL;
        points_choose(viewer, 1);
        viewer_cross(viewer, (double[]){1, 2, 3});
        assert_int_equal(use_list(&scene, wanted[i].text), 0);
        assert_int_equal(viewer->chosen_point, wanted[i].row);
        assert_int_equal(viewer->tools[FIRST_TOOL].pointer, wanted[i].row ? POINT_BY_REPLAY : POINT_BY_MOUSE);
        assert_near(viewer->cone.options.range[1], wanted[i].far, 0);
        assert_int_equal(count_hits(viewer), wanted[i].hits);
        assert_near(viewer->crosshair[2], 3, 0);
        viewer_finish(viewer);
    }
    (void)state;
}

/* Depths that were set by hand for a row are no list's: 26 to 34 mm from x = -50 are the largest ball alone. They stay
 * when the list is loaded again, with its row or without, and the next row that is chosen has its own. */
static void depths_set_by_hand_stay(void **state)
{
    static const char kept[] = "name,x,y,z,dx,dy,dz,far\nN1,-50,0,0,1,0,0,90\nN2,-50,0,9,1,0,0,36\n";
    static const char *const others[] = {kept, "name,x,y,z,dx,dy,dz,far\nN1,-50,0,0,1,0,0,36\n",
                                         "name,x,y,z,dx,dy,dz,far\nN1,-50,0,0,0,1,0,30\n"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        struct list_scene scene;
        struct viewer *viewer = &scene.viewer;
        open_list(&scene);
        assert_int_equal(use_list(&scene, kept), 0);
        viewer->cone.options.radius = 1;
        viewer->cone.options.layers = CONUS_LAYERS_ALL;
        points_choose(viewer, 1);
        assert_int_equal(count_hits(viewer), 3);
        assert_true(query_set_range(viewer, 20, 33));
        assert_int_equal(use_list(&scene, others[i]), 0);
        assert_int_equal(viewer->chosen_point, i < 2);
        assert_near(viewer->cone.options.range[0], 20, 0);
        assert_near(viewer->cone.options.range[1], 33, 0);
        assert_int_equal(count_hits(viewer), 1);
        points_choose(viewer, 1);
        assert_near(viewer->cone.options.range[0], 0, 0);
        assert_near(viewer->cone.options.range[1], i == 0 ? 90 : i == 1 ? 36 : 30, 0);
        viewer_finish(viewer);
    }
    (void)state;
}

/* A needle from x = -50 to 10 along the x axis. Sagittal cuts show its line alone: where it crosses them, and up to 2
 * mm before its tip; the axial cut of 40 mm around 0 has it from its left edge on. */
static void a_needle_is_chosen_by_its_line(void **state)
{
    static const char text[] = "name,x,y,z,dx,dy,dz,far\nN1,-50,0,0,1,0,0,60\nN2,-50,40,40,1,0,0,60\n";
    static const struct {
        double centre[3], right[3], up[3], mm_per_pixel;
        float at[2];
        uint32_t row;
    } clicks[] = {{{-10, 0, 0}, {0, -1, 0}, {0, 0, 1}, 0.5, {203, 146}, 1},
                  {{-10, 0, 0}, {0, -1, 0}, {0, 0, 1}, 0.5, {220, 150}, 0},
                  {{-10, 0, 0}, {0, -1, 0}, {0, 0, 1}, 0.5, {120, 70}, 2},
                  {{11.5, 0, 0}, {0, -1, 0}, {0, 0, 1}, 0.5, {200, 150}, 1},
                  {{12.5, 0, 0}, {0, -1, 0}, {0, 0, 1}, 0.5, {200, 150}, 0},
                  {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.2, {102, 150}, 1},
                  {{0, 0, 2.5}, {1, 0, 0}, {0, 1, 0}, 0.2, {102, 150}, 0}};
    struct list_scene scene;
    (void)state;
    open_list(&scene);
    scene.window.screen.scale = 1;
    assert_int_equal(use_list(&scene, text), 0);
    for (size_t i = 0; i < sizeof clicks / sizeof *clicks; i++) {
        struct pane_plane plane = {.box = {100, 50, 200, 200}, .view.mm_per_pixel = clicks[i].mm_per_pixel};
        memcpy(plane.view.centre, clicks[i].centre, sizeof plane.view.centre);
        memcpy(plane.view.right, clicks[i].right, sizeof plane.view.right);
        memcpy(plane.view.up, clicks[i].up, sizeof plane.view.up);
        points_choose(&scene.viewer, 0);
        assert_int_equal(pane_points_choose(&scene.window, clicks[i].at, &plane), clicks[i].row > 0);
        assert_int_equal(scene.viewer.chosen_point, clicks[i].row);
    }
    viewer_finish(&scene.viewer);
}

static void escape_leaves_the_row_and_its_depths(void **state)
{
    static const char text[] = "name,x,y,z,dx,dy,dz,far\nN1,-50,0,0,1,0,0,30\n";
    struct list_scene scene;
    (void)state;
    open_list(&scene);
    assert_int_equal(use_list(&scene, text), 0);
    points_choose(&scene.viewer, 1);
    scene.window.press = keys_press;
    assert_true(window_press(&scene.window, "escape"));
    assert_int_equal(scene.viewer.chosen_point, 0);
    assert_int_equal(scene.viewer.tools[FIRST_TOOL].pointer, POINT_BY_MOUSE);
    assert_false(scene.viewer.tools[FIRST_TOOL].has_pose);
    assert_near(scene.viewer.cone.options.range[1], 0, 0);
    viewer_finish(&scene.viewer);
}

/* Undo goes from row to row, each with its own depth, and back to a mouse that has none. */
static void undo_goes_from_needle_to_needle(void **state)
{
    static const char text[] = "name,x,y,z,dx,dy,dz,far\nN1,-50,0,0,1,0,0,30\nN2,-50,0,9,1,0,0,36\n";
    static const double far[] = {0, 30, 36}, height[] = {0, 0, 9};
    static const struct {
        int by;
        uint32_t row;
    } steps[] = {{-1, 1}, {-1, 0}, {1, 1}, {1, 2}, {-1, 1}};
    struct list_scene scene;
    struct viewer *viewer = &scene.viewer;
    (void)state;
    open_list(&scene);
    assert_int_equal(use_list(&scene, text), 0);
    undo_note(&scene.window);
    for (uint32_t row = 1; row <= 2; row++) {
        points_choose(viewer, row);
        undo_note(&scene.window);
    }
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        const uint32_t row = steps[i].row;
        undo_step(&scene.window, steps[i].by);
        assert_int_equal(viewer->chosen_point, row);
        assert_near(viewer->cone.options.range[1], far[row], 0);
        assert_true(!row || viewer->tools[FIRST_TOOL].pose.world_from_device[14] == height[row]);
    }
    changes_finish(&scene.window.history.changes);
    viewer_finish(viewer);
}

TEST_GROUP(point_list)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_balls_and_a_row_with_an_error_is_none),
        cmocka_unit_test(a_chosen_point_is_asked_about),
        cmocka_unit_test(a_point_with_a_radius_is_a_ball),
        cmocka_unit_test(a_chosen_pose_is_a_cone),
        cmocka_unit_test(a_session_keeps_what_is_chosen),
        cmocka_unit_test(lists_that_cannot_be_drawn_are_refused),
        cmocka_unit_test(a_needle_of_a_list_ends),
        cmocka_unit_test(a_row_stays_where_the_list_still_has_it),
        cmocka_unit_test(depths_set_by_hand_stay),
        cmocka_unit_test(a_needle_is_chosen_by_its_line),
        cmocka_unit_test(escape_leaves_the_row_and_its_depths),
        cmocka_unit_test(undo_goes_from_needle_to_needle),
        cmocka_unit_test(a_list_takes_the_place_of_another_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
