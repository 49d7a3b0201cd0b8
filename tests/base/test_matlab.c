/* SPDX-License-Identifier: BSD-3-Clause */
/* MATLAB's files of level 5 in both byte orders, packed and plain; and files with wrong sizes. */
#include "base/formats/matlab.h"

#include "builders/matlab_builder.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

enum { HEADER = 128, LIMIT = 1 << 20 };

/* The arrays are the job's. */
static const struct matlab *parse(struct job *job, const struct matlab_builder *builder)
{
    const struct matlab *matlab = matlab_read(job, matlab_built(builder), LIMIT);
    assert_int_equal(job->status, CONUS_OK);
    return matlab;
}

static conus_status parse_built(void *builder)
{
    struct job job = {0};
    (void)matlab_read(&job, matlab_built(builder), LIMIT);
    return job_close(&job, NULL, NULL);
}

static void refuse(struct matlab_builder *builder, conus_status wanted, const char *part)
{
    assert_fails(parse_built(builder), wanted);
    if (!strstr(conus_message(), part)) {
        fail_msg("\"%s\" is not in \"%s\"", part, conus_message());
    }
    buffer_finish(&builder->bytes);
}

/* Numbers are read by their stored type, whatever the class of the array: MATLAB stores whole doubles as small
 * integers. */
static void numbers_of_every_type(void **state)
{
    (void)state;
    static const struct {
        uint32_t type;
        double values[3];
    } cases[] = {{MI_INT8, {-128, 0, 127}},        {MI_UINT8, {0, 1, 255}},
                 {MI_INT16, {-32768, 1, 32767}},   {MI_UINT16, {0, 256, 65535}},
                 {MI_INT32, {-2147483648., 2, 3}}, {MI_UINT32, {0, 65536, 4294967295.}},
                 {MI_SINGLE, {-0.5, 1e10f, 0.25}}, {MI_DOUBLE, {-0.1, 1e300, 2}},
                 {MI_INT64, {-1e15, 5, 1e15}},     {MI_UINT64, {0, 7, 1e18}}};
    for (size_t i = 0; i < 2 * (sizeof cases / sizeof cases[0]); i++) {
        struct matlab_builder builder;
        struct job job = {0};
        matlab_begin(&builder, i % 2);
        matlab_open(&builder, MX_DOUBLE, 3, 1, "x");
        matlab_values(&builder, cases[i / 2].type, cases[i / 2].values, 3);
        matlab_close(&builder);
        const struct matlab *matlab = parse(&job, &builder);
        const struct matlab_array *x = matlab_variable(matlab, "x");
        assert_non_null(x);
        assert_true(matlab_is_real(x));
        assert_int_equal(x->rows, 3);
        assert_int_equal(x->columns, 1);
        for (size_t k = 0; k < 3; k++) {
            assert_near(matlab_number(x, k), cases[i / 2].values[k], 0);
        }
        job_end(&job);
        buffer_finish(&builder.bytes);
    }
}

static const uint16_t units[] = {'a', 0xe4, 0x20ac, 0xd83e, 0xdde0}; /* a, a umlaut, the euro sign, a brain */
static const char spelt[] = "a\xc3\xa4\xe2\x82\xac\xf0\x9f\xa7\xa0";

/* s(2) has the fields cell = {1 x 2: [1 2 3], []} and name; a variable plain = "UTF-8" in another type; an object,
 * which is passed over. */
