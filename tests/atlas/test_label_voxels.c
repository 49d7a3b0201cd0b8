/* SPDX-License-Identifier: BSD-3-Clause */
/* Voxels that store places in a list of labels, against the labels themselves. */
#include "atlas/labels/labels.h"
#include "base/memory.h"
#include "test.h"

#include <string.h>

enum { COUNT = 180000, MANY = 80000 /* different labels, more than 2 bytes can tell apart */ };

/* Label n of a volume of `different` labels, far apart and out of order; every eighth voxel has none. */
static uint32_t label_of(size_t n, uint32_t different)
{
    return n % 8 ? (uint32_t)(n % different + 1) * 2654435761U | 1U : 0; /* odd, hence not 0 */
}

static uint32_t *make_labels(uint32_t different)
{
    uint32_t *labels = memory_raw(COUNT, sizeof *labels);
    assert_non_null(labels);
    for (size_t i = 0; i < COUNT; i++) {
        labels[i] = label_of(i / 2, different); /* runs of two */
    }
    return labels;
}

static void assert_same(const struct label_voxels *voxels, const uint32_t *labels)
{
    uint32_t some[100];
    assert_int_equal(voxels->count, COUNT);
    for (size_t i = 0; i < COUNT; i++) {
        assert_int_equal(label_voxels_at(voxels, i), labels[i]);
    }
    label_voxels_get(some, voxels, COUNT - 100, 100);
    assert_memory_equal(some, labels + COUNT - 100, sizeof some);
}

static void labels_come_back_in_two_or_four_bytes(void **state)
{
    (void)state;
    static const uint32_t different[] = {1, 2, 100, MANY};
    for (size_t i = 0; i < sizeof different / sizeof different[0]; i++) {
        uint32_t *labels = make_labels(different[i]);
        struct label_voxels voxels = {0};
        assert_ok(label_voxels_of(&voxels, labels, COUNT));
        assert_int_equal(voxels.wide != NULL, different[i] == MANY);
        assert_int_equal(voxels.narrow != NULL, different[i] != MANY);
        assert_same(&voxels, labels);
        label_voxels_finish(&voxels);
        memory_free(labels);
    }
}

/* Labels are compared side by side: one voxel that differs in one bit is found wherever it is in a run of others. */
static void one_voxel_in_a_run_is_found(void **state)
{
    (void)state;
    enum { RUN = 70 };
    for (size_t odd = 0; odd < RUN; odd++) {
        uint32_t labels[RUN];
        struct label_voxels voxels = {0};
        for (size_t i = 0; i < RUN; i++) {
            labels[i] = i == odd ? 5 ^ UINT32_C(1) << odd % 32 : 5;
        }
        assert_ok(label_voxels_of(&voxels, labels, RUN));
        for (size_t i = 0; i < RUN; i++) {
            assert_int_equal(label_voxels_at(&voxels, i), labels[i]);
        }
        label_voxels_finish(&voxels);
    }
}

/* 65,535 labels and 0 fit into 2 bytes; one more takes 4 bytes. */
static void the_last_place_of_two_bytes_is_used(void **state)
{
    (void)state;
    for (uint32_t most = UINT16_MAX; most <= UINT16_MAX + 1; most++) {
        struct label_voxels voxels = {0};
        uint32_t *labels = memory_raw(most + 1, sizeof *labels);
        assert_non_null(labels);
        for (uint32_t i = 0; i <= most; i++) {
            labels[i] = most - i;
        }
        assert_ok(label_voxels_of(&voxels, labels, most + 1));
        assert_int_equal(voxels.narrow != NULL, most == UINT16_MAX);
        assert_int_equal(label_voxels_at(&voxels, 0), most);
        assert_int_equal(label_voxels_at(&voxels, most - 1), 1);
        assert_int_equal(label_voxels_at(&voxels, most), 0);
        label_voxels_finish(&voxels);
        memory_free(labels);
    }
}

static void a_tally_counts_the_voxels_of_each_label(void **state)
{
    (void)state;
    uint32_t *labels = make_labels(100);
    struct label_voxels voxels = {0};
    struct label_map tally = {0};
    uint64_t sum = 0;
    assert_ok(label_voxels_of(&voxels, labels, COUNT));
    label_voxels_clear(&voxels, 2); /* its label is that of one voxel fewer */
    labels[2] = 0;
    assert_ok(label_voxels_tally(&tally, &voxels));
    for (size_t i = 0; i <= tally.mask; i++) {
        uint64_t wanted = 0;
        for (size_t v = 0; v < COUNT && tally.slots[i].used; v++) {
            wanted += labels[v] == tally.slots[i].label;
        }
        assert_int_equal(tally.slots[i].value, wanted);
        sum += wanted;
    }
    assert_int_equal(sum, COUNT / 8 * 7 - 1); /* COUNT is a multiple of 16 */
    label_map_finish(&tally);
    label_voxels_finish(&voxels);
    memory_free(labels);
}

