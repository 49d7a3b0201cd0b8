/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene by VTK's selector, locators and picker, beside the rays engine. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/bench.h"
#include "bench/peers/peers.h"
#include "bench/support/trace.h"
#include "bench/torus/torus_scene.h"

#include <stdio.h>

enum { TORI = 20000, CONES = 4, WAYS_LIMIT = 10, LARGE_WIDTH = 1400, LARGE_HEIGHT = 1050 };

/* What programs look at their scene with, in whose middle 16 x 16 pixels are asked about. */
#define LARGE_DEGREES 30.0

struct scene {
    struct torus_scene tori;
    struct mesh_object *placed; /* [tori.count] one torus at all places */
    struct mesh_object *areas;  /* [tori.count] the atlas's, with triangles of their own */
    conus_atlas *atlas;
    struct engine *rays;
    struct mesh_rays *placed_rays;
    struct engine *rays_on_placed;          /* which share the torus's triangles, as VTK's actors do */
    struct cone wide[CONES], narrow[CONES]; /* what 16 x 16 pixels show of a window of their size, and of a large one */
    struct peer_selector *small, *own, *large, *composite;
    struct peer_surface *surface;
};

enum kind { SELECTOR, LOCATOR, PICKER };

struct peer {
    struct engine engine;
    enum kind kind;
    struct peer_selector *selector;
    bool actors_only;
    struct peer_surface *surface;
    enum peer_locator locator;
};

static conus_status trace_as_peer(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    struct peer *peer = (struct peer *)engine;
    switch (peer->kind) {
    case SELECTOR:
        return peer_selector_trace(peer->selector, out->object, cone, peer->actors_only);
    case PICKER:
        return peer_surface_pick(peer->surface, out->object, cone, peer->locator);
    default:
        return peer_surface_trace(peer->surface, out->object, cone, peer->locator);
    }
}

static const struct engine_functions functions = {.trace = trace_as_peer};

/* Something of VTK's that is made before anything can be asked. */
struct preparation {
    struct scene *scene;
    conus_status (*make)(struct scene *scene);
    conus_status status;
};

static double view_range(const struct scene *scene)
{
    return 4 * scene->tori.side;
}

static conus_status remake_selector(struct peer_selector **selector, const struct scene *scene,
                                    const struct mesh_object *objects, enum peer_parts parts, const uint32_t size[2],
                                    const struct cone *cones)
{
    peer_selector_destroy(*selector);
    *selector = NULL;
    return peer_selector_create(selector, objects, scene->tori.count, parts, size, view_range(scene), cones);
}

static const uint32_t small_size[2] = {PEER_RESOLUTION, PEER_RESOLUTION};
static const uint32_t large_size[2] = {LARGE_WIDTH, LARGE_HEIGHT};

static conus_status make_small(struct scene *scene)
{
    return remake_selector(&scene->small, scene, scene->placed, PEER_ACTORS, small_size, scene->wide);
}

static conus_status make_own(struct scene *scene)
{
    return remake_selector(&scene->own, scene, scene->areas, PEER_ACTORS, small_size, scene->wide);
}

static conus_status make_large(struct scene *scene)
{
    return remake_selector(&scene->large, scene, scene->placed, PEER_ACTORS, large_size, scene->narrow);
}

static conus_status make_composite(struct scene *scene)
{
    return remake_selector(&scene->composite, scene, scene->areas, PEER_COMPOSITE, small_size, scene->wide);
}

static conus_status make_surface(struct scene *scene)
{
    peer_surface_destroy(scene->surface);
    scene->surface = NULL;
    return peer_surface_create(&scene->surface, scene->areas, scene->tori.count, view_range(scene));
}

static conus_status build_locator(struct scene *scene)
{
    return peer_surface_build(scene->surface, PEER_CELL_LOCATOR);
}

static conus_status build_static(struct scene *scene)
{
    return peer_surface_build(scene->surface, PEER_STATIC_LOCATOR);
}

static conus_status make_rays(struct scene *scene)
{
    engine_destroy(scene->rays);
    scene->rays = NULL;
    return engine_rays_create(&scene->rays, scene->atlas, &(struct engine_options){0});
}

static conus_status make_placed_rays(struct scene *scene)
{
    engine_destroy(scene->rays_on_placed);
    mesh_rays_destroy(scene->placed_rays);
    scene->rays_on_placed = NULL;
    scene->placed_rays = NULL;
    conus_status status = mesh_rays_create(&scene->placed_rays, scene->placed, scene->tori.count);
    status = status ? status : mesh_engine_create(&scene->rays_on_placed, scene->placed_rays, 0);
    if (!status) {
        snprintf(scene->rays_on_placed->name, sizeof scene->rays_on_placed->name, "rays, one torus placed");
    }
    return status;
}

static void prepare(void *data)
{
    struct preparation *preparation = data;
    conus_status status = preparation->make(preparation->scene);
    preparation->status = status ? status : preparation->status;
}

