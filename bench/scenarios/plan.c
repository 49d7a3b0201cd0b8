/* SPDX-License-Identifier: BSD-3-Clause */
/* A plan of needles towards one area that keep away from its neighbours in the list, with pruning and without; and one
 * of several needles together, against whole lists of each. */
#include "selection/plan/plan.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/support/bench.h"

#include <math.h>
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

enum { TOGETHER = 4 };

/* Several needles, each towards an area of its own. */
struct several {
    conus_selector *selector;
    conus_constraint wanted[TOGETHER];
    char paths[TOGETHER][128];
    char names[TOGETHER][2];
    conus_question needles[TOGETHER];
    size_t count;
    conus_plan_options options;
    double largest[2][TOGETHER]; /* leeway, by each variant; below 0 where there is none */
    bool is_proven;
    conus_status status[2];
};

static conus_status open_needles(conus_pose_stream **out, void *user)
{
    return conus_pose_stream_open(out, user, NULL);
}

static void run_alone(void *data)
{
    struct several *several = data;
    conus_plan_options options = several->options;
    conus_status status = CONUS_OK;
    options.top = UINT64_MAX;
    for (size_t i = 0; i < several->count && !status; i++) {
        conus_plan *plan = NULL;
        conus_pose_stream *poses = NULL;
        status = conus_plan_create(&plan, several->selector, &several->wanted[i], 1, &options);
        status = status ? status : conus_pose_stream_open(&poses, several->paths[i], NULL);
        status = status ? status : conus_plan_run(plan, poses, UINT64_MAX);
        const conus_planned *best = status ? NULL : conus_plan_pose(plan, 0);
        several->largest[0][i] = best ? best->leeway : -1;
        conus_pose_stream_destroy(poses);
        conus_plan_destroy(plan);
    }
    several->status[0] = status;
}

static void run_together(void *data)
{
    struct several *several = data;
    conus_together *together = NULL;
    const conus_together_options options = {.between = 0.5};
    conus_status status = conus_plan_together(&together, several->needles, several->count, &options);
    const conus_combination *combination = status ? NULL : conus_together_combination(together, 0);
    several->is_proven = combination ? combination->proven : !status && conus_together_conflict(together);
    for (size_t i = 0; i < several->count && !status; i++) {
        double largest = conus_together_needle(together, i)->largest;
        several->largest[1][i] = isnan(largest) ? -1 : largest;
    }
    conus_together_destroy(together);
    several->status[1] = status;
}

static bool has_same_largest(const struct several *several)
{
    bool same = several->is_proven;
    for (size_t i = 0; i < several->count; i++) {
        same = same && fabs(several->largest[0][i] - several->largest[1][i]) <= 1e-6;
    }
    return same;
}

conus_status bench_together(struct bench *bench)
{
    conus_atlas *atlas = NULL;
    struct several several = {.options = {.threads = 1, .far = LENGTH}};
    bench->one_thread = true;
    conus_status status = bench_load_labels(&atlas, bench->options.atlas);
    status =
        status ? status : conus_selector_create(&several.selector, atlas, &(conus_selector_options){.radius = 0.4});
    uint32_t first = status ? 0 : (uint32_t)atlas->object_count / 2;
    for (uint32_t i = 0; i < TOGETHER && first + i <= atlas->object_count && !status; i++) {
        size_t at = several.count++;
        snprintf(several.paths[at], sizeof several.paths[at], "%s/together-%u.tsv", bench->folder, (unsigned)i);
        snprintf(several.names[at], sizeof several.names[at], "%c", (char)('A' + at));
        several.wanted[at] =
            (conus_constraint){.kind = CONUS_CONSTRAINT_REACH, .names = atlas->objects[first + i - 1].name, .limit = 3};
        several.needles[at] = (conus_question){.needles = several.names[at],
                                               .selector = several.selector,
                                               .constraints = &several.wanted[at],
                                               .constraint_count = 1,
                                               .options = &several.options,
                                               .open = open_needles,
                                               .user = several.paths[at]};
        status = write_needles(several.paths[at], &atlas->volumes[0], first + i, bench->options.poses);
    }
    if (!status) {
        run_alone(&several);
        run_together(&several);
        status = several.status[0] ? several.status[0] : several.status[1];
    }
    if (!status) {
        struct bench_variant variants[2] = {
            {.name = "all that hold, of each alone", .run = run_alone, .data = &several, .equal = true},
            {.name = "together, and proven", .run = run_together, .data = &several}};
        variants[1].equal = has_same_largest(&several);
        status = bench_measure(bench, "together", variants, 2, several.count * bench->options.poses, 0);
        status = status ? status : bench_ratio(bench, "together_over_whole_lists", &variants[1], &variants[0]);
    }
    conus_selector_destroy(several.selector);
    conus_atlas_destroy(atlas);
    return status;
}
