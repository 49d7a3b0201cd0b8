/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Writes GIFTI documents for tests, right or wrong ones. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_GIFTI_BUILDER_H
#define CONUS_TESTS_SUPPORT_BUILDERS_GIFTI_BUILDER_H

#include "base/memory.h"

/** A DataArray; zero is the default of each. */
struct array_spec {
    const char *intent;   /**< "POINTSET" */
    const char *type;     /**< "FLOAT32"  */
    const char *encoding; /**< "ASCII"    */
    bool big_endian;
    size_t rows, columns; /**< Shape of the values; columns 0: Dimensionality is 1. */
    const char *inside;   /**< Elements before <Data>.                        */
    const char *data;     /**< Replaces the encoded values. */
    const char *more;     /**< Further attributes.                            */
    const double *values; /**< [rows columns] by rows.                        */
};

/** Begins and ends a document of @p arrays arrays. */
void gifti_begin(struct buffer *out, const char *prologue, int arrays);
void gifti_end(struct buffer *out);

void gifti_append(struct buffer *out, const struct array_spec *spec);

/** A closed tetrahedron of 4 vertices and 4 triangles, facing outwards: two arrays in one encoding. */
extern const double tetrahedron_vertices[12];
extern const double tetrahedron_triangles[12];
void gifti_append_tetrahedron(struct buffer *out, const char *encoding);

#endif
