/* SPDX-License-Identifier: BSD-3-Clause */
/* MetaImage volumes against the closed form of ITK's placement, and files with every field changed. */
#include "loaders/volumes/text/text_volume.h"

#include "base/memory.h"
#include "builders/bent_text.h"
#include "builders/nifti_builder.h"
#include "label_list.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_values.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

/* 2 x 3 x 2 voxels of 2 x 3 x 4 mm. i leads to y, j to -x, k to z of LPS; the first voxel is at LPS (10, 20, 30). */
static const char plain[] = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                            "CompressedData = False\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20 30\n"
                            "CenterOfRotation = 0 0 0\nAnatomicalOrientation = ALI\nElementSpacing = 2 3 4\n"
                            "DimSize = 2 3 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";

static void append_counting(struct buffer *bytes, size_t count, size_t size, bool big)
{
    for (size_t i = 0; i < count; i++) {
        append_ordered(bytes, i, size, big);
    }
}

static conus_status parse_bent(struct text_volume *out, const char *from, const char *to, struct notes *notes)
{
    struct buffer bytes = {0};
    append_bent(&bytes, plain, from, to);
    conus_status status = parse_header(out, metaimage_parse, &bytes, notes);
    buffer_finish(&bytes);
    return status;
}

/* Opens the changed header with `voxels` behind it. */
static conus_status open_bent(struct volume_file *file, const char *from, const char *to, const struct buffer *voxels,
                              const char *choice)
{
    struct buffer bytes = {0};
    struct notes notes = {0};
    char path[300];
    append_bent(&bytes, plain, from, to);
    buffer_append(&bytes, voxels->data, voxels->size);
    snprintf(path, sizeof path, "%s%s", write_bytes("bent.mha", &bytes), choice);
    conus_status status = volume_file_open(file, path, 0, &notes);
    notes_finish(&notes);
    buffer_finish(&bytes);
    return status;
}

static void check_labels(struct volume_file *file, size_t count, size_t first, size_t step)
{
    uint32_t *labels;
    assert_ok(label_list_read(&labels, file));
    for (size_t v = 0; v < count; v++) {
        assert_int_equal(labels[v], first + step * v);
    }
    memory_free(labels);
    volume_file_finish(file);
}

/* RAS = diag(-1, -1, 1) LPS; the columns of LPS are (0, 2, 0), (-3, 0, 0), (0, 0, 4). */
static void placement_is_itks(void **state)
{
    (void)state;
    static const char *const same[][2] = {{NULL, NULL},
                                          {"TransformMatrix", "Rotation"},
                                          {"TransformMatrix", "Orientation"},
                                          {"Offset", "Position"},
                                          {"Offset", "Origin"},
                                          {"ElementSpacing", "ElementSize"},
                                          {"= ALI", "= PRS"},
                                          {"= ALI", "= ???"}};
    const double wanted[16] = {0, -2, 0, 0, 3, 0, 0, 0, 0, 0, 4, 0, -10, -20, 30, 1};
    for (size_t i = 0; i < sizeof same / sizeof same[0]; i++) {
        struct text_volume volume;
        struct notes notes = {0};
        assert_ok(parse_bent(&volume, same[i][0], same[i][1], &notes));
        assert_int_equal(notes.count, 0);
        for (int k = 0; k < 16; k++) {
            assert_near(volume.world_from_voxel[k], wanted[k], 1e-12);
        }
        end_header();
    }
}

static void truth_has_several_words(void **state)
{
    (void)state;
    static const struct {
        const char *word;
        bool big;
    } words[] = {{"True", true},   {"true", true}, {"T", true},  {"t", true}, {"1", true},
                 {"False", false}, {"F", false},   {"f", false}, {"0", false}};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        struct text_volume volume;
        struct notes notes = {0};
        char line[64];
        snprintf(line, sizeof line, "MSB = %s", words[i].word);
        assert_ok(parse_bent(&volume, "MSB = False", line, &notes));
        assert_int_equal(volume.big_endian, words[i].big);
        end_header();
    }
}

