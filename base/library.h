/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Libraries that are loaded when they are first needed: linked, they would slow down every start, and be missed where
 * nobody needs them. A list F(png_, error) F(png_, read_info) gives a table of functions, and their names. In one
 * program without a library beside it (CONUS_LIBRARIES_LINKED) they are linked, and a table has their addresses from
 * the start. */
#ifndef CONUS_BASE_LIBRARY_H
#define CONUS_BASE_LIBRARY_H

#include "base/status.h"

/** Member `error` of a table, which has the address of png_error(). */
#define LIBRARY_MEMBER(prefix, name) __typeof__(prefix##name) *(name);
#define LIBRARY_NAME(prefix, name) #prefix #name "\0"
#ifdef CONUS_LIBRARIES_LINKED
#define LIBRARY_ADDRESS(prefix, name) prefix##name,
#else
#define LIBRARY_ADDRESS(prefix, name) NULL,
#endif

/** Defines a file's own table of this name. */
#define LIBRARY_TABLE(name, FUNCTIONS)                                                                                 \
    static struct {                                                                                                    \
        FUNCTIONS(LIBRARY_MEMBER)                                                                                      \
    }(name) = {FUNCTIONS(LIBRARY_ADDRESS)}

/** Writes the addresses of the functions @p names, as LIBRARY_NAME gives them one after the other, to the pointers from
 * @p table on, once for the process: a table that is full is left as it is. @p file is the name that the linker would
 * look for. CONUS_ERROR_UNSUPPORTED names @p package, the one of Debian. */
conus_status library_load(void *table, const char *names, const char *file, const char *package);

#endif
