/* SPDX-License-Identifier: BSD-3-Clause */
/* Stacks of TIFF pages: reading, and the messages of refused ones. tests/oracles/compare_tiff.py has strips, tiles and
 * compressions of other programs. */
#include "loaders/tiff/tiff.h"

#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "builders/tiff_builder.h"
#include "label_list.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_values.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

#define PLACE ",resolution=10:20:40,orientation=asr"
enum { PIXELS = 12, SHORT = 3, ASCII = 2 };

static const char *placed(const char *path)
{
    static char text[400];
    snprintf(text, sizeof text, "%s" PLACE, path);
    return text;
}

/* The type's value of voxel v. */
static int64_t value_of(int bits, bool negative, size_t v)
{
    return (negative ? -1 : 1) * (int64_t)(v * (bits == 8 ? 3 : 1001));
}

static void append_value(struct tiff_builder *b, int bits, int format, int64_t value)
{
    if (format == TIFF_FLOAT) {
        append_float(&b->bytes, (double)value, b->big_endian);
    } else {
        append_ordered(&b->bytes, (uint64_t)value, (size_t)bits / 8, b->big_endian);
    }
}

/* Pages of 4 x 3 pixels each; numbers run on from page to page. */
static void build_stack(struct tiff_builder *b, int bits, int format, size_t pages)
{
    for (size_t k = 0; k < pages; k++) {
        struct tiff_builder pixels = {.big_endian = b->big_endian};
        const struct tiff_field fields[] = {{.tag = TAG_BITS, .value = (uint64_t)bits, .type = SHORT},
                                            {.tag = TAG_FORMAT, .value = (uint64_t)format, .type = SHORT}};
        for (size_t v = 0; v < PIXELS; v++) {
            append_value(&pixels, bits, format, value_of(bits, format == TIFF_SIGNED, k * PIXELS + v));
        }
        tiff_add_page(b, pixels.bytes.data, pixels.bytes.size, fields, 2);
        buffer_finish(&pixels.bytes);
    }
}

static void every_type_and_byte_order_is_read(void **state)
{
    (void)state;
    const struct {
        int bits, format;
        const char *datatype;
    } types[] = {{8, 1, "uint8"},   {8, 2, "int8"},   {16, 1, "uint16"}, {16, 2, "int16"},
                 {32, 1, "uint32"}, {32, 2, "int32"}, {32, 3, "float32"}};
    for (size_t i = 0; i < 4 * 7; i++) {
        struct tiff_builder b;
        struct volume_file file;
        struct notes notes = {0};
        float *values;
        bool negative = types[i / 4].format == TIFF_SIGNED;
        tiff_begin(&b, i & 1, i & 2);
        build_stack(&b, types[i / 4].bits, types[i / 4].format, 2);
        assert_ok(volume_file_open(&file, placed(write_bytes("stack.tif", &b.bytes)), 0, &notes));
        assert_int_equal(notes.count, 0);
        assert_string_equal(file.info.datatype, types[i / 4].datatype);
        assert_int_equal(file.info.dim[0], 4);
        assert_int_equal(file.info.dim[1], 3);
        assert_int_equal(file.info.dim[2], 2);
        assert_ok(volume_file_values(&values, &file, &notes));
        for (size_t v = 0; v < 2 * PIXELS; v++) {
            assert_near(values[v], (double)value_of(types[i / 4].bits, negative, v), 0);
        }
        memory_free(values);
        volume_file_finish(&file);
        buffer_finish(&b.bytes);
    }
}

