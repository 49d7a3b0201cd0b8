/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The evidence: what each pixel's ray hits first. Statistics, scores, reports and pictures use it, whichever engine
 * made it. */
#ifndef CONUS_SELECTION_EVIDENCE_EVIDENCE_H
#define CONUS_SELECTION_EVIDENCE_EVIDENCE_H

#include "atlas/atlas.h"
#include "selection/cone/cone.h"

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

#endif
