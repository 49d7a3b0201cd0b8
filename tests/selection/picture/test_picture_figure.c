/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures for papers: sides, backgrounds, letters, places of the legend, and sizes on paper. */
#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "conus/own.h"
#include "picture_scene.h"
#include "render/image/image.h"
#include "selection/picture/picture.h"
#include "test.h"
#include "test_gl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 160, HEIGHT = 120 };

struct scene {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_selection *selection;
    conus_renderer *renderer;
};

/* Six balls: 1 right, 2 left, 3 anterior, 4 posterior, 5 superior, 6 inferior. */
static double balls(const double p[3])
{
    for (int n = 0; n < 6; n++) {
        double centre[3] = {0, 0, 0};
        double offset[3];
        centre[n / 2] = n % 2 ? -20 : 20;
        vec3_sub(offset, p, centre);
        if (vec3_length(offset) < 8) {
            return n + 1;
        }
    }
    return 0;
}

/* The atlas of balls, hit from the left. */
static int make_scene(void **state)
{
    static struct scene scene;
    conus_volume_info grid = picture_grid((size_t[]){60, 60, 60}, (double[]){1, 1, 1}, picture_identity);
    conus_pose pose;
    scene.atlas = picture_atlas(&grid, balls, NULL, NULL);
    assert_ok(conus_selector_create(&scene.selector, scene.atlas, NULL));
    assert_ok(conus_pose_toward(&pose, (double[]){-60, 0, 0}, (double[]){0, 0, 0}, NULL));
    assert_ok(conus_select(&scene.selection, scene.selector, &pose, 60));
    *state = &scene;
    return 0;
}

/* The scene with its renderer; skips the test if there is no GL. */
static struct scene need_scene(void **state)
{
    struct scene *scene = *state;
    if (!scene->renderer) {
        test_need_gl();
        assert_ok(conus_renderer_create(&scene->renderer, scene->atlas, NULL));
    }
    return *scene;
}

static int finish_scene(void **state)
{
    struct scene *scene = *state;
    conus_renderer_destroy(scene->renderer);
    conus_selection_destroy(scene->selection);
    conus_selector_destroy(scene->selector);
    conus_atlas_destroy(scene->atlas);
    return 0;
}

static conus_image *render(const struct scene *scene, conus_view view)
{
    view.width = view.width ? view.width : WIDTH;
    view.height = view.height ? view.height : HEIGHT;
    conus_image *image = NULL;
    assert_ok(conus_render(&image, scene->renderer, &view));
    return image;
}

/* CCF numbers of a world point are 1000 (10 - z), 1000 (4 - y), 1000 (5 + x); those from bregma are the mm from
 * there. The axis is -(-0.25, 4.5, 12.5) / 13.288 = (0.019, -0.339, -0.941), in the world. */
static void the_legend_is_in_the_space_asked_for(void **state)
{
    (void)state;
    struct cone cone = {.degrees = 20, .angle = radians_from_degrees(20)};
    assert_ok(conus_pose_toward(&cone.pose, (double[]){-0.25, 4.5, 12.5}, (double[3]){0}, NULL));
    static const struct {
        conus_frame frame;
        const char *words, *axis;
    } cases[] = {
        {{.space = CONUS_SPACE_RAS, .world_from_space = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
         "20\u00b0 from -0.25, 4.5, 12.5, RAS mm",
         "along 0.02, -0.34, -0.94"},
        {{.space = CONUS_SPACE_LPS, .world_from_space = {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
         "20\u00b0 from 0.25, -4.5, 12.5, LPS mm",
         "along -0.02, 0.34, -0.94"},
        {{.space = CONUS_SPACE_CCF,
          .world_from_space = {0, 0, -0.001, 0, 0, -0.001, 0, 0, 0.001, 0, 0, 0, -5, 4, 10, 1}},
         "20\u00b0 from AP -2500, DV -500, ML 4750 \u00b5m in CCF",
         "along 0.94, 0.34, 0.02"},
        {{.space = CONUS_SPACE_BREGMA, .world_from_space = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, -1, 2, 3, 1}},
         "20\u00b0 from AP 2.5, ML 0.75, DV 9.5 mm from bregma",
         "along -0.34, 0.02, -0.94"},
    };
    char words[2][PICTURE_TEXT];
    picture_describe_cone(words, &cone, NULL);
    assert_string_equal(words[0], cases[0].words);
    assert_string_equal(words[1], cases[0].axis);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        picture_describe_cone(words, &cone, &cases[i].frame);
        assert_string_equal(words[0], cases[i].words);
        assert_string_equal(words[1], cases[i].axis);
    }
    cone.radius = 2.5;
    picture_describe_cone(words, &cone, &cases[3].frame);
    assert_string_equal(words[0], "radius 2.5 mm from AP 2.5, ML 0.75, DV 9.5 mm from bregma");
}

/* The object whose colour a pixel has, however bright; 0 if it is transparent. */
static uint32_t object_at(const struct scene *scene, const conus_image *image, uint32_t x, uint32_t y)
{
    const struct image_rgba planes = image_rgba(image);
    size_t pixel = (size_t)y * image->width + x;
    double colour[3];
    double best = -1;
    uint32_t object = 0;
    for (int c = 0; c < 3; c++) {
        colour[c] = (double)planes.plane[c][pixel];
    }
    for (uint32_t n = 1; n <= 6 && planes.plane[3][pixel] > 0.5F; n++) {
        double own[3];
        for (int c = 0; c < 3; c++) {
            double srgb = scene->atlas->objects[n - 1].rgb[c] / 255.0;
            own[c] = srgb <= 0.04045 ? srgb / 12.92 : pow((srgb + 0.055) / 1.055, 2.4);
        }
        double alike = vec3_dot(own, colour) / vec3_length(own) / vec3_length(colour);
        if (alike > best) {
            best = alike;
            object = n;
        }
    }
    return object;
}

/* The first object on the way from the middle of an edge to the middle of the picture. */
static uint32_t first_from(const struct scene *scene, const conus_image *image, int dx, int dy)
{
    long x = dx > 0 ? 0 : dx < 0 ? WIDTH - 1 : WIDTH / 2;
    long y = dy > 0 ? 0 : dy < 0 ? HEIGHT - 1 : HEIGHT / 2;
    uint32_t object = 0;
    while (!object) {
        x += dx;
        y += dy;
        object = object_at(scene, image, (uint32_t)(x + dx), (uint32_t)(y + dy)); /* one pixel in: no blended edge */
    }
    return object;
}

/* The view of a person who stands on that side, with superior up; from above and below, with anterior up. */
static void each_side_shows_what_is_there(void **state)
{
    static const struct {
        conus_side side;
        uint32_t middle, left, right, top, bottom;
    } cases[] = {
        {CONUS_SIDE_LEFT, 2, 3, 4, 5, 6}, {CONUS_SIDE_RIGHT, 1, 4, 3, 5, 6}, {CONUS_SIDE_FRONT, 3, 1, 2, 5, 6},
        {CONUS_SIDE_BACK, 4, 2, 1, 5, 6}, {CONUS_SIDE_TOP, 5, 2, 1, 3, 4},   {CONUS_SIDE_BOTTOM, 6, 1, 2, 3, 4},
    };
    struct scene scene = need_scene(state);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        conus_image *image = render(
            &scene, (conus_view){.side = cases[i].side, .no_legend = true, .background = CONUS_BACKGROUND_TRANSPARENT});
        assert_int_equal(object_at(&scene, image, WIDTH / 2, HEIGHT / 2), cases[i].middle);
        assert_int_equal(first_from(&scene, image, 1, 0), cases[i].left);
        assert_int_equal(first_from(&scene, image, -1, 0), cases[i].right);
        assert_int_equal(first_from(&scene, image, 0, 1), cases[i].top);
        assert_int_equal(first_from(&scene, image, 0, -1), cases[i].bottom);
        conus_image_destroy(image);
    }
}

