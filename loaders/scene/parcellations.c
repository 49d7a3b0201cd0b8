/* SPDX-License-Identifier: BSD-3-Clause */
/* Parcellations of one scene: their labels made one set, and each voxel given to the first that claims it. */
#include "loaders/scene/parcellations.h"

#include "atlas/space.h"
#include "base/files/folder.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"

#include <math.h>
#include <string.h>

conus_status parcellations_reserve(struct parcellations *out, size_t count, const struct note_sink *sink)
{
    out->parts = memory_zeroed(count, sizeof *out->parts);
    out->voxels = memory_zeroed(count, sizeof *out->voxels);
    out->notes.sink = sink;
    out->count = out->parts && out->voxels ? count : 0;
    for (size_t p = 0; p < out->count; p++) {
        out->parts[p].notes.sink = sink;
    }
    return out->parts && out->voxels ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void parcellations_finish(struct parcellations *all)
{
    for (size_t p = 0; p < all->count; p++) {
        parcellation_finish(&all->parts[p]);
        label_map_finish(&all->voxels[p]);
    }
    memory_free(all->parts);
    memory_free(all->voxels);
    label_table_finish(&all->table);
    buffer_finish(&all->source);
    file_sums_finish(&all->read);
    notes_finish(&all->notes);
}

conus_status label_raise(uint32_t *label, uint32_t offset)
{
    if (*label > UINT32_MAX - offset) {
        return fail(CONUS_ERROR_DATA, "label_offset: %u + %u is above 4294967295", offset, *label);
    }
    *label += offset;
    return CONUS_OK;
}

conus_status parcellation_shift(struct parcellation *part, uint32_t offset, char hemisphere)
{
    part->hemisphere = hemisphere;
    for (size_t i = 0; i < part->table.count; i++) {
        struct label *label = &part->table.entries[i];
        conus_status status = label_raise(&label->number, offset);
        status = status || !label->has_parent ? status : label_raise(&label->parent, offset);
        if (status) {
            return status;
        }
        label->hemisphere = label->hemisphere ? label->hemisphere : hemisphere;
    }
    if (!offset) {
        return CONUS_OK;
    }
    struct label_voxels *voxels = &part->labels;
    uint32_t largest = 0;
    for (size_t p = 0; p < voxels->label_count; p++) {
        largest = voxels->labels[p] > largest ? voxels->labels[p] : largest;
    }
    conus_status status = label_raise(&largest, offset);
    for (size_t p = 0; !status && p < voxels->label_count; p++) {
        voxels->labels[p] += voxels->labels[p] ? offset : 0;
    }
    return status;
}

/* Which of the first `count` parts is the first to have voxels of the label; `count` if none has. */
static conus_status find_owner(size_t *out, const struct parcellations *all, size_t count, uint32_t label)
{
    for (*out = 0; *out < count; ++*out) {
        const uint64_t *voxels = label_map_at(&all->voxels[*out], label);
        if (!voxels || *voxels) {
            return voxels ? CONUS_OK : CONUS_ERROR_MEMORY;
        }
    }
    return CONUS_OK;
}

/* Fails where two parts have voxels with one label; the message names the least one. */
static conus_status refuse_clashes(const struct parcellations *all)
{
    conus_status status = CONUS_OK;
    for (size_t p = 1; !status && p < all->count; p++) {
        const struct label_map *map = &all->voxels[p];
        uint32_t label = 0;
        size_t owner = p;
        for (size_t i = 0; !status && map->slots && i <= map->mask; i++) {
            const struct label_map_slot *slot = &map->slots[i];
            owner = p;
            status = slot->value ? find_owner(&owner, all, p, slot->label) : CONUS_OK;
            label = owner < p && (!label || slot->label < label) ? slot->label : label;
        }
        status = status || !label ? status : find_owner(&owner, all, p, label);
        if (!status && label) {
            return fail(CONUS_ERROR_DATA,
                        "parcellations[%zu]: label %u of %s is in %s, too (parcellations[%zu]): each needs its own "
                        "(label_offset)",
                        p, label, path_base(all->parts[p].file.path), path_base(all->parts[owner].file.path), owner);
        }
    }
    return status;
}

/* Gives an area without voxels the hemisphere 'B' in the tables before part `p` that have another one. */
static void settle_hemisphere(struct parcellations *all, size_t p, const struct label *label)
{
    for (size_t q = 0; q < p; q++) {
        struct label *same = label_table_find(&all->parts[q].table, label->number);
        if (same && same->hemisphere != label->hemisphere) {
            same->hemisphere = 'B';
        }
    }
}

static conus_status settle_hemispheres(struct parcellations *all)
{
    conus_status status = CONUS_OK;
    for (size_t p = 1; p < all->count; p++) {
        for (size_t i = 0; !status && i < all->parts[p].table.count; i++) {
            const struct label *label = &all->parts[p].table.entries[i];
            size_t owner;
            status = find_owner(&owner, all, all->count, label->number);
            if (!status && owner == all->count) {
                settle_hemisphere(all, p, label);
            }
        }
    }
    return status;
}

/* Moves the entry to the table of all, unless its voxels are another part's. */
static conus_status move_entry(struct parcellations *all, size_t p, struct label *entry)
{
    size_t owner;
    conus_status status = find_owner(&owner, all, all->count, entry->number);
    if (status || (owner < all->count && owner != p)) {
        return status;
    }
    struct label *moved = label_table_add(&all->table, entry->number);
    if (!moved) {
        return CONUS_ERROR_MEMORY;
    }
    *moved = *entry;
    *entry = (struct label){.number = entry->number};
    return CONUS_OK;
}

/* Adds an entry without a name, for the hemisphere, for each label of voxels that no table has. */
static conus_status add_nameless(struct parcellations *all, const struct parcellation *part,
                                 const struct label_map *voxels)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && part->hemisphere && voxels->slots && i <= voxels->mask; i++) {
        const struct label_map_slot *slot = &voxels->slots[i];
        if (slot->value && !label_table_find(&part->table, slot->label)) {
            struct label *label = label_table_add(&all->table, slot->label);
            status = label ? CONUS_OK : CONUS_ERROR_MEMORY;
            if (label) {
                label->hemisphere = part->hemisphere;
            }
        }
    }
    return status;
}

