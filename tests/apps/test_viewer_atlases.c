/* SPDX-License-Identifier: BSD-3-Clause */
/* Several atlases in the window, without a window: all answer the same queries, one of them is drawn. */
#include "viewer/model/viewer.h"
#include "viewer/opening/opening.h"
#include "viewer/session/session.h"
#include "viewer/window/window.h"

#include "conus/own.h"
#include "session_words.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double eye[3] = {0, 90, 0};
static const double back[3] = {0, -1, 0};

static uint32_t best_of(const struct view_atlas *on)
{
    return conus_selection_result(view_atlas_selection(on, FIRST_TOOL), 0)->object;
}

static conus_atlas *load(const char *kind)
{
    char name[64];
    conus_atlas *atlas = NULL;
    test_folder("phantom");
    snprintf(name, sizeof name, "%s.nii.gz", kind);
    if (access(test_in(name), F_OK)) { /* once */
        assert_ok(conus_phantom_write(kind, test_in(""), NULL));
    }
    assert_ok(conus_atlas_load(&atlas, test_in(name), NULL));
    return atlas;
}

/* Balls of 24, 16 and 8 mm one in the other, and two slabs, in the same space. */
static void load_two(struct viewer *out)
{
    const struct view_source sources[] = {{load("nested"), "nested.nii.gz", "nested"},
                                          {load("slabs"), "slabs.nii.gz", "slabs"}};
    assert_ok(viewer_create(out, sources, 2, NULL, NULL, NULL));
}

/* The table of a selection with every digit; the caller frees it. */
static char *table_of(const conus_selector *selector, const conus_selection *selection)
{
    const conus_report_options options = {.format = "tsv"};
    conus_report *report = NULL;
    const char *text;
    size_t size;
    assert_ok(conus_report_create(&report, selector, &options));
    assert_ok(conus_report_add(report, "1", selection));
    assert_ok(conus_report_text(&text, &size, report));
    char *copy = strdup(text);
    conus_report_destroy(report);
    return copy;
}

/* Compares with conus query's way: a new selector for each question. */
static void assert_answers(const struct viewer *viewer, size_t index)
{
    const struct view_atlas *on = &viewer->atlases[index];
    conus_selector *selector = NULL;
    conus_selection *answer = NULL;
    assert_ok(conus_selector_create(&selector, on->atlas, &viewer->cone.options));
    assert_ok(conus_select(&answer, selector, &viewer->tools[FIRST_TOOL].pose,
                           viewer->cone.options.radius > 0 ? 0 : viewer->tools[FIRST_TOOL].angle));
    char *wanted = table_of(selector, answer);
    char *shown = table_of(on->selector, view_atlas_selection(on, FIRST_TOOL));
    assert_string_equal(shown, wanted);
    free(wanted);
    free(shown);
    conus_selection_destroy(answer);
    conus_selector_destroy(selector);
}

static void assert_all_answer(const struct viewer *viewer)
{
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        assert_answers(viewer, i);
    }
}

/* All atlases answer, whatever moves or changes the cone, and whichever of them is drawn. */
static void all_atlases_are_asked_the_same(void **state)
{
    struct viewer viewer;
    (void)state;
    load_two(&viewer);
    assert_null(view_atlas_selection(&viewer.atlases[1], FIRST_TOOL));
    for (int i = 0; i < 8; i++) {
        const double from[3] = {70 * cos(i), 70 * sin(i), 9 * i - 30};
        const double to[3] = {-from[0] + i, -from[1], -from[2]};
        viewer.tools[FIRST_TOOL].angle = 4 + 3 * i;
        viewer.cone.options.layers = i % 2 ? CONUS_LAYERS_ALL : CONUS_LAYERS_VISIBLE;
        viewer.cone.options.score = i % 3 ? NULL : "nearness";
        tool_aim_along(&viewer, FIRST_TOOL, from, to);
        assert_all_answer(&viewer);
        viewer_draw(&viewer, (size_t)i / 4);
        assert_ptr_equal(viewer_selection(&viewer), view_atlas_selection(&viewer.atlases[i / 4], FIRST_TOOL));
        viewer.tools[FIRST_TOOL].angle *= 2;
        tool_reselect(&viewer);
        assert_all_answer(&viewer);
    }
    viewer_finish(&viewer);
}

