/* SPDX-License-Identifier: BSD-3-Clause */
/* The appearance of an atlas: grey values, opacities, haze, colours of the context and the background, without a
 * window. */
#include "viewer/commands/commands.h"
#include "viewer/model/viewer.h"
#include "viewer/pictures/pictures.h"
#include "viewer/session/session.h"
#include "viewer/tools/tools.h"
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

/* The nested balls; with them the first ball again, as a pathway and as the context. */
static conus_atlas *load(bool with_context)
{
    conus_atlas *atlas = NULL;
    test_folder("phantom");
    if (access(test_in("nested.nii.gz"), F_OK)) { /* once */
        assert_ok(conus_phantom_write("nested", test_in(""), &(conus_phantom_options){.size = 32}));
    }
    assert_ok(conus_atlas_load(&atlas, test_in("nested.nii.gz"), NULL));
    if (with_context) {
        const conus_pathway_options pathway = {.name = "Tract", .threshold = 0.5};
        assert_ok(conus_atlas_add_pathway(atlas, test_in("nested.nii.gz"), &pathway));
        assert_ok(conus_atlas_set_context(atlas, test_in("nested.nii.gz"), NULL));
    }
    return atlas;
}

static void open_window(struct window *out, struct viewer *viewer, bool with_context)
{
    const struct view_source source = {.atlas = load(with_context), .path = "nested"};
    assert_ok(viewer_create(viewer, &source, 1, NULL, NULL, NULL));
    *out = (struct window){.viewer = viewer, .screen.enlarged = -1};
    undo_note(out);
}

static void close_window(struct window *window)
{
    changes_finish(&window->history.changes);
    viewer_finish(window->viewer);
}

/* Brighter by half of 0 to 100 puts the middle from 50 to 0; twice the contrast halves the width. */
static void grey_values_move_by_their_own_width(void **state)
{
    const double found[2] = {0, 100};
    double grey[2] = {0, 100};
    (void)state;
    appearance_move_grey(grey, found, 0, 0.5);
    assert_near(grey[0], -50, 1e-12);
    assert_near(grey[1], 50, 1e-12);
    appearance_move_grey(grey, found, log(2), -0.5);
    assert_near(grey[0], 25, 1e-12);
    assert_near(grey[1], 75, 1e-12);
    appearance_move_grey(grey, found, 100, 100); /* to a thousandth, about -100 */
    assert_near(grey[0], -100.05, 1e-9);
    assert_near(grey[1], -99.95, 1e-9);
    appearance_move_grey(grey, found, -100, -100); /* to ten times as wide, about 200 */
    assert_near(grey[0], -300, 1e-9);
    assert_near(grey[1], 700, 1e-9);
}

/* The grey values shown in the cuts do not change where the head begins. */
static void the_apex_stays_where_it_was(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_window(&window, &viewer, true);
    double before = point_depth(&viewer, eye, back);
    assert_true(isfinite(before));
    assert_ptr_equal(view_atlas_grey(viewer.drawn), viewer.drawn->found_grey);
    assert_true(viewer_move_grey(&viewer, 0, -1));
    assert_near(view_atlas_grey(viewer.drawn)[0], viewer.drawn->found_grey[1], 1e-6); /* the middle is as far up */
    assert_near(point_depth(&viewer, eye, back), before, 0);
    viewer_set_grey(&viewer, 0, 0);
    assert_ptr_equal(view_atlas_grey(viewer.drawn), viewer.drawn->found_grey);
    close_window(&window);
    open_window(&window, &viewer, false);
    assert_false(viewer_move_grey(&viewer, 0, 1));
    close_window(&window);
}

static void atlases_of_one_context_have_the_same_grey_values(void **state)
{
    struct viewer viewer;
    const struct view_source sources[] = {{load(true), "a", "a"}, {load(false), "b", "b"}, {load(true), "c", "c"}};
    (void)state;
    assert_ok(viewer_create(&viewer, sources, 3, NULL, NULL, NULL));
    viewer_set_grey(&viewer, 1, 2);
    assert_near(view_atlas_grey(&viewer.atlases[2])[1], 2, 0);
    assert_near(view_atlas_grey(&viewer.atlases[1])[1], 0, 0);
    viewer_finish(&viewer);
}

