/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures by rays on the CPU against those by OpenGL, scene by scene, by any number of threads, and piece by piece.
 * What either must show by closed forms the other tests of this folder ask both (<subject>_by_rays). */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "mesh_scene.h"
#include "picture_scene.h"
#include "render/colour/colour.h"
#include "test.h"
#include "test_gl.h"
#include "value_maps.h"

#include <sched.h>
#include <string.h>

/* Two half balls and a rod beside them. */
static double three_areas(const double p[3])
{
    double r = vec3_length(p);
    return r < 12 ? (p[0] < 0 ? 3 : 700) : fabs(p[1] - 15) < 3 && fabs(p[2]) < 3 && fabs(p[0]) < 20 ? 9 : 0;
}

/* A shell of 100 with a soft edge, 40 inside. */
static double soft_shell(const double p[3])
{
    double r = vec3_length(p);
    return r < 16 ? 40 : fmax(0, 100 - 12 * fabs(r - 20));
}

static conus_atlas *areas_of(picture_function context)
{
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, picture_identity);
    return picture_atlas(&grid, three_areas, NULL, context);
}

static conus_atlas *areas(void)
{
    return areas_of(NULL);
}

static conus_atlas *areas_in_a_shell(void)
{
    return areas_of(soft_shell);
}

static void add_ball(conus_atlas *atlas, double x, double radius)
{
    struct mesh ball = mesh_scene_sphere((double[]){x, 0, 0}, radius, 24, 48);
    mesh_scene_add(atlas, &ball);
}

static conus_atlas *meshes(void)
{
    conus_atlas *atlas = mesh_scene_atlas();
    add_ball(atlas, -8, 10);
    add_ball(atlas, 8, 12);
    add_ball(atlas, 0, 5);
    return atlas;
}

static conus_atlas *meshes_among_areas(void)
{
    conus_atlas *atlas = areas();
    add_ball(atlas, 10, 14);
    return atlas;
}

static conus_atlas *areas_in_glass(void)
{
    conus_atlas *atlas = areas();
    struct context_surface glass = {.mesh = mesh_scene_sphere((double[]){0, 0, 0}, 22, 24, 48), .opacity = 0.3};
    assert_ok(atlas_add_context_surface(atlas, &glass));
    return atlas;
}

static double slab(const double p[3])
{
    return fabs(p[1]) < 8 && fabs(p[0]) < 20 ? 0.6 + p[2] / 80 : 0;
}

static conus_atlas *a_pathway(void)
{
    conus_atlas *atlas = areas();
    conus_volume_info info = picture_grid((size_t[]){60, 60, 60}, (double[]){1, 1, 1}, picture_identity);
    const size_t count = (size_t)60 * 60 * 60;
    float *values = memory_raw(count, sizeof *values);
    info.role = CONUS_ROLE_SCALAR;
    info.threshold = 0.5;
    for (size_t v = 0; v < count; v++) {
        const size_t k = v / 60 / 60;
        double p[3] = {(double)(v % 60), (double)(v / 60 % 60), (double)k};
        mat4_point(p, info.world_from_voxel, p);
        values[v] = (float)slab(p);
    }
    assert_ok(pathway_of_values(atlas, &info, values, "tract"));
    return atlas;
}

/* Helices round the z axis. */
static conus_atlas *streamlines(void)
{
    enum { LINES = 12, POINTS = 60 };
    struct tractogram made = {.path = memory_text("lines", 5),
                              .points = memory_zeroed((size_t)LINES * POINTS, 3 * sizeof(float)),
                              .first = memory_zeroed(LINES + 1, sizeof(uint64_t)),
                              .point_count = (uint64_t)LINES * POINTS,
                              .streamline_count = LINES,
                              .radius = 1};
    assert_true(made.path && made.points && made.first);
    for (size_t k = 0; k < LINES; k++) {
        for (size_t i = 0; i < POINTS; i++) {
            double turn = (double)k * 2 * MATH3_PI / LINES + (double)i / 20;
            float *p = &made.points[3 * (k * POINTS + i)];
            p[0] = (float)(15 * cos(turn));
            p[1] = (float)(15 * sin(turn));
            p[2] = (float)i - POINTS / 2.0F;
        }
        made.first[k + 1] = (k + 1) * POINTS;
    }
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, "none"));
    assert_ok(atlas_add_tractogram(atlas, &made, "lines"));
    return atlas;
}

