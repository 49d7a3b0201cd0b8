/* SPDX-License-Identifier: BSD-3-Clause */
/* Answers many cones with one engine, compares the answers, and makes the cones. */
#include "bench/support/trace.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "tests/support/oracle_traversal.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

conus_status trace_init(struct trace *out, struct engine *engine, const struct cone *cones, size_t count)
{
    *out = (struct trace){.engine = engine, .cones = cones, .count = count};
    snprintf(out->name, sizeof out->name, "%s", engine->name);
    out->answers = memory_zeroed(count, sizeof *out->answers);
    conus_status status = out->answers ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status || !count ? status : evidence_init(&out->scratch, cones[0].resolution);
    for (size_t i = 0; i < count && !status; i++) {
        status = evidence_init(&out->answers[i], cones[i].resolution);
        status = status ? status : engine->functions->trace(engine, &out->answers[i], &cones[i]);
    }
    return status;
}

conus_status trace_init_firsts(struct trace *out, struct engine *engine, const struct cone *cones, size_t count)
{
    struct layers layers = {0};
    conus_status status = trace_init(out, engine, cones, count);
    for (size_t i = 0; i < count && !status; i++) {
        layers_clear(&layers);
        status = engine->functions->pierce(engine, &layers, &cones[i]);
        status = status ? status : layers_sort(&layers, (size_t)cones[i].resolution * cones[i].resolution);
        (void)layers_first(&out->answers[i], &layers);
    }
    layers_finish(&layers);
    return status;
}

void trace_finish(struct trace *trace)
{
    for (size_t i = 0; trace->answers && i < trace->count; i++) {
        evidence_finish(&trace->answers[i]);
    }
    evidence_finish(&trace->scratch);
    memory_free(trace->answers);
    *trace = (struct trace){0};
}

void trace_all(void *data)
{
    struct trace *trace = data;
    for (size_t i = 0; i < trace->count; i++) {
        conus_status status = trace->engine->functions->trace(trace->engine, &trace->scratch, &trace->cones[i]);
        trace->status = trace->status ? trace->status : status;
    }
}

static size_t pixels_of(const struct evidence *answer)
{
    return (size_t)answer->resolution * answer->resolution;
}

size_t trace_pixels(const struct trace *trace)
{
    size_t pixels = 0;
    for (size_t i = 0; i < trace->count; i++) {
        pixels += pixels_of(&trace->answers[i]);
    }
    return pixels;
}

bool trace_same(const struct trace *a, const struct trace *b)
{
    bool same = !a->status && !b->status;
    for (size_t i = 0; i < a->count && same; i++) {
        const struct evidence *x = &a->answers[i];
        const struct evidence *y = &b->answers[i];
        size_t pixels = pixels_of(x);
        same = memcmp(x->object, y->object, pixels * sizeof *x->object) == 0 &&
               memcmp(x->voxel, y->voxel, pixels * sizeof *x->voxel) == 0 &&
               memcmp(x->distance, y->distance, pixels * sizeof *x->distance) == 0;
    }
    return same;
}

size_t trace_differences(const struct trace *a, const struct trace *b)
{
    size_t differences = 0;
    for (size_t i = 0; i < a->count; i++) {
        for (size_t pixel = 0; pixel < pixels_of(&a->answers[i]); pixel++) {
            differences += a->answers[i].object[pixel] != b->answers[i].object[pixel];
        }
    }
    return differences;
}

/* Pixels by which a driver's vertex grid may move an edge. */
#define EDGE_PIXELS (1 / 128.0)

/* Whether a ray within EDGE_PIXELS of the pixel's centre hits the object: tries the nine rays of a tiny cone around
 * it. */