enum { SIDE = 24 };

/* Paints the viewer's drawn atlas at the finest resolution; @p rgb becomes the middle pixel, sRGB. */
static void paint(uint8_t rgb[3], struct viewer *viewer)
{
    struct painting what = {.width = SIDE, .height = SIDE, .backdrop = viewer->display.backdrop};
    struct painted picture;
    bool fine = false;
    char error[PAINTER_TEXT];
    what.scene_number = viewer->scene_number;
    orbit_fit(&viewer->orbit, (double[]){SIDE, SIDE});
    eye_of_orbit(&what.eye, &viewer->orbit, (double[]){SIDE, SIDE});
    painter_ask(viewer->painter, &what);
    while (!fine) {
        assert_false(painter_text(error, viewer->painter, PAINTER_ERROR));
        if (!painter_take(viewer->painter, &picture)) {
            usleep(1000);
            continue;
        }
        fine = picture.fine && picture.what.scene_number == what.scene_number;
        if (fine) { /* coarse ones are smaller */
            assert_int_equal(picture.width * picture.height, SIDE * SIDE);
            memcpy(rgb, picture.rgba + (size_t)4 * (SIDE * SIDE / 2 + SIDE / 2), 3);
        }
        free(picture.rgba);
    }
}

static uint8_t byte_of(float linear)
{
    double srgb = linear <= 0.0031308F ? 12.92 * (double)linear : 1.055 * pow((double)linear, 1 / 2.4) - 0.055;
    return (uint8_t)(255 * fmin(fmax(srgb, 0), 1) + 0.5);
}

/* The same pixel by conus_render(), with @p opacity of every object and @p pale of the rest. */
static void render(uint8_t rgb[3], struct viewer *viewer, const double *opacity, double pale,
                   const conus_renderer_options *options)
{
    static const char *const channels[] = {"R", "G", "B"};
    conus_renderer *renderer = NULL;
    conus_image *image = NULL;
    struct eye sight;
    eye_of_orbit(&sight, &viewer->orbit, (double[]){SIDE, SIDE});
    const double *f = sight.frustum;
    const conus_view view = {.width = SIDE,
                             .height = SIDE,
                             .frustum = {f[0], f[1], f[2], f[3]},
                             .camera = &sight.camera,
                             .no_legend = true,
                             .opacity = opacity,
                             .pale = pale,
                             .background = CONUS_BACKGROUND_COLOUR};
    assert_ok(conus_renderer_create(&renderer, viewer->drawn->atlas, options));
    assert_ok(conus_render(&image, renderer, &view));
    for (int c = 0; c < 3; c++) {
        rgb[c] = byte_of(conus_image_floats(image, channels[c])[SIDE * SIDE / 2 + SIDE / 2]);
    }
    conus_image_destroy(image);
    conus_renderer_destroy(renderer);
}

static void assert_same_pixel(const uint8_t a[3], const uint8_t b[3])
{
    for (int c = 0; c < 3; c++) {
        assert_in_range(a[c], b[c] > 2 ? b[c] - 2 : 0, b[c] + 2); /* the window's table has 4096 levels */
    }
}

