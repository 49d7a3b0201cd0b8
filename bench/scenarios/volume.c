/* SPDX-License-Identifier: BSD-3-Clause */
/* 256 rays through a labelled volume: plain traversal against the rays engine with each kernel, exact and on slices. */
#include "bench/support/trace.h"
#include "selection/engine/engine.h"
#include "selection/engine/voxels/traverse.h"

#include <stdio.h>

enum { SEED = 2010 };

static conus_status add_rays(struct contest *contest, const struct traverse_kernel *kernel, conus_sampling sampling)
{
    struct engine *engine = NULL;
    char name[112];
    conus_status status =
        engine_rays_create_with(&engine, contest->atlas, &(struct engine_options){.sampling = sampling}, kernel);
    if (status) {
        return status;
    }
    snprintf(name, sizeof name, "%s%s", engine->name, sampling == CONUS_SAMPLING_SLICES ? ", slices" : "");
    return contest_add(contest, engine, name);
}

static void build_map(void *data)
{
    struct distance_map map;
    if (!distance_map_init(&map, data)) {
        distance_map_finish(&map);
    }
}

static conus_status measure_ways(struct bench *bench, struct contest *contest)
{
    struct bench_variant variants[CONTEST_LIMIT];
    for (size_t i = 0; i < contest->count; i++) {
        variants[i] = contest_variant(contest, i);
        variants[i].equal = trace_same(&contest->traces[i], &contest->traces[0]);
        variants[i].other_by_design = i == contest->count - 1;
    }
    struct bench_variant build = {
        .name = "building the distance map", .run = build_map, .data = &contest->atlas->volumes[0], .equal = true};
    conus_status status =
        bench_measure(bench, "volume", variants, contest->count, contest->cone_count, bench->options.angle);
    status = status ? status : bench_measure(bench, "volume", &build, 1, 1, 0);
    return status ? status : bench_ratio(bench, "dda_over_simd", &variants[0], &variants[1]);
}

conus_status bench_volume(struct bench *bench)
{
    struct contest contest;
    struct engine *plain = NULL;
    const struct bench_options *options = &bench->options;
    bench->one_thread = true;
    conus_status status = contest_load(&contest, options->atlas, options->poses, options->angle, SEED);
    status = status ? status : plain_engine_create(&plain, contest.atlas);
    status = status ? status : contest_add(&contest, plain, plain->name);
    for (size_t k = 0; traverse_kernel(k) && !status; k++) {
        if (traverse_kernel(k)->is_supported()) {
            status = add_rays(&contest, traverse_kernel(k), CONUS_SAMPLING_EXACT);
        }
    }
    status = status ? status : add_rays(&contest, traverse_best_kernel(), CONUS_SAMPLING_SLICES);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", contest.engines[1]->name);
        status = measure_ways(bench, &contest);
    }
    contest_finish(&contest);
    return status;
}
