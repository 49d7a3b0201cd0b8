/* SPDX-License-Identifier: BSD-3-Clause */
/* Libraries that are loaded on demand, and missing ones. */
#include "base/library.h"

#include "test.h"

#include <zlib.h>

#define FUNCTIONS(F) F(adler, 32) F(zlib, Version)
struct table {
    __typeof__(adler32) *adler;
    __typeof__(zlibVersion) *version;
};

static void functions_are_found_in_order(void **state)
{
    (void)state;
    struct table table = {0};
    assert_ok(library_load(&table, FUNCTIONS(LIBRARY_NAME), "libz.so.1", "zlib1g"));
    assert_int_equal(table.adler(1, (const unsigned char *)"abc", 3),
                     0x024d0127); /* RFC 1950: 98 + 196 + 295 and 1 + 97 + 98 + 99 */
    assert_string_equal(table.version(), zlibVersion());
    const struct table filled = table;
    assert_ok(library_load(&table, FUNCTIONS(LIBRARY_NAME), "libnone.so", "none")); /* it is not looked for again */
    assert_memory_equal(&table, &filled, sizeof table);
}

static void a_missing_function_leaves_the_table_empty(void **state)
{
    (void)state;
    struct table table = {0};
    const struct table empty = {0};
    assert_fails(library_load(&table, FUNCTIONS(LIBRARY_NAME), "libnone.so.7", "libnone7"), CONUS_ERROR_UNSUPPORTED);
    assert_string_equal(conus_message(), "libnone.so.7 cannot be loaded (Debian: libnone7)");
    assert_fails(library_load(&table, "adler32\0zlibNone\0", "libz.so.1", "zlib1g"), CONUS_ERROR_UNSUPPORTED);
    assert_fails(library_load(&table, "zlibNone\0adler32\0", "libz.so.1", "zlib1g"), CONUS_ERROR_UNSUPPORTED);
    assert_memory_equal(&table, &empty, sizeof table);
    assert_ok(library_load(&table, FUNCTIONS(LIBRARY_NAME), "libz.so.1", "zlib1g"));
}

TEST_GROUP(library)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(functions_are_found_in_order),
        cmocka_unit_test(a_missing_function_leaves_the_table_empty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
