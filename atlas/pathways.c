/* SPDX-License-Identifier: BSD-3-Clause */
/* Objects from the values of a volume (Eq. 6): pathways, by a threshold or by bands, and a context that blocks. Also
 * other areas before them. */
#include "atlas/atlas.h"
#include "atlas/labels/labels.h"
#include "atlas/space.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/tolerance.h"

#include <math.h>

/* What was written as an end reaches it, and is no longer below it. */
static struct volume_step step_of(double low, double high, uint32_t number)
{
    return (struct volume_step){
        .low = (float)tolerance_least(low), .high = (float)tolerance_least(high), .number = number};
}

static void set_voxels(conus_object *object, uint64_t voxels, const conus_volume_info *info)
{
    object->voxels = voxels;
    object->volume_mm3 = (double)voxels * space_voxel_mm3(info);
}

static int compare_steps(const void *a, const void *b)
{
    const struct volume_step *first = a;
    const struct volume_step *second = b;
    return (first->low > second->low) - (first->low < second->low);
}

/* Adds `objects`, made from the steps, whose numbers follow each other: an area, or pathways with kind, name, low, high
 * and is_band. */
static conus_status add_objects(conus_atlas *atlas, const conus_volume_info *info, struct value_map *map,
                                const conus_object *objects, const struct volume_step *steps, size_t count)
{
    struct volume volume = {0};
    size_t before = atlas->object_count;
    uint64_t *counts = memory_zeroed(count, sizeof *counts);
    conus_status status = counts ? volume_init(&volume, info) : CONUS_ERROR_MEMORY;
    volume.steps = status ? NULL : memory_copy(steps, count, sizeof *steps);
    status = status || volume.steps ? status : CONUS_ERROR_MEMORY;
    if (!status) {
        volume.map = *map;
        volume.step_count = count;
        order_sort(volume.steps, count, sizeof *steps, compare_steps);
        volume_count_steps(counts, &volume);
    }
    for (size_t i = 0; i < count && !status; i++) {
        conus_object object = objects[i];
        if (object.kind == CONUS_KIND_PATHWAY) {
            uint32_t ordinal = 1;
            for (size_t k = atlas->area_count; k < atlas->object_count; k++) {
                ordinal += atlas->objects[k].kind == CONUS_KIND_PATHWAY;
            }
            object.label = ordinal;
            object.abbreviation = "";
            object.named = true;
            palette_colour(object.rgb, 1000 + ordinal);
        }
        object.volume = atlas->volume_count;
        size_t step = 0;
        while (volume.steps[step].number != (uint32_t)(before + i) + 1) {
            step++;
        }
        set_voxels(&object, counts[step], info);
        status = atlas_append_object(atlas, &object, (struct object_place){.index = atlas->volume_count});
    }
    status = status ? status : atlas_append_volume(atlas, &volume);
    if (status) {
        atlas_cut_objects(atlas, before);
        volume.map = (struct value_map){0}; /* stays the caller's */
    } else {
        *map = (struct value_map){0};
    }
    volume_finish(&volume);
    memory_free(counts);
    return status;
}

conus_status atlas_add_pathway(conus_atlas *atlas, const conus_volume_info *info, struct value_map *map,
                               const char *name)
{
    struct volume_step step = step_of(info->threshold, INFINITY, (uint32_t)atlas->object_count + 1);
    const conus_object pathway = {.kind = CONUS_KIND_PATHWAY, .name = name, .low = info->threshold, .high = INFINITY};
    return add_objects(atlas, info, map, &pathway, &step, 1);
}

conus_status atlas_add_probabilistic_area(conus_atlas *atlas, const conus_volume_info *info, struct value_map *map,
                                          const conus_object *area)
{
    struct volume_step step = step_of(info->threshold, INFINITY, (uint32_t)atlas->object_count + 1);
    conus_object object = *area;
    object.low = info->threshold;
    object.high = INFINITY;
    conus_status status = atlas_check_order(atlas, area);
    status = status ? status : add_objects(atlas, info, map, &object, &step, 1);
    atlas->area_count = status ? atlas->area_count : atlas->object_count;
    return status;
}

