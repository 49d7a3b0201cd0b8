/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_set_hemispheres(): areas cut in two (halves.c), or pairs merged into an area above both, here. */
#include "atlas/areas/halves.h"
#include "atlas/areas/pairs.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

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

static int by_text(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
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
    qsort(merging->names, merging->name_count, sizeof(char *), by_text);
    return CONUS_OK;
}

static bool is_unique(const struct merging *merging, const char *name)
{
    const char **names = merging->names;
    const char **found = bsearch(&name, names, merging->name_count, sizeof(char *), by_text);
    bool first = found == names || strcmp(found[-1], name) != 0;
    bool last = found + 1 == names + merging->name_count || strcmp(found[1], name) != 0;
    return first && last;
}

/* "Precentral", or "Thalamus_L + Thalamus_R" where another is called Thalamus. */
static void write_name(struct buffer *out, const struct merging *merging, const struct pair *pair)
{
    const conus_object *objects = merging->atlas->objects;
    if (*pair->name && is_unique(merging, pair->name)) {
        buffer_text(out, pair->name);
    } else {
        buffer_format(out, "%s + %s", objects[pair->left - 1].name, objects[pair->right - 1].name);
    }
}

/* Of abbreviations, too, that end in the side and nothing between: AntL and AntR. Their names give the sides. */
static void write_abbreviation(struct buffer *out, const char *left, const char *right)
{
    size_t length = strlen(left);
    hemispheres_common_name(out, left, right);
    bool attached = !out->size && length > 1 && strlen(right) == length && left[length - 1] == 'L' &&
                    right[length - 1] == 'R' && strncmp(left, right, length - 1) == 0;
    buffer_append(out, left, attached ? length - 1 : 0);
}

static conus_status add_pair(struct merging *merging, const struct pair *pair)
{
    const conus_object *left = &merging->atlas->objects[pair->left - 1];
    const conus_object *right = &merging->atlas->objects[pair->right - 1];
    struct buffer name = {0};
    struct buffer abbreviation = {0};
    conus_object area = {.kind = CONUS_KIND_AREA, .hemisphere = 'B', .named = left->named};
    write_name(&name, merging, pair);
    write_abbreviation(&abbreviation, left->abbreviation, right->abbreviation);
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