/* Labels of the first volume stay; those of the second fill its voxels of label 0, also where a label was set to 0. */
static void merging_fills_what_is_empty(void **state)
{
    (void)state;
    for (uint32_t different = 100; different <= MANY; different += MANY - 100) {
        uint32_t *first = make_labels(100);
        uint32_t *second = memory_raw(COUNT, sizeof *second);
        struct label_voxels to = {0};
        struct label_voxels from = {0};
        assert_non_null(second);
        for (size_t i = 0; i < COUNT; i++) {
            second[i] = i % 16 ? (uint32_t)(i % different) * 2U + 2U : 0; /* even: labels that `first` lacks */
        }
        assert_ok(label_voxels_of(&to, first, COUNT));
        assert_ok(label_voxels_of(&from, second, COUNT));
        uint32_t forgotten = to.labels[5];
        to.labels[5] = 0;
        assert_ok(label_voxels_merge(&to, &from));
        assert_int_equal(to.wide != NULL, different == MANY);
        for (size_t i = 0; i < COUNT; i++) {
            uint32_t left = first[i] == forgotten ? 0 : first[i];
            first[i] = left ? left : second[i];
        }
        assert_same(&to, first);
        label_voxels_finish(&to);
        label_voxels_finish(&from);
        memory_free(first);
        memory_free(second);
    }
}

/* Numbers replace places in 2 bytes and in 4, whichever the places had. */
static void numbers_take_the_place_of_places(void **state)
{
    (void)state;
    for (int round = 0; round < 4; round++) {
        uint32_t *labels = make_labels(round & 1 ? MANY : 100);
        struct label_voxels voxels = {0};
        assert_ok(label_voxels_of(&voxels, labels, COUNT));
        uint32_t *numbers = memory_raw(voxels.label_count, sizeof *numbers);
        assert_non_null(numbers);
        for (size_t p = 0; p < voxels.label_count; p++) {
            numbers[p] = voxels.labels[p] % 65521;
        }
        bool narrow = round & 2;
        assert_ok(label_voxels_renumber(&voxels, numbers, narrow));
        assert_int_equal(voxels.narrow != NULL, narrow);
        for (size_t i = 0; i < COUNT; i++) {
            assert_int_equal(narrow ? voxels.narrow[i] : voxels.wide[i], labels[i] % 65521);
        }
        memory_free(numbers);
        label_voxels_finish(&voxels);
        memory_free(labels);
    }
}

/* Parts of the voxels come in reverse order, and one of them never: its voxels have label 0. */
static void voxels_come_in_any_order(void **state)
{
    (void)state;
    enum { PIECE = 1000 };
    static const uint32_t different[] = {100, MANY};
    for (size_t n = 0; n < sizeof different / sizeof different[0]; n++) {
        struct label_coder coder;
        struct label_voxels voxels = {0};
        struct label_map tally = {0};
        uint32_t *labels = make_labels(different[n]);
        assert_ok(label_coder_init(&coder, COUNT, 0, NULL, 0));
        memset(labels, 0, PIECE * sizeof *labels);
        for (size_t at = COUNT; at > PIECE; at -= PIECE) {
            assert_ok(label_coder_put(&coder, at - PIECE, labels + at - PIECE, PIECE));
        }
        label_coder_end(&voxels, &coder);
        assert_int_equal(coder.minimum, 0);
        label_coder_finish(&coder);
        assert_int_equal(voxels.wide != NULL, different[n] == MANY);
        assert_same(&voxels, labels);
        assert_ok(label_voxels_tally(&tally, &voxels));
        uint64_t filled = 0;
        for (size_t i = 0; i < COUNT; i++) {
            filled += labels[i] != 0;
        }
        for (size_t i = 0; i <= tally.mask; i++) {
            filled -= tally.slots[i].value;
        }
        assert_int_equal(filled, 0);
        label_map_finish(&tally);
        label_voxels_finish(&voxels);
        memory_free(labels);
    }
}