static void the_window_draws_opacities_as_render_does(void **state)
{
    struct viewer viewer;
    struct window window;
    uint8_t opaque[3], painted[3], rendered[3];
    const double outer[4] = {NAN, 0.3, NAN, NAN};
    const double all[4] = {NAN, NAN, NAN, NAN};
    (void)state;
    open_window(&window, &viewer, false);
    viewer.display.backdrop = BACKDROP_BLACK;
    paint(opaque, &viewer);
    viewer_set_opacity(&viewer, 1, 0.3);
    paint(painted, &viewer);
    assert_memory_not_equal(opaque, painted, 3);
    render(rendered, &viewer, outer, 0, NULL);
    assert_same_pixel(painted, rendered);
    viewer_set_opacity(&viewer, 1, NAN);
    viewer_set_opacity(&viewer, 0, 0.4);
    paint(painted, &viewer);
    render(rendered, &viewer, all, 0.4, NULL);
    assert_same_pixel(painted, rendered);
    viewer_set_opacity(&viewer, 0, 1);
    paint(painted, &viewer);
    assert_memory_equal(painted, opaque, 3);
    close_window(&window);
}

static void the_window_draws_haze_and_presets_as_render_does(void **state)
{
    struct viewer viewer;
    struct window window;
    uint8_t solid[3], painted[3], rendered[3];
    const conus_pathway_transfer heat = {4, "heat"};
    (void)state;
    open_window(&window, &viewer, true);
    viewer.display.backdrop = BACKDROP_BLACK;
    paint(solid, &viewer);
    assert_string_equal(haze_name(HAZE_NONE), "solid");
    assert_int_equal(haze_find("no such"), HAZE_LIMIT);
    viewer_set_haze(&viewer, 4, haze_find("heat"));
    paint(painted, &viewer);
    assert_memory_not_equal(solid, painted, 3);
    render(rendered, &viewer, NULL, 0, &(conus_renderer_options){.pathways = &heat, .pathway_count = 1});
    assert_same_pixel(painted, rendered);
    viewer_use_preset(&viewer, "bright");
    paint(painted, &viewer);
    render(rendered, &viewer, NULL, 0,
           &(conus_renderer_options){.transfer = "bright", .pathways = &heat, .pathway_count = 1});
    assert_same_pixel(painted, rendered);
    viewer_set_haze(&viewer, 4, HAZE_NONE);
    viewer_use_preset(&viewer, NULL);
    paint(painted, &viewer);
    assert_memory_equal(painted, solid, 3);
    close_window(&window);
}

/* Runs a command of a script with its arguments. */
static bool does(struct window *window, char *name, char *const *arguments, size_t count)
{
    char *words[SCRIPT_WORDS] = {name};
    memcpy(words + 1, arguments, count * sizeof *words);
    return script_do(window, words, 1 + count);
}

/* The session of the window has the text @p from once. With @p to in its place it is refused, and nothing changes. */
static void assert_refused(struct window *window, const char *from, const char *to, const char *why)
{
    char reason[PROPERTY_REASON] = "";
    char *text = session_text(window);
    char *at = strstr(text, from);
    char changed[1 << 14];
    assert_non_null(at);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    assert_false(session_parse(window, changed, strlen(changed), reason));
    assert_non_null(strstr(reason, why));
    char *after = session_text(window);
    assert_string_equal(text, after);
    free(after);
    free(text);
}

/* Adds a bundle straight up through the middle of the balls, with a number per point from 0.2 below to 0.8 above. */
static void add_bundle(conus_atlas *atlas)
{
    static const float points[3][3] = {{0, 0, -60}, {0, 0, 0}, {0, 0, 60}};
    static const float numbers[] = {0.2F, NAN, 0.8F};
    static const uint64_t first[] = {0, 3};
    const conus_tract_scalar scalars[] = {{.name = "FA", .per_point = true, .components = 1, .values = numbers},
                                          {.name = "tensor", .components = 3, .values = points[0]},
                                          {.name = "count", .components = 1, .values = numbers + 1}};
    const conus_polylines lines = {.points = points,
                                   .type = CONUS_SCALAR_FLOAT32,
                                   .point_count = 3,
                                   .first = first,
                                   .streamline_count = 1,
                                   .scalars = scalars,
                                   .scalar_count = 3};
    assert_ok(conus_atlas_add_polylines(atlas, &lines, &(conus_streamlines_options){.name = "Up", .radius = 8}));
}

