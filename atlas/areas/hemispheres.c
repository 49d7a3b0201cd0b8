/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_set_hemispheres(): areas cut in two at the midline, or pairs merged into an area above both. */
#include "atlas/areas/areas.h"
#include "atlas/atlas.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"

#include <stdlib.h>
#include <string.h>

enum { LEFT = 0, RIGHT, SIDES };

/** How an area is cut. */
struct split_area {
    char side;              /* it has by pair, table or name; 0 = none */
    uint64_t voxels[SIDES]; /* of its own, by their centres */
    bool reaches[SIDES];    /* itself or what is below it, on that side */
    bool is_cut;
    uint32_t number[SIDES]; /* its new ones; of a whole area both are the same */
};

struct splitting {
    const conus_atlas *atlas;
    struct midline midline;
    conus_atlas *areas;       /* what the atlas is to have */
    struct split_area *split; /* [area_count + 1] */
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
        splitting->split[number].side = (char)(sides[number] == 'B' ? 0 : sides[number]);
    }
    memory_free(sides);
    return status;
}

/* Called with each voxel of an area, and its side. */
typedef void (*voxel_act)(struct splitting *splitting, size_t voxel, int side);

/* The midline is that of the atlas's own space. A centre on it counts as right despite rounding there and back. */
static void each_voxel(struct splitting *splitting, voxel_act act)
{
    const conus_atlas *atlas = splitting->atlas;
    const conus_volume_info *info = &atlas_parcellation(atlas)->info;
    double m[16];
    memcpy(m, info->world_from_voxel, sizeof m);
    if (atlas->is_moved) {
        mat4_multiply(m, atlas->own_from_world, m);
    }
    mat4_multiply(m, splitting->midline.side_from_own, m);
    m[12] += atlas->is_moved || splitting->midline.is_ccf ? FRAME_MIDLINE_ROUNDING : 0;
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
    splitting->split[volume_object(atlas_parcellation(splitting->atlas), voxel)].voxels[side]++;
}

static void decide_cuts(struct splitting *splitting)
{
    size_t count = splitting->atlas->area_count;
    for (uint32_t number = 1; number <= count; number++) {
        const struct split_area *area = &splitting->split[number];
        for (int side = LEFT; side < SIDES; side++) {
            bool here = area->side ? area->side == "LR"[side] : area->voxels[side] > 0;
            if (here && (area->voxels[LEFT] || area->voxels[RIGHT])) {
                uint32_t above = number;
                while (above && !splitting->split[above].reaches[side]) {
                    splitting->split[above].reaches[side] = true;
                    above = splitting->atlas->objects[above - 1].parent;
                }
            }
        }
    }
    for (uint32_t number = 1; number <= count; number++) {
        struct split_area *area = &splitting->split[number];
        area->is_cut = !area->side && area->reaches[LEFT] && area->reaches[RIGHT];
        splitting->cut_count += area->is_cut;
    }
}

/* Whole areas keep their order; left halves follow, then right ones, so that labels ascend. */
static void number_areas(struct splitting *splitting)
{
    size_t count = splitting->atlas->area_count;
    uint32_t number = 0;
    for (uint32_t old = 1; old <= count; old++) {
        struct split_area *area = &splitting->split[old];
        if (!area->is_cut) {
            area->number[LEFT] = area->number[RIGHT] = ++number;
        }
    }
    for (int side = LEFT; side < SIDES; side++) {
        for (uint32_t old = 1; old <= count; old++) {
            struct split_area *area = &splitting->split[old];
            if (area->is_cut) {
                area->number[side] = ++number;
            }
        }
    }
}

/* The new parent, on `side`, of areas below area `old`; for no side, the nearest area that is not cut. */
static uint32_t parent_on(const struct splitting *splitting, uint32_t old, int side)
{
    while (old && side == SIDES && splitting->split[old].is_cut) {
        old = splitting->atlas->objects[old - 1].parent;
    }
    return old ? splitting->split[old].number[side == SIDES ? LEFT : side] : 0;
}

static conus_status add_whole(struct splitting *splitting, uint32_t old)
{
    const conus_atlas *atlas = splitting->atlas;
    const struct split_area *split = &splitting->split[old];
    conus_object area = atlas->objects[old - 1];
    bool left = split->side ? split->side == 'L' : split->reaches[LEFT] && !split->reaches[RIGHT];
    bool right = split->side ? split->side == 'R' : split->reaches[RIGHT] && !split->reaches[LEFT];
    area.parent = parent_on(splitting, area.parent, left ? LEFT : right ? RIGHT : SIDES);
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
        area.voxels = splitting->split[old].voxels[side];
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
        status = splitting->split[old].is_cut ? CONUS_OK : add_whole(splitting, old);
    }
    for (int side = LEFT; side < SIDES; side++) {
        for (uint32_t old = 1; !status && old <= count; old++) {
            status = splitting->split[old].is_cut ? add_half(splitting, old, side) : CONUS_OK;
        }
    }
    return status;
}