/* "asr": pages (10 um) start in front and grow backwards, rows (20 um) start above, columns (40 um) on the right. */
static void the_corner_is_the_origin(void **state)
{
    (void)state;
    struct tiff_builder b;
    struct volume_file file;
    struct notes notes = {0};
    tiff_begin(&b, false, false);
    build_stack(&b, 8, TIFF_UNSIGNED, 2);
    assert_ok(volume_file_open(&file, placed(write_bytes("stack.tif", &b.bytes)), 0, &notes));
    const double wanted[16] = {-0.04, 0, 0, 0, 0, 0, -0.02, 0, 0, -0.01, 0, 0, -0.02, -0.005, -0.01, 1};
    for (int i = 0; i < 16; i++) {
        assert_near(file.info.world_from_voxel[i], wanted[i], 1e-15);
    }
    assert_string_equal(file.info.orientation, "LIP");
    volume_file_finish(&file);
    buffer_finish(&b.bytes);
}

/* Codes of 9 bits, the highest bit first. */
static size_t pack_codes(uint8_t *out, const unsigned *codes, size_t count)
{
    memset(out, 0, (9 * count + 7) / 8);
    for (size_t bit = 0; bit < 9 * count; bit++) {
        out[bit / 8] |= (uint8_t)((codes[bit / 9] >> (8 - bit % 9) & 1) << (7 - bit % 8));
    }
    return (9 * count + 7) / 8;
}

#define LZW(width, length)                                                                                             \
    {.tag = TAG_COMPRESSION, .value = 5}, {.tag = TAG_WIDTH, .value = (width)},                                        \
    {                                                                                                                  \
        .tag = TAG_LENGTH, .value = (length)                                                                           \
    }

/* The example of TIFF 6.0, section 13: 7 7 7 8 8 7 7 6 6 are the codes 256 7 258 8 8 258 6 6 257. */
static void lzw_is_that_of_the_specification(void **state)
{
    (void)state;
    static const unsigned codes[] = {256, 7, 258, 8, 8, 258, 6, 6, 257};
    static const uint8_t wanted[] = {7, 7, 7, 8, 8, 7, 7, 6, 6};
    const struct tiff_field fields[] = {LZW(3, 3)};
    uint8_t packed[16];
    struct bytes got = {0};
    assert_ok(tiff_read_page(&got, packed, pack_codes(packed, codes, 9), fields, 3));
    assert_int_equal(got.size, 9);
    assert_memory_equal(got.data, wanted, 9);
    bytes_finish(&got);
    assert_ok(tiff_read_page(&got, packed, pack_codes(packed, codes, 8), fields, 3)); /* some leave out the end */
    bytes_finish(&got);
}

static void damaged_lzw_is_refused(void **state)
{
    (void)state;
    static const struct {
        unsigned codes[6];
        size_t count;
    } cases[] = {
        {{7, 7, 7, 257}, 4},         /* no clear at the beginning */
        {{256, 7, 8, 9, 9, 257}, 6}, /* more than 3 bytes */
        {{256, 7, 8, 257}, 4},       /* fewer */
        {{256, 258, 8, 257}, 4},     /* a code that is none yet */
        {{256, 7, 260, 257}, 4},     /* likewise */
        {{256, 7, 257, 8, 8}, 5},    /* ends early */
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct tiff_field fields[] = {LZW(3, 1)};
        uint8_t packed[16];
        struct bytes got = {0};
        size_t size = pack_codes(packed, cases[i].codes, cases[i].count);
        assert_fails(tiff_read_page(&got, packed, size, fields, 3), CONUS_ERROR_DATA);
        assert_string_equal(conus_message(), "page 0: strip 0: damaged, or not as long as its pixels");
    }
}

static void deflate_holds_what_the_page_needs(void **state)
{
    (void)state;
    const struct tiff_field fields[] = {{.tag = TAG_COMPRESSION, .value = 8}};
    for (size_t size = PIXELS - 1; size <= PIXELS + 1; size++) {
        uint8_t pixels[PIXELS + 1] = {1, 2, 3};
        uint8_t packed[64];
        uLongf length = sizeof packed;
        struct bytes got = {0};
        assert_int_equal(compress(packed, &length, pixels, size), Z_OK);
        conus_status status = tiff_read_page(&got, packed, length, fields, 1);
        assert_fails(status, size == PIXELS ? CONUS_OK : CONUS_ERROR_DATA);
        if (!status) {
            assert_memory_equal(got.data, pixels, PIXELS);
            bytes_finish(&got);
            packed[length - 1] ^= 1; /* the checksum */
            assert_fails(tiff_read_page(&got, packed, length, fields, 1), CONUS_ERROR_DATA);
        }
    }
}

