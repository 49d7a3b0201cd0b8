/* SPDX-License-Identifier: BSD-3-Clause */
/* Flat cuts: the object at each pixel's centre, the sides, and the order in which things are laid over each other. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "mesh_scene.h"
#include "picture_scene.h"
#include "render/flat/cut.h"
#include "scene.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 61 };

struct picture {
    uint8_t rgba[SIDE * SIDE * 4];
    uint32_t objects[SIDE * SIDE];
};

static conus_atlas *open_phantom(const char *kind)
{
    struct phantom_drawing drawing;
    conus_atlas *atlas = NULL;
    assert_ok(phantom_draw(&drawing, kind, NULL));
    assert_ok(phantom_drawing_atlas(&atlas, &drawing));
    phantom_drawing_finish(&drawing);
    return atlas;
}

static const conus_cut_view whole = {.width = SIDE, .height = SIDE};

/* 1 mm per pixel, the middle pixel's centre at the origin: pixel (x, y) is at (x - 30, 30 - y). */
static void pixels_are_where_their_centres_are(void **state)
{
    (void)state;
    static struct picture picture;
    conus_atlas *atlas = open_phantom("u-shape");
    const conus_cut_view view = {.width = SIDE, .height = SIDE, .right = {1, 0, 0}, .up = {0, 0, 1}, .fill = 1};
    const struct volume *volume = atlas_parcellation(atlas);
    unsigned hits = 0;
    assert_ok(conus_cut(picture.rgba, picture.objects, atlas, &view));
    for (int y = 0; y < SIDE; y++) {
        for (int x = 0; x < SIDE; x++) {
            size_t voxel;
            bool inside = volume_find_voxel(&voxel, volume, (double[]){x - 30, 0, 30 - y});
            uint32_t wanted = inside ? volume_object(volume, voxel) : 0;
            assert_int_equal(picture.objects[y * SIDE + x], wanted);
            hits += wanted > 0;
        }
    }
    assert_true(hits > 500);
    conus_atlas_destroy(atlas);
}

/* A stair: 1 where the indices' sum is at most 0 (1 mm voxels whose centres are at halves). */
static double label_of_stair(const double world[3])
{
    return world[0] + world[1] < 0.5;
}

/* The voxel around (0.5, 0.5, 0.5) alone. */
static double label_of_voxel(const double world[3])
{
    return fabs(world[0] - 0.5) < 0.5 && fabs(world[1] - 0.5) < 0.5 && fabs(world[2] - 0.5) < 0.5;
}

/* In a cut through voxels' centres a corner weighs xy of its cell, 1/2 on the border: a hyperbola from edge's middle to
 * edge's middle, whose vertex is (1.5 - sqrt 2) / sqrt 2 = 0.061 beside the chord. So a stair becomes straight but for
 * that. A voxel alone keeps 4 (1/2 - ln(2) / 2) = 0.614 of its square. What the pixels are in stays the voxel. */
static void borders_are_smooth_in_the_picture_only(void **state)
{
    (void)state;
    enum { FINE = 20 }; /* pixels per mm */
    const conus_volume_info grid = picture_grid((size_t[]){8, 8, 8}, (double[]){1, 1, 1}, picture_identity);
    const conus_cut_view view = {
        .width = 6 * FINE, .height = 6 * FINE, .centre = {0, 0, 0.5}, .mm_per_pixel = 1.0 / FINE, .fill = 1};
    for (int is_alone = 0; is_alone < 2; is_alone++) {
        conus_atlas *atlas = picture_atlas(&grid, is_alone ? label_of_voxel : label_of_stair, NULL, NULL);
        conus_cutter *cutter = NULL;
        unsigned shown = 0;
        assert_ok(conus_cutter_create(&cutter, atlas));
        assert_ok(conus_cutter_draw(cutter, &view));
        for (size_t i = 0; i < (size_t)view.width * view.height; i++) {
            const double x = ((double)(i % view.width) + 0.5) / FINE - 3;
            const size_t row = i / view.width;
            const double y = 3 - ((double)row + 0.5) / FINE;
            const double centre[3] = {floor(x) + 0.5, floor(y) + 0.5, 0.5};
            const uint32_t drawn = conus_cutter_shown(cutter)[i];
            const double wanted = is_alone ? label_of_voxel(centre) : label_of_stair(centre);
            assert_int_equal(conus_cutter_objects(cutter)[i], (uint32_t)wanted);
            if (!is_alone && fabs(x + y - 0.5) > 0.061 * sqrt(2) + 1e-9) {
                assert_int_equal(drawn, x + y < 0.5);
            }
            const uint8_t *rgb = drawn ? conus_atlas_object(atlas, 1)->rgb : (const uint8_t[]){0, 0, 0};
            assert_memory_equal(conus_cutter_rgba(cutter) + 4 * i, rgb, 3);
            shown += drawn;
        }
        if (is_alone) {
            assert_near(shown / (double)(FINE * FINE), 0.614, 0.02);
        }
        conus_cutter_destroy(cutter);
        conus_atlas_destroy(atlas);
    }
}