static void number_voxel(struct splitting *splitting, size_t voxel, int side)
{
    uint32_t old = volume_object(atlas_parcellation(splitting->atlas), voxel);
    uint32_t number = splitting->split[old].number[side];
    if (splitting->objects16) {
        splitting->objects16[voxel] = (uint16_t)number;
    } else {
        splitting->objects32[voxel] = number;
    }
}

static void count_sides(uint64_t out[SIDES], const struct splitting *splitting)
{
    out[LEFT] = out[RIGHT] = 0;
    for (size_t number = 1; number <= splitting->atlas->area_count; number++) {
        out[LEFT] += splitting->split[number].voxels[LEFT];
        out[RIGHT] += splitting->split[number].voxels[RIGHT];
    }
}

static conus_status refuse_uncut(const struct splitting *splitting)
{
    uint64_t voxels[SIDES];
    count_sides(voxels, splitting);
    return voxels[LEFT] && voxels[RIGHT]
               ? fail(CONUS_ERROR_DATA, "split: each of the %zu areas is left or right already",
                      splitting->atlas->area_count)
           : splitting->midline.is_ccf
               ? fail(CONUS_ERROR_DATA, "split: all voxels lie on one side of the Allen CCF's midline, ML %d um",
                      FRAME_CCF_MIDDLE)
               : fail(CONUS_ERROR_DATA, "split: all voxels lie at x %s 0, so x = 0 is not the midline of this atlas",
                      voxels[LEFT] ? "<" : ">=");
}

static conus_status prepare_halves(struct splitting *splitting)
{
    if (splitting->atlas->mesh_count) {
        return fail(CONUS_ERROR_UNSUPPORTED, "split: %zu areas are surfaces, only areas of voxels can be cut",
                    splitting->atlas->mesh_count);
    }
    if (atlas_has_probabilities(splitting->atlas)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "split: areas of probabilities overlap, only those of labels can be cut");
    }
    size_t grids = atlas_parcellation_count(splitting->atlas);
    if (grids > 1) {
        return fail(CONUS_ERROR_UNSUPPORTED, "split: the areas lie on %zu grids, only those on one can be cut", grids);
    }
    if (!grids) {
        return fail(CONUS_ERROR_DATA, "split: there are no areas");
    }
    frame_midline(&splitting->midline, splitting->atlas);
    if (splitting->midline.is_turned) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "split: what x calls left in this atlas of the Allen CCF has the greater ML, which is right from "
                    "bregma (docs/spaces.md): a half could be either; near:AREA or a point choose a side");
    }
    splitting->split = memory_zeroed(splitting->atlas->area_count + 1, sizeof *splitting->split);
    conus_status status = splitting->split ? find_sides(splitting) : CONUS_ERROR_MEMORY;
    status = status ? status : hemispheres_label_step(&splitting->label_step, splitting->atlas);
    if (!status) {
        each_voxel(splitting, count_voxel);
        decide_cuts(splitting);
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

/* Cuts areas of voxels that are on both sides in two: voxels with a centre left of the midline and the others. The
 * halves' labels are the area's with a 1 or 2 before it; areas above them become two, too. Areas with a side, by pair,
 * table or a name like "Left-vessel", or because all their voxels are on it, stay whole, and so do areas without a
 * voxel. CONUS_ERROR_DATA if nothing can be cut, CONUS_ERROR_UNSUPPORTED if there are meshes. */
static conus_status hemispheres_split(conus_atlas *atlas)
{
    struct splitting splitting = {.atlas = atlas};
    size_t notes = atlas->notes.count;
    conus_status status = prepare_halves(&splitting);
    if (!status) {
        uint64_t voxels[SIDES];
        count_sides(voxels, &splitting);
        status =
            notes_add(&atlas->notes,
                      "hemispheres: %zu areas are cut in two at %s: %llu voxels lie left of it, %llu on it or right",
                      splitting.cut_count,
                      splitting.midline.is_ccf ? "ML 5700 um, the midline of the Allen CCF"
                                               : "x = 0, which is taken as the midline",
                      (unsigned long long)voxels[LEFT], (unsigned long long)voxels[RIGHT]);
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
    memory_free(splitting.split);
    memory_free(splitting.objects16);
    memory_free(splitting.objects32);
    return status;
}

enum { BOTH = 3, SHOWN = 4 };

struct pair {
    uint32_t left, right; /* numbers */
    char *name;
};

struct merging {
    const conus_atlas *atlas;
    conus_atlas *areas; /* what the atlas is to have */
    uint32_t *right_of; /* [area_count + 1] */
    struct pair *pairs; /* by left number */
    size_t pair_count;
    uint32_t *pair_of;  /* [area_count + 1] number of the area above; 0 = is in no pair */
    const char **names; /* of new areas and of those in no pair, sorted */
    size_t name_count;
    uint32_t label_step;
};

static conus_status name_pair(struct pair *pair, const conus_atlas *atlas)
{
    struct buffer name = {0};
    hemispheres_common_name(&name, atlas->objects[pair->left - 1].name, atlas->objects[pair->right - 1].name);
    buffer_text(&name, "");
    conus_status status = buffer_status(&name);
    if (status) {
        buffer_finish(&name);
        return status;
    }
    pair->name = name.data;
    return CONUS_OK;
}

static conus_status list_pairs(struct merging *merging)
{
    const conus_atlas *atlas = merging->atlas;
    conus_status status = CONUS_OK;
    merging->pairs = memory_zeroed(atlas->area_count, sizeof *merging->pairs);
    merging->pair_of = memory_zeroed(atlas->area_count + 1, sizeof *merging->pair_of);
    if (!merging->pairs || !merging->pair_of) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t left = 1; !status && left <= atlas->area_count; left++) {
        uint32_t right = merging->right_of[left];
        if (right) {
            struct pair *pair = &merging->pairs[merging->pair_count++];
            *pair = (struct pair){.left = left, .right = right};
            merging->pair_of[left] = merging->pair_of[right] = (uint32_t)(atlas->area_count + merging->pair_count);
            status = name_pair(pair, atlas);
        }
    }
    return status;
}

static conus_status list_names(struct merging *merging)
{
    const conus_atlas *atlas = merging->atlas;
    merging->names = memory_raw(atlas->area_count, sizeof(char *));
    if (!merging->names) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t number = 1; number <= atlas->area_count; number++) {
        if (!merging->pair_of[number]) {
            merging->names[merging->name_count++] = atlas->objects[number - 1].name;
        }
    }
    for (size_t i = 0; i < merging->pair_count; i++) {
        merging->names[merging->name_count++] = merging->pairs[i].name;
    }
    order_sort(merging->names, merging->name_count, sizeof(char *), compare_text_pointers);
    return CONUS_OK;
}