static void differences_are_undone_row_by_row(void **state)
{
    (void)state;
    const struct tiff_field fields[] = {{.tag = TAG_COMPRESSION, .value = 8}, {.tag = TAG_PREDICTOR, .value = 2}};
    static const uint8_t differences[PIXELS] = {1, 1, 1, 1, 250, 10, 0, 255, 9, 0, 0, 0};
    static const uint8_t wanted[PIXELS] = {1, 2, 3, 4, 250, 4, 4, 3, 9, 9, 9, 9};
    uint8_t packed[64];
    uLongf length = sizeof packed;
    struct bytes got = {0};
    assert_int_equal(compress(packed, &length, differences, PIXELS), Z_OK);
    assert_ok(tiff_read_page(&got, packed, length, fields, 2));
    assert_memory_equal(got.data, wanted, PIXELS);
    bytes_finish(&got);
}

static void assert_refused(const struct tiff_builder *b, conus_status status, const char *part)
{
    struct tiff tiff;
    assert_fails(tiff_parse(&tiff, (const uint8_t *)b->bytes.data, b->bytes.size), status);
    if (!strstr(conus_message(), part) || strchr(conus_message(), '\n')) {
        fail_msg("\"%s\" does not say \"%s\"", conus_message(), part);
    }
}

static void bad_fields_are_named(void **state)
{
    (void)state;
    static const struct {
        struct tiff_field field;
        const char *part;
        bool unsupported;
    } cases[] = {
        {{.tag = TAG_WIDTH, .value = 0}, "page 0: ImageWidth: found 0, allowed are 1 to 2147483647", false},
        {{.tag = TAG_WIDTH, .missing = true}, "ImageWidth: is missing", false},
        {{.tag = TAG_LENGTH, .value = 0x80000000}, "ImageLength: found 2147483648", false},
        {{.tag = TAG_LENGTH, .missing = true}, "ImageLength: is missing", false},
        {{.tag = TAG_WIDTH, .value = 4, .twice = true}, "ImageWidth: is there twice", false},
        {{.tag = TAG_WIDTH, .value = 0xfffffff0, .count = 2}, "ImageWidth: 2 values at byte 4294967280", false},
        {{.tag = TAG_WIDTH, .value = 0, .count = 2}, "ImageWidth: found 2 numbers, one is needed", false},
        {{.tag = TAG_WIDTH, .value = 4, .type = 5}, "ImageWidth: found 1 values of type 5, a whole number", false},
        {{.tag = TAG_WIDTH, .value = 4, .count = 0xffffffff},
         "ImageWidth: 4294967295 values at byte 4, the file has",
         false},
        {{.tag = TAG_BITS, .value = 12}, "BitsPerSample: found 12 of SampleFormat 1", true},
        {{.tag = TAG_BITS, .missing = true}, "BitsPerSample: found 1 of", true},
        {{.tag = TAG_FORMAT, .value = 4}, "BitsPerSample: found 8 of SampleFormat 4", true},
        {{.tag = TAG_FORMAT, .value = 3}, "BitsPerSample: found 8 of SampleFormat 3", true},
        {{.tag = TAG_COMPRESSION, .value = 7}, "Compression: found 7, allowed are 1 (none), 5 (LZW)", true},
        {{.tag = TAG_PREDICTOR, .value = 2}, "Predictor: found 2, allowed are 1 and", true},
        {{.tag = TAG_PHOTOMETRIC, .value = 2}, "PhotometricInterpretation: found 2, allowed is 1", true},
        {{.tag = TAG_SAMPLES, .value = 3},
         "SamplesPerPixel: found 3, allowed is 1: one number a pixel, no colours",
         true},
        {{.tag = TAG_SUBFILE, .value = 1}, "NewSubfileType: found 1", true},
        {{.tag = TAG_ORIENTATION, .value = 3}, "Orientation: found 3", true},
        {{.tag = TAG_PLANAR, .value = 3}, "PlanarConfiguration: found 3", true},
        {{.tag = TAG_DEPTH, .value = 2}, "ImageDepth: found 2", true},
        {{.tag = TAG_ROWS, .value = 0}, "RowsPerStrip: found 0", false},
        {{.tag = TAG_ROWS, .value = 1}, "StripOffsets: found 1 numbers, the page has 3 strips", false},
        {{.tag = TAG_OFFSETS, .missing = true}, "StripOffsets: found 0 numbers, the page has 1 strips", false},
        {{.tag = TAG_COUNTS, .missing = true}, "StripByteCounts: found 0 numbers", false},
        {{.tag = TAG_COUNTS, .value = 11}, "strip 0: 11 bytes, its 4 x 3 pixels of 8 bits are 12", false},
        {{.tag = TAG_COUNTS, .value = 13}, "strip 0: 13 bytes, its 4 x 3", false},
        {{.tag = TAG_COUNTS, .value = 0}, "strip 0: 0 bytes at byte", false},
        {{.tag = TAG_COUNTS, .value = 0xffffffff}, "strip 0: 4294967295 bytes at byte", false},
        {{.tag = TAG_OFFSETS, .value = 0}, "strip 0: 12 bytes at byte 0", false},
        {{.tag = TAG_OFFSETS, .value = 0xfffffff0}, "strip 0: 12 bytes at byte 4294967280, the file has", false},
        {{.tag = TAG_TILE_WIDTH, .value = 16}, "StripOffsets: the page has tiles as well", false},
        {{.tag = TAG_DESCRIPTION, .value = 0, .type = SHORT},
         "ImageDescription: found 1 values of type 3, a text",
         false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct tiff_builder b;
        uint8_t pixels[PIXELS] = {0};
        tiff_begin(&b, i & 1, false);
        tiff_add_page(&b, pixels, sizeof pixels, &cases[i].field, 1);
        assert_refused(&b, cases[i].unsupported ? CONUS_ERROR_UNSUPPORTED : CONUS_ERROR_DATA, cases[i].part);
        buffer_finish(&b.bytes);
    }
}

/* Sizes that no file of this length can hold are refused before memory is allocated. */
static void sizes_follow_from_the_file(void **state)
{
    (void)state;
    static const struct {
        struct tiff_field fields[7];
        const char *part;
    } cases[] = {
        {{{.tag = TAG_WIDTH, .value = INT32_MAX}, {.tag = TAG_LENGTH, .value = INT32_MAX}},
         "ImageWidth: 2147483647 x 2147483647 pixels, more than any file can hold"},
        {{{.tag = TAG_WIDTH, .value = 100000}, {.tag = TAG_LENGTH, .value = 100000}},
         "page 0: strip 0: 12 bytes, its 100000 x 100000 pixels of 8 bits are 10000000000"},
        {{{.tag = TAG_WIDTH, .value = 10000}, {.tag = TAG_COMPRESSION, .value = 8}},
         "are 30000 unpacked, which so few cannot hold"},
        {{{.tag = TAG_WIDTH, .value = 20000}, {.tag = TAG_COMPRESSION, .value = 5}},
         "are 60000 unpacked, which so few cannot hold"},
        {{{.tag = TAG_OFFSETS, .missing = true},
          {.tag = TAG_COUNTS, .missing = true},
          {.tag = TAG_TILE_WIDTH, .value = 65536},
          {.tag = TAG_TILE_LENGTH, .value = 65536},
          {.tag = TAG_TILE_OFFSETS, .value = 8},
          {.tag = TAG_TILE_COUNTS, .value = 12}},
         "TileWidth: 65536 x 65536 pixels of 8 bits, allowed are 268435456 bytes a tile"},
        {{{.tag = TAG_OFFSETS, .missing = true},
          {.tag = TAG_COUNTS, .missing = true},
          {.tag = TAG_TILE_WIDTH, .value = 16},
          {.tag = TAG_TILE_OFFSETS, .value = 8},
          {.tag = TAG_TILE_COUNTS, .value = 12}},
         "TileLength: is missing"},
        {{{.tag = TAG_OFFSETS, .missing = true}, /* of two pages twice 2^28 bytes, for 24 */
          {.tag = TAG_COUNTS, .missing = true},
          {.tag = TAG_TILE_WIDTH, .value = 16384},
          {.tag = TAG_TILE_LENGTH, .value = 16384},
          {.tag = TAG_TILE_OFFSETS, .value = 8},
          {.tag = TAG_TILE_COUNTS, .value = 12},
          {.tag = TAG_COMPRESSION, .value = 8}},
         "TileWidth: tiles of 16384 x 16384 pixels, far larger than pages of 4 x 3"},
    };
    const bool unsupported[] = {false, false, false, false, true, false, false};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct tiff_builder b;
        uint8_t pixels[PIXELS] = {0};
        size_t count = 0;
        while (count < 7 && cases[i].fields[count].tag) {
            count++;
        }
        tiff_begin(&b, false, false);
        tiff_add_page(&b, pixels, sizeof pixels, cases[i].fields, count);
        if (count == 7) {
            tiff_add_page(&b, pixels, sizeof pixels, cases[i].fields, count);
        }
        assert_refused(&b, unsupported[i] ? CONUS_ERROR_UNSUPPORTED : CONUS_ERROR_DATA, cases[i].part);
        buffer_finish(&b.bytes);
    }
}

