/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What engines find: the first hits of rays, all layers, and counts. */
#ifndef CONUS_SELECTION_EVIDENCE_EVIDENCE_H
#define CONUS_SELECTION_EVIDENCE_EVIDENCE_H

#include "atlas/atlas.h"
#include "selection/cone/cone.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The evidence: what each pixel's ray hits first. Statistics, scores, reports and pictures use it, whichever engine
 * made it. */

#define EVIDENCE_NO_VOXEL UINT64_MAX

/** n*n pixels, row-major, row 0 at the device's bottom (v = -1). Pixels outside the aperture are filled too. All are in
 * the memory that `distance` begins. */
struct evidence {
    uint32_t resolution;
    uint32_t *object; /**< Object hit first; 0 = none.                                                          */
    double *distance; /**< mm from the apex along the ray to the entry into that object; INFINITY = none.       */
    uint64_t *voxel;  /**< The part of the object that was hit: linear index of the voxel in its volume, the triangle of
                         its mesh, or the first point of the segment of its streamline; EVIDENCE_NO_VOXEL = none. */
};

conus_status evidence_init(struct evidence *out, uint32_t resolution);
void evidence_finish(struct evidence *evidence);

/** Sets every pixel to "nothing". */
void evidence_clear(struct evidence *evidence);

/** Sets one pixel to "nothing". */
void evidence_clear_pixel(struct evidence *evidence, size_t pixel);

/** Sets pixels that hold VOLUME_BLOCKER to "nothing". */
void evidence_drop_blocked(struct evidence *evidence);

/** World position of the contact of pixel column @p i, row @p j: the ray's origin + distance x ray; NAN where nothing
 * is hit. */
void evidence_position(double out[3], const struct evidence *evidence, const struct cone *cone, uint32_t i, uint32_t j);

/* All layers of the evidence (Eq. 10): every interval of every pixel's ray inside an object. Engines append
 * intervals in any order; later steps get them sorted. Only memory limits their number. */

/** Intervals of an n x n buffer, pixels outside the aperture too. A zeroed one is empty. */
struct layers {
    conus_interval *intervals;
    size_t count, capacity;
};

void layers_finish(struct layers *layers);

/** Empties it and keeps its memory. */
static inline void layers_clear(struct layers *layers)
{
    layers->count = 0;
}

/** Makes capacity for @p more intervals. */
conus_status layers_reserve(struct layers *layers, size_t more);

/** Appends a copy of @p interval. */
conus_status layers_add(struct layers *layers, const conus_interval *interval);

/** Sorts by pixel (of @p pixels), then entry, then object, then exit. Quick where a pixel's intervals were appended in
 * about that order. */
conus_status layers_sort(struct layers *layers, size_t pixels);

/** Drops what lies outside the cone's range; intervals that reach into it are cut there. Needs sorted layers and leaves
 * them so. */
void layers_clip(struct layers *layers, const struct cone *cone);

/** Finds what each pixel hit first, from sorted layers: the visible part of the evidence. True if it is certain: in no
 * pixel do several intervals begin where the first does. */
bool layers_first(struct evidence *out, const struct layers *layers);

/** Replaces each interval's object by the one as which @p group [@p object_count + 1] reports it. Intervals of a pixel
 * that then have one object and touch or overlap become one. Needs sorted layers without blockers and leaves them
 * sorted. */
conus_status layers_regroup(struct layers *layers, const uint32_t *group, size_t object_count);

/** Drops the intervals of voxels that block but are no object (VOLUME_BLOCKER). */
void layers_drop_blockers(struct layers *layers);

#endif
