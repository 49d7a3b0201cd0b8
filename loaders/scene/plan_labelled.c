/* SPDX-License-Identifier: BSD-3-Clause */
/* Areas of a manifest that are the parts of one surface, by the labels of its vertices. */
#include "loaders/scene/plan_labelled.h"

#include "base/memory.h"
#include "base/order.h"

#include <string.h>

/* The labels that vertices have, sorted, each once. */
static conus_status list_labels(uint32_t **out, size_t *count, const struct vertex_labels *labels)
{
    uint32_t *sorted = memory_raw(labels->count, sizeof *sorted);
    size_t kept = 0;
    if (!sorted) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < labels->count; i++) {
        sorted[kept] = labels->labels[i];
        kept += sorted[kept] != 0;
    }
    *out = sorted;
    *count = u32_sort_unique(sorted, kept);
    return CONUS_OK;
}

/* Plans the part `number` of the last labelled surface. */
static conus_status plan_part(struct area_plan *plan, size_t entry, const struct manifest_area *area, uint32_t number)
{
    const struct labelled_surface *surface = &plan->labelled[plan->labelled_count - 1];
    const struct label *known = label_table_find(&surface->labels.table, number);
    struct label label = known ? *known : (struct label){0};
    if (number > UINT32_MAX - area->label_offset) {
        return fail(CONUS_ERROR_DATA, "label_offset: %u + %u is above 4294967295", area->label_offset, number);
    }
    label.number = number + area->label_offset;
    label.hemisphere = area->label.hemisphere ? area->label.hemisphere : surface->labels.hemisphere;
    label.has_parent = area->label.has_parent;
    label.parent = area->label.parent;
    char *path = memory_text(surface->path, strlen(surface->path));
    conus_status status = path ? area_plan_add(plan, entry, path, &label) : CONUS_ERROR_MEMORY;
    if (!status) {
        struct planned_area *planned = &plan->areas[plan->count - 1];
        planned->is_part = true;
        planned->surface = plan->labelled_count - 1;
        planned->part = number;
    }
    return status;
}

static conus_status add_surface(struct area_plan *plan, const struct manifest_area *area, const char *path,
                                struct notes *notes)
{
    struct mesh_file_options options = {
        .max_memory = plan->max_memory, .read = &plan->read, .hemisphere = area->label.hemisphere};
    struct labelled_surface *surfaces = memory_resize(plan->labelled, plan->labelled_count + 1, sizeof *surfaces);
    char *labels = file_beside(path, area->vertex_labels);
    plan->labelled = surfaces ? surfaces : plan->labelled;
    if (!surfaces || !labels) {
        memory_free(labels);
        return CONUS_ERROR_MEMORY;
    }
    struct labelled_surface *surface = &surfaces[plan->labelled_count++];
    *surface = (struct labelled_surface){.path = file_beside(path, area->file)};
    options.surface = surface->path;
    struct notes again = {0};
    conus_status status = surface->path
                              ? vertex_labels_read(&surface->labels, labels, &options, area->noted ? &again : notes)
                              : CONUS_ERROR_MEMORY;
    notes_finish(&again);
    memory_free(labels);
    return status;
}

conus_status plan_labelled(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path,
                           struct notes *notes)
{
    uint32_t *numbers = NULL;
    size_t count = 0;
    conus_status status = add_surface(plan, area, path, notes);
    status = status ? status : list_labels(&numbers, &count, &plan->labelled[plan->labelled_count - 1].labels);
    for (size_t i = 0; !status && i < count; i++) {
        status = plan_part(plan, entry, area, numbers[i]);
    }
    memory_free(numbers);
    return status;
}
