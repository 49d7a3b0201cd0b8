/* SPDX-License-Identifier: BSD-3-Clause */
/* Deep images: OpenEXR's C++ library reads what was written. */
#include "base/memory.h"
#include "conus/file.h"
#include "exr_oracle.h"
#include "render/image/deep_image.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH_LIMIT = 40, HEIGHT_LIMIT = 20 };

static const char *const CHANNELS[] = {"id", "Z", "ZBack", "A"}; /* not the file's order */

/* Two thirds of the pixels are empty, the others have up to `most` samples of arbitrary bits that are numbers. */
static struct deep_image *make_image(uint64_t *state, uint32_t width, uint32_t height, double most)
{
    uint32_t counts[WIDTH_LIMIT * HEIGHT_LIMIT];
    struct deep_image *image = NULL;
    for (uint32_t i = 0; i < width * height; i++) {
        counts[i] = test_random(state, 0, 3) < 1 ? (uint32_t)test_random(state, 0, most + 1) : 0;
    }
    assert_ok(deep_image_create(&image, width, height, counts));
    for (int c = 0; c < 4; c++) {
        struct image_channel *channel = NULL;
        assert_ok(deep_image_add_channel(image, CHANNELS[c], c ? IMAGE_FLOAT : IMAGE_UINT, &channel));
        for (size_t i = 0; i < image->sample_count; i++) {
            if (c) {
                channel->floats[i] = (float)test_random(state, -1e3, 1e3);
            } else {
                channel->uints[i] = (uint32_t)test_random(state, 0, 4294967296.0);
            }
        }
    }
    assert_ok(image_add_text(image->header, "conus:space", "RAS mm"));
    return image;
}

static uint32_t largest(const struct deep_image *image)
{
    uint32_t most = 0;
    for (uint32_t i = 0; i < image->header->width * image->header->height; i++) {
        most = image->counts[i] > most ? image->counts[i] : most;
    }
    return most;
}

static void assert_same_sample(const struct exr_deep *deep, const struct deep_image *image, uint32_t x, uint32_t y,
                               uint32_t s, size_t sample)
{
    assert_int_equal(image->channel_count, 4);
    for (int c = 0; c < 4; c++) {
        const struct image_channel *channel = &image->channels[c];
        if (channel->type == IMAGE_UINT) {
            assert_int_equal(exr_deep_uint(deep, channel->name, x, y, s), channel->uints[sample]);
        } else {
            assert_true(exr_deep_float(deep, channel->name, x, y, s) == channel->floats[sample]);
        }
    }
}

static void assert_same(const struct exr_deep *deep, const struct deep_image *image)
{
    size_t sample = 0;
    assert_int_equal(exr_deep_side(deep, 0), image->header->width);
    assert_int_equal(exr_deep_side(deep, 1), image->header->height);
    for (uint32_t y = 0; y < image->header->height; y++) {
        for (uint32_t x = 0; x < image->header->width; x++) {
            assert_int_equal(exr_deep_count(deep, x, y), image->counts[y * image->header->width + x]);
            for (uint32_t s = 0; s < exr_deep_count(deep, x, y); s++, sample++) {
                assert_same_sample(deep, image, x, y, s, sample);
            }
        }
    }
    assert_int_equal(sample, image->sample_count);
    assert_int_equal(exr_deep_number(deep, "maxSamplesPerPixel"), largest(image));
    assert_string_equal(exr_deep_text(deep, "conus:space"), "RAS mm");
    assert_int_equal(exr_deep_names(deep, "id"), 0);
}

static void check_written(struct deep_image *image)
{
    struct bytes bytes;
    const char *path = test_scratch("deep.exr");
    assert_ok(deep_image_format(&bytes, image));
    assert_ok(conus_write_file(path, bytes.data, bytes.size));
    struct exr_deep *deep = exr_deep_read(path);
    assert_non_null(deep);
    assert_same(deep, image);
    exr_deep_close(deep);
    bytes_finish(&bytes);
    deep_image_destroy(image);
}

static void openexr_reads_what_was_written(void **state)
{
    (void)state;
    uint64_t seed = 8;
    for (int i = 0; i < 60; i++) {
        uint32_t width = (uint32_t)test_random(&seed, 1, WIDTH_LIMIT);
        uint32_t height = (uint32_t)test_random(&seed, 1, HEIGHT_LIMIT);
        check_written(make_image(&seed, width, height, i % 3 ? 5 : 400));
    }
}

static void images_may_be_empty_or_one_pixel(void **state)
{
    (void)state;
    uint64_t seed = 9;
    check_written(make_image(&seed, 7, 5, 0));
    check_written(make_image(&seed, 1, 1, 0));
    for (int i = 0; i < 20; i++) {
        check_written(make_image(&seed, 1, 1, 3));
    }
}

/* Equal samples pack well, random ones not at all: both ways of storing a chunk. */
static void what_packs_well_is_smaller(void **state)
{
    (void)state;
    struct deep_image *image = NULL;
    struct image_channel *channel = NULL;
    struct bytes alike;
    struct bytes mixed;
    uint64_t seed = 1;
    assert_ok(deep_image_create(&image, 1, 1, (uint32_t[]){100000}));
    assert_ok(deep_image_add_channel(image, "id", IMAGE_UINT, &channel));
    assert_ok(deep_image_format(&alike, image));
    for (size_t i = 0; i < image->sample_count; i++) {
        channel->uints[i] = (uint32_t)test_random(&seed, 0, 4294967296.0);
    }
    assert_ok(deep_image_format(&mixed, image));
    assert_true(alike.size < 4000);
    assert_in_range(mixed.size, 400000, 402000);
    bytes_finish(&alike);
    bytes_finish(&mixed);
    deep_image_destroy(image);
}

static void too_many_samples_are_refused(void **state)
{
    (void)state;
    struct deep_image *image = NULL;
    assert_fails(deep_image_create(&image, 2, 1, (uint32_t[]){INT32_MAX, 1}), CONUS_ERROR_UNSUPPORTED);
    assert_fails(deep_image_create(&image, 0, 1, (uint32_t[]){1}), CONUS_ERROR_DATA);
    assert_null(image);
    deep_image_destroy(NULL);
}

static conus_status format_image(void *data)
{
    (void)data;
    static const uint32_t counts[] = {0, 2, 1, 0};
    struct deep_image *image = NULL;
    struct image_channel *channel = NULL;
    struct bytes bytes = {0};
    conus_status status = deep_image_create(&image, 2, 2, counts);
    status = status ? status : deep_image_add_channel(image, "id", IMAGE_UINT, &channel);
    status = status ? status : deep_image_add_channel(image, "Z", IMAGE_FLOAT, &channel);
    if (!status) {
        image->manifest = (struct bytes){memory_zeroed(2000, 1), 2000};
        status = image->manifest.data ? deep_image_format(&bytes, image) : CONUS_ERROR_MEMORY;
    }
    bytes_finish(&bytes);
    deep_image_destroy(image);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    test_every_allocation(format_image, NULL);
}

TEST_GROUP(deep_image)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(openexr_reads_what_was_written),       cmocka_unit_test(images_may_be_empty_or_one_pixel),
        cmocka_unit_test(what_packs_well_is_smaller),           cmocka_unit_test(too_many_samples_are_refused),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
