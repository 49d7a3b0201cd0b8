/* SPDX-License-Identifier: BSD-3-Clause */
/* AFNI's data sets against the closed form of their placement, and headers with every attribute changed. */
#include "loaders/volumes/text/text_volume.h"

#include "base/memory.h"
#include "base/status.h"
#include "builders/bent_text.h"
#include "builders/nifti_builder.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_values.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* 2 x 3 x 2 voxels, two volumes. i runs from left to right by 2 mm, j from the back to the front by 3 mm, k from below
 * by 4 mm; the first voxel is at DICOM (LPS) (10, 20, 30). */
static const char plain[] = "\ntype = integer-attribute\nname = DATASET_RANK\ncount = 8\n 3 2 0 0 0\n 0 0 0\n"
                            "\ntype = integer-attribute\nname = DATASET_DIMENSIONS\ncount = 5\n 2 3 2 0 0\n"
                            "\ntype = integer-attribute\nname = BRICK_TYPES\ncount = 2\n 0 0\n"
                            "\ntype  = float-attribute\nname  = BRICK_FLOAT_FACS\ncount = 2\n 0 0.5\n"
                            "\ntype = string-attribute\nname = BYTEORDER_STRING\ncount = 10\n'LSB_FIRST~\n"
                            "\ntype = string-attribute\nname = BRICK_LABS\ncount = 6\n'FA~MD~\n"
                            "\ntype = integer-attribute\nname = ORIENT_SPECIFIC\ncount = 3\n 1 2 4\n"
                            "\ntype  = float-attribute\nname  = ORIGIN\ncount = 3\n 10 20 30\n"
                            "\ntype  = float-attribute\nname  = DELTA\ncount = 3\n -2 -3 4\n";

static const char real[] = "\ntype = float-attribute\nname = IJK_TO_DICOM_REAL\ncount = 12\n"
                           " 0 -2 0 10 3 0 0 20 0 0 4 30\n";

static const char table[] =
    "\ntype = string-attribute\nname = VALUE_LABEL_DTABLE\ncount = 109\n"
    "'<VALUE_LABEL_DTABLE ni_type=\"2*String\" ni_dimen=\"3\">\n\"2\" \"Two\"\n\"1\" \"One\"\n\"11\" \"Eleven\"\n"
    "</VALUE_LABEL_DTABLE>~\n";

static void append_counting(struct buffer *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        append_ordered(bytes, i, 1, false);
    }
}

/* Parses the header with one place changed, and `more` behind it. */
static conus_status parse_bent(struct text_volume *out, const char *from, const char *to, const char *more,
                               struct notes *notes)
{
    struct buffer bytes = {0};
    append_bent(&bytes, plain, from, to);
    buffer_text(&bytes, more);
    conus_status status = parse_header(out, afni_parse, &bytes, notes);
    buffer_finish(&bytes);
    return status;
}

static void write_head(const char *name, const char *more)
{
    struct buffer bytes = {0};
    buffer_text(&bytes, plain);
    buffer_text(&bytes, more);
    write_bytes(name, &bytes);
    buffer_finish(&bytes);
}

static void write_brik(const char *name, size_t count, bool packed)
{
    struct buffer bytes = {0};
    append_counting(&bytes, count);
    packed ? write_packed(name, &bytes) : write_bytes(name, &bytes);
    buffer_finish(&bytes);
}

static conus_status open_scratch(struct volume_file *file, const char *name, const char *choice, struct notes *notes)
{
    char path[300];
    snprintf(path, sizeof path, "%s%s", test_scratch(name), choice);
    return volume_file_open(file, path, 0, notes);
}

/* LPS (x, y, z) is RAS (-x, -y, z): steps of -2 and -3 mm in LPS lead to +x and +y. */
static void plumb_axes_follow_their_codes(void **state)
{
    (void)state;
    static const struct {
        const char *orient, *delta;
        double matrix[9]; /* columns, RAS */
    } cases[] = {{" 1 2 4\n", " -2 -3 4\n", {2, 0, 0, 0, 3, 0, 0, 0, 4}},
                 {" 0 3 5\n", " 2 3 -4\n", {-2, 0, 0, 0, -3, 0, 0, 0, -4}},
                 {" 3 4 1\n", " 2 3 -4\n", {0, -2, 0, 0, 0, 3, 4, 0, 0}}};
    for (size_t i = 0; i < 3; i++) {
        struct text_volume volume;
        struct notes notes = {0};
        struct buffer text = {0};
        append_bent(&text, plain, " 1 2 4\n", cases[i].orient);
        struct buffer both = {0};
        append_bent(&both, text.data, " -2 -3 4\n", cases[i].delta);
        assert_ok(parse_header(&volume, afni_parse, &both, &notes));
        for (int k = 0; k < 9; k++) {
            assert_near(volume.world_from_voxel[4 * (k / 3) + k % 3], cases[i].matrix[k], 1e-12);
        }
        end_header();
        buffer_finish(&both);
        buffer_finish(&text);
    }
    struct text_volume volume;
    struct notes notes = {0};
    assert_ok(parse_bent(&volume, NULL, NULL, "", &notes));
    assert_near(volume.world_from_voxel[12], -10, 1e-12);
    assert_near(volume.world_from_voxel[13], -20, 1e-12);
    assert_near(volume.world_from_voxel[14], 30, 1e-12);
    end_header();
}

