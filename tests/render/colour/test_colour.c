/* SPDX-License-Identifier: BSD-3-Clause */
/* The colour pass (Eq. 8) on volumes against closed forms. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "picture_scene.h"
#include "render/colour/colour.h"
#include "test.h"
#include "value_maps.h"

#include <stdio.h>
#include <string.h>

enum { WIDTH = PICTURE_WIDTH, HEIGHT = PICTURE_HEIGHT, PIXELS = PICTURE_PIXELS };

static double ball_on_the_left(const double p[3])
{
    const double centre[3] = {-15, 0, 0};
    double offset[3];
    vec3_sub(offset, p, centre);
    return vec3_length(offset) < 10;
}

/* Two half balls and a rod off the middle. */
static double three_areas(const double p[3])
{
    double r = vec3_length(p);
    return r < 12 ? (p[0] < 0 ? 3 : 70000) : fabs(p[1] - 15) < 3 && fabs(p[2]) < 3 && fabs(p[0]) < 20 ? 9 : 0;
}

/* A shell of 100 with a soft edge, 40 inside. */
static double soft_shell(const double p[3])
{
    double r = vec3_length(p);
    return r < 16 ? 40 : fmax(0, 100 - 12 * fabs(r - 20));
}

static const char *transfer_file(const char *text)
{
    const char *path = test_scratch("function.tf");
    assert_ok(conus_write_file(path, text, strlen(text)));
    return path;
}

static const float *pixel(const float *rgba, int column, int row_from_bottom)
{
    return rgba + 4 * ((ptrdiff_t)row_from_bottom * WIDTH + column);
}

/* Eq. 8: a homogeneous slab of thickness L along the ray has opacity 1 - (1 - a)^L, straight or oblique, whatever the
 * number of planes, and the function's colour in linear light. */
static void a_slab_obeys_its_closed_form(void **state)
{
    (void)state;
    conus_volume_info grid =
        picture_grid((size_t[]){80, 20, 80}, (double[]){1, 0.5, 1}, picture_identity); /* 10 mm thick */
    conus_atlas *atlas = picture_atlas(&grid, picture_nothing, NULL, picture_ten);
    conus_renderer *renderer = picture_renderer(atlas, transfer_file("0 1 0.5 0 0.06\n20 1 0.5 0 0.06\n"));
    struct camera camera = picture_camera((double[]){0, 1, 0}, 200, radians_from_degrees(15));
    for (uint32_t slices = 7; slices < 400; slices *= 3) {
        float *rgba = picture_draw(renderer, &camera, &(struct colour_view){.slices = slices}, false);
        for (int column = 5; column < WIDTH; column += 30) {
            double u = ((column + 0.5) / WIDTH * 2 - 1) * camera.slope[0];
            double v = 1.0 / HEIGHT * camera.slope[1]; /* the row above the middle */
            double opacity = 1 - pow(1 - 0.06, 10 * sqrt(1 + u * u + v * v));
            const float *p = pixel(rgba, column, HEIGHT / 2);
            assert_near(p[3], opacity, 2e-5);
            assert_near(p[0], opacity, 2e-5);
            assert_near(p[1], 0.214041 * opacity, 2e-5); /* sRGB 0.5 */
            assert_near(p[2], 0, 0);
        }
        memory_free(rgba);
    }
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

static void haze_before_an_area_obeys_its_closed_form(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){60, 60, 60}, (double[]){1, 1, 1}, picture_identity);
    picture_check_haze(picture_atlas(&grid, picture_ball_of_20, NULL, NULL),
                       picture_atlas(&grid, picture_ball_of_20, NULL, picture_ten), radians_from_degrees(15));
}

static void more_planes_change_little(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, three_areas, NULL, soft_shell);
    conus_renderer *renderer = picture_renderer(atlas, "brain");
    struct camera camera = picture_camera((double[]){1, 2, -1}, 150, radians_from_degrees(25));
    float *once = picture_draw(renderer, &camera, NULL, false);
    float *twice = picture_draw(renderer, &camera, &(struct colour_view){.slices = 140}, false);
    assert_true(picture_difference(once, twice) > 0);
    assert_true(picture_difference(once, twice) < 0.003);
    memory_free(once);
    memory_free(twice);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

