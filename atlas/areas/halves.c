/* SPDX-License-Identifier: BSD-3-Clause */
/* One as a pair: areas on both sides cut at x = 0. */
#include "atlas/areas/halves.h"

#include "atlas/areas/area_sides.h"
#include "atlas/areas/pairs.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

enum { LEFT = 0, RIGHT, SIDES };

/** What becomes of an area. */
struct fate {
    char side;              /* it has by pair, table or name; 0 = none */
    uint64_t voxels[SIDES]; /* of its own, by their centres */
    bool reaches[SIDES];    /* itself or what is below it, on that side */
    bool is_cut;
    uint32_t number[SIDES]; /* its new ones; of a whole area both are the same */
};

struct splitting {
    const conus_atlas *atlas;
    conus_atlas *areas; /* what the atlas is to have */
    struct fate *fates; /* [area_count + 1] */
    uint16_t *objects16;
    uint32_t *objects32; /* one of them: the parcellation's new object numbers */
    size_t cut_count;
    uint32_t label_step;
};

static conus_status find_sides(struct splitting *splitting)
{
    size_t count = splitting->atlas->area_count;
    char *sides = memory_zeroed(count + 1, 1);
    conus_status status = sides ? area_sides_find(sides, splitting->atlas) : CONUS_ERROR_MEMORY;
    for (size_t number = 1; !status && number <= count; number++) {
        splitting->fates[number].side = (char)(sides[number] == 'B' ? 0 : sides[number]);
    }
    memory_free(sides);
    return status;
}

/* Called with each voxel of an area, and its side. */
typedef void (*voxel_act)(struct splitting *splitting, size_t voxel, int side);

/* The midline is that of the atlas's own space. There and back a centre on it is right by rounding only. */
static void each_voxel(struct splitting *splitting, voxel_act act)
{
    const conus_atlas *atlas = splitting->atlas;
    const conus_volume_info *info = &atlas_parcellation(atlas)->info;
    double m[16];
    memcpy(m, info->world_from_voxel, sizeof m);
    if (atlas->is_moved) {
        mat4_multiply(m, atlas->own_from_world, m);
        m[12] += 1e-6;
    }
    for (size_t k = 0; k < info->dim[2]; k++) {
        for (size_t j = 0; j < info->dim[1]; j++) {
            size_t first = info->dim[0] * (j + info->dim[1] * k);
            const double step = m[0];
            const double start = m[4] * (double)j + m[8] * (double)k + m[12];
            const struct volume *volume = atlas_parcellation(splitting->atlas);
            for (size_t i = 0; i < volume->info.dim[0]; i++) {
                if (volume_object(volume, first + i)) {
                    act(splitting, first + i, start + step * (double)i < 0 ? LEFT : RIGHT);
                }
            }
        }
    }
}

static void count_voxel(struct splitting *splitting, size_t voxel, int side)
{
    splitting->fates[volume_object(atlas_parcellation(splitting->atlas), voxel)].voxels[side]++;
}

static void decide_fates(struct splitting *splitting)
{
    size_t count = splitting->atlas->area_count;
    for (uint32_t number = 1; number <= count; number++) {
        const struct fate *fate = &splitting->fates[number];
        for (int side = LEFT; side < SIDES; side++) {
            bool here = fate->side ? fate->side == "LR"[side] : fate->voxels[side] > 0;
            if (here && (fate->voxels[LEFT] || fate->voxels[RIGHT])) {
                uint32_t above = number;
                while (above && !splitting->fates[above].reaches[side]) {
                    splitting->fates[above].reaches[side] = true;
                    above = splitting->atlas->objects[above - 1].parent;
                }
            }
        }
    }
    for (uint32_t number = 1; number <= count; number++) {
        struct fate *fate = &splitting->fates[number];
        fate->is_cut = !fate->side && fate->reaches[LEFT] && fate->reaches[RIGHT];
        splitting->cut_count += fate->is_cut;
    }
}