static const uint8_t emphasis[] = {0, EMPHASIS_FULL, EMPHASIS_HATCHED, EMPHASIS_PALE};
static const float half[] = {1, 0.5F, 0.3F, 1};
static const float hidden[] = {1, 0, 0.6F, 0.6F};
static const uint8_t grey[3] = {201, 205, 211};
static const uint32_t group[] = {0, 2, 2, 3};
static const struct colour_marker marker = {.centre = {6, -18, 6}, .radius = 3, .rgb = {200, 20, 20}};

/* A scene, and the most by which two pictures of it may differ: the mean of all channels, and the part of the pixels of
 * which one differs by more than 0.1, where white is 1. Edges differ, and what a coarse sampling of the context shows.
 */
static const struct scene {
    const char *name;
    conus_atlas *(*make)(void);
    const char *transfer; /* of the context */
    const char *haze;     /* of pathways; NULL = none */
    bool cone, smooth;
    double distance; /* of the camera, mm */
    struct colour_view view;
    double mean, edges;
} scenes[] = {
    {"areas", areas, NULL, NULL, false, false, 150, {0}, 3e-4, 0.001},
    {"smooth", areas, NULL, NULL, false, true, 150, {0}, 3e-4, 0.001},
    {"a cone, pale and hatched", areas, NULL, NULL, true, true, 150, {.emphasis = emphasis}, 3e-4, 0.001},
    {"one tone", areas, NULL, NULL, true, false, 150, {.emphasis = emphasis, .pale_rgb = grey}, 3e-4, 0.002},
    {"a group", areas, NULL, NULL, true, false, 150, {.group = group}, 3e-4, 0.002},
    {"a context", areas_in_a_shell, "brain", NULL, false, false, 150, {0}, 4e-4, 0.001},
    {"a dense one, and a cone", areas_in_a_shell, "surface", NULL, true, true, 150, {0}, 1.5e-3, 0.001},
    {"half gone", areas_in_a_shell, "grey", NULL, false, false, 150, {.fade = 0.5}, 4e-4, 0.001},
    {"translucent", areas, NULL, NULL, false, true, 150, {.opacity = half}, 1.5e-4, 0.001},
    {"translucent to the picture's end", areas, NULL, NULL, false, true, 50, {.opacity = half}, 4e-4, 0.001},
    {"translucent in a context", areas_in_a_shell, "heat", NULL, true, false, 150, {.opacity = hidden}, 3e-3, 0.001},
    {"meshes", meshes, NULL, NULL, true, true, 150, {.emphasis = emphasis}, 3e-5, 0.001},
    {"translucent meshes", meshes, NULL, NULL, true, true, 150, {.opacity = half}, 3e-5, 0.001},
    {"meshes among areas", meshes_among_areas, NULL, NULL, false, false, 150, {0}, 2e-4, 0.001},
    {"glass", areas_in_glass, NULL, NULL, true, true, 150, {0}, 1.2e-4, 0.001},
    {"a pathway", a_pathway, NULL, NULL, true, false, 150, {0}, 3e-4, 0.004},
    {"haze", a_pathway, NULL, "heat", true, false, 150, {0}, 1e-3, 0.001},
    {"streamlines", streamlines, NULL, NULL, true, true, 150, {0}, 3e-5, 0.001},
    {"a draft of them", streamlines, NULL, NULL, false, false, 150, {.draft = 3}, 3e-5, 0.001},
};

static float *draw_scene(const struct scene *scene, conus_engine engine)
{
    const conus_pathway_transfer haze = {.transfer = scene->haze};
    const conus_renderer_options options = {
        .transfer = scene->transfer, .pathways = &haze, .pathway_count = scene->haze ? 1 : 0, .engine = engine};
    conus_atlas *atlas = scene->make();
    conus_renderer *renderer = NULL;
    assert_ok(conus_renderer_create(&renderer, atlas, &options));
    assert_true(engine != CONUS_ENGINE_RAYS || strcmp(conus_renderer_device(renderer), "rays") == 0);
    struct camera camera = picture_camera((double[]){1, 2, -1}, scene->distance, radians_from_degrees(25));
    struct colour_view view = scene->view;
    conus_pose pose;
    assert_ok(conus_pose_toward(&pose, (double[]){-40, -30, 20}, (double[]){0, 0, 0}, NULL));
    if (scene->cone) {
        view.world_from_cone = pose.world_from_device;
        view.cone_slope = 0.15;
        view.cone_length = 45;
        view.line_width = 1;
        view.markers = &marker;
        view.marker_count = 1;
    }
    if (scene->smooth) { /* nothing of one picture is in the next */
        memory_free(picture_draw(renderer, &camera, &view, true));
    }
    float *rgba = picture_draw(renderer, &camera, &view, scene->smooth);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
    return rgba;
}

