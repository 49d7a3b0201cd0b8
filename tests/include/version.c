/* SPDX-License-Identifier: BSD-3-Clause */
/* The headers, the library and CMake name one version. */
#include <conus/conus.h>

#include <stdio.h>
#include <string.h>

#if CONUS_VERSION_NUMBER != CONUS_VERSION_MAJOR * 1000000 + CONUS_VERSION_MINOR * 1000 + CONUS_VERSION_PATCH
#error "CONUS_VERSION_NUMBER is not made of its parts"
#endif
#if CONUS_MAKE_VERSION(0, 9, 9) >= CONUS_MAKE_VERSION(0, 10, 0) ||                                                     \
    CONUS_MAKE_VERSION(0, 10, 0) >= CONUS_MAKE_VERSION(1, 0, 0)
#error "CONUS_MAKE_VERSION() does not grow with the version"
#endif

int main(void)
{
    if (strcmp(CONUS_VERSION, PROJECT_VERSION) != 0 || strcmp(CONUS_VERSION, conus_version()) != 0) {
        printf("headers: %s, library: %s, CMake: %s\n", CONUS_VERSION, conus_version(), PROJECT_VERSION);
        return 1;
    }
    return 0;
}
