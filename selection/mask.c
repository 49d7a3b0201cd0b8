/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_selection_grid(): the voxels of a selection's region on their own grid. */
#include "atlas/space.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "selection/selection.h"

#include <stdio.h>
#include <string.h>

struct mask {
    const conus_atlas *atlas;
    const struct volume *volume;
    conus_grid_content content;
    const uint32_t *group; /* [object_count + 1] as what each object is reported; NULL = itself */
    bool *wanted;          /* [object_count + 1] which objects count */
    conus_grid *grid;
};

/* The only volume of values, or with `any` one of several that lie on one grid. */
static conus_status find_scalar(const struct volume **out, const conus_atlas *atlas, const char *what, bool any)
{
    const struct volume *first = NULL;
    size_t count = 0;
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        bool fits = atlas_object_is_scalar(atlas, number) && !atlas->places[number - 1].is_hidden;
        const struct volume *volume = fits ? atlas_object_volume(atlas, number) : NULL;
        count += volume && !(any && first && space_same_grid(&first->info, &volume->info));
        first = first ? first : volume;
    }
    if (count == 0) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: there is no pathway", what);
    }
    if (count > 1) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: found %zu pathways%s, name one of them (--mask-object)", what, count,
                    any ? " on different grids" : "");
    }
    *out = first;
    return CONUS_OK;
}

static conus_status find_volume(const struct volume **out, const conus_atlas *atlas, const conus_grid_options *options)
{
    const conus_object *object = conus_atlas_object(atlas, options->object);
    if (options->object && !object) {
        return fail(CONUS_ERROR_ARGUMENT, "object: %u, allowed is up to %zu", options->object, atlas->object_count);
    }
    if (conus_atlas_is_hidden(atlas, options->object)) {
        return fail(CONUS_ERROR_ARGUMENT, "object: %s is hidden", object->name);
    }
    if (object && atlas_object_is_scalar(atlas, options->object)) {
        *out = atlas_object_volume(atlas, options->object);
        return options->content == CONUS_GRID_MAP_OF_LABELS
                   ? fail(CONUS_ERROR_ARGUMENT, "map of labels: %s is %s, an area is needed", object->name,
                          object->kind == CONUS_KIND_AREA ? "an area of probabilities" : "a pathway")
                   : CONUS_OK;
    }
    if (options->content == CONUS_GRID_MAP_OF_VALUES) {
        return object ? fail(CONUS_ERROR_ARGUMENT, "map of values: %s is an area, a pathway is needed", object->name)
                      : find_scalar(out, atlas, "map of values", false);
    }
    size_t grids = atlas_parcellation_count(atlas);
    if (grids > 1) { /* the grid of labels that has the area's voxels */
        *out = object ? atlas_only_volume(atlas, options->object) : NULL;
        return *out ? CONUS_OK
               : object
                   ? fail(CONUS_ERROR_ARGUMENT, "mask: %s has no voxels, or voxels on different grids", object->name)
                   : fail(CONUS_ERROR_ARGUMENT,
                          "mask: the areas lie on %zu different grids, name one of them (--mask-object)", grids);
    }
    if (object && options->content == CONUS_GRID_MASK_OF_REGION) {
        return fail(CONUS_ERROR_ARGUMENT, "mask of everything: %s is an area, which has no effect", object->name);
    }
    *out = atlas_parcellation(atlas);
    if (!*out && options->content == CONUS_GRID_MAP_OF_LABELS) {
        return fail(CONUS_ERROR_ARGUMENT, "map of labels: the atlas has no labelled voxels");
    }
    return *out ? CONUS_OK
                : find_scalar(out, atlas, "mask of an atlas without labelled voxels",
                              options->content == CONUS_GRID_MASK_OF_REGION);
}

static conus_status choose_objects(struct mask *mask, uint32_t object)
{
    bool found = mask->content == CONUS_GRID_MASK_OF_REGION;
    mask->wanted = memory_zeroed(mask->atlas->object_count + 1, sizeof *mask->wanted);
    if (!mask->wanted) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t number = 1; number <= mask->atlas->object_count; number++) {
        if (!object || atlas_is_below(mask->atlas, number, object)) {
            mask->wanted[number] = true;
            found = found || atlas_object_volume(mask->atlas, number) == mask->volume;
        }
    }
    return found ? CONUS_OK
                 : fail(CONUS_ERROR_ARGUMENT, "%s has no voxels",
                        object ? mask->atlas->objects[object - 1].name : "the atlas");
}

