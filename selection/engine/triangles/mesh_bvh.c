/* SPDX-License-Identifier: BSD-3-Clause */
/* The tracer with a tree of our own: over the objects, and over the triangles of each mesh. */
#include "atlas/surface/mesh.h"
#include "base/memory.h"
#include "selection/engine/triangles/mesh_tracer.h"

struct scene {
    struct bvh objects;    /* Boxes in the world; a number is that of a surface. */
    struct bvh *meshes;    /* [mesh_count]; boxes and numbers are those of triangles. */
    size_t mesh_count;     /* Objects in a row that have the same mesh share its tree. */
    size_t *mesh_of;       /* [objects] the index of its tree in `meshes` */
    struct bvh_box *boxes; /* Boxes of objects, while the scene is made; */
    size_t box_count;      /* those that are meshes. */
};

/* A box of all, moved to where the object is. It is rounded to single precision, which BVH_SLACK covers. */
static struct bvh_box place_box(const struct bvh_box *box, const double *world_from_mesh, size_t number)
{
    struct bvh_box placed = bvh_box_empty((uint32_t)number);
    for (int k = 0; k < 8; k++) {
        float corner[3];
        double p[3];
        for (int a = 0; a < 3; a++) {
            p[a] = (double)(k >> a & 1 ? box->high[a] : box->low[a]);
        }
        if (world_from_mesh) {
            mat4_point(p, world_from_mesh, p);
        }
        for (int a = 0; a < 3; a++) {
            corner[a] = (float)p[a];
        }
        bvh_box_extend(&placed, corner);
    }
    return placed;
}

static conus_status add_mesh(struct scene *scene, struct bvh_box *around, const struct mesh *mesh)
{
    struct bvh_box *boxes = memory_raw(mesh->triangle_count, sizeof *boxes);
    if (!boxes) {
        return CONUS_ERROR_MEMORY;
    }
    *around = bvh_box_empty(0);
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        boxes[i] = bvh_box_empty((uint32_t)i);
        for (size_t k = 0; k < 3; k++) {
            bvh_box_extend(&boxes[i], mesh->positions + 3 * (size_t)mesh->triangles[3 * i + k]);
        }
        bvh_box_extend(around, boxes[i].low);
        bvh_box_extend(around, boxes[i].high);
    }
    conus_status status = bvh_init(&scene->meshes[scene->mesh_count], boxes, mesh->triangle_count);
    scene->mesh_count += !status;
    memory_free(boxes);
    return status;
}

static conus_status create(struct mesh_rays *rays, const struct mesh_object *objects, size_t count)
{
    struct scene *scene = rays->scene = memory_zeroed(1, sizeof *scene);
    if (!scene) {
        return CONUS_ERROR_MEMORY;
    }
    scene->meshes = memory_zeroed(count, sizeof *scene->meshes);
    scene->mesh_of = memory_zeroed(count, sizeof *scene->mesh_of);
    scene->boxes = memory_raw(count, sizeof *scene->boxes);
    if (!scene->meshes || !scene->mesh_of || !scene->boxes) {
        memory_free(scene->boxes);
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = CONUS_OK;
    const struct mesh *last = NULL;
    struct bvh_box around;
    for (size_t i = 0; i < count && !status; i++) {
        if (objects[i].mesh && objects[i].mesh != last) {
            last = objects[i].mesh;
            status = add_mesh(scene, &around, last);
        }
        if (objects[i].mesh && !status) {
            scene->boxes[scene->box_count++] = place_box(&around, objects[i].world_from_mesh, i);
            scene->mesh_of[i] = scene->mesh_count - 1;
        }
    }
    status = status ? status : bvh_init(&scene->objects, scene->boxes, scene->box_count);
    memory_free(scene->boxes);
    scene->boxes = NULL;
    return status;
}

static void destroy(struct mesh_rays *rays)
{
    struct scene *scene = rays->scene;
    if (scene) {
        for (size_t i = 0; i < scene->mesh_count; i++) {
            bvh_finish(&scene->meshes[i]);
        }
        bvh_finish(&scene->objects);
        memory_free(scene->meshes);
        memory_free(scene->mesh_of);
        memory_free(scene);
    }
}

/* A ray of a bundle on its way. */
struct tracing {
    const struct mesh_rays *rays;
    struct mesh_bundle *bundle;
    size_t ray;
    double start;
    struct mesh_intervals *out; /* NULL = only the first hit */
};

static conus_status take_triangle(const struct tracing *tracing, uint32_t object, uint32_t triangle)
{
    if (tracing->out) {
        return mesh_intervals_add(tracing->out, &(struct crossing){.pixel = (uint32_t)tracing->ray, object, triangle});
    }
    mesh_tracer_offer(tracing->rays, tracing->bundle, tracing->ray, object, triangle);
    return CONUS_OK;
}

static double reach(const struct tracing *tracing)
{
    return mesh_tracer_reach(tracing->rays, tracing->bundle, tracing->ray, tracing->start);
}

static conus_status search_mesh(const struct tracing *tracing, uint32_t index, const double origin[3],
                                const double direction[3])
{
    const struct scene *scene = tracing->rays->scene;
    const struct surface *surface = &tracing->rays->surfaces[index];
    double p[3] = {origin[0], origin[1], origin[2]};
    double d[3] = {direction[0], direction[1], direction[2]};
    if (surface->mesh_from_world) {
        mat4_point(p, surface->mesh_from_world, origin);
        mat4_direction(d, surface->mesh_from_world, direction);
    }
    struct bvh_search search;
    conus_status status = CONUS_OK;
    bvh_search_init(&search, &scene->meshes[scene->mesh_of[index]], p, d);
    for (uint32_t triangle; !status && bvh_search_next(&triangle, &search, reach(tracing));) {
        if (mesh_is_passed(surface->mesh, triangle, p, d)) {
            status = take_triangle(tracing, index + 1, triangle);
        }
    }
    return status;
}

static conus_status search_objects(const struct tracing *tracing)
{
    const struct scene *scene = tracing->rays->scene;
    double origin[3], direction[3];
    for (int a = 0; a < 3; a++) {
        direction[a] = tracing->bundle->direction[a][tracing->ray];
        origin[a] = tracing->bundle->origin[a] + tracing->start * direction[a];
    }
    struct bvh_search search;
    conus_status status = CONUS_OK;
    bvh_search_init(&search, &scene->objects, origin, direction);
    for (uint32_t index; !status && bvh_search_next(&index, &search, reach(tracing));) {
        status = search_mesh(tracing, index, origin, direction);
    }
    return status;
}

static conus_status search_bundle(struct mesh_rays *rays, struct mesh_bundle *bundle, struct mesh_intervals *out)
{
    struct tracing tracing = {
        .rays = rays, .bundle = bundle, .out = out, .start = mesh_tracer_start(rays, bundle->origin)};
    conus_status status = CONUS_OK;
    for (; tracing.ray < bundle->count && !status; tracing.ray++) {
        status = search_objects(&tracing);
    }
    return status;
}

static conus_status trace(struct mesh_rays *rays, struct mesh_bundle *bundle, unsigned width)
{
    (void)width; /* one ray after the other */
    return search_bundle(rays, bundle, NULL);
}

const struct mesh_tracer mesh_bvh = {
    .name = "own tree", .create = create, .destroy = destroy, .trace = trace, .pierce = search_bundle};
