/* SPDX-License-Identifier: BSD-3-Clause */
/* The window's plan without a window: its judgement of the tool, its list, and rows that move the tool.
 *
 * The U of u-shape: an axis from x = 40 along -x at z = 5 passes through one arm at the depths 18 to 28 and through the
 * ball at 35 to 45 (tests/cli/plan.bats). So a needle of radius 1 mm that ends at depth F is in the U by F - 18, at
 * most 10 mm, and has 35 - F - 1 mm of clearance from the ball. */
#include "ui_audit.h"
#include "viewer/model/columns.h"
#include "viewer/model/viewer.h"
#include "viewer/opening/opening.h"
#include "viewer/panes/panes.h"
#include "viewer/session/session.h"

#include "base/look.h"
#include "conus/own.h"
#include "test.h"
#include "window_scene.h"

#include <math.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>

static const double start[3] = {40, 0, 5};
static const double along[3] = {-1, 0, 0};

/* Opens a plan with these options, as the command line or a session has them; [count]. */
static int open_plan(struct viewer *viewer, const char *const *words, size_t count)
{
    const struct view_settings none = {.depth = 0};
    struct worded worded;
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++) {
        json_array_append_new(array, json_string(words[i]));
    }
    int code = worded_parse(&worded, array, &none, false);
    code = code ? code
                : plans_open(viewer, worded.settings.arguments, worded.settings.poses, worded.settings.depth,
                             worded.settings.radius);
    worded_finish(&worded); /* the plan has its own copies */
    json_decref(array);
    return code;
}

static const char *const usual[] = {"--reach=U,length=5", "--avoid=Ball,margin=3", "--radius=1", "--depth=30"};

static void open_usual(struct window *window, struct viewer *viewer)
{
    window_scene_open_phantom(window, viewer, "u-shape");
    assert_int_equal(open_plan(viewer, usual, 4), 0);
    tool_aim_along(viewer, FIRST_TOOL, start, along);
}

static void says(struct viewer *viewer, double depth, const char *text, const char *leeway)
{
    viewer->cone.options.range[1] = depth;
    tool_reselect(viewer);
    const struct plan_verdict *verdict = plans_verdict(viewer);
    assert_string_equal(verdict->text, text);
    assert_string_equal(verdict->leeway, leeway);
    assert_int_equal(verdict->state, strncmp(text, "holds", 5) == 0    ? PLAN_HOLDS
                                     : strncmp(text, "breaks", 6) == 0 ? PLAN_BREAKS
                                                                       : PLAN_UNKNOWN);
}

/* Leeways as in tests/cli/plan.bats: for the reach of 5 mm the d with 10 - 2 d = 5, for the ball its clearance less 3.
 * A measure that has to be at least something is rounded down, so that nothing looks better than it is. */
static void the_tool_is_judged_where_it_is(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_usual(&window, &viewer);
    assert_true(plans_is_on(&viewer));
    says(&viewer, 30, "holds, 4.0 mm to Ball", ", may be off by 1.0 mm");
    says(&viewer, 26, "holds, 8.0 mm to Ball", ", may be off by 2.5 mm");
    says(&viewer, 30.96, "holds, 3.0 mm to Ball", ", may be off by 0.04 mm");
    says(&viewer, 31.02, "breaks: 2.9 of 3 mm to Ball", "");
    says(&viewer, 33.3, "breaks: 0.70 of 3 mm to Ball", "");
    says(&viewer, 36, "breaks: touches Ball", "");
    says(&viewer, 20, "breaks: 2.0 of 5 mm in U", "");
    says(&viewer, 17, "breaks: not in U", "");
    says(&viewer, 0, "no depth yet: F5 sets the tip", "");
    says(&viewer, 30, "holds, 4.0 mm to Ball", ", may be off by 1.0 mm");
    assert_string_equal(plans_verdict(&viewer)->details, "holds: 10.0 mm in U\nholds: 4.0 mm to Ball");
    char line[PLAN_LINE];
    plans_line(line, &viewer, true);
    assert_string_equal(line, "holds, 4.0 mm to Ball, may be off by 1.0 mm");
    viewer.tools[FIRST_TOOL].pointer = POINT_BY_TRACKER;
    viewer.tools[FIRST_TOOL].held = true; /* so the tracked tool may be anywhere */
    plans_line(line, &viewer, false);
    assert_string_equal(line, "held, not tracked: holds, 4.0 mm to Ball");
    viewer.cone.options.radius = 2; /* a thicker needle, which another plan judges */
    says(&viewer, 30, "breaks: 3.0 of 3 mm to Ball", "");
    viewer_finish(&viewer);
}

