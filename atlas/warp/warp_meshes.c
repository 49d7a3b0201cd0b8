/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces whose vertices go back through a field. */
#include "atlas/deformation/deformation.h"
#include "atlas/warp/warp_parts.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

void warped_meshes_finish(struct warped_meshes *meshes, size_t count)
{
    for (size_t i = 0; meshes->items && i < count; i++) {
        mesh_finish(&meshes->items[i]);
    }
    memory_free(meshes->items);
    *meshes = (struct warped_meshes){0};
}

/* Leaves out vertices without a place, and the triangles that have one. Returns how many triangles in *cut. */
static conus_status cut_mesh(size_t *cut, struct mesh *mesh)
{
    enum { NOWHERE = UINT32_MAX };
    uint32_t *numbers = memory_raw(mesh->vertex_count, sizeof *numbers);
    size_t vertices = 0;
    size_t triangles = 0;
    if (!numbers) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const float *p = &mesh->positions[3 * i];
        numbers[i] = isnan(*p) ? NOWHERE : (uint32_t)vertices;
        if (!isnan(*p)) {
            memmove(&mesh->positions[3 * vertices++], p, 3 * sizeof *p);
        }
    }
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *old = &mesh->triangles[3 * i];
        const uint32_t corners[3] = {numbers[old[0]], numbers[old[1]], numbers[old[2]]};
        if (corners[0] != NOWHERE && corners[1] != NOWHERE && corners[2] != NOWHERE) {
            memcpy(&mesh->triangles[3 * triangles++], corners, sizeof corners);
        }
    }
    *cut = mesh->triangle_count - triangles;
    mesh->vertex_count = vertices;
    mesh->triangle_count = triangles;
    memory_free(numbers);
    return CONUS_OK;
}

static const char *name_of(const conus_atlas *atlas, size_t mesh)
{
    for (size_t i = 0; i < atlas->object_count; i++) {
        if (atlas->places[i].is_mesh && atlas->places[i].index == mesh) {
            return atlas->objects[i].name;
        }
    }
    return "a surface";
}

/* Whether the map of the fields as a whole mirrors. */
static bool mirrors(const struct deformation *fields, size_t count)
{
    bool is = false;
    for (size_t i = 0; i < count; i++) {
        is = is != (mat4_determinant3(fields[i].start) * mat4_determinant3(fields[i].world_from_voxel) < 0);
    }
    return is;
}

static conus_status move_mesh(struct warped_meshes *out, size_t index, const conus_atlas *atlas,
                              const struct deformation *fields, size_t count, struct notes *notes)
{
    const struct mesh *old = &atlas->meshes[index];
    struct mesh *mesh = &out->items[index];
    conus_status status = mesh_copy(mesh, old);
    if (status) {
        return status;
    }
    /* NaN for a vertex that has no place. */
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        float *p = &mesh->positions[3 * i];
        double point[3] = {(double)p[0], (double)p[1], (double)p[2]};
        enum deformation_found found = deformations_find(point, fields, count, point);
        out->counts.points++;
        out->counts.outside += found == DEFORMATION_OUTSIDE;
        out->counts.lost += found == DEFORMATION_LOST;
        for (int a = 0; a < 3; a++) {
            p[a] = found == DEFORMATION_LOST ? NAN : (float)point[a];
        }
    }
    size_t cut = 0;
    status = cut_mesh(&cut, mesh);
    if (status) {
        return status;
    }
    out->counts.wholes += old->triangle_count;
    out->counts.cut += cut;
    if (!mesh->triangle_count) {
        return fail(CONUS_ERROR_DATA, "nothing of %s is where the field leads to", name_of(atlas, index));
    }
    if (mirrors(fields, count)) {
        mesh_turn(mesh);
    }
    status = cut ? mesh_check(mesh, notes) : mesh_check_numbers(mesh);
    return status ? status : mesh_measure(&mesh->shape, mesh);
}

conus_status warped_meshes_init(struct warped_meshes *out, const conus_atlas *atlas, const struct deformation *fields,
                                size_t count, struct notes *notes)
{
    struct warped_meshes meshes = {.items = memory_zeroed(atlas->mesh_count, sizeof *meshes.items)};
    conus_status status = meshes.items ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < atlas->mesh_count; i++) {
        status = move_mesh(&meshes, i, atlas, fields, count, notes);
    }
    return GIVE(status, out, meshes, warped_meshes_finish(&meshes, atlas->mesh_count));
}