/* Each row differs from the one before in one option, for which the selectors have to be made again. */
static void each_option_alone_changes_the_answers(void **state)
{
    static const conus_selector_options changes[] = {
        {0},
        {.score = "nearness"},
        {.score = "nearness", .layers = CONUS_LAYERS_ALL},
        {.layers = CONUS_LAYERS_ALL},
        {.layers = CONUS_LAYERS_ALL, .resolution = 24},
        {.layers = CONUS_LAYERS_ALL, .resolution = 24, .aperture = CONUS_APERTURE_SQUARE},
        {.layers = CONUS_LAYERS_ALL, .resolution = 24, .range = {70, 90}},
        {.layers = CONUS_LAYERS_ALL, .resolution = 24, .range = {80, 90}},
        {.layers = CONUS_LAYERS_ALL, .resolution = 24, .range = {80, 85}},
        {.layers = CONUS_LAYERS_ALL, .resolution = 24, .range = {80, 85}, .radius = 4},
        {.layers = CONUS_LAYERS_ALL, .resolution = 24, .range = {80, 85}, .radius = 6},
        {.resolution = 24},
        {.resolution = 24, .sampling = CONUS_SAMPLING_SLICES},
        {.resolution = 24, .sampling = CONUS_SAMPLING_SLICES, .slice_fraction = 0.05}};
    struct viewer viewer;
    char *before = NULL;
    (void)state;
    load_two(&viewer);
    viewer.tools[FIRST_TOOL].angle = 30;
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){3, 90, 20}, (double[]){0, -1, -0.1});
    for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++) {
        viewer.cone.options = changes[i];
        tool_reselect(&viewer);
        assert_all_answer(&viewer);
        char *now = viewer_results_text(&viewer);
        assert_true(!before || strcmp(before, now) != 0);
        free(before);
        before = now;
    }
    free(before);
    viewer_finish(&viewer);
}

/* Each atlas has its own hidden, chosen and confirmed areas; the colours are common to all. */
static void hiding_and_confirming_apply_to_the_drawn_atlas(void **state)
{
    struct viewer viewer;
    (void)state;
    load_two(&viewer);
    viewer.tools[FIRST_TOOL].angle = 2;
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    const uint32_t slab = best_of(&viewer.atlases[1]);
    viewer_hide(&viewer, 1, true);
    tool_confirm(&viewer, FIRST_TOOL);
    unsigned answer = viewer.tools[FIRST_TOOL].answer_number;
    unsigned scene = viewer.scene_number;
    unsigned atlas = viewer.atlas_number;
    viewer_draw(&viewer, 1);
    assert_true(viewer.tools[FIRST_TOOL].answer_number != answer && viewer.scene_number != scene &&
                viewer.atlas_number != atlas);
    assert_ptr_equal(viewer.drawn, &viewer.atlases[1]);
    assert_int_equal(best_of(viewer.drawn), slab);
    assert_int_equal(viewer_shown(&viewer, slab), SHOWN);
    tool_confirm(&viewer, FIRST_TOOL);
    viewer_hide(&viewer, slab, true);
    assert_true(best_of(viewer.drawn) != slab);
    assert_int_equal(best_of(&viewer.atlases[0]), 2);
    assert_all_answer(&viewer);
    viewer_hide(&viewer, slab, false);
    assert_int_equal(best_of(viewer.drawn), slab);
    assert_int_equal(viewer.pin_count, 2);
    assert_int_equal(viewer.pins[0].object, 2);
    char *text = viewer_pins_text(&viewer);
    assert_memory_equal(text, "atlas\tname\tshare\t", 17);
    assert_non_null(strstr(text, "\nnested\tShell "));
    assert_non_null(strstr(text, "\nslabs\tSlab "));
    free(text);
    viewer_draw(&viewer, 0);
    assert_int_equal(viewer_shown(&viewer, 1), SHOWN_NOT);
    viewer_finish(&viewer);
}

