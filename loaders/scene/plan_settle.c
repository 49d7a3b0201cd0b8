/* SPDX-License-Identifier: BSD-3-Clause */
/* Which of two areas keeps a label that both the planned surfaces and the parcellation have. */
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/scene/area_plan.h"
#include "loaders/scene/parcellations.h"

#include <string.h>

/* Gives the surface what the table's entry says and the manifest does not. */
static void fill_from_entry(struct label *label, struct label *entry)
{
    if (!label->name) {
        label->name = entry->name;
        entry->name = NULL;
    }
    if (!label->abbreviation) {
        label->abbreviation = entry->abbreviation;
        entry->abbreviation = NULL;
    }
    if (!label->has_rgb) {
        label->has_rgb = entry->has_rgb;
        memcpy(label->rgb, entry->rgb, sizeof label->rgb);
    }
    label->hemisphere = label->hemisphere ? label->hemisphere : entry->hemisphere;
}

/* Makes an entry whose parent is a planned surface a node of the tree, since the table will not know its parent. The
 * first `stated` nodes are the manifest's. */
static conus_status hand_over_link(struct area_plan *plan, struct label *entry, size_t stated)
{
    if (!entry->name || !entry->has_parent || !area_plan_find(plan, entry->parent)) {
        return CONUS_OK;
    }
    struct label *node = NULL;
    for (size_t i = 0; i < stated && !node; i++) {
        node = plan->groups.entries[i].number == entry->number ? &plan->groups.entries[i] : NULL;
    }
    node = node ? node : label_table_add(&plan->groups, entry->number);
    if (!node) {
        return CONUS_ERROR_MEMORY;
    }
    node->parent = node->has_parent ? node->parent : entry->parent;
    node->has_parent = true;
    entry->has_parent = false;
    return CONUS_OK;
}

/* Moves the entries of planned surfaces from the table to the plan; the table keeps the others. */
static conus_status hand_over_entries(struct area_plan *plan, struct label_table *table)
{
    size_t kept = 0;
    size_t stated = plan->groups.count;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < plan->count; i++) { /* parents that the table knows and the manifest does not */
        struct label *label = &plan->areas[i].label;
        const struct label *entry = label_table_find(table, label->number);
        bool known = entry && entry->has_parent &&
                     (label_table_find(table, entry->parent) || area_plan_find(plan, entry->parent));
        if (known && !label->has_parent) {
            label->has_parent = true;
            label->parent = entry->parent;
        }
    }
    for (size_t i = 0; !status && i < table->count; i++) {
        status = hand_over_link(plan, &table->entries[i], stated);
    }
    for (size_t i = 0; i < table->count; i++) {
        struct label *entry = &table->entries[i];
        struct planned_area *area = area_plan_find(plan, entry->number);
        if (area) {
            fill_from_entry(&area->label, entry);
            label_finish(entry);
        } else {
            table->entries[kept++] = *entry;
        }
    }
    table->count = kept;
    return status;
}

static conus_status apply_preference(struct area_plan *plan, struct parcellations *all, const uint64_t *counts,
                                     enum manifest_preference preference)
{
    size_t shared = 0;
    const struct planned_area *first = NULL;
    for (size_t i = 0; i < plan->count; i++) {
        first = counts[i] && !first ? &plan->areas[i] : first;
        shared += counts[i] > 0;
    }
    if (!first) {
        return CONUS_OK;
    }
    if (preference == MANIFEST_PREFER_NONE) {
        return fail(CONUS_ERROR_DATA,
                    "areas[%zu]: label %u of %s is in the parcellation, too: say \"prefer\": \"areas\" or "
                    "\"parcellation\"",
                    first->entry, first->label.number, path_base(first->path));
    }
    bool surfaces = preference != MANIFEST_PREFER_PARCELLATION;
    for (size_t p = 0; surfaces && p < all->count; p++) { /* their voxels become background */
        const struct label_voxels *voxels = &all->parts[p].labels;
        for (size_t i = 0; i < voxels->label_count; i++) {
            uint32_t *label = &voxels->labels[i];
            *label = *label && area_plan_find(plan, *label) ? 0 : *label;
        }
    }
    size_t kept = 0;
    for (size_t i = 0; !surfaces && i < plan->count; i++) {
        if (counts[i]) {
            planned_area_finish(&plan->areas[i]);
        } else {
            plan->areas[kept++] = plan->areas[i];
        }
    }
    plan->count = surfaces ? plan->count : kept;
    return notes_add(&all->notes, "labels that are both a surface and voxels: %zu, the %s taken", shared,
                     surfaces ? "surfaces are" : "voxels are");
}

conus_status area_plan_settle(struct area_plan *plan, struct parcellations *all, enum manifest_preference preference)
{
    uint64_t *counts = memory_zeroed(plan->count, sizeof *counts); /* voxels of each planned area's label */
    conus_status status = counts ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < plan->count; i++) {
        for (size_t p = 0; !status && p < all->count; p++) {
            const uint64_t *count = label_map_at(&all->voxels[p], plan->areas[i].label.number);
            status = count ? CONUS_OK : CONUS_ERROR_MEMORY;
            counts[i] += count ? *count : 0;
        }
    }
    status = status ? status : apply_preference(plan, all, counts, preference);
    status = status ? status : hand_over_entries(plan, &all->table);
    status = status ? status : label_table_sort(&plan->groups, &all->notes);
    memory_free(counts);
    return status;
}
