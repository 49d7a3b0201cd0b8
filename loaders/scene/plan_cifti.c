/* SPDX-License-Identifier: BSD-3-Clause */
/* From a .dlabel.nii to a manifest: the surface of each structure, and labels that no two of them share. */
#include "loaders/scene/parts.h"

#include "base/files/file.h"
#include "base/order.h"
#include "loaders/manifest/manifest.h"
#include "loaders/surfaces/surfaces.h"

#include <stdlib.h>

struct planning {
    struct job *job;
    const struct cifti_file *file;
    struct surface_list surfaces;
    struct scene *scene;
    uint32_t *taken; /* labels of the areas planned so far, sorted */
    size_t taken_count;
};

/* "FILE,map=K", without the folder. */
static char *name_map(const struct planning *planning)
{
    const struct cifti_file *file = planning->file;
    return job_format(planning->job, "%s,map=%zu", path_base(file->path), file->choice->map);
}

/* The least multiple of the step by which no label of `list`, sorted, becomes one that is taken: 0 if none is; else
 * above all that are taken. */
static uint32_t choose_offset(const struct planning *planning, const uint32_t *list, size_t count)
{
    bool shared = false;
    for (size_t i = 0; i < count && !shared; i++) {
        shared = planning->taken_count &&
                 bsearch(&list[i], planning->taken, planning->taken_count, sizeof *planning->taken, compare_u32);
    }
    uint64_t largest = shared ? planning->taken[planning->taken_count - 1] : 0;
    uint64_t offset = (largest + MANIFEST_LABEL_STEP - 1) / MANIFEST_LABEL_STEP * MANIFEST_LABEL_STEP;
    if (count && offset + list[count - 1] > UINT32_MAX) {
        job_bad(planning->job,
                "label %u of a structure, raised by %llu since others have its labels, is above 4294967295",
                list[count - 1], (unsigned long long)offset);
    }
    return (uint32_t)offset;
}

static void take_labels(struct planning *planning, const uint32_t *list, size_t count, uint32_t offset)
{
    size_t all = planning->taken_count + count;
    uint32_t *taken = job_grow(planning->job, planning->taken, all, sizeof *taken);
    for (size_t i = 0; taken && i < count; i++) {
        taken[planning->taken_count + i] = list[i] + offset;
    }
    if (taken) {
        planning->taken = taken;
        planning->taken_count = u32_sort_unique(taken, all);
    }
}

static void plan_surface(struct planning *planning, const struct cifti_model *model, const uint32_t *list, size_t count)
{
    struct job *job = planning->job;
    const struct surface_item *surface;
    const char *kind;
    const char *path = planning->file->path;
    const char *structure = model->structure->name;
    const size_t mark = job_in(job, path, JOB_ALONE);
    surface = surface_list_find(job, &kind, &planning->surfaces, structure, model->vertex_count);
    const uint32_t offset = choose_offset(planning, list, count);
    job_out(job, mark);
    if (!job_step(job) || !surface) {
        return;
    }
    /* names the map: sidecars of two maps with the same labels differ in nothing else */
    job_note(job, "%s: map %zu: labels of %s are on %s (%s)", path, planning->file->choice->map, structure,
             surface->name, kind);
    if (offset) {
        job_note(job, "%s: labels of %s are raised by %u, since others have them, too", path, structure, offset);
    }
    take_labels(planning, list, count, offset);
    const struct scene_item area = {.kind = ITEM_AREA,
                                    .file = job_copy(job, text_from(surface->name)),
                                    .vertex_labels = name_map(planning),
                                    .noted = true,
                                    .label_offset = offset};
    scene_add(job, planning->scene, &area);
}

static void plan_voxels(struct planning *planning, const uint32_t *list, size_t count)
{
    const struct scene_item voxels = {.kind = ITEM_PARCELLATION, .file = name_map(planning), .noted = true};
    scene_add(planning->job, planning->scene, &voxels);
    take_labels(planning, list, count, 0);
}

/* Plans a surface, or all voxels where `model` is NULL. */
static void plan_model(struct planning *planning, const struct cifti_model *model)
{
    struct job *job = planning->job;
    size_t count;
    const uint32_t *list = cifti_list(job, &count, planning->file->choice, model);
    if (!count) {
        job_note(job, "%s: no label in this map for %s, left out", planning->file->path,
                 model ? model->structure->name : "voxels");
    } else if (list && model) {
        plan_surface(planning, model, list, count);
    } else if (list) {
        plan_voxels(planning, list, count);
    }
}

void plan_cifti(struct job *job, struct scene *out, const struct cifti_file *file)
{
    struct planning planning = {.job = job, .file = file, .scene = out};
    if (!job_step(job)) { /* there is no file */
        return;
    }
    const struct cifti_choice *choice = file->choice;
    const struct cifti *cifti = &choice->cifti;
    const int folder = (int)(path_base(file->path) - file->path);
    const char *where = folder ? job_format(job, "%.*s", folder, file->path) : "./";
    planning.surfaces = surface_list_make(job, where);
    if (cifti_choice_has_voxels(choice)) {
        plan_model(&planning, NULL);
    }
    for (size_t i = 0; i < cifti->model_count && job_ok(job); i++) {
        if (cifti->models[i].is_surface) {
            plan_model(&planning, &cifti->models[i]);
        }
    }
    if (!planning.taken_count) {
        const char *name = cifti->maps.at[choice->map].name;
        job_bad(job, "%s: map %zu, \"%.60s\", has no label but 0", file->path, choice->map, name ? name : "");
    }
}
