/* SPDX-License-Identifier: BSD-3-Clause */
/* The gl engine: the GPU finds hits and crossings, which become evidence and layers here. */
#include "selection/engine/engine.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/gl/gl.h"
#include "render/passes/id_pass.h"
#include "selection/engine/triangles/mesh_rays.h"
#include "selection/engine/voxels/traverse.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

/* Rays that are traced in step lie in such a part of the buffer. */
enum { TILE_WIDTH = 4, TILE_HEIGHT = 2, RAYS_AT_ONCE = 64 };

struct gl_engine {
    struct engine base;
    pthread_mutex_t lock; /* held by the thread that has the context */
    const conus_atlas *atlas;
    struct gl_context *context;
    struct id_pass *pass;        /* NULL where there are no volumes to select from */
    struct mesh_pass *mesh_pass; /* NULL where there are no meshes                 */
    struct engine *wide;         /* what finds meshes in wide cones; NULL before the first one */
    struct engine *bundles;      /* what finds streamlines; NULL where there are none */
    struct mesh_ray *rays;       /* of all pixels of all cones in view */
    uint32_t *traced;            /* [ray_count] pixels whose rays are traced through volumes, neighbours together */
    struct mesh_query *queries;
    size_t ray_capacity, traced_capacity, query_capacity;
    uint32_t ray_count;
    struct mesh_intervals intervals;
    struct engine_options options;
    size_t *volumes; /* [volume_count] of the atlas, in the order in which the pass has them */
    size_t volume_count;
};

static void destroy(struct engine *engine)
{
    struct gl_engine *gl = (struct gl_engine *)engine;
    struct gl_current previous = {0};
    if (gl->context && !gl_context_use(gl->context, &previous)) {
        id_pass_destroy(gl->pass);
        mesh_pass_destroy(gl->mesh_pass);
        gl_current_restore(&previous);
    }
    gl_context_destroy(gl->context);
    engine_destroy(gl->wide);
    engine_destroy(gl->bundles);
    mesh_intervals_finish(&gl->intervals);
    memory_free(gl->rays);
    memory_free(gl->traced);
    memory_free(gl->queries);
    memory_free(gl->volumes);
    pthread_mutex_destroy(&gl->lock);
    memory_free(gl);
}

/* Waits for threads that are in there. */
static conus_status enter(struct gl_engine *gl, struct gl_current *previous)
{
    *previous = (struct gl_current){0};
    pthread_mutex_lock(&gl->lock);
    conus_status status = gl_context_use(gl->context, previous);
    if (status) {
        pthread_mutex_unlock(&gl->lock);
    }
    return status;
}

static void leave(struct gl_engine *gl, const struct gl_current *previous)
{
    gl_current_restore(previous);
    pthread_mutex_unlock(&gl->lock);
}

/* The cones of one trace, all of one resolution, and where their answers go (NULL when it is layers). */
struct view {
    const struct cone *const *cones;
    struct evidence *const *out;
    size_t count;
    uint32_t pixels; /* of a cone */
};

static struct view view_of(const struct cone *const *cones, struct evidence *const *out, size_t count)
{
    return (struct view){cones, out, count, cones[0]->resolution * cones[0]->resolution};
}

/* Lists the wanted pixels of all cones, tile by tile. */
static conus_status list_traced(struct gl_engine *gl, const struct view *view)
{
    const uint32_t n = view->cones[0]->resolution;
    const uint32_t across = (n + TILE_WIDTH - 1) / TILE_WIDTH;
    const uint32_t tiles = across * ((n + TILE_HEIGHT - 1) / TILE_HEIGHT);
    if (!memory_reserve(&gl->traced, &gl->traced_capacity, view->count * view->pixels, sizeof *gl->traced)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t c = 0; c < view->count; c++) {
        const bool *wanted = view->cones[c]->tracing.wanted;
        for (uint32_t k = 0; k < tiles * TILE_WIDTH * TILE_HEIGHT; k++) {
            uint32_t tile = k / (TILE_WIDTH * TILE_HEIGHT);
            uint32_t i = tile % across * TILE_WIDTH + k % TILE_WIDTH;
            uint32_t j = tile / across * TILE_HEIGHT + k / TILE_WIDTH % TILE_HEIGHT;
            if (i < n && j < n && (!wanted || wanted[j * n + i])) {
                gl->traced[gl->ray_count++] = (uint32_t)c * view->pixels + j * n + i;
            }
        }
    }
    return CONUS_OK;
}