static void build_all(struct matlab_builder *builder, bool big, bool packed)
{
    static const double numbers[] = {1, 2, 3};
    matlab_begin(builder, big);
    matlab_open(builder, MX_STRUCT, 1, 2, "s");
    matlab_field_names(builder, "cell name");
    for (int i = 0; i < 2; i++) {
        matlab_open(builder, MX_CELL, 1, 2, "");
        matlab_doubles(builder, "", 1, 3, numbers);
        matlab_element(builder, MI_MATRIX, "", 0);
        matlab_close(builder);
        matlab_chars(builder, "", units + i, 5 - i);
    }
    matlab_close(builder);
    if (packed) {
        matlab_pack(builder, HEADER);
    }
    size_t here = builder->bytes.size;
    struct matlab_builder other = {.big = big}; /* by itself: packed elements are not padded */
    matlab_open(&other, MX_CHAR, 1, 3, "plain");
    matlab_element(&other, MI_UTF8, "b\xc3\xa9t", 4);
    matlab_close(&other);
    matlab_open(&other, MX_OBJECT, 1, 1, "thing");
    matlab_element(&other, MI_INT8, "someclass", 9);
    matlab_close(&other);
    buffer_append(&builder->bytes, other.bytes.data, other.bytes.size);
    buffer_finish(&other.bytes);
    assert_true(builder->bytes.size > here);
}

static void structures_cells_and_texts(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        struct matlab_builder builder;
        struct job job = {0};
        char text[32];
        build_all(&builder, i % 2, i / 2);
        assert_true(matlab_is(matlab_built(&builder)));
        const struct matlab *matlab = parse(&job, &builder);
        assert_int_equal(matlab->variables, 3);
        const struct matlab_array *s = matlab_variable(matlab, "s");
        assert_int_equal(s->count, 2);
        for (size_t k = 0; k < 2; k++) {
            const struct matlab_array *cell = matlab_field(matlab, s, k, "cell");
            assert_int_equal(cell->kind, MATLAB_CELL);
            assert_int_equal(cell->count, 2);
            assert_near(matlab_number(&matlab->arrays[cell->parts], 2), 3, 0);
            assert_int_equal(matlab->arrays[cell->parts + 1].kind, MATLAB_EMPTY);
            struct text name = matlab_text(text, sizeof text, matlab_field(matlab, s, k, "name"));
            assert_int_equal(name.size, sizeof spelt - 1 - k);
            assert_memory_equal(name.data, spelt + k, name.size);
        }
        assert_null(matlab_field(matlab, s, 2, "name"));
        assert_null(matlab_field(matlab, s, 0, "nam"));
        assert_null(matlab_field(matlab, NULL, 0, "name"));
        assert_null(matlab_variable(matlab, "cell"));
        struct text plain = matlab_text(text, sizeof text, matlab_variable(matlab, "plain"));
        assert_int_equal(plain.size, 4);
        assert_memory_equal(plain.data, "b\xc3\xa9t", 4);
        assert_int_equal(matlab_text(text, 6, matlab_field(matlab, s, 0, "name")).size, 3); /* as much as fits */
        assert_int_equal(matlab_text(text, sizeof text, s).size, 0);
        job_end(&job);
        buffer_finish(&builder.bytes);
    }
}

static void begin_array(struct matlab_builder *builder, uint32_t kind, int rows, int columns)
{
    matlab_begin(builder, false);
    matlab_open(builder, kind, rows, columns, "x");
}

/* Refuses an array whose values are an element of @p size zeros. */
static void refuse_values(uint32_t kind, int rows, int columns, uint32_t type, size_t size, const char *part)
{
    static const char zeros[256];
    struct matlab_builder builder;
    begin_array(&builder, kind, rows, columns);
    matlab_element(&builder, type, zeros, size);
    matlab_close(&builder);
    refuse(&builder, CONUS_ERROR_DATA, part);
}

static void sizes_must_fit(void **state)
{
    (void)state;
    refuse_values(MX_DOUBLE, 2, 2, MI_DOUBLE, 24, "4 values has 24 bytes, 8 each are needed");
    refuse_values(MX_DOUBLE, 2, 2, MI_DOUBLE, 40, "4 values has 40 bytes");
    refuse_values(MX_CHAR, 1, 2, MI_UINT16, 6, "2 values has 6 bytes, 2 each");
    refuse_values(MX_DOUBLE, 2, 2, MI_UTF8, 4, "values of type 16");
    refuse_values(MX_DOUBLE, 2, 2, MI_MATRIX, 8, "values of type 14");
    refuse_values(MX_DOUBLE, 2, 2, 4711, 8, "values of type 4711");
    refuse_values(MX_DOUBLE, -1, 2, MI_DOUBLE, 8, "-1 is number 1");
    refuse_values(MX_DOUBLE, 2147483647, 2147483647, MI_DOUBLE, 8, "bytes, 8 each are needed");
    refuse_values(MX_CELL, 1000000, 1000, MI_DOUBLE, 64, "a cell array of 1000000000 elements in 72 bytes");
    refuse_values(MX_CELL, 1, 1, MI_DOUBLE, 64, "a part of an array: an element of type 9, 14 is needed");
    refuse_values(MX_STRUCT, 1, 1, MI_DOUBLE, 64, "length of names of fields: an element of type 9");
}

