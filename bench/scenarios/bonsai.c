/* SPDX-License-Identifier: BSD-3-Clause */
/* The paper's second experiment: frames with 1 to 45 copies of a volume of 256^3 bytes, blended in 362 slices, without
 * and with a selection by 72 slices in each; against ray casting that skips empty space, and exact selection. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/support/bench.h"
#include "bench/support/frame.h"
#include "bench/support/trace.h"
#include "render/colour/colour.h"
#include "render/colour/colour_gl.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { CONES = 4, SEED = 45, CHECK_EDGE = 48 };

/* Memory of each copy, in both engines with slices and without, on a driver that has textures in memory, too. */
enum { BYTES_PER_VOXEL = 8 };

/* Distance from copy to copy, in edges of one. */
#define SPACING 1.1

/* The most by which pictures may differ (rms, white is 1): one step of the 8 bits in which slices are blended. */
#define PICTURE_RMS_LIMIT (1 / 255.0)

/* Ways to select. The CPU's slices are here because GL's slices are compared with them. */
enum { GL_SLICES, GL_EXACT, RAYS_EXACT, RAYS_SLICES, ENGINES };

/* Ways to draw. */
enum { SLICED, ALL_SAMPLES, SKIPPING, PICTURES };

struct scene {
    const struct bonsai *bonsai;
    size_t copies;
    double (*places)[3]; /* [copies] of their middles, farthest from the camera first */
    conus_atlas *one;    /* a context: the volume that is drawn at each place */
    conus_renderer *renderer;
    struct gl_current previous;
    bool is_current; /* the renderer's context; what was current before it is `previous` */
    struct camera camera;
    struct colour_view view;
    struct frame frame;
    struct colour_volume at_home; /* the renderer's context */
    struct slicing slicing;
    conus_atlas *atlas; /* a pathway for each copy: the atlas that is selected from */
    struct engine *engines[ENGINES];
    struct cone cones[CONES];
    struct trace traces[ENGINES];
};

/* Leaves, wood and pot, by their values in the paper's volume. */
static const conus_transfer_point transfer[] = {
    {0, {0, 0, 0, 0}},           {BONSAI_AIR, {0, 0, 0, 0}},   {BONSAI_AIR + 4, {0.15, 0.45, 0.1, 0.15}},
    {60, {0.3, 0.6, 0.15, 0.4}}, {90, {0.45, 0.3, 0.15, 0.5}}, {150, {0.6, 0.4, 0.2, 0.8}},
    {200, {0.6, 0.6, 0.65, 1}},  {255, {0.9, 0.9, 0.9, 1}}};

/* Moves the context to `place`. */
static void move_to(struct scene *scene, const double place[3])
{
    struct colour_volume *context = &scene->renderer->colour.context;
    double back[16];
    *context = scene->at_home;
    for (int a = 0; a < 3; a++) {
        context->world_from_voxel[12 + a] += place[a];
    }
    mat4_identity(back);
    vec3_scale(back + 12, place, -1);
    mat4_multiply(context->texture_from_world, scene->at_home.texture_from_world, back);
}

/* Limits drawing to the pixels of the copy's box; a box that reaches behind the camera takes the whole frame. */
static void limit_to(const struct scene *scene, const double place[3])
{
    const struct camera_frame whole = {scene->view.width, scene->view.height, 0, 0, 0, 0};
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int n = 0; n < 8; n++) {
        double p[3], at[2], depth;
        for (int a = 0; a < 3; a++) {
            p[a] = place[a] + (n >> a & 1 ? 0.5 : -0.5) * (double)scene->bonsai->edge;
        }
        if (!camera_project(&at[0], &at[1], &depth, &scene->camera, &whole, p)) {
            return;
        }
        at[1] = scene->view.height - at[1]; /* from below */
        for (int a = 0; a < 2; a++) {
            low[a] = fmin(low[a], floor(at[a]) - 1);
            high[a] = fmax(high[a], ceil(at[a]) + 1);
        }
    }
    low[0] = fmax(low[0], 0);
    low[1] = fmax(low[1], 0);
    glScissor((GLint)low[0], (GLint)low[1], (GLsizei)fmax(high[0] - low[0], 0), (GLsizei)fmax(high[1] - low[1], 0));
    glEnable(GL_SCISSOR_TEST);
}