/* Whether a voxel with that object is at most half a voxel away along each axis of the volume. */
static bool is_within_half_a_voxel(const struct volume *volume, const double world[3], uint32_t object)
{
    for (int n = 0; n < 27; n++) {
        const int steps[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        const double step[3] = {steps[0], steps[1], steps[2]};
        double p[3], at[3];
        size_t voxel;
        mat4_point(p, volume->voxel_from_world, world);
        vec3_add_scaled(p, p, 0.5 + 1e-9, step);
        mat4_point(at, volume->info.world_from_voxel, p);
        const bool inside = volume_find_voxel(&voxel, volume, at);
        if ((inside ? volume_object(volume, voxel) : 0) == object) {
            return true;
        }
    }
    return false;
}

static unsigned count_moved(const conus_atlas *atlas, const conus_cut_view *view)
{
    conus_cutter *cutter = NULL;
    unsigned moved = 0;
    assert_ok(conus_cutter_create(&cutter, atlas));
    assert_ok(conus_cutter_draw(cutter, view));
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
        const uint32_t drawn = conus_cutter_shown(cutter)[i];
        const size_t row = i / SIDE;
        double at[3];
        vec3_add_scaled(at, view->centre, view->mm_per_pixel * ((double)(i % SIDE) - 30), view->right);
        vec3_add_scaled(at, at, view->mm_per_pixel * (30 - (double)row), view->up);
        moved += drawn != conus_cutter_objects(cutter)[i];
        assert_true(is_within_half_a_voxel(atlas_parcellation(atlas), at, drawn));
    }
    conus_cutter_destroy(cutter);
    return moved;
}

static void borders_move_by_half_a_voxel(void **state)
{
    (void)state;
    uint64_t random = 7;
    unsigned moved = 0;
    for (size_t i = 0; i < 20; i++) {
        conus_atlas *atlas = scene_atlas(&random, 24, 0);
        conus_cut_view view = {
            .width = SIDE, .height = SIDE, .right = {0.8, 0.6, 0}, .up = {0, 0, 1}, .mm_per_pixel = 0.2};
        scene_voxel(view.centre, atlas_parcellation(atlas), atlas_parcellation(atlas)->voxel_count / 2);
        moved += count_moved(atlas, &view);
        conus_atlas_destroy(atlas);
    }
    assert_true(moved > 100);
}

/* Neurological: the world's +x is right in the default, axial, cut; +y is up. */
static void the_default_is_axial_and_neurological(void **state)
{
    (void)state;
    static struct picture picture;
    conus_atlas *atlas = open_phantom("slabs"); /* across y: 1 at y > 0, 300 at y < 0 */
    assert_ok(conus_cut(picture.rgba, picture.objects, atlas, &whole));
    const conus_object *above = conus_atlas_object(atlas, picture.objects[(30 - 9) * SIDE + 30]);
    const conus_object *below = conus_atlas_object(atlas, picture.objects[(30 + 9) * SIDE + 30]);
    assert_int_equal(above->label, 1);
    assert_int_equal(below->label, 300);
    conus_atlas_destroy(atlas);
}

static void hidden_objects_are_left_out(void **state)
{
    (void)state;
    static struct picture picture;
    conus_atlas *atlas = open_phantom("slabs");
    const bool hidden[3] = {false, true, false};
    conus_cut_view view = whole;
    assert_ok(conus_atlas_set_hidden(atlas, hidden));
    assert_ok(conus_cut(picture.rgba, picture.objects, atlas, &view));
    assert_int_equal(picture.objects[(30 - 9) * SIDE + 30], 0);
    assert_int_equal(picture.objects[(30 + 9) * SIDE + 30], 2);
    conus_atlas_destroy(atlas);
}

static const uint8_t *pixel_at(const struct picture *picture, int x, int y)
{
    return picture->rgba + 4 * (y * SIDE + x);
}

