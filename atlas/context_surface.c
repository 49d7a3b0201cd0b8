/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces around the areas: drawn, never hit. */
#include "atlas/atlas.h"

#include "base/memory.h"
#include "conus/own.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

conus_status atlas_add_context_surface(conus_atlas *atlas, struct context_surface *surface)
{
    size_t count = atlas->context_surface_count;
    struct context_surface *surfaces = memory_resize(atlas->context_surfaces, count + 1, sizeof *surfaces);
    if (!surfaces) {
        return CONUS_ERROR_MEMORY;
    }
    atlas->context_surfaces = surfaces;
    conus_status status = mesh_measure(&surface->mesh.shape, &surface->mesh);
    if (!status) {
        surfaces[count] = *surface;
        atlas->context_surface_count = count + 1;
        *surface = (struct context_surface){0};
    }
    return status;
}

void atlas_cut_context_surfaces(conus_atlas *atlas, size_t count)
{
    while (atlas->context_surface_count > count) {
        struct context_surface *surface = &atlas->context_surfaces[--atlas->context_surface_count];
        mesh_finish(&surface->mesh);
        memory_free(surface->values);
        memory_free(surface->map_name);
    }
}

const struct context_surface *atlas_mapped_surface(const conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->context_surface_count; i++) {
        if (atlas->context_surfaces[i].values) {
            return &atlas->context_surfaces[i];
        }
    }
    return NULL;
}

size_t conus_atlas_context_surface_count(const conus_atlas *atlas)
{
    return atlas ? atlas->context_surface_count : 0;
}

conus_status conus_atlas_context_surface(conus_context_surface *out, const conus_atlas *atlas, size_t index)
{
    if (!out || index >= conus_atlas_context_surface_count(atlas)) {
        return fail(CONUS_ERROR_ARGUMENT, "surface %zu around the areas, there are %zu", index,
                    conus_atlas_context_surface_count(atlas));
    }
    const struct context_surface *surface = &atlas->context_surfaces[index];
    const struct mesh *mesh = &surface->mesh;
    size_t size = out->struct_size && out->struct_size < sizeof *out ? out->struct_size : sizeof *out;
    conus_context_surface whole = {.struct_size = out->struct_size,
                                   .path = mesh->path,
                                   .vertices = mesh->vertex_count,
                                   .triangles = mesh->triangle_count,
                                   .closed = mesh->shape.closed,
                                   .hemisphere = surface->hemisphere,
                                   .opacity = surface->opacity};
    memcpy(whole.low, mesh->shape.low, sizeof whole.low);
    memcpy(whole.high, mesh->shape.high, sizeof whole.high);
    memcpy(out, &whole, size);
    return CONUS_OK;
}

double conus_atlas_context_depth(const conus_atlas *atlas, const double origin[3], const double direction[3])
{
    double nearest = INFINITY;
    for (size_t i = 0; i < conus_atlas_context_surface_count(atlas); i++) {
        const struct mesh *mesh = &atlas->context_surfaces[i].mesh;
        for (size_t t = 0; t < mesh->triangle_count; t++) {
            if (mesh_is_passed(mesh, t, origin, direction)) {
                double depth = mesh_distance(mesh, t, origin, direction);
                nearest = depth >= 0 && depth < nearest ? depth : nearest;
            }
        }
    }
    return nearest;
}