/* Makes the rays of all pixels, in the world. */
static conus_status make_rays(struct gl_engine *gl, const struct view *view)
{
    const uint32_t n = view->cones[0]->resolution;
    if (!memory_reserve(&gl->rays, &gl->ray_capacity, view->count * view->pixels, sizeof *gl->rays)) {
        return CONUS_ERROR_MEMORY;
    }
    struct mesh_ray *ray = gl->rays;
    for (size_t first = 0, count; first < view->count * view->pixels; first += count) {
        const struct cone *cone = view->cones[first / view->pixels];
        const uint32_t pixel = (uint32_t)(first % view->pixels);
        double u[RAYS_AT_ONCE], v[RAYS_AT_ONCE], x[RAYS_AT_ONCE], y[RAYS_AT_ONCE], z[RAYS_AT_ONCE];
        count = view->pixels - pixel < RAYS_AT_ONCE ? view->pixels - pixel : RAYS_AT_ONCE;
        for (uint32_t k = 0; k < count; k++) {
            u[k] = cone_coordinate((pixel + k) % n, n);
            v[k] = cone_coordinate((pixel + k) / n, n);
        }
        cone_rays((double *const[]){x, y, z}, cone, u, v, count);
        for (uint32_t k = 0; k < count; k++, ray++) {
            memcpy(ray->direction, (const double[]){x[k], y[k], z[k]}, sizeof ray->direction);
            cone_origin(ray->origin, cone, (pixel + k) % n, (pixel + k) / n);
        }
    }
    return CONUS_OK;
}

/* Lists the rays through volumes, and makes all. */
static conus_status aim(struct gl_engine *gl, const struct view *view)
{
    gl->ray_count = 0;
    conus_status status = gl->pass ? list_traced(gl, view) : CONUS_OK;
    return !status && (gl->mesh_pass || gl->ray_count) ? make_rays(gl, view) : status;
}

/* Sets the planes (Eq. 7) of the rays of one cone. */
static void prepare_planes(const struct gl_engine *gl, const struct volume *volume, const struct cone *cone,
                           struct id_ray *rays, const uint32_t *traced, size_t count)
{
    const size_t *dim = volume->info.dim;
    double axis[3];
    vec3_scale(axis, cone->pose.world_from_device + 8, -1); /* the device looks down its -z */
    struct slices slices = slices_over(dim, volume->info.world_from_voxel, cone->pose.world_from_device + 12, axis,
                                       slices_of_id_pass(gl->options.slices, gl->options.slice_fraction, dim));
    for (size_t r = 0; r < count; r++) {
        double per_depth = 1 / vec3_dot(gl->rays[traced[r]].direction, axis);
        rays[r].planes.start = slices.start;
        rays[r].planes.spacing = slices.spacing;
        rays[r].planes.count = per_depth > 0 ? slices.count : 0; /* none is before a ray that goes back */
        rays[r].planes.per_depth = per_depth;
    }
}

/* The rays in the index space of volume number `index` of the pass. */
static conus_status prepare_rays(struct gl_engine *gl, size_t index, const struct view *view)
{
    const struct volume *volume = &gl->atlas->volumes[gl->volumes[index]];
    struct id_ray *rays = id_pass_rays(gl->pass);
    if (!rays) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t r = 0; r < gl->ray_count; r++) {
        double origin[3];
        double direction[3];
        mat4_point(origin, volume->voxel_from_world, gl->rays[gl->traced[r]].origin);
        mat4_direction(direction, volume->voxel_from_world, gl->rays[gl->traced[r]].direction);
        if (gl->options.sampling == CONUS_SAMPLING_EXACT) {
            struct traverse_ray ray;
            traverse_ray_init(&ray, origin, direction);
            memcpy(rays[r].origin, ray.origin, sizeof rays[r].origin);
            memcpy(rays[r].direction, ray.direction, sizeof rays[r].direction);
            memcpy(rays[r].inverse, ray.inverse, sizeof rays[r].inverse);
        } else {
            memcpy(rays[r].origin, origin, sizeof origin);
            memcpy(rays[r].direction, direction, sizeof direction);
        }
    }
    for (uint32_t first = 0, end; first < gl->ray_count && gl->options.sampling == CONUS_SAMPLING_SLICES; first = end) {
        uint32_t c = gl->traced[first] / view->pixels;
        for (end = first; end < gl->ray_count && gl->traced[end] / view->pixels == c;) {
            end++;
        }
        prepare_planes(gl, volume, view->cones[c], rays + first, gl->traced + first, end - first);
    }
    return CONUS_OK;
}

