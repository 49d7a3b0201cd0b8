/* SPDX-License-Identifier: BSD-3-Clause */
/* Whole batches: poses as text in, rows as text out. */
#include "apps/bench/bench.h"

#include "base/buffer.h"
#include "base/file.h"
#include "base/math3.h"
#include "base/memory.h"
#include "selection/selection.h"
#include "tests/oracle_traversal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SEED = 2010 };
enum { NO_ROWS, PLAIN, RAYS, RAYS_2, GL_ALONE, GL_BLOCKS, VARIANTS };

struct scene {
    conus_atlas *atlas;
    conus_selector *selector; /* of the rays engine   */
    conus_selector *plain;    /* of plain_engine      */
    conus_selector *gl;       /* NULL where there is no OpenGL */
    double angle;             /* radians              */
    char path[32];            /* of the poses         */
};

struct contender {
    const struct scene *scene;
    conus_batch *batch; /* NULL = only the plain traversal */
    conus_pose_list *list;
    struct buffer rows;
    conus_status status;
};

/* ---- The scene ----------------------------------------------------------------------------------------------------
 */

/* Round the head, 200 to 300 mm from its middle, aiming at points of its inner half, as in the scenario "volume". */
static conus_status write_poses(struct scene *scene, size_t count)
{
    const conus_volume_info *info = &scene->atlas->volumes[0].info;
    struct buffer text = {0};
    uint64_t random = SEED;
    buffer_text(&text, "x\ty\tz\ttx\tty\ttz\n");
    for (size_t i = 0; i < count; i++) {
        double centre[3], from[3], target[3];
        for (int a = 0; a < 3; a++) {
            centre[a] = 0.5 * (double)(info->dim[a] - 1);
            target[a] = centre[a] + bench_random(&random, -0.25, 0.25) * (double)info->dim[a];
        }
        mat4_point(centre, info->world_from_voxel, centre);
        mat4_point(target, info->world_from_voxel, target);
        double z = bench_random(&random, -1, 1);
        double turn = bench_random(&random, 0, 2 * MATH3_PI);
        const double outward[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
        vec3_add_scaled(from, centre, bench_random(&random, 200, 300), outward);
        buffer_format(&text, "%.3f\t%.3f\t%.3f\t%.3f\t%.3f\t%.3f\n", from[0], from[1], from[2], target[0], target[1],
                      target[2]);
    }
    snprintf(scene->path, sizeof scene->path, "bench-poses-%ld.tsv", (long)getpid());
    conus_status status = buffer_status(&text);
    status = status ? status : file_write_soon(scene->path, text.data, text.size);
    buffer_finish(&text);
    return status;
}

/* An engine that walks from cell to cell. */
struct plain_engine {
    struct engine base;
    const conus_atlas *atlas;
};

static conus_status look_plainly(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    oracle_look(out, ((struct plain_engine *)engine)->atlas, cone);
    return CONUS_OK;
}

static void destroy_plain(struct engine *engine)
{
    memory_free(engine);
}

/* The selector takes over the plain engine in the place of its own. */
static conus_status make_plain(struct scene *scene)
{
    static const struct engine_functions functions = {.look = look_plainly, .destroy = destroy_plain};
    conus_status status = conus_selector_create(&scene->plain, scene->atlas, NULL);
    struct plain_engine *engine = status ? NULL : memory_zeroed(1, sizeof *engine);
    if (!engine) {
        return CONUS_ERROR_MEMORY;
    }
    *engine = (struct plain_engine){{&functions, "plain"}, scene->atlas};
    engine_destroy(scene->plain->engine);
    scene->plain->engine = &engine->base;
    return CONUS_OK;
}

static conus_status make_scene(struct scene *scene, const struct bench_options *options)
{
    conus_status status = conus_atlas_load(&scene->atlas, options->atlas, NULL);
    status = status ? status : write_poses(scene, options->poses);
    status = status ? status : conus_selector_create(&scene->selector, scene->atlas, NULL);
    scene->angle = radians_from_degrees(options->angle);
    return status ? status : make_plain(scene);
}

static conus_status make_gl(struct scene *scene, struct bench *bench)
{
    const conus_selector_options options = {.engine = CONUS_ENGINE_GL};
    conus_status status = conus_selector_create(&scene->gl, scene->atlas, &options);
    return status == CONUS_ERROR_GL ? bench_leave_out(bench, "batches by OpenGL") : status;
}

static void scene_finish(struct scene *scene)
{
    if (scene->path[0]) {
        unlink(scene->path);
    }
    conus_selector_destroy(scene->plain);
    conus_selector_destroy(scene->gl);
    conus_selector_destroy(scene->selector);
    conus_atlas_destroy(scene->atlas);
}

/* ---- The contenders -----------------------------------------------------------------------------------------------
 */

static conus_status contender_init(struct contender *out, const struct scene *scene, int variant)
{
    conus_selector *const selectors[VARIANTS] = {NULL,      scene->plain, scene->selector, scene->selector,
                                                 scene->gl, scene->gl};
    const conus_batch_options options = {.threads = variant == RAYS_2 ? 2 : 1,
                                         .block = variant == GL_ALONE,
                                         .angle = scene->angle,
                                         .report = {.format = CONUS_TSV, .no_voxels = true}};
    out->scene = scene;
    return variant == NO_ROWS ? conus_pose_list_load(&out->list, scene->path, NULL)
                              : conus_batch_create(&out->batch, selectors[variant], &options);
}

static void contender_finish(struct contender *contender)
{
    conus_batch_destroy(contender->batch);
    conus_pose_list_destroy(contender->list);
    buffer_finish(&contender->rows);
}

static bool keep_rows(void *user, const conus_batch_block *block)
{
    struct contender *contender = user;
    buffer_append(&contender->rows, block->text, block->size);
    return true;
}

/* Nothing but the evidence. */
static conus_status look_at_all(const struct contender *contender)
{
    struct evidence evidence;
    conus_status status = evidence_init(&evidence, 16);
    for (size_t i = 0; i < conus_pose_list_count(contender->list) && !status; i++) {
        struct cone cone = {
            .pose = conus_pose_list_row(contender->list, i)->pose, .angle = contender->scene->angle, .resolution = 16};
        oracle_look(&evidence, contender->scene->atlas, &cone);
    }
    evidence_finish(&evidence);
    return status;
}

static conus_status answer_all(struct contender *contender)
{
    conus_pose_stream *poses = NULL;
    buffer_clear(&contender->rows);
    conus_status status = conus_pose_stream_open(&poses, contender->scene->path, NULL);
    status = status ? status : conus_batch_run(contender->batch, poses, UINT64_MAX, keep_rows, contender);
    conus_pose_stream_destroy(poses);
    return status;
}

static void run(void *data)
{
    struct contender *contender = data;
    conus_status status = contender->batch ? answer_all(contender) : look_at_all(contender);
    contender->status = status ? status : contender->status;
}

static bool gives_the_same(const struct contender *contender, const struct contender *reference)
{
    return !contender->status && contender->rows.size == reference->rows.size &&
           memcmp(contender->rows.data, reference->rows.data, reference->rows.size) == 0;
}

/* ---- Measuring ----------------------------------------------------------------------------------------------------
 */

static conus_status add_speed(struct bench *bench, const struct bench_variant *variant)
{
    double speed = 1000 / variant->median_ms;
    printf("batch_cones_per_s = %.0f (%s)\n", speed, variant->name);
    return json_object_set_new(bench->ratios, "batch_cones_per_s", variant->equal ? json_real(speed) : json_null())
               ? fail(CONUS_ERROR_MEMORY, "out of memory")
               : CONUS_OK;
}

static conus_status measure(struct bench *bench, struct contender *contenders, size_t count)
{
    static const char *const names[VARIANTS] = {"plain scalar traversal, no rows", "plain scalar traversal, batch",
                                                "rays, batch, 1 thread",           "rays, batch, 2 threads",
                                                "gl, batch, one cone at a time",   "gl, batch, blocks of 256 cones"};
    struct bench_variant variants[VARIANTS];
    for (size_t i = 0; i < count; i++) {
        run(&contenders[i]);
        bool same = i == 0 ? !contenders[0].status : gives_the_same(&contenders[i], &contenders[1]);
        variants[i] = (struct bench_variant){.name = names[i], .run = run, .data = &contenders[i], .equal = same};
    }
    conus_status status = bench_measure(bench, "batch", variants, count, bench->options.poses, bench->options.angle);
    status = status ? status : bench_ratio(bench, "plain_over_batch", &variants[NO_ROWS], &variants[RAYS]);
    status = status ? status : bench_ratio(bench, "batch_one_over_two_threads", &variants[RAYS], &variants[RAYS_2]);
    if (!status && count > GL_BLOCKS) {
        status = bench_ratio(bench, "gl_one_over_block", &variants[GL_ALONE], &variants[GL_BLOCKS]);
    }
    return status ? status : add_speed(bench, &variants[RAYS_2]);
}

conus_status bench_batch(struct bench *bench)
{
    struct scene scene = {0};
    struct contender contenders[VARIANTS] = {0};
    conus_status status = make_scene(&scene, &bench->options);
    status = status ? status : make_gl(&scene, bench);
    size_t count = scene.gl ? VARIANTS : GL_ALONE;
    for (size_t i = 0; i < count && !status; i++) {
        status = contender_init(&contenders[i], &scene, (int)i);
    }
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s; %s", conus_selector_engine(scene.selector),
                 conus_selector_engine(scene.gl));
        status = measure(bench, contenders, count);
    }
    for (size_t i = 0; i < VARIANTS; i++) {
        contender_finish(&contenders[i]);
    }
    scene_finish(&scene);
    return status;
}
