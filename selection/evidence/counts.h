/* SPDX-License-Identifier: BSD-3-Clause */
/** @file First hits added up per object, where an engine counts them itself: evidence of a cone without its pixels. */
#ifndef CONUS_SELECTION_EVIDENCE_COUNTS_H
#define CONUS_SELECTION_EVIDENCE_COUNTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** What some pixels in the cone hit first of one object. */
struct hit_count {
    uint32_t object; /**< As it is reported; 0 = nothing.                               */
    uint32_t pixels;
    double weight;     /**< Sum of theirs (Eq. 4).                                         */
    double nearest;    /**< mm along their rays; INFINITY of nothing.                      */
    uint32_t pixel;    /**< The contact's: the smallest r, of equal ones the nearest, the first (Eq. 11). */
    uint32_t own;      /**< Which object that one hit, whatever it is reported as,         */
    uint64_t voxel;    /**< in which voxel,                                                */
    double contact;    /**< and how far along its ray, mm.                                 */
    bool is_at_border; /**< One of the pixels has a neighbour that is not in the cone.  */
};

/** Of one cone. An object may have several, of other pixels. End it with memory_free(rows). */
struct hit_counts {
    struct hit_count *rows;
    size_t count, capacity;
};

#endif
