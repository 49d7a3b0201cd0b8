/* SPDX-License-Identifier: BSD-3-Clause */
/* Traces bundles of rays by the kernel of an instruction set, or ray by ray where kernels cannot. */
#include "base/geometry/math3.h"
#include "base/simd/processor.h"
#include "selection/engine/voxels/traverse.h"

#include <math.h>

static void trace_one_by_one(const struct distance_map *map, struct traverse_bundle *bundle)
{
    for (size_t i = 0; i < bundle->count; i++) {
        traverse_bundle_ray(map, bundle, i);
    }
}

static bool everywhere(void)
{
    return true;
}

const struct traverse_kernel *traverse_kernel(size_t index)
{
    static const struct traverse_kernel kernels[] = {
#if defined(__x86_64__)
        {.name = "avx512",
         .is_supported = processor_has_avx512,
         .trace = traverse_trace_avx512,
         .pierce = traverse_pierce_avx512},
        {.name = "avx2",
         .is_supported = processor_has_avx2,
         .trace = traverse_trace_avx2,
         .pierce = traverse_pierce_avx2},
        {.name = "sse2", .is_supported = everywhere, .trace = traverse_trace_plain, .pierce = traverse_pierce_plain},
#else
        {.name = "vector", .is_supported = everywhere, .trace = traverse_trace_plain, .pierce = traverse_pierce_plain},
#endif
        {.name = "scalar", .is_supported = everywhere, .trace = trace_one_by_one},
    };
    return index < sizeof kernels / sizeof kernels[0] ? &kernels[index] : NULL;
}

const struct traverse_kernel *traverse_best_kernel(void)
{
    size_t i = 0;
    while (!traverse_kernel(i)->is_supported()) {
        i++;
    }
    return traverse_kernel(i);
}

/* Repeats the last ray. */
static void pad(struct traverse_bundle *bundle)
{
    size_t last = bundle->count - 1;
    for (; bundle->count % TRAVERSE_LANES; bundle->count++) {
        for (int a = 0; a < 3; a++) {
            bundle->direction[a][bundle->count] = bundle->direction[a][last];
            bundle->starts[a][bundle->count] = bundle->starts[a][last];
        }
        bundle->limit[bundle->count] = bundle->limit[last];
    }
}

/* Sets where the rays begin in the volume's index space. */
static void find_starts(struct traverse_bundle *bundle)
{
    mat4_point(bundle->start, bundle->index_from_world, bundle->origin);
    for (int a = 0; a < 3; a++) {
        bundle->low[a] = bundle->is_apart ? INFINITY : bundle->start[a];
        bundle->high[a] = bundle->is_apart ? -INFINITY : bundle->start[a];
    }
    for (size_t i = 0; i < bundle->count && bundle->is_apart; i++) {
        double start[3] = {bundle->origins[0][i], bundle->origins[1][i], bundle->origins[2][i]};
        mat4_point(start, bundle->index_from_world, start);
        for (int a = 0; a < 3; a++) {
            bundle->starts[a][i] = start[a];
            bundle->low[a] = start[a] < bundle->low[a] ? start[a] : bundle->low[a];
            bundle->high[a] = start[a] > bundle->high[a] ? start[a] : bundle->high[a];
        }
    }
}

/* Sets what follows from the volume; whether kernels can trace the rays. */
static bool aim_at_volume(struct traverse_bundle *bundle, const struct distance_map *map, const struct volume *volume)
{
    bool is_near = bundle->count > 0 && distance_map_codes(map) <= TRAVERSE_CODES;
    bundle->index_from_world = volume->voxel_from_world;
    find_starts(bundle);
    bundle->starts_inside = true;
    for (int a = 0; a < 3; a++) {
        bool inside = traverse_cell(bundle->low[a]) >= map->first[a] && traverse_cell(bundle->high[a]) <= map->last[a];
        bundle->starts_inside = bundle->starts_inside && inside;
        is_near =
            is_near && -bundle->low[a] < TRAVERSE_FAR && bundle->high[a] < TRAVERSE_FAR && map->dim[a] <= TRAVERSE_EDGE;
    }
    return is_near;
}

/* Sets what object each hit is. */
static void find_objects(struct traverse_bundle *bundle, const struct volume *volume)
{
    for (size_t i = 0; i < bundle->count; i++) { /* or each would be waited for in turn */
        volume_fetch(volume, bundle->voxel[i] == UINT64_MAX ? 0 : bundle->voxel[i]);
    }
    for (size_t i = 0; i < bundle->count; i++) {
        bundle->object[i] = bundle->voxel[i] == UINT64_MAX ? 0 : volume_occupant(volume, bundle->voxel[i]);
    }
}

void traverse_bundle_trace(const struct traverse_kernel *kernel, const struct distance_map *map,
                           const struct volume *volume, struct traverse_bundle *bundle)
{
    size_t count = bundle->count;
    if (aim_at_volume(bundle, map, volume)) {
        pad(bundle);
        kernel->trace(map, bundle);
    } else {
        trace_one_by_one(map, bundle);
    }
    bundle->count = count;
    if (!map->least) {
        find_objects(bundle, volume);
    }
}

conus_status traverse_bundle_pierce(const struct traverse_kernel *kernel, const struct distance_map *map,
                                    struct traverse_piercing *piercing, struct traverse_bundle *bundle)
{
    conus_status status = CONUS_OK;
    bool is_lone = bundle->count == 1; /* kernels would take as long for it as for many */
    bool by_kernel = aim_at_volume(bundle, map, piercing->volume) && piercing->uniform && kernel->pierce && !is_lone;
    piercing->count = bundle->count;
    if (by_kernel) {
        for (size_t i = 0; i < bundle->count; i++) {
            bundle->limit[i] = INFINITY;
        }
        pad(bundle);
        status = kernel->pierce(piercing, bundle);
        bundle->count = piercing->count;
    }
    for (size_t i = 0; i < bundle->count && !status; i++) {
        if (!by_kernel || piercing->again[i]) {
            struct traverse_ray ray = traverse_bundle_at(bundle, i);
            status = traverse_pierce(piercing->out, map, piercing->volume, &ray, bundle->limit[i],
                                     (uint32_t)piercing->pixel[i]);
        }
    }
    return status;
}