/* Whole areas keep their order; left halves follow, then right ones, so that labels ascend. */
static void number_areas(struct splitting *splitting)
{
    size_t count = splitting->atlas->area_count;
    uint32_t number = 0;
    for (uint32_t old = 1; old <= count; old++) {
        struct fate *fate = &splitting->fates[old];
        if (!fate->is_cut) {
            fate->number[LEFT] = fate->number[RIGHT] = ++number;
        }
    }
    for (int side = LEFT; side < SIDES; side++) {
        for (uint32_t old = 1; old <= count; old++) {
            struct fate *fate = &splitting->fates[old];
            if (fate->is_cut) {
                fate->number[side] = ++number;
            }
        }
    }
}

/* The new parent of what lies on `side` below area `old`; on no side, the nearest whole one. */
static uint32_t parent_on(const struct splitting *splitting, uint32_t old, int side)
{
    while (old && side == SIDES && splitting->fates[old].is_cut) {
        old = splitting->atlas->objects[old - 1].parent;
    }
    return old ? splitting->fates[old].number[side == SIDES ? LEFT : side] : 0;
}

static int side_of(const struct fate *fate)
{
    bool left = fate->side ? fate->side == 'L' : fate->reaches[LEFT] && !fate->reaches[RIGHT];
    bool right = fate->side ? fate->side == 'R' : fate->reaches[RIGHT] && !fate->reaches[LEFT];
    return left ? LEFT : right ? RIGHT : SIDES;
}

static conus_status add_whole(struct splitting *splitting, uint32_t old)
{
    const conus_atlas *atlas = splitting->atlas;
    conus_object area = atlas->objects[old - 1];
    area.parent = parent_on(splitting, area.parent, side_of(&splitting->fates[old]));
    return atlas_append_object(splitting->areas, &area, atlas->places[old - 1]);
}

static conus_status add_half(struct splitting *splitting, uint32_t old, int side)
{
    const conus_atlas *atlas = splitting->atlas;
    conus_object area = atlas->objects[old - 1];
    struct buffer name = {0};
    struct buffer abbreviation = {0};
    buffer_format(&name, "%s %s", area.name, side == LEFT ? "left" : "right");
    buffer_format(&abbreviation, "%s%s", area.abbreviation, !*area.abbreviation ? "" : side == LEFT ? "_L" : "_R");
    conus_status status = buffer_status(&name);
    status = status ? status : buffer_status(&abbreviation);
    if (!status) {
        area.name = name.data;
        area.abbreviation = abbreviation.data;
        area.hemisphere = "LR"[side];
        area.label += splitting->label_step * (uint32_t)(side == LEFT ? 1 : 2);
        area.parent = parent_on(splitting, area.parent, side);
        area.voxels = splitting->fates[old].voxels[side];
        area.volume_mm3 = (double)area.voxels * space_voxel_mm3(&atlas_parcellation(atlas)->info);
        status = atlas_append_object(splitting->areas, &area, atlas->places[old - 1]);
    }
    buffer_finish(&name);
    buffer_finish(&abbreviation);
    return status;
}

static conus_status add_areas(struct splitting *splitting)
{
    size_t count = splitting->atlas->area_count;
    conus_status status = atlas_create_empty(&splitting->areas, "");
    for (uint32_t old = 1; !status && old <= count; old++) {
        status = splitting->fates[old].is_cut ? CONUS_OK : add_whole(splitting, old);
    }
    for (int side = LEFT; side < SIDES; side++) {
        for (uint32_t old = 1; !status && old <= count; old++) {
            status = splitting->fates[old].is_cut ? add_half(splitting, old, side) : CONUS_OK;
        }
    }
    return status;
}

static void number_voxel(struct splitting *splitting, size_t voxel, int side)
{
    uint32_t old = volume_object(atlas_parcellation(splitting->atlas), voxel);
    uint32_t number = splitting->fates[old].number[side];
    if (splitting->objects16) {
        splitting->objects16[voxel] = (uint16_t)number;
    } else {
        splitting->objects32[voxel] = number;
    }
}