/* Darkness of a pixel on white paper. */
static double ink_at(const conus_image *image, uint32_t x, uint32_t y)
{
    return 1 - (double)conus_image_floats(image, "R")[(size_t)y * image->width + x];
}

struct box {
    uint32_t left, top, right, bottom; /* the last two are one past the end */
};

/* The smallest box around the ink in `in`. */
static struct box shrink(const conus_image *image, struct box in)
{
    struct box box = {in.right, in.bottom, in.left, in.top};
    for (uint32_t y = in.top; y < in.bottom; y++) {
        for (uint32_t x = in.left; x < in.right; x++) {
            if (ink_at(image, x, y) > 0.5) {
                box.left = x < box.left ? x : box.left;
                box.top = y < box.top ? y : box.top;
                box.right = x >= box.right ? x + 1 : box.right;
                box.bottom = y >= box.bottom ? y + 1 : box.bottom;
            }
        }
    }
    return box;
}

static double ink_in(const conus_image *image, struct box box)
{
    double sum = 0;
    for (uint32_t y = box.top; y < box.bottom; y++) {
        for (uint32_t x = box.left; x < box.right; x++) {
            sum += ink_at(image, x, y);
        }
    }
    return sum;
}

/* The part of the ink in the upper right quarter of the letter at the left or right edge: an L has none there; R, A and
 * P have. *all becomes the whole letter's ink. */
static double quarter_ink(double *all, const conus_image *image, bool at_right)
{
    uint32_t tenth = image->width / 10;
    const struct box edge = {at_right ? image->width - tenth : 0, image->height / 3, at_right ? image->width : tenth,
                             image->height * 2 / 3};
    struct box letter = shrink(image, edge);
    *all = ink_in(image, edge);
    letter.left = (letter.left + letter.right) / 2 + 1;
    letter.bottom = (letter.top + letter.bottom) / 2;
    return ink_in(image, letter);
}

static void letters_tell_left_from_right(void **state)
{
    static const struct {
        conus_side side;
        bool left_is_l, right_is_l;
    } cases[] = {{CONUS_SIDE_FRONT, false, true},  {CONUS_SIDE_BACK, true, false},  {CONUS_SIDE_TOP, true, false},
                 {CONUS_SIDE_BOTTOM, false, true}, {CONUS_SIDE_LEFT, false, false}, {CONUS_SIDE_RIGHT, false, false}};
    struct scene scene = need_scene(state);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const conus_view view = {.side = cases[i].side,
                                 .width = 300,
                                 .height = 200,
                                 .background = CONUS_BACKGROUND_COLOUR,
                                 .background_rgb = {255, 255, 255}};
        conus_image *image = render(&scene, view);
        double left_all, right_all;
        double left = quarter_ink(&left_all, image, false);
        double right = quarter_ink(&right_all, image, true);
        assert_true(left_all > 10 && right_all > 10);
        assert_true((left < 0.02 * left_all) == cases[i].left_is_l);
        assert_true((right < 0.02 * right_all) == cases[i].right_is_l);
        conus_image_destroy(image);
    }
    conus_image *oblique = render(&scene, (conus_view){.width = 300,
                                                       .height = 200,
                                                       .background = CONUS_BACKGROUND_COLOUR,
                                                       .background_rgb = {255, 255, 255}});
    double all;
    quarter_ink(&all, oblique, false);
    assert_near(all, 0, 1e-6);
    conus_image_destroy(oblique);
}

/* A picture on a transparent background, laid over a colour, equals the picture on that colour. */
static void backgrounds_lie_behind(void **state)
{
    struct scene scene = need_scene(state);
    conus_view view = {.no_legend = true, .selection = scene.selection, .background = CONUS_BACKGROUND_TRANSPARENT};
    conus_image *clear = render(&scene, view);
    view.background = CONUS_BACKGROUND_COLOUR;
    memcpy(view.background_rgb, (uint8_t[]){255, 0, 188}, 3); /* 188 is 0.5029 of linear light */
    conus_image *pink = render(&scene, view);
    static const double linear[3] = {1, 0, 0.502886};
    const struct image_rgba a = image_rgba(clear);
    const struct image_rgba b = image_rgba(pink);
    size_t empty = 0;
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
        empty += a.plane[3][i] == 0;
        assert_true(b.plane[3][i] == 1);
        for (int c = 0; c < 3; c++) {
            double expected = (double)a.plane[c][i] + (1 - (double)a.plane[3][i]) * linear[c];
            assert_near((double)b.plane[c][i], expected, 1e-5);
        }
    }
    assert_true(empty > 1000 && a.plane[3][0] == 0);
    conus_image_destroy(clear);
    conus_image_destroy(pink);
}

static void assert_same_top(const conus_image *a, const conus_image *b, uint32_t width)
{
    for (int c = 0; c < 3; c++) {
        for (uint32_t y = 0; y < HEIGHT * 2; y++) {
            const float *row = image_rgba(a).plane[c] + (size_t)y * a->width;
            const float *other = image_rgba(b).plane[c] + (size_t)y * b->width;
            assert_memory_equal(row, other, width * sizeof *row);
        }
    }
}

static void a_legend_outside_leaves_the_drawing_alone(void **state)
{
    struct scene scene = need_scene(state);
    conus_view view = {.width = 2 * WIDTH,
                       .height = 2 * HEIGHT,
                       .side = CONUS_SIDE_LEFT,
                       .selection = scene.selection,
                       .background = CONUS_BACKGROUND_COLOUR,
                       .legend = CONUS_LEGEND_NONE};
    conus_image *none = render(&scene, view);
    view.legend = CONUS_LEGEND_BELOW;
    conus_image *below = render(&scene, view);
    assert_int_equal(conus_image_height(none), 2 * HEIGHT);
    assert_int_equal(conus_image_width(below), 2 * WIDTH);
    assert_true(conus_image_height(below) > 2 * HEIGHT + 50 && conus_image_height(below) <= 3 * HEIGHT);
    assert_same_top(none, below, 2 * WIDTH);
    view.legend = CONUS_LEGEND_RIGHT;
    conus_image *right = render(&scene, view);
    assert_int_equal(conus_image_width(right), 2 * WIDTH);
    assert_int_equal(conus_image_height(right), 2 * HEIGHT);
    conus_image_destroy(none);
    conus_image_destroy(below);
    conus_image_destroy(right);
}

/* How often the legend of a selection from the left says so. */
static size_t count_words(const struct scene *scene, conus_layers layers, const char *word)
{
    const conus_selector_options options = {.layers = layers};
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    size_t count = 0;
    assert_ok(conus_selector_create(&selector, scene->atlas, &options));
    assert_ok(conus_pose_toward(&pose, (double[]){-60, 0, 0}, (double[]){0, 0, 0}, NULL));
    assert_ok(conus_select(&selection, selector, &pose, 60));
    conus_image *image =
        render(scene, (conus_view){.width = 4 * WIDTH, .height = 4 * HEIGHT, .selection = selection, .shapes = true});
    for (size_t i = 0; i < image->list->count; i++) {
        const struct draw_item *item = &image->list->items[i];
        count += item->kind == DRAW_TEXT && strcmp(item->text, word) == 0;
    }
    conus_image_destroy(image);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return count;
}

/* Seen from 60 mm to the left, the left ball (centre at 40 mm, radius 8: 11.5 degrees to its rim) hides the right one
 * (80 mm, 5.7 degrees) and nothing else: with all layers there is one row more. */
