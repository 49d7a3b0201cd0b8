/* SPDX-License-Identifier: BSD-3-Clause */
/* The window's texts can be read: contrast of its colours, and no text cut off, at usual sizes of window. */
#include "ui_audit.h"
#include "viewer/commands/commands.h"
#include "viewer/model/columns.h"
#include "viewer/model/viewer.h"
#include "viewer/opening/opening.h"
#include "viewer/panes/panes.h"

#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Contrasts of WCAG 2.2, success criterion 1.4.3 (level AA): texts; 1.4.11: marks that say something. */
#define LEAST_CONTRAST 4.5
#define LEAST_MARK_CONTRAST 3.0

/* The colour of `above` on an opaque `below`, `opacity` times as opaque as it says. */
static ui_colour blend(ui_colour above, ui_colour below, double opacity)
{
    double part = opacity * above.a / 255;
    return (ui_colour){(uint8_t)lround(part * above.r + (1 - part) * below.r),
                       (uint8_t)lround(part * above.g + (1 - part) * below.g),
                       (uint8_t)lround(part * above.b + (1 - part) * below.b), 255};
}

static double linear(uint8_t byte)
{
    double value = byte / 255.0;
    return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

static double luminance(ui_colour c)
{
    return 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
}

/* Contrast ratio of two opaque colours, 1 to 21: (L1 + 0.05) / (L2 + 0.05), L1 the greater relative luminance (WCAG
 * 2.2, definitions of contrast ratio and relative luminance). */
static double contrast_of(ui_colour a, ui_colour b)
{
    double first = luminance(a) + 0.05;
    double second = luminance(b) + 0.05;
    return fmax(first, second) / fmin(first, second);
}

/* Known pairs: black on white has 21, #767676 is the lightest grey that passes on white, #777777 fails. Grey 0x76 = 118
 * by hand: ((118 / 255 + 0.055) / 1.055)^2.4 = 0.18116, (1.05) / (0.23116) = 4.542. */
static void contrast_is_that_of_wcag(void **state)
{
    const ui_colour white = {255, 255, 255, 255};
    (void)state;
    assert_near(contrast_of((ui_colour){0, 0, 0, 255}, white), 21, 1e-9);
    assert_near(contrast_of(white, white), 1, 1e-12);
    assert_near(contrast_of(white, (ui_colour){0x76, 0x76, 0x76, 255}), 4.542, 1e-3);
    assert_true(contrast_of(white, (ui_colour){0x77, 0x77, 0x77, 255}) < 4.5);
    assert_near(contrast_of((ui_colour){255, 0, 0, 255}, white), 1.05 / (0.2126 + 0.05), 1e-9);
    assert_near(contrast_of((ui_colour){10, 0, 0, 255}, (ui_colour){0, 0, 0, 255}),
                (0.2126 * 10 / 255 / 12.92 + 0.05) / 0.05, 1e-9); /* the straight part of the curve */
}

static void colours_are_blended_by_opacity(void **state)
{
    ui_colour mixed = blend((ui_colour){200, 100, 0, 255}, (ui_colour){100, 100, 100, 255}, 0.5);
    (void)state;
    assert_int_equal(mixed.r, 150);
    assert_int_equal(mixed.g, 100);
    assert_int_equal(mixed.b, 50);
    assert_int_equal(blend((ui_colour){0, 0, 0, 205}, (ui_colour){255, 255, 255, 255}, 1).r, 50);
}

static ui_colour surface_of(size_t surface)
{
    return blend(theme_surfaces[surface], (ui_colour){255, 255, 255, 255}, 1); /* over a white picture */
}

static bool may_stand(size_t text, size_t surface)
{
    bool is_field = surface >= THEME_FIELD && surface <= THEME_FIELD_HELD;
    bool is_row = surface >= THEME_ROW && surface <= THEME_ROW_HELD;
    bool is_plain = surface <= THEME_POPUP || surface == THEME_SHADE || is_row;
    return text == THEME_PLAIN || is_plain || (text == THEME_HINT && is_field);
}

static void every_text_can_be_read(void **state)
{
    (void)state;
    for (enum theme theme = THEME_DARK; theme < THEME_COUNT; theme++) {
        size_t pairs = 0;
        theme_use(theme);
        assert_int_equal(theme_used(), theme);
        for (size_t text = 0; text < THEME_TEXTS; text++) {
            for (size_t surface = 0; surface < THEME_SURFACES; surface++) {
                const ui_colour *texts = surface == THEME_SHADE ? theme_shaded : theme_texts;
                double contrast = contrast_of(texts[text], surface_of(surface));
                if (may_stand(text, surface) && contrast < LEAST_CONTRAST) {
                    fail_msg("theme %d, text %zu on surface %zu: %.2f", (int)theme, text, surface, contrast);
                }
                pairs += may_stand(text, surface);
            }
        }
        assert_int_equal(pairs, 13 + 5 * 6 + 3);
    }
    theme_use(THEME_DARK);
}

/* Pale texts are used for hidden areas and old answers, and in all other colours only on panels. */
static void pale_texts_can_be_read(void **state)
{
    (void)state;
    for (enum theme theme = THEME_DARK; theme < THEME_COUNT; theme++) {
        theme_use(theme);
        for (size_t surface = 0; surface < THEME_SHADE; surface++) {
            ui_colour below = surface_of(surface);
            if (contrast_of(blend(theme_texts[THEME_PLAIN], below, theme_pale), below) < LEAST_CONTRAST) {
                fail_msg("theme %d: pale on surface %zu", (int)theme, surface);
            }
        }
        ui_colour panel = surface_of(THEME_PANEL);
        for (size_t text = 0; text < THEME_TEXTS; text++) {
            if (contrast_of(blend(theme_texts[text], panel, theme_pale), panel) < LEAST_CONTRAST) {
                fail_msg("theme %d: text %zu is too pale", (int)theme, text);
            }
        }
    }
    theme_use(THEME_DARK);
    ui_colour shade = surface_of(THEME_SHADE);
    assert_true(contrast_of(blend(theme_shaded[THEME_PLAIN], shade, theme_pale), shade) >= LEAST_CONTRAST);
}

static bool begins_with_one_of(const char *name, const char *const *beginnings)
{
    bool found = false;
    for (; *beginnings; beginnings++) {
        found = found || strncmp(name, *beginnings, strlen(*beginnings)) == 0;
    }
    return found;
}

/* Checks the colours that the widgets really have: plain text on everything that a widget with text fills, and marks on
 * fields. */
static void the_widgets_of_a_theme_have_its_colours(enum theme theme)
{
    static const char *const filled[] = {"WindowBg", "PopupBg",       "FrameBg",       "TitleBg",        "Button",
                                         "Header",   "TableHeaderBg", "TableRowBgAlt", "TextSelectedBg", NULL};
    static const char *const marks[] = {"CheckMark", "NavHighlight", "SliderGrab", NULL};
    static const char *const edges[] = {"BorderShadow", "Border", "ScrollbarGrab", NULL}; /* seen on panels */
    const char *name;
    ui_colour colour;
    size_t seen = 0;
    theme_use(theme);
    assert_true(ui_audit_create(1, 640, 480));
    for (size_t i = 0; ui_audit_colour(&colour, &name, i); i++) {
        bool is_filled = begins_with_one_of(name, filled) && strcmp(name, "TitleBgCollapsed") != 0;
        ui_colour shown = blend(colour, theme_surfaces[THEME_PANEL], 1);
        if (is_filled && contrast_of(theme_texts[THEME_PLAIN], shown) < LEAST_CONTRAST) {
            fail_msg("%s: %.2f", name, contrast_of(theme_texts[THEME_PLAIN], shown));
        }
        if (begins_with_one_of(name, marks)) {
            assert_true(contrast_of(shown, theme_surfaces[THEME_FIELD_HOVERED]) >= LEAST_MARK_CONTRAST);
            assert_true(contrast_of(shown, theme_surfaces[THEME_PANEL]) >= LEAST_MARK_CONTRAST);
        }
        bool is_edge = begins_with_one_of(name, edges + 1);
        if (is_edge && strcmp(name, edges[0]) != 0) {
            assert_true(contrast_of(shown, theme_surfaces[THEME_PANEL]) >= LEAST_MARK_CONTRAST);
        }
        bool is_text = strcmp(name, "Text") == 0 || strcmp(name, "TextDisabled") == 0;
        const ui_colour wanted = theme_texts[strcmp(name, "Text") == 0 ? THEME_PLAIN : THEME_HINT];
        assert_true(!is_text || memcmp(&colour, &wanted, sizeof colour) == 0);
        seen += is_filled + is_text;
    }
    assert_int_equal(seen, 18);
    ui_destroy();
}

/* An edge says where a control ends: on the panel it is seen from outside, on what fills the control from inside. */
static void edges_are_seen_on_what_they_enclose(void **state)
{
    (void)state;
    for (enum theme theme = THEME_DARK; theme < THEME_COUNT; theme++) {
        theme_use(theme);
        for (size_t surface = THEME_PANEL; surface <= THEME_BUTTON_HELD; surface++) {
            const double contrast = contrast_of(theme_marks[THEME_EDGE], theme_surfaces[surface]);
            if (contrast < LEAST_MARK_CONTRAST) {
                fail_msg("theme %d, edge on surface %zu: %.2f", (int)theme, surface, contrast);
            }
        }
    }
    theme_use(THEME_DARK);
}

static void the_widgets_have_these_colours(void **state)
{
    (void)state;
    the_widgets_of_a_theme_have_its_colours(THEME_LIGHT);
    the_widgets_of_a_theme_have_its_colours(THEME_DARK);
}

static const char long_name[] = "superior longitudinal fasciculus, temporoparietal part, of the left hemisphere";

/* Areas, a pathway, and a context. */
static conus_atlas *load_scene(void)
{
    conus_atlas *atlas = NULL;
    const conus_pathway_options pathway = {.name = long_name, .threshold = 3};
    char path[600];
    char folder[512];
    snprintf(folder, sizeof folder, "%s", test_scratch("scene"));
    assert_ok(conus_phantom_write("slabs", folder, NULL));
    assert_ok(conus_phantom_write("tubes", folder, NULL));
    snprintf(path, sizeof path, "%s/slabs.nii.gz", folder);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    snprintf(path, sizeof path, "%s/tubes.nii.gz", folder);
    assert_ok(conus_atlas_add_pathway(atlas, path, &pathway));
    assert_ok(conus_atlas_set_context(atlas, path, NULL));
    return atlas;
}

/* A plan of the slabs, with candidates of long names that hold it. */
static void open_plan(struct viewer *viewer)
{
    static const char needles[] = "query_id\tx\ty\tz\tdx\tdy\tdz\n"
                                  "electrode contact-bearing shaft 1\t-123.4\t-123.4\t-123.4\t1\t1\t1\n"
                                  "electrode contact-bearing shaft 2\t-123.4\t-123.4\t-123.4\t1\t1\t1.01\n";
    static const struct view_settings none = {.depth = 0};
    struct worded worded;
    char poses[600];
    snprintf(poses, sizeof poses, "--poses=%s", test_scratch("needles.tsv"));
    assert_ok(conus_write_file(poses + strlen("--poses="), needles, strlen(needles)));
    json_t *words =
        json_pack("[s, s, s, s]", "--avoid=Slab anterior,margin=0.125", "--length=1,500", "--depth=100", poses);
    assert_int_equal(worded_parse(&worded, words, &none, false), 0);
    assert_int_equal(plans_open(viewer, worded.settings.arguments, worded.settings.poses, 100, 0), 0);
    worded_finish(&worded);
    json_decref(words);
    do {
        plans_step(viewer);
        sched_yield();
    } while (plans_is_behind(viewer));
}

static void draw(struct window *window)
{
    ui_audit_begin();
    if (window->start.on) {
        panel_start(window);
    } else {
        panel_areas(window);
        panel_results(window);
        panel_status(window);
    }
    if (window->forms.show_help) {
        keys_draw_help(window);
    }
    ui_audit_end();
}

/* Asserts that no text is cut off, and that every widget has a tip. */
static void nothing_is_cut(struct window *window, const char *where)
{
    for (int i = 0; i < 4; i++) { /* columns find their widths */
        draw(window);
    }
    assert_true(ui_audit_count() > 10);
    if (ui_audit_cut(0)) {
        fail_msg("%d x %d, scale %g, %s: \"%s\" is cut", window->screen.width, window->screen.height,
                 (double)window->screen.scale, where, ui_audit_cut(0));
    }
    if (ui_audit_untold(0)) {
        fail_msg("%s: \"%s\" has no tip", where, ui_audit_untold(0));
    }
}

/* Tables of studies have room for their numbers in the first frame that shows them; it is not followed by a second
 * one. */
static void numbers_of_studies_are_seen_at_once(struct window *window)
{
    struct viewer *viewer = window->viewer;
    for (int kind = STUDY_SWEEP; kind < STUDY_COUNT; kind++) {
        struct study_settings study = viewer->study.settings;
        study.kind = (enum study_kind)kind;
        study.samples = 16;
        studies_use(viewer, &study);
        do {
            studies_step(viewer);
            sched_yield();
        } while (studies_is_old(viewer));
        draw(window);
        if (ui_audit_cut(0)) {
            fail_msg("study %d, its first frame: \"%s\" is cut", kind, ui_audit_cut(0));
        }
        nothing_is_cut(window, "a study");
    }
    studies_use(viewer, &(struct study_settings){.kind = STUDY_NONE, .angles = {2, 40, 2}, .samples = 16});
}

/* Shows every setting in turn, with the widgets that it adds to the panels. */
static void look_at_all(struct window *window)
{
    struct viewer *viewer = window->viewer;
    nothing_is_cut(window, "first hits, no depth of the planned needle");
    assert_true(plans_go(viewer, 0));
    nothing_is_cut(window, "a planned pose");
    viewer->cone.options.range[1] = 0;
    viewer->cone.options.layers = CONUS_LAYERS_ALL;
    viewer->cone.options.radius = 12.5;
    viewer->cone.options.score = "unoccluded";
    tool_reselect(viewer);
    nothing_is_cut(window, "all hits in a cylinder");
    numbers_of_studies_are_seen_at_once(window);
    for (size_t column = 0; column < RESULT_COLUMNS; column++) {
        result_show(viewer, column, true);
    }
    viewer->cone.options.score = "distance";
    tool_reselect(viewer);
    if ((float)window->screen.width > 640 * window->screen.scale) { /* else the edge of what scrolls cuts a column */
        nothing_is_cut(window, "all columns");
    }
    result_choose(viewer, NULL, 0);
    viewer->cone.options.sampling = CONUS_SAMPLING_SLICES;
    viewer->cone.options.layers = CONUS_LAYERS_VISIBLE;
    viewer->tools[FIRST_TOOL].pointer = POINT_BY_WAND;
    viewer->frame.space = CONUS_SPACE_BREGMA;
    tool_reselect(viewer);
    nothing_is_cut(window, "slices, from bregma");
    tool_confirm(viewer, FIRST_TOOL);
    viewer_choose(viewer, 1);
    nothing_is_cut(window, "confirmed");
    viewer_choose(viewer, 3);
    viewer_pin(viewer, (struct pin){.object = 3, .share = 0.5, .distance = 12.3});
    nothing_is_cut(window, "a long name");
    viewer->tools[FIRST_TOOL].pointer = POINT_BY_TRACKER;
    nothing_is_cut(window, "an old answer");
    viewer->tools[SECOND_TOOL].on = true;
    nothing_is_cut(window, "a second tool, not placed yet");
    viewer->tools[SECOND_TOOL].on = false;
    viewer_hide(viewer, 1, true);
    tool_clear(viewer);
    viewer->tools[FIRST_TOOL].pointer = POINT_BY_REPLAY;
    nothing_is_cut(window, "hidden, and no cone");
    viewer->tools[FIRST_TOOL].pointer = POINT_BY_TRACKER;
    snprintf(viewer->drawn->shown.search, sizeof viewer->drawn->shown.search, "nothing of that name");
    nothing_is_cut(window, "a tracker, and nothing found");
    viewer->drawn->shown.search[0] = '\0';
    viewer->drawn->sides[1] = 'L';
    viewer->drawn->sides[2] = 'R';
    nothing_is_cut(window, "sides");
    window->forms.show_help = true;
    nothing_is_cut(window, "keys");
    window->forms.show_help = false;
    window->start.on = true;
    static const char asked[] = "What lies behind that? All depths of the cone";
    nothing_is_cut(window, "start page");
    assert_true(ui_audit_place(asked) < SIZE_MAX);
    window->start.recent = (struct recent){.count = 1, .paths = {"/atlases/slabs.nii.gz"}};
    nothing_is_cut(window, "start page with what was opened before");
    assert_true(ui_audit_place("slabs.nii.gz") < SIZE_MAX && ui_audit_place(asked) == SIZE_MAX);
    window->start.on = false;
}

static void nothing_is_cut_at_usual_sizes(void **state)
{
    static const struct {
        int width, height;
        float scale;
    } screens[] = {{1280, 800, 1},     {1280, 800, 2},  {1920, 1080, 1},
                   {1920, 1080, 1.5F}, {2560, 1440, 1}, {2560, 1440, 2}};
    conus_atlas *atlas = load_scene();
    struct viewer viewer;
    (void)state;
    assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = "slabs"}, 1, NULL, NULL, NULL));
    open_plan(&viewer);
    for (size_t i = 0; i < sizeof screens / sizeof screens[0]; i++) {
        struct window window = {.viewer = &viewer, .screen.enlarged = -1, .screen.scale = screens[i].scale};
        window.screen.width = screens[i].width;
        window.screen.height = screens[i].height;
        screen_divide(&window.screen);
        viewer.cone = (struct cone_state){0};
        viewer.tools[FIRST_TOOL] = (struct tool){.on = true, .angle = 20};
        viewer.tools[SECOND_TOOL] = (struct tool){.angle = 5};
        viewer.frame.space = CONUS_SPACE_RAS;
        viewer_show_all(&viewer);
        tool_aim_along(&viewer, FIRST_TOOL, (double[]){-123.4, -123.4, -123.4}, (double[]){1, 1, 1});
        viewer_say(&viewer, "opened: slabs.nii.gz");
        assert_true(ui_audit_create(window.screen.scale, (float)window.screen.width, (float)window.screen.height));
        look_at_all(&window);
        ui_destroy();
    }
    viewer_finish(&viewer);
}

