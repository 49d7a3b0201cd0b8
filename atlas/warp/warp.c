/* SPDX-License-Identifier: BSD-3-Clause */
/* Moves an atlas by a deformation field: everything is made first, so that nothing can fail when the atlas changes. */
#include "atlas/warp/warp.h"

#include "atlas/atlas.h"
#include "atlas/deformation/deformation.h"
#include "atlas/warp/warp_parts.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#define SHORT_WAY 0.1 /* mm; vectors that are all shorter are hardly in mm */
#define LONG_WAY 300.0

static conus_status note_facts(struct notes *notes, const struct deformation *field, const char *words)
{
    struct deformation_facts facts;
    conus_status status = deformation_facts_find(&facts, field);
    bool is_plausible = facts.farthest >= SHORT_WAY && facts.farthest <= LONG_WAY;
    if (!status && field->stays_outside && !is_plausible) {
        status = notes_warn(notes, "%s: the farthest way of a point is %.3g mm: are the field's vectors in mm?", words,
                            facts.farthest);
    }
    if (!status && !(facts.growth >= 0.1 && facts.growth <= 10)) {
        status =
            notes_warn(notes, "%s: 1 mm^3 becomes %.3g mm^3 of the atlas: is the field in mm?", words, facts.growth);
    }
    if (!status && facts.folds) {
        status = notes_add(notes, "%s: the field folds (Jacobian <= 0) in %zu of %zu cells", words, facts.folds,
                           facts.cells);
    }
    if (!status && facts.unstated) {
        status = notes_add(notes, "%s: the field has no value at %.3g %% of its nodes: nothing of the atlas is there",
                           words, 100 * (double)facts.unstated / (double)facts.nodes);
    }
    if (!status && facts.mirrors) {
        status = notes_warn(notes, "%s mirrors: left areas of the atlas are right ones where poses are", words);
    }
    if (!status && facts.half_turn) {
        status =
            notes_warn(notes, "%s turns by half a circle about z, as positions in LPS would: RAS is needed", words);
    }
    return status;
}

/* `names` of points, of what they make, and of one point. */
static conus_status note_counts(struct notes *notes, const struct warped_counts *counts, bool stays, const char *words,
                                const char *const names[3])
{
    conus_status status = CONUS_OK;
    const unsigned long long points = counts->points;
    if (counts->outside) {
        status = notes_add(notes, "%s: %llu of %llu %s lie outside of the field%s", words,
                           (unsigned long long)counts->outside, points, names[0],
                           stays ? "; those outside of its grid stay where they are" : "");
    }
    if (!status && counts->lost) {
        status = notes_add(notes, "%s: %llu of %llu %s have no place: the field folds there, or has no value", words,
                           (unsigned long long)counts->lost, points, names[0]);
    }
    if (!status && counts->cut) {
        status = notes_add(notes, "%s: %llu of %llu %s are left out, with a %s that has no place", words,
                           (unsigned long long)counts->cut, (unsigned long long)counts->wholes, names[1], names[2]);
    }
    return status;
}

/* Before the atlas has these voxels, of whose space the matrix leads to where it is. */
static conus_status note_grid(conus_atlas *atlas, const struct warp_plan *plan, const double atlas_from_world[16],
                              const char *before, const char *behind)
{
    const conus_volume_info *grid = plan->grid;
    double atlas_from_voxel[16];
    mat4_multiply(atlas_from_voxel, atlas_from_world, grid->world_from_voxel);
    double coarse = warp_coarseness(atlas_from_voxel, atlas);
    conus_status status = notes_add(
        &atlas->notes, "%s%s%s, on a grid of %zu x %zu x %zu voxels of %.3g x %.3g x %.3g mm", before, plan->words,
        behind, grid->dim[0], grid->dim[1], grid->dim[2], grid->spacing[0], grid->spacing[1], grid->spacing[2]);
    return status || coarse <= WARP_AS_FINE
               ? status
               : notes_add(&atlas->notes,
                           "%s: voxels of this grid are up to %.3g times as long as the atlas's, so that areas are "
                           "coarser: grid=IMAGE takes a finer one",
                           plan->words, coarse);
}

static conus_status check_state(const conus_atlas *atlas)
{
    bool attached = false;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        attached = attached || (atlas->volumes[i].is_borrowed && !atlas->volumes[i].source);
    }
    if (atlas_has_hidden(atlas)) {
        return fail(CONUS_ERROR_ARGUMENT, "an atlas is warped before something of it is hidden");
    }
    return attached && atlas->warp_count
               ? fail(CONUS_ERROR_ARGUMENT, "an atlas that was warped before it was packed cannot be warped again: "
                                            "pack it with both transforms")
               : CONUS_OK;
}

