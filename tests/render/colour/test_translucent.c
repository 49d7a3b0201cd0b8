/* SPDX-License-Identifier: BSD-3-Clause */
/* Translucent areas and meshes, and pathways as haze (Eq. 8), against closed forms. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "golden_picture.h"
#include "mesh_scene.h"
#include "picture_scene.h"
#include "render/colour/colour.h"
#include "render/image/image.h"
#include "test.h"
#include "value_maps.h"

#include <stdlib.h>
#include <string.h>

enum { WIDTH = PICTURE_WIDTH, HEIGHT = PICTURE_HEIGHT, PIXELS = PICTURE_PIXELS };

static const uint8_t red[3] = {255, 0, 0}, green[3] = {0, 255, 0}, blue[3] = {0, 0, 255};
static const uint8_t bone[3]; /* stands for the colour of what is around the areas, #DBD4C7 */

/* A square across the view, at a depth y. */
static void add_wall(conus_atlas *atlas, float y, const uint8_t rgb[3])
{
    const float positions[] = {-300, y, -300, 300, y, -300, 300, y, 300, -300, y, 300};
    const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    struct mesh wall;
    assert_ok(mesh_init(&wall, 4, 2));
    memcpy(wall.positions, positions, sizeof positions);
    memcpy(wall.triangles, triangles, sizeof triangles);
    mesh_scene_add(atlas, &wall);
    memcpy(atlas->objects[atlas->object_count - 1].rgb, rgb, 3);
}

/* Values of a map, one per voxel of a grid of cubes of 1 mm whose middle is the origin. */
static void add_pathway(conus_atlas *atlas, const size_t dim[3], picture_function value)
{
    conus_volume_info info = picture_grid(dim, (double[]){1, 1, 1}, picture_identity);
    size_t count = dim[0] * dim[1] * dim[2];
    float *values = memory_raw(count, sizeof *values);
    info.role = CONUS_ROLE_SCALAR;
    info.threshold = 0.5;
    for (size_t v = 0; v < count; v++) {
        const size_t k = v / dim[0] / dim[1];
        double p[3] = {(double)(v % dim[0]), (double)(v / dim[0] % dim[1]), (double)k};
        mat4_point(p, info.world_from_voxel, p);
        values[v] = (float)value(p);
    }
    assert_ok(pathway_of_values(atlas, &info, values, "tract"));
}

static const size_t around[3] = {60, 60, 60};

/* A slab 16 mm thick. */
static double slab(const double p[3])
{
    return fabs(p[1]) < 8 ? 1 : 0;
}

static double faint(const double p[3])
{
    (void)p;
    return 0.25;
}

static conus_renderer *renderer_of(const conus_atlas *atlas, const char *function)
{
    picture_need_engine();
    const conus_pathway_transfer transfer = {.transfer = function};
    const conus_renderer_options options = {
        .pathways = &transfer, .pathway_count = function ? 1 : 0, .engine = picture_engine()};
    conus_renderer *renderer = NULL;
    assert_ok(conus_renderer_create(&renderer, atlas, &options));
    return renderer;
}

/* One colour, with the opacity 0.05 of 1 mm, for every value. */
static const char *red_haze(void)
{
    static const char text[] = "0 1 0 0 0.05\n2 1 0 0 0.05\n";
    const char *path = test_scratch("red.tf");
    assert_ok(conus_write_file(path, text, sizeof text - 1));
    return path;
}

static struct camera from_the_front(void)
{
    return picture_camera((double[]){0, 1, 0}, 200, radians_from_degrees(15));
}

/* A part along the ray of the middle pixel, from front to back: colour and opacity. */
struct part {
    const uint8_t *rgb;
    double opacity;
    bool is_haze; /* not lit */
};

/* The part for `mm` of haze. */
static struct part haze(double mm)
{
    return (struct part){red, 1 - pow(0.95, mm), true};
}

/* Eq. 8's light on a surface that faces the eye: l is (-0.42, 0.52, 0.74) normalised. */
static double lit(double colour)
{
    const double u = (1.0 / WIDTH) * tan(radians_from_degrees(7.5)) * WIDTH / HEIGHT;
    const double v = (1.0 / HEIGHT) * tan(radians_from_degrees(7.5));
    double light[3] = {-0.42, 0.52, 0.74};
    double view[3] = {u, v, -1};
    double half[3];
    vec3_normalise(light, light);
    vec3_normalise(view, view);
    vec3_sub(half, light, view);
    vec3_normalise(half, half);
    return colour * (0.30 + 0.75 * light[2]) + 0.06 * pow(half[2], 30);
}

