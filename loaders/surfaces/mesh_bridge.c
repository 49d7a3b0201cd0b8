/* SPDX-License-Identifier: BSD-3-Clause */
/* Bridge: mesh_file.c reports a status, the readers of its formats are on a job. It goes when that is on one, too. */
#include "base/memory.h"
#include "loaders/cifti/cifti_file.h"
#include "loaders/surfaces/freesurfer_labels.h"
#include "loaders/surfaces/freesurfer_surface.h"
#include "loaders/surfaces/gifti.h"
#include "loaders/surfaces/surface_find.h"

/* Ends the job that made the labels, of which the caller gets *labels; outputs are 0 after a failure. */
static conus_status give_labels(struct job *job, uint32_t **labels, size_t *count, uint32_t *made, struct notes *notes)
{
    *labels = job_give(job, made, *count * sizeof *made);
    conus_status status = job_close(job, notes, NULL);
    if (status) {
        memory_free(*labels);
        *labels = NULL;
        *count = 0;
    }
    return status;
}

static conus_status end_mesh(struct job *job, struct mesh *out, struct notes *notes)
{
    conus_status status = job_close(job, notes, NULL);
    if (status) {
        mesh_finish(out);
    }
    return status;
}

/* Ends a job of its own. */
static conus_status end_own(struct job *job, struct notes *notes)
{
    conus_status status = job_close(job, notes, NULL);
    memory_free(job);
    return status;
}

conus_status gifti_parse(struct gifti *out, const uint8_t *data, size_t size, const struct gifti_options *options,
                         struct notes *notes)
{
    struct job *job = memory_zeroed(1, sizeof *job);
    if (!job) {
        return CONUS_ERROR_MEMORY;
    }
    job->max_memory = options->max_memory;
    struct gifti *gifti = gifti_read(job, text_from_bytes(data, size), options->external ? options->path : NULL);
    char *name = gifti && gifti->name ? memory_text(gifti->name, strlen(gifti->name)) : NULL;
    if (gifti && gifti->name) {
        job_need(job, name);
    }
    (void)JOB_CALL(job, notes_move(notes, &job->notes));
    if (!gifti || !job_ok(job)) {
        memory_free(name);
        return end_own(job, notes);
    }
    *out = *gifti;
    out->name = name;
    out->own = job;
    gifti->labels = (struct label_table){0};
    return CONUS_OK;
}

void gifti_finish(struct gifti *gifti)
{
    if (gifti->own) {
        memory_free(gifti->name);
        label_table_finish(&gifti->labels);
        (void)end_own(gifti->own, NULL);
    }
    *gifti = (struct gifti){0};
}

conus_status gifti_mesh(struct mesh *out, const struct gifti *gifti, bool as_stored, struct notes *notes)
{
    struct job job = {0};
    gifti_surface(&job, out, gifti, as_stored);
    return end_mesh(&job, out, notes);
}

conus_status gifti_labels(uint32_t **labels, size_t *count, const struct gifti *gifti, size_t map, struct notes *notes)
{
    struct job job = {0};
    return give_labels(&job, labels, count, gifti_vertices(&job, count, gifti, map), notes);
}

conus_status gifti_find_labels(struct gifti *gifti, struct notes *notes)
{
    struct job job = {0};
    gifti_settle_labels(&job, gifti);
    return job_close(&job, notes, NULL);
}

conus_status gifti_map_find(size_t *out, const struct gifti *gifti, struct text wanted, struct notes *notes)
{
    struct job job = {0};
    *out = gifti_map(&job, gifti, wanted);
    return job_close(&job, notes, NULL);
}

conus_status surface_about_read(struct surface_about *out, const char *path, uint64_t max_memory)
{
    struct job job = {.max_memory = max_memory};
    const struct surface_about about = surface_about_of(&job, path);
    char *structure = about.structure ? memory_text(about.structure, strlen(about.structure)) : NULL;
    if (about.structure) {
        job_need(&job, structure);
    }
    *out = (struct surface_about){.structure = structure, .vertices = about.vertices};
    return job_close(&job, NULL, NULL);
}

void surface_about_finish(struct surface_about *about)
{
    memory_free(about->structure);
    *about = (struct surface_about){0};
}

conus_status cifti_choice_read(struct cifti_choice *out, const struct bytes *bytes, struct text wanted,
                               uint64_t max_memory, struct notes *notes)
{
    struct job *job = memory_zeroed(1, sizeof *job);
    if (!job) {
        return CONUS_ERROR_MEMORY;
    }
    job->max_memory = max_memory;
    struct cifti_choice *choice = cifti_choose(job, bytes, wanted);
    (void)JOB_CALL(job, notes_move(notes, &job->notes));
    if (!choice || !job_ok(job)) {
        return end_own(job, notes);
    }
    *out = *choice;
    out->own = job;
    return CONUS_OK;
}

void cifti_choice_finish(struct cifti_choice *choice)
{
    if (choice->own) {
        (void)end_own(choice->own, NULL);
    }
    *choice = (struct cifti_choice){0};
}

conus_status cifti_choice_vertices(uint32_t **labels, struct label_table *table, const struct cifti_choice *choice,
                                   const struct cifti_model *model)
{
    struct job job = {0};
    size_t count = model->vertex_count;
    return give_labels(&job, labels, &count, cifti_vertices(&job, table, choice, model), NULL);
}

static struct text text_of(const uint8_t *data, size_t size)
{
    return (struct text){(const char *)data, size};
}

conus_status freesurfer_surface_parse(struct mesh *out, const uint8_t *data, size_t size, bool as_stored,
                                      struct notes *notes)
{
    struct job job = {0};
    struct reader r = reader_of(&job, text_of(data, size));
    freesurfer_surface_read(&r, out, as_stored);
    return end_mesh(&job, out, notes);
}

conus_status freesurfer_annot_parse(uint32_t **labels, size_t *count, struct label_table *table, const uint8_t *data,
                                    size_t size, struct notes *notes)
{
    struct job job = {0};
    struct reader r = reader_of(&job, text_of(data, size));
    return give_labels(&job, labels, count, freesurfer_annot_read(&r, table, count), notes);
}

conus_status freesurfer_label_parse(uint32_t **labels, size_t *count, struct text text)
{
    struct job job = {0};
    return give_labels(&job, labels, count, freesurfer_label_read(&job, text, count), NULL);
}
