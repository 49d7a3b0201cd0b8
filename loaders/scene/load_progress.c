/* SPDX-License-Identifier: BSD-3-Clause */
/* What all loaders of scenes share: callbacks, and the atlas with its notes and files. */
#include "loaders/scene/parts.h"

#include "base/memory.h"
#include "loaders/maps/maps.h"
#include "loaders/surfaces/surfaces.h"

#include <string.h>

void load_begin(struct load *out, const char *path, const conus_load_options *options)
{
    *out = (struct load){.options = options, .sink = {options->log, options->log_user, path}};
    out->job.sink = &out->sink;
    out->job.max_memory = options->max_memory;
    out->job.progress = options->progress;
    out->job.progress_user = options->progress_user;
}

conus_status load_end(conus_atlas **out, struct load *load)
{
    conus_status status = job_close(&load->job, NULL, NULL);
    memory_free(load->path);
    if (out) {
        return atlas_give(out, load->atlas, status);
    }
    conus_atlas_destroy(load->atlas);
    return status;
}

void load_at(struct load *load, const char *path)
{
    struct job *job = &load->job;
    char *copy = job_step(job) ? memory_text(path, strlen(path)) : NULL;
    if (copy) {
        memory_free(load->path);
        load->sink.path = load->path = copy;
    } else {
        job_need(job, copy);
    }
}

void load_report(struct load *load, const char *path, size_t files)
{
    job_report(&load->job, path, files);
    load_at(load, path);
}

void load_create(struct load *load, struct labelled_volume *volumes, size_t count, const struct label_table *table,
                 const char *label_source)
{
    struct job *job = &load->job;
    struct notes notes = {.sink = &load->sink};
    if (!count) {
        (void)JOB_CALL(job, atlas_create_empty(&load->atlas, label_source));
    } else if (JOB_CALL(job, notes_move(&notes, &job->notes))) {
        (void)JOB_CALL(job, atlas_create_of(&load->atlas, volumes, count, table, label_source, &notes));
    }
    notes_finish(&notes);
    if (load->atlas) {
        load->atlas->notes.sink = &load->sink;
    }
}

char *mesh_name(struct job *job, const char *path)
{
    char *name = job_step(job) ? mesh_file_name(path) : NULL;
    job_need(job, name);
    return job_adopt(job, name);
}

struct deferred_notes load_defer_notes(struct load *load)
{
    const struct deferred_notes deferred = {load->job.notes, load->job.files};
    load->job.notes = (struct notes){0};
    load->job.files = (struct file_sums){0};
    return deferred;
}

void load_release_notes(struct load *load, struct deferred_notes *deferred)
{
    struct job *job = &load->job;
    (void)JOB_CALL(job, notes_move(&deferred->notes, &job->notes));
    (void)JOB_CALL(job, file_sums_move(&deferred->files, &job->files));
    notes_finish(&job->notes); /* what a failure left */
    file_sums_finish(&job->files);
    job->notes = deferred->notes;
    job->files = deferred->files;
}