static void draw_both_ways(conus_renderer *renderer, uint64_t *seed)
{
    for (int view = 0; view < 6; view++) {
        double forward[3] = {test_random(seed, -1, 1), test_random(seed, -1, 1), test_random(seed, -1, 1)};
        struct camera camera = picture_camera(forward, view == 5 ? 10 : test_random(seed, 40, 300), 0.5);
        conus_pose pose;
        assert_ok(conus_pose_toward(&pose, (double[]){-60, 10, test_random(seed, -20, 20)}, (double[]){0, 0, 0}, NULL));
        const struct colour_marker marker = {.centre = {5, -13, 2}, .radius = 3, .rgb = {200, 20, 20}};
        struct colour_view options = {.slices = (uint32_t)test_random(seed, 20, 200),
                                      .world_from_cone = pose.world_from_device,
                                      .cone_slope = 0.2,
                                      .cone_length = 90,
                                      .line_width = 1,
                                      .markers = &marker,
                                      .marker_count = 1};
        float *skipping = picture_draw(renderer, &camera, &options, false);
        options.no_skipping = true;
        float *not_skipping = picture_draw(renderer, &camera, &options, false);
        assert_memory_equal(skipping, not_skipping, PIXELS * 4 * sizeof *skipping);
        memory_free(skipping);
        memory_free(not_skipping);
    }
}

/* The picture with brick skipping equals the one without, to the last bit: separate, oblique, flipped and anisotropic
 * grids; soft, hard and band-shaped functions; from outside and inside. */
static void skipping_changes_no_bit(void **state)
{
    (void)state;
    static const char *const functions[] = {"brain", "surface", "bright",
                                            "0 0 0 0 0\n39 0 0 0 0\n40 1 0 0 0.2\n41 0 0 0 0\n200 0 0 0 0\n",
                                            "30 1 1 1 0.4\n30 0 0 0 0\n95 0 0 0 0\n95 1 1 0 0.9\n"};
    uint64_t seed = 3;
    for (size_t f = 0; f < sizeof functions / sizeof *functions; f++) {
        double areas[16], context[16];
        picture_rigid(areas, test_random(&seed, 0, 6), (double[]){2, -3, 1});
        picture_rigid(context, test_random(&seed, 0, 6), (double[]){-4, 1, 0});
        conus_volume_info grid = picture_grid((size_t[]){61, 33, 90}, (double[]){-1, 1.3, 0.6}, areas);
        conus_volume_info other = picture_grid((size_t[]){40, 77, 19}, (double[]){1.2, -0.7, 2.4}, context);
        conus_atlas *atlas = picture_atlas(&grid, three_areas, &other, soft_shell);
        const char *transfer = f < 3 ? functions[f] : transfer_file(functions[f]);
        conus_renderer *renderer = picture_renderer(atlas, transfer);
        draw_both_ways(renderer, &seed);
        conus_renderer_destroy(renderer);
        conus_atlas_destroy(atlas);
    }
}

/* A ball of radius r at distance D covers a disc of radius tan(asin(r / D)). */
static void a_ball_has_its_silhouette(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){50, 60, 50}, (double[]){1, 0.8, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, NULL);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    const double forwards[3][3] = {{0, 1, 0}, {1, 0, -0.3}, {-0.4, -0.8, -0.7}};
    for (int n = 0; n < 3; n++) {
        struct camera camera = picture_camera(forwards[n], 120, radians_from_degrees(25));
        float *rgba = picture_draw(renderer, &camera, NULL, false);
        double area = 0, x = 0, y = 0;
        for (int row = 0; row < HEIGHT; row++) {
            for (int column = 0; column < WIDTH; column++) {
                double covered = (double)pixel(rgba, column, row)[3];
                assert_true(covered == 0 || covered == 1); /* areas are opaque */
                area += covered;
                x += covered * (column + 0.5);
                y += covered * (row + 0.5);
            }
        }
        double radius = tan(asin(20.0 / 120)) / camera.slope[1] * HEIGHT / 2;
        assert_near(area, MATH3_PI * radius * radius, 0.02 * area);
        assert_near(x / area, WIDTH / 2.0, 0.3);
        assert_near(y / area, HEIGHT / 2.0, 0.3);
        memory_free(rgba);
    }
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

