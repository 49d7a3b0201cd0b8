/* SPDX-License-Identifier: BSD-3-Clause */
/* Images, OpenEXR and PNG files, sRGB and comparison. */
#include "base/memory.h"
#include "conus/own.h"
#include "render/image/image.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double MATRIX[16] = {0.1, 1.0 / 3, -2, 0, 0, 1e-9, 3, 0, 7, 8, 9, 0, 25.5314207153, -1e6, 4, 1};

/* An image with every kind of value that images of a selection have; its height is no multiple of a chunk's lines. */
static conus_image *make_image(void)
{
    conus_image *image = NULL;
    struct image_channel *channel;
    assert_ok(image_create(&image, 5, 19));
    assert_ok(image_add_channel(image, "id", IMAGE_UINT, &channel));
    for (uint32_t i = 0; i < 95; i++) {
        channel->uints[i] = i % 3 ? UINT32_MAX - i : i;
    }
    assert_ok(image_add_channel(image, "Z", IMAGE_FLOAT, &channel));
    for (int i = 0; i < 95; i++) {
        channel->floats[i] = i % 7 == 0 ? NAN : i % 7 == 1 ? INFINITY : (float)exp(i - 40) * (i % 2 ? -1.0F : 1.0F);
    }
    assert_ok(image_add_channel(image, "A", IMAGE_FLOAT, &channel));
    channel->floats[94] = 0x1p-149F;
    assert_ok(image_add_text(image, "conus:space", "RAS mm"));
    assert_ok(image_add_text(image, "conus:atlas", "to be replaced"));
    assert_ok(image_add_text(image, "conus:atlas", "Hippocampe gauche, \xc3\xa9"));
    assert_ok(image_add_matrix(image, "conus:worldFromDevice", MATRIX));
    return image;
}

static void assert_same_pixels(const conus_image *a, const conus_image *b)
{
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_int_equal(a->channel_count, b->channel_count);
    for (size_t i = 0; i < a->channel_count; i++) {
        const struct image_channel *other = image_find(b, a->channels[i].name);
        assert_non_null(other);
        assert_int_equal(other->type, a->channels[i].type);
        assert_memory_equal(other->uints, a->channels[i].uints, (size_t)a->width * a->height * sizeof(uint32_t));
    }
}

static void exr_keeps_every_bit(void **state)
{
    (void)state;
    conus_image *image = make_image();
    conus_image *back = NULL;
    const char *path = test_scratch("bits.exr");
    assert_ok(conus_image_write(image, path));
    assert_ok(conus_image_load(&back, path));
    assert_same_pixels(image, back);
    assert_string_equal(conus_image_channel(back, 0), "A"); /* OpenEXR sorts them */
    assert_string_equal(image_find_attribute(back, "conus:atlas")->text, "Hippocampe gauche, \xc3\xa9");
    assert_memory_equal(image_find_attribute(back, "conus:worldFromDevice")->matrix, MATRIX, sizeof MATRIX);
    assert_null(image_find_attribute(back, "conus:none"));
    conus_image_destroy(back);
    conus_image_destroy(image);
}

static void accessors_know_types_and_ends(void **state)
{
    (void)state;
    conus_image *image = make_image();
    assert_int_equal(conus_image_width(image), 5);
    assert_int_equal(conus_image_height(image), 19);
    assert_non_null(conus_image_uints(image, "id"));
    assert_null(conus_image_floats(image, "id"));
    assert_non_null(conus_image_floats(image, "Z"));
    assert_null(conus_image_uints(image, "Z"));
    assert_null(conus_image_floats(image, "none"));
    assert_null(conus_image_channel(image, 3));
    assert_int_equal(conus_image_width(NULL), 0);
    assert_null(conus_image_channel(NULL, 0));
    assert_fails(image_add_channel(image, "Z", IMAGE_UINT, NULL), CONUS_ERROR_DATA);
    assert_fails(image_add_channel(image, "", IMAGE_UINT, NULL), CONUS_ERROR_UNSUPPORTED);
    conus_image_destroy(image);
    conus_image_destroy(NULL);
}

