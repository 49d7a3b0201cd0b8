/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes as files: packing, pairs, volumes of 4-D files, voxels into labels and values. */
#include "loaders/volumes/volume_file.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "label_list.h"
#include "loaders/volumes/volume_header.h"
#include "loaders/volumes/volume_values.h"
#include "test.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const int64_t small[3] = {3, 2, 2};
enum { SMALL_COUNT = 12 };

static const int all_types[] = {VOLUME_UINT8, VOLUME_INT8,   VOLUME_UINT16, VOLUME_INT16,   VOLUME_UINT32,
                                VOLUME_INT32, VOLUME_UINT64, VOLUME_INT64,  VOLUME_FLOAT32, VOLUME_FLOAT64};

/* Voxel v of a small test volume: 0, 1, 2, ... 10, 127. */
static double small_value(size_t v)
{
    return v == SMALL_COUNT - 1 ? 127 : (double)v;
}

static void begin_small(struct nifti_builder *b, int version, bool big, int datatype)
{
    nifti_begin(b, version, big, datatype, small);
    for (size_t v = 0; v < SMALL_COUNT; v++) {
        nifti_voxel(b, small_value(v));
    }
}

static void open_ok(struct volume_file *file, const char *path)
{
    struct notes notes = {0};
    assert_ok(volume_file_open(file, path, 0, &notes));
    assert_int_equal(notes.count, 0);
}

static void open_fails(const char *path, conus_status status, const char *part)
{
    struct volume_file file;
    struct notes notes = {0};
    assert_fails(volume_file_open(&file, path, 0, &notes), status);
    if (!strstr(conus_message(), part) || strncmp(conus_message(), path, strcspn(path, ",")) != 0) {
        fail_msg("\"%s\" does not begin with the path and say \"%s\"", conus_message(), part);
    }
    assert_int_equal(notes.count, 0);
}

static void assert_small(struct volume_file *file)
{
    uint32_t *labels;
    float *values;
    struct notes notes = {0};
    assert_ok(label_list_read(&labels, file));
    assert_near(file->info.minimum, 0, 0);
    assert_near(file->info.maximum, 127, 0);
    assert_ok(volume_file_values(&values, file, &notes));
    assert_near(file->info.minimum, 0, 0);
    assert_near(file->info.maximum, 127, 0);
    for (size_t v = 0; v < SMALL_COUNT; v++) {
        assert_near(labels[v], small_value(v), 0);
        assert_near(values[v], small_value(v), 0);
    }
    assert_int_equal(notes.count, 0);
    memory_free(labels);
    memory_free(values);
}