static void moving_everything_changes_little(void **state)
{
    (void)state;
    double still[16], move[16];
    mat4_identity(still);
    picture_rigid(move, 2.1, (double[]){300, -40, 1000});
    float *pictures[2];
    for (int moved = 0; moved < 2; moved++) {
        conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, picture_identity);
        conus_atlas *atlas = picture_atlas(&grid, three_areas, NULL, soft_shell);
        for (size_t i = 0; i < atlas->volume_count; i++) { /* the same voxels, elsewhere */
            struct volume *volume = &atlas->volumes[i];
            mat4_multiply(volume->info.world_from_voxel, moved ? move : still, volume->info.world_from_voxel);
            assert_true(mat4_invert_affine(volume->voxel_from_world, volume->info.world_from_voxel));
        }
        conus_renderer *renderer = picture_renderer(atlas, "brain");
        struct camera camera = picture_camera((double[]){1, 2, -1}, 150, radians_from_degrees(25));
        mat4_multiply(camera.world_from_camera, moved ? move : still, camera.world_from_camera);
        pictures[moved] = picture_draw(renderer, &camera, NULL, false);
        conus_renderer_destroy(renderer);
        conus_atlas_destroy(atlas);
    }
    assert_true(picture_difference(pictures[0], pictures[1]) < 0.002);
    memory_free(pictures[0]);
    memory_free(pictures[1]);
}

/* 16 x 12 voxels of 4 mm that face the camera, each of an area 1 to 3 or of none; behind them a wall of area 3, if
 * there is one. */
enum { ACROSS = 16, UPWARD = 12, EACH = WIDTH / ACROSS };

static struct {
    uint8_t area[UPWARD][ACROSS];
    bool has_wall;
} sheet;

/* The front's area there; none beyond it. */
static unsigned front_area(int column, int row)
{
    return column >= 0 && row >= 0 && column < ACROSS && row < UPWARD ? sheet.area[row][column] : 0;
}

static double front_label(const double p[3])
{
    const int depth = (int)floor(p[1] / 4 + 2.5);
    return depth == 1                    ? front_area((int)floor(p[0] / 4 + 8), (int)floor(p[2] / 4 + 6))
           : depth > 1 && sheet.has_wall ? 3
                                         : 0;
}

/* The area that a pixel shows, by its colour; 0 = none. */
static unsigned shown_area(const float *rgba)
{
    return rgba[3] < 0.5F ? 0 : rgba[0] > rgba[1] && rgba[0] > rgba[2] ? 1 : rgba[1] > rgba[2] ? 2 : 3;
}

static bool is_alone(int column, int row)
{
    unsigned others = 0;
    for (int n = 0; n < 9; n++) {
        others += n != 4 && front_area(column + n % 3 - 1, row + n / 3 - 1) == sheet.area[row][column];
    }
    return sheet.area[row][column] && !others;
}

/* Whether a voxel of that area is at most half a voxel from the pixel, or its wall may be seen. */
static bool is_near_front(int x, int y, unsigned area)
{
    bool found = sheet.has_wall && area == 3;
    for (int n = 0; n < 4; n++) {
        found = found ||
                front_area((x + (n % 2 ? 2 : -2) + EACH) / EACH - 1, (y + (n / 2 ? 2 : -2) + EACH) / EACH - 1) == area;
    }
    return found;
}

/* What smooths labels moves no voxel's centre into another area and no border by more than half a voxel, and a single
 * voxel stays: it covers at least a fifth of its square, also where nothing is behind it. */
