/* SPDX-License-Identifier: BSD-3-Clause */
/* Whole batches: poses as text in, rows as text out. */
#include "bench/support/bench.h"
#include "bench/support/trace.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "selection/engine/engine.h"
#include "selection/engine/voxels/traverse.h"
#include "selection/selection.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One way to answer the poses. */
struct way {
    const char *name;
    conus_selector *selector;
    conus_selector *like; /* that gives the same rows; NULL where nothing else does */
    uint32_t threads;
    bool one_by_one; /* not in blocks of cones                                      */
    bool no_rows;    /* the engine's evidence alone */
};

struct scene {
    conus_atlas *atlas;
    conus_selector *selector; /* of the rays engine   */
    double angle;             /* degrees              */
    char path[96];            /* of the poses         */
};

struct contender {
    const struct scene *scene;
    const struct way *way;
    conus_batch *batch;
    conus_pose_list *list;
    struct buffer rows; /* or the objects of pixels, the first time */
    bool is_known;
    conus_status status;
};

/* What the holds of docs/benchmarks.md were measured with. */
static const conus_selector_options held = {.resolution = BENCH_RESOLUTION};

/* Creates a selector with `engine` in the place of its own. */
static conus_status create_with(conus_selector **out, const conus_atlas *atlas, const conus_selector_options *options,
                                struct engine *engine)
{
    conus_status status = conus_selector_create(out, atlas, options);
    if (status) {
        engine_destroy(engine);
        return status;
    }
    engine_destroy((*out)->engine);
    (*out)->engine = engine;
    return CONUS_OK;
}

/* The labelled volume, and poses around it. */
static conus_status make_scene(struct scene *scene, const struct bench *bench)
{
    conus_status status = bench_load_labels(&scene->atlas, bench->options.atlas);
    if (!status) {
        snprintf(scene->path, sizeof scene->path, "%s/poses.tsv", bench->folder);
        status = program_write_poses(scene->path, bench->options.poses, &scene->atlas->volumes[0].info,
                                     bench->options.angle);
    }
    status = status ? status : conus_selector_create(&scene->selector, scene->atlas, &held);
    scene->angle = bench->options.angle;
    return status;
}

static void scene_finish(struct scene *scene)
{
    conus_selector_destroy(scene->selector);
    conus_atlas_destroy(scene->atlas);
}

static bool keep_rows(void *user, const conus_batch_block *block)
{
    struct contender *contender = user;
    buffer_append(&contender->rows, block->text, block->size);
    return true;
}

/* Traces the evidence only, with the rays of the selector. */
static conus_status trace_all_poses(struct contender *contender)
{
    conus_selector *selector = contender->way->selector;
    struct cone cone = {.angle = radians_from_degrees(contender->scene->angle),
                        .resolution = selector->options.resolution};
    struct evidence evidence;
    cone.slope = cone_slope(&cone);
    conus_status status = evidence_init(&evidence, cone.resolution);
    status = status ? status : aperture_prepare(&selector->aperture, &cone);
    cone.tracing.wanted = selector->aperture.in_cone;
    cone.tracing.rays = &selector->aperture.rays;
    for (size_t i = 0; i < conus_pose_list_count(contender->list) && !status; i++) {
        cone.pose = conus_pose_list_row(contender->list, i)->pose;
        status = selector->engine->functions->trace(selector->engine, &evidence, &cone);
        size_t size = (size_t)cone.resolution * cone.resolution * sizeof *evidence.object;
        buffer_append(&contender->rows, evidence.object, contender->is_known ? 0 : size);
    }
    evidence_finish(&evidence);
    return status;
}

static void run_contender(void *data)
{
    struct contender *contender = data;
    conus_pose_stream *poses = NULL;
    conus_status status;
    if (contender->way->no_rows) {
        status = trace_all_poses(contender);
    } else {
        buffer_clear(&contender->rows);
        status = conus_pose_stream_open(&poses, contender->scene->path, NULL);
        status = status ? status : conus_batch_run(contender->batch, poses, UINT64_MAX, keep_rows, contender);
        conus_pose_stream_destroy(poses);
    }
    contender->status = status ? status : contender->status;
}

static void contender_finish(struct contender *contender)
{
    conus_batch_destroy(contender->batch);
    conus_pose_list_destroy(contender->list);
    buffer_finish(&contender->rows);
}

/* Answers once. End it with contender_finish() even if this fails. */
static conus_status contender_init(struct contender *out, const struct scene *scene, const struct way *way)
{
    const conus_batch_options options = {.threads = way->threads,
                                         .block = way->one_by_one,
                                         .angle = way->selector->options.radius > 0 ? 0 : scene->angle,
                                         .report = {.format = "tsv", .no_voxels = true}};
    *out = (struct contender){.scene = scene, .way = way};
    conus_status status = way->no_rows ? conus_pose_list_load(&out->list, scene->path, NULL)
                                       : conus_batch_create(&out->batch, way->selector, &options);
    if (!status) {
        run_contender(out);
        out->is_known = true;
    }
    return status;
}

