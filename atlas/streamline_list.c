/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists of streamlines. */
#include "atlas/streamline_list.h"

#include "base/memory.h"

conus_status streamline_list_create(conus_streamline_list **out, const conus_atlas *atlas)
{
    conus_streamline_list *list = memory_zeroed(1, sizeof *list);
    if (!list) {
        return CONUS_ERROR_MEMORY;
    }
    list->atlas = atlas;
    *out = list;
    return CONUS_OK;
}

conus_status streamline_list_add(conus_streamline_list *list, uint32_t tractogram, uint32_t number)
{
    const uint64_t *first = list->atlas->tractograms[tractogram].first;
    if (!memory_reserve(&list->tractograms, &list->capacities[0], list->count + 1, sizeof *list->tractograms) ||
        !memory_reserve(&list->numbers, &list->capacities[1], list->count + 1, sizeof *list->numbers)) {
        return CONUS_ERROR_MEMORY;
    }
    list->tractograms[list->count] = tractogram;
    list->numbers[list->count++] = number;
    list->points += first[number + 1] - first[number];
    return CONUS_OK;
}

conus_streamline_list_view conus_streamline_list_data(const conus_streamline_list *list)
{
    return list ? (conus_streamline_list_view){list->count, list->tractograms, list->numbers, list->points}
                : (conus_streamline_list_view){0};
}

void conus_streamline_list_points(float *points, uint64_t *first, const conus_streamline_list *list)
{
    uint64_t done = 0;
    for (size_t i = 0; i < list->count; i++) {
        const struct tractogram *tractogram = &list->atlas->tractograms[list->tractograms[i]];
        uint64_t end = tractogram->first[list->numbers[i] + 1];
        if (first) {
            first[i] = done;
        }
        for (uint64_t p = tractogram->first[list->numbers[i]]; p < end; p++, done++) {
            double point[3];
            tractogram_point(point, tractogram, p);
            for (uint64_t a = 0; a < 3; a++) {
                points[3 * done + a] = (float)point[a]; /* which they are: floats or halves */
            }
        }
    }
    if (first) {
        first[list->count] = done;
    }
}

void conus_streamline_list_destroy(conus_streamline_list *list)
{
    if (list) {
        memory_free(list->tractograms);
        memory_free(list->numbers);
        memory_free(list);
    }
}