static void smooth_areas_keep_their_voxels(void **state)
{
    (void)state;
    static const uint8_t rgb[][3] = {{0}, {255, 0, 0}, {0, 255, 0}, {0, 0, 255}};
    uint64_t random = 5;
    unsigned lone = 0;
    for (int scene = 0; scene < 24; scene++) {
        const double some = scene % 3 == 0 ? 10 : 4; /* how rare voxels of areas are */
        sheet.has_wall = scene % 2;
        for (int n = 0; n < ACROSS * UPWARD; n++) {
            const unsigned area = (unsigned)test_random(&random, 0, some);
            sheet.area[n / ACROSS][n % ACROSS] = (uint8_t)(area > 3 ? 0 : area);
        }
        for (uint8_t n = 1; n <= 3; n++) { /* all are there */
            sheet.area[0][4 * n] = n;
        }
        conus_volume_info grid = picture_grid((size_t[]){ACROSS, 4, UPWARD}, (double[]){4, 4, 4}, picture_identity);
        conus_atlas *atlas = picture_atlas(&grid, front_label, NULL, NULL);
        conus_renderer *renderer = picture_renderer(atlas, NULL);
        const struct camera camera = picture_camera((double[]){0, 1, 0}, 4000, 2 * atan(2.0 * UPWARD / 3994));
        float *rgba = picture_draw(renderer, &camera, &(struct colour_view){.rgb = rgb}, false);
        unsigned pixels[UPWARD][ACROSS] = {{0}};
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                const unsigned area = shown_area(pixel(rgba, x, y));
                assert_true(is_near_front(x, y, area));
                pixels[y / EACH][x / EACH] += area == front_area(x / EACH, y / EACH);
                if (x % EACH == EACH / 2 && y % EACH == EACH / 2) {
                    const unsigned own = front_area(x / EACH, y / EACH);
                    assert_int_equal(area, own || !sheet.has_wall ? own : 3);
                }
            }
        }
        for (int n = 0; n < ACROSS * UPWARD; n++) {
            const bool alone = is_alone(n % ACROSS, n / ACROSS);
            lone += alone;
            assert_true(!alone || pixels[n / ACROSS][n % ACROSS] >= EACH * EACH / 5);
        }
        memory_free(rgba);
        conus_renderer_destroy(renderer);
        conus_atlas_destroy(atlas);
    }
    assert_true(lone > 100);
}

/* Mean column of the opaque pixels. */
static double centre_column(const float *rgba)
{
    double sum = 0, count = 0;
    for (int i = 0; i < PIXELS; i++) {
        sum += (double)rgba[4 * i + 3] * (i % WIDTH);
        count += (double)rgba[4 * i + 3];
    }
    return sum / count;
}

/* Seen from the front, the patient's left is on the picture's right; from behind, on its left, whatever the order in
 * which the file stores voxels. */
static void left_is_left(void **state)
{
    (void)state;
    for (int flipped = 0; flipped < 2; flipped++) {
        conus_volume_info grid =
            picture_grid((size_t[]){60, 40, 40}, (double[]){flipped ? -1 : 1, flipped ? -1 : 1, 1}, picture_identity);
        conus_atlas *atlas = picture_atlas(&grid, ball_on_the_left, NULL, NULL);
        conus_renderer *renderer = picture_renderer(atlas, NULL);
        struct camera front = picture_camera((double[]){0, -1, 0}, 150, radians_from_degrees(25));
        struct camera back = picture_camera((double[]){0, 1, 0}, 150, radians_from_degrees(25));
        float *from_front = picture_draw(renderer, &front, NULL, false);
        float *from_back = picture_draw(renderer, &back, NULL, false);
        assert_true(centre_column(from_front) > WIDTH / 2.0 + 10);
        assert_true(centre_column(from_back) < WIDTH / 2.0 - 10);
        memory_free(from_front);
        memory_free(from_back);
        conus_renderer_destroy(renderer);
        conus_atlas_destroy(atlas);
    }
}