/* Two pages whose strips are each almost the whole file. */
static void strips_cannot_overlap_without_end(void **state)
{
    (void)state;
    uint8_t pixels[400] = {0};
    struct tiff_builder b;
    const struct tiff_field fields[] = {{.tag = TAG_COMPRESSION, .value = 8},
                                        {.tag = TAG_OFFSETS, .value = 8},
                                        {.tag = TAG_COUNTS, .value = sizeof pixels}};
    tiff_begin(&b, false, false);
    tiff_add_page(&b, pixels, sizeof pixels, fields, 3);
    tiff_add_page(&b, pixels, 0, fields, 3);
    assert_refused(&b, CONUS_ERROR_DATA, "page 1: StripByteCounts: those up to here have more bytes together");
    buffer_finish(&b.bytes);
}

static void chains_of_directories_end(void **state)
{
    (void)state;
    uint8_t pixels[PIXELS] = {0};
    for (size_t before = 0; before < 9; before++) { /* a circle of one or four, behind none to eight others */
        struct tiff_builder b;
        size_t back = 0;
        tiff_begin(&b, before & 1, before & 2);
        for (size_t i = 0; i <= before + (before & 1 ? 3 : 0); i++) {
            tiff_add_page(&b, pixels, sizeof pixels, NULL, 0);
            back = i == before ? b.directory : back;
        }
        tiff_link(&b, back);
        assert_refused(&b, CONUS_ERROR_DATA, "follows on itself");
        buffer_finish(&b.bytes);
    }
    struct tiff_builder b;
    tiff_begin(&b, false, false);
    for (size_t i = 0; i <= TIFF_PAGE_LIMIT; i++) {
        tiff_add_page(&b, pixels, sizeof pixels, NULL, 0);
    }
    assert_refused(&b, CONUS_ERROR_UNSUPPORTED, "directory: more than 65536 pages");
    buffer_finish(&b.bytes);
}

