/* SPDX-License-Identifier: BSD-3-Clause */
/* Labels of a large volume, packed or not, read slab by slab, against all voxels at once. */
#include "base/byte_order.h"
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "label_list.h"
#include "loaders/volumes/volumes.h"
#include "test.h"
#include "volume_on_job.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { NI = 1291, NJ = 61, NK = 28, COUNT = NI * NJ * NK /* 17.6 MB of float64, no whole number of slabs */ };

static const char needed[] = "a labelled volume";

static uint32_t label_at(size_t v)
{
    return 100 + 2 * (uint32_t)(v % NI / 5 + v / NI % 7);
}

/* Writes float64 voxels whose scaled values are those of label_at(); voxel `bad` has another one, COUNT = none. */
static void build(struct nifti_builder *b, size_t bad, size_t extra)
{
    const int64_t dim[3] = {NI, NJ, NK};
    nifti_begin(b, 1, BIG_ENDIAN_IS_SWAPPED ? false : true, VOLUME_FLOAT64, dim);
    nifti_set(b, "scl_slope", 0, 2);
    nifti_set(b, "scl_inter", 0, 100);
    for (size_t row = 0; row < NJ * NK; row++) {
        double values[NI];
        for (size_t i = 0; i < NI; i++) {
            values[i] = row * NI + i == bad ? 0.25 : ((double)label_at(row * NI + i) - 100) / 2;
        }
        buffer_append(&b->bytes, (const char *)values, sizeof values);
    }
    buffer_append(&b->bytes, "xxx", extra);
}

/* write_packed() by zlib's fastest level; `path` has 300 bytes. */
static void write_fast(char *path, const char *name, const struct buffer *bytes)
{
    snprintf(path, 300, "%s", write_bytes(name, &(struct buffer){.data = "", .size = 0}));
    gzFile file = gzopen(path, "wb1");
    assert_non_null(file);
    assert_int_equal(gzfwrite(bytes->data, 1, bytes->size, file), bytes->size);
    assert_int_equal(gzclose(file), Z_OK);
}

/* The first bytes of a file. */
static const char *cut_file(const struct bytes *bytes, size_t size)
{
    struct buffer cut = {0};
    buffer_append(&cut, (const char *)bytes->data, size);
    const char *name = write_bytes("cut.nii.gz", &cut);
    buffer_finish(&cut);
    return name;
}

static conus_status open_slabs(struct volume_file *file, struct label_voxels *labels, const char *path, uint64_t limit,
                               struct notes *notes)
{
    const conus_load_options options = {.max_memory = limit};
    return volume_file_open_labels(file, labels, path, &options, needed, notes);
}

static void labels_and_notes_are_those_of_all_voxels_at_once(void **state)
{
    const char *path = *state;
    struct volume_file file, other;
    struct label_voxels labels = {0};
    struct notes notes = {0};
    struct notes wanted = {0};
    uint32_t *list;
    assert_ok(open_slabs(&file, &labels, path, 0, &notes));
    assert_null(file.voxels.data);
    assert_ok(volume_file_open(&other, path, 0, &wanted));
    assert_ok(label_list_read(&list, &other));
    assert_int_equal(labels.count, COUNT);
    for (size_t v = 0; v < COUNT; v++) {
        if (label_voxels_at(&labels, v) != list[v] || list[v] != label_at(v)) {
            fail_msg("voxel %zu: %u and %u", v, label_voxels_at(&labels, v), list[v]);
        }
    }
    assert_near(file.info.minimum, 100, 0);
    assert_near(file.info.maximum, label_at(6 * NI + NI - 1), 0);
    assert_int_equal(notes.count, 2); /* a grid of more than a metre, bytes after the last voxel */
    assert_string_equal(notes.lines[0], wanted.lines[0]);
    assert_string_equal(notes.lines[1], wanted.lines[1]);
    assert_string_equal(file.info.sha256, other.info.sha256);
    memory_free(list);
    label_voxels_finish(&labels);
    volume_file_finish(&file);
    volume_file_finish(&other);
    notes_finish(&notes);
    notes_finish(&wanted);
}