/* The row of a coil has no depth, and F5 is no way to one: what its cone hits is told. From 18 mm on the U fills the
 * cone of 5 degrees, 0.8 mm to each side, the ball behind it all of it, too (1.6 to 2 mm of 5). The mouse may be a
 * needle. */
static void a_row_without_a_depth_is_no_needle(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_usual(&window, &viewer);
    viewer.cone.options.radius = 0;
    says(&viewer, 0, "no depth yet: F5 sets the tip", "");
    viewer.tools[FIRST_TOOL].pointer = POINT_BY_REPLAY;
    says(&viewer, 0, "100 % of the cone on U, 0 % of the cone on Ball", "");
    assert_string_equal(plans_verdict(&viewer)->details, "lengths and margins are not judged: it has no depth");
    assert_false(plans_has_needle(&viewer));
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    says(&viewer, 0, "100 % of the cone on U, 0 % of the cone on Ball, which lies behind", "");
    says(&viewer, 30, "holds, 5.0 mm to Ball", ", may be off by 2.0 mm"); /* without a radius */
    viewer_finish(&viewer);
}

/* The ball of u-shape at (0, 0, 5), called as the U's name begins, is what a cone from above hits, and the U is not
 * hit. The other atlas, a ball of 24 mm around (0, 0, 0), is hit in its first object, whose number is the U's. */
static void a_coil_is_judged_by_the_objects_of_the_plan(void **state)
{
    static const char table[] = "index\tname\n1\tBall, dented\n2\tBall\n";
    static const char *const names[] = {"u-shape", "nested"};
    struct view_source sources[2];
    struct viewer viewer;
    (void)state;
    test_folder("plans");
    for (size_t i = 0; i < 2; i++) {
        char file[64];
        conus_atlas *atlas = NULL;
        assert_ok(conus_phantom_write(names[i], test_in(""), NULL));
        assert_ok(conus_write_file(test_in("u-shape.tsv"), table, strlen(table)));
        snprintf(file, sizeof file, "%s.nii.gz", names[i]);
        assert_ok(conus_atlas_load(&atlas, test_in(file), NULL));
        sources[i] = (struct view_source){.atlas = atlas, .path = names[i], .name = names[i]};
    }
    assert_ok(viewer_create(&viewer, sources, 2, NULL, NULL, NULL));
    assert_int_equal(open_plan(&viewer, (const char *const[]){"--reach=\"Ball, dented\"", "--avoid=Ball"}, 2), 0);
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){0, 0, 60}, (double[]){0, 0, -1});
    viewer.tools[FIRST_TOOL].pointer = POINT_BY_REPLAY;
    for (size_t drawn = 0; drawn < 2; drawn++) {
        viewer_draw(&viewer, drawn);
        says(&viewer, 0, "0 % of the cone on Ball, dented, 100 % of the cone on Ball", "");
        assert_int_equal(plans_is_in(&viewer, CONUS_CONSTRAINT_REACH, 1), !drawn);
        assert_false(plans_is_in(&viewer, CONUS_CONSTRAINT_REACH, 2));
        assert_false(plans_is_in(&viewer, CONUS_CONSTRAINT_REACH, 99));
    }
    snprintf(viewer.cone.level, sizeof viewer.cone.level, "1");
    says(&viewer, 0, "not judged: the level has areas as one", "");
    viewer_finish(&viewer);
}

static void assert_asked(const struct viewer *viewer, const char *name, bool asks, const char *wanted)
{
    json_t *words = json_pack("[s, s, s, s]", usual[0], usual[1], usual[2], usual[3]);
    json_t *asked = plans_ask(viewer, words, CONUS_CONSTRAINT_AVOID, name, asks);
    char *text = json_dumps(asked, JSON_COMPACT);
    assert_string_equal(text, wanted);
    free(text);
    json_decref(asked);
    json_decref(words);
}

