/* SPDX-License-Identifier: BSD-3-Clause */
/* MGH volumes against the closed form of FreeSurfer's placement. */
#include "loaders/volumes/mgh.h"

#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "label_list.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_values.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

enum { TYPE = 20, GOOD_RAS = 28, DELTA = 30, COSINES = 42, CENTRE = 78 };

/* Puts @p value as a big-endian integer of @p size bytes at @p offset. */
static void put(struct buffer *bytes, size_t offset, int64_t value, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        bytes->data[offset + i] = (char)((uint64_t)value >> 8 * (size - 1 - i));
    }
}

static void put_float(struct buffer *bytes, size_t offset, double value)
{
    float single = (float)value;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    put(bytes, offset, bits, 4);
}

/* 2 x 3 x 4 voxels of 1 x 2 x 3 mm, i to the left, j down, k to the front, c_ras (5, 6, 7). */
static void begin(struct buffer *bytes, int type, int frames)
{
    static const uint8_t zeros[MGH_HEADER_SIZE];
    const double cosines[9] = {-1, 0, 0, 0, 0, -1, 0, 1, 0};
    buffer_append(bytes, zeros, sizeof zeros);
    put(bytes, 0, 1, 4);
    for (size_t i = 0; i < 3; i++) {
        put(bytes, 4 + 4 * i, 2 + (int64_t)i, 4);
        put_float(bytes, DELTA + 4 * i, 1 + (double)i);
        put_float(bytes, CENTRE + 4 * i, 5 + (double)i);
    }
    put(bytes, 16, frames, 4);
    put(bytes, TYPE, type, 4);
    put(bytes, GOOD_RAS, 1, 2);
    for (size_t i = 0; i < 9; i++) {
        put_float(bytes, COSINES + 4 * i, cosines[i]);
    }
}

static conus_status parse(struct volume_header *out, const struct buffer *bytes, struct notes *notes)
{
    return mgh_header_parse(out, (const uint8_t *)bytes->data, bytes->size, notes);
}

static void placement_follows_the_closed_form(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct volume_header header;
    struct notes notes = {0};
    begin(&bytes, 0, 1);
    assert_ok(parse(&header, &bytes, &notes));
    assert_int_equal(notes.count, 0);
    const double wanted[16] = {-1, 0, 0, 0, 0, 0, -2, 0, 0, 3, 0, 0, 5 + 1, 6 - 6, 7 + 3, 1};
    for (int i = 0; i < 16; i++) {
        assert_near(header.info.world_from_voxel[i], wanted[i], 1e-6);
    }
    assert_string_equal(header.info.orientation, "LIA");
    assert_string_equal(header.info.transform, "direction cosines and c_ras");
    buffer_finish(&bytes);
}

static void no_good_ras_is_freesurfers_default(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct volume_header header;
    struct notes notes = {0};
    begin(&bytes, 0, 1);
    put(&bytes, GOOD_RAS, 0, 2);
    assert_ok(parse(&header, &bytes, &notes));
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "goodRASFlag is not set"));
    const double wanted[16] = {-1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 1, -2, 1.5, 1};
    for (int i = 0; i < 16; i++) {
        assert_near(header.info.world_from_voxel[i], wanted[i], 1e-6);
    }
    assert_string_equal(header.info.transform, "none: FreeSurfer's default");
    notes_finish(&notes);
    buffer_finish(&bytes);
}

static void voxels_of_every_type_and_frame(void **state)
{
    (void)state;
    const struct {
        int type;
        size_t size;
        const char *datatype;
    } types[] = {{0, 1, "uint8"}, {4, 2, "int16"}, {1, 4, "int32"}, {3, 4, "float32"}};
    for (size_t i = 0; i < 16; i++) {
        struct buffer bytes = {0};
        struct volume_file file;
        struct notes notes = {0};
        uint32_t *labels;
        size_t frame = i % 2;
        begin(&bytes, types[i / 4].type, 2);
        for (size_t v = 0; v < 48; v++) {
            if (types[i / 4].type == 3) {
                append_float(&bytes, (double)v, true);
            } else {
                append_ordered(&bytes, v, types[i / 4].size, true);
            }
        }
        char path[300];
        snprintf(path, sizeof path, "%s,volume=%zu", (i & 2 ? write_packed : write_bytes)("x.mgz", &bytes), frame);
        assert_ok(volume_file_open(&file, path, 0, &notes));
        assert_string_equal(file.info.format, i & 2 ? "MGH, gzip, big-endian" : "MGH, big-endian");
        assert_string_equal(file.info.datatype, types[i / 4].datatype);
        assert_int_equal(file.info.volume_count, 2);
        assert_int_equal(file.embedded.size, 0);
        assert_ok(label_list_read(&labels, &file));
        for (size_t v = 0; v < 24; v++) {
            assert_int_equal(labels[v], 24 * frame + v);
        }
        memory_free(labels);
        volume_file_finish(&file);
        buffer_finish(&bytes);
    }
}

