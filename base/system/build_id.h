/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The identity of a build, for the cache. */
#ifndef CONUS_BASE_SYSTEM_BUILD_ID_H
#define CONUS_BASE_SYSTEM_BUILD_ID_H

#include <stdbool.h>

enum { BUILD_ID_SIZE = 65 };

/** The identity that the linker gave to the library, or to the program that it is part of, in hexadecimal: it follows
 * from the machine code. False where the linker gave none. */
bool build_id_find(char out[BUILD_ID_SIZE]);

#endif