conus_status atlas_add_bands(conus_atlas *atlas, const conus_volume_info *info, struct value_map *map,
                             const conus_band *bands, size_t count)
{
    struct volume_step *steps = memory_zeroed(count, sizeof *steps);
    conus_object *objects = memory_zeroed(count, sizeof *objects);
    conus_status status = steps && objects ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        uint32_t number = (uint32_t)(atlas->object_count + i) + 1;
        objects[i] = (conus_object){.kind = CONUS_KIND_PATHWAY,
                                    .name = bands[i].name,
                                    .low = bands[i].low,
                                    .high = bands[i].high,
                                    .is_band = true};
        steps[i] = step_of(bands[i].low, bands[i].high, number);
    }
    status = status ? status : add_objects(atlas, info, map, objects, steps, count);
    memory_free(steps);
    memory_free(objects);
    return status;
}

conus_status conus_atlas_set_threshold(conus_atlas *atlas, size_t number, double threshold)
{
    const conus_object *object = conus_atlas_object(atlas, number);
    if (!object || !atlas_object_is_scalar(atlas, (uint32_t)number)) {
        return fail(CONUS_ERROR_ARGUMENT, "object %zu is no pathway, and no area of probabilities", number);
    }
    if (object->is_band) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: a band of values has no threshold", object->name);
    }
    if (!isfinite(threshold)) {
        return fail(CONUS_ERROR_ARGUMENT, "threshold: %g, a number is needed", threshold);
    }
    struct volume *volume = &atlas->volumes[atlas->places[number - 1].index];
    conus_status status = volume_own(volume);
    if (!status) {
        uint64_t voxels;
        volume->steps[0] = step_of(threshold, INFINITY, (uint32_t)number);
        volume_count_steps(&voxels, volume);
        volume->info.threshold = threshold;
        atlas->objects[number - 1].low = threshold;
        set_voxels(&atlas->objects[number - 1], voxels, &volume->info);
    }
    return status;
}

conus_status atlas_exchange_areas(conus_atlas *atlas, conus_atlas *areas)
{
    conus_status status = CONUS_OK;
    areas->area_count = areas->object_count;
    uint32_t shift = (uint32_t)(areas->area_count - atlas->area_count); /* modulo 2^32 where there are fewer */
    for (size_t i = atlas->area_count; !status && i < atlas->object_count; i++) {
        status = atlas_append_object(areas, &atlas->objects[i], atlas->places[i]);
    }
    for (size_t i = 0; !status && i < atlas->volume_count; i++) {
        struct volume *volume = &atlas->volumes[i];
        for (size_t s = 0; volume->info.role == CONUS_ROLE_SCALAR && s < volume->step_count; s++) {
            volume->steps[s].number += shift;
        }
    }
    if (!status) {
        name_set_finish(&atlas->taken);
        conus_atlas held = *atlas;
        atlas->objects = areas->objects;
        atlas->places = areas->places;
        atlas->object_count = areas->object_count;
        atlas->area_count = areas->area_count;
        areas->objects = held.objects;
        areas->places = held.places;
        areas->object_count = held.object_count;
        areas->area_count = held.area_count;
    }
    return status;
}

conus_status atlas_set_context(conus_atlas *atlas, const conus_volume_info *info, float *values)
{
    struct volume volume = {0};
    struct volume *old = (struct volume *)atlas_context(atlas);
    conus_status status = volume_init(&volume, info);
    volume.values = values;
    if (!status && info->threshold > 0) {
        volume.objects32 = memory_zeroed(volume.voxel_count, sizeof *volume.objects32);
        status = volume.objects32 ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    const float least = (float)tolerance_least(info->threshold);
    for (size_t i = 0; volume.objects32 && i < volume.voxel_count; i++) {
        volume.objects32[i] = values[i] >= least ? VOLUME_BLOCKER : 0;
    }
    if (!status && old) {
        volume_finish(old);
        *old = volume;
        return CONUS_OK;
    }
    status = status ? status : atlas_append_volume(atlas, &volume);
    if (status) {
        volume.values = NULL; /* stays the caller's */
    }
    volume_finish(&volume);
    return status;
}
