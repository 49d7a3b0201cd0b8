/* SPDX-License-Identifier: BSD-3-Clause */
/* Labels that take the place of voxels, and sparse maps of values; tests/corpus/nifti/ has single labels and values. */
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "label_list.h"
#include "loaders/volumes/volumes.h"
#include "test.h"
#include "volume_on_job.h"

#include <string.h>

static const int all_types[] = {VOLUME_UINT8, VOLUME_INT8,   VOLUME_UINT16, VOLUME_INT16,   VOLUME_UINT32,
                                VOLUME_INT32, VOLUME_UINT64, VOLUME_INT64,  VOLUME_FLOAT32, VOLUME_FLOAT64};

static void open_ok(struct volume_file *file, const char *path)
{
    struct notes notes = {0};
    assert_ok(volume_file_open(file, path, 0, &notes));
    assert_int_equal(notes.count, 0);
}

/* Labels that replace the voxels equal those made beside them, for every type, narrow and wide: the decoder writes
 * blocks where others still wait to be read. Scaled int16 has 65,536 labels that are not 0, one too many for places of
 * 2 bytes; its places cannot stay where they are. */
static void labels_may_take_the_place_of_the_voxels(void **state)
{
    (void)state;
    const int64_t dim[3] = {331, 200, 1};
    for (size_t i = 0; i < sizeof all_types / sizeof all_types[0]; i++) {
        struct nifti_builder b;
        struct volume_file file;
        uint32_t *labels;
        struct label_voxels taken = {0};
        size_t size = volume_datatype_size(all_types[i]);
        nifti_begin(&b, 1, i & 1, all_types[i], dim);
        nifti_set(&b, "scl_slope", 0, 1);
        nifti_set(&b, "scl_inter", 0, all_types[i] == VOLUME_INT8 ? 200 : 40000);
        for (size_t v = 0; v < 331 * 200; v++) {
            double few = all_types[i] == VOLUME_INT16 ? (double)(v % 65536) - 32768 : (double)(v % 65536);
            nifti_voxel(&b, size == 1 ? (double)(v / 7 % 100) : size == 2 ? few : (double)v);
        }
        open_ok(&file, write_bytes("place.nii", &b.bytes));
        assert_ok(label_list_read(&labels, &file));
        double range[] = {file.info.minimum, file.info.maximum};
        assert_ok(volume_file_take_labels(&taken, &file));
        assert_null(file.voxels.data);
        assert_int_equal(taken.wide != NULL, size > 1);
        assert_int_equal(taken.count, 331 * 200);
        for (size_t v = 0; v < taken.count; v++) {
            assert_int_equal(label_voxels_at(&taken, v), labels[v]);
        }
        assert_near(file.info.minimum, range[0], 0);
        assert_near(file.info.maximum, range[1], 0);
        label_voxels_finish(&taken);
        memory_free(labels);
        volume_file_finish(&file);
        buffer_finish(&b.bytes);
    }
}

/* More voxels than one block of the decoder, the bad one in the last. */
static void late_voxels_are_found(void **state)
{
    (void)state;
    const int64_t dim[3] = {70, 61, 3};
    struct nifti_builder b;
    struct volume_file file;
    uint32_t *labels;
    nifti_begin(&b, 1, true, VOLUME_FLOAT32, dim);
    for (int64_t v = 0; v < 70 * 61 * 3; v++) {
        nifti_voxel(&b, v == 2 * 4270 + 60 * 70 + 69 ? 0.25 : (double)v);
    }
    open_ok(&file, write_packed("late.nii.gz", &b.bytes));
    assert_fails(label_list_read(&labels, &file), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "voxel (69, 60, 2): found 0.25"));
    volume_file_finish(&file);
    buffer_finish(&b.bytes);
}

