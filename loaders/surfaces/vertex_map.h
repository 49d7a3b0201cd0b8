/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Numbers of the vertices of a surface in GIFTI files (.func.gii, .shape.gii), one array each. */
#ifndef CONUS_LOADERS_SURFACES_VERTEX_MAP_H
#define CONUS_LOADERS_SURFACES_VERTEX_MAP_H

#include "base/job/job.h"

struct vertex_map {
    float *values; /**< [count] NaN where there is none, also where the file has an infinity; owned. */
    size_t count;
    char *name;      /**< The array's name, else the one that was asked for; owned. */
    char hemisphere; /**< 'L', 'R', 'B' where the file says so, else 0. */
};

void vertex_map_finish(struct vertex_map *map);

/** Reads the array called @p name, or number @p name from 0, of those with one number for each vertex. Errors carry the
 * path. CONUS_ERROR_ARGUMENT, with the names that there are, where none or several are called so. All 0 after a
 * failure.
 */
struct vertex_map vertex_map_read(struct job *job, const char *path, const char *name);

#endif
