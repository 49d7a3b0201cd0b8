/* SPDX-License-Identifier: BSD-3-Clause */
/* The legend of a picture: its rows if there are too many, and its place beside or below the drawing. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "builders/area_rows.h"
#include "conus/own.h"
#include "picture_scene.h"
#include "render/draw/draw.h"
#include "render/image/image.h"
#include "selection/picture/picture.h"
#include "test.h"
#include "test_gl.h"
#include "tract_scene.h"

#include <stdio.h>
#include <string.h>

enum { WIDTH = 400, HEIGHT = 300, DPI = 100, SLABS = 60, TEXT = 96 };

/* Letters of 7 points, which are a 72nd inch each, and the smallest. */
static const double LARGEST = 7.0 / 72 * DPI;
static const double SMALLEST = 6.0 / 72 * DPI;

enum place { RIGHT, BELOW };

struct scene {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_selection *selection;
    conus_renderer *renderer;
    conus_view view; /* settings of the picture besides its size and selection */
};

/* Labels 1 to 60 from left to right. */
static double slabs(const double p[3])
{
    return floor(p[0]) + SLABS / 2.0 + 1;
}

/* The same; behind them, as seen from the front, are six more: 61 to 66 from left to right. */
static double slabs_and_more(const double p[3])
{
    return p[1] > 0 ? slabs(p) : floor(p[0] / 10) + 64;
}

static double halves(const double p[3])
{
    return p[0] < 0 ? 1 : 2;
}

/* Label 1, but 2 from 10 mm before the middle on. */
static double front_and_rest(const double p[3])
{
    return p[1] < 10 ? 1 : 2;
}

static const double left[3] = {-60, 0, 0}, front[3] = {0, 60, 0};

/* An atlas in which each label is called @p name. */
static conus_atlas *make_atlas(picture_function labels, const char *name)
{
    const conus_volume_info grid = picture_grid((size_t[]){SLABS, 40, 40}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, labels, NULL, NULL);
    for (size_t i = 0; i < atlas->object_count; i++) {
        memory_free((char *)atlas->objects[i].name);
        atlas->objects[i].name = memory_text(name, strlen(name));
    }
    return atlas;
}

/* Takes the atlas over. */
static struct scene see_layers(conus_atlas *atlas, const double from[3], double degrees, conus_layers layers)
{
    const conus_selector_options options = {.layers = layers, .resolution = 64};
    struct scene scene = {.atlas = atlas};
    conus_pose pose;
    scene.renderer = picture_renderer(scene.atlas, NULL);
    assert_ok(conus_selector_create(&scene.selector, scene.atlas, &options));
    assert_ok(conus_pose_toward(&pose, from, (double[]){0, 0, 0}, NULL));
    assert_ok(conus_select(&scene.selection, scene.selector, &pose, degrees));
    return scene;
}

/* With all layers: from the left the first label is hit, each other one is behind it. */
static struct scene see(conus_atlas *atlas, const double from[3], double degrees)
{
    return see_layers(atlas, from, degrees, CONUS_LAYERS_ALL);
}

static struct scene make_scene(picture_function labels, const char *name, const double from[3], double degrees)
{
    return see(make_atlas(labels, name), from, degrees);
}

static void finish_scene(struct scene *scene)
{
    conus_renderer_destroy(scene->renderer);
    conus_selection_destroy(scene->selection);
    conus_selector_destroy(scene->selector);
    conus_atlas_destroy(scene->atlas);
}

/* By place in the answer; from the seventh on a grey, with a number where it is hit
 * first. */
static const uint8_t ranks[][3] = {{LOOK_RGB(LOOK_RANK_1)},   {LOOK_RGB(LOOK_RANK_2)}, {LOOK_RGB(LOOK_RANK_3)},
                                   {LOOK_RGB(LOOK_RANK_4)},   {LOOK_RGB(LOOK_RANK_5)}, {LOOK_RGB(LOOK_RANK_6)},
                                   {LOOK_RGB(LOOK_RANK_MORE)}};

/* The legend's row of a result, with all layers: all have their entries. */
static struct legend_row describe(char text[3][TEXT], const struct scene *scene, size_t index)
{
    const conus_result *result = conus_selection_result(scene->selection, index);
    const conus_object *object = conus_atlas_object(scene->atlas, result->object);
    struct legend_row row = {.name = object->name};
    bool behind = result->pixels == 0;
    snprintf(text[0], TEXT, "%.1f %%", 100 * result->share);
    snprintf(text[1], TEXT, "%.1f mm", result->entry);
    row.striped = behind;
    row.bare = behind && index >= 6;
    row.detail[0] = behind ? "behind" : text[0];
    row.detail[1] = text[1];
    static const uint8_t grey[3] = {LOOK_RGB(LOOK_NOT_HIT_ON_WHITE)}; /* as what is not hit there */
    const double eighths = behind ? 8 : rint(8 * fmin(fmax((result->share - 0.02) / 0.48, 0), 1)); /* of a colour */
    for (int c = 0; c < 3; c++) {
        const double weight = 0.4 + 0.6 * eighths / 8;
        row.rgb[c] = (uint8_t)(weight * ranks[index < 6 ? index : 6][c] + (1 - weight) * grey[c] + 0.5);
    }
    if (!behind && index >= 6) {
        snprintf(text[2], TEXT, "%zu  %s", index + 1, object->name);
        row.name = text[2];
    }
    return row;
}

static conus_status draw(conus_image **out, const struct scene *scene)
{
    conus_view view = scene->view;
    view.width = WIDTH;
    view.height = HEIGHT;
    view.dpi = DPI;
    view.selection = scene->selection;
    view.background = CONUS_BACKGROUND_TRANSPARENT;
    return conus_render(out, scene->renderer, &view);
}

/* Asserts that the picture has the expected legend on the right, in at most half of the width, or below, where it adds
 * at most half of the height and has columns of at least three rows; and a drawing elsewhere. */