/* Fill 1 is the area's colour; fill 0 leaves what is below it inside, and its colour at its outline. */
static void fill_and_outline(void **state)
{
    (void)state;
    static struct picture picture;
    static const uint8_t black[3] = {0, 0, 0};
    conus_atlas *atlas = open_phantom("sphere");
    const uint8_t *rgb = conus_atlas_object(atlas, 1)->rgb;
    conus_cut_view view = whole;
    view.fill = 1;
    assert_ok(conus_cut(picture.rgba, NULL, atlas, &view));
    assert_memory_equal(pixel_at(&picture, 30, 30), rgb, 3);
    assert_int_equal(pixel_at(&picture, 30, 30)[3], 255);
    assert_memory_equal(pixel_at(&picture, 2, 2), black, 3);
    view.fill = 0;
    assert_ok(conus_cut(picture.rgba, picture.objects, atlas, &view));
    assert_memory_equal(pixel_at(&picture, 30, 30), black, 3);
    int edge = 30;
    while (picture.objects[30 * SIDE + edge + 1]) {
        edge++;
    }
    assert_memory_equal(pixel_at(&picture, edge, 30), rgb, 3);
    view.no_outlines = true;
    assert_ok(conus_cut(picture.rgba, NULL, atlas, &view));
    assert_memory_equal(pixel_at(&picture, edge, 30), black, 3);
    conus_atlas_destroy(atlas);
}

/* A box whose walls the plane z = 0 cuts where pixels have their centres: at x and y of -12 and 12. */
static void a_surface_around_is_an_outline(void **state)
{
    (void)state;
    static struct picture picture;
    static struct picture plain;
    static const uint8_t bone[3] = {172, 165, 155};
    conus_atlas *atlas = open_phantom("sphere");
    const conus_cut_view view = {.width = SIDE, .height = SIDE, .fill = 1, .no_outlines = true};
    struct context_surface surface = {
        .opacity = 0.25, .mesh = mesh_scene_box((const double[]){-12, -12, -12}, (const double[]){12, 12, 12})};
    assert_ok(conus_cut(plain.rgba, plain.objects, atlas, &view));
    assert_ok(conus_atlas_add_shell(atlas, 0)); /* which is in space only */
    assert_ok(conus_cut(picture.rgba, picture.objects, atlas, &view));
    assert_memory_equal(picture.rgba, plain.rgba, sizeof plain.rgba);
    assert_ok(mesh_check(&surface.mesh, NULL));
    assert_ok(atlas_add_context_surface(atlas, &surface));
    assert_ok(conus_cut(picture.rgba, picture.objects, atlas, &view));
    assert_memory_equal(picture.objects, plain.objects, sizeof plain.objects);
    for (int y = 0; y < SIDE; y++) {
        for (int x = 0; x < SIDE; x++) {
            int far = abs(x - 30) > abs(y - 30) ? abs(x - 30) : abs(y - 30);
            assert_memory_equal(pixel_at(&picture, x, y), far == 12 ? bone : pixel_at(&plain, x, y), 3);
        }
    }
    conus_atlas_destroy(atlas);
}

static double grey_of(const double world[3])
{
    return 10 * world[0]; /* trilinear interpolation reproduces linear functions */
}

static void the_context_is_linear_between_black_and_white(void **state)
{
    (void)state;
    static struct picture picture;
    const conus_volume_info grid = picture_grid((size_t[]){40, 40, 40}, (double[]){2, 2, 2}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_nothing, NULL, grey_of);
    conus_cut_view view = whole;
    view.window[0] = -200;
    view.window[1] = 200;
    assert_ok(conus_cut(picture.rgba, NULL, atlas, &view));
    for (int x = 0; x < SIDE; x++) {
        double wanted = fmin(fmax((10.0 * (x - 30) + 200) / 400 * 255, 0), 255);
        assert_near(pixel_at(&picture, x, 17)[0], wanted, 1);
        assert_int_equal(pixel_at(&picture, x, 17)[0], pixel_at(&picture, x, 17)[2]);
    }
    conus_atlas_destroy(atlas);
}

static double stripe_at(const double world[3])
{
    return fabs(world[1]) < 8;
}

/* Of a byte of sRGB, as WCAG 2.2 defines relative luminance. */
static double luminance_of(uint8_t level)
{
    return level <= 10 ? level / 255.0 / 12.92 : pow((level / 255.0 + 0.055) / 1.055, 2.4);
}

/* An outline crosses all greys, which it equals nowhere: its contrast is that of lines that mean something (1.4.11),
 * 3, and hardly more, so that it does not outshine what is hit. */
