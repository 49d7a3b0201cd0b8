/* SPDX-License-Identifier: BSD-3-Clause */
/* Stored voxels into labels and values. */
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "label_list.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_header.h"
#include "loaders/volumes/volume_values.h"
#include "test.h"

#include <math.h>
#include <string.h>

static const int64_t small[3] = {3, 2, 2};
enum { SMALL_COUNT = 12 };

static const int all_types[] = {VOLUME_UINT8, VOLUME_INT8,   VOLUME_UINT16, VOLUME_INT16,   VOLUME_UINT32,
                                VOLUME_INT32, VOLUME_UINT64, VOLUME_INT64,  VOLUME_FLOAT32, VOLUME_FLOAT64};

static void open_ok(struct volume_file *file, const char *path)
{
    struct notes notes = {0};
    assert_ok(volume_file_open(file, path, 0, &notes));
    assert_int_equal(notes.count, 0);
}

/* A volume of 3 x 2 x 2 zeros with `bits` as voxel (1, 0, 1). */
static void open_with_bits(struct volume_file *file, int datatype, bool big, uint64_t bits, double slope, double inter)
{
    struct nifti_builder b;
    nifti_begin(&b, 1, big, datatype, small);
    nifti_set(&b, "scl_slope", 0, slope);
    nifti_set(&b, "scl_inter", 0, inter);
    for (size_t v = 0; v < SMALL_COUNT; v++) {
        nifti_voxel_bits(&b, v == 7 ? bits : 0);
    }
    open_ok(file, write_bytes("bits.nii", &b.bytes));
    buffer_finish(&b.bytes);
}

static uint64_t float_bits(double value)
{
    float single = (float)value;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    return bits;
}

static uint64_t double_bits(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void the_largest_label_of_every_type(void **state)
{
    (void)state;
    const struct {
        int datatype;
        uint64_t bits;
        uint32_t label;
    } cases[] = {
        {VOLUME_UINT8, 255, 255},
        {VOLUME_INT8, 127, 127},
        {VOLUME_UINT16, 65535, 65535},
        {VOLUME_INT16, 32767, 32767},
        {VOLUME_UINT32, UINT32_MAX, UINT32_MAX},
        {VOLUME_INT32, INT32_MAX, INT32_MAX},
        {VOLUME_UINT64, UINT32_MAX, UINT32_MAX},
        {VOLUME_INT64, UINT32_MAX, UINT32_MAX},
        {VOLUME_FLOAT32, float_bits(4294967040.0), 4294967040U},
        {VOLUME_FLOAT64, double_bits(4294967295.0), UINT32_MAX},
        {VOLUME_FLOAT64, double_bits(-0.0), 0},
    };
    for (size_t i = 0; i < 2 * sizeof cases / sizeof cases[0]; i++) {
        struct volume_file file;
        uint32_t *labels;
        uint32_t wanted = cases[i / 2].label;
        open_with_bits(&file, cases[i / 2].datatype, i & 1, cases[i / 2].bits, 0, 0);
        assert_ok(label_list_read(&labels, &file));
        assert_true(labels[7] == wanted);
        assert_near(file.info.maximum, wanted, 0);
        memory_free(labels);
        volume_file_finish(&file);
    }
}

static void values_that_are_no_labels_are_named(void **state)
{
    (void)state;
    const struct {
        int datatype;
        uint64_t bits;
        double slope, inter;
        const char *found;
    } cases[] = {
        {VOLUME_INT8, (uint64_t)-1, 0, 0, "found -1,"},
        {VOLUME_INT16, (uint64_t)-32768, 0, 0, "found -32768,"},
        {VOLUME_INT32, (uint64_t)-7, 0, 0, "found -7,"},
        {VOLUME_INT64, (uint64_t)INT64_MIN, 0, 0, "found -9223372036854775808,"},
        {VOLUME_INT64, UINT64_C(9007199254740993), 0, 0, "found 9007199254740993,"},
        {VOLUME_UINT64, UINT64_C(4294967296), 0, 0, "found 4294967296,"},
        {VOLUME_UINT64, UINT64_MAX, 0, 0, "found 18446744073709551615,"},
        {VOLUME_FLOAT32, 0x40600000, 0, 0, "found 3.5,"},
        {VOLUME_FLOAT32, 0x4f800000, 0, 0, "found 4294967296,"},
        {VOLUME_FLOAT32, 0x7fc00000, 0, 0, "found nan,"},
        {VOLUME_FLOAT64, UINT64_C(0x7ff0000000000000), 0, 0, "found inf,"},
        {VOLUME_FLOAT64, UINT64_C(0x3ff0001000000000), 0, 0, "found 1.0000152587890625,"},
        {VOLUME_FLOAT32, 0x40e0000a, 0, 0, "found 7.000004768371582,"},
        {VOLUME_FLOAT32, 0x49800002, 0, 0, "found 1048576.25,"}, /* in float32, two steps beside a whole number */
        {VOLUME_INT16, 71, 0.1, 0, "found 7.1000001"},
        {VOLUME_UINT8, 3, 0.5, 0, "found 1.5 (stored 3, scale 0.5, offset 0),"},
        {VOLUME_UINT8, 3, -1, 0, "found -3 (stored 3, scale -1, offset 0),"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct volume_file file;
        uint32_t *labels;
        open_with_bits(&file, cases[i].datatype, i & 1, cases[i].bits, cases[i].slope, cases[i].inter);
        assert_fails(label_list_read(&labels, &file), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), "bits.nii: voxel (1, 0, 1): "));
        if (!strstr(conus_message(), cases[i].found)) {
            fail_msg("\"%s\" does not say \"%s\"", conus_message(), cases[i].found);
        }
        volume_file_finish(&file);
    }
}