/* Compares byte for byte; of the counts of pixels, which Embree alone finds in single precision, one in a thousand may
 * differ. */
static bool is_alike(const struct contender *a, const struct contender *b)
{
    size_t differences = 0;
    for (size_t i = 0; i < a->rows.size && a->rows.size == b->rows.size; i++) {
        differences += a->rows.data[i] != b->rows.data[i];
    }
    return a->rows.size && a->rows.size == b->rows.size && differences <= (a->way->no_rows ? a->rows.size / 1000 : 0);
}

/* Answers once by each of @p ways, compares the rows with those that they must be like, and measures. */
static conus_status measure_ways(struct bench *bench, const char *scenario, const struct scene *scene,
                                 const struct way *ways, size_t count, struct bench_variant *variants)
{
    struct contender contenders[CONTEST_LIMIT] = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status && ways[i].selector; i++) {
        struct contender like = {0};
        const struct way other = {.selector = ways[i].like, .threads = 1, .no_rows = ways[i].no_rows};
        status = contender_init(&contenders[i], scene, &ways[i]);
        status = status || !other.selector ? status : contender_init(&like, scene, &other);
        variants[i] = (struct bench_variant){.name = ways[i].name, .run = run_contender, .data = &contenders[i]};
        bool same = !ways[i].like || is_alike(&contenders[i], &like);
        variants[i].equal = !contenders[i].status && !like.status && same;
        contender_finish(&like);
    }
    status =
        status ? status : bench_measure(bench, scenario, variants, count, bench->options.poses, bench->options.angle);
    for (size_t i = 0; i < count; i++) {
        contender_finish(&contenders[i]);
    }
    return status;
}

conus_status bench_batch(struct bench *bench)
{
    enum { NO_ROWS, TRACE, RAYS, RAYS_2, GL_ALONE, GL_BLOCKS, WAYS };
    const conus_selector_options by_gl = {.engine = CONUS_ENGINE_GL, .resolution = BENCH_RESOLUTION};
    struct scene scene = {0};
    struct engine *engine = NULL;
    conus_selector *plain = NULL, *gl = NULL;
    struct bench_variant v[WAYS];
    conus_status status = make_scene(&scene, bench);
    status = status ? status : plain_engine_create(&engine, scene.atlas);
    status = status ? status : create_with(&plain, scene.atlas, &held, engine);
    status = status ? status : conus_selector_create(&gl, scene.atlas, &by_gl);
    status = status == CONUS_ERROR_GL ? bench_leave_out(bench, "batches by OpenGL") : status;
    const struct way ways[WAYS] = {{"plain scalar traversal, no rows", plain, NULL, 1, false, true},
                                   {"rays, no rows", scene.selector, NULL, 1, false, true},
                                   {"rays, batch, 1 thread", scene.selector, plain, 1, false, false},
                                   {"rays, batch, 2 threads", scene.selector, plain, 2, false, false},
                                   {"gl, batch, one cone at a time", gl, plain, 1, true, false},
                                   {"gl, batch, blocks of 256 cones", gl, plain, 1, false, false}};
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s; %s", conus_selector_engine(scene.selector),
                 conus_selector_engine(gl));
        status = measure_ways(bench, "batch", &scene, ways, gl ? WAYS : GL_ALONE, v);
    }
    status = status ? status : bench_ratio(bench, "plain_over_batch", &v[NO_ROWS], &v[RAYS]);
    status = status ? status : bench_ratio(bench, "batch_over_trace", &v[RAYS], &v[TRACE]);
    status = status ? status : bench_ratio(bench, "batch_one_over_two_threads", &v[RAYS], &v[RAYS_2]);
    status = status || !gl ? status : bench_ratio(bench, "gl_one_over_block", &v[GL_ALONE], &v[GL_BLOCKS]);
    status = status ? status : bench_value(bench, "batch_cones_per_s", 1000 / v[RAYS_2].median_ms, v[RAYS_2].equal);
    conus_selector_destroy(plain);
    conus_selector_destroy(gl);
    scene_finish(&scene);
    return status;
}

/* The questions asked of a batch. A question may be compared with another one: `ratio` names its time over that of
 * question `over`. */
