/* SPDX-License-Identifier: BSD-3-Clause */
/* Streamlines in pictures: each pixel against a march along its ray that uses distances to segments only, and their
 * colours. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/picture.h"
#include "mesh_scene.h"
#include "picture_scene.h"
#include "render/passes/id_pass.h"
#include "render/passes/shapes.h"
#include "test.h"
#include "test_gl.h"
#include "tract_scene.h"

#include <string.h>

enum { WIDTH = 160, HEIGHT = 120, WALKS = 12, STEPS = 20, TURNS = 200000 };

#define RADIUS 1.5

/* Random walks of STEPS points within about 25 mm, each with a point that occurs twice; then a streamline of a single
 * point, in front of the walks as seen along y. */
static struct tractogram random_walks(void)
{
    uint64_t random = 1910;
    size_t points = (size_t)WALKS * STEPS + 1;
    struct tractogram made = {.path = memory_text("walks", 5),
                              .points = memory_zeroed(points, 3 * sizeof(float)),
                              .first = memory_zeroed(WALKS + 2, sizeof(uint64_t)),
                              .point_count = points,
                              .streamline_count = WALKS + 1,
                              .radius = RADIUS};
    assert_true(made.path && made.points && made.first);
    for (size_t i = 0; i < points; i++) {
        bool begins = i % STEPS == 0;
        for (size_t a = 0; a < 3; a++) {
            made.points[3 * i + a] = (float)(begins ? test_random(&random, -20, 20)
                                                    : (double)made.points[3 * i - 3 + a] + test_random(&random, -3, 3));
        }
        if (i % STEPS == 7) {
            memcpy(&made.points[3 * i], &made.points[3 * i - 3], 3 * sizeof(float));
        }
    }
    memcpy(&made.points[3 * (points - 1)], (const float[]){0, -32, 0}, 3 * sizeof(float));
    for (size_t k = 0; k <= WALKS; k++) {
        made.first[k] = k * STEPS;
    }
    made.first[WALKS + 1] = points;
    return made;
}

static conus_atlas *atlas_of(struct tractogram tractogram)
{
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, "none"));
    assert_ok(atlas_add_tractogram(atlas, &tractogram, "walks"));
    return atlas;
}

static double distance_to_segment(const double p[3], const double a[3], const double b[3])
{
    double along[3];
    double away[3];
    vec3_sub(along, b, a);
    vec3_sub(away, p, a);
    double square = vec3_dot(along, along);
    double s = square > 0 ? fmin(fmax(vec3_dot(away, along) / square, 0), 1) : 0;
    vec3_add_scaled(away, away, -s, along);
    return vec3_length(away);
}

static double distance_to_tubes(const struct tractogram *tractogram, const double p[3])
{
    double least = INFINITY;
    for (uint32_t k = 0; k < tractogram->streamline_count; k++) {
        uint64_t last = tractogram->first[k + 1] - 1;
        for (uint64_t i = tractogram->first[k]; i <= last; i++) {
            double a[3];
            double b[3];
            tractogram_point(a, tractogram, i);
            tractogram_point(b, tractogram, i < last ? i + 1 : i);
            least = fmin(least, distance_to_segment(p, a, b));
        }
    }
    return least - tractogram->radius;
}

/* Distance along the ray to its first point in a tube; INFINITY if there is none. The distance to the tubes changes by
 * at most 1 per mm, so nothing is stepped over. *least becomes the ray's least distance before that. */
static double march(double *least, const struct tractogram *tractogram, const double origin[3], const double ray[3])
{
    double t = 0;
    double before = INFINITY;
    *least = INFINITY;
    for (int turn = 0; turn < TURNS && t < 300; turn++) {
        double p[3];
        vec3_add_scaled(p, origin, t, ray);
        double away = distance_to_tubes(tractogram, p);
        if (away < 1e-5) {
            return t;
        }
        if (away > before) {
            *least = fmin(*least, before);
        }
        before = away;
        t += away;
    }
    return INFINITY;
}

/* Depth of the ray in the tube that it enters at t. */
static double depth_in_tube(const struct tractogram *tractogram, const double origin[3], const double ray[3], double t)
{
    double deepest = 0;
    for (int n = 0; n <= 100; n++) {
        double p[3];
        vec3_add_scaled(p, origin, t + n * 2 * RADIUS / 100, ray);
        deepest = fmax(deepest, -distance_to_tubes(tractogram, p));
    }
    return deepest;
}