static void check_legend(const struct scene *scene, struct legend legend, enum place place)
{
    static const float ink[4] = {LOOK_PICTURE_INK_ON_LIGHT, LOOK_PICTURE_INK_ON_LIGHT, LOOK_PICTURE_INK_ON_LIGHT, 1};
    const double limit[2] = {place == RIGHT ? 0.5 * WIDTH : WIDTH, place == RIGHT ? HEIGHT : 0.5 * HEIGHT};
    struct font *font = NULL;
    conus_image *image = NULL;
    conus_image *expected = NULL;
    double size[2];
    assert_ok(font_create(&font));
    legend.columns = place == RIGHT ? 1 : (legend.count + 2) / 3;
    legend.ink = ink;
    legend_fit(size, &legend, font, limit, LARGEST, SMALLEST);
    if (size[0] > limit[0]) { /* a name is too long for that */
        legend_fit(size, &legend, font, (double[]){limit[0], INFINITY}, legend.size, 1);
    }
    legend.at[place == RIGHT ? 0 : 1] = place == RIGHT ? WIDTH - ceil(size[0]) : HEIGHT;
    const uint32_t height = HEIGHT + (place == RIGHT ? 0 : (uint32_t)fmin(ceil(size[1]), 0.5 * HEIGHT));
    assert_ok(image_create_listed(&expected, WIDTH, height));
    legend_draw(expected->list, font, &legend);
    assert_ok(image_paint(expected));
    assert_ok(draw(&image, scene));
    assert_int_equal(image->width, WIDTH);
    assert_int_equal(image->height, height);
    const struct image_rgba a = image_rgba(image);
    const struct image_rgba b = image_rgba(expected);
    size_t drawn = 0;
    double letters = 0;
    for (size_t i = 0; i < (size_t)WIDTH * height; i++) {
        bool inside = (double)(i % WIDTH) >= legend.at[0] && floor((double)i / WIDTH) >= legend.at[1];
        drawn += !inside && a.plane[3][i] > 0;
        letters += inside ? (double)b.plane[3][i] : 0;
        for (int c = 0; inside && c < 4; c++) {
            assert_near((double)a.plane[c][i], (double)b.plane[c][i], 1e-6);
        }
    }
    assert_true(drawn > 9000);
    assert_true(letters > 300);
    conus_image_destroy(image);
    conus_image_destroy(expected);
    font_destroy(font);
}

/* Checks the legend of a cone that has no further rows. */
static void check_rows(const struct scene *scene, const struct legend_row *rows, size_t count, enum place place)
{
    char lines[2][PICTURE_TEXT], whole[2 * PICTURE_TEXT];
    picture_describe_cone(lines, &scene->selection->cone, NULL);
    snprintf(whole, sizeof whole, "%s %s", lines[0], lines[1]);
    const struct legend legend = {.title = "Hits of the cone",
                                  .subtitle = {place == BELOW ? whole : lines[0], place == BELOW ? NULL : lines[1]},
                                  .header = {"share", "entry"},
                                  .rows = rows,
                                  .count = count};
    check_legend(scene, legend, place);
}

/* Checks a legend with the first `shown` results, or all if that is 0, and a row about the others if there are any. All
 * rays hit something, so `unassigned`, the last result, has no row. */
static void check(struct scene *scene, size_t shown, enum place place)
{
    char texts[SLABS + 1][3][TEXT];
    char more[40];
    struct legend_row rows[SLABS + 2];
    const size_t results = conus_selection_count(scene->selection) - 1;
    size_t count = 0;
    assert_int_equal(conus_selection_result(scene->selection, results)->object, 0);
    shown = shown ? shown : results;
    for (size_t i = 0; i < shown; i++, count++) {
        rows[count] = describe(texts[i], scene, i);
    }
    if (shown < results) {
        snprintf(more, sizeof more, "and %zu others", results - shown);
        rows[count++] = (struct legend_row){.name = more, .plain = true, .detail = {"behind"}};
    }
    check_rows(scene, rows, count, place);
    finish_scene(scene);
}

/* The head has 1.1 + 2 + 1 lines of 1.45 em, the margins 2.4 em; an em has 8.33 pixels. So 19 rows fit into 300 pixels:
 * the one that is hit, 17 behind it, and one about the others. */
static void the_last_rows_behind_are_counted_in_one(void **state)
{
    (void)state;
    struct scene scene = make_scene(slabs, "Slab", left, 20);
    check(&scene, 18, RIGHT);
}

/* At the face, 40 mm before the device, a cone of 34.4 degrees reaches 12.4 mm to either side: it hits 26 slabs first.
 * At the end of the slabs, 60 mm away, it reaches 18.6 mm, which is 12 slabs more, behind these; at 80 mm it is in six
 * of the others. So there are 44 rows and `unassigned`, 18 of them behind. 26 are left without those, which are too
 * many for 19 lines. Therefore the rows that are hit are counted, too. */
static void rows_that_are_hit_are_counted_with_the_others(void **state)
{
    (void)state;
    struct scene scene = make_scene(slabs_and_more, "Slab", front, 34.4);
    size_t behind = 0;
    for (size_t i = 0; i < conus_selection_count(scene.selection); i++) {
        const conus_result *result = conus_selection_result(scene.selection, i);
        behind += result->object && result->pixels == 0;
    }
    assert_int_equal(conus_selection_count(scene.selection), 45);
    assert_int_equal(behind, 18);
    check(&scene, 0, RIGHT);
}

/* Of the picture's letters, which its view leaves as shapes. */
static size_t count_in(const conus_image *image, const char *text)
{
    size_t found = 0;
    for (size_t i = 0; i < image->list->count; i++) {
        const struct draw_item *item = &image->list->items[i];
        found += item->kind == DRAW_TEXT && strcmp(item->text, text) == 0;
    }
    return found;
}

static size_t count_texts(const struct scene *scene, const char *text)
{
    conus_image *image = NULL;
    assert_ok(draw(&image, scene));
    const size_t found = count_in(image, text);
    conus_image_destroy(image);
    return found;
}

/* A picture without a legend has no numbers, but where one stands elsewhere, as on a sheet of cuts: those of its rows.
 */
static void numbers_are_there_for_a_legend_elsewhere(void **state)
{
    (void)state;
    static const uint32_t rows[] = {0, 6, 7, 26};
    struct scene scene = make_scene(slabs_and_more, "Slab", front, 34.4);
    for (size_t n = 0; n < 4; n++) {
        scene.view = (conus_view){.legend = CONUS_LEGEND_NONE, .legend_rows = rows[n], .shapes = true};
        const size_t found = count_texts(&scene, "7") + count_texts(&scene, "26");
        assert_int_equal(found, n < 2 ? 0 : n - 1); /* the first six have colours, 26 are hit first */
    }
    finish_scene(&scene);
}

/* 82 letters are too long for half of the width, and below the drawing for letters of 6 points. Where the legend is
 * asked for on the right it is there all the same, with its names whole. */
static void long_names_have_the_place_below(void **state)
{
    (void)state;
    for (enum place place = RIGHT; place <= BELOW; place++) {
        struct scene scene = make_scene(
            halves, "One of the two halves of the atlas, which is called by a name that is so very long", left, 20);
        scene.view.legend = place == RIGHT ? CONUS_LEGEND_RIGHT : CONUS_LEGEND_AUTO;
        check(&scene, 2, place);
    }
}

