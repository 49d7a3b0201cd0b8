/* SPDX-License-Identifier: BSD-3-Clause */
/* Changes of a renderer between two pictures: hidden objects, transfer function, fading; and the cylinder, the other
 * shape of the cone. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "picture_scene.h"
#include "render/image/image.h"
#include "test.h"
#include "test_gl.h"
#include "value_maps.h"

#include <string.h>

enum { WIDTH = 160, HEIGHT = 120, PIXELS = WIDTH * HEIGHT };

static double two_boxes(const double p[3])
{
    bool inside = fabs(p[1]) < 8 && fabs(p[2]) < 8;
    return inside && p[0] > 4 && p[0] < 20 ? 2 : inside && p[0] < -4 && p[0] > -20 ? 1 : 0;
}

static conus_atlas *boxes(picture_function context)
{
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, picture_identity);
    return picture_atlas(&grid, two_boxes, NULL, context);
}

/* From the front, +x on the left of the picture. */
static conus_image *render(conus_renderer *renderer, conus_view view)
{
    conus_image *image = NULL;
    conus_pose camera;
    assert_ok(conus_pose_along(&camera, (double[]){0, 150, 0}, (double[]){0, -1, 0}, NULL));
    view.camera = &camera;
    view.width = WIDTH;
    view.height = HEIGHT;
    view.field_of_view = 0.35 * 180 / MATH3_PI;
    view.no_legend = true;
    assert_ok(conus_render(&image, renderer, &view));
    return image;
}

static double difference(const conus_image *a, const conus_image *b)
{
    conus_image_difference difference;
    assert_ok(conus_image_compare(&difference, a, b, 0));
    return difference.max_difference;
}

/* Whether the half of the picture with the given columns differs. */
static bool differs(const conus_image *a, const conus_image *b, uint32_t from, uint32_t to)
{
    const float *x = conus_image_floats(a, "R");
    const float *y = conus_image_floats(b, "R");
    for (uint32_t p = 0; p < PIXELS; p++) {
        if (p % WIDTH >= from && p % WIDTH < to && fabsf(x[p] - y[p]) > 0.02F) {
            return true;
        }
    }
    return false;
}

static void hide(conus_renderer *renderer, conus_atlas *atlas, const bool *hidden)
{
    assert_ok(conus_atlas_set_hidden(atlas, hidden));
    assert_ok(conus_renderer_update(renderer));
}

/* Takes over an atlas of two objects, of which object `number` is in the half of the picture from column `from` on, and
 * asserts that it is gone while it is hidden. */