static void too_large_images_are_refused(void **state)
{
    (void)state;
    conus_image *image = NULL;
    assert_fails(image_create(&image, 0, 4), CONUS_ERROR_DATA);
    assert_fails(image_create(&image, 4, IMAGE_MAX_SIDE + 1), CONUS_ERROR_DATA);
    assert_fails(image_create_rgba(&image, IMAGE_MAX_SIDE, IMAGE_MAX_SIDE), CONUS_ERROR_MEMORY);
    assert_null(image);
}

/* IEC 61966-2-1, at its joint and at both ends; the 18 % grey of painters is byte 118. */
static void srgb_follows_its_closed_form(void **state)
{
    (void)state;
    assert_near(srgb_from_linear(0), 0, 0);
    assert_near(srgb_from_linear(1), 1, 1e-15);
    assert_near(srgb_from_linear(0.0031308), 12.92 * 0.0031308, 1e-15);
    assert_near(srgb_from_linear(0.18), 0.46135612950044164, 1e-12);
    for (int i = 0; i <= 255; i++) {
        assert_near(srgb_from_linear(linear_from_srgb(i / 255.0)), i / 255.0, 1e-7);
    }
}

static conus_image *one_row(size_t count)
{
    conus_image *image = NULL;
    assert_ok(image_create_rgba(&image, (uint32_t)count, 1));
    return image;
}

/* Opaque greys at and around every byte's value, and half-transparent ones: the bytes are those of the formula. */
static void png_rounds_to_the_nearest_byte(void **state)
{
    (void)state;
    uint64_t seed = 7;
    conus_image *image = one_row(4096);
    struct image_rgba rgba = image_rgba(image);
    for (int i = 0; i < 4096; i++) {
        double opacity = i % 2 ? 1 : 0.5;
        double value = test_random(&seed, -0.1, 1.1);
        for (int c = 0; c < 3; c++) {
            rgba.plane[c][i] = (float)(value * opacity);
        }
        rgba.plane[3][i] = (float)opacity;
    }
    const char *path = test_scratch("grey.png");
    conus_image *back = NULL;
    assert_ok(conus_image_write(image, path));
    assert_ok(conus_image_load(&back, path));
    struct image_rgba got = image_rgba(back);
    for (int i = 0; i < 4096; i++) {
        double opacity = (double)got.plane[3][i];
        double linear = fmin(fmax((double)rgba.plane[0][i] / (double)rgba.plane[3][i], 0), 1);
        double wanted = 255 * srgb_from_linear(linear);
        double byte = 255 * srgb_from_linear((double)got.plane[0][i] / opacity);
        assert_near(byte, wanted, 0.5 + 1e-4);
        assert_near(byte, round(byte), 1e-4);
        assert_near(opacity, i % 2 ? 1 : 128 / 255.0, 1e-7);
    }
    conus_image_destroy(back);
    conus_image_destroy(image);
}

/* The chunk pHYs: pixels per metre across and down, and the unit 1, metres. 300 / 0.0254 = 11811.02, 72 / 0.0254 =
 * 2834.65. Without a density there is no such chunk. */
static void png_has_its_density(void **state)
{
    (void)state;
    static const struct {
        double dpi;
        uint8_t chunk[9];
    } cases[] = {{300, {0, 0, 0x2e, 0x23, 0, 0, 0x2e, 0x23, 1}}, {72, {0, 0, 0x0b, 0x13, 0, 0, 0x0b, 0x13, 1}}};
    for (size_t i = 0; i < 3; i++) {
        struct bytes bytes = {0};
        conus_image *image = one_row(4);
        image->dpi = i < 2 ? cases[i].dpi : 0;
        assert_ok(image_format_png(&bytes, image));
        const uint8_t *found = memmem(bytes.data, bytes.size, "pHYs", 4);
        if (i < 2) {
            assert_non_null(found);
            assert_memory_equal(found + 4, cases[i].chunk, sizeof cases[i].chunk);
        } else {
            assert_null(found);
        }
        memory_free(bytes.data);
        conus_image_destroy(image);
    }
}

