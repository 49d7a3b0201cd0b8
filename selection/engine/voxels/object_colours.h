/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Colours of a volume's objects, as of countries on a map: two objects have different colours if a voxel of one shares
 * a face with a voxel of the other. So a ray that goes from voxel to voxel sees by colours alone where it enters
 * another object. */
#ifndef CONUS_SELECTION_ENGINE_VOXELS_OBJECT_COLOURS_H
#define CONUS_SELECTION_ENGINE_VOXELS_OBJECT_COLOURS_H

#include "atlas/volume.h"

/** Colours are below OBJECT_NO_COLOUR. That is what objects have for which none was left, and those from number
 * OBJECTS_COLOURED on. */
enum { OBJECT_NO_COLOUR = 7, OBJECTS_COLOURED = 4096 };

struct object_colours {
    uint8_t of[OBJECTS_COLOURED]; /**< [0] says nothing. */
};

static inline uint8_t object_colour(const struct object_colours *colours, uint32_t object)
{
    return object < OBJECTS_COLOURED ? colours->of[object] : OBJECT_NO_COLOUR;
}

/** @p volume must have objects. Fails for want of memory only: it takes 2 MB for a while. */
conus_status object_colours_find(struct object_colours *out, const struct volume *volume);

#endif
