/* SPDX-License-Identifier: BSD-3-Clause */
/* An atlas to which a job adds something: its notes and files, and the way back. */
#include "loaders/maps/maps.h"

struct atlas_mark atlas_mark(const conus_atlas *atlas)
{
    return (struct atlas_mark){atlas->notes.count, atlas->files.count, atlas->object_count, atlas->volume_count,
                               atlas->context_surface_count};
}

void atlas_take(struct job *job, conus_atlas *atlas)
{
    (void)JOB_CALL(job, notes_move(&atlas->notes, &job->notes));
    (void)JOB_CALL(job, file_sums_move(&atlas->files, &job->files));
}

conus_status atlas_close(struct job *job, conus_atlas *atlas, struct atlas_mark mark)
{
    if (!job_ok(job)) {
        atlas_cut_objects(atlas, mark.objects);
        while (atlas->volume_count > mark.volumes) {
            volume_finish(&atlas->volumes[--atlas->volume_count]);
        }
        atlas_cut_context_surfaces(atlas, mark.context_surfaces);
        notes_cut(&atlas->notes, mark.notes);
        file_sums_cut(&atlas->files, mark.files);
    }
    return job_close(job, NULL, NULL);
}

static void finish_volume(void *file)
{
    volume_file_finish(file);
}

struct volume_file *volume_file_new(struct job *job)
{
    struct volume_file *file = job_new(job, struct volume_file);
    if (file) {
        job_own(job, finish_volume, file);
    }
    return job_ok(job) ? file : NULL;
}
