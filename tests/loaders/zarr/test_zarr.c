/* SPDX-License-Identifier: BSD-3-Clause */
/* Zarr stores that change while they are read, and heads of chunks; tests/corpus/zarr/ has small stores, and
 * tests/oracles/compare_zarr.py those of other writers. */
#include "loaders/zarr/zarr.h"

#include "base/memory.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* A shard of two chunks of a voxel each. */
#define BYTES "{\"name\":\"bytes\",\"configuration\":{\"endian\":\"little\"}}"
#define TWO                                                                                                            \
    "{\"zarr_format\":3,\"node_type\":\"array\",\"attributes\":{},\"shape\":[2,1,1],\"data_type\":\"uint8\","          \
    "\"chunk_key_encoding\":{\"name\":\"default\"},\"fill_value\":7,\"chunk_grid\":{\"name\":\"regular\","             \
    "\"configuration\":{\"chunk_shape\":[2,1,1]}},\"codecs\":[{\"name\":\"sharding_indexed\",\"configuration\":{"      \
    "\"chunk_shape\":[1,1,1],\"codecs\":[\"bytes\"],\"index_codecs\":[" BYTES "]}}]}"

/* The header of a chunk of blosc 1: versions, flags (shuffle of bytes is 1, of bits 4), the size of a number. Only
 * where it was shuffled the size matters; what is good ends in the library, or without it. */
static void a_shuffle_is_by_numbers(void **state)
{
    (void)state;
    static const struct {
        uint8_t flags, size;
        bool is_bad;
    } cases[] = {{1, 255, true}, {1, 3, true},  {4, 16, true},  {5, 0, true},
                 {1, 4, false},  {4, 1, false}, {0, 255, false}};
    const struct zarr_chain chain = {.packings = {ZARR_BLOSC}, .count = 1};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        uint8_t out[48 + ZARR_AROUND];
        uint8_t data[16] = {2, 1, cases[i].flags, cases[i].size};
        struct job job = {0};
        zarr_unpack(&job, out, zarr_unpacker_new(&job), &chain, (struct bytes){data, sizeof data}, 48);
        assert_int_not_equal(job_close(&job, NULL, NULL), CONUS_OK);
        assert_int_equal(strstr(conus_message(), "allowed are 1, 2, 4 and 8") != NULL, cases[i].is_bad);
    }
}

static void write_shard(void)
{
    static const uint64_t index[4] = {1, 1, 0, 1};
    uint8_t shard[2 + 32] = {40, 41};
    memcpy(shard + 2, index, 32); /* tests run on little-endian machines */
    test_folder("shard");
    test_folder("shard/c");
    test_folder("shard/c/0");
    test_folder("shard/c/0/0");
    assert_ok(file_write(test_scratch("shard/zarr.json"), TWO, strlen(TWO)));
    assert_ok(file_write(test_scratch("shard/c/0/0/0"), shard, sizeof shard));
}

/* Writes the shard again with another size after the first of its chunks was read; or deletes it. */
static void change_shard(struct job *job, void *user, size_t first, const uint8_t *voxels, size_t count)
{
    (void)first;
    (void)voxels;
    (void)count;
    if (*(bool *)user) {
        remove(test_scratch("shard/c/0/0/0"));
    } else {
        (void)JOB_CALL(job, file_write(test_scratch("shard/c/0/0/0"), "another size", 12));
    }
}

static void a_shard_that_changes_between_chunks_is_an_error(void **state)
{
    (void)state;
    struct zarr_array array;
    struct job job = {0};
    zarr_array_parse(&job, &array, text_from(TWO));
    assert_ok(job_close(&job, NULL, NULL));
    for (int i = 0; i < 2; i++) {
        bool goes = i;
        write_shard();
        (void)zarr_read(&job, &array, test_scratch("shard"), 0, change_shard, &goes);
        assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_IO);
        assert_non_null(strstr(conus_message(), "c/0/0/0: changed while it was read"));
    }
}

static void indexes_beyond_the_limit_are_refused(void **state)
{
    (void)state;
    struct zarr_array array;
    bool goes = true;
    struct job job = {0};
    zarr_array_parse(&job, &array, text_from(TWO));
    assert_ok(job_close(&job, NULL, NULL));
    array.file_chunk[0] = 1 << 20; /* as many chunks in a shard, 16 bytes each in its index */
    job.max_memory = 1 << 24;
    (void)zarr_read(&job, &array, test_scratch("shard"), 0, change_shard, &goes);
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "(--max-memory)"));
}

TEST_GROUP(zarr)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_shuffle_is_by_numbers),
        cmocka_unit_test(a_shard_that_changes_between_chunks_is_an_error),
        cmocka_unit_test(indexes_beyond_the_limit_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