static conus_status draw_frame(void *data, int way)
{
    struct scene *scene = data;
    struct colour_pass *pass = &scene->renderer->colour;
    struct colour_view view = scene->view;
    conus_status status = CONUS_OK;
    view.no_skipping = way == ALL_SAMPLES;
    frame_begin(&scene->frame, false);
    for (size_t i = 0; i < scene->copies && !status; i++) {
        move_to(scene, scene->places[i]);
        limit_to(scene, scene->places[i]);
        if (way == SLICED) {
            slicing_draw(&scene->slicing, pass, &view);
        } else {
            glEnable(GL_BLEND);
            glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
            status = colour_gl_draw(pass, &view);
        }
    }
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
    glFlush();
    return status;
}

static conus_status wait_for(void *scene)
{
    (void)scene;
    glFinish();
    return gl_check("bonsai");
}

/* Places copies on a cubic grid around the world's origin. */
static conus_status make_places(struct scene *scene)
{
    size_t edge = (size_t)ceil(cbrt((double)scene->copies) - 1e-9);
    size_t layers = (scene->copies + edge * edge - 1) / (edge * edge);
    const size_t size[3] = {edge, edge, layers};
    scene->places = memory_raw(scene->copies, sizeof *scene->places);
    for (size_t i = 0; scene->places && i < scene->copies; i++) {
        const size_t at[3] = {i % edge, i / edge % edge, i / edge / edge};
        for (int a = 0; a < 3; a++) {
            double place = (double)at[a] - 0.5 * (double)(size[a] - 1);
            scene->places[i][a] = place * SPACING * (double)scene->bonsai->edge;
        }
    }
    return scene->places ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status make_renderer(struct scene *scene)
{
    static const double origin[3] = {0, 0, 0};
    conus_volume_info info;
    bonsai_info(&info, scene->bonsai, origin, 0);
    float *values = bonsai_values(scene->bonsai);
    conus_status status = values ? atlas_create_empty(&scene->one, "bonsai") : CONUS_ERROR_MEMORY;
    status = status ? status : atlas_set_context(scene->one, &info, values);
    if (status) {
        memory_free(values);
        return status;
    }
    status = conus_renderer_create(&scene->renderer, scene->one, NULL);
    return status ? status : conus_renderer_set_transfer(scene->renderer, transfer, sizeof transfer / sizeof *transfer);
}

static double depth_of(const struct scene *scene, const double place[3])
{
    double from[3];
    vec3_sub(from, place, scene->camera.world_from_camera + 12);
    return -vec3_dot(from, scene->camera.world_from_camera + 8);
}

/* Sorts the places farthest first, as blending needs it. */
static void sort_places(struct scene *scene)
{
    for (size_t i = 1; i < scene->copies; i++) {
        for (size_t k = i; k > 0 && depth_of(scene, scene->places[k]) > depth_of(scene, scene->places[k - 1]); k--) {
            double swap[3];
            memcpy(swap, scene->places[k], sizeof swap);
            memcpy(scene->places[k], scene->places[k - 1], sizeof swap);
            memcpy(scene->places[k - 1], swap, sizeof swap);
        }
    }
}

static conus_status aim_camera(struct scene *scene, const struct bench_options *options)
{
    uint32_t size[2];
    double(*corners)[3] = memory_raw(8 * scene->copies, sizeof *corners);
    if (!corners) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t n = 0; n < 8 * scene->copies; n++) {
        for (int a = 0; a < 3; a++) {
            corners[n][a] = scene->places[n / 8][a] + ((n >> a & 1) ? 0.5 : -0.5) * (double)scene->bonsai->edge;
        }
    }
    frame_size(size, options->check);
    const struct camera_frame frame = {size[0], size[1], 0, 0, 0, 0};
    picture_aim(&scene->camera, &scene->view, &frame, (const double(*)[3])corners, 8 * scene->copies, options->slices);
    memory_free(corners);
    sort_places(scene);
    return CONUS_OK;
}

