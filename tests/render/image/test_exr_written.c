/* SPDX-License-Identifier: BSD-3-Clause */
/* Every written picture reads back bit by bit, here and by OpenEXR's C++ library, whatever its content. A chunk that
 * deflates to just its own size must be stored as it is, since readers take it for that. The part of a chunk that is
 * noise, the rest being zero, grows byte by byte from nothing to all, and so passes through that size: 13 of the 2,425
 * flat pictures here have such a chunk. */
#include "exr_oracle.h"
#include "render/image/image.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINES_OF_CHUNK = 16 }; /* of ZIP */

static uint32_t noise(uint64_t *seed)
{
    return (uint32_t)test_random(seed, 0, 4294967296.0);
}

/* `count` values whose first `noisy` bytes are noise. */
static void fill_values(uint32_t *values, size_t count, size_t noisy, uint64_t *seed)
{
    memset(values, 0, count * sizeof *values);
    for (size_t i = 0; i < noisy; i++) {
        ((uint8_t *)values)[i] = (uint8_t)noise(seed);
    }
}

static void check_channel(const conus_image *image, const conus_image *back, const char *path, const char *name)
{
    size_t count = (size_t)image->width * image->height;
    const uint32_t *wanted = image_find(image, name)->uints;
    uint32_t *read = exr_flat_read(path, name, image->width, image->height);
    assert_non_null(read);
    if (memcmp(image_find(back, name)->uints, wanted, count * sizeof *wanted) != 0 ||
        memcmp(read, wanted, count * sizeof *wanted) != 0) {
        fail_msg("%u x %u pixels: channel %s is not what was written", image->width, image->height, name);
    }
    free(read);
}

static void write_scratch(const char *path, const struct bytes *bytes)
{
    remove(path); /* a new file needs no wait for the disk */
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes->data, 1, bytes->size, file), bytes->size);
    assert_int_equal(fclose(file), 0);
}

/* A picture of two channels, whose last chunk begins with `noisy` bytes of noise in each. */
static void check_flat(uint32_t width, uint32_t height, size_t noisy, uint64_t *seed)
{
    static const char *const names[] = {"id", "Z"};
    size_t before = (size_t)(height - 1) / LINES_OF_CHUNK * LINES_OF_CHUNK * width;
    conus_image *image = NULL;
    conus_image *back = NULL;
    struct bytes bytes;
    assert_ok(image_create(&image, width, height));
    for (int i = 0; i < 2; i++) {
        struct image_channel *channel = NULL;
        assert_ok(image_add_channel(image, names[i], i ? IMAGE_FLOAT : IMAGE_UINT, &channel));
        fill_values(channel->uints + before, (size_t)width * height - before, noisy, seed);
    }
    const char *path = test_scratch("flat.exr");
    assert_ok(image_format_exr(&bytes, image));
    assert_ok(image_parse_exr(&back, bytes.data, bytes.size));
    write_scratch(path, &bytes);
    for (int i = 0; i < 2; i++) {
        check_channel(image, back, path, names[i]);
    }
    bytes_finish(&bytes);
    conus_image_destroy(back);
    conus_image_destroy(image);
}

/* Heights of one chunk, of whole ones, and with a short last one. */
static void flat_pictures_read_back(void **state)
{
    (void)state;
    static const uint32_t heights[] = {1, 3, 16, 17, 35};
    static const uint32_t widths[] = {1, 2, 3, 7, 12};
    uint64_t seed = 12;
    for (int h = 0; h < 5; h++) {
        for (int w = 0; w < 5; w++) {
            size_t all = sizeof(uint32_t) * widths[w] * ((heights[h] - 1) % LINES_OF_CHUNK + 1);
            for (size_t noisy = 0; noisy <= all; noisy++) {
                check_flat(widths[w], heights[h], noisy, &seed);
            }
        }
    }
}

TEST_GROUP(exr_written)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flat_pictures_read_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