static void png_of_nothing_and_nonsense(void **state)
{
    (void)state;
    conus_image *image = one_row(4);
    struct image_rgba rgba = image_rgba(image);
    const float reds[] = {NAN, INFINITY, 0.5F, -INFINITY};
    const float opacities[] = {1, 1, 0, NAN};
    const float wanted[] = {0, 1, 0, 0};
    memcpy(rgba.plane[0], reds, sizeof reds);
    memcpy(rgba.plane[3], opacities, sizeof opacities);
    struct bytes bytes;
    conus_image *back = NULL;
    assert_ok(image_format_png(&bytes, image));
    assert_ok(image_parse_png(&back, bytes.data, bytes.size));
    assert_memory_equal(image_rgba(back).plane[0], wanted, sizeof wanted);
    assert_near(image_rgba(back).plane[3][3], 0, 0);
    conus_image_destroy(back);
    conus_image_destroy(image);
    bytes_finish(&bytes);
}

static void png_rgba_goes_out_as_it_is(void **state)
{
    (void)state;
    conus_image *image = make_image(); /* has no R, G, B */
    struct bytes bytes;
    assert_fails(image_format_png(&bytes, image), CONUS_ERROR_ARGUMENT);
    image->png_width = 10;
    image->png_height = 2;
    image->png_rgba = memory_raw(20, 4);
    for (int i = 0; i < 80; i++) {
        image->png_rgba[i] = i % 4 == 3 ? 255 : (uint8_t)(3 * i);
    }
    conus_image *back = NULL;
    assert_ok(image_format_png(&bytes, image));
    assert_ok(image_parse_png(&back, bytes.data, bytes.size));
    assert_int_equal(back->width, 10);
    assert_int_equal(back->height, 2);
    for (size_t i = 0; i < 80; i++) {
        double value = (double)image_rgba(back).plane[i % 4][i / 4];
        double byte = 255 * (i % 4 == 3 ? value : srgb_from_linear(value));
        assert_near(byte, image->png_rgba[i], 1e-4);
    }
    conus_image_destroy(back);
    conus_image_destroy(image);
    bytes_finish(&bytes);
}

static void unknown_endings_and_contents_are_named(void **state)
{
    (void)state;
    conus_image *image = make_image();
    const char *const bad[] = {"picture.jpg", "picture", "folder.exr/picture"};
    for (size_t i = 0; i < 3; i++) {
        assert_fails(conus_image_write(image, test_scratch(bad[i])), CONUS_ERROR_ARGUMENT);
        assert_non_null(strstr(conus_message(), ".exr, .png, .svg or .pdf"));
    }
    const char *path = test_scratch("no-image.png");
    conus_image *back = NULL;
    assert_ok(conus_write_file(path, "<html>", 6));
    assert_fails(conus_image_load(&back, path), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "neither OpenEXR nor PNG"));
    assert_fails(conus_image_load(&back, test_scratch("absent.exr")), CONUS_ERROR_IO);
    assert_fails(conus_image_load(&back, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_image_load(NULL, path), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_image_write(NULL, path), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_image_write(image, NULL), CONUS_ERROR_ARGUMENT);
    assert_null(back);
    conus_image_destroy(image);
}

