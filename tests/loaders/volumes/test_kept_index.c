/* SPDX-License-Identifier: BSD-3-Clause */
/* One volume of a packed 4-D file, by the kept index: the same as without it. */
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "builders/series_builder.h"
#include "conus/cache.h"
#include "loaders/volumes/stored/stored_file.h"
#include "loaders/volumes/volume_values.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void assert_same_as_without(const char *path, size_t volume)
{
    struct volume_file with = {0};
    struct volume_file without = {0};
    assert_ok(series_open(&with, path, volume, true));
    assert_ok(series_open(&without, path, volume, false));
    series_assert(&with, volume);
    series_assert(&without, volume);
    assert_string_equal(with.info.sha256, without.info.sha256);
    assert_string_equal(with.info.format, without.info.format);
    assert_int_equal(with.info.volume, without.info.volume);
    assert_int_equal(with.info.volume_count, SERIES_COUNT);
    assert_int_equal(with.head.size, without.head.size);
    assert_memory_equal(with.head.data, without.head.data, with.head.size);
    volume_file_finish(&with);
    volume_file_finish(&without);
}

static void a_volume_is_found_by_the_index(void **state)
{
    (void)state;
    const size_t members[] = {SIZE_MAX, 65280 /* as bgzip makes them */, 3000000};
    for (size_t i = 0; i < 3; i++) {
        char path[8192];
        snprintf(path, sizeof path, "%s", i ? series_make("members.nii.gz", 0, members[i]) : series_path());
        assert_ok(conus_cache_clear());
        assert_false(series_opens_by_index(path, 3));
        series_index(path, true);
        assert_true(series_opens_by_index(path, 0));
        assert_true(series_opens_by_index(path, 7));
        assert_true(series_opens_by_index(path, SERIES_COUNT - 1));
        assert_same_as_without(path, 12);
    }
}

/* Every other volume is found, and a volume of an exchanged file is not. */
static void a_volume_is_found_in_every_format(void **state)
{
    (void)state;
    for (int form = 0; form < SERIES_FORMS; form++) {
        char path[8192];
        char named[8192];
        snprintf(path, sizeof path, "%s", series_make_as((enum series_form)form, 0));
        assert_ok(conus_cache_clear());
        assert_false(series_opens_by_index(path, 3));
        series_open_rested(path);
        assert_true(series_opens_by_index(path, 0));
        assert_true(series_opens_by_index(path, SERIES_COUNT - 1));
        assert_same_as_without(path, 12);
        assert_non_null(realpath(series_voxels_of(path, (enum series_form)form), named));
        conus_cache *cache = NULL;
        assert_ok(conus_cache_create(&cache));
        assert_int_equal(conus_cache_count(cache), 1);
        assert_string_equal(conus_cache_entry_at(cache, 0)->path, named);
        conus_cache_destroy(cache);
    }
}

/* A header in a separate file is part of what the index depends on: with another header the index is not used. */
static void another_header_has_another_index(void **state)
{
    (void)state;
    char path[8192];
    struct bytes bytes = {0};
    snprintf(path, sizeof path, "%s", series_make_as(SERIES_NRRD_APART, 0));
    series_open_rested(path);
    assert_ok(file_read(&bytes, path, UINT64_MAX));
    bytes.data[bytes.size - 1] = '#'; /* instead of the empty line: a comment, which ends with the file */
    overwrite_file(path, bytes.data, bytes.size);
    assert_false(series_opens_by_index(path, 3));
    assert_same_as_without(path, 3);
    bytes_finish(&bytes);
}

/* Volumes that do not fit into memory together are read one after the other, by the index that the first one made. */
static void a_series_too_large_to_keep_is_read_by_its_index(void **state)
{
    (void)state;
    struct volume_file file = {0};
    struct notes notes = {0};
    const uint64_t limit = SERIES_VOLUME * (uint64_t)(SERIES_COUNT - 1);
    series_need_index();
    test_limit_allocations(SERIES_MEMORY);
    conus_status without =
        volume_file_open_series(&file, series_path(), &(conus_load_options){.max_memory = limit}, &notes);
    assert_ok(volume_file_open_series(&file, series_path(), &(conus_load_options){.max_memory = limit, .cache = true},
                                      &notes));
    for (size_t k = 0; k < SERIES_COUNT; k += 4) {
        assert_ok(volume_file_select(&file, k));
        series_assert(&file, k);
    }
    test_limit_allocations(0);
    assert_int_equal(without, CONUS_ERROR_MEMORY);
    volume_file_finish(&file);
    notes_finish(&notes);
}

