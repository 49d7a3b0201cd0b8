/* SPDX-License-Identifier: BSD-3-Clause */
/* Deep images, read back with the OpenEXR library. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/image.h"
#include "conus/version.h"
#include "exr_oracle.h"
#include "scene.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct fixture {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_selection *selection;
    conus_pose pose;
    double angle;
};

static struct fixture select_from(conus_atlas *atlas, const conus_selector_options *options, const conus_pose *pose,
                                  double angle)
{
    struct fixture fixture = {.atlas = atlas, .pose = *pose, .angle = angle};
    assert_ok(conus_selector_create(&fixture.selector, atlas, options));
    assert_ok(conus_select(&fixture.selection, fixture.selector, pose, angle));
    return fixture;
}

static void finish(struct fixture *fixture)
{
    conus_selection_destroy(fixture->selection);
    conus_selector_destroy(fixture->selector);
    conus_atlas_destroy(fixture->atlas);
}

/* A device outside of a random atlas with a pathway, so that many pixels have several intervals and some none. */
static struct fixture make_fixture(uint32_t resolution, uint64_t seed)
{
    conus_atlas *atlas = scene_atlas(&seed, 20, 1);
    const conus_volume_info *info = conus_atlas_volume(atlas, 0);
    const double dim[3] = {(double)info->dim[0], (double)info->dim[1], (double)info->dim[2]};
    const conus_selector_options options = {.resolution = resolution, .layers = CONUS_LAYERS_ALL};
    double corner[3];
    double centre[3];
    conus_pose pose;
    mat4_point(corner, info->world_from_voxel, (double[]){-2 * dim[0], -1.5 * dim[1], -2});
    mat4_point(centre, info->world_from_voxel, (double[]){dim[0] / 2, dim[1] / 2, dim[2] / 2});
    assert_ok(conus_pose_toward(&pose, corner, centre, NULL));
    return select_from(atlas, &options, &pose, radians_from_degrees(35));
}

static struct exr_deep *write_and_read(const conus_selection *selection)
{
    const char *path = test_scratch("deep.exr");
    assert_ok(conus_selection_write_deep(selection, path));
    struct exr_deep *deep = exr_deep_read(path);
    assert_non_null(deep);
    return deep;
}

/* Depth along the axis of the place at `distance` along the ray of pixel (x, y), counted from the top left (Eq. 3). */
static double depth(const struct fixture *fixture, uint32_t n, uint32_t x, uint32_t y, double distance)
{
    double u = (2.0 * x + 1) / n - 1;
    double v = 1 - (2.0 * y + 1) / n;
    return distance * cos(atan(tan(fixture->angle / 2) * hypot(u, v)));
}

static void check_sample(const struct exr_deep *deep, const struct fixture *fixture, uint32_t x, uint32_t y, uint32_t s,
                         const conus_interval *interval)
{
    uint32_t n = exr_deep_side(deep, 0);
    double wanted[2] = {depth(fixture, n, x, y, interval->entry), depth(fixture, n, x, y, interval->exit)};
    assert_int_equal(exr_deep_uint(deep, "object", x, y, s), interval->object);
    assert_int_equal(exr_deep_uint(deep, "id", x, y, s), conus_atlas_object(fixture->atlas, interval->object)->label);
    assert_true(exr_deep_float(deep, "t", x, y, s) == (float)interval->entry);
    assert_true(exr_deep_float(deep, "tBack", x, y, s) == (float)interval->exit);
    assert_near(exr_deep_float(deep, "Z", x, y, s), wanted[0], 1e-7 * wanted[0]);
    assert_near(exr_deep_float(deep, "ZBack", x, y, s), wanted[1], 1e-7 * wanted[1]);
    assert_true(exr_deep_float(deep, "Z", x, y, s) <= exr_deep_float(deep, "ZBack", x, y, s));
    assert_true(s == 0 || exr_deep_float(deep, "Z", x, y, s) >= exr_deep_float(deep, "Z", x, y, s - 1));
    assert_true(exr_deep_float(deep, "A", x, y, s) == 1);
}

/* Checks that all intervals are there, each once, in its own pixel; returns the number of empty pixels. */
static uint32_t check_samples(const struct exr_deep *deep, const struct fixture *fixture)
{
    size_t count = 0;
    size_t next = 0;
    uint32_t empty = 0;
    uint32_t n = conus_selection_evidence(fixture->selection).resolution;
    const conus_interval *intervals = conus_selection_intervals(&count, fixture->selection);
    assert_int_equal(exr_deep_side(deep, 0), n);
    assert_int_equal(exr_deep_side(deep, 1), n);
    for (uint32_t pixel = 0; pixel < n * n; pixel++) {
        uint32_t x = pixel % n;
        uint32_t y = n - 1 - pixel / n;
        uint32_t samples = exr_deep_count(deep, x, y);
        for (uint32_t s = 0; s < samples; s++, next++) {
            assert_true(next < count);
            assert_int_equal(intervals[next].pixel, pixel);
            check_sample(deep, fixture, x, y, s, &intervals[next]);
        }
        empty += samples == 0;
    }
    assert_int_equal(next, count);
    return empty;
}

