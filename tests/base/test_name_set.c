/* SPDX-License-Identifier: BSD-3-Clause */
/* Sets of names against a list of the same names. */
#include "base/memory.h"

#include "test.h"

#include <stdio.h>
#include <string.h>

enum { COUNT = 1000 };

/* Each name is found with its own value once it was added, in any order. */
static void what_was_added_is_found(void **state)
{
    (void)state;
    static char names[COUNT][8];
    static const size_t steps[] = {1, 7, 333, 999}; /* none shares a factor with COUNT */
    for (size_t s = 0; s < 4; s++) {
        const size_t step = steps[s];
        struct name_set set = {0};
        for (size_t i = 0; i < COUNT; i++) {
            size_t k = i * step % COUNT;
            snprintf(names[k], sizeof names[k], "n%zu", k);
            assert_null(name_set_find(&set, names[k]));
            assert_ok(name_set_add(&set, names[k], k));
            for (size_t before = 0; before <= i; before += i / 7 + 1) {
                size_t known = before * step % COUNT;
                assert_int_equal(name_set_find(&set, names[known])->value, known);
            }
        }
        assert_null(name_set_find(&set, "n"));
        assert_null(name_set_find(&set, ""));
        assert_null(name_set_find(&set, "n1000"));
        name_set_finish(&set);
        assert_null(name_set_find(&set, "n1"));
    }
}

static void one_name_may_be_there_twice(void **state)
{
    (void)state;
    struct name_set set = {0};
    for (size_t i = 0; i < 100; i++) {
        assert_ok(name_set_add(&set, "same", i));
        assert_true(name_set_find(&set, "same")->value <= i);
    }
    assert_int_equal(set.count, 100);
    name_set_finish(&set);
}

/* Searching a list would take 3 * 10^10 comparisons, and the test would hang. */
static void a_quarter_of_a_million_is_quick(void **state)
{
    (void)state;
    enum { MANY = 1 << 18 };
    static char names[MANY][8];
    struct name_set set = {0};
    for (size_t i = 0; i < MANY; i++) {
        snprintf(names[i], sizeof names[i], "%zu", i);
        assert_null(name_set_find(&set, names[i]));
        assert_ok(name_set_add(&set, names[i], i));
    }
    name_set_finish(&set);
}

static conus_status add_ten(void *data)
{
    static const char *const names[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j"};
    (void)data;
    struct name_set set = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < 10; i++) {
        status = name_set_add(&set, names[i], i);
        assert_true(status || name_set_find(&set, names[0])->value == 0);
    }
    name_set_finish(&set);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    test_every_allocation(add_ten, NULL);
}

TEST_GROUP(name_set)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_added_is_found),
        cmocka_unit_test(one_name_may_be_there_twice),
        cmocka_unit_test(a_quarter_of_a_million_is_quick),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
