/* SPDX-License-Identifier: BSD-3-Clause */
/* The stable sort. Rows of 3 keys are expected as those of key 0 in their order, then those of 1, then those of 2; rows
 * that all differ as the C library sorts them; with memory, and where there is none. */
#include "base/order.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { KEYS = 3, LONG = 10000 };

static int by_first_byte(const void *a, const void *b)
{
    return *(const uint8_t *)a - *(const uint8_t *)b;
}

/* Rows of a key, and of the lowest bytes of their number. */
static void fill_rows(uint8_t *rows, size_t count, size_t size, uint64_t *random)
{
    for (size_t i = 0; i < count && size; i++) {
        uint64_t number = i;
        memset(rows + i * size, 0, size);
        memcpy(rows + i * size + 1, &number, size - 1 < 8 ? size - 1 : 8);
        rows[i * size] = (uint8_t)test_random(random, 0, KEYS);
    }
}

static void assert_stable(size_t count, size_t size, bool has_memory, uint64_t *random)
{
    uint8_t *rows = calloc(count + 1, size + 1);
    uint8_t *wanted = calloc(count + 1, size + 1);
    size_t at = 0;
    assert_non_null(rows);
    assert_non_null(wanted);
    fill_rows(rows, count, size, random);
    for (int key = 0; key < KEYS; key++) {
        for (size_t i = 0; i < count && size; i++) {
            if (rows[i * size] == key) {
                memcpy(wanted + at, rows + i * size, size);
                at += size;
            }
        }
    }
    test_fail_allocation(has_memory ? -1 : 0);
    order_sort(rows, count, size, by_first_byte);
    test_fail_allocation(-1);
    assert_memory_equal(rows, wanted, count * size + 1);
    free(rows);
    free(wanted);
}

static void equal_rows_keep_their_order(void **state)
{
    (void)state;
    static const size_t counts[] = {0, 1, 2, 3, 8, 9, 17, 100, 400};
    uint64_t random = 0;
    for (int memory = 0; memory < 2; memory++) {
        for (size_t size = 0; size <= 200; size++) {
            for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
                assert_stable(counts[i], size, memory, &random);
            }
        }
        assert_stable(LONG, 4, memory, &random);
        assert_stable(LONG, 24, memory, &random);
        assert_stable(LONG, 200, memory, &random);
        assert_stable(100, 5000, memory, &random); /* one is more than what needs no allocation */
    }
    order_sort(NULL, 0, 8, compare_u64);
}

static void rows_are_those_of_qsort(void **state)
{
    (void)state;
    uint64_t random = 1;
    for (size_t trial = 0; trial < test_trials(400); trial++) {
        size_t count = (size_t)pow(2, test_random(&random, 0, 12));
        uint64_t ours[4096];
        uint64_t theirs[4096];
        double most = pow(2, test_random(&random, 0, 64));
        for (size_t i = 0; i < count; i++) {
            ours[i] = theirs[i] = (uint64_t)test_random(&random, 0, most);
        }
        test_fail_allocation(trial % 2 ? 0 : -1);
        order_sort(ours, count, sizeof *ours, compare_u64);
        test_fail_allocation(-1);
        qsort(theirs, count, sizeof *theirs, compare_u64);
        assert_memory_equal(ours, theirs, count * sizeof *ours);
        order_sort(ours, 2 * count, 4, compare_u32);
        qsort(theirs, 2 * count, 4, compare_u32);
        assert_memory_equal(ours, theirs, count * sizeof *ours);
    }
}

struct counting {
    size_t size, comparisons;
};

static int compare_and_count(const void *a, const void *b, void *user)
{
    struct counting *counting = user;
    counting->comparisons++;
    return memcmp(a, b, counting->size);
}

/* Sorts LONG rows whose first 4 bytes are what `number` says of i; returns how many comparisons that took. */
static size_t count_comparisons(size_t size, uint32_t (*number)(size_t i), bool has_memory)
{
    struct counting counting = {.size = size};
    uint8_t *rows = calloc(LONG, size);
    assert_non_null(rows);
    for (size_t i = 0; i < LONG; i++) {
        for (size_t k = 0; k < 4; k++) {
            rows[i * size + k] = (uint8_t)(number(i) >> (24 - 8 * k));
        }
    }
    test_fail_allocation(has_memory ? -1 : 0);
    order_sort_by(rows, LONG, size, compare_and_count, &counting);
    assert_int_equal(test_allocation_failed(), !has_memory);
    test_fail_allocation(-1);
    for (size_t i = 1; i < LONG; i++) {
        assert_true(memcmp(rows + (i - 1) * size, rows + i * size, size) <= 0);
    }
    free(rows);
    return counting.comparisons;
}

static uint32_t upward(size_t i)
{
    return (uint32_t)i;
}

static uint32_t downward(size_t i)
{
    return (uint32_t)(LONG - i);
}

static uint32_t equal(size_t i)
{
    return 7 + 0 * (uint32_t)i;
}

static uint32_t anyhow(size_t i)
{
    return (uint32_t)i * UINT32_C(2654435761);
}

/* log2(LONG) is below 14. Merging takes n log2(n) comparisons at most, 8 rows by insertion 28 in the place of 17; in
 * place another bisection, of 14 at most, for each row that the last rows of 4096 bytes do not hold. */
static void no_input_is_slow(void **state)
{
    (void)state;
    static const size_t sizes[] = {4, 24, 72};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        for (int memory = 0; memory < 2; memory++) {
            size_t most = (size_t)LONG * 14 * (memory ? 1 : 14);
            assert_in_range(count_comparisons(sizes[i], upward, memory), LONG - 1, 2 * LONG);
            assert_in_range(count_comparisons(sizes[i], equal, memory), LONG - 1, 2 * LONG);
            assert_in_range(count_comparisons(sizes[i], downward, memory), LONG - 1, most);
            assert_in_range(count_comparisons(sizes[i], anyhow, memory), LONG - 1, most);
        }
    }
}

static void numbers_and_texts_are_compared(void **state)
{
    (void)state;
    double numbers[] = {INFINITY, -0.5, 3, -INFINITY};
    const char *texts[] = {"b", "", "\xc3\xa4", "a"}; /* by bytes */
    order_sort(numbers, 4, sizeof *numbers, compare_f64);
    order_sort(texts, 4, sizeof *texts, compare_text_pointers);
    assert_true(numbers[0] == -INFINITY && numbers[1] == -0.5 && numbers[2] == 3 && numbers[3] == INFINITY);
    assert_true(!texts[0][0] && texts[1][0] == 'a' && texts[2][0] == 'b');
}

TEST_GROUP(order)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_rows_keep_their_order),
        cmocka_unit_test(rows_are_those_of_qsort),
        cmocka_unit_test(no_input_is_slow),
        cmocka_unit_test(numbers_and_texts_are_compared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
