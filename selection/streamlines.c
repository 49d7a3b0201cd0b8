/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists of streamlines: those that come into a selection's region. */
#include "atlas/atlas.h"
#include "base/memory.h"
#include "conus/own.h"
#include "selection/measure/measure.h"
#include "selection/selection.h"

struct conus_streamline_list {
    const conus_atlas *atlas;
    uint32_t *tractograms, *numbers; /**< [count], ascending. */
    size_t count, capacities[2];
    uint64_t points;
};

enum { SHOWN = 1, INSIDE = 2, LISTED = SHOWN | INSIDE };

static void mark_inside(void *user, const struct tract_run *run, const struct tract_part *part)
{
    uint8_t *marks = user;
    (void)part;
    marks[run->streamline] |= INSIDE;
}

static conus_status list_tractogram(conus_streamline_list *list, uint32_t which, const struct region *region,
                                    uint32_t object)
{
    const conus_atlas *atlas = list->atlas;
    const struct tractogram *tractogram = &atlas->tractograms[which];
    uint8_t *marks = memory_zeroed(tractogram->streamline_count, sizeof *marks);
    conus_status status = marks ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (uint32_t number = (uint32_t)atlas->area_count + 1; number <= atlas->object_count && !status; number++) {
        bool wanted = object ? number == object : !atlas->places[number - 1].is_hidden;
        if (wanted && atlas_bundle_tractogram(atlas, number) == tractogram) {
            const struct tract_group *group = atlas_bundle_group(atlas, number);
            size_t count = tract_group_count(group, tractogram);
            for (size_t i = 0; i < count; i++) {
                marks[tract_group_member(group, i)] |= SHOWN;
            }
        }
    }
    if (!status) {
        tract_census_walk(tractogram, region, mark_inside, marks);
    }
    for (uint32_t k = 0; k < tractogram->streamline_count && !status; k++) {
        if (marks[k] != LISTED) {
            continue;
        }
        if (!memory_reserve(&list->tractograms, &list->capacities[0], list->count + 1, sizeof *list->tractograms) ||
            !memory_reserve(&list->numbers, &list->capacities[1], list->count + 1, sizeof *list->numbers)) {
            status = CONUS_ERROR_MEMORY;
            break;
        }
        list->tractograms[list->count] = which;
        list->numbers[list->count++] = k;
        list->points += tractogram->first[k + 1] - tractogram->first[k];
    }
    memory_free(marks);
    return status;
}

conus_status conus_selection_streamlines(conus_streamline_list **out, const conus_selection *selection, uint32_t object)
{
    const conus_atlas *atlas = selection->atlas;
    const conus_object *bundle = conus_atlas_object(atlas, object);
    if (object && !bundle) {
        return fail(CONUS_ERROR_ARGUMENT, "object: %u, allowed is up to %zu", object, atlas->object_count);
    }
    if (bundle && bundle->kind != CONUS_KIND_BUNDLE) {
        return fail(CONUS_ERROR_ARGUMENT, "streamlines: %s is %s, a bundle is needed", bundle->name,
                    bundle->kind == CONUS_KIND_AREA ? "an area" : "a pathway");
    }
    if (bundle && conus_atlas_is_hidden(atlas, object)) {
        return fail(CONUS_ERROR_ARGUMENT, "streamlines: %s is hidden", bundle->name);
    }
    if (!bundle && !atlas_has_bundles(atlas)) {
        return fail(CONUS_ERROR_ARGUMENT, "streamlines: there is no bundle");
    }
    conus_streamline_list *list = memory_zeroed(1, sizeof *list);
    if (!list) {
        return CONUS_ERROR_MEMORY;
    }
    list->atlas = atlas;
    conus_status status = CONUS_OK;
    for (uint32_t which = 0; which < atlas->tractogram_count && !status; which++) {
        status = list_tractogram(list, which, &selection->region, object);
    }
    if (status) {
        conus_streamline_list_destroy(list);
        return status;
    }
    *out = list;
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