static uint64_t linear_index(const conus_atlas *atlas, uint32_t object, const uint32_t cell[3])
{
    bool blocked = object == VOLUME_BLOCKER;
    const size_t *dim = (blocked ? atlas_context(atlas) : atlas_object_volume(atlas, object))->info.dim;
    return cell[0] + dim[0] * (cell[1] + dim[1] * (uint64_t)cell[2]);
}

static conus_status trace_volumes(struct gl_engine *gl, const struct view *view)
{
    const struct id_hit *hits = NULL;
    conus_status status = id_pass_begin(gl->pass, gl->ray_count);
    for (size_t i = 0; i < gl->volume_count && !status; i++) {
        status = prepare_rays(gl, i, view);
        status = status ? status : id_pass_trace(gl->pass, i);
    }
    status = status ? status : id_pass_read(gl->pass, &hits);
    for (uint32_t r = 0; r < gl->ray_count && !status; r++) {
        struct evidence *out = view->out[gl->traced[r] / view->pixels];
        uint32_t pixel = gl->traced[r] % view->pixels;
        if (hits[r].identifier) {
            out->object[pixel] = hits[r].identifier;
            out->distance[pixel] = hits[r].distance + 0.0; /* -0 becomes 0 */
            out->voxel[pixel] = linear_index(gl->atlas, hits[r].identifier, hits[r].cell);
        }
    }
    return status;
}

static struct mesh_view mesh_view_of(const struct cone *cone)
{
    return (struct mesh_view){cone->pose.world_from_device, tan(cone->angle / 2), cone->radius, cone->resolution};
}

/* To the rays of pixels that are not wanted. */
static void set_distances(struct evidence *out, const struct cone *cone, double distance)
{
    size_t pixels = (size_t)cone->resolution * cone->resolution;
    for (size_t pixel = 0; cone->tracing.wanted && pixel < pixels; pixel++) {
        if (!cone->tracing.wanted[pixel]) {
            out->distance[pixel] = distance;
        }
    }
}

/* Wide cones are no perspective picture, which is all that a driver can draw: there the rays engine finds the meshes
 * (Eq. 15), with the same answers. */
static conus_status prepare_wide(struct gl_engine *gl)
{
    return gl->wide ? CONUS_OK : engine_rays_create_for_meshes(&gl->wide, gl->atlas);
}

/* Sets the queries of the cones that are not wide, and traces the meshes in those that are. */
static conus_status prepare_queries(struct gl_engine *gl, const struct view *view, size_t *count)
{
    conus_status status = CONUS_OK;
    *count = 0;
    if (!memory_reserve(&gl->queries, &gl->query_capacity, view->count, sizeof *gl->queries)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t c = 0; c < view->count && !status; c++) {
        struct evidence *out = view->out[c];
        const struct mesh_pixels pixels = {gl->rays + c * view->pixels, out->object, out->distance, out->voxel};
        if (cone_is_wide(view->cones[c])) {
            status = prepare_wide(gl);
            status = status ? status : engine_rays_trace_on(gl->wide, out, view->cones[c]);
        } else {
            gl->queries[(*count)++] = (struct mesh_query){mesh_view_of(view->cones[c]), pixels};
            set_distances(out, view->cones[c], 0);
        }
    }
    return status;
}

/* Called after trace_volumes(): a hit in a volume limits how far meshes are looked for. Where no pixel is wanted,
 * nothing is looked for. */
static conus_status trace_meshes(struct gl_engine *gl, const struct view *view)
{
    size_t count;
    conus_status status = prepare_queries(gl, view, &count);
    status = !status && count ? mesh_pass_render(gl->mesh_pass, gl->queries, count) : status;
    for (size_t c = 0; c < view->count; c++) {
        set_distances(view->out[c], view->cones[c], INFINITY);
    }
    return status;
}

/* Called after both: a hit in a volume or mesh limits how far streamlines are looked for. */
static conus_status trace_tracts(struct gl_engine *gl, const struct view *view)
{
    conus_status status = CONUS_OK;
    for (size_t c = 0; c < view->count && !status; c++) {
        status = engine_rays_trace_on(gl->bundles, view->out[c], view->cones[c]);
    }
    return status;
}

