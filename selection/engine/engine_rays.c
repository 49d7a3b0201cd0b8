/* SPDX-License-Identifier: BSD-3-Clause */
/* The rays engine: traces volumes, meshes and streamlines on the CPU, block by block of pixels. */
#include "selection/engine/engine.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/passes/shapes.h"
#include "selection/cone/cone.h"
#include "selection/engine/tracts/tract_rays.h"
#include "selection/engine/triangles/mesh_rays.h"
#include "selection/engine/voxels/distance_map.h"
#include "selection/engine/voxels/traverse.h"

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum { BLOCK = APERTURE_BLOCK };

/* After so many rays that listed their intervals, uniform maps are made: AAL's takes about as long as these rays. */
enum { RAYS_WITHOUT_UNIFORM = 1 << 13 };

/* After so many traced rays, labelled maps are made: AAL's takes about as long as half of these rays. */
enum { RAYS_WITHOUT_LABELS = 1 << 19 };

struct target {
    const struct volume *volume;
    struct distance_map map;      /* exact sampling                                */
    struct distance_map uniform;  /* with has_uniform; no codes: go on without one */
    struct distance_map labelled; /* with has_labelled; the same                  */
    uint32_t slices;              /* sampled slices                                */
};

struct rays_engine {
    struct engine base;
    conus_sampling sampling;
    const struct traverse_kernel *kernel;
    struct mesh_rays *meshes;        /* NULL if the atlas has none */
    struct tract_rays *tracts;       /* NULL if the atlas has none */
    struct mesh_intervals intervals; /* empty: what a query begins with */
    atomic_size_t pierced;           /* rays that have listed their intervals */
    atomic_bool has_uniform;         /* the targets' uniform maps are there: several threads may be here */
    atomic_size_t traced;            /* rays traced for their first hit */
    atomic_bool has_labelled;        /* the labelled maps are there */
    size_t target_count;
    struct target targets[];
};

/* A block of pixels while it is traced. */
struct block {
    size_t pixel[TRAVERSE_BUNDLE];
    struct traverse_bundle bundle;
    struct mesh_bundle meshes; /* filled in where there are any */
    struct tract_bundle tracts;
};

static void destroy(struct engine *engine)
{
    struct rays_engine *rays = (struct rays_engine *)engine;
    for (size_t i = 0; i < rays->target_count; i++) {
        distance_map_finish(&rays->targets[i].map);
        distance_map_finish(&rays->targets[i].uniform);
        distance_map_finish(&rays->targets[i].labelled);
    }
    mesh_rays_destroy(rays->meshes);
    tract_rays_destroy(rays->tracts);
    memory_free(rays);
}

/* Nearest first; of equally near ones the object with the lower number. */
static void keep_nearer(struct evidence *out, size_t pixel, double t, uint64_t voxel, uint32_t object)
{
    if (voxel == EVIDENCE_NO_VOXEL || t > out->distance[pixel]) {
        return;
    }
    if (t < out->distance[pixel] || object < out->object[pixel]) {
        out->object[pixel] = object;
        out->distance[pixel] = t;
        out->voxel[pixel] = voxel;
    }
}

/* Sets where the rays of the block's pixels begin. */
static void set_origins(struct block *block, const struct cone *cone)
{
    struct traverse_bundle *bundle = &block->bundle;
    cone_origin(bundle->origin, cone, (uint32_t)(block->pixel[0] % cone->resolution),
                (uint32_t)(block->pixel[0] / cone->resolution));
    bundle->is_apart = cone->radius > 0;
    for (size_t ray = 0; ray < bundle->count && bundle->is_apart; ray++) {
        double origin[3];
        cone_origin(origin, cone, (uint32_t)(block->pixel[ray] % cone->resolution),
                    (uint32_t)(block->pixel[ray] / cone->resolution));
        for (int a = 0; a < 3; a++) {
            bundle->origins[a][ray] = origin[a];
        }
    }
}

