/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes of 4-D files, one after the other, and real ones; tests/corpus/nifti/ has packing, pairs and choices. */
#include "loaders/volumes/volumes.h"

#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "label_list.h"
#include "test.h"
#include "volume_on_job.h"

#include <stdio.h>
#include <string.h>

static const int64_t small[3] = {3, 2, 2};
enum { SMALL_COUNT = 12 };

static void open_ok(struct volume_file *file, const char *path)
{
    struct notes notes = {0};
    assert_ok(volume_file_open(file, path, 0, &notes));
    assert_int_equal(notes.count, 0);
}

/* Volume t has the value 10 t + v in voxel v. */
static const char *write_series(bool packed)
{
    struct nifti_builder b;
    nifti_begin(&b, 1, false, VOLUME_INT16, small);
    nifti_set(&b, "dim", 0, 5);
    nifti_set(&b, "dim", 4, 3);
    nifti_set(&b, "dim", 5, 2);
    for (size_t v = 0; v < (size_t)6 * SMALL_COUNT; v++) {
        size_t series = v / SMALL_COUNT;
        nifti_voxel(&b, (double)(10 * series + v % SMALL_COUNT));
    }
    const char *path = packed ? write_packed("series.nii.gz", &b.bytes) : write_bytes("series.nii", &b.bytes);
    buffer_finish(&b.bytes);
    return path;
}

/* The chosen volume is the one that opening the file with ",volume=K" gives. */
static void assert_as_opened(const struct volume_file *file, const char *path, size_t volume)
{
    struct volume_file alone;
    char choice[300];
    snprintf(choice, sizeof choice, "%s,volume=%zu", path, volume);
    open_ok(&alone, choice);
    assert_int_equal(file->info.volume, volume);
    assert_int_equal(file->info.volume_count, alone.info.volume_count);
    assert_string_equal(file->path, alone.path);
    assert_ptr_equal(file->info.path, file->path);
    assert_string_equal(file->info.sha256, alone.info.sha256);
    assert_string_equal(file->info.format, alone.info.format);
    assert_int_equal(file->voxels.size, alone.voxels.size);
    assert_memory_equal(file->voxels.data, alone.voxels.data, alone.voxels.size);
    volume_file_finish(&alone);
}

enum { TOO_LITTLE = 400 }; /* less than the 352 + 6 * 24 bytes of a series, enough for a volume */

static void a_series_gives_what_each_volume_by_itself_does(void **state)
{
    (void)state;
    static const size_t order[] = {0, 1, 2, 5, 3, 3, 0, 4};
    const struct {
        bool packed;
        uint64_t max_memory;
    } cases[] = {{false, 0}, {true, 0}, {true, 352 + 6 * 24}, {true, 352 + 6 * 24 - 1}, {true, TOO_LITTLE}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct volume_file file;
        struct notes notes = {0};
        const char *path = write_series(cases[i].packed);
        assert_ok(
            volume_file_open_series(&file, path, &(conus_load_options){.max_memory = cases[i].max_memory}, &notes));
        assert_int_equal(file.series.size, i < 3 ? 6 * 24 : 0);
        assert_as_opened(&file, path, 0);
        for (size_t k = 0; k < sizeof order / sizeof order[0]; k++) {
            assert_ok(volume_file_select(&file, order[k]));
            assert_as_opened(&file, path, order[k]);
        }
        assert_int_equal(notes.count, 0);
        volume_file_finish(&file);
    }
}

static void a_volume_that_is_not_there_cannot_be_selected(void **state)
{
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        struct volume_file file;
        struct notes notes = {0};
        const char *path = write_series(true);
        assert_ok(
            volume_file_open_series(&file, path, &(conus_load_options){.max_memory = i ? TOO_LITTLE : 0}, &notes));
        assert_ok(volume_file_select(&file, 5));
        assert_fails(volume_file_select(&file, 6), CONUS_ERROR_ARGUMENT);
        assert_non_null(strstr(conus_message(), "series.nii.gz: volume: found 6, allowed are 0 to 5"));
        assert_fails(volume_file_select(&file, SIZE_MAX), CONUS_ERROR_ARGUMENT);
        assert_as_opened(&file, path, 5);
        volume_file_finish(&file);
    }
}

static void a_series_that_vanishes_stays_as_it_was(void **state)
{
    (void)state;
    struct volume_file file;
    struct notes notes = {0};
    const char *path = write_series(true);
    assert_ok(volume_file_open_series(&file, path, &(conus_load_options){.max_memory = TOO_LITTLE}, &notes));
    assert_ok(volume_file_select(&file, 2));
    assert_int_equal(remove(path), 0);
    assert_fails(volume_file_select(&file, 3), CONUS_ERROR_IO);
    assert_as_opened(&file, write_series(true), 2);
    volume_file_finish(&file);
}

struct series_case {
    const char *path;
    uint64_t max_memory;
};

static conus_status open_and_select(void *data)
{
    const struct series_case *wanted = data;
    struct volume_file file = {0};
    struct notes notes = {0};
    conus_status status =
        volume_file_open_series(&file, wanted->path, &(conus_load_options){.max_memory = wanted->max_memory}, &notes);
    for (size_t i = 0; !status && i < 3; i++) {
        size_t before = file.info.volume;
        status = volume_file_select(&file, 2 * i);
        assert_int_equal(file.info.volume, status ? before : 2 * i);
    }
    notes_finish(&notes);
    volume_file_finish(&file);
    return status;
}

static void every_failing_allocation_of_a_series(void **state)
{
    (void)state;
    test_every_allocation(open_and_select, &(struct series_case){write_series(false), 0});
    test_every_allocation(open_and_select, &(struct series_case){write_series(true), 0});
    test_every_allocation(open_and_select, &(struct series_case){write_series(true), TOO_LITTLE});
}

/* Real atlases, their facts by independent readers (docs/spaces.md). */
static void reads_the_mricron_templates(void **state)
{
    (void)state;
    const struct {
        const char *name, *orientation, *transform;
        size_t dim[3], embedded;
        double maximum;
    } wanted[] = {
        {"aal.nii.gz", "RAS", "sform, code 4 (MNI 152)", {181, 217, 181}, 0, 116},
        {"natbrainlab.nii.gz", "LAS", "sform, code 2 (aligned to another)", {157, 189, 136}, 944, 116},
        {"inia19-NeuroMaps.nii.gz", "RAS", "sform, code 1 (scanner)", {168, 206, 128}, 32624, 1605},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        struct volume_file file;
        struct notes notes = {0};
        uint32_t *labels;
        assert_ok(volume_file_open(&file, test_mricron(wanted[i].name), 0, &notes));
        assert_memory_equal(file.info.dim, wanted[i].dim, sizeof wanted[i].dim);
        assert_string_equal(file.info.orientation, wanted[i].orientation);
        assert_string_equal(file.info.transform, wanted[i].transform);
        assert_int_equal(file.embedded.size, wanted[i].embedded);
        assert_ok(label_list_read(&labels, &file));
        assert_near(file.info.minimum, 0, 0);
        assert_near(file.info.maximum, wanted[i].maximum, 0);
        memory_free(labels);
        volume_file_finish(&file);
        notes_finish(&notes);
    }
}

TEST_GROUP(volume_file)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_series_gives_what_each_volume_by_itself_does),
        cmocka_unit_test(a_volume_that_is_not_there_cannot_be_selected),
        cmocka_unit_test(a_series_that_vanishes_stays_as_it_was),
        cmocka_unit_test(every_failing_allocation_of_a_series),
        cmocka_unit_test(reads_the_mricron_templates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