/* A picture that is not wider than high keeps its width. */
static void a_high_picture_has_its_legend_below(void **state)
{
    (void)state;
    for (uint32_t height = 399; height <= 400; height++) {
        struct scene scene = make_scene(halves, "Half", left, 20);
        conus_image *image = NULL;
        const conus_view view = {.width = 400, .height = height, .dpi = DPI, .selection = scene.selection};
        assert_ok(conus_render(&image, scene.renderer, &view));
        assert_int_equal(image->height > height, height == 400);
        conus_image_destroy(image);
        finish_scene(&scene);
    }
}

/* A cone of 90 degrees 40 mm before a ball of 20 mm: most of its rays pass it. */
static void rays_that_hit_nothing_have_a_row(void **state)
{
    (void)state;
    char texts[2][3][TEXT];
    struct scene scene = make_scene(picture_ball_of_20, "Ball", left, 90);
    struct legend_row rows[2] = {describe(texts[0], &scene, 0)};
    const conus_result *missed = conus_selection_result(scene.selection, 1);
    assert_true(missed->object == 0 && missed->share > 0.5);
    snprintf(texts[1][0], TEXT, "%.1f %%", 100 * missed->share);
    rows[1] = (struct legend_row){.name = "unassigned", .plain = true, .detail = {texts[1][0]}};
    check_rows(&scene, rows, 2, BELOW);
    finish_scene(&scene);
}

/* A name is written as people do where that leaves it the only one: left and right are those that the atlas knows. */
static void names_are_written_as_people_do(void **state)
{
    (void)state;
    static const struct {
        const char *names[4], *wanted;
    } cases[] = {{{"Frontal_Inf_L", "Frontal_Inf_R"}, "Frontal Inf left"},
                 {{"l_gyrus_a", "r_gyrus_a"}, "left gyrus a"},
                 {{"Left-Putamen", "Right-Putamen"}, "Left-Putamen"},
                 {{"CST_L", "Other"}, "CST L"}, /* there is no right one: nobody knows */
                 {{"A_B", "A B"}, "A_B"},
                 {{"A_L", "A_R", "A left"}, "A_L"},
                 {{"X_L_Y", "X_R_Y"}, "X L Y"},
                 {{"L", "R"}, "L"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        conus_atlas *atlas = make_atlas(slabs, "Slab");
        char *sides = memory_zeroed(atlas->object_count + 1, 1);
        char text[PICTURE_TEXT];
        for (size_t n = 0; n < 4 && cases[i].names[n]; n++) {
            memory_free((char *)atlas->objects[n].name);
            atlas->objects[n].name = memory_text(cases[i].names[n], strlen(cases[i].names[n]));
        }
        assert_ok(conus_atlas_sides(sides, atlas));
        const struct picture picture = {.atlas = atlas, .sides = sides};
        assert_string_equal(picture_name(text, &picture, 1), cases[i].wanted);
        memory_free(sides);
        conus_atlas_destroy(atlas);
    }
}

/* A mark of an object beside its place in a picture has the name that the legend has. */
static void a_mark_has_the_name_of_the_legend(void **state)
{
    (void)state;
    conus_drawn_point mark = {.at = {-40, 0, 0}, .end = {-40, 0, 0}, .object = 1};
    struct scene scene = make_scene(slabs, "Some_slab", left, 20);
    conus_image *image = NULL;
    scene.view = (conus_view){.shapes = true, .legend_rows = 1};
    assert_int_equal(count_texts(&scene, "Some slab"), 1);
    scene.view.marks = &mark;
    scene.view.mark_count = 1;
    assert_int_equal(count_texts(&scene, "Some slab"), 2);
    mark.object = (uint32_t)conus_atlas_object_count(scene.atlas) + 1;
    assert_int_equal(draw(&image, &scene), CONUS_ERROR_ARGUMENT);
    finish_scene(&scene);
}

/* A streamline of 40 mm along y, at x and about y. */
static void add_bundle(conus_atlas *atlas, const char *name, double x, double y)
{
    struct tract_builder builder;
    tract_begin(&builder);
    builder.made.radius = 3;
    tract_add_point(&builder, (double[]){x, y - 20, 0});
    tract_add_point(&builder, (double[]){x, y + 20, 0});
    tract_end_streamline(&builder);
    assert_ok(atlas_add_tractogram(atlas, &builder.made, name));
}

/* The cone of 8 degrees, 40 mm before its apex, goes through the first bundle, 15 mm before the brain. At the end of
 * the brain, 90 mm away, it reaches 6.3 mm to either side: neither to the area from 10 mm on, nor to the two other
 * bundles, which begin 20 mm beside its axis. In an atlas with bundles areas that the cone does not reach are not
 * drawn, and such bundles are pale. A name of more than 42 letters needs more than two fifths of the width. */
static void bundles_that_are_not_hit_are_said_in_words(void **state)
{
    (void)state;
    static const char *const names[] = {"The bundle that is hit, which has a long name", "Beside", "Beside it"};
    char texts[2][3][TEXT];
    struct legend_row rows[3];
    conus_atlas *atlas = make_atlas(front_and_rest, "Area");
    for (int k = 0; k < 3; k++) {
        add_bundle(atlas, names[k], -45, 40 * k);
    }
    struct scene scene = see(atlas, left, 8);
    assert_int_equal(conus_selection_count(scene.selection), 3); /* with `unassigned` */
    for (size_t i = 0; i < 2; i++) {
        rows[i] = describe(texts[i], &scene, i);
    }
    rows[2] = (struct legend_row){.name = "other areas", .plain = true, .detail = {"not drawn"}};
    check_rows(&scene, rows, 3, BELOW);
    conus_image *image = NULL;
    assert_ok(draw(&image, &scene));
    assert_non_null(strstr(conus_image_legend(image), "\nGrey, not hit: Beside, Beside it\n"));
    conus_image_destroy(image);
    finish_scene(&scene);
}

/* An area beside bundles that is given an opacity is drawn, so it has a row; all other areas are left out. */
static void an_area_that_is_given_an_opacity_has_a_row(void **state)
{
    (void)state;
    const double opacity[] = {NAN, NAN, 1, NAN, NAN};
    char texts[2][3][TEXT];
    struct legend_row rows[3];
    conus_atlas *atlas = make_atlas(front_and_rest, "Area");
    add_bundle(atlas, "The bundle that is hit, which has a long name", -45, 0);
    struct scene scene = see(atlas, left, 8);
    scene.view.opacity = opacity;
    assert_int_equal(conus_selection_count(scene.selection), 3);
    for (size_t i = 0; i < 2; i++) {
        rows[i] = describe(texts[i], &scene, i);
    }
    assert_string_equal(rows[1].name, "Area"); /* the other one, 1 */
    rows[2] = (struct legend_row){.name = "Area", .detail = {"not hit"}};
    memcpy(rows[2].rgb, (const uint8_t[]){LOOK_RGB(LOOK_NOT_HIT_ON_WHITE)}, 3); /* that of no hit */
    check_rows(&scene, rows, 3, BELOW);
    finish_scene(&scene);
}

/* From the left the first slab is hit and all others lie behind it, the bundle behind these. It was asked for, so that
 * it has the second colour. */
static void what_was_asked_for_has_colours_before_what_is_behind(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(slabs, "Slab");
    add_bundle(atlas, "Bundle", 35, 0);
    struct scene scene = see(atlas, left, 8);
    const uint32_t bundle = (uint32_t)atlas->object_count;
    uint32_t *places = picture_ranks(scene.selection);
    assert_non_null(places);
    assert_int_equal(atlas->objects[bundle - 1].kind, CONUS_KIND_BUNDLE);
    assert_int_equal(places[conus_selection_result(scene.selection, 0)->object], 1);
    assert_int_equal(places[bundle], 2);
    assert_int_equal(places[conus_selection_result(scene.selection, 1)->object], 3);
    for (uint32_t object = 0; object <= bundle + 1; object++) {
        assert_int_equal(conus_selection_rank(scene.selection, object), object <= bundle ? places[object] : 0);
    }
    assert_int_equal(conus_selection_rank(NULL, 1), 0);
    memory_free(places);
    finish_scene(&scene);
}

/* Every second of sixty slabs is hit, the last one best: while the palette has colours, what is hit has one that
 * nothing better has, and all other slabs, the best one, too, keep theirs. */
static void what_is_hit_differs_in_a_palette(void **state)
{
    (void)state;
    static const uint8_t palette[4][3] = {{200, 0, 0}, {0, 150, 0}, {0, 0, 250}, {220, 200, 0}};
    uint32_t places[SLABS + 1] = {0};
    conus_atlas *atlas = make_atlas(slabs, "Slab");
    assert_ok(conus_atlas_use_palette(atlas, palette[0], 4));
    size_t colours = 0; /* that are in use: lighter and darker ones, too */
    for (size_t n = 0; n < SLABS; n++) {
        bool is_new = true;
        for (size_t k = 0; k < n; k++) {
            is_new = is_new && memcmp(atlas->objects[n].rgb, atlas->objects[k].rgb, 3) != 0;
        }
        colours += is_new;
        places[n + 1] = n % 2 ? (uint32_t)(SLABS - n + 1) / 2 : 0;
    }
    assert_in_range(colours, 2, SLABS / 2 - 1);
    uint8_t(*rgb)[3] = picture_rank_colours(places, atlas, 0, NULL, NULL);
    assert_non_null(rgb);
    for (size_t n = 1; n <= SLABS; n++) {
        bool keeps = places[n] <= 1;
        assert_true(!keeps || memcmp(rgb[n], atlas->objects[n - 1].rgb, 3) == 0);
        for (size_t k = 1; k < n && places[n] && places[n] <= colours; k++) {
            assert_true(!places[k] || places[k] > colours || memcmp(rgb[n], rgb[k], 3) != 0);
        }
    }
    memory_free(rgb);
    conus_atlas_destroy(atlas);
}

/* Mean saturation of the drawing in the right part of the picture: the largest less the least channel, over the
 * largest. */
static double chroma(const struct scene *scene)
{
    conus_image *image = NULL;
    double sum = 0;
    double count = 0;
    assert_ok(draw(&image, scene));
    const struct image_rgba planes = image_rgba(image);
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
        double high = fmax(fmax((double)planes.plane[0][i], (double)planes.plane[1][i]), (double)planes.plane[2][i]);
        double low = fmin(fmin((double)planes.plane[0][i], (double)planes.plane[1][i]), (double)planes.plane[2][i]);
        bool counts = planes.plane[3][i] >= 1 && i % WIDTH > WIDTH / 2 && high > 0;
        sum += counts ? (high - low) / high : 0;
        count += counts;
    }
    conus_image_destroy(image);
    assert_true(count > 1000);
    return sum / count;
}