/* Makes it and prints how long that took: once, by the wall clock, since some of it uses all processors. */
static conus_status make_timed(struct bench *bench, struct scene *scene, const char *what,
                               conus_status (*make)(struct scene *scene))
{
    struct preparation preparation = {.scene = scene, .make = make};
    struct bench_variant variant = {.name = what, .run = prepare, .data = &preparation, .equal = true};
    size_t repeats = bench->options.repeats;
    bench->options.repeats = 1;
    bench->one_thread = false;
    conus_status status = bench_measure(bench, "peers_mesh", &variant, 1, 1, 0);
    bench->options.repeats = repeats;
    bench->one_thread = true;
    return preparation.status ? preparation.status : status;
}

static conus_status make_objects(struct scene *scene)
{
    size_t count = scene->tori.count;
    scene->placed = memory_zeroed(count, sizeof *scene->placed);
    scene->areas = memory_zeroed(count, sizeof *scene->areas);
    if (!scene->placed || !scene->areas) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        scene->placed[i] = (struct mesh_object){&scene->tori.torus, scene->tori.places[i]};
        scene->areas[i] = (struct mesh_object){atlas_object_mesh(scene->atlas, (uint32_t)i + 1), NULL};
    }
    double slope = tan(radians_from_degrees(LARGE_DEGREES) / 2) * PEER_RESOLUTION / LARGE_HEIGHT;
    torus_scene_cones(scene->wide, &scene->tori, CONES, 5);
    torus_scene_cones(scene->narrow, &scene->tori, CONES, degrees_from_radians(2 * atan(slope)));
    return CONUS_OK;
}

static conus_status scene_init(struct bench *bench, struct scene *scene)
{
    conus_status status = torus_scene_init(&scene->tori, bench_size(&bench->options, TORI));
    status = status ? status : torus_scene_atlas(&scene->atlas, &scene->tori);
    status = status ? status : make_objects(scene);
    status = status ? status : make_timed(bench, scene, "making the rays engine", make_rays);
    status = status ? status : make_timed(bench, scene, "making rays on placed tori", make_placed_rays);
    status = status ? status : make_timed(bench, scene, "merging for locators", make_surface);
    status = status ? status : make_timed(bench, scene, "building vtkCellLocator", build_locator);
    return status ? status : make_timed(bench, scene, "building vtkStaticCellLocator", build_static);
}

/* What needs a display. */
static conus_status windows_init(struct bench *bench, struct scene *scene)
{
    conus_status status = peer_check_display();
    status = status ? status : make_timed(bench, scene, "actors, 16 x 16, first frame", make_small);
    status = status ? status : make_timed(bench, scene, "actors, 1400 x 1050, first frame", make_large);
    status = status ? status : make_timed(bench, scene, "composite, 16 x 16, first frame", make_composite);
    return status ? status : make_timed(bench, scene, "actors of own triangles, first frame", make_own);
}

static void scene_finish(struct scene *scene)
{
    peer_selector_destroy(scene->small);
    peer_selector_destroy(scene->own);
    peer_selector_destroy(scene->large);
    peer_selector_destroy(scene->composite);
    peer_surface_destroy(scene->surface);
    engine_destroy(scene->rays_on_placed);
    mesh_rays_destroy(scene->placed_rays);
    engine_destroy(scene->rays);
    conus_atlas_destroy(scene->atlas);
    memory_free(scene->placed);
    memory_free(scene->areas);
    torus_scene_finish(&scene->tori);
}

/* Several ways to answer the same cones, the rays first. */
struct contest {
    struct scene *scene;
    const struct cone *cones;
    struct engine *engines[WAYS_LIMIT];
    struct peer peers[WAYS_LIMIT]; /* where the engine is one */
    struct trace traces[WAYS_LIMIT];
    struct bench_variant variants[WAYS_LIMIT];
    size_t count;
};

static struct peer *add_peer(struct contest *contest, enum kind kind, const char *what)
{
    struct peer *peer = &contest->peers[contest->count];
    snprintf(peer->engine.name, sizeof peer->engine.name, "%s", what);
    peer->engine.functions = &functions;
    peer->kind = kind;
    peer->surface = contest->scene->surface;
    contest->engines[contest->count++] = &peer->engine;
    return peer;
}

static void add_locator(struct contest *contest, enum kind kind, enum peer_locator locator, const char *what)
{
    add_peer(contest, kind, what)->locator = locator;
}

static void add_selector(struct contest *contest, struct peer_selector *selector, bool actors_only, const char *what)
{
    struct peer *peer = add_peer(contest, SELECTOR, what);
    peer->selector = selector;
    peer->actors_only = actors_only;
}