/* Fills the block of `edge` times `edge` pixels whose lowest column and row are given. */
static void block_init(struct block *block, const struct cone *cone, uint32_t column, uint32_t row, uint32_t edge)
{
    struct traverse_bundle *bundle = &block->bundle;
    double u[TRAVERSE_BUNDLE];
    double v[TRAVERSE_BUNDLE];
    double coordinate[2][BLOCK];
    const bool *wanted = cone->tracing.wanted;
    size_t count = 0;
    for (uint32_t k = 0; k < edge; k++) {
        coordinate[0][k] = cone_coordinate(column + k, cone->resolution);
        coordinate[1][k] = cone_coordinate(row + k, cone->resolution);
    }
    for (uint32_t k = 0; k < edge * edge; k++) {
        uint32_t i = aperture_column(k);
        uint32_t j = aperture_row(k);
        size_t pixel = (size_t)(row + j) * cone->resolution + column + i;
        if (column + i < cone->resolution && row + j < cone->resolution && (!wanted || wanted[pixel])) {
            block->pixel[count] = pixel;
            u[count] = coordinate[0][i];
            v[count++] = coordinate[1][j];
        }
    }
    double *const directions[3] = {bundle->direction[0], bundle->direction[1], bundle->direction[2]};
    cone_rays(directions, cone, u, v, count);
    bundle->count = count;
    if (count > 0) {
        set_origins(block, cone);
    }
}

/* Fills a block with the rays that are known from number `first` on, `most` at most. */
static void block_take(struct block *block, const struct cone *cone, size_t first, size_t most)
{
    struct traverse_bundle *bundle = &block->bundle;
    double *const directions[3] = {bundle->direction[0], bundle->direction[1], bundle->direction[2]};
    size_t left = cone->tracing.rays->count - first;
    bundle->count = left < most ? left : most;
    for (size_t ray = 0; ray < bundle->count; ray++) {
        block->pixel[ray] = cone->tracing.rays->pixel[first + ray];
    }
    cone_rays_from(directions, cone, cone->tracing.rays, first, bundle->count);
    set_origins(block, cone);
}

/* Eq. 7: the first of the planes, at depths along the axis, on which a ray hits an object's voxel. None is before a ray
 * that goes back, as those of pixels outside a wide cone may. */
static struct traverse_contact sample_slices(const struct volume *volume, const struct slices *slices,
                                             const double origin[3], const double direction[3], double per_depth)
{
    const size_t *dim = volume->info.dim;
    for (uint32_t k = 0; k < slices->count && per_depth > 0; k++) {
        double t = slices_depth(slices, k) * per_depth;
        double cell[3];
        bool inside = true;
        for (int a = 0; a < 3; a++) {
            cell[a] = floor(origin[a] + t * direction[a] + 0.5);
            inside = inside && cell[a] >= 0 && cell[a] < (double)dim[a];
        }
        size_t voxel = inside ? (size_t)cell[0] + dim[0] * ((size_t)cell[1] + dim[1] * (size_t)cell[2]) : 0;
        if (inside && volume_object(volume, voxel)) {
            return (struct traverse_contact){.t = t, .voxel = voxel, .object = volume_object(volume, voxel)};
        }
    }
    return (struct traverse_contact){.t = INFINITY, .voxel = EVIDENCE_NO_VOXEL};
}

static void trace_slices(const struct target *target, struct traverse_bundle *bundle, const struct cone *cone)
{
    const struct volume *volume = target->volume;
    const double *device = cone->pose.world_from_device;
    double axis[3];
    vec3_scale(axis, device + 8, -1);
    struct slices slices =
        slices_over(volume->info.dim, volume->info.world_from_voxel, device + 12, axis, target->slices);
    for (size_t ray = 0; ray < bundle->count; ray++) {
        double direction[3] = {bundle->direction[0][ray], bundle->direction[1][ray], bundle->direction[2][ray]};
        double per_depth = 1 / vec3_dot(direction, axis);
        double origin[3] = {bundle->origins[0][ray], bundle->origins[1][ray], bundle->origins[2][ray]};
        mat4_point(origin, volume->voxel_from_world, bundle->is_apart ? origin : bundle->origin);
        mat4_direction(direction, volume->voxel_from_world, direction);
        struct traverse_contact contact = sample_slices(volume, &slices, origin, direction, per_depth);
        bundle->t[ray] = contact.t;
        bundle->voxel[ray] = contact.voxel;
        bundle->object[ray] = contact.object;
    }
}