static void outlines_of_what_is_not_hit_are_seen_on_any_grey(void **state)
{
    (void)state;
    static struct picture picture;
    conus_selector *selector = NULL;
    conus_selection *nothing = NULL;
    conus_pose away;
    unsigned seen = 0;
    const conus_volume_info grid = picture_grid((size_t[]){40, 40, 40}, (double[]){2, 2, 2}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, stripe_at, NULL, grey_of);
    assert_ok(conus_pose_along(&away, (double[]){0, 0, 90}, (double[]){0, 0, 1}, NULL));
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_select(&nothing, selector, &away, degrees_from_radians(0.1)));
    conus_cut_view view = whole;
    view.window[0] = -300;
    view.window[1] = 300;
    view.fill = 0.45;
    view.selection = nothing;
    view.no_cone = true;
    assert_ok(conus_cut(picture.rgba, picture.objects, atlas, &view));
    for (int y = 1; y < SIDE; y++) {
        for (int x = 0; x < SIDE; x++) {
            if (picture.objects[y * SIDE + x] && !picture.objects[(y - 1) * SIDE + x]) {
                double line = luminance_of(pixel_at(&picture, x, y)[0]) + 0.05;
                double under = luminance_of(pixel_at(&picture, x, y - 1)[0]) + 0.05; /* greys change along x alone */
                double contrast = fmax(line, under) / fmin(line, under);
                assert_true(contrast >= 3 && contrast < 3.5);
                seen++;
            }
        }
    }
    assert_int_equal(seen, SIDE);
    conus_selection_destroy(nothing);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static void values_are_linear_between_voxels(void **state)
{
    (void)state;
    const conus_volume_info grid = picture_grid((size_t[]){20, 20, 20}, (double[]){2, 2, 2}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_nothing, NULL, grey_of);
    size_t context = 0;
    while (conus_atlas_volume(atlas, context)->role != CONUS_ROLE_CONTEXT) {
        assert_true(isnan(conus_atlas_value(atlas, context++, (double[]){0, 0, 0})));
    }
    for (int step = 0; step < 52; step++) {
        double x = -18 + 0.7 * step;
        assert_near(conus_atlas_value(atlas, context, (double[]){x, 0.3 * x, 1}), 10 * x, 1e-3);
    }
    assert_near(conus_atlas_value(atlas, context, (double[]){19.9, 0, 0}), 190, 1e-3); /* beside the last centre */
    assert_true(isnan(conus_atlas_value(atlas, context, (double[]){20.1, 0, 0})));
    assert_true(isnan(conus_atlas_value(atlas, context + 1, (double[]){0, 0, 0})));
    conus_atlas_destroy(atlas);
}

static conus_selection *select_in(conus_atlas *atlas, const conus_selector_options *options, double degrees)
{
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){0, 60, 0}, (double[]){0, -1, 0}, NULL));
    assert_ok(conus_selector_create(&selector, atlas, options));
    assert_ok(conus_select(&selection, selector, &pose, degrees));
    conus_selector_destroy(selector);
    return selection;
}

/* The wall is drawn at the cone's radius: 60 tan(15 deg) = 16.08 mm beside the axis at the origin's depth. With first
 * hits it ends before that: those of the torus, which has the origin in its middle, are nearer. */
static void a_cone_is_drawn_to_scale(void **state)
{
    (void)state;
    static struct picture with, without;
    conus_atlas *atlas = open_phantom("torus");
    for (int is_whole = 0; is_whole < 2; is_whole++) {
        const conus_selector_options options = {.layers = is_whole ? CONUS_LAYERS_ALL : CONUS_LAYERS_VISIBLE};
        conus_selection *selection = select_in(atlas, &options, 30);
        conus_cut_view view = whole;
        assert_ok(conus_cut(without.rgba, NULL, atlas, &view));
        view.selection = selection;
        assert_ok(conus_cut(with.rgba, NULL, atlas, &view));
        assert_int_equal(pixel_at(&with, 30 + 16, 30)[0] > 200, is_whole);
        assert_int_equal(pixel_at(&with, 30 - 16, 30)[0] > 200, is_whole);
        const double before = floor(60 - conus_selection_result(selection, 0)->contact[1]) - 3; /* the only area */
        const int beside = (int)lrint(before * tan(radians_from_degrees(15)));
        assert_true(pixel_at(&with, 30 + beside, (int)before - 30)[0] > 150);
        assert_memory_equal(pixel_at(&with, 30 + 20, 2), pixel_at(&without, 30 + 20, 2), 4); /* beside it nothing */
        conus_selection_destroy(selection);
    }
    conus_atlas_destroy(atlas);
}

/* A cylinder of 8 mm from (0, 60, 0) along -y, drawn between depths of 50 and 75 mm, and a cone of slope 0.5 between 60
 * and 72: inside are |x| < 8 and -15 < y < 10, and |x| < 0.5 (60 - y) and -12 < y < 0. A pixel of 1 mm is brightest on
 * the border, tinted inside, and as it was outside. */