static uint32_t label_of(const struct mask *mask, uint32_t number)
{
    return mask->atlas->objects[(mask->group ? mask->group[number] : number) - 1].label;
}

static conus_number number_of_labels(const struct mask *mask)
{
    uint32_t most = 0;
    for (uint32_t number = 1; number <= mask->atlas->object_count; number++) {
        most = mask->wanted[number] && label_of(mask, number) > most ? label_of(mask, number) : most;
    }
    return most <= UINT8_MAX ? CONUS_NUMBER_UINT8 : most <= UINT16_MAX ? CONUS_NUMBER_UINT16 : CONUS_NUMBER_UINT32;
}

static void put_label(conus_grid *grid, size_t voxel, uint32_t label)
{
    switch (grid->view.number) {
    case CONUS_NUMBER_UINT8:
        ((uint8_t *)grid->data)[voxel] = (uint8_t)label;
        break;
    case CONUS_NUMBER_UINT16:
        ((uint16_t *)grid->data)[voxel] = (uint16_t)label;
        break;
    default:
        ((uint32_t *)grid->data)[voxel] = label;
    }
}

static void fill_row(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    struct mask *mask = user;
    const size_t *dim = volume->info.dim;
    size_t first = at[0] + dim[0] * (at[1] + dim[1] * at[2]);
    for (size_t voxel = first; voxel < first + count; voxel++) {
        uint32_t number = volume_object(volume, voxel);
        if (mask->content == CONUS_GRID_MASK_OF_REGION) {
            put_label(mask->grid, voxel, 1);
        } else if (mask->wanted[number] && mask->content == CONUS_GRID_MAP_OF_VALUES) {
            ((float *)mask->grid->data)[voxel] = volume_value(volume, voxel);
        } else if (mask->wanted[number]) {
            bool labels = mask->content == CONUS_GRID_MAP_OF_LABELS;
            put_label(mask->grid, voxel, labels ? label_of(mask, number) : 1);
        }
    }
}

static conus_status start_grid(struct mask *mask, const struct region *region)
{
    static const char *const contents[] = {"mask of areas", "mask of everything", "labels of areas",
                                           "values of a pathway"};
    static const char *const shapes[] = {"cone", "cylinder", "ball"};
    static const char *const square_shapes[] = {"square pyramid", "square rod", "ball"};
    char words[80];
    bool of_pathway = volume_has_values(mask->volume) && mask->content == CONUS_GRID_MASK_OF_AREAS;
    snprintf(words, sizeof words, "conus " CONUS_VERSION ": %s in a %s",
             of_pathway ? "mask of a pathway" : contents[mask->content],
             (region->square ? square_shapes : shapes)[region->shape]);
    conus_number number = mask->content == CONUS_GRID_MAP_OF_VALUES   ? CONUS_NUMBER_FLOAT32
                          : mask->content == CONUS_GRID_MAP_OF_LABELS ? number_of_labels(mask)
                                                                      : CONUS_NUMBER_UINT8;
    conus_status status = grid_create(&mask->grid, &mask->volume->info, number, words);
    if (!status) {
        mask->grid->labels = mask->content == CONUS_GRID_MAP_OF_LABELS;
    }
    return status;
}

conus_status conus_selection_grid(conus_grid **out, const conus_selection *selection, const conus_grid_options *options)
{
    options = options_of(conus_grid_options, options);
    struct mask mask = {.atlas = selection->atlas, .content = options->content, .group = selection->group};
    conus_status status = find_volume(&mask.volume, selection->atlas, options);
    status = status ? status : choose_objects(&mask, options->object);
    status = status ? status : start_grid(&mask, &selection->region);
    if (!status) {
        census_walk(&selection->region, mask.volume, fill_row, &mask);
        *out = mask.grid;
    }
    memory_free(mask.wanted);
    return status;
}
