/* SPDX-License-Identifier: BSD-3-Clause */
#include "apps/bench/mesh_look.h"

#include <math.h>

enum { PIXELS = MESH_LOOK_RESOLUTION * MESH_LOOK_RESOLUTION };

/* Pixels in tiles of 4 x 4, as the rays engine takes them. */
static size_t pixel_of(size_t ray)
{
    size_t tile = ray / 16, row = tile / 4 * 4 + ray % 16 / 4, column = tile % 4 * 4 + ray % 4;
    return row * MESH_LOOK_RESOLUTION + column;
}

conus_status bench_look_at_meshes(struct evidence *out, struct mesh_rays *rays, const struct cone *cone, unsigned width)
{
    double u[PIXELS], v[PIXELS], direction[3][MESH_RAYS_LIMIT];
    struct mesh_bundle bundle = {.count = PIXELS, .origin = cone->pose.world_from_device + 12};
    bundle.direction = (const double(*)[MESH_RAYS_LIMIT])direction;
    for (size_t ray = 0; ray < PIXELS; ray++) {
        u[ray] = cone_coordinate((uint32_t)(pixel_of(ray) % MESH_LOOK_RESOLUTION), MESH_LOOK_RESOLUTION);
        v[ray] = cone_coordinate((uint32_t)(pixel_of(ray) / MESH_LOOK_RESOLUTION), MESH_LOOK_RESOLUTION);
        bundle.t[ray] = INFINITY;
    }
    double *const axes[3] = {direction[0], direction[1], direction[2]};
    cone_rays(axes, cone, u, v, PIXELS);
    width = width ? width : mesh_rays_width(rays, bundle.origin, cone->angle / cone->resolution);
    conus_status status = mesh_rays_walk(rays, &bundle, width);
    for (size_t ray = 0; ray < PIXELS; ray++) {
        size_t pixel = pixel_of(ray);
        out->object[pixel] = bundle.object[ray];
        out->distance[pixel] = bundle.t[ray];
        out->voxel[pixel] = bundle.triangle[ray];
    }
    return status;
}