static void occluded_objects_have_a_row_with_all_layers(void **state)
{
    struct scene scene = need_scene(state);
    assert_int_equal(count_words(&scene, CONUS_LAYERS_VISIBLE, "behind"), 0);
    assert_int_equal(count_words(&scene, CONUS_LAYERS_ALL, "behind"), 1);
}

/* The box around an item; around a text up to its capitals' height. */
static struct draw_box box_of(const struct draw_item *item)
{
    const double half = item->kind == DRAW_LINES ? item->width / 2 : 0;
    const double *from = item->points[0];
    if (item->kind == DRAW_TEXT) {
        return (struct draw_box){from[0], from[1] - 0.7 * item->width, from[0] + item->length, from[1]};
    }
    const double *to = item->points[1];
    return (struct draw_box){fmin(from[0], to[0]) - half, fmin(from[1], to[1]) - half, fmax(from[0], to[0]) + half,
                             fmax(from[1], to[1]) + half};
}

/* Number of pixels of the drawing, on a transparent background, in the box. */
static size_t drawn_in(const conus_image *image, const struct draw_box *box)
{
    const float *opacity = conus_image_floats(image, "A");
    size_t count = 0;
    for (uint32_t y = 0; y < conus_image_height(image); y++) {
        for (uint32_t x = 0; x < conus_image_width(image); x++) {
            bool is_in = x + 1 > box->left && x < box->right && y + 1 > box->top && y < box->bottom;
            count += is_in && opacity[(size_t)conus_image_width(image) * y + x] > 0;
        }
    }
    return count;
}

/* First and last column and row of the drawing. */
static void find_drawn(uint32_t low[2], uint32_t high[2], const conus_image *image)
{
    const float *opacity = conus_image_floats(image, "A");
    low[0] = low[1] = UINT32_MAX;
    high[0] = high[1] = 0;
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        const uint32_t at[2] = {(uint32_t)(i % image->width), (uint32_t)(i / image->width)};
        for (int a = 0; a < 2 && opacity[i] > 0; a++) {
            low[a] = at[a] < low[a] ? at[a] : low[a];
            high[a] = at[a] > high[a] ? at[a] : high[a];
        }
    }
}

/* Width and height of the drawing, pixels. */
static void find_extent(double out[2], const conus_image *image)
{
    uint32_t low[2];
    uint32_t high[2];
    find_drawn(low, high, image);
    for (int a = 0; a < 2; a++) {
        out[a] = (double)high[a] - low[a] + 1;
    }
}

/* A picture whose text is kept as shapes, so that its pixels are the drawing alone. */
static conus_image *render_shapes(const struct scene *scene, conus_view view)
{
    view.shapes = true;
    view.background = CONUS_BACKGROUND_TRANSPARENT;
    return render(scene, view);
}

static void assert_nothing_is_under_shapes(const conus_image *image)
{
    assert_true(image->list->count >= 4);
    for (size_t i = 0; i < image->list->count; i++) {
        const struct draw_box box = box_of(&image->list->items[i]);
        assert_true(box.left >= 0 && box.top >= 0 && box.right <= image->width && box.bottom <= image->height);
        assert_int_equal(drawn_in(image, &box), 0);
    }
}

/* 60 mm at 300 dpi are 709 pixels, with letters of 31. The drawing keeps two fifths of the width or height. */
static void scale_and_directions_lie_on_nothing(void **state)
{
    static const struct {
        uint32_t width, height;
        double dpi;
    } sizes[] = {{355, 266, 150}, {300, 225, 0}, {225, 300, 0}, {600, 200, 0}};
    struct scene scene = need_scene(state);
    conus_selection *selection = NULL;
    conus_pose pose;
    assert_ok(conus_pose_toward(&pose, (double[]){-40, 0, 0}, (double[]){0, 0, 0}, NULL));
    assert_ok(conus_select(&selection, scene.selector, &pose, 10));
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        for (int side = CONUS_SIDE_OF_CONE; side <= CONUS_SIDE_BOTTOM; side++) {
            const conus_view view = {.width = sizes[i].width,
                                     .height = sizes[i].height,
                                     .dpi = sizes[i].dpi,
                                     .side = (conus_side)side,
                                     .legend = CONUS_LEGEND_NONE,
                                     .selection = i % 2 ? selection : NULL};
            conus_image *image = render_shapes(&scene, view);
            assert_nothing_is_under_shapes(image);
            double extent[2];
            find_extent(extent, image);
            assert_true(fmax(extent[0] / view.width, extent[1] / view.height) > 0.4);
            conus_image_destroy(image);
        }
    }
    conus_selection_destroy(selection);
}

static double all(const double p[3])
{
    (void)p;
    return 1;
}

/* Seen from the front, a cube fills a square picture up to its margins: no corner is free, and the drawing shrinks. */
static void a_cube_makes_room_for_scale_and_directions(void **state)
{
    (void)state;
    test_need_gl();
    conus_volume_info grid = picture_grid((size_t[]){40, 40, 40}, (double[]){1, 1, 1}, picture_identity);
    struct scene scene = {.atlas = picture_atlas(&grid, all, NULL, NULL)};
    assert_ok(conus_renderer_create(&scene.renderer, scene.atlas, NULL));
    for (int side = CONUS_SIDE_OF_CONE; side <= CONUS_SIDE_BOTTOM; side++) {
        conus_image *image = render_shapes(&scene, (conus_view){.width = 300, .height = 300, .side = (conus_side)side});
        assert_nothing_is_under_shapes(image);
        conus_image_destroy(image);
    }
    conus_renderer_destroy(scene.renderer);
    conus_atlas_destroy(scene.atlas);
}

/* With a camera from the left, past the balls in front and above, scale and directions are in the lower right
 * corner. */
static void scale_and_directions_follow_a_given_camera(void **state)
{
    struct scene scene = need_scene(state);
    conus_pose camera;
    assert_ok(conus_pose_toward(&camera, (double[]){-150, 38, 18}, (double[]){0, 38, 18}, NULL));
    conus_image *image = render_shapes(&scene, (conus_view){.width = 400, .height = 300, .camera = &camera});
    const struct draw_box corner = {300, 200, 400, 300};
    assert_true(drawn_in(image, &corner) > 100);
    assert_nothing_is_under_shapes(image);
    conus_image_destroy(image);
}

/* 18 mm before its middle a ball of radius 8 spans 52 degrees: all of a square picture of 30 degrees. */
static void without_free_corners_scale_and_directions_have_patches(void **state)
{
    struct scene scene = need_scene(state);
    conus_pose camera;
    assert_ok(conus_pose_toward(&camera, (double[]){-38, 0, 0}, (double[]){0, 0, 0}, NULL));
    conus_image *image = render_shapes(&scene, (conus_view){.width = 300, .height = 300, .camera = &camera});
    size_t patches = 0;
    for (size_t i = 0; i < image->list->count; i++) {
        patches += image->list->items[i].kind == DRAW_BOX;
    }
    assert_int_equal(patches, 5); /* for four letters and the bar */
    conus_image_destroy(image);
}

/* Segments of an axis from the left, which passes the left ball, then the right one. */
static conus_table *follow_in(const struct scene *scene, conus_space space)
{
    conus_selector *selector = NULL;
    conus_table *segments = NULL;
    conus_frame frame;
    conus_pose pose;
    assert_ok(conus_pose_toward(&pose, (double[]){-60, 0, 0}, (double[]){0, 0, 0}, NULL));
    assert_ok(conus_frame_find(&frame, NULL, space, NULL));
    assert_ok(conus_selector_create(&selector, scene->atlas, &(conus_selector_options){.frame = &frame}));
    assert_ok(conus_segments(&segments, selector, &pose));
    conus_selector_destroy(selector);
    return segments;
}