/* FreeSurfer writes scan parameters and tags behind the voxels. */
static void footers_are_no_surprise(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct volume_file file;
    struct notes notes = {0};
    begin(&bytes, 0, 1);
    for (int i = 0; i < 24 + 20; i++) {
        append_ordered(&bytes, 0, 1, true);
    }
    assert_ok(volume_file_open(&file, write_bytes("footer.mgh", &bytes), 0, &notes));
    assert_int_equal(notes.count, 0);
    volume_file_finish(&file);
    buffer_finish(&bytes);
}

static void bad_fields_are_named(void **state)
{
    (void)state;
    const struct {
        size_t offset, size;
        int64_t value;
        const char *part;
        conus_status status;
    } cases[] = {
        {0, 4, 2, "version: found 2, allowed is 1", CONUS_ERROR_DATA},
        {4, 4, 0, "width: found 0, allowed is 1 or more", CONUS_ERROR_DATA},
        {8, 4, -1, "height: found -1", CONUS_ERROR_DATA},
        {12, 4, INT32_MIN, "depth: found -2147483648", CONUS_ERROR_DATA},
        {16, 4, 0, "nframes: found 0", CONUS_ERROR_DATA},
        {TYPE, 4, 2, "type: found 2, allowed are 0 (uchar), 1 (int), 3 (float) and 4 (short)", CONUS_ERROR_UNSUPPORTED},
        {TYPE, 4, -1, "type: found -1", CONUS_ERROR_UNSUPPORTED},
        {DELTA, 4, 0, "spacing x: found 0, allowed are finite numbers above 0", CONUS_ERROR_DATA},
        {DELTA + 8, 4, 0x7fc00000, "spacing z: found nan", CONUS_ERROR_DATA},
        {DELTA + 4, 4, 0xbf800000, "spacing y: found -1", CONUS_ERROR_DATA},
        {COSINES, 4, 0, "direction cosines and c_ras: the matrix is singular", CONUS_ERROR_DATA},
        {CENTRE, 4, 0x7f800000, "direction cosines and c_ras: the matrix is singular or not finite", CONUS_ERROR_DATA},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        struct volume_header header;
        struct notes notes = {0};
        begin(&bytes, 1, 1);
        put(&bytes, cases[i].offset, cases[i].value, cases[i].size);
        assert_fails(parse(&header, &bytes, &notes), cases[i].status);
        if (!strstr(conus_message(), cases[i].part)) {
            fail_msg("\"%s\" does not say \"%s\"", conus_message(), cases[i].part);
        }
        buffer_finish(&bytes);
    }
}

static void sizes_are_multiplied_with_care(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct volume_header header;
    struct notes notes = {0};
    begin(&bytes, 1, 1);
    for (size_t i = 0; i < 4; i++) {
        put(&bytes, 4 + 4 * i, INT32_MAX, 4);
    }
    assert_fails(parse(&header, &bytes, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "allowed are as many as fit in 2^62 bytes"));
    buffer_finish(&bytes);
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    begin(&bytes, 0, 1);
    for (int i = 0; i < 24; i++) {
        append_ordered(&bytes, 1, 1, true);
    }
    for (size_t size = 0; size < bytes.size; size++) {
        const struct buffer prefix = {.data = bytes.data, .size = size};
        struct volume_file file;
        struct notes notes = {0};
        assert_fails(volume_file_open(&file, write_bytes("prefix.mgh", &prefix), 0, &notes), CONUS_ERROR_DATA);
    }
    buffer_finish(&bytes);
}

static conus_status attempt(void *data)
{
    struct volume_header header;
    struct notes notes = {0};
    conus_status status = parse(&header, data, &notes);
    notes_finish(&notes);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    begin(&bytes, 0, 1);
    put(&bytes, GOOD_RAS, 0, 2); /* makes a note */
    test_every_allocation(attempt, &bytes);
    buffer_finish(&bytes);
}

TEST_GROUP(mgh)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(placement_follows_the_closed_form),
        cmocka_unit_test(no_good_ras_is_freesurfers_default),
        cmocka_unit_test(voxels_of_every_type_and_frame),
        cmocka_unit_test(footers_are_no_surprise),
        cmocka_unit_test(bad_fields_are_named),
        cmocka_unit_test(sizes_are_multiplied_with_care),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
