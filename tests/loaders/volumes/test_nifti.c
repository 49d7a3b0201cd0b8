/* SPDX-License-Identifier: BSD-3-Clause */
/* NIfTI headers, with every field changed that can be. */
#include "loaders/volumes/nifti.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

static const int64_t small[3] = {3, 2, 2};

static conus_status parse(struct volume_header *out, const struct nifti_builder *builder, struct notes *notes)
{
    return nifti_header_parse(out, (const uint8_t *)builder->bytes.data, builder->bytes.size, notes);
}

static void assert_matrix(const double got[16], const double rows[12], double tolerance)
{
    for (int i = 0; i < 12; i++) {
        assert_near(got[4 * (i % 4) + i / 4], rows[i], tolerance);
    }
}

static void header_is_read_in_both_versions_and_orders(void **state)
{
    (void)state;
    for (int variant = 0; variant < 4; variant++) {
        struct nifti_builder b;
        struct volume_header header;
        struct notes notes = {0};
        nifti_begin(&b, 1 + variant / 2, variant % 2, VOLUME_INT16, small);
        nifti_set(&b, "dim", 0, 5);
        nifti_set(&b, "dim", 4, 7);
        nifti_set(&b, "dim", 5, 2);
        nifti_set(&b, "intent_code", 0, 1002);
        assert_ok(parse(&header, &b, &notes));
        assert_string_equal(header.info.format, variant < 2 ? "NIfTI-1" : "NIfTI-2");
        assert_string_equal(header.info.datatype, "int16");
        assert_int_equal(header.swapped, (variant % 2 == 1) == (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__));
        assert_int_equal(header.info.dim[0], 3);
        assert_int_equal(header.info.volume_count, 14);
        assert_int_equal(header.volume_size, 24);
        assert_int_equal(header.offset, variant < 2 ? 352 : 544);
        assert_int_equal(header.intent_code, 1002);
        assert_string_equal(header.info.transform, "sform, code 4 (MNI 152)");
        assert_string_equal(header.info.orientation, "RAS");
        assert_near(header.info.spacing[2], 4, 0);
        assert_matrix(header.info.world_from_voxel, (double[]){2, 0, 0, -10, 0, 3, 0, -20, 0, 0, 4, -30}, 0);
        assert_int_equal(notes.count, 0);
        buffer_finish(&b.bytes);
    }
}

