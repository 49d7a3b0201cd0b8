/* SPDX-License-Identifier: BSD-3-Clause */
#include "atlas/atlas.h"

#include "base/math3.h"

/* ---- Where everything is ------------------------------------------------------------------------------------- */

struct box {
    double low[3], high[3];
};

static void add_point(struct box *box, const double p[3])
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = fmin(box->low[a], p[a]);
        box->high[a] = fmax(box->high[a], p[a]);
    }
}

/* The lowest and highest indices of voxels that hold an object; false if none does. */
static bool find_voxels(size_t low[3], size_t high[3], const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    bool found = false;
    for (size_t v = 0; v < volume->voxel_count; v++) {
        if (volume_object(volume, v)) {
            const size_t at[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
            for (int a = 0; a < 3; a++) {
                low[a] = found && low[a] < at[a] ? low[a] : at[a];
                high[a] = found && high[a] > at[a] ? high[a] : at[a];
            }
            found = true;
        }
    }
    return found;
}

static void add_volume(struct box *box, const struct volume *volume)
{
    size_t low[3];
    size_t high[3];
    if (!find_voxels(low, high, volume)) {
        return;
    }
    for (unsigned n = 0; n < 8; n++) {
        double corner[3];
        for (unsigned a = 0; a < 3; a++) {
            corner[a] = n >> a & 1 ? (double)high[a] + 0.5 : (double)low[a] - 0.5;
        }
        mat4_point(corner, volume->info.world_from_voxel, corner);
        add_point(box, corner);
    }
}

static void add_mesh(struct box *box, const struct mesh *mesh)
{
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const double p[3] = {(double)mesh->positions[3 * v], (double)mesh->positions[3 * v + 1],
                             (double)mesh->positions[3 * v + 2]};
        add_point(box, p);
    }
}

conus_status conus_atlas_bounds(const conus_atlas *atlas, double low[3], double high[3])
{
    struct box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (atlas->volumes[i].info.role != CONUS_CONTEXT && volume_is_met(&atlas->volumes[i])) {
            add_volume(&box, &atlas->volumes[i]);
        }
    }
    for (size_t i = 0; i < atlas->mesh_count; i++) {
        add_mesh(&box, &atlas->meshes[i]);
    }
    if (!(box.low[0] <= box.high[0])) {
        return fail(CONUS_ERROR_DATA, "the atlas has nothing in it");
    }
    memcpy(low, box.low, sizeof box.low);
    memcpy(high, box.high, sizeof box.high);
    return CONUS_OK;
}

/* ---- Where an object is -------------------------------------------------------------------------------------- */

/* Sums of what belongs to an object. */
struct moment {
    double sum[3], weight;
};

static bool is_below(const conus_atlas *atlas, uint32_t object, uint32_t ancestor)
{
    while (object && object != ancestor) {
        object = atlas->objects[object - 1].parent;
    }
    return object;
}

static void add_voxels(struct moment *moment, const conus_atlas *atlas, const struct volume *volume, uint32_t object)
{
    const size_t *dim = volume->info.dim;
    uint32_t last = 0; /* neighbours are mostly of one object */
    bool is_mine = false;
    for (size_t v = 0; v < volume->voxel_count; v++) {
        uint32_t here = volume_object(volume, v);
        if (here != last) {
            last = here;
            is_mine = here && here != VOLUME_BLOCKER && is_below(atlas, here, object);
        }
        if (is_mine) {
            const size_t at[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
            const double p[3] = {(double)at[0], (double)at[1], (double)at[2]};
            vec3_add_scaled(moment->sum, moment->sum, 1, p);
            moment->weight++;
        }
    }
}

/* By the triangles' areas. */
static void add_triangles(struct moment *moment, const struct mesh *mesh)
{
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3];
        double normal[3];
        double middle[3];
        for (size_t k = 0; k < 3; k++) {
            for (size_t a = 0; a < 3; a++) {
                p[k][a] = (double)mesh->positions[3 * (size_t)mesh->triangles[3 * t + k] + a];
            }
        }
        for (int a = 0; a < 3; a++) {
            middle[a] = (p[0][a] + p[1][a] + p[2][a]) / 3;
        }
        vec3_sub(p[1], p[1], p[0]);
        vec3_sub(p[2], p[2], p[0]);
        vec3_cross(normal, p[1], p[2]);
        double area = vec3_length(normal) / 2;
        vec3_add_scaled(moment->sum, moment->sum, area, middle);
        moment->weight += area;
    }
}

conus_status conus_atlas_centre(double out[3], const conus_atlas *atlas, size_t number)
{
    struct moment all = {0};
    if (number < 1 || number > atlas->object_count) {
        return fail(CONUS_ERROR_ARGUMENT, "object %zu, allowed is 1 to %zu", number, atlas->object_count);
    }
    for (size_t i = 0; i < atlas->volume_count; i++) {
        struct moment voxels = {0};
        const struct volume *volume = &atlas->volumes[i];
        if (volume->info.role != CONUS_CONTEXT && volume_is_met(volume)) {
            add_voxels(&voxels, atlas, volume, (uint32_t)number);
        }
        if (voxels.weight > 0) {
            vec3_scale(voxels.sum, voxels.sum, 1 / voxels.weight);
            mat4_point(voxels.sum, volume->info.world_from_voxel, voxels.sum);
            vec3_add_scaled(all.sum, all.sum, voxels.weight, voxels.sum);
            all.weight += voxels.weight;
        }
    }
    for (uint32_t object = 1; object <= atlas->object_count; object++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, object);
        if (mesh && is_below(atlas, object, (uint32_t)number)) {
            add_triangles(&all, mesh);
        }
    }
    if (!(all.weight > 0)) {
        return fail(CONUS_ERROR_DATA, "%s has no voxels and no triangles", atlas->objects[number - 1].name);
    }
    vec3_scale(out, all.sum, 1 / all.weight);
    return CONUS_OK;
}