struct layer_picture {
    float surface[WIDTH * HEIGHT][4]; /* bottom row first */
    uint32_t object[WIDTH * HEIGHT];
};

static void draw_by_rays(struct layer_picture *out, const conus_atlas *atlas, const struct mesh_layer_view *view,
                         const struct tube_colouring *colouring, const bool *const *is_pale)
{
    uint64_t memory = 1 << 24;
    struct surface_rays *rays = NULL;
    struct surface_band band = {0};
    assert_ok(surface_rays_create(&rays, atlas, &memory));
    assert_ok(surface_rays_update(rays, atlas, colouring, is_pale));
    assert_ok(surface_rays_begin(rays, view));
    assert_ok(surface_band_init(&band, rays));
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
        const struct surface_hit *hit = &band.solid[i % (SURFACE_BAND * WIDTH)];
        if (i % (SURFACE_BAND * WIDTH) == 0) {
            surface_rays_fill(&band, rays, i / (SURFACE_BAND * WIDTH), view->shift);
        }
        memcpy(out->surface[i], hit->normal, sizeof hit->normal);
        out->surface[i][3] = hit->depth;
        out->object[i] = hit->object;
    }
    surface_band_finish(&band);
    surface_rays_destroy(rays);
}

static void draw_view(struct layer_picture *out, const conus_atlas *atlas, const struct mesh_layer_view *view,
                      const struct tube_colouring *colouring, const bool *const *is_pale)
{
    if (picture_engine() == CONUS_ENGINE_RAYS) {
        draw_by_rays(out, atlas, view, colouring, is_pale);
        return;
    }
    struct test_gl gl;
    test_gl_enter(&gl);
    uint64_t memory = 1 << 24;
    struct mesh_layer *layer = NULL;
    assert_ok(mesh_layer_create(&layer, atlas, &memory));
    assert_ok(mesh_layer_update(layer, atlas, colouring, is_pale));
    assert_ok(mesh_layer_draw(layer, view));
    glGetTextureImage(mesh_layer_surface(layer), 0, GL_RGBA, GL_FLOAT, sizeof out->surface, out->surface);
    glGetTextureImage(mesh_layer_object(layer), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, sizeof out->object, out->object);
    mesh_layer_destroy(layer);
    test_gl_leave(&gl);
}

static void draw(struct layer_picture *out, const conus_atlas *atlas, const struct camera *camera,
                 const double shift[2], const struct tube_colouring *colouring, const bool *const *is_pale)
{
    const struct mesh_layer_view view = {camera, WIDTH, HEIGHT, {shift[0], shift[1]}, NULL, false, {NULL, NULL}};
    draw_view(out, atlas, &view, colouring, is_pale);
}

static void find_ray(double ray[3], const struct camera *camera, int x, int y, const double shift[2])
{
    double u = (2 * (x + 0.5 + shift[0]) / WIDTH - 1) * camera->slope[0] + camera->middle[0];
    double v = (2 * (y + 0.5 + shift[1]) / HEIGHT - 1) * camera->slope[1] + camera->middle[1];
    const double local[3] = {u, v, -1};
    mat4_direction(ray, camera->world_from_camera, local);
}

/* Depths are compared at pixels that are not within 0.01 mm of a silhouette; normals where the march has one. */
static void check_pixels(const struct layer_picture *picture, const struct tractogram *tractogram,
                         const struct camera *camera, const double shift[2])
{
    size_t hits = 0;
    size_t grazing = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i += 3) {
        double direction[3];
        double ray[3] = {0};
        double least;
        find_ray(direction, camera, i % WIDTH, i / WIDTH, shift);
        assert_true(vec3_normalise(ray, direction));
        double t = march(&least, tractogram, camera->world_from_camera + 12, ray);
        double depth = (double)picture->surface[i][3] * vec3_length(direction);
        bool same = isinf(t) ? depth == 0 : fabs(depth - t) < 2e-3;
        hits += !isinf(t);
        if (!same) { /* a ray that only touches may be on either side */
            grazing++;
            assert_true(least < 0.01 || fabs(depth - t) < 0.5 ||
                        (isfinite(t) && depth_in_tube(tractogram, camera->world_from_camera + 12, ray, t) < 0.01));
        }
        assert_true(depth == 0 || picture->object[i] == 1);
    }
    assert_true(hits > 500);
    assert_true(grazing < hits / 50);
}

