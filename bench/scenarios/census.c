/* SPDX-License-Identifier: BSD-3-Clause */
/* Which voxels of a labelled volume are in a cone (Eq. 10): every one asked, against the walk over rows. */
#include "selection/measure/census.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/bench.h"
#include "bench/support/trace.h"

#include <stdio.h>
#include <string.h>

enum { WAYS = 2, SEED = 5 };

struct scene {
    conus_atlas *atlas;
    struct cone *cones;
    struct region *regions; /* [count] those of the cones */
    size_t count;
};

struct way {
    const struct scene *scene;
    void (*take)(struct census *census, const conus_atlas *atlas, const struct region *region);
    struct census census;
    uint64_t sum; /* of voxels times object numbers, over all regions */
};

static void make_regions(struct scene *scene, double degrees)
{
    cones_round_grid(scene->cones, scene->count, &scene->atlas->volumes[0].info, degrees, SEED);
    for (size_t i = 0; i < scene->count; i++) {
        region_from_cone(&scene->regions[i], &scene->cones[i]);
    }
}

/* The plain way: the predicate for every voxel. */
static void ask_all(struct census *census, const conus_atlas *atlas, const struct region *region)
{
    const struct volume *volume = &atlas->volumes[0];
    const size_t *dim = volume->info.dim;
    size_t voxel = 0;
    memset(census->counts, 0, (atlas->object_count + 1) * sizeof *census->counts);
    for (size_t k = 0; k < dim[2]; k++) {
        for (size_t j = 0; j < dim[1]; j++) {
            for (size_t i = 0; i < dim[0]; i++, voxel++) {
                double p[3] = {(double)i, (double)j, (double)k};
                mat4_point(p, volume->info.world_from_voxel, p);
                census->counts[volume_object(volume, voxel)].voxels += region_has(region, p);
            }
        }
    }
}

static void count_voxels(void *data)
{
    struct way *way = data;
    way->sum = 0;
    for (size_t i = 0; i < way->scene->count; i++) {
        way->take(&way->census, way->scene->atlas, &way->scene->regions[i]);
        for (size_t object = 0; object <= way->scene->atlas->object_count; object++) {
            way->sum += (object + 1) * way->census.counts[object].voxels;
        }
    }
}

static conus_status measure_angle(struct bench *bench, struct scene *scene, struct way ways[WAYS], double degrees)
{
    static const char *const names[WAYS] = {"every voxel asked", "rows"};
    struct bench_variant variants[WAYS];
    char key[64];
    make_regions(scene, degrees);
    for (size_t w = 0; w < WAYS; w++) {
        count_voxels(&ways[w]);
        variants[w] = (struct bench_variant){.name = names[w], .run = count_voxels, .data = &ways[w]};
        variants[w].equal = ways[w].sum == ways[0].sum;
    }
    snprintf(key, sizeof key, "asked_over_rows_%gdeg", degrees);
    conus_status status = bench_measure(bench, "census", variants, WAYS, scene->count, degrees);
    return status ? status : bench_ratio(bench, key, &variants[0], &variants[1]);
}

conus_status bench_census(struct bench *bench)
{
    static const double angles[] = {5, 20, 60};
    struct scene scene = {.count = bench->options.poses};
    struct way ways[WAYS] = {{.scene = &scene, .take = ask_all}, {.scene = &scene, .take = census_take}};
    struct census_labels *labels = NULL;
    bench->one_thread = true;
    conus_status status = conus_atlas_load(&scene.atlas, bench->options.atlas, NULL);
    if (!status && !atlas_parcellation(scene.atlas)) {
        status = fail(CONUS_ERROR_DATA, "%s: has no labelled voxels", bench->options.atlas);
    }
    status = status ? status : census_labels_create(&labels, scene.atlas);
    for (size_t w = 0; w < WAYS && !status; w++) {
        status = census_prepare(&ways[w].census, scene.atlas, labels);
    }
    scene.regions = status ? NULL : memory_zeroed(scene.count, sizeof *scene.regions);
    scene.cones = status ? NULL : memory_zeroed(scene.count, sizeof *scene.cones);
    status = status || (scene.regions && scene.cones) ? status : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < sizeof angles / sizeof angles[0] && !status; i++) {
        status = measure_angle(bench, &scene, ways, angles[i]);
    }
    for (size_t w = 0; w < WAYS; w++) {
        census_finish(&ways[w].census);
    }
    memory_free(scene.regions);
    memory_free(scene.cones);
    census_labels_destroy(labels, scene.atlas ? scene.atlas->volume_count : 0);
    conus_atlas_destroy(scene.atlas);
    return status;
}