static conus_status trace_many(struct engine *engine, struct evidence *const *out, const struct cone *const *cones,
                               size_t count)
{
    struct gl_engine *gl = (struct gl_engine *)engine;
    const struct view view = view_of(cones, out, count);
    struct gl_current previous;
    conus_status status = enter(gl, &previous);
    if (status) {
        return status;
    }
    for (size_t c = 0; c < count; c++) {
        evidence_clear(out[c]);
    }
    status = aim(gl, &view);
    status = !status && gl->ray_count ? trace_volumes(gl, &view) : status;
    status = !status && gl->mesh_pass ? trace_meshes(gl, &view) : status;
    status = !status && gl->bundles ? trace_tracts(gl, &view) : status;
    leave(gl, &previous);
    return status;
}

static conus_status trace(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    return trace_many(engine, &out, &cone, 1);
}

struct piercing {
    struct gl_engine *gl;
    struct layers *out;
};

static conus_status take_intervals(void *user, const struct id_interval *intervals, uint32_t count)
{
    const struct piercing *piercing = user;
    conus_status status = CONUS_OK;
    for (uint32_t i = 0; i < count && !status; i++) {
        const struct id_interval *found = &intervals[i];
        const conus_interval interval = {piercing->gl->traced[found->ray], found->identifier, found->entry + 0.0,
                                         found->exit + 0.0, /* -0 becomes 0 */
                                         linear_index(piercing->gl->atlas, found->identifier, found->cell)};
        status = layers_add(piercing->out, &interval);
    }
    return status;
}

static conus_status pierce_volumes(struct gl_engine *gl, struct layers *out, const struct view *view)
{
    struct piercing piercing = {gl, out};
    conus_status status = id_pass_begin(gl->pass, gl->ray_count);
    for (size_t i = 0; i < gl->volume_count && !status; i++) {
        status = prepare_rays(gl, i, view);
        status = status ? status : id_pass_pierce(gl->pass, i, take_intervals, &piercing);
    }
    return status;
}

static conus_status take_hit(void *user, const struct mesh_pass_hit *hit)
{
    struct gl_engine *gl = user;
    const struct mesh *mesh = atlas_object_mesh(gl->atlas, hit->object);
    const struct mesh_ray *ray = &gl->rays[hit->pixel];
    int side = 0;
    double t = mesh_crossing(&side, mesh, hit->triangle, ray->origin, ray->direction);
    const struct crossing crossing = {hit->pixel, hit->object, hit->triangle, side, t};
    return t >= 0 ? mesh_intervals_add(&gl->intervals, &crossing) : CONUS_OK;
}

static conus_status pierce_meshes(struct gl_engine *gl, struct layers *out, const struct cone *cone)
{
    const struct mesh_view view = mesh_view_of(cone);
    if (cone_is_wide(cone)) {
        conus_status status = prepare_wide(gl);
        return status ? status : gl->wide->functions->pierce(gl->wide, out, cone);
    }
    conus_status status = mesh_pass_pierce(gl->mesh_pass, &view, take_hit, gl);
    status = status ? status : mesh_intervals_pair(out, &gl->intervals, cone);
    gl->intervals.count = 0;
    return status;
}

static conus_status pierce(struct engine *engine, struct layers *out, const struct cone *cone)
{
    struct gl_engine *gl = (struct gl_engine *)engine;
    const struct view view = view_of(&cone, NULL, 1);
    struct gl_current previous;
    conus_status status = enter(gl, &previous);
    if (status) {
        return status;
    }
    status = aim(gl, &view);
    status = !status && gl->ray_count ? pierce_volumes(gl, out, &view) : status;
    status = !status && gl->mesh_pass ? pierce_meshes(gl, out, cone) : status;
    status = !status && gl->bundles ? gl->bundles->functions->pierce(gl->bundles, out, cone) : status;
    leave(gl, &previous);
    return status;
}

/* Identifiers are the objects' numbers: dense, from 1, integers all the way. The one behind them stands for what
 * blocks. */
static conus_status create_pass(struct gl_engine *gl)
{
    size_t count = gl->atlas->object_count + 2;
    uint32_t *identifiers = memory_raw(count, sizeof *identifiers);
    if (!identifiers) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        identifiers[i] = (uint32_t)i;
    }
    identifiers[count - 1] = VOLUME_BLOCKER;
    conus_status status = id_pass_create(&gl->pass, gl->options.sampling, identifiers, count);
    memory_free(identifiers);
    return status;
}