/* The matrix wins over the plumb axes; that they differ is noted. Rows (0 -2 0 10), (3 0 0 20), (0 0 4 30) of LPS. */
static void the_real_matrix_wins(void **state)
{
    (void)state;
    struct text_volume volume;
    struct notes notes = {0};
    const double wanted[16] = {0, -3, 0, 0, 2, 0, 0, 0, 0, 0, 4, 0, -10, -20, 30, 1};
    assert_ok(parse_bent(&volume, NULL, NULL, real, &notes));
    for (int k = 0; k < 16; k++) {
        assert_near(volume.world_from_voxel[k], wanted[k], 1e-12);
    }
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "IJK_TO_DICOM_REAL was used; ORIENT_SPECIFIC"));
    end_header();
    notes_finish(&notes);
}

/* Plumb axes with steps of the wrong sign do not count beside the matrix, and give a note; a header without them gives
 * none. */
static void broken_plumb_axes_are_noted_beside_the_matrix(void **state)
{
    static const char *const gone[][2] = {{"ORIGIN", "OTHER1"}, {"DELTA", "OTHER"}, {"ORIENT_SPECIFIC", "OTHER"}};
    struct text_volume volume;
    struct notes notes = {0};
    (void)state;
    assert_ok(parse_bent(&volume, " -2 -3 4\n", " 2 -3 4\n", real, &notes));
    assert_near(volume.world_from_voxel[1], -3, 1e-12);
    assert_int_equal(notes.count, 1);
    assert_string_equal(notes.lines[0], "IJK_TO_DICOM_REAL was used; DELTA: found 2, ORIENT_SPECIFIC 1 needs a step of "
                                        "the other sign");
    end_header();
    notes_finish(&notes);
    for (size_t i = 0; i < 3; i++) {
        struct notes none = {0};
        (void)fail(CONUS_ERROR_DATA, "before");
        assert_ok(parse_bent(&volume, gone[i][0], gone[i][1], real, &none));
        assert_string_equal(conus_message(), "before");
        assert_int_equal(none.count, 0);
        end_header();
    }
}