/* Eq. 8: pale is 0.16 of the colour and 0.3 of white. From the front only objects that are not hit are seen. */
static void areas_with_an_opacity_or_a_row_are_not_pale(void **state)
{
    (void)state;
    const double opacity[] = {NAN, NAN, 1};
    const bool listed[] = {false, false, true};
    struct scene scene = make_scene(front_and_rest, "Part", left, 8);
    scene.view = (conus_view){.side = CONUS_SIDE_FRONT, .no_legend = true, .pale = 1};
    double pale = chroma(&scene);
    scene.view.opacity = opacity;
    assert_true(chroma(&scene) < 1.1 * pale); /* an opacity gives it no colour of a hit */
    scene.view.opacity = NULL;
    scene.view.listed = listed;
    assert_true(chroma(&scene) > 1.8 * pale); /* its own */
    finish_scene(&scene);
}

/* Without pale areas the picture is as if every area that the cone does not hit had opacity 0. */
static void areas_that_are_not_hit_can_be_left_out(void **state)
{
    (void)state;
    const double opacity[] = {NAN, NAN, 0};
    conus_image *images[3];
    double drawn[3] = {0};
    struct scene scene = make_scene(front_and_rest, "Part", left, 8);
    for (int n = 0; n < 3; n++) {
        scene.view = (conus_view){.no_legend = true, .no_pale = n == 1, .opacity = n == 2 ? opacity : NULL};
        assert_ok(draw(&images[n], &scene));
        for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
            drawn[n] += (double)image_rgba(images[n]).plane[3][i];
        }
    }
    assert_true(drawn[1] < 0.9 * drawn[0]);
    for (int c = 0; c < 4; c++) {
        assert_memory_equal(image_rgba(images[1]).plane[c], image_rgba(images[2]).plane[c],
                            (size_t)WIDTH * HEIGHT * sizeof(float));
    }
    for (int n = 0; n < 3; n++) {
        conus_image_destroy(images[n]);
    }
    finish_scene(&scene);
}

/* A legend without a cone that is limited to so many rows has these, and one about the other areas. */
static void a_legend_without_a_cone_has_the_first_rows(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(front_and_rest, "One of two areas, whose colours are far from each other");
    struct legend_row rows[] = {{.name = atlas->objects[1].name}, {.name = "and 1 other", .plain = true}};
    const struct legend legend = {.title = "Areas", .rows = rows, .count = 2};
    memcpy(rows[0].rgb, atlas->objects[1].rgb, 3);
    struct scene scene = see(atlas, left, 8);
    conus_selection_destroy(scene.selection);
    scene.selection = NULL;
    scene.view.legend_rows = 1;
    check_legend(&scene, legend, BELOW);
    finish_scene(&scene);
}

