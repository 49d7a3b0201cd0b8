/* SPDX-License-Identifier: BSD-3-Clause */
/* Cuts as figures: the cut's own pixels, letters, the scale, the legend, the sheet. */
#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "picture_scene.h"
#include "render/image/image.h"

#include "builders/area_rows.h"
#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 400, HEIGHT = 300, BAND = 24 };

/* A ball of 20 mm around the origin. */
static conus_atlas *load(void)
{
    conus_atlas *atlas = NULL;
    test_folder("phantom");
    assert_ok(conus_phantom_write("sphere", test_in(""), NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("sphere.nii.gz"), NULL));
    return atlas;
}

static const conus_cut_view plain = {.mm_per_pixel = 0.5, .width = WIDTH, .height = HEIGHT, .fill = 1};

/* sRGB of a pixel; fails unless it is opaque, as all pixels of a cut are. */
static void pixel_of(uint8_t rgb[3], const conus_image *image, size_t column, size_t row)
{
    static const char *const channels[] = {"R", "G", "B"};
    for (int c = 0; c < 3; c++) {
        float linear = conus_image_floats(image, channels[c])[row * conus_image_width(image) + column];
        rgb[c] = (uint8_t)(255 * srgb_from_linear((double)linear) + 0.5);
    }
}

/* Number of pixels in a box that differ from the plain cut's. */
static size_t count_changed(const conus_image *image, const uint8_t *rgba, size_t left, size_t top, size_t side)
{
    size_t changed = 0;
    for (size_t row = top; row < top + side; row++) {
        for (size_t column = left; column < left + side; column++) {
            uint8_t rgb[3];
            pixel_of(rgb, image, column, row);
            changed += memcmp(rgb, rgba + 4 * (row * WIDTH + column), 3) != 0;
        }
    }
    return changed;
}

static void without_text_it_is_the_cut(void **state)
{
    conus_atlas *atlas = load();
    conus_image *image = NULL;
    uint8_t *rgba = malloc((size_t)4 * WIDTH * HEIGHT);
    (void)state;
    assert_non_null(rgba);
    assert_ok(conus_cut(rgba, NULL, atlas, &plain));
    assert_ok(conus_cut_image(&image, atlas, &plain, &(conus_view){.no_legend = true, .dpi = 300}));
    assert_int_equal(conus_image_width(image), WIDTH);
    assert_int_equal(conus_image_height(image), HEIGHT);
    assert_near(image->dpi, 300, 0);
    assert_int_equal(count_changed(image, rgba, 0, 0, HEIGHT), 0);
    assert_int_equal(count_changed(image, rgba, WIDTH - HEIGHT, 0, HEIGHT), 0);
    conus_image_destroy(image);
    free(rgba);
    conus_atlas_destroy(atlas);
}

/* Letters are 16.5 pixels high (one and a half of 11), and their middles 11.55 from the edges. */
static void letters_stand_where_the_axes_are(void **state)
{
    static const size_t boxes[4][2] = {
        {0, HEIGHT / 2 - 12}, {WIDTH - BAND, HEIGHT / 2 - 12}, {WIDTH / 2 - 12, 0}, {WIDTH / 2 - 12, HEIGHT - BAND}};
    conus_atlas *atlas = load();
    uint8_t *rgba = malloc((size_t)4 * WIDTH * HEIGHT);
    size_t right[4];
    (void)state;
    assert_non_null(rgba);
    assert_ok(conus_cut(rgba, NULL, atlas, &plain)); /* black there, whichever way it looks */
    for (int turn = 0; turn < 3; turn++) {
        conus_cut_view view = plain;
        conus_image *image = NULL;
        double angle = turn == 0 ? 0 : turn == 1 ? M_PI : M_PI / 4;
        memcpy(view.right, (double[]){cos(angle), turn == 2 ? sin(angle) : 0, 0}, sizeof view.right);
        memcpy(view.up, (double[]){turn == 2 ? -sin(angle) : 0, turn == 2 ? cos(angle) : 1, 0}, sizeof view.up);
        assert_ok(conus_cut_image(&image, atlas, &view, NULL));
        for (int i = 0; i < 4; i++) {
            size_t changed = count_changed(image, rgba, boxes[i][0], boxes[i][1], BAND);
            assert_true(turn == 2 ? changed == 0 : changed > 10); /* oblique: no letter would be true */
            right[i] = turn == 0 ? changed : right[i];
        }
        if (turn == 1) { /* radiological: L, with fewer pixels than R, is on the right now */
            assert_true(right[0] < right[1]);
            assert_true(count_changed(image, rgba, boxes[1][0], boxes[1][1], BAND) <
                        count_changed(image, rgba, boxes[0][0], boxes[0][1], BAND));
        }
        conus_image_destroy(image);
    }
    free(rgba);
    conus_atlas_destroy(atlas);
}

