/* SPDX-License-Identifier: BSD-3-Clause */
/* Objects from the values of a volume (Eq. 6): pathways, by a threshold or by bands, and a context that blocks. Also
 * other areas before them. */
#include "atlas/atlas.h"
#include "atlas/labels/labels.h"
#include "atlas/space.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Voxels with low <= value < high are the object `number`. Values are kept as floats, and so are the ends: bands that
 * share an end have neither a gap nor a voxel in common. */
struct step {
    float low, high;
    uint32_t number;
    uint64_t voxels; /* counted */
};

/* The step that holds the value. Steps are sorted by their lower ends and do not overlap. NULL = none, as for NaN. */
static struct step *step_of(struct step *steps, size_t count, float value)
{
    size_t first = 0; /* of those that begin above the value */
    for (size_t end = count; first < end;) {
        size_t middle = first + (end - first) / 2;
        if (steps[middle].low <= value) {
            first = middle + 1;
        } else {
            end = middle;
        }
    }
    return first && value < steps[first - 1].high ? &steps[first - 1] : NULL;
}

/* Makes volume->objects16 or 32 of the values, and counts the steps' voxels. */
static conus_status mark_voxels(struct volume *volume, struct step *steps, size_t count)
{
    uint32_t most = 0;
    for (size_t i = 0; i < count; i++) {
        most = steps[i].number > most ? steps[i].number : most;
    }
    if (most <= UINT16_MAX) {
        volume->objects16 = memory_zeroed(volume->voxel_count, sizeof *volume->objects16);
    } else {
        volume->objects32 = memory_zeroed(volume->voxel_count, sizeof *volume->objects32);
    }
    if (!volume->objects16 && !volume->objects32) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < volume->voxel_count; i++) {
        struct step *step = step_of(steps, count, volume->values[i]);
        if (step) {
            step->voxels++;
            volume_set_object(volume, i, step->number);
        }
    }
    return CONUS_OK;
}

static struct step step_from(double threshold, uint32_t number)
{
    return (struct step){.low = (float)threshold, .high = INFINITY, .number = number};
}

static void count_voxels(conus_object *object, const struct step *step, const conus_volume_info *info)
{
    object->voxels = step->voxels;
    object->volume_mm3 = (double)step->voxels * space_voxel_mm3(info);
}

static int compare_steps(const void *a, const void *b)
{
    const struct step *first = a;
    const struct step *second = b;
    return (first->low > second->low) - (first->low < second->low);
}

/* Adds `objects`, made from the steps: an area, or pathways with kind, name, low, high and is_band. */
static conus_status add_objects(conus_atlas *atlas, const conus_volume_info *info, float *values,
                                const conus_object *objects, struct step *steps, size_t count)
{
    struct volume volume = {0};
    size_t before = atlas->object_count;
    conus_status status = volume_init(&volume, info);
    if (!status) {
        volume.values = values;
        qsort(steps, count, sizeof *steps, compare_steps);
        status = mark_voxels(&volume, steps, count);
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
        const struct step *step = steps;
        while (step->number != (uint32_t)(before + i) + 1) {
            step++;
        }
        count_voxels(&object, step, info);
        status = atlas_append_object(atlas, &object, (struct object_place){.index = atlas->volume_count});
    }
    status = status ? status : atlas_append_volume(atlas, &volume);
    if (status) {
        atlas_cut_objects(atlas, before);
        volume.values = NULL; /* stays the caller's */
    }
    volume_finish(&volume);
    return status;
}

conus_status atlas_add_pathway(conus_atlas *atlas, const conus_volume_info *info, float *values, const char *name)
{
    struct step step = step_from(info->threshold, (uint32_t)atlas->object_count + 1);
    const conus_object pathway = {.kind = CONUS_KIND_PATHWAY, .name = name, .low = info->threshold, .high = INFINITY};
    return add_objects(atlas, info, values, &pathway, &step, 1);
}

conus_status atlas_add_probabilistic_area(conus_atlas *atlas, const conus_volume_info *info, float *values,
                                          const conus_object *area)
{
    struct step step = step_from(info->threshold, (uint32_t)atlas->object_count + 1);
    conus_object object = *area;
    object.low = info->threshold;
    object.high = INFINITY;
    conus_status status = atlas_check_order(atlas, area);
    status = status ? status : add_objects(atlas, info, values, &object, &step, 1);
    atlas->area_count = status ? atlas->area_count : atlas->object_count;
    return status;
}