static void bend(size_t at, int value, conus_status wanted, const char *part)
{
    static const double number = 1;
    struct matlab_builder builder;
    matlab_begin(&builder, false);
    matlab_doubles(&builder, "x", 1, 1, &number);
    builder.bytes.data[at] = (char)value;
    refuse(&builder, wanted, part);
}

/* The array is at 128: its tag, then flags at 136, dimensions at 152, the name at 168, values at 176. */
static void single_bytes_that_lie(void **state)
{
    (void)state;
    bend(125, 2, CONUS_ERROR_DATA, "version 0x200, allowed is 0x100");
    bend(126, 'X', CONUS_ERROR_DATA, "byte order 58 4d");
    bend(HEADER, 9, CONUS_ERROR_DATA, "an element of type 9, an array (14) is needed");
    bend(HEADER + 5, 1, CONUS_ERROR_DATA, "an element of 312 bytes, where there are 56");
    bend(136, 5, CONUS_ERROR_DATA, "flags of an array: an element of type 5, 6 is needed");
    bend(140, 16, CONUS_ERROR_DATA, "flags of an array: 16 bytes, 8 are needed");
    bend(152, 4, CONUS_ERROR_DATA, "dimensions of an array: an element of type 4, 5 is needed");
    bend(156, 4, CONUS_ERROR_DATA, "dimensions of an array: 4 bytes");
    bend(168, 2, CONUS_ERROR_DATA, "name of an array: an element of type 2");
    bend(170, 5, CONUS_ERROR_DATA, "an element of 5 bytes, where there are 4");
}

static void names_of_fields_must_fit(void **state)
{
    (void)state;
    static const char lengths[][4] = {{0, 0, 0, 0}, {3, 0, 0, 0}, {'\xff', '\xff', '\xff', '\xff'}};
    for (size_t i = 0; i < 3; i++) {
        struct matlab_builder builder;
        begin_array(&builder, MX_STRUCT, 1, 1);
        matlab_element(&builder, MI_INT32, lengths[i], 4);
        matlab_element(&builder, MI_INT8, "abcdefgh", 8);
        matlab_close(&builder);
        refuse(&builder, CONUS_ERROR_DATA, "names of fields: 8 bytes, of");
    }
}

static void nests_have_an_end(void **state)
{
    (void)state;
    for (int depth = 32; depth <= 33; depth++) {
        struct matlab_builder builder;
        struct job job = {0};
        matlab_begin(&builder, false);
        for (int i = 0; i < depth; i++) {
            matlab_open(&builder, MX_CELL, 1, 1, "");
        }
        matlab_element(&builder, MI_MATRIX, "", 0);
        for (int i = 0; i < depth; i++) {
            matlab_close(&builder);
        }
        if (depth == 33) {
            refuse(&builder, CONUS_ERROR_DATA, "more than 32 deep");
        } else {
            (void)parse(&job, &builder);
            job_end(&job);
            buffer_finish(&builder.bytes);
        }
    }
}

