/* SPDX-License-Identifier: BSD-3-Clause */
/* Cost of cones into labelled volumes against voxels, labels, pixels and angle. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/growth/growth.h"
#include "bench/support/trace.h"
#include "selection/engine/engine_rays.h"
#include "selection/evidence/layers.h"
#include "selection/selector.h"

#include <math.h>
#include <string.h>

/* What the voxels of a volume are made of. */
struct recipe {
    conus_volume_info info;
    uint32_t (*label)(const struct recipe *recipe, size_t i, size_t j, size_t k);
    const conus_atlas *atlas;    /* to enlarge */
    const struct volume *volume; /* its parcellation */
    double times;
    size_t edge, blocks;
};

static conus_status fill(struct label_voxels *out, const struct recipe *recipe)
{
    const size_t *dim = recipe->info.dim;
    struct label_coder coder;
    uint32_t *plane = memory_raw(dim[0] * dim[1], sizeof *plane);
    conus_status status = plane ? label_coder_init(&coder, dim[0] * dim[1] * dim[2], 0, NULL, 0) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(plane);
        return status;
    }
    for (size_t k = 0; k < dim[2] && !status; k++) {
        for (size_t j = 0; j < dim[1]; j++) {
            for (size_t i = 0; i < dim[0]; i++) {
                plane[i + dim[0] * j] = recipe->label(recipe, i, j, k);
            }
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

static conus_status make_atlas(conus_atlas **out, const struct recipe *recipe)
{
    struct label_voxels labels = {0};
    struct label_table table = {0};
    struct notes notes = {0};
    conus_status status = fill(&labels, recipe);
    struct labelled_volume volume = {.info = &recipe->info, .labels = &labels};
    status = status ? status : atlas_create_of(out, &volume, 1, &table, "made for conus-bench", &notes);
    label_voxels_finish(&labels);
    notes_finish(&notes);
    return status;
}

static uint32_t enlarged_label(const struct recipe *recipe, size_t i, size_t j, size_t k)
{
    const size_t *dim = recipe->volume->info.dim;
    const size_t fine[3] = {i, j, k};
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        at[a] = (size_t)(((double)fine[a] + 0.5) * (double)dim[a] / (double)recipe->info.dim[a]);
    }
    uint32_t number = volume_object(recipe->volume, at[0] + dim[0] * (at[1] + dim[1] * at[2]));
    return number ? recipe->atlas->objects[number - 1].label : 0;
}

/* The parcellation of atlas with times as many voxels along each axis, by nearest neighbour, in the same place.
 * Two bytes a voxel beside the atlas. */
static conus_status enlarge_atlas(conus_atlas **out, const conus_atlas *atlas, double times)
{
    struct recipe recipe = {.label = enlarged_label, .atlas = atlas, .volume = atlas_parcellation(atlas)};
    recipe.info = recipe.volume->info;
    double *m = recipe.info.world_from_voxel;
    const double *coarse = recipe.volume->info.world_from_voxel;
    for (int a = 0; a < 3; a++) {
        size_t dim = recipe.volume->info.dim[a];
        recipe.info.dim[a] = (size_t)fmax(1, round((double)dim * times));
        double step = (double)dim / (double)recipe.info.dim[a];
        for (int r = 0; r < 3; r++) { /* the corner of the grid stays where it is */
            m[4 * a + r] = coarse[4 * a + r] * step;
            m[12 + r] += coarse[4 * a + r] * (step - 1) / 2;
        }
    }
    return make_atlas(out, &recipe);
}

static uint32_t block_label(const struct recipe *recipe, size_t i, size_t j, size_t k)
{
    size_t block = recipe->edge / recipe->blocks;
    double middle = (double)(recipe->edge - 1) / 2;
    double x = (double)i - middle;
    double y = (double)j - middle;
    double z = (double)k - middle;
    bool inside = x * x + y * y + z * z <= middle * middle;
    size_t number = i / block + recipe->blocks * (j / block + recipe->blocks * (k / block));
    return inside ? (uint32_t)number + 1 : 0;
}

/* A ball in a cube of edge voxels of 1 mm, cut into cubes of edge / blocks voxels, of which each is an area.
 * edge is a multiple of blocks. */
static conus_status make_blocks(conus_atlas **out, size_t edge, size_t blocks)
{
    double corner = -(double)(edge - 1) / 2;
    struct recipe recipe = {.label = block_label, .edge = edge, .blocks = blocks};
    recipe.info = (conus_volume_info){.role = CONUS_ROLE_PARCELLATION, .path = "blocks", .dim = {edge, edge, edge}};
    const double m[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, corner, corner, corner, 1};
    memcpy(recipe.info.world_from_voxel, m, sizeof m);
    return make_atlas(out, &recipe);
}

enum { SEED = 2010, RESOLUTION = 16, PIXEL_CONES = 8 };

/* A volume, and cones that are asked of it in three ways. */
struct work {
    conus_atlas *atlas;       /* owned, unless the engine is borrowed */
    conus_selector *selector; /* of all layers; NULL where the engine is borrowed */
    struct cone *cones;
    size_t count;
    struct trace trace; /* first hits by the selector's engine */
    conus_status status;
    bool equal, layers_equal;
};

static void work_finish(struct work *work)
{
    bool owned = work->selector;
    trace_finish(&work->trace);
    conus_selector_destroy(work->selector);
    memory_free(work->cones);
    if (owned) {
        conus_atlas_destroy(work->atlas);
    }
}

/* Whether the engine's first hits are those of a plain walk from voxel to voxel. */
static conus_status compare_with_plain(struct work *work)
{
    struct engine *plain = NULL;
    struct trace trace = {0};
    conus_status status = plain_engine_create(&plain, work->atlas);
    status = status ? status : trace_init(&trace, plain, work->cones, work->count);
    work->equal = !status && trace_same(&work->trace, &trace);
    trace_finish(&trace);
    engine_destroy(plain);
    return status;
}

/* Whether the first of all layers is what is hit first, in every pixel. */
static conus_status compare_layers(struct work *work)
{
    struct layers layers = {0};
    struct evidence *first = &work->trace.scratch;
    struct engine *engine = work->selector->engine;
    size_t pixels = (size_t)RESOLUTION * RESOLUTION;
    conus_status status = CONUS_OK;
    work->layers_equal = work->equal;
    for (size_t i = 0; i < work->count && !status; i++) {
        const struct evidence *hits = &work->trace.answers[i];
        layers_clear(&layers);
        status = engine->functions->pierce(engine, &layers, &work->cones[i]);
        status = status ? status : layers_sort(&layers, pixels);
        (void)layers_first(first, &layers);
        for (size_t p = 0; p < pixels; p++) {
            work->layers_equal &= first->object[p] == hits->object[p] && first->distance[p] == hits->distance[p];
        }
    }
    layers_finish(&layers);
    return status;
}

static conus_status make_cones(struct work *work, size_t count, double angle_deg, uint32_t resolution)
{
    work->cones = memory_zeroed(count, sizeof *work->cones);
    work->count = count;
    if (!work->cones) {
        return CONUS_ERROR_MEMORY;
    }
    cones_round_grid(work->cones, count, &atlas_parcellation(work->atlas)->info, angle_deg, SEED);
    for (size_t i = 0; i < count; i++) {
        work->cones[i].resolution = resolution;
    }
    return CONUS_OK;
}

/* Cones into @p atlas, which becomes the work's, also on failure. */
static conus_status work_init(struct work *work, conus_atlas *atlas, const struct bench *bench)
{
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL};
    *work = (struct work){.atlas = atlas};
    conus_status status = conus_selector_create(&work->selector, atlas, &options);
    if (status) {
        conus_atlas_destroy(atlas);
        return status;
    }
    status = make_cones(work, bench->options.poses, bench->options.angle, RESOLUTION);
    status = status ? status : trace_init(&work->trace, work->selector->engine, work->cones, work->count);
    status = status ? status : compare_with_plain(work);
    return status ? status : compare_layers(work);
}