/* A field set to a value that is not allowed, in both versions and byte orders, and a part of the message. */
static const struct bend {
    const char *field;
    size_t index;
    double value;
    const char *message;
    conus_status status;
} bends[] = {
    {"sizeof_hdr", 0, 347, "sizeof_hdr: found", CONUS_ERROR_DATA},
    {"magic", 0, 'x', "ANALYZE 7.5", CONUS_ERROR_DATA},
    {"magic", 2, '3', "magic: found \"n+3", CONUS_ERROR_DATA},
    {"magic", 3, 'x', "magic: found \"n+", CONUS_ERROR_DATA},
    {"dim", 0, 0, "dim[0]: found 0, allowed are 1 to 7", CONUS_ERROR_DATA},
    {"dim", 0, 8, "dim[0]: found 8", CONUS_ERROR_DATA},
    {"dim", 0, -3, "dim[0]: found -3", CONUS_ERROR_DATA},
    {"dim", 1, 0, "dim[1]: found 0, allowed is 1 or more", CONUS_ERROR_DATA},
    {"dim", 2, -1, "dim[2]: found -1", CONUS_ERROR_DATA},
    {"dim", 3, -32768, "dim[3]: found -32768", CONUS_ERROR_DATA},
    {"datatype", 0, 0, "datatype: found 0, allowed are int8", CONUS_ERROR_DATA},
    {"datatype", 0, 999, "datatype: found 999", CONUS_ERROR_DATA},
    {"datatype", 0, -4, "datatype: found -4", CONUS_ERROR_DATA},
    {"datatype", 0, 1, "datatype: found 1 (binary", CONUS_ERROR_UNSUPPORTED},
    {"datatype", 0, 32, "(complex64)", CONUS_ERROR_UNSUPPORTED},
    {"datatype", 0, 128, "(RGB24)", CONUS_ERROR_UNSUPPORTED},
    {"datatype", 0, 1536, "(float128)", CONUS_ERROR_UNSUPPORTED},
    {"datatype", 0, 1792, "(complex128)", CONUS_ERROR_UNSUPPORTED},
    {"datatype", 0, 2048, "(complex256)", CONUS_ERROR_UNSUPPORTED},
    {"datatype", 0, 2304, "(RGBA32)", CONUS_ERROR_UNSUPPORTED},
    {"bitpix", 0, 8, "bitpix: found 8, datatype int16 needs 16", CONUS_ERROR_DATA},
    {"bitpix", 0, 0, "bitpix: found 0", CONUS_ERROR_DATA},
    {"vox_offset", 0, -100, "vox_offset: found -100", CONUS_ERROR_DATA},
    {"vox_offset", 0, 0, "vox_offset: found 0", CONUS_ERROR_DATA},
    {"vox_offset", 0, 348, "vox_offset: found 348", CONUS_ERROR_DATA},
    {"vox_offset", 0, 9.1e18, "vox_offset: found 9.1", CONUS_ERROR_DATA},
    {"scl_slope", 0, INFINITY, "scl_slope: found inf", CONUS_ERROR_DATA},
    {"srow", 0, NAN, "sform, code 4 (MNI 152): the matrix is singular or not finite", CONUS_ERROR_DATA},
    {"srow", 3, INFINITY, "sform, code 4 (MNI 152): the matrix", CONUS_ERROR_DATA},
    {"srow", 5, 0, "sform, code 4 (MNI 152): the matrix is singular", CONUS_ERROR_DATA},
};

static void fields_out_of_range_are_named(void **state)
{
    (void)state;
    for (size_t i = 0; i < 4 * sizeof bends / sizeof bends[0]; i++) {
        const struct bend *bend = &bends[i / 4];
        struct nifti_builder b;
        struct volume_header header;
        struct notes notes = {0};
        nifti_begin(&b, 1 + (int)(i & 1), i & 2, VOLUME_INT16, small);
        nifti_set(&b, bend->field, bend->index, bend->value);
        assert_fails(parse(&header, &b, &notes), bend->status);
        if (!strstr(conus_message(), bend->message)) {
            fail_msg("\"%s\" does not say \"%s\"", conus_message(), bend->message);
        }
        notes_finish(&notes);
        buffer_finish(&b.bytes);
    }
}

static void assert_parse_fails(const struct nifti_builder *b, const char *part)
{
    struct volume_header header;
    struct notes notes = {0};
    assert_fails(parse(&header, b, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), part));
    notes_finish(&notes);
}

static void only_one_version_can_say_it(void **state)
{
    (void)state;
    struct nifti_builder b;
    const double offsets[] = {NAN, 352.5, 1e30, -INFINITY};
    for (size_t i = 0; i < 4; i++) {
        nifti_begin(&b, 1, false, VOLUME_UINT8, small);
        nifti_set(&b, "vox_offset", 0, offsets[i]);
        assert_parse_fails(&b, "vox_offset: found");
        buffer_finish(&b.bytes);
    }
    const double sizes[][3] = {{0x1p62, 4, 1}, {0x1p62 + 1024, 4, 1}, {0x1p32, 0x1p32, 2}, {0x1p40, 0x1p40, 0x1p40}};
    for (size_t i = 0; i < 4; i++) {
        nifti_begin(&b, 2, true, VOLUME_UINT8, small);
        for (size_t k = 0; k < 3; k++) {
            nifti_set(&b, "dim", k + 1, sizes[i][k]);
        }
        assert_parse_fails(&b, "allowed are as many as fit in 2^62 bytes");
        buffer_finish(&b.bytes);
    }
    nifti_begin(&b, 2, false, VOLUME_UINT8, small);
    nifti_set(&b, "dim", 0, 0x1p33);
    assert_parse_fails(&b, "dim[0]: found 8589934592");
    buffer_finish(&b.bytes);
    nifti_begin(&b, 2, false, VOLUME_FLOAT32, small);
    nifti_set(&b, "intent_code", 0, 3007);
    struct volume_header header;
    assert_fails(parse(&header, &b, NULL), CONUS_ERROR_UNSUPPORTED);
    assert_non_null(
        strstr(conus_message(), "intent_code: found 3007, a CIFTI matrix of labels (.dlabel.nii), allowed are "));
    buffer_finish(&b.bytes);
}