/* The head has 1.1 lines: 22 rows of 8.33 pixels fit into 300 on the right. All 60 slabs are seen from before them:
 * they are in columns, and none is left out. */
static void many_short_names_have_columns_on_the_right(void **state)
{
    (void)state;
    struct scene scene = make_scene(slabs, "Ab", front, 20);
    conus_image *image = NULL;
    size_t rows = 0;
    conus_selection_destroy(scene.selection);
    scene.selection = NULL;
    scene.view.legend = CONUS_LEGEND_RIGHT;
    scene.view.shapes = true;
    assert_ok(draw(&image, &scene));
    for (size_t i = 0; i < image->list->count; i++) {
        const struct draw_item *item = &image->list->items[i];
        bool is_text = item->kind == DRAW_TEXT;
        rows += is_text && strcmp(item->text, "Ab") == 0;
        assert_false(is_text && strncmp(item->text, "\u2026", strlen("\u2026")) == 0);
    }
    assert_int_equal(rows, SLABS);
    conus_image_destroy(image);
    finish_scene(&scene);
}

/* 60 rows do not fit: the picture stays as large as asked for, and below it becomes higher by at most half. */
static void a_legend_outside_does_not_make_the_picture_endless(void **state)
{
    (void)state;
    struct scene scene = make_scene(slabs, "Slab", left, 20);
    for (int n = 0; n < 4; n++) {
        conus_image *image = NULL;
        bool right = n % 2 == 0;
        scene.view.legend = right ? CONUS_LEGEND_RIGHT : CONUS_LEGEND_BELOW;
        assert_ok(draw(&image, &scene));
        assert_int_equal(conus_image_width(image), WIDTH);
        assert_in_range(conus_image_height(image), right ? HEIGHT : HEIGHT + HEIGHT / 3,
                        right ? HEIGHT : HEIGHT + HEIGHT / 2);
        conus_image_destroy(image);
        if (n == 1) { /* and without a cone */
            conus_selection_destroy(scene.selection);
            scene.selection = NULL;
        }
    }
    finish_scene(&scene);
}

/* Relative luminance of sRGB bytes and contrast, as WCAG 2.2 defines them. */
static double luminance(const double srgb[3])
{
    static const double weights[3] = {0.2126, 0.7152, 0.0722};
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        double level = srgb[c];
        sum += weights[c] * (level <= 0.04045 ? level / 12.92 : pow((level + 0.055) / 1.055, 2.4));
    }
    return sum;
}

static double contrast(double a, double b)
{
    return (fmax(a, b) + 0.05) / (fmin(a, b) + 0.05);
}

/* Letters, dim ones, too, have a contrast of 4.5 on every grey, on other colours, and on both ends of the default. */
static void letters_have_contrast_on_any_background(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(halves, "Half");
    for (int n = -1; n < 256 + 64; n++) {
        struct picture picture = {.atlas = atlas};
        picture.options = (conus_view){.width = WIDTH, .height = HEIGHT};
        double light[2] = {0.9, 0.68};
        if (n >= 0) {
            picture.options.background = CONUS_BACKGROUND_COLOUR;
            double rgb[3];
            for (int c = 0; c < 3; c++) {
                int level = n < 256 ? n : 85 * ((n - 256) >> (2 * c) & 3);
                picture.options.background_rgb[c] = (uint8_t)level;
                rgb[c] = level / 255.0;
            }
            light[0] = light[1] = luminance(rgb);
        }
        assert_ok(picture_prepare_sheet(&picture, UINT64_MAX, NULL, NULL));
        double ink =
            0.2126 * (double)picture.ink[0] + 0.7152 * (double)picture.ink[1] + 0.0722 * (double)picture.ink[2];
        for (int end = 0; end < 2; end++) {
            double part = (double)picture.dim;
            assert_true(contrast(ink, light[end]) >= 4.5);
            assert_true(contrast(part * ink + (1 - part) * light[end], light[end]) >= 4.5);
        }
        font_destroy(picture.font);
    }
    conus_atlas_destroy(atlas);
}

/* sRGB of the preset heat: its colours at 0, 0.35, 0.7 and 1 of the way. */
static void heat(uint8_t rgb[3], double part)
{
    static const double at[] = {0, 0.35, 0.7, 1};
    static const double colours[][3] = {{0.45, 0.02, 0.03}, {0.85, 0.12, 0.03}, {1, 0.62, 0.05}, {1, 0.97, 0.75}};
    int step = part < at[1] ? 0 : part < at[2] ? 1 : 2;
    double between = (part - at[step]) / (at[step + 1] - at[step]);
    for (int c = 0; c < 3; c++) {
        double level = colours[step][c] + between * (colours[step + 1][c] - colours[step][c]);
        rgb[c] = (uint8_t)lrint(255 * level);
    }
}

/* A scene without a cone of halves and so many pathways with the probability 1 from a half on, drawn as heat. */
static struct scene see_haze(size_t count)
{
    static const char *const names[] = {"First", "Second"};
    const conus_pathway_transfer transfer = {.transfer = "heat"};
    conus_atlas *atlas = make_atlas(halves, "Half");
    for (size_t i = 0; i < count; i++) {
        assert_ok(area_rows_add_pathway(atlas, names[i]));
    }
    struct scene scene = see(atlas, left, 8);
    conus_selection_destroy(scene.selection);
    scene.selection = NULL;
    conus_renderer_destroy(scene.renderer);
    assert_ok(conus_renderer_create(&scene.renderer, atlas,
                                    &(conus_renderer_options){.pathways = &transfer, .pathway_count = 1}));
    return scene;
}

/* The key of heat from 50 to 100 %: a heading and five marks. */
static void describe_heat(struct legend_row rows[6], uint8_t bars[5][LEGEND_BAR][3], const char *heading)
{
    static const char *const words[] = {"100", "88", "75", "62", "50"};
    rows[0] = (struct legend_row){.name = heading, .heading = true};
    for (size_t i = 0; i < 5; i++) {
        for (size_t k = 0; k < LEGEND_BAR && i; k++) {
            heat(bars[i][k], 1 - ((double)i - 1 + ((double)k + 0.5) / LEGEND_BAR) / 4);
        }
        rows[1 + i] =
            (struct legend_row){.name = words[i], .mark = true, .bar = i ? (const uint8_t(*)[3])bars[i] : NULL};
    }
}

/* The legend has a bar from 50 to 100 %, for each pathway a disc with its number, which is on the picture, too, and a
 * row for the two areas, which are left out. The disc has the pathway's colour; it is one and a half times as high as
 * the letters, 86 pixels large, less the number and the rim. */
