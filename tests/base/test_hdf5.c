/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the reader of conus-hdf5's stream, whole, cut off and damaged, and of the search for objects in it. */
#include "base/child/hdf5.h"

#include "base/memory.h"
#include "builders/hdf5_builder.h"
#include "test.h"

#include <string.h>

/* The objects are the job's, which ends after a failure. */
static conus_status parse(struct job *job, const struct hdf5 **out, const struct hdf5_builder *builder, size_t size)
{
    *job = (struct job){0};
    const char *stream = job_adopt(job, memory_copy(builder->bytes.data, size, 1));
    if (job_need(job, stream)) {
        *out = hdf5_of_stream(job, (struct text){stream, size});
    }
    return job_ok(job) ? CONUS_OK : job_close(job, NULL, NULL);
}

/* A transform of two parts, one with attributes, and a group whose name is no number. */
static void build(struct hdf5_builder *builder)
{
    static const double numbers[] = {1, -2.5, 3e300};
    static const char *const texts[] = {"", "Affine", "x"};
    static const int16_t whole[] = {-1, 2, 300, 4};
    hdf5_begin(builder);
    hdf5_group(builder, "/T");
    hdf5_doubles(builder, HDF5_FRAME_ATTRIBUTE, "scale", numbers, 3);
    hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "words", texts, 3);
    hdf5_strings(builder, HDF5_FRAME_OBJECT, "/T/10/type", texts, 3);
    hdf5_doubles(builder, HDF5_FRAME_OBJECT, "/T/2/numbers", numbers, 3);
    hdf5_frame(builder,
               (struct built_value){HDF5_FRAME_OBJECT, HDF5_SIGNED, 2, 2, {2, 2}, 77, "/T/9", whole, sizeof whole});
    hdf5_group(builder, "/T/2");
    hdf5_group(builder, "/T/10");
    hdf5_group(builder, "/T/a");
    hdf5_end(builder);
}

static void objects_are_found_by_path_and_by_address(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    struct job job;
    const struct hdf5 *hdf5;
    build(&builder);
    assert_ok(parse(&job, &hdf5, &builder, builder.bytes.size));
    assert_int_equal(hdf5_count(hdf5), 7);
    const struct hdf5_object *type = hdf5_find(hdf5, "/T/10/type");
    assert_non_null(type);
    assert_int_equal(type->value.class, HDF5_STRING);
    assert_int_equal(type->value.count, 3);
    assert_true(text_equal(hdf5_string(&type->value, 0), ""));
    assert_true(text_equal(hdf5_string(&type->value, 1), "Affine"));
    assert_true(text_equal(hdf5_string(&type->value, 2), "x"));
    assert_null(hdf5_find(hdf5, "/T/1"));
    assert_null(hdf5_find(hdf5, "/T/10/typ"));

    const struct hdf5_object *whole = hdf5_find_address(hdf5, 77);
    assert_ptr_equal(whole, hdf5_find(hdf5, "/T/9"));
    assert_null(hdf5_find_address(hdf5, 78));
    assert_int_equal(whole->value.rank, 2);
    assert_near(hdf5_number(&whole->value, 0), -1, 0);
    assert_int_equal(hdf5_whole(&whole->value, 2), 300);

    const struct hdf5_object *numbers = hdf5_find_in(hdf5, text_from("/T/2"), "numbers");
    assert_non_null(numbers);
    assert_near(hdf5_number(&numbers->value, 2), 3e300, 0);
    assert_null(hdf5_find_in(hdf5, text_from("/T"), "numbers"));
    job_end(&job);
    buffer_finish(&builder.bytes);
}