static void every_pixel_has_the_nearest_capsule(void **state)
{
    (void)state;
    static const double forwards[2][3] = {{0, 1, 0}, {0.4, -0.8, -0.7}};
    static const double shifts[2][2] = {{0, 0}, {0.25, -0.375}};
    static struct layer_picture picture;
    conus_atlas *atlas = atlas_of(random_walks());
    for (int n = 0; n < 2; n++) {
        struct camera camera = picture_camera(forwards[n], n ? 25 : 120, radians_from_degrees(n ? 70 : 25));
        camera.middle[0] = n ? 0.1 : 0;
        draw(&picture, atlas, &camera, shifts[n], &(const struct tube_colouring){0}, NULL);
        check_pixels(&picture, &atlas->tractograms[0], &camera, shifts[n]);
    }
    conus_atlas_destroy(atlas);
}

/* Three straight streamlines, along x, y and z, apart from each other. */
static struct tractogram three_axes(void)
{
    static const float points[] = {-9, 0, -8, 9, 0, -8, 15, -9, 0, 15, 9, 0, -15, 0, -5, -15, 0, 9};
    static const uint64_t first[] = {0, 2, 4, 6};
    return tract_of("axes", points, first, 3, RADIUS);
}

/* The object that covers the world point, as seen along y. */
static uint32_t painted_at(const struct layer_picture *picture, const struct camera *camera, const double p[3])
{
    const struct camera_frame frame = {WIDTH, HEIGHT, 0, 0, 0, 0};
    double x;
    double y;
    double depth;
    assert_true(camera_project(&x, &y, &depth, camera, &frame, p));
    return picture->object[(HEIGHT - 1 - (int)y) * WIDTH + (int)x];
}

static const double on_axes[3][3] = {{0, 0, -8}, {15, 0, 0}, {-15, 0, 2}};

static void directions_are_red_green_and_blue(void **state)
{
    (void)state;
    static struct layer_picture picture;
    static const uint32_t expected[3] = {0x0000ff, 0x00ff00, 0xff0000}; /* red first, from the lowest byte */
    conus_atlas *atlas = atlas_of(three_axes());
    const struct camera camera = picture_camera((const double[]){0, 1, 0}, 120, radians_from_degrees(25));
    const struct tube_colouring colouring = {.by = TUBE_BY_DIRECTION};
    draw(&picture, atlas, &camera, (const double[]){0, 0}, &colouring, NULL);
    for (int k = 0; k < 3; k++) {
        assert_int_equal(painted_at(&picture, &camera, on_axes[k]), TUBE_OWN_COLOUR | expected[k]);
    }
    conus_atlas_destroy(atlas);
}

/* A direction and its opposite have one colour: 255 times the sizes of the parts of a unit vector, rounded. */
static void a_direction_has_the_colour_of_its_opposite(void **state)
{
    (void)state;
    static const struct {
        double along[3];
        uint8_t rgb[3];
    } of[] = {{{-1, 0, 0}, {255, 0, 0}},     {{0, -2, 0}, {0, 255, 0}},   {{0, 0, -3}, {0, 0, 255}},
              {{-3, -4, 0}, {153, 204, 0}},  {{3, 0, -4}, {153, 0, 204}}, {{2, -2, 1}, {170, 170, 85}},
              {{-2, 2, -1}, {170, 170, 85}}, {{0, 0, 0}, {128, 128, 128}}};
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        uint8_t rgb[3];
        tube_direction_colour(rgb, of[i].along);
        assert_memory_equal(rgb, of[i].rgb, 3);
    }
}

/* Numbers 0, 5 and 10 per streamline: both ends and the middle of the colours; the second is pale. */
static void numbers_span_the_colours_and_pale_ones_are_pale(void **state)
{
    (void)state;
    static struct layer_picture picture;
    static const float values[3] = {0, 5, 10};
    static const bool pale[3] = {false, true, false};
    const bool *const is_pale[1] = {pale};
    struct tractogram axes = three_axes();
    axes.scalars = memory_zeroed(1, sizeof *axes.scalars);
    axes.scalar_count = 1;
    axes.scalars[0] = (struct tract_scalar){memory_text("fa", 2), false, 1, memory_copy(values, 3, sizeof *values)};
    conus_atlas *atlas = atlas_of(axes);
    const struct camera camera = picture_camera((const double[]){0, 1, 0}, 120, radians_from_degrees(25));
    struct tube_colouring colouring = {0};
    assert_ok(tube_colouring_choose(&colouring, atlas, "fa"));
    assert_true(colouring.low == 0 && colouring.high == 10);
    draw(&picture, atlas, &camera, (const double[]){0, 0}, &colouring, is_pale);
    for (int k = 0; k < 3; k++) {
        uint8_t rgb[3];
        tube_scalar_colour(rgb, k / 2.0);
        uint32_t expected = TUBE_OWN_COLOUR | rgb[0] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2] << 16;
        assert_int_equal(painted_at(&picture, &camera, on_axes[k]), expected | (k == 1 ? TUBE_PALE : 0));
    }
    tube_colouring_finish(&colouring);
    assert_fails(tube_colouring_choose(&colouring, atlas, "md"), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "colour of streamlines: md is none of bundle, direction, fa");
    conus_atlas_destroy(atlas);
}

