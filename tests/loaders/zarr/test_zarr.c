/* SPDX-License-Identifier: BSD-3-Clause */
/* Metadata of Zarr arrays and of OME: reading, and the messages of refused ones. tests/oracles/compare_zarr.py has
 * chunks of other writers. */
#include "loaders/zarr/zarr.h"

#include "atlas/labels/label_voxels.h"
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

static void fill_values_are_bits(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint8_t bits[8]; /* the stored bytes */
    } cases[] = {
        {"\"float32\",\"fill_value\":\"0x7fc00001\"", {0x01, 0, 0xc0, 0x7f}},
        {"\"float32\",\"fill_value\":\"NaN\"", {0, 0, 0xc0, 0x7f}},
        {"\"float32\",\"fill_value\":\"-Infinity\"", {0, 0, 0x80, 0xff}},
        {"\"float32\",\"fill_value\":1.5", {0, 0, 0xc0, 0x3f}},
        {"\"float64\",\"fill_value\":\"Infinity\"", {0, 0, 0, 0, 0, 0, 0xf0, 0x7f}},
        {"\"float64\",\"fill_value\":\"0x7FF0000000000000\"", {0, 0, 0, 0, 0, 0, 0xf0, 0x7f}},
        {"\"int16\",\"fill_value\":-2", {0xfe, 0xff}},
    };
    static const char *const bad[] = {
        "\"float32\",\"fill_value\":\"0x7fc000001\"", "\"float64\",\"fill_value\":\"0x7fc00000\"",
        "\"float32\",\"fill_value\":\"0x7fc0000g\"",  "\"float32\",\"fill_value\":\"0x\"",
        "\"float32\",\"fill_value\":\"nan\"",         "\"uint32\",\"fill_value\":\"0x7fc00000\"",
        "\"uint32\",\"fill_value\":\"NaN\"",          "\"int16\",\"fill_value\":\"Infinity\""};
    struct zarr_array array;
    char text[1024];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        snprintf(text, sizeof text, HEAD SHAPE GRID KEYS "\"data_type\":%s," CODECS, cases[i].text);
        assert_ok(zarr_array_parse(&array, text_from(text)));
        assert_memory_equal(array.fill, cases[i].bits, sizeof array.fill);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        snprintf(text, sizeof text, HEAD SHAPE GRID KEYS "\"data_type\":%s," CODECS, bad[i]);
        assert_fails(zarr_array_parse(&array, text_from(text)), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), "fill_value: a number of the array's type"));
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

/* OME 0.6: the axes are those of the system to which a level leads, and the image's own transformations start from
 * there. Drafts have the systems beside the images, and other names than the final version. */
static void a_level_of_the_sixth_version_has_millimetres(void **state)
{
    (void)state;
#define SYSTEM(name, unit)                                                                                             \
    "{\"name\":\"" name "\",\"axes\":[{\"unit\":\"" unit "\"},{\"unit\":\"" unit "\"},{\"unit\":\"" unit "\"}]}"
#define SYSTEMS "\"coordinateSystems\":[" SYSTEM("other", "meter") "," SYSTEM("physical", "micrometer") "]"
#define LEVEL(output)                                                                                                  \
    "\"coordinateTransformations\":[{\"type\":\"scale\",\"scale\":[9,9,9]}],\"datasets\":[{\"path\":\"0\","            \
    "\"coordinateTransformations\":[{\"type\":\"sequence\",\"output\":" output                                         \
    ",\"transformations\":[{\"type\":\"scale\",\"scale\":[25,20,10]},{\"type\":\"translation\",\"translation\":"       \
    "[1,2,3]}]}]}]"
    static const char *const texts[] = {
        "{\"attributes\":{\"ome\":{\"version\":\"0.6\",\"multiscales\":[{" SYSTEMS
        "," LEVEL("{\"name\":\"physical\"}") "}]}}}",
        "{\"attributes\":{\"ome\":{\"version\":\"0.6.dev3\"," SYSTEMS
        ",\"multiscales\":[{" LEVEL("\"physical\"") "}]}}}",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct ome ome;
        assert_ok(ome_parse(&ome, text_from(texts[i])));
        assert_int_equal(ome.rank, 3);
        assert_near(ome.levels[0].scale[0], 0.025, 1e-15);
        assert_near(ome.levels[0].scale[2], 0.01, 1e-15);
        assert_near(ome.levels[0].translation[0], 0.001, 1e-15);
        assert_near(ome.levels[0].translation[2], 0.003, 1e-15);
        ome_finish(&ome);
    }
}

