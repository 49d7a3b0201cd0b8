/* SPDX-License-Identifier: BSD-3-Clause */
/* ID manifests: the bytes of OpenEXR's own encoder. */
#include "base/memory.h"
#include "conus/status.h"
#include "exr_oracle.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const COMPONENTS[] = {"name", "label", "kind"};

/* Both encoders give the same bytes. */
static void assert_as_openexr(const struct id_manifest_group *groups, size_t count)
{
    struct bytes got;
    size_t size = 0;
    uint8_t *wanted = exr_manifest(&size, groups, count);
    assert_ok(id_manifest_format(&got, groups, count));
    assert_int_equal(got.size, size);
    assert_memory_equal(got.data, wanted, size);
    bytes_finish(&got);
    free(wanted);
}

static void a_few_names(void **state)
{
    (void)state;
    static const uint32_t ids[] = {1, 7, 300, 70000, UINT32_MAX};
    static const char *const texts[] = {
        "Hippocampe gauche, \xc3\xa9",
        "1",
        "area",
        "tab\there",
        "7",
        "area",
        "\"quoted\"",
        "300",
        "area",
        "",
        "70000",
        "area",
        "\xe5\xb9\xb3\xe5\x8e\x9f",
        "1",
        "pathway",
    };
    const struct id_manifest_group groups[] = {{"id", COMPONENTS, 1, ids, 5, texts},
                                               {"object", COMPONENTS, 3, ids, 5, texts}};
    assert_as_openexr(groups, 2);
    assert_as_openexr(groups, 1);
    assert_as_openexr(groups + 1, 1);
    assert_as_openexr(groups, 0);
    assert_as_openexr(&(struct id_manifest_group){"id", COMPONENTS, 1, ids, 0, texts}, 1);
}

/* Lengths around the limits of the encoding: the length of the previous text decides whether one byte or two count the
 * shared bytes. */
static void long_names(void **state)
{
    (void)state;
    enum { COUNT = 8, LONGEST = 70000 };
    static const size_t lengths[COUNT] = {1, 254, 255, 256, 257, 65534, 65536, LONGEST};
    static char storage[COUNT][LONGEST + 1];
    const char *texts[COUNT];
    uint32_t ids[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        memset(storage[i], 'a', lengths[i]);
        ids[i] = 1000 * i;
        texts[i] = storage[i];
    }
    assert_as_openexr(&(struct id_manifest_group){"id", COMPONENTS, 1, ids, COUNT, texts}, 1);
}

/* Names that share much or little, so that ranks of one, two and three bytes make runs of all lengths; ids near and
 * far. */
static void check_random(uint64_t *state, size_t count, uint32_t step)
{
    char(*storage)[40] = malloc(count * sizeof *storage);
    const char **texts = malloc(3 * count * sizeof *texts);
    uint32_t *ids = malloc(count * sizeof *ids);
    double kinds = test_random(state, 1, 2.0 * (double)count);
    for (size_t i = 0; i < count; i++) {
        double kind = test_random(state, 0, 1);
        snprintf(storage[i], sizeof storage[i], "%.*s%.0f", (int)test_random(state, 0, 20), "Area of the cortex, 5",
                 kinds * kind * kind);
        ids[i] = (uint32_t)(i ? ids[i - 1] + 1 : 0) + (uint32_t)test_random(state, 0, step);
        texts[3 * i] = storage[i];
        texts[3 * i + 1] = storage[(size_t)test_random(state, 0, (double)i)];
        texts[3 * i + 2] = i % 3 ? "area" : "pathway";
    }
    const struct id_manifest_group groups[] = {{"object", COMPONENTS, 3, ids, count, texts},
                                               {"id", COMPONENTS, 1, ids, count, texts}};
    assert_as_openexr(groups, 2);
    free(ids);
    free(texts);
    free(storage);
}

static void random_names(void **state)
{
    (void)state;
    uint64_t seed = 21;
    for (size_t count = 1; count < 40000; count = 2 * count + 1) {
        check_random(&seed, count, 1);
        check_random(&seed, count, 100);
        check_random(&seed, count, 100000);
    }
    for (int i = 0; i < 200; i++) {
        check_random(&seed, 1 + (size_t)test_random(&seed, 0, 300), 10);
    }
}

/* As many as the largest atlas has. */
static void many_names(void **state)
{
    (void)state;
    uint64_t seed = 5;
    check_random(&seed, 72783, 100);
}

static conus_status format_manifest(void *data)
{
    struct bytes bytes;
    conus_status status = id_manifest_format(&bytes, data, 1);
    if (!status) {
        bytes_finish(&bytes);
    }
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    enum { COUNT = 300 };
    static char storage[COUNT][8];
    const char *texts[COUNT];
    uint32_t ids[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        snprintf(storage[i], sizeof storage[i], "%u", 7919 * i % 1000);
        ids[i] = i;
        texts[i] = storage[i];
    }
    struct id_manifest_group group = {"id", COMPONENTS, 1, ids, COUNT, texts};
    test_every_allocation(format_manifest, &group);
}

TEST_GROUP(id_manifest)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_few_names),
        cmocka_unit_test(long_names),
        cmocka_unit_test(random_names),
        cmocka_unit_test(many_names),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
