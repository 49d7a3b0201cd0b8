/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures of meshes, alone and among voxels. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/atlas.h"
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

#define FIELD_OF_VIEW radians_from_degrees(25)

/* A shell of 100 with a soft edge. */
static double soft_shell(const double p[3])
{
    return fmax(0, 100 - 12 * fabs(vec3_length(p) - 26));
}

static void add_ball(conus_atlas *atlas, double x, double y, double z, double radius, const uint8_t rgb[3])
{
    struct mesh ball = mesh_scene_sphere((double[]){x, y, z}, radius, 48, 96);
    mesh_scene_add(atlas, &ball);
    memcpy(atlas->objects[atlas->object_count - 1].rgb, rgb, 3);
}

static const uint8_t red[3] = {255, 0, 0}, blue[3] = {0, 0, 255};

/* Draws `atlas` from `distance`; the caller frees the picture. */
static float *draw_atlas(const conus_atlas *atlas, const double forward[3], double distance)
{
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    struct camera camera = picture_camera(forward, distance, FIELD_OF_VIEW);
    float *rgba = picture_draw(renderer, &camera, NULL, false);
    conus_renderer_destroy(renderer);
    return rgba;
}

static const float *middle(const float *rgba)
{
    return rgba + (ptrdiff_t)4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
}