/* A marker before the ball shows, one behind it shines through faintly; the cone's wall tints what is behind it. */
static void depth_decides_what_is_seen(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, NULL);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    struct camera camera = picture_camera((double[]){0, 1, 0}, 120, radians_from_degrees(25));
    struct colour_marker marker = {.centre = {3, -30, 0}, .radius = 4, .rgb = {0, 0, 255}};
    struct colour_view view = {.markers = &marker, .marker_count = 1};
    float *plain = picture_draw(renderer, &camera, NULL, false);
    float *before = picture_draw(renderer, &camera, &view, false);
    marker.centre[1] = 30;
    float *behind = picture_draw(renderer, &camera, &view, false);
    assert_true(picture_difference(plain, behind) > 0);
    assert_true(picture_difference(plain, behind) < 0.4 * picture_difference(plain, before));
    conus_pose pose; /* from the left, in front of the ball: both walls are before it */
    assert_ok(conus_pose_toward(&pose, (double[]){-60, -30, 0}, (double[]){0, -30, 0}, NULL));
    const struct colour_view cone = {
        .world_from_cone = pose.world_from_device, .cone_slope = 0.1, .cone_length = 100, .line_width = 0.5};
    float *with_cone = picture_draw(renderer, &camera, &cone, false);
    const float *clear = pixel(plain, WIDTH / 2, HEIGHT / 2 + 5);
    const float *tinted = pixel(with_cone, WIDTH / 2, HEIGHT / 2 + 5);
    assert_true(tinted[0] / tinted[2] > 1.2F * clear[0] / clear[2]); /* the cone is orange */
    memory_free(plain);
    memory_free(before);
    memory_free(behind);
    memory_free(with_cone);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* The cone of slope 0.1 comes from 60 mm before the middle of the ball of 20: its wall is 4.04 mm off the axis
 * and 40.41 deep where it meets the ball, and the line there 0.5 mm wide. So a reach of 41 changes nothing, one of 40
 * takes the line away, and nothing else: no more than a square of 11 mm. */
static void a_cone_leaves_a_line_within_its_reach(void **state)
{
    (void)state;
    static const double reaches[3] = {0, 41, 40};
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, NULL);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    struct camera camera = picture_camera((double[]){0, 1, 0}, 120, radians_from_degrees(25));
    float *pictures[3];
    size_t changed[3] = {0};
    conus_pose pose;
    assert_ok(conus_pose_toward(&pose, (double[]){0, -60, 0}, (double[]){0, 0, 0}, NULL));
    for (int n = 0; n < 3; n++) {
        const struct colour_view cone = {.world_from_cone = pose.world_from_device,
                                         .cone_slope = 0.1,
                                         .cone_length = 100,
                                         .cone_reach = reaches[n],
                                         .line_width = 0.5};
        pictures[n] = picture_draw(renderer, &camera, &cone, false);
        for (size_t p = 0; p < PICTURE_PIXELS; p++) {
            const float *a = pictures[n] + 4 * p;
            const float *b = pictures[0] + 4 * p;
            changed[n] += a[0] != b[0] || a[1] != b[1] || a[2] != b[2] || a[3] != b[3];
        }
    }
    const double mm = 2 * 100 * tan(radians_from_degrees(25) / 2) / HEIGHT; /* of a pixel, at the ball's front */
    assert_int_equal(changed[1], 0);
    assert_true(changed[2] > 10);
    assert_true((double)changed[2] * mm * mm < 11 * 11);
    for (int n = 0; n < 3; n++) {
        memory_free(pictures[n]);
    }
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

static void areas_not_hit_are_pale(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, NULL);
    memcpy(atlas->objects[0].rgb, (uint8_t[]){255, 0, 0}, 3);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    struct camera camera = picture_camera((double[]){0, 1, 0}, 120, radians_from_degrees(25));
    const uint8_t none[2] = {false, false};
    float *full = picture_draw(renderer, &camera, NULL, false);
    float *pale = picture_draw(renderer, &camera, &(struct colour_view){.emphasis = none}, false);
    const float *strong = pixel(full, WIDTH / 2, HEIGHT / 2);
    const float *weak = pixel(pale, WIDTH / 2, HEIGHT / 2);
    assert_true(strong[0] > 4 * strong[1]);
    assert_true(weak[0] < 2 * weak[1]);
    /* The colour that is given for areas that are not hit is not made paler, but darker towards the ball's edge. */
    static const uint8_t red[3] = {255, 0, 0};
    float *given = picture_draw(renderer, &camera, &(struct colour_view){.emphasis = none, .pale_rgb = red}, false);
    const float *plain = pixel(given, WIDTH / 2, HEIGHT / 2);
    assert_near((double)plain[0], (double)strong[0], 1e-6);
    assert_near((double)plain[1], (double)strong[1], 1e-6);
    int edge = WIDTH / 2;
    while (pixel(full, edge + 1, HEIGHT / 2)[3] == 1) {
        edge++;
    }
    assert_true(pixel(given, edge, HEIGHT / 2)[0] < 0.75F * pixel(full, edge, HEIGHT / 2)[0]);
    memory_free(full);
    memory_free(pale);
    memory_free(given);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* A pathway inside an area is drawn in its place, on whatever grid. */