/* Answers all once, compares, and times them. */
static conus_status measure_contest(struct bench *bench, struct contest *contest)
{
    conus_status status = CONUS_OK;
    for (size_t w = 0; w < contest->count && !status; w++) {
        struct trace *trace = &contest->traces[w];
        status = trace_init(trace, contest->engines[w], contest->cones, CONES);
        if (!status) {
            contest->variants[w] = (struct bench_variant){.name = trace->name, .run = trace_all, .data = trace};
            contest->variants[w].equal = trace_same_but_edges(trace, &contest->traces[0]);
        }
    }
    double angle = degrees_from_radians(contest->cones[0].angle);
    return status ? status : bench_measure(bench, "peers_mesh", contest->variants, contest->count, CONES, angle);
}

static conus_status ratio(struct bench *bench, const struct contest *contest, size_t above, size_t below,
                          const char *key)
{
    return bench_ratio(bench, key, &contest->variants[above], &contest->variants[below]);
}

static void contest_finish(struct contest *contest)
{
    for (size_t w = 0; w < contest->count; w++) {
        trace_finish(&contest->traces[w]);
    }
}

/* The ways of measure_wide(). */
enum way {
    RAYS,
    RAYS_PLACED,
    CELL_LOCATOR,
    STATIC_LOCATOR,
    CELL_PICKER,
    STATIC_PICKER,
    ACTORS, /* from here on a display is needed */
    ACTORS_CELLS,
    ACTORS_OWN,
    COMPOSITE
};

/* Each over rays at what it has in memory: one torus for all places, or triangles for each. */
static const struct {
    enum way above, below;
    const char *key;
} ratios[] = {{CELL_LOCATOR, RAYS, "vtkcelllocator_over_rays"},
              {STATIC_LOCATOR, RAYS, "vtkstaticlocator_over_rays"},
              {CELL_PICKER, RAYS, "vtkcellpicker_over_rays"},
              {ACTORS, RAYS_PLACED, "vtkselector_over_rays"},
              {ACTORS_CELLS, RAYS_PLACED, "vtkselector_cells_over_rays"},
              {ACTORS_OWN, RAYS, "vtkselector_own_over_rays"},
              {COMPOSITE, RAYS, "vtkselector_composite_over_rays"}};
enum { RATIOS = sizeof ratios / sizeof ratios[0], RATIOS_WITHOUT_DISPLAY = 3 };

/* Cones of 5 degrees; the selector's window has 16 x 16 pixels. */
static conus_status measure_wide(struct bench *bench, struct scene *scene)
{
    struct contest contest = {
        .scene = scene, .cones = scene->wide, .engines = {scene->rays, scene->rays_on_placed}, .count = CELL_LOCATOR};
    add_locator(&contest, LOCATOR, PEER_CELL_LOCATOR, "vtkCellLocator");
    add_locator(&contest, LOCATOR, PEER_STATIC_LOCATOR, "vtkStaticCellLocator");
    add_locator(&contest, PICKER, PEER_CELL_LOCATOR, "vtkCellPicker, vtkCellLocator");
    add_locator(&contest, PICKER, PEER_STATIC_LOCATOR, "vtkCellPicker, vtkStaticCellLocator");
    if (scene->small) {
        add_selector(&contest, scene->small, true, "vtkHardwareSelector, actors");
        add_selector(&contest, scene->small, false, "vtkHardwareSelector, actors and cells");
        add_selector(&contest, scene->own, true, "vtkHardwareSelector, actors of own triangles");
        add_selector(&contest, scene->composite, false, "vtkHardwareSelector, composite");
    }
    conus_status status = measure_contest(bench, &contest);
    for (size_t i = 0; i < (scene->small ? RATIOS : RATIOS_WITHOUT_DISPLAY) && !status; i++) {
        status = ratio(bench, &contest, ratios[i].above, ratios[i].below, ratios[i].key);
    }
    contest_finish(&contest);
    return status;
}

/* What 16 x 16 pixels in the middle of a large window show. */
static conus_status measure_narrow(struct bench *bench, struct scene *scene)
{
    struct contest contest = {.scene = scene, .cones = scene->narrow, .engines = {scene->rays}, .count = 1};
    add_selector(&contest, scene->large, true, "vtkHardwareSelector, 1400 x 1050, actors");
    conus_status status = measure_contest(bench, &contest);
    status = status ? status : ratio(bench, &contest, 1, 0, "vtkselector_window_over_rays");
    contest_finish(&contest);
    return status;
}

conus_status bench_peers_mesh(struct bench *bench)
{
    struct scene scene = {0};
    bench_draw_on_this_thread();
    bench->one_thread = true;
    conus_status status = scene_init(bench, &scene);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s; %s", peer_version(), scene.rays->name);
        status = windows_init(bench, &scene);
        status = status == CONUS_ERROR_GL ? bench_leave_out(bench, "vtkHardwareSelector") : status;
    }
    status = status ? status : measure_wide(bench, &scene);
    status = status || !scene.large ? status : measure_narrow(bench, &scene);
    scene_finish(&scene);
    return status;
}