/* A ball of radius r at distance D covers a disc of radius tan(asin(r / D)); smooth edges cover it better. */
static void a_mesh_ball_has_its_silhouette(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_ball(atlas, 0, 0, 0, 20, red);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    const double forwards[3][3] = {{0, 1, 0}, {1, 0, -0.3}, {-0.4, -0.8, -0.7}};
    for (int n = 0; n < 6; n++) {
        struct camera camera = picture_camera(forwards[n % 3], 120, FIELD_OF_VIEW);
        float *rgba = picture_draw(renderer, &camera, NULL, n >= 3);
        double radius = tan(asin(20.0 / 120)) / camera.slope[1] * HEIGHT / 2;
        double area = 0;
        for (ptrdiff_t i = 0; i < PIXELS; i++) {
            area += (double)rgba[4 * i + 3];
        }
        assert_near(area, MATH3_PI * radius * radius, (n >= 3 ? 0.005 : 0.01) * area);
        assert_true(middle(rgba)[0] > 4 * middle(rgba)[2]); /* red */
        memory_free(rgba);
    }
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* The shell of a ball of 20 in a box of 40 lies 0.84 / 96 of that outside it; its front and back let light through, and
 * its edge is dark, as glass. */
static void a_shell_has_its_silhouette(void **state)
{
    (void)state;
    const conus_volume_info grid = picture_grid((size_t[]){64, 64, 64}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, NULL);
    assert_ok(conus_atlas_add_shell(atlas, 0.25));
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    const float gone[] = {1, 0}; /* of the ball itself */
    struct camera camera = picture_camera((double[]){-0.4, -0.8, -0.7}, 120, FIELD_OF_VIEW);
    float *rgba = picture_draw(renderer, &camera, &(struct colour_view){.opacity = gone}, false);
    const double radius = tan(asin((20 + 0.84 * 40 / 96) / 120)) / camera.slope[1] * HEIGHT / 2;
    double area = 0;
    for (ptrdiff_t i = 0; i < PIXELS; i++) {
        area += rgba[4 * i + 3] > 0 ? 1 : 0;
    }
    assert_near(area, MATH3_PI * radius * radius, 0.03 * area);
    assert_true(middle(rgba)[3] > 0.2F && middle(rgba)[3] < 0.6F); /* two layers of a quarter are 0.44 */
    memory_free(rgba);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* A level edge through the middle of a row of pixels: two of the four rays of each pixel there are below it. Where the
 * wall is translucent, and the edge a quarter of a pixel above or below the middle, the ray of the pixel, of weight a
 * half, is below or above it, and so are two of the corners, of weight an eighth each. */
static void level_edges_are_smooth(void **state)
{
    (void)state;
    enum { ROW = HEIGHT / 2 };
    static const double covered[] = {0.5, 0.75, 0.25}; /* and where the edge is, in pixels from the row's lower end */
    static const float half[] = {1, 0.5F};
    for (int n = 0; n < 3; n++) {
        struct camera camera = picture_camera((double[]){0, 1, 0}, 120, FIELD_OF_VIEW);
        const float edge = (float)(((ROW + covered[n]) / HEIGHT * 2 - 1) * camera.slope[1] * 120);
        const float positions[] = {-300, 0, -300, 300, 0, -300, 300, 0, edge, -300, 0, edge};
        const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
        struct mesh wall;
        assert_ok(mesh_init(&wall, 4, 2));
        memcpy(wall.positions, positions, sizeof positions);
        memcpy(wall.triangles, triangles, sizeof triangles);
        conus_atlas *atlas = mesh_scene_atlas();
        mesh_scene_add(atlas, &wall);
        conus_renderer *renderer = picture_renderer(atlas, NULL);
        float *rgba = picture_draw(renderer, &camera, &(struct colour_view){.opacity = n ? half : NULL}, true);
        for (int column = 0; column < WIDTH; column++) {
            for (int row = -1; row <= 1; row++) {
                const double part = row < 0 ? 1 : row > 0 ? 0 : covered[n];
                assert_near(rgba[4 * ((ROW + row) * WIDTH + column) + 3], (n ? 0.5 : 1) * part, 1e-6);
            }
        }
        memory_free(rgba);
        conus_renderer_destroy(renderer);
        conus_atlas_destroy(atlas);
    }
}

/* The visible side is lit, whichever way triangles face: an inside-out ball looks like the other one. */
static void both_faces_are_lit(void **state)
{
    (void)state;
    float *pictures[2];
    for (int turned = 0; turned < 2; turned++) {
        struct mesh ball = mesh_scene_sphere((double[]){0, 0, 0}, 20, 24, 48);
        for (size_t i = 0; turned && i < ball.triangle_count; i++) {
            uint32_t kept = ball.triangles[3 * i];
            ball.triangles[3 * i] = ball.triangles[3 * i + 1];
            ball.triangles[3 * i + 1] = kept;
        }
        conus_atlas *atlas = mesh_scene_atlas();
        mesh_scene_add(atlas, &ball);
        pictures[turned] = draw_atlas(atlas, (double[]){0, 1, 0}, 120);
        conus_atlas_destroy(atlas);
    }
    assert_true(picture_difference(pictures[0], pictures[1]) < 1e-4);
    memory_free(pictures[0]);
    memory_free(pictures[1]);
}

static void meshes_not_hit_are_pale(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_ball(atlas, 0, 0, 0, 20, red);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    struct camera camera = picture_camera((double[]){0, 1, 0}, 120, FIELD_OF_VIEW);
    const uint8_t none[2] = {false, false};
    float *full = picture_draw(renderer, &camera, NULL, false);
    float *pale = picture_draw(renderer, &camera, &(struct colour_view){.emphasis = none}, false);
    assert_true(middle(full)[0] > 4 * middle(full)[1]);
    assert_true(middle(pale)[0] < 2 * middle(pale)[1]);
    memory_free(full);
    memory_free(pale);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* A small blue ball that sticks out of a red one on the grid shows from that side only; a ball inside never shows. */
static void meshes_and_voxels_hide_each_other(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, picture_identity);
    for (int inside = 0; inside < 2; inside++) {
        conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, NULL);
        memcpy(atlas->objects[0].rgb, red, 3);
        add_ball(atlas, 0, inside ? 0 : -18, 0, 8, blue);
        float *front = draw_atlas(atlas, (double[]){0, 1, 0}, 120);
        float *back = draw_atlas(atlas, (double[]){0, -1, 0}, 120);
        int shown = inside ? 0 : 2;
        assert_true(middle(front)[shown] > 4 * middle(front)[2 - shown]);
        assert_true(middle(back)[0] > 4 * middle(back)[2]);
        memory_free(front);
        memory_free(back);
        conus_atlas_destroy(atlas);
    }
}

/* A pathway may be the only volume of an atlas. */
static void a_pathway_shows_among_meshes(void **state)
{
    (void)state;
    enum { EDGE = 40 };
    conus_volume_info grid = picture_grid((size_t[]){EDGE, EDGE, EDGE}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = mesh_scene_atlas();
    add_ball(atlas, 0, 5, 0, 10, red);
    float *values = memory_zeroed((size_t)EDGE * EDGE * EDGE, sizeof *values);
    assert_non_null(values);
    for (size_t v = 0; v < (size_t)EDGE * EDGE * EDGE; v++) {
        values[v] = v / EDGE % EDGE < EDGE / 2 ? 1 : 0; /* the half at negative y */
    }
    grid.role = CONUS_ROLE_SCALAR;
    grid.threshold = 0.5;
    assert_ok(pathway_of_values(atlas, &grid, values, "tract"));
    memcpy(atlas->objects[1].rgb, blue, 3);
    float *front = draw_atlas(atlas, (double[]){0, 1, 0}, 120);
    float *back = draw_atlas(atlas, (double[]){0, -1, 0}, 120);
    assert_true(middle(front)[2] > 4 * middle(front)[0]);
    assert_true(middle(back)[0] > 4 * middle(back)[2]);
    memory_free(front);
    memory_free(back);
    conus_atlas_destroy(atlas);
}

static void haze_before_a_mesh_obeys_its_closed_form(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){60, 60, 60}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *hazy = picture_atlas(&grid, picture_nothing, NULL, picture_ten);
    conus_atlas *clear = mesh_scene_atlas();
    add_ball(hazy, 0, 0, 0, 20, red);
    add_ball(clear, 0, 0, 0, 20, red);
    picture_check_haze(clear, hazy, FIELD_OF_VIEW);
}

/* Markers and the cone's wall before a mesh, without any volume. */
static void cone_and_markers_among_meshes(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_ball(atlas, 0, 0, 0, 20, red);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    struct camera camera = picture_camera((double[]){0, 1, 0}, 120, FIELD_OF_VIEW);
    struct colour_marker marker = {.centre = {0, -30, 0}, .radius = 4, .rgb = {0, 0, 255}};
    const struct colour_view view = {.markers = &marker, .marker_count = 1};
    float *before = picture_draw(renderer, &camera, &view, false);
    assert_true(middle(before)[2] > 4 * middle(before)[0]);
    conus_pose pose;
    assert_ok(conus_pose_toward(&pose, (double[]){-60, -30, 0}, (double[]){0, -30, 0}, NULL));
    float *plain = picture_draw(renderer, &camera, NULL, false);
    float *wall = picture_draw(
        renderer, &camera,
        &(struct colour_view){
            .world_from_cone = pose.world_from_device, .cone_slope = 0.1, .cone_length = 100, .line_width = 0.5},
        false);
    const ptrdiff_t above = (ptrdiff_t)4 * 5 * WIDTH;                       /* the axis is in the middle */
    assert_true(middle(wall + above)[1] > 1.1F * middle(plain + above)[1]); /* orange over red */
    memory_free(before);
    memory_free(plain);
    memory_free(wall);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

static conus_status create_and_destroy(void *atlas)
{
    conus_renderer *renderer = NULL;
    conus_status status =
        conus_renderer_create(&renderer, atlas, &(conus_renderer_options){.engine = picture_engine()});
    conus_renderer_destroy(renderer);
    return status;
}

static void allocations_may_fail(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){9, 8, 7}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, picture_ten);
    add_ball(atlas, 0, 0, 0, 20, red);
    conus_renderer_destroy(picture_renderer(atlas, NULL)); /* skips where there is no GL */
    test_every_allocation(create_and_destroy, atlas);
    conus_atlas_destroy(atlas);
}