/* What is avoided by a margin keeps it when it is to be avoided once more. */
static void a_margin_is_not_lost(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_usual(&window, &viewer);
    assert_asked(&viewer, "Ball", true,
                 "[\"--reach=U,length=5\",\"--avoid=Ball,margin=3\",\"--radius=1\",\"--depth=30\"]");
    assert_asked(&viewer, "Ball", false, "[\"--reach=U,length=5\",\"--radius=1\",\"--depth=30\"]");
    assert_asked(
        &viewer, "U", true,
        "[\"--reach=U,length=5\",\"--avoid=Ball,margin=3\",\"--radius=1\",\"--depth=30\",\"--avoid=\\\"U\\\"\"]");
    viewer_finish(&viewer);
}

/* Words in another order than the constraints, as a session's and the command line's may be: each is read by itself,
 * and what goes is what is about the area. The ball is also the area of label 2, and is meant by that. */
static void an_avoid_is_known_by_what_it_is_about(void **state)
{
    static const char *const opened[] = {"--avoid=U,margin=1", "--avoid=Ball,margin=3", "--radius=1", "--depth=10"};
    static const char *const cases[][2] = {
        {"[\"--avoid=Ball,margin=3\",\"--avoid=U,margin=1\"]", "[\"--avoid=U,margin=1\"]"},
        {"[\"--avoid=2,margin=3\",\"--avoid=U,margin=1\"]", "[\"--avoid=U,margin=1\"]"},
        {"[\"--avoid=U,margin=1\",\"--avoid=\\\"Ball\\\",share=0.1\"]", "[\"--avoid=U,margin=1\"]"},
        {"[\"--avoid=\\\"ball\\\",margin=3\",\"--avoid=U,margin=1\"]", "[\"--avoid=U,margin=1\"]"},
        {"[\"--avoid=U,Ball,margin=1\"]", "[\"--avoid=U,Ball,margin=1\"]"},
    };
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open_phantom(&window, &viewer, "u-shape");
    assert_int_equal(open_plan(&viewer, opened, 4), 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        json_t *words = json_loads(cases[i][0], 0, NULL);
        json_t *asked = plans_ask(&viewer, words, CONUS_CONSTRAINT_AVOID, "Ball", false);
        char *text = json_dumps(asked, JSON_COMPACT);
        assert_string_equal(text, cases[i][1]);
        free(text);
        json_decref(asked);
        json_decref(words);
    }
    assert_int_equal(open_plan(&viewer, (const char *const[]){"--avoid=2"}, 1), 0);
    assert_true(plans_asks(&viewer, CONUS_CONSTRAINT_AVOID, 2));
    assert_false(plans_asks(&viewer, CONUS_CONSTRAINT_AVOID, 1));
    viewer_finish(&viewer);
}

/* Buttons of the panel of the answer in which a text is. */
static bool panel_offers(struct window *window, const char *label)
{
    assert_true(ui_audit_create(1, 1280, 800));
    ui_audit_begin();
    panel_results(window);
    ui_audit_end();
    const bool offers = ui_audit_place(label) < SIZE_MAX;
    ui_destroy();
    return offers;
}

/* The ball is not in the picture any more: no limit goes silently, also while there is no needle. */
static void a_limit_whose_area_is_gone_says_so(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_usual(&window, &viewer);
    window.screen.scale = 1;
    window.screen.width = 1280;
    window.screen.height = 800;
    screen_divide(&window.screen);
    assert_null(plans_verdict(&viewer)->lost);
    assert_false(panel_offers(&window, "Avoid it no more"));
    viewer_hide(&viewer, 2, true);
    for (int has_needle = 1; has_needle >= 0; has_needle--) {
        assert_non_null(plans_verdict(&viewer)->lost);
        assert_string_equal(plans_verdict(&viewer)->lost->names, "Ball");
        assert_true(panel_offers(&window, "Avoid it no more"));
        tool_clear(&viewer);
    }
    assert_asked(&viewer, "Ball", false, "[\"--reach=U,length=5\",\"--radius=1\",\"--depth=30\"]");
    viewer_hide(&viewer, 2, false);
    assert_null(plans_verdict(&viewer)->lost);
    viewer_finish(&viewer);
}

