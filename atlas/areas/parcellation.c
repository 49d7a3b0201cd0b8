/* SPDX-License-Identifier: BSD-3-Clause */
/* atlas_create_of(): turns labels of any size and a label table into areas with dense numbers. */
#include "atlas/atlas.h"
#include "atlas/labels/labels.h"
#include "atlas/space.h"
#include "base/memory.h"
#include "base/order.h"

#include <stdio.h>
#include <string.h>

enum { NOTED = 8 };

/* Volumes that become an atlas. */
struct numbering {
    struct labelled_volume *volumes; /* [count] */
    size_t count;
    const struct label_table *table;
    struct label_map *voxels;   /* [count] label -> how many the volume has */
    struct label_map number_of; /* label -> its area */
};

/* Whether a volume after the first has voxels of the label. */
static conus_status is_elsewhere(bool *out, struct numbering *numbering, uint32_t label)
{
    *out = false;
    for (size_t v = 1; v < numbering->count && !*out; v++) {
        const uint64_t *voxels = label_map_at(&numbering->voxels[v], label);
        if (!voxels) {
            return CONUS_ERROR_MEMORY;
        }
        *out = *voxels > 0;
    }
    return CONUS_OK;
}

/* The labels of volume `v`, sorted; for the first volume also those that the table names and no volume has: an area is
 * one or the other. */
static conus_status list_labels(uint32_t **out, size_t *out_count, struct numbering *numbering, size_t v)
{
    const struct label_map *present = &numbering->voxels[v];
    const struct label_table *table = numbering->table;
    uint32_t *numbers = memory_raw(present->count + table->count, sizeof *numbers);
    conus_status status = numbers ? CONUS_OK : CONUS_ERROR_MEMORY;
    size_t count = 0;
    for (size_t i = 0; !status && present->slots && i <= present->mask; i++) {
        if (present->slots[i].value) {
            numbers[count++] = present->slots[i].label;
        }
    }
    for (size_t i = 0; !status && v == 0 && i < table->count; i++) {
        bool elsewhere = false;
        if (table->entries[i].name) { /* a colour alone makes no area of a label that is absent */
            status = is_elsewhere(&elsewhere, numbering, table->entries[i].number);
            numbers[count] = table->entries[i].number;
            count += !elsewhere;
        }
    }
    *out = numbers;
    *out_count = numbers ? u32_sort_unique(numbers, count) : 0;
    return status;
}

static conus_status append_area(conus_atlas *atlas, size_t volume, uint32_t number, const struct label *label,
                                uint64_t voxels)
{
    char digits[LABEL_DIGITS];
    const struct label unknown = {.number = number};
    conus_object area = label_object(label ? label : &unknown, atlas->object_count, digits);
    area.volume = volume;
    area.voxels = voxels;
    area.volume_mm3 = (double)voxels * space_voxel_mm3(&atlas->volumes[volume].info);
    return atlas_append_object(atlas, &area, (struct object_place){.index = volume});
}

static conus_status append_areas(conus_atlas *atlas, struct numbering *numbering, size_t v)
{
    uint32_t *labels = NULL;
    size_t count = 0;
    conus_status status = list_labels(&labels, &count, numbering, v);
    for (size_t i = 0; !status && i < count; i++) {
        const uint64_t *voxels = label_map_at(&numbering->voxels[v], labels[i]);
        uint64_t *number = label_map_at(&numbering->number_of, labels[i]);
        status = voxels && number
                     ? append_area(atlas, v, labels[i], label_table_find(numbering->table, labels[i]), *voxels)
                     : CONUS_ERROR_MEMORY;
        if (!status) {
            *number = atlas->object_count;
        }
    }
    atlas->area_count = atlas->object_count;
    memory_free(labels);
    return status;
}

/* The area's number for each place in the list of labels. */
static conus_status number_places(uint32_t *numbers, struct label_map *number_of, const struct label_voxels *labels)
{
    for (size_t p = 0; p < labels->label_count; p++) {
        const uint64_t *number = labels->labels[p] ? label_map_at(number_of, labels->labels[p]) : NULL;
        if (labels->labels[p] && !number) {
            return CONUS_ERROR_MEMORY;
        }
        numbers[p] = number ? (uint32_t)*number : 0; /* 0: no voxel has it any more */
    }
    return CONUS_OK;
}

/* Takes the voxels over. */
static conus_status number_voxels(struct volume *volume, struct label_map *number_of, struct label_voxels *labels,
                                  size_t area_count)
{
    uint32_t *numbers = memory_raw(labels->label_count, sizeof *numbers);
    conus_status status = numbers ? number_places(numbers, number_of, labels) : CONUS_ERROR_MEMORY;
    status = status ? status : label_voxels_renumber(labels, numbers, area_count <= UINT16_MAX);
    if (!status) {
        volume->objects16 = labels->narrow;
        volume->objects32 = labels->wide;
        labels->narrow = NULL;
        labels->wide = NULL;
    }
    memory_free(numbers);
    return status;
}

/* True when following the parents of `object` comes back to it. Longer circles are refused as too deep. */
static bool is_cyclic(const conus_atlas *atlas, size_t object)
{
    uint32_t at = atlas->objects[object - 1].parent;
    for (size_t steps = 0; at && steps <= ATLAS_DEPTH_LIMIT; steps++) {
        if (at == object) {
            return true;
        }
        at = atlas->objects[at - 1].parent;
    }
    return false;
}