static void scaling_is_used_only_where_it_is_one(void **state)
{
    (void)state;
    const struct {
        double slope, inter, wanted_slope, wanted_inter;
        bool fine;
    } cases[] = {
        {0, 7, 1, 0, true},         {NAN, NAN, 1, 0, true},         {1, 0, 1, 0, true},
        {0, NAN, 1, 0, true},       {-0.5, 2.25, -0.5, 2.25, true}, {2, NAN, 0, 0, false},
        {2, INFINITY, 0, 0, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct nifti_builder b;
        struct volume_header header;
        struct notes notes = {0};
        nifti_begin(&b, 1 + (int)(i % 2), false, VOLUME_INT16, small);
        nifti_set(&b, "scl_slope", 0, cases[i].slope);
        nifti_set(&b, "scl_inter", 0, cases[i].inter);
        assert_fails(parse(&header, &b, &notes), cases[i].fine ? CONUS_OK : CONUS_ERROR_DATA);
        if (cases[i].fine) {
            assert_near(header.info.slope, cases[i].wanted_slope, 0);
            assert_near(header.info.intercept, cases[i].wanted_inter, 0);
        } else {
            assert_non_null(strstr(conus_message(), "scl_inter: found"));
        }
        buffer_finish(&b.bytes);
    }
}

static void begin_qform(struct nifti_builder *b, int version)
{
    nifti_begin(b, version, false, VOLUME_UINT8, small);
    nifti_set(b, "sform_code", 0, 0);
    nifti_set(b, "qform_code", 0, 1);
    for (size_t i = 0; i < 3; i++) {
        nifti_set(b, "qoffset", i, 5 + (double)i);
    }
}

static void qform_of_a_quarter_turn(void **state)
{
    (void)state;
    struct nifti_builder b;
    struct volume_header header;
    struct notes notes = {0};
    begin_qform(&b, 2); /* 90 degrees about z: a = d = sqrt(1/2); i goes to +y, j to -x */
    nifti_set(&b, "quatern", 2, sqrt(0.5));
    assert_ok(parse(&header, &b, &notes));
    assert_matrix(header.info.world_from_voxel, (double[]){0, -3, 0, 5, 2, 0, 0, 6, 0, 0, 4, 7}, 1e-12);
    assert_string_equal(header.info.transform, "qform, code 1 (scanner)");
    assert_string_equal(header.info.orientation, "ALS");
    nifti_set(&b, "pixdim", 0, -1); /* qfac */
    assert_ok(parse(&header, &b, &notes));
    assert_matrix(header.info.world_from_voxel, (double[]){0, -3, 0, 5, 2, 0, 0, 6, 0, 0, -4, 7}, 1e-12);
    nifti_set(&b, "pixdim", 0, 0); /* nifti1.h: taken as 1 */
    assert_ok(parse(&header, &b, &notes));
    assert_string_equal(header.info.orientation, "ALS");
    assert_int_equal(notes.count, 0);
    buffer_finish(&b.bytes);
}

static void half_turns_have_no_scalar_part(void **state)
{
    (void)state;
    for (size_t axis = 0; axis < 3; axis++) {
        struct nifti_builder b;
        struct volume_header header;
        struct notes notes = {0};
        begin_qform(&b, 1);
        nifti_set(&b, "quatern", axis, 1 + 3e-7); /* a float's rounding */
        assert_ok(parse(&header, &b, &notes));
        for (int i = 0; i < 3; i++) {
            double wanted = (2 + i) * (i == (int)axis ? 1 : -1);
            assert_near(header.info.world_from_voxel[5 * i], wanted, 1e-6);
        }
        buffer_finish(&b.bytes);
    }
}

/* By nifti1_io.c: a half turn about (1, 1, 0) is b = c = float32(sqrt(1/2)), whose squares sum to 1 - 1.6e-8 (of
 * (1, 1, 1) to 1 + 6e-8): that is 1, or the axes are tilted by 0.01 degrees. qfac was computed, too. */
static void what_single_precision_bends_is_a_half_turn(void **state)
{
    (void)state;
    for (int count = 2; count <= 3; count++) {
        struct nifti_builder b;
        struct volume_header header;
        struct notes notes = {0};
        begin_qform(&b, 1);
        for (int i = 0; i < 3; i++) {
            nifti_set(&b, "quatern", (size_t)i, i < count ? sqrt(1.0 / count) : 0);
        }
        nifti_set(&b, "pixdim", 0, -0.9999999);
        assert_ok(parse(&header, &b, &notes));
        for (int column = 0; column < 3; column++) {
            for (int row = 0; row < 3; row++) { /* 2 u u' - 1, u = the axis; k is mirrored */
                double wanted = (column < count && row < count ? 2.0 / count : 0) - (row == column);
                wanted *= column == 2 ? -4 : 2 + column;
                assert_near(header.info.world_from_voxel[4 * column + row], wanted, 1e-6);
            }
        }
        buffer_finish(&b.bytes);
    }
}

static void bad_qforms_are_named(void **state)
{
    (void)state;
    const struct bend bad[] = {
        {"quatern", 0, 1.01, "quatern_b, c, d: found 1.0", CONUS_ERROR_DATA},
        {"quatern", 1, NAN, "quatern_b, c, d: found 0, nan", CONUS_ERROR_DATA},
        {"pixdim", 0, -2, "pixdim[0] (qfac): found -2", CONUS_ERROR_DATA},
        {"pixdim", 0, NAN, "pixdim[0] (qfac): found", CONUS_ERROR_DATA},
        {"pixdim", 1, 0, "pixdim[1]: found 0", CONUS_ERROR_DATA},
        {"pixdim", 2, -1, "pixdim[2]: found -1", CONUS_ERROR_DATA},
        {"pixdim", 3, INFINITY, "pixdim[3]: found inf", CONUS_ERROR_DATA},
        {"qoffset", 1, NAN, "qform, code 1 (scanner): the matrix", CONUS_ERROR_DATA},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct nifti_builder b;
        begin_qform(&b, 1 + (int)(i % 2));
        nifti_set(&b, bad[i].field, bad[i].index, bad[i].value);
        assert_parse_fails(&b, bad[i].message);
        buffer_finish(&b.bytes);
    }
}

static void no_transform_is_a_stated_guess(void **state)
{
    (void)state;
    struct nifti_builder b;
    struct volume_header header;
    struct notes notes = {0};
    nifti_begin(&b, 1, true, VOLUME_UINT8, small);
    nifti_set(&b, "sform_code", 0, 0);
    assert_ok(parse(&header, &b, &notes));
    assert_matrix(header.info.world_from_voxel, (double[]){-2, 0, 0, 2, 0, 3, 0, -1.5, 0, 0, 4, -2}, 0);
    assert_string_equal(header.info.orientation, "LAS");
    assert_non_null(strstr(header.info.transform, "none: voxel sizes only"));
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "neither sform nor qform"));
    nifti_set(&b, "pixdim", 2, 0);
    assert_parse_fails(&b, "pixdim[2]: found 0");
    notes_finish(&notes);
    buffer_finish(&b.bytes);
}