static void pictures_look_as_opengl_draws_them(void **state)
{
    (void)state;
    if (picture_engine() == CONUS_ENGINE_RAYS) { /* with sanitizers, say */
        skip();
    }
    test_need_gl();
    size_t failed = 0;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        float *gl = draw_scene(&scenes[i], CONUS_ENGINE_GL);
        float *rays = draw_scene(&scenes[i], CONUS_ENGINE_RAYS);
        double edges = 0;
        double shown = 0;
        for (size_t p = 0; p < PICTURE_PIXELS; p++) {
            double most = 0;
            for (size_t c = 0; c < 4; c++) {
                most = fmax(most, fabs((double)gl[4 * p + c] - (double)rays[4 * p + c]));
            }
            edges += most > 0.1;
            shown += gl[4 * p + 3] > 0.05F;
        }
        const double mean = picture_difference(gl, rays);
        assert_true(shown > 100); /* there is something to compare */
        if (mean > scenes[i].mean || edges / PICTURE_PIXELS > scenes[i].edges) {
            print_message("%s: %.6f and %.5f, allowed are %g and %g\n", scenes[i].name, mean, edges / PICTURE_PIXELS,
                          scenes[i].mean, scenes[i].edges);
            failed++;
        }
        memory_free(gl);
        memory_free(rays);
    }
    assert_int_equal(failed, 0);
}

static float *draw_shifted(const struct scene *scene, conus_engine engine, double right, double up)
{
    struct scene shifted = *scene;
    shifted.smooth = false;
    shifted.view.shift[0] = right;
    shifted.view.shift[1] = up;
    return draw_scene(&shifted, engine);
}

/* Whether the pixel differs by more than 0.05 from the one that is so far to the right and up, if there is one. */
static bool differs(const float *rgba, size_t x, size_t y, size_t right, size_t up)
{
    float most = 0;
    for (size_t c = 0; c < 4 && x + right < PICTURE_WIDTH && y + up < PICTURE_HEIGHT; c++) {
        most = fmaxf(
            most, fabsf(rgba[4 * (y * PICTURE_WIDTH + x) + c] - rgba[4 * ((y + up) * PICTURE_WIDTH + x + right) + c]));
    }
    return most > 0.05F;
}

/* Whether the 4 x 4 pixels around this one have one that differs from the next. */
static bool is_redrawn(const float *rgba, size_t x, size_t y)
{
    bool any = false;
    for (size_t n = 0; n < 16; n++) {
        const size_t i = x / 4 * 4 + n % 4;
        const size_t j = y / 4 * 4 + n / 4;
        any = any || differs(rgba, i, j, 1, 0) || differs(rgba, i, j, 0, 1);
    }
    return any;
}

/* What the renderer promises of a pixel with edges around: the mean of four rays, as of a rotated square. */
static float mean_of_square(float *const shifted[4], size_t at)
{
    float sum = 0;
    for (size_t n = 0; n < 4; n++) {
        sum += 0.25F * shifted[n][at];
    }
    return sum;
}

/* And where something may be translucent: half its own ray, an eighth of each of its corners, which are the lower left
 * ones of pixels around, unless those have no edges or are beyond the picture. */
static float mean_of_corners(const float *own, const float *corners, size_t x, size_t y, size_t c)
{
    const float centre = own[4 * (y * PICTURE_WIDTH + x) + c];
    float sum = 4 * centre;
    for (size_t n = 0; n < 4; n++) {
        const size_t i = x + n % 2 < PICTURE_WIDTH ? x + n % 2 : x;
        const size_t j = y + n / 2 < PICTURE_HEIGHT ? y + n / 2 : y;
        sum += is_redrawn(own, i, j) ? corners[4 * (j * PICTURE_WIDTH + i) + c] : centre;
    }
    return sum / 8;
}

/* Pictures without smooth edges, shifted, say what a smooth one is: by rays to the bit. A driver may round the blending
 * of four by itself. */
