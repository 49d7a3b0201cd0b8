/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What VTK's files have beside surfaces: lines of any number of corners, and numbers of points and cells. A
 * reader that wants them points foreign_mesh.lines to one; the others pass them over. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_LINES_H
#define CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_LINES_H

#include "loaders/surfaces/foreign/foreign_mesh.h"

/** Numbers by name, of all points or of all lines. */
struct foreign_array {
    char *name; /**< UTF-8; owned. */
    bool per_point;
    uint32_t components;
    float *values; /**< [count], rounded once; owned. */
    size_t count, capacity;
};

enum { FOREIGN_ARRAY_LIMIT = 4096, FOREIGN_COMPONENT_LIMIT = 65536 };

/** Zero but for max_memory is an empty one. */
struct foreign_lines {
    struct corners corners; /**< Of all lines, one behind the other; indices of vertices. */
    size_t *ends;           /**< [count] Behind the last corner of each line; owned. */
    size_t count, capacity;
    size_t before; /**< Cells that VTK numbers before lines: single vertices. */
    size_t behind; /**< Those behind: polygons and strips. */
    struct foreign_array *arrays;
    size_t array_count, array_capacity;
    uint64_t max_memory; /**< Bytes that values of arrays may still take. */
};

void foreign_lines_finish(struct foreign_lines *lines);

/** Ends the face of @p mesh as a line; passes it over where nobody wants lines. */
conus_status foreign_end_line(struct foreign_mesh *mesh);

/** The array @p name, which is added where there is none. CONUS_ERROR_DATA for one with other components, for too many
 * of them, and for more than FOREIGN_ARRAY_LIMIT arrays. */
conus_status foreign_lines_array(struct foreign_array **out, struct foreign_lines *lines, struct text name,
                                 bool per_point, uint64_t components);

/** Makes place for @p more values of @p array, one of @p lines. CONUS_ERROR_MEMORY above max_memory. */
conus_status foreign_array_reserve(struct foreign_lines *lines, struct foreign_array *array, size_t more);

#endif
