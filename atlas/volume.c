/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes, copies and frees a volume, and finds the voxel at a point. */
#include "atlas/volume.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

static void free_arrays(struct volume *volume)
{
    memory_free(volume->objects16);
    memory_free(volume->objects32);
    memory_free(volume->values);
    memory_free(volume->steps);
    memory_free(volume->hidden_runs);
    value_map_finish(&volume->map);
}

void volume_finish(struct volume *volume)
{
    memory_free(volume->path);
    if (volume->source && !volume->source->is_borrowed) {
        memory_free(volume->source->objects16);
        memory_free(volume->source->objects32);
        memory_free(volume->source->values);
        value_map_finish(&volume->source->map);
    }
    memory_free(volume->source);
    if (!volume->is_borrowed) {
        free_arrays(volume);
    }
    *volume = (struct volume){0};
}

/* False without memory; a copy of nothing is nothing. */
static bool copy_array(void *copy, const void *array, size_t count, size_t size)
{
    void *made = array ? memory_copy(array, count, size) : NULL;
    memcpy(copy, &made, sizeof made);
    return made || !array;
}

conus_status volume_own(struct volume *volume)
{
    struct volume own = *volume;
    if (!volume->is_borrowed) {
        return CONUS_OK;
    }
    own.is_borrowed = false;
    own.distances = NULL;
    own.objects32 = NULL;
    own.values = NULL;
    own.steps = NULL;
    own.hidden_runs = NULL;
    own.map = (struct value_map){0};
    if (!copy_array(&own.objects16, volume->objects16, volume->voxel_count, sizeof *own.objects16) ||
        !copy_array(&own.objects32, volume->objects32, volume->voxel_count, sizeof *own.objects32) ||
        !copy_array(&own.values, volume->values, volume->voxel_count, sizeof *own.values) ||
        !copy_array(&own.steps, volume->steps, volume->step_count, sizeof *own.steps) ||
        !copy_array(&own.hidden_runs, volume->hidden_runs, volume->hidden_run_count, sizeof *own.hidden_runs) ||
        (volume->map.count && value_map_copy(&own.map, &volume->map))) {
        free_arrays(&own);
        return CONUS_ERROR_MEMORY;
    }
    *volume = own;
    return CONUS_OK;
}

const struct volume_step *volume_step_of(const struct volume *volume, float value)
{
    size_t first = 0; /* of those that begin above the value */
    for (size_t end = volume->step_count; first < end;) {
        size_t middle = first + (end - first) / 2;
        if (volume->steps[middle].low <= value) {
            first = middle + 1;
        } else {
            end = middle;
        }
    }
    return first && value < volume->steps[first - 1].high ? &volume->steps[first - 1] : NULL;
}

size_t volume_next(const struct volume *volume, size_t voxel)
{
    bool is_sparse = volume->map.count && !volume_step_of(volume, value_map_code(&volume->map, 0));
    return is_sparse ? value_map_next(&volume->map, voxel) : voxel;
}

void volume_count_steps(uint64_t *counts, struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    struct object_box box = {{SIZE_MAX, SIZE_MAX, SIZE_MAX}, {0, 0, 0}};
    memset(counts, 0, volume->step_count * sizeof *counts);
    for (size_t v = volume_next(volume, 0); v < volume->voxel_count;) {
        size_t end = v - v % VALUE_RUN + VALUE_RUN;
        for (; v < end && v < volume->voxel_count; v++) {
            const struct volume_step *step = volume_step_of(volume, value_map_at(&volume->map, v));
            if (step) {
                const size_t at[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
                counts[step - volume->steps]++;
                for (int a = 0; a < 3; a++) {
                    box.first[a] = at[a] < box.first[a] ? at[a] : box.first[a];
                    box.last[a] = at[a] > box.last[a] ? at[a] : box.last[a];
                }
            }
        }
        v = volume_next(volume, v);
    }
    volume->box = box;
}

conus_status volume_spread(struct volume *out, const struct volume *volume, const size_t first[3], const size_t dim[3])
{
    struct volume part = {.info = {.dim = {dim[0], dim[1], dim[2]}}, .voxel_count = dim[0] * dim[1] * dim[2]};
    uint32_t most = 0;
    for (size_t i = 0; i < volume->step_count; i++) {
        most = volume->steps[i].number > most ? volume->steps[i].number : most;
    }
    if (most <= UINT16_MAX) {
        part.objects16 = memory_zeroed(part.voxel_count, sizeof *part.objects16);
    } else {
        part.objects32 = memory_zeroed(part.voxel_count, sizeof *part.objects32);
    }
    if (!part.objects16 && !part.objects32) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t row = 0; row < dim[1] * dim[2]; row++) {
        const size_t *all = volume->info.dim;
        size_t from = first[0] + all[0] * (first[1] + row % dim[1] + all[1] * (first[2] + row / dim[1]));
        for (size_t v = volume_next(volume, from); v < from + dim[0]; v = volume_next(volume, v + 1)) {
            volume_set_object(&part, row * dim[0] + v - from, volume_object(volume, v));
        }
    }
    *out = part;
    return CONUS_OK;
}

conus_status volume_init(struct volume *out, const conus_volume_info *info)
{
    struct volume volume = {.info = *info};
    if (!memory_multiply(info->dim[0], info->dim[1], &volume.voxel_count) ||
        !memory_multiply(volume.voxel_count, info->dim[2], &volume.voxel_count)) {
        return fail(CONUS_ERROR_DATA, "%zu x %zu x %zu voxels are too many to count", info->dim[0], info->dim[1],
                    info->dim[2]);
    }
    if (!mat4_invert_affine(volume.voxel_from_world, info->world_from_voxel)) {
        return fail(CONUS_ERROR_DATA, "%s: the matrix is singular, an invertible one is needed", info->transform);
    }
    const char *path = info->path ? info->path : "";
    volume.path = memory_text(path, strlen(path));
    if (!volume.path) {
        return CONUS_ERROR_MEMORY;
    }
    volume.info.path = volume.path;
    *out = volume;
    return CONUS_OK;
}

bool volume_find_voxel(size_t *voxel, const struct volume *volume, const double point[3])
{
    const size_t *dim = volume->info.dim;
    double cell[3];
    mat4_point(cell, volume->voxel_from_world, point);
    for (int a = 0; a < 3; a++) {
        cell[a] = floor(cell[a] + 0.5);
        if (!(cell[a] >= 0 && cell[a] < (double)dim[a])) {
            return false;
        }
    }
    *voxel = (size_t)cell[0] + dim[0] * ((size_t)cell[1] + dim[1] * (size_t)cell[2]);
    return true;
}

struct value_scale value_scale_of(const conus_volume_info *info)
{
    static const struct {
        const char *datatype;
        double value;
        const char *words;
    } full[] = {{"uint8", UINT8_MAX, "values over the range of uint8"},
                {"uint16", UINT16_MAX, "values over the range of uint16"}};
    if (info->maximum <= 1) {
        return (struct value_scale){1, true, "values up to 1, taken as probabilities"};
    }
    if (info->maximum <= 100) {
        return (struct value_scale){100, true, "values up to 100, taken as percent"};
    }
    for (size_t i = 0; i < 2; i++) {
        bool stored = strcmp(info->datatype, full[i].datatype) == 0 && info->slope == 1 && info->intercept == 0;
        if (stored && info->maximum > full[i].value / 2) {
            return (struct value_scale){full[i].value, true, full[i].words};
        }
    }
    return (struct value_scale){info->maximum, false, "values of no usual scale, measured by the largest"};
}