/* Writes a store of 2 x 3 x 4 voxels, 0 to 23; returns its path. */
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
    struct zarr_unpacker *unpacker = NULL;
    assert_ok(zarr_unpacker_create(&unpacker));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        uint8_t out[48 + ZARR_AROUND];
        const uint8_t data[16] = {2, 1, cases[i].flags, cases[i].size};
        conus_status status = zarr_unpack(out, unpacker, &chain, data, sizeof data, 48);
        assert_int_not_equal(status, CONUS_OK);
        assert_int_equal(strstr(conus_message(), "allowed are 1, 2, 4 and 8") != NULL, cases[i].is_bad);
    }
    zarr_unpacker_destroy(unpacker);
}

/* A shard of two chunks of a voxel each, one above the other, by the numbers of its index. */
#define TWO                                                                                                            \
    HEAD "\"shape\":[2,1,1],\"data_type\":\"uint8\"," KEYS FILL                                                        \
         "\"chunk_grid\":{\"name\":\"regular\",\"configuration\":{\"chunk_shape\":[2,1,1]}},\"codecs\":[{\"name\":"    \
         "\"sharding_indexed\",\"configuration\":{\"chunk_shape\":[1,1,1],\"codecs\":[\"bytes\"],\"index_codecs\":"    \
         "[" BYTES "]}}]}"
static const char *write_shard(const uint64_t index[4])
{
    uint8_t shard[2 + 32] = {40, 41};
    memcpy(shard + 2, index, 32); /* tests run on little-endian machines */
    test_folder("shard");
    test_folder("shard/c");
    test_folder("shard/c/0");
    test_folder("shard/c/0/0");
    assert_ok(file_write(test_scratch("shard/zarr.json"), TWO, strlen(TWO)));
    assert_ok(file_write(test_scratch("shard/c/0/0/0"), shard, sizeof shard));
    return test_scratch("shard,resolution=1,orientation=ras");
}

static const uint64_t good_index[4] = {1, 1, 0, 1};

static void chunks_of_a_shard_lie_apart(void **state)
{
    (void)state;
    static const struct {
        uint64_t index[4];
        uint8_t voxels[2]; /* 0 = refused */
    } cases[] = {
        {{1, 1, 0, 1}, {41, 40}},
        {{UINT64_MAX, UINT64_MAX, 0, 1}, {7, 40}},
        {{0, 1, 0, 1}, {0}},              /* the same */
        {{0, 2, 1, 1}, {0}},              /* one in the other */
        {{0, 1, 2, 1}, {0}},              /* over the index */
        {{0, 1, 34, 1}, {0}},             /* behind the end */
        {{0, 1, 1, UINT64_MAX}, {0}},     /* their sum is 0 */
        {{0, 1, UINT64_MAX - 1, 3}, {0}}, /* their sum is 1 */
        {{0, 1, UINT64_MAX, UINT64_MAX - 1}, {0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct volume_file file = {0};
        struct notes notes = {0};
        conus_status status = volume_file_open(&file, write_shard(cases[i].index), 0, &notes);
        if (cases[i].voxels[0]) {
            assert_ok(status);
            assert_memory_equal(file.voxels.data, cases[i].voxels, 2);
        } else {
            assert_fails(status, CONUS_ERROR_DATA);
            assert_non_null(strstr(conus_message(), "lies outside of the file, or over another or the index"));
        }
        volume_file_finish(&file);
        notes_finish(&notes);
    }
}

static conus_status open_shard(void *data)
{
    struct volume_file file = {0};
    struct notes notes = {0};
    conus_status status = volume_file_open(&file, data, 0, &notes);
    volume_file_finish(&file);
    notes_finish(&notes);
    return status;
}

static void every_failing_allocation_of_a_shard_is_reported(void **state)
{
    (void)state;
    test_every_allocation(open_shard, (void *)write_shard(good_index));
}

/* Writes the shard again with another size after the first of its chunks was read; or deletes it. */
static conus_status change_shard(void *user, size_t first, const uint8_t *voxels, size_t count)
{
    (void)first;
    (void)voxels;
    (void)count;
    if (*(bool *)user) {
        remove(test_scratch("shard/c/0/0/0"));
        return CONUS_OK;
    }
    return file_write(test_scratch("shard/c/0/0/0"), "another size", 12);
}

static void a_shard_that_changes_between_chunks_is_an_error(void **state)
{
    (void)state;
    struct zarr_array array;
    struct zarr_found found;
    assert_ok(zarr_array_parse(&array, text_from(TWO)));
    for (int i = 0; i < 2; i++) {
        bool goes = i;
        write_shard(good_index);
        assert_fails(zarr_read(&found, &array, test_scratch("shard"), 0, 1 << 20, change_shard, &goes), CONUS_ERROR_IO);
        assert_non_null(strstr(conus_message(), "c/0/0/0: changed while it was read"));
    }
}

static void indexes_beyond_the_limit_are_refused(void **state)
{
    (void)state;
    struct zarr_array array;
    struct zarr_found found;
    bool goes = true;
    assert_ok(zarr_array_parse(&array, text_from(TWO)));
    array.file_chunk[0] = 1 << 20; /* as many chunks in a shard, 16 bytes each in its index */
    assert_fails(zarr_read(&found, &array, test_scratch("shard"), 0, 1 << 24, change_shard, &goes), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "(--max-memory)"));
}

/* Two chunks along the first row: the invalid voxel of the second comes before that of the first. */
static void the_first_voxel_that_is_no_label_is_named(void **state)
{
    (void)state;
    static const int8_t chunks[2][4] = {{1, 1, -5, 1}, {1, -3, 1, 1}};
    static const char array[] = "{\"zarr_format\":2,\"shape\":[1,2,4],\"chunks\":[1,2,2],\"dtype\":\"|i1\","
                                "\"compressor\":null,\"fill_value\":0,\"order\":\"C\",\"filters\":null}";
    struct volume_file file = {0};
    struct label_voxels labels = {0};
    struct notes notes = {0};
    const conus_load_options options = {0};
    test_folder("signs");
    assert_ok(file_write(test_scratch("signs/.zarray"), array, strlen(array)));
    assert_ok(file_write(test_scratch("signs/0.0.0"), (const char *)chunks[0], 4));
    assert_ok(file_write(test_scratch("signs/0.0.1"), (const char *)chunks[1], 4));
    assert_fails(volume_file_open_labels(&file, &labels, test_scratch("signs,resolution=1,orientation=ras"), NULL,
                                         &options, "", &notes),
                 CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "voxel (3, 0, 0): found -3"));
    notes_finish(&notes);
}