/* Numbers that are not finite are not in the range; numbers with three components per point are not offered in
 * messages. */
static void a_range_is_of_finite_numbers_of_one_part(void **state)
{
    (void)state;
    static const float values[3] = {2, INFINITY, -INFINITY};
    static const float triples[9] = {0};
    struct tractogram axes = three_axes();
    axes.scalars = memory_zeroed(2, sizeof *axes.scalars);
    axes.scalar_count = 2;
    axes.scalars[0] = (struct tract_scalar){memory_text("fa", 2), false, 1, memory_copy(values, 3, sizeof *values)};
    axes.scalars[1] = (struct tract_scalar){memory_text("v1", 2), false, 3, memory_copy(triples, 9, sizeof *triples)};
    conus_atlas *atlas = atlas_of(axes);
    struct tube_colouring colouring = {0};
    assert_ok(tube_colouring_choose(&colouring, atlas, "fa"));
    assert_true(colouring.low == 2 && colouring.high == 2);
    tube_colouring_finish(&colouring);
    assert_fails(tube_colouring_choose(&colouring, atlas, "v1"), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "colour of streamlines: v1 is none of bundle, direction, fa");
    conus_atlas_destroy(atlas);
}

/* The colours of numbers grow lighter from step to step (relative luminance, Rec. 709). */
static void colours_of_numbers_grow_lighter(void **state)
{
    (void)state;
    double before = -1;
    for (int i = 0; i <= 100; i++) {
        uint8_t rgb[3];
        tube_scalar_colour(rgb, i / 100.0);
        double light = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        assert_true(light > before);
        before = light;
    }
}

/* The colour of the ramp's stops, mixed by hand; to one unit, since the shader rounds float32. */
static void assert_ramp(uint32_t painted, double part)
{
    static const double stops[][3] = {{34, 46, 110}, {36, 104, 142}, {40, 156, 128}, {138, 204, 84}, {250, 230, 80}};
    int k = part >= 1 ? 3 : (int)(4 * part);
    assert_int_equal(painted >> 24, TUBE_OWN_COLOUR >> 24);
    for (int c = 0; c < 3; c++) {
        double wanted = stops[k][c] + (4 * part - k) * (stops[k + 1][c] - stops[k][c]);
        assert_near((double)(painted >> 8 * c & 0xff), wanted, 1.01);
    }
}

/* Numbers that are linear in x and z are linear within each triangle, too. Beyond the range the colour of its end is
 * used. Near a vertex without a number the surface has its plain colour. */
static void a_map_is_linear_within_triangles(void **state)
{
    (void)state;
    static struct layer_picture picture;
    static const double bounds[2][3] = {{-20, -12, -20}, {20, 12, 20}};
    conus_atlas *atlas = atlas_of(three_axes()); /* within the box */
    const uint32_t number = (uint32_t)conus_atlas_object_count(atlas) + 1;
    const struct camera camera = picture_camera((const double[]){0, 1, 0}, 120, radians_from_degrees(25));
    const double front = camera.world_from_camera[13] < 0 ? -12 : 12;
    struct context_surface surface = {.mesh = mesh_scene_box(bounds[0], bounds[1]), .opacity = 1, .low = 0, .high = 1};
    surface.values = memory_zeroed(8, sizeof *surface.values);
    surface.map_name = memory_text("leeway_mm", 9);
    for (size_t v = 0; v < 8; v++) {
        const float *p = surface.mesh.positions + 3 * v;
        surface.values[v] = v == 4 || v == 6 ? NAN : p[0] / 32 + p[2] / 80 + 0.5F; /* -0.375 to 1.375 */
    }
    assert_ok(atlas_add_context_surface(atlas, &surface));
    draw(&picture, atlas, &camera, (const double[]){0, 0}, &(const struct tube_colouring){0}, NULL);
    int exact = 0;
    for (int x = -18; x < 20; x += 3) {
        for (int z = -18; z < x - 2; z += 3) { /* the triangle without the corner at -20, 20 */
            /* the middle of the pixel where the point is */
            double at[3] = {x, front, z};
            const struct camera_frame frame = {WIDTH, HEIGHT, 0, 0, 0, 0};
            double px, py, depth, ray[3];
            assert_true(camera_project(&px, &py, &depth, &camera, &frame, at));
            find_ray(ray, &camera, (int)px, HEIGHT - 1 - (int)py, (const double[]){0, 0});
            double t = (front - camera.world_from_camera[13]) / ray[1];
            double part = (camera.world_from_camera[12] + t * ray[0]) / 32 +
                          (camera.world_from_camera[14] + t * ray[2]) / 80 + 0.5;
            assert_ramp(painted_at(&picture, &camera, at), fmin(fmax(part, 0), 1));
            exact++;
        }
    }
    assert_true(exact > 60);
    assert_int_equal(painted_at(&picture, &camera, (const double[]){-17, front, 17}), number);
    conus_atlas_destroy(atlas);
}