static bool is_near(struct engine *rays, const struct cone *cone, uint32_t pixel, uint32_t object)
{
    struct cone tiny = {.resolution = 3};
    struct evidence evidence;
    double direction[3];
    bool found = false;
    cone_ray(direction, cone, pixel % cone->resolution, pixel / cone->resolution);
    double foreshortening = -vec3_dot(direction, cone->pose.world_from_device + 8);
    double step = EDGE_PIXELS * 2 * tan(cone->angle / 2) / cone->resolution * foreshortening;
    tiny.angle = 2 * atan(1.5 * step);
    if (!conus_pose_along(&tiny.pose, cone->pose.world_from_device + 12, direction, NULL) &&
        !evidence_init(&evidence, tiny.resolution)) {
        if (!rays->functions->trace(rays, &evidence, &tiny)) {
            for (int i = 0; i < 9; i++) {
                found = found || evidence.object[i] == object;
            }
        }
        evidence_finish(&evidence);
    }
    return found;
}

bool trace_same_but_edges(const struct trace *trace, const struct trace *rays)
{
    size_t at_edges = 0, elsewhere = 0;
    for (size_t i = 0; i < trace->count; i++) {
        const uint32_t *named = trace->answers[i].object, *hits = rays->answers[i].object;
        for (uint32_t pixel = 0; pixel < pixels_of(&trace->answers[i]); pixel++) {
            if (named[pixel] != hits[pixel]) {
                bool near = is_near(rays->engine, &trace->cones[i], pixel, named[pixel]);
                at_edges += near;
                elsewhere += !near;
            }
        }
    }
    if (at_edges || elsewhere) {
        printf("%s: %zu of %zu pixels differ from the rays' at edges, %zu elsewhere\n", trace->name, at_edges,
               trace_pixels(trace), elsewhere);
    }
    return !elsewhere && !trace->status;
}

void shoot(void *data)
{
    struct shot *shot = data;
    struct trace *trace = shot->trace;
    conus_status status = shot->draw(shot->scene, shot->way);
    if (trace && !status) {
        status =
            trace->engine->functions->trace(trace->engine, &trace->scratch, &trace->cones[shot->next++ % trace->count]);
    }
    status = status ? status : shot->wait(shot->scene);
    shot->status = shot->status ? shot->status : status;
}

struct plain_engine {
    struct engine base;
    const conus_atlas *atlas;
};

static conus_status trace_plainly(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    oracle_trace(out, ((struct plain_engine *)engine)->atlas, cone);
    return CONUS_OK;
}

static void destroy(struct engine *engine)
{
    memory_free(engine);
}

conus_status plain_engine_create(struct engine **out, const conus_atlas *atlas)
{
    static const struct engine_functions functions = {.trace = trace_plainly, .destroy = destroy};
    struct plain_engine *engine = memory_zeroed(1, sizeof *engine);
    if (!engine) {
        return CONUS_ERROR_MEMORY;
    }
    *engine = (struct plain_engine){{&functions, "plain scalar traversal"}, atlas};
    *out = &engine->base;
    return CONUS_OK;
}

struct mesh_engine {
    struct engine base;
    struct mesh_rays *rays;
    unsigned width;
};

/* Pixels in tiles of 4 x 4, as the rays engine takes them, where the resolution allows it. */
static uint32_t pixel_of(uint32_t ray, uint32_t n)
{
    uint32_t tile = ray / 16, tiles = n / 4;
    uint32_t row = tile / (tiles ? tiles : 1) * 4 + ray % 16 / 4, column = tile % (tiles ? tiles : 1) * 4 + ray % 4;
    return n % 4 ? ray : row * n + column;
}

static conus_status trace_meshes(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    struct mesh_engine *own = (struct mesh_engine *)engine;
    double u[MESH_RAYS_LIMIT], v[MESH_RAYS_LIMIT], direction[3][MESH_RAYS_LIMIT];
    uint32_t n = cone->resolution;
    struct mesh_bundle bundle = {.count = (size_t)n * n, .origin = cone->pose.world_from_device + 12};
    assert(bundle.count <= MESH_RAYS_LIMIT);
    bundle.direction = (const double(*)[MESH_RAYS_LIMIT])direction;
    for (uint32_t ray = 0; ray < bundle.count; ray++) {
        u[ray] = cone_coordinate(pixel_of(ray, n) % n, n);
        v[ray] = cone_coordinate(pixel_of(ray, n) / n, n);
        bundle.t[ray] = INFINITY;
    }
    double *const axes[3] = {direction[0], direction[1], direction[2]};
    cone_rays(axes, cone, u, v, bundle.count);
    unsigned width = own->width ? own->width : mesh_rays_width(own->rays, bundle.origin, cone->angle / n);
    conus_status status = mesh_rays_trace(own->rays, &bundle, width);
    for (uint32_t ray = 0; ray < bundle.count; ray++) {
        uint32_t pixel = pixel_of(ray, n);
        out->object[pixel] = bundle.object[ray];
        out->distance[pixel] = bundle.t[ray];
        out->voxel[pixel] = bundle.triangle[ray];
    }
    return status;
}

