/* SPDX-License-Identifier: BSD-3-Clause */
/* A plan of needles towards one area that keep away from its neighbours in the list, with pruning and without. */
#include "selection/plan/plan.h"
#include "base/buffer.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "bench/support/bench.h"

#include <stdio.h>

enum { AVOIDED = 4, WANTED = AVOIDED + 1 };
static const double LENGTH = 90; /* mm */

struct way {
    conus_selector *selector;
    conus_constraint wanted[WANTED];
    size_t count;
    bool measures_all;
    const char *path;
    conus_plan *plan; /* the last run's */
    conus_status status;
};

static void run_plan(void *data)
{
    struct way *way = data;
    conus_pose_stream *poses = NULL;
    conus_plan_destroy(way->plan);
    way->plan = NULL;
    conus_status status = conus_plan_create(&way->plan, way->selector, way->wanted, way->count,
                                            &(conus_plan_options){.threads = 1, .far = LENGTH});
    if (!status && way->measures_all) {
        plan_measure_all(way->plan);
    }
    status = status ? status : conus_pose_stream_open(&poses, way->path, NULL);
    way->status = status ? status : conus_plan_run(way->plan, poses, UINT64_MAX);
    conus_pose_stream_destroy(poses);
}

/* Needles from all sides, each to 3 mm behind a voxel of the object. */
static conus_status write_needles(const char *path, const struct volume *volume, uint32_t object, size_t count)
{
    struct buffer text = {0};
    uint64_t state = 22;
    buffer_text(&text, "x\ty\tz\tdx\tdy\tdz\n");
    while (count) {
        const size_t *dim = volume->info.dim;
        double d[3] = {bench_random(&state, -1, 1), bench_random(&state, -1, 1), bench_random(&state, -1, -0.1)};
        double at[3];
        for (int a = 0; a < 3; a++) {
            at[a] = floor(bench_random(&state, 0, (double)dim[a]));
        }
        if (volume_object(volume, (size_t)at[0] + dim[0] * ((size_t)at[1] + dim[1] * (size_t)at[2])) == object) {
            vec3_normalise(d, d);
            mat4_point(at, volume->info.world_from_voxel, at);
            vec3_add_scaled(at, at, 3 - LENGTH, d);
            buffer_format(&text, "%.9g\t%.9g\t%.9g\t%.9g\t%.9g\t%.9g\n", at[0], at[1], at[2], d[0], d[1], d[2]);
            count--;
        }
    }
    conus_status status = buffer_status(&text) ? CONUS_ERROR_MEMORY : file_write(path, text.data, text.size);
    buffer_finish(&text);
    return status;
}

static bool is_same(const conus_plan *a, const conus_plan *b)
{
    bool same = conus_plan_count(a) == conus_plan_count(b) && conus_plan_count(a) > 0;
    for (size_t i = 0; same && i < conus_plan_count(a); i++) {
        const conus_planned *x = conus_plan_pose(a, i);
        const conus_planned *y = conus_plan_pose(b, i);
        same = x->candidate == y->candidate && x->leeway == y->leeway && x->clearance == y->clearance;
    }
    return same && conus_plan_left(a, 1) == conus_plan_left(b, 1);
}

conus_status bench_plan(struct bench *bench)
{
    conus_atlas *atlas = NULL;
    conus_selector *selector = NULL;
    char path[128];
    struct way ways[2] = {0};
    snprintf(path, sizeof path, "%s/needles.tsv", bench->folder);
    bench->one_thread = true;
    conus_status status = bench_load_labels(&atlas, bench->options.atlas);
    status = status ? status
                    : conus_selector_create(&selector, atlas,
                                            &(conus_selector_options){.resolution = BENCH_RESOLUTION, .radius = 0.65});
    uint32_t reached = status ? 0 : (uint32_t)atlas->object_count / 2;
    status = status ? status : write_needles(path, &atlas->volumes[0], reached, bench->options.poses);
    for (int w = 0; w < 2 && !status; w++) {
        ways[w] = (struct way){.selector = selector, .path = path, .measures_all = w == 0};
        for (uint32_t k = 0; k < WANTED && reached + k <= atlas->object_count; k++) {
            ways[w].wanted[ways[w].count++] =
                (conus_constraint){.kind = k ? CONUS_CONSTRAINT_AVOID : CONUS_CONSTRAINT_REACH,
                                   .names = atlas->objects[reached + k - 1].name,
                                   .limit = k ? 1 : 3};
        }
        run_plan(&ways[w]);
        status = ways[w].status;
    }
    if (!status) {
        struct bench_variant variants[2] = {
            {.name = "everything of every needle", .run = run_plan, .data = &ways[0], .equal = true},
            {.name = "as much as decides", .run = run_plan, .data = &ways[1]}};
        variants[1].equal = is_same(ways[0].plan, ways[1].plan);
        status = bench_measure(bench, "plan", variants, 2, bench->options.poses, 0);
        status = status ? status : bench_ratio(bench, "plan_over_no_pruning", &variants[1], &variants[0]);
    }
    conus_plan_destroy(ways[0].plan);
    conus_plan_destroy(ways[1].plan);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
    return status;
}