static void check_parts(const float *rgba, const struct part *parts, size_t count, double tolerance)
{
    const float *pixel = rgba + (ptrdiff_t)4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
    double wanted[4] = {0};
    for (size_t i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++) {
            static const double around_srgb[3] = {219 / 255.0, 212 / 255.0, 199 / 255.0};
            double colour = parts[i].rgb == bone ? pow((around_srgb[c] + 0.055) / 1.055, 2.4)
                                                 : parts[i].rgb[c] / 255.0; /* 0 or 1 in linear light, too */
            wanted[c] += (1 - wanted[3]) * parts[i].opacity * (parts[i].is_haze ? colour : lit(colour));
        }
        wanted[3] += (1 - wanted[3]) * parts[i].opacity;
    }
    for (int c = 0; c < 4; c++) {
        assert_near(pixel[c], wanted[c], tolerance);
    }
}

static float *draw_with(conus_renderer *renderer, const float *opacity, uint32_t slices)
{
    struct camera camera = from_the_front();
    return picture_draw(renderer, &camera, &(struct colour_view){.opacity = opacity, .slices = slices}, false);
}

/* The order of the walls in the atlas does not matter. */
static void walls_are_composed_front_to_back(void **state)
{
    (void)state;
    static const float depths[3] = {10, 20, 30};
    static const uint8_t *const colours[3] = {red, green, blue};
    static const float opacities[3] = {0.3F, 0.5F, 1};
    const struct part parts[] = {{red, 0.3, false}, {green, 0.5, false}, {blue, 1, false}};
    for (int turn = 1; turn < 6; turn += 3) {
        conus_atlas *atlas = mesh_scene_atlas();
        float opacity[4] = {1};
        for (int n = 0; n < 3; n++) {
            int wall = (turn < 3 ? n + turn : 2 * 3 + turn - n) % 3;
            add_wall(atlas, depths[wall], colours[wall]);
            opacity[n + 1] = opacities[wall];
        }
        conus_renderer *renderer = renderer_of(atlas, NULL);
        float *rgba = draw_with(renderer, opacity, 0);
        check_parts(rgba, parts, 3, 2e-5);
        memory_free(rgba);
        conus_renderer_destroy(renderer);
        conus_atlas_destroy(atlas);
    }
}

/* A cone across the view, whose walls are seen 5 mm before and behind y = 20, and glass before, between and behind
 * them. Both walls face the eye alike, so the picture of the cone alone tells the colour and opacity a of one: A = 1 -
 * (1 - a)^2, C = c + (1 - a) c. */
static void walls_of_a_cone_and_glass_are_composed_front_to_back(void **state)
{
    (void)state;
    static const float depths[3] = {10, 20, 30};
    conus_pose pose;
    assert_ok(conus_pose_toward(&pose, (double[]){-60, 20, 3}, (double[]){0, 20, 3}, NULL));
    for (int glass = 0; glass < 3; glass++) {
        struct colour_view view = {.world_from_cone = pose.world_from_device, .cone_slope = 0.1, .cone_length = 120};
        struct camera camera = from_the_front();
        conus_atlas *atlas = mesh_scene_atlas();
        add_wall(atlas, depths[glass], green);
        conus_renderer *renderer = renderer_of(atlas, NULL);
        view.opacity = (const float[]){1, 0};
        float *alone = picture_draw(renderer, &camera, &view, false);
        view.opacity = (const float[]){1, 0.5F};
        float *both = picture_draw(renderer, &camera, &view, false);
        const float *pixel = alone + (ptrdiff_t)4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
        double a = 1 - sqrt(1 - (double)pixel[3]);
        double wanted[4] = {0};
        assert_in_range(100 * a, 5, 80);
        for (int part = 0; part < 3; part++) {
            for (int c = 0; c < 4; c++) {
                double wall = c == 3 ? a : (double)pixel[c] / (2 - a);
                double green_glass = c == 3 ? 0.5 : 0.5 * lit(c == 1);
                wanted[c] += (1 - wanted[3]) * (part == glass ? green_glass : wall);
            }
        }
        pixel = both + (ptrdiff_t)4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
        for (int c = 0; c < 4; c++) {
            assert_near(pixel[c], wanted[c], 2e-3);
        }
        memory_free(alone);
        memory_free(both);
        conus_renderer_destroy(renderer);
        conus_atlas_destroy(atlas);
    }
}

