/* SPDX-License-Identifier: BSD-3-Clause */
/* Streamlines in flat cuts: every pixel against its distance to all segments, areas in closed form. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/flat/cut.h"
#include "scene.h"
#include "test.h"
#include "tract_scene.h"

#include <string.h>

enum { WIDTH = 150, HEIGHT = 110, PIXELS = WIDTH * HEIGHT };

static conus_atlas *empty_atlas(void)
{
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, "none"));
    return atlas;
}

static void add(conus_atlas *atlas, const char *name, const float *points, size_t count, double radius)
{
    struct tractogram tractogram = tract_of("made", points, (const uint64_t[]){0, count}, 1, radius);
    assert_ok(atlas_add_tractogram(atlas, &tractogram, name));
}

/* x to the right and z up, through `y`. */
static struct cut_view coronal(double y, double mm_per_pixel)
{
    return (struct cut_view){.place = {.centre = {1, y, 2},
                                       .right = {1, 0, 0},
                                       .up = {0, 0, 1},
                                       .mm_per_pixel = mm_per_pixel,
                                       .width = WIDTH,
                                       .height = HEIGHT},
                             .fill = 0.5,
                             .window = {0, 1}};
}

static size_t draw_and_count(uint32_t *objects, const conus_atlas *atlas, const struct cut_view *view, uint32_t object)
{
    struct cut cut;
    size_t count = 0;
    assert_ok(cut_init(&cut, atlas));
    assert_ok(cut_draw(&cut, view));
    memcpy(objects, cut.objects, PIXELS * sizeof *objects);
    for (int i = 0; i < PIXELS; i++) {
        count += objects[i] == object;
    }
    cut_finish(&cut);
    return count;
}

/* A tube across the plane is a disc, at 60 degrees to it an ellipse, and in it a bar with round ends: their areas are
 * right within 1.5 %. */
static void tubes_have_the_area_of_their_section(void **state)
{
    (void)state;
    static uint32_t objects[PIXELS];
    const float slope = (float)sqrt(3);
    const struct {
        float points[6];
        double area;
    } sections[] = {{{5, -20, 1, 5, 30, 1}, MATH3_PI * 9},
                    {{-9, -10 * slope, 0, 11, 10 * slope, 0}, MATH3_PI * 9 * 2 / sqrt(3)},
                    {{-2, 3, 1, 4, 3, 1}, MATH3_PI * 9 + 6 * 6}};
    for (size_t i = 0; i < 3; i++) {
        conus_atlas *atlas = empty_atlas();
        const struct cut_view view = coronal(i == 2 ? 3 : 0, 0.1);
        add(atlas, "one", sections[i].points, 2, 3);
        size_t count = draw_and_count(objects, atlas, &view, 1);
        assert_near((double)count * 0.01, sections[i].area, 0.015 * sections[i].area);
        conus_atlas_destroy(atlas);
    }
}

static double distance_to_segment(const double p[3], const float *a, const float *b)
{
    double least = INFINITY; /* by bisection: the distance to a line's point is convex in s */
    double low = 0;
    double high = 1;
    for (int turn = 0; turn < 45; turn++) {
        double at[2];
        for (int side = 0; side < 2; side++) {
            double s = low + (high - low) * (side ? 2.0 / 3 : 1.0 / 3);
            double away[3];
            for (int k = 0; k < 3; k++) {
                away[k] = (double)a[k] + s * ((double)b[k] - (double)a[k]) - p[k];
            }
            at[side] = vec3_length(away);
            least = fmin(least, at[side]);
        }
        *(at[0] < at[1] ? &high : &low) = low + (high - low) * (at[0] < at[1] ? 2.0 / 3 : 1.0 / 3);
    }
    return least;
}

/* Two random walks of two bundles; the first bundle has the pixels that are in both. Pixels within 1e-6 mm of a border
 * may be either. */