static conus_status link_parents(conus_atlas *atlas, struct label_map *number_of, const struct label_table *table)
{
    conus_status status = CONUS_OK;
    size_t count = 0;
    for (size_t i = 0; !status && i < table->count; i++) {
        const struct label *label = &table->entries[i];
        if (!label->has_parent) {
            continue;
        }
        uint64_t *child = label_map_at(number_of, label->number);
        uint64_t number = child ? *child : 0;
        uint64_t *parent = label_map_at(number_of, label->parent);
        if (!child || !parent) {
            return CONUS_ERROR_MEMORY;
        }
        if (!number) { /* neither named nor present */
            continue;
        }
        conus_object *area = &atlas->objects[number - 1];
        area->parent = (uint32_t)*parent;
        if (!area->parent || is_cyclic(atlas, number)) {
            if (++count <= NOTED) {
                status = notes_add(&atlas->notes, "area %u: its parent %u %s: treated as a root", label->number,
                                   label->parent, area->parent ? "lies below it" : "is not in the label table");
            }
            area->parent = 0;
        }
    }
    return status || count <= NOTED ? status
                                    : notes_add(&atlas->notes, "%zu more areas are treated as roots", count - NOTED);
}

/* "N labels ... : 3, 17, 20, ..." for the areas that `wanted` picks. */
static conus_status note_areas(conus_atlas *atlas, conus_severity severity, const char *what,
                               bool (*wanted)(const conus_object *))
{
    struct buffer list = {0};
    size_t count = 0;
    for (size_t i = 0; i < atlas->area_count; i++) {
        if (wanted(&atlas->objects[i]) && count++ < NOTED) {
            buffer_format(&list, "%s%u", count > 1 ? ", " : "", atlas->objects[i].label);
        }
    }
    conus_status status = buffer_status(&list);
    if (!status && count) {
        status =
            notes_put(&atlas->notes, severity, "%s: %zu (%s%s)", what, count, list.data, count > NOTED ? ", ..." : "");
    }
    buffer_finish(&list);
    return status;
}

static bool has_no_name(const conus_object *area)
{
    return !area->named;
}

static bool has_no_voxels(const conus_object *area)
{
    return !area->voxels;
}

static conus_status add_notes(conus_atlas *atlas, const struct label_table *table)
{
    conus_status status = CONUS_OK;
    bool has_names = false;
    for (size_t i = 0; i < table->count && !has_names; i++) {
        has_names = table->entries[i].name;
    }
    if (has_names) {
        status = note_areas(atlas, CONUS_SEVERITY_WARNING, "labels in the volume that the label table does not name",
                            has_no_name);
        status =
            status ? status
                   : note_areas(atlas, CONUS_SEVERITY_NOTE, "areas of the label table without a voxel", has_no_voxels);
    }
    if (!status && !atlas->area_count) {
        status = notes_add(&atlas->notes, "the volume has no label but 0: nothing can be selected");
    }
    return status;
}

static conus_status create_with(conus_atlas **out, struct numbering *numbering, const char *label_source,
                                struct notes *notes)
{
    conus_atlas *atlas = NULL;
    conus_status status = atlas_create_empty(&atlas, label_source);
    if (status) {
        return status;
    }
    atlas->notes.sink = notes->sink;
    for (size_t v = 0; !status && v < numbering->count; v++) {
        struct volume volume = {0};
        status = volume_init(&volume, numbering->volumes[v].info);
        volume.is_joined = numbering->volumes[v].is_joined;
        status = status ? status : atlas_append_volume(atlas, &volume);
        volume_finish(&volume);
        status = status ? status : label_voxels_tally(&numbering->voxels[v], numbering->volumes[v].labels);
    }
    for (size_t v = 0; !status && v < numbering->count; v++) {
        status = append_areas(atlas, numbering, v);
    }
    for (size_t v = 0; !status && v < numbering->count; v++) {
        status =
            number_voxels(&atlas->volumes[v], &numbering->number_of, numbering->volumes[v].labels, atlas->area_count);
    }
    status = status ? status : link_parents(atlas, &numbering->number_of, numbering->table);
    if (!status && atlas_check_tree(atlas)) {
        status = fail_in(CONUS_ERROR_DATA, label_source);
    }
    status = status ? status : add_notes(atlas, numbering->table);
    status = status ? status : notes_move(&atlas->notes, notes);
    return atlas_give(out, atlas, status);
}

conus_status atlas_create_of(conus_atlas **out, struct labelled_volume *volumes, size_t count,
                             const struct label_table *table, const char *label_source, struct notes *notes)
{
    struct label_map *voxels = memory_zeroed(count, sizeof *voxels);
    struct numbering numbering = {.volumes = volumes, .count = voxels ? count : 0, .table = table, .voxels = voxels};
    conus_status status = voxels ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : create_with(out, &numbering, label_source, notes);
    for (size_t v = 0; v < numbering.count; v++) {
        label_map_finish(&numbering.voxels[v]);
    }
    memory_free(numbering.voxels);
    label_map_finish(&numbering.number_of);
    return status;
}