/* An array of 2 x 2 volumes, in chunks of 1 x 2, of 2 x 1 x 1 voxels each, as the level "scale0/image" of a group. */
static void volumes_lie_along_the_axes_ahead_of_space(void **state)
{
    (void)state;
    static const char array[] =
        HEAD "\"shape\":[2,2,2,1,1],\"data_type\":\"uint8\"," KEYS FILL "\"chunk_grid\":{\"name\":\"regular\","
             "\"configuration\":{\"chunk_shape\":[1,2,1,1,1]}},\"codecs\":[\"bytes\"]}";
    static const char group[] =
        "{\"multiscales\":[{\"axes\":[{\"type\":\"time\"},{\"type\":\"channel\"},{\"unit\":\"millimeter\"},{\"unit\":"
        "\"millimeter\"},{\"unit\":\"millimeter\"}],\"datasets\":[{\"path\":\"scale0/image\","
        "\"coordinateTransformations\":[{\"type\":\"scale\",\"scale\":[1,1,2,3,4]}]}]}]}";
    static const char *const folders[] = {"volumes", "volumes/scale0", "volumes/scale0/image"};
    static const char *const ways[] = {"volumes/scale0/image,volume=%d,orientation=asr",
                                       "volumes,volume=%d,orientation=asr"};
    for (size_t i = 0; i < 3; i++) {
        test_folder(folders[i]);
    }
    assert_ok(file_write(test_scratch("volumes/.zattrs"), group, strlen(group)));
    assert_ok(file_write(test_scratch("volumes/scale0/image/zarr.json"), array, strlen(array)));
    for (unsigned i = 0; i < 4; i++) { /* t and z of the chunks' keys */
        char key[64] = "volumes/scale0/image/c";
        const unsigned at[] = {i / 2, 0, i % 2, 0};
        for (size_t k = 0; k < 4; k++) {
            size_t length = strlen(key);
            test_folder(key);
            snprintf(key + length, sizeof key - length, "/%u", at[k]);
        }
        test_folder(key);
        const uint8_t voxels[2] = {(uint8_t)(100 * at[0] + 1 + at[2]), (uint8_t)(100 * at[0] + 11 + at[2])};
        snprintf(key + strlen(key), sizeof key - strlen(key), "/0");
        assert_ok(file_write(test_scratch(key), voxels, 2));
    }
    for (size_t i = 0; i < 8; i++) {
        struct volume_file file = {0};
        struct notes notes = {0};
        char path[64];
        unsigned volume = (unsigned)i % 4;
        snprintf(path, sizeof path, ways[i / 4], volume);
        assert_ok(volume_file_open(&file, test_scratch(path), 0, &notes));
        const uint8_t first = (uint8_t)(100 * (volume / 2) + 10 * (volume % 2) + 1);
        const uint8_t voxels[2] = {first, (uint8_t)(first + 1)};
        assert_memory_equal(file.voxels.data, voxels, 2);
        assert_int_equal(file.info.volume_count, 4);
        assert_near(file.info.spacing[0], 4, 1e-12);
        volume_file_finish(&file);
        notes_finish(&notes);
    }
}

