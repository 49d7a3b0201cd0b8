/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * From the points where rays pass through surfaces to the intervals between them (Eq. 10). An engine brings crossings
 * in any order, and may bring one more than once; what an interval is, is decided here for all of them. */
#ifndef CONUS_SELECTION_ENGINE_TRIANGLES_MESH_INTERVALS_H
#define CONUS_SELECTION_ENGINE_TRIANGLES_MESH_INTERVALS_H

#include "selection/evidence/layers.h"

/** A point where a pixel's ray passes through a triangle. */
struct crossing {
    uint32_t pixel;
    uint32_t object;
    uint32_t triangle; /**< In the object's mesh.                           */
    int32_t side;      /**< mesh_crossing()'s.                              */
    double t;          /**< mesh_crossing()'s, in mm from the apex; 0 or more. */
};

/** Crossings of an n x n buffer, pixels outside the aperture too, and what pairing them needs. */
struct mesh_intervals {
    const conus_atlas *atlas; /**< Must outlive it.                                               */
    double slack;             /**< mm: crossings of neighbouring triangles within it may be one.  */
    struct crossing *crossings;
    size_t count, capacity;
    struct crossing *sorted; /**< [sorted_capacity] */
    size_t sorted_capacity;
    size_t *end; /**< [pixel_capacity] */
    size_t pixel_capacity;
};

void mesh_intervals_init(struct mesh_intervals *out, const conus_atlas *atlas);
void mesh_intervals_finish(struct mesh_intervals *intervals);

/** Reserves capacity for one more; called by mesh_intervals_add(). */
conus_status mesh_intervals_grow(struct mesh_intervals *intervals);

/** Appends a copy of @p crossing. */
static inline conus_status mesh_intervals_add(struct mesh_intervals *intervals, const struct crossing *crossing)
{
    conus_status status = intervals->count < intervals->capacity ? CONUS_OK : mesh_intervals_grow(intervals);
    if (!status) {
        intervals->crossings[intervals->count++] = *crossing;
    }
    return status;
}

/** Appends the intervals between the crossings of all of the cone's pixels to @p out, and drops the crossings: the
 * first hit of an object is where its first interval begins, to the bit, unless the apex is inside; then that is 0. */
conus_status mesh_intervals_pair(struct layers *out, struct mesh_intervals *intervals, const struct cone *cone);

#endif
