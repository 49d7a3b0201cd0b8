/* SPDX-License-Identifier: BSD-3-Clause */
/* Lays pairs of areas out as a table. */
#include "base/memory.h"
#include "base/order.h"
#include "base/status.h"
#include "selection/ends/connectivity.h"
#include "selection/selector.h"

#include <math.h>

enum { AREA_LIMIT = 8192 };

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

conus_status connection_areas_list(conus_connectivity *connectivity, const conus_selector *selector)
{
    size_t count = selector->atlas->area_count + 1;
    struct listing listing = {.atlas = selector->atlas,
                              .group = level_group(selector->level),
                              .keys = memory_raw(count, sizeof *listing.keys),
                              .has_shape = memory_zeroed(count, sizeof *listing.has_shape),
                              .is_listed = memory_zeroed(count, sizeof *listing.is_listed)};
    uint32_t *areas = memory_raw(count, sizeof *areas);
    bool fits = listing.keys && listing.has_shape && listing.is_listed && areas;
    if (fits) {
        list_shapes(&listing);
        list_named(&listing);
        order_sort(listing.keys, listing.count, sizeof *listing.keys, compare_u64);
        for (size_t i = 0; i < listing.count; i++) {
            uint32_t area = (uint32_t)listing.keys[i];
            if (!listing.is_listed[area]) {
                listing.is_listed[area] = true;
                areas[connectivity->area_count++] = area;
            }
        }
        areas[connectivity->area_count++] = 0; /* ends in none */
        connectivity->areas = areas;
    } else {
        memory_free(areas);
    }
    memory_free(listing.keys);
    memory_free(listing.has_shape);
    memory_free(listing.is_listed);
    return fits ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status fill(conus_connectivity *connectivity)
{
    size_t count = connectivity->area_count;
    uint32_t most = 0;
    for (size_t i = 0; i < count; i++) {
        most = connectivity->areas[i] > most ? connectivity->areas[i] : most;
    }
    size_t *row = memory_raw(most + 1, sizeof *row); /* of an area */
    uint64_t *streamlines = memory_zeroed(count * count, sizeof *streamlines);
    double *length = memory_raw(count * count, sizeof *length);
    if (!row || !streamlines || !length) {
        memory_free(row);
        memory_free(streamlines);
        memory_free(length);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        row[connectivity->areas[i]] = i;
    }
    for (size_t i = 0; i < count * count; i++) {
        length[i] = NAN;
    }
    for (size_t i = 0; i < connectivity->pair_count; i++) {
        const conus_connection *pair = &connectivity->pairs[i];
        size_t a = row[pair->area_a];
        size_t b = row[pair->area_b];
        streamlines[a * count + b] = streamlines[b * count + a] = pair->streamlines;
        length[a * count + b] = length[b * count + a] = pair->length;
    }
    memory_free(row);
    connectivity->streamlines = streamlines;
    connectivity->length = length;
    return CONUS_OK;
}

conus_status conus_connectivity_matrix(conus_connection_matrix *out, conus_connectivity *connectivity)
{
    size_t count = connectivity->area_count - 1;
    if (count > AREA_LIMIT) {
        return fail(
            CONUS_ERROR_UNSUPPORTED,
            "connectivity: a table of %zu areas, allowed are up to %d; a level has fewer, and so have areas that "
            "are named",
            count, AREA_LIMIT);
    }
    conus_status status = connectivity->streamlines ? CONUS_OK : fill(connectivity);
    if (status) {
        return status;
    }
    *out = (conus_connection_matrix){.count = connectivity->area_count,
                                     .areas = connectivity->areas,
                                     .streamlines = connectivity->streamlines,
                                     .length = connectivity->length};
    return CONUS_OK;
}