static void flat_files_are_volumes_of_one_slice(void **state)
{
    (void)state;
    struct nifti_builder b;
    struct volume_header header;
    struct notes notes = {0};
    begin_qform(&b, 1);
    nifti_set(&b, "dim", 0, 2);
    nifti_set(&b, "dim", 3, 0); /* beyond dim[0]: not looked at */
    nifti_set(&b, "pixdim", 3, 0);
    assert_ok(parse(&header, &b, &notes));
    assert_int_equal(header.info.dim[2], 1);
    assert_near(header.info.spacing[2], 1, 0);
    buffer_finish(&b.bytes);
}

static void sform_wins_and_says_so(void **state)
{
    (void)state;
    struct nifti_builder b;
    struct volume_header header;
    struct notes notes = {0};
    nifti_begin(&b, 1, false, VOLUME_UINT8, small);
    nifti_set(&b, "qform_code", 0, 1);
    for (size_t i = 0; i < 3; i++) {
        nifti_set(&b, "qoffset", i, -10 - 10 * (double)i);
    }
    assert_ok(parse(&header, &b, &notes));
    assert_int_equal(notes.count, 0); /* the same place */
    nifti_set(&b, "qoffset", 0, 110);
    assert_ok(parse(&header, &b, &notes));
    assert_near(header.info.world_from_voxel[12], -10, 0);
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "120 mm apart; the sform was used"));
    nifti_set(&b, "quatern", 0, 2);
    assert_ok(parse(&header, &b, &notes));
    assert_int_equal(notes.count, 2);
    assert_non_null(strstr(notes.lines[1], "qform (code 1) is not valid"));
    notes_finish(&notes);
    buffer_finish(&b.bytes);
}

