/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * What H5MM.c of a libhdf5 that scripts/libraries builds takes in place of malloc() and its like, so that conus-hdf5
 * knows how much that is, and says when it is enough. */
#ifndef CONUS_HDF5_MEMORY_COUNTED_H
#define CONUS_HDF5_MEMORY_COUNTED_H

#include <stddef.h>

/** realloc(). */
void *counted_resize(void *memory, size_t size);
/** calloc(). */
void *counted_zeros(size_t count, size_t size);
/** strdup(). */
char *counted_text(const char *text);
void counted_free(void *memory);

/* In the place of what H5private.h says. */
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