static void open_with_bundle(struct window *out, struct viewer *viewer)
{
    const struct view_source source = {.atlas = load(false), .path = "nested"};
    add_bundle(source.atlas);
    assert_ok(viewer_create(viewer, &source, 1, NULL, NULL, NULL));
    *out = (struct window){.viewer = viewer, .screen.enlarged = -1};
    undo_note(out);
}

/* Areas that are not hit are not drawn beside a bundle, so a ray of the picture meets the bundle first. */
static void the_bundle_is_named_where_the_picture_has_it(void **state)
{
    struct viewer viewer;
    struct window window;
    uint32_t object;
    double contact[3];
    (void)state;
    open_with_bundle(&window, &viewer);
    assert_true(viewer_pick(&object, contact, &viewer, eye, back, INFINITY));
    assert_string_equal(conus_atlas_object(viewer.drawn->atlas, object)->name, "Up");
    assert_near(contact[1], 8, 1e-6);                                            /* its radius */
    assert_int_equal(view_atlas_at(viewer.drawn, (double[]){0, 0, 55}), object); /* above the balls */
    viewer_hide(&viewer, object, true);
    assert_true(viewer_pick(&object, contact, &viewer, eye, back, INFINITY));
    assert_int_equal(object, 1);
    close_window(&window);
}

static void streamlines_have_the_colours_of_their_files(void **state)
{
    conus_atlas *atlas = load(false);
    double range[2] = {1, 2};
    (void)state;
    assert_int_equal(tract_colour_count(atlas), 0);
    assert_int_equal(tract_colour_find(atlas, "bundle"), TRACT_COLOUR_LIMIT);
    add_bundle(atlas);
    assert_int_equal(tract_colour_count(atlas), 4); /* a number of three components is no colour */
    assert_string_equal(tract_colour_name(atlas, TRACT_BY_NUMBER + 1), "count");
    assert_int_equal(tract_colour_find(atlas, "FA"), TRACT_BY_NUMBER);
    assert_int_equal(tract_colour_find(atlas, "tensor"), TRACT_COLOUR_LIMIT);
    assert_false(tract_colour_range(range, atlas, "count")); /* its only value is not known */
    assert_near(range[0], 1, 0);
    assert_true(tract_colour_range(range, atlas, "FA"));
    assert_near(range[0], 0.2, 1e-7);
    assert_near(range[1], 0.8, 1e-7);
    conus_atlas_destroy(atlas);
}

static void the_window_colours_streamlines_as_render_does(void **state)
{
    struct viewer viewer;
    struct window window;
    uint8_t own[3], painted[3], rendered[3];
    (void)state;
    open_with_bundle(&window, &viewer);
    viewer.display.backdrop = BACKDROP_BLACK;
    paint(own, &viewer);
    assert_true(does(&window, "streamline-colour", (char *[]){"direction"}, 1));
    paint(painted, &viewer);
    assert_memory_not_equal(own, painted, 3);
    render(rendered, &viewer, NULL, 0, &(conus_renderer_options){.streamline_colour = "direction"});
    assert_same_pixel(painted, rendered);
    undo_note(&window);
    assert_true(does(&window, "streamline-colour", (char *[]){"count"}, 1)); /* grey */
    assert_true(isnan(viewer.drawn->appearance.streamline_range[0]));
    paint(painted, &viewer);
    assert_int_equal(painted[0], painted[1]);
    undo_note(&window);
    undo_step(&window, -1);
    assert_int_equal(viewer.drawn->appearance.streamlines, TRACT_BY_DIRECTION);
    undo_step(&window, -1);
    assert_int_equal(viewer.drawn->appearance.streamlines, TRACT_BY_BUNDLE);
    paint(painted, &viewer);
    assert_memory_equal(painted, own, 3);
    close_window(&window);
}