static void units_become_millimetres(void **state)
{
    (void)state;
    const struct {
        int units;
        double factor;
    } cases[] = {{0, 1}, {2, 1}, {2 + 8, 1}, {1 + 16, 1000}, {3, 0.001}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct nifti_builder b;
        struct volume_header header;
        struct notes notes = {0};
        nifti_begin(&b, 1, false, VOLUME_UINT8, small);
        nifti_set(&b, "xyzt_units", 0, cases[i].units);
        assert_ok(parse(&header, &b, &notes));
        assert_near(header.info.spacing[1], 3 * cases[i].factor, 1e-12);
        assert_near(header.info.world_from_voxel[13], -20 * cases[i].factor, 1e-12);
        assert_int_equal(notes.count, cases[i].factor != 1);
        notes_finish(&notes);
        buffer_finish(&b.bytes);
    }
}

struct listing {
    struct volume_extension *list;
    size_t count, end;
};

static conus_status list_extensions(struct listing *out, const struct nifti_builder *b)
{
    struct volume_header header;
    struct notes notes = {0};
    const struct bytes head = {(uint8_t *)b->bytes.data, b->bytes.size};
    assert_ok(parse(&header, b, &notes));
    return nifti_extensions_parse(&out->list, &out->count, &out->end, &head, &header);
}

static void extensions_are_listed(void **state)
{
    (void)state;
    for (int big = 0; big < 2; big++) {
        struct nifti_builder b;
        struct listing listing;
        nifti_begin(&b, 1 + big, big, VOLUME_UINT8, small);
        nifti_extend(&b, 32, 4, "abcdefghijklmnopqrstuvwx", 24);
        nifti_extend(&b, 16, 6, "comment!", 8);
        size_t end = b.bytes.size;
        nifti_gap(&b, "\0\0\0\0\0\0\0\0text", 12);
        assert_ok(list_extensions(&listing, &b));
        assert_int_equal(listing.count, 2);
        assert_int_equal(listing.list[0].code, 4);
        assert_int_equal(listing.list[0].size, 24);
        assert_memory_equal(listing.list[0].data, "abcdef", 6);
        assert_int_equal(listing.list[1].code, 6);
        assert_memory_equal(listing.list[1].data, "comment!", 8);
        assert_int_equal(listing.end, end);
        memory_free(listing.list);
        nifti_set(&b, "extender", 0, 0); /* the flag for no extensions */
        assert_ok(list_extensions(&listing, &b));
        assert_int_equal(listing.count, 0);
        assert_int_equal(listing.end, big ? 544 : 352);
        buffer_finish(&b.bytes);
    }
}

