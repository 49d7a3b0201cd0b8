/* SPDX-License-Identifier: BSD-3-Clause */
/* Parcellations of one scene: their labels made one set, and each voxel given to the first that claims it. */
#include "loaders/scene/parts.h"

#include "atlas/space.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/order.h"
#include "loaders/labels/labels.h"

#include <math.h>
#include <string.h>

uint64_t *map_at(struct job *job, struct label_map *map, uint32_t label)
{
    uint64_t *value = job_step(job) ? label_map_at(map, label) : NULL;
    return job_need(job, value) ? value : job_spare(job, sizeof *value);
}

uint32_t label_raise(struct job *job, uint32_t label, uint32_t offset)
{
    if (label > UINT32_MAX - offset) {
        job_bad(job, "label_offset: %u + %u is above 4294967295", offset, label);
        return 0;
    }
    return label + offset;
}

void parcellation_shift(struct job *job, struct parcellation *part, uint32_t offset, char hemisphere)
{
    part->hemisphere = hemisphere;
    for (size_t i = 0; job_ok(job) && i < part->table->count; i++) {
        struct label *label = &part->table->entries[i];
        label->number = label_raise(job, label->number, offset);
        label->parent = label->has_parent ? label_raise(job, label->parent, offset) : label->parent;
        label->hemisphere = label->hemisphere ? label->hemisphere : hemisphere;
    }
    uint32_t largest = 0;
    const struct label_voxels *voxels = &part->labels;
    for (size_t p = 0; p < voxels->label_count; p++) {
        largest = voxels->labels[p] > largest ? voxels->labels[p] : largest;
    }
    label_raise(job, largest, offset);
    for (size_t p = 0; job_ok(job) && p < voxels->label_count; p++) {
        voxels->labels[p] += voxels->labels[p] ? offset : 0;
    }
}

/* Which of the first `count` parts is the first to have voxels of the label; `count` if none has. */
static size_t find_owner(struct job *job, const struct parcellations *all, size_t count, uint32_t label)
{
    size_t owner = 0;
    while (owner < count && !*map_at(job, &all->parts[owner].voxels, label)) {
        owner++;
    }
    return owner;
}

/* Fails where two parts have voxels with one label; the message names the least one. */
static void refuse_clashes(struct job *job, const struct parcellations *all)
{
    for (size_t p = 1; p < all->count; p++) {
        const struct label_map *map = &all->parts[p].voxels;
        uint32_t label = 0;
        for (size_t i = 0; map->slots && i <= map->mask; i++) {
            const struct label_map_slot *slot = &map->slots[i];
            bool is_shared = slot->value && find_owner(job, all, p, slot->label) < p;
            label = is_shared && (!label || slot->label < label) ? slot->label : label;
        }
        size_t owner = label ? find_owner(job, all, p, label) : p;
        if (owner < p) {
            job_bad(job,
                    "parcellations[%zu]: label %u of %s is in %s, too (parcellations[%zu]): each needs its own "
                    "(label_offset)",
                    p, label, path_base(all->parts[p].file.path), path_base(all->parts[owner].file.path), owner);
        }
    }
}

/* Gives an area without voxels the hemisphere 'B' in the tables that have another one than a later part's. */
static void settle_hemispheres(struct job *job, struct parcellations *all)
{
    for (size_t p = 1; p < all->count; p++) {
        for (size_t i = 0; i < all->parts[p].table->count; i++) {
            const struct label *label = &all->parts[p].table->entries[i];
            bool has_voxels = find_owner(job, all, all->count, label->number) < all->count;
            for (size_t q = 0; q < p && !has_voxels; q++) {
                struct label *same = label_table_find(all->parts[q].table, label->number);
                if (same && same->hemisphere != label->hemisphere) {
                    same->hemisphere = 'B';
                }
            }
        }
    }
}

/* Moves the entries of part `p` to the table, but for those whose voxels are another part's; adds an entry without a
 * name, for the hemisphere, for each label of voxels that no table has. */