/* A hidden group hides its streamlines, unless another bundle has them. */
static void hidden_bundles_are_not_drawn(void **state)
{
    (void)state;
    static struct layer_picture picture;
    static const uint32_t members[2] = {0, 1};
    struct tractogram axes = three_axes();
    axes.groups = memory_zeroed(1, sizeof *axes.groups);
    axes.group_count = 1;
    axes.groups[0] = (struct tract_group){memory_text("two", 3), memory_copy(members, 2, sizeof *members), 2};
    conus_atlas *atlas = atlas_of(axes);
    const struct camera camera = picture_camera((const double[]){0, 1, 0}, 120, radians_from_degrees(25));
    assert_ok(conus_atlas_show(atlas, NULL, "two"));
    draw(&picture, atlas, &camera, (const double[]){0, 0}, &(const struct tube_colouring){0}, NULL);
    assert_int_equal(painted_at(&picture, &camera, on_axes[0]), 0);
    assert_int_equal(painted_at(&picture, &camera, on_axes[1]), 0);
    assert_int_equal(painted_at(&picture, &camera, on_axes[2]), 2);
    conus_atlas_destroy(atlas);
}

/* Through the whole colour pass: a red bundle along x is red in the picture's middle. */
static void a_picture_shows_a_bundle_in_its_colour(void **state)
{
    (void)state;
    conus_atlas *atlas = atlas_of(three_axes());
    memcpy(atlas->objects[0].rgb, (const uint8_t[]){255, 0, 0}, 3);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    struct camera camera = picture_camera((const double[]){0, 1, 0}, 120, radians_from_degrees(25));
    camera.world_from_camera[14] -= 8; /* at the height of the first */
    float *rgba = picture_draw(renderer, &camera, NULL, false);
    const float *middle = rgba + (ptrdiff_t)4 * (PICTURE_HEIGHT / 2 * PICTURE_WIDTH + PICTURE_WIDTH / 2);
    assert_true(middle[3] > 0.99F && middle[0] > 4 * middle[2] && middle[0] > 4 * middle[1]);
    memory_free(rgba);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

enum { ACROSS = 250, DOTS = ACROSS * ACROSS };

/* Streamlines along y, seen as dots in rows, each in the middle of a grid's square. Their points are 0.1 mm apart and
 * not in line, so that all are drawn. */
static struct tractogram dots(size_t points_each)
{
    struct tractogram made = {.path = memory_text("dots", 4),
                              .points = memory_zeroed(DOTS * points_each, 3 * sizeof(float)),
                              .first = memory_zeroed(DOTS + 1, sizeof(uint64_t)),
                              .point_count = DOTS * points_each,
                              .streamline_count = DOTS,
                              .radius = 0.03};
    assert_true(made.path && made.points && made.first);
    for (size_t k = 0; k < DOTS; k++) {
        for (size_t i = 0; i < points_each; i++) {
            size_t row = k / ACROSS;
            float *p = &made.points[3 * (k * points_each + i)];
            p[0] = (float)((double)(k % ACROSS) - (ACROSS - 1) / 2.0) * 0.16F;
            p[1] = 0.1F * (float)i;
            p[2] = (float)((double)row - (ACROSS - 1) / 2.0) * 0.16F + (i % 2 ? 0.02F : 0);
        }
        made.first[k + 1] = (k + 1) * points_each;
    }
    return made;
}

/* Pixels with a dot, of each quarter of the picture and of all. */
static size_t count_dots(size_t quarters[4], const conus_atlas *atlas, bool draft)
{
    static struct layer_picture picture;
    size_t sum = 0;
    struct camera camera = picture_camera((double[]){0, 1, 0}, 200, radians_from_degrees(12));
    const struct mesh_layer_view view = {&camera, WIDTH, HEIGHT, {0, 0}, NULL, draft ? 1e-3 : 0, {NULL, NULL}};
    draw_view(&picture, atlas, &view, &(const struct tube_colouring){0}, NULL);
    memset(quarters, 0, 4 * sizeof *quarters);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        quarters[(i % WIDTH >= WIDTH / 2) + 2 * (i / WIDTH >= HEIGHT / 2)] += picture.object[i] != 0;
        sum += picture.object[i] != 0;
    }
    return sum;
}

