/* SPDX-License-Identifier: BSD-3-Clause */
/* MATLAB's files of level 7.3 as conus-hdf5 gives them; and files with wrong sizes and references. */
#include "base/formats/matlab.h"
#include "base/memory.h"

#include "builders/hdf5_builder.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIMIT = 1 << 20 };

/* A MATLAB array as HDF5 stores it: the last dimension in HDF5 is MATLAB's first. */
struct built_array {
    const char *path, *matlab_class; /* NULL = it has none */
    enum hdf5_class class;
    uint32_t size;
    uint64_t columns, rows;
    uint64_t address;
    const void *data;
    bool is_empty; /* data are the dimensions */
};

static void put(struct hdf5_builder *builder, struct built_array array)
{
    static const uint8_t one = 1;
    bool has_shape = array.class != HDF5_GROUP;
    struct built_value value = {.kind = HDF5_FRAME_OBJECT,
                                .class = array.class,
                                .size = array.size,
                                .rank = !has_shape      ? 0
                                        : array.columns ? 2
                                                        : 1,
                                .address = array.address,
                                .name = array.path,
                                .data = array.data};
    value.dims[0] = !has_shape ? 0 : array.columns ? array.columns : array.rows;
    value.dims[1] = has_shape && array.columns ? array.rows : 0;
    value.data_size = array.size * array.rows * (array.columns ? array.columns : 1);
    hdf5_frame(builder, value);
    if (array.matlab_class) {
        hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "MATLAB_class", &array.matlab_class, 1);
    }
    if (array.is_empty) {
        hdf5_frame(builder, (struct built_value){.kind = HDF5_FRAME_ATTRIBUTE,
                                                 .class = HDF5_UNSIGNED,
                                                 .size = 1,
                                                 .name = "MATLAB_empty",
                                                 .data = &one,
                                                 .data_size = 1});
    }
}

static void put_numbers(struct hdf5_builder *builder, const char *path, uint64_t address, const double numbers[6])
{
    put(builder, (struct built_array){path, "double", HDF5_FLOAT, 8, 3, 2, address, numbers, false});
}

static void put_text(struct hdf5_builder *builder, const char *path, uint64_t address, const uint16_t *units, size_t n)
{
    put(builder, (struct built_array){path, "char", HDF5_UNSIGNED, 2, n, 1, address, units, false});
}

static const double numbers[] = {1, 2, 3, 4, 5, 6};
static const uint16_t units[] = {'M', '1', 0xe9, 0xd83d, 0xde00};
static const uint64_t none[] = {0, 3};

/* s(1, 3) with the fields cell = {numbers, [], null} and name; one = struct('a', numbers); small = single(...); empty;
 * an object; and MATLAB's own folder of what references lead to. */
static void build(struct hdf5_builder *builder)
{
    static const float small[] = {1.5F, -2};
    static const int8_t whole[] = {-1, 127};
    static const uint64_t cells[] = {10, 11, 0};
    static const uint64_t both[][3] = {{12, 12, 12}, {13, 14, 13}};
    hdf5_begin(builder);
    put(builder, (struct built_array){"/", NULL, HDF5_GROUP, 0, 0, 0, 1, NULL, false});
    put(builder, (struct built_array){"/#refs#", NULL, HDF5_GROUP, 0, 0, 0, 2, NULL, false});
    put_numbers(builder, "/#refs#/a", 10, numbers);
    put(builder, (struct built_array){"/#refs#/b", "double", HDF5_UNSIGNED, 8, 0, 2, 11, none, true});
    put(builder, (struct built_array){"/#refs#/c", "cell", HDF5_REFERENCE, 8, 3, 1, 12, cells, false});
    put_text(builder, "/#refs#/d", 13, units, 5);
    put_text(builder, "/#refs#/e", 14, units, 2);
    put(builder, (struct built_array){"/one", "struct", HDF5_GROUP, 0, 0, 0, 20, NULL, false});
    put_numbers(builder, "/one/a", 21, numbers);
    put(builder, (struct built_array){"/s", "struct", HDF5_GROUP, 0, 0, 0, 30, NULL, false});
    put(builder, (struct built_array){"/s/cell", NULL, HDF5_REFERENCE, 8, 3, 1, 31, both[0], false});
    put(builder, (struct built_array){"/s/name", NULL, HDF5_REFERENCE, 8, 3, 1, 32, both[1], false});
    put(builder, (struct built_array){"/small", "single", HDF5_FLOAT, 4, 1, 2, 40, small, false});
    put(builder, (struct built_array){"/whole", "int8", HDF5_SIGNED, 1, 2, 1, 41, whole, false});
    put(builder, (struct built_array){"/complex", "double", HDF5_OTHER, 0, 2, 1, 42, NULL, false});
    put(builder, (struct built_array){"/sparse", "double", HDF5_GROUP, 0, 0, 0, 43, NULL, false});
    put(builder, (struct built_array){"/thing", "table", HDF5_UNSIGNED, 4, 1, 1, 44, small, false});
    put(builder, (struct built_array){"/other", NULL, HDF5_FLOAT, 4, 1, 1, 45, small, false});
    put(builder, (struct built_array){"/flag", "logical", HDF5_UNSIGNED, 1, 1, 1, 46, "\1", false});
    hdf5_end(builder);
}

