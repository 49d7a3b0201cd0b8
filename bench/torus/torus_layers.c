/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene with all layers (Eq. 10), against first hits. */
#include "base/memory.h"
#include "bench/support/bench.h"
#include "bench/support/trace.h"
#include "bench/torus/torus.h"
#include "selection/evidence/evidence.h"

#include <stdio.h>

enum { TORI = 20000 };

struct layer_round {
    struct torus_scene scene;
    struct contest contest; /* of the rays engine */
    struct trace first;     /* the first of all hits */
    struct layers all_hits; /* of the last cone */
};

static void pierce_all(void *data)
{
    struct layer_round *round = data;
    struct engine *rays = round->contest.engines[0];
    for (size_t i = 0; i < round->contest.cone_count; i++) {
        layers_clear(&round->all_hits);
        conus_status status = rays->functions->pierce(rays, &round->all_hits, &round->contest.cones[i]);
        status = status ? status : layers_sort(&round->all_hits, TORUS_RESOLUTION * TORUS_RESOLUTION);
        round->first.status = status ? status : round->first.status;
    }
}

conus_status bench_layers(struct bench *bench)
{
    const struct bench_options *options = &bench->options;
    struct layer_round round = {.contest = {.cone_count = options->poses}};
    struct contest *contest = &round.contest;
    struct engine *rays = NULL;
    bench->one_thread = true;
    contest->cones = memory_zeroed(options->poses, sizeof *contest->cones);
    conus_status status = contest->cones ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : torus_scene_init(&round.scene, bench_size(options, TORI));
    status = status ? status : torus_scene_atlas(&contest->atlas, &round.scene);
    status = status ? status : engine_rays_create(&rays, contest->atlas, &(struct engine_options){0});
    if (!status) {
        torus_scene_cones(contest->cones, &round.scene, options->poses, options->angle);
        status = contest_add(contest, rays, "20000 tori, visible");
    }
    status = status ? status : trace_init_firsts(&round.first, rays, contest->cones, options->poses);
    if (!status) {
        struct bench_variant v[] = {contest_variant(contest, 0),
                                    {.name = "20000 tori, all layers", .run = pierce_all, .data = &round}};
        v[0].equal = v[1].equal = trace_same(&contest->traces[0], &round.first);
        snprintf(bench->driver, sizeof bench->driver, "%s", rays->name);
        status = bench_measure(bench, "layers", v, 2, options->poses, options->angle);
        status = status ? status : bench_ratio(bench, "layers_over_visible", &v[1], &v[0]);
    }
    trace_finish(&round.first);
    layers_finish(&round.all_hits);
    contest_finish(contest);
    torus_scene_finish(&round.scene);
    return status;
}
