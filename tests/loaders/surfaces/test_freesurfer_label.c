/* SPDX-License-Identifier: BSD-3-Clause */
/* FreeSurfer's labels and annotations. tests/corpus/annot/ has the areas that they cut from a surface. */
#include "loaders/surfaces/parts.h"

#include "builders/nifti_builder.h"
#include "sources/source.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

#define HEAD "#!ascii label  , from subject bert vox2ras=TkReg\n"

static void vertices_of_the_list_are_labelled(void **state)
{
    (void)state;
    struct job job = {0};
    size_t count;
    const uint32_t *labels =
        freesurfer_label_read(&job, text_from(HEAD "3\n5 0 0 0 0\r\n2 0 0 0 0\n2 0 0 0 0"), &count);
    static const uint32_t wanted[6] = {0, 0, 1, 0, 0, 1};
    assert_int_equal(count, 6);
    assert_memory_equal(labels, wanted, sizeof wanted);
    assert_ok(job_close(&job, NULL, NULL));
}

enum { VERTICES = 40, ENTRIES = 5 };

/* Vertices from the last to the first, of an area each in turn; "area 0" is entry 1. */
static void make_annot(struct buffer *out)
{
    append_ordered(out, VERTICES, 4, true);
    for (size_t i = VERTICES; i-- > 0;) {
        append_ordered(out, i, 4, true);
        append_ordered(out, 1 + i % ENTRIES, 4, true);
    }
    append_ordered(out, 1, 4, true);
    append_ordered(out, (uint32_t)-2, 4, true);
    append_ordered(out, ENTRIES + 1, 4, true);
    append_ordered(out, 6, 4, true);
    buffer_append(out, "a.txt", 6);
    append_ordered(out, ENTRIES, 4, true);
    for (uint64_t i = 0; i < ENTRIES; i++) {
        append_ordered(out, i + 1, 4, true);
        append_ordered(out, 7, 4, true);
        buffer_format(out, "area %d", (int)i);
        buffer_append(out, "", 1);
        append_ordered(out, i + 1, 4, true);
        buffer_append(out, "\0\0\0\0\0\0\0\0\0\0\0\0", 12);
    }
}

static conus_status read_annot(void *path)
{
    struct job job = {0};
    struct label_table *table = labels_new(&job);
    size_t count;
    struct reader r = source_reader(&job, source_open(&job, path));
    const uint32_t *labels = freesurfer_annot_read(&r, table, &count);
    assert_int_equal(labels != NULL, job_ok(&job));
    if (labels) {
        assert_int_equal(count, VERTICES);
        for (size_t i = 0; i < count; i++) {
            assert_int_equal(labels[i], 1 + i % ENTRIES);
        }
        assert_int_equal(table->count, ENTRIES);
        assert_string_equal(table->entries[4].name, "area 4");
        assert_int_equal(job.notes.count, 0);
    }
    return job_close(&job, NULL, NULL);
}

static void annotations_are_read_from_files(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    make_annot(&bytes);
    for (int packed = 0; packed < 2; packed++) {
        char path[512];
        snprintf(path, sizeof path, "%s", (packed ? write_packed : write_bytes)("x.annot", &bytes));
        assert_ok(read_annot(path));
        test_every_allocation(read_annot, path);
        assert_true(test_every_primitive(read_annot, path) > 30);
        for (size_t size = 0; size < bytes.size; size += packed ? 7 : 1) {
            const struct buffer part = {.data = bytes.data, .size = size};
            snprintf(path, sizeof path, "%s", (packed ? write_packed : write_bytes)("part.annot", &part));
            assert_fails(read_annot(path), CONUS_ERROR_DATA);
        }
    }
    buffer_finish(&bytes);
}

TEST_GROUP(freesurfer_label)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_of_the_list_are_labelled),
        cmocka_unit_test(annotations_are_read_from_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