static void assert_gone_until_shown(conus_atlas *atlas, size_t number, uint32_t from)
{
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    const uint32_t other = WIDTH / 2 - from; /* the first column of the other object */
    bool hidden[3] = {false};
    conus_image *before = render(renderer, (conus_view){0});
    hidden[number] = true;
    hide(renderer, atlas, hidden);
    conus_image *without = render(renderer, (conus_view){0});
    assert_true(differs(before, without, from, from + WIDTH / 2));
    assert_false(differs(before, without, other, other + WIDTH / 2));
    hide(renderer, atlas, (const bool[]){false, true, true});
    conus_image *empty = render(renderer, (conus_view){0});
    assert_true(differs(without, empty, other, other + WIDTH / 2));
    hide(renderer, atlas, NULL);
    conus_image *again = render(renderer, (conus_view){0});
    assert_near(difference(before, again), 0, 0);
    conus_image_destroy(before);
    conus_image_destroy(without);
    conus_image_destroy(empty);
    conus_image_destroy(again);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

static void hidden_areas_are_gone_until_shown(void **state)
{
    (void)state;
    assert_gone_until_shown(boxes(NULL), 2, 0);
}

static void hidden_meshes_are_gone_until_shown(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh left = mesh_scene_sphere((double[]){-12, 0, 0}, 8, 24, 48);
    struct mesh right = mesh_scene_sphere((double[]){12, 0, 0}, 8, 24, 48);
    mesh_scene_add(atlas, &left);
    mesh_scene_add(atlas, &right);
    assert_gone_until_shown(atlas, 1, WIDTH / 2);
}

/* A context that is faded away leaves the picture of an atlas whose context is transparent. */
static void a_faded_context_thins_out(void **state)
{
    (void)state;
    conus_atlas *atlas = boxes(picture_ball_of_20);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    const conus_transfer_point clear = {0.5, {1, 1, 1, 0}};
    conus_image *full = render(renderer, (conus_view){0});
    conus_image *half = render(renderer, (conus_view){.fade = 0.5});
    conus_image *gone = render(renderer, (conus_view){.fade = 1});
    assert_ok(conus_renderer_set_transfer(renderer, &clear, 1));
    conus_image *transparent = render(renderer, (conus_view){0});
    assert_true(difference(full, half) > 0.02);
    assert_true(difference(half, gone) > 0.02);
    assert_true(difference(gone, transparent) < 0.05);
    conus_image_destroy(full);
    conus_image_destroy(half);
    conus_image_destroy(gone);
    conus_image_destroy(transparent);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

static void the_same_transfer_function_is_the_same_picture(void **state)
{
    (void)state;
    conus_atlas *atlas = boxes(picture_ball_of_20);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    size_t count;
    const conus_transfer_point *points = conus_renderer_transfer(&count, renderer);
    assert_true(count > 1);
    conus_transfer_point copy[16];
    assert_true(count <= 16);
    memcpy(copy, points, count * sizeof *copy);
    conus_image *before = render(renderer, (conus_view){0});
    assert_ok(conus_renderer_set_transfer(renderer, copy, count));
    conus_image *after = render(renderer, (conus_view){0});
    assert_near(difference(before, after), 0, 0);
    copy[0].rgba[3] = 2;
    assert_fails(conus_renderer_set_transfer(renderer, copy, count), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_renderer_set_transfer(renderer, copy, 0), CONUS_ERROR_ARGUMENT);
    copy[0].rgba[3] = 0;
    copy[0].value = copy[count - 1].value + 1;
    assert_fails(conus_renderer_set_transfer(renderer, copy, count), CONUS_ERROR_ARGUMENT);
    conus_image_destroy(before);
    conus_image_destroy(after);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* A cylinder across the picture is as wide at its end as at its beginning, and only drawn in its range. */
static void a_cylinder_is_drawn_to_scale(void **state)
{
    (void)state;
    conus_atlas *atlas = boxes(NULL);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    const conus_selector_options options = {.radius = 4, .range = {10, 30}};
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){20, 0, 15}, (double[]){-1, 0, 0}, NULL)); /* above the boxes */
    assert_ok(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_select(&selection, selector, &pose, 0));
    conus_image *plain = render(renderer, (conus_view){.draft = true});
    conus_image *with = render(renderer, (conus_view){.draft = true, .selection = selection});
    const float *before = conus_image_floats(plain, "B");
    const float *after = conus_image_floats(with, "B");
    const double mm = 2 * 150 * tan(0.35 / 2) / HEIGHT; /* per pixel, at the cylinder's distance */
    for (int x = 8; x > -8; x--) {
        int column = (int)(0.5 * WIDTH - x / mm);
        int high = 0;
        for (int row = 0; row < HEIGHT / 2 - 22; row++) { /* down to just above the boxes */
            high += fabsf(before[row * WIDTH + column] - after[row * WIDTH + column]) > 0.02F;
        }
        assert_near(high * mm, 8, 1.6);
    }
    int column = (int)(0.5 * WIDTH - 14 / mm); /* nearer than the range: only the axis */
    int row = (int)(0.5 * HEIGHT - 17.5 / mm);
    assert_near((double)after[row * WIDTH + column], (double)before[row * WIDTH + column], 0.005);
    conus_image_destroy(plain);
    conus_image_destroy(with);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* Adds a rod along x behind the boxes; from the front its middle is seen between them. */
static void add_rod(conus_atlas *atlas)
{
    conus_volume_info grid = picture_grid((size_t[]){60, 20, 10}, (double[]){1, 1, 1}, picture_identity);
    float *values = memory_zeroed((size_t)60 * 20 * 10, sizeof *values);
    grid.role = CONUS_ROLE_SCALAR;
    grid.threshold = 0.5;
    for (size_t v = 0; v < (size_t)60 * 20 * 10; v++) {
        size_t j = v / 60 % 20;
        size_t k = v / 1200;
        values[v] = j < 9 && j > 4 && k > 2 && k < 7 ? 1 : 0;
    }
    assert_ok(pathway_of_values(atlas, &grid, values, "rod"));
    memcpy(atlas->objects[0].rgb, (uint8_t[]){0, 255, 0}, 3);
    memcpy(atlas->objects[1].rgb, (uint8_t[]){0, 255, 0}, 3);
    memcpy(atlas->objects[2].rgb, (uint8_t[]){0, 0, 255}, 3);
}

/* Pixels between two columns in which green is by far the strongest. */
static size_t count_green(const conus_image *image, uint32_t from, uint32_t to)
{
    const float *r = conus_image_floats(image, "R");
    const float *g = conus_image_floats(image, "G");
    const float *b = conus_image_floats(image, "B");
    size_t count = 0;
    for (uint32_t p = 0; p < PIXELS; p++) {
        count += p % WIDTH >= from && p % WIDTH < to && g[p] > 2 * r[p] && g[p] > 2 * b[p];
    }
    return count;
}

/* Pixels of the cone's colour or darker: in linear light its green is 0.43 of its red, and it has no blue. */
static size_t count_amber(const conus_image *image)
{
    const float *r = conus_image_floats(image, "R");
    const float *g = conus_image_floats(image, "G");
    const float *b = conus_image_floats(image, "B");
    size_t count = 0;
    for (uint32_t p = 0; p < PIXELS; p++) {
        count += r[p] > 0.1F && g[p] > 0.3F * r[p] && g[p] < 0.6F * r[p] && b[p] < 0.2F * r[p];
    }
    return count;
}

/* A picture of an atlas with a pathway shows the pathway, and of the areas only those that a selection hits. Here this
 * is the box on the picture's right, which reaches beyond the pathway's grid of z from -5 to 5; the other box is not
 * hit. The box is 16 x 16 mm at a distance of about 142, which gives its number of pixels from the front. */
static void areas_that_are_hit_are_drawn_beside_pathways(void **state)
{
    (void)state;
    conus_atlas *atlas = boxes(NULL);
    add_rod(atlas);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){-12, 60, 0}, (double[]){0, -1, 0}, NULL));
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_select(&selection, selector, &pose, degrees_from_radians(0.05)));
    assert_int_equal(conus_selection_result(selection, 0)->object, 1);
    conus_image *alone = render(renderer, (conus_view){0});
    conus_image *with = render(renderer, (conus_view){.selection = selection, .own_colours = true});
    conus_image *no_cone = render(renderer, (conus_view){.selection = selection, .own_colours = true, .no_cone = true});
    conus_image *draft = render(renderer, (conus_view){.draft = true});
    conus_image *again = render(renderer, (conus_view){0});
    const double pixels_per_mm = HEIGHT / (2 * 142 * tan(0.35 / 2));
    const double box = 16 * 16 * pixels_per_mm * pixels_per_mm;
    assert_int_equal(count_green(alone, 0, WIDTH), 0);
    assert_int_equal(count_green(with, 0, WIDTH / 2), 0);
    assert_true((double)count_green(with, WIDTH / 2, WIDTH) > 0.6 * box); /* the cone's marks cover some of it */
    assert_true((double)count_green(with, WIDTH / 2, WIDTH) < 1.1 * box);
    assert_true(count_amber(with) > 20);
    assert_int_equal(count_amber(no_cone), 0); /* and what it hits is there all the same */
    assert_true(count_green(no_cone, WIDTH / 2, WIDTH) > count_green(with, WIDTH / 2, WIDTH));
    assert_int_equal(count_green(draft, 0, WIDTH), 0); /* which has none of the picture before */
    assert_near(difference(alone, again), 0, 0);
    conus_image_destroy(alone);
    conus_image_destroy(with);
    conus_image_destroy(no_cone);
    conus_image_destroy(draft);
    conus_image_destroy(again);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