/* The audit finds texts that are cut off. */
static void the_audit_finds_cut_texts(void **state)
{
    (void)state;
    assert_true(ui_audit_create(1, 200, 100));
    ui_audit_begin();
    ui_panel("small", (struct ui_box){0, 0, 100, 100}, 0);
    ui_button("fits", NULL);
    ui_text("This does not fit into a hundred pixels.");
    ui_button("Nor does this long button", NULL);
    ui_panel_end();
    ui_audit_end();
    assert_int_equal(ui_audit_count(), 3);
    assert_string_equal(ui_audit_cut(0), "This does not fit into a hundred pixels.");
    assert_string_equal(ui_audit_cut(1), "Nor does this long button");
    assert_null(ui_audit_cut(2));
    ui_destroy();
}

/* Names of a left and a right area stay different, and so do those of areas that end alike; characters stay whole. */
static void a_name_that_is_cut_keeps_its_side(void **state)
{
    static const char *const names[] = {"Frontal_Inf_Oper_L", "Frontal_Inf_Oper_R",
                                        "\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u0141"};
    char shown[3][64];
    (void)state;
    assert_true(ui_audit_create(1, 400, 100));
    ui_audit_begin();
    for (size_t i = 0; i < 3; i++) {
        float whole = ui_text_width(names[i]);
        ui_shorten_name(shown[i], sizeof shown[i], names[i], whole);
        assert_string_equal(shown[i], names[i]);
        ui_shorten_name(shown[i], sizeof shown[i], names[i], 0.7F * whole);
        assert_true(ui_text_width(shown[i]) <= 0.7F * whole);
        assert_true(ui_text_width(shown[i]) > 0.5F * whole);
    }
    assert_memory_equal(shown[0], "Front", 5);
    assert_non_null(strstr(shown[0], "\u2026"));
    assert_string_equal(shown[0] + strlen(shown[0]) - 2, "_L");
    assert_string_equal(shown[1] + strlen(shown[1]) - 2, "_R");
    assert_string_equal(shown[2], "\u00e9\u00e9\u2026\u0141");
    ui_shorten_name(shown[0], sizeof shown[0], names[0], 0);
    assert_string_equal(shown[0], "\u2026");
    ui_audit_end();
    ui_destroy();
}