static conus_table *follow(const struct scene *scene)
{
    return follow_in(scene, CONUS_SPACE_RAS);
}

/* First and last column of a row with the object's colour. */
static void columns_of(double out[2], const struct scene *scene, const conus_image *image, uint32_t object)
{
    out[0] = out[1] = -1;
    for (uint32_t x = 0; x < image->width; x++) {
        if (object_at(scene, image, x, image->height / 2) == object) {
            out[0] = out[0] < 0 ? x : out[0];
            out[1] = x + 1;
        }
    }
}

/* From the front the left ball is on the right. The line has a ball's colour for the length of the ball, and shows
 * through objects in front of it. Balls that it does not pass are not drawn. */
static void a_probe_is_a_line_in_the_colours_of_what_it_passes(void **state)
{
    struct scene scene = need_scene(state);
    conus_table *segments = follow(&scene);
    const conus_drawn_probe probe = {"P", segments};
    conus_image *image = render_shapes(&scene, (conus_view){.width = 600,
                                                            .height = 300,
                                                            .side = CONUS_SIDE_FRONT,
                                                            .no_pale = true,
                                                            .no_legend = true,
                                                            .probes = &probe,
                                                            .probe_count = 1});
    assert_int_equal(image->list->count, 4); /* casing, all of it, and two balls */
    for (uint32_t n = 1; n <= 2; n++) {
        const struct draw_item *line = &image->list->items[4 - n];
        double columns[2];
        columns_of(columns, &scene, image, n);
        assert_int_equal(line->kind, DRAW_LINES);
        assert_near(line->points[0][0], columns[1], 2);
        assert_near(line->points[1][0], columns[0], 2);
        assert_true(line->points[0][0] - line->points[1][0] > 30);
        assert_near(line->points[0][1], 150, 1);
    }
    assert_int_equal(object_at(&scene, image, 300, 150), 0); /* the ball at the front would be here */
    conus_image_destroy(image);
    conus_table_destroy(segments);
}

static void probes_that_cannot_be_drawn_are_refused(void **state)
{
    struct scene scene = need_scene(state);
    conus_table *segments = follow(&scene);
    const conus_drawn_probe probes[3] = {{"P", segments}, {"Q", segments}, {"R", segments}};
    const conus_drawn_probe empty = {"P", NULL};
    const conus_drawn_probe turned = {"P", follow_in(&scene, CONUS_SPACE_LPS)};
    const conus_view views[] = {{.probes = probes, .probe_count = 1, .selection = scene.selection},
                                {.probes = &empty, .probe_count = 1},
                                {.probes = &turned, .probe_count = 1},
                                {.probe_count = 1},
                                {.probes = probes, .probe_count = 3, .width = 200, .height = 400}};
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        conus_image *image = NULL;
        assert_fails(conus_render(&image, scene.renderer, &views[i]), CONUS_ERROR_ARGUMENT);
        assert_null(image);
    }
    conus_table_destroy((conus_table *)turned.segments);
    conus_table_destroy(segments);
}

static void points_that_cannot_be_drawn_are_refused(void **state)
{
    struct scene scene = need_scene(state);
    conus_table *segments = follow(&scene);
    const conus_drawn_probe probe = {"P", segments};
    const conus_drawn_point points[] = {
        {.at = {0, 0, 0}}, {.at = {NAN, 0, 0}}, {.at = {0, INFINITY, 0}}, {.radius = -1}, {.radius = NAN}};
    const conus_view views[] = {{.points = points, .point_count = 1, .probes = &probe, .probe_count = 1},
                                {.points = points + 1, .point_count = 1},
                                {.points = points + 2, .point_count = 1},
                                {.points = points + 3, .point_count = 1},
                                {.points = points + 4, .point_count = 1},
                                {.point_count = 1}};
    static const conus_cut_plane plane = {.right = {1, 0, 0}, .up = {0, 1, 0}};
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        conus_image *image = NULL;
        assert_fails(conus_render(&image, scene.renderer, &views[i]), CONUS_ERROR_ARGUMENT);
        assert_fails(conus_render_cuts(&image, scene.atlas, &plane, 1, NULL, NULL, &views[i]), CONUS_ERROR_ARGUMENT);
        assert_null(image);
    }
    conus_table_destroy(segments);
}

/* The camera looks from the left at balls of 2 mm: that at 0 is in the middle, the other 90 pixels to its right. A
 * picture of points alone is empty but for the balls, which have the same pixels as over the drawing; in a cut
 * likewise. With a selection they are white, since colours are those of its answer. */
static void points_alone_are_those_over_a_drawing(void **state)
{
    struct scene scene = need_scene(state);
    static const conus_drawn_point points[] = {{.group = "a", .end = {NAN}, .radius = 2},
                                               {.group = "b", .at = {0, -18, 0}, .end = {NAN}, .radius = 2}};
    conus_pose camera;
    assert_ok(conus_pose_toward(&camera, (double[]){-100, 0, 0}, (double[]){0, 0, 0}, NULL));
    conus_view view = {.width = 200,
                       .height = 200,
                       .camera = &camera,
                       .frustum = {-0.2, 0.2, -0.2, 0.2},
                       .no_legend = true,
                       .points = points,
                       .point_count = 2};
    const conus_cut_view cut = {.mm_per_pixel = 0.2, .right = {0, -1, 0}, .up = {0, 0, 1}};
    for (int which = 0; which < 3; which++) { /* in space, in a cut, and with a selection */
        conus_image *alone = NULL;
        conus_image *over = NULL;
        view.selection = which == 2 ? scene.selection : NULL;
        view.no_cone = which == 2;
        assert_ok(conus_points_image(&alone, scene.atlas, &view, which == 1 ? &cut : NULL, SIZE_MAX));
        if (which == 1) {
            conus_cut_view same = cut;
            same.width = same.height = 200;
            assert_ok(conus_cut_image(&over, scene.atlas, &same, &view));
        } else {
            assert_ok(conus_render(&over, scene.renderer, &view));
        }
        const float *alpha = conus_image_floats(alone, "A");
        const size_t middles[] = {100 * 200 + 100, 100 * 200 + 190};
        for (int n = 0; n < 2; n++) {
            assert_near((double)alpha[middles[n]], 1, 1e-6);
            for (const char *c = "RGB"; *c; c++) {
                const float value = conus_image_floats(alone, (char[]){*c, 0})[middles[n]];
                assert_near((double)value, (double)conus_image_floats(over, (char[]){*c, 0})[middles[n]], 1e-6);
                assert_true(which < 2 || n || value > 0.99F);
            }
        }
        size_t drawn = 0;
        for (size_t p = 0; p < (size_t)200 * 200; p++) {
            drawn += alpha[p] > 0;
        }
        assert_true(drawn > 300 && drawn < 2000); /* of discs of some 10 pixels, whole and with dark edges */
        assert_true(alpha[50 * 200 + 50] == 0);
        conus_image_destroy(alone);
        conus_image_destroy(over);
    }
    conus_image *none = NULL;
    view.camera = NULL;
    assert_fails(conus_points_image(&none, scene.atlas, &view, NULL, SIZE_MAX), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_points_image(&none, scene.atlas, &view, &(conus_cut_view){.mm_per_pixel = 0}, SIZE_MAX),
                 CONUS_ERROR_ARGUMENT);
    assert_null(none);
}

/* The most that is drawn in a column of the image, in its rows from `from` on. */
static double most_in_column(const conus_image *image, size_t column, size_t from, size_t rows)
{
    const float *alpha = conus_image_floats(image, "A");
    double most = 0;
    for (size_t row = from; row < from + rows; row++) {
        most = fmax(most, (double)alpha[row * conus_image_width(image) + column]);
    }
    return most;
}

