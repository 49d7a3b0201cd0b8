/* SPDX-License-Identifier: BSD-3-Clause */
/* Metadata of Zarr arrays and of OME: what is read, and what is refused with which words. Chunks of other writers:
 * tests/oracles/compare_zarr.py. */
#include "loaders/zarr/zarr.h"

#include "base/memory.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/zarr/ome.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

#define HEAD "{\"zarr_format\":3,\"node_type\":\"array\",\"attributes\":{},"
#define SHAPE "\"shape\":[2,3,4],"
#define TYPE "\"data_type\":\"uint16\","
#define GRID "\"chunk_grid\":{\"name\":\"regular\",\"configuration\":{\"chunk_shape\":[2,3,4]}},"
#define KEYS "\"chunk_key_encoding\":{\"name\":\"default\"},"
#define FILL "\"fill_value\":7,"
#define BYTES "{\"name\":\"bytes\",\"configuration\":{\"endian\":\"little\"}}"
#define CODECS "\"codecs\":[" BYTES "]}"
#define WHOLE HEAD SHAPE TYPE GRID KEYS FILL CODECS
#define SHARD(chunk, index)                                                                                            \
    HEAD SHAPE TYPE GRID KEYS FILL                                                                                     \
        "\"codecs\":[{\"name\":\"sharding_indexed\",\"configuration\":{\"chunk_shape\":" chunk ",\"codecs\":[" BYTES   \
        "],\"index_codecs\":[" index "]}}]}"
#define GROUP                                                                                                          \
    "{\"attributes\":{\"ome\":{\"multiscales\":[{\"axes\":[{\"unit\":\"micrometer\"},{\"unit\":\"micrometer\"},{"      \
    "\"unit\":\"micrometer\"}],\"datasets\":[{\"path\":\"0\",\"coordinateTransformations\":[{\"type\":\"scale\","      \
    "\"scale\":[25,20,10]},{\"type\":\"translation\",\"translation\":[1,2,3]}]}]}]}}}"

static void an_array_is_taken(void **state)
{
    (void)state;
    struct zarr_array array;
    assert_ok(zarr_array_parse(&array, text_from(WHOLE)));
    assert_int_equal(array.rank, 3);
    assert_int_equal(array.shape[2], 4);
    assert_int_equal(array.chunk_bytes, 48);
    assert_int_equal(array.fill[0] + array.fill[1], 7);
    assert_ok(zarr_array_parse(&array, text_from(SHARD("[1,3,2]", BYTES ",\"crc32c\""))));
    assert_true(array.sharded);
    assert_int_equal(array.chunk_bytes, 12);
}

static void bad_metadata_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"[]", "zarr_format: no array"},
        {"{\"zarr_format\":3,\"node_type\":\"group\"}", "zarr_format: no array"},
        {HEAD "\"shape\":[2,3]}", "shape: found 2 axes"},
        {HEAD "\"shape\":[2,3,0]}", "shape: 3 whole numbers"},
        {HEAD "\"shape\":[2,3,2147483648]}", "shape: 3 whole numbers"},
        {HEAD SHAPE "\"data_type\":\"r16\"}", "data_type: found \"r16\""},
        {HEAD SHAPE TYPE "\"chunk_grid\":{\"name\":\"rectangular\"}}", "chunk_grid: found \"rectangular\""},
        {HEAD SHAPE TYPE GRID "\"chunk_key_encoding\":{\"name\":\"x\"}}", "chunk_key_encoding: found \"x\""},
        {HEAD SHAPE TYPE GRID KEYS "\"codecs\":[]}", "codecs: bytes or sharding_indexed is needed"},
        {HEAD SHAPE TYPE GRID KEYS "\"codecs\":[\"bytes\"]}", "endian: little or big"},
        {HEAD SHAPE TYPE GRID KEYS "\"codecs\":[" BYTES ",\"lz4\"]}", "codecs: found \"lz4\""},
        {HEAD SHAPE TYPE GRID KEYS "\"codecs\":[" BYTES ",\"zstd\",\"gzip\"]}", "a second compression, gzip"},
        {HEAD SHAPE TYPE GRID KEYS "\"codecs\":[{\"name\":\"transpose\",\"configuration\":{\"order\":[0,0,1]}}]}",
         "order: each of the 3 axes is needed once"},
        {HEAD SHAPE TYPE GRID KEYS CODECS, "fill_value: a number"},
        {HEAD SHAPE TYPE GRID KEYS "\"fill_value\":65536," CODECS, "fill_value: a number"},
        {HEAD SHAPE TYPE GRID KEYS "\"fill_value\":-1," CODECS, "fill_value: a number"},
        {HEAD "\"more\":{}," SHAPE TYPE GRID KEYS FILL CODECS, "more: an extension"},
        {HEAD "\"storage_transformers\":[1]," SHAPE TYPE GRID KEYS FILL CODECS, "storage_transformers: an extension"},
        {SHARD("[2,2,4]", BYTES), "chunk_shape: 2 does not divide the 3"},
        {SHARD("[1,3,2]", BYTES ",\"zstd\""), "index_codecs: allowed are bytes and crc32c"},
        {HEAD SHAPE TYPE
         "\"chunk_grid\":{\"name\":\"regular\",\"configuration\":{\"chunk_shape\":[2147483647,2147483647,4]}}," KEYS
             FILL CODECS,
         "chunk_shape: more than"},
        {"{\"zarr_format\":2,\"shape\":[2,3,4],\"order\":\"K\"}", "order: found \"K\""},
        {"{\"zarr_format\":2,\"shape\":[2,3,4],\"order\":\"C\",\"filters\":[{\"id\":\"delta\"}]}", "filters: found"},
        {"{\"zarr_format\":2,\"shape\":[2,3,4],\"order\":\"C\",\"dtype\":\"<U8\"}", "dtype: found \"<U8\""},
        {"{\"zarr_format\":2,\"shape\":[2,3,4],\"order\":\"C\",\"dtype\":\"<u2\",\"chunks\":[2,3,4],"
         "\"compressor\":{\"id\":\"bz2\"},\"fill_value\":null}",
         "compressor: found \"bz2\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct zarr_array array;
        assert_true(zarr_array_parse(&array, text_from(cases[i].text)));
        if (!strstr(conus_message(), cases[i].part)) {
            fail_msg("\"%s\" does not say \"%s\"", conus_message(), cases[i].part);
        }
    }
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    for (size_t size = 0; size < strlen(WHOLE); size++) {
        struct zarr_array array;
        assert_fails(zarr_array_parse(&array, (struct text){WHOLE, size}), CONUS_ERROR_DATA);
    }
    for (size_t size = 0; size < strlen(GROUP); size++) {
        struct ome ome;
        assert_fails(ome_parse(&ome, (struct text){GROUP, size}), CONUS_ERROR_DATA);
    }
}