/* Cones of another angle or resolution, with the engine of @p other. */
static conus_status work_beside(struct work *work, const struct work *other, size_t count, double angle_deg,
                                uint32_t resolution)
{
    *work = (struct work){.atlas = other->atlas};
    conus_status status = make_cones(work, count, angle_deg, resolution);
    status = status ? status : trace_init(&work->trace, other->selector->engine, work->cones, count);
    return status ? status : compare_with_plain(work);
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

static struct bench_variant first_hits(struct work *work)
{
    return (struct bench_variant){.run = trace_all, .data = &work->trace, .per = work->count, .equal = work->equal};
}

static struct bench_variant all_layers(struct work *work)
{
    return (struct bench_variant){
        .run = select_all_layers, .data = work, .per = work->count, .equal = work->layers_equal};
}

static conus_status load_parcellation(conus_atlas **out, const struct bench *bench)
{
    conus_status status = conus_atlas_load(out, bench->options.atlas, NULL);
    if (!status && !atlas_parcellation(*out)) {
        conus_atlas_destroy(*out);
        *out = NULL;
        status = fail(CONUS_ERROR_DATA, "%s: has no labelled voxels", bench->options.atlas);
    }
    return status;
}

/* The distance map is made beside the selector's, so it is made without one. */
static conus_status measure_opening(struct growth_curve *curve, conus_atlas *atlas, double voxels)
{
    struct work work = {.atlas = atlas};
    struct bench_variant variant = {.run = make_engine, .data = &work, .equal = true};
    conus_status status = growth_add(curve, &voxels, &variant, 1, 1);
    return status ? status : work.status;
}

/* First hits and all layers in turn, so that what disturbs one round of a short measurement is not in all of them. */
static conus_status measure_both(struct growth_curve curves[2], struct work *work, double voxels)
{
    char names[2][GROWTH_NAME];
    struct bench_variant variants[] = {first_hits(work), all_layers(work)};
    for (int c = 0; c < 2; c++) {
        growth_name(names[c], &curves[c], voxels, &variants[c]);
    }
    conus_status status = bench_measure(curves[0].bench, "growth", variants, 2, work->count, curves[0].angle_deg);
    for (int c = 0; c < 2 && !status; c++) {
        growth_take(&curves[c], voxels, &variants[c]);
    }
    return status ? status : work->status;
}

static conus_status measure_voxels(struct growth_curve curves[3], const conus_atlas *atlas, double times)
{
    conus_atlas *enlarged = NULL;
    struct work work = {0};
    conus_status status = enlarge_atlas(&enlarged, atlas, times);
    if (status) {
        return status;
    }
    double voxels = (double)atlas_parcellation(enlarged)->voxel_count;
    status = measure_opening(&curves[2], enlarged, voxels);
    if (status) {
        conus_atlas_destroy(enlarged);
        return status;
    }
    status = work_init(&work, enlarged, curves[0].bench);
    status = status ? status : measure_both(curves, &work, voxels);
    work_finish(&work);
    return status;
}

/* One size after the other: there is no memory for all. */
conus_status growth_voxels(struct bench *bench)
{
    static const double times[] = {0.52, 0.76, 1.12, 1.64, 2.41, 3.54, 5};
    double angle = bench->options.angle;
    conus_atlas *atlas = NULL;
    struct growth_curve curves[] = {growth_begin(bench, "voxels", angle), growth_begin(bench, "voxels_layers", angle),
                                    growth_begin(bench, "voxels_open", 0)};
    conus_status status = load_parcellation(&atlas, bench);
    for (size_t i = 0; i < growth_sizes(bench, sizeof times / sizeof *times) && !status; i++) {
        status = measure_voxels(curves, atlas, times[i]);
    }
    for (size_t c = 0; c < 3 && !status; c++) {
        status = growth_end(&curves[c]);
    }
    conus_atlas_destroy(atlas);
    return status;
}

/* All numbers of blocks divide the first; the first ones the second, too. */
enum { EDGE = 240, CHECK_EDGE = 120, LABEL_SIZES = 7 };

static conus_status measure_labels(struct bench *bench, struct work *works, const double *x, size_t count)
{
    struct growth_curve hits = growth_begin(bench, "labels", bench->options.angle);
    struct growth_curve layers = growth_begin(bench, "labels_layers", bench->options.angle);
    struct bench_variant variants[2][LABEL_SIZES];
    for (size_t i = 0; i < count; i++) {
        variants[0][i] = first_hits(&works[i]);
        variants[1][i] = all_layers(&works[i]);
    }
    conus_status status = growth_add(&hits, x, variants[0], count, bench->options.poses);
    status = status ? status : growth_add(&layers, x, variants[1], count, bench->options.poses);
    for (size_t i = 0; i < count; i++) {
        status = status ? status : works[i].status;
    }
    status = status ? status : growth_end(&hits);
    return status ? status : growth_end(&layers);
}

conus_status growth_labels(struct bench *bench)
{
    static const size_t blocks[LABEL_SIZES] = {5, 8, 12, 20, 30, 48, 60};
    struct work works[LABEL_SIZES] = {0};
    double x[LABEL_SIZES];
    size_t count = growth_sizes(bench, LABEL_SIZES);
    size_t edge = bench->options.check ? CHECK_EDGE : EDGE;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        conus_atlas *atlas = NULL;
        status = make_blocks(&atlas, edge, blocks[i]);
        x[i] = status ? 0 : (double)atlas->area_count;
        status = status ? status : work_init(&works[i], atlas, bench);
    }
    status = status ? status : measure_labels(bench, works, x, count);
    for (size_t i = 0; i < LABEL_SIZES; i++) {
        work_finish(&works[i]);
    }
    return status;
}

