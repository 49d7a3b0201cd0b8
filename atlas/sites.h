/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Points where needles may enter, or to which they may point (conus/candidates.h). */
#ifndef CONUS_ATLAS_SITES_H
#define CONUS_ATLAS_SITES_H

#include "base/notes.h"
#include "conus/conus.h"

struct conus_sites {
    double (*points)[3];
    double (*normals)[3]; /**< NULL = there are none. */
    uint64_t *sources;
    size_t count, capacity;
    size_t vertex_count; /**< Of the surface that they are of; 0 = of none. */
    char *path;          /**< Its file. */
    struct notes notes;
};

/** Sites without a point, with capacity for @p capacity of them. */
conus_status sites_create(conus_sites **out, size_t capacity, bool has_normals);

/** Appends one; @p normal is NULL without normals. */
conus_status sites_add(conus_sites *sites, const double point[3], const double *normal, uint64_t source);

/** Keeps those that @p is_kept says. */
void sites_filter(conus_sites *sites, bool (*is_kept)(const conus_sites *sites, size_t index, void *user), void *user);

#endif