static const struct question {
    const char *name;
    conus_selector_options options;
    const char *ratio;
    size_t over;
} questions[] = {
    {"first hits", {.resolution = BENCH_RESOLUTION}, NULL, 0},
    {"first hits, --range 0,250", {.resolution = BENCH_RESOLUTION, .range = {0, 250}}, "range_over_cone", 0},
    {"first hits, --range 200,300", {.resolution = BENCH_RESOLUTION, .range = {200, 300}}, "near_range_over_cone", 0},
    {"first hits, --radius 0.65", {.resolution = BENCH_RESOLUTION, .radius = 0.65}, "cylinder_over_cone", 0},
    {"all layers", {.resolution = BENCH_RESOLUTION, .layers = CONUS_LAYERS_ALL}, "layers_over_visible_aal", 0},
    {"all layers, --radius 0.65",
     {.resolution = BENCH_RESOLUTION, .layers = CONUS_LAYERS_ALL, .radius = 0.65},
     "cylinder_layers_over_cone_layers",
     4},
    {"first hits, default resolution", {0}, "default_rays_over_16", 0}};
enum { QUESTIONS = sizeof questions / sizeof questions[0] };

conus_status bench_batch_layers(struct bench *bench)
{
    struct scene scene = {0};
    struct way ways[QUESTIONS] = {{0}};
    struct bench_variant v[QUESTIONS];
    bench->one_thread = true;
    size_t scalar = 0; /* the kernel that is none: ray by ray */
    for (; traverse_kernel(scalar + 1); scalar++) {
    }
    conus_status status = make_scene(&scene, bench);
    for (size_t q = 0; q < QUESTIONS && !status; q++) {
        struct engine *single = NULL;
        ways[q] = (struct way){.name = questions[q].name, .threads = 1};
        status = conus_selector_create(&ways[q].selector, scene.atlas, &questions[q].options);
        status = status ? status
                        : engine_rays_create_with(&single, scene.atlas, &(struct engine_options){0},
                                                  traverse_kernel(scalar));
        status = status ? status : create_with(&ways[q].like, scene.atlas, &questions[q].options, single);
    }
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", conus_selector_engine(scene.selector));
        status = measure_ways(bench, "batch_layers", &scene, ways, QUESTIONS, v);
    }
    for (size_t q = 0; q < QUESTIONS; q++) {
        bool has_ratio = !status && questions[q].ratio;
        status = has_ratio ? bench_ratio(bench, questions[q].ratio, &v[q], &v[questions[q].over]) : status;
        conus_selector_destroy(ways[q].selector);
        conus_selector_destroy(ways[q].like);
    }
    scene_finish(&scene);
    return status;
}

conus_status bench_batch_mesh(struct bench *bench)
{
    enum { ONE, TWO, VOLUME, TRACE, BARE, WAYS };
    char folder[96], program[320];
    struct scene scene = {0};
    conus_atlas *surfaces = NULL;
    conus_selector *surface = NULL, *bare = NULL;
    struct bench_variant v[WAYS];
    conus_status status = make_scene(&scene, bench);
    if (program_find(program, sizeof program, "conus-mesh", "CONUS_MESH") == CONUS_OK) {
        setenv("CONUS_MESH", program, 0);
    }
    snprintf(folder, sizeof folder, "%s/surfaces", bench->folder);
    status = status ? status : conus_atlas_write_meshes(scene.atlas, folder, NULL); /* as `conus mesh` makes them */
    status = status ? status : conus_atlas_load(&surfaces, folder, NULL);
    status = status ? status : conus_selector_create(&surface, surfaces, &held);
#if CONUS_EMBREE
    struct engine *engine = NULL;
    status = status ? status : bare_embree_create(&engine, surfaces);
    status = status ? status : create_with(&bare, surfaces, &held, engine);
#endif
    const struct way ways[WAYS] = {{"surfaces, rays, batch, 1 thread", surface, NULL, 1, false, false},
                                   {"surfaces, rays, batch, 2 threads", surface, surface, 2, false, false},
                                   {"volume, rays, batch, 1 thread", scene.selector, NULL, 1, false, false},
                                   {"surfaces, rays, no rows", surface, NULL, 1, false, true},
                                   {"surfaces, bare Embree, no rows", bare, surface, 1, false, true}};
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", conus_selector_engine(surface));
        status = measure_ways(bench, "batch_mesh", &scene, ways, bare ? WAYS : BARE, v);
    }
    status = status || !bare ? status : bench_ratio(bench, "mesh_over_embree", &v[TRACE], &v[BARE]);
    status = status ? status : bench_value(bench, "batch_mesh_cones_per_s", 1000 / v[TWO].median_ms, v[TWO].equal);
    conus_selector_destroy(surface);
    conus_selector_destroy(bare);
    conus_atlas_destroy(surfaces);
    scene_finish(&scene);
    return status;
}