static conus_status make_codes(uint8_t **out, const struct distance_map *map)
{
    uint8_t *codes = memory_raw(map->dim[0] * map->dim[1] * map->dim[2], 1);
    size_t at = 0;
    for (size_t k = 0; k < map->dim[2] && codes; k++) {
        for (size_t j = 0; j < map->dim[1]; j++) {
            for (size_t i = 0; i < map->dim[0]; i++) {
                codes[at++] = map->codes[distance_map_at(map, i, j, k)];
            }
        }
    }
    *out = codes;
    return codes ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status upload_volume(struct gl_engine *gl, const struct volume *volume, uint64_t *memory_left)
{
    struct volume spread = {0};
    struct distance_map map = {0};
    struct id_distances distances = {0};
    uint8_t *codes = NULL;
    conus_status status = CONUS_OK;
    if (volume->step_count) { /* textures are dense */
        status = volume_spread(&spread, volume, (const size_t[3]){0}, volume->info.dim);
        memcpy(spread.voxel_from_world, volume->voxel_from_world, sizeof spread.voxel_from_world);
        volume = &spread;
    }
    if (!status && gl->options.sampling == CONUS_SAMPLING_EXACT) {
        status = distance_map_init(&map, volume);
        status = status ? status : make_codes(&codes, &map);
        distances.codes = codes;
        for (int a = 0; a < 3; a++) {
            distances.box[0][a] = (int)map.first[a];
            distances.box[1][a] = (int)map.last[a];
        }
    }
    status = status ? status : id_pass_add_volume(gl->pass, volume, &distances, memory_left);
    memory_free(codes);
    distance_map_finish(&map);
    volume_finish(&spread);
    return status;
}

static conus_status upload_meshes(struct gl_engine *gl, uint64_t *memory_left)
{
    const struct mesh **meshes = memory_raw(gl->atlas->object_count, sizeof(void *));
    if (!meshes) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < gl->atlas->object_count; i++) {
        meshes[i] = atlas_object_mesh(gl->atlas, (uint32_t)i + 1);
    }
    conus_status status = mesh_pass_create(&gl->mesh_pass, meshes, gl->atlas->object_count, memory_left);
    memory_free(meshes);
    return status;
}

static conus_status fill_engine(struct gl_engine *gl)
{
    gl->volumes = memory_raw(gl->atlas->volume_count, sizeof *gl->volumes);
    conus_status status = gl->volumes ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : gl_context_create(&gl->context, gl->options.log, gl->options.log_user);
    if (status) {
        return status;
    }
    snprintf(gl->base.name, sizeof gl->base.name, "gl, %s", gl_context_renderer(gl->context));
    struct gl_current previous = {0};
    status = gl_context_use(gl->context, &previous);
    if (status) {
        return status;
    }
    uint64_t memory_left = memory_limit(0);
    for (size_t i = 0; i < gl->atlas->volume_count && !status; i++) {
        if (volume_can_be_hit(&gl->atlas->volumes[i])) {
            status = gl->pass ? CONUS_OK : create_pass(gl);
            status = status ? status : upload_volume(gl, &gl->atlas->volumes[i], &memory_left);
            gl->volumes[gl->volume_count] = i;
            gl->volume_count += !status;
        }
    }
    status = !status && atlas_has_meshes(gl->atlas) ? upload_meshes(gl, &memory_left) : status;
    status = !status && atlas_has_bundles(gl->atlas) ? engine_rays_create_for_bundles(&gl->bundles, gl->atlas) : status;
    gl_current_restore(&previous);
    return status;
}

conus_status engine_gl_create(struct engine **out, const conus_atlas *atlas, const struct engine_options *options)
{
    static const struct engine_functions functions = {
        .trace = trace, .trace_many = trace_many, .pierce = pierce, .destroy = destroy};
    struct gl_engine *gl = memory_zeroed(1, sizeof *gl);
    if (!gl) {
        return CONUS_ERROR_MEMORY;
    }
    gl->base.functions = &functions;
    pthread_mutex_init(&gl->lock, NULL);
    gl->atlas = atlas;
    gl->options = *options;
    mesh_intervals_init(&gl->intervals, atlas);
    conus_status status = fill_engine(gl);
    if (status) {
        destroy(&gl->base);
        return status;
    }
    *out = &gl->base;
    return CONUS_OK;
}
