/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Libraries that are loaded when they are first needed: linked, they would slow down every start, and be missed where
 * nobody needs them. A list F(png_, error) F(png_, read_info) gives a table of functions, and their names. */
#ifndef CONUS_BASE_LIBRARY_H
#define CONUS_BASE_LIBRARY_H

#include "base/status.h"

/** Member `error` of a table, which has the address of png_error(). */
#define LIBRARY_MEMBER(prefix, name) __typeof__(prefix##name) *(name);
#define LIBRARY_NAME(prefix, name) #prefix #name "\0"

/** Writes the addresses of the functions @p names, as LIBRARY_NAME gives them one after the other, to the pointers from
 * @p table on, once for the process: a table that is full is left as it is. @p file is the name that the linker would
 * look for. CONUS_ERROR_UNSUPPORTED names @p package, the one of Debian. */
conus_status library_load(void *table, const char *names, const char *file, const char *package);

#endif
