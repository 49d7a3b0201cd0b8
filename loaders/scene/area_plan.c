/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of surfaces that become areas, while it is being made. */
#include "loaders/scene/area_plan.h"

#include "base/memory.h"
#include "base/order.h"

#include <stdlib.h>
#include <string.h>

void planned_area_finish(struct planned_area *area)
{
    memory_free(area->path);
    label_finish(&area->label);
}

void area_plan_finish(struct area_plan *plan)
{
    for (size_t i = 0; i < plan->count; i++) {
        planned_area_finish(&plan->areas[i]);
    }
    for (size_t i = 0; i < plan->labelled_count; i++) {
        memory_free(plan->labelled[i].path);
        vertex_labels_finish(&plan->labelled[i].labels);
    }
    memory_free(plan->labelled);
    file_sums_finish(&plan->read);
    memory_free(plan->areas);
    label_table_finish(&plan->groups);
    *plan = (struct area_plan){0};
}

static conus_status copy_text(char **out, const char *text)
{
    *out = text ? memory_text(text, strlen(text)) : NULL;
    return text && !*out ? CONUS_ERROR_MEMORY : CONUS_OK;
}

static conus_status copy_label(struct label *out, const struct label *label)
{
    *out = *label;
    out->abbreviation = NULL;
    conus_status status = copy_text(&out->name, label->name);
    return status ? status : copy_text(&out->abbreviation, label->abbreviation);
}

conus_status area_plan_add(struct area_plan *plan, size_t entry, char *path, const struct label *label)
{
    if (!memory_reserve(&plan->areas, &plan->capacity, plan->count + 1, sizeof *plan->areas)) {
        memory_free(path);
        return CONUS_ERROR_MEMORY;
    }
    struct planned_area *area = &plan->areas[plan->count++];
    *area = (struct planned_area){.path = path, .entry = entry};
    return copy_label(&area->label, label);
}

conus_status area_plan_add_group(struct area_plan *plan, const struct label *label)
{
    struct label *group = label_table_add(&plan->groups, label->number);
    struct label copy = {0};
    conus_status status = group ? copy_label(&copy, label) : CONUS_ERROR_MEMORY;
    if (status) {
        label_finish(&copy);
        return status;
    }
    *group = copy;
    return CONUS_OK;
}

static int compare_areas(const void *a, const void *b)
{
    return compare_unsigned(((const struct planned_area *)a)->label.number,
                            ((const struct planned_area *)b)->label.number);
}

void area_plan_sort(struct area_plan *plan)
{
    if (plan->count) {
        qsort(plan->areas, plan->count, sizeof *plan->areas, compare_areas);
    }
}

struct planned_area *area_plan_find(const struct area_plan *plan, uint32_t label)
{
    struct planned_area key = {.label.number = label};
    return plan->count ? bsearch(&key, plan->areas, plan->count, sizeof key, compare_areas) : NULL;
}

size_t area_plan_files(const struct area_plan *plan)
{
    size_t files = plan->labelled_count;
    for (size_t i = 0; i < plan->count; i++) {
        files += !plan->areas[i].is_part;
    }
    return files;
}