/* The list, the names and the pictures have one colour for what is to be reached, hit or not; only that has it. */
static void a_target_has_one_colour(void **state)
{
    static const uint8_t green[] = {LOOK_RGB(LOOK_HOLDS)};
    static const uint8_t neutral[] = {LOOK_RGB(LOOK_NOT_HIT)};
    struct viewer viewer;
    struct window window;
    uint8_t rgb[3];
    (void)state;
    open_usual(&window, &viewer);
    assert_int_equal(viewer_rank(&viewer, 1), 1);
    viewer_colour(rgb, &viewer, 1);
    assert_memory_equal(rgb, green, 3);
    assert_memory_equal(outline_looks[OUTLINE_TARGET].rgb, green, 3);
    assert_true(outline_looks[OUTLINE_TARGET].fill > 0.8); /* so what is below does not change its hue */
    viewer_colour(rgb, &viewer, 2);
    assert_memory_equal(rgb, neutral, 3);
    assert_int_equal(open_plan(&viewer, (const char *const[]){"--avoid=U"}, 1), 0);
    viewer_colour(rgb, &viewer, 1);
    assert_true(memcmp(rgb, green, 3) != 0);
    viewer_finish(&viewer);
}

static void assert_headline(struct viewer *viewer, double depth, const char *what, const char *more)
{
    struct headline headline;
    viewer->cone.options.range[1] = depth;
    tool_reselect(viewer);
    headline_find(&headline, viewer);
    assert_string_equal(headline.what, what);
    assert_string_equal(headline.more, more);
}

/* Whatever is done to depths, the sentence is about the target, as far as there is a needle. Without a limit there is a
 * cylinder, which meets the U 18 mm from its start. */
static void the_answer_is_whether_the_target_is_reached(void **state)
{
    static const char *const two[] = {"--reach=U", "--reach=Ball", "--radius=1", "--depth=30"};
    static const char *const clear[] = {"--avoid=Ball,margin=3", "--radius=1", "--depth=30"};
    struct viewer viewer;
    struct window window = {.screen.enlarged = -1};
    char title[TITLE_SIZE];
    (void)state;
    open_usual(&window, &viewer);
    window.viewer = &viewer;
    assert_headline(&viewer, 30, "Reaches U", "4.0 mm from Ball");
    title_write(title, &window);
    assert_non_null(strstr(title, " - Reaches U (hit)"));
    assert_headline(&viewer, 31.02, "Reaches U", "2.9 mm from Ball"); /* and breaks the margin, as the verdict says */
    assert_headline(&viewer, 36, "Reaches U", "touches Ball");
    assert_headline(&viewer, 20, "Does not reach U", "14.0 mm from Ball"); /* 2 of 5 mm */
    assert_headline(&viewer, 17, "Does not reach U", "17.0 mm from Ball");
    assert_headline(&viewer, 0, "U", "100 % of the cylinder \u00b7\u00a018.0 mm from the start");
    assert_int_equal(open_plan(&viewer, two, 4), 0);
    assert_headline(&viewer, 30, "Does not reach Ball", " ");
    assert_headline(&viewer, 40, "Reaches U, Ball", " ");
    assert_int_equal(open_plan(&viewer, clear, 3), 0);
    assert_headline(&viewer, 30, "4.0 mm from Ball", " ");
    assert_headline(&viewer, 36, "Touches Ball", " ");
    viewer_finish(&viewer);
}