static void broken_extensions_are_errors(void **state)
{
    (void)state;
    const int sizes[] = {7, 8, 15, 17, -16, 0x7ffffff0, 48, INT32_MIN};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct nifti_builder b;
        struct listing listing;
        nifti_begin(&b, 1 + (int)(i % 2), i & 2, VOLUME_UINT8, small);
        nifti_extend(&b, sizes[i], 4, "labels..labels..labels..", 24);
        assert_fails(list_extensions(&listing, &b), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), "found esize"));
        buffer_finish(&b.bytes);
    }
}

/* The flag says that an extension follows the header, and the voxels begin there, too. One that is not there, as of
 * programs that only set the flag, harms nobody. */
static void voxels_and_an_extension_cannot_begin_at_one_byte(void **state)
{
    (void)state;
    for (int extra = 0; extra < 2; extra++) {
        struct nifti_builder b;
        struct volume_file file;
        struct notes notes = {0};
        nifti_begin(&b, 1, false, VOLUME_UINT8, small);
        ((uint8_t *)b.bytes.data)[348] = 1;
        for (int i = 0; i < (int)(small[0] * small[1] * small[2]) + 16 * extra; i++) {
            nifti_voxel(&b, 1);
        }
        conus_status status = volume_file_open(&file, write_bytes("x.nii", &b.bytes), 0, &notes);
        assert_int_equal(status, extra ? CONUS_ERROR_DATA : CONUS_OK);
        if (extra) {
            assert_non_null(strstr(conus_message(), "vox_offset: found 352, but an extension begins there, as byte 348 "
                                                    "says, and 16 bytes stand after the last voxel"));
        } else {
            volume_file_finish(&file);
        }
        notes_finish(&notes);
        buffer_finish(&b.bytes);
    }
}

static void every_prefix_is_survived(void **state)
{
    (void)state;
    for (int version = 1; version <= 2; version++) {
        struct nifti_builder b;
        nifti_begin(&b, version, false, VOLUME_UINT8, small);
        size_t whole = version == 1 ? 348 : 540;
        for (size_t size = 0; size <= b.bytes.size; size++) {
            uint8_t *exact = malloc(size ? size : 1);
            struct volume_header header;
            struct notes notes = {0};
            assert_non_null(exact);
            memcpy(exact, b.bytes.data, size);
            assert_fails(nifti_header_parse(&header, exact, size, &notes), size < whole ? CONUS_ERROR_DATA : CONUS_OK);
            free(exact);
            notes_finish(&notes);
        }
        buffer_finish(&b.bytes);
    }
}

TEST_GROUP(nifti)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(header_is_read_in_both_versions_and_orders),
        cmocka_unit_test(fields_out_of_range_are_named),
        cmocka_unit_test(only_one_version_can_say_it),
        cmocka_unit_test(scaling_is_used_only_where_it_is_one),
        cmocka_unit_test(qform_of_a_quarter_turn),
        cmocka_unit_test(half_turns_have_no_scalar_part),
        cmocka_unit_test(what_single_precision_bends_is_a_half_turn),
        cmocka_unit_test(bad_qforms_are_named),
        cmocka_unit_test(no_transform_is_a_stated_guess),
        cmocka_unit_test(flat_files_are_volumes_of_one_slice),
        cmocka_unit_test(sform_wins_and_says_so),
        cmocka_unit_test(units_become_millimetres),
        cmocka_unit_test(extensions_are_listed),
        cmocka_unit_test(broken_extensions_are_errors),
        cmocka_unit_test(voxels_and_an_extension_cannot_begin_at_one_byte),
        cmocka_unit_test(every_prefix_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