/* Asserts that both fail with the message of reading at once, whatever was found before the end. */
static void assert_refused_alike(const char *path, const char *part)
{
    char message[600];
    struct volume_file file;
    struct label_voxels labels = {0};
    struct notes notes = {0};
    uint32_t *list = NULL;
    conus_status status = volume_file_open(&file, path, 0, &notes);
    if (!status) {
        status = label_list_read(&list, &file);
        volume_file_finish(&file);
    }
    assert_int_equal(status, CONUS_ERROR_DATA);
    snprintf(message, sizeof message, "%s", conus_message());
    assert_non_null(strstr(message, part));
    assert_fails(open_slabs(&file, &labels, path, 0, &notes), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), message);
    assert_null(labels.labels);
    notes_finish(&notes);
}

static void what_is_wrong_is_said_as_of_all_voxels_at_once(void **state)
{
    (void)state;
    struct nifti_builder b;
    size_t bad = NI * (NJ * (NK - 1) + 7) + 5;
    build(&b, bad, 0);
    char path[300];
    write_fast(path, "slabs.nii.gz", &b.bytes);
    assert_refused_alike(path, "voxel (5, 7, 27): found 100.5 (stored 0.25, scale 2, offset 100), allowed labels");
    struct bytes packed = {0};
    assert_ok(file_read(&packed, path, UINT64_MAX));
    assert_refused_alike(cut_file(&packed, packed.size / 2), "gzip: cut off"); /* before the bad voxel */
    assert_refused_alike(cut_file(&packed, packed.size - 3), "gzip: cut off"); /* and behind it */
    struct buffer wrong = {0};
    buffer_append(&wrong, (const char *)packed.data, packed.size);
    wrong.data[packed.size - 6] ^= 1; /* a byte of the checksum: a whole file, but another one was packed */
    assert_refused_alike(write_bytes("wrong.nii.gz", &wrong), "incorrect data check");
    bytes_finish(&packed);
    buffer_finish(&wrong);
    buffer_finish(&b.bytes);
}

static void what_is_wrong_in_a_plain_file_is_said_alike(void **state)
{
    (void)state;
    struct nifti_builder b;
    build(&b, NI * NJ + 3, 0);
    assert_refused_alike(write_bytes("slabs.nii", &b.bytes), "voxel (3, 0, 1): found 100.5 (stored 0.25, scale 2");
    b.bytes.size -= 5;
    assert_refused_alike(write_bytes("short.nii", &b.bytes), "voxels: the file has 17640571 bytes, the header asks");
    buffer_finish(&b.bytes);
}

/* The limit holds for the labels, at least 2 bytes each; the plain file itself is not in memory. */
static void the_limit_holds_for_a_plain_file(void **state)
{
    struct volume_file file;
    struct label_voxels labels = {0};
    struct notes notes = {0};
    assert_fails(open_slabs(&file, &labels, *state, 2 * COUNT - 1, &notes), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "(--max-memory)"));
    notes_finish(&notes);
}

static conus_status open_and_finish(void *path)
{
    struct volume_file file;
    struct label_voxels labels = {0};
    struct notes notes = {0};
    conus_status status = open_slabs(&file, &labels, path, 0, &notes);
    if (!status) {
        volume_file_finish(&file);
    }
    label_voxels_finish(&labels);
    notes_finish(&notes);
    return status;
}

static void every_failing_allocation(void **state)
{
    char *path = *state;
    test_limit_allocations(8 * COUNT - 1); /* the voxels are never there as a whole */
    assert_ok(open_and_finish(path));
    test_limit_allocations(0);
    test_every_allocation(open_and_finish, path);
}

enum { WIDE_EDGE = 162, WIDE = WIDE_EDGE * WIDE_EDGE * WIDE_EDGE };

static uint32_t wide_voxel(size_t volume, size_t i)
{
    return (uint32_t)(i % 97 * (i / 5000 % 600) + volume);
}