conus_status mesh_engine_create(struct engine **out, struct mesh_rays *rays, unsigned width)
{
    static const struct engine_functions functions = {.trace = trace_meshes, .destroy = destroy};
    struct mesh_engine *engine = memory_zeroed(1, sizeof *engine);
    if (!engine) {
        return CONUS_ERROR_MEMORY;
    }
    *engine = (struct mesh_engine){{&functions, "1 or 16 by rule"}, rays, width};
    if (width) {
        snprintf(engine->base.name, sizeof engine->base.name, "%u ray%s at once", width, width > 1 ? "s" : "");
    }
    *out = &engine->base;
    return CONUS_OK;
}

void cones_round_grid(struct cone *out, size_t count, const conus_volume_info *info, double angle_deg, uint64_t seed)
{
    double middle[3], edge[3][3];
    for (int a = 0; a < 3; a++) {
        middle[a] = 0.5 * (double)(info->dim[a] - 1);
        vec3_scale(edge[a], info->world_from_voxel + 4 * a, (double)info->dim[a]);
    }
    mat4_point(middle, info->world_from_voxel, middle);
    for (size_t i = 0; i < count; i++) {
        double from[3], target[3];
        memcpy(target, middle, sizeof target);
        for (int a = 0; a < 3; a++) {
            vec3_add_scaled(target, target, bench_random(&seed, -0.25, 0.25), edge[a]);
        }
        double z = bench_random(&seed, -1, 1);
        double turn = bench_random(&seed, 0, 2 * MATH3_PI);
        const double outward[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
        vec3_add_scaled(from, middle, bench_random(&seed, 200, 300), outward);
        out[i] = (struct cone){.angle = radians_from_degrees(angle_deg), .resolution = BENCH_RESOLUTION};
        out[i].slope = cone_slope(&out[i]); /* which a selector finds once for all its poses */
        conus_status status = conus_pose_toward(&out[i].pose, from, target, NULL);
        assert(!status);
        (void)status;
    }
}

conus_status contest_load(struct contest *out, const char *path, size_t count, double angle_deg, uint64_t seed)
{
    *out = (struct contest){.cone_count = count};
    conus_status status = bench_load_labels(&out->atlas, path);
    out->cones = status ? NULL : memory_zeroed(count, sizeof *out->cones);
    if (!out->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    cones_round_grid(out->cones, count, &atlas_parcellation(out->atlas)->info, angle_deg, seed);
    return CONUS_OK;
}

conus_status contest_add(struct contest *contest, struct engine *engine, const char *name)
{
    size_t i = contest->count++;
    assert(i < CONTEST_LIMIT);
    contest->engines[i] = engine;
    conus_status status = trace_init(&contest->traces[i], engine, contest->cones, contest->cone_count);
    snprintf(contest->traces[i].name, sizeof contest->traces[i].name, "%s", name);
    return status;
}

struct bench_variant contest_variant(struct contest *contest, size_t index)
{
    struct trace *trace = &contest->traces[index];
    return (struct bench_variant){.name = trace->name, .run = trace_all, .data = trace};
}

void contest_finish(struct contest *contest)
{
    for (size_t i = 0; i < contest->count; i++) {
        trace_finish(&contest->traces[i]);
        engine_destroy(contest->engines[i]);
    }
    memory_free(contest->cones);
    conus_atlas_destroy(contest->atlas);
    *contest = (struct contest){0};
}