static void colours_are_those_of_all_atlases(void **state)
{
    struct viewer viewer;
    uint8_t own[2][3];
    (void)state;
    load_two(&viewer);
    for (size_t i = 0; i < 2; i++) {
        memcpy(own[i], conus_atlas_object(viewer.atlases[i].atlas, 1)->rgb, 3);
    }
    viewer_use_safe_colours(&viewer, true);
    viewer_draw(&viewer, 1);
    assert_memory_not_equal(own[0], conus_atlas_object(viewer.atlases[0].atlas, 1)->rgb, 3);
    assert_memory_not_equal(own[1], conus_atlas_object(viewer.atlases[1].atlas, 1)->rgb, 3);
    viewer_use_safe_colours(&viewer, false);
    assert_memory_equal(own[0], conus_atlas_object(viewer.atlases[0].atlas, 1)->rgb, 3);
    assert_memory_equal(own[1], conus_atlas_object(viewer.atlases[1].atlas, 1)->rgb, 3);
    viewer_finish(&viewer);
}

/* An atlas that cannot answer shows nothing, not even its last answer. A cone of 180 degrees is invalid. */
static void no_answer_outlives_its_question(void **state)
{
    struct viewer viewer;
    (void)state;
    load_two(&viewer);
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    unsigned before = viewer.tools[FIRST_TOOL].answer_number;
    viewer.tools[FIRST_TOOL].angle = 180;
    tool_reselect(&viewer);
    assert_null(view_atlas_selection(&viewer.atlases[0], FIRST_TOOL));
    assert_null(view_atlas_selection(&viewer.atlases[1], FIRST_TOOL));
    assert_true(viewer.tools[FIRST_TOOL].answer_number != before);
    assert_memory_equal(viewer.message, "slabs: ", 7); /* the atlas that was asked last */
    viewer.tools[FIRST_TOOL].angle = 10;
    tool_reselect(&viewer);
    assert_all_answer(&viewer);
    viewer_finish(&viewer);
}

/* The object at a place: the innermost ball in the middle, the outermost 20 mm to the left (it is from 16 to 24 mm),
 * none outside. A ray from 90 mm before the balls meets the outermost, of 24 mm, after 66 mm, to a voxel. */
static void places_have_a_name_in_each_atlas(void **state)
{
    struct viewer viewer;
    double depth;
    (void)state;
    load_two(&viewer);
    assert_int_equal(view_atlas_at(&viewer.atlases[0], (double[]){0, 0, 0}), 3);
    assert_int_equal(view_atlas_at(&viewer.atlases[0], (double[]){-20, 0, 0}), 1);
    assert_int_equal(view_atlas_at(&viewer.atlases[0], (double[]){-30, 0, 0}), 0);
    assert_int_equal(view_atlas_at(&viewer.atlases[0], (double[]){-1e6, 0, 0}), 0);
    assert_int_equal(view_atlas_pick(&depth, &viewer.atlases[0], eye, back), 1);
    assert_near(depth, 66, 1);
    assert_int_equal(view_atlas_pick(&depth, &viewer.atlases[0], eye, (double[]){0, 1, 0}), 0);
    assert_true(isinf(depth));
    viewer_hide(&viewer, 1, true);
    assert_int_equal(view_atlas_at(&viewer.atlases[0], (double[]){-20, 0, 0}), 0);
    assert_int_equal(view_atlas_pick(&depth, &viewer.atlases[0], eye, back), 2);
    assert_near(depth, 74, 1);
    viewer_finish(&viewer);
}

/* The mouse is in 3-D, on the ray of `eye`: the first voxels of the ball and of the anterior slab begin at y = 24 and
 * 12. */
static void point(struct window *window)
{
    struct hover *hover = &window->frame.hover;
    *hover = (struct hover){.by_ray = true, .value = NAN};
    memcpy(hover->eye, eye, sizeof eye);
    memcpy(hover->direction, back, sizeof back);
    hover->has_place = viewer_pick(&hover->object, hover->at, window->viewer, eye, back, INFINITY);
    assert_true(hover->has_place);
}

/* The crosshair at y = -9 is in the middle of the posterior slab, and 9 mm from the middle of the balls of 24, 16 and 8
 * mm; at x = 20 there is no slab. In a cut the mouse is at a place, not on a ray. */
