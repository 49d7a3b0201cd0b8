/* SPDX-License-Identifier: BSD-3-Clause */
/* Stacks of too many pages, and of too many bytes; tests/corpus/tiff/ has all else, and tests/oracles/compare_tiff.py
 * strips, tiles and compressions of other programs. */
#include "loaders/tiff/tiff.h"

#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "builders/tiff_builder.h"
#include "loaders/volumes/volume_file.h"
#include "test.h"

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
    assert_fails(tiff_parse(&tiff, (const uint8_t *)b.bytes.data, b.bytes.size), CONUS_ERROR_UNSUPPORTED);
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

TEST_GROUP(tiff)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pages_are_counted),
        cmocka_unit_test(memory_is_limited),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