/* A file of random voxels, most of them with the bits of the background. */
static void open_sparse(struct volume_file *file, int datatype, bool big, double slope, uint64_t background,
                        uint64_t *random)
{
    const int64_t dim[3] = {21, 17, 13};
    struct nifti_builder b;
    nifti_begin(&b, 1, big, datatype, dim);
    nifti_set(&b, "scl_slope", 0, slope);
    nifti_set(&b, "scl_inter", 0, slope == 1 ? 0 : 0.25);
    for (int64_t v = 0; v < dim[0] * dim[1] * dim[2]; v++) {
        bool full = v / 300 % 4 == 1 && test_random(random, 0, 1) < 0.5;
        nifti_voxel_bits(&b, full ? (uint64_t)test_random(random, 0, 0x1p63) << 1 : background);
    }
    open_ok(file, write_bytes("sparse.nii", &b.bytes));
    buffer_finish(&b.bytes);
}

typedef conus_status as_array(float **out, struct volume_file *file, struct notes *notes);
typedef conus_status as_map(struct value_map *out, struct volume_file *file, struct notes *notes);

static void check_same_values(struct volume_file *file, as_array *array, as_map *sparse)
{
    struct notes notes[2] = {{0}, {0}};
    struct value_map map;
    float *values = NULL;
    double range[2];
    assert_ok(array(&values, file, &notes[0]));
    range[0] = file->info.minimum;
    range[1] = file->info.maximum;
    assert_ok(sparse(&map, file, &notes[1]));
    assert_memory_equal(&file->info.minimum, &range[0], sizeof *range);
    assert_memory_equal(&file->info.maximum, &range[1], sizeof *range);
    assert_int_equal(notes[0].count, notes[1].count);
    for (size_t i = 0; i < notes[0].count; i++) {
        assert_string_equal(notes[0].lines[i], notes[1].lines[i]);
    }
    for (size_t v = 0; v < map.count; v++) {
        float value = value_map_at(&map, v);
        assert_memory_equal(&value, &values[v], sizeof value);
    }
    value_map_finish(&map);
    memory_free(values);
    notes_finish(&notes[0]);
    notes_finish(&notes[1]);
}

/* Random bits are NaN or infinite now and then, and a slope takes more of them out of range. */
static void a_sparse_map_has_the_values_of_every_type(void **state)
{
    (void)state;
    uint64_t random = 44;
    for (size_t t = 0; t < sizeof all_types / sizeof *all_types; t++) {
        for (int k = 0; k < 8; k++) {
            static const double slopes[] = {1, 0.01, -2, 1e36};
            struct volume_file file;
            open_sparse(&file, all_types[t], k / 4, slopes[k % 4], 0, &random);
            check_same_values(&file, volume_file_values, volume_file_map);
            check_same_values(&file, volume_file_values_or_nan, volume_file_map_or_nan);
            volume_file_finish(&file);
        }
    }
}

static void a_background_that_is_no_number_is_counted(void **state)
{
    (void)state;
    static const uint64_t nan_bits[] = {0x7fc00000, 0x7ff8000000000000};
    uint64_t random = 47;
    for (int k = 0; k < 4; k++) {
        struct volume_file file;
        open_sparse(&file, k / 2 ? VOLUME_FLOAT64 : VOLUME_FLOAT32, k % 2, 1, nan_bits[k / 2], &random);
        check_same_values(&file, volume_file_values, volume_file_map);
        volume_file_finish(&file);
    }
}

static conus_status make_map(void *file)
{
    struct notes notes = {0};
    struct value_map map = {0};
    conus_status status = volume_file_map(&map, file, &notes);
    value_map_finish(&map);
    notes_finish(&notes);
    return status;
}

static void making_a_map_survives_every_failing_allocation(void **state)
{
    (void)state;
    uint64_t random = 45;
    struct volume_file file;
    open_sparse(&file, VOLUME_UINT16, false, 1e36, 0, &random);
    test_every_allocation(make_map, &file);
    volume_file_finish(&file);
}

TEST_GROUP(volume_values)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sparse_map_has_the_values_of_every_type),
        cmocka_unit_test(a_background_that_is_no_number_is_counted),
        cmocka_unit_test(making_a_map_survives_every_failing_allocation),
        cmocka_unit_test(labels_may_take_the_place_of_the_voxels),
        cmocka_unit_test(late_voxels_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
