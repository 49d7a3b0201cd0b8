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
    memory_free(volume->hidden_runs);
}

void volume_finish(struct volume *volume)
{
    memory_free(volume->path);
    if (volume->source && !volume->source->is_borrowed) {
        memory_free(volume->source->objects16);
        memory_free(volume->source->objects32);
        memory_free(volume->source->values);
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
    own.hidden_runs = NULL;
    if (!copy_array(&own.objects16, volume->objects16, volume->voxel_count, sizeof *own.objects16) ||
        !copy_array(&own.objects32, volume->objects32, volume->voxel_count, sizeof *own.objects32) ||
        !copy_array(&own.values, volume->values, volume->voxel_count, sizeof *own.values) ||
        !copy_array(&own.hidden_runs, volume->hidden_runs, volume->hidden_run_count, sizeof *own.hidden_runs)) {
        free_arrays(&own);
        return CONUS_ERROR_MEMORY;
    }
    *volume = own;
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
