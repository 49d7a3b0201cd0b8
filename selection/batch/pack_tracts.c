/* SPDX-License-Identifier: BSD-3-Clause */
/* Packs tractograms, and checks what is attached. */
#include "selection/batch/pack_tracts.h"

#include "atlas/bundles.h"
#include "atlas/tracts/tract_node.h"

#include <string.h>

/* Numbers, and of the rest nothing. */
static struct tractogram bare_tractogram(const struct tractogram *tractogram)
{
    struct tractogram bare = *tractogram;
    bare.path = NULL;
    bare.files = (struct file_sums){0};
    bare.points = NULL;
    bare.halves = NULL;
    bare.first = NULL;
    bare.scalars = NULL;
    bare.groups = NULL;
    bare.tree.nodes = NULL;
    bare.tree.leaves = NULL;
    bare.tree.marks = NULL;
    bare.has_borrowed_points = true;
    bare.is_borrowed = true;
    return bare;
}

/* Counts that arrays in the block can have, and texts that end. */
static bool fits_block(const struct tractogram *plain, const struct pack_walk *walk)
{
    return plain->point_count <= walk->size && plain->streamline_count < UINT32_MAX &&
           plain->streamline_count <= walk->size && plain->tree.run_count <= walk->size &&
           plain->tree.run_count <= UINT32_MAX && memchr(plain->format, 0, sizeof plain->format) &&
           memchr(plain->sha256, 0, sizeof plain->sha256);
}

static void pass_scalar(struct pack_walk *walk, struct tract_scalar *scalar, const struct tractogram *of)
{
    struct tract_scalar plain = *scalar;
    uint8_t per_point = scalar->per_point; /* not as a bool, which damage could make neither */
    plain.name = NULL;
    plain.values = NULL;
    plain.per_point = false;
    pack_bytes(walk, &plain, sizeof plain);
    pack_bytes(walk, &per_point, sizeof per_point);
    if (!walk->status && walk->mode == PACK_ATTACH) {
        scalar->per_point = per_point;
        scalar->components = plain.components;
    }
    size_t count = scalar->per_point ? of->point_count : of->streamline_count;
    pack_text(walk, &scalar->name);
    pack_array(walk, &scalar->values, count, scalar->components * sizeof *scalar->values);
    if (!walk->status && (!scalar->name || (count && !scalar->values))) {
        walk->status = pack_fail_damaged();
    }
}

static void pass_scalars(struct pack_walk *walk, struct tractogram *tractogram, size_t count)
{
    tractogram->scalars = pack_reserve(walk, tractogram->scalars, count, sizeof *tractogram->scalars);
    for (size_t i = 0; i < count && !walk->status; i++) {
        struct tract_scalar scalar = walk->mode == PACK_ATTACH ? (struct tract_scalar){0} : tractogram->scalars[i];
        pass_scalar(walk, &scalar, tractogram);
        if (walk->mode == PACK_ATTACH) {
            tractogram->scalars[i] = scalar;
            tractogram->scalar_count = i + 1;
        }
    }
}

static void pass_group(struct pack_walk *walk, struct tract_group *group)
{
    pack_bytes(walk, &group->count, sizeof group->count);
    pack_text(walk, &group->name);
    pack_array(walk, &group->members, group->count, sizeof *group->members);
    if (!walk->status && (!group->name || (group->count && !group->members))) {
        walk->status = pack_fail_damaged();
    }
}

static void pass_groups(struct pack_walk *walk, struct tractogram *tractogram, size_t count)
{
    tractogram->groups = pack_reserve(walk, tractogram->groups, count, sizeof *tractogram->groups);
    for (size_t i = 0; i < count && !walk->status; i++) {
        struct tract_group group = walk->mode == PACK_ATTACH ? (struct tract_group){0} : tractogram->groups[i];
        pass_group(walk, &group);
        if (walk->mode == PACK_ATTACH) {
            tractogram->groups[i] = group;
            tractogram->group_count = i + 1;
        }
    }
}

static void pass_arrays(struct pack_walk *walk, struct tractogram *tractogram)
{
    struct tract_tree *tree = &tractogram->tree;
    pack_array(walk, &tractogram->points, tractogram->point_count, 3 * sizeof *tractogram->points);
    pack_array(walk, &tractogram->halves, tractogram->point_count, 3 * sizeof *tractogram->halves);
    pack_array(walk, &tractogram->first, tractogram->streamline_count + 1, sizeof *tractogram->first);
    pack_array(walk, &tree->nodes, tree->node_count, sizeof *tree->nodes);
    pack_array(walk, &tree->leaves, tract_leaf_count(tree->run_count), sizeof *tree->leaves);
    pack_array(walk, &tree->marks, tract_mark_count(tractogram->point_count), sizeof *tree->marks);
}

static bool has_arrays(const struct tractogram *tractogram)
{
    const struct tract_tree *tree = &tractogram->tree;
    return tractogram->first && (tree->leaves || !tree->run_count) && (tree->marks || !tractogram->point_count) &&
           (tree->nodes || !tree->node_count) && (tractogram->points || tractogram->halves || !tractogram->point_count);
}

/* Into a tractogram of zeros when attaching, which has at every moment what tractogram_finish() may end. */
static void pass_tractogram(struct pack_walk *walk, struct tractogram *tractogram)
{
    struct tractogram plain = bare_tractogram(tractogram);
    bool attaches = walk->mode == PACK_ATTACH;
    pack_bytes(walk, &plain, sizeof plain);
    if (!walk->status && attaches && !fits_block(&plain, walk)) {
        walk->status = pack_fail_damaged();
    }
    if (walk->status) {
        return;
    }
    if (attaches) {
        *tractogram = bare_tractogram(&plain);
        tractogram->scalar_count = tractogram->group_count = 0;
    }
    pack_text(walk, &tractogram->path);
    pass_arrays(walk, tractogram);
    pass_scalars(walk, tractogram, plain.scalar_count);
    pass_groups(walk, tractogram, plain.group_count);
    bool sound = !attaches || walk->status ||
                 (tractogram->path && has_arrays(tractogram) && tractogram_leads_nowhere_else(tractogram));
    walk->status = sound ? walk->status : pack_fail_damaged();
}

void pack_tractograms(struct pack_walk *walk, conus_atlas *atlas, size_t count)
{
    bool attaches = walk->mode == PACK_ATTACH;
    atlas->tractograms = pack_reserve(walk, atlas->tractograms, count, sizeof *atlas->tractograms);
    for (size_t i = 0; i < count && !walk->status; i++) {
        struct tractogram tractogram = attaches ? (struct tractogram){0} : atlas->tractograms[i];
        pass_tractogram(walk, &tractogram);
        if (attaches) {
            atlas->tractograms[i] = tractogram;
            atlas->tractogram_count = i + 1;
        }
    }
}

static bool is_sound(const conus_atlas *atlas, size_t object)
{
    const struct object_place *place = &atlas->places[object];
    uint8_t is_bundle; /* not as a bool, which damage could make neither */
    memcpy(&is_bundle, &place->is_bundle, sizeof is_bundle);
    return !is_bundle ||
           (is_bundle == 1 && place->index < atlas->tractogram_count &&
            (place->group == BUNDLE_OF_ALL || place->group < atlas->tractograms[place->index].group_count));
}

void pack_check_bundles(struct pack_walk *walk, const conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->object_count && walk->mode == PACK_ATTACH && !walk->status; i++) {
        walk->status = is_sound(atlas, i) ? CONUS_OK : pack_fail_damaged();
    }
}
