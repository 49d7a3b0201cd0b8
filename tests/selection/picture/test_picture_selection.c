/* SPDX-License-Identifier: BSD-3-Clause */
/* Images of a selection: evidence, colours and attributes. */
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "render/image/image.h"
#include "scene.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct fixture {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_selection *selection;
};

/* A random atlas with a pathway, seen so that some pixels hit objects of both kinds and some hit nothing. */
static struct fixture make_fixture(uint32_t resolution, conus_aperture aperture)
{
    uint64_t seed = 4;
    struct fixture fixture = {.atlas = scene_atlas(&seed, 20, 1)};
    const conus_selector_options options = {.resolution = resolution, .aperture = aperture};
    const conus_volume_info *info = conus_atlas_volume(fixture.atlas, 0);
    double corner[3];
    double centre[3];
    conus_pose pose;
    mat4_point(corner, info->world_from_voxel,
               (double[]){-2.0 * (double)info->dim[0], -1.5 * (double)info->dim[1], -2});
    mat4_point(centre, info->world_from_voxel,
               (double[]){(double)info->dim[0] / 2, (double)info->dim[1] / 2, (double)info->dim[2] / 2});
    assert_ok(conus_selector_create(&fixture.selector, fixture.atlas, &options));
    assert_ok(conus_pose_toward(&pose, corner, centre, NULL));
    assert_ok(conus_select(&fixture.selection, fixture.selector, &pose, 35));
    return fixture;
}

static void finish(struct fixture *fixture)
{
    conus_selection_destroy(fixture->selection);
    conus_selector_destroy(fixture->selector);
    conus_atlas_destroy(fixture->atlas);
}

static void check_pixel(const conus_image *image, const struct fixture *fixture, uint32_t x, uint32_t y)
{
    static const char *const axes[] = {"X", "Y", "Z"};
    conus_evidence evidence = conus_selection_evidence(fixture->selection);
    uint32_t n = evidence.resolution;
    size_t got = (size_t)y * n + x;
    size_t wanted = (size_t)(n - 1 - y) * n + x;
    uint32_t number = evidence.object[wanted];
    double position[3];
    conus_selection_position(position, fixture->selection, wanted);
    assert_int_equal(conus_image_uints(image, "object")[got], number);
    assert_int_equal(conus_image_uints(image, "id")[got],
                     number ? conus_atlas_object(fixture->atlas, number)->label : 0);
    for (int a = 0; a < 3; a++) {
        float coordinate = conus_image_floats(image, axes[a])[got];
        assert_true(number ? coordinate == (float)position[a] : isnan(coordinate));
    }
    float distance = conus_image_floats(image, "t")[got];
    assert_true(number ? distance == (float)evidence.distance[wanted] : distance == INFINITY);
}

static void image_is_the_evidence_from_the_top(void **state)
{
    (void)state;
    struct fixture fixture = make_fixture(17, CONUS_APERTURE_CIRCLE);
    conus_image *image = NULL;
    size_t hits = 0;
    assert_ok(conus_selection_image(&image, fixture.selection));
    assert_int_equal(conus_image_width(image), 17);
    assert_int_equal(conus_image_height(image), 17);
    for (uint32_t y = 0; y < 17; y++) {
        for (uint32_t x = 0; x < 17; x++) {
            check_pixel(image, &fixture, x, y);
            hits += conus_image_uints(image, "object")[y * 17 + x] > 0;
        }
    }
    assert_true(hits > 20 && hits < 17 * 17 - 20);
    conus_image_destroy(image);
    finish(&fixture);
}

static const char *text_of(const conus_image *image, const char *name)
{
    const struct image_attribute *attribute = image_find_attribute(image, name);
    assert_non_null(attribute);
    assert_non_null(attribute->text);
    return attribute->text;
}