/* The bar is at most 0.14 of 400 pixels of 0.5 mm, 28 mm: so it is 20 mm, 40 pixels, and up to two of its round
 * ends. */
static void the_bar_is_as_long_as_it_says(void **state)
{
    conus_atlas *atlas = load();
    conus_image *image = NULL;
    size_t lit = 0;
    (void)state;
    assert_ok(conus_cut_image(&image, atlas, &plain, NULL));
    for (size_t column = WIDTH - 100; column < WIDTH; column++) {
        uint8_t rgb[3];
        pixel_of(rgb, image, column, HEIGHT - 16); /* 1.4 letters of 11 above the edge */
        lit += rgb[0] > 60;
    }
    assert_in_range(lit, 39, 44);
    conus_image_destroy(image);
    conus_atlas_destroy(atlas);
}

/* Number of pixels of the middle row, of the first @p width, that are neither paper nor black. */
static size_t width_of_ball(const conus_image *image, size_t width)
{
    size_t count = 0;
    for (size_t column = 0; column < width; column++) {
        uint8_t rgb[3];
        pixel_of(rgb, image, column, HEIGHT / 2 + 20);
        count += rgb[0] || rgb[1] || rgb[2];
    }
    return count;
}

/* A sheet with the legend below, of an area and a pathway with these names, both of which the cone hits. */
static conus_image *sheet_of(const char *area, const char *pathway)
{
    static const uint32_t labels[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    const struct area_row rows[] = {{1, area, 0, NULL, 0}, {0}};
    conus_atlas *atlas = NULL;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_image *image = NULL;
    conus_pose pose;
    assert_ok(area_rows_atlas(&atlas, (const size_t[]){2, 2, 2}, labels, rows));
    assert_ok(area_rows_add_pathway(atlas, pathway));
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 9}, (double[]){0, 0, -1}, NULL));
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.layers = CONUS_LAYERS_ALL}));
    assert_ok(conus_select(&selection, selector, &pose, degrees_from_radians(0.01)));
    assert_int_equal(conus_selection_count(selection), 3); /* with `unassigned` */
    const conus_cut_view view = {.mm_per_pixel = 0.5, .width = WIDTH, .height = HEIGHT, .selection = selection};
    assert_ok(conus_cut_image(&image, atlas, &view, &(conus_view){.legend = CONUS_LEGEND_BELOW}));
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
    return image;
}

/* The legend tells an area from a pathway of the same name as tables do. */
static void a_legend_tells_namesakes_apart(void **state)
{
    conus_image *alike = sheet_of("Ball", "Ball");
    conus_image *told = sheet_of("area Ball", "pathway Ball");
    (void)state;
    size_t size = conus_image_width(told) * conus_image_height(told) * sizeof(float);
    assert_int_equal(conus_image_width(alike), conus_image_width(told));
    assert_int_equal(conus_image_height(alike), conus_image_height(told));
    assert_memory_equal(conus_image_floats(alike, "G"), conus_image_floats(told, "G"), size);
    conus_image_destroy(alike);
    conus_image_destroy(told);
}

