/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/evidence.h"

#include "base/math3.h"
#include "base/memory.h"
#include "render/context.h"
#include "render/id_pass.h"
#include "render/mesh_pass.h"
#include "selection/mesh_spans.h"
#include "selection/traverse.h"

#include <stdio.h>
#include <string.h>

static const uint64_t memory_limit = (uint64_t)8 << 30;

struct gl_engine {
    struct engine base;
    const conus_atlas *atlas;
    struct gl_context *context;
    struct id_pass *pass;        /* NULL where there are no volumes to select from */
    struct mesh_pass *mesh_pass; /* NULL where there are no meshes                 */
    double (*origins)[3];        /* [resolution^2] of the mesh pass; and           */
    double (*directions)[3];
    uint32_t resolution;
    struct mesh_spans spans;
    conus_sampling sampling;
    uint32_t slices;
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
    mesh_spans_finish(&gl->spans);
    memory_free(gl->origins);
    memory_free(gl->directions);
    memory_free(gl->volumes);
    memory_free(gl);
}

/* ---- A look ------------------------------------------------------------------------------------------------- */

static void view_axis(double out[3], const struct cone *cone)
{
    vec3_scale(out, cone->pose.world_from_device + 8, -1); /* the device looks down its -z */
}

static void prepare_ray(struct id_ray *out, const double origin[3], const double direction[3], conus_sampling sampling)
{
    struct traverse_ray ray;
    traverse_ray_init(&ray, origin, direction);
    bool exact = sampling == CONUS_EXACT;
    memcpy(out->origin, exact ? ray.origin : origin, sizeof out->origin);
    memcpy(out->direction, exact ? ray.direction : direction, sizeof out->direction);
    memcpy(out->inverse, ray.inverse, sizeof out->inverse);
}

static void prepare_rays(struct gl_engine *gl, const struct volume *volume, const struct cone *cone)
{
    struct id_ray *rays = id_pass_rays(gl->pass);
    uint32_t n = cone->resolution;
    double axis[3];
    view_axis(axis, cone);
    for (uint32_t pixel = 0; pixel < n * n; pixel++) {
        double origin[3];
        double direction[3];
        cone_origin(origin, cone, pixel % n, pixel / n);
        cone_ray(direction, cone, pixel % n, pixel / n);
        rays[pixel].per_depth = 1 / vec3_dot(direction, axis);
        mat4_point(origin, volume->voxel_from_world, origin);
        mat4_direction(direction, volume->voxel_from_world, direction);
        prepare_ray(&rays[pixel], origin, direction, gl->sampling);
    }
}

static conus_status draw(struct gl_engine *gl, const struct cone *cone)
{
    double axis[3];
    view_axis(axis, cone);
    conus_status status = id_pass_begin(gl->pass, cone->resolution);
    for (size_t i = 0; i < gl->volume_count && !status; i++) {
        const struct volume *volume = &gl->atlas->volumes[gl->volumes[i]];
        const size_t *dim = volume->info.dim;
        struct slices slices = slices_over(dim, volume->info.world_from_voxel, cone->pose.world_from_device + 12, axis,
                                           slices_of_id_pass(gl->slices, dim));
        prepare_rays(gl, volume, cone);
        status = id_pass_draw(gl->pass, i, &slices);
    }
    return status;
}

static uint64_t linear_index(const conus_atlas *atlas, uint32_t object, uint64_t i, uint64_t j, uint64_t k)
{
    bool blocked = object == VOLUME_BLOCKER;
    const size_t *dim = (blocked ? atlas_context(atlas) : atlas_object_volume(atlas, object))->info.dim;
    return i + dim[0] * (j + dim[1] * k);
}

