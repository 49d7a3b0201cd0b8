/* SPDX-License-Identifier: BSD-3-Clause */
/* Puts the meshes of an atlas together. */
#include "render/passes/shapes.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

/* Each triangle adds its normal, weighted by its area, to its corners. */
static void add_normals(struct mesh_vertex *vertices, const struct mesh *mesh)
{
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *t = &mesh->triangles[3 * i];
        double p[3][3], normal[3];
        for (int k = 0; k < 3; k++) {
            for (int a = 0; a < 3; a++) {
                p[k][a] = (double)vertices[t[k]].position[a];
            }
        }
        vec3_sub(p[1], p[1], p[0]);
        vec3_sub(p[2], p[2], p[0]);
        vec3_cross(normal, p[1], p[2]);
        for (int k = 0; k < 3; k++) {
            for (int a = 0; a < 3; a++) {
                vertices[t[k]].normal[a] += (float)normal[a];
            }
        }
    }
}

static void fill_mesh(struct mesh_vertex *vertices, uint32_t *indices, uint32_t first, const struct mesh *mesh,
                      uint32_t object)
{
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        vertices[v] = (struct mesh_vertex){.object = object};
        for (size_t a = 0; a < 3; a++) {
            vertices[v].position[a] = mesh->positions[3 * v + a];
        }
    }
    add_normals(vertices, mesh);
    for (size_t k = 0; k < 3 * mesh->triangle_count; k++) {
        indices[k] = first + mesh->triangles[k];
    }
}

/* The surfaces around the areas come after the objects. */
static size_t count_parts(const conus_atlas *atlas)
{
    return atlas->object_count + atlas->context_surface_count;
}

static const struct mesh *part_mesh(const conus_atlas *atlas, size_t part)
{
    return part < atlas->object_count ? atlas_stored_mesh(atlas, (uint32_t)part + 1)
                                      : &atlas->context_surfaces[part - atlas->object_count].mesh;
}

struct sizes {
    size_t vertices, indices;
};

static conus_status check_sizes(struct sizes *out, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct sizes sizes = {0};
    for (size_t part = 0; part < count_parts(atlas); part++) {
        const struct mesh *mesh = part_mesh(atlas, part);
        sizes.vertices += mesh ? mesh->vertex_count : 0;
        sizes.indices += mesh ? 3 * mesh->triangle_count : 0;
    }
    uint64_t size = sizes.vertices * (uint64_t)sizeof(struct mesh_vertex) + sizes.indices * UINT64_C(4);
    if (size > *memory_left || sizes.vertices > INT32_MAX || sizes.indices > INT32_MAX) {
        return fail(CONUS_ERROR_MEMORY, "meshes of %zu triangles: %llu bytes, allowed are %llu more", sizes.indices / 3,
                    (unsigned long long)size, (unsigned long long)*memory_left);
    }
    *memory_left -= size;
    *out = sizes;
    return CONUS_OK;
}

/* Lays the numbers of a surface's map beside all vertices: their part of the range, and 1, or twice 0 where there is no
 * number. Both are interpolated; one by the other is then the number between the corners that have one. */
static conus_status add_map(struct mesh_list *parts, const struct context_surface *surface, size_t first)
{
    parts->values = memory_zeroed(parts->vertex_count, sizeof *parts->values);
    if (!parts->values) {
        return CONUS_ERROR_MEMORY;
    }
    double span = surface->high - surface->low;
    for (size_t v = 0; v < surface->mesh.vertex_count; v++) {
        double value = (double)surface->values[v];
        if (!isnan(value)) {
            parts->values[first + v][0] = span > 0 ? (float)((value - surface->low) / span) : 0.5F;
            parts->values[first + v][1] = 1;
        }
    }
    return CONUS_OK;
}

static conus_status fill_parts(struct mesh_list *parts, const conus_atlas *atlas, uint64_t *memory_left)
{
    const struct context_surface *mapped = atlas_mapped_surface(atlas);
    struct sizes next = {0};
    size_t first_mapped = 0;
    for (size_t part = 0; part < parts->part_count; part++) {
        const struct mesh *mesh = part_mesh(atlas, part);
        if (mapped && mesh == &mapped->mesh) {
            first_mapped = next.vertices;
            parts->mapped = (uint32_t)part + 1;
        }
        if (mesh) {
            fill_mesh(parts->vertices + next.vertices, parts->indices + next.indices, (uint32_t)next.vertices, mesh,
                      (uint32_t)part + 1);
            parts->parts[part] = (struct mesh_entry){.first = next.indices, .count = 3 * mesh->triangle_count};
            next.vertices += mesh->vertex_count;
            next.indices += 3 * mesh->triangle_count;
        }
    }
    conus_status status = mesh_borders_smooth(parts, atlas, memory_left);
    return status || !mapped ? status : add_map(parts, mapped, first_mapped);
}

conus_status mesh_list_init(struct mesh_list *out, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct sizes sizes = {0};
    conus_status status = check_sizes(&sizes, atlas, memory_left);
    if (status) {
        return status;
    }
    struct mesh_list parts = {.vertices = memory_raw(sizes.vertices, sizeof *parts.vertices),
                              .vertex_count = sizes.vertices,
                              .indices = memory_raw(sizes.indices, sizeof *parts.indices),
                              .index_count = sizes.indices,
                              .parts = memory_zeroed(count_parts(atlas), sizeof *parts.parts),
                              .part_count = count_parts(atlas)};
    status = parts.vertices && parts.indices && parts.parts ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status || !sizes.indices ? status : fill_parts(&parts, atlas, memory_left); /* else streamlines alone */
    if (status) {
        mesh_list_finish(&parts);
        return status;
    }
    mesh_list_show(&parts, atlas);
    *out = parts;
    return CONUS_OK;
}

void mesh_list_show(struct mesh_list *parts, const conus_atlas *atlas)
{
    for (size_t i = 0; i < parts->part_count; i++) {
        bool is_around = i >= atlas->object_count;
        parts->parts[i].is_shown = parts->parts[i].count && (is_around || atlas_object_mesh(atlas, (uint32_t)i + 1));
    }
}

bool mesh_list_draws(const struct mesh_list *parts, size_t part, const float *opacity, bool translucent)
{
    float own = opacity ? opacity[part + 1] : 1;
    return parts->parts[part].is_shown && own > 0 && (own < 1) == translucent;
}

void mesh_list_drop(struct mesh_list *parts)
{
    memory_free(parts->vertices);
    memory_free(parts->indices);
    memory_free(parts->values);
    parts->vertices = NULL;
    parts->indices = NULL;
    parts->values = NULL;
}

void mesh_list_finish(struct mesh_list *parts)
{
    mesh_list_drop(parts);
    memory_free(parts->parts);
    *parts = (struct mesh_list){0};
}

void mesh_camera_rows(double rows[9], const struct camera *camera)
{
    const double *m = camera->world_from_camera;
    for (int a = 0; a < 3; a++) {
        rows[a] = (m[a] + camera->middle[0] * m[8 + a]) / camera->slope[0];
        rows[3 + a] = (m[4 + a] + camera->middle[1] * m[8 + a]) / camera->slope[1];
        rows[6 + a] = -m[8 + a];
    }
}

void mesh_camera_columns(double columns[9], const double rows[9])
{
    vec3_cross(columns, rows + 3, rows + 6);
    vec3_cross(columns + 3, rows + 6, rows);
    vec3_cross(columns + 6, rows, rows + 3);
    double determinant = vec3_dot(rows, columns);
    for (int i = 0; i < 9; i++) {
        columns[i] /= determinant;
    }
}