static void cylinders_and_ranges_are_drawn_to_scale(void **state)
{
    (void)state;
    static uint8_t rgba[SIDE * SIDE * 4];
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){0, 60, 0}, (double[]){0, -1, 0}, NULL));
    const struct cut_place place = {
        .right = {1, 0, 0}, .up = {0, 1, 0}, .mm_per_pixel = 1, .width = SIDE, .height = SIDE};
    for (int is_cone = 0; is_cone < 2; is_cone++) {
        const struct cut_cone cone = {.world_from_cone = pose.world_from_device,
                                      .slope = is_cone ? 0.5 : 0,
                                      .radius = is_cone ? 0 : 8,
                                      .near = is_cone ? 60 : 50,
                                      .far = is_cone ? 72 : 75};
        memset(rgba, 0, sizeof rgba);
        cut_draw_cone(rgba, &place, &cone);
        for (int i = 0; i < SIDE * SIDE; i++) {
            int depth = 30 + i / SIDE;
            double wall = is_cone ? (abs(i % SIDE - 30) - 0.5 * depth) / sqrt(1.25) : abs(i % SIDE - 30) - 8;
            double border = fmax(wall, fmax(cone.near - depth, depth - cone.far));
            const uint8_t red = rgba[4 * i];
            assert_true(border > 1.4    ? red == 0
                        : border < -1.4 ? red > 20 && red < 50
                                        : fabs(border) > 0.5 || red > 150);
        }
    }
}

/* Objects hit first are full, objects only pierced are striped, objects outside the cone are pale. */
static void hidden_areas_in_the_cone_are_hatched(void **state)
{
    (void)state;
    static struct picture picture;
    conus_atlas *atlas = open_phantom("slabs");
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .radius = 3};
    conus_selection *selection = select_in(atlas, &options, 0);
    conus_cut_view view = whole;
    view.fill = 0.5;
    view.no_outlines = true;
    view.selection = selection;
    assert_ok(conus_cut(picture.rgba, NULL, atlas, &view));
    bool front_varies = false;
    bool back_varies = false;
    for (int x = 40; x < 50; x++) { /* beside the cylinder */
        front_varies = front_varies || memcmp(pixel_at(&picture, x, 30 - 9), pixel_at(&picture, 40, 30 - 9), 3) != 0;
        back_varies = back_varies || memcmp(pixel_at(&picture, x, 30 + 9), pixel_at(&picture, 40, 30 + 9), 3) != 0;
    }
    assert_false(front_varies);
    assert_true(back_varies);
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

static double left_half(const double world[3])
{
    return world[0] < 0 ? 100 : 0;
}

/* A hit is mixed with what is under it: an image of 100, or LOOK_CUT_GROUND, 144, where there is none or it is 0. So
 * it looks everywhere as on its chip, not darker. Half of the first rank's colour, to the nearest byte. */
static void a_hit_is_laid_over_the_image_or_over_ground(void **state)
{
    (void)state;
    static const uint8_t rank[3] = {LOOK_RGB(LOOK_RANK_1)};
    static struct picture picture;
    const conus_volume_info grid = picture_grid((size_t[]){40, 40, 40}, (double[]){2, 2, 2}, picture_identity);
    for (int has_image = 0; has_image < 2; has_image++) {
        conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, has_image ? left_half : NULL);
        conus_selection *selection = select_in(atlas, NULL, 10);
        const conus_cut_view view = {.width = SIDE,
                                     .height = SIDE,
                                     .fill = 0.5,
                                     .no_outlines = true,
                                     .no_cone = true,
                                     .window = {0, 255},
                                     .selection = selection};
        assert_ok(conus_cut(picture.rgba, picture.objects, atlas, &view));
        for (int x = 30 - 15; x <= 30 + 15; x++) {
            const int under = has_image && x < 30 - 1 ? 100 : 144;
            for (int c = 0; c < 3 && abs(x - 30) > 2; c++) { /* the image is linear between 0 and 100 there */
                assert_int_equal(pixel_at(&picture, x, 30)[c], (rank[c] + under + 1) / 2);
            }
        }
        conus_selection_destroy(selection);
        conus_atlas_destroy(atlas);
    }
}