static conus_status look_at_volumes(struct gl_engine *gl, struct evidence *out, const struct cone *cone)
{
    struct id_pixels pixels = {0};
    conus_status status = draw(gl, cone);
    status = status ? status : id_pass_read(gl->pass, &pixels);
    for (size_t i = 0; i < (size_t)cone->resolution * cone->resolution && !status; i++) {
        uint32_t object = pixels.identifiers[i];
        if (object) {
            out->object[i] = object;
            out->distance[i] = pixels.distances[i];
            const float *voxel = pixels.voxels[i];
            out->voxel[i] = linear_index(gl->atlas, object, (uint64_t)voxel[0], (uint64_t)voxel[1], (uint64_t)voxel[2]);
        }
    }
    return status;
}

static conus_status reserve_pixels(struct gl_engine *gl, uint32_t resolution)
{
    size_t pixels = (size_t)resolution * resolution;
    if (gl->resolution == resolution) {
        return CONUS_OK;
    }
    gl->resolution = 0;
    memory_free(gl->origins);
    memory_free(gl->directions);
    gl->origins = memory_raw(pixels, sizeof *gl->origins);
    gl->directions = memory_raw(pixels, sizeof *gl->directions);
    if (!gl->origins || !gl->directions) {
        return CONUS_ERROR_MEMORY;
    }
    gl->resolution = resolution;
    return CONUS_OK;
}

/* The rays of the mesh pass, and its view. */
static conus_status prepare_view(struct mesh_view *out, struct gl_engine *gl, const struct cone *cone)
{
    uint32_t n = cone->resolution;
    conus_status status = reserve_pixels(gl, n);
    for (uint32_t pixel = 0; pixel < n * n && !status; pixel++) {
        cone_origin(gl->origins[pixel], cone, pixel % n, pixel / n);
        cone_ray(gl->directions[pixel], cone, pixel % n, pixel / n);
    }
    *out = (struct mesh_view){cone->pose.world_from_device, tan(cone->angle / 2), cone->radius, n};
    return status;
}

/* Behind look_at_volumes(): what the volumes show limits how far the meshes are looked for. */
static conus_status look_at_meshes(struct gl_engine *gl, struct evidence *out, const struct cone *cone)
{
    struct mesh_view view;
    conus_status status = prepare_view(&view, gl, cone);
    if (status) {
        return status;
    }
    const struct mesh_pixels pixels = {(const double(*)[3])gl->origins, (const double(*)[3])gl->directions, out->object,
                                       out->distance, out->voxel};
    return mesh_pass_look(gl->mesh_pass, &view, &pixels);
}

static conus_status look(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    struct gl_engine *gl = (struct gl_engine *)engine;
    struct gl_current previous = {0};
    conus_status status = gl_context_use(gl->context, &previous);
    if (status) {
        return status;
    }
    evidence_clear(out);
    status = gl->pass ? look_at_volumes(gl, out, cone) : CONUS_OK;
    status = !status && gl->mesh_pass ? look_at_meshes(gl, out, cone) : status;
    gl_current_restore(&previous);
    return status;
}

/* ---- All layers --------------------------------------------------------------------------------------------- */

struct piercing {
    struct gl_engine *gl;
    struct layers *out;
};

static conus_status take_pieces(void *user, const struct id_piece *pieces, uint32_t count)
{
    const struct piercing *piercing = user;
    conus_status status = CONUS_OK;
    for (uint32_t i = 0; i < count && !status; i++) {
        const struct id_piece *piece = &pieces[i];
        const conus_span span = {
            piece->pixel, piece->identifier, piece->entry, piece->exit,
            linear_index(piercing->gl->atlas, piece->identifier, piece->cell[0], piece->cell[1], piece->cell[2])};
        status = layers_add(piercing->out, &span);
    }
    return status;
}

static conus_status pierce_volumes(struct gl_engine *gl, struct layers *out, const struct cone *cone)
{
    struct piercing piercing = {gl, out};
    conus_status status = id_pass_begin(gl->pass, cone->resolution);
    for (size_t i = 0; i < gl->volume_count && !status; i++) {
        prepare_rays(gl, &gl->atlas->volumes[gl->volumes[i]], cone);
        status = id_pass_pierce(gl->pass, i, take_pieces, &piercing);
    }
    return status;
}

