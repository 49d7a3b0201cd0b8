/* SPDX-License-Identifier: BSD-3-Clause */
/* A volume with the labels that a .dlabel.nii gives to voxels. */
#include "loaders/scene/cifti_parcellation.h"

#include "atlas/space.h"
#include "base/buffer.h"
#include "base/memory.h"
#include "loaders/cifti/cifti_file.h"

#include <stdio.h>
#include <string.h>

static void set_range(conus_volume_info *info, const uint32_t *labels)
{
    size_t count = info->dim[0] * info->dim[1] * info->dim[2];
    uint32_t least = UINT32_MAX;
    uint32_t most = 0;
    for (size_t i = 0; i < count; i++) {
        least = labels[i] < least ? labels[i] : least;
        most = labels[i] > most ? labels[i] : most;
    }
    info->minimum = least;
    info->maximum = most;
}

static conus_status describe(struct volume_file *out, const struct cifti_file *file, uint64_t max_memory)
{
    const struct cifti *cifti = &file->choice.cifti;
    conus_volume_info *info = &out->info;
    out->path = memory_text(file->path, strlen(file->path));
    out->datatype = cifti->datatype;
    out->max_memory = max_memory;
    *info = (conus_volume_info){
        .path = out->path, .volume = file->choice.map, .volume_count = cifti->map_count, .slope = 1};
    snprintf(info->format, sizeof info->format, "CIFTI-2");
    snprintf(info->datatype, sizeof info->datatype, "%s", volume_datatype_name(cifti->datatype));
    memcpy(info->sha256, file->sha256, sizeof info->sha256);
    memcpy(info->dim, cifti->dim, sizeof info->dim);
    return out->path ? space_describe(info, cifti->world_from_voxel, "the CIFTI file's volume") : CONUS_ERROR_MEMORY;
}

conus_status cifti_parcellation_read(struct parcellation *out, const char *path, uint64_t max_memory)
{
    struct cifti_file file = {0};
    struct buffer source = {0};
    conus_status status = cifti_file_open(&file, path, max_memory, &out->notes);
    if (!status && !cifti_choice_has_voxels(&file.choice)) {
        status = fail(CONUS_ERROR_DATA,
                      "%s: no voxels, its labels are of vertices only: \"vertex_labels\" in a "
                      "manifest, or --labels, takes them",
                      file.path);
    }
    status = status ? status : describe(&out->file, &file, max_memory);
    uint32_t *labels = NULL;
    status = status ? status : cifti_choice_voxels(&labels, &out->table, &file.choice);
    if (!status && !out->table.count) {
        status = fail(CONUS_ERROR_DATA, "%s: no voxel has a label but 0 in map %zu", file.path, file.choice.map);
    }
    if (!status) {
        set_range(&out->file.info, labels);
        status = label_voxels_of(&out->labels, labels,
                                 file.choice.cifti.dim[0] * file.choice.cifti.dim[1] * file.choice.cifti.dim[2]);
    }
    memory_free(labels);
    if (!status) {
        buffer_format(&source, "label table in %s", file.path);
        status = buffer_status(&source);
        out->source = source.data;
    }
    cifti_file_finish(&file);
    return status;
}