/* A megabyte of zeros packs into a thousand bytes, a cell array of empty cells into fewer. */
static void bombs_are_refused(void **state)
{
    (void)state;
    struct matlab_builder builder;
    char *zeros = calloc(LIMIT, 1);
    matlab_begin(&builder, false);
    matlab_open(&builder, MX_UINT8, 1, LIMIT, "x");
    matlab_element(&builder, MI_UINT8, zeros, LIMIT);
    matlab_close(&builder);
    matlab_pack(&builder, HEADER);
    assert_true(builder.bytes.size < 4096);
    refuse(&builder, CONUS_ERROR_MEMORY, "unpacks to more than");
    free(zeros);

    enum { CELLS = LIMIT / (sizeof(struct matlab_array) + 4) }; /* cells fit, but not with unpacked bytes */
    matlab_begin(&builder, false);
    matlab_open(&builder, MX_CELL, 1, CELLS, "x");
    for (int i = 0; i < CELLS; i++) {
        matlab_element(&builder, MI_MATRIX, "", 0);
    }
    matlab_close(&builder);
    matlab_pack(&builder, HEADER);
    refuse(&builder, CONUS_ERROR_MEMORY, "more than the 1048576 bytes that are allowed");
}

static void packed_elements_are_checked(void **state)
{
    (void)state;
    static const double number = 1;
    struct matlab_builder builder;
    matlab_begin(&builder, false);
    matlab_doubles(&builder, "x", 1, 1, &number);
    matlab_doubles(&builder, "y", 1, 1, &number);
    matlab_pack(&builder, HEADER);
    refuse(&builder, CONUS_ERROR_DATA, "64 bytes behind the packed array");
    matlab_begin(&builder, false);
    matlab_doubles(&builder, "x", 1, 1, &number);
    matlab_pack(&builder, HEADER);
    matlab_pack(&builder, HEADER);
    refuse(&builder, CONUS_ERROR_DATA, "an element of type 15, an array (14) is needed");
    matlab_begin(&builder, false);
    matlab_element(&builder, MI_COMPRESSED, "no data of zlib.", 16);
    refuse(&builder, CONUS_ERROR_DATA, "variable 1 of MATLAB's file: gzip: damaged");
}

static void complex_numbers_are_none(void **state)
{
    (void)state;
    static const double number = 1;
    struct matlab_builder builder;
    struct job job = {0};
    begin_array(&builder, MX_DOUBLE | MX_COMPLEX, 1, 1);
    matlab_values(&builder, MI_DOUBLE, &number, 1);
    matlab_values(&builder, MI_DOUBLE, &number, 1);
    matlab_close(&builder);
    const struct matlab *matlab = parse(&job, &builder);
    assert_false(matlab_is_real(matlab_variable(matlab, "x")));
    assert_string_equal(matlab_class_name(matlab_variable(matlab, "x")).text, "an array of complex numbers");
    job_end(&job);
    buffer_finish(&builder.bytes);
}

/* A file cut off anywhere but between its variables is refused. */
static void every_prefix_is_refused(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        struct matlab_builder builder;
        size_t whole = 0;
        build_all(&builder, i % 2, i / 2);
        for (size_t size = 0; size < builder.bytes.size; size++) {
            char *exact = malloc(size + !size); /* so that a sanitizer notices one byte too many */
            struct job job = {0};
            memcpy(exact, builder.bytes.data, size);
            const struct matlab *matlab = matlab_read(&job, (struct text){exact, size}, LIMIT);
            assert_true(!job_ok(&job) || matlab->variables == whole++);
            job_end(&job);
            free(exact);
        }
        assert_int_equal(whole, 3);
        buffer_finish(&builder.bytes);
    }
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    for (int packed = 0; packed < 2; packed++) {
        struct matlab_builder builder;
        build_all(&builder, false, packed);
        test_every_allocation(parse_built, &builder);
        buffer_finish(&builder.bytes);
    }
}

TEST_GROUP(matlab)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_every_type),
        cmocka_unit_test(structures_cells_and_texts),
        cmocka_unit_test(sizes_must_fit),
        cmocka_unit_test(single_bytes_that_lie),
        cmocka_unit_test(names_of_fields_must_fit),
        cmocka_unit_test(nests_have_an_end),
        cmocka_unit_test(bombs_are_refused),
        cmocka_unit_test(packed_elements_are_checked),
        cmocka_unit_test(complex_numbers_are_none),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
