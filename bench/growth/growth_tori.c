/* SPDX-License-Identifier: BSD-3-Clause */
/* Cost of cones into the paper's scene against the number of its tori, and the angle. */
#include "base/memory.h"
#include "bench/growth/growth.h"
#include "bench/support/trace.h"
#include "bench/torus/torus_scene.h"

enum { SIZES = 7, ANGLES = 8, ANGLE_TORI = 20000 };

/* Rays at so many tori. */
struct tori {
    struct torus_scene scene;
    struct mesh_rays *rays; /* at one torus in all places */
    conus_atlas *atlas;     /* of tori with triangles of their own; NULL = not wanted */
    struct engine *engine;
    struct cone *cones;
    struct trace trace;
    bool equal;
};

static void tori_finish(struct tori *tori)
{
    trace_finish(&tori->trace);
    engine_destroy(tori->engine);
    mesh_rays_destroy(tori->rays);
    conus_atlas_destroy(tori->atlas);
    memory_free(tori->cones);
    torus_scene_finish(&tori->scene);
}

static conus_status make_cones(struct tori *tori, size_t count, double angle_deg)
{
    tori->cones = memory_zeroed(count, sizeof *tori->cones);
    if (!tori->cones) {
        return CONUS_ERROR_MEMORY;
    }
    torus_scene_cones(tori->cones, &tori->scene, count, angle_deg);
    return CONUS_OK;
}

/* Against single rays at the shared torus. The vertices of own triangles are rounded when they are moved, so that a ray
 * in thousands differs. */
static conus_status compare(struct tori *tori, struct mesh_rays *rays, size_t count)
{
    struct engine *single = NULL;
    struct trace trace = {0};
    conus_status status = mesh_engine_create(&single, rays, 1);
    status = status ? status : trace_init(&trace, single, tori->cones, count);
    size_t allowed = status || !tori->atlas ? 0 : trace_pixels(&trace) / 1000;
    tori->equal = !status && trace_differences(&tori->trace, &trace) <= allowed;
    trace_finish(&trace);
    engine_destroy(single);
    return status;
}

static conus_status tori_init(struct tori *tori, size_t size, bool own, const struct bench_options *options)
{
    conus_status status = torus_scene_init(&tori->scene, size);
    status = status ? status : torus_scene_rays(&tori->rays, &tori->scene);
    status = status || !own ? status : torus_scene_atlas(&tori->atlas, &tori->scene);
    if (!status) {
        status = own ? engine_rays_create(&tori->engine, tori->atlas, &(struct engine_options){0})
                     : mesh_engine_create(&tori->engine, tori->rays, 0);
    }
    status = status ? status : make_cones(tori, options->poses, options->angle);
    status = status ? status : trace_init(&tori->trace, tori->engine, tori->cones, options->poses);
    return status ? status : compare(tori, tori->rays, options->poses);
}

static struct bench_variant variant_of(struct tori *tori)
{
    return (struct bench_variant){.run = trace_all, .data = &tori->trace, .equal = tori->equal};
}

static conus_status measure_sizes(struct bench *bench, const char *name, const size_t *sizes, size_t count, bool own)
{
    struct growth_curve curve = growth_begin(bench, name, bench->options.angle);
    struct tori tori[SIZES] = {0};
    struct bench_variant variants[SIZES];
    double x[SIZES];
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        size_t size = bench_size(&bench->options, sizes[i]);
        x[i] = (double)size;
        status = tori_init(&tori[i], size, own, &bench->options);
        variants[i] = variant_of(&tori[i]);
    }
    status = status ? status : growth_add(&curve, x, variants, count, bench->options.poses);
    status = status ? status : growth_end(&curve);
    for (size_t i = 0; i < SIZES; i++) {
        tori_finish(&tori[i]);
    }
    return status;
}

conus_status growth_objects(struct bench *bench)
{
    static const size_t shared[SIZES] = {1000, 3000, 10000, 30000, 100000, 300000, 1000000};
    static const size_t own[] = {1000, 2000, 5000, 10000, 20000};
    conus_status status = measure_sizes(bench, "objects", shared, growth_sizes(bench, SIZES), false);
    size_t count = growth_sizes(bench, sizeof own / sizeof *own);
    return status ? status : measure_sizes(bench, "objects_own", own, count, true);
}

conus_status growth_torus_angle(struct bench *bench)
{
    static const double angles[ANGLES] = {0.5, 1, 2, 5, 10, 20, 40, 80};
    struct growth_curve curve = growth_begin(bench, "angle_tori", 0);
    struct tori all = {0};
    struct tori tori[ANGLES] = {0};
    struct bench_variant variants[ANGLES];
    size_t count = growth_sizes(bench, ANGLES);
    size_t cone_count = bench->options.poses;
    conus_status status = tori_init(&all, bench_size(&bench->options, ANGLE_TORI), false, &bench->options);
    for (size_t i = 0; i < count && !status; i++) {
        struct tori *one = &tori[i];
        one->scene = all.scene;
        status = make_cones(one, cone_count, angles[i]);
        status = status ? status : trace_init(&one->trace, all.engine, one->cones, cone_count);
        status = status ? status : compare(one, all.rays, cone_count);
        one->scene = (struct torus_scene){0};
        variants[i] = variant_of(one);
    }
    status = status ? status : growth_add(&curve, angles, variants, count, cone_count);
    status = status ? status : growth_end(&curve);
    for (size_t i = 0; i < ANGLES; i++) {
        tori_finish(&tori[i]);
    }
    tori_finish(&all);
    return status;
}
