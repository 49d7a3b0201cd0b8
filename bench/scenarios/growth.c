/* SPDX-License-Identifier: BSD-3-Clause */
/* Curves: the cost of a query at several sizes, and the exponent with which it grows. Cones into the paper's scene
 * against the number of its tori and the angle, and into a labelled volume against the number of its voxels. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/support/bench.h"
#include "bench/support/trace.h"
#include "bench/torus/torus.h"
#include "selection/engine/engine.h"
#include "selection/selection.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { GROWTH_POINTS = 12, GROWTH_NAME = 64, CHECK_SIZES = 3 };

struct growth_curve {
    struct bench *bench; /* Borrowed. */
    const char *name;    /* A literal; part of the keys in the JSON. */
    double angle_deg;    /* The cones'; 0 if they differ, or there are none. */
    size_t count;
    double x[GROWTH_POINTS], ms[GROWTH_POINTS];
    bool equal; /* All points' answers are as they should be. */
};

static struct growth_curve growth_begin(struct bench *bench, const char *name, double angle_deg)
{
    return (struct growth_curve){.bench = bench, .name = name, .angle_deg = angle_deg, .equal = true};
}

/* The number of sizes to measure: all `count`, or in a check only the first ones. */
static size_t growth_sizes(const struct bench *bench, size_t count)
{
    return bench->options.check && count > CHECK_SIZES ? CHECK_SIZES : count;
}

/* Prepares `variant` as the curve's next point at `x`, still to be measured; writes its name to `name`. */
static void growth_name(char name[GROWTH_NAME], const struct growth_curve *curve, double x,
                        struct bench_variant *variant)
{
    snprintf(name, GROWTH_NAME, "%s, %.10g", curve->name, x);
    variant->name = name;
    variant->more = json_pack("{s:s, s:f}", "curve", curve->name, "x", x);
}

/* Appends the point at `x` that was measured. */
static void growth_take(struct growth_curve *curve, double x, const struct bench_variant *variant)
{
    assert(curve->count < GROWTH_POINTS);
    curve->x[curve->count] = x;
    curve->ms[curve->count++] = variant->median_ms;
    curve->equal = curve->equal && variant->equal;
}

/* Names, measures in turn and appends `count` points at the sizes `x`, with `per` queries in a run. */
static conus_status growth_add(struct growth_curve *curve, const double *x, struct bench_variant *variants,
                               size_t count, size_t per)
{
    char names[GROWTH_POINTS][GROWTH_NAME];
    assert(count <= GROWTH_POINTS);
    for (size_t i = 0; i < count; i++) {
        growth_name(names[i], curve, x[i], &variants[i]);
    }
    conus_status status = bench_measure(curve->bench, "growth", variants, count, per, curve->angle_deg);
    for (size_t i = 0; i < count && !status; i++) {
        growth_take(curve, x[i], &variants[i]);
    }
    return status;
}

/* Adds the exponent of all points as `growth_NAME`, and to each run but the first its slope from the one before. */
static conus_status growth_end(struct growth_curve *curve)
{
    char key[64];
    size_t point = 0;
    size_t index;
    json_t *run;
    json_array_foreach(curve->bench->runs, index, run)
    {
        const char *name = json_string_value(json_object_get(run, "curve"));
        if (name && strcmp(name, curve->name) == 0 && point++ > 0) {
            double slope = bench_exponent(curve->x + point - 2, curve->ms + point - 2, 2);
            if (json_object_set_new(run, "slope", json_real(slope))) {
                return fail(CONUS_ERROR_MEMORY, "out of memory");
            }
        }
    }
    snprintf(key, sizeof key, "growth_%s", curve->name);
    return bench_value(curve->bench, key, bench_exponent(curve->x, curve->ms, curve->count), curve->equal);
}

enum { SIZES = 7, ANGLES = 8, ANGLE_TORI = 20000 };

/* Rays at a number of tori. */
struct tori {
    struct torus_scene scene;
    struct mesh_rays *rays; /* at one torus in all places */
    struct contest contest; /* the engines that are measured, and single rays at the shared torus */
    bool equal;
};

static void tori_finish(struct tori *tori)
{
    contest_finish(&tori->contest);
    mesh_rays_destroy(tori->rays);
    torus_scene_finish(&tori->scene);
}

/* Takes @p engine over, and cones into @p all as its questions. The vertices of an atlas's triangles are rounded when
 * they are moved, so that one ray in thousands differs from those at the shared torus. */
static conus_status tori_ask(struct tori *out, const struct tori *all, struct engine *engine, size_t count,
                             double angle_deg)
{
    struct contest *contest = &out->contest;
    struct engine *single = NULL;
    contest->cones = memory_zeroed(count, sizeof *contest->cones);
    contest->cone_count = contest->cones ? count : 0;
    torus_scene_cones(contest->cones, &all->scene, contest->cone_count, angle_deg);
    conus_status status = contest_add(contest, engine, engine->name);
    status = status || contest->cones ? status : CONUS_ERROR_MEMORY;
    status = status ? status : mesh_engine_create(&single, all->rays, 1);
    status = status ? status : contest_add(contest, single, single->name);
    size_t allowed = status || !contest->atlas ? 0 : trace_pixels(&contest->traces[0]) / 1000;
    out->equal = !status && trace_differences(&contest->traces[0], &contest->traces[1]) <= allowed;
    return status;
}