static conus_status change(void *data)
{
    conus_renderer *renderer = data;
    const conus_transfer_point points[2] = {{0, {1, 1, 1, 0}}, {1, {1, 1, 1, 0.2}}};
    conus_status status = conus_renderer_update(renderer);
    return status ? status : conus_renderer_set_transfer(renderer, points, 2);
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_atlas *atlas = boxes(picture_ball_of_20);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    test_every_allocation(change, renderer);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* A ball alone: no voxels say where the camera is. */
static conus_atlas *mesh_ball(void)
{
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh ball = mesh_scene_sphere((double[]){0, 0, 0}, 8, 24, 48);
    mesh_scene_add(atlas, &ball);
    return atlas;
}

/* A camera that is pushed aside, not turned, sees another picture: rough after rough, and smooth after rough. */
static void a_pushed_camera_sees_another_picture(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_ball();
    for (int smooth = 0; smooth < 2; smooth++) {
        conus_renderer *renderer = picture_renderer(atlas, NULL);
        conus_renderer *fresh = picture_renderer(atlas, NULL);
        struct camera camera = picture_camera((double[]){0, -1, 0}, 100, 0.35);
        float *before = picture_draw(renderer, &camera, NULL, false);
        camera.world_from_camera[12] += 6;
        float *pushed = picture_draw(renderer, &camera, NULL, smooth);
        float *right = picture_draw(fresh, &camera, NULL, smooth);
        assert_true(picture_difference(before, right) > 0.01);
        assert_true(picture_difference(pushed, right) == 0);
        memory_free(before);
        memory_free(pushed);
        memory_free(right);
        conus_renderer_destroy(renderer);
        conus_renderer_destroy(fresh);
    }
    conus_atlas_destroy(atlas);
}

/* A picture that no driver draws, between a rough picture and the same smooth, leaves the latter as it is. */
static void a_picture_that_failed_leaves_the_next_as_it_is(void **state)
{
    (void)state;
    test_need_gl();
    conus_atlas *atlas = mesh_ball();
    conus_renderer *renderers[2] = {NULL};
    float *images[2] = {NULL};
    struct camera camera = picture_camera((double[]){0, -1, 0}, 100, 0.35);
    for (int i = 0; i < 2; i++) {
        assert_ok(conus_renderer_create(&renderers[i], atlas, &(conus_renderer_options){.engine = CONUS_ENGINE_GL}));
        memory_free(picture_draw(renderers[i], &camera, NULL, false));
    }
    float none = 0;
    const struct colour_view large = {.camera = &camera, .width = 1 << 24, .height = 1};
    assert_int_equal(renderer_draw(&none, renderers[1], &large, false), CONUS_ERROR_GL);
    for (int i = 0; i < 2; i++) {
        images[i] = picture_draw(renderers[i], &camera, NULL, true);
        conus_renderer_destroy(renderers[i]);
    }
    assert_true(picture_difference(images[0], images[1]) == 0);
    memory_free(images[0]);
    memory_free(images[1]);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(renderer_changes)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hidden_areas_are_gone_until_shown),
        cmocka_unit_test(hidden_meshes_are_gone_until_shown),
        cmocka_unit_test(a_pushed_camera_sees_another_picture),
        cmocka_unit_test(a_picture_that_failed_leaves_the_next_as_it_is),
        cmocka_unit_test(a_faded_context_thins_out),
        cmocka_unit_test(the_same_transfer_function_is_the_same_picture),
        cmocka_unit_test(a_cylinder_is_drawn_to_scale),
        cmocka_unit_test(areas_that_are_hit_are_drawn_beside_pathways),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