static void every_type_order_version_and_packing(void **state)
{
    (void)state;
    for (size_t i = 0; i < 8 * sizeof all_types / sizeof all_types[0]; i++) {
        struct nifti_builder b;
        struct volume_file file;
        bool packed = i & 4;
        begin_small(&b, 1 + (int)(i & 1), i & 2, all_types[i / 8]);
        const char *path = packed ? write_packed("type.nii", &b.bytes) : write_bytes("type.nii.gz", &b.bytes);
        open_ok(&file, path); /* the name lies about the packing */
        assert_string_equal(file.path, path);
        assert_ptr_equal(file.info.path, file.path);
        assert_int_equal(strstr(file.info.format, "gzip") != NULL, packed);
        assert_int_equal(strstr(file.info.format, "big-endian") != NULL, b.big);
        assert_int_equal(file.head.size, i & 1 ? 544 : 352);
        assert_int_equal(file.embedded.size, 0);
        assert_int_equal(strlen(file.info.sha256), 64);
        assert_small(&file);
        volume_file_finish(&file);
        buffer_finish(&b.bytes);
    }
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

static void one_volume_of_a_series(void **state)
{
    (void)state;
    for (size_t i = 0; i < 12; i++) {
        struct volume_file file;
        uint32_t *labels;
        char choice[300];
        size_t chosen = i % 6;
        snprintf(choice, sizeof choice, "%s,volume=%zu", write_series(i < 6), chosen);
        open_ok(&file, choice);
        assert_int_equal(file.info.volume, chosen);
        assert_int_equal(file.info.volume_count, 6);
        assert_int_equal(file.voxels.size, 2 * SMALL_COUNT);
        assert_null(strchr(file.path, ','));
        assert_ok(label_list_read(&labels, &file));
        for (size_t v = 0; v < SMALL_COUNT; v++) {
            assert_int_equal(labels[v], 10 * chosen + v);
        }
        memory_free(labels);
        volume_file_finish(&file);
    }
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
    assert_int_equal(file->head.size, alone.head.size);
    assert_memory_equal(file->head.data, alone.head.data, alone.head.size);
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

static void folders_may_look_like_choices(void **state)
{
    (void)state;
    const char *folder = test_scratch("x,volume=7");
    struct volume_file file;
    struct nifti_builder b;
    assert_true(mkdir(folder, 0777) == 0 || errno == EEXIST);
    begin_small(&b, 1, false, VOLUME_UINT8);
    const char *path = write_bytes("x,volume=7/y.nii", &b.bytes);
    char choice[300];
    snprintf(choice, sizeof choice, "%s,volume=0", path);
    open_ok(&file, choice);
    assert_string_equal(file.path, path);
    volume_file_finish(&file);
    open_ok(&file, path);
    volume_file_finish(&file);
    buffer_finish(&b.bytes);
}

static void choices_that_are_none(void **state)
{
    (void)state;
    const struct {
        const char *choice, *part;
    } cases[] = {
        {"", "volume: the file has 6, choose one by adding \",volume=K\", K from 0 to 5"},
        {",volume=6", "volume: found 6, allowed are 0 to 5"},
        {",volume=-1", "volume: found \"-1\", allowed are whole numbers from 0"},
        {",volume=", "volume: found \"\""},
        {",volume=1.5", "volume: found \"1.5\""},
        {",volume=99999999999999999999", "volume: found \"9999"},
    };
    char series[256];
    snprintf(series, sizeof series, "%s", write_series(false));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char path[300];
        snprintf(path, sizeof path, "%s%s", series, cases[i].choice);
        open_fails(path, CONUS_ERROR_ARGUMENT, cases[i].part);
    }
}

static void remove_pair(void)
{
    const char *const names[] = {"p.hdr", "p.img", "p.hdr.gz", "p.img.gz"};
    for (size_t i = 0; i < 4; i++) {
        unlink(test_scratch(names[i]));
    }
}

/* Writes the two halves, packed or not, with names that say so; `offset` bytes come before the voxels of the image. */
static void write_pair(int version, bool packed_header, bool packed_image, size_t offset)
{
    static const char filler[16] = "before voxels...";
    struct nifti_builder b;
    struct nifti_builder image = {.version = version, .datatype = VOLUME_INT16};
    remove_pair();
    nifti_begin(&b, version, false, VOLUME_INT16, small);
    nifti_make_pair(&b);
    nifti_extend(&b, 16, 6, "comment!", 8);
    nifti_set(&b, "vox_offset", 0, (double)offset);
    buffer_append(&image.bytes, filler, offset);
    for (size_t v = 0; v < SMALL_COUNT; v++) {
        nifti_voxel(&image, small_value(v));
    }
    (packed_header ? write_packed : write_bytes)(packed_header ? "p.hdr.gz" : "p.hdr", &b.bytes);
    (packed_image ? write_packed : write_bytes)(packed_image ? "p.img.gz" : "p.img", &image.bytes);
    buffer_finish(&b.bytes);
    buffer_finish(&image.bytes);
}

static void pairs_open_by_either_half(void **state)
{
    (void)state;
    for (unsigned i = 0; i < 16; i++) {
        bool packed_header = i & 1;
        bool packed_image = i & 2;
        struct volume_file file;
        write_pair(i & 8 ? 2 : 1, packed_header, packed_image, i & 4 ? 16 : 0);
        const char *image = test_scratch(packed_image ? "p.img.gz" : "p.img");
        open_ok(&file, i & 4 ? image : test_scratch(packed_header ? "p.hdr.gz" : "p.hdr"));
        assert_string_equal(file.path, image);
        assert_non_null(strstr(file.info.format, i & 8 ? "NIfTI-2 pair" : "NIfTI-1 pair"));
        assert_int_equal(file.extension_count, 1);
        assert_memory_equal(file.extensions[0].data, "comment!", 8);
        assert_small(&file);
        volume_file_finish(&file);
    }
}

static void pairs_may_be_in_capitals(void **state)
{
    (void)state;
    struct volume_file file;
    write_pair(1, false, true, 0);
    assert_int_equal(rename(test_scratch("p.hdr"), test_scratch("P.HDR")), 0);
    assert_int_equal(rename(test_scratch("p.img.gz"), test_scratch("P.IMG.gz")), 0);
    open_ok(&file, test_scratch("P.HDR"));
    assert_small(&file);
    volume_file_finish(&file);
    open_ok(&file, test_scratch("P.IMG.gz"));
    volume_file_finish(&file);
}

static void broken_pairs_are_named(void **state)
{
    (void)state;
    struct nifti_builder b;
    write_pair(1, true, false, 0);
    unlink(test_scratch("p.img"));
    open_fails(test_scratch("p.hdr.gz"), CONUS_ERROR_IO, "the other half of the pair is missing");
    write_pair(1, false, true, 0);
    unlink(test_scratch("p.hdr"));
    open_fails(test_scratch("p.img.gz"), CONUS_ERROR_IO, "the other half of the pair is missing");
    write_pair(1, false, false, 0);
    assert_ok(file_write(test_scratch("p.img"), "short", 5));
    open_fails(test_scratch("p.img"), CONUS_ERROR_DATA, "voxels: the file has 5 bytes, the header asks for 24");
    begin_small(&b, 1, false, VOLUME_UINT8);
    write_bytes("p.hdr", &b.bytes); /* a single file in the place of a header */
    struct volume_file file;
    struct notes notes = {0};
    assert_fails(volume_file_open(&file, test_scratch("p.img"), 0, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "p.hdr: magic: found that of a single file"));
    nifti_make_pair(&b);
    open_fails(write_bytes("half.nii", &b.bytes), CONUS_ERROR_DATA, "magic: found that of a .hdr/.img pair");
    buffer_finish(&b.bytes);
    remove_pair();
}

static void text_before_the_voxels_is_kept(void **state)
{
    (void)state;
    struct nifti_builder b;
    struct volume_file file;
    nifti_begin(&b, 1, false, VOLUME_UINT8, small);
    nifti_extend(&b, 16, 6, "comment!", 8);
    nifti_gap(&b,
              "\0\0\0\0\0\0\0\0"
              "1\tOne\n2\tTwo\n    \0\0\0",
              27);
    for (size_t v = 0; v < SMALL_COUNT; v++) {
        nifti_voxel(&b, small_value(v));
    }
    open_ok(&file, write_packed("gap.nii.gz", &b.bytes));
    assert_int_equal(file.extension_count, 1);
    assert_int_equal(file.embedded.size, 16);
    assert_memory_equal(file.embedded.data, "1\tOne\n", 6);
    assert_small(&file);
    volume_file_finish(&file);
    buffer_finish(&b.bytes);
}

static void bytes_behind_the_voxels_are_noted(void **state)
{
    (void)state;
    for (int packed = 0; packed < 2; packed++) {
        struct nifti_builder b;
        struct volume_file file;
        struct notes notes = {0};
        begin_small(&b, 1, false, VOLUME_INT16);
        buffer_text(&b.bytes, "trailing");
        const char *path = packed ? write_packed("more.nii", &b.bytes) : write_bytes("more.nii", &b.bytes);
        assert_ok(volume_file_open(&file, path, 0, &notes));
        assert_int_equal(notes.count, 1);
        assert_non_null(strstr(notes.lines[0], "more.nii: 8 bytes after the last voxel were ignored"));
        assert_small(&file);
        notes_finish(&notes);
        volume_file_finish(&file);
        buffer_finish(&b.bytes);
    }
}

static void memory_is_capped_before_it_is_taken(void **state)
{
    (void)state;
    const int64_t dim[3] = {1100, 1100, 1100};
    struct nifti_builder b;
    struct volume_file file;
    struct notes notes = {0};
    nifti_begin(&b, 1, false, VOLUME_UINT8, dim);
    const char *path = write_packed("claims.nii.gz", &b.bytes);
    assert_fails(volume_file_open(&file, path, 1 << 30, &notes), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "take 1331000000 bytes unpacked, allowed are 1073741824 (--max-memory)"));
    open_fails(path, CONUS_ERROR_DATA, "cannot unpack to the 1331000352 that the header asks for");
    open_fails(write_bytes("claims.nii", &b.bytes), CONUS_ERROR_DATA, "voxels: the file has 352 bytes");
    buffer_finish(&b.bytes);
    begin_small(&b, 1, false, VOLUME_UINT8);
    assert_fails(volume_file_open(&file, write_bytes("file.nii", &b.bytes), 100, &notes), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "--max-memory"));
    buffer_finish(&b.bytes);
}