static void colours_that_no_streamline_has_are_refused(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_with_bundle(&window, &viewer);
    assert_false(does(&window, "streamline-colour", (char *[]){"tensor"}, 1));
    assert_refused(&window, "\"streamline_colour\": \"bundle\"", "\"streamline_colour\": \"tensor\"", "direction");
    assert_refused(&window, "\"streamline_colour\": \"bundle\"", "\"streamline_colour\": 1", "direction");
    close_window(&window);
    open_window(&window, &viewer, true);
    assert_false(does(&window, "streamline-colour", (char *[]){"direction"}, 1));
    assert_refused(&window, "\"grey\": null", "\"streamline_colour\": \"bundle\"", "streamlines");
    close_window(&window);
}

static void each_change_is_taken_back(void **state)
{
    struct viewer viewer;
    struct window window;
    const struct appearance *appearance;
    (void)state;
    open_window(&window, &viewer, true);
    viewer_set_grey(&viewer, 0.5, 2);
    undo_note(&window);
    viewer_set_opacity(&viewer, 2, 0.25);
    undo_note(&window);
    viewer_set_opacity(&viewer, 0, 0.5);
    undo_note(&window);
    viewer_set_haze(&viewer, 4, HAZE_OWN);
    undo_note(&window);
    viewer_use_preset(&viewer, conus_transfer_preset(2));
    undo_note(&window);
    viewer.display.backdrop = BACKDROP_TRANSPARENT;
    viewer.version++;
    char *all = session_text(&window);
    appearance = &viewer.drawn->appearance;
    undo_step(&window, -1);
    assert_int_equal(viewer.display.backdrop, BACKDROP_THEME);
    assert_non_null(viewer.preset);
    undo_step(&window, -1);
    assert_null(viewer.preset);
    assert_int_equal(appearance->haze[4], HAZE_OWN);
    undo_step(&window, -1);
    assert_int_equal(appearance->haze[4], HAZE_NONE);
    assert_near(appearance->opacity[0], 0.5, 0);
    undo_step(&window, -1);
    assert_near(appearance->opacity[0], 1, 0);
    assert_near(appearance->opacity[2], 0.25, 0);
    undo_step(&window, -1);
    assert_true(isnan(appearance->opacity[2]));
    assert_near(view_atlas_grey(viewer.drawn)[0], 0.5, 0);
    undo_step(&window, -1);
    assert_ptr_equal(view_atlas_grey(viewer.drawn), viewer.drawn->found_grey);
    for (int i = 0; i < 6; i++) {
        undo_step(&window, 1);
    }
    char *again = session_text(&window);
    assert_string_equal(all, again);
    free(again);
    free(all);
    close_window(&window);
}

static void what_cannot_be_is_refused(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_window(&window, &viewer, true);
    assert_refused(&window, "\"grey\": null", "\"grey\": [2, 2]", "grey");
    assert_refused(&window, "\"grey\": null", "\"grey\": [1, 2, 3]", "grey");
    assert_refused(&window, "\"grey\": null", "\"grey\": [\"a\", 2]", "grey");
    assert_refused(&window, "\"opacities\": []", "\"opacities\": [[5, 1]]", "1 to 4");
    assert_refused(&window, "\"opacities\": []", "\"opacities\": [[0, 1]]", "1 to 4");
    assert_refused(&window, "\"opacities\": []", "\"opacities\": [[1, 1.5]]", "0 to 1");
    assert_refused(&window, "\"opacities\": []", "\"opacities\": 3", "list");
    assert_refused(&window, "\"opacity_of_the_rest\": 1.0", "\"opacity_of_the_rest\": 0", "above 0");
    assert_refused(&window, "\"pathways\": []", "\"pathways\": [[1, \"own\"]]", "pathway");
    assert_refused(&window, "\"pathways\": []", "\"pathways\": [[4, \"nonsense\"]]", "preset");
    assert_refused(&window, "\"background\": \"theme\"", "\"background\": \"pink\"", "transparent");
    assert_refused(&window, "\"preset\": null", "\"preset\": \"pink\"", "transfer function");
    close_window(&window);
    open_window(&window, &viewer, false);
    assert_refused(&window, "\"preset\": null", "\"preset\": \"heat\"", "--context");
    close_window(&window);
}