/* The cut at x = 0 has 5 pixels for a mm; y = 0 is in the middle, and less of it to the right. The first needle is 2 mm
 * from it, and so firm, for y from -1 to 1, and 25 mm for y from -12.5 to 12.5: its ball at y = -15 is not drawn. The
 * second lies in the cut, and the third begins 5 mm before it and leads away. */
static void a_needle_is_firm_where_it_is_in_a_cut(void **state)
{
    struct scene scene = need_scene(state);
    static const conus_drawn_point points[] = {{.at = {-30, -15, -10}, .end = {30, 15, -10}, .radius = 1},
                                               {.at = {1, -8, 0}, .end = {1, 8, 0}, .radius = 1},
                                               {.at = {5, -10, 10}, .end = {20, 10, 10}, .radius = 1}};
    const conus_cut_view cut = {.mm_per_pixel = 0.2, .right = {0, -1, 0}, .up = {0, 0, 1}};
    const conus_view view = {.width = 200, .height = 200, .no_legend = true, .points = points, .point_count = 3};
    conus_image *image = NULL;
    assert_ok(conus_points_image(&image, scene.atlas, &view, &cut, SIZE_MAX));
    const bool is_up = most_in_column(image, 100, 40, 20) > 0; /* the order of rows: z = -10 is 50 rows from z = 0 */
    const size_t first = is_up ? 40 : 140;
    const size_t third = is_up ? 140 : 40;
    for (size_t column = 0; column < 200; column++) {
        const double y = (100 - (double)column - 0.5) * 0.2;
        const double through = most_in_column(image, column, first, 20);
        const double within = most_in_column(image, column, 90, 20);
        if (fabs(y) < 1) {
            assert_true(through > 0.99);
        } else if (fabs(y) > 2 && fabs(y) < 12) { /* with round ends */
            assert_true(through > 0.05 && through < 0.5);
        } else if (fabs(y) > 13.5) {
            assert_true(through == 0);
        }
        assert_true(fabs(y) < 7.5 ? within > 0.99 : fabs(y) < 9.8 || within == 0);
        assert_true(most_in_column(image, column, third, 20) == 0);
    }
    conus_image_destroy(image);
}

/* What a needle without a name draws is as it is beside its name, whichever way it goes from its ball. */
static void a_name_stands_beside_its_needle(void **state)
{
    struct scene scene = need_scene(state);
    static const double ends[][3] = {{0, -30, 0}, {0, 30, 0}, {0, -30, 4}, {9, -30, -4}};
    const conus_cut_view cut = {.mm_per_pixel = 0.5, .right = {0, -1, 0}, .up = {0, 0, 1}};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        conus_image *images[2] = {NULL};
        size_t differing = 0;
        for (size_t n = 0; n < 2; n++) {
            const conus_drawn_point point = {
                .name = n ? "AAAAAA" : NULL, .end = {ends[i][0], ends[i][1], ends[i][2]}, .radius = 1};
            const conus_view view = {.width = 160,
                                     .height = 100,
                                     .dpi = 12.0 * 72 / LOOK_FIGURE_POINTS,
                                     .legend = CONUS_LEGEND_NONE,
                                     .points = &point,
                                     .point_count = 1};
            assert_ok(conus_points_image(&images[n], scene.atlas, &view, &cut, SIZE_MAX));
        }
        for (size_t p = 0; p < (size_t)160 * 100; p++) {
            const float *bare = conus_image_floats(images[0], "R"), *named = conus_image_floats(images[1], "R");
            assert_true(conus_image_floats(images[0], "A")[p] < 0.99F || bare[p] == named[p]);
            differing += bare[p] != named[p];
        }
        assert_true(differing > 20);
        conus_image_destroy(images[0]);
        conus_image_destroy(images[1]);
    }
}

/* Two names at one place, in a picture with room for one: it is that of the end of the list, as if the other one had no
 * name, but that of the chosen one where one is chosen. */
static void a_chosen_point_has_its_name_first(void **state)
{
    struct scene scene = need_scene(state);
    const conus_cut_view cut = {.mm_per_pixel = 1, .right = {0, -1, 0}, .up = {0, 0, 1}};
    const struct {
        const char *end, *middle;
        size_t chosen;
    } pictures[] = {
        {"AAAAAA", NULL, SIZE_MAX}, {"AAAAAA", "BBBBBB", SIZE_MAX}, {NULL, "BBBBBB", 1}, {"AAAAAA", "BBBBBB", 1}};
    conus_image *images[4] = {NULL};
    size_t differing = 0; /* pixels of one name and of the other */
    for (size_t i = 0; i < 4; i++) {
        const conus_drawn_point points[] = {{.name = pictures[i].end, .at = {0, 40, 0}, .end = {NAN}, .radius = 2},
                                            {.name = pictures[i].middle, .at = {0, 40, 0}, .end = {NAN}, .radius = 2},
                                            {.at = {0, 40, 0}, .end = {NAN}, .radius = 2}};
        const conus_view view = {.width = 100,
                                 .height = 30,
                                 .dpi = 16.0 * 72 / LOOK_FIGURE_POINTS,
                                 .legend = CONUS_LEGEND_NONE,
                                 .points = points,
                                 .point_count = 3};
        assert_ok(conus_points_image(&images[i], scene.atlas, &view, &cut, pictures[i].chosen));
    }
    for (size_t p = 0; p < (size_t)100 * 30; p++) {
        for (size_t pair = 0; pair < 2; pair++) {
            assert_near((double)conus_image_floats(images[2 * pair], "A")[p],
                        (double)conus_image_floats(images[2 * pair + 1], "A")[p], 1e-6);
            assert_near((double)conus_image_floats(images[2 * pair], "R")[p],
                        (double)conus_image_floats(images[2 * pair + 1], "R")[p], 1e-6);
        }
        differing += conus_image_floats(images[0], "R")[p] != conus_image_floats(images[2], "R")[p];
    }
    assert_true(differing > 20);
    for (size_t i = 0; i < 4; i++) {
        conus_image_destroy(images[i]);
    }
}

/* All of a colour shows with half of the cone, 0.4 of it with a fiftieth, between them in eight steps; and the picture
 * has that colour, mixed with the grey of what is not hit. */
static void colours_are_weighted_by_share(void **state)
{
    struct scene scene = need_scene(state);
    static const uint8_t second[3] = {LOOK_RGB(LOOK_RANK_2)}, grey[3] = {LOOK_RGB(LOOK_NOT_HIT)};
    conus_selection *selection = NULL;
    conus_pose pose;
    bool has_weak = false;
    assert_ok(conus_pose_toward(&pose, (double[]){-30, -60, 0}, (double[]){-14, 0, 0}, NULL));
    assert_ok(conus_select(&selection, scene.selector, &pose, 50));
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        const double part = fmin(fmax((result->share - 0.02) / 0.48, 0), 1);
        const double weight = conus_selection_weight(selection, result->object);
        assert_true(!result->object || fabs(weight - (0.4 + 0.6 * part)) <= 0.6 / 16 + 1e-9);
        assert_near(fabs(remainder((weight - 0.4) / 0.6, 0.125)), 0, 1e-9);
        has_weak = has_weak || (conus_selection_rank(selection, result->object) == 2 && weight < 1);
        if (conus_selection_rank(selection, result->object) == 2) {
            uint8_t(*rgb)[3] = NULL;
            uint32_t *ranks = picture_ranks(selection);
            rgb = picture_rank_colours(ranks, scene.atlas, LOOK_NOT_HIT, NULL, selection);
            for (int c = 0; c < 3; c++) {
                assert_near(rgb[result->object][c], weight * second[c] + (1 - weight) * grey[c], 0.51);
            }
            memory_free(ranks);
            memory_free(rgb);
        }
    }
    assert_true(has_weak);
    assert_near(conus_selection_weight(NULL, 1), 1, 0);
    assert_near(conus_selection_weight(selection, 0), 1, 0);
    conus_selection_destroy(selection);
}