static void the_space_follows_view_and_template(void **state)
{
    (void)state;
    static const struct {
        int view, code;
        const char *space;
    } cases[] = {{0, 1, "MNI"},      {1, 2, "ORIG"},        {2, 3, "TLRC"}, {2, 3, "TT_N27"}, {2, 4, "MNI"},
                 {2, 4, "MNI_ANAT"}, {2, 5, "HaskinsPeds"}, {0, 1, NULL},   {1, 2, NULL},     {2, 3, NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct text_volume volume;
        struct notes notes = {0};
        char more[200];
        int size = snprintf(more, sizeof more, "\ntype = integer-attribute\nname = SCENE_DATA\ncount = 1\n %d\n",
                            cases[i].view);
        if (cases[i].space) { /* AFNI's older files have none: its +tlrc was Talairach */
            snprintf(more + size, sizeof more - (size_t)size,
                     "\ntype = string-attribute\nname = TEMPLATE_SPACE\ncount = %zu\n'%s~\n",
                     strlen(cases[i].space) + 1, cases[i].space);
        }
        assert_ok(parse_bent(&volume, NULL, NULL, more, &notes));
        assert_int_equal(volume.space_code, cases[i].code);
        end_header();
    }
}

/* The data set opens by either name, packed or not; the factor of volume 1 halves it. */
static void a_data_set_opens_by_either_name(void **state)
{
    (void)state;
    static const char *const names[] = {"a+orig.HEAD", "a+orig.BRIK", "b+orig.HEAD", "b+orig.BRIK.gz"};
    write_head("a+orig.HEAD", "");
    write_head("b+orig.HEAD", "");
    write_brik("a+orig.BRIK", 24, false);
    write_brik("b+orig.BRIK.gz", 24, true);
    for (size_t i = 0; i < 4; i++) {
        struct volume_file file;
        struct notes notes = {0};
        float *values;
        assert_ok(open_scratch(&file, names[i], ",volume=1", &notes));
        assert_string_equal(strrchr(file.path, '.'), ".HEAD");
        assert_string_equal(file.info.format, i > 1 ? "AFNI, gzip, little-endian" : "AFNI, little-endian");
        assert_string_equal(file.title, "MD");
        assert_ok(volume_file_values(&values, &file, &notes));
        for (size_t v = 0; v < 12; v++) {
            assert_near(values[v], 0.5 * (double)(12 + v), 0);
        }
        memory_free(values);
        volume_file_finish(&file);
    }
}

static void a_series_has_its_own_factors_and_names(void **state)
{
    (void)state;
    struct volume_file file;
    struct notes notes = {0};
    write_head("a+orig.HEAD", "");
    write_brik("a+orig.BRIK", 24, false);
    for (int kept = 0; kept < 2; kept++) {
        uint64_t limit = kept ? 0 : 700; /* enough for one volume only: each is read again */
        assert_ok(volume_file_open_series(&file, test_scratch("a+orig.HEAD"),
                                          &(conus_load_options){.max_memory = limit}, &notes));
        for (size_t k = 2; k-- > 0;) {
            assert_ok(volume_file_select(&file, k));
            assert_near(file.info.slope, k ? 0.5 : 1, 0);
            assert_string_equal(file.title, k ? "MD" : "FA");
            assert_int_equal(file.voxels.data[3], 12 * k + 3);
        }
        volume_file_finish(&file);
    }
}

static void names_come_from_the_header(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    char path[300];
    write_head("t+tlrc.HEAD", table);
    write_brik("t+tlrc.BRIK", 24, false);
    snprintf(path, sizeof path, "%s,volume=0", test_scratch("t+tlrc.HEAD"));
    const conus_load_options options = {.labels_anyway = true};
    assert_ok(conus_atlas_load(&atlas, path, &options));
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "One");
    assert_string_equal(conus_atlas_object(atlas, 2)->name, "Two");
    assert_string_equal(conus_atlas_object(atlas, 11)->name, "Eleven");
    snprintf(path, sizeof path, "%s,volume=1", test_scratch("t+tlrc.BRIK"));
    const conus_pathway_options above = {.threshold = 1};
    assert_ok(conus_atlas_add_pathway(atlas, path, &above));
    assert_string_equal(conus_atlas_object(atlas, conus_atlas_object_count(atlas))->name, "MD");
    conus_atlas_destroy(atlas);
}

static void bad_attributes_are_named(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        {"DATASET_RANK", "DATASET_RUNK", "DATASET_RANK: missing"},
        {" 3 2 0 0 0", " 4 2 0 0 0", "DATASET_RANK: found 4, allowed is 3"},
        {" 3 2 0 0 0", " 3 0 0 0 0", "DATASET_RANK: found 0"},
        {" 3 2 0 0 0", " 3 99999999 0 0 0", "DATASET_RANK: found 1e+08"},
        {" 2 3 2 0 0", " 2 0 2 0 0", "DATASET_DIMENSIONS: found 0, allowed are whole numbers from 1"},
        {" 2 3 2 0 0", " 2 2.5 2 0 0", "DATASET_DIMENSIONS: found 2.5"},
        {" 2 3 2 0 0", " 2 nan 2 0 0", "DATASET_DIMENSIONS: found nan"},
        {" 2 3 2 0 0", " 2 3 2 0", "DATASET_DIMENSIONS: found 4 numbers, its count is 5"},
        {"count = 2\n 0 0\n", "count = 1\n 0\n", "BRICK_TYPES: found fewer or a string, 2 numbers are needed"},
        {"count = 2\n 0 0\n", "count = 2\n 0 1\n", "BRICK_TYPES: found 0 and 1, allowed is one type"},
        {"count = 2\n 0 0\n", "count = 2\n 5 5\n", "BRICK_TYPES: found 5, allowed are 0 (byte)"},
        {"count = 2\n 0 0\n", "count = x\n 0 0\n", "BRICK_TYPES: count: found \"x\""},
        {" 0 0.5\n", " 0 inf\n", "BRICK_FLOAT_FACS: found inf"},
        {"LSB_FIRST", "RSB_FIRST", "BYTEORDER_STRING: found \"RSB_FIRST\""},
        {" -2 -3 4\n", " 2 -3 4\n", "DELTA: found 2, ORIENT_SPECIFIC 1 needs a step of the other sign"},
        {" -2 -3 4\n", " -2 0 4\n", "DELTA: found 0"},
        {" 1 2 4\n", " 1 2 6\n", "ORIENT_SPECIFIC: found 6"},
        {"ORIGIN", "ORIGON", "ORIGIN: missing, 3 numbers are needed"},
        {"ORIGIN", "DELTA", "DELTA: found twice, allowed is once"},
        {"type  = float-attribute", "type  = complex-attribute", "type: found \"complex-attribute\""},
        {"name = BRICK_TYPES\n", "", "header: found the line \"count = 2\", needed is \"name = ...\""},
        {"'LSB_FIRST~", "LSB_FIRST~", "BYTEORDER_STRING: found no string of 10 characters"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct text_volume volume;
        struct notes notes = {0};
        conus_status status = parse_bent(&volume, cases[i][0], cases[i][1], "", &notes);
        assert_true(status == CONUS_ERROR_DATA || status == CONUS_ERROR_UNSUPPORTED);
        assert_said(cases[i][2]);
    }
}