/* Where the rays come to the near end of the cone's range. */
static void find_near(double from[TRAVERSE_BUNDLE], const struct cone *cone, const struct block *block)
{
    for (size_t ray = 0; ray < TRAVERSE_BUNDLE; ray++) {
        size_t pixel = block->pixel[ray < block->bundle.count ? ray : block->bundle.count - 1];
        from[ray] = cone->range[0] *
                    cone_per_depth(cone, (uint32_t)(pixel % cone->resolution), (uint32_t)(pixel / cone->resolution));
    }
}

/* A ray that is inside an object at the near end of the range hits the voxel that holds its point there, if that voxel
 * is of the same object. Else its hit counts as one before the range, and its intervals tell what is first. */
static void settle_near(struct traverse_bundle *bundle, size_t ray, const struct volume *volume)
{
    double point[3] = {bundle->origin[0], bundle->origin[1], bundle->origin[2]};
    const double direction[3] = {bundle->direction[0][ray], bundle->direction[1][ray], bundle->direction[2][ray]};
    size_t voxel = 0;
    for (int a = 0; a < 3 && bundle->is_apart; a++) {
        point[a] = bundle->origins[a][ray];
    }
    vec3_add_scaled(point, point, bundle->from[ray], direction);
    bool found = bundle->object[ray] != VOLUME_BLOCKER && volume_find_voxel(&voxel, volume, point) &&
                 volume_object(volume, voxel) == bundle->object[ray];
    bundle->t[ray] = found ? bundle->from[ray] : 0;
    bundle->voxel[ray] = found ? voxel : bundle->voxel[ray];
}

static conus_status trace_volumes(const struct rays_engine *engine, void *evidence, const struct cone *cone,
                                  struct block *block)
{
    struct evidence *out = evidence;
    struct traverse_bundle *bundle = &block->bundle;
    bool has_labelled = atomic_load_explicit(&engine->has_labelled, memory_order_acquire);
    double from[TRAVERSE_BUNDLE];
    bundle->from = NULL;
    if (cone->tracing.begins_at_range && cone->range[0] > 0 && engine->target_count == 1) {
        find_near(from, cone, block);
        bundle->from = from;
    }
    for (size_t i = 0; i < engine->target_count; i++) {
        const struct target *target = &engine->targets[i];
        const struct distance_map *map = has_labelled && target->labelled.codes ? &target->labelled : &target->map;
        for (size_t ray = 0; ray < bundle->count; ray++) {
            bundle->limit[ray] = i ? out->distance[block->pixel[ray]] : INFINITY;
        }
        if (engine->sampling == CONUS_SAMPLING_SLICES) {
            trace_slices(target, bundle, cone);
        } else {
            traverse_bundle_trace(engine->kernel, map, target->volume, bundle);
        }
        for (size_t ray = 0; ray < bundle->count; ray++) {
            if (bundle->t[ray] == TRAVERSE_THERE) {
                settle_near(bundle, ray, target->volume);
            }
            keep_nearer(out, block->pixel[ray], bundle->t[ray], bundle->voxel[ray], bundle->object[ray]);
        }
    }
    return CONUS_OK;
}

static void aim_at_meshes(struct block *block)
{
    struct mesh_bundle *bundle = &block->meshes;
    bundle->count = block->bundle.count;
    bundle->origin = block->bundle.origin;
    bundle->direction = (const double(*)[MESH_RAYS_LIMIT])block->bundle.direction;
}

/* Called after trace_volumes(): a hit in a volume limits how far meshes are looked for. */
static conus_status trace_meshes(const struct rays_engine *engine, struct evidence *out, const struct cone *cone,
                                 struct block *block)
{
    struct mesh_bundle *bundle = &block->meshes;
    aim_at_meshes(block);
    for (size_t ray = 0; ray < bundle->count; ray++) {
        size_t pixel = block->pixel[ray];
        bundle->object[ray] = out->object[pixel];
        bundle->t[ray] = out->distance[pixel];
        bundle->triangle[ray] = out->voxel[pixel];
    }
    unsigned width = mesh_rays_width(engine->meshes, bundle->origin, cone->angle / cone->resolution);
    conus_status status = mesh_rays_trace(engine->meshes, bundle, width);
    for (size_t ray = 0; ray < bundle->count; ray++) {
        size_t pixel = block->pixel[ray];
        out->object[pixel] = bundle->object[ray];
        out->distance[pixel] = bundle->t[ray];
        out->voxel[pixel] = bundle->triangle[ray];
    }
    return status;
}