/* The written file is the oracle. */
static void encoded_bytes_are_those_of_the_file(void **state)
{
    (void)state;
    static const char *const formats[] = {"exr", "png"};
    conus_image *image = NULL;
    const uint8_t *data = NULL;
    size_t size = 7;
    assert_ok(conus_image_from_bytes(&image, (const uint8_t[]){1, 2, 3, 255, 40, 50, 60, 128}, 2, 1));
    for (size_t i = 0; i < 2; i++) {
        char path[300];
        struct bytes file;
        snprintf(path, sizeof path, "%s.%s", test_scratch("encoded"), formats[i]);
        assert_ok(conus_image_write(image, path));
        assert_ok(file_read(&file, path, 1 << 20));
        assert_ok(conus_image_encode(&data, &size, image, formats[i]));
        assert_int_equal(size, file.size);
        assert_memory_equal(data, file.data, size);
        bytes_finish(&file);
    }
    const uint8_t *before = data;
    assert_fails(conus_image_encode(&data, &size, image, "jpg"), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "jpg"));
    assert_fails(conus_image_encode(&data, &size, image, NULL), CONUS_ERROR_ARGUMENT);
    assert_ptr_equal(data, before);
    conus_image_destroy(image);
}

static void comparison_finds_the_worst_pixel(void **state)
{
    (void)state;
    conus_image *a = make_image();
    conus_image *b = make_image();
    conus_image_difference difference;
    assert_ok(conus_image_compare(&difference, a, b, 0));
    assert_int_equal(difference.pixels, 95);
    assert_int_equal(difference.differing, 0);
    assert_near(difference.max_difference, 0, 0);
    assert_string_equal(difference.channel, "");
    image_find(b, "A")->floats[13] = 0.25F;
    image_find(b, "A")->floats[14] = -0.5F;
    assert_ok(conus_image_compare(&difference, a, b, 0.3));
    assert_int_equal(difference.differing, 1);
    assert_near(difference.max_difference, 0.5, 0);
    assert_near(difference.rms, sqrt((0.0625 + 0.25) / 95), 1e-12);
    assert_string_equal(difference.channel, "A");
    assert_int_equal(difference.x, 4);
    assert_int_equal(difference.y, 2);
    image_find(b, "id")->uints[3]++; /* an identifier has no tolerance */
    assert_ok(conus_image_compare(&difference, a, b, 1e9));
    assert_int_equal(difference.differing, 1);
    image_find(b, "Z")->floats[0] = 1; /* was NaN */
    assert_ok(conus_image_compare(&difference, a, b, 1e30));
    assert_true(isinf(difference.max_difference));
    assert_int_equal(difference.differing, 2);
    conus_image_destroy(a);
    conus_image_destroy(b);
}

static void assert_incomparable(const conus_image *a, const conus_image *b, double tolerance, const char *why)
{
    conus_image_difference difference;
    assert_fails(conus_image_compare(&difference, a, b, tolerance), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), why));
}

static void what_cannot_be_compared_is_named(void **state)
{
    (void)state;
    conus_image *a = make_image();
    conus_image *b = make_image();
    assert_ok(image_add_channel(b, "Y", IMAGE_FLOAT, NULL));
    assert_incomparable(a, b, 0, "channel Y is not in the first");
    assert_incomparable(b, a, 0, "channel Y is not in the second");
    assert_ok(image_add_channel(a, "Y", IMAGE_UINT, NULL));
    assert_incomparable(a, b, 0, "uint32 in one image and float in the other");
    assert_incomparable(a, a, NAN, "tolerance");
    conus_image_destroy(b);
    assert_ok(image_create(&b, 5, 18));
    assert_incomparable(a, b, 0, "5 x 18");
    conus_image_destroy(a);
    conus_image_destroy(b);
}

typedef conus_status (*parse_function)(conus_image **out, const uint8_t *data, size_t size);

static void check_prefixes(struct bytes *bytes, parse_function parse)
{
    for (size_t size = 0; size < bytes->size; size++) {
        uint8_t *exact = memory_raw(size, 1); /* so that a sanitizer notices one byte too many */
        memcpy(exact, bytes->data, size);
        conus_image *image = NULL;
        conus_status status = parse(&image, exact, size);
        memory_free(exact);
        if (status == CONUS_OK || !*conus_message()) {
            fail_msg("the first %zu of %zu bytes are read as an image", size, bytes->size);
        }
        assert_null(image);
    }
    bytes_finish(bytes);
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    conus_image *image = make_image();
    struct bytes bytes;
    assert_ok(image_format_exr(&bytes, image));
    check_prefixes(&bytes, image_parse_exr);
    conus_image_destroy(image);
    assert_ok(image_create_rgba(&image, 7, 5));
    assert_ok(image_format_png(&bytes, image));
    check_prefixes(&bytes, image_parse_png);
    conus_image_destroy(image);
}