/* A title or a line of the 3-D pane: its beginning, dots at its end, and characters whole. */
static void a_line_that_is_cut_ends_in_dots(void **state)
{
    static const char line[] = "axial  z = 17.0 mm  \u00e9\u00e9\u00e9\u00e9\u00e9\u00e9";
    static const char dots[] = "\u2026";
    char shown[64];
    (void)state;
    assert_true(ui_audit_create(1, 400, 100));
    ui_audit_begin();
    const float whole = ui_text_width(line);
    ui_shorten(shown, sizeof shown, line, whole);
    assert_string_equal(shown, line);
    for (int less = 1; whole - (float)less > ui_text_width(dots); less += 3) {
        const float room = whole - (float)less;
        ui_shorten(shown, sizeof shown, line, room);
        assert_true(ui_text_width(shown) <= room);
        const size_t kept = strlen(shown) - strlen(dots);
        assert_string_equal(shown + kept, dots);
        assert_memory_equal(shown, line, kept);
        assert_true(((unsigned char)line[kept] & 0xc0) != 0x80);
    }
    ui_shorten(shown, sizeof shown, line, 0);
    assert_string_equal(shown, dots);
    ui_audit_end();
    ui_destroy();
}

static void letters_that_the_font_lacks_are_known(void **state)
{
    (void)state;
    assert_true(ui_audit_create(1, 200, 100));
    ui_audit_begin();
    assert_true(ui_can_write(""));
    assert_true(ui_can_write("Gyrus rectus, \u00e9 \u0141 \u03b1 \u041a\u043e\u0440\u0430"));
    assert_false(ui_can_write("left \u6d77\u99ac"));
    assert_false(ui_can_write("\u0627 left"));
    ui_audit_end();
    ui_destroy();
}

