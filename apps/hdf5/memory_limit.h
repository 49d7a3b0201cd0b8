/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * How much memory libhdf5 may have, and where one that scripts/libraries has built takes it from. */
#ifndef CONUS_HDF5_MEMORY_LIMIT_H
#define CONUS_HDF5_MEMORY_LIMIT_H

#include <stddef.h>
#include <stdint.h>

/** Lets libhdf5 have @p bytes of memory more than it has: a damaged file may make it ask for any number. In
 * memory_space.c that is the space of the program, up to the limit that it was started with; in memory_counted.c what
 * libhdf5 takes. */
void memory_allow(uint64_t bytes);

/* Of memory_counted.c alone. */

/** realloc(). */
void *counted_resize(void *memory, size_t size);
/** calloc(). */
void *counted_zeros(size_t count, size_t size);
/** strdup(). */
char *counted_text(const char *text);
void counted_free(void *memory);

/* In the place of what libhdf5's H5private.h says: scripts/libraries has its H5MM.c include this. */
#undef HDmalloc
#undef HDcalloc
#undef HDrealloc
#undef HDstrdup
#undef HDfree
#define HDmalloc(size) counted_resize(NULL, size)
#define HDcalloc(count, size) counted_zeros(count, size)
#define HDrealloc(memory, size) counted_resize(memory, size)
#define HDstrdup(text) counted_text(text)
#define HDfree(memory) counted_free(memory)

#endif