conus_status atlas_add_bands(conus_atlas *atlas, const conus_volume_info *info, float *values, const conus_band *bands,
                             size_t count)
{
    struct step *steps = memory_zeroed(count, sizeof *steps);
    conus_object *objects = memory_zeroed(count, sizeof *objects);
    conus_status status = steps && objects ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        uint32_t number = (uint32_t)(atlas->object_count + i) + 1;
        objects[i] = (conus_object){.kind = CONUS_KIND_PATHWAY,
                                    .name = bands[i].name,
                                    .low = bands[i].low,
                                    .high = bands[i].high,
                                    .is_band = true};
        steps[i] = (struct step){.low = (float)bands[i].low, .high = (float)bands[i].high, .number = number};
    }
    status = status ? status : add_objects(atlas, info, values, objects, steps, count);
    memory_free(steps);
    memory_free(objects);
    return status;
}

/* The voxels of a warped volume, from which it may be resampled again: its present ones. */
static conus_status mark_source(struct volume_source *source, struct step step)
{
    if (!source) {
        return CONUS_OK;
    }
    size_t count = source->dim[0] * source->dim[1] * source->dim[2];
    struct volume marked = {.values = source->values, .voxel_count = count};
    float *values = source->is_borrowed ? memory_copy(source->values, count, sizeof *values) : source->values;
    conus_status status = values ? mark_voxels(&marked, &step, 1) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(source->is_borrowed ? values : NULL);
        return status;
    }
    memory_free(source->is_borrowed ? NULL : source->objects16);
    memory_free(source->is_borrowed ? NULL : source->objects32);
    source->objects16 = marked.objects16;
    source->objects32 = marked.objects32;
    source->values = values;
    source->is_borrowed = false;
    return CONUS_OK;
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
    struct step step = step_from(threshold, (uint32_t)number);
    conus_status status = volume_own(volume);
    struct volume marked = {.values = volume->values, .voxel_count = volume->voxel_count};
    status = status ? status : mark_source(volume->source, step);
    status = status ? status : mark_voxels(&marked, &step, 1);
    if (!status) {
        memory_free(volume->objects16);
        memory_free(volume->objects32);
        volume->objects16 = marked.objects16;
        volume->objects32 = marked.objects32;
        volume->info.threshold = threshold;
        atlas->objects[number - 1].low = threshold;
        count_voxels(&atlas->objects[number - 1], &step, &volume->info);
    }
    return status;
}

conus_status atlas_exchange_areas(conus_atlas *atlas, conus_atlas *areas)
{
    uint32_t **wide = memory_zeroed(atlas->volume_count, sizeof *wide);
    conus_status status = wide ? CONUS_OK : CONUS_ERROR_MEMORY;
    areas->area_count = areas->object_count;
    uint32_t shift = (uint32_t)(areas->area_count - atlas->area_count); /* modulo 2^32 where there are fewer */
    for (size_t i = atlas->area_count; !status && i < atlas->object_count; i++) {
        status = atlas_append_object(areas, &atlas->objects[i], atlas->places[i]);
    }
    for (size_t i = atlas->area_count; !status && i < atlas->object_count; i++) {
        size_t index = atlas->places[i].index;
        const struct volume *volume = atlas_object_volume(atlas, (uint32_t)i + 1);
        if (volume && volume->objects16 && !wide[index] && i + 1 + areas->area_count - atlas->area_count > UINT16_MAX) {
            wide[index] = memory_zeroed(volume->voxel_count, sizeof **wide);
            status = wide[index] ? CONUS_OK : CONUS_ERROR_MEMORY;
        }
    }
    for (size_t i = 0; !status && i < atlas->volume_count; i++) {
        if (atlas->volumes[i].info.role != CONUS_ROLE_SCALAR) {
            continue;
        }
        struct volume *volume = &atlas->volumes[i];
        for (size_t v = 0; v < volume->voxel_count; v++) {
            uint32_t number = volume_object(volume, v);
            if (number && wide[i]) {
                wide[i][v] = number + shift;
            } else if (number) {
                volume_set_object(volume, v, number + shift);
            }
        }
        if (wide[i]) {
            memory_free(volume->objects16);
            volume->objects16 = NULL;
            volume->objects32 = wide[i];
        }
        wide[i] = NULL;
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
    for (size_t i = 0; wide && i < atlas->volume_count; i++) {
        memory_free(wide[i]);
    }
    memory_free(wide);
    return status;
}

conus_status atlas_set_context(conus_atlas *atlas, const conus_volume_info *info, float *values)
{
    struct volume volume = {0};
    struct volume *old = (struct volume *)atlas_context(atlas);
    struct step step = step_from(info->threshold, VOLUME_BLOCKER);
    conus_status status = volume_init(&volume, info);
    volume.values = values;
    if (!status && info->threshold > 0) {
        status = mark_voxels(&volume, &step, 1);
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
