/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Maps over a volume that let a ray skip: colours of its objects, distances to the nearest one, and both in
 * one. */
#ifndef CONUS_SELECTION_ENGINE_VOXELS_DISTANCE_MAP_H
#define CONUS_SELECTION_ENGINE_VOXELS_DISTANCE_MAP_H

#include "atlas/volume.h"

/* Colours of a volume's objects, as of countries on a map: two objects have different colours if a voxel of one
 * shares a face with a voxel of the other. So a ray that goes from voxel to voxel sees by colours alone where it
 * enters another object. */

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

/* The Chebyshev distance from each empty voxel of a volume to the nearest occupied one, for empty-space skipping.
 *
 * One byte per voxel, its code (of a sparse volume only round the box of its objects): 0 where the voxel holds an
 * object; else 1 + r, where all voxels of the grid that differ from it by at most r in every index hold none. There is
 * a margin of empty voxels around the grid, with codes of their own. Bytes lie in lines of 4 x 4 x 4, the size of the
 * processor's, so that neighbours share them whatever the direction of a ray.
 *
 * In a labelled map (labelled_map.c) the voxels that hold an object have several codes, which say what object it is. */

enum { DISTANCE_MARGIN = 1, DISTANCE_EDGE = 4, DISTANCE_LINE = 64 };

struct distance_map {
    size_t dim[3];   /**< Voxels of the volume along i, j, k.            */
    size_t base[3];  /**< The first voxel with codes, after the margin. All is empty before it. */
    size_t lines[3]; /**< Lines along i, j, k; the last may be padded.   */
    double first[3]; /**< The box of the voxels with objects: lowest     */
    double last[3];  /**< and highest index; below the lowest if none.   */
    uint8_t *codes;  /**< [distance_map_codes()], in                          */
    void *block;     /**< this memory; NULL if they are not the map's own. */
    uint32_t shift;  /**< Codes of empty voxels are higher by so many; the others are up to it. */
    uint32_t least;  /**< The object whose voxels have code 0; 0: the map is not labelled.      */
};

/** @p volume must have objects. Uses its distance map, if it has one, for as long as the volume has it. */
conus_status distance_map_init(struct distance_map *out, const struct volume *volume);
void distance_map_finish(struct distance_map *map);

/** In a code of a uniform map: no object here; else the colour of the object (object_colours.c). The other bits are
 * 1 + r, seven of them without an object, four in one. */
enum {
    UNIFORM_EMPTY = 0x80,
    UNIFORM_COLOUR = 0x70,
    UNIFORM_EMPTY_RADIUS = 0x7f,
    UNIFORM_RADIUS = 0x0f,
    UNIFORM_NO_COLOUR = OBJECT_NO_COLOUR * 0x10
};

/** The largest grid, in codes, of which a uniform map is made. */
#define UNIFORM_CODES ((size_t)1 << 28)

/** Makes a uniform map: the code of every voxel, occupied ones too, is 1 + r where all voxels that differ from it by at
 * most r in every index hold the same object as it does, or none as it does; the margin holds none. So a ray leaves r
 * cells at once inside an object, too. Its box is that of @p map, the volume's distance map. Takes one byte a voxel,
 * and 2 MB more while it is made. */
conus_status distance_map_init_uniform(struct distance_map *out, const struct volume *volume,
                                       const struct distance_map *map);

/** The bytes that distance_map_write() writes. */
size_t distance_map_size(const struct volume *volume);
/** Makes the distance map of a volume (volume->distances) at @p memory, which is aligned as malloc's is, better as a
 * line. */
conus_status distance_map_write(void *memory, const struct volume *volume);

/** Whether a written map that comes from elsewhere fits the volume, and no ray that it leads leaves the volume: codes
 * of voxels with objects are nowhere but in its box. What the others say is not checked. */
bool distance_map_is_sound(const void *memory, const struct volume *volume);

/** How many codes there are. */
static inline size_t distance_map_codes(const struct distance_map *map)
{
    return map->lines[0] * map->lines[1] * map->lines[2] * DISTANCE_LINE;
}

/** The first of the processor's lines in a block of memory. */
static inline uint8_t *distance_map_on_lines(void *block)
{
    return (uint8_t *)(((uintptr_t)block + DISTANCE_LINE - 1) / DISTANCE_LINE * DISTANCE_LINE);
}

/** Position of voxel (i, j, k) among the codes; those of the margin in front are (size_t)-DISTANCE_MARGIN. */
static inline size_t distance_map_at(const struct distance_map *map, size_t i, size_t j, size_t k)
{
    size_t x = i - map->base[0] + DISTANCE_MARGIN;
    size_t y = j - map->base[1] + DISTANCE_MARGIN;
    size_t z = k - map->base[2] + DISTANCE_MARGIN;
    size_t line = x / DISTANCE_EDGE + map->lines[0] * (y / DISTANCE_EDGE + map->lines[1] * (z / DISTANCE_EDGE));
    return line * DISTANCE_LINE + x % DISTANCE_EDGE +
           DISTANCE_EDGE * (y % DISTANCE_EDGE + DISTANCE_EDGE * (z % DISTANCE_EDGE));
}

/* A distance map whose codes also say which object a voxel holds. So a ray that hits something need not read the
 * volume, which is far away in memory. The objects of AAL have codes 0 to 115, and a code of 116 + r is an empty
 * voxel with r empty ones around it. */

/** At most so many codes are objects; the others are distances, and larger distances are cut. */
enum { LABELLED_OBJECTS = 192 };

/** The largest grid, in codes, of which a labelled map is made: each process of a batch has one for itself. */
#define LABELLED_CODES ((size_t)1 << 26)

/** Makes the labelled map of a volume whose distance map @p map is. False without memory, and where the volume has no
 * objects, has more than LABELLED_CODES codes, or its objects' numbers are LABELLED_OBJECTS apart or more; then @p out
 * is as before. It takes a byte a voxel,
 * unless there is one object: then it has the codes of @p map, which must outlive it. */
bool labelled_map_init(struct distance_map *out, const struct volume *volume, const struct distance_map *map);

#endif
