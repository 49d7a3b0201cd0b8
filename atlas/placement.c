/* SPDX-License-Identifier: BSD-3-Clause */
/* Moves an atlas: matrices of voxels exactly, vertices and streamlines in single precision. */
#include "atlas/atlas.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"

#include <stdio.h>
#include <string.h>

/* The parts of an atlas in its new place, made before anything is changed. */
struct moved {
    struct volume *volumes; /* only info and voxel_from_world count */
    struct mesh *meshes;
    struct tractogram *tractograms; /* only points and trees count */
};

static conus_status move_mesh(struct mesh *out, const struct mesh *mesh, const double world_from_atlas[16])
{
    conus_status status = mesh_copy(out, mesh);
    if (status) {
        return status;
    }
    mesh_transform(out, world_from_atlas);
    status = mesh_check_numbers(out);
    return status ? status : mesh_measure(&out->shape, out);
}

void placement_words(char out[PLACEMENT_WORDS], const conus_volume_info *info, const char *how)
{
    snprintf(out, PLACEMENT_WORDS, "%.*s%s", (int)(PLACEMENT_WORDS - 1 - strlen(how)), info->transform,
             strstr(info->transform, how) ? "" : how);
}

static conus_status move_all(struct moved *moved, const conus_atlas *atlas, const double world_from_atlas[16])
{
    moved->volumes = memory_zeroed(atlas->volume_count, sizeof *moved->volumes);
    moved->meshes = memory_zeroed(atlas->mesh_count, sizeof *moved->meshes);
    moved->tractograms = memory_zeroed(atlas->tractogram_count, sizeof *moved->tractograms);
    conus_status status = moved->volumes && moved->meshes && moved->tractograms ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < atlas->volume_count; i++) {
        struct volume *out = &moved->volumes[i];
        const struct volume *volume = &atlas->volumes[i];
        double matrix[16];
        char words[PLACEMENT_WORDS];
        out->info = volume->info;
        mat4_multiply(matrix, world_from_atlas, volume->info.world_from_voxel);
        placement_words(words, &volume->info, ", moved");
        status = space_describe(&out->info, matrix, words);
        out->info.space_code = 0;
        if (!status && !mat4_invert_affine(out->voxel_from_world, matrix)) {
            status = fail(CONUS_ERROR_DATA, "%s: the matrix is singular", words);
        }
    }
    for (size_t i = 0; !status && i < atlas->mesh_count; i++) {
        status = move_mesh(&moved->meshes[i], &atlas->meshes[i], world_from_atlas);
    }
    return status ? status : bundles_move(moved->tractograms, atlas, world_from_atlas);
}

void meshes_take(conus_atlas *atlas, struct mesh *moved)
{
    for (size_t i = 0; i < atlas->mesh_count; i++) {
        struct mesh old = atlas->meshes[i];
        atlas->meshes[i] = moved[i];
        atlas->meshes[i].path = old.path;
        old.path = NULL;
        moved[i] = old;
    }
    for (size_t i = 0; i < atlas->object_count; i++) {
        if (atlas->places[i].is_mesh) {
            const struct mesh *mesh = &atlas->meshes[atlas->places[i].index];
            atlas->objects[i].triangles = mesh->triangle_count;
            atlas->objects[i].closed = mesh->shape.closed;
            atlas->objects[i].volume_mm3 = mesh->shape.has_volume ? fabs(mesh->shape.volume_mm3) : 0;
        }
    }
}

/* `moved` gets the old meshes and points. */
static void take(conus_atlas *atlas, struct moved *moved)
{
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const char *path = atlas->volumes[i].info.path;
        atlas->volumes[i].info = moved->volumes[i].info;
        atlas->volumes[i].info.path = path;
        memcpy(atlas->volumes[i].voxel_from_world, moved->volumes[i].voxel_from_world,
               sizeof atlas->volumes[i].voxel_from_world);
    }
    meshes_take(atlas, moved->meshes);
    bundles_take(atlas, moved->tractograms);
}

conus_status atlas_move(conus_atlas *atlas, const double atlas_from_world[16], const char *words)
{
    struct moved moved = {0};
    double world_from_atlas[16];
    conus_status status = space_invert(world_from_atlas, atlas_from_world, words);
    if (status) {
        return status;
    }
    size_t note_count = atlas->notes.count;
    status = move_all(&moved, atlas, world_from_atlas);
    double growth = fabs(mat4_determinant3(world_from_atlas));
    bool mirrors = mat4_determinant3(atlas_from_world) < 0;
    status = status ? status : notes_add(&atlas->notes, "moved by %s: what was 1 mm^3 is %.4g mm^3", words, growth);
    status =
        status || !mirrors
            ? status
            : notes_warn(&atlas->notes, "%s mirrors: left areas of the atlas are right ones where poses are", words);
    if (!status) {
        take(atlas, &moved);
        /* Volumes scale with the matrix; those of meshes are measured anew. */
        for (size_t i = 0; i < atlas->object_count; i++) {
            atlas->objects[i].volume_mm3 *= atlas->places[i].is_mesh ? 1 : growth;
        }
        if (atlas->is_moved) {
            mat4_multiply(atlas->own_from_world, atlas->own_from_world, atlas_from_world);
        } else {
            memcpy(atlas->own_from_world, atlas_from_world, sizeof atlas->own_from_world);
        }
        atlas_note_move(atlas);
    } else {
        notes_cut(&atlas->notes, note_count);
    }
    for (size_t i = 0; moved.tractograms && i < atlas->tractogram_count; i++) {
        tractogram_finish(&moved.tractograms[i]);
    }
    memory_free(moved.tractograms);
    for (size_t i = 0; moved.meshes && i < atlas->mesh_count; i++) {
        mesh_finish(&moved.meshes[i]);
    }
    memory_free(moved.meshes);
    memory_free(moved.volumes);
    return status;
}

void conus_atlas_own_point(double out[3], const conus_atlas *atlas, const double point[3])
{
    if (atlas->is_moved) {
        mat4_point(out, atlas->own_from_world, point);
        (void)warps_point(out, atlas->warps, atlas->warp_count, out);
    } else {
        memcpy(out, point, 3 * sizeof *out);
    }
}

bool conus_atlas_is_warped(const conus_atlas *atlas)
{
    return atlas->warp_count > 0;
}