static void names_of_all_atlases_are_said(void **state)
{
    struct viewer viewer;
    struct window window = {.viewer = &viewer};
    char text[HOVER_TEXT];
    (void)state;
    load_two(&viewer);
    viewer_cross(&viewer, (double[]){0.5, -9.5, 0.5});
    hover_text(text, &window, "; ");
    assert_string_equal(text, "nested: Shell inner; slabs: Slab posterior");
    viewer_cross(&viewer, (double[]){20.5, 0, 0.5});
    hover_text(text, &window, "\n");
    assert_string_equal(text, "nested: Shell outer\nslabs: -");
    point(&window);
    hover_text(text, &window, "; ");
    assert_string_equal(text, "nested: Shell outer; slabs: Slab anterior (12.0 mm deeper)");
    window.frame.hover = (struct hover){.object = 2, .has_place = true, .at = {0.5, 9.5, 0.5}, .value = NAN};
    hover_text(text, &window, "; ");
    assert_string_equal(text, "nested: Shell inner; slabs: Slab anterior");
    viewer_draw(&viewer, 1);
    point(&window);
    hover_text(text, &window, "; ");
    assert_string_equal(text, "nested: Shell outer (12.0 mm nearer); slabs: Slab anterior");
    viewer_finish(&viewer);
}

/* The rows of all atlases are one table, with a column for the atlas. An atlas that could not answer has a row that
 * says so. */
static void all_answers_are_one_table(void **state)
{
    struct viewer viewer;
    (void)state;
    load_two(&viewer);
    char *text = viewer_results_text(&viewer);
    assert_ptr_equal(strchr(text, '\n'), text + strlen(text) - 1); /* the header */
    free(text);
    viewer.tools[FIRST_TOOL].angle = 30;
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    text = viewer_results_text(&viewer);
    assert_memory_equal(text, "query\tatlas\tkind\t", 17);
    const char *first = strstr(text, "\n1\tnested\tarea\t1\tShell outer\t");
    const char *second = strstr(text, "\n1\tslabs\tarea\t1\tSlab anterior\t");
    assert_true(first && second && first < second);
    char *path = strdup(test_scratch("all.tsv"));
    char written[8192] = "";
    assert_ok(viewer_write_results(&viewer, FIRST_TOOL, path));
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_int_equal(fread(written, 1, sizeof written, file), strlen(text));
    fclose(file);
    assert_string_equal(written, text);
    free(path);
    free(text);
    view_atlas_forget(&viewer.atlases[0], FIRST_TOOL);
    text = viewer_results_text(&viewer);
    assert_non_null(strstr(text, "\n1\tnested\terror\tn/a\tthere is no answer\t"));
    assert_non_null(strstr(text, "\n1\tslabs\tarea\t1\tSlab anterior\t"));
    free(text);
    viewer_finish(&viewer);
}

/* Loads `more` besides `first`, both files of the folder of phantoms. */
static bool load_besides(struct atlases *out, const char *first, const char *more, const char *context,
                         char why[LOADER_WHY])
{
    char paths[3][600];
    const char *further = paths[1];
    const struct atlas_settings settings = {.more = {&further, 1}};
    const char *files[] = {paths[2]};
    const struct context_choice choice = {.files = {files, context ? 1 : 0}};
    const struct loading what = {.path = paths[0], .settings = &settings, .context = &choice};
    struct loader *loader = NULL;
    snprintf(paths[0], sizeof paths[0], "%s", test_in(first));
    snprintf(paths[1], sizeof paths[1], "%s", test_in(more));
    snprintf(paths[2], sizeof paths[2], "%s", test_in(context ? context : ""));
    assert_true(loader_start(&loader, &what));
    return loader_finish(loader, out, why);
}

/* The name of the file of the context that is drawn around an atlas; "" = none. */
static const char *context_of(const struct atlases *atlases, size_t index)
{
    const struct view_atlas on = {.atlas = atlases->items[index].atlas};
    const conus_volume_info *info = conus_atlas_volume(on.atlas, view_atlas_context(&on));
    return info ? strrchr(info->path, '/') + 1 : "";
}