/* Two volumes of uint32 in a plain file. */
static const char *make_wide(void)
{
    static const int64_t dim[3] = {WIDE_EDGE, WIDE_EDGE, WIDE_EDGE};
    struct nifti_builder builder;
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
    const char *path = write_bytes("wide.nii", &builder.bytes);
    buffer_finish(&builder.bytes);
    return path;
}

static conus_status open_second(struct volume_file *file, struct label_voxels *labels, const char *path,
                                uint64_t max_memory)
{
    char chosen[8300];
    struct notes notes = {0};
    const conus_load_options options = {.max_memory = max_memory};
    snprintf(chosen, sizeof chosen, "%s,volume=1", path);
    conus_status status = volume_file_open_labels(file, labels, chosen, &options, needed, &notes);
    notes_finish(&notes);
    return status;
}

static void assert_second(const char *path, uint64_t max_memory)
{
    struct volume_file file = {0};
    struct label_voxels labels = {0};
    size_t wrong = 0;
    assert_ok(open_second(&file, &labels, path, max_memory));
    assert_int_equal(labels.count, WIDE);
    for (size_t i = 0; i < WIDE; i++) {
        wrong += label_voxels_at(&labels, i) != wide_voxel(1, i);
    }
    assert_int_equal(wrong, 0);
    label_voxels_finish(&labels);
    volume_file_finish(&file);
}

/* One volume of a plain file: only this volume is in memory. */
static void a_volume_of_a_plain_file_is_read_alone(void **state)
{
    (void)state;
    char path[8192];
    snprintf(path, sizeof path, "%s", make_wide());
    test_limit_allocations((size_t)WIDE * 4 - 1); /* less than the volume, as it is stored */
    assert_second(path, 0);
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
    snprintf(path, sizeof path, "%s", make_wide());
    static bool is_there[96 * 599 + 2];
    uint64_t different = 0;
    for (size_t i = 0; i < WIDE; i++) {
        different += !is_there[wide_voxel(1, i)];
        is_there[wide_voxel(1, i)] = true;
    }
    const uint64_t held = 352 + (uint64_t)WIDE * sizeof(uint16_t) + 512 * different; /* formats.md */
    assert_second(path, held);
    assert_fails(open_second(&file, &labels, path, held / 2), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "different ones, which take 512 bytes each, and 4251528 voxels with 2"));
}

/* Sets *state to the path of a whole file. */
static int write_whole(void **state)
{
    static char path[300];
    struct nifti_builder b;
    build(&b, COUNT, 3);
    write_fast(path, "whole.nii.gz", &b.bytes);
    buffer_finish(&b.bytes);
    *state = path;
    return 0;
}

static int write_plain(void **state)
{
    static char path[300];
    struct nifti_builder b;
    build(&b, COUNT, 3);
    snprintf(path, sizeof path, "%s", write_bytes("whole.nii", &b.bytes));
    buffer_finish(&b.bytes);
    *state = path;
    return 0;
}

TEST_GROUP(label_slabs)
{
    const struct CMUnitTest packed[] = {
        cmocka_unit_test(labels_and_notes_are_those_of_all_voxels_at_once),
        cmocka_unit_test(what_is_wrong_is_said_as_of_all_voxels_at_once),
        cmocka_unit_test(every_failing_allocation),
    };
    const struct CMUnitTest plain[] = {
        cmocka_unit_test(labels_and_notes_are_those_of_all_voxels_at_once),
        cmocka_unit_test(what_is_wrong_in_a_plain_file_is_said_alike),
        cmocka_unit_test(the_limit_holds_for_a_plain_file),
        cmocka_unit_test(every_failing_allocation),
    };
    const struct CMUnitTest second[] = {
        cmocka_unit_test(a_volume_of_a_plain_file_is_read_alone),
        cmocka_unit_test(the_limit_of_a_plain_file_counts_its_labels),
    };
    int failed = cmocka_run_group_tests_name("packed", packed, write_whole, NULL);
    failed += cmocka_run_group_tests_name("plain", plain, write_plain, NULL);
    return failed + cmocka_run_group_tests_name("second", second, NULL, NULL);
}
