/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene by VTK's selector, locators and picker, beside the rays engine. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/peers/peers.h"
#include "bench/support/bench.h"
#include "bench/support/trace.h"
#include "bench/torus/torus_scene.h"

#include <stdio.h>

enum { TORI = 20000, CONES = 4, ANGLE = 5 };

/* The ways to answer the cones. ACTORS is missing where there is no display. */
enum way { RAYS, RAYS_PLACED, CELL_LOCATOR, STATIC_LOCATOR, CELL_PICKER, ACTORS, WAYS };

struct scene {
    struct torus_scene tori;
    struct mesh_object *placed; /* [tori.count] one torus at all places */
    struct mesh_object *areas;  /* [tori.count] the atlas's, with triangles of their own */
    conus_atlas *atlas;
    struct mesh_rays *placed_rays; /* share the torus's triangles, as VTK's actors do */
    struct cone cones[CONES];
    struct peer_surface *surface;
    struct peer_selector *selector;
    double reach; /* no cone is so far from a torus, mm */
};

/* A way of VTK's as an engine. */
struct peer {
    struct engine engine;
    enum way way;
    struct scene *scene;
};

static conus_status trace_as_peer(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    struct scene *scene = ((struct peer *)engine)->scene;
    switch (((struct peer *)engine)->way) {
    case CELL_LOCATOR:
        return peer_surface_trace(scene->surface, out->object, cone, PEER_CELL_LOCATOR);
    case STATIC_LOCATOR:
        return peer_surface_trace(scene->surface, out->object, cone, PEER_STATIC_LOCATOR);
    case CELL_PICKER:
        return peer_surface_pick(scene->surface, out->object, cone, PEER_CELL_LOCATOR);
    default:
        return peer_selector_trace(scene->selector, out->object, cone);
    }
}

static conus_status scene_init(struct scene *scene, const struct bench_options *options)
{
    conus_status status = torus_scene_init(&scene->tori, bench_size(options, TORI));
    status = status ? status : torus_scene_atlas(&scene->atlas, &scene->tori);
    if (status) {
        return status;
    }
    size_t count = scene->tori.count;
    scene->reach = 4 * scene->tori.side;
    scene->placed = memory_zeroed(count, sizeof *scene->placed);
    scene->areas = memory_zeroed(count, sizeof *scene->areas);
    if (!scene->placed || !scene->areas) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        scene->placed[i] = (struct mesh_object){&scene->tori.torus, scene->tori.places[i]};
        scene->areas[i] = (struct mesh_object){atlas_object_mesh(scene->atlas, (uint32_t)i + 1), NULL};
    }
    torus_scene_cones(scene->cones, &scene->tori, CONES, ANGLE);
    return CONUS_OK;
}

static void scene_finish(struct scene *scene)
{
    peer_selector_destroy(scene->selector);
    peer_surface_destroy(scene->surface);
    mesh_rays_destroy(scene->placed_rays);
    conus_atlas_destroy(scene->atlas);
    memory_free(scene->placed);
    memory_free(scene->areas);
    torus_scene_finish(&scene->tori);
}

/* Makes what the way needs, and notes the processor time of all threads that this took. */
static conus_status make_way(struct bench *bench, struct scene *scene, enum way way, struct engine **own)
{
    static const char *const keys[WAYS] = {
        "rays_ready_ms",       "rays_placed_ready_ms", "vtkcelllocator_ready_ms", "vtkstaticlocator_ready_ms", NULL,
        "vtkselector_ready_ms"};
    double start = bench_cpu();
    conus_status status = CONUS_OK;
    switch (way) {
    case RAYS:
        status = engine_rays_create(own, scene->atlas, &(struct engine_options){0});
        break;
    case RAYS_PLACED:
        status = mesh_rays_create(&scene->placed_rays, scene->placed, scene->tori.count);
        status = status ? status : mesh_engine_create(own, scene->placed_rays, 0);
        break;
    case CELL_LOCATOR:
        status = peer_surface_create(&scene->surface, scene->areas, scene->tori.count, scene->reach);
        status = status ? status : peer_surface_build(scene->surface, PEER_CELL_LOCATOR);
        break;
    case STATIC_LOCATOR:
        status = peer_surface_build(scene->surface, PEER_STATIC_LOCATOR);
        break;
    case ACTORS:
        status = peer_check_display();
        status = status ? status
                        : peer_selector_create(&scene->selector, scene->placed, scene->tori.count, scene->reach,
                                               scene->cones);
        break;
    default:
        break;
    }
    return status || !keys[way] ? status : bench_value(bench, keys[way], 1e3 * (bench_cpu() - start), true);
}

static conus_status measure_ways(struct bench *bench, struct scene *scene, struct engine *own[2],
                                 struct trace traces[WAYS])
{
    static const char *const names[WAYS] = {
        "rays engine",          "rays, one torus placed",        "vtkCellLocator",
        "vtkStaticCellLocator", "vtkCellPicker, vtkCellLocator", "vtkHardwareSelector, actors"};
    /* Each over rays at what it has in memory: triangles for each torus, or one torus for all places. */
    static const struct {
        const char *key;
        enum way above, below;
    } ratios[] = {{"vtkcelllocator_over_rays", CELL_LOCATOR, RAYS},
                  {"vtkstaticlocator_over_rays", STATIC_LOCATOR, RAYS},
                  {"vtkcellpicker_over_rays", CELL_PICKER, RAYS},
                  {"vtkselector_over_rays", ACTORS, RAYS_PLACED}};
    static const struct engine_functions functions = {.trace = trace_as_peer};
    struct peer peers[WAYS];
    struct bench_variant variants[WAYS];
    size_t count = 0;
    conus_status status = CONUS_OK;
    for (; count < WAYS && !status; count++) {
        struct trace *trace = &traces[count];
        status = make_way(bench, scene, (enum way)count, count <= RAYS_PLACED ? &own[count] : NULL);
        if (status == CONUS_ERROR_GL) {
            status = bench_leave_out(bench, "vtkHardwareSelector");
            break;
        }
        peers[count] = (struct peer){{.functions = &functions}, (enum way)count, scene};
        status = status
                     ? status
                     : trace_init(trace, count <= RAYS_PLACED ? own[count] : &peers[count].engine, scene->cones, CONES);
        if (!status) {
            snprintf(trace->name, sizeof trace->name, "%s", names[count]);
            variants[count] = (struct bench_variant){.name = trace->name, .run = trace_all, .data = trace};
            variants[count].equal = trace_same_but_edges(trace, &traces[RAYS]);
        }
    }
    status = status ? status : bench_measure(bench, "peers_mesh", variants, count, CONES, ANGLE);
    for (size_t i = 0; i < sizeof ratios / sizeof *ratios && !status; i++) {
        if (ratios[i].above < count) {
            status = bench_ratio(bench, ratios[i].key, &variants[ratios[i].above], &variants[ratios[i].below]);
        }
    }
    return status;
}

conus_status bench_peers_mesh(struct bench *bench)
{
    struct scene scene = {0};
    struct engine *own[2] = {NULL, NULL};
    struct trace traces[WAYS] = {0};
    bench_draw_on_this_thread();
    bench->one_thread = true;
    snprintf(bench->driver, sizeof bench->driver, "%s", peer_version());
    conus_status status = scene_init(&scene, &bench->options);
    status = status ? status : measure_ways(bench, &scene, own, traces);
    for (int way = 0; way < WAYS; way++) {
        trace_finish(&traces[way]);
    }
    engine_destroy(own[RAYS]);
    engine_destroy(own[RAYS_PLACED]);
    scene_finish(&scene);
    return status;
}
