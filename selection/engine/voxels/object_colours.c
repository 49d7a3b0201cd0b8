/* SPDX-License-Identifier: BSD-3-Clause */
/* Colours objects one after the other, those with the most neighbours first. */
#include "selection/engine/voxels/distance_map.h"

#include "base/memory.h"
#include "base/order.h"

#include <stdlib.h>

enum { WORDS = OBJECTS_COLOURED / 64 };

/* A bit for each two objects. */
struct neighbours {
    uint64_t (*of)[WORDS]; /* [OBJECTS_COLOURED] */
};

struct degree {
    uint32_t object, neighbours;
};

/* The voxels of two rows, or of one and itself a voxel on: `count` pairs. */
static void note_rows(const struct neighbours *neighbours, const struct volume *volume, size_t row, size_t other,
                      size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t a = volume_object(volume, row + i);
        uint32_t b = volume_object(volume, other + i);
        if (a != b && a && b && a < OBJECTS_COLOURED && b < OBJECTS_COLOURED) {
            neighbours->of[a][b / 64] |= UINT64_C(1) << b % 64;
            neighbours->of[b][a / 64] |= UINT64_C(1) << a % 64;
        }
    }
}

static void note_volume(const struct neighbours *neighbours, const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    for (size_t k = 0; k < dim[2]; k++) {
        for (size_t j = 0; j < dim[1]; j++) {
            size_t row = dim[0] * (j + dim[1] * k);
            note_rows(neighbours, volume, row, row + 1, dim[0] - 1);
            if (j + 1 < dim[1]) {
                note_rows(neighbours, volume, row, row + dim[0], dim[0]);
            }
            if (k + 1 < dim[2]) {
                note_rows(neighbours, volume, row, row + dim[0] * dim[1], dim[0]);
            }
        }
    }
}

static int most_neighbours_first(const void *a, const void *b)
{
    return compare_unsigned(((const struct degree *)b)->neighbours, ((const struct degree *)a)->neighbours);
}

/* The lowest colour that no neighbour has; those without a colour leave all to it. */
static uint8_t free_colour(const struct object_colours *colours, const uint64_t neighbours[WORDS])
{
    unsigned taken = 0;
    for (uint32_t w = 0; w < WORDS; w++) {
        for (uint64_t left = neighbours[w]; left; left &= left - 1) {
            taken |= 1U << colours->of[64 * w + (uint32_t)__builtin_ctzll(left)];
        }
    }
    unsigned free = ~taken & ((1U << OBJECT_NO_COLOUR) - 1);
    return free ? (uint8_t)__builtin_ctz(free) : OBJECT_NO_COLOUR;
}

conus_status object_colours_find(struct object_colours *out, const struct volume *volume)
{
    struct neighbours neighbours = {memory_zeroed(OBJECTS_COLOURED, sizeof *neighbours.of)};
    struct degree *degrees = memory_raw(OBJECTS_COLOURED, sizeof *degrees);
    conus_status status = neighbours.of && degrees ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        note_volume(&neighbours, volume);
        for (uint32_t object = 0; object < OBJECTS_COLOURED; object++) {
            degrees[object] = (struct degree){.object = object};
            for (size_t w = 0; w < WORDS; w++) {
                degrees[object].neighbours += (uint32_t)__builtin_popcountll(neighbours.of[object][w]);
            }
        }
        order_sort(degrees, OBJECTS_COLOURED, sizeof *degrees, most_neighbours_first);
        for (size_t i = 0; i < OBJECTS_COLOURED; i++) {
            out->of[i] = OBJECT_NO_COLOUR;
        }
        for (size_t i = 0; i < OBJECTS_COLOURED; i++) {
            uint32_t object = degrees[i].object;
            out->of[object] = free_colour(out, neighbours.of[object]);
        }
    }
    memory_free(neighbours.of);
    memory_free(degrees);
    return status;
}