static void errors_are_those_of_the_file(void **state)
{
    (void)state;
    struct volume_file file = {0};
    struct notes notes = {0};
    series_need_index();
    assert_fails(series_open(&file, series_path(), SERIES_COUNT, true), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "volume: found 17, allowed are 0 to 16"));
    assert_fails(volume_file_open_cached(&file, series_path(), 0, true, &notes), CONUS_ERROR_ARGUMENT);
    char chosen[8300];
    snprintf(chosen, sizeof chosen, "%s,volume=2", series_path());
    assert_fails(volume_file_open_cached(&file, chosen, SERIES_MEMORY, true, &notes), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "allowed are 5242880 (--max-memory)")); /* the packed file is larger */
    notes_finish(&notes);
}

static void without_being_asked_for_there_is_none(void **state)
{
    (void)state;
    struct volume_file file = {0};
    assert_ok(conus_cache_clear());
    assert_ok(series_open(&file, series_path(), 1, false));
    volume_file_finish(&file);
    assert_string_equal(series_entry(), "");
    series_need_index();
    test_limit_allocations(SERIES_MEMORY);
    conus_status status = series_open(&file, series_path(), 1, false);
    test_limit_allocations(0);
    assert_int_equal(status, CONUS_ERROR_MEMORY);
    setenv("CONUS_CACHE", "off", 1);
    assert_false(series_opens_by_index(series_path(), 1));
    setenv("CONUS_CACHE", "12x", 1);
    assert_fails(series_open(&file, series_path(), 1, true), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "12x"));
    assert_ok(series_open(&file, series_path(), 1, false));
    volume_file_finish(&file);
    unsetenv("CONUS_CACHE");
    assert_true(series_opens_by_index(series_path(), 1));
}

static void the_list_names_it(void **state)
{
    (void)state;
    conus_cache *cache = NULL;
    char real[8192];
    assert_ok(conus_cache_clear());
    series_need_index();
    assert_ok(conus_cache_create(&cache));
    assert_int_equal(conus_cache_count(cache), 1);
    const conus_cache_entry *entry = conus_cache_entry_at(cache, 0);
    assert_string_equal(entry->kind, "index");
    assert_non_null(realpath(series_path(), real));
    assert_string_equal(entry->path, real);
    assert_true(entry->size < 1 << 20); /* 17 points, each at most 32 KiB */
    conus_cache_destroy(cache);
    assert_ok(conus_cache_clear());
    assert_false(series_is_indexed(series_path()));
}

enum { WIDE_EDGE = 162, WIDE = WIDE_EDGE * WIDE_EDGE * WIDE_EDGE };

static uint32_t wide_voxel(size_t volume, size_t i)
{
    return (uint32_t)(i % 97 * (i / 5000 % 600) + volume);
}

static const char *make_wide(bool is_packed)
{
    static const int64_t dim[3] = {WIDE_EDGE, WIDE_EDGE, WIDE_EDGE};
    struct nifti_builder builder;
    struct buffer packed = {0};
    nifti_begin(&builder, 1, false, 768 /* uint32 */, dim);
    nifti_set(&builder, "dim", 0, 4);
    nifti_set(&builder, "dim", 4, 2);
    for (size_t k = 0; k < 2; k++) {
        uint32_t *voxels = malloc(WIDE * sizeof *voxels);
        for (size_t i = 0; i < WIDE; i++) {
            voxels[i] = wide_voxel(k, i);
        }
        buffer_append(&builder.bytes, voxels, WIDE * sizeof *voxels);
        free(voxels);
    }
    if (is_packed) {
        append_fast_gzip(&packed, builder.bytes.data, builder.bytes.size);
    }
    const char *path = is_packed ? write_bytes("wide.nii.gz", &packed) : write_bytes("wide.nii", &builder.bytes);
    buffer_finish(&builder.bytes);
    buffer_finish(&packed);
    return path;
}

static conus_status open_labels(struct volume_file *file, struct label_voxels *labels, const char *path,
                                uint64_t max_memory)
{
    char chosen[8300];
    struct notes notes = {0};
    const conus_load_options options = {.cache = true, .max_memory = max_memory};
    snprintf(chosen, sizeof chosen, "%s,volume=1", path);
    conus_status status = volume_file_open_labels(file, labels, chosen, NULL, &options, "a volume", &notes);
    notes_finish(&notes);
    return status;
}

static void assert_labels(const char *path, uint64_t max_memory)
{
    struct volume_file file = {0};
    struct label_voxels labels = {0};
    size_t wrong = 0;
    assert_ok(open_labels(&file, &labels, path, max_memory));
    assert_int_equal(labels.count, WIDE);
    for (size_t i = 0; i < WIDE; i++) {
        wrong += label_voxels_at(&labels, i) != wide_voxel(1, i);
    }
    assert_int_equal(wrong, 0);
    label_voxels_finish(&labels);
    volume_file_finish(&file);
}