/* What is kept is the needle: its verdict, and both ends. Sessions have them, too. */
static void the_needle_is_kept_not_its_first_hit(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_usual(&window, &viewer);
    window.screen.scale = 1;
    window.screen.width = 1280;
    window.screen.height = 800;
    screen_divide(&window.screen);
    assert_true(ui_audit_create(1, 1280, 800));
    ui_audit_begin();
    panel_results(&window);
    ui_audit_end();
    assert_true(ui_audit_place("Keep this needle") < SIZE_MAX && ui_audit_place("Keep U") == SIZE_MAX);
    ui_destroy();
    inputs_confirm(&window.inputs, &viewer, FIRST_TOOL);
    assert_int_equal(viewer.pin_count, 1);
    const struct pin *pin = &viewer.pins[0];
    assert_int_equal(pin->object, 0);
    assert_string_equal(pin->name, "needle: Reaches U, 4.0 mm from Ball");
    assert_string_equal(viewer.message, "kept: needle: Reaches U, 4.0 mm from Ball");
    for (int a = 0; a < 3; a++) {
        assert_near(pin->entry[a], start[a], 1e-9);
        assert_near(pin->contact[a], start[a] + 30 * along[a], 1e-9);
    }
    assert_near(pin->distance, 30, 0);
    char *copied = viewer_pins_text(&viewer);
    assert_non_null(strstr(copied, "needle: Reaches U, 4.0 mm from Ball\tn/a\t30\t10\t0\t5\tn/a\t40\t0\t5\n"));
    free(copied);
    char why[PROPERTY_REASON];
    json_t *saved = session_json(&window);
    viewer.pin_count = 0;
    assert_true(session_read(&window, saved, "kept", why));
    json_decref(saved);
    assert_int_equal(viewer.pin_count, 1);
    assert_near(viewer.pins[0].entry[0], 40, 1e-9);
    assert_string_equal(viewer.pins[0].name, "needle: Reaches U, 4.0 mm from Ball");
    viewer.cone.options.range[1] = 0; /* no needle: the area that is hit */
    tool_reselect(&viewer);
    inputs_confirm(&window.inputs, &viewer, FIRST_TOOL);
    assert_string_equal(viewer.pins[1].name, "U");
    assert_true(isnan(viewer.pins[1].entry[0]));
    viewer_finish(&viewer);
}

static void check_structure(struct viewer *viewer, conus_constraint_kind kind, const char *name, bool u, bool ball)
{
    const char *is = plans_name(viewer, kind);
    bool *wanted = outline_wanted(viewer, kind == CONUS_CONSTRAINT_REACH ? OUTLINE_TARGET : OUTLINE_AVOIDED);
    assert_int_equal(!is, !name);
    assert_int_equal(!wanted, !name);
    if (name) {
        assert_string_equal(is, name);
        assert_int_equal(wanted[1], u);
        assert_int_equal(wanted[2], ball);
    }
    free(wanted);
}

static void the_structures_of_a_plan_are_shown(void **state)
{
    static const char *const both[] = {"--reach=Ball,U", "--radius=1", "--depth=30"};
    struct viewer viewer;
    struct window window;
    (void)state;
    open_usual(&window, &viewer);
    check_structure(&viewer, CONUS_CONSTRAINT_REACH, "U", true, false);
    check_structure(&viewer, CONUS_CONSTRAINT_AVOID, "Ball", false, true);
    tool_clear(&viewer);
    viewer_hide(&viewer, 2, true); /* then there is no such plan */
    check_structure(&viewer, CONUS_CONSTRAINT_AVOID, NULL, false, false);
    viewer_hide(&viewer, 2, false);
    check_structure(&viewer, CONUS_CONSTRAINT_REACH, "U", true, false);
    unsigned number = viewer.plan.number;
    assert_int_equal(open_plan(&viewer, both, 3), 0);
    assert_int_not_equal(viewer.plan.number, number);
    check_structure(&viewer, CONUS_CONSTRAINT_REACH, "Ball, U", true, true);
    check_structure(&viewer, CONUS_CONSTRAINT_AVOID, NULL, false, false);
    viewer_finish(&viewer);
}

static void what_is_not_there_is_not_judged(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_usual(&window, &viewer);
    viewer_hide(&viewer, 2, true); /* the ball, which is no structure any more */
    assert_int_equal(plans_verdict(&viewer)->state, PLAN_FAILED);
    assert_non_null(strstr(plans_verdict(&viewer)->text, "not judged: "));
    viewer_hide(&viewer, 2, false);
    assert_string_equal(plans_verdict(&viewer)->text, "holds, 4.0 mm to Ball");
    tool_clear(&viewer);
    assert_string_equal(plans_verdict(&viewer)->text, "no pose yet: point at the brain");
    assert_false(plans_go(&viewer, 0)); /* there are no candidates */
    viewer_finish(&viewer);
}