static void move_entries(struct job *job, struct label_table *table, const struct parcellations *all, size_t p)
{
    const struct parcellation *part = &all->parts[p];
    const struct label_map *voxels = &all->parts[p].voxels;
    for (size_t i = 0; i < part->table->count && job_ok(job); i++) {
        struct label *entry = &part->table->entries[i];
        size_t owner = find_owner(job, all, all->count, entry->number);
        struct label *moved = owner == p || owner == all->count ? labels_add(job, table, entry->number) : NULL;
        if (moved && job_ok(job)) {
            *moved = *entry;
            *entry = (struct label){.number = entry->number};
        }
    }
    for (size_t i = 0; part->hemisphere && voxels->slots && i <= voxels->mask && job_ok(job); i++) {
        const struct label_map_slot *slot = &voxels->slots[i];
        if (slot->value && !label_table_find(part->table, slot->label)) {
            labels_add(job, table, slot->label)->hemisphere = part->hemisphere;
        }
    }
}

void parcellations_unite(struct job *job, struct parcellations *all)
{
    struct label_table *table = labels_new(job);
    if (!job_step(job)) { /* some have no table */
        return;
    }
    for (size_t p = 0; p < all->count; p++) {
        (void)JOB_CALL(job, label_voxels_tally(&all->parts[p].voxels, &all->parts[p].labels));
    }
    refuse_clashes(job, all);
    settle_hemispheres(job, all);
    for (size_t p = 0; p < all->count && job_ok(job); p++) {
        const char *source = all->parts[p].source;
        move_entries(job, table, all, p);
        all->source = !p                                              ? source
                      : strcmp(source, all->parts[p - 1].source) == 0 ? all->source
                                                                      : job_format(job, "%s; %s", all->source, source);
    }
    labels_sort(job, table);
    all->table = *table;
}

static const char *file_name(const struct parcellation *part)
{
    return path_base(part->file.path);
}

/* A part as later parts see it. */
struct claim {
    const struct parcellation *part;
    struct volume grid;    /* without voxels */
    struct label_map lost; /* label -> voxels that earlier parts have taken */
    bool same;             /* as the grid of the part that is asked about */
};

static void end_claim(void *thing)
{
    struct claim *claim = thing;
    volume_finish(&claim->grid);
    label_map_finish(&claim->lost);
}

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

/* Takes the voxels that the first `count` parts claim from the next one. */
static void take_claimed(struct job *job, struct parcellation *part, struct claim *claims, size_t count)
{
    const conus_volume_info *info = &part->file.info;
    for (size_t q = 0; q < count; q++) {
        claims[q].same = space_same_grid(&claims[q].grid.info, info);
    }
    for (size_t voxel = 0; voxel < info->dim[0] * info->dim[1] * info->dim[2] && job_ok(job); voxel++) {
        const size_t at[3] = {voxel % info->dim[0], voxel / info->dim[0] % info->dim[1],
                              voxel / info->dim[0] / info->dim[1]};
        double centre[3] = {(double)at[0], (double)at[1], (double)at[2]};
        uint32_t label = label_voxels_at(&part->labels, voxel);
        if (label) {
            mat4_point(centre, info->world_from_voxel, centre);
            if (is_claimed(claims, count, voxel, centre)) {
                ++*map_at(job, &claims[count].lost, label);
                label_voxels_clear(&part->labels, voxel);
            }
        }
    }
}

static void note_loss(struct job *job, const struct label_map *lost, struct parcellation *part)
{
    enum { SHOWN = 4 };
    uint64_t sum = 0;
    size_t gone = 0; /* labels without any voxel left */
    const char *list = "";
    uint32_t *labels = job_raw(job, lost->count, sizeof *labels);
    for (size_t i = 0; labels && lost->slots && i <= lost->mask; i++) {
        const struct label_map_slot *slot = &lost->slots[i];
        sum += slot->value;
        if (slot->used && *map_at(job, &part->voxels, slot->label) == slot->value) {
            labels[gone++] = slot->label;
        }
    }
    if (sum) {
        job_note(job, "%s: voxels in areas of earlier parcellations, which keep them: %llu (of %zu of its areas)",
                 file_name(part), (unsigned long long)sum, lost->count);
    }
    gone = gone ? u32_sort_unique(labels, gone) : 0;
    for (size_t i = 0; i < gone && i < SHOWN; i++) {
        list = job_format(job, "%s%s%u", list, i ? ", " : "", labels[i]);
    }
    if (gone) {
        job_note(job, "%s: areas that lose all of their voxels to earlier parcellations: %zu (%s%s)", file_name(part),
                 gone, list, gone > SHOWN ? ", ..." : "");
    }
}