static void attributes_say_where_it_comes_from(void **state)
{
    (void)state;
    struct fixture fixture = make_fixture(8, CONUS_APERTURE_SQUARE);
    conus_image *made = NULL;
    conus_image *image = NULL;
    assert_ok(conus_selection_image(&made, fixture.selection));
    assert_ok(conus_image_write(made, test_scratch("selection.exr")));
    assert_ok(conus_image_load(&image, test_scratch("selection.exr")));
    assert_string_equal(text_of(image, "conus:version"), CONUS_VERSION);
    assert_string_equal(text_of(image, "conus:space"), "RAS mm");
    assert_string_equal(text_of(image, "conus:angleDegrees"), "35");
    assert_string_equal(text_of(image, "conus:aperture"), "square");
    assert_string_equal(text_of(image, "conus:sampling"), "exact");
    assert_string_equal(text_of(image, "conus:engine"), conus_selector_engine(fixture.selector));
    const conus_volume_info *info = conus_atlas_volume(fixture.atlas, 0);
    assert_string_equal(text_of(image, "conus:atlas"), info->path);
    assert_string_equal(text_of(image, "conus:atlasSha256"), info->sha256);
    assert_string_equal(text_of(image, "conus:volume1"), conus_atlas_volume(fixture.atlas, 1)->path);
    assert_memory_equal(text_of(image, "conus:objects"), "object\tid\tkind\tname\n", 20);
    const struct image_attribute *pose = image_find_attribute(image, "conus:worldFromDevice");
    double origin[3];
    mat4_point(origin, info->world_from_voxel,
               (double[]){-2.0 * (double)info->dim[0], -1.5 * (double)info->dim[1], -2});
    for (int a = 0; a < 3; a++) {
        assert_near(pose->matrix[12 + a], origin[a], 1e-9);
    }
    conus_image_difference difference;
    assert_ok(conus_image_compare(&difference, made, image, 0));
    assert_int_equal(difference.differing, 0);
    conus_image_destroy(image);
    conus_image_destroy(made);
    finish(&fixture);
}

/* The middle of each magnified pixel has its object's colour, or a darker one outside the aperture. */
static void check_magnified(const conus_image *image, const struct fixture *fixture, uint32_t i)
{
    conus_evidence evidence = conus_selection_evidence(fixture->selection);
    uint32_t n = evidence.resolution;
    size_t factor = image->png_height / n;
    size_t x = i % n * factor + factor / 2;
    size_t y = (n - 1 - i / n) * factor + factor / 2;
    const uint8_t *pixel = image->png_rgba + 4 * (y * image->png_width + x);
    const conus_object *object = conus_atlas_object(fixture->atlas, evidence.object[i]);
    for (int c = 0; object && c < 3; c++) {
        double linear = (evidence.in_cone[i] ? 1 : 0.15) * linear_from_srgb(object->rgb[c] / 255.0);
        assert_near(pixel[c], 255 * srgb_from_linear(linear), 0.51);
    }
    assert_true(object || (pixel[0] < 60 && pixel[1] < 60 && pixel[2] < 60));
    assert_int_equal(pixel[3], 255);
}

static void picture_is_in_the_areas_colours(void **state)
{
    (void)state;
    for (uint32_t n = 1; n <= 1024; n = 3 * n + 1) {
        struct fixture fixture = make_fixture(n, CONUS_APERTURE_CIRCLE);
        conus_image *image = NULL;
        assert_ok(conus_selection_image(&image, fixture.selection));
        assert_true(image->png_height >= 512 && image->png_height % n == 0 && image->png_width >= image->png_height);
        for (uint32_t i = 0; i < n * n; i++) {
            check_magnified(image, &fixture, i);
        }
        conus_image_destroy(image);
        finish(&fixture);
    }
}

static conus_status make_image(void *data)
{
    conus_image *image = NULL;
    conus_status status = conus_selection_image(&image, data);
    conus_image_destroy(image);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    struct fixture fixture = make_fixture(4, CONUS_APERTURE_CIRCLE);
    test_every_allocation(make_image, fixture.selection);
    finish(&fixture);
}

TEST_GROUP(picture_selection)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(image_is_the_evidence_from_the_top),
        cmocka_unit_test(attributes_say_where_it_comes_from),
        cmocka_unit_test(picture_is_in_the_areas_colours),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