/* The index turns out to be wrong in the middle: the labels that were read so far are discarded. */
static void labels_begin_again_without_an_index_that_lies(void **state)
{
    (void)state;
    char path[8192];
    struct bytes bytes = {0};
    struct cache_entry parts;
    snprintf(path, sizeof path, "%s", make_wide(true));
    assert_ok(conus_cache_clear());
    struct stored stored = {0};
    struct gzip_range range = {.from = SERIES_HEAD, .count = 1, .total = SERIES_HEAD + (size_t)WIDE * 8};
    char sum[65];
    struct bytes out = {0};
    assert_ok(stored_open(&stored, path, UINT64_MAX, STORED_KEEP, NULL));
    stored.keeper->trace.begun.tv_sec += 2 * TRACE_REST_ELSEWHERE_SECONDS;
    file_sha256(sum, &stored.bytes);
    assert_ok(stored_range(&out, &range, &stored, sum));
    bytes_finish(&out);
    stored_finish(&stored);
    assert_true(series_is_indexed(path));
    assert_labels(path, 0);
    char *entry = strdup(series_entry());
    assert_ok(file_read(&bytes, entry, UINT64_MAX));
    assert_true(cache_entry_parse(&parts, bytes.data, bytes.size));
    uint8_t *index = memory_copy(parts.packed.data, parts.packed.size, 1);
    struct gzip_index parsed;
    assert_true(gzip_index_parse(&parsed, index, parts.packed.size));
    ((struct gzip_point *)(void *)(index + SERIES_POINTS_AT))[parsed.count - 2].sum ^= 1; /* last spans but one */
    memset(index + SERIES_TRAILER_AT, 0, 8);
    series_forge(entry, &bytes, index);
    assert_true(series_is_indexed(path));
    assert_labels(path, 0);
    memory_free(index);
    bytes_finish(&bytes);
    free(entry);
}

/* One volume of a plain file: there is no index, and only this volume is in memory. */
static void a_volume_of_a_plain_file_is_read_alone(void **state)
{
    (void)state;
    char path[8192];
    snprintf(path, sizeof path, "%s", make_wide(false));
    test_limit_allocations((size_t)WIDE * 4 - 1); /* less than the volume, as it is stored */
    assert_labels(path, 0);
    test_limit_allocations(0);
}

/* The limit counts the memory that is held: the places of the labels and 512 bytes for each different one. It counts
 * neither the file nor the volume as stored. */
static void the_limit_of_a_plain_file_counts_its_labels(void **state)
{
    (void)state;
    struct volume_file file = {0};
    struct label_voxels labels = {0};
    char path[8192];
    snprintf(path, sizeof path, "%s", make_wide(false));
    static bool is_there[96 * 599 + 2];
    uint64_t different = 0;
    for (size_t i = 0; i < WIDE; i++) {
        different += !is_there[wide_voxel(1, i)];
        is_there[wide_voxel(1, i)] = true;
    }
    const uint64_t held = SERIES_HEAD + (uint64_t)WIDE * sizeof(uint16_t) + 512 * different; /* formats.md */
    assert_labels(path, held);
    assert_fails(open_labels(&file, &labels, path, held / 2), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "different ones, which take 512 bytes each, and 4251528 voxels with 2"));
}

static conus_status attempt(void *path)
{
    struct volume_file file = {0};
    conus_status status = series_open(&file, path, 4, true);
    if (!status) {
        series_assert(&file, 4);
    }
    volume_file_finish(&file);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    series_need_index();
    test_every_allocation(attempt, (void *)series_path());
}

TEST_GROUP(kept_index)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_volume_is_found_by_the_index),
        cmocka_unit_test(a_volume_is_found_in_every_format),
        cmocka_unit_test(another_header_has_another_index),
        cmocka_unit_test(a_series_too_large_to_keep_is_read_by_its_index),
        cmocka_unit_test(errors_are_those_of_the_file),
        cmocka_unit_test(without_being_asked_for_there_is_none),
        cmocka_unit_test(the_list_names_it),
        cmocka_unit_test(labels_begin_again_without_an_index_that_lies),
        cmocka_unit_test(a_volume_of_a_plain_file_is_read_alone),
        cmocka_unit_test(the_limit_of_a_plain_file_counts_its_labels),
        cmocka_unit_test(every_failing_allocation),
    };
    umask(022);
    unsetenv("CONUS_CACHE");
    test_own_cache();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