static void attributes_are_those_of_their_object(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    struct job job;
    const struct hdf5 *hdf5;
    build(&builder);
    assert_ok(parse(&job, &hdf5, &builder, builder.bytes.size));
    const struct hdf5_object *group = hdf5_find(hdf5, "/T");
    assert_int_equal(group->attribute_count, 2);
    assert_near(hdf5_number(hdf5_attribute(group, "scale"), 1), -2.5, 0);
    assert_true(text_equal(hdf5_string(hdf5_attribute(group, "words"), 1), "Affine"));
    assert_null(hdf5_attribute(group, "sca"));
    assert_null(hdf5_attribute(hdf5_find(hdf5, "/T/9"), "scale"));
    job_end(&job);
    buffer_finish(&builder.bytes);
}

/* Alphabetically 10 would come before 2. */
static void numbers_are_in_the_order_of_numbers(void **state)
{
    (void)state;
    static const char *const wanted[] = {"2", "9", "10", "a"};
    struct hdf5_builder builder;
    struct job job;
    const struct hdf5 *hdf5;
    size_t at = 0;
    build(&builder);
    assert_ok(parse(&job, &hdf5, &builder, builder.bytes.size));
    for (size_t i = 0; i < 4; i++) {
        const struct hdf5_object *next = hdf5_next_in(hdf5, &at, text_from("/T"));
        assert_non_null(next);
        assert_true(text_equal(hdf5_last_name(next->value.name), wanted[i]));
    }
    assert_null(hdf5_next_in(hdf5, &at, text_from("/T")));
    at = 0;
    assert_ptr_equal(hdf5_next_in(hdf5, &at, text_from("/")), hdf5_find(hdf5, "/T"));
    assert_null(hdf5_next_in(hdf5, &at, text_from("/")));
    job_end(&job);
    buffer_finish(&builder.bytes);
}

/* 9 < 10 as numbers, and 10 < 1a < 9 as letters: numbers come first, so that there is one order. */
static void there_is_one_order_of_names(void **state)
{
    (void)state;
    static const char *const wanted[] = {"/9", "/010", "/10", "/1a", "/b"};
    for (size_t first = 0; first < 5; first++) {
        struct hdf5_builder builder;
        struct job job;
        const struct hdf5 *hdf5;
        hdf5_begin(&builder);
        for (size_t i = 0; i < 5; i++) {
            hdf5_group(&builder, wanted[(first + 2 * i) % 5]);
        }
        hdf5_end(&builder);
        assert_ok(parse(&job, &hdf5, &builder, builder.bytes.size));
        for (size_t i = 0; i < 5; i++) {
            assert_true(text_equal(hdf5_object(hdf5, i)->value.name, wanted[i]));
            assert_ptr_equal(hdf5_find(hdf5, wanted[i]), hdf5_object(hdf5, i));
        }
        job_end(&job);
        buffer_finish(&builder.bytes);
    }
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    struct job job;
    const struct hdf5 *hdf5;
    build(&builder);
    for (size_t size = 0; size < builder.bytes.size; size++) {
        assert_fails(parse(&job, &hdf5, &builder, size), CONUS_ERROR_DATA);
    }
    buffer_text(&builder.bytes, "12345678");
    assert_fails(parse(&job, &hdf5, &builder, builder.bytes.size), CONUS_ERROR_DATA);
    buffer_finish(&builder.bytes);
}

