/* SPDX-License-Identifier: BSD-3-Clause */
/* Stacks of too many pages, and of too many bytes; tests/corpus/tiff/ has all else, and tests/oracles/compare_tiff.py
 * strips, tiles and compressions of other programs. */
#include "loaders/tiff/tiff.h"

#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "builders/tiff_builder.h"
#include "loaders/volumes/volumes.h"
#include "test.h"
#include "volume_on_job.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

static void pages_are_counted(void **state)
{
    (void)state;
    enum { PIXELS = 12 };
    uint8_t pixels[PIXELS] = {0};
    struct tiff_builder b;
    struct tiff tiff;
    tiff_begin(&b);
    for (size_t i = 0; i <= TIFF_PAGE_LIMIT; i++) {
        tiff_add_page(&b, pixels, sizeof pixels, NULL, 0);
    }
    struct job job = {0};
    tiff_parse(&job, &tiff, (const uint8_t *)b.bytes.data, b.bytes.size);
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_UNSUPPORTED);
    assert_non_null(strstr(conus_message(), "directory: more than 65536 pages"));
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
    char path[300];
    assert_int_equal(compress(packed, &length, zeros, SIDE * SIDE), Z_OK);
    tiff_begin(&b);
    tiff_add_page(&b, packed, length, fields, 3);
    snprintf(path, sizeof path, "%s,resolution=10,orientation=asr", write_bytes("large.tif", &b.bytes));
    test_limit_allocations(1 << 20);
    assert_fails(volume_file_open(&file, path, 1 << 20, &notes), CONUS_ERROR_MEMORY);
    test_limit_allocations(0);
    assert_non_null(strstr(conus_message(), "take 4194304 bytes unpacked, allowed are 1048576 (--max-memory)"));
    assert_ok(volume_file_open(&file, path, 1 << 23, &notes));
    volume_file_finish(&file);
    memory_free(zeros);
    buffer_finish(&b.bytes);
}

/* Pages enough for several threads; of those that are damaged the first one is named, whichever was tried first. */
static void pages_are_unpacked_by_threads(void **state)
{
    (void)state;
    enum { SIDE = 512, BYTES = SIDE * SIDE, PAGES = 24 };
    const struct tiff_field fields[] = {
        {.tag = TAG_COMPRESSION, .value = 8}, {.tag = TAG_WIDTH, .value = SIDE}, {.tag = TAG_LENGTH, .value = SIDE}};
    uint8_t *pixels = memory_zeroed(PAGES, BYTES);
    size_t middles[PAGES]; /* of the packed pages */
    struct tiff_builder b;
    struct tiff tiff;
    struct job job = {0};
    uint8_t *unpacked = memory_zeroed(PAGES, BYTES);
    assert_non_null(pixels);
    tiff_begin(&b);
    for (size_t page = 0; page < PAGES; page++) {
        static uint8_t packed[BYTES + BYTES / 8];
        uLongf length = sizeof packed;
        for (size_t i = 0; i < BYTES; i++) {
            pixels[page * BYTES + i] = (uint8_t)(i * i / 7 + page * (i % 5));
        }
        assert_int_equal(compress(packed, &length, pixels + page * BYTES, BYTES), Z_OK);
        size_t before = b.bytes.size;
        tiff_add_page(&b, packed, length, fields, 3);
        middles[page] = before + (b.bytes.size - before) / 2;
    }
    uint8_t *data = (uint8_t *)b.bytes.data;
    tiff_parse(&job, &tiff, data, b.bytes.size);
    tiff_unpack(&job, unpacked, &tiff, 0, PAGES);
    assert_memory_equal(unpacked, pixels, PAGES * BYTES);
    memset(unpacked, 0, BYTES);
    tiff_unpack(&job, unpacked, &tiff, PAGES - 2, 1);
    assert_memory_equal(unpacked, pixels + (PAGES - 2) * BYTES, BYTES);
    for (size_t page = PAGES; page-- > 0; page -= page < 7 ? page : 7) {
        char expected[96];
        struct job other = {0};
        memset(data + middles[page], 0xff, 64);
        snprintf(expected, sizeof expected, "page %zu: strip 0: damaged, or not as long as its pixels", page);
        tiff_unpack(&other, unpacked, &tiff, 0, PAGES);
        assert_fails(job_close(&other, NULL, NULL), CONUS_ERROR_DATA);
        assert_string_equal(conus_message(), expected);
    }
    assert_ok(job_close(&job, NULL, NULL));
    memory_free(unpacked);
    memory_free(pixels);
    buffer_finish(&b.bytes);
}

TEST_GROUP(tiff)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pages_are_counted),
        cmocka_unit_test(memory_is_limited),
        cmocka_unit_test(pages_are_unpacked_by_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
