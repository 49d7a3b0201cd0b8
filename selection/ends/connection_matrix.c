/* SPDX-License-Identifier: BSD-3-Clause */
/* Lays pairs of areas out as a table. */
#include "base/memory.h"
#include "base/order.h"
#include "base/status.h"
#include "selection/ends/connectivity.h"

#include <math.h>
#include <stdlib.h>

enum { AREA_LIMIT = 8192 };

/* 0, which is none, comes last. */
static int by_number(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a - 1;
    uint32_t y = *(const uint32_t *)b - 1;
    return (x > y) - (x < y);
}

/* The areas of all pairs, each once. */
static conus_status list_areas(conus_connectivity *connectivity)
{
    size_t count = 2 * connectivity->pair_count;
    uint32_t *areas = memory_raw(count, sizeof *areas);
    if (!areas) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        const conus_connection *pair = &connectivity->pairs[i / 2];
        areas[i] = i % 2 ? pair->area_b : pair->area_a;
    }
    order_sort(areas, count, sizeof *areas, by_number);
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        if (!kept || areas[kept - 1] != areas[i]) {
            areas[kept++] = areas[i];
        }
    }
    connectivity->areas = areas;
    connectivity->area_count = kept;
    return kept <= AREA_LIMIT
               ? CONUS_OK
               : fail(CONUS_ERROR_UNSUPPORTED,
                      "connectivity: a table of %zu areas, allowed are up to %d; a level has fewer", kept, AREA_LIMIT);
}

static size_t place_of(const conus_connectivity *connectivity, uint32_t area)
{
    const uint32_t *found =
        bsearch(&area, connectivity->areas, connectivity->area_count, sizeof *connectivity->areas, by_number);
    return (size_t)(found - connectivity->areas);
}

static conus_status fill(conus_connectivity *connectivity)
{
    size_t count = connectivity->area_count;
    connectivity->streamlines = memory_zeroed(count * count, sizeof *connectivity->streamlines);
    connectivity->length = memory_raw(count * count, sizeof *connectivity->length);
    if (!connectivity->streamlines || !connectivity->length) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count * count; i++) {
        connectivity->length[i] = NAN;
    }
    for (size_t i = 0; i < connectivity->pair_count; i++) {
        const conus_connection *pair = &connectivity->pairs[i];
        size_t a = place_of(connectivity, pair->area_a);
        size_t b = place_of(connectivity, pair->area_b);
        connectivity->streamlines[a * count + b] = connectivity->streamlines[b * count + a] = pair->streamlines;
        connectivity->length[a * count + b] = connectivity->length[b * count + a] = pair->length;
    }
    return CONUS_OK;
}

conus_status conus_connectivity_matrix(conus_connection_matrix *out, conus_connectivity *connectivity)
{
    conus_status status = connectivity->areas ? CONUS_OK : list_areas(connectivity);
    status = status || connectivity->streamlines ? status : fill(connectivity);
    if (status) {
        memory_free(connectivity->areas);
        memory_free(connectivity->streamlines);
        memory_free(connectivity->length);
        connectivity->areas = NULL;
        connectivity->streamlines = NULL;
        connectivity->length = NULL;
        return status;
    }
    *out = (conus_connection_matrix){.count = connectivity->area_count,
                                     .areas = connectivity->areas,
                                     .streamlines = connectivity->streamlines,
                                     .length = connectivity->length};
    return CONUS_OK;
}
