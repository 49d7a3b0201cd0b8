/* SPDX-License-Identifier: BSD-3-Clause */
/* Cost of cones into a labelled volume against the number of its voxels. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/growth/growth.h"
#include "bench/support/trace.h"
#include "selection/engine/engine_rays.h"
#include "selection/evidence/layers.h"
#include "selection/selector.h"

#include <math.h>

enum { SEED = 2010, PIXELS = 16 * 16 };

/* Labels of the parcellation with other numbers of voxels along its axes, by nearest neighbour, plane by plane, so that
 * nothing is in memory but what the atlas keeps. */
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

/* An atlas of some size, and cones that are asked of it. */
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
    const conus_selector_options all = {.layers = CONUS_LAYERS_ALL};
    work->count = options->poses;
    work->cones = memory_zeroed(work->count, sizeof *work->cones);
    if (!work->cones) {
        return CONUS_ERROR_MEMORY;
    }
    cones_round_grid(work->cones, work->count, &atlas_parcellation(work->atlas)->info, options->angle, SEED);
    conus_status status = conus_selector_create(&work->selector, work->atlas, &all);
    return status ? status : trace_init(&work->trace, work->selector->engine, work->cones, work->count);
}

/* Whether the engine's first hits are those of a plain walk from voxel to voxel, and the first of all layers, too. */
static conus_status compare(bool equal[2], struct work *work)
{
    struct engine *plain = NULL, *engine = work->selector->engine;
    struct trace truth = {0};
    struct layers layers = {0};
    struct evidence *first = &work->trace.scratch;
    conus_status status = plain_engine_create(&plain, work->atlas);
    status = status ? status : trace_init(&truth, plain, work->cones, work->count);
    equal[0] = equal[1] = !status && trace_same(&work->trace, &truth);
    for (size_t i = 0; i < work->count && !status; i++) {
        const struct evidence *hits = &work->trace.answers[i];
        layers_clear(&layers);
        status = engine->functions->pierce(engine, &layers, &work->cones[i]);
        status = status ? status : layers_sort(&layers, PIXELS);
        (void)layers_first(first, &layers);
        for (size_t p = 0; p < PIXELS; p++) {
            equal[1] &= first->object[p] == hits->object[p] && first->distance[p] == hits->distance[p];
        }
    }
    layers_finish(&layers);
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
        conus_status status = conus_select(&selection, work->selector, &cone->pose, cone->angle);
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

/* First hits and all layers in turn, so that what disturbs one round of a short measurement is not in all of them. The
 * distance map is made before there is a selector, which has one. */
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
    status = status ? status : compare(equal, work);
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

/* One size after the other: there is no memory for all. */
conus_status growth_voxels(struct bench *bench)
{
    static const double times[] = {0.52, 0.76, 1.12, 1.64, 2.41, 3.54, 5};
    double angle = bench->options.angle;
    conus_atlas *atlas = NULL;
    struct growth_curve curves[] = {growth_begin(bench, "voxels", angle), growth_begin(bench, "voxels_layers", angle),
                                    growth_begin(bench, "voxels_open", 0)};
    conus_status status = conus_atlas_load(&atlas, bench->options.atlas, NULL);
    if (!status && !atlas_parcellation(atlas)) {
        status = fail(CONUS_ERROR_DATA, "%s: has no labelled voxels", bench->options.atlas);
    }
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
