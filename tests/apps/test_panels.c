/* SPDX-License-Identifier: BSD-3-Clause */
/* Which texts the panel of hits has, and in which order, without a screen. */
#include "options/messages.h"
#include "options/progress.h"
#include "ui_audit.h"
#include "viewer/commands/commands.h"
#include "viewer/panes/panes.h"
#include "viewer/tools/tools.h"

#include "builders/area_rows.h"
#include "conus/own.h"
#include "test.h"
#include "window_scene.h"

#include <arpa/inet.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static void lay_out(struct window *window)
{
    window->screen.scale = 1;
    window->screen.width = 1280;
    window->screen.height = 800;
    screen_divide(&window->screen);
    assert_true(ui_audit_create(1, 1280, 800));
}

static void draw(struct window *window)
{
    ui_audit_begin();
    panel_results(window);
    ui_audit_end();
}

static bool has(const char *text)
{
    return ui_audit_place(text) < SIZE_MAX;
}

static void a_cylinder_has_a_radius_and_no_opening(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    lay_out(&window);
    draw(&window);
    assert_true(has("Opening") && !has("Radius"));
    assert_true(script_do(&window, (char *[]){"angle", "7"}, 2));
    assert_string_equal(viewer.message, "");
    viewer.cone.options.radius = 2;
    tool_reselect(&viewer);
    draw(&window);
    assert_true(has("Radius") && !has("Opening"));
    assert_true(script_do(&window, (char *[]){"angle", "9"}, 2));
    assert_string_equal(viewer.message, "the tool is a cylinder of 2 mm radius: its opening does not count");
    assert_near(viewer.tools[FIRST_TOOL].angle, 9, 0); /* it does again with a cone */
    ui_destroy();
    viewer_finish(&viewer);
}

/* What comes and goes stands below what is pressed, in a tab: of a second tool, too. */
static void the_card_stands_below_all_else(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    lay_out(&window);
    for (int second = 0; second < 2; second++) {
        viewer.tools[SECOND_TOOL].on = second;
        viewer.drawn->shown.chosen = 0;
        draw(&window);
        size_t last = ui_audit_count() - 1; /* a line says that nothing is chosen */
        assert_false(has("Label"));
        viewer.drawn->shown.chosen = 1;
        draw(&window);
        assert_true(ui_audit_place("Label") >= last && has("Label"));
        assert_true(ui_audit_place("Second tool") < last && ui_audit_place("Search") < last);
    }
    ui_destroy();
    viewer_finish(&viewer);
}

/* Nothing that the answer says moves what is asked, nor the tabs. */
static void what_is_pressed_stays_where_it_is(void **state)
{
    struct viewer viewer;
    struct window window;
    float places[2];
    (void)state;
    window_scene_open(&window, &viewer);
    lay_out(&window);
    draw(&window);
    assert_true(ui_audit_at(places, "Opening"));
    const float asked = places[1];
    assert_true(ui_audit_at(places, "Keep answer"));
    const float keeps = places[1];
    assert_true(ui_audit_at(places, "How sure?"));
    const float tab = places[1];
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    viewer.cone.options.range[1] = 70; /* a line above the answer says so */
    tool_reselect(&viewer);
    viewer_choose(&viewer, 1);
    tool_confirm(&viewer, FIRST_TOOL);
    viewer.tools[SECOND_TOOL].on = true;
    draw(&window);
    draw(&window);
    assert_true(has("only depths from 0 to 70 mm count"));
    assert_true(ui_audit_at(places, "Opening") && places[1] == asked);
    assert_true(ui_audit_at(places, "Keep answer") && places[1] == keeps);
    assert_true(ui_audit_at(places, "How sure?") && places[1] == tab);
    ui_destroy();
    viewer_finish(&viewer);
}

/* A second tool that is switched on shows its tab; a kept answer does not take another one away. */
static void a_tab_comes_to_the_front_when_it_is_switched_on(void **state)
{
    enum { AREA = 0, SURE = 3, SECOND = 7 };
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    lay_out(&window);
    draw(&window);
    assert_int_equal(window.screen.tabs.shown, AREA);
    viewer.study.settings.kind = STUDY_SWEEP;
    draw(&window);
    assert_int_equal(window.screen.tabs.shown, SURE);
    viewer.tools[SECOND_TOOL].on = true;
    draw(&window);
    assert_int_equal(window.screen.tabs.shown, SECOND);
    window.screen.tabs.shown = SURE;
    tool_confirm(&viewer, FIRST_TOOL);
    draw(&window);
    assert_int_equal(window.screen.tabs.shown, SURE);
    assert_true(has(viewer.pin_count ? "Kept 1" : "Kept"));
    ui_destroy();
    viewer_finish(&viewer);
}

