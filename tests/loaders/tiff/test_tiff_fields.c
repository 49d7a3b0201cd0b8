/* SPDX-License-Identifier: BSD-3-Clause */
/* Fields of TIFF with a list of values. Tried are all values of the specification and those next to them. */
#include "base/files/file.h"
#include "builders/tiff_builder.h"
#include "loaders/tiff/tiff.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

enum { PIXELS = 12, SHORT = 3 };

/* Page 1 differs from page 0 in one field. */
static void pages_must_be_alike(void **state)
{
    (void)state;
    static const struct {
        struct tiff_field field;
        size_t bytes;
        const char *part;
    } cases[] = {
        {{.tag = TAG_BITS, .value = 16},
         2 * PIXELS,
         "page 1: 4 x 3 pixels of 16 bits, SampleFormat 1, but page 0 has 4 x"},
        {{.tag = TAG_FORMAT, .value = 2},
         PIXELS,
         "page 1: 4 x 3 pixels of 8 bits, SampleFormat 2, but page 0 has 4 x 3 of "
         "8 bits, SampleFormat 1: all must be alike"},
        {{.tag = TAG_WIDTH, .value = 8}, 2 * PIXELS, "page 1: 8 x 3 pixels of 8 bits"},
        {{.tag = TAG_LENGTH, .value = 6}, 2 * PIXELS, "page 1: 4 x 6 pixels of 8 bits"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        uint8_t pixels[2 * PIXELS] = {0};
        struct tiff_builder b;
        struct tiff tiff;
        const struct tiff_field fields[] = {cases[i].field, {.tag = TAG_ROWS, .value = 6}};
        tiff_begin(&b, false, false);
        tiff_add_page(&b, pixels, PIXELS, NULL, 0);
        tiff_add_page(&b, pixels, cases[i].bytes, fields, 2);
        assert_fails(tiff_parse(&tiff, (const uint8_t *)b.bytes.data, b.bytes.size), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), cases[i].part));
        buffer_finish(&b.bytes);
    }
}

/* The eight orientations of TIFF 6.0, and the numbers next to them: only in 1 the first row is the top and the first
 * column the left. */
static void one_orientation_is_read(void **state)
{
    (void)state;
    for (uint64_t orientation = 0; orientation <= 9; orientation++) {
        const struct tiff_field field = {.tag = TAG_ORIENTATION, .value = orientation, .type = SHORT};
        uint8_t pixels[PIXELS] = {7, 6, 5, 4, 3, 2, 1};
        struct bytes got = {0};
        conus_status status = tiff_read_page(&got, pixels, sizeof pixels, &field, 1);
        if (orientation == 1) {
            assert_ok(status);
            assert_memory_equal(got.data, pixels, PIXELS);
            bytes_finish(&got);
        } else {
            char part[40];
            snprintf(part, sizeof part, "Orientation: found %d, allowed", (int)orientation);
            assert_fails(status, CONUS_ERROR_UNSUPPORTED);
            assert_non_null(strstr(conus_message(), part));
        }
    }
}

/* Fields that change the meaning of pixels, each with the values 0 to 4. Values that TIFF 6.0 and SGI's fields of depth
 * give to plain pages of one number are read; all others are refused. */
static void fields_have_their_plain_values(void **state)
{
    (void)state;
    static const struct {
        uint16_t tag;
        bool is_read[5];
    } cases[] = {{254, {true, false, true}},      /* NewSubfileType: an image, a page */
                 {262, {[1] = true, [3] = true}}, /* PhotometricInterpretation: black is 0, a palette */
                 {266, {[1] = true}},             /* FillOrder */
                 {277, {[1] = true}},             /* SamplesPerPixel */
                 {284, {[1] = true, [2] = true}}, /* PlanarConfiguration: of one sample the same */
                 {32997, {[1] = true}},           /* ImageDepth */
                 {32998, {[1] = true}}};          /* TileDepth */
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (uint64_t value = 0; value < 5; value++) {
            const struct tiff_field field = {.tag = cases[i].tag, .value = value, .type = SHORT};
            uint8_t pixels[PIXELS] = {7, 6, 5, 4, 3, 2, 1};
            struct bytes got = {0};
            conus_status status = tiff_read_page(&got, pixels, sizeof pixels, &field, 1);
            assert_int_equal(status, cases[i].is_read[value] ? CONUS_OK : CONUS_ERROR_UNSUPPORTED);
            bytes_finish(&got);
        }
    }
}

/* Whole numbers of 8 to 64 bits and floats of 32 and 64 bits, the sizes of C's types. */
static void numbers_are_of_whole_types(void **state)
{
    (void)state;
    static const uint64_t sizes[] = {1, 4, 8, 12, 16, 24, 32, 64, 128};
    for (uint64_t format = 0; format <= 6; format++) {
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
            const uint64_t bits = sizes[i];
            const struct tiff_field fields[] = {{.tag = TAG_BITS, .value = bits}, {.tag = TAG_FORMAT, .value = format}};
            bool is_whole = bits == 8 || bits == 16 || bits == 32 || bits == 64;
            bool is_read = is_whole && (format == 1 || format == 2 || (format == 3 && bits >= 32));
            uint8_t pixels[PIXELS * 16] = {0};
            struct bytes got = {0};
            conus_status status = tiff_read_page(&got, pixels, PIXELS * bits / 8, fields, 2);
            assert_int_equal(status, is_read ? CONUS_OK : CONUS_ERROR_UNSUPPORTED);
            bytes_finish(&got);
        }
    }
}

/* Numbers of TIFF 6.0, its supplements and libtiff; 8 and 32946 are the same deflate. */
static void three_compressions_are_read(void **state)
{
    (void)state;
    static const uint64_t refused[] = {0, 2, 3, 4, 6, 7, 9, 32771, 32773, 32809, 34712, 34887, 34925, 50000};
    static const uint64_t deflate[] = {8, 32946};
    uint8_t pixels[PIXELS] = {1, 2, 3};
    uint8_t packed[64];
    uLongf length = sizeof packed;
    struct bytes got = {0};
    assert_int_equal(compress(packed, &length, pixels, PIXELS), Z_OK);
    for (size_t i = 0; i < 2; i++) {
        const struct tiff_field field = {.tag = TAG_COMPRESSION, .value = deflate[i]};
        assert_ok(tiff_read_page(&got, packed, length, &field, 1));
        assert_memory_equal(got.data, pixels, PIXELS);
        bytes_finish(&got);
    }
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        const struct tiff_field field = {.tag = TAG_COMPRESSION, .value = refused[i]};
        assert_fails(tiff_read_page(&got, packed, length, &field, 1), CONUS_ERROR_UNSUPPORTED);
        assert_non_null(strstr(conus_message(), "allowed are 1 (none), 5 (LZW) and 8 (deflate)"));
    }
}

TEST_GROUP(tiff_fields)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pages_must_be_alike),
        cmocka_unit_test(one_orientation_is_read),
        cmocka_unit_test(fields_have_their_plain_values),
        cmocka_unit_test(numbers_are_of_whole_types),
        cmocka_unit_test(three_compressions_are_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