static void put_chunk_head(uint8_t *out, uint32_t size, const char *name)
{
    for (int i = 0; i < 4; i++) {
        out[i] = (uint8_t)(size >> (24 - 8 * i));
        out[4 + i] = (uint8_t)name[i];
    }
}

/* A PNG of 41 bytes whose second chunk claims to be long: no memory is taken for bytes that are missing. libpng itself
 * takes 512 MiB for an sPLT of that length. The limit covers libpng's own state and zlib's. */
static void a_chunk_takes_no_more_memory_than_it_has(void **state)
{
    (void)state;
    static const char *const names[] = {"sPLT", "tEXt", "zTXt", "iTXt", "iCCP", "eXIf", "pCAL", "sCAL", "hIST",
                                        "gAMA", "cHRM", "bKGD", "tRNS", "PLTE", "IDAT", "abCd", "ABCD"};
    enum { HEAD = 33, ALL = 41, LIMIT = 1 << 18 };
    conus_image *image = one_row(4);
    conus_image *back = NULL;
    struct bytes bytes;
    assert_ok(image_format_png(&bytes, image));
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        for (uint32_t size = 1u << 20; size < 1u << 31; size += size - 1) {
            uint8_t short_file[ALL];
            memcpy(short_file, bytes.data, HEAD);
            put_chunk_head(short_file + HEAD, size, names[i]);
            test_limit_allocations(LIMIT);
            conus_status status = image_parse_png(&back, short_file, ALL);
            test_limit_allocations(0);
            assert_fails(status, CONUS_ERROR_DATA);
        }
    }
    assert_null(back);
    bytes_finish(&bytes);
    conus_image_destroy(image);
}

struct codec {
    conus_status (*format)(struct bytes *out, const conus_image *image);
    parse_function parse;
    const conus_image *image;
};

static conus_status round_trip(void *data)
{
    const struct codec *codec = data;
    struct bytes bytes = {0};
    conus_image *back = NULL;
    conus_status status = codec->format(&bytes, codec->image);
    status = status ? status : codec->parse(&back, bytes.data, bytes.size);
    conus_image_destroy(back);
    bytes_finish(&bytes);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_image *image = make_image();
    test_every_allocation(round_trip, &(struct codec){image_format_exr, image_parse_exr, image});
    conus_image_destroy(image);
    assert_ok(image_create_rgba(&image, 3, 3));
    test_every_allocation(round_trip, &(struct codec){image_format_png, image_parse_png, image});
    conus_image_destroy(image);
}

static void dump_channel(struct buffer *dump, const conus_image *image, const struct image_channel *channel)
{
    const uint8_t *bytes = (const uint8_t *)channel->uints;
    buffer_format(dump, "channel %s %s ", channel->name, channel->type == IMAGE_UINT ? "uint" : "float");
    for (size_t i = 0; i < sizeof(float) * image->width * image->height; i++) {
        buffer_format(dump, "%02x", bytes[i]);
    }
    buffer_text(dump, "\n");
}

/* Writes the image that conus read from `path` beside it, for the oracle. */
static void dump_image(const char *path, const char *dump_path)
{
    conus_image *image = NULL;
    struct buffer dump = {0};
    assert_ok(conus_image_load(&image, path));
    for (size_t i = 0; i < image->channel_count; i++) {
        dump_channel(&dump, image, &image->channels[i]);
    }
    for (size_t i = 0; i < image->attribute_count; i++) {
        const struct image_attribute *attribute = &image->attributes[i];
        buffer_format(&dump, attribute->is_matrix ? "matrix %s" : "text %s %s", attribute->name, attribute->text);
        for (int k = 0; attribute->is_matrix && k < 16; k++) {
            buffer_format(&dump, " %.17g", attribute->matrix[k]);
        }
        buffer_text(&dump, "\n");
    }
    assert_ok(buffer_status(&dump));
    assert_ok(conus_write_file(dump_path, dump.data, dump.size));
    buffer_finish(&dump);
    conus_image_destroy(image);
}