/* The needle leans by 45 degrees from (-1, 0, 1), is 30 mm long, and meets the U first. */
static void all_kinds_of_constraints_are_worded(void **state)
{
    static const struct {
        const char *words[2];
        const char *text;
    } cases[] = {
        {{"--lean=-1,0,1,46"}, "holds, 45.0\u00b0 of lean"},
        {{"--lean=-1,0,1,44"}, "breaks: 45.0 of at most 44\u00b0 of lean"},
        {{"--length=10,29"}, "breaks: 30.0 mm long, 10 to 29 asked"},
        {{"--first=U"}, "holds, passes U first"},
        {{"--first=Ball"}, "breaks: does not pass Ball first"},
        {{"--reach=U,tip"}, "breaks: not the tip in U"},
        {{"--reach=U,crossed"}, "holds, through U"},
        {{"--reach=Ball"}, "breaks: not in Ball"},
        {{"--reach=U,share=0.5"}, "holds, 100.0 % of the cone on U"}, /* the arm of the U is wider than the needle */
        {{"--avoid=U,share=0.5"}, "breaks: 100.0 of at most 50 % of the cone on U"},
        {{"--reach=Ball,pierced=0.5"}, "breaks: 0.00 of 50 % of the pixels through Ball"},
        {{"--reach=U,length=11", "--avoid=Ball,margin=9"}, "breaks: 10.0 of 11 mm in U, and 1 more"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct viewer viewer;
        struct window window;
        const char *const words[4] = {"--radius=1", "--depth=30", cases[i].words[0], cases[i].words[1]};
        window_scene_open_phantom(&window, &viewer, "u-shape");
        assert_int_equal(open_plan(&viewer, words, cases[i].words[1] ? 4 : 3), 0);
        tool_aim_along(&viewer, FIRST_TOOL, start, along);
        assert_string_equal(plans_verdict(&viewer)->text, cases[i].text);
        viewer_finish(&viewer);
    }
}

static void unknown_names_are_refused(void **state)
{
    static const char *const words[] = {"--reach=Boll"};
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open_phantom(&window, &viewer, "u-shape");
    assert_int_not_equal(open_plan(&viewer, words, 1), 0);
    viewer_finish(&viewer);
    window_scene_open_phantom(&window, &viewer, "u-shape");
    assert_int_equal(open_plan(&viewer, words, 0), 0); /* no constraint is no plan */
    assert_false(plans_is_on(&viewer));
    viewer_finish(&viewer);
}

/* Waits until the list is there: the thread makes it without being asked again. */
static const struct plan_list *await_list(struct viewer *viewer, const char **why)
{
    do {
        plans_step(viewer);
        sched_yield();
    } while (plans_is_behind(viewer));
    return plans_list(viewer, why);
}

static void open_list(struct window *window, struct viewer *viewer, const char *avoid)
{
    static const char needles[] =
        "query_id\tx\ty\tz\tdx\tdy\tdz\tfar\na\t40\t0\t5\t-1\t0\t0\t30\nb\t40\t0\t5\t-1\t0\t0\t26\n"
        "c\t40\t0\t5\t-1\t0\t0\t36\nd\t40\t0\t5\t-1\t0\t0\t\n";
    char poses[600];
    const char *const words[] = {"--reach=U,length=5", avoid, "--radius=1", "--depth=20", poses};
    window_scene_open_phantom(window, viewer, "u-shape");
    snprintf(poses, sizeof poses, "--poses=%s", test_scratch("needles.tsv"));
    assert_ok(conus_write_file(poses + strlen("--poses="), needles, strlen(needles)));
    assert_int_equal(open_plan(viewer, words, 5), 0);
}

/* b has 8 mm of clearance and a leeway of 2.5 mm, a has 4 and 1 mm; c touches the ball, and d is in the U by 2 mm. */
static void rows_move_the_tool_and_are_taken_back(void **state)
{
    struct viewer viewer;
    struct window window;
    const char *why;
    (void)state;
    open_list(&window, &viewer, "--avoid=Ball,margin=3");
    assert_false(plans_go(&viewer, 0)); /* it is not there yet */
    const struct plan_list *list = await_list(&viewer, &why);
    assert_non_null(list);
    assert_int_equal(list->count, 2);
    assert_string_equal(list->says, "2 of 4 poses hold all constraints");
    assert_string_equal(list->rows[0].id, "b");
    assert_near(list->rows[0].leeway, 2.5, 1e-5);
    assert_near(list->rows[0].clearance, 8, 1e-9);
    assert_string_equal(list->rows[0].nearest, "Ball");
    assert_string_equal(list->rows[1].id, "a");
    assert_int_equal(plans_at(&viewer), SIZE_MAX);
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){0, 0, 80}, (double[]){0, 0, -1});
    viewer.tools[FIRST_TOOL].held = true;
    undo_note(&window);
    viewer.tools[FIRST_TOOL].held = false; /* the mouse points */
    assert_true(plans_go(&viewer, 1));
    undo_note(&window);
    assert_int_equal(plans_at(&viewer), 1);
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[12], 40, 1e-12);
    assert_near(viewer.cone.options.range[1], 30, 1e-12);
    assert_near(viewer.crosshair[0], 10, 1e-9); /* its tip */
    assert_true(viewer.tools[FIRST_TOOL].held);
    assert_string_equal(plans_verdict(&viewer)->text, "holds, 4.0 mm to Ball");
    assert_false(plans_go(&viewer, 2));
    assert_false(plans_is_behind(&viewer)); /* its depth is not that of other candidates */
    undo_step(&window, -1);
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[14], 80, 1e-12);
    assert_near(viewer.cone.options.range[1], 20, 1e-12);
    undo_step(&window, 1);
    assert_int_equal(plans_at(&viewer), 1);
    changes_finish(&window.history.changes);
    viewer_finish(&viewer);
}