static conus_status check_atlas(const conus_atlas *atlas)
{
    if (atlas->mesh_count) {
        return fail(CONUS_ERROR_UNSUPPORTED, "split: %zu areas are surfaces, only areas of voxels can be cut",
                    atlas->mesh_count);
    }
    if (atlas_has_probabilities(atlas)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "split: areas of probabilities overlap, only those of labels can be cut");
    }
    size_t grids = atlas_parcellation_count(atlas);
    if (grids > 1) {
        return fail(CONUS_ERROR_UNSUPPORTED, "split: the areas lie on %zu grids, only those on one can be cut", grids);
    }
    return grids ? CONUS_OK : fail(CONUS_ERROR_DATA, "split: there are no areas");
}

static void count_sides(uint64_t out[SIDES], const struct splitting *splitting)
{
    out[LEFT] = out[RIGHT] = 0;
    for (size_t number = 1; number <= splitting->atlas->area_count; number++) {
        out[LEFT] += splitting->fates[number].voxels[LEFT];
        out[RIGHT] += splitting->fates[number].voxels[RIGHT];
    }
}

static conus_status refuse_uncut(const struct splitting *splitting)
{
    uint64_t voxels[SIDES];
    count_sides(voxels, splitting);
    return voxels[LEFT] && voxels[RIGHT]
               ? fail(CONUS_ERROR_DATA, "split: each of the %zu areas is left or right already",
                      splitting->atlas->area_count)
               : fail(CONUS_ERROR_DATA, "split: all voxels lie at x %s 0, so x = 0 is not the midline of this atlas",
                      voxels[LEFT] ? "<" : ">=");
}

static conus_status prepare_halves(struct splitting *splitting)
{
    conus_status status = check_atlas(splitting->atlas);
    if (status) {
        return status;
    }
    splitting->fates = memory_zeroed(splitting->atlas->area_count + 1, sizeof *splitting->fates);
    status = splitting->fates ? find_sides(splitting) : CONUS_ERROR_MEMORY;
    status = status ? status : hemispheres_label_step(&splitting->label_step, splitting->atlas);
    if (!status) {
        each_voxel(splitting, count_voxel);
        decide_fates(splitting);
        status = splitting->cut_count ? CONUS_OK : refuse_uncut(splitting);
    }
    if (!status) {
        number_areas(splitting);
        status = add_areas(splitting);
    }
    if (status) {
        return status;
    }
    size_t voxels = atlas_parcellation(splitting->atlas)->voxel_count;
    bool narrow = splitting->areas->object_count <= UINT16_MAX;
    splitting->objects16 = narrow ? memory_zeroed(voxels, sizeof *splitting->objects16) : NULL;
    splitting->objects32 = narrow ? NULL : memory_zeroed(voxels, sizeof *splitting->objects32);
    if (!splitting->objects16 && !splitting->objects32) {
        return CONUS_ERROR_MEMORY;
    }
    each_voxel(splitting, number_voxel);
    return CONUS_OK;
}

conus_status hemispheres_split(conus_atlas *atlas)
{
    struct splitting splitting = {.atlas = atlas};
    size_t notes = atlas->notes.count;
    conus_status status = prepare_halves(&splitting);
    if (!status) {
        uint64_t voxels[SIDES];
        count_sides(voxels, &splitting);
        status = notes_add(
            &atlas->notes,
            "hemispheres: %zu areas are cut in two at x = 0, which is taken as the midline: %llu voxels lie left "
            "of it, %llu on it or right",
            splitting.cut_count, (unsigned long long)voxels[LEFT], (unsigned long long)voxels[RIGHT]);
    }
    if (!status) {
        status = atlas_exchange_areas(atlas, splitting.areas);
        if (status) {
            notes_cut(&atlas->notes, notes);
        }
    }
    if (!status) {
        memory_free(atlas->volumes[0].objects16);
        memory_free(atlas->volumes[0].objects32);
        atlas->volumes[0].objects16 = splitting.objects16;
        atlas->volumes[0].objects32 = splitting.objects32;
        splitting.objects16 = NULL;
        splitting.objects32 = NULL;
        atlas->hemispheres = CONUS_HEMISPHERES_SPLIT;
        atlas->half_step = splitting.label_step;
    }
    conus_atlas_destroy(splitting.areas);
    memory_free(splitting.fates);
    memory_free(splitting.objects16);
    memory_free(splitting.objects32);
    return status;
}
