/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists the areas of a matrix, with ends or without. */
#include "base/memory.h"
#include "base/order.h"
#include "selection/connectivity/connectivity.h"
#include "selection/selection.h"

/* Areas as they are listed: by their places in the list of those to show, then by number. */
struct listing {
    const conus_atlas *atlas;
    const uint32_t *group;
    uint64_t *keys; /* [count] place, then the number as it is reported */
    size_t count;
    bool *has_shape; /* [area_count + 1] in or below it */
    bool *is_listed; /* [area_count + 1] */
};

static void add_key(struct listing *listing, uint32_t place, uint32_t number)
{
    listing->keys[listing->count++] = (uint64_t)place << 32 | listing->group[number];
}

/* Lists the areas that have voxels or triangles. */
static void list_shapes(struct listing *listing)
{
    const conus_atlas *atlas = listing->atlas;
    for (uint32_t number = 1; number <= atlas->area_count; number++) {
        const conus_object *area = &atlas->objects[number - 1];
        uint32_t place = 0; /* of the nearest that is named, itself or above it */
        if (atlas->places[number - 1].is_hidden || !(area->voxels || area->triangles)) {
            continue;
        }
        for (uint32_t above = number; above; above = atlas->objects[above - 1].parent) {
            place = place ? place : atlas->places[above - 1].named;
            listing->has_shape[above] = true;
        }
        add_key(listing, place, number);
    }
}

/* Lists the areas that are named, though they have no shape. */
static void list_named(struct listing *listing)
{
    for (uint32_t number = 1; number <= listing->atlas->area_count; number++) {
        const struct object_place *place = &listing->atlas->places[number - 1];
        if (place->named && !place->is_hidden && !listing->has_shape[number]) {
            add_key(listing, place->named, number);
        }
    }
}

conus_status connection_areas_list(struct table_object **out, size_t *count, const conus_selector *selector)
{
    size_t limit = selector->atlas->area_count + 1;
    struct listing listing = {.atlas = selector->atlas,
                              .group = level_group(selector->level),
                              .keys = memory_raw(limit, sizeof *listing.keys),
                              .has_shape = memory_zeroed(limit, sizeof *listing.has_shape),
                              .is_listed = memory_zeroed(limit, sizeof *listing.is_listed)};
    struct table_object *areas = memory_raw(limit, sizeof *areas);
    bool fits = listing.keys && listing.has_shape && listing.is_listed && areas;
    *count = 0;
    if (fits) {
        list_shapes(&listing);
        list_named(&listing);
        order_sort(listing.keys, listing.count, sizeof *listing.keys, compare_u64);
        for (size_t i = 0; i < listing.count; i++) {
            uint32_t area = (uint32_t)listing.keys[i];
            if (!listing.is_listed[area]) {
                listing.is_listed[area] = true;
                areas[(*count)++] = (struct table_object){CONUS_KIND_AREA, area};
            }
        }
        areas[(*count)++] = (struct table_object){CONUS_KIND_UNASSIGNED, 0}; /* ends in none */
        *out = areas;
    } else {
        memory_free(areas);
    }
    memory_free(listing.keys);
    memory_free(listing.has_shape);
    memory_free(listing.is_listed);
    return fits ? CONUS_OK : CONUS_ERROR_MEMORY;
}