static void aim_at_tracts(struct block *block)
{
    struct tract_bundle *bundle = &block->tracts;
    bundle->count = block->bundle.count;
    bundle->origin = block->bundle.origin;
    bundle->direction = (const double(*)[TRACT_RAYS_LIMIT])block->bundle.direction;
}

/* Called after both: a hit in a volume or mesh limits how far streamlines are looked for. */
static void trace_tracts(const struct rays_engine *engine, struct evidence *out, struct block *block)
{
    struct tract_bundle *bundle = &block->tracts;
    aim_at_tracts(block);
    for (size_t ray = 0; ray < bundle->count; ray++) {
        size_t pixel = block->pixel[ray];
        bundle->object[ray] = out->object[pixel];
        bundle->t[ray] = out->distance[pixel];
        bundle->point[ray] = out->voxel[pixel];
    }
    tract_rays_trace(engine->tracts, bundle);
    for (size_t ray = 0; ray < bundle->count; ray++) {
        size_t pixel = block->pixel[ray];
        out->object[pixel] = bundle->object[ray];
        out->distance[pixel] = bundle->t[ray];
        out->voxel[pixel] = bundle->point[ray];
    }
}

/* Called for each block of a cone's rays. */
typedef conus_status block_step(const struct rays_engine *engine, void *out, const struct cone *cone,
                                struct block *block);

/* In blocks of `edge` times `edge` pixels. */
static conus_status for_blocks(const struct rays_engine *engine, void *out, const struct cone *cone, block_step *step,
                               uint32_t edge)
{
    struct block block;
    conus_status status = CONUS_OK;
    size_t most = (size_t)edge * edge;
    for (size_t first = 0; cone->tracing.rays && first < cone->tracing.rays->count && !status; first += most) {
        block_take(&block, cone, first, most);
        status = step(engine, out, cone, &block);
    }
    for (uint32_t row = 0; row < cone->resolution && !cone->tracing.rays && !status; row += edge) {
        for (uint32_t column = 0; column < cone->resolution && !status; column += edge) {
            block_init(&block, cone, column, row, edge);
            status = block.bundle.count ? step(engine, out, cone, &block) : CONUS_OK;
        }
    }
    return status;
}

/* Rays in a bundle for meshes and streamlines share one origin, so each ray of a cylinder is a bundle. */
static uint32_t shapes_edge(const struct cone *cone)
{
    return cone->radius > 0 ? 1 : BLOCK;
}

static conus_status trace_shapes(const struct rays_engine *engine, void *out, const struct cone *cone,
                                 struct block *block)
{
    conus_status status = engine->meshes ? trace_meshes(engine, out, cone, block) : CONUS_OK;
    if (!status && engine->tracts) {
        trace_tracts(engine, out, block);
    }
    return status;
}

conus_status engine_rays_trace_on(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    const struct rays_engine *rays = (const struct rays_engine *)engine;
    conus_status status = rays->target_count ? for_blocks(rays, out, cone, trace_volumes, BLOCK) : CONUS_OK;
    bool has_shapes = rays->meshes || rays->tracts;
    return status || !has_shapes ? status : for_blocks(rays, out, cone, trace_shapes, shapes_edge(cone));
}

/* The thread that reaches the limit makes the labelled maps; a volume that can have none goes on without. */
static void count_traced(struct rays_engine *engine, size_t rays)
{
    if (engine->sampling != CONUS_SAMPLING_EXACT || atomic_load_explicit(&engine->has_labelled, memory_order_acquire)) {
        return;
    }
    size_t before = atomic_fetch_add(&engine->traced, rays);
    if (before >= RAYS_WITHOUT_LABELS || before + rays < RAYS_WITHOUT_LABELS) {
        return;
    }
    for (size_t t = 0; t < engine->target_count; t++) {
        struct target *target = &engine->targets[t];
        labelled_map_init(&target->labelled, target->volume, &target->map);
    }
    atomic_store_explicit(&engine->has_labelled, true, memory_order_release);
}