/* Each atlas is drawn with a context: its own, otherwise that of --context or of the first atlas. */
static void all_atlases_have_a_context(void **state)
{
    static const char own[] = "{\"conus_atlas\": 1, \"parcellation\": {\"file\": \"slabs.nii.gz\"},"
                              " \"context\": {\"file\": \"nested.nii.gz\"}}";
    static const struct {
        const char *first, *more, *context, *wanted[2];
    } cases[] = {
        {"nested.nii.gz", "slabs.nii.gz", NULL, {"", ""}},
        {"nested.nii.gz", "slabs.nii.gz", "sphere.nii.gz", {"sphere.nii.gz", "sphere.nii.gz"}},
        {"own.atlas.json", "sphere.nii.gz", NULL, {"nested.nii.gz", "nested.nii.gz"}},
        {"own.atlas.json", "sphere.nii.gz", "sphere.nii.gz", {"sphere.nii.gz", "sphere.nii.gz"}},
        {"sphere.nii.gz", "own.atlas.json", "sphere.nii.gz", {"sphere.nii.gz", "nested.nii.gz"}},
        {"sphere.nii.gz", "own.atlas.json", NULL, {"", "nested.nii.gz"}},
    };
    char why[LOADER_WHY];
    (void)state;
    conus_atlas_destroy(load("nested"));
    conus_atlas_destroy(load("slabs"));
    conus_atlas_destroy(load("sphere"));
    assert_ok(conus_write_file(test_in("own.atlas.json"), own, strlen(own)));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct atlases atlases = {0};
        assert_true(load_besides(&atlases, cases[i].first, cases[i].more, cases[i].context, why));
        assert_int_equal(atlases.count, 2);
        assert_string_equal(context_of(&atlases, 0), cases[i].wanted[0]);
        assert_string_equal(context_of(&atlases, 1), cases[i].wanted[1]);
        atlases_finish(&atlases);
    }
}

static void one_that_cannot_be_loaded_is_named(void **state)
{
    struct atlases atlases = {0};
    char why[LOADER_WHY] = "";
    (void)state;
    conus_atlas_destroy(load("nested"));
    assert_false(load_besides(&atlases, "nested.nii.gz", "absent.nii.gz", NULL, why));
    assert_non_null(strstr(why, "absent.nii.gz"));
    assert_int_equal(atlases.count, 0);
    assert_false(load_besides(&atlases, "nested.nii.gz", "nested.nii.gz", "absent.nii.gz", why));
    assert_non_null(strstr(why, "absent.nii.gz"));
}

/* A ball, and its own voxels as a pathway. */
static conus_atlas *load_pathway(void)
{
    const conus_pathway_options pathway = {.name = "Tract", .threshold = 0.5};
    conus_atlas *atlas = load("sphere");
    assert_ok(conus_atlas_add_pathway(atlas, test_in("sphere.nii.gz"), &pathway));
    return atlas;
}

/* Three atlases, the last two with a pathway. */
static void load_three(struct viewer *out)
{
    const struct view_source sources[] = {{load("nested"), "nested.nii.gz", "nested"},
                                          {load_pathway(), "sphere.nii.gz", "sphere"},
                                          {load_pathway(), "sphere.nii.gz", "sphere-2"}};
    assert_ok(viewer_create(out, sources, 3, NULL, NULL, NULL));
}

static void confirm_and_hide(struct viewer *viewer, size_t atlas)
{
    viewer_draw(viewer, atlas);
    tool_confirm(viewer, FIRST_TOOL);
    viewer_hide(viewer, 1, true);
}

