/* SPDX-License-Identifier: BSD-3-Clause */
/* What libhdf5 takes of the programs for other systems is counted: to the byte, from the first memory_allow() on, and
 * given back with what is freed. The tests use one counter, in this order. */
#include "hdf5/memory_limit.h"
#include "test.h"

#include <string.h>

static void all_is_allowed_before_a_limit(void **state)
{
    (void)state;
    void *before = counted_resize(NULL, 5000);
    assert_non_null(before);
    memory_allow(1000); /* beside the 5000 that it has */
    void *last = counted_resize(NULL, 1000);
    assert_non_null(last);
    assert_null(counted_resize(NULL, 1));
    counted_free(before);
    counted_free(last);
}

static void it_is_counted_to_the_byte(void **state)
{
    (void)state;
    char *half = counted_zeros(1500, 2); /* of the 6000 that are allowed by now */
    assert_non_null(half);
    for (size_t i = 0; i < 3000; i++) {
        assert_int_equal(half[i], 0);
    }
    assert_null(counted_zeros(3001, 1));
    char *text = counted_text("abc"); /* 4 bytes */
    assert_string_equal(text, "abc");
    assert_null(counted_zeros(2997, 1));
    char *rest = counted_zeros(2996, 1);
    assert_non_null(rest);
    assert_null(counted_text(""));
    counted_free(rest);
    counted_free(text);
    memset(half, 7, 3000);
    char *grown = counted_resize(half, 6000);
    assert_non_null(grown);
    assert_int_equal(grown[2999], 7);
    assert_null(counted_resize(grown, 6001)); /* which leaves it as it is */
    assert_int_equal(grown[0], 7);
    counted_free(grown);
    counted_free(NULL);
}

static void sizes_that_no_number_holds_are_none(void **state)
{
    (void)state;
    memory_allow(UINT64_MAX);
    memory_allow(UINT64_MAX);
    assert_null(counted_zeros(SIZE_MAX / 2, 3));
    assert_null(counted_resize(NULL, SIZE_MAX));
    assert_null(counted_resize(NULL, SIZE_MAX - 8));
}

TEST_GROUP(memory_counted)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_is_allowed_before_a_limit),
        cmocka_unit_test(it_is_counted_to_the_byte),
        cmocka_unit_test(sizes_that_no_number_holds_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
