/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays through surfaces, whoever finds the triangles. */
#include "base/memory.h"
#include "selection/engine/triangles/mesh_tracer.h"

/* Part of the scene's size: far more than single precision can move a hit, far less than anything that matters. */
#define SLACK 1e-5

/* Keeps what mesh_tracer_distance() needs of every object. */
static conus_status keep_surfaces(struct mesh_rays *rays, const struct mesh_object *objects, size_t count)
{
    bool placed = false;
    for (size_t i = 0; i < count; i++) {
        placed = placed || objects[i].world_from_mesh;
    }
    rays->surfaces = memory_zeroed(count, sizeof *rays->surfaces);
    rays->mesh_from_world = placed ? memory_raw(count, sizeof *rays->mesh_from_world) : NULL;
    if (!rays->surfaces || (placed && !rays->mesh_from_world)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        const double *place = objects[i].world_from_mesh;
        const struct mesh *mesh = objects[i].mesh;
        rays->surfaces[i] = (struct surface){.mesh = mesh, .mesh_from_world = place ? rays->mesh_from_world[i] : NULL};
        if (mesh) {
            rays->surfaces[i].triangles = mesh->triangles;
            rays->surfaces[i].positions = mesh->positions;
        }
        if (place && !mat4_invert_affine(rays->mesh_from_world[i], place)) {
            return fail(CONUS_ERROR_ARGUMENT, "object %zu: its matrix cannot be inverted", i + 1);
        }
    }
    return CONUS_OK;
}

/* Lets the bounds of everything hold the corners of a box round the mesh, at its place. */
static void extend_bounds(struct mesh_rays *rays, const struct mesh_object *object)
{
    struct box3 box = box3_empty();
    for (size_t i = 0; i < 3 * object->mesh->triangle_count; i++) {
        const float *corner = object->mesh->positions + 3 * (size_t)object->mesh->triangles[i];
        box3_add(&box, (const double[3]){(double)corner[0], (double)corner[1], (double)corner[2]});
    }
    box = object->world_from_mesh ? box3_image(&box, object->world_from_mesh) : box;
    box3_join(&rays->bounds, box.low, box.high);
}

conus_status mesh_rays_create_with(struct mesh_rays **out, const struct mesh_tracer *tracer,
                                   const struct mesh_object *objects, size_t count)
{
    struct mesh_rays *rays = memory_zeroed(1, sizeof *rays);
    if (!rays) {
        return CONUS_ERROR_MEMORY;
    }
    *rays = (struct mesh_rays){.tracer = tracer, .bounds = box3_empty()};
    size_t triangles = 0;
    double reach = 0;
    double volume = 1;
    for (size_t i = 0; i < count; i++) {
        if (objects[i].mesh) {
            triangles += objects[i].mesh->triangle_count;
            extend_bounds(rays, &objects[i]);
        }
    }
    for (int a = 0; a < 3; a++) {
        volume *= rays->bounds.high[a] - rays->bounds.low[a];
        reach = fmax(reach, fmax(fabs(rays->bounds.low[a]), fabs(rays->bounds.high[a])));
    }
    rays->slack = SLACK * reach;
    rays->cell = cbrt(volume / (double)triangles);
    conus_status status = keep_surfaces(rays, objects, count);
    status = status ? status : tracer->create(rays, objects, count);
    if (status) {
        mesh_rays_destroy(rays);
        return status;
    }
    *out = rays;
    return CONUS_OK;
}

#if !CONUS_EMBREE
conus_status mesh_rays_load_embree(void)
{
    return CONUS_OK;
}
#endif

conus_status mesh_rays_create(struct mesh_rays **out, const struct mesh_object *objects, size_t count)
{
    const struct mesh_tracer *tracer = &mesh_bvh;
#if CONUS_EMBREE
    tracer = mesh_rays_load_embree() ? tracer : &mesh_embree;
#endif
    return mesh_rays_create_with(out, tracer, objects, count);
}

void mesh_rays_destroy(struct mesh_rays *rays)
{
    if (rays) {
        rays->tracer->destroy(rays);
        memory_free(rays->surfaces);
        memory_free(rays->mesh_from_world);
        memory_free(rays);
    }
}

conus_status mesh_rays_trace(struct mesh_rays *rays, struct mesh_bundle *bundle, unsigned width)
{
    return rays->tracer->trace(rays, bundle, width);
}

static void fetch_triangle(const struct mesh_rays *rays, const struct crossing *crossing)
{
    const struct surface *surface = &rays->surfaces[crossing->object - 1];
    __builtin_prefetch(surface->mesh);
    __builtin_prefetch(surface->triangles + 3 * (size_t)crossing->triangle);
}

static void fetch_corners(const struct mesh_rays *rays, const struct crossing *crossing)
{
    const struct surface *surface = &rays->surfaces[crossing->object - 1];
    const uint32_t *corners = surface->triangles + 3 * (size_t)crossing->triangle;
    for (int k = 0; k < 3; k++) {
        __builtin_prefetch(surface->positions + 3 * (size_t)corners[k]);
    }
}

/* Gives the crossings from `first` on their distances and pixels, and drops those behind the apex. Memory is asked for
 * what the next ones need, or the processor would wait for it most of the time. */
static void settle(const struct mesh_rays *rays, const struct mesh_bundle *bundle, struct mesh_intervals *out,
                   size_t first, const size_t *pixel)
{
    enum { AHEAD = 8 };
    struct crossing *crossings = out->crossings;
    size_t count = out->count;
    size_t kept = first;
    for (size_t i = first; i < count + 2 * AHEAD; i++) {
        if (i < count) {
            fetch_triangle(rays, &crossings[i]);
        }
        if (i >= first + AHEAD && i < count + AHEAD) {
            fetch_corners(rays, &crossings[i - AHEAD]);
        }
        if (i >= first + 2 * AHEAD) {
            struct crossing crossing = crossings[i - 2 * AHEAD];
            crossing.t =
                mesh_tracer_distance(&crossing.side, rays, bundle, crossing.pixel, crossing.object, crossing.triangle);
            crossing.pixel = (uint32_t)pixel[crossing.pixel];
            crossings[kept] = crossing;
            kept += crossing.t >= 0;
        }
    }
    out->count = kept;
}

conus_status mesh_rays_pierce(struct mesh_rays *rays, struct mesh_bundle *bundle, struct mesh_intervals *out,
                              const size_t *pixel)
{
    size_t first = out->count;
    for (size_t ray = 0; ray < bundle->count; ray++) {
        bundle->t[ray] = INFINITY;
    }
    conus_status status = rays->tracer->pierce(rays, bundle, out);
    settle(rays, bundle, out, first, pixel);
    return status;
}

unsigned mesh_rays_width(const struct mesh_rays *rays, const double apex[3], double pitch)
{
    double middle[3];
    for (int a = 0; a < 3; a++) {
        middle[a] = 0.5 * (rays->bounds.low[a] + rays->bounds.high[a]) - apex[a];
    }
    return pitch * vec3_length(middle) < rays->cell ? 16 : 1;
}