/* Starts the oracle with a command about the folder of scratch files; it prints the names of the files it makes. */
static FILE *start_oracle(const char *command)
{
    if (system("/usr/bin/python3 -c 'import OpenImageIO, numpy' 2>/dev/null")) {
        print_message("skipped: no OpenImageIO for /usr/bin/python3\n");
        skip();
    }
    char line[512];
    snprintf(line, sizeof line, "/usr/bin/python3 '%s/tests/oracles/image.py' %s $(dirname %s)", CONUS_SOURCE_DIR,
             command, test_scratch("any"));
    FILE *oracle = popen(line, "r");
    assert_non_null(oracle);
    return oracle;
}

static bool next_file(FILE *oracle, char *path, int size)
{
    if (!fgets(path, size, oracle)) {
        return false;
    }
    path[strcspn(path, "\n")] = '\0';
    return true;
}

static void what_cannot_be_read_is_unsupported(void **state)
{
    (void)state;
    char path[512];
    size_t count = 0;
    FILE *oracle = start_oracle("refuse");
    for (; next_file(oracle, path, sizeof path); count++) {
        conus_image *image = NULL;
        assert_fails(conus_image_load(&image, path), CONUS_ERROR_UNSUPPORTED);
        assert_null(image);
    }
    assert_int_equal(pclose(oracle), 0);
    assert_int_equal(count, 6);
}

/* OpenImageIO reads our files, and we read its files: all compressions, all colour types, data windows that begin
 * elsewhere than at 0. */
static void another_reader_sees_the_same(void **state)
{
    (void)state;
    FILE *oracle = start_oracle("make");
    char path[512];
    struct buffer compare = {0};
    const char *ours = test_scratch("ours.exr");
    conus_image *image = make_image();
    assert_ok(conus_image_write(image, ours));
    conus_image_destroy(image);
    dump_image(ours, test_scratch("ours.dump"));
    buffer_format(&compare, "/usr/bin/python3 '%s/tests/oracles/image.py' compare %s %s", CONUS_SOURCE_DIR, ours,
                  test_scratch("ours.dump"));
    size_t count = 0;
    for (; next_file(oracle, path, sizeof path); count++) {
        char dump[520];
        snprintf(dump, sizeof dump, "%s.dump", path);
        dump_image(path, dump);
        buffer_format(&compare, " %s %s", path, dump);
    }
    assert_int_equal(pclose(oracle), 0);
    assert_int_equal(count, 53);
    assert_int_equal(system(compare.data), 0);
    buffer_finish(&compare);
}

TEST_GROUP(image)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exr_keeps_every_bit),
        cmocka_unit_test(accessors_know_types_and_ends),
        cmocka_unit_test(too_large_images_are_refused),
        cmocka_unit_test(srgb_follows_its_closed_form),
        cmocka_unit_test(png_rounds_to_the_nearest_byte),
        cmocka_unit_test(png_has_its_density),
        cmocka_unit_test(png_of_nothing_and_nonsense),
        cmocka_unit_test(png_rgba_goes_out_as_it_is),
        cmocka_unit_test(unknown_endings_and_contents_are_named),
        cmocka_unit_test(encoded_bytes_are_those_of_the_file),
        cmocka_unit_test(comparison_finds_the_worst_pixel),
        cmocka_unit_test(what_cannot_be_compared_is_named),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(a_chunk_takes_no_more_memory_than_it_has),
        cmocka_unit_test(every_failing_allocation_is_survived),
        cmocka_unit_test(what_cannot_be_read_is_unsupported),
        cmocka_unit_test(another_reader_sees_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