static void impossible_frames_are_refused(void **state)
{
    (void)state;
    static const uint64_t backwards[] = {0, 2, 1, 2, 0};
    static const uint64_t more[] = {0, 1, 0};
    static const uint64_t beyond[] = {0, 1, 9, 0};
    static const uint64_t early[] = {1, 1, 1, 0};
    static const char same[8] = "12345678";
    const struct {
        struct built_value value;
        const char *part;
    } cases[] = {
        {{.kind = 0, .name = "/a"}, "no frame"},
        {{.kind = 5, .name = "/a"}, "no frame"},
        {{.kind = HDF5_FRAME_OBJECT, .class = 0, .name = "/a"}, "impossible shape"},
        {{.kind = HDF5_FRAME_OBJECT, .class = 8, .name = "/a"}, "impossible shape"},
        {{.kind = HDF5_FRAME_OBJECT, .class = HDF5_GROUP, .name = "a"}, "a name that is none"},
        {{.kind = HDF5_FRAME_OBJECT, .class = HDF5_GROUP, .name = ""}, "a name that is none"},
        {{.kind = HDF5_FRAME_OBJECT, .class = HDF5_GROUP, .size = 1, .name = "/a"}, "impossible shape"},
        {{.kind = HDF5_FRAME_OBJECT, .class = HDF5_FLOAT, .size = 2, .name = "/a", .data = same, .data_size = 2},
         "impossible"},
        {{.kind = HDF5_FRAME_OBJECT, .class = HDF5_SIGNED, .size = 3, .name = "/a", .data = same, .data_size = 3},
         "impossible"},
        {{HDF5_FRAME_OBJECT, HDF5_FLOAT, 8, 9, {1, 1, 1, 1, 1, 1, 1, 1}, 0, "/a", same, 8}, "impossible shape"},
        {{HDF5_FRAME_OBJECT, HDF5_FLOAT, 8, 1, {1, 1}, 0, "/a", same, 8}, "impossible shape"},
        {{HDF5_FRAME_OBJECT, HDF5_FLOAT, 4, 1, {1}, 0, "/a", same, 8}, "impossible shape"},
        {{HDF5_FRAME_OBJECT, HDF5_FLOAT, 8, 2, {UINT64_C(1) << 32, UINT64_C(1) << 32}, 0, "/a", same, 8},
         "impossible shape"},
        {{HDF5_FRAME_OBJECT, HDF5_FLOAT, 8, 1, {UINT64_C(1) << 61}, 0, "/a", NULL, 0}, "impossible shape"},
        {{HDF5_FRAME_OBJECT, HDF5_FLOAT, 8, 1, {1}, 0, "/a", NULL, UINT64_MAX}, "cut off"},
        {{HDF5_FRAME_OBJECT, HDF5_STRING, 0, 1, {3}, 0, "/a", backwards, 34}, "impossible shape"},
        {{HDF5_FRAME_OBJECT, HDF5_STRING, 0, 1, {1}, 0, "/a", more, 24}, "impossible shape"},
        {{HDF5_FRAME_OBJECT, HDF5_STRING, 0, 1, {2}, 0, "/a", beyond, 32}, "impossible shape"},
        {{HDF5_FRAME_OBJECT, HDF5_STRING, 0, 1, {2}, 0, "/a", early, 25}, "impossible shape"},
        {{HDF5_FRAME_OBJECT, HDF5_STRING, 0, 1, {2}, 0, "/a", beyond, 16}, "impossible shape"},
        {{HDF5_FRAME_OBJECT, HDF5_STRING, 0, 1, {UINT64_MAX / 8}, 0, "/a", beyond, 16}, "impossible shape"},
        {{HDF5_FRAME_OBJECT, HDF5_STRING, 0, 0, {0}, 0, "/a", NULL, 0}, "impossible shape"},
        {{.kind = HDF5_FRAME_ATTRIBUTE, .class = HDF5_OTHER, .name = "a"}, "an attribute before any object"},
        {{.kind = HDF5_FRAME_END, .address = 1}, "its end does not match"},
        {{.kind = HDF5_FRAME_END, .name = "a"}, "a name that is none"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct hdf5_builder builder;
        struct job job;
        const struct hdf5 *hdf5;
        hdf5_begin(&builder);
        hdf5_frame(&builder, cases[i].value);
        hdf5_end(&builder);
        assert_fails(parse(&job, &hdf5, &builder, builder.bytes.size), CONUS_ERROR_DATA);
        if (!strstr(conus_message(), cases[i].part)) {
            fail_msg("case %zu: \"%s\" does not say \"%s\"", i, conus_message(), cases[i].part);
        }
        buffer_finish(&builder.bytes);
    }
}

static void the_end_counts_the_frames(void **state)
{
    (void)state;
    for (uint64_t count = 0; count < 3; count++) {
        struct hdf5_builder builder;
        struct job job;
        const struct hdf5 *hdf5 = NULL;
        hdf5_begin(&builder);
        hdf5_group(&builder, "/a");
        hdf5_frame(&builder, (struct built_value){.kind = HDF5_FRAME_END, .address = count});
        assert_int_equal(parse(&job, &hdf5, &builder, builder.bytes.size), count == 1 ? CONUS_OK : CONUS_ERROR_DATA);
        job_end(&job);
        buffer_finish(&builder.bytes);
    }
}

static void nothing_is_there_twice(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    struct job job;
    const struct hdf5 *hdf5;
    hdf5_begin(&builder);
    hdf5_group(&builder, "/a");
    hdf5_group(&builder, "/b");
    hdf5_group(&builder, "/a");
    hdf5_end(&builder);
    assert_fails(parse(&job, &hdf5, &builder, builder.bytes.size), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "/a is there twice"));
    buffer_finish(&builder.bytes);
}