static void directories_lie_in_the_file(void **state)
{
    (void)state;
    uint8_t pixels[PIXELS] = {0};
    struct tiff_builder b;
    tiff_begin(&b, false, true);
    assert_refused(&b, CONUS_ERROR_DATA, "header: there is no directory");
    tiff_link(&b, UINT64_MAX);
    assert_refused(&b, CONUS_ERROR_DATA, "page 0: directory: 0 entries at byte 18446744073709551615");
    tiff_add_page(&b, pixels, sizeof pixels, NULL, 0);
    tiff_put(&b, b.directory, UINT64_MAX / 20 + 2); /* their size in bytes would overflow */
    assert_refused(&b, CONUS_ERROR_DATA, "directory: 922337203685477582 entries at byte");
    buffer_finish(&b.bytes);
    tiff_begin(&b, false, true);
    b.bytes.data[4] = 4;
    assert_refused(&b, CONUS_ERROR_DATA, "header: found offsets of 4 bytes, BigTIFF has 8");
    buffer_finish(&b.bytes);
}

/* A file of one directory with this description and `pages` pages of pixels; all pixels of page k are k. */
static void build_imagej(struct tiff_builder *b, const char *text, size_t pages)
{
    uint8_t pixels[8 * PIXELS];
    tiff_begin(b, true, false);
    buffer_text(&b->bytes, text);
    for (size_t i = 0; i < pages * PIXELS; i++) {
        pixels[i] = (uint8_t)(i / PIXELS);
    }
    const struct tiff_field fields[] = {{.tag = TAG_DESCRIPTION, .value = 8, .type = ASCII, .count = strlen(text)},
                                        {.tag = TAG_COUNTS, .value = PIXELS}};
    tiff_add_page(b, pixels, pages * PIXELS, fields, 2);
}

