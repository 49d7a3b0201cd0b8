/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * How much memory libhdf5 may have. */
#ifndef CONUS_HDF5_MEMORY_LIMIT_H
#define CONUS_HDF5_MEMORY_LIMIT_H

#include <stdint.h>

/** Lets libhdf5 have @p bytes of memory more than it has: a damaged file may make it ask for any number. In
 * memory_space.c that is the space of the program, up to the limit that it was started with; in memory_counted.c what
 * libhdf5 takes. */
void memory_allow(uint64_t bytes);

#endif
