/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A small atlas with something of every kind, for the targets that damage it when it is packed. */
#ifndef CONUS_TESTS_SUPPORT_PACKED_ATLAS_H
#define CONUS_TESTS_SUPPORT_PACKED_ATLAS_H

#include "atlas/atlas.h"
#include "atlas/labels/labels.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "tests/support/value_maps.h"

#include <stdlib.h>
#include <string.h>

static void must(conus_status status)
{
    if (status) {
        abort();
    }
}

static void add_tetrahedron(conus_atlas *atlas)
{
    static const float positions[] = {0, 0, 0, 9, 0, 0, 0, 9, 0, 0, 0, 9};
    static const uint32_t triangles[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    const conus_object area = {.kind = CONUS_KIND_AREA, .name = "Mesh", .abbreviation = "M", .label = 9};
    struct mesh mesh;
    must(mesh_init(&mesh, 4, 4));
    memcpy(mesh.positions, positions, sizeof positions);
    memcpy(mesh.triangles, triangles, sizeof triangles);
    must(atlas_add_mesh(atlas, &area, &mesh));
}

/* Two streamlines with a scalar, one of them a group. */
static void add_streamlines(conus_atlas *atlas)
{
    static const float points[] = {0, 0, 0, 1, 0, 0, 1, 2, 0, 5, 5, 5, 6, 6, 6};
    static const uint64_t first[] = {0, 3, 5};
    struct tractogram made = {.path = memory_text("t.trk", 5),
                              .points = memory_copy(points, 15, sizeof *points),
                              .first = memory_copy(first, 3, sizeof *first),
                              .point_count = 5,
                              .streamline_count = 2,
                              .scalars = memory_zeroed(1, sizeof *made.scalars),
                              .scalar_count = 1,
                              .groups = memory_zeroed(1, sizeof *made.groups),
                              .group_count = 1,
                              .radius = 0.5};
    must(made.scalars && made.groups ? CONUS_OK : CONUS_ERROR_MEMORY);
    made.scalars[0] = (struct tract_scalar){
        .name = memory_text("FA", 2), .per_point = true, .components = 1, .values = memory_zeroed(5, sizeof(float))};
    made.groups[0] =
        (struct tract_group){.name = memory_text("one", 3), .members = memory_zeroed(1, sizeof(uint32_t)), .count = 1};
    must(atlas_add_tractogram(atlas, &made, "rest"));
}

/* A volume that blocks and a surface around the areas. */
static void add_context(conus_atlas *atlas, conus_volume_info info)
{
    static const float positions[] = {-9, -9, -9, 19, 0, 0, 0, 19, 0, 0, 0, 19};
    static const uint32_t triangles[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    struct context_surface surface = {.opacity = 0.5, .hemisphere = 'L'};
    float *values = memory_zeroed(12, sizeof *values);
    info.role = CONUS_ROLE_CONTEXT;
    info.threshold = 1;
    must(values ? CONUS_OK : CONUS_ERROR_MEMORY);
    values[11] = 2;
    must(atlas_set_context(atlas, &info, values));
    must(mesh_init(&surface.mesh, 4, 4));
    memcpy(surface.mesh.positions, positions, sizeof positions);
    memcpy(surface.mesh.triangles, triangles, sizeof triangles);
    surface.mesh.path = memory_text("s.gii", 5);
    surface.map_name = memory_text("map", 3);
    surface.values = memory_zeroed(4, sizeof *surface.values);
    must(atlas_add_context_surface(atlas, &surface));
}

/* Areas in voxels and one with a surface, a pathway, streamlines, a note and a file. */
static conus_atlas *make_atlas(void)
{
    static const uint32_t labels[12] = {0, 1, 1, 2, 2, 0, 0, 3, 3, 1, 0, 0};
    conus_volume_info info = {.role = CONUS_ROLE_PARCELLATION, .path = "v.nii", .dim = {3, 2, 2}, .slope = 1};
    struct label_voxels voxels = {0};
    struct labelled_volume volume = {.info = &info, .labels = &voxels};
    struct label_table table = {0};
    struct notes notes = {0};
    conus_atlas *atlas = NULL;
    double m[16];
    mat4_identity(m);
    must(space_describe(&info, m, "v.nii"));
    must(label_voxels_of(&voxels, labels, sizeof labels / sizeof *labels));
    must(atlas_create_of(&atlas, &volume, 1, &table, "none", &notes));
    label_voxels_finish(&voxels);
    notes_finish(&notes);
    add_tetrahedron(atlas);
    float *values = memory_zeroed(12, sizeof *values);
    info.role = CONUS_ROLE_SCALAR;
    info.threshold = 0.5;
    must(values ? pathway_of_values(atlas, &info, values, "tract") : CONUS_ERROR_MEMORY);
    add_streamlines(atlas);
    add_context(atlas, info);
    must(notes_add(&atlas->notes, "a note"));
    must(atlas_add_file(atlas, "v.nii", &(const struct bytes){(uint8_t *)"abc", 3}));
    return atlas;
}

#endif
