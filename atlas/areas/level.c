/* SPDX-License-Identifier: BSD-3-Clause */
/* Rolls areas up the area tree: to a depth, or to the areas of a list. */
#include "atlas/areas/areas.h"

#include "base/memory.h"
#include "base/text.h"

struct level {
    uint32_t *group;
    uint32_t *areas; /* of a list, by number */
    size_t area_count;
    bool is_identity;
};

/** State while a level is made. */
struct climb {
    const conus_atlas *atlas;
    uint32_t *group;  /* [object_count + 1] the object as which each is reported */
    uint32_t *depth;  /* [object_count + 1] of areas, from 1; 0 of pathways */
    uint32_t deepest; /* the largest of them */
    uint32_t *order;  /* [object_count + 1] areas, parents before their children */
    bool *targets;    /* [object_count + 1] at which the way up ends */
    bool is_list;
    struct object_index index; /* of a list */
};

static uint32_t parent_of(const conus_atlas *atlas, uint32_t number)
{
    return atlas->objects[number - 1].parent;
}

/* Depth of each area: up to the first ancestor whose depth is known, then down again on the same way. */
static void measure_depths(struct climb *climb)
{
    const conus_atlas *atlas = climb->atlas;
    uint32_t ordered = 0;
    for (uint32_t number = 1; number <= atlas->area_count; number++) {
        uint32_t steps = 0;
        uint32_t first = ordered;
        uint32_t at = number;
        for (; at && !climb->depth[at]; at = parent_of(atlas, at)) {
            steps += !atlas_is_paired(atlas, at);
            ordered++;
        }
        uint32_t depth = (at ? climb->depth[at] : 0) + steps;
        climb->deepest = depth > climb->deepest ? depth : climb->deepest;
        at = number;
        for (uint32_t place = ordered; place > first; at = parent_of(atlas, at)) {
            climb->order[--place] = at;
            climb->depth[at] = depth;
            depth -= !atlas_is_paired(atlas, at);
        }
    }
}

static conus_status target_depth(struct climb *climb, uint64_t depth)
{
    if (depth < 1 || depth > climb->deepest) {
        return fail(CONUS_ERROR_ARGUMENT, "depth %llu, the area tree has depths 1 to %u", (unsigned long long)depth,
                    climb->deepest);
    }
    for (uint32_t number = 1; number <= climb->atlas->area_count; number++) {
        climb->targets[number] = climb->depth[number] <= depth && !atlas_is_paired(climb->atlas, number);
    }
    return CONUS_OK;
}

static conus_status list_area(void *user, struct text name)
{
    struct climb *climb = user;
    uint32_t halves[2];
    uint32_t number = object_index_find(&climb->index, name);
    number = number <= climb->atlas->area_count ? number : 0; /* area_find() says that it is a pathway */
    if (!number && area_find_halves(halves, climb->atlas, name)) {
        climb->targets[halves[0]] = climb->targets[halves[1]] = true;
        return CONUS_OK;
    }
    conus_status status = number ? CONUS_OK : area_find(&number, climb->atlas, name);
    if (!status) {
        climb->targets[number] = true;
    }
    return status;
}

static conus_status target_list(struct climb *climb, struct text spec)
{
    climb->is_list = true;
    conus_status status = object_index_init(&climb->index, climb->atlas);
    status = status ? status : area_list_read(spec, list_area, NULL, climb);
    object_index_finish(&climb->index);
    return status;
}

static conus_status roll_up(struct climb *climb, const char *spec)
{
    uint64_t depth;
    struct text text = text_trim(text_from(spec));
    measure_depths(climb);
    conus_status status =
        climb->deepest > 1
            ? CONUS_OK
            : fail(CONUS_ERROR_ARGUMENT, "the atlas has no area tree: none of its %zu areas is part of another",
                   climb->atlas->area_count);
    if (!status) {
        status = text_to_uint(text, UINT64_MAX, &depth) ? target_depth(climb, depth) : target_list(climb, text);
    }
    if (status) {
        return fail_in(status, "level");
    }
    /* Reports every area that is a target, or below one, as the nearest target. Overwrites the depths with the targets.
     */
    uint32_t *target = climb->depth;
    for (size_t i = 0; i < climb->atlas->area_count; i++) {
        uint32_t number = climb->order[i];
        uint32_t parent = parent_of(climb->atlas, number);
        target[number] = climb->targets[number] ? number : parent ? target[parent] : 0;
        climb->group[number] = target[number] ? target[number] : climb->group[number];
    }
    return CONUS_OK;
}

static conus_status fill_level(struct level *level, const conus_atlas *atlas, const char *spec)
{
    size_t count = atlas->object_count + 1;
    struct climb climb = {.atlas = atlas, .group = level->group};
    for (uint32_t number = 1; number < count; number++) {
        level->group[number] = atlas_is_paired(atlas, number) ? parent_of(atlas, number) : number;
    }
    climb.depth = memory_zeroed(count, sizeof *climb.depth);
    climb.order = memory_zeroed(count, sizeof *climb.order);
    climb.targets = memory_zeroed(count, sizeof *climb.targets);
    conus_status status = climb.depth && climb.order && climb.targets ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && spec) {
        status = roll_up(&climb, spec);
    }
    if (!status && climb.is_list) {
        level->areas = memory_zeroed(atlas->area_count, sizeof *level->areas);
        for (uint32_t number = 1; level->areas && number <= atlas->area_count; number++) {
            if (climb.targets[number]) {
                level->areas[level->area_count++] = number;
            }
        }
        status = level->areas ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    memory_free(climb.depth);
    memory_free(climb.order);
    memory_free(climb.targets);
    level->is_identity = true;
    for (size_t i = 0; i < count; i++) {
        level->is_identity = level->is_identity && level->group[i] == i;
    }
    return status;
}

conus_status level_create(struct level **out, const conus_atlas *atlas, const char *spec)
{
    struct level *level = memory_zeroed(1, sizeof *level);
    if (!level) {
        return CONUS_ERROR_MEMORY;
    }
    level->group = memory_zeroed(atlas->object_count + 1, sizeof *level->group);
    conus_status status = level->group ? fill_level(level, atlas, spec) : CONUS_ERROR_MEMORY;
    return GIVE(status, out, level, level_destroy(level));
}

void level_destroy(struct level *level)
{
    if (level) {
        memory_free(level->group);
        memory_free(level->areas);
        memory_free(level);
    }
}

const uint32_t *level_group(const struct level *level)
{
    return level ? level->group : NULL;
}

const uint32_t *level_areas(const struct level *level, size_t *count)
{
    *count = level ? level->area_count : 0;
    return level ? level->areas : NULL;
}

bool level_is_identity(const struct level *level)
{
    return !level || level->is_identity;
}
