/* SPDX-License-Identifier: BSD-3-Clause */
/* From the "areas" and the "tree" of a manifest to a list of surfaces and groups. */
#include "loaders/scene/load_plan.h"

#include "base/files/folder.h"
#include "loaders/scene/plan_brainglobe.h"
#include "loaders/scene/plan_files.h"
#include "loaders/scene/plan_labelled.h"

#include <stdio.h>

static conus_status refuse_twins(const struct area_plan *plan)
{
    for (size_t i = 1; i < plan->count; i++) {
        const struct planned_area *a = &plan->areas[i - 1];
        const struct planned_area *b = &plan->areas[i];
        if (a->label.number == b->label.number) {
            return fail(CONUS_ERROR_DATA,
                        "areas[%zu]: label %u is that of %s and of %s: each needs its own (label, label_offset)",
                        b->entry, b->label.number, path_base(a->path), path_base(b->path));
        }
    }
    return CONUS_OK;
}

static conus_status add_tree(struct area_plan *plan, const struct manifest *manifest)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < manifest->tree_count; i++) {
        struct label *node = &manifest->tree[i];
        struct planned_area *area = area_plan_find(plan, node->number);
        if (!area) {
            status = area_plan_add_group(plan, node);
        } else if (node->has_parent) {
            area->label.has_parent = true;
            area->label.parent = node->parent;
        }
    }
    return status;
}

conus_status area_plan_make(struct area_plan *out, const struct manifest *manifest, const char *path,
                            struct notes *notes)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < manifest->area_count; i++) {
        char key[48];
        const struct manifest_area *area = &manifest->areas[i];
        status = area->vertex_labels ? plan_labelled(out, i, area, path, notes)
                 : area->file        ? plan_file(out, i, area, path)
                 : area->files       ? plan_pattern(out, i, area, path, notes)
                                     : plan_brainglobe(out, i, area, path, notes);
        snprintf(key, sizeof key, "areas[%zu]", i);
        status = status ? fail_in(status, key) : CONUS_OK;
    }
    area_plan_sort(out);
    status = status ? status : refuse_twins(out);
    status = status ? status : add_tree(out, manifest);
    return status ? status : label_table_sort(&out->groups, notes);
}