/* 62,500 streamlines of 3 points have 187,500, of which a draft draws 20,000, 10.7 %. The dots hardly cover each other,
 * so that the same part of the pixels has one; each quarter of the picture has a fourth of them. */
static void a_draft_has_some_from_everywhere(void **state)
{
    (void)state;
    size_t all[4];
    size_t some[4];
    conus_atlas *atlas = atlas_of(dots(3));
    double full = (double)count_dots(all, atlas, false);
    double draft = (double)count_dots(some, atlas, true);
    assert_true(full > 1000);
    assert_near(draft / full, 20000.0 / 187500, 0.2 * 20000 / 187500);
    for (int q = 0; q < 4; q++) {
        assert_near((double)some[q], draft / 4, 0.2 * draft / 4);
    }
    conus_atlas_destroy(atlas);
}

struct pieces {
    size_t heard, most; /* it ends the picture when it has heard of so many */
    size_t done, total;
};

static bool hear(void *user, size_t done, size_t total)
{
    struct pieces *pieces = user;
    assert_true(done > pieces->done && done <= total);
    pieces->done = done;
    pieces->total = total;
    return ++pieces->heard < pieces->most;
}

/* 62,500 points make two pieces with OpenGL. By rays pictures have pieces of their own (test_picture_rays.c). */
static void pieces_make_the_whole_and_may_be_the_last(void **state)
{
    (void)state;
    if (picture_engine() == CONUS_ENGINE_RAYS) {
        skip();
    }
    static struct layer_picture whole, cut;
    conus_atlas *atlas = atlas_of(dots(1));
    struct mesh_layer *layer = NULL;
    struct test_gl gl;
    uint64_t memory = 1 << 24;
    struct pieces all = {.most = 100};
    struct pieces one = {.most = 1};
    struct camera camera = picture_camera((double[]){0, 1, 0}, 200, radians_from_degrees(12));
    struct mesh_layer_view view = {&camera, WIDTH, HEIGHT, {0, 0}, NULL, false, {NULL, NULL}};
    draw_view(&whole, atlas, &view, &(const struct tube_colouring){0}, NULL);
    view.listener = (struct picture_listener){hear, &all};
    draw_view(&cut, atlas, &view, &(const struct tube_colouring){0}, NULL);
    assert_memory_equal(&cut, &whole, sizeof whole);
    assert_int_equal(all.heard, 2);
    assert_int_equal(all.total, DOTS);
    assert_int_equal(all.done, all.total);
    view.listener.user = &one;
    test_gl_enter(&gl);
    assert_ok(mesh_layer_create(&layer, atlas, &memory));
    assert_int_equal(mesh_layer_draw(layer, &view), CONUS_ERROR_CANCELLED);
    assert_true(one.heard == 1 && one.done < one.total);
    mesh_layer_destroy(layer);
    test_gl_leave(&gl);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(tubes)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pixel_has_the_nearest_capsule),
        cmocka_unit_test(a_draft_has_some_from_everywhere),
        cmocka_unit_test(pieces_make_the_whole_and_may_be_the_last),
        cmocka_unit_test(directions_are_red_green_and_blue),
        cmocka_unit_test(a_direction_has_the_colour_of_its_opposite),
        cmocka_unit_test(numbers_span_the_colours_and_pale_ones_are_pale),
        cmocka_unit_test(a_range_is_of_finite_numbers_of_one_part),
        cmocka_unit_test(a_map_is_linear_within_triangles),
        cmocka_unit_test(colours_of_numbers_grow_lighter),
        cmocka_unit_test(hidden_bundles_are_not_drawn),
        cmocka_unit_test(a_picture_shows_a_bundle_in_its_colour),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