static void a_session_has_all_atlases(void **state)
{
    struct viewer viewer;
    struct window window = {.screen.enlarged = -1, .viewer = &viewer};
    char why[PROPERTY_REASON];
    (void)state;
    load_three(&viewer);
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    char *fresh = session_text(&window);
    confirm_and_hide(&viewer, 0);
    viewer_choose(&viewer, 3);
    confirm_and_hide(&viewer, 2);
    viewer_choose(&viewer, 2);
    viewer_draw(&viewer, 1);
    viewer_set_threshold(&viewer, 2, 0.75);
    char *left = session_text(&window);
    assert_true(session_parse(&window, fresh, strlen(fresh), why));
    char *again = session_text(&window);
    assert_string_equal(again, fresh);
    assert_int_equal(viewer.atlases[0].shown.chosen, 0);
    assert_true(view_atlas_pathway(&viewer.atlases[1], 2)->threshold == 0.5);
    assert_true(session_parse(&window, left, strlen(left), why));
    free(again);
    again = session_text(&window);
    assert_string_equal(again, left);
    assert_ptr_equal(viewer.drawn, &viewer.atlases[1]);
    assert_true(conus_atlas_is_hidden(viewer.atlases[0].atlas, 1) && conus_atlas_is_hidden(viewer.atlases[2].atlas, 1));
    assert_false(conus_atlas_is_hidden(viewer.atlases[1].atlas, 1));
    assert_true(view_atlas_pathway(&viewer.atlases[1], 2)->threshold == 0.75);
    assert_true(view_atlas_pathway(&viewer.atlases[2], 2)->threshold == 0.5);
    assert_int_equal(viewer.pin_count, 2);
    assert_int_equal(viewer.pins[0].atlas, 0);
    assert_int_equal(viewer.pins[1].atlas, 2);
    assert_string_equal(viewer.pins[1].name, "Sphere");
    assert_int_equal(viewer.atlases[0].shown.chosen, 3);
    assert_int_equal(viewer.atlases[1].shown.chosen, 0);
    assert_int_equal(viewer.atlases[2].shown.chosen, 2);
    assert_all_answer(&viewer);
    free(again);
    free(left);
    free(fresh);
    viewer_finish(&viewer);
}

/* @p text with the first @p old replaced; the caller frees it. */
static char *replaced(const char *text, const char *old, const char *by)
{
    const char *at = strstr(text, old);
    char *out = malloc(strlen(text) + strlen(by) + 1);
    assert_true(at && out);
    snprintf(out, strlen(text) + strlen(by) + 1, "%.*s%s%s", (int)(at - text), text, by, at + strlen(old));
    return out;
}

/* A session that does not fit is refused with the reason, and changes nothing. */
static void a_session_that_does_not_fit_changes_no_atlas(void **state)
{
    static const struct {
        const char *old, *by, *why;
    } cases[] = {
        {"\"drawn\": 2", "\"drawn\": 4", "drawn: a number from 1 to 3"},
        {"\"drawn\": 2", "\"drawn\": 0", "drawn: a number from 1 to 3"},
        {"\"drawn\": 2", "\"drawn\": \"2\"", "drawn: a number from 1 to 3"},
        {"\"further_atlases\": [", "\"further_atlases\": [{},", "further_atlases: a list of 2 is needed"},
        {"\"further_atlases\"", "\"further_atlases\": 5, \"x\"", "further_atlases: a list of 2 is needed"},
        {"\"objects\": 2", "\"objects\": 7", "of an atlas with 7 areas and pathways, sphere has 2"},
        {"\"objects\": 3", "\"objects\": 2", "of an atlas with 2 areas and pathways, this one has 3"},
        {"\"threshold\": 0.75", "\"threshold\": 2", "thresholds: Tract: a number from 0 to 1"},
        {"\"pathway\": \"Tract\"", "\"pathway\": \"Arc\"", "that of \"Tract\" is needed, not of \"Arc\""},
    };
    struct viewer viewer;
    struct window window = {.screen.enlarged = -1, .viewer = &viewer};
    char why[PROPERTY_REASON];
    (void)state;
    load_three(&viewer);
    char *before = session_text(&window);
    confirm_and_hide(&viewer, 0);
    viewer_draw(&viewer, 1);
    viewer_set_threshold(&viewer, 2, 0.75);
    char *other = session_text(&window);
    assert_true(session_parse(&window, before, strlen(before), why));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *text = replaced(other, cases[i].old, cases[i].by);
        assert_false(session_parse(&window, text, strlen(text), why));
        assert_non_null(strstr(why, cases[i].why));
        char *after = session_text(&window);
        assert_string_equal(after, before);
        free(after);
        free(text);
    }
    free(other);
    free(before);
    viewer_finish(&viewer);
}