static void units_scale_the_matrix(void **state)
{
    (void)state;
    struct text_volume volume;
    struct notes notes = {0};
    assert_ok(parse_bent(&volume, "DimSize", "DistanceUnits = um\nDimSize", &notes));
    assert_near(volume.world_from_voxel[1], -0.002, 1e-12);
    assert_near(volume.world_from_voxel[14], 0.03, 1e-12);
    end_header();
}

static void defaults_are_noted(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        {"TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20 30\nCenterOfRotation = 0 0 0\nAnatomicalOrientation = "
         "ALI\n",
         "Offset = 1 2 3\n", "TransformMatrix is missing: ITK's default was used"},
        {"Offset = 10 20 30\n", "", "Offset is missing: ITK's default was used"},
        {"= ALI", "= RSA", "AnatomicalOrientation says RSA, which TransformMatrix contradicts"},
    };
    for (size_t i = 0; i < 3; i++) {
        struct text_volume volume;
        struct notes notes = {0};
        assert_ok(parse_bent(&volume, cases[i][0], cases[i][1], &notes));
        assert_int_equal(notes.count, 1);
        assert_non_null(strstr(notes.lines[0], cases[i][2]));
        notes_finish(&notes);
        end_header();
    }
}

static void integers_of_every_type(void **state)
{
    (void)state;
    static const struct {
        const char *name, *datatype;
        size_t size;
    } types[] = {{"MET_CHAR", "int8", 1},        {"MET_UCHAR", "uint8", 1},  {"MET_SHORT", "int16", 2},
                 {"MET_USHORT", "uint16", 2},    {"MET_INT", "int32", 4},    {"MET_UINT", "uint32", 4},
                 {"MET_LONG", "int32", 4},       {"MET_ULONG", "uint32", 4}, {"MET_LONG_LONG", "int64", 8},
                 {"MET_ULONG_LONG", "uint64", 8}};
    for (size_t i = 0; i < 20; i++) {
        struct buffer voxels = {0};
        struct buffer head = {0};
        struct volume_file file;
        struct notes notes = {0};
        append_bent(&head, plain, "MET_UCHAR", types[i / 2].name);
        struct buffer bytes = {0};
        static const char *const orders[4] = {"BinaryDataByteOrderMSB = False", "BinaryDataByteOrderMSB = True",
                                              "ElementByteOrderMSB = False", "ElementByteOrderMSB = True"};
        append_bent(&bytes, head.data, orders[0], orders[i % 2 + (i % 4 ? 2 : 0)]);
        append_counting(&voxels, 12, types[i / 2].size, i % 2);
        buffer_append(&bytes, voxels.data, voxels.size);
        assert_ok(volume_file_open(&file, write_bytes("type.mha", &bytes), 0, &notes));
        assert_string_equal(file.info.datatype, types[i / 2].datatype);
        check_labels(&file, 12, 0, 1);
        buffer_finish(&bytes);
        buffer_finish(&head);
        buffer_finish(&voxels);
    }
}

static void append_zlib(struct buffer *out, const struct buffer *data)
{
    uint8_t packed[200];
    uLongf size = sizeof packed;
    assert_int_equal(compress(packed, &size, (const Bytef *)data->data, data->size), Z_OK);
    buffer_append(out, packed, size);
}

