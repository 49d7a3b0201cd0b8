/* SPDX-License-Identifier: BSD-3-Clause */
/* Fills closed surfaces line by line. */
#include "atlas/fit/surface_head.h"

#include "atlas/surface/mesh_lines.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

/* False where no surface is closed. */
static bool find_box(double low[3], double high[3], const conus_atlas *atlas)
{
    bool found = false;
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
    }
    for (size_t i = 0; i < atlas->context_surface_count; i++) {
        const struct mesh_shape *shape = &atlas->context_surfaces[i].mesh.shape;
        for (int a = 0; shape->closed && a < 3; a++) {
            low[a] = fmin(low[a], shape->low[a]);
            high[a] = fmax(high[a], shape->high[a]);
        }
        found = found || shape->closed;
    }
    return found;
}

static conus_status make_grid(struct volume *out, const double low[3], const double high[3])
{
    conus_volume_info info = {.role = CONUS_ROLE_CONTEXT, .maximum = 1};
    double edge = fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2])) / SURFACE_HEAD_CELLS;
    mat4_identity(info.world_from_voxel);
    for (int a = 0; a < 3; a++) {
        info.dim[a] = (size_t)ceil((high[a] - low[a]) / edge) + 2;
        info.spacing[a] = edge;
        info.world_from_voxel[5 * a] = edge;
        info.world_from_voxel[12 + a] = low[a] - edge / 2;
    }
    conus_status status = volume_init(out, &info);
    out->values = status ? NULL : memory_zeroed(out->voxel_count, sizeof *out->values);
    return status || out->values ? status : CONUS_ERROR_MEMORY;
}

/* A line is inside where the surface winds around it. */
static void fill_lines(struct volume *volume, const struct mesh_lines *lines)
{
    const size_t *dim = volume->info.dim;
    int32_t winding = 0;
    for (size_t i = 0; i + 1 < lines->crossing_count; i++) {
        const struct line_crossing *in = &lines->crossings[i];
        const struct line_crossing *out = in + 1;
        winding = in->line == out->line ? winding + in->side : 0;
        const double last = winding ? fmin(floor(out->z), (double)dim[2] - 1) : -1;
        for (size_t k = (size_t)fmax(ceil(in->z), 0); (double)k <= last; k++) {
            volume->values[in->line + dim[0] * dim[1] * k] = 1;
        }
    }
}

static conus_status fill_surface(struct volume *volume, const struct mesh *mesh)
{
    struct mesh_lines lines = {.start = {0, 0}, .step = {1, 1}, .count = {volume->info.dim[0], volume->info.dim[1]}};
    conus_status status = CONUS_OK;
    for (size_t t = 0; !status && t < mesh->triangle_count; t++) {
        status = mesh_lines_cross(&lines, 0, mesh, t, volume->voxel_from_world);
    }
    if (!status) {
        mesh_lines_sort(&lines);
        fill_lines(volume, &lines);
    }
    mesh_lines_finish(&lines);
    return status;
}

conus_status surface_head_make(struct volume *out, const conus_atlas *atlas)
{
    double low[3];
    double high[3];
    struct volume volume = {0};
    if (!find_box(low, high, atlas)) {
        *out = volume;
        return CONUS_OK;
    }
    conus_status status = make_grid(&volume, low, high);
    for (size_t i = 0; !status && i < atlas->context_surface_count; i++) {
        const struct mesh *mesh = &atlas->context_surfaces[i].mesh;
        status = mesh->shape.closed ? fill_surface(&volume, mesh) : CONUS_OK;
    }
    if (status) {
        volume_finish(&volume);
        return status;
    }
    *out = volume;
    return CONUS_OK;
}