/* @p curve at cones of the work's atlas that have these angles and resolutions. */
static conus_status measure_cones(struct growth_curve *curve, const struct work *work, size_t cone_count,
                                  const double *x, const double *angles, const uint32_t *resolutions, size_t count)
{
    struct work beside[GROWTH_POINTS] = {0};
    struct bench_variant variants[GROWTH_POINTS];
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        status = work_beside(&beside[i], work, cone_count, angles[i], resolutions[i]);
        variants[i] = first_hits(&beside[i]);
    }
    status = status ? status : growth_add(curve, x, variants, count, cone_count);
    for (size_t i = 0; i < GROWTH_POINTS; i++) {
        work_finish(&beside[i]);
    }
    return status ? status : growth_end(curve);
}

static conus_status measure_pixels(struct bench *bench, const struct work *work)
{
    static const uint32_t resolutions[] = {4, 8, 16, 32, 64, 128, 256, 512};
    struct growth_curve curve = growth_begin(bench, "pixels", bench->options.angle);
    size_t count = growth_sizes(bench, sizeof resolutions / sizeof *resolutions);
    double x[GROWTH_POINTS];
    double angles[GROWTH_POINTS];
    for (size_t i = 0; i < count; i++) {
        x[i] = (double)resolutions[i] * resolutions[i];
        angles[i] = bench->options.angle;
    }
    return measure_cones(&curve, work, PIXEL_CONES, x, angles, resolutions, count);
}

static conus_status measure_angles(struct bench *bench, const struct work *work)
{
    static const double angles[] = {0.5, 1, 2, 5, 10, 20, 40, 80};
    struct growth_curve curve = growth_begin(bench, "angle", 0);
    size_t count = growth_sizes(bench, sizeof angles / sizeof *angles);
    uint32_t resolutions[GROWTH_POINTS];
    for (size_t i = 0; i < count; i++) {
        resolutions[i] = RESOLUTION;
    }
    return measure_cones(&curve, work, bench->options.poses, angles, angles, resolutions, count);
}

conus_status growth_cones(struct bench *bench)
{
    conus_atlas *atlas = NULL;
    struct work work = {0};
    conus_status status = load_parcellation(&atlas, bench);
    status = status ? status : work_init(&work, atlas, bench);
    status = status ? status : measure_pixels(bench, &work);
    status = status ? status : measure_angles(bench, &work);
    work_finish(&work);
    return status;
}