static void failures_are_what_the_file_is_refused_for(void **state)
{
    (void)state;
    for (uint32_t kind = 0; kind < 2; kind++) {
        struct hdf5_builder builder;
        struct job job;
        const struct hdf5 *hdf5;
        hdf5_begin(&builder);
        hdf5_group(&builder, "/a");
        hdf5_frame(&builder, (struct built_value){.kind = HDF5_FRAME_FAILURE, .rank = kind, .name = "/a: a circle"});
        assert_fails(parse(&job, &hdf5, &builder, builder.bytes.size), kind ? CONUS_ERROR_MEMORY : CONUS_ERROR_DATA);
        assert_string_equal(conus_message(), "/a: a circle");
        buffer_finish(&builder.bytes);
    }
}

static void an_empty_answer_is_one(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    struct job job;
    const struct hdf5 *hdf5;
    size_t at = 0;
    hdf5_begin(&builder);
    hdf5_end(&builder);
    assert_ok(parse(&job, &hdf5, &builder, builder.bytes.size));
    assert_null(hdf5_find(hdf5, "/"));
    assert_null(hdf5_find_address(hdf5, 0));
    assert_null(hdf5_next_in(hdf5, &at, text_from("/")));
    job_end(&job);
    buffer_finish(&builder.bytes);
}

/* A block of the user's, as in MATLAB's files, may come before the file. */
static void the_mark_is_at_powers_of_two(void **state)
{
    (void)state;
    static const struct {
        size_t at;
        bool is;
    } cases[] = {{0, true}, {512, true}, {1024, true}, {4096, true}, {8, false}, {1536, false}, {256, false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        uint8_t file[4104] = {0};
        memcpy(file + cases[i].at, "\x89HDF\r\n\x1a\n", 8);
        assert_int_equal(hdf5_is(file, cases[i].at + 8), cases[i].is);
        assert_false(hdf5_is(file, cases[i].at + 7));
    }
    assert_false(hdf5_is((const uint8_t *)"", 0));
}

static conus_status attempt(void *data)
{
    struct job job;
    const struct hdf5 *hdf5 = NULL;
    const struct hdf5_builder *builder = data;
    conus_status status = parse(&job, &hdf5, builder, builder->bytes.size);
    job_end(&job);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    build(&builder);
    test_every_allocation(attempt, &builder);
    buffer_finish(&builder.bytes);
}

TEST_GROUP(hdf5)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(objects_are_found_by_path_and_by_address),
        cmocka_unit_test(attributes_are_those_of_their_object),
        cmocka_unit_test(numbers_are_in_the_order_of_numbers),
        cmocka_unit_test(there_is_one_order_of_names),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(impossible_frames_are_refused),
        cmocka_unit_test(the_end_counts_the_frames),
        cmocka_unit_test(nothing_is_there_twice),
        cmocka_unit_test(failures_are_what_the_file_is_refused_for),
        cmocka_unit_test(an_empty_answer_is_one),
        cmocka_unit_test(the_mark_is_at_powers_of_two),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
