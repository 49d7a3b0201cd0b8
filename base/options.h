/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Reads a struct of options filled by a caller who may have been compiled with a smaller one. */
#ifndef CONUS_BASE_OPTIONS_H
#define CONUS_BASE_OPTIONS_H

#include <stddef.h>
#include <string.h>

/** Fills @p out, a struct of @p size bytes that begins with struct_size, with zeros, which are the defaults, and with
 * what @p given has, NULL = nothing. A struct_size of 0 there means that of this version. Returns @p out. */
static inline void *options_fill(void *out, size_t size, const void *given)
{
    size_t known = 0;
    memset(out, 0, size);
    if (given) {
        memcpy(&known, given, sizeof known);
        memcpy(out, given, known && known < size ? known : size);
    }
    memcpy(out, &size, sizeof size);
    return out;
}

/** The options that @p given means, as of this version: `options = options_of(conus_load_options, options);`. They live
 * as long as the block in which this stands. */
#define options_of(type, given) ((const type *)options_fill(&(type){0}, sizeof(type), (given)))

#endif