static void a_legend_has_its_place(void **state)
{
    conus_atlas *atlas = load();
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    conus_view sheet = {.background = CONUS_BACKGROUND_COLOUR, .background_rgb = {10, 20, 200}};
    conus_cut_view view = plain;
    conus_image *image = NULL;
    uint8_t rgb[3];
    (void)state;
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 90}, (double[]){0, 0, -1}, NULL)); /* across the cut */
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_select(&selection, selector, &pose, degrees_from_radians(0.01)));
    view.selection = selection;
    sheet.legend = CONUS_LEGEND_BELOW;
    assert_ok(conus_cut_image(&image, atlas, &view, &sheet));
    assert_true(conus_image_height(image) > HEIGHT + 20);
    pixel_of(rgb, image, WIDTH - 1, conus_image_height(image) - 1);
    assert_memory_equal(rgb, sheet.background_rgb, 3);
    size_t below = width_of_ball(image, WIDTH);
    assert_in_range(below, 66, 71); /* 10.25 mm below the middle: 2 sqrt(20^2 - 10.25^2) = 34.3 mm, of voxels of 1 */
    conus_image_destroy(image);
    sheet.legend = CONUS_LEGEND_RIGHT;
    assert_ok(conus_cut_image(&image, atlas, &view, &sheet));
    assert_int_equal(conus_image_width(image), WIDTH);
    pixel_of(rgb, image, WIDTH - 1, HEIGHT - 1);
    assert_memory_equal(rgb, sheet.background_rgb, 3);
    size_t drawing = 0; /* up to where the sheet begins, in the lowest row, which is black */
    for (pixel_of(rgb, image, 0, HEIGHT - 1); !rgb[2]; pixel_of(rgb, image, drawing, HEIGHT - 1)) {
        drawing++;
    }
    assert_in_range(drawing, WIDTH / 2, HEIGHT - 1); /* now its width is what shows 150 mm */
    double half = 20.5 * 0.5 * HEIGHT / (double)drawing;
    double chord = 2 * sqrt(400 - half * half) / 150 * (double)drawing;
    assert_near(width_of_ball(image, drawing), chord, 3);
    conus_image_destroy(image);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* The first shape that is a text, or a line of that width; NULL = none. */
static const struct draw_item *find_shape(const conus_image *image, enum draw_kind kind, const char *text, double width)
{
    for (size_t i = 0; i < image->list->count; i++) {
        const struct draw_item *item = &image->list->items[i];
        if (item->kind == kind && (text ? strcmp(item->text, text) == 0 : item->width == width)) {
            return item;
        }
    }
    return NULL;
}

/* 3, 4 and 12 mm apart are 13 mm. Half a mm is a pixel. The cut is at z = 0, in
 * voxels of 1 mm: of a line that goes 12 mm behind it a 24th is in it. */
static void a_measured_distance_is_drawn(void **state)
{
    static const struct {
        double places[6], firm; /* the part that is, from its first end */
        const char *text;
        bool is_faint;
    } cases[] = {{{-10, 5, 0, -7, 9, 12}, 1 / 24.0, "13.00 mm in 3-D", true},
                 {{-10, 5, 0, -7, 9, 0}, 1, "5.00 mm", false},
                 {{-10, 5, 4, -7, 9, 16}, 0, NULL, true},
                 {{-10, 5, 30, -7, 9, 42}, 0, NULL, false},
                 {{-10, 5, 0, -7, 90, 12}, 0, NULL, false}}; /* outside the drawing */
    conus_atlas *atlas = load();
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        conus_image *image = NULL;
        const conus_view sheet = {.shapes = true, .measured = cases[i].places};
        const double part = cases[i].firm;
        assert_ok(conus_cut_image(&image, atlas, &plain, &sheet));
        const struct draw_item *line = find_shape(image, DRAW_LINES, NULL, 4);
        const struct draw_item *text = cases[i].text ? find_shape(image, DRAW_TEXT, cases[i].text, 0) : NULL;
        assert_int_equal(line != NULL, part > 0);
        assert_int_equal(text != NULL, part > 0);
        assert_int_equal(find_shape(image, DRAW_LINES, NULL, 1) != NULL, cases[i].is_faint);
        for (size_t item = 0; item < image->list->count && !text; item++) {
            const char *any = image->list->items[item].text;
            assert_true(!any || !strstr(any, "13.00 mm"));
        }
        if (line && text) {
            assert_near(line->points[0][0], WIDTH / 2.0 - 20, 1e-9);
            assert_near(line->points[0][1], HEIGHT / 2.0 - 10, 1e-9);
            assert_near(line->points[1][0], WIDTH / 2.0 - 20 + 6 * part, 1e-9);
            assert_near(line->points[1][1], HEIGHT / 2.0 - 10 - 8 * part, 1e-9);
            assert_near(text->points[0][0] + text->length / 2, WIDTH / 2.0 - 17, 1);
        }
        conus_image_destroy(image);
    }
    conus_atlas_destroy(atlas);
}