/* A block of voxels with a label is renumbered; blocks of label 0 before and behind it stay 0. */
static void empty_blocks_stay_empty(void **state)
{
    (void)state;
    const uint32_t numbers[3] = {0, 7, 1};
    for (size_t at = 0; at < 5; at++) {
        static const size_t places[5] = {0, LABEL_BLOCK - 1, LABEL_BLOCK, 3 * LABEL_BLOCK + 17, COUNT - 1};
        struct label_coder coder;
        struct label_voxels voxels = {0};
        const uint32_t labels[2] = {40, 50};
        size_t count = at == 4 ? 1 : 2; /* the second pair lies in two blocks */
        assert_ok(label_coder_init(&coder, COUNT, 0, NULL, 0));
        assert_ok(label_coder_put(&coder, places[at], labels, count));
        label_coder_end(&voxels, &coder);
        label_coder_finish(&coder);
        assert_ok(label_voxels_renumber(&voxels, numbers, true));
        for (size_t i = 0; i < COUNT; i++) {
            bool is = i >= places[at] && i < places[at] + count;
            assert_int_equal(voxels.narrow[i], is ? numbers[1 + i - places[at]] : 0);
        }
        label_voxels_finish(&voxels);
    }
}

static conus_status code_and_finish(struct label_coder *coder, const uint32_t *labels, size_t count)
{
    struct label_voxels voxels = {0};
    conus_status status = label_coder_add(coder, labels, count);
    if (!status) {
        label_coder_end(&voxels, coder);
    }
    label_voxels_finish(&voxels);
    label_coder_finish(coder);
    return status;
}

static void what_does_not_fit_is_refused(void **state)
{
    (void)state;
    struct label_coder coder;
    uint32_t *labels = make_labels(MANY);
    /* label_of() has a label for 7 of 8 numbers of 80,000, and 90,000 pairs of voxels pass them all. */
    const uint64_t all = 4 * COUNT + MANY / 8 * 7 * (uint64_t)LABEL_BYTES;
    assert_ok(label_coder_init(&coder, COUNT, all, NULL, 0));
    assert_ok(code_and_finish(&coder, labels, COUNT));
    assert_ok(label_coder_init(&coder, COUNT, all - 1, NULL, 0));
    assert_fails(code_and_finish(&coder, labels, COUNT), CONUS_ERROR_MEMORY);
    assert_string_equal(conus_message(), "labels: found 70000 different ones, which take 512 bytes each, and 180000 "
                                         "voxels with 4, allowed are 36559999 bytes (--max-memory)");
    /* The 65,536th label widens the voxels: here the wider voxels do not fit. */
    assert_ok(label_coder_init(&coder, COUNT, 4 * COUNT + 65536 * (uint64_t)LABEL_BYTES - 1, NULL, 0));
    assert_fails(code_and_finish(&coder, labels, COUNT), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "found 65536 different ones"));
    assert_ok(label_coder_init(&coder, COUNT, 2 * COUNT, NULL, 0));
    memset(labels, 1, COUNT * sizeof *labels);
    assert_fails(code_and_finish(&coder, labels, COUNT), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "found 1 different ones"));
    assert_ok(label_coder_init(&coder, COUNT, 2 * COUNT + LABEL_BYTES, NULL, 0));
    assert_ok(code_and_finish(&coder, labels, COUNT));
    assert_fails(label_coder_init(&coder, COUNT, 2 * COUNT - 1, NULL, 0), CONUS_ERROR_MEMORY);
    label_coder_finish(&coder);
    assert_fails(label_coder_init(&coder, SIZE_MAX / 2 + 2, 0, NULL, 0), CONUS_ERROR_MEMORY);
    label_coder_finish(&coder);
    memory_free(labels);
}

static conus_status make_and_merge(void *data)
{
    struct label_voxels to = {0};
    struct label_voxels from = {0};
    struct label_map tally = {0};
    const uint32_t *labels = data;
    uint32_t few[COUNT / 1000] = {1, 2, 3};
    conus_status status = label_voxels_of(&to, few, COUNT / 1000);
    status = status ? status : label_voxels_of(&from, labels, COUNT);
    from.count = COUNT / 1000;
    status = status ? status : label_voxels_merge(&to, &from);
    status = status ? status : label_voxels_tally(&tally, &to);
    label_map_finish(&tally);
    label_voxels_finish(&to);
    label_voxels_finish(&from);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    uint32_t *labels = make_labels(MANY);
    test_every_allocation(make_and_merge, labels);
    memory_free(labels);
}

TEST_GROUP(label_voxels)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(labels_come_back_in_two_or_four_bytes),
        cmocka_unit_test(one_voxel_in_a_run_is_found),
        cmocka_unit_test(the_last_place_of_two_bytes_is_used),
        cmocka_unit_test(a_tally_counts_the_voxels_of_each_label),
        cmocka_unit_test(merging_fills_what_is_empty),
        cmocka_unit_test(numbers_take_the_place_of_places),
        cmocka_unit_test(voxels_come_in_any_order),
        cmocka_unit_test(empty_blocks_stay_empty),
        cmocka_unit_test(what_does_not_fit_is_refused),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests_name("label_voxels", tests, NULL, NULL);
}