static void pathways_are_drawn_in_place_of_areas(void **state)
{
    (void)state;
    double turned[16];
    picture_rigid(turned, 0.7, (double[]){0, 0, 0});
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, picture_identity);
    conus_volume_info other = picture_grid((size_t[]){30, 70, 40}, (double[]){1.5, 0.7, 1}, turned);
    other.role = CONUS_ROLE_SCALAR;
    other.threshold = 0.5;
    conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, NULL);
    float *values = memory_raw((size_t)30 * 70 * 40, sizeof *values);
    for (size_t v = 0; v < (size_t)30 * 70 * 40; v++) {
        const size_t at[3] = {v % 30, v / 30 % 70, v / 30 / 70};
        double p[3] = {(double)at[0], (double)at[1], (double)at[2]};
        mat4_point(p, other.world_from_voxel, p);
        values[v] = vec3_length(p) < 10 ? 1 : 0;
    }
    assert_ok(pathway_of_values(atlas, &other, values, "tract"));
    memcpy(atlas->objects[1].rgb, (uint8_t[]){0, 0, 255}, 3);
    conus_renderer *renderer = picture_renderer(atlas, NULL);
    struct camera camera = picture_camera((double[]){0, 1, 0}, 120, radians_from_degrees(25));
    float *rgba = picture_draw(renderer, &camera, NULL, false);
    double area = 0;
    for (ptrdiff_t i = 0; i < PIXELS; i++) {
        area += (double)rgba[4 * i + 3];
    }
    double radius = tan(asin(10.0 / 120)) / camera.slope[1] * HEIGHT / 2;
    assert_near(area, MATH3_PI * radius * radius, 0.04 * area);
    const float *middle = pixel(rgba, WIDTH / 2, HEIGHT / 2);
    assert_true(middle[2] > 4 * middle[0]);
    memory_free(rgba);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

static conus_status create_and_destroy(void *data)
{
    conus_renderer *renderer = NULL;
    conus_status status = conus_renderer_create(&renderer, data, &(conus_renderer_options){.engine = picture_engine()});
    conus_renderer_destroy(renderer);
    return status;
}

static void allocations_may_fail(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){9, 8, 7}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, soft_shell);
    conus_renderer_destroy(picture_renderer(atlas, NULL)); /* skips where there is no GL */
    test_every_allocation(create_and_destroy, atlas);
    conus_atlas_destroy(atlas);
}

static void limits_are_kept(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){20, 20, 20}, (double[]){1, 1, 1}, picture_identity);
    conus_atlas *atlas = picture_atlas(&grid, picture_ball_of_20, NULL, soft_shell);
    conus_renderer_destroy(picture_renderer(atlas, NULL)); /* skips where there is no GL */
    conus_renderer *renderer = NULL;
    assert_fails(conus_renderer_create(&renderer, atlas,
                                       &(conus_renderer_options){.max_memory = 40000, .engine = picture_engine()}),
                 CONUS_ERROR_MEMORY);
    assert_fails(conus_renderer_create(&renderer, atlas,
                                       &(conus_renderer_options){.transfer = "brian", .engine = picture_engine()}),
                 CONUS_ERROR_ARGUMENT);
    assert_null(renderer);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(colour)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slab_obeys_its_closed_form),
        cmocka_unit_test(haze_before_an_area_obeys_its_closed_form),
        cmocka_unit_test(more_planes_change_little),
        cmocka_unit_test(skipping_changes_no_bit),
        cmocka_unit_test(a_ball_has_its_silhouette),
        cmocka_unit_test(smooth_areas_keep_their_voxels),
        cmocka_unit_test(moving_everything_changes_little),
        cmocka_unit_test(left_is_left),
        cmocka_unit_test(depth_decides_what_is_seen),
        cmocka_unit_test(a_cone_leaves_a_line_within_its_reach),
        cmocka_unit_test(areas_not_hit_are_pale),
        cmocka_unit_test(pathways_are_drawn_in_place_of_areas),
        cmocka_unit_test(allocations_may_fail),
        cmocka_unit_test(limits_are_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
