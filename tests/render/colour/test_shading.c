/* SPDX-License-Identifier: BSD-3-Clause */
/* The brightness of surfaces and context, pixel by pixel, against the closed forms of light in Eq. 8. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "picture_scene.h"
#include "render/colour/colour.h"
#include "render/image/image.h"
#include "test.h"

#include <string.h>

enum { WIDTH = PICTURE_WIDTH, HEIGHT = PICTURE_HEIGHT };

#define DISTANCE 120.0
#define RADIUS 20.0

static const double forwards[3][3] = {{0, 1, 0}, {1, 0, -0.3}, {-0.4, -0.8, -0.7}};
static const uint8_t ochre[3] = {230, 170, 40};

static double shown(const double a[3], const double b[3])
{
    return fmax(vec3_dot(a, b), 0);
}

/* Direction to the light, which moves with the camera. */
static void find_light(double out[3], const struct camera *camera)
{
    mat4_direction(out, camera->world_from_camera, (double[]){-0.42, 0.52, 0.74});
    vec3_normalise(out, out);
}

/* Unit vector along the ray of a pixel. */
static void find_view(double out[3], const struct camera *camera, int column, int row)
{
    const double direction[3] = {((column + 0.5) / WIDTH * 2 - 1) * camera->slope[0],
                                 ((row + 0.5) / HEIGHT * 2 - 1) * camera->slope[1], -1};
    mat4_direction(out, camera->world_from_camera, direction);
    vec3_normalise(out, out);
}

/* Normal where a ray from the camera hits the ball of RADIUS around 0; false if it misses. */
static bool hit_ball(double normal[3], const struct camera *camera, const double view[3])
{
    const double *eye = camera->world_from_camera + 12;
    double b = vec3_dot(eye, view);
    double root = b * b - vec3_dot(eye, eye) + RADIUS * RADIUS;
    if (root <= 0) {
        return false;
    }
    for (int a = 0; a < 3; a++) {
        normal[a] = (eye[a] + (-b - sqrt(root)) * view[a]) / RADIUS;
    }
    return true;
}

/* Light of an opaque surface (Eq. 8). */
static double surface_light(double albedo, const double normal[3], const double view[3], const double light[3])
{
    double half[3];
    vec3_sub(half, light, view);
    vec3_normalise(half, half);
    return albedo * (0.30 + 0.75 * shown(normal, light)) + 0.06 * pow(shown(normal, half), 30);
}

/* Asserts the light of each pixel in which the ball faces the eye by more than `least`: that of its normal and
 * `albedo`. */
static void check_ball(const float *rgba, const struct camera *camera, const double albedo[3], double least,
                       double tolerance)
{
    double light[3];
    int count = 0;
    find_light(light, camera);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        double view[3], normal[3];
        find_view(view, camera, i % WIDTH, i / WIDTH);
        if (hit_ball(normal, camera, view) && -vec3_dot(normal, view) > least) {
            for (int c = 0; c < 3; c++) {
                assert_near(rgba[4 * i + c], surface_light(albedo[c], normal, view, light), tolerance);
            }
            count++;
        }
    }
    assert_true(count > 1000);
}

