/* SPDX-License-Identifier: BSD-3-Clause */
/* Whole batches: poses as text in, rows as text out. */
#include "bench/support/program.h"
#include "bench/support/trace.h"

#include "base/buffer.h"
#include "base/geometry/math3.h"
#include "conus/batch.h"
#include "conus/mesh.h"
#include "selection/engine/engine_rays.h"
#include "selection/selection.h"
#include "selection/selector.h"
#include "tests/support/oracle_traversal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { NO_ROWS, PLAIN, RAYS, RAYS_2, GL_ALONE, GL_BLOCKS, VARIANTS };

struct scene {
    conus_atlas *atlas;
    conus_selector *selector; /* of the rays engine   */
    conus_selector *plain;    /* of plain_engine      */
    conus_selector *gl;       /* NULL where there is no OpenGL */
    double angle;             /* radians              */
    char path[96];            /* of the poses         */
    conus_atlas *surfaces;    /* made of the atlas's areas, where they are asked for */
    conus_selector *surface;
};

struct contender {
    const struct scene *scene;
    conus_batch *batch; /* NULL = only the plain traversal */
    conus_pose_list *list;
    struct buffer rows;
    conus_status status;
};

/* A selector that takes over `engine` in the place of its own. */
static conus_status create_with(conus_selector **out, const conus_atlas *atlas, conus_layers layers,
                                struct engine *engine)
{
    conus_status status = conus_selector_create(out, atlas, &(conus_selector_options){.layers = layers});
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
        snprintf(scene->path, sizeof scene->path, "%s/poses-%ld.tsv", bench->folder, (long)getpid());
        status = program_write_poses(scene->path, bench->options.poses, &scene->atlas->volumes[0].info,
                                     bench->options.angle);
    }
    status = status ? status : conus_selector_create(&scene->selector, scene->atlas, NULL);
    scene->angle = radians_from_degrees(bench->options.angle);
    return status;
}

static void scene_finish(struct scene *scene)
{
    if (scene->path[0]) {
        unlink(scene->path);
    }
    conus_selector_destroy(scene->plain);
    conus_selector_destroy(scene->gl);
    conus_selector_destroy(scene->selector);
    conus_selector_destroy(scene->surface);
    conus_atlas_destroy(scene->surfaces);
    conus_atlas_destroy(scene->atlas);
}

static bool keep_rows(void *user, const conus_batch_block *block)
{
    struct contender *contender = user;
    buffer_append(&contender->rows, block->text, block->size);
    return true;
}

/* Nothing but the evidence. */
static conus_status trace_all_plainly(const struct contender *contender)
{
    struct evidence evidence;
    conus_status status = evidence_init(&evidence, 16);
    for (size_t i = 0; i < conus_pose_list_count(contender->list) && !status; i++) {
        struct cone cone = {
            .pose = conus_pose_list_row(contender->list, i)->pose, .angle = contender->scene->angle, .resolution = 16};
        oracle_trace(&evidence, contender->scene->atlas, &cone);
    }
    evidence_finish(&evidence);
    return status;
}

static void run_contender(void *data)
{
    struct contender *contender = data;
    conus_pose_stream *poses = NULL;
    conus_status status;
    if (contender->batch) {
        buffer_clear(&contender->rows);
        status = conus_pose_stream_open(&poses, contender->scene->path, NULL);
        status = status ? status : conus_batch_run(contender->batch, poses, UINT64_MAX, keep_rows, contender);
        conus_pose_stream_destroy(poses);
    } else {
        status = trace_all_plainly(contender);
    }
    contender->status = status ? status : contender->status;
}

static conus_status add_speed(struct bench *bench, const char *key, const struct bench_variant *variant)
{
    return bench_value(bench, key, 1000 / variant->median_ms, variant->equal);
}

/* One way to answer the poses. */
struct way {
    const char *name;
    conus_selector *selector; /* NULL = only the plain traversal, without rows */
    uint32_t threads;
    bool one_by_one;      /* not in blocks of cones */
    bool other_by_design; /* rows that are not the others' */
};

/* Answers once by each of @p ways, compares the rows with those of way number @p reference, and measures. */
static conus_status measure_ways(struct bench *bench, const char *scenario, const struct scene *scene,
                                 const struct way *ways, size_t count, size_t reference, struct bench_variant *variants)
{
    struct contender contenders[VARIANTS] = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        const conus_batch_options options = {.threads = ways[i].threads,
                                             .block = ways[i].one_by_one,
                                             .angle = scene->angle,
                                             .report = {.format = CONUS_FORMAT_TSV, .no_voxels = true}};
        contenders[i].scene = scene;
        status = ways[i].selector ? conus_batch_create(&contenders[i].batch, ways[i].selector, &options)
                                  : conus_pose_list_load(&contenders[i].list, scene->path, NULL);
        if (!status) {
            run_contender(&contenders[i]);
        }
    }
    for (size_t i = 0; i < count && !status; i++) {
        variants[i] = (struct bench_variant){.name = ways[i].name, .run = run_contender, .data = &contenders[i]};
        variants[i].other_by_design = ways[i].other_by_design;
        const struct buffer *rows = &contenders[i].rows, *wanted = &contenders[reference].rows;
        variants[i].equal =
            !contenders[i].status &&
            (!ways[i].selector || (rows->size == wanted->size && memcmp(rows->data, wanted->data, wanted->size) == 0));
    }
    status =
        status ? status : bench_measure(bench, scenario, variants, count, bench->options.poses, bench->options.angle);
    for (size_t i = 0; i < count; i++) {
        conus_batch_destroy(contenders[i].batch);
        conus_pose_list_destroy(contenders[i].list);
        buffer_finish(&contenders[i].rows);
    }
    return status;
}