/* Parses, and releases the builder's bytes. The arrays are the job's; after a failure there are none. */
static const struct matlab *parse(struct job *job, struct hdf5_builder *builder, uint64_t limit)
{
    *job = (struct job){0};
    const struct text stream = job_text(job, (struct text){builder->bytes.data, builder->bytes.size});
    const struct matlab *matlab = matlab_of_hdf5(job, hdf5_of_stream(job, stream), limit);
    buffer_finish(&builder->bytes);
    assert_true(job_ok(job) || !matlab->arrays);
    return matlab;
}

static conus_status parse_only(struct hdf5_builder *builder, uint64_t limit)
{
    struct job job;
    (void)parse(&job, builder, limit);
    return job_close(&job, NULL, NULL);
}

static const char *class_of(const struct matlab *matlab, const char *name)
{
    static struct matlab_words words;
    words = matlab_class_name(matlab_variable(matlab, name));
    return words.text;
}

static void all_that_is_read(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    struct job job;
    char text[32];
    build(&builder);
    const struct matlab *matlab = parse(&job, &builder, LIMIT);
    assert_int_equal(job.status, CONUS_OK);
    assert_int_equal(matlab->variables, 9); /* not "#refs#" */
    assert_null(matlab_variable(matlab, "#refs#"));

    const struct matlab_array *a = matlab_field(matlab, matlab_variable(matlab, "one"), 0, "a");
    assert_true(matlab_is_real(a));
    assert_int_equal(a->rows, 2);
    assert_int_equal(a->columns, 3);
    for (size_t i = 0; i < 6; i++) { /* column by column, as HDF5's last dimension runs */
        assert_near(matlab_number(a, i), numbers[i], 0);
    }
    assert_null(matlab_field(matlab, matlab_variable(matlab, "one"), 1, "a"));

    const struct matlab_array *s = matlab_variable(matlab, "s");
    assert_int_equal(s->count, 3);
    assert_int_equal(s->fields, 2);
    for (size_t i = 0; i < 3; i++) {
        const struct matlab_array *cell = matlab_field(matlab, s, i, "cell");
        assert_int_equal(cell->kind, MATLAB_CELL);
        assert_int_equal(cell->count, 3);
        const struct matlab_array *parts = &matlab->arrays[cell->parts];
        assert_near(matlab_number(&parts[0], 5), 6, 0);
        assert_int_equal(parts[1].count, 0);
        assert_int_equal(parts[1].columns, 3);
        assert_true(matlab_is_real(&parts[1]));
        assert_int_equal(parts[2].kind, MATLAB_EMPTY);
    }
    struct text name = matlab_text(text, sizeof text, matlab_field(matlab, s, 0, "name"));
    assert_int_equal(name.size, 8);
    assert_memory_equal(name.data, "M1\xc3\xa9\xf0\x9f\x98\x80", 8);
    assert_int_equal(matlab_text(text, sizeof text, matlab_field(matlab, s, 1, "name")).size, 2);

    assert_near(matlab_number(matlab_variable(matlab, "small"), 1), -2, 0);
    assert_near(matlab_number(matlab_variable(matlab, "whole"), 0), -1, 0);
    assert_near(matlab_number(matlab_variable(matlab, "flag"), 0), 1, 0);
    assert_string_equal(class_of(matlab, "complex"), "an array of complex numbers");
    assert_string_equal(class_of(matlab, "sparse"), "an object (double)");
    assert_string_equal(class_of(matlab, "thing"), "an object (table)");
    assert_string_equal(class_of(matlab, "other"), "an object (without a class)");
    assert_false(matlab_is_real(matlab_variable(matlab, "complex")));
    job_end(&job);
}