/* Cones begin at the camera and around it, and point at the copies' inner halves. */
static conus_status aim_cones(struct scene *scene, double angle_deg)
{
    uint64_t random = SEED;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < CONES && !status; i++) {
        const double *place = scene->places[(size_t)bench_random(&random, 0, (double)scene->copies)];
        double from[3], to[3];
        for (int a = 0; a < 3; a++) {
            double half = 0.25 * (double)scene->bonsai->edge;
            from[a] = scene->camera.world_from_camera[12 + a] + bench_random(&random, -half, half);
            to[a] = place[a] + bench_random(&random, -half, half);
        }
        scene->cones[i] = (struct cone){.angle = radians_from_degrees(angle_deg), .resolution = 16};
        status = conus_pose_toward(&scene->cones[i].pose, from, to, NULL);
    }
    return status;
}

static conus_status make_engines(struct scene *scene, const struct bench_options *options)
{
    static const char *const names[ENGINES] = {"gl, ", "gl, exact", "rays, exact", "rays, "};
    char planes[32];
    snprintf(planes, sizeof planes, "%zu slices", options->slices / 5);
    conus_status status = atlas_create_empty(&scene->atlas, "bonsai");
    for (size_t i = 0; i < scene->copies && !status; i++) {
        conus_volume_info info;
        char name[32];
        float *values = bonsai_values(scene->bonsai);
        bonsai_info(&info, scene->bonsai, scene->places[i], BONSAI_AIR + 1);
        snprintf(name, sizeof name, "copy %zu", i + 1);
        struct value_map map = {0};
        status = values ? value_map_of(&map, values, info.dim[0] * info.dim[1] * info.dim[2]) : CONUS_ERROR_MEMORY;
        status = status ? status : atlas_add_pathway(scene->atlas, &info, &map, name);
        value_map_finish(&map);
        memory_free(values);
    }
    status = status ? status : aim_cones(scene, options->angle);
    for (int e = 0; e < ENGINES && !status; e++) {
        bool is_gl = e == GL_SLICES || e == GL_EXACT;
        const struct engine_options how = {.sampling = e == GL_SLICES || e == RAYS_SLICES ? CONUS_SAMPLING_SLICES
                                                                                          : CONUS_SAMPLING_EXACT,
                                           .slices = (uint32_t)options->slices};
        status = is_gl ? engine_gl_create(&scene->engines[e], scene->atlas, &how)
                       : engine_rays_create(&scene->engines[e], scene->atlas, &how);
        status = status ? status : trace_init(&scene->traces[e], scene->engines[e], scene->cones, CONES);
        snprintf(scene->traces[e].name, sizeof scene->traces[e].name, "%zu copies, %s%s", scene->copies, names[e],
                 how.sampling == CONUS_SAMPLING_SLICES ? planes : "");
    }
    return status;
}

static conus_status scene_init(struct scene *scene, const struct bonsai *bonsai, size_t copies,
                               const struct bench_options *options)
{
    *scene = (struct scene){.bonsai = bonsai, .copies = copies};
    conus_status status = make_places(scene);
    status = status ? status : make_renderer(scene);
    status = status ? status : aim_camera(scene, options);
    status = status ? status : make_engines(scene, options);
    status = status ? status : gl_context_use(colour_gl_context(scene->renderer->colour.device), &scene->previous);
    scene->is_current = !status;
    status = status ? status : frame_resize(&scene->frame, (uint32_t[]){scene->view.width, scene->view.height});
    if (status) {
        return status;
    }
    scene->at_home = scene->renderer->colour.context;
    return slicing_init(&scene->slicing, scene->view.slices);
}

