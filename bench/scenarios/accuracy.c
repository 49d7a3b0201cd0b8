/* SPDX-License-Identifier: BSD-3-Clause */
/* The errors of slices (Eq. 7) and their cost: labels of an atlas, and thin tubes, by a fifth of the slices, by all of
 * them, and exactly. */
#include "bench/support/bench.h"
#include "bench/support/trace.h"
#include "conus/own.h"
#include "render/passes/shapes.h"

#include <stdio.h>

enum { SEED = 72 };

enum { PLAIN, EXACT, ALL_SLICES, FIFTH, WAYS };

/* Pixels that hit something, and those in which a way of tracing differs from the exact one. */
struct faults {
    size_t hits, missed, invented, other; /* nothing instead of an object, the other way round, another object */
};

static void count_faults(struct faults *out, const struct trace *trace, const struct trace *exact)
{
    *out = (struct faults){0};
    for (size_t i = 0; i < trace->count; i++) {
        size_t pixels = (size_t)trace->cones[i].resolution * trace->cones[i].resolution;
        for (size_t pixel = 0; pixel < pixels; pixel++) {
            uint32_t got = trace->answers[i].object[pixel], wanted = exact->answers[i].object[pixel];
            out->hits += wanted != 0;
            out->missed += wanted && !got;
            out->invented += got && !wanted;
            out->other += got && wanted && got != wanted;
        }
    }
}

/* The plain traversal is the truth. Engines with slices take a fifth of the given number. */
static conus_status add_ways(struct contest *contest, const char *what)
{
    static const char *const names[WAYS] = {"plain", "exact", "slices", "slices, a fifth"};
    uint32_t slices = slices_default(contest->atlas->volumes[0].info.dim);
    const struct engine_options how[WAYS] = {[ALL_SLICES] = {.sampling = CONUS_SAMPLING_SLICES, .slices = 5 * slices},
                                             [FIFTH] = {.sampling = CONUS_SAMPLING_SLICES, .slices = slices}};
    conus_status status = CONUS_OK;
    for (int way = 0; way < WAYS && !status; way++) {
        struct engine *engine = NULL;
        char name[112];
        status = way == PLAIN ? plain_engine_create(&engine, contest->atlas)
                              : engine_rays_create(&engine, contest->atlas, &how[way]);
        snprintf(name, sizeof name, "%s, %s", what, names[way]);
        status = status ? status : contest_add(contest, engine, name);
    }
    return status;
}

static conus_status measure_angle(struct bench *bench, const char *what, const char *path, double angle)
{
    struct contest contest;
    struct bench_variant variants[WAYS];
    conus_status status = contest_load(&contest, path, bench->options.poses, angle, SEED);
    status = status ? status : add_ways(&contest, what);
    for (size_t way = EXACT; way < WAYS && !status; way++) {
        struct faults faults;
        count_faults(&faults, &contest.traces[way], &contest.traces[PLAIN]);
        variants[way] = contest_variant(&contest, way);
        variants[way].equal = trace_same(&contest.traces[way], &contest.traces[PLAIN]);
        variants[way].other_by_design = way != EXACT;
        double hits = (double)(faults.hits ? faults.hits : 1);
        double wrong = (double)(faults.missed + faults.invented + faults.other) / hits;
        variants[way].more = json_pack("{s:I, s:f, s:f, s:f, s:f}", "pixels_met", (json_int_t)faults.hits, "wrong",
                                       wrong, "missed", (double)faults.missed / hits, "invented",
                                       (double)faults.invented / hits, "other", (double)faults.other / hits);
        printf("%s, %g degrees: wrong pixels are %.3g %% of those that hit something\n", variants[way].name, angle,
               100 * wrong);
    }
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", contest.engines[EXACT]->name);
        status = bench_measure(bench, "accuracy", variants + EXACT, WAYS - EXACT, contest.cone_count, angle);
    }
    contest_finish(&contest);
    return status;
}

conus_status bench_accuracy(struct bench *bench)
{
    static const double angles[] = {1, 2, 5, 10, 20, 40};
    enum { ANGLES = sizeof angles / sizeof *angles };
    char tubes[160];
    bench->one_thread = true;
    snprintf(tubes, sizeof tubes, "%s/tubes.nii.gz", bench->folder);
    const conus_phantom_options options = {.size = bench->options.check ? 32 : 64};
    conus_status status = conus_phantom_write("tubes", bench->folder, &options);
    for (size_t i = 0; i < 2 * ANGLES && !status; i++) {
        bool is_atlas = i < ANGLES;
        status = measure_angle(bench, is_atlas ? "labels" : "tubes", is_atlas ? bench->options.atlas : tubes,
                               angles[i % ANGLES]);
    }
    return status;
}
