/* SPDX-License-Identifier: BSD-3-Clause */
/** @file MATLAB's files of level 5, byte by byte after MathWorks's "MAT-File Format", so that each byte can be
 * changed. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_MATLAB_BUILDER_H
#define CONUS_TESTS_SUPPORT_BUILDERS_MATLAB_BUILDER_H

#include "base/memory.h"
#include "base/text.h"

/** Types of elements, and classes of arrays, by the numbers of that document. */
enum {
    MI_INT8 = 1,
    MI_UINT8,
    MI_INT16,
    MI_UINT16,
    MI_INT32,
    MI_UINT32,
    MI_SINGLE,
    MI_DOUBLE = 9,
    MI_INT64 = 12,
    MI_UINT64,
    MI_MATRIX,
    MI_COMPRESSED,
    MI_UTF8,
    MI_UTF16
};
enum { MX_CELL = 1, MX_STRUCT, MX_OBJECT, MX_CHAR, MX_SPARSE, MX_DOUBLE, MX_SINGLE, MX_UINT8 = 9, MX_COMPLEX = 0x800 };

struct matlab_builder {
    struct buffer bytes; /**< End it with buffer_finish(). */
    bool big;            /**< Byte order. */
    size_t open[64];     /**< Where the elements begin that are still open. */
    size_t depth;
};

/** The header of 128 bytes. */
void matlab_begin(struct matlab_builder *builder, bool big);

/** An element with these bytes; at most four of them become a small one. */
void matlab_element(struct matlab_builder *builder, uint32_t type, const void *data, size_t size);

/** Begins an array: flags, dimensions, name ("" for an element of another array). */
void matlab_open(struct matlab_builder *builder, uint32_t kind, int rows, int columns, const char *name);
/** Ends the array that was begun last. */
void matlab_close(struct matlab_builder *builder);

/** The names of a structure's fields, separated by spaces, each in 32 bytes. */
void matlab_field_names(struct matlab_builder *builder, const char *names);

/** Values of this type, column by column. */
void matlab_values(struct matlab_builder *builder, uint32_t type, const double *values, size_t count);

/** A whole array of doubles. */
void matlab_doubles(struct matlab_builder *builder, const char *name, int rows, int columns, const double *values);

/** A whole row of characters, in units of two bytes. */
void matlab_chars(struct matlab_builder *builder, const char *name, const uint16_t *units, int count);

/** Packs everything behind the first @p from bytes by zlib, as one element. */
void matlab_pack(struct matlab_builder *builder, size_t from);

struct text matlab_built(const struct matlab_builder *builder);

#endif
