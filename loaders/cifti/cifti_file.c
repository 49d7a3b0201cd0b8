/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens a .dlabel.nii, and spreads the labels of a map over vertices and voxels. */
#include "loaders/cifti/cifti_file.h"

#include "base/formats/gzip.h"
#include "base/memory.h"
#include "base/order.h"
#include "loaders/volumes/nifti.h"
#include "sources/map_choice.h"

#include <string.h>

void cifti_choice_finish(struct cifti_choice *choice)
{
    cifti_finish(&choice->cifti);
    memory_free(choice->labels);
    *choice = (struct cifti_choice){0};
}

static conus_status choose_map(struct cifti_choice *choice, struct text wanted, struct notes *notes)
{
    const struct cifti *cifti = &choice->cifti;
    const char **names = memory_zeroed(cifti->map_count, sizeof *names);
    if (!names) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < cifti->map_count; i++) {
        names[i] = cifti->maps[i].name;
    }
    conus_status status = map_choice_make(&choice->map, names, cifti->map_count, wanted, "maps", notes);
    memory_free(names);
    return status || choice->map < cifti->map_count
               ? status
               : fail(CONUS_ERROR_ARGUMENT, "map: found %zu, allowed are 0 to %zu", choice->map, cifti->map_count - 1);
}

conus_status cifti_choice_read(struct cifti_choice *out, const struct bytes *bytes, struct text wanted,
                               uint64_t max_memory, struct notes *notes)
{
    struct cifti_choice choice = {0};
    conus_status status = cifti_parse(&choice.cifti, bytes->data, bytes->size, max_memory);
    status = status ? status : choose_map(&choice, wanted, notes);
    status = status ? status : notes_move(notes, &choice.cifti.maps[choice.map].notes);
    status = status ? status : cifti_labels(&choice.labels, &choice.cifti, choice.map, notes);
    if (status) {
        cifti_choice_finish(&choice);
        return status;
    }
    *out = choice;
    return CONUS_OK;
}

const struct cifti_model *cifti_choice_surface(const struct cifti_choice *choice, const char *structure)
{
    for (size_t i = 0; i < choice->cifti.model_count; i++) {
        const struct cifti_model *model = &choice->cifti.models[i];
        if (model->is_surface && strcmp(model->structure->name, structure) == 0) {
            return model;
        }
    }
    return NULL;
}

bool cifti_choice_has_voxels(const struct cifti_choice *choice)
{
    for (size_t i = 0; i < choice->cifti.model_count; i++) {
        if (!choice->cifti.models[i].is_surface) {
            return true;
        }
    }
    return false;
}

conus_status cifti_choice_list(uint32_t **labels, size_t *count, const struct cifti_choice *choice,
                               const struct cifti_model *model)
{
    const struct cifti *cifti = &choice->cifti;
    size_t kept = 0;
    uint32_t *list = memory_raw(cifti->count, sizeof *list);
    if (!list) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < cifti->model_count; i++) {
        const struct cifti_model *at = &cifti->models[i];
        bool wanted = model ? at == model : !at->is_surface;
        for (size_t n = 0; wanted && n < at->count; n++) {
            list[kept] = choice->labels[at->offset + n];
            kept += list[kept] != 0;
        }
    }
    *labels = list;
    *count = u32_sort_unique(list, kept);
    return CONUS_OK;
}

static conus_status copy_entry(struct label_table *table, const struct label *from)
{
    struct label *entry = label_table_add(table, from->number);
    if (!entry) {
        return CONUS_ERROR_MEMORY;
    }
    entry->has_rgb = from->has_rgb;
    memcpy(entry->rgb, from->rgb, sizeof entry->rgb);
    return from->name ? label_set_text(&entry->name, text_from(from->name)) : CONUS_OK;
}

/* The entries of the labels that `model`, or all voxels, have. */
static conus_status copy_table(struct label_table *table, const struct cifti_choice *choice,
                               const struct cifti_model *model)
{
    uint32_t *list = NULL;
    size_t count = 0;
    const struct label_table *from = &choice->cifti.maps[choice->map].table;
    conus_status status = cifti_choice_list(&list, &count, choice, model);
    for (size_t i = 0; !status && i < count; i++) {
        status = copy_entry(table, label_table_find(from, list[i])); /* in ascending order, so the table is sorted */
    }
    memory_free(list);
    return status;
}

static void spread_labels(uint32_t *out, const struct cifti_choice *choice, const struct cifti_model *model)
{
    for (size_t n = 0; n < model->count; n++) {
        out[model->indices[n]] = choice->labels[model->offset + n];
    }
}

conus_status cifti_choice_vertices(uint32_t **labels, struct label_table *table, const struct cifti_choice *choice,
                                   const struct cifti_model *model)
{
    uint32_t *out = memory_zeroed(model->vertex_count, sizeof *out);
    conus_status status = out ? copy_table(table, choice, model) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(out);
        return status;
    }
    spread_labels(out, choice, model);
    *labels = out;
    return CONUS_OK;
}

/* A label's voxels may be on one side, on both, or somewhere else, too. */
static void set_sides(struct label_table *table, const struct cifti_choice *choice)
{
    static const char NOWHERE = '-';
    for (size_t i = 0; i < table->count; i++) {
        table->entries[i].hemisphere = NOWHERE;
    }
    for (size_t i = 0; i < choice->cifti.model_count; i++) {
        const struct cifti_model *model = &choice->cifti.models[i];
        for (size_t n = 0; !model->is_surface && n < model->count; n++) {
            struct label *entry = label_table_find(table, choice->labels[model->offset + n]);
            if (entry) {
                bool same = entry->hemisphere == NOWHERE || entry->hemisphere == model->structure->side;
                entry->hemisphere = same ? model->structure->side : 0;
            }
        }
    }
}

conus_status cifti_choice_voxels(uint32_t **labels, struct label_table *table, const struct cifti_choice *choice)
{
    const struct cifti *cifti = &choice->cifti;
    uint32_t *out = memory_zeroed(cifti->dim[0] * cifti->dim[1] * cifti->dim[2], sizeof *out);
    conus_status status = out ? copy_table(table, choice, NULL) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(out);
        return status;
    }
    for (size_t i = 0; i < cifti->model_count; i++) {
        if (!cifti->models[i].is_surface) {
            spread_labels(out, choice, &cifti->models[i]);
        }
    }
    set_sides(table, choice);
    *labels = out;
    return CONUS_OK;
}

void cifti_file_finish(struct cifti_file *file)
{
    memory_free(file->path);
    bytes_finish(&file->bytes);
    cifti_choice_finish(&file->choice);
    *file = (struct cifti_file){0};
}

conus_status cifti_file_open(struct cifti_file *out, const char *path, uint64_t max_memory, struct notes *notes)
{
    struct cifti_file file = {0};
    struct text map;
    struct notes own = {0};
    uint64_t limit = memory_limit(max_memory);
    struct file_sums sums = {0};
    conus_status status = map_choice_split(&file.path, &map, path);
    status = status ? status : gzip_read(&file.bytes, file.path, limit, &sums);
    if (!status) {
        memcpy(file.sha256, sums.items[0].sha256, sizeof file.sha256);
        status = cifti_choice_read(&file.choice, &file.bytes, map, limit, &own);
        status = status ? fail_in(status, file.path) : notes_move_in(notes, &own, file.path);
    }
    notes_finish(&own);
    file_sums_finish(&sums);
    if (status) {
        cifti_file_finish(&file);
        return status;
    }
    *out = file;
    return CONUS_OK;
}
