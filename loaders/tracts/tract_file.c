/* SPDX-License-Identifier: BSD-3-Clause */
/* The readers of the formats of tractograms, and what holds for all of them. */
#include "loaders/tracts/tracts.h"

#include "base/memory.h"
#include "base/path.h"
#include "loaders/refuse.h"
#include "loaders/tracts/tract_formats.h"

#include <stdio.h>
#include <string.h>

/* True for a folder and for a name that ends in .trx. The head of a file cannot tell TRX from other zip archives. */
static bool trx_is_named(const char *path)
{
    return file_is_folder(path) || path_ends_in(path, ".trx");
}

/* `has_lines`, unless NULL, checks further whether the file is a tractogram. `states_mm`: points are always world mm.
 * `space`: the axes in which the format has its numbers; those that a header places come out in RAS, and nobody may say
 * otherwise. */
static const struct tract_format {
    enum format_id id;
    tract_reader *read;
    bool (*has_lines)(const char *path);
    bool states_mm;
    enum { SPACE_OF_FILE, SPACE_RAS, SPACE_PLACED } space;
} formats[] = {
    {FORMAT_TRK, trk_read, NULL, false, SPACE_PLACED}, /* where it has a matrix */
    {FORMAT_TCK, tck_read, NULL, true, SPACE_RAS},
    {FORMAT_TT, tt_read, NULL, true, SPACE_PLACED},
    {FORMAT_TRX, trx_read, trx_is_named, true, SPACE_RAS},
    {FORMAT_VTK, vtk_lines_read, vtk_lines_are_in, false, SPACE_OF_FILE},
    {FORMAT_VTP, vtk_lines_read, vtk_lines_are_in, false, SPACE_OF_FILE},
};

static const struct tract_format *format_reader(const struct format *format)
{
    for (size_t i = 0; format && i < sizeof formats / sizeof formats[0]; i++) {
        if (formats[i].id == format->id) {
            return &formats[i];
        }
    }
    return NULL;
}

bool tract_file_is(const char *path)
{
    const struct format *found;
    const struct tract_format *format = source_find(&found, path, ROLE_TRACTS) ? NULL : format_reader(found);
    return format && (!format->has_lines || format->has_lines(path));
}

/* Callers ask for scalars by name. */
static void check_names(struct job *job, const struct tractogram *tractogram)
{
    for (size_t i = 0; job_ok(job) && i < tractogram->scalar_count; i++) { /* else names may be missing */
        for (size_t k = 0; k < i; k++) {
            const struct tract_scalar *a = &tractogram->scalars[i];
            const struct tract_scalar *b = &tractogram->scalars[k];
            if (a->per_point == b->per_point && strcmp(a->name, b->name) == 0) {
                job_bad(job, "scalars: found '%s' twice, each needs a name of its own", a->name);
            }
        }
    }
}

/* Brings points into RAS: from the axes that the user states, which count before those of the file. */
static void settle_space(struct job *job, struct tractogram *tractogram, const struct tract_format *format,
                         conus_file_space given)
{
    static const char *const names[] = {"", "RAS", "LPS"};
    unsigned char own = format->space == SPACE_OF_FILE ? tractogram->space : CONUS_FILE_SPACE_RAS;
    tractogram->space = given ? (unsigned char)given : own;
    if (given == CONUS_FILE_SPACE_LPS && format->space == SPACE_PLACED) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "space: found lps, but the header of this format places its points: RAS is allowed, or nothing");
    }
    if (job_ok(job) && tractogram->space == CONUS_FILE_SPACE_LPS) {
        tractogram_from_lps(tractogram);
    }
    if (given && own && given != own) {
        job_warn(job, "points are taken for %s, as is stated, but the %s says %s", names[given],
                 format->space == SPACE_OF_FILE ? "file" : "format", names[own]);
    } else if (!given && !own) {
        job_note(job, "the file does not state its space; RAS was taken (,space=lps states LPS, which DIPY writes)");
    }
}

static void read_format(struct job *job, struct tractogram *out, struct source *source, conus_file_space space)
{
    struct tract_build build = {.job = job, .max_memory = memory_limit(job->max_memory)};
    struct tractogram *t = &build.tractogram;
    const struct tract_format *format = format_reader(format_find(&source->head, ROLE_TRACTS));
    if (!format) { /* says what it is instead; its name does not count, which may well be a tractogram's */
        file_refuse(job, NULL, &source->stored, "a tractogram: TrackVis, MRtrix, DSI Studio, TRX or polylines of VTK");
        return;
    }
    source_sum_ahead(source->is_open && format->read != trx_read ? source : NULL); /* which is read whole */
    format->read(job, source, &build);
    if (source->is_open) {
        snprintf(t->sha256, sizeof t->sha256, "%s", source_sum(job, source));
    }
    settle_space(job, t, format, space);
    check_names(job, t);
    t->states_mm = t->states_mm || format->states_mm;
    t->radius = TRACT_RADIUS;
    (void)JOB_CALL(job, tractogram_check(t, &job->notes));
    if (!t->streamline_count) {
        job_note(job, "streamlines: the file has none");
    }
    if (source->file.path && job_step(job)) {
        t->path = memory_text(source->file.path, strlen(source->file.path));
        job_need(job, t->path);
    }
    if (!job_ok(job)) {
        tractogram_finish(t);
        return;
    }
    *out = *t;
}

/* The file, or the folder of a format that is one; NULL after a failure. */
static struct source *open_source(struct job *job, const char *path)
{
    const struct file_head folder = {.path = path, .is_folder = file_is_folder(path)};
    if (!folder.is_folder || !format_find(&folder, ROLE_TRACTS)) {
        return source_open(job, path);
    }
    struct source *source = job_new(job, struct source);
    if (source) {
        source->file.path = path;
        source->head = folder;
    }
    return source;
}

void tract_file_read(struct job *job, struct tractogram *out, const char *path, conus_file_space space)
{
    const size_t place = job_in(job, path, JOB_ALONE);
    struct source *source = open_source(job, path);
    if (source) {
        read_format(job, out, source, space);
    }
    job_out(job, place);
}

void tract_file_parse(struct job *job, struct tractogram *out, struct text bytes)
{
    struct source *source = source_of_memory(job, NULL, bytes);
    if (source) {
        read_format(job, out, source, CONUS_FILE_SPACE_AS_STATED);
    }
}