static void what_cannot_be_is_refused(void **state)
{
    conus_atlas *atlas = load();
    conus_image *image = NULL;
    conus_cut_view view = plain;
    (void)state;
    assert_fails(conus_cut_image(&image, atlas, &plain, &(conus_view){.dpi = -1}), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_cut_image(&image, atlas, &plain, &(conus_view){.legend = CONUS_LEGEND_NONE + 1}),
                 CONUS_ERROR_ARGUMENT);
    view.mm_per_pixel = -1;
    assert_fails(conus_cut_image(&image, atlas, &view, NULL), CONUS_ERROR_ARGUMENT);
    view.mm_per_pixel = NAN;
    assert_fails(conus_cut_image(&image, atlas, &view, NULL), CONUS_ERROR_ARGUMENT);
    view = plain;
    view.width = 0;
    assert_fails(conus_cut_image(&image, atlas, &view, NULL), CONUS_ERROR_ARGUMENT);
    view.width = 16385;
    assert_fails(conus_cut_image(&image, atlas, &view, NULL), CONUS_ERROR_ARGUMENT);
    view.width = view.height = 16384; /* 32 bytes each: exactly 8 GiB are allowed, but there is no need to draw them */
    view.fill = 2;
    test_limit_allocations(1 << 28);
    assert_true(conus_cut_image(&image, atlas, &view, NULL) != CONUS_OK);
    test_limit_allocations(0);
    assert_null(image);
    conus_atlas_destroy(atlas);
}

static conus_status attempt(void *data)
{
    conus_image *image = NULL;
    conus_status status = conus_cut_image(&image, data, &plain, NULL);
    assert_true(!status == (image != NULL));
    conus_image_destroy(image);
    return status;
}

static void every_allocation_may_fail(void **state)
{
    conus_atlas *atlas = load();
    (void)state;
    test_every_allocation(attempt, atlas);
    conus_atlas_destroy(atlas);
}

static const conus_cut_plane planes[] = {{.right = {1, 0, 0}, .up = {0, 1, 0}}, {.right = {0, 1, 0}, .up = {0, 0, 1}}};

static conus_status draw_sheet(void *user)
{
    static const char *const formats[] = {"svg", "pdf"};
    const conus_view sheet = {.width = 80, .height = 40, .no_legend = true, .shapes = true};
    conus_image *image = NULL;
    conus_status status = conus_render_cuts(&image, user, planes, 2, NULL, NULL, &sheet);
    for (size_t i = 0; i < 2 && !status; i++) {
        const uint8_t *data = NULL;
        size_t size = 0;
        status = conus_image_encode(&data, &size, image, formats[i]);
    }
    conus_image_destroy(image);
    return status;
}

static double grey_in_ball(const double world[3])
{
    return vec3_length(world) < 10 ? 100 : 0;
}

/* An area reaches beyond the image, whose background is 0: unfilled it is white there, as the sheet; the image is not.
 */
static void areas_beyond_the_image_are_background(void **state)
{
    (void)state;
    const conus_volume_info grid = picture_grid((size_t[]){40, 40, 40}, (double[]){1, 1, 1}, picture_identity);
    const conus_view sheet = {.width = 101,
                              .height = 101,
                              .no_legend = true,
                              .background = CONUS_BACKGROUND_COLOUR,
                              .background_rgb = {255, 255, 255}};
    const conus_cut_view look = {.fill = 0, .window = {0, 200}};
    conus_atlas *atlas = picture_atlas(&grid, picture_ten, NULL, grey_in_ball);
    conus_image *image = NULL;
    assert_ok(conus_render_cuts(&image, atlas, planes, 1, &look, NULL, &sheet));
    const float *red = image_rgba(image).plane[0];
    assert_near(red[101 * 50 + 15], 1, 1e-6);                            /* beside the ball, in the area */
    assert_true(red[101 * 50 + 50] > 0.1F && red[101 * 50 + 50] < 0.5F); /* half of white */
    conus_image_destroy(image);
    conus_atlas_destroy(atlas);
}