/* A ball has neither a cone nor a legend: without these what it meets is coloured. */
static void a_ball_colours_what_is_in_it(void **state)
{
    struct scene scene = need_scene(state);
    conus_selection *ball = NULL;
    conus_image *image = NULL;
    assert_ok(conus_select_ball(&ball, scene.selector, (double[]){-20, 0, 0}, 4));
    conus_view view = {.width = 200, .height = 200, .side = CONUS_SIDE_LEFT, .selection = ball};
    assert_fails(conus_render(&image, scene.renderer, &view), CONUS_ERROR_ARGUMENT);
    view.no_cone = true;
    assert_fails(conus_render(&image, scene.renderer, &view), CONUS_ERROR_ARGUMENT);
    view.legend = CONUS_LEGEND_NONE;
    assert_ok(conus_render(&image, scene.renderer, &view));
    const size_t middle = 100 * 200 + 100;
    assert_true(conus_image_floats(image, "R")[middle] > 2 * conus_image_floats(image, "G")[middle]); /* rank 1 */
    conus_image_destroy(image);
    conus_selection_destroy(ball);
}

/* The first six groups have the colours of the ranks, which look.h has; the seventh and eighth are grey together, and
 * the legend has a row for each of twelve groups, of fifteen for eleven and one for the rest. */