static conus_status take_hit(void *user, const struct mesh_pass_hit *hit)
{
    struct gl_engine *gl = user;
    const struct mesh *mesh = atlas_object_mesh(gl->atlas, hit->object);
    int side = 0;
    double t = mesh_crossing(&side, mesh, hit->triangle, gl->origins[hit->pixel], gl->directions[hit->pixel]);
    const struct crossing crossing = {hit->pixel, hit->object, hit->triangle, side, t};
    return t >= 0 ? mesh_spans_add(&gl->spans, &crossing) : CONUS_OK;
}

static conus_status pierce_meshes(struct gl_engine *gl, struct layers *out, const struct cone *cone)
{
    struct mesh_view view;
    conus_status status = prepare_view(&view, gl, cone);
    status = status ? status : mesh_pass_pierce(gl->mesh_pass, &view, take_hit, gl);
    status = status ? status : mesh_spans_pair(out, &gl->spans, cone);
    gl->spans.count = 0;
    return status;
}

static conus_status pierce(struct engine *engine, struct layers *out, const struct cone *cone)
{
    struct gl_engine *gl = (struct gl_engine *)engine;
    struct gl_current previous = {0};
    conus_status status = gl_context_use(gl->context, &previous);
    if (status) {
        return status;
    }
    status = gl->pass ? pierce_volumes(gl, out, cone) : CONUS_OK;
    status = !status && gl->mesh_pass ? pierce_meshes(gl, out, cone) : status;
    gl_current_restore(&previous);
    return status;
}

/* ---- Creation ----------------------------------------------------------------------------------------------- */

/* Identifiers are the objects' numbers: dense, from 1, integers all the way; behind them that of what blocks. */
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
    conus_status status = id_pass_create(&gl->pass, gl->sampling, identifiers, count);
    memory_free(identifiers);
    return status;
}

static conus_status upload_volumes(struct gl_engine *gl, uint64_t *memory_left)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < gl->atlas->volume_count && !status; i++) {
        if (volume_is_met(&gl->atlas->volumes[i])) {
            status = gl->pass ? CONUS_OK : create_pass(gl);
            status = status ? status : id_pass_add_volume(gl->pass, &gl->atlas->volumes[i], memory_left);
            gl->volumes[gl->volume_count] = i;
            gl->volume_count += !status;
        }
    }
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

static conus_status fill(struct gl_engine *gl, const struct engine_options *options)
{
    gl->volumes = memory_raw(gl->atlas->volume_count, sizeof *gl->volumes);
    if (!gl->volumes) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = gl_context_create(&gl->context, options->log, options->log_user);
    if (status) {
        return status;
    }
    snprintf(gl->base.name, sizeof gl->base.name, "gl, %s", gl_context_renderer(gl->context));
    struct gl_current previous = {0};
    status = gl_context_use(gl->context, &previous);
    if (status) {
        return status;
    }
    uint64_t memory_left = memory_limit;
    status = upload_volumes(gl, &memory_left);
    status = !status && gl->atlas->mesh_count ? upload_meshes(gl, &memory_left) : status;
    gl_current_restore(&previous);
    return status;
}

conus_status engine_gl_create(struct engine **out, const conus_atlas *atlas, const struct engine_options *options)
{
    static const struct engine_functions functions = {.look = look, .pierce = pierce, .destroy = destroy};
    struct gl_engine *gl = memory_zeroed(1, sizeof *gl);
    if (!gl) {
        return CONUS_ERROR_MEMORY;
    }
    gl->base.functions = &functions;
    gl->atlas = atlas;
    gl->sampling = options->sampling;
    gl->slices = options->slices;
    mesh_spans_init(&gl->spans, atlas);
    conus_status status = fill(gl, options);
    if (status) {
        destroy(&gl->base);
        return status;
    }
    *out = &gl->base;
    return CONUS_OK;
}