static void scaled_labels_may_be_whole(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof all_types / sizeof all_types[0]; i++) {
        struct nifti_builder b;
        struct volume_file file;
        uint32_t *labels;
        nifti_begin(&b, 2, i & 1, all_types[i], small);
        nifti_set(&b, "scl_slope", 0, 3);
        nifti_set(&b, "scl_inter", 0, 1000);
        for (size_t v = 0; v < SMALL_COUNT; v++) {
            nifti_voxel(&b, (double)v);
        }
        open_ok(&file, write_bytes("scaled.nii", &b.bytes));
        assert_ok(label_list_read(&labels, &file));
        for (size_t v = 0; v < SMALL_COUNT; v++) {
            assert_near(labels[v], 1000 + 3 * (double)v, 0);
        }
        assert_near(file.info.minimum, 1000, 0);
        memory_free(labels);
        volume_file_finish(&file);
        buffer_finish(&b.bytes);
    }
}

/* What a program that computes in float32 has: (float)stored * (float)slope + (float)inter is the label, or a step of
 * float32 beside it. In double, as here, 70 times float32(0.1) is 7.0000001. */
static void labels_bent_by_single_precision_are_whole(void **state)
{
    (void)state;
    const struct {
        int datatype;
        uint64_t bits;
        double slope, inter;
        uint32_t label;
    } cases[] = {
        {VOLUME_INT16, 70, 0.1, 0, 7},
        {VOLUME_UINT8, 21, 1.0 / 3, 0, 7},
        {VOLUME_UINT16, 1785, 1.0 / 255, 0, 7},
        {VOLUME_INT16, 70, 0.1, 1000, 1007},
        {VOLUME_INT32, 10000010, 0.1, 0, 1000001},
        {VOLUME_FLOAT32, float_bits(70), 0.1, 0, 7},
        {VOLUME_FLOAT32, 0x40dfffff, 0, 0, 7},
        {VOLUME_FLOAT32, 0x40e00002, 0, 0, 7},
        {VOLUME_FLOAT32, float_bits(-1e-9), 0, 0, 0},
        {VOLUME_FLOAT64, double_bits(70 * (double)0.1F), 0, 0, 7},
    };
    for (size_t i = 0; i < 2 * sizeof cases / sizeof cases[0]; i++) {
        struct volume_file file;
        uint32_t *labels;
        const float in_single = (float)cases[i / 2].slope;
        open_with_bits(&file, cases[i / 2].datatype, i & 1, cases[i / 2].bits, (double)in_single, cases[i / 2].inter);
        assert_ok(label_list_read(&labels, &file));
        assert_int_equal(labels[7], cases[i / 2].label);
        assert_int_equal(labels[6], (uint32_t)cases[i / 2].inter);
        memory_free(labels);
        volume_file_finish(&file);
    }
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

static void values_that_are_not_finite_become_zero(void **state)
{
    (void)state;
    const uint64_t bits[] = {UINT64_C(0x7ff8000000000000), UINT64_C(0xfff0000000000000), double_bits(1e300)};
    for (size_t i = 0; i < 3; i++) {
        struct volume_file file;
        struct notes notes = {0};
        float *values;
        open_with_bits(&file, VOLUME_FLOAT64, i & 1, bits[i], 0, 0);
        assert_ok(volume_file_values(&values, &file, &notes));
        assert_near(values[7], 0, 0);
        assert_near(file.info.maximum, 0, 0);
        assert_int_equal(notes.count, 1);
        assert_non_null(strstr(notes.lines[0], "bits.nii: 1 voxels are not finite"));
        memory_free(values);
        notes_finish(&notes);
        volume_file_finish(&file);
    }
}

static void values_are_scaled(void **state)
{
    (void)state;
    struct volume_file file;
    struct notes notes = {0};
    float *values;
    open_with_bits(&file, VOLUME_UINT16, true, 65535, 0.5, -1);
    assert_ok(volume_file_values(&values, &file, &notes));
    assert_near(values[7], 32766.5, 0);
    assert_near(file.info.minimum, -1, 0);
    assert_near(file.info.maximum, 32766.5, 0);
    memory_free(values);
    volume_file_finish(&file);
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
        cmocka_unit_test(the_largest_label_of_every_type),
        cmocka_unit_test(values_that_are_no_labels_are_named),
        cmocka_unit_test(scaled_labels_may_be_whole),
        cmocka_unit_test(labels_bent_by_single_precision_are_whole),
        cmocka_unit_test(labels_may_take_the_place_of_the_voxels),
        cmocka_unit_test(late_voxels_are_found),
        cmocka_unit_test(values_that_are_not_finite_become_zero),
        cmocka_unit_test(values_are_scaled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