/* A marker is a ball in closed form, dark where it faces the eye by less than 0.55. */
static void markers_are_lit(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){9, 9, 9}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_nothing, NULL, NULL);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    struct colour_marker marker = {.radius = RADIUS};
    double albedo[3];
    memcpy(marker.rgb, ochre, 3);
    for (int c = 0; c < 3; c++) {
        albedo[c] = linear_from_srgb(ochre[c] / 255.0);
    }
    for (int n = 0; n < 3; n++) {
        struct camera camera = picture_camera(forwards[n], DISTANCE, radians_from_degrees(25));
        float *rgba =
            picture_draw(renderer, &camera, &(struct colour_view){.markers = &marker, .marker_count = 1}, false);
        check_ball(rgba, &camera, albedo, 0.56, 1e-4);
        memory_free(rgba);
    }
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* A mesh ball of 65,000 triangles, whose normals are the ball's but for 0.01; in its own colour, and pale. */
static void meshes_are_lit(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh ball = mesh_scene_sphere((double[]){0, 0, 0}, RADIUS, 128, 256);
    mesh_scene_add(atlas, &ball);
    memcpy(atlas->objects[0].rgb, ochre, 3);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    const uint8_t none[2] = {0, 0};
    for (int n = 0; n < 6; n++) {
        struct camera camera = picture_camera(forwards[n % 3], DISTANCE, radians_from_degrees(25));
        double albedo[3];
        for (int c = 0; c < 3; c++) {
            albedo[c] = linear_from_srgb(ochre[c] / 255.0);
            albedo[c] = n < 3 ? albedo[c] : 0.16 * albedo[c] + 0.30;
        }
        float *rgba = picture_draw(renderer, &camera, &(struct colour_view){.emphasis = n < 3 ? NULL : none}, false);
        check_ball(rgba, &camera, albedo, 0.2, 0.006);
        memory_free(rgba);
    }
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* Rises by 4, 6 and 2 of 255 levels per mm along x, y and z: whole levels at the voxels. */
static double ramp(const double p[3])
{
    return 128 + 4 * p[0] + 6 * p[1] + 2 * p[2];
}

/* The context's shade depends on the gradient alone, and its colour over its opacity is that of the function times the
 * shade. A byte holds a component of a gradient to 0.004, of which half is shaded by up to 0.8. */
static void the_context_is_shaded_by_its_gradient(void **state)
{
    (void)state;
    const double slope[3] = {4, 6, 2};
    conus_volume_info grid = picture_grid((size_t[]){21, 21, 21}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_nothing, NULL, ramp);
    const char *path = test_scratch("ramp.tf");
    const char text[] = "0 1 0.5 0 0.06\n255 1 0.5 0 0.06\n";
    assert_ok(conus_write_file(path, text, strlen(text)));
    conus_renderer *renderer = picture_renderer(atlas, path);
    double steepness = vec3_length(slope) / 255;
    double share = steepness / (steepness + 0.03);
    int lit = 0;
    for (int n = 0; n < 6; n++) {
        double forward[3], light[3], normal[3];
        vec3_scale(forward, forwards[n % 3], n < 3 ? 1 : -1);
        vec3_scale(normal, slope, -1 / vec3_length(slope));
        struct camera camera = picture_camera(forward, 100, radians_from_degrees(8));
        float *rgba = picture_draw(renderer, &camera, NULL, false);
        find_light(light, &camera);
        double shade = 1 - share + share * (0.35 + 0.8 * shown(normal, light));
        lit += shown(normal, light) > 0.2;
        for (int row = HEIGHT / 2 - 20; row < HEIGHT / 2 + 20; row += 10) {
            for (int column = WIDTH / 2 - 20; column < WIDTH / 2 + 20; column += 10) {
                const float *p = rgba + 4 * ((ptrdiff_t)row * WIDTH + column);
                assert_true(p[3] > 0.3F);
                assert_near(p[0] / p[3], shade, 0.004);
                assert_near(p[1] / p[3], 0.214041 * shade, 0.004); /* sRGB 0.5 */
            }
        }
        memory_free(rgba);
    }
    assert_in_range(lit, 1, 5); /* some from the light's side, some from the other */
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* The planes reach over areas and context, whichever is nearer, so that neither is missing. */
static void planes_reach_over_every_volume(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, picture_identity);
    for (int behind = 0; behind < 2; behind++) {
        double place[16];
        mat4_identity(place);
        place[13] = behind ? 60 : -60;
        conus_volume_info other = picture_grid((size_t[]){100, 20, 100}, (double[]){1, 1, 1}, place);
        conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, &other, picture_ten);
        memcpy(atlas->objects[0].rgb, (uint8_t[]){255, 0, 0}, 3);
        const char *path = test_scratch("haze.tf");
        assert_ok(conus_write_file(path, "0 0 0 1 0.02\n", strlen("0 0 0 1 0.02\n"))); /* blue */
        conus_renderer *renderer = picture_renderer(atlas, path);
        struct camera camera = picture_camera((double[]){0, 1, 0}, 200, radians_from_degrees(25));
        float *rgba = picture_draw(renderer, &camera, NULL, false);
        const float *ball = rgba + (ptrdiff_t)4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
        const float *beside = ball + (ptrdiff_t)4 * 18;
        double view[3];
        find_view(view, &camera, WIDTH / 2 + 18, HEIGHT / 2);
        assert_true(ball[0] > 0.2F);
        assert_near(ball[3], 1, 1e-6);
        assert_near(beside[2], 1 - pow(1 - 0.02, 20 / view[1]), 0.03); /* 20 mm of haze, to a plane */
        memory_free(rgba);
        conus_renderer_destroy(renderer);
        conus_atlas_destroy(atlas);
    }
}

TEST_GROUP(shading)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(markers_are_lit),
        cmocka_unit_test(meshes_are_lit),
        cmocka_unit_test(the_context_is_shaded_by_its_gradient),
        cmocka_unit_test(planes_reach_over_every_volume),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
