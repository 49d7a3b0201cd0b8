/* SPDX-License-Identifier: BSD-3-Clause */
/* Adds up triangles of closed surfaces in a region, block by block. */
#include "selection/measure/measure.h"

#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/region/region.h"

enum { BLOCK_TRIANGLES = 16 };

/* Triangles beside each other. */
struct solid_block {
    double low[3], high[3];
    double volume;  /* between them and the corner `low` */
    double area[3]; /* a third of the sum of their areas along their normals */
};

/* Orders the boxes so that each BLOCK_TRIANGLES in a row are neighbours. */
static void gather_neighbours(struct bvh_box *boxes, size_t count)
{
    while (count > BLOCK_TRIANGLES) {
        struct bvh_box around = bvh_box_around(boxes, count);
        size_t blocks = (count + BLOCK_TRIANGLES - 1) / BLOCK_TRIANGLES;
        size_t half = blocks / 2 * BLOCK_TRIANGLES;
        bvh_halve(boxes, count, half, bvh_box_longest_axis(&around));
        gather_neighbours(boxes, half);
        boxes += half;
        count -= half;
    }
}

static conus_status order_triangles(struct solid *solid)
{
    const struct mesh *mesh = solid->mesh;
    struct bvh_box *boxes = memory_raw(mesh->triangle_count, sizeof *boxes);
    solid->triangles = memory_raw(mesh->triangle_count, sizeof *solid->triangles);
    for (size_t t = 0; boxes && solid->triangles && t < mesh->triangle_count; t++) {
        boxes[t] = bvh_box_empty((uint32_t)t);
        for (size_t c = 0; c < 3; c++) {
            bvh_box_extend(&boxes[t], mesh->positions + 3 * (size_t)mesh->triangles[3 * t + c]);
        }
    }
    conus_status status = boxes && solid->triangles ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        gather_neighbours(boxes, mesh->triangle_count);
    }
    for (size_t t = 0; !status && t < mesh->triangle_count; t++) {
        solid->triangles[t] = boxes[t].number;
    }
    memory_free(boxes);
    return status;
}

static size_t block_end(const struct solid *solid, size_t block)
{
    size_t end = (block + 1) * BLOCK_TRIANGLES;
    return end < solid->mesh->triangle_count ? end : solid->mesh->triangle_count;
}

static struct solid_block measure_block(const struct solid *solid, size_t block)
{
    struct solid_block out = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0, {0}};
    double p[3][3];
    for (size_t t = block * BLOCK_TRIANGLES; t < block_end(solid, block); t++) {
        mesh_corners(p, solid->mesh, solid->triangles[t]);
        for (int i = 0; i < 9; i++) {
            out.low[i % 3] = fmin(out.low[i % 3], p[i / 3][i % 3]);
            out.high[i % 3] = fmax(out.high[i % 3], p[i / 3][i % 3]);
        }
    }
    for (size_t t = block * BLOCK_TRIANGLES; t < block_end(solid, block); t++) {
        double edges[2][3];
        double normal[3];
        mesh_corners(p, solid->mesh, solid->triangles[t]);
        vec3_sub(edges[0], p[1], p[0]);
        vec3_sub(edges[1], p[2], p[0]);
        vec3_cross(normal, edges[0], edges[1]);
        vec3_sub(p[0], p[0], out.low);
        vec3_add_scaled(out.area, out.area, 1.0 / 6, normal);
        out.volume += vec3_dot(p[0], normal) / 6;
    }
    return out;
}

conus_status solids_add(struct solids *solids, uint32_t object, const struct mesh *mesh)
{
    if (!memory_reserve(&solids->solids, &solids->capacity, solids->count + 1, sizeof *solids->solids)) {
        return CONUS_ERROR_MEMORY;
    }
    struct solid solid = {
        .object = object, .mesh = mesh, .block_count = (mesh->triangle_count + BLOCK_TRIANGLES - 1) / BLOCK_TRIANGLES};
    solid.blocks = memory_raw(solid.block_count, sizeof *solid.blocks);
    conus_status status = solid.blocks ? order_triangles(&solid) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(solid.blocks);
        memory_free(solid.triangles);
        return status;
    }
    for (size_t b = 0; b < solid.block_count; b++) {
        solid.blocks[b] = measure_block(&solid, b);
    }
    solids->solids[solids->count++] = solid;
    return CONUS_OK;
}

void solids_finish(struct solids *solids)
{
    for (size_t i = 0; i < solids->count; i++) {
        memory_free(solids->solids[i].blocks);
        memory_free(solids->solids[i].triangles);
    }
    memory_free(solids->solids);
    *solids = (struct solids){0};
}

/* Whether a plane that bounds the region's range may pass through the block: that counts beside the region, too. */
static bool is_cut(const struct solid_block *block, const struct region *region)
{
    double middle = 0;
    double reach = 0;
    for (int a = 0; a < 3 && region->shape != REGION_BALL; a++) {
        middle += region->axis[a] * ((block->low[a] + block->high[a]) / 2 - region->origin[a]);
        reach += fabs(region->axis[a]) * (block->high[a] - block->low[a]) / 2;
    }
    reach += 1e-9 * (reach + fabs(middle)); /* more than rounding */
    return region->shape == REGION_BALL || (region->near > 0 && fabs(middle - region->near) <= reach) ||
           fabs(middle - region->far) <= reach;
}

static double block_volume(const struct solid *solid, size_t number, const struct region_solid *cut)
{
    const struct solid_block *block = &solid->blocks[number];
    const struct region *region = cut->region;
    enum tract_answer lies = region_box(region, block->low, block->high);
    double sum = 0;
    if (lies == TRACT_INSIDE && region->shape != REGION_CYLINDER) {
        double from[3];
        vec3_sub(from, block->low, region->origin);
        return block->volume + vec3_dot(from, block->area);
    }
    if (lies == TRACT_OUTSIDE && !is_cut(block, region)) {
        return 0;
    }
    for (size_t t = number * BLOCK_TRIANGLES; t < block_end(solid, number); t++) {
        double corners[3][3];
        mesh_corners(corners, solid->mesh, solid->triangles[t]);
        sum += region_triangle(cut, corners);
    }
    return sum;
}

/* A surface may wind other than once around a hundredth of its inside (mesh_winds_once()). There the sum may leave 0 to
 * `whole` by about as much, and is clamped. A sum that leaves it by more is an error, which should be seen. */
static double clamp_to_whole(double volume, double whole)
{
    static const double folds = 0.02;
    return volume < 0 && volume > -folds * whole ? 0 : volume > whole && volume < (1 + folds) * whole ? whole : volume;
}

double solid_volume(const struct solid *solid, const struct region_solid *region)
{
    static const double rounding = 1e-12;
    const struct mesh_shape *shape = &solid->mesh->shape;
    double whole = fabs(shape->volume_mm3);
    double size[3];
    double from[3];
    double sum = 0;
    enum tract_answer lies = region_box(region->region, shape->low, shape->high);
    if (lies != TRACT_PERHAPS) {
        return lies == TRACT_INSIDE ? whole : 0;
    }
    for (size_t b = 0; b < solid->block_count; b++) {
        sum += block_volume(solid, b, region);
    }
    vec3_sub(size, shape->high, shape->low);
    vec3_sub(from, shape->low, region->region->origin);
    double noise = rounding * vec3_dot(size, size) * (vec3_length(from) + vec3_length(size));
    return fabs(sum) < noise ? 0 : clamp_to_whole(shape->volume_mm3 < 0 ? -sum : sum, whole);
}