static void groups_of_points_have_colours_and_rows(void **state)
{
    static const uint8_t wanted[][3] = {{LOOK_RGB(LOOK_RANK_1)},    {LOOK_RGB(LOOK_RANK_2)},   {LOOK_RGB(LOOK_RANK_3)},
                                        {LOOK_RGB(LOOK_RANK_4)},    {LOOK_RGB(LOOK_RANK_5)},   {LOOK_RGB(LOOK_RANK_6)},
                                        {LOOK_RGB(LOOK_RANK_MORE)}, {LOOK_RGB(LOOK_RANK_MORE)}};
    static const char *const groups[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l", "m", "n", "o"};
    struct scene scene = need_scene(state);
    conus_drawn_point points[15];
    for (size_t i = 0; i < 15; i++) { /* nearer than the middle to whom looks from above, so that none is pale */
        points[i] = (conus_drawn_point){.group = groups[i], .at = {(double)i - 7, 0, 25}, .end = {NAN, 0, 0}};
    }
    for (size_t count = 12; count <= 15; count += 3) {
        conus_image *image = render(&scene, (conus_view){.points = points,
                                                         .point_count = count,
                                                         .side = CONUS_SIDE_TOP,
                                                         .shapes = true,
                                                         .width = 600,
                                                         .height = 400});
        size_t rows = 0;
        size_t discs = 0;
        bool has_rest = false;
        for (size_t i = 0; i < image->list->count; i++) {
            const struct draw_item *item = &image->list->items[i];
            if (item->kind == DRAW_TEXT) {
                rows += strlen(item->text) == 1 && item->text[0] >= 'a' && item->text[0] <= 'o';
                has_rest = has_rest || strcmp(item->text, "and 4 other groups") == 0;
            } else if (item->kind == DRAW_LINES && item->points[0][0] == item->points[1][0] &&
                       item->points[0][1] == item->points[1][1]) {
                const size_t ball = discs++ / 2;
                if (discs % 2 == 0 && ball < 8) { /* behind its edge; all are equally deep, so in their order */
                    float rgba[4];
                    draw_colour(rgba, wanted[ball], 1);
                    assert_memory_equal(item->rgba, rgba, sizeof rgba);
                }
            }
        }
        assert_int_equal(discs, 2 * count);
        assert_int_equal(rows, count == 12 ? 12 : 11);
        assert_int_equal(has_rest, count == 15);
        conus_image_destroy(image);
    }
}

/* A ball is two discs, its edge and its colour; one whose row has no answer is a ring: a third disc, as dark as the
 * edge and smaller than both, is in its middle. */
static void a_row_without_an_answer_is_a_ring(void **state)
{
    struct scene scene = need_scene(state);
    conus_drawn_point point = {.at = {0, 0, 25}, .end = {NAN, 0, 0}};
    for (int is_hollow = 0; is_hollow < 2; is_hollow++) {
        point.hollow = is_hollow;
        conus_image *image = render(&scene, (conus_view){.points = &point,
                                                         .point_count = 1,
                                                         .side = CONUS_SIDE_TOP,
                                                         .no_legend = true,
                                                         .shapes = true,
                                                         .width = 600,
                                                         .height = 400});
        const struct draw_item *discs[3] = {NULL};
        size_t count = 0;
        for (size_t i = 0; i < image->list->count; i++) {
            const struct draw_item *item = &image->list->items[i];
            bool is_disc = item->kind == DRAW_LINES && item->points[0][0] == item->points[1][0] &&
                           item->points[0][1] == item->points[1][1];
            if (is_disc) {
                assert_true(count < 3);
                discs[count++] = item;
            }
        }
        assert_int_equal(count, 2 + is_hollow);
        if (is_hollow) {
            assert_memory_equal(discs[2]->rgba, discs[0]->rgba, sizeof discs[0]->rgba);
            assert_true(discs[2]->width < discs[1]->width && discs[1]->width < discs[0]->width);
        }
        conus_image_destroy(image);
    }
}

static const uint8_t *find_bytes(const uint8_t *data, size_t size, const char *word)
{
    size_t length = strlen(word);
    for (size_t i = 0; i + length <= size; i++) {
        if (memcmp(data + i, word, length) == 0) {
            return data + i;
        }
    }
    return NULL;
}

/* 300 pixels per 25.4 mm are 11811 per metre, 0x2e23; PNG says it big-endian with the unit 1, OpenEXR as a float in
 * little-endian bytes: 300 = 0x43960000. */
static void files_say_how_large_they_are(void **state)
{
    struct scene scene = need_scene(state);
    conus_image *image = render(&scene, (conus_view){.dpi = 300});
    conus_image *plain = render(&scene, (conus_view){.no_legend = true});
    const uint8_t *data = NULL;
    size_t size = 0;
    assert_ok(conus_image_encode(&data, &size, image, "png"));
    const uint8_t *chunk = find_bytes(data, size, "pHYs");
    assert_non_null(chunk);
    assert_memory_equal(chunk + 4, ((uint8_t[]){0, 0, 0x2e, 0x23, 0, 0, 0x2e, 0x23, 1}), 9);
    assert_ok(conus_image_encode(&data, &size, image, "exr"));
    chunk = find_bytes(data, size, "xDensity");
    assert_non_null(chunk);
    assert_memory_equal(chunk, "xDensity\0float\0\4\0\0\0\0\0\x96\x43", 23);
    assert_ok(conus_image_encode(&data, &size, plain, "png"));
    assert_null(find_bytes(data, size, "pHYs"));
    assert_ok(conus_image_encode(&data, &size, plain, "exr"));
    assert_null(find_bytes(data, size, "xDensity"));
    conus_image_destroy(image);
    conus_image_destroy(plain);
}

/* The camera's forward and the cone's axis are 60 degrees apart, cos 0.5, whichever way the cone points. What it hits
 * is seen from there: the drawing has the best hit's colour. The whole cone is in the picture: nothing of it is at its
 * edges. */
static void the_side_beside_the_cone_is_60_degrees_off(void **state)
{
    static const double from[][3] = {{-60, 0, 0}, {60, 10, 5}, {0, 70, 0}, {0, 0, 75}, {10, -40, -60}};
    struct scene scene = need_scene(state);
    for (size_t i = 0; i < sizeof from / sizeof *from; i++) {
        conus_selection *selection = NULL;
        conus_pose pose;
        assert_ok(conus_pose_toward(&pose, from[i], (double[]){0, 0, 0}, NULL));
        assert_ok(conus_select(&selection, scene.selector, &pose, 20));
        const conus_view view = {.side = CONUS_SIDE_BESIDE_CONE,
                                 .width = 400,
                                 .height = 300,
                                 .legend = CONUS_LEGEND_NONE,
                                 .own_colours = true,
                                 .selection = selection};
        conus_image *image = render_shapes(&scene, view);
        const struct image_attribute *camera = image_find_attribute(image, "conus:worldFromCamera");
        assert_non_null(camera);
        double cosine = 0;
        for (int a = 0; a < 3; a++) {
            cosine += (double)camera->matrix[8 + a] * pose.world_from_device[8 + a];
        }
        assert_near(cosine, 0.5, 1e-5);
        const uint32_t best = conus_selection_result(selection, 0)->object;
        size_t seen = 0;
        for (uint32_t p = 0; p < 400 * 300; p++) {
            const uint32_t x = p % 400;
            const uint32_t y = p / 400;
            bool is_edge = x == 0 || y == 0 || x == 399 || y == 299;
            seen += object_at(&scene, image, x, y) == best;
            assert_true(!is_edge || image_rgba(image).plane[3][p] == 0);
        }
        assert_true(best && seen > 200);
        conus_image_destroy(image);
        conus_selection_destroy(selection);
    }
}

/* Whether a pixel within so many of another one is transparent by half. */
static bool is_near_nothing(const float *opacity, int x, int y, int reach)
{
    bool found = false;
    for (int dy = -reach; dy <= reach; dy++) {
        for (int dx = -reach; dx <= reach; dx++) {
            const int at[2] = {x + dx, y + dy};
            bool is_in = dx * dx + dy * dy <= reach * reach && at[0] >= 0 && at[1] >= 0 && at[0] < 400 && at[1] < 300;
            found = found || (is_in && opacity[400 * at[1] + at[0]] <= 0.5F);
        }
    }
    return found;
}

/* In print the pixels along what is drawn are darker, and only these: half a point has 2.08 pixels at 300 dpi, which
 * end within 3. */
static void on_paper_a_line_runs_around_the_drawing(void **state)
{
    struct scene scene = need_scene(state);
    conus_image *images[2];
    size_t edges = 0;
    for (int n = 0; n < 2; n++) {
        images[n] = render_shapes(&scene, (conus_view){.width = 400, .height = 300, .dpi = 300, .print = n == 1});
    }
    const struct image_rgba plain = image_rgba(images[0]);
    const struct image_rgba lined = image_rgba(images[1]);
    for (int y = 0; y < 300; y++) {
        for (int x = 0; x < 400; x++) {
            const size_t i = (size_t)400 * (size_t)y + (size_t)x;
            double before = 0;
            double after = 0;
            for (int c = 0; c < 3; c++) {
                before += (double)plain.plane[c][i];
                after += (double)lined.plane[c][i];
            }
            assert_true(plain.plane[3][i] == lined.plane[3][i]);
            assert_true(before == after || is_near_nothing(plain.plane[3], x, y, 3));
            bool is_edge = plain.plane[3][i] > 0.99F && before > 0.6 && is_near_nothing(plain.plane[3], x, y, 1);
            edges += is_edge;
            assert_true(!is_edge || after < before);
        }
    }
    assert_true(edges > 100);
    conus_image_destroy(images[0]);
    conus_image_destroy(images[1]);
}

/* Twice the pixels per inch on twice the pixels give the same sheet, legend included, to a few pixels. */
static void letters_grow_with_the_resolution(void **state)
{
    struct scene scene = need_scene(state);
    uint32_t extra[2];
    for (uint32_t times = 1; times <= 2; times++) {
        conus_image *image = render(&scene, (conus_view){.width = 200 * times,
                                                         .height = 150 * times,
                                                         .dpi = 60 * times,
                                                         .selection = scene.selection,
                                                         .legend = CONUS_LEGEND_BELOW});
        extra[times - 1] = conus_image_height(image) - (150 * times);
        conus_image_destroy(image);
    }
    assert_near(extra[1], 2.0 * extra[0], 6);
}

/* At 200 mm before the eye, in a picture of 300 pixels over 60 degrees: 1.299 pixels per mm. */
static void a_measured_distance_is_drawn(void **state)
{
    static const double places[6] = {-30, 0, 10, 30, 0, 10};
    const double scale = 150 / (200 * tan(radians_from_degrees(30)));
    struct scene scene = need_scene(state);
    conus_pose camera;
    conus_image *image = NULL;
    size_t lines = 0;
    size_t texts = 0;
    assert_ok(conus_pose_toward(&camera, (double[]){0, -200, 0}, (double[]){0, 0, 0}, NULL));
    for (int behind = 0; behind < 2; behind++) { /* the camera: no line */
        const conus_view view = {.width = 400,
                                 .height = 300,
                                 .camera = &camera,
                                 .field_of_view = 60,
                                 .shapes = true,
                                 .measured = behind ? (double[]){-30, 0, 10, 30, -201, 10} : places};
        image = render(&scene, view);
        for (size_t i = 0; i < image->list->count; i++) {
            const struct draw_item *item = &image->list->items[i];
            if (item->kind == DRAW_LINES && fabs(item->points[1][0] - item->points[0][0] - 60 * scale) < 1e-6) {
                assert_near(item->points[0][0], 200 - 30 * scale, 1e-6);
                assert_near(item->points[0][1], 150 - 10 * scale, 1e-6);
                assert_near(item->points[1][1], item->points[0][1], 1e-6);
                lines++;
            }
            texts += item->kind == DRAW_TEXT && strcmp(item->text, "60.00 mm") == 0;
        }
        conus_image_destroy(image);
    }
    assert_int_equal(lines, 2); /* light on dark */
    assert_int_equal(texts, 1);
}

/* At right angles to the axis, and 25 degrees from above where such a direction is among these. */
static void the_side_across_the_cone_is_at_right_angles(void **state)
{
    static const double from[][4] = {
        {-60, 0, 0, 25}, {60, 10, 5, 25}, {0, 70, 0, 25}, {0, 0, 75, 0}, {10, -40, -60, 25}};
    struct scene scene = need_scene(state);
    for (size_t i = 0; i < sizeof from / sizeof *from; i++) {
        conus_selection *selection = NULL;
        conus_image *image = NULL;
        conus_pose pose;
        double cosine = 0;
        assert_ok(conus_pose_toward(&pose, from[i], (double[]){0, 0, 0}, NULL));
        assert_ok(conus_select(&selection, scene.selector, &pose, 20));
        const conus_view view = {.side = CONUS_SIDE_ACROSS_CONE,
                                 .width = 200,
                                 .height = 150,
                                 .legend = CONUS_LEGEND_NONE,
                                 .selection = selection};
        image = render(&scene, view);
        const struct image_attribute *camera = image_find_attribute(image, "conus:worldFromCamera");
        for (int a = 0; a < 3; a++) {
            cosine += (double)camera->matrix[8 + a] * pose.world_from_device[8 + a];
        }
        assert_near(cosine, 0, 1e-5);
        assert_near(degrees_from_radians(asin((double)camera->matrix[10])), from[i][3], 0.6);
        conus_image_destroy(image);
        conus_selection_destroy(selection);
    }
}

static void views_out_of_range_are_refused(void **state)
{
    struct scene scene = need_scene(state);
    conus_pose camera;
    assert_ok(conus_pose_toward(&camera, (double[]){-150, 0, 0}, (double[]){0, 0, 0}, NULL));
    const conus_view views[] = {{.side = CONUS_SIDE_ACROSS_CONE + 1},
                                {.legend = CONUS_LEGEND_NONE + 1},
                                {.background = CONUS_BACKGROUND_TRANSPARENT + 1},
                                {.side = CONUS_SIDE_TOP, .camera = &camera},
                                {.dpi = -1},
                                {.dpi = NAN},
                                {.dpi = 100001}};
    conus_image *image = NULL;
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        assert_fails(conus_render(&image, scene.renderer, &views[i]), CONUS_ERROR_ARGUMENT);
        assert_null(image);
    }
    const conus_renderer_options little = {.max_memory = 2000000}; /* a picture of 400 x 300 takes 3,840,000 bytes */
    conus_renderer *renderer = NULL;
    assert_ok(conus_renderer_create(&renderer, scene.atlas, &little));
    assert_fails(conus_render(&image, renderer, &(conus_view){.width = 400, .height = 300}), CONUS_ERROR_MEMORY);
    assert_null(image);
    conus_renderer_destroy(renderer);
}