static void imagej_keeps_pages_behind_one_directory(void **state)
{
    (void)state;
    struct tiff_builder b;
    struct tiff tiff;
    struct bytes got = {0};
    build_imagej(&b, "ImageJ=1.53t\nimages=5\nslices=5\n", 5);
    assert_ok(tiff_parse(&tiff, (const uint8_t *)b.bytes.data, b.bytes.size));
    assert_int_equal(tiff.depth, 5);
    assert_ok(tiff_unpack(&got, &tiff));
    assert_int_equal(got.size, 5 * PIXELS);
    assert_int_equal(got.data[4 * PIXELS], 4);
    bytes_finish(&got);
    tiff_finish(&tiff);
    buffer_finish(&b.bytes);
    static const struct {
        const char *text, *part;
        conus_status status;
    } cases[] = {
        {"ImageJ=1.53t\nimages=50\nslices=50\n", "ImageJ says images=50, the file has 1 pages and too few bytes",
         CONUS_ERROR_DATA},
        {"ImageJ=1.53t\nimages=0\n", "ImageDescription: images: a whole number above 0 is needed", CONUS_ERROR_DATA},
        {"ImageJ=1.53t\nimages=99999999999\n", "images: a whole number above 0", CONUS_ERROR_DATA},
        {"ImageJ=1.53t\nimages=4\nslices=2\nchannels=2\n", "found 2 slices, 2 channels and 1 frames",
         CONUS_ERROR_UNSUPPORTED},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        build_imagej(&b, cases[i].text, 5);
        assert_refused(&b, cases[i].status, cases[i].part);
        buffer_finish(&b.bytes);
    }
}