/* Number of objects that have samples; each has its name in the manifest, under its number and under its label. */
static size_t check_names(const struct exr_deep *deep, const struct fixture *fixture)
{
    size_t interval_count = 0;
    size_t objects = 0;
    const conus_interval *intervals = conus_selection_intervals(&interval_count, fixture->selection);
    bool *present = calloc(conus_atlas_object_count(fixture->atlas) + 1, sizeof *present);
    for (size_t i = 0; i < interval_count; i++) {
        objects += !present[intervals[i].object];
        present[intervals[i].object] = true;
    }
    for (uint32_t number = 1; number <= conus_atlas_object_count(fixture->atlas); number++) {
        const conus_object *object = conus_atlas_object(fixture->atlas, number);
        if (!present[number]) {
            assert_null(exr_deep_name(deep, "object", number, "name"));
            continue;
        }
        char label[16];
        snprintf(label, sizeof label, "%u", object->label);
        assert_string_equal(exr_deep_name(deep, "object", number, "name"), object->name);
        assert_string_equal(exr_deep_name(deep, "object", number, "label"), label);
        assert_string_equal(exr_deep_name(deep, "object", number, "kind"),
                            object->kind == CONUS_KIND_PATHWAY ? "pathway" : "area");
        assert_non_null(strstr(exr_deep_name(deep, "id", object->label, "name"), object->name));
    }
    assert_int_equal(exr_deep_names(deep, "object"), objects);
    free(present);
    return objects;
}

static void every_interval_of_every_ray_is_a_sample(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++) {
        struct fixture fixture = make_fixture(17, seed);
        struct exr_deep *deep = write_and_read(fixture.selection);
        check_samples(deep, &fixture);
        check_names(deep, &fixture);
        exr_deep_close(deep);
        finish(&fixture);
    }
}

static void one_pixel_or_nothing_at_all(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++) {
        struct fixture fixture = make_fixture(1, seed);
        struct exr_deep *deep = write_and_read(fixture.selection);
        check_samples(deep, &fixture);
        exr_deep_close(deep);
        for (int a = 8; a < 11; a++) { /* and the other way: x and z turned about y */
            fixture.pose.world_from_device[a] *= -1;
            fixture.pose.world_from_device[a - 8] *= -1;
        }
        conus_selection_destroy(fixture.selection);
        assert_ok(conus_select(&fixture.selection, fixture.selector, &fixture.pose, fixture.angle));
        deep = write_and_read(fixture.selection);
        assert_int_equal(check_samples(deep, &fixture), 1);
        assert_int_equal(check_names(deep, &fixture), 0);
        exr_deep_close(deep);
        finish(&fixture);
    }
}

static void header_says_where_it_comes_from(void **state)
{
    (void)state;
    struct fixture fixture = make_fixture(8, 4);
    struct exr_deep *deep = write_and_read(fixture.selection);
    assert_string_equal(exr_deep_text(deep, "conus:version"), CONUS_VERSION);
    assert_string_equal(exr_deep_text(deep, "conus:angleDegrees"), "35");
    assert_null(exr_deep_text(deep, "conus:radiusMm"));
    assert_null(exr_deep_text(deep, "conus:rangeMm"));
    assert_string_equal(exr_deep_text(deep, "conus:atlas"), "scene");
    assert_int_equal(exr_deep_number(deep, "chunkCount"), 8);
    assert_string_equal(exr_deep_text(deep, "conus:engine"), conus_selector_engine(fixture.selector));
    assert_memory_equal(exr_deep_text(deep, "conus:objects"), "object\tid\tkind\tname\n", 20);
    exr_deep_close(deep);
    finish(&fixture);
}

/* Rays of a cylinder are parallel to the axis: a depth is a distance. Intervals that the range cuts begin and end at
 * it. */
static void a_cylinder_with_a_range(void **state)
{
    (void)state;
    uint64_t seed = 8;
    conus_atlas *atlas = scene_atlas(&seed, 20, 1);
    const conus_selector_options options = {
        .layers = CONUS_LAYERS_ALL, .resolution = 9, .radius = 12.5, .range = {40, 55.25}};
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){-50, 0, 0}, (double[]){1, 0, 0}, NULL));
    struct fixture fixture = select_from(atlas, &options, &pose, 0);
    struct exr_deep *deep = write_and_read(fixture.selection);
    assert_true(check_samples(deep, &fixture) < 81);
    for (uint32_t pixel = 0; pixel < 81; pixel++) {
        for (uint32_t s = 0; s < exr_deep_count(deep, pixel % 9, pixel / 9); s++) {
            assert_true(exr_deep_float(deep, "Z", pixel % 9, pixel / 9, s) >= 40);
            assert_true(exr_deep_float(deep, "ZBack", pixel % 9, pixel / 9, s) <= 55.25F);
        }
    }
    assert_string_equal(exr_deep_text(deep, "conus:radiusMm"), "12.5");
    assert_string_equal(exr_deep_text(deep, "conus:rangeMm"), "40 55.25");
    exr_deep_close(deep);
    finish(&fixture);
}

