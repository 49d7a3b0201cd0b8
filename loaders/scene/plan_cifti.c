/* SPDX-License-Identifier: BSD-3-Clause */
/* From a .dlabel.nii to a manifest: the surface of each structure, and labels that no two of them share. */
#include "loaders/scene/plan_cifti.h"

#include "base/files/folder.h"
#include "base/memory.h"
#include "base/order.h"
#include "loaders/manifest/manifest_surfaces.h"
#include "loaders/surfaces/surface_find.h"

#include <stdlib.h>

struct planning {
    const struct cifti_file *file;
    struct surface_list surfaces;
    struct manifest manifest;
    struct notes *notes;
    struct job *job; /* Bridge: owns the manifest */
    uint32_t *taken; /* labels of the areas planned so far, sorted */
    size_t taken_count;
};

/* "FILE,map=K", without the folder. */
static char *name_map(struct job *job, const struct cifti_file *file)
{
    return job_format(job, "%s,map=%zu", path_base(file->path), file->choice.map);
}

/* Bridge: the state of the job as a status. */
static conus_status state_of(const struct job *job)
{
    return job_ok(job) ? CONUS_OK : fail(job->status, "%s", job->message);
}

/* The least multiple of the step by which no label of `list`, sorted, becomes one that is taken: 0 if none is; else
 * above all that are taken. */
static conus_status choose_offset(uint32_t *out, const struct planning *planning, const uint32_t *list, size_t count)
{
    bool shared = false;
    for (size_t i = 0; i < count && !shared; i++) {
        shared = planning->taken_count &&
                 bsearch(&list[i], planning->taken, planning->taken_count, sizeof *planning->taken, compare_u32);
    }
    uint64_t largest = shared ? planning->taken[planning->taken_count - 1] : 0;
    uint64_t offset = (largest + MANIFEST_LABEL_STEP - 1) / MANIFEST_LABEL_STEP * MANIFEST_LABEL_STEP;
    if (count && offset + list[count - 1] > UINT32_MAX) {
        return fail(CONUS_ERROR_DATA,
                    "label %u of a structure, raised by %llu since others have its labels, is above "
                    "4294967295",
                    list[count - 1], (unsigned long long)offset);
    }
    *out = (uint32_t)offset;
    return CONUS_OK;
}

static conus_status take_labels(struct planning *planning, const uint32_t *list, size_t count, uint32_t offset)
{
    uint32_t *taken = memory_resize(planning->taken, planning->taken_count + count, sizeof *taken);
    if (!taken) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        taken[planning->taken_count + i] = list[i] + offset;
    }
    planning->taken = taken;
    planning->taken_count = u32_sort_unique(taken, planning->taken_count + count);
    return CONUS_OK;
}

static conus_status add_area(struct planning *planning, const char *surface, uint32_t offset)
{
    struct manifest *manifest = &planning->manifest;
    struct manifest_area *areas = job_grow(planning->job, manifest->areas, manifest->area_count + 1, sizeof *areas);
    if (!areas) {
        return state_of(planning->job);
    }
    manifest->areas = areas;
    areas[manifest->area_count++] = (struct manifest_area){.file = job_format(planning->job, "%s", surface),
                                                           .vertex_labels = name_map(planning->job, planning->file),
                                                           .noted = true,
                                                           .label_offset = offset};
    return state_of(planning->job);
}

static conus_status plan_surface(struct planning *planning, const struct cifti_model *model, const uint32_t *list,
                                 size_t count)
{
    const struct surface_item *surface = NULL;
    const char *kind = NULL;
    uint32_t offset = 0;
    conus_status status =
        surface_list_find(&surface, &kind, &planning->surfaces, model->structure->name, model->vertex_count);
    const char *path = planning->file->path;
    status = status ? status : choose_offset(&offset, planning, list, count);
    if (status) {
        return status == CONUS_ERROR_MEMORY ? status : fail_in(status, path);
    }
    /* names the map: sidecars of two maps with the same labels differ in nothing else */
    status = notes_add(planning->notes, "%s: map %zu: labels of %s are on %s (%s)", path, planning->file->choice.map,
                       model->structure->name, surface->name, kind);
    if (!status && offset) {
        status = notes_add(planning->notes, "%s: labels of %s are raised by %u, since others have them, too", path,
                           model->structure->name, offset);
    }
    status = status ? status : take_labels(planning, list, count, offset);
    return status ? status : add_area(planning, surface->name, offset);
}

static conus_status add_voxels(struct job *job, struct manifest *manifest, const struct cifti_file *file)
{
    manifest->parcellations = job_new(job, struct manifest_parcellation);
    if (!manifest->parcellations) {
        return state_of(job);
    }
    manifest->parcellation_count = 1;
    manifest->single = true;
    manifest->parcellations[0] = (struct manifest_parcellation){.source.file = name_map(job, file), .noted = true};
    return state_of(job);
}

/* Plans a surface, or all voxels where `model` is NULL. */
static conus_status plan_model(struct planning *planning, const struct cifti_model *model)
{
    uint32_t *list = NULL;
    size_t count = 0;
    conus_status status = cifti_choice_list(&list, &count, &planning->file->choice, model);
    if (!status && !count) {
        status = notes_add(planning->notes, "%s: no label in this map for %s, left out", planning->file->path,
                           model ? model->structure->name : "voxels");
    } else if (!status && model) {
        status = plan_surface(planning, model, list, count);
    } else if (!status) {
        status = add_voxels(planning->job, &planning->manifest, planning->file);
        status = status ? status : take_labels(planning, list, count, 0);
    }
    memory_free(list);
    return status;
}

conus_status plan_cifti(struct job *job, struct manifest *out, const struct cifti_file *file, uint64_t max_memory,
                        struct notes *notes)
{
    struct planning planning = {.file = file, .notes = notes, .job = job};
    char *folder = path_folder(file->path);
    conus_status status = folder ? surface_list_make(&planning.surfaces, folder, max_memory) : CONUS_ERROR_MEMORY;
    const struct cifti_choice *choice = &file->choice;
    status = status || !cifti_choice_has_voxels(choice) ? status : plan_model(&planning, NULL);
    for (size_t i = 0; !status && i < choice->cifti.model_count; i++) {
        status = choice->cifti.models[i].is_surface ? plan_model(&planning, &choice->cifti.models[i]) : CONUS_OK;
    }
    if (!status && !planning.taken_count) {
        const char *name = choice->cifti.maps[choice->map].name;
        status = fail(CONUS_ERROR_DATA, "%s: map %zu, \"%.60s\", has no label but 0", file->path, choice->map,
                      name ? name : "");
    }
    surface_list_finish(&planning.surfaces);
    memory_free(planning.taken);
    memory_free(folder);
    if (status) {
        return status;
    }
    *out = planning.manifest;
    return CONUS_OK;
}