static conus_status trace(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    evidence_clear(out);
    conus_status status = engine_rays_trace_on(engine, out, cone);
    count_traced((struct rays_engine *)engine, (size_t)cone->resolution * cone->resolution);
    return status;
}

/* The thread that reaches the limit makes the uniform maps. A volume that is too large, or for whose map there is no
 * memory, goes on without. */
static void count_pierced(struct rays_engine *engine, size_t rays)
{
    size_t before = atomic_fetch_add(&engine->pierced, rays);
    if (before >= RAYS_WITHOUT_UNIFORM || before + rays < RAYS_WITHOUT_UNIFORM) {
        return;
    }
    for (size_t t = 0; t < engine->target_count; t++) {
        struct target *target = &engine->targets[t];
        if (distance_map_codes(&target->map) <= UNIFORM_CODES && target->volume->voxel_count <= UNIFORM_CODES) {
            distance_map_init_uniform(&target->uniform, target->volume, &target->map);
        }
    }
    atomic_store_explicit(&engine->has_uniform, true, memory_order_release);
}

static conus_status pierce_volumes(const struct rays_engine *engine, void *out, const struct cone *cone,
                                   struct block *block)
{
    bool has_uniform = atomic_load_explicit(&engine->has_uniform, memory_order_acquire);
    conus_status status = CONUS_OK;
    block->bundle.from = NULL;
    for (size_t ray = 0; ray < block->bundle.count; ray++) {
        uint32_t i = (uint32_t)(block->pixel[ray] % cone->resolution);
        uint32_t j = (uint32_t)(block->pixel[ray] / cone->resolution);
        block->bundle.limit[ray] = cone_has_range(cone) ? cone->range[1] * cone_per_depth(cone, i, j) : INFINITY;
    }
    for (size_t t = 0; t < engine->target_count && !status; t++) {
        const struct target *target = &engine->targets[t];
        struct traverse_piercing piercing = {
            .uniform = has_uniform && target->uniform.codes ? &target->uniform : NULL,
            .volume = target->volume,
            .pixel = block->pixel,
            .out = out,
        };
        status = traverse_bundle_pierce(engine->kernel, &target->map, &piercing, &block->bundle);
    }
    return status;
}

static conus_status pierce_meshes(const struct rays_engine *engine, void *out, const struct cone *cone,
                                  struct block *block)
{
    (void)cone;
    aim_at_meshes(block);
    return mesh_rays_pierce(engine->meshes, &block->meshes, out, block->pixel);
}

static conus_status pierce_tracts(const struct rays_engine *engine, void *out, const struct cone *cone,
                                  struct block *block)
{
    (void)cone;
    aim_at_tracts(block);
    return tract_rays_pierce(engine->tracts, &block->tracts, out, block->pixel);
}

static size_t count_rays(const struct cone *cone)
{
    size_t pixels = (size_t)cone->resolution * cone->resolution;
    size_t count = cone->tracing.rays ? cone->tracing.rays->count : 0;
    for (size_t pixel = 0; pixel < pixels && !cone->tracing.rays; pixel++) {
        count += !cone->tracing.wanted || cone->tracing.wanted[pixel];
    }
    return count;
}

static conus_status pierce(struct engine *engine, struct layers *out, const struct cone *cone)
{
    struct rays_engine *rays = (struct rays_engine *)engine;
    conus_status status = rays->target_count ? for_blocks(rays, out, cone, pierce_volumes, BLOCK) : CONUS_OK;
    if (!status && rays->target_count && cone->resolution > 1) { /* lone rays need none */
        count_pierced(rays, count_rays(cone));
    }
    if (!status && rays->meshes) {
        struct mesh_intervals intervals = rays->intervals; /* of its own, since several threads may be here */
        status = for_blocks(rays, &intervals, cone, pierce_meshes, shapes_edge(cone));
        status = status ? status : mesh_intervals_pair(out, &intervals, cone);
        mesh_intervals_finish(&intervals);
    }
    return !status && rays->tracts ? for_blocks(rays, out, cone, pierce_tracts, shapes_edge(cone)) : status;
}