/* The new parts, made before the atlas changes. */
struct parts {
    struct warped_volumes volumes;
    struct warped_meshes meshes;
    struct warped_tracts tracts;
    struct notes notes; /* about the surfaces' shapes */
};

/* Reserves places for more warps, which count only when the atlas has moved. */
static conus_status reserve_warps(struct warp_way *way, conus_atlas *atlas, const struct deformation *fields,
                                  size_t count)
{
    struct warp *warps = memory_resize(atlas->warps, atlas->warp_count + count, sizeof *warps);
    if (!warps) {
        return CONUS_ERROR_MEMORY;
    }
    atlas->warps = warps;
    for (size_t i = 0; i < count; i++) {
        warps[atlas->warp_count + i].field = fields[i];
        mat4_identity(warps[atlas->warp_count + i].after);
    }
    if (atlas->is_moved) {
        memcpy(warps[atlas->warp_count].after, atlas->own_from_world, sizeof atlas->own_from_world);
    }
    *way = (struct warp_way){.warps = warps, .count = atlas->warp_count + count};
    mat4_identity(way->first);
    return CONUS_OK;
}

conus_status atlas_warp(conus_atlas *atlas, struct deformation *fields, size_t count, const struct warp_plan *plan)
{
    static const char *const of_meshes[] = {"vertices", "triangles", "vertex"};
    static const char *const of_tracts[] = {"points of streamlines", "streamlines", "point"};
    struct parts parts = {0};
    struct warp_way way;
    size_t note_count = atlas->notes.count;
    conus_status status = check_state(atlas);
    bool stays = true;
    status = status ? status : reserve_warps(&way, atlas, fields, count);
    status = status ? status : warped_volumes_init(&parts.volumes, atlas, &way, plan);
    status = status ? status : warped_meshes_init(&parts.meshes, atlas, fields, count, &parts.notes);
    status = status ? status : warped_tracts_init(&parts.tracts, atlas, fields, count);
    if (!status) {
        status = note_grid(atlas, plan, way.first, "warped by ", ": voxels are those of the atlas that are nearest");
        for (size_t i = 0; !status && i < count; i++) {
            status = note_facts(&atlas->notes, &fields[i], plan->words);
            stays = stays && fields[i].stays_outside;
        }
        status = status ? status : warped_volumes_note(&parts.volumes, atlas, plan->words);
        status = status ? status : note_counts(&atlas->notes, &parts.meshes.counts, stays, plan->words, of_meshes);
        status = status ? status : note_counts(&atlas->notes, &parts.tracts.counts, stays, plan->words, of_tracts);
        status = status ? status : notes_move(&atlas->notes, &parts.notes);
    }
    if (!status) {
        frame_keep_ccf(atlas);
        warped_volumes_take(&parts.volumes, atlas);
        meshes_take(atlas, parts.meshes.items);
        bundles_take(atlas, parts.tracts.items);
        atlas->warp_count += count;
        memset(fields, 0, count * sizeof *fields);
        mat4_identity(atlas->own_from_world);
        atlas_note_move(atlas);
    } else {
        notes_cut(&atlas->notes, note_count);
    }
    warped_volumes_finish(&parts.volumes, atlas->volume_count);
    warped_meshes_finish(&parts.meshes, atlas->mesh_count);
    warped_tracts_finish(&parts.tracts, atlas->tractogram_count);
    notes_finish(&parts.notes);
    return status;
}

conus_status atlas_move_onto(conus_atlas *atlas, const double atlas_from_world[16], const struct warp_plan *plan)
{
    struct warped_volumes volumes = {0};
    struct warp_way way = {.warps = atlas->warps, .count = atlas->warp_count};
    size_t note_count = atlas->notes.count;
    if (!atlas->warp_count) {
        return fail(CONUS_ERROR_ARGUMENT, "grid: nothing is resampled, since no deformation field has moved the atlas");
    }
    mat4_multiply(way.first, atlas->own_from_world, atlas_from_world);
    conus_status status = check_state(atlas);
    status = status ? status : warped_volumes_init(&volumes, atlas, &way, plan);
    status = status
                 ? status
                 : note_grid(atlas, plan, atlas_from_world, "", ": voxels are taken anew from the atlas's own, once");
    status = status ? status : warped_volumes_note(&volumes, atlas, plan->words);
    status = status ? status : atlas_move(atlas, atlas_from_world, plan->words);
    if (!status) {
        warped_volumes_take(&volumes, atlas);
    } else {
        notes_cut(&atlas->notes, note_count);
    }
    warped_volumes_finish(&volumes, atlas->volume_count);
    return status;
}
