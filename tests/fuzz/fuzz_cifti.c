/* SPDX-License-Identifier: BSD-3-Clause */
/* CIFTI files of labels: the contents of an accepted file are consistent, and its vertices and voxels can be used. */
#include "loaders/cifti/cifti.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool fact)
{
    if (!fact) {
        abort();
    }
}

static void check_models(const struct cifti *cifti)
{
    size_t next = 0;
    for (size_t i = 0; i < cifti->model_count; i++) {
        const struct cifti_model *model = &cifti->models[i];
        size_t limit = model->is_surface ? model->vertex_count : cifti->dim[0] * cifti->dim[1] * cifti->dim[2];
        require(model->offset == next && model->count);
        for (size_t n = 0; n < model->count; n++) {
            require(model->indices[n] < limit);
        }
        next += model->count;
    }
    require(next == cifti->count);
}

static void use_vertices(const struct cifti_choice *choice, const struct cifti_model *model)
{
    struct job job = {0};
    struct label_table *table = labels_new(&job);
    const uint32_t *labels = cifti_vertices(&job, table, choice, model);
    for (size_t n = 0; labels && n < model->vertex_count; n++) {
        require(!labels[n] || label_table_find(table, labels[n]));
    }
    job_end(&job);
}

static void use_voxels(const struct cifti_choice *choice)
{
    const size_t *dim = choice->cifti.dim;
    struct job job = {0};
    struct label_table *table = labels_new(&job);
    const uint32_t *labels = cifti_voxels(&job, table, choice);
    for (size_t n = 0; labels && n < dim[0] * dim[1] * dim[2]; n++) {
        require(!labels[n] || label_table_find(table, labels[n]));
    }
    job_end(&job);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct bytes bytes = {(uint8_t *)data, size};
    struct job job = {.max_memory = 1 << 20};
    const struct cifti_choice *choice = cifti_choose(&job, &bytes, text_from(""));
    if (choice) {
        check_models(&choice->cifti);
        for (size_t i = 0; i < choice->cifti.model_count; i++) {
            if (choice->cifti.models[i].is_surface) {
                use_vertices(choice, &choice->cifti.models[i]);
            }
        }
        use_voxels(choice);
    }
    job_end(&job);
    return 0;
}