/* Adds a square across the view like add_wall(), but around the areas. */
static void add_around(conus_atlas *atlas, float y, double opacity)
{
    const float positions[] = {-300, y, -300, 300, y, -300, 300, y, 300, -300, y, 300};
    const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    struct context_surface surface = {.opacity = opacity};
    assert_ok(mesh_init(&surface.mesh, 4, 2));
    memcpy(surface.mesh.positions, positions, sizeof positions);
    memcpy(surface.mesh.triangles, triangles, sizeof triangles);
    assert_ok(atlas_add_context_surface(atlas, &surface));
}

/* Haze from y = -8 to 8; surfaces around at -12, 4 and 40; areas at 20, translucent, and 30. The camera looks along y.
 */
static void surfaces_around_are_composed_with_all_else(void **state)
{
    (void)state;
    const struct part parts[] = {{bone, 0.25, false}, haze(12),        {bone, 0.4, false}, haze(4),
                                 {green, 0.5, false}, {blue, 1, false}};
    const struct part halved[] = {{bone, 0.125, false}, haze(12), {bone, 0.2, false}, haze(4), {green, 1, false}};
    conus_atlas *atlas = mesh_scene_atlas();
    add_wall(atlas, 30, blue);
    add_wall(atlas, 20, green);
    add_pathway(atlas, around, slab);
    add_around(atlas, 4, 0.4);
    add_around(atlas, -12, 0.25);
    add_around(atlas, 40, 0.5);
    conus_renderer *renderer = renderer_of(atlas, red_haze());
    float *rgba = draw_with(renderer, (const float[]){1, 1, 0.5F, 1}, 500);
    check_parts(rgba, parts, 6, 6e-3);
    memory_free(rgba);
    struct camera camera = from_the_front();
    rgba = picture_draw(renderer, &camera, &(struct colour_view){.fade = 0.5, .slices = 500}, false);
    check_parts(rgba, halved, 5, 6e-3);
    memory_free(rgba);
    rgba = picture_draw(renderer, &camera, &(struct colour_view){.fade = 1, .slices = 500}, false);
    check_parts(rgba, (const struct part[]){haze(16), {green, 1, false}}, 2, 6e-3);
    memory_free(rgba);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* A surface around the areas is composed though nothing else is translucent. An opaque one hides. */
static void a_surface_around_lies_over_opaque_areas(void **state)
{
    (void)state;
    for (int opaque = 0; opaque < 2; opaque++) {
        const struct part parts[] = {{bone, opaque ? 1 : 0.25, false}, {blue, 1, false}};
        conus_atlas *atlas = mesh_scene_atlas();
        add_wall(atlas, 30, blue);
        add_around(atlas, 10, opaque ? 1 : 0.25);
        conus_renderer *renderer = renderer_of(atlas, NULL);
        float *rgba = draw_with(renderer, NULL, 0);
        check_parts(rgba, parts, 2, 2e-5);
        memory_free(rgba);
        conus_renderer_destroy(renderer);
        conus_atlas_destroy(atlas);
    }
}

/* Eight layers and the opaque surface behind them all are drawn; opacity 0 is not. */
static void many_walls_are_the_nearest_eight(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    float opacity[14] = {1};
    struct part parts[9];
    for (int n = 0; n < 13; n++) {
        add_wall(atlas, (float)(13 - n), n == 0 ? blue : n % 2 ? red : green);
        opacity[n + 1] = n == 0 ? 1 : n == 12 ? 0 : 0.1F;
    }
    for (int k = 0; k < 9; k++) {
        int n = 11 - k; /* the nearest that is drawn first */
        parts[k] = k < 8 ? (struct part){n % 2 ? red : green, 0.1, false} : (struct part){blue, 1, false};
    }
    conus_renderer *renderer = renderer_of(atlas, NULL);
    float *rgba = draw_with(renderer, opacity, 0);
    check_parts(rgba, parts, 9, 2e-5);
    memory_free(rgba);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* A surface lets 1 - a of the light behind it through, however often the ray crosses it. */
static void a_surface_counts_once(void **state)
{
    (void)state;
    const float opacity[] = {1, 0.4F};
    for (int voxels = 0; voxels < 2; voxels++) {
        conus_volume_info grid = picture_grid(around, (double[]){1, 1, 1}, picture_identity);
        conus_atlas *atlas = voxels ? picture_atlas(&grid, picture_ball_of_20, NULL, NULL) : mesh_scene_atlas();
        if (!voxels) {
            struct mesh ball = mesh_scene_sphere((double[]){0, 0, 0}, 20, 48, 96);
            mesh_scene_add(atlas, &ball);
        }
        conus_renderer *renderer = renderer_of(atlas, NULL);
        float *rgba = draw_with(renderer, opacity, 0);
        assert_near(rgba[4 * (HEIGHT / 2 * WIDTH + WIDTH / 2) + 3], 0.4, 1e-5);
        memory_free(rgba);
        conus_renderer_destroy(renderer);
        conus_atlas_destroy(atlas);
    }
}

/* The slab of haze reaches from -8 to 8 mm. One of four walls is drawn: before it, in it, or behind it. */
static void haze_lies_before_and_behind_a_wall(void **state)
{
    (void)state;
    static const float depths[] = {-12, -3, 5, 12};
    conus_atlas *atlas = mesh_scene_atlas();
    for (int n = 0; n < 4; n++) {
        add_wall(atlas, depths[n], green);
    }
    add_pathway(atlas, around, slab);
    conus_renderer *renderer = renderer_of(atlas, red_haze());
    for (int n = 0; n < 4; n++) {
        double before = fmin(fmax((double)depths[n] + 8, 0), 16);
        const struct part parts[] = {haze(before), {green, 0.4, false}, haze(16 - before)};
        float opacity[6] = {1, 0, 0, 0, 0, 1};
        opacity[n + 1] = 0.4F;
        for (uint32_t slices = 0; slices <= 600; slices += 300) {
            float *rgba = draw_with(renderer, opacity, slices);
            check_parts(rgba, parts, 3, slices ? 2e-3 : 0.01);
            memory_free(rgba);
        }
    }
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* Slabs before, in and behind the haze. */
static double three_slabs(const double p[3])
{
    return p[1] > -14 && p[1] < -10 ? 1 : p[1] > 0 && p[1] < 4 ? 2 : p[1] > 10 && p[1] < 14 ? 3 : 0;
}

/* The same with areas of voxels, whose surfaces lie at the ends of their voxels, to a tenth of one. */
static void haze_lies_before_and_behind_an_area(void **state)
{
    (void)state;
    static const double before[] = {0, 8, 16};
    static const uint8_t over[] = {0, PATHWAYS_AREA_OVER, PATHWAYS_AREA_OVER, PATHWAYS_AREA_OVER, 0};
    static const uint8_t under[] = {0, PATHWAYS_AREA_UNDER, PATHWAYS_AREA_UNDER, PATHWAYS_AREA_UNDER, 0};
    conus_volume_info grid = picture_grid(around, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, three_slabs, NULL, NULL);
    add_pathway(atlas, around, slab);
    for (int n = 0; n < 3; n++) {
        memcpy(atlas->objects[n].rgb, green, 3);
    }
    conus_renderer *renderer = renderer_of(atlas, red_haze());
    for (int n = 0; n < 6; n++) {
        bool opaque = n >= 3;
        float opacity[5] = {1, 0, 0, 0, 1};
        const struct part parts[] = {haze(before[n % 3]), {green, opaque ? 1 : 0.4, false}, haze(16 - before[n % 3])};
        opacity[n % 3 + 1] = opaque ? 1 : 0.4F;
        assert_ok(renderer_include(renderer, opaque ? over : under));
        float *rgba = draw_with(renderer, opacity, 500);
        check_parts(rgba, parts, opaque ? 2 : 3, 6e-3);
        memory_free(rgba);
    }
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* A value outside of its pathway makes no haze, whatever the transfer function says of it. */
static void haze_ends_where_the_pathway_ends(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_wall(atlas, 12, green);
    add_pathway(atlas, around, faint);
    conus_renderer *renderer = renderer_of(atlas, red_haze());
    float *rgba = draw_with(renderer, (const float[]){1, 0.4F, 1}, 0);
    check_parts(rgba, &(struct part){green, 0.4, false}, 1, 2e-5);
    memory_free(rgba);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* Values from 2 to 5 with a threshold of 0.5 as a pathway, and as a band above 1: a relative function spans 0.5 to 5 of
 * the one, and 2 to 5 of the other, whose voxels begin there. */
static void relative_functions_span_what_is_shown(void **state)
{
    (void)state;
    static const size_t dim[3] = {4, 1, 1};
    static const float values[4] = {2, 3, 4, 5};
    static const conus_band band = {.name = "band", .low = 1, .high = INFINITY};
    const conus_pathway_transfer transfer = {.transfer = "own"};
    const conus_renderer_options options = {.pathways = &transfer, .pathway_count = 1, .engine = picture_engine()};
    conus_volume_info info = picture_grid(dim, (double[]){1, 1, 1}, picture_identity);
    info.role = CONUS_ROLE_SCALAR;
    info.threshold = 0.5;
    for (int is_band = 0; is_band < 2; is_band++) {
        conus_atlas *atlas = mesh_scene_atlas();
        float *copy = memory_copy(values, 4, sizeof *values);
        assert_ok(is_band ? bands_of_values(atlas, &info, copy, &band, 1)
                          : pathway_of_values(atlas, &info, copy, "tract"));
        struct haze_choice choice = {0};
        assert_ok(haze_choose(&choice, atlas, &options));
        const struct transfer *made = &choice.transfers[1];
        assert_int_equal(made->count, 2);
        assert_near(made->points[0].value, is_band ? 2 : 0.5, 1e-12);
        assert_near(made->points[1].value, 5, 1e-12);
        haze_choice_finish(&choice);
        conus_atlas_destroy(atlas);
    }
}

static void functions_that_fit_no_pathway_are_refused(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid(around, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, NULL);
    const conus_pathway_transfer transfers[] = {{0, "heat"}, {1, "heat"}, {3, "heat"}, {2, "nothing"}};
    struct haze_choice choice = {0};
    conus_renderer_options options = {.pathways = transfers, .pathway_count = 1, .engine = picture_engine()};
    assert_fails(haze_choose(&choice, atlas, &options), CONUS_ERROR_ARGUMENT); /* there is no pathway */
    haze_choice_finish(&choice);
    add_pathway(atlas, around, slab);
    for (size_t i = 1; i < 4; i++) { /* an area, nothing, no such function */
        options.pathways = &transfers[i];
        assert_fails(haze_choose(&choice, atlas, &options), CONUS_ERROR_ARGUMENT);
        haze_choice_finish(&choice);
    }
    struct haze_field field = {0};
    options.pathways = &transfers[0];
    assert_ok(haze_choose(&choice, atlas, &options));
    /* 60 x 16 x 60 voxels and one more on each side, 16 bytes each */
    assert_fails(haze_fill(&field, atlas, &choice, 62 * 18 * 62 * 16 - 1), CONUS_ERROR_MEMORY);
    assert_ok(haze_fill(&field, atlas, &choice, 62 * 18 * 62 * 16));
    haze_field_finish(&field);
    haze_choice_finish(&choice);
    conus_atlas_destroy(atlas);
}

static conus_status attempt(void *data)
{
    const conus_pathway_transfer transfer = {.transfer = "own"};
    const conus_renderer_options options = {.pathways = &transfer, .pathway_count = 1, .engine = picture_engine()};
    struct haze_choice choice = {0};
    struct haze_field field = {0};
    conus_status status = haze_choose(&choice, data, &options);
    status = status ? status : haze_fill(&field, data, &choice, UINT64_MAX);
    assert_true((status == CONUS_OK) == (field.texels != NULL));
    haze_field_finish(&field);
    haze_choice_finish(&choice);
    return status;
}

static void allocations_may_fail(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_pathway(atlas, (size_t[]){8, 20, 8}, slab);
    test_every_allocation(attempt, atlas);
    conus_atlas_destroy(atlas);
}

/* Two half balls and a rod before them. */
static double three_areas(const double p[3])
{
    double r = vec3_length(p);
    return r < 18 ? (p[0] < 0 ? 1 : 2) : fabs(p[1] + 24) < 3 && fabs(p[2]) < 3 ? 3 : 0;
}

static double soft_shell(const double p[3])
{
    return fmax(0, 100 - 12 * fabs(vec3_length(p) - 22));
}

static conus_atlas *busy_atlas(void)
{
    conus_volume_info grid = picture_grid(around, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, three_areas, NULL, soft_shell);
    memcpy(atlas->objects[0].rgb, (uint8_t[]){230, 120, 40}, 3);
    memcpy(atlas->objects[1].rgb, (uint8_t[]){60, 120, 230}, 3);
    memcpy(atlas->objects[2].rgb, (uint8_t[]){90, 200, 90}, 3);
    return atlas;
}

static struct colour_view with_cone(const conus_pose *pose, const struct colour_marker *marker)
{
    return (struct colour_view){.world_from_cone = pose->world_from_device,
                                .cone_slope = 0.2,
                                .cone_length = 60,
                                .line_width = 1,
                                .markers = marker,
                                .marker_count = 1};
}

/* Without translucent objects the walk for them draws the same as the plain walk, except for half of a plane at
 * surfaces in haze; skipping empty bricks changes no bit. */
static void the_walks_agree(void **state)
{
    (void)state;
    const float opaque[] = {1, 1, 1, 1};
    const float clear[] = {1, 0.4F, 0.7F, 0};
    const struct colour_marker marker = {.centre = {5, -13, 2}, .radius = 3, .rgb = {200, 20, 20}};
    conus_atlas *atlas = busy_atlas();
    conus_renderer *renderer = picture_renderer(atlas, "brain");
    conus_pose pose;
    assert_ok(conus_pose_toward(&pose, (double[]){-60, -20, 10}, (double[]){0, 0, 0}, NULL));
    for (int side = 0; side < 2; side++) {
        struct camera camera = picture_camera((double[]){side - 1, 1, 0.3 * side}, 150, radians_from_degrees(25));
        struct colour_view view = with_cone(&pose, &marker);
        float *plain = picture_draw(renderer, &camera, &view, false);
        view.opacity = opaque;
        float *layers = picture_draw(renderer, &camera, &view, false);
        assert_true(picture_difference(plain, layers) < 0.004);
        view.opacity = clear;
        float *skipping = picture_draw(renderer, &camera, &view, false);
        view.no_skipping = true;
        float *whole = picture_draw(renderer, &camera, &view, false);
        assert_memory_equal(skipping, whole, PIXELS * 4 * sizeof *whole);
        assert_true(picture_difference(plain, whole) > 0.02);
        view.no_skipping = false;
        view.opacity = opaque;
        float *again = picture_draw(renderer, &camera, &view, false); /* bricks of the unseen area are seen again */
        assert_memory_equal(again, layers, PIXELS * 4 * sizeof *again);
        memory_free(again);
        memory_free(plain);
        memory_free(layers);
        memory_free(skipping);
        memory_free(whole);
    }
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* Blocks of four areas and of none, up to the grid's border, some of them a voxel thin. */
static double blocks(const double p[3])
{
    const double thin = fabs(p[1] - 7) < 0.7 ? 1 : 0;
    const double number = floor(p[0] / 9) + 3 * floor(p[1] / 7) + floor(p[2] / 12) + thin;
    return number - 5 * floor(number / 5);
}

/* What rays leap over in glass and on borders of areas changes no bit: with few planes and many, from outside and
 * inside, alone and in a context, where one of the areas is hidden and one is opaque. */
static void glass_is_drawn_as_by_each_plane(void **state)
{
    (void)state;
    static const float opacities[][5] = {{1, 0.3F, 0, 0.1F, 1}, {1, 0, 0, 0, 0.2F}};
    uint64_t seed = 5;
    for (int n = 0; n < 8; n++) {
        double areas[16];
        picture_rigid(areas, test_random(&seed, 0, 6), (double[]){2, -3, 1});
        conus_volume_info grid = picture_grid((size_t[]){45, 33, 60}, (double[]){-1, 1.3, 0.6}, areas);
        conus_atlas *atlas = picture_atlas(&grid, blocks, NULL, n % 2 ? soft_shell : NULL);
        conus_renderer *renderer = picture_renderer(atlas, n % 2 ? "brain" : NULL);
        const double forward[3] = {test_random(&seed, -1, 1), test_random(&seed, -1, 1), test_random(&seed, -1, 1)};
        const struct camera camera = picture_camera(forward, n < 2 ? 10 : test_random(&seed, 40, 300), 0.5);
        const struct colour_marker marker = {.centre = {5, -13, 2}, .radius = 3, .rgb = {200, 20, 20}};
        conus_pose pose;
        assert_ok(conus_pose_toward(&pose, (double[]){-60, 10, 5}, (double[]){0, 0, 0}, NULL));
        struct colour_view view = with_cone(&pose, &marker);
        view.slices = (uint32_t)test_random(&seed, 10, 200);
        for (int unseen = 0; unseen < 2; unseen++) {
            view.opacity = opacities[unseen];
            view.no_skipping = false;
            float *leaping = picture_draw(renderer, &camera, &view, false);
            view.no_skipping = true;
            float *each = picture_draw(renderer, &camera, &view, false);
            assert_memory_equal(leaping, each, PIXELS * 4 * sizeof *each);
            memory_free(leaping);
            memory_free(each);
        }
        conus_renderer_destroy(renderer);
        conus_atlas_destroy(atlas);
    }
}

/* The same with a pathway's haze in a part of the glass. */
static void haze_in_glass_is_drawn_as_by_each_plane(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid(around, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, blocks, NULL, NULL);
    add_pathway(atlas, (size_t[]){20, 20, 20}, slab);
    conus_renderer *renderer = renderer_of(atlas, red_haze());
    const struct camera camera = picture_camera((const double[]){0.6, 0.7, -0.4}, 90, 0.5);
    const float opacity[] = {1, 0.3F, 0.2F, 0.1F, 0.4F, 1};
    struct colour_view view = {.slices = 120, .opacity = opacity};
    float *leaping = picture_draw(renderer, &camera, &view, false);
    view.no_skipping = true;
    float *each = picture_draw(renderer, &camera, &view, false);
    assert_memory_equal(leaping, each, PIXELS * 4 * sizeof *each);
    memory_free(leaping);
    memory_free(each);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* A fibre in an arch over the areas and through one of them: the more probable, the nearer to its middle. */
static double arch(const double p[3])
{
    double ring = hypot(hypot(p[1], p[2] + 8) - 22, p[0] - 4);
    return p[2] > -10 ? fmax(0, 1 - ring / 6) : 0;
}

static void pathways_and_areas_look_as_they_did(void **state)
{
    (void)state;
    conus_atlas *atlas = busy_atlas();
    add_pathway(atlas, around, arch);
    conus_renderer *renderer = renderer_of(atlas, "heat");
    const double opacity[] = {NAN, 0.35, 1, 0.6, NAN};
    const conus_view view = {.width = 160, .height = 120, .opacity = opacity, .no_legend = true};
    conus_image *image = NULL;
    assert_ok(conus_render(&image, renderer, &view));
    golden_check(image, "translucent.png");
    conus_image_destroy(image);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(translucent)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walls_are_composed_front_to_back),
        cmocka_unit_test(walls_of_a_cone_and_glass_are_composed_front_to_back),
        cmocka_unit_test(surfaces_around_are_composed_with_all_else),
        cmocka_unit_test(a_surface_around_lies_over_opaque_areas),
        cmocka_unit_test(many_walls_are_the_nearest_eight),
        cmocka_unit_test(a_surface_counts_once),
        cmocka_unit_test(haze_lies_before_and_behind_a_wall),
        cmocka_unit_test(haze_lies_before_and_behind_an_area),
        cmocka_unit_test(haze_ends_where_the_pathway_ends),
        cmocka_unit_test(relative_functions_span_what_is_shown),
        cmocka_unit_test(functions_that_fit_no_pathway_are_refused),
        cmocka_unit_test(allocations_may_fail),
        cmocka_unit_test(the_walks_agree),
        cmocka_unit_test(glass_is_drawn_as_by_each_plane),
        cmocka_unit_test(haze_in_glass_is_drawn_as_by_each_plane),
        cmocka_unit_test(pathways_and_areas_look_as_they_did),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