static conus_status add_meshes(struct rays_engine *engine, const conus_atlas *atlas)
{
    if (!atlas_has_meshes(atlas)) {
        return CONUS_OK;
    }
    struct mesh_object *objects = memory_zeroed(atlas->object_count, sizeof *objects);
    if (!objects) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < atlas->object_count; i++) {
        objects[i].mesh = atlas_object_mesh(atlas, (uint32_t)i + 1);
    }
    conus_status status = mesh_rays_create(&engine->meshes, objects, atlas->object_count);
    mesh_intervals_init(&engine->intervals, atlas);
    memory_free(objects);
    return status;
}

static conus_status add_bundles(struct rays_engine *engine, const conus_atlas *atlas)
{
    if (!atlas_has_bundles(atlas)) {
        return CONUS_OK;
    }
    size_t count = 0;
    struct tract_object *objects = memory_raw(atlas->object_count, sizeof *objects);
    if (!objects) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, number);
        if (tractogram && !atlas->places[number - 1].is_hidden) {
            objects[count++] = (struct tract_object){tractogram, atlas_bundle_group(atlas, number), number};
        }
    }
    conus_status status = tract_rays_create(&engine->tracts, objects, count);
    memory_free(objects);
    return status;
}

static conus_status add_target(struct rays_engine *engine, const struct volume *volume,
                               const struct engine_options *options)
{
    struct target *target = &engine->targets[engine->target_count];
    *target = (struct target){.volume = volume};
    target->slices = slices_of_id_pass(options->slices, options->slice_fraction, volume->info.dim);
    conus_status status = engine->sampling == CONUS_SAMPLING_EXACT ? distance_map_init(&target->map, volume) : CONUS_OK;
    engine->target_count += !status;
    return status;
}

static const struct engine_functions functions = {.trace = trace, .pierce = pierce, .destroy = destroy};

conus_status engine_rays_create_with(struct engine **out, const conus_atlas *atlas,
                                     const struct engine_options *options, const struct traverse_kernel *kernel)
{
    struct rays_engine *engine = memory_zeroed(1, sizeof *engine + atlas->volume_count * sizeof engine->targets[0]);
    if (!engine) {
        return CONUS_ERROR_MEMORY;
    }
    engine->base.functions = &functions;
    engine->sampling = options->sampling;
    engine->kernel = kernel;
    snprintf(engine->base.name, sizeof engine->base.name, "rays, %s", kernel->name);
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < atlas->volume_count && !status; i++) {
        if (volume_can_be_hit(&atlas->volumes[i])) {
            status = add_target(engine, &atlas->volumes[i], options);
        }
    }
    status = status ? status : add_meshes(engine, atlas);
    status = status ? status : add_bundles(engine, atlas);
    if (!status && engine->meshes && options->log && mesh_rays_load_embree()) {
        char line[256];
        snprintf(line, sizeof line, "%s: triangles are found more slowly", conus_message());
        options->log(options->log_user, &(conus_note){.severity = CONUS_SEVERITY_WARNING, .line = line});
    }
    if (status) {
        destroy(&engine->base);
        return status;
    }
    *out = &engine->base;
    return CONUS_OK;
}

conus_status engine_rays_create(struct engine **out, const conus_atlas *atlas, const struct engine_options *options)
{
    return engine_rays_create_with(out, atlas, options, traverse_best_kernel());
}

static conus_status create_for(struct engine **out, const conus_atlas *atlas,
                               conus_status (*add)(struct rays_engine *engine, const conus_atlas *atlas))
{
    struct rays_engine *engine = memory_zeroed(1, sizeof *engine);
    if (!engine) {
        return CONUS_ERROR_MEMORY;
    }
    engine->base.functions = &functions;
    conus_status status = add(engine, atlas);
    if (status) {
        destroy(&engine->base);
        return status;
    }
    *out = &engine->base;
    return CONUS_OK;
}

conus_status engine_rays_create_for_meshes(struct engine **out, const conus_atlas *atlas)
{
    return create_for(out, atlas, add_meshes);
}

conus_status engine_rays_create_for_bundles(struct engine **out, const conus_atlas *atlas)
{
    return create_for(out, atlas, add_bundles);
}
