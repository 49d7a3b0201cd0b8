/* SPDX-License-Identifier: BSD-3-Clause */
/* Tori by VTK's selector, locators and pickers, beside the rays engine: cones into many, and single picks. */
#include "base/memory.h"
#include "bench/peers/peers.h"
#include "bench/support/bench.h"
#include "bench/support/trace.h"
#include "bench/torus/torus.h"

#include <stdio.h>

enum { MOST_CONES = 16, ANGLE = 5, ROWS = 8 };

/* The ways to answer cones. ACTORS is missing where there is no display. */
enum way { RAYS, RAYS_PLACED, LONE_PICKER, CELL_LOCATOR, CELL_PICKER, STATIC_LOCATOR, STATIC_PICKER, ACTORS, WAYS };

/* The locator that each way of casting rays with VTK searches with. */
static const enum peer_locator locators[WAYS] = {[LONE_PICKER] = PEER_NO_LOCATOR,
                                                 [CELL_LOCATOR] = PEER_CELL_LOCATOR,
                                                 [CELL_PICKER] = PEER_CELL_LOCATOR,
                                                 [STATIC_LOCATOR] = PEER_STATIC_LOCATOR,
                                                 [STATIC_PICKER] = PEER_STATIC_LOCATOR};

/* A scenario: each row answers the same cones, with as many rays along their edge, as row `over` of the table does; the
 * ratio is its time over that of row `over`. Both rows have the same in memory: triangles for each torus, or one torus
 * for all places. */
struct question {
    const char *scenario;
    size_t tori, cones;
    struct row {
        enum way way;
        uint32_t resolution;
        const char *name, *ratio;
        size_t over;
    } rows[ROWS];
};

struct scene {
    struct torus_scene tori;
    struct mesh_object *placed; /* [tori.count] one torus at all places */
    struct mesh_object *areas;  /* [tori.count] the atlas's, with triangles of their own */
    conus_atlas *atlas;
    struct mesh_rays *placed_rays; /* share the torus's triangles, as VTK's actors do */
    struct engine *own[2];         /* RAYS and RAYS_PLACED */
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
    enum way way = ((struct peer *)engine)->way;
    switch (way) {
    case CELL_LOCATOR:
    case STATIC_LOCATOR:
        return peer_surface_trace(scene->surface, out->object, cone, locators[way]);
    case ACTORS:
        return peer_selector_trace(scene->selector, out->object, cone);
    default:
        return peer_surface_pick(scene->surface, out->object, cone, locators[way]);
    }
}

static conus_status scene_init(struct scene *scene, size_t tori)
{
    conus_status status = torus_scene_init(&scene->tori, tori);
    status = status ? status : torus_scene_atlas(&scene->atlas, &scene->tori);
    if (status) {
        return status;
    }
    scene->reach = 4 * scene->tori.side;
    scene->placed = memory_zeroed(tori, sizeof *scene->placed);
    scene->areas = memory_zeroed(tori, sizeof *scene->areas);
    if (!scene->placed || !scene->areas) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < tori; i++) {
        scene->placed[i] = (struct mesh_object){&scene->tori.torus, scene->tori.places[i]};
        scene->areas[i] = (struct mesh_object){atlas_object_mesh(scene->atlas, (uint32_t)i + 1), NULL};
    }
    return CONUS_OK;
}

static void scene_finish(struct scene *scene)
{
    peer_selector_destroy(scene->selector);
    peer_surface_destroy(scene->surface);
    engine_destroy(scene->own[RAYS]);
    engine_destroy(scene->own[RAYS_PLACED]);
    mesh_rays_destroy(scene->placed_rays);
    conus_atlas_destroy(scene->atlas);
    memory_free(scene->placed);
    memory_free(scene->areas);
    torus_scene_finish(&scene->tori);
}

/* Makes whatever the way needs and no row before it has made. */
static conus_status make_way(struct scene *scene, enum way way, const struct cone *cone)
{
    size_t count = scene->tori.count;
    conus_status status = CONUS_OK;
    switch (way) {
    case RAYS:
        return scene->own[way] ? CONUS_OK
                               : engine_rays_create(&scene->own[way], scene->atlas, &(struct engine_options){0});
    case RAYS_PLACED:
        status = mesh_rays_create(&scene->placed_rays, scene->placed, count);
        return status ? status : mesh_engine_create(&scene->own[way], scene->placed_rays, 0);
    case ACTORS:
        status = peer_check_display();
        return status ? status : peer_selector_create(&scene->selector, scene->placed, count, scene->reach, cone);
    default:
        status = scene->surface ? CONUS_OK : peer_surface_create(&scene->surface, scene->areas, count, scene->reach);
        return status ? status : peer_surface_build(scene->surface, locators[way]);
    }
}