/* One area is in the cone, one is chosen, one neither: only the last is pale. */
static void the_chosen_area_is_never_pale(void **state)
{
    (void)state;
    static struct picture picture;
    conus_atlas *atlas = open_phantom("slabs");
    const conus_selector_options options = {.radius = 3};
    conus_selection *selection = select_in(atlas, &options, 0);
    const uint32_t hit = conus_selection_result(selection, 0)->object;
    const int other_y = hit == 1 ? 30 + 9 : 30 - 9;
    uint8_t plain[3];
    conus_cut_view view = whole;
    view.fill = 1;
    view.no_outlines = view.own_colours = true;
    assert_ok(conus_cut(picture.rgba, NULL, atlas, &view));
    memcpy(plain, pixel_at(&picture, 45, other_y), 3);
    view.selection = selection;
    assert_ok(conus_cut(picture.rgba, NULL, atlas, &view));
    assert_memory_not_equal(pixel_at(&picture, 45, other_y), plain, 3);
    view.chosen = 3 - hit;
    assert_ok(conus_cut(picture.rgba, NULL, atlas, &view));
    assert_memory_equal(pixel_at(&picture, 45, other_y), plain, 3);
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

/* One area is hit, one is not. Without an image this one is grey with a darker outline, and that one has the first
 * rank's colour, also beside safe colours; where the atlas has another palette both have this one's. */
static void areas_have_the_colours_of_their_ranks(void **state)
{
    (void)state;
    static struct picture picture;
    static const uint8_t first[3] = {LOOK_RGB(LOOK_RANK_1)}, not_hit[3] = {LOOK_RGB(LOOK_NOT_HIT)};
    static const uint8_t outline[3] = {LOOK_RGB(LOOK_OUTLINE)}, black[3] = {0, 0, 0};
    conus_atlas *atlas = open_phantom("slabs");
    const conus_selector_options options = {.radius = 3};
    conus_selection *selection = select_in(atlas, &options, 0);
    const uint32_t hit = conus_selection_result(selection, 0)->object;
    const int y[2] = {hit == 1 ? 30 - 9 : 30 + 9, hit == 1 ? 30 + 9 : 30 - 9};
    conus_cut_view view = whole;
    view.fill = 1;
    view.selection = selection;
    assert_ok(conus_cut(picture.rgba, picture.objects, atlas, &view));
    assert_int_equal(picture.objects[y[0] * SIDE + 45], hit);
    assert_memory_equal(pixel_at(&picture, 45, y[0]), first, 3);
    assert_memory_equal(pixel_at(&picture, 45, y[1]), not_hit, 3);
    int edge = 45;
    while (picture.objects[y[1] * SIDE + edge + 1]) {
        edge++;
    }
    assert_memory_equal(pixel_at(&picture, edge, y[1]), outline, 3);
    view.fill = 0;
    assert_ok(conus_cut(picture.rgba, NULL, atlas, &view));
    assert_memory_equal(pixel_at(&picture, 45, y[1]), black, 3);
    static struct picture no_cone;
    view.no_cone = true; /* then the amber, whose inside has more red, is gone */
    assert_ok(conus_cut(no_cone.rgba, NULL, atlas, &view));
    size_t changed = 0;
    for (size_t pixel = 0; pixel < (size_t)SIDE * SIDE; pixel++) {
        changed += no_cone.rgba[4 * pixel] < picture.rgba[4 * pixel];
        assert_true(no_cone.rgba[4 * pixel] <= picture.rgba[4 * pixel]);
    }
    assert_true(changed > 100);
    view.no_cone = false;
    view.fill = 1;
    conus_atlas_use_safe_colours(atlas);
    assert_ok(conus_cut(picture.rgba, NULL, atlas, &view));
    assert_memory_equal(pixel_at(&picture, 45, y[0]), first, 3);
    assert_ok(conus_atlas_use_palette(atlas, (const uint8_t[]){1, 2, 3, 40, 50, 60}, 2));
    assert_ok(conus_cut(picture.rgba, NULL, atlas, &view));
    assert_memory_equal(pixel_at(&picture, 45, y[0]), atlas->objects[hit - 1].rgb, 3);
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

static void what_cannot_be_drawn_is_refused(void **state)
{
    (void)state;
    static struct picture picture;
    conus_atlas *atlas = open_phantom("slabs");
    const conus_cut_view bad[] = {
        {.width = 0, .height = 1},
        {.width = 20000, .height = 1},
        {.width = 1, .height = 1, .right = {1, 0, 0}},
        {.width = 1, .height = 1, .right = {1, 0, 0}, .up = {1, 0, 0}},
        {.width = 1, .height = 1, .centre = {NAN, 0, 0}},
        {.width = 1, .height = 1, .mm_per_pixel = -1},
        {.width = 1, .height = 1, .fill = 2},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_fails(conus_cut(picture.rgba, NULL, atlas, &bad[i]), CONUS_ERROR_ARGUMENT);
    }
    assert_fails(conus_cut(picture.rgba, NULL, atlas, NULL), CONUS_ERROR_ARGUMENT); /* 0 x 0 pixels */
    conus_atlas_destroy(atlas);
}

/* A cutter reuses memory, but each picture equals that of conus_cut(), whatever has changed since the last one. */
static void draw_as_alone(conus_cutter *cutter, const conus_atlas *atlas, const conus_cut_view *view)
{
    static struct picture alone;
    size_t pixels = (size_t)view->width * view->height;
    assert_ok(conus_cut(alone.rgba, alone.objects, atlas, view));
    assert_ok(conus_cutter_draw(cutter, view));
    assert_memory_equal(conus_cutter_rgba(cutter), alone.rgba, 4 * pixels);
    assert_memory_equal(conus_cutter_objects(cutter), alone.objects, 4 * pixels);
}

static unsigned pick(uint64_t *state, size_t count)
{
    return (unsigned)test_random(state, 0, (double)count);
}

/* Changes the view now and then in one respect: turns it, moves it, shows points elsewhere. */
static void change(conus_cut_view *view, conus_selection *const selections[2], uint64_t *state)
{
    static const double axes[][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    unsigned turn = pick(state, 3);
    switch (pick(state, 7)) {
    case 0:
        view->centre[pick(state, 3)] = test_random(state, -8, 8);
        break;
    case 1:
        memcpy(view->right, axes[turn], sizeof view->right);
        memcpy(view->up, axes[(turn + 1) % 3], sizeof view->up);
        break;
    case 2:
        view->width = 1 + pick(state, SIDE);
        break;
    case 3:
        view->window[1] = test_random(state, 1, 200);
        break;
    case 4:
        view->no_outlines = !view->no_outlines;
        break;
    case 5:
        view->mm_per_pixel = test_random(state, 0.2, 3);
        break;
    default:
        view->selection = selections[pick(state, 2)];
    }
}

static void check_cutter(conus_atlas *atlas, uint64_t *state)
{
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL};
    conus_selection *selections[] = {select_in(atlas, &options, 20), select_in(atlas, NULL, 60)};
    conus_cut_view view = {.width = SIDE, .height = SIDE, .fill = 0.4, .window = {-5, 90}};
    conus_cutter *cutter = NULL;
    assert_ok(conus_cutter_create(&cutter, atlas));
    assert_null(conus_cutter_rgba(cutter));
    for (size_t i = 0; i < test_trials(60); i++) {
        draw_as_alone(cutter, atlas, &view);
        change(&view, selections, state);
    }
    conus_cutter_destroy(cutter);
    conus_selection_destroy(selections[0]);
    conus_selection_destroy(selections[1]);
    conus_atlas_destroy(atlas);
}

/* Surfaces, a context and a pathway. */
static conus_atlas *load_brain(void)
{
    conus_atlas *atlas = NULL;
    char path[600];
    char folder[512];
    snprintf(folder, sizeof folder, "%s", test_scratch("brain"));
    assert_ok(conus_phantom_write("brain", folder, NULL));
    snprintf(path, sizeof path, "%s/brain.atlas.json", folder);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    return atlas;
}

/* Whether the ray along +x from `at` crosses the mesh an odd number of times (Moeller and Trumbore). */
static bool is_inside(const struct mesh *mesh, const double at[3])
{
    bool inside = false;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][2];
        double x[3];
        for (int k = 0; k < 3; k++) {
            const float *corner = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)k];
            x[k] = (double)corner[0] - at[0];
            p[k][0] = (double)corner[1] - at[1];
            p[k][1] = (double)corner[2] - at[2];
        }
        double a = p[1][0] * p[2][1] - p[1][1] * p[2][0];
        double b = p[2][0] * p[0][1] - p[2][1] * p[0][0];
        double c = p[0][0] * p[1][1] - p[0][1] * p[1][0];
        bool passes = (a > 0) == (b > 0) && (b > 0) == (c > 0);
        inside = inside != (passes && (a * x[0] + b * x[1] + c * x[2]) / (a + b + c) > 0);
    }
    return inside;
}

