/* SPDX-License-Identifier: BSD-3-Clause */
/* The viewer-centred projection (Eq. 1): the picture that an eye sees through a window. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "picture_scene.h"
#include "render/image/image.h"
#include "selection/picture/picture.h"
#include "test.h"

#include <math.h>
#include <string.h>

enum { WIDTH = PICTURE_WIDTH, HEIGHT = PICTURE_HEIGHT, ZOOM = 5 };

static const struct camera_frame frame = {.width = WIDTH, .height = HEIGHT};
static const double size[2] = {400, 300};

/* A window somewhere, and an eye on its +z side. */
static void random_window(conus_pose *window, double eye[3], uint64_t *seed)
{
    double to[3], place[3];
    for (int a = 0; a < 3; a++) {
        to[a] = test_random(seed, -200, 200);
        place[a] = test_random(seed, -500, 500);
    }
    place[2] = test_random(seed, 50, 900);
    picture_rigid(window->world_from_device, test_random(seed, 0, 6), to);
    mat4_point(eye, window->world_from_device, place);
}

static struct camera camera_through(const conus_pose *window, const double eye[3])
{
    conus_pose pose;
    double frustum[4];
    struct camera camera;
    assert_ok(conus_window_camera(&pose, frustum, window, size, eye));
    camera_from_frustum(&camera, &pose, frustum);
    return camera;
}

/* Position, in mm from the middle, of a place in the window's plane. */
static void assert_on_window(double x, double y, const double place[3])
{
    assert_near(x, (place[0] / size[0] + 0.5) * WIDTH, 1e-6);
    assert_near(y, (0.5 - place[1] / size[1]) * HEIGHT, 1e-6);
}

/* A point of the window is at the same pixel wherever the eye is; any other point is where the line to it passes
 * through the window. */
static void the_picture_is_what_the_window_shows(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int round = 0; round < 1000; round++) {
        conus_pose window;
        double eye[3], world[3], window_from_world[16] = {0}, from[3], x, y, depth;
        random_window(&window, eye, &seed);
        struct camera camera = camera_through(&window, eye);
        double place[3] = {test_random(&seed, -300, 300), test_random(&seed, -300, 300), 0};
        mat4_point(world, window.world_from_device, place);
        assert_true(camera_project(&x, &y, &depth, &camera, &frame, world));
        assert_on_window(x, y, place);
        place[2] = test_random(&seed, -500, 40);
        mat4_point(world, window.world_from_device, place);
        assert_true(mat4_invert_affine(window_from_world, window.world_from_device));
        mat4_point(from, window_from_world, eye);
        double part = from[2] / (from[2] - place[2]);
        for (int a = 0; a < 3; a++) {
            place[a] = from[a] + part * (place[a] - from[a]);
        }
        assert_true(camera_project(&x, &y, &depth, &camera, &frame, world));
        assert_on_window(x, y, place);
    }
}

static conus_atlas *make_atlas(void)
{
    conus_volume_info grid = picture_grid((size_t[]){60, 60, 60}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, picture_ten);
    struct mesh ring = mesh_scene_torus(26, 4, 60, 30);
    mesh_scene_add(atlas, &ring);
    return atlas;
}

static const double window_at_front[16] = {-1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 40, 0, 1};

static conus_image *render(conus_renderer *renderer, conus_view view)
{
    conus_image *image = NULL;
    view.width = WIDTH;
    view.height = HEIGHT;
    assert_ok(conus_render(&image, renderer, &view));
    return image;
}