static void packed_and_text_voxels(void **state)
{
    (void)state;
    struct volume_file file;
    struct buffer voxels = {0};
    struct buffer packed = {0};
    struct buffer gzip = {0};
    struct buffer words = {0};
    char size[120];
    append_counting(&voxels, 12, 1, false);
    append_zlib(&packed, &voxels);
    append_gzip(&gzip, voxels.data, voxels.size);
    buffer_text(&words, "0 1 2 3 4 5 6 7 8 9 10 11\n");
    assert_ok(open_bent(&file, "CompressedData = False", "CompressedData = True", &packed, ""));
    assert_string_equal(file.info.format, "MetaImage, zlib, little-endian");
    check_labels(&file, 12, 0, 1);
    assert_ok(open_bent(&file, "CompressedData = False", "CompressedData = True", &gzip, ""));
    check_labels(&file, 12, 0, 1);
    snprintf(size, sizeof size, "CompressedData = True\nCompressedDataSize = %zu", packed.size);
    assert_ok(open_bent(&file, "CompressedData = False", size, &packed, ""));
    check_labels(&file, 12, 0, 1);
    snprintf(size, sizeof size, "CompressedData = True\nCompressedDataSize = %zu", packed.size + 1);
    assert_fails(open_bent(&file, "CompressedData = False", size, &packed, ""), CONUS_ERROR_DATA);
    assert_said("CompressedDataSize: found ");
    snprintf(size, sizeof size, "CompressedData = True\nCompressedDataSize = %zu", packed.size - 1);
    assert_fails(open_bent(&file, "CompressedData = False", size, &packed, ""), CONUS_ERROR_DATA);
    snprintf(size, sizeof size, "CompressedDataSize: found %zu, the file has %zu bytes of voxels: gzip",
             packed.size - 1, packed.size);
    assert_said(size);
    assert_ok(open_bent(&file, "BinaryData = True", "BinaryData = False", &words, ""));
    check_labels(&file, 12, 0, 1);
    packed.data[packed.size - 1] ^= 1; /* its checksum */
    assert_fails(open_bent(&file, "CompressedData = False", "CompressedData = True", &packed, ""), CONUS_ERROR_DATA);
    assert_said("gzip: damaged");
    buffer_finish(&voxels);
    buffer_finish(&packed);
    buffer_finish(&gzip);
    buffer_finish(&words);
}

/* Channels lie together, volumes of a fourth axis one behind the other. */
static void volumes_come_apart(void **state)
{
    (void)state;
    struct volume_file file;
    struct buffer voxels = {0};
    append_counting(&voxels, 24, 1, false);
    assert_ok(open_bent(&file, "DimSize", "ElementNumberOfChannels = 2\nDimSize", &voxels, ",volume=1"));
    check_labels(&file, 12, 1, 2);
    static const char four[] = "NDims = 4\nBinaryData = True\nTransformMatrix = 0 1 0 0 -1 0 0 0 0 0 1 0 0 0 0 1\n"
                               "Offset = 10 20 30 0\nElementSpacing = 2 3 4 1\nDimSize = 2 3 2 2\n"
                               "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
    struct buffer bytes = {0};
    struct notes notes = {0};
    char path[300];
    buffer_text(&bytes, four);
    buffer_append(&bytes, voxels.data, voxels.size);
    snprintf(path, sizeof path, "%s,volume=1", write_bytes("four.mha", &bytes));
    assert_ok(volume_file_open(&file, path, 0, &notes));
    assert_near(file.info.world_from_voxel[1], -2, 1e-12);
    assert_near(file.info.world_from_voxel[4], 3, 1e-12);
    check_labels(&file, 12, 12, 1);
    buffer_finish(&bytes);
    buffer_finish(&voxels);
}

