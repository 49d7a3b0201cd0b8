/* SPDX-License-Identifier: BSD-3-Clause */
/* How wrong slices are (Eq. 7): labels of an atlas, and thin tubes, by a fifth of the slices, all of them, and exactly;
 * and what that costs. */
#include "base/memory.h"
#include "bench/bench.h"
#include "bench/support/trace.h"
#include "render/id/slices.h"

#include <stdio.h>

enum { SEED = 72 };

/* Ways to trace. An engine takes a fifth of the given number of slices. */
enum { EXACT, ALL_SLICES, FIFTH, WAYS };

struct scene {
    const char *what;
    conus_atlas *atlas;
    struct cone *cones;
    size_t cone_count;
    struct engine *engines[WAYS];
    struct trace traces[WAYS];
};

/* Pixels that hit something, and those in which a way differs from the exact one. */
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

static conus_status make_engines(struct scene *scene)
{
    uint32_t slices = slices_default(scene->atlas->volumes[0].info.dim);
    const struct engine_options how[WAYS] = {[EXACT] = {0},
                                             [ALL_SLICES] = {.sampling = CONUS_SAMPLING_SLICES, .slices = 5 * slices},
                                             [FIFTH] = {.sampling = CONUS_SAMPLING_SLICES, .slices = slices}};
    conus_status status = CONUS_OK;
    for (int way = 0; way < WAYS && !status; way++) {
        status = engine_rays_create(&scene->engines[way], scene->atlas, &how[way]);
    }
    return status;
}

static conus_status scene_init(struct scene *scene, const char *what, const char *path, size_t cone_count)
{
    *scene = (struct scene){.what = what, .cone_count = cone_count};
    conus_status status = conus_atlas_load(&scene->atlas, path, NULL);
    if (!status && !atlas_parcellation(scene->atlas)) {
        status = fail(CONUS_ERROR_DATA, "%s: has no labelled voxels", path);
    }
    scene->cones = status ? NULL : memory_zeroed(cone_count, sizeof *scene->cones);
    if (!scene->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    return make_engines(scene);
}

static void scene_finish(struct scene *scene)
{
    for (int way = 0; way < WAYS; way++) {
        engine_destroy(scene->engines[way]);
    }
    memory_free(scene->cones);
    conus_atlas_destroy(scene->atlas);
}

static json_t *describe(const struct faults *faults)
{
    double hits = (double)(faults->hits ? faults->hits : 1);
    size_t wrong = faults->missed + faults->invented + faults->other;
    return json_pack("{s:I, s:f, s:f, s:f, s:f}", "pixels_met", (json_int_t)faults->hits, "wrong", (double)wrong / hits,
                     "missed", (double)faults->missed / hits, "invented", (double)faults->invented / hits, "other",
                     (double)faults->other / hits);
}

static conus_status measure_angle(struct bench *bench, struct scene *scene, double angle)
{
    static const char *const names[WAYS] = {"exact", "slices", "slices, a fifth"};
    struct bench_variant variants[WAYS];
    struct engine *plain = NULL;
    struct trace truth = {0};
    cones_round_grid(scene->cones, scene->cone_count, &scene->atlas->volumes[0].info, angle, SEED);
    conus_status status = plain_engine_create(&plain, scene->atlas);
    status = status ? status : trace_init(&truth, plain, scene->cones, scene->cone_count);
    for (int way = 0; way < WAYS && !status; way++) {
        struct trace *trace = &scene->traces[way];
        struct faults faults;
        status = trace_init(trace, scene->engines[way], scene->cones, scene->cone_count);
        count_faults(&faults, trace, &truth);
        snprintf(trace->name, sizeof trace->name, "%s, %s", scene->what, names[way]);
        variants[way] = (struct bench_variant){.name = trace->name, .run = trace_all, .data = trace};
        variants[way].equal = trace_same(trace, &truth);
        variants[way].other_by_design = way != EXACT;
        variants[way].more = describe(&faults);
        printf("%s, %g degrees: wrong pixels are %.3g %% of those that hit something\n", trace->name, angle,
               100 * json_number_value(json_object_get(variants[way].more, "wrong")));
    }
    status = status ? status : bench_measure(bench, "accuracy", variants, WAYS, scene->cone_count, angle);
    for (int way = 0; way < WAYS; way++) {
        trace_finish(&scene->traces[way]);
    }
    trace_finish(&truth);
    engine_destroy(plain);
    return status;
}

static conus_status measure_volume(struct bench *bench, const char *what, const char *path)
{
    static const double angles[] = {1, 2, 5, 10, 20, 40};
    struct scene scene;
    conus_status status = scene_init(&scene, what, path, bench->options.poses);
    for (size_t i = 0; i < sizeof angles / sizeof *angles && !status; i++) {
        snprintf(bench->driver, sizeof bench->driver, "%s", scene.engines[EXACT]->name);
        status = measure_angle(bench, &scene, angles[i]);
    }
    scene_finish(&scene);
    return status;
}

conus_status bench_accuracy(struct bench *bench)
{
    char tubes[160];
    bench->one_thread = true;
    snprintf(tubes, sizeof tubes, "%s/tubes.nii.gz", bench->folder);
    const conus_phantom_options options = {.size = bench->options.check ? 32 : 64};
    conus_status status = measure_volume(bench, "labels", bench->options.atlas);
    status = status ? status : conus_phantom_write("tubes", bench->folder, &options);
    return status ? status : measure_volume(bench, "tubes", tubes);
}