static void every_pixel_has_the_first_bundle_within_the_radius(void **state)
{
    (void)state;
    enum { POINTS = 60 };
    static uint32_t objects[PIXELS];
    static float walks[2][3 * POINTS];
    uint64_t random = 77;
    const double radius = 0.8;
    for (int w = 0; w < 2; w++) {
        for (int i = 0; i < 3 * POINTS; i++) {
            double before = i < 3 ? 0 : (double)walks[w][i - 3];
            walks[w][i] = (float)(before + test_random(&random, -2.5, 2.5));
        }
    }
    conus_atlas *atlas = empty_atlas();
    add(atlas, "first", walks[0], POINTS, radius);
    add(atlas, "second", walks[1], POINTS, radius);
    const struct cut_view view = coronal(0.5, 0.4);
    size_t found = draw_and_count(objects, atlas, &view, 1) + draw_and_count(objects, atlas, &view, 2);
    assert_true(found > 100);
    for (int i = 0; i < PIXELS; i++) {
        const int row = i / WIDTH;
        const double p[3] = {1 + (i % WIDTH + 0.5 - WIDTH / 2.0) * 0.4, 0.5, 2 - (row + 0.5 - HEIGHT / 2.0) * 0.4};
        double distance[2] = {INFINITY, INFINITY};
        for (int n = 0; n < 2 * (POINTS - 1); n++) {
            const float *at = &walks[n % 2][3 * (n / 2)];
            distance[n % 2] = fmin(distance[n % 2], distance_to_segment(p, at, at + 3));
        }
        uint32_t expected = distance[0] <= radius ? 1 : distance[1] <= radius ? 2 : 0;
        bool is_near = fabs(distance[0] - radius) < 1e-6 || fabs(distance[1] - radius) < 1e-6;
        assert_true(is_near || objects[i] == expected);
    }
    conus_atlas_destroy(atlas);
}

/* A tube much thinner than a pixel takes one or two pixels where it passes, and always at least one. */
static void thin_tubes_are_not_lost(void **state)
{
    (void)state;
    static uint32_t objects[PIXELS];
    uint64_t random = 5;
    for (int n = 0; n < 20; n++) {
        float x = (float)test_random(&random, -20, 20);
        float z = (float)test_random(&random, -20, 20);
        const float points[6] = {x, -20, z, x, 30, z};
        conus_atlas *atlas = empty_atlas();
        const struct cut_view view = coronal(0, 1);
        add(atlas, "thin", points, 2, 0.01);
        size_t count = draw_and_count(objects, atlas, &view, 1);
        assert_true(count >= 1 && count <= 4);
        conus_atlas_destroy(atlas);
    }
}

/* A bundle inside an area with a lower number: the area is 40 mm wide, and the bundle is drawn in it. */
static void a_bundle_is_drawn_over_areas(void **state)
{
    (void)state;
    static uint32_t objects[PIXELS];
    static const float points[6] = {0, -20, 0, 0, 30, 0};
    const double m[16] = {40, 0, 0, 0, 0, 40, 0, 0, 0, 0, 40, 0, 0, 0, 0, 1};
    const conus_volume_info grid = scene_plain_grid((size_t[]){1, 1, 1}, m);
    conus_atlas *atlas = scene_parcellation(&grid, (uint32_t[]){1});
    const struct cut_view view = coronal(0, 0.5);
    add(atlas, "one", points, 2, 2);
    size_t count = draw_and_count(objects, atlas, &view, 2);
    assert_near((double)count * 0.25, MATH3_PI * 4, 0.1 * MATH3_PI * 4);
    assert_true(draw_and_count(objects, atlas, &view, 1) > 4000);
    conus_atlas_destroy(atlas);
}

static void what_is_hidden_is_not_cut(void **state)
{
    (void)state;
    static uint32_t objects[PIXELS];
    static const float points[6] = {0, -20, 0, 0, 30, 0};
    static const float others[6] = {9, -20, 0, 9, 30, 0};
    conus_atlas *atlas = empty_atlas();
    const struct cut_view view = coronal(0, 0.5);
    add(atlas, "one", points, 2, 2);
    add(atlas, "two", others, 2, 2);
    assert_ok(conus_atlas_show(atlas, NULL, "one"));
    assert_int_equal(draw_and_count(objects, atlas, &view, 1), 0);
    assert_true(draw_and_count(objects, atlas, &view, 2) > 30);
    conus_atlas_destroy(atlas);
}

static conus_status cut_once(void *user)
{
    const conus_atlas *atlas = user;
    struct cut cut = {0};
    const struct cut_view view = coronal(0, 0.5);
    conus_status status = cut_init(&cut, atlas);
    if (!status) {
        status = cut_draw(&cut, &view);
        cut_finish(&cut);
    }
    return status;
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    static const float points[6] = {0, -20, 0, 0, 30, 0};
    conus_atlas *atlas = empty_atlas();
    add(atlas, "one", points, 2, 2);
    test_every_allocation(cut_once, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(cut_tracts)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tubes_have_the_area_of_their_section),
        cmocka_unit_test(every_pixel_has_the_first_bundle_within_the_radius),
        cmocka_unit_test(thin_tubes_are_not_lost),
        cmocka_unit_test(a_bundle_is_drawn_over_areas),
        cmocka_unit_test(what_is_hidden_is_not_cut),
        cmocka_unit_test(every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