static void detached_voxels_are_found(void **state)
{
    (void)state;
    static const struct {
        const char *fields, *part; /* NULL: right */
    } cases[] = {
        {"HeaderSize = 3\nElementDataFile = m.raw", NULL},
        {"HeaderSize = -1\nElementDataFile = m.raw", NULL},
        {"HeaderSize = 4\nElementDataFile = m.raw", "m.raw: voxels: the file has 15 bytes"},
        {"HeaderSize = -2\nElementDataFile = m.raw", "HeaderSize: found \"-2\""},
        {"HeaderSize = 3\nElementDataFile = LOCAL", "HeaderSize: found 3 beside LOCAL voxels"},
        {"ElementDataFile = none.raw", "bent.mha: the file of the voxels is missing: "},
        {"ElementDataFile = ../m.raw", "ElementDataFile: found \"../m.raw\", allowed is the name of a file in"},
        {"ElementDataFile = /m.raw", "ElementDataFile: found \"/m.raw\""},
        {"ElementDataFile = LIST", "ElementDataFile: found \"LIST\", allowed are LOCAL and one file"},
        {"ElementDataFile = s%02d.raw 1 9 1", "ElementDataFile: found \"s%02d.raw 1 9 1\""},
        {"ElementDataFile =", "ElementDataFile: found \"\""},
    };
    struct buffer raw = {0};
    struct buffer none = {0};
    buffer_text(&raw, "abc");
    append_counting(&raw, 12, 1, false);
    write_bytes("m.raw", &raw);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct volume_file file;
        conus_status status = open_bent(&file, "ElementDataFile = LOCAL", cases[i].fields, &none, "");
        assert_true((status == CONUS_OK) == (cases[i].part == NULL));
        if (cases[i].part) {
            assert_said(cases[i].part);
        } else {
            check_labels(&file, 12, 0, 1);
        }
    }
    buffer_finish(&raw);
}

static void bad_fields_are_named(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        {"= Image", "= Tube", "ObjectType: found \"Tube\", allowed is Image"},
        {"NDims = 3", "NDims = 2", "NDims: found 2, allowed are 3 and 4"},
        {"NDims = 3", "NDims = x", "NDims: found \"x\""},
        {"NDims = 3\n", "", "NDims: missing"},
        {"NDims = 3", "NDims = 3\nNDims = 3", "NDims: found twice"},
        {"Offset = 10 20 30", "Offset = 10 20 30\nPosition = 0 0 0", "Position: found twice"},
        {"Offset = 10 20 30", "Offset = 10 20", "Offset: found \"10 20\", 3 numbers are needed"},
        {"NDims = 3", "NDims = 4", "DimSize: found 3 numbers, NDims is 4"},
        {"DimSize = 2 3 2", "DimSize = 2 0 2", "DimSize: found \"0\""},
        {"DimSize = 2 3 2\n", "", "DimSize: missing"},
        {"ElementSpacing = 2 3 4\n", "", "ElementSpacing: missing"},
        {"ElementSpacing = 2 3 4", "ElementSpacing = 2 -3 4", "ElementSpacing: found -3"},
        {"ElementSpacing = 2 3 4", "ElementSpacing = 2 nan 4", "ElementSpacing: found nan"},
        {"= 0 1 0 -1 0 0 0 0 1", "= 0 1 0 -1 0 0 0 0", "TransformMatrix: found \"0 1 0 -1 0 0 0 0\", 9 numbers"},
        {"MET_UCHAR", "MET_UCHAR_ARRAY", "ElementType: found \"MET_UCHAR_ARRAY\""},
        {"ElementType = MET_UCHAR\n", "", "ElementType: missing"},
        {"BinaryData = True", "BinaryData = yes", "BinaryData: found \"yes\", allowed are True and False"},
        {"BinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False",
         "BinaryData = False\nCompressedData = True", "CompressedData: found True beside BinaryData = False"},
        {"CompressedData = False", "CompressedData = True\nHeaderSize = 3", "HeaderSize: found 3, which only plain"},
        {"DimSize", "ElementToIntensityFunctionSlope = 2\nDimSize",
         "ElementToIntensityFunctionSlope: found 2, allowed"},
        {"DimSize", "DistanceUnits = furlong\nDimSize", "DistanceUnits: found \"furlong\""},
        {"ElementDataFile = LOCAL\n", "", "ElementDataFile: missing"},
        {"CenterOfRotation = 0 0 0", "CenterOfRotation", "header: found the line \"CenterOfRotation\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct text_volume volume;
        struct notes notes = {0};
        conus_status status = parse_bent(&volume, cases[i][0], cases[i][1], &notes);
        assert_true(status == CONUS_ERROR_DATA || status == CONUS_ERROR_UNSUPPORTED);
        assert_said(cases[i][2]);
    }
}