static conus_status move_words(struct parcellations *all, size_t p)
{
    struct parcellation *part = &all->parts[p];
    bool said = p && strcmp(part->source, all->parts[p - 1].source) == 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < part->table.count; i++) {
        status = move_entry(all, p, &part->table.entries[i]);
    }
    status = status ? status : add_nameless(all, part, &all->voxels[p]);
    buffer_format(&all->source, "%s%s", p && !said ? "; " : "", said ? "" : part->source);
    status = status ? status : notes_move(&all->notes, &part->notes);
    return status ? status : file_sums_move(&all->read, &part->read);
}

conus_status parcellations_unite(struct parcellations *all)
{
    conus_status status = CONUS_OK;
    for (size_t p = 0; !status && p < all->count; p++) {
        status = label_voxels_tally(&all->voxels[p], &all->parts[p].labels);
    }
    status = status ? status : refuse_clashes(all);
    status = status ? status : settle_hemispheres(all);
    for (size_t p = 0; !status && p < all->count; p++) {
        status = move_words(all, p);
    }
    status = status ? status : label_table_sort(&all->table, &all->notes);
    return status ? status : buffer_status(&all->source);
}

static const char *file_name(const struct parcellation *part)
{
    return path_base(part->file.path);
}

/* A part as later parts see it. */
struct claim {
    const struct parcellation *part;
    struct volume grid; /* without voxels */
    bool same;          /* as the grid of the part that is asked about */
};

/* Whether the voxel, whose centre is the world point, lies in an area of one of these parts. */
static bool is_claimed(const struct claim *claims, size_t count, size_t voxel, const double centre[3])
{
    for (size_t q = 0; q < count; q++) {
        size_t at = voxel;
        bool inside = claims[q].same || volume_find_voxel(&at, &claims[q].grid, centre);
        if (inside && label_voxels_at(&claims[q].part->labels, at)) {
            return true;
        }
    }
    return false;
}