static void closed_surfaces_are_filled(void **state)
{
    (void)state;
    static struct picture picture;
    conus_atlas *atlas = load_brain();
    const conus_cut_view view = {.width = SIDE,
                                 .height = SIDE,
                                 .centre = {0.31, -7.13, 11.7},
                                 .right = {0, 1, 0},
                                 .up = {0, 0, 1},
                                 .mm_per_pixel = 2.9};
    unsigned hits = 0;
    uint64_t random = 5;
    assert_ok(conus_cut(picture.rgba, picture.objects, atlas, &view));
    for (int i = 0; i < 60; i++) {
        unsigned x = pick(&random, SIDE);
        unsigned y = pick(&random, SIDE);
        const double at[3] = {0.31, -7.13 + 2.9 * (x - 30.0), 11.7 + 2.9 * (30.0 - y)};
        uint32_t found = picture.objects[y * SIDE + x];
        for (uint32_t number = 1; number <= atlas->object_count; number++) {
            const struct mesh *mesh = atlas_object_mesh(atlas, number);
            bool above = found && !atlas_object_mesh(atlas, found); /* the pathway */
            if (mesh && mesh->shape.closed && !above) {
                assert_int_equal(found == number, is_inside(mesh, at)); /* no two of them overlap */
            }
        }
        hits += found > 0;
    }
    assert_in_range(hits, 10, 55);
    conus_atlas_destroy(atlas);
}