static void a_level_has_millimetres(void **state)
{
    (void)state;
    struct ome ome;
    assert_ok(ome_parse(&ome, text_from(GROUP)));
    assert_int_equal(ome.count, 1);
    assert_near(ome.levels[0].scale[1], 0.02, 1e-15);
    assert_near(ome.levels[0].translation[2], 0.003, 1e-15);
    ome_finish(&ome);
    static const char outside[] = "{\"multiscales\":[{\"datasets\":[{\"path\":\"a/../../b\"}]}]}";
    assert_fails(ome_parse(&ome, text_from(outside)), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "a folder below is needed"));
}

/* Writes a store of 2 x 3 x 4 voxels, 0 to 23, and gives its path. */
static const char *write_store(const char *chunk, size_t size)
{
    test_folder("store");
    test_folder("store/c");
    test_folder("store/c/0");
    test_folder("store/c/0/0");
    assert_ok(file_write(test_scratch("store/zarr.json"), WHOLE, strlen(WHOLE)));
    assert_ok(file_write(test_scratch("store/c/0/0/0"), chunk, size));
    return test_scratch("store,resolution=1,orientation=ras");
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    uint8_t chunk[48] = {0};
    for (uint8_t i = 0; i < 24; i++) {
        chunk[2 * i] = i;
    }
    char path[400];
    snprintf(path, sizeof path, "%s", write_store((const char *)chunk, sizeof chunk));
    bool failed = true;
    for (long n = 0; failed; n++) {
        struct volume_file file = {0};
        struct notes notes = {0};
        test_fail_allocation(n);
        conus_status status = volume_file_open(&file, path, 0, &notes);
        failed = test_allocation_failed();
        test_fail_allocation(-1);
        assert_int_equal(status, failed ? CONUS_ERROR_MEMORY : CONUS_OK);
        if (!status) {
            assert_memory_equal(file.voxels.data, chunk, sizeof chunk);
        }
        volume_file_finish(&file);
        notes_finish(&notes);
    }
}

static void a_chunk_of_another_size_is_refused(void **state)
{
    (void)state;
    struct volume_file file = {0};
    struct notes notes = {0};
    const char chunk[47] = {0};
    assert_fails(volume_file_open(&file, write_store(chunk, sizeof chunk), 0, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "c/0/0/0: damaged, or not the 48 bytes of a chunk"));
    notes_finish(&notes);
}

TEST_GROUP(zarr)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_array_is_taken),
        cmocka_unit_test(bad_metadata_are_named),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(a_level_has_millimetres),
        cmocka_unit_test(every_failing_allocation_is_reported),
        cmocka_unit_test(a_chunk_of_another_size_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