/* The answer of a cone from `far` times the extent of the atlas left of it, along x. */
static conus_selection *select_from_left(const conus_atlas *atlas, double far)
{
    const conus_selector_options options = {.resolution = 32};
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    double low[3], high[3];
    assert_ok(conus_atlas_bounds(low, high, atlas));
    const double from[3] = {low[0] - far * (high[0] - low[0]), 0, 0};
    assert_ok(conus_pose_along(&pose, from, (double[]){1, 0, 0}, NULL));
    assert_ok(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_select(&selection, selector, &pose, 20));
    conus_selector_destroy(selector);
    return selection;
}

/* Ends of the cone's lines at which no other of them begins. */
static size_t count_ends(const conus_image *image)
{
    static const uint8_t rgb[3] = {LOOK_RGB(LOOK_CONE)};
    float amber[4];
    size_t ends = 0;
    draw_colour(amber, rgb, 1);
    for (size_t i = 0; i < image->list->count; i++) {
        const struct draw_item *item = &image->list->items[i];
        bool is_cone = item->kind == DRAW_LINES && item->rgba[0] == amber[0] && item->rgba[1] == amber[1];
        for (size_t k = 0; k < item->count && is_cone; k++) {
            size_t there = 0;
            for (size_t n = 0; n < item->count; n++) {
                there += hypot(item->points[n][0] - item->points[k][0], item->points[n][1] - item->points[k][1]) < 1e-3;
            }
            ends += there % 2;
        }
        assert_true(!is_cone || item->count > 20);
    }
    return ends;
}

/* The outline of a cone that starts less than a quarter of the atlas's extent beside it is closed; that of one farther
 * away ends twice at the cut's edge. */
static void a_cone_from_near_is_closed_in_cuts(void **state)
{
    (void)state;
    const conus_volume_info grid = picture_grid((size_t[]){40, 40, 40}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ten, NULL, NULL);
    static const double far[] = {0.24, 0.26};
    for (size_t i = 0; i < 2; i++) {
        conus_selection *selection = select_from_left(atlas, far[i]);
        const conus_view sheet = {
            .width = 300, .height = 300, .no_legend = true, .shapes = true, .selection = selection};
        conus_image *image = NULL;
        assert_ok(conus_render_cuts(&image, atlas, planes, 1, NULL, NULL, &sheet));
        assert_int_equal(count_ends(image), i == 0 ? 0 : 2);
        conus_image_destroy(image);
        conus_selection_destroy(selection);
    }
    conus_atlas_destroy(atlas);
}

enum { BARS = 9, BAR = 2 };

/* Bars along x, side by side along y. */
static double bars(const double p[3])
{
    return fabs(p[1]) < 0.5 * BARS * BAR ? 1 + floor((p[1] + 0.5 * BARS * BAR) / BAR) : 0;
}

static const struct draw_item *find_text(const conus_image *image, const char *text)
{
    for (size_t i = 0; i < image->list->count; i++) {
        const struct draw_item *item = &image->list->items[i];
        if (item->kind == DRAW_TEXT && strcmp(item->text, text) == 0) {
            return item;
        }
    }
    return NULL;
}

/* The seventh to ninth bar by share have numbers in their middles: the higher a bar lies in the body the higher in the
 * cut, all at one scale. The first six have colours and no numbers, and without a legend there are none. */