/* The font of texts has signs and old letters that the one of headings lacks; a line is as high. */
static void a_heading_has_all_letters_that_texts_have(void **state)
{
    static const char *const texts[] = {"Gyrus \u00e9 \u03b1 \u041a", "left \u2192 right", "\u0480 left"};
    float high = 0;
    (void)state;
    assert_true(ui_audit_create(1, 400, 100));
    ui_audit_begin();
    for (size_t i = 0; i < 3; i++) {
        const float enlarged = push_heading(texts[i]);
        assert_true(ui_can_write(texts[i]));
        assert_true(i == 0 ? enlarged == 1 : enlarged > 1);
        high = i == 0 ? ui_line() : high;
        assert_near(ui_line(), high, 1e-3);
        pop_heading();
        assert_true(ui_line() < high);
    }
    ui_audit_end();
    ui_destroy();
}

TEST_GROUP(legible)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contrast_is_that_of_wcag),
        cmocka_unit_test(colours_are_blended_by_opacity),
        cmocka_unit_test(every_text_can_be_read),
        cmocka_unit_test(pale_texts_can_be_read),
        cmocka_unit_test(edges_are_seen_on_what_they_enclose),
        cmocka_unit_test(the_widgets_have_these_colours),
        cmocka_unit_test(the_audit_finds_cut_texts),
        cmocka_unit_test(nothing_is_cut_at_usual_sizes),
        cmocka_unit_test(letters_that_the_font_lacks_are_known),
        cmocka_unit_test(a_heading_has_all_letters_that_texts_have),
        cmocka_unit_test(a_name_that_is_cut_keeps_its_side),
        cmocka_unit_test(a_line_that_is_cut_ends_in_dots),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
