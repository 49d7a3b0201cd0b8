/* SPDX-License-Identifier: BSD-3-Clause */
/* The headers, the library and CMake name one version. */
#include "test.h"

#include <conus/conus.h>

#if CONUS_VERSION_NUMBER != CONUS_VERSION_MAJOR * 1000000 + CONUS_VERSION_MINOR * 1000 + CONUS_VERSION_PATCH
#error "CONUS_VERSION_NUMBER is not made of its parts"
#endif
#if CONUS_MAKE_VERSION(0, 9, 9) >= CONUS_MAKE_VERSION(0, 10, 0) ||                                                     \
    CONUS_MAKE_VERSION(0, 10, 0) >= CONUS_MAKE_VERSION(1, 0, 0)
#error "CONUS_MAKE_VERSION() does not grow with the version"
#endif

static void versions_agree(void **state)
{
    (void)state;
    assert_string_equal(CONUS_VERSION, PROJECT_VERSION);
    assert_string_equal(CONUS_VERSION, conus_version());
}

TEST_GROUP(version)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(versions_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