static void without_a_feasible_pose_the_nearest_misses_are_listed(void **state)
{
    struct viewer viewer;
    struct window window;
    const char *why;
    (void)state;
    open_list(&window, &viewer, "--avoid=Ball,margin=9");
    const struct plan_list *list = await_list(&viewer, &why);
    assert_non_null(list);
    assert_string_equal(list->says, "0 of 4 poses hold all constraints; the nearest misses:");
    assert_int_equal(list->count, 2);
    assert_string_equal(list->rows[0].nearest, "breaks U"); /* d, by 3 mm */
    assert_true(isnan(list->rows[0].clearance));
    assert_string_equal(list->rows[1].id, "b"); /* by 1 mm */
    assert_near(list->rows[1].clearance, 8, 1e-9);
    assert_true(plans_go(&viewer, 1));
    assert_string_equal(plans_verdict(&viewer)->text, "breaks: 8.0 of 9 mm to Ball");
    viewer_finish(&viewer);
}

/* Whoever has the window alone is told what it can do, and no option of the command line. */
static void without_a_list_the_next_step_is_told(void **state)
{
    static const char *const wanted[2][2][2] = {/* by target, and by points: words that are there */
                                                {{"Set as target", "Ctrl+O"}, {"Set as target", "in Points"}},
                                                {{"aim by hand", "Ctrl+O"}, {"aim by hand", "in Points"}}};
    struct viewer viewer;
    struct window window;
    const char *why;
    (void)state;
    window_scene_open_phantom(&window, &viewer, "u-shape");
    for (size_t target = 0; target < 2; target++) {
        assert_int_equal(open_plan(&viewer, usual, target ? 4 : 0), 0);
        for (size_t points = 0; points < 2; points++) {
            viewer.points.count = points;
            assert_null(plans_list(&viewer, &why));
            assert_false(plans_go(&viewer, 0));
            assert_string_equal(viewer.message, why);
            assert_null(strstr(why, "--"));
            assert_int_equal(strstr(why, "no target yet") == why, !target);
            assert_non_null(strstr(why, wanted[target][points][0]));
            assert_non_null(strstr(why, wanted[target][points][1]));
        }
    }
    viewer.points.count = 0;
    viewer_finish(&viewer);
}