/* Takes the voxels that the first `count` parts claim; `lost` counts them by label. */
static conus_status take_claimed(struct label_map *lost, struct parcellation *part, struct claim *claims, size_t count)
{
    const conus_volume_info *info = &part->file.info;
    for (size_t q = 0; q < count; q++) {
        claims[q].same = space_same_grid(&claims[q].grid.info, info);
    }
    for (size_t voxel = 0; voxel < info->dim[0] * info->dim[1] * info->dim[2]; voxel++) {
        const size_t at[3] = {voxel % info->dim[0], voxel / info->dim[0] % info->dim[1],
                              voxel / info->dim[0] / info->dim[1]};
        double centre[3] = {(double)at[0], (double)at[1], (double)at[2]};
        uint32_t label = label_voxels_at(&part->labels, voxel);
        if (label) {
            mat4_point(centre, info->world_from_voxel, centre);
            if (is_claimed(claims, count, voxel, centre)) {
                uint64_t *taken = label_map_at(lost, label);
                if (!taken) {
                    return CONUS_ERROR_MEMORY;
                }
                ++*taken;
                label_voxels_clear(&part->labels, voxel);
            }
        }
    }
    return CONUS_OK;
}

/* The voxels that one part loses to others. */
struct loss {
    struct label_map voxels; /* by label */
    uint64_t sum;
    uint32_t *gone; /* labels without any voxel left, sorted */
    size_t gone_count;
};

/* Sums the loss; `before` has the voxels of each label. */
static conus_status add_up(struct loss *loss, struct label_map *before)
{
    const struct label_map *lost = &loss->voxels;
    loss->gone = memory_raw(lost->count, sizeof *loss->gone);
    conus_status status = loss->gone ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && lost->slots && i <= lost->mask; i++) {
        const struct label_map_slot *slot = &lost->slots[i];
        const uint64_t *whole = slot->used ? label_map_at(before, slot->label) : NULL;
        status = slot->used && !whole ? CONUS_ERROR_MEMORY : CONUS_OK;
        loss->sum += slot->value;
        if (whole && *whole == slot->value) {
            loss->gone[loss->gone_count++] = slot->label;
        }
    }
    loss->gone_count = status ? 0 : u32_sort_unique(loss->gone, loss->gone_count);
    return status;
}

static conus_status note_loss(struct notes *notes, const struct loss *loss, const struct parcellation *part)
{
    enum { SHOWN = 4 };
    struct buffer list = {0};
    conus_status status = CONUS_OK;
    if (loss->sum) {
        status = notes_add(notes,
                           "%s: voxels in areas of earlier parcellations, which keep them: %llu (of %zu of its areas)",
                           file_name(part), (unsigned long long)loss->sum, loss->voxels.count);
    }
    if (status || !loss->gone_count) {
        return status;
    }
    for (size_t i = 0; i < loss->gone_count && i < SHOWN; i++) {
        buffer_format(&list, "%s%u", i ? ", " : "", loss->gone[i]);
    }
    status = buffer_status(&list);
    if (!status) {
        status = notes_warn(notes, "%s: areas that lose all of their voxels to earlier parcellations: %zu (%s%s)",
                            file_name(part), loss->gone_count, list.data, loss->gone_count > SHOWN ? ", ..." : "");
    }
    buffer_finish(&list);
    return status;
}

static conus_status give_voxels(struct parcellations *all, struct claim *claims)
{
    conus_status status = CONUS_OK;
    for (size_t p = 0; !status && p < all->count; p++) {
        claims[p].part = &all->parts[p];
        status = volume_init(&claims[p].grid, &all->parts[p].file.info);
    }
    for (size_t p = 1; !status && p < all->count; p++) {
        struct loss loss = {0};
        status = take_claimed(&loss.voxels, &all->parts[p], claims, p);
        status = status ? status : add_up(&loss, &all->voxels[p]);
        status = status ? status : note_loss(&all->notes, &loss, &all->parts[p]);
        label_map_finish(&loss.voxels);
        memory_free(loss.gone);
    }
    return status;
}

/* Which of the first `count` parts is the first on the grid of part `p`; `count` if none is. */
static size_t find_grid(const struct parcellations *all, size_t count, size_t p)
{
    size_t q = 0;
    while (q < count && !space_same_grid(&all->parts[q].file.info, &all->parts[p].file.info)) {
        q++;
    }
    return q;
}

