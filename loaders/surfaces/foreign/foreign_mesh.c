/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects vertices, faces and strips. */
#include "loaders/surfaces/foreign/foreign_mesh.h"

#include "base/memory.h"

#include <string.h>

void foreign_mesh_finish(struct foreign_mesh *mesh)
{
    memory_free(mesh->positions);
    memory_free(mesh->triangles);
    memory_free(mesh->face.indices);
    *mesh = (struct foreign_mesh){0};
}

static conus_status check_count(size_t count, const char *what)
{
    return count <= UINT32_MAX ? CONUS_OK : fail(CONUS_ERROR_DATA, "%zu %s, allowed are up to 4294967295", count, what);
}

conus_status foreign_reserve_vertices(struct foreign_mesh *mesh, size_t count)
{
    conus_status status = check_count(count, "vertices");
    if (!status && !memory_reserve(&mesh->positions, &mesh->vertex_capacity, count, 3 * sizeof *mesh->positions)) {
        status = CONUS_ERROR_MEMORY;
    }
    return status;
}

conus_status foreign_add_vertex(struct foreign_mesh *mesh, const float position[3])
{
    conus_status status = foreign_reserve_vertices(mesh, mesh->vertex_count + 1);
    if (!status) {
        memcpy(&mesh->positions[3 * mesh->vertex_count++], position, 3 * sizeof *position);
    }
    return status;
}

conus_status foreign_add_corner(struct foreign_mesh *mesh, int64_t index)
{
    struct corners *face = &mesh->face;
    if (index < 0 || (uint64_t)index >= mesh->vertex_count) {
        const char *what = foreign_cell_word(mesh);
        return mesh->vertex_count ? fail(CONUS_ERROR_DATA, "%s %zu: vertex index %lld, allowed are 0 to %zu", what,
                                         mesh->face_count, (long long)index, mesh->vertex_count - 1)
                                  : fail(CONUS_ERROR_DATA, "%s %zu: vertex index %lld, there are no vertices", what,
                                         mesh->face_count, (long long)index);
    }
    if (!memory_reserve(&face->indices, &face->capacity, face->count + 1, sizeof *face->indices)) {
        return CONUS_ERROR_MEMORY;
    }
    face->indices[face->count++] = (uint32_t)index;
    return CONUS_OK;
}

conus_status foreign_add_triangle(struct foreign_mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t corners[3] = {a, b, c};
    conus_status status = check_count(mesh->triangle_count + 1, "triangles");
    if (!status && !memory_reserve(&mesh->triangles, &mesh->triangle_capacity, mesh->triangle_count + 1,
                                   3 * sizeof *mesh->triangles)) {
        status = CONUS_ERROR_MEMORY;
    }
    if (!status) {
        memcpy(&mesh->triangles[3 * mesh->triangle_count++], corners, sizeof corners);
    }
    return status;
}

void foreign_drop_face(struct foreign_mesh *mesh)
{
    mesh->face.count = 0;
    mesh->face_count++;
}

conus_status foreign_end_polygon(struct foreign_mesh *mesh)
{
    const uint32_t *at = mesh->face.indices;
    size_t count = mesh->face.count;
    conus_status status = CONUS_OK;
    if (count > POLYGON_LIMIT) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%s %zu: a polygon of %zu corners, allowed are up to %d",
                    foreign_cell_word(mesh), mesh->face_count, count, POLYGON_LIMIT);
    }
    if (count > 3) {
        status = polygon_cut(mesh, at, count);
    } else if (count > 0) {
        status = foreign_add_triangle(mesh, at[0], at[count > 1], at[count - 1]);
    }
    foreign_drop_face(mesh);
    return status;
}

/* Every second triangle of a strip is turned around. */
conus_status foreign_end_strip(struct foreign_mesh *mesh)
{
    const uint32_t *at = mesh->face.indices;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i + 2 < mesh->face.count; i++) {
        status = foreign_add_triangle(mesh, at[i + i % 2], at[i + 1 - i % 2], at[i + 2]);
    }
    foreign_drop_face(mesh);
    return status;
}

conus_status foreign_mesh_take(struct mesh *out, struct foreign_mesh *mesh)
{
    struct mesh taken = {0};
    conus_status status = CONUS_OK;
    if (!mesh->triangle_count) {
        return fail(CONUS_ERROR_DATA, "no triangle with an area: no ray can hit it");
    }
    float *positions = memory_resize(mesh->positions, mesh->vertex_count, 3 * sizeof *positions); /* smaller */
    mesh->positions = positions ? positions : mesh->positions;
    uint32_t *triangles = memory_resize(mesh->triangles, mesh->triangle_count, 3 * sizeof *triangles);
    mesh->triangles = triangles ? triangles : mesh->triangles;
    status = positions && triangles ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        taken.vertex_count = mesh->vertex_count;
        taken.triangle_count = mesh->triangle_count;
        taken.positions = mesh->positions;
        taken.triangles = mesh->triangles;
        mesh->positions = NULL;
        mesh->triangles = NULL;
        *out = taken;
    }
    return status;
}