/* Pages that are packed. */
static void build_packed(struct tiff_builder *b, bool big)
{
    static const unsigned codes[] = {256, 7, 258, 8, 8, 258, 6, 6, 257};
    const struct tiff_field lzw[] = {LZW(3, 3)};
    const struct tiff_field deflate[] = {
        {.tag = TAG_COMPRESSION, .value = 8}, {.tag = TAG_WIDTH, .value = 3}, {.tag = TAG_LENGTH, .value = 3}};
    uint8_t pixels[9] = {1, 1, 1, 2, 2, 2};
    uint8_t packed[64];
    uLongf length = sizeof packed;
    tiff_begin(b, false, big);
    tiff_add_page(b, packed, pack_codes(packed, codes, 9), lzw, 3);
    assert_int_equal(compress(packed, &length, pixels, sizeof pixels), Z_OK);
    tiff_add_page(b, packed, length, deflate, 3);
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    for (int big = 0; big < 2; big++) {
        struct tiff_builder b;
        build_packed(&b, big);
        for (size_t size = 0; size < b.bytes.size; size++) {
            const struct buffer prefix = {.data = b.bytes.data, .size = size};
            struct volume_file file;
            struct notes notes = {0};
            assert_fails(volume_file_open(&file, placed(write_bytes("prefix.tif", &prefix)), 0, &notes),
                         size < 4 ? CONUS_ERROR_ARGUMENT : CONUS_ERROR_DATA); /* no TIFF yet: no place for it */
        }
        buffer_finish(&b.bytes);
    }
}

static conus_status open_and_decode(void *path)
{
    struct volume_file file = {0};
    struct notes notes = {0};
    uint32_t *labels = NULL;
    conus_status status = volume_file_open(&file, path, 0, &notes);
    status = status ? status : label_list_read(&labels, &file);
    memory_free(labels);
    notes_finish(&notes);
    volume_file_finish(&file);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct tiff_builder b;
    build_packed(&b, false);
    static const char metadata[] = "{\"orientation\": \"asr\", \"resolution\": [1, 1, 1], \"shape\": [2, 3, 3]}";
    const struct buffer text = {.data = (char *)metadata, .size = sizeof metadata - 1};
    write_bytes("metadata.json", &text);
    test_every_allocation(open_and_decode, (void *)write_bytes("packed.tif", &b.bytes));
    remove(test_scratch("metadata.json"));
    buffer_finish(&b.bytes);
}

static void memory_is_limited(void **state)
{
    (void)state;
    enum { SIDE = 2048 };
    const struct tiff_field fields[] = {
        {.tag = TAG_COMPRESSION, .value = 8}, {.tag = TAG_WIDTH, .value = SIDE}, {.tag = TAG_LENGTH, .value = SIDE}};
    uint8_t *zeros = memory_zeroed(SIDE, SIDE);
    uint8_t packed[1 << 16];
    uLongf length = sizeof packed;
    struct tiff_builder b;
    struct volume_file file;
    struct notes notes = {0};
    assert_int_equal(compress(packed, &length, zeros, SIDE * SIDE), Z_OK);
    tiff_begin(&b, false, false);
    tiff_add_page(&b, packed, length, fields, 3);
    const char *path = placed(write_bytes("large.tif", &b.bytes));
    test_limit_allocations(1 << 20);
    assert_fails(volume_file_open(&file, path, 1 << 20, &notes), CONUS_ERROR_MEMORY);
    test_limit_allocations(0);
    assert_non_null(strstr(conus_message(), "take 4194304 bytes unpacked, allowed are 1048576 (--max-memory)"));
    assert_ok(volume_file_open(&file, path, 1 << 23, &notes));
    volume_file_finish(&file);
    memory_free(zeros);
    buffer_finish(&b.bytes);
}

TEST_GROUP(tiff)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_type_and_byte_order_is_read),
        cmocka_unit_test(the_corner_is_the_origin),
        cmocka_unit_test(lzw_is_that_of_the_specification),
        cmocka_unit_test(damaged_lzw_is_refused),
        cmocka_unit_test(deflate_holds_what_the_page_needs),
        cmocka_unit_test(differences_are_undone_row_by_row),
        cmocka_unit_test(bad_fields_are_named),
        cmocka_unit_test(sizes_follow_from_the_file),
        cmocka_unit_test(strips_cannot_overlap_without_end),
        cmocka_unit_test(chains_of_directories_end),
        cmocka_unit_test(directories_lie_in_the_file),
        cmocka_unit_test(imagej_keeps_pages_behind_one_directory),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(every_failing_allocation),
        cmocka_unit_test(memory_is_limited),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
