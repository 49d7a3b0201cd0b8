/* SPDX-License-Identifier: BSD-3-Clause */
/* Sides of areas by table, pair and name; conus_atlas_sides(). */
#include "atlas/areas/area_sides.h"

#include "atlas/areas/pairs.h"
#include "atlas/areas/sides.h"
#include "base/memory.h"

#include <string.h>

/* Of a name like "Left-vessel"; single letters need a counterpart to mean anything. */
static char side_of_name(const char *name)
{
    struct side_word word;
    for (size_t from = 0; side_word_find(&word, text_from(name), from); from = word.start + word.size) {
        if (side_word_is_long(&word)) {
            return word.side;
        }
    }
    return 0;
}

conus_status area_sides_find(char *out, const conus_atlas *atlas)
{
    uint32_t *right_of = NULL;
    conus_status status = hemispheres_pair(&right_of, atlas);
    for (uint32_t number = 1; !status && number <= atlas->area_count; number++) {
        const conus_object *area = &atlas->objects[number - 1];
        out[number] = area->hemisphere ? area->hemisphere : side_of_name(area->name);
    }
    for (uint32_t number = 1; !status && number <= atlas->area_count; number++) {
        if (right_of[number]) {
            out[number] = 'L';
            out[right_of[number]] = 'R';
        }
    }
    memory_free(right_of);
    return status;
}

/* Its own, or else that of the nearest area above it that has one. */
static char side_with_parents(const char *own, const conus_atlas *atlas, uint32_t number)
{
    while (number && !own[number]) {
        number = atlas->objects[number - 1].parent;
    }
    return own[number];
}

conus_status conus_atlas_sides(char *sides, const conus_atlas *atlas)
{
    char *own = memory_zeroed(atlas->area_count + 1, 1);
    conus_status status = own ? area_sides_find(own, atlas) : CONUS_ERROR_MEMORY;
    if (!status) {
        memset(sides, 0, atlas->object_count + 1);
    }
    for (uint32_t number = 1; !status && number <= atlas->area_count; number++) {
        char side = side_with_parents(own, atlas, number);
        sides[number] = (char)(side == 'B' ? 0 : side);
    }
    memory_free(own);
    return status;
}
