/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens a .dlabel.nii, and spreads the labels of a map over vertices and voxels. */
#include "loaders/cifti/cifti.h"

#include "base/order.h"
#include "sources/source.h"

#include <string.h>

static size_t choose_map(struct job *job, const struct cifti *cifti, struct text wanted)
{
    size_t map = 0;
    const char **names = job_zeroed(job, cifti->maps.count, sizeof *names);
    for (size_t i = 0; names && i < cifti->maps.count; i++) {
        names[i] = cifti->maps.at[i].name;
    }
    (void)JOB_CALL(job, map_choice_make(&map, names, cifti->maps.count, wanted, "maps", &job->notes));
    if (map >= cifti->maps.count) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "map: found %zu, allowed are 0 to %zu", map, cifti->maps.count - 1);
    }
    return map;
}

struct cifti_choice *cifti_choose(struct job *job, const struct bytes *file, struct text wanted)
{
    struct cifti_choice *choice = job_new(job, struct cifti_choice);
    if (!choice) {
        return NULL;
    }
    struct cifti *cifti = &choice->cifti;
    labels_own(job, &choice->table);
    cifti_parse(job, cifti, file);
    choice->map = choose_map(job, cifti, wanted);
    if (!job_ok(job)) {
        return NULL;
    }
    cifti_table(job, &choice->table, &cifti->maps.at[choice->map]);
    choice->labels = cifti_labels(job, cifti, choice->map, &choice->table);
    cifti->values = NULL; /* of the file, which the caller may let go */
    return job_ok(job) ? choice : NULL;
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

uint32_t *cifti_list(struct job *job, size_t *count, const struct cifti_choice *choice, const struct cifti_model *model)
{
    size_t kept = 0;
    uint32_t *list = job_raw(job, choice->cifti.count, sizeof *list);
    for (size_t i = 0; list && i < choice->cifti.model_count; i++) {
        const struct cifti_model *at = &choice->cifti.models[i];
        bool wanted = model ? at == model : !at->is_surface;
        for (size_t n = 0; wanted && n < at->count; n++) {
            list[kept] = choice->labels[at->offset + n];
            kept += list[kept] != 0;
        }
    }
    *count = list ? u32_sort_unique(list, kept) : 0;
    return list;
}

/* The entries of the labels that `model`, or all voxels, have. */
static void copy_table(struct job *job, struct label_table *table, const struct cifti_choice *choice,
                       const struct cifti_model *model)
{
    size_t count;
    const struct job_mark mark = job_mark(job);
    const uint32_t *list = cifti_list(job, &count, choice, model);
    for (size_t i = 0; i < count; i++) { /* in ascending order, so the table is sorted */
        const struct label *from = label_table_find(&choice->table, list[i]);
        struct label *entry = labels_add(job, table, list[i]);
        entry->has_rgb = from->has_rgb;
        memcpy(entry->rgb, from->rgb, sizeof entry->rgb);
        if (from->name) {
            labels_set(job, &entry->name, text_from(from->name));
        }
    }
    job_release(job, mark);
}

static void spread_labels(uint32_t *out, const struct cifti_choice *choice, const struct cifti_model *model)
{
    for (size_t n = 0; n < model->count; n++) {
        out[model->indices[n]] = choice->labels[model->offset + n];
    }
}

uint32_t *cifti_vertices(struct job *job, struct label_table *table, const struct cifti_choice *choice,
                         const struct cifti_model *model)
{
    copy_table(job, table, choice, model);
    uint32_t *labels = job_zeroed(job, model->vertex_count, sizeof *labels);
    if (labels) {
        spread_labels(labels, choice, model);
    }
    return labels;
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

uint32_t *cifti_voxels(struct job *job, struct label_table *table, const struct cifti_choice *choice)
{
    const struct cifti *cifti = &choice->cifti;
    copy_table(job, table, choice, NULL);
    uint32_t *labels = job_zeroed(job, cifti->dim[0] * cifti->dim[1] * cifti->dim[2], sizeof *labels);
    for (size_t i = 0; labels && i < cifti->model_count; i++) {
        if (!cifti->models[i].is_surface) {
            spread_labels(labels, choice, &cifti->models[i]);
        }
    }
    if (labels) {
        set_sides(table, choice);
    }
    return labels;
}

struct cifti_file *cifti_file_open(struct job *job, const char *path)
{
    struct cifti_file *file = job_new(job, struct cifti_file);
    struct source_keys keys;
    source_keys_read(job, &keys, path, KEYS_VERTICES);
    if (!file) {
        return NULL;
    }
    file->path = keys.path;
    const size_t place = job_in(job, keys.path, JOB_ALONE);
    struct attempt own = job_try(job);
    struct source *source = source_open(job, keys.path);
    const struct bytes bytes = source_whole(job, source);
    snprintf(file->sha256, sizeof file->sha256, "%s", source_sum(job, source));
    file->choice = cifti_choose(job, &bytes, keys_value(&keys, KEY_MAP)->text);
    source_close(source); /* the choice has what is needed of it */
    struct notes *notes = attempt_notes(job, &own);
    (void)attempt_end(job, &own, ATTEMPT_SILENT);
    job_out(job, place);
    (void)JOB_CALL(job, notes_move_in(&job->notes, notes, keys.path));
    return job_ok(job) ? file : NULL;
}