static void an_exchanged_atlas_is_exchanged_and_has_no_side(void **state)
{
    static const char line[] = "Names or places have left and right exchanged";
    (void)state;
    for (int is_exchanged = 0; is_exchanged < 2; is_exchanged++) {
        struct viewer viewer;
        struct window window = {.viewer = &viewer, .screen.enlarged = -1};
        conus_atlas *atlas = NULL;
        assert_ok(area_rows_pairs(&atlas, is_exchanged));
        assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = "six"}, 1, NULL, NULL, NULL));
        viewer_choose(&viewer, 1);
        lay_out(&window);
        draw(&window);
        assert_int_equal(has(line), is_exchanged);
        assert_int_equal(has("Side"), !is_exchanged);
        ui_destroy();
        viewer_finish(&viewer);
    }
}

/* Of areas and a pathway: names come from the label table alone. */
static void an_atlas_whose_areas_have_no_names_says_so(void **state)
{
    static const struct area_row tables[3][2] = {{{.label = 0}}, {{.label = 7, .name = "Insula"}}, {{.label = 0}}};
    static const size_t dim[] = {2, 1, 1};
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        const bool has_areas = i < 2;
        struct viewer viewer;
        struct window window = {.viewer = &viewer, .screen.enlarged = -1};
        conus_atlas *atlas = NULL;
        assert_ok(area_rows_atlas(&atlas, dim, (const uint32_t[]){6 * has_areas, 7 * has_areas}, tables[i]));
        assert_ok(area_rows_add_pathway(atlas, "Tract"));
        assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = "two"}, 1, NULL, NULL, NULL));
        lay_out(&window);
        draw(&window);
        assert_int_equal(has("Areas have numbers in place of names"), i == 0);
        ui_destroy();
        viewer_finish(&viewer);
    }
}

/* Beside fibres surfaces are drawn, and areas of voxels are not: only these are said to be left out, while they are not
 * hidden. */
static void what_is_drawn_is_not_said_to_be_left_out(void **state)
{
    static const struct area_row table[] = {{.label = 6, .name = "Insula"}, {.label = 7, .name = "Putamen"}};
    (void)state;
    for (int is_surfaces = 0; is_surfaces < 2; is_surfaces++) {
        struct viewer viewer;
        struct window window = {.viewer = &viewer, .screen.enlarged = -1};
        char path[600];
        conus_atlas *atlas = NULL;
        snprintf(path, sizeof path, "%s/brain.atlas.json", test_scratch("phantom"));
        if (is_surfaces) {
            assert_ok(conus_phantom_write("brain", test_scratch("phantom"), NULL));
            assert_ok(conus_atlas_load(&atlas, path, NULL));
        } else {
            assert_ok(area_rows_atlas(&atlas, (const size_t[]){2, 1, 1}, (const uint32_t[]){6, 7}, table));
            assert_ok(area_rows_add_pathway(atlas, "Tract"));
        }
        assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = path}, 1, NULL, NULL, NULL));
        lay_out(&window);
        for (uint32_t hidden = 0; hidden <= 2; hidden++) {
            if (hidden) {
                viewer_hide(&viewer, hidden, true);
            }
            ui_audit_begin();
            panel_views(&window);
            ui_audit_end();
            assert_int_equal(has("Areas as glass"), !is_surfaces && hidden < 2);
        }
        ui_destroy();
        viewer_finish(&viewer);
    }
}

/* What was said on stderr stands beside the answer, but for what is there in short already. */
static void warnings_of_the_program_stand_beside_the_answer(void **state)
{
    static const char other[] = "the two do not overlap: are they in one space?";
    struct viewer viewer;
    struct window window = {.viewer = &viewer, .screen.enlarged = -1};
    conus_atlas *atlas = NULL;
    (void)state;
    assert_ok(area_rows_pairs(&atlas, true));
    say_warning("%s", other);
    say_warning("six: %s; more", conus_atlas_exchanged(atlas));
    say_note(CONUS_SEVERITY_NOTE, false, "its spaces are two");
    say_note(CONUS_SEVERITY_NOTE, false, "its spaces are two");
    say_note(CONUS_SEVERITY_NOTE, true, "nobody wants to know");
    assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = "six"}, 1, NULL, NULL, NULL));
    lay_out(&window);
    draw(&window);
    assert_true(has("Warning: the two do not overlap: are they in one space?"));
    assert_true(has("Names or places have left and right exchanged"));
    assert_true(has("Note: its spaces are two"));
    struct panel_warning warning;
    size_t count = 0;
    for (size_t i = 0; panel_warning(&warning, &i, &viewer);) {
        count++;
    }
    assert_int_equal(count, 3);
    warnings_forget(0);
    draw(&window);
    assert_false(has("Warning: the two do not overlap: are they in one space?"));
    assert_false(has("Note: its spaces are two"));
    ui_destroy();
    viewer_finish(&viewer);
}

/* A needle begins at the surface, since its depths are told from there: no other word is lit, and none that does
 * nothing is offered. */
static void the_start_that_is_lit_is_the_start(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    window.viewer = &viewer;
    window.screen.enlarged = -1;
    lay_out(&window);
    assert_int_equal(viewer.cone.start, START_BEFORE);
    for (int has_end = 0; has_end < 2; has_end++) {
        viewer.cone.options.range[1] = 30 * has_end;
        draw(&window);
        assert_int_equal(point_start(&viewer), has_end ? START_SURFACE : START_BEFORE);
        assert_int_equal(has("in front"), !has_end);
        assert_true(has("surface") && has("eye"));
    }
    ui_destroy();
    viewer_finish(&viewer);
}