static bool is_unique(const struct merging *merging, const char *name)
{
    const char **names = merging->names;
    const char **found = bsearch(&name, names, merging->name_count, sizeof(char *), compare_text_pointers);
    bool first = found == names || strcmp(found[-1], name) != 0;
    bool last = found + 1 == names + merging->name_count || strcmp(found[1], name) != 0;
    return first && last;
}

static conus_status add_pair(struct merging *merging, const struct pair *pair)
{
    const conus_object *left = &merging->atlas->objects[pair->left - 1];
    const conus_object *right = &merging->atlas->objects[pair->right - 1];
    struct buffer name = {0};
    struct buffer abbreviation = {0};
    conus_object area = {.kind = CONUS_KIND_AREA, .hemisphere = 'B', .named = left->named};
    if (*pair->name && is_unique(merging, pair->name)) {
        buffer_text(&name, pair->name);
    } else { /* "Thalamus_L + Thalamus_R" where another is called Thalamus */
        buffer_format(&name, "%s + %s", left->name, right->name);
    }
    /* Abbreviations may end in the side without a separator: AntL and AntR. Their names give the sides. */
    size_t length = strlen(left->abbreviation);
    hemispheres_common_name(&abbreviation, left->abbreviation, right->abbreviation);
    bool attached = !abbreviation.size && length > 1 && strlen(right->abbreviation) == length &&
                    left->abbreviation[length - 1] == 'L' && right->abbreviation[length - 1] == 'R' &&
                    strncmp(left->abbreviation, right->abbreviation, length - 1) == 0;
    buffer_append(&abbreviation, left->abbreviation, attached ? length - 1 : 0);
    conus_status status = buffer_status(&name);
    status = status ? status : buffer_status(&abbreviation);
    if (!status) {
        area.label = BOTH * merging->label_step + left->label;
        area.name = name.data;
        area.abbreviation = abbreviation.data;
        area.parent = left->parent == right->parent ? left->parent : merging->pair_of[left->parent];
        memcpy(area.rgb, left->rgb, sizeof area.rgb);
        status = atlas_append_object(merging->areas, &area, (struct object_place){.index = SIZE_MAX});
    }
    buffer_finish(&name);
    buffer_finish(&abbreviation);
    return status;
}