static void scene_finish(struct scene *scene)
{
    for (int e = 0; e < ENGINES; e++) {
        trace_finish(&scene->traces[e]);
        engine_destroy(scene->engines[e]);
    }
    if (scene->is_current) {
        slicing_finish(&scene->slicing);
        frame_finish(&scene->frame);
        gl_current_restore(&scene->previous);
    }
    conus_renderer_destroy(scene->renderer);
    conus_atlas_destroy(scene->one);
    conus_atlas_destroy(scene->atlas);
    memory_free(scene->places);
}

/* Whether rays give the same picture with and without skipping, and slices one that is nearly the same. */
static conus_status compare_pictures(bool equal[PICTURES], double *sliced_ms, struct scene *scene)
{
    float *pictures[PICTURES] = {NULL};
    size_t count = (size_t)scene->view.width * scene->view.height * 4;
    conus_status status = CONUS_OK;
    double start = bench_wall();
    for (int way = 0; way < PICTURES && !status; way++) {
        pictures[way] = memory_raw(count, sizeof *pictures[way]);
        status = pictures[way] ? draw_frame(scene, way) : CONUS_ERROR_MEMORY;
        status = status ? status : frame_read(&scene->frame, pictures[way]);
        *sliced_ms = way == SLICED ? 1e3 * (bench_wall() - start) : *sliced_ms;
    }
    if (!status) {
        double coverage = 0, rms = picture_rms(pictures[SLICED], pictures[ALL_SAMPLES], count / 4, 0, 3);
        status = frame_coverage(&coverage, &scene->frame);
        equal[SLICED] = equal[ALL_SAMPLES] = rms <= PICTURE_RMS_LIMIT && coverage >= FRAME_COVERAGE;
        equal[SKIPPING] =
            equal[ALL_SAMPLES] && memcmp(pictures[ALL_SAMPLES], pictures[SKIPPING], count * sizeof(float)) == 0;
        printf("%zu copies cover %.0f %% of a frame; slices and rays differ by %.5f rms of white (allowed %.4f)\n",
               scene->copies, 100 * coverage, rms, PICTURE_RMS_LIMIT);
    }
    for (int way = 0; way < PICTURES; way++) {
        memory_free(pictures[way]);
    }
    return status;
}

/* Selections alone; then frames, with a selection in some. The last two are left out where frames are slow. */
enum { TRACES = RAYS_SLICES, FRAMES = 6, SLOW_FRAMES = 4, VARIANTS = TRACES + FRAMES };
#define SLOW_MS 2000.0

static const struct {
    int way, trace;   /* trace: an engine, or -1 */
    const char *name; /* behind the number of slices, if they are SLICED */
} kinds[FRAMES] = {{SLICED, -1, " slices"},
                   {SKIPPING, -1, "rays, skipping"},
                   {SKIPPING, GL_EXACT, "rays, skipping, and gl, exact"},
                   {SKIPPING, RAYS_EXACT, "rays, skipping, and rays, exact"},
                   {SLICED, GL_SLICES, " slices and gl, a fifth of them"},
                   {ALL_SAMPLES, -1, "rays, all samples"}};