static void cuts_alone_have_the_numbers_of_the_legend(void **state)
{
    (void)state;
    const conus_volume_info grid = picture_grid((size_t[]){40, 40, 40}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, bars, NULL, NULL);
    conus_selection *selection = select_from_left(atlas, 1.2);
    const char *const numbers[] = {"7", "8", "9"};
    double at[3];
    double place[3]; /* along y, in bars */
    for (size_t i = 0; i < BARS; i++) {
        memory_free((char *)atlas->objects[i].name);
        atlas->objects[i].name = memory_text("bar", 3);
    }
    assert_true(conus_selection_count(selection) >= BARS);
    for (int legend = 0; legend < 2; legend++) {
        const conus_view sheet = {
            .width = 400, .height = 300, .no_legend = !legend, .shapes = true, .selection = selection};
        conus_image *image = NULL;
        assert_ok(conus_render_cuts(&image, atlas, planes, 1, NULL, NULL, &sheet));
        for (size_t i = 0; i < 3; i++) {
            const struct draw_item *item = find_text(image, numbers[i]);
            assert_true((item != NULL) == legend);
            at[i] = legend ? item->points[0][1] : 0;
            place[i] = (double)conus_selection_result(selection, 6 + i)->object;
        }
        assert_null(find_text(image, "6"));
        conus_image_destroy(image);
    }
    const double step = (at[0] - at[1]) / (place[0] - place[1]);
    assert_true(step < -5);
    assert_near((at[0] - at[2]) / (place[0] - place[2]), step, 0.5);
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

static void every_failing_allocation_of_a_sheet_is_reported(void **state)
{
    (void)state;
    conus_atlas *atlas = load();
    test_every_allocation(draw_sheet, atlas);
    conus_atlas_destroy(atlas);
}

static void a_sheet_says_what_is_wrong(void **state)
{
    (void)state;
    conus_atlas *atlas = load();
    conus_image *image = NULL;
    conus_cut_plane bad = planes[0];
    assert_fails(conus_render_cuts(&image, atlas, planes, 0, NULL, NULL, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_render_cuts(&image, atlas, planes, 401, NULL, NULL, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_render_cuts(&image, atlas, planes, 2, NULL, NULL, &(conus_view){.width = 8, .height = 8}),
                 CONUS_ERROR_ARGUMENT);
    bad.up[0] = 1;
    assert_fails(conus_render_cuts(&image, atlas, &bad, 1, NULL, NULL, NULL), CONUS_ERROR_ARGUMENT);
    bad = (conus_cut_plane){.at = {0, 0, NAN}, .right = {1, 0, 0}, .up = {0, 1, 0}};
    assert_fails(conus_render_cuts(&image, atlas, &bad, 1, NULL, NULL, NULL), CONUS_ERROR_ARGUMENT);
    assert_null(image);
    conus_atlas_destroy(atlas);
}

static void shapes_are_for_svg_and_pdf_only(void **state)
{
    (void)state;
    conus_atlas *atlas = load();
    for (int shapes = 0; shapes < 2; shapes++) {
        static const char *const formats[] = {"png", "exr", "svg", "pdf"};
        conus_image *image = NULL;
        const conus_view sheet = {.shapes = shapes == 1};
        assert_ok(conus_cut_image(&image, atlas, &plain, &sheet));
        for (int i = 0; i < 4; i++) {
            const uint8_t *data = NULL;
            size_t size = 0;
            if ((i >= 2) == (shapes == 1)) {
                assert_ok(conus_image_encode(&data, &size, image, formats[i]));
                assert_true(size > 100);
            } else {
                assert_fails(conus_image_encode(&data, &size, image, formats[i]), CONUS_ERROR_ARGUMENT);
            }
        }
        conus_image_destroy(image);
    }
    conus_atlas_destroy(atlas);
}

TEST_GROUP(picture_cut_image)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_text_it_is_the_cut),
        cmocka_unit_test(letters_stand_where_the_axes_are),
        cmocka_unit_test(the_bar_is_as_long_as_it_says),
        cmocka_unit_test(a_legend_has_its_place),
        cmocka_unit_test(a_legend_tells_namesakes_apart),
        cmocka_unit_test(a_measured_distance_is_drawn),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(areas_beyond_the_image_are_background),
        cmocka_unit_test(a_cone_from_near_is_closed_in_cuts),
        cmocka_unit_test(cuts_alone_have_the_numbers_of_the_legend),
        cmocka_unit_test(every_failing_allocation_of_a_sheet_is_reported),
        cmocka_unit_test(a_sheet_says_what_is_wrong),
        cmocka_unit_test(shapes_are_for_svg_and_pdf_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