static void haze_by_values_has_a_bar_and_numbers(void **state)
{
    (void)state;
    static const char *const names[] = {"1  First", "2  Second"};
    uint8_t bars[5][LEGEND_BAR][3];
    struct legend_row rows[9];
    const struct legend legend = {.rows = rows, .count = 9, .tail = 6}; /* a mask: its name says what it is */
    conus_image *image = NULL;
    struct scene scene = see_haze(2);
    const conus_atlas *atlas = scene.atlas;
    for (size_t i = 0; i < 2; i++) {
        rows[i] = (struct legend_row){.name = names[i]};
        memcpy(rows[i].rgb, atlas->objects[2 + i].rgb, 3);
    }
    rows[2] = (struct legend_row){.name = "other areas", .plain = true, .detail = {"not drawn"}};
    describe_heat(rows + 3, bars, "Pathways by probability, %");
    check_legend(&scene, legend, BELOW);
    scene.view.legend = CONUS_LEGEND_BELOW;
    assert_ok(draw(&image, &scene));
    for (size_t n = 2; n < 4; n++) {
        size_t found = 0;
        for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
            double worst = 0; /* the legend is below these rows */
            for (int c = 0; c < 3; c++) {
                double level = atlas->objects[n].rgb[c] / 255.0;
                double linear = level <= 0.04045 ? level / 12.92 : pow((level + 0.055) / 1.055, 2.4);
                worst = fmax(worst, fabs((double)image_rgba(image).plane[c][i] - linear));
            }
            found += worst < 1e-4;
        }
        assert_in_range(found, 40, 200);
    }
    conus_image_destroy(image);
    finish_scene(&scene);
}

/* Adds a pathway of the value 1, from a half on, in the box from @p low to @p high. */
static void add_box(conus_atlas *atlas, const char *name, const double low[3], const double high[3])
{
    enum { SIDE = 60 };
    float *values = memory_zeroed((size_t)SIDE * SIDE * SIDE, sizeof *values);
    assert_non_null(values);
    for (size_t v = 0; v < (size_t)SIDE * SIDE * SIDE; v++) {
        const size_t at[3] = {v % SIDE, v / SIDE % SIDE, v / SIDE / SIDE};
        bool is_in = true;
        for (int a = 0; a < 3; a++) {
            const double x = (double)at[a] - 29.5;
            is_in = is_in && low[a] < x && x < high[a];
        }
        values[v] = is_in;
    }
    const conus_voxels voxels = {.dim = {SIDE, SIDE, SIDE},
                                 .type = CONUS_SCALAR_FLOAT32,
                                 .data = values,
                                 .world_from_voxel = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -29.5, -29.5, -29.5, 1}};
    assert_ok(conus_atlas_add_pathway_voxels(atlas, &voxels,
                                             &(conus_pathway_options){.name = name, .threshold = 0.5, .unit = "z"}));
    memory_free(values);
}

/* A scene without a cone of a wall of 10 mm, with one pathway behind it and one before it as seen from the front; the
 * wall is haze of its colour with so much opacity per mm (0 = none), and the one behind, too; from 2 on that is heat.
 */
static struct scene see_wall(double wall, double behind)
{
    const double opacities[] = {wall, behind};
    conus_pathway_transfer transfers[2];
    size_t count = 0;
    conus_atlas *atlas = make_atlas(halves, "Half");
    add_box(atlas, "Wall", (double[]){-20, 0, -20}, (double[]){20, 10, 20});
    add_box(atlas, "Behind", (double[]){-8, -20, -8}, (double[]){8, -10, 8});
    add_box(atlas, "Before", (double[]){10, 15, -8}, (double[]){18, 20, 8});
    for (uint32_t i = 0; i < 2; i++) {
        const uint8_t *rgb = conus_atlas_object(atlas, i + 3)->rgb;
        const char *path = test_scratch(i ? "behind.txt" : "wall.txt");
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fprintf(file, "0 %.9f %.9f %.9f %g\n", rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0, opacities[i]);
        assert_int_equal(fclose(file), 0);
        if (opacities[i] > 0) {
            transfers[count++] = (conus_pathway_transfer){i + 3, opacities[i] < 2 ? path : "heat"};
        }
    }
    struct scene scene = see(atlas, left, 8);
    conus_selection_destroy(scene.selection);
    scene.selection = NULL;
    conus_renderer_destroy(scene.renderer);
    assert_ok(conus_renderer_create(&scene.renderer, atlas,
                                    &(conus_renderer_options){.pathways = transfers, .pathway_count = count}));
    scene.view = (conus_view){.legend = CONUS_LEGEND_RIGHT, .shapes = true};
    return scene;
}

/* L mm of haze with the opacity a per mm leave (1 - a)^L of the light: 10 mm of 0.004 have an opacity of 0.039, of
 * 0.006 one of 0.058, of 0.25 leave 0.056, of 0.28 leave 0.037; seen is what has 0.05. From 0.28 on little is also left
 * to what is haze behind. */
