/* SPDX-License-Identifier: BSD-3-Clause */
/* Which of two areas keeps a label that both the planned surfaces and the parcellation have. */
#include "base/files/file.h"
#include "loaders/labels/labels.h"
#include "loaders/scene/parts.h"

#include <string.h>

/* Gives the surface what the table's entry says and the manifest does not. */
static void fill_from_entry(struct label *label, const struct label *entry)
{
    label->name = label->name ? label->name : entry->name;
    label->abbreviation = label->abbreviation ? label->abbreviation : entry->abbreviation;
    if (!label->has_rgb) {
        label->has_rgb = entry->has_rgb;
        memcpy(label->rgb, entry->rgb, sizeof label->rgb);
    }
    label->hemisphere = label->hemisphere ? label->hemisphere : entry->hemisphere;
}

/* Makes an entry whose parent is a planned surface a node of the tree, since the table will not know its parent. The
 * first `stated` nodes are the manifest's. */
static void hand_over_link(struct job *job, struct area_plan *plan, struct label *entry, size_t stated)
{
    if (!entry->name || !entry->has_parent || !area_plan_find(plan, entry->parent)) {
        return;
    }
    struct label *node = NULL;
    for (size_t i = 0; i < stated && !node; i++) {
        node = plan->groups->entries[i].number == entry->number ? &plan->groups->entries[i] : NULL;
    }
    node = node ? node : labels_add(job, plan->groups, entry->number);
    node->parent = node->has_parent ? node->parent : entry->parent;
    node->has_parent = true;
    entry->has_parent = false;
}

/* Gives the plan what the table says of planned surfaces; their entries are left out of the table. */
static void hand_over_entries(struct job *job, struct area_plan *plan, struct label_table *table)
{
    size_t kept = 0;
    const size_t stated = plan->groups->count;
    for (size_t i = 0; i < plan->areas.count; i++) { /* parents that the table knows and the manifest does not */
        struct label *label = &plan->areas.at[i].label;
        const struct label *entry = label_table_find(table, label->number);
        bool known = entry && entry->has_parent &&
                     (label_table_find(table, entry->parent) || area_plan_find(plan, entry->parent));
        if (known && !label->has_parent) {
            label->has_parent = true;
            label->parent = entry->parent;
        }
    }
    for (size_t i = 0; i < table->count && job_ok(job); i++) {
        hand_over_link(job, plan, &table->entries[i], stated);
    }
    for (size_t i = 0; i < table->count; i++) {
        const struct label entry = table->entries[i];
        struct planned_area *area = area_plan_find(plan, entry.number);
        if (area) {
            fill_from_entry(&area->label, &entry);
        } else { /* changes places with one that is left out: all texts stay in the table */
            table->entries[i] = table->entries[kept];
            table->entries[kept++] = entry;
        }
    }
    table->count = kept;
}

/* Leaves out surfaces whose labels voxels have, of which there are `counts`. */
static void drop_surfaces(struct area_plan *plan, const uint64_t *counts)
{
    size_t kept = 0;
    for (size_t i = 0; i < plan->areas.count; i++) {
        if (!counts[i]) {
            plan->areas.at[kept++] = plan->areas.at[i];
        }
    }
    plan->areas.count = kept;
}

/* Makes voxels with labels of planned surfaces background. */
static void drop_voxels(const struct area_plan *plan, const struct parcellations *all)
{
    for (size_t p = 0; p < all->count; p++) {
        const struct label_voxels *voxels = &all->parts[p].labels;
        for (size_t i = 0; i < voxels->label_count; i++) {
            uint32_t *label = &voxels->labels[i];
            *label = *label && area_plan_find(plan, *label) ? 0 : *label;
        }
    }
}

static void apply_preference(struct job *job, struct area_plan *plan, const struct parcellations *all,
                             const uint64_t *counts, enum scene_preference preference)
{
    size_t shared = 0;
    const struct planned_area *first = NULL;
    for (size_t i = 0; i < plan->areas.count; i++) {
        first = counts[i] && !first ? &plan->areas.at[i] : first;
        shared += counts[i] > 0;
    }
    if (first && preference == SCENE_PREFER_NONE) {
        job_bad(job,
                "areas[%zu]: label %u of %s is in the parcellation, too: say \"prefer\": \"areas\" or "
                "\"parcellation\"",
                first->item->index, first->label.number, path_base(first->path));
    } else if (first && preference == SCENE_PREFER_PARCELLATION) {
        drop_surfaces(plan, counts);
        job_note(job, "labels that are both a surface and voxels: %zu, the voxels are taken", shared);
    } else if (first) {
        drop_voxels(plan, all);
        job_note(job, "labels that are both a surface and voxels: %zu, the surfaces are taken", shared);
    }
}

void area_plan_settle(struct job *job, struct area_plan *plan, struct parcellations *all,
                      enum scene_preference preference)
{
    const size_t count = plan->areas.count;
    uint64_t *counts = job_zeroed(job, count + 1, sizeof *counts); /* voxels of each planned area's label */
    for (size_t i = 0; counts && i < count; i++) {
        for (size_t p = 0; p < all->count; p++) {
            counts[i] += *map_at(job, &all->parts[p].voxels, plan->areas.at[i].label.number);
        }
    }
    if (counts && job_step(job)) {
        apply_preference(job, plan, all, counts, preference);
        hand_over_entries(job, plan, &all->table);
        labels_sort(job, plan->groups);
    }
}