/* Each volume is placed as the manifest says, also beside another one of the same store. */
static void pathways_of_a_manifest_are_volumes(void **state)
{
    (void)state;
#define PLACED ",\"resolution\":[2000,3000,4000],\"orientation\":\"asr\""
    static const char manifest[] =
        "{\"conus_atlas\":1,\"parcellation\":{\"file\":\"volumes\",\"volume\":0" PLACED "},\"pathways\":[{\"file\":"
        "\"volumes\",\"volume\":1,\"threshold\":2" PLACED "},{\"file\":\"volumes\",\"volume\":3,\"threshold\":2" PLACED
        "}]}";
    conus_atlas *atlas;
    volumes_lie_along_the_axes_ahead_of_space(state);
    assert_ok(file_write(test_scratch("volumes.atlas.json"), manifest, strlen(manifest)));
    assert_ok(conus_atlas_load(&atlas, test_scratch("volumes.atlas.json"), NULL));
    assert_int_equal(conus_atlas_volume_count(atlas), 3);
    for (size_t i = 0; i < 3; i++) {
        const conus_volume_info *info = conus_atlas_volume(atlas, i);
        assert_near(info->world_from_voxel[12], -2, 1e-12); /* half a voxel from the corner; OME says 0 */
        assert_int_equal(info->volume, i ? 2 * i - 1 : 0);
        assert_int_equal((int)info->maximum, ((int[]){2, 12, 112})[i]);
    }
    conus_atlas_destroy(atlas);
}

static void areas_of_an_image_have_its_names_and_colours(void **state)
{
    (void)state;
    static const char group[] = "{\"multiscales\":[{\"datasets\":[{\"path\":\"scale0/"
                                "image\"}]}],\"image-label\":{\"colors\":[{\"label-value\":1,"
                                "\"rgba\":[1,2,3,4]},{\"label-value\":2,\"rgba\":[5,6,7,8]}],\"properties\":[{\"label-"
                                "value\":1,\"class\":\"a\"}]}}";
    static const char *const ways[] = {"volumes,volume=0,resolution=1,orientation=asr",
                                       "volumes/scale0/image,volume=0,resolution=1,orientation=asr"};
    volumes_lie_along_the_axes_ahead_of_space(state); /* labels 1 and 2 in the first */
    assert_ok(file_write(test_scratch("volumes/.zattrs"), group, strlen(group)));
    for (size_t i = 0; i < 2; i++) {
        conus_atlas *atlas;
        assert_ok(conus_atlas_load(&atlas, test_scratch(ways[i]), NULL));
        assert_int_equal(conus_atlas_object_count(atlas), 2);
        assert_string_equal(conus_atlas_object(atlas, 1)->name, "a");
        assert_string_equal(conus_atlas_object(atlas, 2)->name, "2");
        assert_int_equal(conus_atlas_object(atlas, 1)->rgb[2], 3);
        assert_int_equal(conus_atlas_object(atlas, 2)->rgb[0], 5);
        conus_atlas_destroy(atlas);
    }
}

TEST_GROUP(zarr)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_array_is_taken),
        cmocka_unit_test(bad_metadata_are_named),
        cmocka_unit_test(fill_values_are_bits),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(a_level_has_millimetres),
        cmocka_unit_test(a_level_of_the_sixth_version_has_millimetres),
        cmocka_unit_test(every_failing_allocation_is_reported),
        cmocka_unit_test(a_chunk_of_another_size_is_refused),
        cmocka_unit_test(a_shuffle_is_by_numbers),
        cmocka_unit_test(chunks_of_a_shard_lie_apart),
        cmocka_unit_test(every_failing_allocation_of_a_shard_is_reported),
        cmocka_unit_test(a_shard_that_changes_between_chunks_is_an_error),
        cmocka_unit_test(indexes_beyond_the_limit_are_refused),
        cmocka_unit_test(the_first_voxel_that_is_no_label_is_named),
        cmocka_unit_test(volumes_lie_along_the_axes_ahead_of_space),
        cmocka_unit_test(pathways_of_a_manifest_are_volumes),
        cmocka_unit_test(areas_of_an_image_have_its_names_and_colours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