static void a_legend_without_a_cone_has_the_pathways_that_are_seen(void **state)
{
    (void)state;
    static const struct {
        double wall, behind;
        conus_side side;
        size_t is_wall, is_behind, is_before;
    } cases[] = {{0, 0, CONUS_SIDE_FRONT, 1, 0, 1},         {0, 0, CONUS_SIDE_BACK, 1, 1, 0},
                 {0, 0, CONUS_SIDE_TOP, 1, 1, 1},           {0.25, 0, CONUS_SIDE_FRONT, 1, 1, 1},
                 {0.28, 0, CONUS_SIDE_FRONT, 1, 0, 1},      {0, 0.006, CONUS_SIDE_BACK, 1, 1, 0},
                 {0, 0.004, CONUS_SIDE_BACK, 1, 0, 0},      {0.006, 0.006, CONUS_SIDE_FRONT, 1, 1, 1},
                 {0.004, 0.006, CONUS_SIDE_FRONT, 0, 1, 1}, {0.28, 0.9, CONUS_SIDE_FRONT, 1, 0, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct scene scene = see_wall(cases[i].wall, cases[i].behind);
        conus_image *image = NULL;
        scene.view.side = cases[i].side;
        assert_ok(draw(&image, &scene));
        assert_int_equal(count_in(image, "Wall"), cases[i].is_wall);
        assert_int_equal(count_in(image, "Behind"), cases[i].is_behind);
        assert_int_equal(count_in(image, "Before"), cases[i].is_before);
        assert_int_equal(count_in(image, "Half"), 0);
        conus_image_destroy(image);
        finish_scene(&scene);
    }
}

/* A pathway that is drawn by its values has neither a row nor a bar where it is not seen. */
static void haze_that_is_not_seen_has_no_bar(void **state)
{
    (void)state;
    struct scene scene = see_wall(0, 2);
    for (int is_back = 0; is_back < 2; is_back++) {
        scene.view = (conus_view){.side = is_back ? CONUS_SIDE_BACK : CONUS_SIDE_FRONT, .shapes = true};
        assert_int_equal(count_texts(&scene, "Behind"), is_back);
        assert_int_equal(count_texts(&scene, "Behind by z"), is_back);
    }
    finish_scene(&scene);
}

/* From 60 mm away the picture of 30 degrees shows 16 mm up and down, and 21 mm left and right: what is 18 mm to the
 * left is seen, but not where the camera is turned so that it is above the picture. From 600 mm away a square
 * millimetre is a 137,000th of the picture. */
static void what_is_out_of_the_picture_has_no_row(void **state)
{
    (void)state;
    static const struct {
        double up[3], distance;
        size_t is_beside, is_speck;
    } cases[] = {{{0, 0, 1}, 60, 1, 1}, {{1, 0, 0}, 60, 0, 1}, {{0, 0, 1}, 600, 1, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        conus_pose camera;
        conus_atlas *atlas = make_atlas(halves, "Half");
        add_box(atlas, "Middle", (double[]){-5, 0, -5}, (double[]){5, 1, 5});
        add_box(atlas, "Beside", (double[]){-25, 0, -5}, (double[]){-18, 1, 5});
        add_box(atlas, "Speck", (double[]){10, 0, 10}, (double[]){11, 1, 11});
        struct scene scene = see(atlas, left, 8);
        conus_selection_destroy(scene.selection);
        scene.selection = NULL;
        assert_ok(conus_pose_toward(&camera, (double[]){0, cases[i].distance, 0}, (double[]){0, 0, 0}, cases[i].up));
        scene.view = (conus_view){.legend = CONUS_LEGEND_BELOW, .camera = &camera, .shapes = true};
        conus_image *image = NULL;
        assert_ok(draw(&image, &scene));
        assert_int_equal(count_in(image, "Middle"), 1);
        assert_int_equal(count_in(image, "Beside"), cases[i].is_beside);
        assert_int_equal(count_in(image, "Speck"), cases[i].is_speck);
        conus_image_destroy(image);
        finish_scene(&scene);
    }
}

/* The chip of a single one has all colours of the bar, from the least on the left to the largest. */
static void one_haze_has_its_bar_as_its_chip(void **state)
{
    (void)state;
    uint8_t ramp[LEGEND_BAR][3];
    uint8_t bars[5][LEGEND_BAR][3];
    struct legend_row rows[8] = {{.name = "First", .ramp = (const uint8_t(*)[3])ramp},
                                 {.name = "other areas", .plain = true, .detail = {"not drawn"}}};
    const struct legend legend = {.rows = rows, .count = 8, .tail = 6}; /* a mask: its name says what it is */
    struct scene scene = see_haze(1);
    for (size_t k = 0; k < LEGEND_BAR; k++) {
        heat(ramp[k], ((double)k + 0.5) / LEGEND_BAR);
    }
    heat(rows[0].rgb, 0.5);
    describe_heat(rows + 2, bars, "First by probability, %");
    check_legend(&scene, legend, BELOW);
    finish_scene(&scene);
}

static void colour_streamlines(struct scene *scene, const char *by)
{
    conus_renderer_destroy(scene->renderer);
    assert_ok(
        conus_renderer_create(&scene->renderer, scene->atlas, &(conus_renderer_options){.streamline_colour = by}));
}

/* A picture without a cone has the key, too: red, green and blue are the axes. */
static void colours_of_directions_have_a_key(void **state)
{
    (void)state;
    static const struct legend_row rows[] = {{.rgb = {255, 0, 0}, .name = "left to right"},
                                             {.rgb = {0, 255, 0}, .name = "back to front"},
                                             {.rgb = {0, 0, 255}, .name = "down to up"}};
    const struct legend legend = {.title = "Streamlines by direction", .rows = rows, .count = 3};
    conus_atlas *atlas = make_atlas(picture_ball_of_20, "Ball");
    add_bundle(atlas, "Bundle", -45, 0);
    struct scene scene = see(atlas, left, 8);
    colour_streamlines(&scene, "direction");
    conus_selection_destroy(scene.selection);
    scene.selection = NULL;
    check_legend(&scene, legend, RIGHT);
    finish_scene(&scene);
}

/* The chip of a bundle that is hit is red, green and blue from left to right; that of the ball has its rank's colour.
 */
static void a_bundle_by_direction_has_three_colours(void **state)
{
    (void)state;
    uint8_t ramp[LEGEND_BAR][3] = {{0}};
    char texts[2][3][TEXT];
    char lines[2][PICTURE_TEXT];
    struct legend_row rows[6] = {[2] = {.heading = true, .name = "Streamlines by direction"},
                                 [3] = {.rgb = {255, 0, 0}, .name = "left to right"},
                                 [4] = {.rgb = {0, 255, 0}, .name = "back to front"},
                                 [5] = {.rgb = {0, 0, 255}, .name = "down to up"}};
    conus_atlas *atlas = make_atlas(picture_ball_of_20, "Ball");
    add_bundle(atlas, "Bundle", -45, 0);
    struct scene scene = see(atlas, left, 8);
    colour_streamlines(&scene, "direction");
    for (size_t k = 0; k < LEGEND_BAR; k++) {
        ramp[k][6 * k + 3 < 2 * LEGEND_BAR ? 0 : 6 * k + 3 < 4 * LEGEND_BAR ? 1 : 2] = 255;
    }
    for (size_t i = 0; i < 2; i++) {
        rows[i] = describe(texts[i], &scene, i);
        rows[i].ramp = strcmp(rows[i].name, "Bundle") == 0 ? (const uint8_t(*)[3])ramp : NULL;
    }
    assert_true(rows[0].ramp || rows[1].ramp);
    picture_describe_cone(lines, &scene.selection->cone, NULL);
    const struct legend legend = {.title = "Hits of the cone",
                                  .subtitle = {lines[0], lines[1]},
                                  .header = {"share", "entry"},
                                  .rows = rows,
                                  .count = 6,
                                  .tail = 4};
    scene.view.legend = CONUS_LEGEND_RIGHT;
    check_legend(&scene, legend, RIGHT);
    finish_scene(&scene);
}

/* Behind the ball, which alone is hit, one bundle crosses the axis, and five begin 20 mm beside it, where the cone has
 * a radius of 7 mm. By its direction that one's streamline has its full colour in the cone; as a bundle it is pale. */
static void coloured_bundles_in_the_cone_are_not_said_to_be_outside(void **state)
{
    (void)state;
    for (int is_coloured = 0; is_coloured < 2; is_coloured++) {
        conus_atlas *atlas = make_atlas(picture_ball_of_20, "Ball");
        for (int k = 0; k < 6; k++) {
            char name[] = "Bundle 0";
            name[7] = (char)('0' + k);
            add_bundle(atlas, name, 30, k ? 35 + 5 * k : 0);
        }
        struct scene scene = see_layers(atlas, left, 8, CONUS_LAYERS_VISIBLE);
        if (is_coloured) {
            colour_streamlines(&scene, "direction");
        }
        scene.view.shapes = true;
        assert_int_equal(conus_selection_count(scene.selection), 2);
        assert_int_equal(count_texts(&scene, "Bundle 0"), is_coloured);
        assert_int_equal(count_texts(&scene, "passes"), is_coloured);
        assert_int_equal(count_texts(&scene, "Bundle 1"), 0);
        finish_scene(&scene);
    }
}

/* The bar of a number, from its largest to its least value, comes below a heading behind the rows that are hit: here
 * those of two streamlines, 0.25 and 0.75. Between two marks it has LEGEND_BAR steps, each with the colour of its
 * middle, which lies between two of the five known ones. */
static void colours_of_a_number_have_a_bar(void **state)
{
    (void)state;
    static const char *const words[] = {"0.750", "0.625", "0.500", "0.375", "0.250"};
    static const double colours[][3] = {{250, 230, 80}, {138, 204, 84}, {40, 156, 128}, {36, 104, 142}, {34, 46, 110}};
    uint8_t bars[5][LEGEND_BAR][3];
    uint8_t ramp[LEGEND_BAR][3];
    char texts[2][3][TEXT];
    struct legend_row rows[8];
    struct tract_builder builder;
    float values[] = {0.25F, 0.75F};
    conus_atlas *atlas = make_atlas(picture_ball_of_20, "A ball, which is called by a rather long name, too");
    tract_begin(&builder);
    builder.made.radius = 3;
    for (int s = 0; s < 2; s++) {
        tract_add_point(&builder, (double[]){-45, -20, 30 * s});
        tract_add_point(&builder, (double[]){-45, 20, 30 * s});
        tract_end_streamline(&builder);
    }
    builder.made.scalar_count = 1;
    builder.made.scalars = memory_zeroed(1, sizeof *builder.made.scalars);
    builder.made.scalars[0] = (struct tract_scalar){
        .name = memory_text("FA", 2), .components = 1, .values = memory_copy(values, 2, sizeof *values)};
    assert_ok(atlas_add_tractogram(atlas, &builder.made, "Bundle"));
    struct scene scene = see(atlas, left, 8);
    colour_streamlines(&scene, "FA");
    assert_int_equal(conus_selection_count(scene.selection), 3);
    for (size_t i = 0; i < 2; i++) {
        rows[i] = describe(texts[i], &scene, i);
    }
    for (size_t i = 0; i < 5; i++) {
        for (size_t k = 0; k < 3 * LEGEND_BAR && i; k++) {
            size_t step = k / 3;
            double down = ((double)step + 0.5) / LEGEND_BAR;
            double mixed = colours[i - 1][k % 3] + down * (colours[i][k % 3] - colours[i - 1][k % 3]);
            bars[i][k / 3][k % 3] = (uint8_t)(mixed + 0.5);
        }
        rows[3 + i] =
            (struct legend_row){.name = words[i], .mark = true, .bar = i ? (const uint8_t(*)[3])bars[i] : NULL};
    }
    rows[2] = (struct legend_row){.name = "Streamlines by FA", .heading = true};
    for (size_t k = 0; k < 3 * LEGEND_BAR; k++) { /* from the least value on */
        const size_t place = k / 3;
        const double at = 4 - ((double)place + 0.5) / LEGEND_BAR * 4;
        const size_t step = (size_t)at;
        const double mixed =
            colours[step][k % 3] + (at - (double)step) * (colours[step + 1][k % 3] - colours[step][k % 3]);
        ramp[place][k % 3] = (uint8_t)(mixed + 0.5);
    }
    rows[strcmp(rows[0].name, "Bundle") != 0].ramp = (const uint8_t(*)[3])ramp;
    char lines[2][PICTURE_TEXT], whole[2 * PICTURE_TEXT];
    picture_describe_cone(lines, &scene.selection->cone, NULL);
    snprintf(whole, sizeof whole, "%s %s", lines[0], lines[1]);
    const struct legend legend = {.title = "Hits of the cone",
                                  .subtitle = {whole},
                                  .header = {"share", "entry"},
                                  .rows = rows,
                                  .count = 8,
                                  .tail = 6};
    check_legend(&scene, legend, BELOW);
    finish_scene(&scene);
}

TEST_GROUP(picture_legend)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_last_rows_behind_are_counted_in_one),
        cmocka_unit_test(rows_that_are_hit_are_counted_with_the_others),
        cmocka_unit_test(numbers_are_there_for_a_legend_elsewhere),
        cmocka_unit_test(long_names_have_the_place_below),
        cmocka_unit_test(a_high_picture_has_its_legend_below),
        cmocka_unit_test(rays_that_hit_nothing_have_a_row),
        cmocka_unit_test(names_are_written_as_people_do),
        cmocka_unit_test(a_mark_has_the_name_of_the_legend),
        cmocka_unit_test(bundles_that_are_not_hit_are_said_in_words),
        cmocka_unit_test(an_area_that_is_given_an_opacity_has_a_row),
        cmocka_unit_test(areas_with_an_opacity_or_a_row_are_not_pale),
        cmocka_unit_test(areas_that_are_not_hit_can_be_left_out),
        cmocka_unit_test(a_legend_without_a_cone_has_the_first_rows),
        cmocka_unit_test(many_short_names_have_columns_on_the_right),
        cmocka_unit_test(a_legend_outside_does_not_make_the_picture_endless),
        cmocka_unit_test(letters_have_contrast_on_any_background),
        cmocka_unit_test(what_was_asked_for_has_colours_before_what_is_behind),
        cmocka_unit_test(what_is_hit_differs_in_a_palette),
        cmocka_unit_test(haze_by_values_has_a_bar_and_numbers),
        cmocka_unit_test(a_legend_without_a_cone_has_the_pathways_that_are_seen),
        cmocka_unit_test(haze_that_is_not_seen_has_no_bar),
        cmocka_unit_test(what_is_out_of_the_picture_has_no_row),
        cmocka_unit_test(one_haze_has_its_bar_as_its_chip),
        cmocka_unit_test(colours_of_directions_have_a_key),
        cmocka_unit_test(a_bundle_by_direction_has_three_colours),
        cmocka_unit_test(coloured_bundles_in_the_cone_are_not_said_to_be_outside),
        cmocka_unit_test(colours_of_a_number_have_a_bar),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