static conus_status measure_copies(struct bench *bench, struct scene *scene, struct bench_variant variants[VARIANTS])
{
    struct shot shots[FRAMES];
    char names[FRAMES][80];
    bool equal[PICTURES] = {false};
    double sliced_ms = 0;
    conus_status status = compare_pictures(equal, &sliced_ms, scene);
    size_t frames = sliced_ms > SLOW_MS ? SLOW_FRAMES : FRAMES;
    /* Slices are right if they equal the other engine's slices. The run says how often they name another object than
     * exact tracing. */
    struct trace *traces = scene->traces;
    for (int e = 0; e < TRACES; e++) {
        int like = e == GL_SLICES ? RAYS_SLICES : RAYS_EXACT;
        variants[e] =
            (struct bench_variant){.name = traces[e].name, .run = trace_all, .data = &traces[e], .per = CONES};
        variants[e].equal = trace_same(&traces[e], &traces[like]);
        variants[e].more =
            json_pack("{s:I, s:I}", "wrong_pixels", (json_int_t)trace_differences(&traces[e], &traces[RAYS_EXACT]),
                      "pixels", (json_int_t)trace_pixels(&traces[e]));
    }
    for (size_t f = 0; f < frames; f++) {
        struct trace *trace = kinds[f].trace < 0 ? NULL : &scene->traces[kinds[f].trace];
        shots[f] =
            (struct shot){.draw = draw_frame, .wait = wait_for, .scene = scene, .way = kinds[f].way, .trace = trace};
        char slices[16] = "";
        if (kinds[f].way == SLICED) {
            snprintf(slices, sizeof slices, "%u", scene->view.slices);
        }
        snprintf(names[f], sizeof names[f], "%zu copies, frame, %s%s", scene->copies, slices, kinds[f].name);
        variants[TRACES + f] =
            (struct bench_variant){.name = names[f], .run = shoot, .data = &shots[f], .equal = equal[kinds[f].way]};
    }
    size_t count = TRACES + frames;
    status = status ? status : bench_measure(bench, "bonsai", variants, count, 1, bench->options.angle);
    for (size_t f = 0; f < frames; f++) {
        status = status ? status : shots[f].status;
    }
    return status;
}

static conus_status run_copies(struct bench *bench, const struct bonsai *bonsai, size_t copies)
{
    struct scene scene;
    struct bench_variant v[VARIANTS];
    const struct {
        const char *key;
        int above, below;
    } ratios[] = {{"bonsai_slicing_over_skipping", TRACES, TRACES + 1},
                  {"bonsai_slices72_over_exact", GL_SLICES, GL_EXACT},
                  {"bonsai_slices72_over_rays", GL_SLICES, RAYS_EXACT}};
    conus_status status = scene_init(&scene, bonsai, copies, &bench->options);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "gl, %s; %s", conus_renderer_device(scene.renderer),
                 scene.engines[RAYS_EXACT]->name);
        status = measure_copies(bench, &scene, v);
    }
    for (size_t i = 0; i < sizeof ratios / sizeof *ratios && !status; i++) {
        char key[64];
        snprintf(key, sizeof key, "%s_%zu", ratios[i].key, copies);
        status = bench_ratio(bench, key, &v[ratios[i].above], &v[ratios[i].below]);
    }
    scene_finish(&scene);
    return status;
}

conus_status bench_bonsai(struct bench *bench)
{
    static const size_t counts[] = {1, 5, 15, 45};
    const char *path = bench->options.bonsai;
    size_t count = bench->options.check ? 2 : sizeof counts / sizeof *counts;
    struct bonsai bonsai = {0};
    conus_status status =
        path ? bonsai_read(&bonsai, path) : bonsai_make(&bonsai, bench->options.check ? CHECK_EDGE : BONSAI_EDGE);
    bench->note = bonsai.is_papers ? "the paper's volume" : "a stand-in for the paper's volume";
    printf("volume: %s\n", bench->note);
    for (size_t i = 0; i < count && !status; i++) {
        uint64_t needed = (uint64_t)BYTES_PER_VOXEL * counts[i] * bonsai.edge * bonsai.edge * bonsai.edge;
        uint64_t available = (uint64_t)sysconf(_SC_PHYS_PAGES) * (uint64_t)sysconf(_SC_PAGESIZE) / 4 * 3;
        char what[64];
        if (needed <= available) {
            status = run_copies(bench, &bonsai, counts[i]);
            continue;
        }
        snprintf(what, sizeof what, "bonsai, %zu copies", counts[i]);
        (void)fail(CONUS_ERROR_MEMORY, "it takes about %" PRIu64 " MiB of memory, three quarters are %" PRIu64,
                   needed >> 20, available >> 20);
        status = bench_leave_out(bench, what);
    }
    bonsai_finish(&bonsai);
    return status;
}