static void other_files_are_refused(void **state)
{
    (void)state;
    const struct {
        const char *content, *part;
    } cases[] = {
        {"", "content: the file is empty"},
        {"x", "content: found plain text, \"x\""},
        {"\1\2x",
         "content: found \"..x\"; needed is a volume (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC or OME-Zarr)"},
        {"<!DOCTYPE html><html>", "this is a web page; needed is a volume"},
        {"1 Precentral_L\n", "this is a label table: give it as --labels"},
        {"\x1f\x8b\x08", "content: the file unpacks to nothing: it is empty or cut off"},
        {"\x1f\x8b\x08 not deflate at all", "gzip: damaged"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        buffer_text(&bytes, cases[i].content);
        open_fails(write_bytes("other.nii", &bytes), CONUS_ERROR_DATA, cases[i].part);
        buffer_finish(&bytes);
    }
    open_fails("/nowhere/at all.nii", CONUS_ERROR_IO, "cannot open");
    open_fails("/", CONUS_ERROR_IO, "is a folder");
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    for (int packed = 0; packed < 2; packed++) {
        struct nifti_builder b;
        struct buffer bytes = {0};
        nifti_begin(&b, 1, true, VOLUME_INT16, small);
        nifti_extend(&b, 16, 6, "comment!", 8);
        for (size_t v = 0; v < SMALL_COUNT; v++) {
            nifti_voxel(&b, small_value(v));
        }
        if (packed) {
            append_gzip(&bytes, b.bytes.data, b.bytes.size);
        } else {
            buffer_append(&bytes, b.bytes.data, b.bytes.size);
        }
        for (size_t size = 0; size < bytes.size; size++) {
            const struct buffer prefix = {.data = bytes.data, .size = size};
            open_fails(write_bytes("prefix.nii", &prefix), CONUS_ERROR_DATA, ": ");
        }
        buffer_finish(&bytes);
        buffer_finish(&b.bytes);
    }
}

static conus_status open_and_decode(void *path)
{
    struct volume_file file = {0};
    struct notes notes = {0};
    uint32_t *labels = NULL;
    float *values = NULL;
    conus_status status = volume_file_open(&file, path, 0, &notes);
    if (!status) {
        status = label_list_read(&labels, &file);
    }
    if (!status) {
        status = volume_file_values(&values, &file, &notes);
    }
    memory_free(labels);
    memory_free(values);
    notes_finish(&notes);
    volume_file_finish(&file);
    return status;
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

static void every_failing_allocation(void **state)
{
    (void)state;
    struct nifti_builder b;
    nifti_begin(&b, 1, false, VOLUME_FLOAT32, small);
    nifti_set(&b, "sform_code", 0, 0); /* makes a note */
    nifti_extend(&b, 16, 6, "comment!", 8);
    for (size_t v = 0; v < SMALL_COUNT; v++) {
        nifti_voxel(&b, small_value(v));
    }
    buffer_text(&b.bytes, "more"); /* makes another, by way of zlib */
    test_every_allocation(open_and_decode, (void *)(uintptr_t)write_packed("allocation.nii.gz", &b.bytes));
    test_every_allocation(open_and_decode, (void *)(uintptr_t)write_bytes("allocation.nii", &b.bytes));
    buffer_finish(&b.bytes);
    write_pair(2, true, true, 0);
    test_every_allocation(open_and_decode, (void *)(uintptr_t)test_scratch("p.hdr.gz"));
    test_every_allocation(open_and_decode, (void *)(uintptr_t)test_scratch("p.img.gz"));
    remove_pair();
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
        cmocka_unit_test(every_type_order_version_and_packing),
        cmocka_unit_test(one_volume_of_a_series),
        cmocka_unit_test(a_series_gives_what_each_volume_by_itself_does),
        cmocka_unit_test(a_volume_that_is_not_there_cannot_be_selected),
        cmocka_unit_test(a_series_that_vanishes_stays_as_it_was),
        cmocka_unit_test(folders_may_look_like_choices),
        cmocka_unit_test(choices_that_are_none),
        cmocka_unit_test(pairs_open_by_either_half),
        cmocka_unit_test(pairs_may_be_in_capitals),
        cmocka_unit_test(broken_pairs_are_named),
        cmocka_unit_test(text_before_the_voxels_is_kept),
        cmocka_unit_test(bytes_behind_the_voxels_are_noted),
        cmocka_unit_test(memory_is_capped_before_it_is_taken),
        cmocka_unit_test(other_files_are_refused),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(every_failing_allocation_of_a_series),
        cmocka_unit_test(every_failing_allocation),
        cmocka_unit_test(reads_the_mricron_templates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