static conus_status tori_init(struct tori *tori, size_t size, bool own, const struct bench_options *options)
{
    conus_atlas **atlas = &tori->contest.atlas;
    struct engine *engine = NULL;
    conus_status status = torus_scene_init(&tori->scene, size);
    status = status ? status : torus_scene_rays(&tori->rays, &tori->scene);
    status = status || !own ? status : torus_scene_atlas(atlas, &tori->scene);
    if (!status) {
        status = own ? engine_rays_create(&engine, *atlas, &(struct engine_options){0})
                     : mesh_engine_create(&engine, tori->rays, 0);
    }
    return status ? status : tori_ask(tori, tori, engine, options->poses, options->angle);
}

static struct bench_variant variant_of(struct tori *tori)
{
    struct bench_variant variant = contest_variant(&tori->contest, 0);
    variant.equal = tori->equal;
    return variant;
}

static conus_status measure_sizes(struct bench *bench, const char *name, const size_t *sizes, size_t all, bool own)
{
    size_t count = growth_sizes(bench, all);
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

static conus_status growth_torus_angle(struct bench *bench)
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
        struct engine *engine = NULL;
        status = mesh_engine_create(&engine, all.rays, 0);
        status = status ? status : tori_ask(&tori[i], &all, engine, cone_count, angles[i]);
        variants[i] = variant_of(&tori[i]);
    }
    status = status ? status : growth_add(&curve, angles, variants, count, cone_count);
    status = status ? status : growth_end(&curve);
    for (size_t i = 0; i < ANGLES; i++) {
        tori_finish(&tori[i]);
    }
    tori_finish(&all);
    return status;
}

enum { SEED = 2010 };

/* The parcellation's labels with other numbers of voxels along its axes, by nearest neighbour, plane by plane, so that
 * only the atlas's own memory is needed. */
static conus_status enlarge_labels(struct label_voxels *out, const conus_atlas *atlas, const size_t dim[3])
{
    const struct volume *volume = atlas_parcellation(atlas);
    const size_t *coarse = volume->info.dim;
    struct label_coder coder;
    uint32_t *plane = memory_raw(dim[0] * dim[1], sizeof *plane);
    conus_status status = plane ? label_coder_init(&coder, dim[0] * dim[1] * dim[2], 0, NULL, 0) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(plane);
        return status;
    }
    for (size_t k = 0; k < dim[2] && !status; k++) {
        for (size_t v = 0; v < dim[0] * dim[1]; v++) {
            const size_t fine[3] = {v % dim[0], v / dim[0], k};
            size_t at[3];
            for (int a = 0; a < 3; a++) {
                at[a] = (size_t)(((double)fine[a] + 0.5) * (double)coarse[a] / (double)dim[a]);
            }
            uint32_t number = volume_object(volume, at[0] + coarse[0] * (at[1] + coarse[1] * at[2]));
            plane[v] = number ? atlas->objects[number - 1].label : 0;
        }
        status = label_coder_add(&coder, plane, dim[0] * dim[1]);
    }
    if (!status) {
        label_coder_end(out, &coder);
    }
    label_coder_finish(&coder);
    memory_free(plane);
    return status;
}

/* The parcellation of an atlas with `times` as many voxels along each axis, in the same place. */
static conus_status enlarge_atlas(conus_atlas **out, const conus_atlas *atlas, double times)
{
    conus_volume_info info = atlas_parcellation(atlas)->info;
    const conus_volume_info *coarse = &atlas_parcellation(atlas)->info;
    for (int a = 0; a < 3; a++) {
        info.dim[a] = (size_t)fmax(1, round((double)coarse->dim[a] * times));
        double step = (double)coarse->dim[a] / (double)info.dim[a];
        for (int r = 0; r < 3; r++) { /* the corner of the grid stays where it is */
            info.world_from_voxel[4 * a + r] *= step;
            info.world_from_voxel[12 + r] += coarse->world_from_voxel[4 * a + r] * (step - 1) / 2;
        }
    }
    struct label_voxels labels = {0};
    struct label_table table = {0};
    struct notes notes = {0};
    struct labelled_volume volume = {.info = &info, .labels = &labels};
    conus_status status = enlarge_labels(&labels, atlas, info.dim);
    status = status ? status : atlas_create_of(out, &volume, 1, &table, "made for conus-bench", &notes);
    label_voxels_finish(&labels);
    notes_finish(&notes);
    return status;
}

/* An atlas of some size, and the cones to answer. */
struct work {
    conus_atlas *atlas;
    conus_selector *selector; /* of all layers */
    struct cone *cones;
    size_t count;
    struct trace trace; /* first hits by the selector's engine */
    conus_status status;
};