static void bad_files_are_named(void **state)
{
    (void)state;
    struct volume_file file;
    struct notes notes = {0};
    write_head("m+orig.HEAD", "");
    assert_fails(open_scratch(&file, "m+orig.HEAD", ",volume=0", &notes), CONUS_ERROR_IO);
    assert_said("m+orig.HEAD: the file of the voxels is missing: ");
    write_brik("m+orig.BRIK", 23, false);
    assert_fails(open_scratch(&file, "m+orig.BRIK", ",volume=0", &notes), CONUS_ERROR_DATA);
    assert_said("m+orig.BRIK: voxels: the file has 23 bytes, the header asks for 24");
    write_brik("n+orig.BRIK", 24, false);
    assert_fails(open_scratch(&file, "n+orig.BRIK", ",volume=0", &notes), CONUS_ERROR_IO);
    assert_said("n+orig.HEAD");
    write_brik("n+orig.HEAD", 24, false);
    assert_fails(open_scratch(&file, "n+orig.BRIK", ",volume=0", &notes), CONUS_ERROR_DATA);
    write_head("n.txt", "");
    assert_fails(open_scratch(&file, "n.txt", ",volume=0", &notes), CONUS_ERROR_DATA);
    assert_said("whose name must end in .HEAD");
    write_head("m+orig.HEAD",
               "\ntype = float-attribute\nname = IJK_TO_DICOM_REAL\ncount = 12\n 0 0 0 0 0 0 0 0 0 0 0 nan\n");
    write_brik("m+orig.BRIK", 24, false);
    assert_fails(open_scratch(&file, "m+orig.BRIK", ",volume=0", &notes), CONUS_ERROR_DATA);
    assert_said("IJK_TO_DICOM_REAL: the matrix is singular or not finite");
}

/* The last attribute is the table, which may be left out: from there on every prefix that ends with an attribute is a
 * header. All shorter prefixes are refused. */
static void every_prefix_is_refused(void **state)
{
    (void)state;
    size_t length = strlen(plain);
    for (size_t size = 0; size + 2 < length; size++) { /* the last step without its digit is another number or none */
        struct text_volume volume;
        struct notes notes = {0};
        char *prefix = memory_text(plain, size);
        assert_fails(parse_header(&volume, afni_parse, &(struct buffer){.data = prefix, .size = size}, &notes),
                     CONUS_ERROR_DATA);
        memory_free(prefix);
    }
    write_head("p+orig.HEAD", "");
    for (size_t size = 1; size < 24; size++) {
        struct volume_file file;
        struct notes notes = {0};
        write_brik("p+orig.BRIK", size, false);
        assert_fails(open_scratch(&file, "p+orig.BRIK", ",volume=0", &notes), CONUS_ERROR_DATA);
    }
}

static void every_failing_allocation(void **state)
{
    (void)state;
    char path[300];
    struct buffer more = {0};
    buffer_text(&more, table);
    buffer_text(&more, real); /* makes a note */
    write_head("f+orig.HEAD", more.data);
    write_brik("f+orig.BRIK.gz", 24, true);
    snprintf(path, sizeof path, "%s,volume=1", test_scratch("f+orig.HEAD"));
    test_every_allocation(open_and_close, path);
    assert_true(test_every_primitive(open_and_close, path) > 0);
    snprintf(path, sizeof path, "%s,volume=1", test_scratch("f+orig.BRIK.gz"));
    test_every_allocation(open_and_close, path);
    assert_true(test_every_primitive(open_and_close, path) > 0);
    buffer_finish(&more);
}

TEST_GROUP(afni)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plumb_axes_follow_their_codes),
        cmocka_unit_test(the_real_matrix_wins),
        cmocka_unit_test(broken_plumb_axes_are_noted_beside_the_matrix),
        cmocka_unit_test(the_space_follows_view_and_template),
        cmocka_unit_test(a_data_set_opens_by_either_name),
        cmocka_unit_test(a_series_has_its_own_factors_and_names),
        cmocka_unit_test(names_come_from_the_header),
        cmocka_unit_test(bad_attributes_are_named),
        cmocka_unit_test(bad_files_are_named),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