/* Without panels names are read from the back of a room: capital letters, at least 0.7 of the height of a font, have
 * 1/60 of the picture's height. */
static void names_fill_a_projector(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    window.viewer = &viewer;
    window.screen.scale = 1;
    window.screen.enlarged = -1;
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){0, 60, 0}, (double[]){0, -1, 0});
    for (int bare = 0; bare < 2; bare++) {
        size_t names = 0;
        window.screen.bare = bare;
        window.screen.width = 2560;
        window.screen.height = 1440;
        screen_divide(&window.screen);
        assert_true(ui_audit_create(1, 2560, 1440));
        ui_audit_begin();
        pane_3d(&window);
        ui_audit_end();
        const struct labels *labels = &window.frame.labels;
        for (size_t i = 0; i < labels->count; i++) {
            names += labels->items[i].object > 0;
            assert_true(!bare || !labels->items[i].object || labels->items[i].box.height >= labels->high);
        }
        assert_int_equal(names, 1);
        assert_int_equal(0.7F * labels->high >= window.screen.panes[PANE_3D].height / 60, bare);
        ui_destroy();
    }
    viewer_finish(&viewer);
}

/* The phantom's labels as the values of a pathway: the largest one is 4000000001. */
static void a_threshold_has_its_part_of_the_largest_value(void **state)
{
    const conus_pathway_options pathway = {.name = "Tract", .threshold = 1e9};
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    char *file = strdup(viewer.drawn->path);
    viewer_finish(&viewer);
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, file, NULL));
    assert_ok(conus_atlas_add_pathway(atlas, file, &pathway));
    assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = file}, 1, NULL, NULL, NULL));
    window = (struct window){.viewer = &viewer, .screen.enlarged = -1};
    lay_out(&window);
    draw(&window);
    assert_true(has("25 % of its largest value"));
    ui_destroy();
    viewer_finish(&viewer);
    free(file);
}

/* The typed address stays, and its field, whether it is none or nobody answers there: a port that is kept from others
 * and not listened to. */
static void an_address_that_is_refused_stays_in_its_field(void **state)
{
    struct sockaddr_in place = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t length = sizeof place;
    const int kept = socket(AF_INET, SOCK_STREAM, 0);
    struct viewer viewer;
    struct window window;
    char address[32];
    char line[96];
    (void)state;
    window_scene_open(&window, &viewer);
    devices_init(&window.inputs.devices);
    viewer.tools[FIRST_TOOL].pointer = POINT_BY_TRACKER;
    lay_out(&window);
    draw(&window);
    assert_true(has("host:port") && has("Connect") && !has("Disconnect"));
    assert_false(script_do(&window, (char *[]){"tracker", "here:there"}, 2));
    draw(&window);
    assert_string_equal(window.inputs.address, "here:there");
    assert_non_null(strstr(viewer.message, "\"here:there\" is no address and port"));
    assert_true(has("host:port") && !has("Disconnect"));
    assert_int_equal(bind(kept, (struct sockaddr *)&place, sizeof place), 0);
    assert_int_equal(getsockname(kept, (struct sockaddr *)&place, &length), 0);
    snprintf(address, sizeof address, "127.0.0.1:%u", ntohs(place.sin_port));
    assert_true(script_do(&window, (char *[]){"tracker", address}, 2));
    while (!window.inputs.update.trouble) {
        inputs_step(&window.inputs, &viewer, 1e-3 * clock_ms());
    }
    draw(&window);
    snprintf(line, sizeof line, "no answer yet from 127.0.0.1 on port %u: Connection refused", ntohs(place.sin_port));
    assert_true(has(line));
    assert_string_equal(window.inputs.address, address);
    assert_true(has("host:port") && has("Connect") && has("Disconnect"));
    station_stop(window.inputs.station);
    close(kept);
    ui_destroy();
    viewer_finish(&viewer);
}

TEST_GROUP(panels)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cylinder_has_a_radius_and_no_opening),
        cmocka_unit_test(the_card_stands_below_all_else),
        cmocka_unit_test(what_is_pressed_stays_where_it_is),
        cmocka_unit_test(a_tab_comes_to_the_front_when_it_is_switched_on),
        cmocka_unit_test(an_exchanged_atlas_is_exchanged_and_has_no_side),
        cmocka_unit_test(warnings_of_the_program_stand_beside_the_answer),
        cmocka_unit_test(the_start_that_is_lit_is_the_start),
        cmocka_unit_test(names_fill_a_projector),
        cmocka_unit_test(an_atlas_whose_areas_have_no_names_says_so),
        cmocka_unit_test(what_is_drawn_is_not_said_to_be_left_out),
        cmocka_unit_test(an_address_that_is_refused_stays_in_its_field),
        cmocka_unit_test(a_threshold_has_its_part_of_the_largest_value),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