/* Rings and balls in a shell of tissue, with a cone. */
static conus_image *picture_of_rings(void)
{
    conus_volume_info grid = picture_grid((size_t[]){64, 64, 64}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_nothing, NULL, soft_shell);
    struct mesh rings[] = {mesh_scene_torus(14, 4, 48, 24), mesh_scene_torus(14, 4, 48, 24)};
    double turn[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 14, 0, 0, 1};
    mesh_transform(&rings[1], turn);
    mesh_scene_add(atlas, &rings[0]);
    mesh_scene_add(atlas, &rings[1]);
    add_ball(atlas, -6, 0, 4, 6, red);
    memcpy(atlas->objects[0].rgb, (uint8_t[]){60, 160, 80}, 3);
    memcpy(atlas->objects[1].rgb, (uint8_t[]){230, 170, 40}, 3);
    conus_renderer *renderer = picture_renderer(atlas, "brain");
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_image *image = NULL;
    conus_pose pose;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_pose_toward(&pose, (double[]){-50, -30, 35}, (double[]){-6, 0, 4}, NULL));
    assert_ok(conus_select(&selection, selector, &pose, 12));
    const conus_view view = {.width = 240, .height = 180, .selection = selection, .no_legend = true};
    assert_ok(conus_render(&image, renderer, &view));
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
    return image;
}

static void rings_look_as_they_did(void **state)
{
    (void)state;
    conus_image *got = picture_of_rings();
    golden_check(got, "rings.png");
    conus_image_destroy(got);
}

TEST_GROUP(mesh_picture)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mesh_ball_has_its_silhouette), cmocka_unit_test(a_shell_has_its_silhouette),
        cmocka_unit_test(level_edges_are_smooth),         cmocka_unit_test(both_faces_are_lit),
        cmocka_unit_test(meshes_not_hit_are_pale),        cmocka_unit_test(meshes_and_voxels_hide_each_other),
        cmocka_unit_test(a_pathway_shows_among_meshes),   cmocka_unit_test(haze_before_a_mesh_obeys_its_closed_form),
        cmocka_unit_test(cone_and_markers_among_meshes),  cmocka_unit_test(allocations_may_fail),
        cmocka_unit_test(rings_look_as_they_did),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