/* An eye straight before the window's middle sees the plain camera's picture, to the last bit. */
static void a_symmetric_eye_is_the_plain_camera(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    conus_pose window, camera;
    double frustum[4];
    conus_image_difference difference;
    memcpy(window.world_from_device, window_at_front, sizeof window_at_front);
    assert_ok(conus_window_camera(&camera, frustum, &window, (double[]){80, 60}, (double[]){0, 160, 0}));
    assert_near(frustum[1], 40.0 / 120, 0);
    assert_near(frustum[3], 30.0 / 120, 0);
    const double field_of_view = 2 * atan(frustum[3]);
    const double plain[4] = {-tan(field_of_view / 2) * WIDTH / HEIGHT, tan(field_of_view / 2) * WIDTH / HEIGHT,
                             -tan(field_of_view / 2), tan(field_of_view / 2)};
    for (int k = 0; k < 4; k++) {
        assert_near(plain[k], frustum[k], 1e-15);
    }
    conus_view off_axis = {.camera = &camera};
    memcpy(off_axis.frustum, plain, sizeof plain);
    conus_image *a =
        render(renderer, (conus_view){.camera = &camera, .field_of_view = degrees_from_radians(field_of_view)});
    conus_image *b = render(renderer, off_axis);
    assert_ok(conus_image_compare(&difference, a, b, 0));
    assert_int_equal(difference.differing, 0);
    assert_non_null(image_find_attribute(a, "conus:fieldOfViewDegrees"));
    assert_null(image_find_attribute(b, "conus:fieldOfViewDegrees"));
    assert_int_equal(strncmp(image_find_attribute(b, "conus:frustum")->text, "-0.333", 6), 0);
    conus_image_destroy(a);
    conus_image_destroy(b);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* How often pixels of a tile's picture differ from the pixels of the whole that have the same ray. */
static size_t tile_differences(const float *whole, const float *tile, size_t i, size_t j)
{
    size_t differing = 0;
    for (size_t q = 0; q < HEIGHT / ZOOM; q++) {
        for (size_t p = 0; p < WIDTH / ZOOM; p++) {
            const float *a = whole + 4 * ((j * (HEIGHT / ZOOM) + q) * WIDTH + i * (WIDTH / ZOOM) + p);
            const float *b = tile + 4 * ((ZOOM * q + ZOOM / 2) * WIDTH + ZOOM * p + ZOOM / 2);
            float most = 0;
            for (int c = 0; c < 4; c++) {
                most = fmaxf(most, fabsf(a[c] - b[c]));
            }
            differing += most > 0.02F;
        }
    }
    return differing;
}

/* Each of 5 x 5 tiles of a picture is the picture of an off-axis frustum: volumes, context, meshes, cone. */
static void parts_of_a_picture_are_pictures(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    struct camera camera = picture_camera((double[]){-0.5, -0.8, -0.3}, 150, radians_from_degrees(25));
    const double cone[16] = {0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, -50, 3, 4, 1};
    const struct colour_view extra = {
        .world_from_cone = cone, .cone_slope = 0.2, .cone_length = 90, .line_width = 0.6, .slices = 90};
    float *whole = picture_draw(renderer, &camera, &extra, false);
    size_t differing = 0;
    for (size_t tile = 0; tile < (size_t)ZOOM * ZOOM; tile++) {
        size_t at[2] = {tile % ZOOM, tile / ZOOM};
        double frustum[4];
        struct camera part;
        conus_pose pose;
        memcpy(pose.world_from_device, camera.world_from_camera, sizeof pose.world_from_device);
        for (size_t k = 0; k < 4; k++) {
            size_t edge = at[k / 2] + k % 2;
            frustum[k] = camera.slope[k / 2] * (2 * (double)edge / ZOOM - 1);
        }
        camera_from_frustum(&part, &pose, frustum);
        float *drawn = picture_draw(renderer, &part, &extra, false);
        differing += tile_differences(whole, drawn, at[0], at[1]);
        memory_free(drawn);
    }
    assert_in_range(differing, 0, WIDTH * HEIGHT / 1000); /* rays that graze an edge */
    memory_free(whole);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

static void eyes_that_see_nothing_are_refused(void **state)
{
    (void)state;
    conus_pose window, camera = {{7}};
    double frustum[4] = {7, 7, 7, 7};
    memcpy(window.world_from_device, window_at_front, sizeof window_at_front);
    static const double eyes[][3] = {{0, 40, 0},      {0, 39, 0},    {100, -1e9, 3},   {0, 40 + 1e-9, 0},
                                     {0, 40.1, 2000}, {NAN, 100, 0}, {0, INFINITY, 0}, {0, 100, -INFINITY},
                                     {1e300, 50, 0},  {0, 1e-320, 0}};
    for (size_t i = 0; i < sizeof eyes / sizeof *eyes; i++) {
        assert_fails(conus_window_camera(&camera, frustum, &window, size, eyes[i]), CONUS_ERROR_ARGUMENT);
    }
    static const double sizes[][2] = {{0, 1}, {1, -1}, {NAN, 1}, {1, INFINITY}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        assert_fails(conus_window_camera(&camera, frustum, &window, sizes[i], (double[]){0, 99, 0}),
                     CONUS_ERROR_ARGUMENT);
    }
    window.world_from_device[0] = 1; /* mirrored */
    assert_fails(conus_window_camera(&camera, frustum, &window, size, (double[]){0, 99, 0}), CONUS_ERROR_ARGUMENT);
    assert_near(camera.world_from_device[0], 7, 0);
    assert_near(frustum[3], 7, 0);
}

static void frusta_that_are_none_are_refused(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    conus_pose camera;
    memcpy(camera.world_from_device, window_at_front, sizeof window_at_front);
    const conus_view views[] = {{.frustum = {-1, 1, -1, 1}}, /* no camera */
                                {.camera = &camera, .frustum = {-1, 1, -1, 1}, .field_of_view = 1 * 180 / MATH3_PI},
                                {.camera = &camera, .frustum = {1, -1, -1, 1}},
                                {.camera = &camera, .frustum = {-1, 1, 0.5, 0.5}},
                                {.camera = &camera, .frustum = {-1, 1, 0, 0}},
                                {.camera = &camera, .frustum = {-1, NAN, -1, 1}},
                                {.camera = &camera, .frustum = {-INFINITY, 1, -1, 1}},
                                {.camera = &camera, .frustum = {-1, 1, -1, 1000.5}}};
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        conus_image *image = NULL;
        assert_fails(conus_render(&image, renderer, &views[i]), CONUS_ERROR_ARGUMENT);
        assert_null(image);
    }
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(off_axis)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_picture_is_what_the_window_shows), cmocka_unit_test(a_symmetric_eye_is_the_plain_camera),
        cmocka_unit_test(parts_of_a_picture_are_pictures),      cmocka_unit_test(eyes_that_see_nothing_are_refused),
        cmocka_unit_test(frusta_that_are_none_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