static void check_edges(const struct scene *scene, conus_engine engine)
{
    const float allowed = engine == CONUS_ENGINE_RAYS ? 0 : 1e-6F;
    float *smooth = draw_scene(scene, engine);
    float *own = draw_shifted(scene, engine, 0, 0);
    float *shifted[] = {draw_shifted(scene, engine, -0.125, -0.375), draw_shifted(scene, engine, 0.375, -0.125),
                        draw_shifted(scene, engine, 0.125, 0.375), draw_shifted(scene, engine, -0.375, 0.125),
                        draw_shifted(scene, engine, -0.5, -0.5)};
    size_t redrawn = 0;
    for (size_t at = 0; at < 4 * (size_t)PICTURE_PIXELS; at++) {
        const size_t x = at / 4 % PICTURE_WIDTH;
        const size_t y = at / 4 / PICTURE_WIDTH;
        const bool is_edge = is_redrawn(own, x, y);
        const float wanted = !is_edge              ? own[at]
                             : scene->view.opacity ? mean_of_corners(own, shifted[4], x, y, at % 4)
                                                   : mean_of_square(shifted, at);
        redrawn += is_edge;
        if (fabsf(smooth[at] - wanted) > (is_edge ? allowed : 0)) {
            fail_msg("%s: %g in place of %g at %zu, %zu", scene->name, (double)smooth[at], (double)wanted, x, y);
        }
    }
    assert_in_range(redrawn, 4 * 100, 4 * (PICTURE_PIXELS - 100));
    for (size_t n = 0; n < sizeof shifted / sizeof *shifted; n++) {
        memory_free(shifted[n]);
    }
    memory_free(smooth);
    memory_free(own);
}

static void smooth_edges_are_means_of_rays(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        if (scenes[i].smooth) {
            check_edges(&scenes[i], CONUS_ENGINE_RAYS);
        }
    }
}

static void smooth_edges_are_the_same_on_the_device(void **state)
{
    (void)state;
    test_need_gl();
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        if (scenes[i].smooth) {
            check_edges(&scenes[i], CONUS_ENGINE_GL);
        }
    }
}

/* A process that may use one processor draws with one thread. */
static void threads_change_no_bit(void **state)
{
    (void)state;
    cpu_set_t all, one;
    assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
    if (CPU_COUNT(&all) < 2) {
        skip();
    }
    CPU_ZERO(&one);
    for (size_t cpu = 0; !CPU_COUNT(&one); cpu++) {
        if (CPU_ISSET(cpu, &all)) {
            CPU_SET(cpu, &one);
        }
    }
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        float *many = draw_scene(&scenes[i], CONUS_ENGINE_RAYS);
        assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
        float *single = draw_scene(&scenes[i], CONUS_ENGINE_RAYS);
        assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
        assert_memory_equal(single, many, (size_t)4 * PICTURE_PIXELS * sizeof *many);
        memory_free(many);
        memory_free(single);
    }
}

struct pieces {
    size_t heard, most, done;
};

static bool hear(void *user, size_t done, size_t total)
{
    struct pieces *pieces = user;
    assert_true(done > pieces->done && done <= total);
    pieces->done = done;
    return ++pieces->heard < pieces->most;
}

/* Whoever listens may end a picture after any piece, and changes nothing of it. */
static void a_listener_ends_a_picture(void **state)
{
    (void)state;
    conus_atlas *atlas = areas();
    conus_renderer *renderer = NULL;
    assert_ok(conus_renderer_create(&renderer, atlas, &(conus_renderer_options){.engine = CONUS_ENGINE_RAYS}));
    struct camera camera = picture_camera((double[]){1, 2, -1}, 150, radians_from_degrees(25));
    struct pieces all = {.most = 1000};
    struct pieces one = {.most = 1};
    struct colour_view view = {.listener = {hear, &all}};
    float *alone = picture_draw(renderer, &camera, NULL, false);
    float *heard = picture_draw(renderer, &camera, &view, false);
    assert_memory_equal(heard, alone, (size_t)4 * PICTURE_PIXELS * sizeof *alone);
    assert_true(all.heard > 0);
    view.listener.user = &one;
    view.camera = &camera;
    view.width = PICTURE_WIDTH;
    view.height = PICTURE_HEIGHT;
    assert_fails(renderer_draw(heard, renderer, &view, false), CONUS_ERROR_CANCELLED);
    assert_int_equal(one.heard, 1);
    memory_free(alone);
    memory_free(heard);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(picture_rays)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_look_as_opengl_draws_them),
        cmocka_unit_test(smooth_edges_are_means_of_rays),
        cmocka_unit_test(smooth_edges_are_the_same_on_the_device),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(a_listener_ends_a_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