/* A threshold that is no number cannot be set; those of the atlases before it are restored. */
static void thresholds_of_all_atlases_are_set_or_none(void **state)
{
    struct viewer viewer;
    double second[3] = {0, 0, 0.75};
    double third[3] = {0, 0, NAN};
    const struct atlas_edits edits = {.thresholds = (double *[]){NULL, second, third}};
    (void)state;
    load_three(&viewer);
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    assert_fails(viewer_set_up(&viewer, &edits), CONUS_ERROR_ARGUMENT);
    assert_true(view_atlas_pathway(&viewer.atlases[1], 2)->threshold == 0.5);
    assert_true(view_atlas_pathway(&viewer.atlases[2], 2)->threshold == 0.5);
    assert_all_answer(&viewer);
    third[2] = 0.25;
    assert_ok(viewer_set_up(&viewer, &edits));
    assert_true(view_atlas_pathway(&viewer.atlases[1], 2)->threshold == 0.75);
    assert_true(view_atlas_pathway(&viewer.atlases[2], 2)->threshold == 0.25);
    assert_all_answer(&viewer);
    viewer_finish(&viewer);
}

/* JSON cannot hold the path: no session is written, rather than one without that atlas. */
static void a_path_that_is_not_utf8_makes_no_session(void **state)
{
    struct viewer viewer;
    struct window window = {.screen.enlarged = -1, .viewer = &viewer};
    const struct view_source sources[] = {{load("nested"), "nested.nii.gz", "nested"},
                                          {load("slabs"), "\xff.nii.gz", "?"}};
    (void)state;
    assert_ok(viewer_create(&viewer, sources, 2, NULL, NULL, NULL));
    assert_null(session_text(&window));
    viewer_finish(&viewer);
}

/* A session of one atlas leaves all further atlases as they are. */
static void a_session_of_one_atlas_is_that_of_the_first(void **state)
{
    struct viewer one;
    struct viewer two;
    struct window window = {.screen.enlarged = -1, .viewer = &one};
    const struct view_source source = {load("nested"), "nested.nii.gz", NULL};
    char why[PROPERTY_REASON];
    (void)state;
    assert_ok(viewer_create(&one, &source, 1, NULL, NULL, NULL));
    tool_aim_along(&one, FIRST_TOOL, eye, back);
    confirm_and_hide(&one, 0);
    char *text = session_text(&window);
    assert_null(strstr(text, "drawn"));
    assert_null(strstr(text, "further"));
    load_two(&two);
    window.viewer = &two;
    viewer_draw(&two, 1);
    viewer_hide(&two, 2, true);
    assert_true(session_parse(&window, text, strlen(text), why));
    assert_ptr_equal(two.drawn, &two.atlases[1]);
    assert_true(two.atlases[0].shown.hidden[1] && two.atlases[1].shown.hidden[2]);
    assert_string_equal(two.pins[0].name, one.pins[0].name);
    assert_all_answer(&two);
    free(text);
    viewer_finish(&one);
    viewer_finish(&two);
}

TEST_GROUP(viewer_atlases)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_atlases_are_asked_the_same),
        cmocka_unit_test(each_option_alone_changes_the_answers),
        cmocka_unit_test(hiding_and_confirming_apply_to_the_drawn_atlas),
        cmocka_unit_test(colours_are_those_of_all_atlases),
        cmocka_unit_test(no_answer_outlives_its_question),
        cmocka_unit_test(places_have_a_name_in_each_atlas),
        cmocka_unit_test(names_of_all_atlases_are_said),
        cmocka_unit_test(all_answers_are_one_table),
        cmocka_unit_test(all_atlases_have_a_context),
        cmocka_unit_test(one_that_cannot_be_loaded_is_named),
        cmocka_unit_test(a_session_has_all_atlases),
        cmocka_unit_test(a_session_that_does_not_fit_changes_no_atlas),
        cmocka_unit_test(thresholds_of_all_atlases_are_set_or_none),
        cmocka_unit_test(a_path_that_is_not_utf8_makes_no_session),
        cmocka_unit_test(a_session_of_one_atlas_is_that_of_the_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