static void work_finish(struct work *work)
{
    trace_finish(&work->trace);
    conus_selector_destroy(work->selector);
    memory_free(work->cones);
    conus_atlas_destroy(work->atlas);
}

static conus_status work_init(struct work *work, const struct bench_options *options)
{
    const conus_selector_options all = {.resolution = BENCH_RESOLUTION, .layers = CONUS_LAYERS_ALL};
    work->count = options->poses;
    work->cones = memory_zeroed(work->count, sizeof *work->cones);
    if (!work->cones) {
        return CONUS_ERROR_MEMORY;
    }
    cones_round_grid(work->cones, work->count, &atlas_parcellation(work->atlas)->info, options->angle, SEED);
    conus_status status = conus_selector_create(&work->selector, work->atlas, &all);
    return status ? status : trace_init(&work->trace, work->selector->engine, work->cones, work->count);
}

/* Compares first hits with those of a plain walk from voxel to voxel, and the first of all layers, too. */
static conus_status work_compare(bool equal[2], struct work *work)
{
    struct engine *plain = NULL;
    struct trace truth = {0}, first = {0};
    conus_status status = plain_engine_create(&plain, work->atlas);
    status = status ? status : trace_init(&truth, plain, work->cones, work->count);
    status = status ? status : trace_init_firsts(&first, work->selector->engine, work->cones, work->count);
    equal[0] = !status && trace_same(&work->trace, &truth);
    equal[1] = equal[0] && trace_same(&work->trace, &first);
    trace_finish(&first);
    trace_finish(&truth);
    engine_destroy(plain);
    return status;
}

static void select_all_layers(void *data)
{
    struct work *work = data;
    for (size_t i = 0; i < work->count; i++) {
        conus_selection *selection = NULL;
        const struct cone *cone = &work->cones[i];
        conus_status status = conus_select(&selection, work->selector, &cone->pose, degrees_from_radians(cone->angle));
        work->status = work->status ? work->status : status;
        conus_selection_destroy(selection);
    }
}

static void make_engine(void *data)
{
    struct work *work = data;
    struct engine *engine = NULL;
    conus_status status = engine_rays_create(&engine, work->atlas, &(struct engine_options){0});
    work->status = work->status ? work->status : status;
    engine_destroy(engine);
}

/* Measures first hits and all layers in turn, so that a disturbance of one round of a short measurement is not in all
 * of them. The distance map is timed first, while there is no selector, which makes another. */
static conus_status measure_work(struct growth_curve curves[3], struct work *work)
{
    double voxels = (double)atlas_parcellation(work->atlas)->voxel_count;
    struct bench_variant opening = {.run = make_engine, .data = work, .equal = true};
    struct bench_variant variants[] = {{.run = trace_all, .data = &work->trace},
                                       {.run = select_all_layers, .data = work}};
    char names[2][GROWTH_NAME];
    bool equal[2] = {false, false};
    conus_status status = growth_add(&curves[2], &voxels, &opening, 1, 1);
    status = status ? status : work_init(work, &curves[0].bench->options);
    status = status ? status : work_compare(equal, work);
    if (status) {
        return status;
    }
    for (int c = 0; c < 2; c++) {
        variants[c].equal = equal[c];
        growth_name(names[c], &curves[c], voxels, &variants[c]);
    }
    status = bench_measure(curves[0].bench, "growth", variants, 2, work->count, curves[0].angle_deg);
    for (int c = 0; c < 2 && !status; c++) {
        growth_take(&curves[c], voxels, &variants[c]);
    }
    return status ? status : work->status;
}

/* Measures one size after the other: there is no memory for all. */
static conus_status growth_voxels(struct bench *bench)
{
    static const double times[] = {0.52, 0.76, 1.12, 1.64, 2.41, 3.54, 5};
    double angle = bench->options.angle;
    conus_atlas *atlas = NULL;
    struct growth_curve curves[] = {growth_begin(bench, "voxels", angle), growth_begin(bench, "voxels_layers", angle),
                                    growth_begin(bench, "voxels_open", 0)};
    conus_status status = bench_load_labels(&atlas, bench->options.atlas);
    for (size_t i = 0; i < growth_sizes(bench, sizeof times / sizeof *times) && !status; i++) {
        struct work work = {0};
        status = enlarge_atlas(&work.atlas, atlas, times[i]);
        status = status ? status : measure_work(curves, &work);
        work_finish(&work);
    }
    for (size_t c = 0; c < 3 && !status; c++) {
        status = growth_end(&curves[c]);
    }
    conus_atlas_destroy(atlas);
    return status;
}

conus_status bench_growth(struct bench *bench)
{
    static const size_t shared[SIZES] = {1000, 3000, 10000, 30000, 100000, 300000, 1000000};
    static const size_t own[] = {1000, 2000, 5000, 10000, 20000};
    bench->one_thread = true;
    conus_status status = measure_sizes(bench, "objects", shared, SIZES, false);
    status = status ? status : measure_sizes(bench, "objects_own", own, sizeof own / sizeof *own, true);
    status = status ? status : growth_torus_angle(bench);
    return status ? status : growth_voxels(bench);
}
