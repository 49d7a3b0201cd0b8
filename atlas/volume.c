/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes, copies and frees a volume, and finds the voxel at a point. */
#include "atlas/volume.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/tolerance.h"

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

bool grid_find_voxel(size_t *voxel, const size_t dim[3], const double at[3])
{
    double cell[3];
    for (int a = 0; a < 3; a++) {
        cell[a] = floor(at[a] + 0.5);
        if (!(cell[a] >= 0 && cell[a] < (double)dim[a])) {
            return false;
        }
    }
    *voxel = (size_t)cell[0] + dim[0] * ((size_t)cell[1] + dim[1] * (size_t)cell[2]);
    return true;
}

bool volume_find_voxel(size_t *voxel, const struct volume *volume, const double point[3])
{
    double at[3];
    mat4_point(at, volume->voxel_from_world, point);
    return grid_find_voxel(voxel, volume->info.dim, at);
}

/* The places of the bounds in value_spread.above. The first counts all voxels that are not below 0. */
enum { NOT_BELOW, COUNTED, ABOVE_1, BEYOND_1, ABOVE_100, BEYOND_100, BEYOND_HALF };
static const double bounds[] = {[NOT_BELOW] = -TOLERANCE,
                                [COUNTED] = 0.01, /* what a spline leaves of 0 is no value */
                                [ABOVE_1] = 1 + TOLERANCE,
                                [BEYOND_1] = 1.5, /* splines overshoot by less */
                                [ABOVE_100] = 100 * (1 + TOLERANCE),
                                [BEYOND_100] = 150,
                                [BEYOND_HALF] = UINT16_MAX / 2};

void value_spread_add(struct value_spread *spread, const struct value_map *map, const conus_volume_info *info)
{
    spread->least = fmin(spread->least, info->minimum);
    spread->largest = fmax(spread->largest, info->maximum);
    spread->voxels += map->count;
    double own[sizeof bounds / sizeof bounds[0]];
    memcpy(own, bounds, sizeof bounds);
    own[COUNTED] = info->intercept != 0 ? fmax(own[COUNTED], fabs(info->slope)) : own[COUNTED]; /* nor a step */
    value_map_spread(spread->above, map, own, sizeof own / sizeof own[0]);
}

/* One voxel of a hundred that count decides nothing about the others. */
static bool are_few(uint64_t voxels, const struct value_spread *spread)
{
    return voxels <= spread->above[COUNTED] / 100;
}

static bool is_stored_as(const conus_volume_info *info, const char *datatype)
{
    return strcmp(info->datatype, datatype) == 0 && info->slope == 1 && info->intercept == 0;
}

struct value_scale value_scale_of(const struct value_spread *spread, const conus_volume_info *info)
{
    const uint64_t *above = spread->above;
    bool is_byte = is_stored_as(info, "uint8");
    if (are_few(above[BEYOND_1], spread)) {
        return (struct value_scale){1, true, "values up to 1, taken as probabilities"};
    }
    if (above[BEYOND_1] < above[COUNTED] / 20) {
        return (struct value_scale){0, false, "too many values above 1 for probabilities, and too few for percent"};
    }
    if (!above[ABOVE_100] || (!is_byte && are_few(above[BEYOND_100], spread))) {
        return (struct value_scale){100, true, "values up to 100, taken as percent"};
    }
    if (is_byte && are_few(above[ABOVE_100], spread)) {
        return (struct value_scale){0, false, "too few values above 100 for the range of uint8, and some for percent"};
    }
    if (is_byte) {
        return (struct value_scale){UINT8_MAX, true, "values over the range of uint8"};
    }
    if (is_stored_as(info, "uint16") && !are_few(above[BEYOND_HALF], spread)) {
        return (struct value_scale){UINT16_MAX, true, "values over the range of uint16"};
    }
    return (struct value_scale){spread->largest, false, "values of no usual scale, measured by the largest"};
}

bool value_spread_strays(uint64_t *strays, const struct value_spread *spread, double value)
{
    const uint64_t *above = spread->above;
    uint64_t below = spread->voxels - above[NOT_BELOW];
    uint64_t over = value == 1 ? above[ABOVE_1] : value == 100 ? above[ABOVE_100] : 0;
    uint64_t far = value == 1 ? above[BEYOND_1] : value == 100 ? above[BEYOND_100] : 0;
    bool is_ring = spread->least >= -0.1 * fmin(spread->largest, value); /* as round what a spline resampled */
    *strays = below + over;
    return are_few(far, spread) && (are_few(below, spread) || is_ring) &&
           (value == 1 || value == 100 || spread->largest <= value * (1 + TOLERANCE));
}