static conus_status attempt(void *data)
{
    const struct scene *scene = data;
    conus_image *image = NULL;
    const conus_view view = {
        .width = 64, .height = 48, .selection = scene->selection, .legend = CONUS_LEGEND_BELOW, .dpi = 100};
    conus_status status = conus_render(&image, scene->renderer, &view);
    assert_true((status == CONUS_OK) == (image != NULL));
    conus_image_destroy(image);
    return status;
}

struct probe_scene {
    const struct scene *scene;
    conus_drawn_probe probe;
};

static conus_status attempt_probe(void *data)
{
    const struct probe_scene *of = data;
    conus_image *image = NULL;
    const conus_view view = {.width = 240, .height = 80, .probes = &of->probe, .probe_count = 1};
    conus_status status = conus_render(&image, of->scene->renderer, &view);
    assert_true((status == CONUS_OK) == (image != NULL));
    conus_image_destroy(image);
    return status;
}

static const conus_drawn_point two_points[] = {{.name = "P1", .group = "P", .end = {10, 10, 10}, .radius = 2},
                                               {.name = "Q1", .at = {9, 0, 0}, .end = {NAN}}};

static conus_status attempt_points(void *data)
{
    static const conus_cut_plane plane = {.right = {1, 0, 0}, .up = {0, 1, 0}};
    const struct scene *scene = data;
    conus_image *image = NULL;
    static const conus_drawn_point marks[] = {{.end = {9, 9, 9}, .dashed = true}, {.radius = 3}, {.name = "M"}};
    const conus_view view = {
        .width = 200, .height = 80, .points = two_points, .point_count = 2, .marks = marks, .mark_count = 3};
    conus_status status = conus_render_cuts(&image, scene->atlas, &plane, 1, NULL, scene->renderer, &view);
    assert_true((status == CONUS_OK) == (image != NULL));
    conus_image_destroy(image);
    return status;
}

static conus_status attempt_points_alone(void *data)
{
    static const conus_cut_view cut = {.mm_per_pixel = 1};
    const struct scene *scene = data;
    conus_image *image = NULL;
    const conus_view view = {.width = 200, .height = 80, .points = two_points, .point_count = 2};
    conus_status status = conus_points_image(&image, scene->atlas, &view, &cut, 1);
    assert_true((status == CONUS_OK) == (image != NULL));
    conus_image_destroy(image);
    return status;
}

static void allocations_may_fail(void **state)
{
    struct scene scene = need_scene(state);
    test_every_allocation(attempt_points_alone, &scene);
    test_every_allocation(attempt_points, &scene);
    test_every_allocation(attempt, &scene);
    conus_table *segments = follow(&scene);
    struct probe_scene of = {&scene, {"P", segments}};
    test_every_allocation(attempt_probe, &of);
    conus_table_destroy(segments);
}

/* In a column of 85 mm at 300 dpi each letter is beside two of three cuts, and at the cross of the view in space. */
static void a_column_has_the_cross_of_directions(void **state)
{
    const struct scene scene = need_scene(state);
    static const conus_cut_plane planes[] = {{.right = {1, 0, 0}, .up = {0, 1, 0}},
                                             {.right = {1, 0, 0}, .up = {0, 0, 1}},
                                             {.right = {0, 1, 0}, .up = {0, 0, 1}}};
    static const char *const letters[] = {"L", "R", "P", "A", "I", "S"};
    const conus_view sheet = {.width = 1004, .dpi = 300, .print = true, .shapes = true, .selection = scene.selection};
    conus_image *image = NULL;
    assert_ok(conus_render_cuts(&image, scene.atlas, planes, 3, NULL, scene.renderer, &sheet));
    for (size_t n = 0; n < 6; n++) {
        size_t count = 0;
        for (size_t i = 0; i < image->list->count; i++) {
            const struct draw_item *item = &image->list->items[i];
            count += item->kind == DRAW_TEXT && strcmp(item->text, letters[n]) == 0;
        }
        assert_int_equal(count, 3);
    }
    conus_image_destroy(image);
}

TEST_GROUP(picture_figure)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_legend_is_in_the_space_asked_for),
        cmocka_unit_test(each_side_shows_what_is_there),
        cmocka_unit_test(letters_tell_left_from_right),
        cmocka_unit_test(backgrounds_lie_behind),
        cmocka_unit_test(a_legend_outside_leaves_the_drawing_alone),
        cmocka_unit_test(occluded_objects_have_a_row_with_all_layers),
        cmocka_unit_test(scale_and_directions_lie_on_nothing),
        cmocka_unit_test(a_cube_makes_room_for_scale_and_directions),
        cmocka_unit_test(scale_and_directions_follow_a_given_camera),
        cmocka_unit_test(without_free_corners_scale_and_directions_have_patches),
        cmocka_unit_test(a_probe_is_a_line_in_the_colours_of_what_it_passes),
        cmocka_unit_test(probes_that_cannot_be_drawn_are_refused),
        cmocka_unit_test(points_that_cannot_be_drawn_are_refused),
        cmocka_unit_test(points_alone_are_those_over_a_drawing),
        cmocka_unit_test(a_chosen_point_has_its_name_first),
        cmocka_unit_test(a_needle_is_firm_where_it_is_in_a_cut),
        cmocka_unit_test(a_name_stands_beside_its_needle),
        cmocka_unit_test(colours_are_weighted_by_share),
        cmocka_unit_test(a_ball_colours_what_is_in_it),
        cmocka_unit_test(groups_of_points_have_colours_and_rows),
        cmocka_unit_test(a_row_without_an_answer_is_a_ring),
        cmocka_unit_test(files_say_how_large_they_are),
        cmocka_unit_test(the_side_beside_the_cone_is_60_degrees_off),
        cmocka_unit_test(on_paper_a_line_runs_around_the_drawing),
        cmocka_unit_test(letters_grow_with_the_resolution),
        cmocka_unit_test(a_measured_distance_is_drawn),
        cmocka_unit_test(the_side_across_the_cone_is_at_right_angles),
        cmocka_unit_test(views_out_of_range_are_refused),
        cmocka_unit_test(a_column_has_the_cross_of_directions),
        cmocka_unit_test(allocations_may_fail),
    };
    return cmocka_run_group_tests(tests, make_scene, finish_scene);
}