static void invalid_commands_change_nothing(void **state)
{
    struct viewer viewer;
    struct window window;
    char *outer[] = {"Shell outer", "1.5", "reset", "solid", "own"};
    char *core[] = {"Tract", "nonsense"};
    char *numbers[] = {"2", "1", "0", "-1"};
    (void)state;
    open_window(&window, &viewer, true);
    char *before = session_text(&window);
    assert_false(does(&window, "grey", numbers, 1) || does(&window, "grey", numbers, 2) ||
                 does(&window, "grey", outer, 2));
    assert_false(does(&window, "opacity", outer, 2) || does(&window, "opacity", core, 2));
    assert_false(does(&window, "opacity", numbers + 2, 1) || does(&window, "opacity", numbers + 3, 1));
    assert_false(does(&window, "opacity", outer + 2, 1)); /* only an area's opacity can be reset */
    assert_false(does(&window, "haze", (char *[]){outer[0], outer[4]}, 2) || does(&window, "haze", core, 2));
    assert_false(does(&window, "preset", core + 1, 1) || does(&window, "background", core + 1, 1));
    char *after = session_text(&window);
    assert_string_equal(before, after);
    free(after);
    free(before);
    close_window(&window);
    open_window(&window, &viewer, false);
    assert_false(does(&window, "grey", (char *[]){"1", "2"}, 2));
    close_window(&window);
}

static void finish_figure(struct window *window)
{
    assert_true(window->forms.figure.frames > 0);
    while (window->forms.figure.frames) {
        figure_form_step(window);
    }
}

static void a_file_is_replaced_when_it_is_said_twice(void **state)
{
    struct viewer viewer;
    struct window window;
    struct figure_form *form = &window.forms.figure;
    (void)state;
    open_window(&window, &viewer, false);
    window.sheet = (struct sheet){.pixels = {40, 30}, .no_text = true};
    snprintf(form->name, sizeof form->name, "%s", test_in("figure"));
    form->pane = AXIAL;
    figure_form_save(&window);
    assert_string_equal(strrchr(form->name, '.'), ".png");
    figure_form_step(&window); /* the frame in which the sheet is asked for, */
    figure_form_step(&window); /* and the one that reports it */
    assert_true(access(form->name, F_OK));
    finish_figure(&window);
    assert_false(access(form->name, F_OK));
    assert_non_null(strstr(viewer.message, "saved: "));
    figure_form_save(&window);
    assert_int_equal(form->frames, 0);
    assert_non_null(strstr(viewer.message, "there already"));
    figure_form_save(&window);
    finish_figure(&window);
    assert_non_null(strstr(viewer.message, "saved: "));
    assert_false(form->failed);
    /* what can be known before is said at once, and the name can be typed again */
    static const char *const refused[][2] = {{"no/folder.png", "there is no such folder: "},
                                             {"figure.jpg", "figures are .png, .svg, .pdf or .exr"}};
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        snprintf(form->name, sizeof form->name, "%s", test_in(refused[i][0]));
        form->takes_keys = false;
        figure_form_save(&window);
        assert_int_equal(form->frames, 0);
        assert_non_null(strstr(viewer.message, refused[i][1]));
        assert_non_null(strstr(viewer.message, refused[i][0]));
        assert_true(form->failed && form->takes_keys);
    }
    close_window(&window);
}