/* Names with characters as files have them, and one label for two objects. */
static void any_name_is_kept(void **state)
{
    (void)state;
    static const char *const names[] = {"Gyrus fusiformis, \xc3\xa9 \xe6\x9c\xac", "a \"quoted\" 'name'\\", "tab\there",
                                        ""};
    struct fixture fixture = make_fixture(17, 8);
    size_t count = conus_atlas_object_count(fixture.atlas);
    const char **kept = malloc(count * sizeof *kept);
    assert_int_equal(count, 7);
    for (size_t i = 0; i < count; i++) {
        kept[i] = fixture.atlas->objects[i].name;
        fixture.atlas->objects[i].name = names[i % 4];
    }
    struct exr_deep *deep = write_and_read(fixture.selection);
    assert_int_equal(check_names(deep, &fixture), 7);
    assert_int_equal(fixture.atlas->objects[0].label, fixture.atlas->objects[count - 1].label); /* the pathway */
    assert_string_equal(exr_deep_name(deep, "id", 1, "name"), "Gyrus fusiformis, \xc3\xa9 \xe6\x9c\xac / tab\there");
    for (size_t i = 0; i < count; i++) {
        fixture.atlas->objects[i].name = kept[i];
    }
    free(kept);
    exr_deep_close(deep);
    finish(&fixture);
}

/* A plate of 270 x 270 voxels, each another area: as many as the largest atlas has. */
static conus_atlas *plate(void)
{
    enum { SIDE = 270, AREAS = 72783 };
    const double centred[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -134.5, -134.5, 0, 1};
    const conus_volume_info grid = scene_plain_grid((size_t[]){SIDE, SIDE, 1}, centred);
    uint32_t *labels = memory_zeroed(SIDE * SIDE, sizeof *labels);
    for (uint32_t i = 0; i < AREAS; i++) {
        labels[i] = 50000 * i + 1;
    }
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    memory_free(labels);
    return atlas;
}

static void as_many_areas_as_there_are(void **state)
{
    (void)state;
    const conus_selector_options options = {
        .resolution = 540, .layers = CONUS_LAYERS_ALL, .aperture = CONUS_APERTURE_SQUARE};
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 10000}, (double[]){0, 0, -1}, NULL));
    struct fixture fixture = select_from(plate(), &options, &pose, 2 * atan2(135, 10000));
    struct exr_deep *deep = write_and_read(fixture.selection);
    check_samples(deep, &fixture);
    assert_int_equal(check_names(deep, &fixture), 72783);
    assert_int_equal(exr_deep_names(deep, "id"), 72783);
    exr_deep_close(deep);
    finish(&fixture);
}

static void what_is_visible_only_is_refused(void **state)
{
    (void)state;
    struct fixture fixture = make_fixture(4, 4);
    const char *path = test_scratch("refused.exr");
    conus_selector *selector = NULL;
    conus_selection *visible = NULL;
    assert_ok(conus_selector_create(&selector, fixture.atlas, NULL));
    assert_ok(conus_select(&visible, selector, &fixture.pose, fixture.angle));
    assert_fails(conus_selection_write_deep(visible, path), CONUS_ERROR_ARGUMENT);
    assert_int_equal(access(path, F_OK), -1);
    assert_fails(conus_selection_write_deep(fixture.selection, test_scratch("none/deep.exr")), CONUS_ERROR_IO);
    conus_selection_destroy(visible);
    assert_ok(conus_select_ball(&visible, fixture.selector, (double[]){0, 0, 0}, 5));
    assert_fails(conus_selection_write_deep(visible, path), CONUS_ERROR_ARGUMENT);
    conus_selection_destroy(visible);
    conus_selector_destroy(selector);
    finish(&fixture);
}

static conus_status write_deep(void *data)
{
    return conus_selection_write_deep(data, test_scratch("allocations.exr"));
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    struct fixture fixture = make_fixture(4, 4);
    test_every_allocation(write_deep, fixture.selection);
    finish(&fixture);
}

TEST_GROUP(picture_deep)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_interval_of_every_ray_is_a_sample),
        cmocka_unit_test(one_pixel_or_nothing_at_all),
        cmocka_unit_test(header_says_where_it_comes_from),
        cmocka_unit_test(a_cylinder_with_a_range),
        cmocka_unit_test(any_name_is_kept),
        cmocka_unit_test(as_many_areas_as_there_are),
        cmocka_unit_test(what_is_visible_only_is_refused),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
