/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares where left and right areas lie. */
#include "atlas/areas/swapped_sides.h"

#include "atlas/areas/pairs.h"
#include "base/memory.h"

/* Of half a million voxels a mean is near enough, and takes a millisecond. */
enum { VOXELS = 1 << 19, LEAST_PAIRS = 3 };

/* Of an area's voxels and vertices. */
struct mean_x {
    double sum, weight;
};

static void add_x(struct mean_x *mean, double x)
{
    mean->sum += x;
    mean->weight++;
}

static void add_voxels(struct mean_x *means, const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    const double *m = volume->info.world_from_voxel;
    size_t step = 1;
    while (volume->voxel_count / step / step > VOXELS) {
        step++;
    }
    for (size_t k = 0; k < dim[2]; k += step) {
        for (size_t j = 0; j < dim[1]; j += step) {
            const size_t first = dim[0] * (j + dim[1] * k);
            const double x = m[4] * (double)j + m[8] * (double)k + m[12];
            for (size_t i = 0; i < dim[0]; i++) {
                uint32_t object = volume_object(volume, first + i);
                if (object) {
                    add_x(&means[object], x + m[0] * (double)i);
                }
            }
        }
    }
}

static void find_means(struct mean_x *means, const conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (atlas_volume_has_areas(&atlas->volumes[i])) {
            add_voxels(means, &atlas->volumes[i]);
        }
    }
    for (uint32_t number = 1; number <= atlas->area_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        for (size_t i = 0; mesh && i < mesh->vertex_count; i++) {
            add_x(&means[number], (double)mesh->positions[3 * i]);
        }
    }
}

static conus_status compare(conus_atlas *atlas, const struct mean_x *means, const uint32_t *right_of)
{
    size_t pairs = 0;
    size_t swapped = 0;
    uint32_t example = 0;
    for (uint32_t left = 1; left <= atlas->area_count; left++) {
        const struct mean_x *l = &means[left];
        const struct mean_x *r = &means[right_of[left]];
        if (right_of[left] && l->weight > 0 && r->weight > 0) {
            bool wrong = l->sum / l->weight > r->sum / r->weight;
            pairs++;
            swapped += wrong;
            example = wrong && !example ? left : example;
        }
    }
    if (pairs < LEAST_PAIRS || 4 * swapped < 3 * pairs) {
        return CONUS_OK;
    }
    return notes_warn(
        &atlas->notes,
        "%zu of %zu pairs of a left and a right area lie the other way round, %s (x %.1f mm) to the right "
        "of %s (%.1f mm): names or positions have left and right exchanged",
        swapped, pairs, atlas->objects[example - 1].name, means[example].sum / means[example].weight,
        atlas->objects[right_of[example] - 1].name, means[right_of[example]].sum / means[right_of[example]].weight);
}

static bool has_pair(const uint32_t *right_of, size_t area_count)
{
    bool any = false;
    for (size_t number = 1; number <= area_count; number++) {
        any = any || right_of[number];
    }
    return any;
}

conus_status swapped_sides_note(conus_atlas *atlas)
{
    uint32_t *right_of = NULL;
    conus_status status = hemispheres_pair(&right_of, atlas);
    if (status || !has_pair(right_of, atlas->area_count)) {
        memory_free(right_of);
        return status;
    }
    struct mean_x *means = memory_zeroed((size_t)atlas->object_count + 1, sizeof *means);
    status = means ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        find_means(means, atlas);
        status = compare(atlas, means, right_of);
    }
    memory_free(means);
    memory_free(right_of);
    return status;
}