/* "hemispheres merged: ...; 8 areas have no counterpart (Vermis_1_2, ...)". */
static conus_status note_merging(conus_atlas *atlas, const struct merging *merging)
{
    struct buffer list = {0};
    size_t single = 0;
    for (uint32_t number = 1; number <= merging->atlas->area_count; number++) {
        if (!merging->pair_of[number] && single++ < SHOWN) {
            buffer_format(&list, "%s%s", single > 1 ? ", " : "", merging->atlas->objects[number - 1].name);
        }
    }
    conus_status status = buffer_status(&list);
    if (!status && single) {
        status = notes_add(&atlas->notes,
                           "hemispheres: %zu pairs are reported as one area each; without a counterpart: %zu (%s%s)",
                           merging->pair_count, single, list.data, single > SHOWN ? ", ..." : "");
    } else if (!status) {
        status = notes_add(&atlas->notes, "hemispheres: %zu pairs are reported as one area each", merging->pair_count);
    }
    buffer_finish(&list);
    return status;
}

static conus_status prepare_merging(struct merging *merging)
{
    if (atlas_has_probabilities(merging->atlas)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "merged: areas of probabilities overlap, their sum is no volume");
    }
    conus_status status = hemispheres_pair(&merging->right_of, merging->atlas);
    status = status ? status : list_pairs(merging);
    if (!status && !merging->pair_count) {
        return fail(CONUS_ERROR_DATA,
                    "merged: no two of its %zu areas are left and right of one, like Precentral_L and "
                    "Precentral_R or by a column hemisphere",
                    merging->atlas->area_count);
    }
    status = status ? status : hemispheres_label_step(&merging->label_step, merging->atlas);
    status = status ? status : list_names(merging);
    if (status) {
        return status;
    }
    status = atlas_create_empty(&merging->areas, "");
    for (uint32_t number = 1; !status && number <= merging->atlas->area_count; number++) {
        const conus_atlas *atlas = merging->atlas;
        conus_object area = atlas->objects[number - 1];
        area.parent = merging->pair_of[number] ? merging->pair_of[number] : area.parent;
        status = atlas_append_object(merging->areas, &area, atlas->places[number - 1]);
    }
    for (size_t i = 0; !status && i < merging->pair_count; i++) {
        status = add_pair(merging, &merging->pairs[i]);
    }
    return status;
}

/* Adds an area above each pair, with the pair's name without the side; level_create() then reports pairs as it. Its
 * label is the left one's with a 3 before it, at the place that no label reaches. CONUS_ERROR_DATA without a pair. */
static conus_status merge_pairs(conus_atlas *atlas)
{
    struct merging merging = {.atlas = atlas};
    uint32_t first_pair = (uint32_t)atlas->area_count + 1;
    size_t notes = atlas->notes.count;
    conus_status status = prepare_merging(&merging);
    status = status ? status : note_merging(atlas, &merging);
    if (!status) {
        status = atlas_exchange_areas(atlas, merging.areas);
        if (status) {
            notes_cut(&atlas->notes, notes);
        }
    }
    if (!status) {
        atlas->first_pair = first_pair;
        atlas->half_step = 0;
        atlas->hemispheres = CONUS_HEMISPHERES_MERGED;
    }
    for (size_t i = 0; merging.pairs && i < merging.pair_count; i++) {
        memory_free(merging.pairs[i].name);
    }
    conus_atlas_destroy(merging.areas);
    memory_free(merging.right_of);
    memory_free(merging.pairs);
    memory_free(merging.pair_of);
    memory_free(merging.names);
    return status;
}

conus_status conus_atlas_set_hemispheres(conus_atlas *atlas, conus_hemispheres hemispheres)
{
    if (!hemispheres) {
        return CONUS_OK;
    }
    if (atlas_has_hidden(atlas)) {
        return fail(CONUS_ERROR_ARGUMENT, "hemispheres: objects are hidden already; change the hemispheres first");
    }
    if (atlas->warp_count) {
        return fail(CONUS_ERROR_ARGUMENT, "hemispheres: a deformation field has moved the atlas already; change the "
                                          "hemispheres first");
    }
    if (atlas->hemispheres == CONUS_HEMISPHERES_MERGED || atlas->hemispheres == hemispheres) {
        return fail(CONUS_ERROR_ARGUMENT, "hemispheres: are %s already",
                    atlas->hemispheres == CONUS_HEMISPHERES_MERGED ? "merged" : "split");
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < atlas->volume_count && !status; i++) {
        status = volume_own(&atlas->volumes[i]);
    }
    status = status ? status : hemispheres == CONUS_HEMISPHERES_SPLIT ? hemispheres_split(atlas) : merge_pairs(atlas);
    return status ? fail_in(status, "hemispheres") : CONUS_OK;
}