conus_status bench_batch(struct bench *bench)
{
    const conus_selector_options by_gl = {.engine = CONUS_ENGINE_GL};
    struct scene scene = {0};
    struct engine *plain = NULL;
    struct bench_variant v[VARIANTS];
    conus_status status = make_scene(&scene, bench);
    status = status ? status : plain_engine_create(&plain, scene.atlas);
    status = status ? status : create_with(&scene.plain, scene.atlas, CONUS_LAYERS_VISIBLE, plain);
    status = status ? status : conus_selector_create(&scene.gl, scene.atlas, &by_gl);
    status = status == CONUS_ERROR_GL ? bench_leave_out(bench, "batches by OpenGL") : status;
    const struct way ways[VARIANTS] = {{"plain scalar traversal, no rows", NULL, 1, false, false},
                                       {"plain scalar traversal, batch", scene.plain, 1, false, false},
                                       {"rays, batch, 1 thread", scene.selector, 1, false, false},
                                       {"rays, batch, 2 threads", scene.selector, 2, false, false},
                                       {"gl, batch, one cone at a time", scene.gl, 1, true, false},
                                       {"gl, batch, blocks of 256 cones", scene.gl, 1, false, false}};
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s; %s", conus_selector_engine(scene.selector),
                 conus_selector_engine(scene.gl));
        status = measure_ways(bench, "batch", &scene, ways, scene.gl ? VARIANTS : GL_ALONE, PLAIN, v);
    }
    status = status ? status : bench_ratio(bench, "plain_over_batch", &v[NO_ROWS], &v[RAYS]);
    status = status ? status : bench_ratio(bench, "batch_one_over_two_threads", &v[RAYS], &v[RAYS_2]);
    status = status || !scene.gl ? status : bench_ratio(bench, "gl_one_over_block", &v[GL_ALONE], &v[GL_BLOCKS]);
    status = status ? status : add_speed(bench, "batch_cones_per_s", &v[RAYS_2]);
    scene_finish(&scene);
    return status;
}

conus_status bench_batch_layers(struct bench *bench)
{
    enum { SINGLE_RAYS, ALL, VISIBLE, WAYS };
    const conus_selector_options all = {.layers = CONUS_LAYERS_ALL};
    struct scene scene = {0};
    struct bench_variant v[WAYS];
    struct engine *scalar = NULL; /* lists intervals ray by ray, without a kernel */
    conus_selector *single = NULL, *layers = NULL;
    size_t last = 0;
    while (traverse_kernel(last + 1)) {
        last++;
    }
    conus_status status = make_scene(&scene, bench);
    status = status ? status
                    : engine_rays_create_with(&scalar, scene.atlas, &(struct engine_options){0}, traverse_kernel(last));
    status = status ? status : create_with(&single, scene.atlas, CONUS_LAYERS_ALL, scalar);
    status = status ? status : conus_selector_create(&layers, scene.atlas, &all);
    const struct way ways[WAYS] = {{"all layers, ray by ray, batch, 1 thread", single, 1, false, false},
                                   {"all layers, batch, 1 thread", layers, 1, false, false},
                                   {"first hits, batch, 1 thread", scene.selector, 1, false, true}};
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", conus_selector_engine(layers));
        status = measure_ways(bench, "batch_layers", &scene, ways, WAYS, SINGLE_RAYS, v);
    }
    status = status
                 ? status
                 : bench_value(bench, "layers_over_visible_aal", v[ALL].median_ms / v[VISIBLE].median_ms, v[ALL].equal);
    conus_selector_destroy(single);
    conus_selector_destroy(layers);
    scene_finish(&scene);
    return status;
}

conus_status bench_batch_mesh(struct bench *bench)
{
    enum { ONE, TWO, VOLUME, WAYS };
    char folder[96], program[320];
    struct scene scene = {0};
    struct bench_variant v[WAYS];
    conus_status status = make_scene(&scene, bench);
    if (program_find(program, sizeof program, "conus-mesh", "CONUS_MESH") == CONUS_OK) {
        setenv("CONUS_MESH", program, 0);
    }
    setenv("XDG_CACHE_HOME", bench->folder, 1);
    snprintf(folder, sizeof folder, "%s/surfaces", bench->folder);
    status = status ? status : conus_atlas_write_meshes(scene.atlas, folder, NULL); /* as `conus mesh` makes them */
    status = status ? status : conus_atlas_load(&scene.surfaces, folder, NULL);
    status = status ? status : conus_selector_create(&scene.surface, scene.surfaces, NULL);
    const struct way ways[WAYS] = {{"surfaces, rays, batch, 1 thread", scene.surface, 1, false, false},
                                   {"surfaces, rays, batch, 2 threads", scene.surface, 2, false, false},
                                   /* surfaces cut corners */
                                   {"volume, rays, batch, 1 thread", scene.selector, 1, false, true}};
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", conus_selector_engine(scene.surface));
        status = measure_ways(bench, "batch_mesh", &scene, ways, WAYS, ONE, v);
    }
    status = status ? status : add_speed(bench, "batch_mesh_cones_per_s", &v[TWO]);
    scene_finish(&scene);
    return status;
}
