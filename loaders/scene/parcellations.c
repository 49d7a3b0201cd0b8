/* SPDX-License-Identifier: BSD-3-Clause */
/* Parcellations of one scene: their labels made one set, and each voxel given to the first that claims it. */
#include "loaders/scene/parcellations.h"

#include "base/files/folder.h"
#include "base/memory.h"

#include <string.h>

size_t parcellation_voxels(const struct parcellation *part)
{
    const size_t *dim = part->file.info.dim;
    return dim[0] * dim[1] * dim[2];
}

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

static conus_status check_offset(uint32_t label, uint32_t offset)
{
    return label <= UINT32_MAX - offset
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "label_offset: %u + %u is above 4294967295", offset, label);
}

static conus_status shift_table(struct label_table *table, uint32_t offset, char hemisphere)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < table->count; i++) {
        struct label *label = &table->entries[i];
        status = check_offset(label->number, offset);
        status = status || !label->has_parent ? status : check_offset(label->parent, offset);
        label->number += offset;
        label->parent += label->has_parent ? offset : 0;
        label->hemisphere = label->hemisphere ? label->hemisphere : hemisphere;
    }
    return status;
}

static conus_status shift_voxels(struct label_voxels *voxels, uint32_t offset)
{
    uint32_t largest = 0;
    for (size_t p = 0; p < voxels->label_count; p++) {
        largest = voxels->labels[p] > largest ? voxels->labels[p] : largest;
    }
    conus_status status = check_offset(largest, offset);
    for (size_t p = 0; !status && p < voxels->label_count; p++) {
        voxels->labels[p] += voxels->labels[p] ? offset : 0;
    }
    return status;
}

conus_status parcellation_shift(struct parcellation *part, uint32_t offset, char hemisphere)
{
    part->hemisphere = hemisphere;
    conus_status status = shift_table(&part->table, offset, hemisphere);
    return status || !offset ? status : shift_voxels(&part->labels, offset);
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

/* The least label that part `p` and one before it have; 0 if there is none. */
static conus_status find_clash(uint32_t *out, const struct parcellations *all, size_t p)
{
    const struct label_map *map = &all->voxels[p];
    conus_status status = CONUS_OK;
    *out = 0;
    for (size_t i = 0; !status && map->slots && i <= map->mask; i++) {
        size_t owner = p;
        const struct label_map_slot *slot = &map->slots[i];
        status = slot->value ? find_owner(&owner, all, p, slot->label) : CONUS_OK;
        *out = owner < p && (!*out || slot->label < *out) ? slot->label : *out;
    }
    return status;
}

static conus_status refuse_clashes(const struct parcellations *all)
{
    conus_status status = CONUS_OK;
    for (size_t p = 1; !status && p < all->count; p++) {
        uint32_t label;
        size_t owner;
        status = find_clash(&label, all, p);
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

/* An area without voxels that tables before that of part `p` have with another hemisphere is of both. */
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

/* Labels of voxels that no table has get an entry without a name, for the hemisphere. */
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
