/* SPDX-License-Identifier: BSD-3-Clause */
/** @file An atlas to which a job adds something, and the volumes that it reads for that. */
#ifndef CONUS_LOADERS_MAPS_ATLAS_ON_JOB_H
#define CONUS_LOADERS_MAPS_ATLAS_ON_JOB_H

#include "atlas/atlas.h"
#include "base/job/job.h"
#include "loaders/volumes/volume_file.h"

/** How much an atlas has. */
struct atlas_mark {
    size_t notes, files, objects, volumes, context_surfaces;
};
struct atlas_mark atlas_mark(const conus_atlas *atlas);

/** Moves the notes and files that the job has so far to the atlas. */
void atlas_take(struct job *job, conus_atlas *atlas);

/** Ends @p job, whose notes and files were taken, at the border. After a failure the atlas has what it had at @p mark.
 */
conus_status atlas_close(struct job *job, conus_atlas *atlas, struct atlas_mark mark);

/** A volume file, all 0, which the job finishes; NULL after a failure. */
struct volume_file *volume_file_new(struct job *job);

#endif