static void bad_grids_are_refused(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        {"= 0 1 0 -1 0 0 0 0 1", "= 0 1 0 0 1 0 0 0 1", "the matrix is singular or not finite"},
        {"= 0 1 0 -1 0 0 0 0 1", "= 0 1 0 -1 0 0 0 0 nan", "the matrix is singular or not finite"},
        {"DimSize = 2 3 2", "DimSize = 4611686018427387903 3 2", "allowed are as many as fit in 2^62 bytes"},
        {"DimSize = 2 3 2", "DimSize = 2147483647 1000 2", "--max-memory"},
        {"DimSize = 2 3 2", "DimSize = 2 3 3", "voxels: the file has"},
        {"MET_UCHAR", "MET_SHORT", "voxels: the file has"},
    };
    struct buffer voxels = {0};
    append_counting(&voxels, 12, 1, false);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct volume_file file;
        assert_true(open_bent(&file, cases[i][0], cases[i][1], &voxels, "") != CONUS_OK);
        assert_said(cases[i][2]);
    }
    struct text_volume volume;
    struct notes notes = {0};
    struct buffer text = {0};
    append_bent(&text, plain, "BinaryDataByteOrderMSB = False\n", "");
    struct buffer wide = {0};
    append_bent(&wide, text.data, "MET_UCHAR", "MET_SHORT");
    assert_fails(parse_header(&volume, metaimage_parse, &wide, &notes), CONUS_ERROR_DATA);
    assert_said("BinaryDataByteOrderMSB: missing");
    buffer_finish(&wide);
    buffer_finish(&text);
    buffer_finish(&voxels);
}

/* A prefix of a file's name is the name of another file, which does not exist. */
static void every_prefix_is_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    buffer_text(&bytes, plain);
    append_counting(&bytes, 12, 1, false);
    for (size_t size = 0; size < bytes.size; size++) {
        const struct buffer prefix = {.data = bytes.data, .size = size};
        struct volume_file file;
        struct notes notes = {0};
        conus_status status = volume_file_open(&file, write_bytes("prefix.mha", &prefix), 0, &notes);
        assert_true(status == CONUS_ERROR_DATA || status == CONUS_ERROR_IO);
        notes_finish(&notes);
    }
    buffer_finish(&bytes);
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct buffer voxels = {0};
    struct buffer head = {0};
    char path[300];
    append_counting(&voxels, 12, 1, false);
    append_bent(&head, plain, "Offset = 10 20 30\n", ""); /* makes a note */
    append_bent(&bytes, head.data, "CompressedData = False", "CompressedData = True");
    append_zlib(&bytes, &voxels);
    snprintf(path, sizeof path, "%s", write_bytes("all.mha", &bytes));
    test_every_allocation(open_and_close, path);
    assert_true(test_every_primitive(open_and_close, path) > 0);
    buffer_finish(&bytes);
    append_bent(&bytes, plain, "LOCAL", "all.raw");
    write_bytes("all.raw", &voxels);
    snprintf(path, sizeof path, "%s", write_bytes("all.mhd", &bytes));
    test_every_allocation(open_and_close, path);
    assert_true(test_every_primitive(open_and_close, path) > 0);
    buffer_finish(&bytes);
    buffer_finish(&head);
    buffer_finish(&voxels);
}

TEST_GROUP(metaimage)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(placement_is_itks),       cmocka_unit_test(truth_has_several_words),
        cmocka_unit_test(units_scale_the_matrix),  cmocka_unit_test(defaults_are_noted),
        cmocka_unit_test(integers_of_every_type),  cmocka_unit_test(packed_and_text_voxels),
        cmocka_unit_test(volumes_come_apart),      cmocka_unit_test(detached_voxels_are_found),
        cmocka_unit_test(bad_fields_are_named),    cmocka_unit_test(bad_grids_are_refused),
        cmocka_unit_test(every_prefix_is_refused), cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
