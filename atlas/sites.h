/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Points where needles may enter, or to which they may point (conus/plan.h). */
#ifndef CONUS_ATLAS_SITES_H
#define CONUS_ATLAS_SITES_H

#include "base/notes.h"
#include "conus/image.h"
#include "conus/plan.h"

struct conus_sites {
    double (*points)[3];
    double (*normals)[3]; /**< NULL = there are none. */
    uint64_t *sources;
    size_t count, capacity;
    size_t vertex_count;  /**< Vertices of their surface; 0 = there is none. */
    conus_grid_view grid; /**< Grid of the one volume whose voxels they are, without data; else its count is 0. */
    char *path;           /**< Its file. */
    struct notes notes;
};

/** Sites without a point, with capacity for @p capacity of them. */
conus_status sites_create(conus_sites **out, size_t capacity, bool has_normals);

/** Appends one; @p normal is NULL without normals. */
conus_status sites_add(conus_sites *sites, const double point[3], const double *normal, uint64_t source);

/** Sites by the cube in which they are: those in a bucket are linked. */
struct site_cubes {
    double edge;   /**< mm */
    size_t *first; /**< [mask + 1] Number of a site from 1, 0 = none. */
    size_t *next;  /**< [count] Likewise, of each. */
    size_t mask;
    size_t count; /**< So many are in it, the first ones. */
};

/** For up to @p capacity sites. */
conus_status site_cubes_init(struct site_cubes *out, double edge, size_t capacity);
void site_cubes_finish(struct site_cubes *cubes);

/** Adds the next site, which is at @p point. */
void site_cubes_add(struct site_cubes *cubes, const double point[3]);

/** Index of the nearest site that is nearer than the edge, the first of equally near ones; SIZE_MAX = there is none. */
size_t site_cubes_nearest(const struct site_cubes *cubes, const conus_sites *sites, const double point[3]);

/** Keeps the sites for which @p is_kept is true. */
void sites_filter(conus_sites *sites, bool (*is_kept)(const conus_sites *sites, size_t index, void *user), void *user);

#endif