static conus_status measure_rows(struct bench *bench, const struct question *question, struct scene *scene,
                                 struct trace traces[ROWS])
{
    static const struct engine_functions functions = {.trace = trace_as_peer};
    struct peer peers[ROWS];
    struct cone cones[ROWS][MOST_CONES];
    struct bench_variant variants[ROWS];
    size_t count = 0;
    conus_status status = CONUS_OK;
    for (; count < ROWS && question->rows[count].name && !status; count++) {
        const struct row *row = &question->rows[count];
        struct trace *trace = &traces[count];
        torus_scene_cones(cones[count], &scene->tori, question->cones, ANGLE);
        for (size_t i = 0; i < question->cones; i++) {
            cones[count][i].resolution = row->resolution;
        }
        double bytes = bench_resident(), start = bench_cpu();
        status = make_way(scene, row->way, cones[count]);
        if (status == CONUS_ERROR_GL) {
            status = bench_leave_out(bench, "vtkHardwareSelector");
            break;
        }
        double ready_ms = 1e3 * (bench_cpu() - start); /* of all threads */
        double ready_mb = (bench_resident() - bytes) / 1e6;
        peers[count] = (struct peer){{.functions = &functions}, row->way, scene};
        struct engine *engine = row->way <= RAYS_PLACED ? scene->own[row->way] : &peers[count].engine;
        status = status ? status : trace_init(trace, engine, cones[count], question->cones);
        if (!status) {
            printf("%s: made in %.1f ms, %.1f MB\n", row->name, ready_ms, ready_mb);
            snprintf(trace->name, sizeof trace->name, "%s", row->name);
            variants[count] = (struct bench_variant){.name = row->name, .run = trace_all, .data = trace};
            variants[count].equal = trace_same_but_edges(trace, &traces[row->over]);
            variants[count].more = json_pack("{s:f, s:f}", "ready_ms", ready_ms, "ready_mb", ready_mb);
        }
    }
    status = status ? status : bench_measure(bench, question->scenario, variants, count, question->cones, ANGLE);
    for (size_t i = 0; i < count && !status; i++) {
        const struct row *row = &question->rows[i];
        status = row->ratio ? bench_ratio(bench, row->ratio, &variants[i], &variants[row->over]) : CONUS_OK;
    }
    return status;
}

static conus_status ask(struct bench *bench, const struct question *question)
{
    struct scene scene = {0};
    struct trace traces[ROWS] = {0};
    bench_draw_on_this_thread();
    bench->one_thread = true;
    snprintf(bench->driver, sizeof bench->driver, "%s", peer_version());
    conus_status status = scene_init(&scene, bench_size(&bench->options, question->tori));
    status = status ? status : measure_rows(bench, question, &scene, traces);
    for (size_t i = 0; i < ROWS; i++) {
        trace_finish(&traces[i]);
    }
    scene_finish(&scene);
    return status;
}

conus_status bench_peers_mesh(struct bench *bench)
{
    return ask(bench,
               &(struct question){"peers_mesh",
                                  20000,
                                  4,
                                  {{RAYS, 16, "rays engine", NULL, 0},
                                   {RAYS_PLACED, 16, "rays, one torus placed", NULL, 0},
                                   {CELL_LOCATOR, 16, "vtkCellLocator", "vtkcelllocator_over_rays", 0},
                                   {STATIC_LOCATOR, 16, "vtkStaticCellLocator", "vtkstaticlocator_over_rays", 0},
                                   {CELL_PICKER, 16, "vtkCellPicker, vtkCellLocator", "vtkcellpicker_over_rays", 0},
                                   {ACTORS, 16, "vtkHardwareSelector, actors", "vtkselector_over_rays", 1}}});
}

/* 2.4 million triangles. A pick is one ray; a cone has 256, and so has the selector's window pixels. */
conus_status bench_peers_pick(struct bench *bench)
{
    return ask(bench,
               &(struct question){"peers_pick",
                                  4688,
                                  MOST_CONES,
                                  {{RAYS, 1, "rays engine, a ray", NULL, 0},
                                   {RAYS, 16, "rays engine, a cone", NULL, 1},
                                   {LONE_PICKER, 1, "vtkCellPicker", "pick_lone_over_ray", 0},
                                   {CELL_PICKER, 1, "vtkCellPicker, vtkCellLocator", "pick_located_over_ray", 0},
                                   {STATIC_PICKER, 1, "vtkCellPicker, vtkStaticCellLocator", "pick_static_over_ray", 0},
                                   {CELL_LOCATOR, 1, "vtkCellLocator", "pick_locator_over_ray", 0},
                                   {STATIC_LOCATOR, 1, "vtkStaticCellLocator", "pick_static_locator_over_ray", 0},
                                   {ACTORS, 16, "vtkHardwareSelector, actors", "pick_selector_over_cone", 1}}});
}
