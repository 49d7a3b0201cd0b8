/* SPDX-License-Identifier: BSD-3-Clause */
/* A labelled volume by VTK's pickers and selector, beside the rays engine. They answer another question, each its own:
 * tests/bench/test_peers.c has what, in closed form. */
#include "base/memory.h"
#include "bench/bench.h"
#include "bench/peers/peers.h"
#include "bench/support/trace.h"

#include <stdio.h>

enum { PIXELS = PEER_RESOLUTION * PEER_RESOLUTION, WAYS = 5, SEED = 2010 };

struct scene {
    conus_atlas *atlas;
    const struct volume *volume;
    struct engine *rays;
    struct cone *cones;
    struct evidence *answers; /* [cone_count] the rays' */
    size_t cone_count;
    struct peer_labels *labels;
    bool has_window; /* without, nothing can be drawn, and so there is no selector */
};

struct way {
    struct scene *scene;
    const char *name;
    enum { RAYS, PICKER, SELECTOR } kind;
    enum peer_picker picker;
    double isovalue;
    struct peer_contact *contacts; /* [cone_count][PIXELS], but of the rays */
    conus_status status;
};

static conus_status answer_cone(struct way *way, size_t i)
{
    struct scene *scene = way->scene;
    struct peer_contact *contacts = way->contacts + i * PIXELS;
    switch (way->kind) {
    case PICKER:
        return peer_labels_pick(scene->labels, contacts, &scene->cones[i], way->picker, way->isovalue);
    case SELECTOR:
        return peer_labels_select(scene->labels, contacts, &scene->cones[i]);
    default:
        return scene->rays->functions->trace(scene->rays, &scene->answers[i], &scene->cones[i]);
    }
}

static void answer_cones(void *data)
{
    struct way *way = data;
    for (size_t i = 0; i < way->scene->cone_count; i++) {
        conus_status status = answer_cone(way, i);
        way->status = status ? status : way->status;
    }
}

/* How many pixels name the first hit of the rays. */
struct agreement {
    size_t hits;    /* pixels with an object by either */
    size_t objects; /* of those, with the same one */
    size_t voxels;  /* and the same voxel of it */
};

static struct agreement compare_with_rays(const struct way *way)
{
    struct agreement sum = {0};
    for (size_t i = 0; i < way->scene->cone_count * PIXELS; i++) {
        const struct evidence *rays = &way->scene->answers[i / PIXELS];
        const struct peer_contact *contact = &way->contacts[i];
        uint32_t object = rays->object[i % PIXELS];
        if (object || contact->object) {
            sum.hits++;
            sum.objects += object == contact->object;
            sum.voxels += object == contact->object && rays->voxel[i % PIXELS] == contact->voxel;
        }
    }
    return sum;
}

static json_t *describe(const struct way *way)
{
    struct agreement agreement = compare_with_rays(way);
    double hits = agreement.hits ? (double)agreement.hits : 1;
    printf("%s: of %zu pixels with an area %.1f %% name the area that the rays hit first, %.1f %% the voxel\n",
           way->name, agreement.hits, 100 * (double)agreement.objects / hits, 100 * (double)agreement.voxels / hits);
    return json_pack("{s:f, s:f}", "same_area", (double)agreement.objects / hits, "same_voxel",
                     (double)agreement.voxels / hits);
}

static conus_status make_cones(struct scene *scene, const struct bench_options *options)
{
    scene->cone_count = options->poses;
    scene->cones = memory_zeroed(scene->cone_count, sizeof *scene->cones);
    scene->answers = memory_zeroed(scene->cone_count, sizeof *scene->answers);
    if (!scene->cones || !scene->answers) {
        return CONUS_ERROR_MEMORY;
    }
    cones_round_grid(scene->cones, scene->cone_count, &scene->volume->info, options->angle, SEED);
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < scene->cone_count && !status; i++) {
        status = evidence_init(&scene->answers[i], PEER_RESOLUTION);
    }
    return status;
}

static conus_status scene_init(struct bench *bench, struct scene *scene)
{
    conus_status status = conus_atlas_load(&scene->atlas, bench->options.atlas, NULL);
    scene->volume = status ? NULL : atlas_parcellation(scene->atlas);
    if (!status && !scene->volume) {
        status = fail(CONUS_ERROR_DATA, "%s: has no labelled volume", bench->options.atlas);
    }
    status = status ? status : engine_rays_create(&scene->rays, scene->atlas, &(struct engine_options){0});
    status = status ? status : make_cones(scene, &bench->options);
    scene->has_window = !status && !peer_check_display();
    if (!status && !scene->has_window) {
        status = bench_leave_out(bench, "vtkHardwareSelector on volumes");
    }
    return status ? status : peer_labels_create(&scene->labels, scene->volume, 1, scene->has_window);
}

static void scene_finish(struct scene *scene)
{
    for (size_t i = 0; scene->answers && i < scene->cone_count; i++) {
        evidence_finish(&scene->answers[i]);
    }
    memory_free(scene->answers);
    memory_free(scene->cones);
    peer_labels_destroy(scene->labels);
    engine_destroy(scene->rays);
    conus_atlas_destroy(scene->atlas);
}

static conus_status measure_pickers(struct bench *bench, struct way ways[WAYS], size_t count)
{
    struct bench_variant variants[WAYS];
    for (size_t w = 0; w < count; w++) {
        answer_cones(&ways[w]);
        if (ways[w].status) {
            return ways[w].status;
        }
        variants[w] =
            (struct bench_variant){.name = ways[w].name, .run = answer_cones, .data = &ways[w], .equal = w == 0};
        variants[w].other_by_design = w > 0;
        variants[w].more = w > 0 ? describe(&ways[w]) : NULL;
    }
    return bench_measure(bench, "peers_volume", variants, count, bench->options.poses, bench->options.angle);
}

static conus_status run_scene(struct bench *bench, struct scene *scene)
{
    struct way ways[WAYS] = {
        {.name = "rays engine", .kind = RAYS},
        {.name = "vtkVolumePicker", .kind = PICKER, .picker = PEER_VOLUME_PICKER, .isovalue = 0.05},
        {.name = "vtkCellPicker", .kind = PICKER, .picker = PEER_CELL_PICKER, .isovalue = 0.05},
        {.name = "vtkCellPicker, isovalue 0.75", .kind = PICKER, .picker = PEER_CELL_PICKER, .isovalue = 0.75},
        {.name = "vtkHardwareSelector, voxels", .kind = SELECTOR}};
    conus_status status = CONUS_OK;
    for (size_t w = 0; w < WAYS && !status; w++) {
        ways[w].scene = scene;
        ways[w].contacts = memory_zeroed(scene->cone_count * PIXELS, sizeof *ways[w].contacts);
        status = ways[w].contacts ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    status = status ? status : measure_pickers(bench, ways, scene->has_window ? WAYS : WAYS - 1);
    for (size_t w = 0; w < WAYS; w++) {
        memory_free(ways[w].contacts);
    }
    return status;
}

conus_status bench_peers_volume(struct bench *bench)
{
    struct scene scene = {0};
    bench_draw_on_this_thread();
    bench->one_thread = true;
    conus_status status = scene_init(bench, &scene);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s; %s", peer_version(), scene.rays->name);
        status = run_scene(bench, &scene);
    }
    scene_finish(&scene);
    return status;
}