/* One surface of two boxes that overlap from x = -2 to 2, without common vertices: a point in both is inside. A third
 * box, turned around, is a hole in the first. */
static void what_overlaps_is_filled_once(void **state)
{
    (void)state;
    static struct picture picture;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh a = mesh_scene_box((double[]){-10, -5, -5}, (double[]){2, 5, 5});
    struct mesh b = mesh_scene_box((double[]){-2, -5, -5}, (double[]){10, 5, 5});
    struct mesh hole = mesh_scene_box((double[]){-8, -2, -2}, (double[]){-5, 2, 2});
    struct mesh both = mesh_scene_join(&a, &b);
    mesh_scene_turn(&hole);
    struct mesh all = mesh_scene_join(&both, &hole);
    mesh_scene_add(atlas, &all);
    const conus_cut_view view = {
        .width = SIDE, .height = SIDE, .right = {1, 0, 0}, .up = {0, 1, 0}, .mm_per_pixel = 0.49};
    assert_ok(conus_cut(picture.rgba, picture.objects, atlas, &view));
    for (unsigned pixel = 0; pixel < SIDE * SIDE; pixel++) {
        unsigned row = pixel / SIDE;
        double x = 0.49 * (pixel % SIDE + 0.5 - SIDE / 2.0);
        double y = 0.49 * (SIDE / 2.0 - 0.5 - row);
        bool in_hole = x > -8 && x < -5 && fabs(y) < 2;
        assert_int_equal(picture.objects[pixel], fabs(x) < 10 && fabs(y) < 5 && !in_hole);
    }
    conus_atlas_destroy(atlas);
}

static void a_cutter_draws_the_same_pictures(void **state)
{
    (void)state;
    uint64_t random = 11;
    const conus_volume_info grid = picture_grid((size_t[]){20, 20, 20}, (double[]){2, 2, 2}, picture_identity);
    check_cutter(scene_atlas(&random, 24, 2), &random);
    check_cutter(load_brain(), &random);
    check_cutter(picture_atlas(&grid, picture_ball_of_20, NULL, grey_of), &random);
}

static conus_status cut_once(void *data)
{
    static struct picture picture;
    conus_cut_view view = whole;
    view.selection = ((void **)data)[1];
    return conus_cut(picture.rgba, NULL, ((void **)data)[0], &view);
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_atlas *atlas = open_phantom("slabs");
    conus_selection *selection = select_in(atlas, NULL, 10);
    void *data[] = {atlas, selection};
    test_every_allocation(cut_once, data);
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(cut)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pixels_are_where_their_centres_are),
        cmocka_unit_test(borders_are_smooth_in_the_picture_only),
        cmocka_unit_test(borders_move_by_half_a_voxel),
        cmocka_unit_test(the_default_is_axial_and_neurological),
        cmocka_unit_test(hidden_objects_are_left_out),
        cmocka_unit_test(fill_and_outline),
        cmocka_unit_test(a_surface_around_is_an_outline),
        cmocka_unit_test(the_context_is_linear_between_black_and_white),
        cmocka_unit_test(outlines_of_what_is_not_hit_are_seen_on_any_grey),
        cmocka_unit_test(values_are_linear_between_voxels),
        cmocka_unit_test(a_cone_is_drawn_to_scale),
        cmocka_unit_test(cylinders_and_ranges_are_drawn_to_scale),
        cmocka_unit_test(hidden_areas_in_the_cone_are_hatched),
        cmocka_unit_test(closed_surfaces_are_filled),
        cmocka_unit_test(what_overlaps_is_filled_once),
        cmocka_unit_test(a_cutter_draws_the_same_pictures),
        cmocka_unit_test(a_hit_is_laid_over_the_image_or_over_ground),
        cmocka_unit_test(the_chosen_area_is_never_pale),
        cmocka_unit_test(areas_have_the_colours_of_their_ranks),
        cmocka_unit_test(what_cannot_be_drawn_is_refused),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