/* Notes which files share a grid: "left.nii with right.nii; cerebellum.nii". */
static conus_status note_grids(struct parcellations *all)
{
    struct buffer list = {0};
    size_t grids = 0;
    for (size_t p = 0; p < all->count; p++) {
        bool is_first = find_grid(all, p, p) == p;
        grids += is_first;
        buffer_format(&list, is_first && p ? "; %s" : "%s", is_first ? file_name(&all->parts[p]) : "");
        for (size_t q = p + 1; is_first && q < all->count; q++) {
            bool joins = find_grid(all, q, q) == p;
            buffer_format(&list, joins ? " with %s" : "%s", joins ? file_name(&all->parts[q]) : "");
        }
    }
    conus_status status = buffer_status(&list);
    if (!status && all->count > 1) {
        status = notes_add(&all->notes, "parcellations: %zu on %zu grid%s (%s)", all->count, grids,
                           grids == 1 ? "" : "s", list.data);
    }
    buffer_finish(&list);
    return status;
}

/* Warns of parts whose known spaces differ. */
static conus_status note_spaces(struct parcellations *all)
{
    enum { TEMPLATES = 3 }; /* NIfTI's codes from there on */
    const conus_volume_info *first = &all->parts[0].file.info;
    conus_status status = CONUS_OK;
    for (size_t p = 1; !status && p < all->count; p++) {
        const conus_volume_info *info = &all->parts[p].file.info;
        if (first->space_code >= TEMPLATES && info->space_code >= TEMPLATES && first->space_code != info->space_code) {
            status =
                notes_warn(&all->notes, "%s is placed by %s, %s by %s: their areas may not fit together",
                           file_name(&all->parts[0]), first->transform, file_name(&all->parts[p]), info->transform);
        }
    }
    return status;
}

/* Merges two parts on one grid. Afterwards no voxel belongs to areas of both. */
static conus_status merge_into(struct parcellation *to, struct parcellation *from, struct file_sums *read)
{
    conus_status status = label_voxels_merge(&to->labels, &from->labels);
    to->file.info.minimum = fmin(to->file.info.minimum, from->file.info.minimum);
    to->file.info.maximum = fmax(to->file.info.maximum, from->file.info.maximum);
    to->is_joined = true;
    bool known = strcmp(to->file.path, from->file.path) == 0; /* another volume of it */
    return status || known ? status : file_sums_put(read, from->file.path, from->file.info.sha256);
}

static conus_status merge_grids(struct parcellations *all)
{
    size_t kept = 0;
    conus_status status = CONUS_OK;
    for (size_t p = 0; p < all->count; p++) {
        struct parcellation *part = &all->parts[p];
        size_t first = find_grid(all, kept, p);
        if (first < kept) {
            status = status ? status : merge_into(&all->parts[first], part, &all->read);
            parcellation_finish(part);
        } else if (kept++ < p) {
            all->parts[first] = *part;
        }
        if (first < p) {
            *part = (struct parcellation){0};
        }
    }
    all->count = kept;
    return status;
}

conus_status parcellations_join(struct parcellations *all)
{
    struct claim *claims = memory_zeroed(all->count, sizeof *claims);
    conus_status status = claims ? note_grids(all) : CONUS_ERROR_MEMORY;
    status = status ? status : note_spaces(all);
    status = status ? status : give_voxels(all, claims);
    for (size_t p = 0; claims && p < all->count; p++) {
        volume_finish(&claims[p].grid);
        label_map_finish(&all->voxels[p]);
    }
    memory_free(claims);
    return status ? status : merge_grids(all);
}

conus_status parcellations_atlas(conus_atlas **out, struct parcellations *all)
{
    struct labelled_volume *volumes = memory_zeroed(all->count, sizeof *volumes);
    for (size_t p = 0; volumes && p < all->count; p++) {
        volumes[p] = (struct labelled_volume){&all->parts[p].file.info, &all->parts[p].labels, all->parts[p].is_joined};
    }
    conus_status status = volumes
                              ? atlas_create_of(out, volumes, all->count, &all->table, all->source.data, &all->notes)
                              : CONUS_ERROR_MEMORY;
    memory_free(volumes);
    return status;
}
