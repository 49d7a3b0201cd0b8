/* SPDX-License-Identifier: BSD-3-Clause */
/* From a tractogram to the bundles of an atlas: their radius, names and notes. */
#include "loaders/scene/scene.h"

#include "atlas/fit/fit.h"
#include "base/memory.h"
#include "base/path.h"
#include "base/text.h"
#include "conus/own.h"
#include "loaders/maps/maps.h"
#include "loaders/tracts/tracts.h"
#include "sources/source.h"

#include <string.h>

/* The name that is wanted, else that of the file or folder without its endings. */
static const char *name_bundle(struct job *job, const char *wanted, const char *path)
{
    if (wanted && wanted[0]) {
        return wanted;
    }
    const size_t length = path_plain_length(path, strlen(path));
    const size_t above = path_length_above(path, length);
    return job_format(job, "%.*s", (int)stem_length(path + above, length - above, ROLE_TRACTS), path + above);
}

double streamlines_radius(struct job *job, double wanted, const char *path)
{
    if (!(wanted >= 0 && wanted <= TRACT_RADIUS_LIMIT)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: radius %s mm, allowed is above 0 to %g", path, NUMBER_TEXT(wanted),
                 TRACT_RADIUS_LIMIT);
    }
    return wanted > 0 ? wanted : TRACT_RADIUS;
}

void streamlines_add(struct job *job, conus_atlas *atlas, struct tractogram *tractogram, const char *name,
                     struct notes *notes)
{
    if (!job_ok(job)) {
        return; /* there may be no path */
    }
    const char *chosen = name_bundle(job, name, tractogram->path);
    (void)JOB_CALL(job, notes_move_in(&atlas->notes, notes, path_base(tractogram->path)));
    (void)JOB_CALL(job, tract_fit_note(&job->notes, atlas, tractogram, chosen));
    atlas_take(job, atlas);
    (void)JOB_CALL(job, atlas_add_tractogram(atlas, tractogram, chosen));
}

static void destroy_atlas(void *atlas)
{
    conus_atlas_destroy(atlas);
}

/* An atlas of one tractogram, which is empty. */
static conus_atlas *make_alone(struct job *job)
{
    conus_atlas *atlas = job_step(job) ? memory_zeroed(1, sizeof *atlas) : NULL;
    if (!job_need(job, atlas)) {
        return NULL;
    }
    job_own(job, destroy_atlas, atlas);
    if (job_ok(job)) {
        atlas->tractograms = memory_zeroed(1, sizeof *atlas->tractograms);
        atlas->tractogram_count = atlas->tractograms != NULL;
        job_need(job, atlas->tractograms);
    }
    return job_ok(job) ? atlas : NULL;
}

conus_atlas *streamlines_load(struct job *job, const char *path, conus_file_space space)
{
    if ((unsigned)space > CONUS_FILE_SPACE_LPS) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: space %d, allowed are CONUS_FILE_SPACE_AS_STATED (0), _RAS and _LPS",
                 path, (int)space);
    }
    conus_atlas *atlas = make_alone(job);
    struct job alone = {.sink = job->sink, .max_memory = job->max_memory}; /* whose notes and files are this atlas's */
    if (!atlas) {
        return NULL;
    }
    tract_file_read(&alone, atlas->tractograms, path, space);
    (void)JOB_CALL(&alone, bundles_ready(atlas->tractograms));
    conus_status status = job_close(&alone, &atlas->notes, &atlas->files);
    return JOB_CALL(job, status) ? atlas : NULL;
}

static bool copy_text(char **out, const char *text)
{
    *out = memory_text(text, strlen(text));
    return *out;
}

/* The names are copied, since an atlas may change them; the numbers are borrowed. False without memory. */
static bool borrow_tractogram(struct tractogram *out, const struct tractogram *from)
{
    *out = *from;
    out->has_borrowed_points = out->is_borrowed = true;
    out->scalars = memory_copy(from->scalars, from->scalar_count, sizeof *out->scalars);
    out->groups = memory_copy(from->groups, from->group_count, sizeof *out->groups);
    out->scalar_count = out->scalars ? from->scalar_count : 0;
    out->group_count = out->groups ? from->group_count : 0;
    bool whole = copy_text(&out->path, from->path) && out->scalars && out->groups;
    for (size_t i = 0; i < out->scalar_count; i++) {
        whole = copy_text(&out->scalars[i].name, from->scalars[i].name) && whole;
    }
    for (size_t i = 0; i < out->group_count; i++) {
        whole = copy_text(&out->groups[i].name, from->groups[i].name) && whole;
    }
    return whole;
}

conus_atlas *streamlines_borrow(struct job *job, const conus_atlas *alone)
{
    conus_atlas *atlas = make_alone(job);
    if (!atlas) {
        return NULL;
    }
    if (!borrow_tractogram(atlas->tractograms, &alone->tractograms[0])) {
        job_need(job, NULL);
    }
    for (size_t i = 0; i < alone->notes.count; i++) {
        (void)JOB_CALL(job, notes_put(&atlas->notes, notes_severity(&alone->notes, i), "%s", alone->notes.lines[i]));
    }
    for (size_t i = 0; i < alone->files.count; i++) {
        const struct file_sum *sum = &alone->files.items[i];
        (void)JOB_CALL(job, file_sums_put(&atlas->files, sum->path, sum->sha256));
    }
    return job_ok(job) ? atlas : NULL;
}

void streamlines_take(struct job *job, conus_atlas *atlas, conus_atlas *alone, double radius, const char *name)
{
    if (!job_ok(job)) {
        return; /* there may be no tractogram */
    }
    struct tractogram *tractogram = &alone->tractograms[0];
    tractogram->radius = radius;
    (void)JOB_CALL(job, file_sums_move(&job->files, &alone->files));
    streamlines_add(job, atlas, tractogram, name, &alone->notes);
}

bool conus_path_is_tractogram(const char *path)
{
    return path && tract_file_is(path);
}