static void sheets_of_sessions_are_checked(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_window(&window, &viewer, false);
    window.sheet = (struct sheet){.in_mm = true, .mm = {85, 60}, .dpi = 300, .legend = CONUS_LEGEND_BELOW};
    assert_refused(&window, "\"dpi\": 300.0", "\"dpi\": 5", "dpi");
    assert_refused(&window, "\"legend\": \"below\"", "\"legend\": 4", "legend");
    assert_refused(&window, "\"dpi\": 300.0", "\"dpi\": true", "dpi");
    assert_refused(&window, "85.0", "1e9", "mm");
    viewer.version++;
    undo_note(&window);
    window.sheet.dpi = 600;
    viewer.version++;
    undo_step(&window, -1);
    assert_near(window.sheet.dpi, 300, 0);
    assert_int_equal(window.sheet.legend, CONUS_LEGEND_BELOW);
    char *text = session_text(&window);
    char why[PROPERTY_REASON] = "";
    memcpy(strstr(text, "\"legend\": \"below\""), "\"legend\":\"inside\"", strlen("\"legend\":\"inside\"")); /* once */
    assert_true(session_parse(&window, text, strlen(text), why));
    assert_int_equal(window.sheet.legend, CONUS_LEGEND_AUTO);
    free(text);
    close_window(&window);
}

/* 85 mm at 300 pixels per 25.4 mm are 1003.94, three quarters of it 752.95; 20 mm at 127 are 100. */
static void a_sheet_follows_from_its_settings(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        conus_background kind;
        uint8_t rgb[3];
    } backgrounds[] = {{NULL, CONUS_BACKGROUND_LIGHT, {0}},
                       {"light", CONUS_BACKGROUND_LIGHT, {0}},
                       {"white", CONUS_BACKGROUND_COLOUR, {255, 255, 255}},
                       {"black", CONUS_BACKGROUND_COLOUR, {0, 0, 0}},
                       {"transparent", CONUS_BACKGROUND_TRANSPARENT, {0}},
                       {"#10aBf0", CONUS_BACKGROUND_COLOUR, {16, 171, 240}}};
    for (size_t i = 0; i < sizeof backgrounds / sizeof backgrounds[0]; i++) {
        conus_view view = {0};
        const struct figure_settings settings = {.background = backgrounds[i].text, .size = {31, 17}};
        figure_view(&view, &settings);
        assert_int_equal(view.background, backgrounds[i].kind);
        assert_memory_equal(view.background_rgb, backgrounds[i].rgb, 3);
        assert_true(view.width == 31 && view.height == 17 && view.dpi == 0);
    }
    static const struct {
        double mm[2], dpi, wanted_dpi;
        uint32_t wanted[2];
    } sheets[] = {{{85, 0}, 0, 300, {1004, 753}}, {{50, 20}, 127, 127, {250, 100}}, {{25.4, 50.8}, 0, 300, {300, 600}}};
    for (size_t i = 0; i < sizeof sheets / sizeof sheets[0]; i++) {
        conus_view view = {0};
        const struct figure_settings settings = {
            .width_mm = sheets[i].mm[0], .height_mm = sheets[i].mm[1], .dpi = sheets[i].dpi};
        figure_view(&view, &settings);
        assert_true(view.width == sheets[i].wanted[0] && view.height == sheets[i].wanted[1]);
        assert_near(view.dpi, sheets[i].wanted_dpi, 0);
    }
}

TEST_GROUP(look)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grey_values_move_by_their_own_width),
        cmocka_unit_test(the_apex_stays_where_it_was),
        cmocka_unit_test(atlases_of_one_context_have_the_same_grey_values),
        cmocka_unit_test(the_window_draws_opacities_as_render_does),
        cmocka_unit_test(the_window_draws_haze_and_presets_as_render_does),
        cmocka_unit_test(the_bundle_is_named_where_the_picture_has_it),
        cmocka_unit_test(streamlines_have_the_colours_of_their_files),
        cmocka_unit_test(the_window_colours_streamlines_as_render_does),
        cmocka_unit_test(colours_that_no_streamline_has_are_refused),
        cmocka_unit_test(each_change_is_taken_back),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(invalid_commands_change_nothing),
        cmocka_unit_test(a_file_is_replaced_when_it_is_said_twice),
        cmocka_unit_test(sheets_of_sessions_are_checked),
        cmocka_unit_test(a_sheet_follows_from_its_settings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