/* A change of the atlas ends a run; the list is made again for the new atlas. */
static void a_list_follows_the_atlas_and_the_radius(void **state)
{
    struct viewer viewer;
    struct window window;
    const char *why;
    (void)state;
    open_list(&window, &viewer, "--avoid=Ball,margin=3");
    plans_step(&viewer);
    viewer_hide(&viewer, 2, true);
    assert_null(await_list(&viewer, &why));
    assert_int_not_equal(why[0], '\0');
    viewer_hide(&viewer, 2, false);
    assert_int_equal(await_list(&viewer, &why)->count, 2);
    viewer.cone.options.radius = 2.5; /* a has 2.5 mm of clearance, which is not more than 3 */
    assert_true(plans_is_behind(&viewer));
    assert_int_equal(await_list(&viewer, &why)->count, 1);
    viewer_finish(&viewer);
}

/* Before the tool has a pose all is neutral, with a plan also where the colours of the file are wanted. */
static void before_the_first_pose_nothing_has_a_colour(void **state)
{
    static const uint8_t neutral[] = {LOOK_RGB(LOOK_NOT_HIT)};
    struct viewer viewer;
    struct window window;
    uint8_t rgb[3];
    (void)state;
    window_scene_open_phantom(&window, &viewer, "u-shape");
    viewer_colour(rgb, &viewer, 1);
    assert_memory_equal(rgb, neutral, 3);
    assert_non_null(viewer_pictured(&viewer));
    viewer.display.own_colours = true;
    viewer_colour(rgb, &viewer, 1);
    assert_memory_equal(rgb, conus_atlas_object(viewer.drawn->atlas, 1)->rgb, 3);
    assert_null(viewer_pictured(&viewer));
    assert_int_equal(open_plan(&viewer, usual, 4), 0);
    viewer.drawn->shown.chosen = 1;
    assert_int_equal(viewer_full(&viewer), 0);
    viewer.display.own_colours = false;
    viewer_colour(rgb, &viewer, 2); /* 1 is the target */
    assert_memory_equal(rgb, neutral, 3);
    const conus_selection *nothing = answer_selection(viewer_pictured(&viewer));
    assert_int_equal(conus_selection_count(nothing), 1);
    assert_int_equal(conus_selection_result(nothing, 0)->object, 0);
    assert_null(viewer_selection(&viewer)); /* of which there is no answer */
    viewer_hide(&viewer, 1, true);          /* another atlas, for which it is made anew */
    assert_int_equal(conus_selection_count(answer_selection(viewer_pictured(&viewer))), 1);
    tool_aim_along(&viewer, FIRST_TOOL, start, along);
    assert_ptr_equal(answer_selection(viewer_pictured(&viewer)), viewer_selection(&viewer));
    viewer_finish(&viewer);
}

TEST_GROUP(plans)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(before_the_first_pose_nothing_has_a_colour),
        cmocka_unit_test(the_tool_is_judged_where_it_is),
        cmocka_unit_test(a_row_without_a_depth_is_no_needle),
        cmocka_unit_test(a_coil_is_judged_by_the_objects_of_the_plan),
        cmocka_unit_test(a_margin_is_not_lost),
        cmocka_unit_test(an_avoid_is_known_by_what_it_is_about),
        cmocka_unit_test(a_limit_whose_area_is_gone_says_so),
        cmocka_unit_test(a_target_has_one_colour),
        cmocka_unit_test(the_answer_is_whether_the_target_is_reached),
        cmocka_unit_test(the_needle_is_kept_not_its_first_hit),
        cmocka_unit_test(the_structures_of_a_plan_are_shown),
        cmocka_unit_test(what_is_not_there_is_not_judged),
        cmocka_unit_test(all_kinds_of_constraints_are_worded),
        cmocka_unit_test(unknown_names_are_refused),
        cmocka_unit_test(rows_move_the_tool_and_are_taken_back),
        cmocka_unit_test(without_a_feasible_pose_the_nearest_misses_are_listed),
        cmocka_unit_test(without_a_list_the_next_step_is_told),
        cmocka_unit_test(a_list_follows_the_atlas_and_the_radius),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