static void give_voxels(struct job *job, struct parcellations *all)
{
    struct claim *claims = job_zeroed(job, all->count, sizeof *claims);
    for (size_t p = 0; p < all->count && job_ok(job); p++) {
        claims[p].part = &all->parts[p];
        (void)JOB_CALL(job, volume_init(&claims[p].grid, &all->parts[p].file.info));
        job_own(job, end_claim, &claims[p]);
    }
    for (size_t p = 1; p < all->count && job_ok(job); p++) {
        take_claimed(job, &all->parts[p], claims, p);
        note_loss(job, &claims[p].lost, &all->parts[p]);
    }
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
static void note_grids(struct job *job, const struct parcellations *all)
{
    const char *list = "";
    size_t grids = 0;
    for (size_t p = 0; p < all->count; p++) {
        if (find_grid(all, p, p) == p) {
            grids++;
            list = job_format(job, "%s%s%s", list, p ? "; " : "", file_name(&all->parts[p]));
            for (size_t q = p + 1; q < all->count; q++) {
                list =
                    find_grid(all, q, q) == p ? job_format(job, "%s with %s", list, file_name(&all->parts[q])) : list;
            }
        }
    }
    if (all->count > 1) {
        job_note(job, "parcellations: %zu on %zu grid%s (%s)", all->count, grids, grids == 1 ? "" : "s", list);
    }
}

static void note_spaces(struct job *job, const struct parcellations *all)
{
    enum { TEMPLATES = 3 }; /* NIfTI's codes from there on */
    const conus_volume_info *first = &all->parts[0].file.info;
    for (size_t p = 1; p < all->count; p++) {
        const conus_volume_info *info = &all->parts[p].file.info;
        if (first->space_code >= TEMPLATES && info->space_code >= TEMPLATES && first->space_code != info->space_code) {
            job_warn(job, "%s is placed by %s, %s by %s: their areas may not fit together", file_name(&all->parts[0]),
                     first->transform, file_name(&all->parts[p]), info->transform);
        }
    }
}

/* Merges two parts on one grid. Afterwards no voxel belongs to areas of both. */
static void merge_into(struct job *job, struct parcellation *to, struct parcellation *from)
{
    (void)JOB_CALL(job, label_voxels_merge(&to->labels, &from->labels));
    label_voxels_finish(&from->labels);
    to->file.info.minimum = fmin(to->file.info.minimum, from->file.info.minimum);
    to->file.info.maximum = fmax(to->file.info.maximum, from->file.info.maximum);
    to->is_joined = true;
    if (strcmp(to->file.path, from->file.path) != 0) { /* else another volume of it */
        (void)JOB_CALL(job, file_sums_put(&job->files, from->file.path, from->file.info.sha256));
    }
}

/* Makes one part of those on each grid; the others are behind the last one. */
static void merge_grids(struct job *job, struct parcellations *all)
{
    size_t kept = 0;
    for (size_t p = 0; p < all->count; p++) {
        size_t first = find_grid(all, kept, p);
        if (first < kept) {
            merge_into(job, &all->parts[first], &all->parts[p]);
        } else {
            const struct parcellation part = all->parts[p];
            all->parts[p] = all->parts[kept];
            all->parts[kept++] = part;
        }
    }
    all->count = kept;
}

void parcellations_join(struct job *job, struct parcellations *all)
{
    if (job_step(job)) {
        note_grids(job, all);
        note_spaces(job, all);
        give_voxels(job, all);
        merge_grids(job, all);
    }
}

void parcellations_atlas(struct load *load, struct parcellation *parts, size_t count, const struct label_table *table,
                         const char *source)
{
    struct labelled_volume *volumes = job_array(&load->job, &count, sizeof *volumes);
    for (size_t p = 0; p < count; p++) {
        volumes[p] = (struct labelled_volume){&parts[p].file.info, &parts[p].labels, parts[p].is_joined};
    }
    load_create(load, volumes, count, table, source);
}