/* Refuses a file with these arrays. */
static void refuse(const struct built_array *arrays, size_t count, conus_status wanted, const char *part)
{
    struct hdf5_builder builder;
    hdf5_begin(&builder);
    put(&builder, (struct built_array){"/", NULL, HDF5_GROUP, 0, 0, 0, 1, NULL, false});
    for (size_t i = 0; i < count; i++) {
        put(&builder, arrays[i]);
    }
    hdf5_end(&builder);
    assert_fails(parse_only(&builder, LIMIT), wanted);
    if (!strstr(conus_message(), part)) {
        fail_msg("\"%s\" does not say \"%s\"", conus_message(), part);
    }
}

static void arrays_that_lie(void **state)
{
    (void)state;
    static const int64_t negative[] = {0, -1};
    static const uint64_t full[] = {2, 3};
    static const uint64_t nowhere[] = {77, 1};
    static const struct {
        struct built_array array;
        const char *part;
    } cases[] = {
        {{"/x", "double", HDF5_FLOAT, 8, 0, 2, 5, numbers, false}, "/x: less than two dimensions"},
        {{"/x", "double", HDF5_REFERENCE, 8, 1, 2, 5, nowhere, false}, "/x: an array of numbers must be of numbers"},
        {{"/x", "char", HDF5_SIGNED, 2, 1, 2, 5, units, false}, "/x: an array of characters must be of unsigned"},
        {{"/x", "char", HDF5_UNSIGNED, 8, 1, 2, 5, full, false}, "/x: an array of characters must be of unsigned"},
        {{"/x", "char", HDF5_OTHER, 0, 1, 2, 5, NULL, false}, "/x: an array of characters must be of unsigned"},
        {{"/x", "cell", HDF5_UNSIGNED, 8, 1, 2, 5, full, false}, "/x: a cell array must be of references"},
        {{"/x", "cell", HDF5_REFERENCE, 8, 1, 2, 5, nowhere, false}, "/x: a reference that leads nowhere"},
        {{"/x", "struct", HDF5_UNSIGNED, 8, 1, 2, 5, full, false}, "/x: a structure must be a group"},
        {{"/x", "double", HDF5_UNSIGNED, 8, 0, 2, 5, full, true}, "/x: MATLAB_empty, but"},
        {{"/x", "double", HDF5_SIGNED, 8, 0, 2, 5, negative, true}, "/x: MATLAB_empty, but"},
        {{"/x", "double", HDF5_UNSIGNED, 8, 0, 1, 5, none, true}, "/x: MATLAB_empty, but"},
        {{"/x", "double", HDF5_FLOAT, 8, 0, 2, 5, none, true}, "/x: MATLAB_empty, but"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        refuse(&cases[i].array, 1, CONUS_ERROR_DATA, cases[i].part);
    }
}

static void structures_that_lie(void **state)
{
    (void)state;
    static const uint64_t to_root[] = {1, 1, 1};
    const struct built_array group = {"/s", "struct", HDF5_GROUP, 0, 0, 0, 5, NULL, false};
    const struct built_array two = {"/s/a", NULL, HDF5_REFERENCE, 8, 2, 1, 6, to_root, false};
    const struct built_array three = {"/s/b", NULL, HDF5_REFERENCE, 8, 3, 1, 7, to_root, false};
    const struct built_array plain = {"/s/b", "double", HDF5_FLOAT, 8, 3, 2, 7, numbers, false};
    refuse((const struct built_array[]){group, two, three}, 3, CONUS_ERROR_DATA, "/s/b: another number of structures");
    refuse((const struct built_array[]){group, two, plain}, 3, CONUS_ERROR_DATA, "/s/b: another number of structures");
}

/* Cells that are parts of themselves, alone or in a circle, are refused. So are two cells that both lead to the next
 * two, and so on: memory is limited to the size of the file. */
static void circles_have_an_end(void **state)
{
    (void)state;
    enum { LEVELS = 30 };
    static const uint64_t self[] = {5, 5};
    refuse(&(struct built_array){"/x", "cell", HDF5_REFERENCE, 8, 1, 1, 5, self, false}, 1, CONUS_ERROR_DATA,
           "/x: arrays that are parts of several");
    struct built_array arrays[LEVELS];
    uint64_t next[LEVELS][2];
    char paths[LEVELS][16];
    for (size_t i = 0; i < LEVELS; i++) {
        snprintf(paths[i], sizeof paths[i], "/#refs#%zu", i);
        next[i][0] = next[i][1] = 11 + i;
        arrays[i] = (struct built_array){i ? paths[i] : "/x", "cell", HDF5_REFERENCE, 8, 2, 1, 10 + i, next[i], false};
    }
    next[LEVELS - 1][0] = next[LEVELS - 1][1] = 0;
    refuse(arrays, LEVELS, CONUS_ERROR_DATA, "arrays that are parts of several");
}

/* 33 cells, each in the one before. */
static void nests_have_an_end(void **state)
{
    (void)state;
    for (size_t depth = 32; depth <= 33; depth++) {
        struct hdf5_builder builder;
        hdf5_begin(&builder);
        put(&builder, (struct built_array){"/", NULL, HDF5_GROUP, 0, 0, 0, 1, NULL, false});
        for (size_t i = 0; i < depth; i++) {
            char path[16];
            const uint64_t next = i + 1 < depth ? 11 + i : 0;
            snprintf(path, sizeof path, i ? "/#%zu" : "/x", i);
            put(&builder, (struct built_array){path, "cell", HDF5_REFERENCE, 8, 1, 1, 10 + i, &next, false});
        }
        hdf5_end(&builder);
        conus_status status = parse_only(&builder, LIMIT);
        test_status(status, depth == 33 ? CONUS_ERROR_DATA : CONUS_OK, "nest", __FILE__, __LINE__);
        assert_true(depth == 32 || strstr(conus_message(), "more than 32 deep"));
    }
}

static void memory_has_a_limit(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    build(&builder);
    assert_fails(parse_only(&builder, 100), CONUS_ERROR_MEMORY);
    build(&builder);
    assert_fails(parse_only(&builder, 1200), CONUS_ERROR_MEMORY);
}

static conus_status read_text(const char *text, size_t size)
{
    struct job job = {0};
    (void)matlab_read(&job, (struct text){text, size}, LIMIT);
    return job_close(&job, NULL, NULL);
}

/* Refused: a prefix of the text, or of the header, and a header that no HDF5 follows. */
static void headers_are_checked(void **state)
{
    (void)state;
    char header[128] = "MATLAB 7.3 MAT-file, Platform: GLNXA64";
    memcpy(header + 124, "\0\2IM", 4);
    assert_true(matlab_is((struct text){header, sizeof header}));
    assert_fails(read_text(header, 127), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "127 bytes, 128 are needed"));
    header[125] = 1;
    assert_fails(read_text(header, sizeof header), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "version 0x100, allowed is 0x200"));
}

static conus_status parse_built(void *data)
{
    const struct hdf5_builder *builder = data;
    struct job job = {0};
    const struct text stream = {builder->bytes.data, builder->bytes.size};
    (void)matlab_of_hdf5(&job, hdf5_of_stream(&job, stream), LIMIT);
    return job_close(&job, NULL, NULL);
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    build(&builder);
    test_every_allocation(parse_built, &builder);
    buffer_finish(&builder.bytes);
}

TEST_GROUP(matlab_hdf5)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_that_is_read),    cmocka_unit_test(arrays_that_lie),
        cmocka_unit_test(structures_that_lie), cmocka_unit_test(circles_have_an_end),
        cmocka_unit_test(nests_have_an_end),   cmocka_unit_test(memory_has_a_limit),
        cmocka_unit_test(headers_are_checked), cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
